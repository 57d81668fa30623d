"""The assembly modes of a 5-RPUR while its actuators move.

All real solutions are followed at once along the straight line in joint space, several times as
quickly as one by one by proven steps. Where a solution arrives it is the same assembly mode, and
keeps its identity; where it ends at a fold, it has merged with another. Arriving is not taken on
trust: the end has to be one of the full set, two may not arrive together, and the determinant may
not have changed its sign.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.answers.solutions import ForwardSolutions, Refreshed
from kinematics.homotopy.assembly_tracking import told_apart
from kinematics.homotopy.tracking import Control, Ending, Index, Tracked, track
from kinematics.mechanisms.five_rpur.forward.assembly import Solving
from kinematics.mechanisms.five_rpur.forward.equations import (
    Complex,
    Deformation,
    Frame,
    from_poses,
    parameters,
    polish,
    real_part,
    to_poses,
)
from kinematics.mechanisms.five_rpur.inverse import joint_points

_AT_ONCE = Control(first=1.0, error=2e-2, shortest=1e-4, most=200)
_CAREFULLY = Control(first=0.02, error=1e-3, contraction=0.02, shortest=1e-6, most=2000)
_THERE = 1e-6  # of the machine's size: an end and the solution that it is
_TOGETHER = 0.2  # of the machine's size: solutions left at the same fold


class Forward(Solving):
    """Solving, and who is who."""

    def refresh(self, before: ForwardSolutions, joints: Sequence[float]) -> Refreshed:
        """As of every mechanism; of one without merged joints, whose solutions may be many, all are
        followed at once.
        """
        if self.design.merged_joints and not before.mixed_modes:
            return super().refresh(before, joints)
        now, frame = self.tracked_on(before, joints), Frame.of(self.design)
        g0, g1 = (parameters(self.design, s.joints, frame) for s in (before, now))
        way, starts = Deformation(g0, g0._replace(rho2=g1.rho2)), self._configurations(before)
        ends = _followed(way, starts, _AT_ONCE)

        def at_ends() -> Index:
            """Which solution each has become; −1 for none, or for doubt."""
            answer = np.full(len(before), -1, dtype=np.intp)
            arrived = ends.ended(Ending.REGULAR)
            if not len(arrived) or not len(now):
                return answer
            poses = to_poses(frame, real_part(ends.values[:, arrived])[0])
            apart = self.distances(poses, (), now.poses, ())
            nearest = apart.argmin(axis=1)
            good = apart.min(axis=1) <= _THERE * frame.unit
            good &= np.sign(before.determinant[arrived]) == np.sign(now.determinant[nearest])
            good &= np.bincount(nearest[good], minlength=len(now))[nearest] <= 1
            answer[arrived[good]] = nearest[good]
            return answer

        became = at_ends()
        doubt = np.flatnonzero((became < 0) & (ends.endings == Ending.REGULAR))
        if doubt.size:
            again = _followed(way.take(doubt), starts[:, doubt], _CAREFULLY)
            ends.endings[doubt], ends.reached[doubt] = again.endings, again.reached
            ends.values[:, doubt] = again.values
            became = at_ends()
        last = to_poses(frame, real_part(ends.values)[0])
        apart, near = self.distances(last, (), last, ()), _TOGETHER * frame.unit
        return told_apart(before, now, became, last, np.sign(before.determinant), apart, near)

    def _configurations(self, known: ForwardSolutions) -> Complex:
        ((_, signs),) = self.alike(known.modes)
        _, elbows, tips = joint_points(self.design, known.poses, signs)
        elbows = np.where(np.isfinite(elbows), elbows, tips)  # rounding, with the link along e1
        frame = Frame.of(self.design)
        u = from_poses(frame, known.poses, elbows)
        return polish(parameters(self.design, known.joints, frame), u, rounds=2)[0]


def _followed(way: Deformation, starts: Complex, control: Control) -> Tracked:
    ends = track(way, starts, control)
    arrived = ends.ended(Ending.REGULAR)
    there = np.ones(len(arrived))
    with np.errstate(all="ignore"):
        for _ in range(2):
            ends.values[:, arrived] += way.take(arrived).step(ends.values[:, arrived], there)[0]
    return ends
