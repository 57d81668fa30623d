"""The assembly modes of a 4-SPS + 1-SPR while its legs move, see `homotopy.assembly_tracking`.

Solutions are followed along the straight line in joint space from the lengths before to those now.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from kinematics.answers.solutions import ForwardSolutions, Refreshed
from kinematics.arrays import Array
from kinematics.homotopy.assembly_tracking import AT_ONCE, CAREFULLY, arrivals, became, told_apart
from kinematics.homotopy.tracking import Ending, Index, Tracked, track
from kinematics.mechanisms.four_sps_spr.forward.assembly import Solving, pose_distances
from kinematics.mechanisms.four_sps_spr.forward.equations import (
    Deformation,
    Frame,
    from_transforms,
    parameters,
    to_transforms,
)
from kinematics.mechanisms.four_sps_spr.inverse import rotation
from kinematics.mechanisms.four_sps_spr.states import poses_of

_THERE = 1e-5  # of the characteristic length: an end and the solution that it is
_TOGETHER = 0.5  # of the characteristic length: solutions left at the same fold


class Forward(Solving):
    """Solving, and who is who."""

    def refresh(self, before: ForwardSolutions, joints: Sequence[float]) -> Refreshed:
        design = self.design
        (now,) = self([joints])
        frame = Frame.of(design)
        g0, g1 = (parameters(design, s.joints, frame) for s in (before, now))
        way = Deformation(g0, g1)
        starts = from_transforms(frame, rotation(before.poses), before.poses[:, :3])
        sides = np.sign(before.determinant), np.sign(now.determinant)
        distances = partial(pose_distances, design)

        def follow(columns: Index | None) -> Tracked:
            if columns is None:
                return track(way, starts, AT_ONCE)
            return track(way.take(columns), starts[:, columns], CAREFULLY)

        def at_ends(ends: Tracked) -> Index:
            arrived = ends.ended(Ending.REGULAR)
            apart = distances(_poses(frame, ends)[arrived], now.poses)
            return arrivals(apart, arrived, sides, _THERE * design.length)

        ends, which = became(follow, at_ends)
        last, near = _poses(frame, ends), _TOGETHER * design.length
        return told_apart(before, now, which, last, sides[0], distances(last, last), near)


def _poses(frame: Frame, ends: Tracked) -> Array:
    return poses_of(*to_transforms(frame, ends.values))
