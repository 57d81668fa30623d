"""States of the platform as rotation and position: where angles would have a pole."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.inverse import euler_angles, rotation
from kinematics.screws.spatial import wrap_angle


class State(NamedTuple):
    """R (3, 3) and p (3,) mm."""

    r: Array
    p: Array


def placed(pose: Sequence[float]) -> State:
    """The state of a pose."""
    values = np.array(pose, dtype=float)
    return State(rotation(values), values[:3])


def pose_of(state: State, near: Sequence[float] | None = None) -> tuple[float, ...]:
    """The pose; of the two triples of angles the one nearer to those of ``near``, if given."""
    angles = euler_angles(state.r)
    if near is not None:
        other = wrap_angle(np.array([np.pi, np.pi, np.pi]) * [1, 1, 1] + angles * [1, -1, 1])
        old = np.array(near[3:], dtype=float)
        if np.abs(wrap_angle(other - old)).sum() < np.abs(wrap_angle(angles - old)).sum():
            angles = other
    return (*state.p.tolist(), *angles.tolist())


def poses_of(r: Array, p: Array) -> Array:
    """The poses (N, 6) of rotations (N, 3, 3) and places (N, 3)."""
    poses = [pose_of(State(*one)) for one in zip(r, p, strict=True)]
    return np.array(poses, dtype=float).reshape(-1, 6)
