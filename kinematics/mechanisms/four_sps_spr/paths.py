"""What a move of the pose passes on its way: singularities and ends of strokes; paths of moves.

The way between two poses is straight in all six coordinates, angles the shorter way round, but for
the position, which is brought back into the plane of the constraint along its normal. What is
sought are changes of sign, of the determinant and of each leg's room, between close places.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.singularities import Event
from kinematics.answers.solutions import Followed, Posture
from kinematics.arrays import Array
from kinematics.facets.inverse import posture
from kinematics.facets.pose_paths import corners_of, follow_ways
from kinematics.mechanisms.four_sps_spr.design import LIMBS, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import (
    STROKE_SLACK,
    leg_lengths,
    rotation,
    violation,
    wrap_angle,
)
from kinematics.mechanisms.four_sps_spr.statics import legs, matrix
from kinematics.screws.wrenches import determinant

_PLACES = 65
_HALVINGS = 40
_BEFORE = 1e-6  # of a way, by which a path stops before a singularity
_STILL = 1e-12  # a shorter way, mm and rad, is none


def passed(design: FourSPSSPRDesign, before: Posture, after: Posture) -> tuple[Event, ...]:
    """Events in the order in which they are met."""
    return _events(_Way(design, before.pose, after.pose))


def path(design: FourSPSSPRDesign, start: Posture, poses: ArrayLike) -> Followed:
    """Follow such ways through poses (N, 6), each brought onto the constraint.

    Stops shortly before a parallel singularity, and at a stroke end that it would pass.

    Raises:
        InputError: no poses, or not six finite numbers each.
    """
    corners = [start.pose, *corners_of(poses, ("x", "y", "z", "α", "β", "γ"))]
    return follow_ways(
        start,
        [_Way(design, tuple(a), tuple(b)) for a, b in pairwise(corners)],
        events=_events,
        posture=lambda pose: posture(design, pose),
        back=lambda _: _BEFORE,
        why=lambda event, *_: event.text,
    )


def _events(way: _Way) -> tuple[Event, ...]:
    if way.length <= _STILL:
        return ()
    at = np.linspace(0.0, 1.0, _PLACES)
    values = way.values(at)
    told = []
    for k, column in np.argwhere((values[1:] >= 0.0) != (values[:-1] >= 0.0)).tolist():
        leaves = bool(values[k, column] >= 0.0)
        fraction = way.crossing(column, float(at[k]), float(at[k + 1]))
        told.append(_event(way, column, fraction, leaves))
    return tuple(sorted(told, key=lambda event: event.fraction))


class _Way:
    def __init__(
        self, design: FourSPSSPRDesign, start: tuple[float, ...], end: tuple[float, ...]
    ) -> None:
        self.design, self.start = design, np.array(start)
        self.step = np.array(end) - self.start
        self.step[3:] = wrap_angle(self.step[3:])
        self.length = float(np.abs(self.step).max())

    def poses(self, at: Array) -> Array:
        """(n, 6), on the constraint."""
        poses = self.start + at[:, None] * self.step
        normal = rotation(poses) @ self.design.axis
        poses[:, :3] += violation(self.design, poses)[:, None] * normal
        return np.asarray(poses)

    def pose(self, s: float) -> tuple[float, ...]:
        """The pose at s, on the constraint."""
        return tuple(self.poses(np.array([s]))[0].tolist())

    def values(self, at: Array) -> Array:
        """(n, 11): the determinant, and the room of every leg at both ends of its stroke, mm."""
        poses = self.poses(at)
        lengths = leg_lengths(self.design, poses)
        low, high = self.design.stroke.T
        return np.column_stack(
            [
                determinant(matrix(legs(self.design, poses)), self.design.length),
                lengths - low + STROKE_SLACK,
                high - lengths + STROKE_SLACK,
            ]
        )

    def crossing(self, column: int, low: float, high: float) -> float:
        """Where a value changes its sign, between two places at which it differs."""
        first = bool(self.values(np.array([low]))[0, column] >= 0.0)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if bool(self.values(np.array([middle]))[0, column] >= 0.0) == first:
                low = middle
            else:
                high = middle
        return low if first else high


def _event(way: _Way, column: int, fraction: float, leaves: bool) -> Event:
    pose = way.pose(fraction)
    if column == 0:
        text = "passed a parallel singularity, where the legs do not hold the platform"
        return Event("parallel", fraction, pose, None, text, True)
    limb, end = (column - 1) % LIMBS + 1, "l min" if column <= LIMBS else "l max"
    bound = float(way.design.stroke[limb - 1, 0 if column <= LIMBS else 1])
    what = "left" if leaves else "came back into"
    text = f"limb {limb} {what} its stroke ({end} = {bound:g} mm)"
    return Event("stroke", fraction, pose, limb, text, leaves)
