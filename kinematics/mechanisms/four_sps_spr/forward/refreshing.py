"""The assembly modes of a 4-SPS + 1-SPR while its legs move, see `homotopy.assembly_tracking`.

Solutions are followed along the straight line in joint space from the lengths before to those now.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from kinematics.answers.solutions import ForwardSolutions, Refreshed
from kinematics.homotopy.assembly_tracking import AT_ONCE, CAREFULLY, tracked_apart
from kinematics.homotopy.tracking import Index, Tracked, track
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

        def tracked(columns: Index | None) -> Tracked:
            if columns is None:
                return track(way, starts, AT_ONCE)
            return track(way.take(columns), starts[:, columns], CAREFULLY)

        return tracked_apart(
            before,
            now,
            tracked,
            lambda ends: poses_of(*to_transforms(frame, ends)),
            partial(pose_distances, design),
            sides=sides,
            there=_THERE * design.length,
            together=_TOGETHER * design.length,
        )
