"""Motion of the five-bar along its assembly mode while the joints turn, and the fold ahead."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.solutions import Fold, Followed, Posture, Stop
from kinematics.arrays import Array
from kinematics.facets.following import Aim, FollowingFacet, aimed
from kinematics.facets.inverse import posture
from kinematics.facets.paths import PathsFacet
from kinematics.mechanisms.five_bar.design import SUBSCRIPTS, FiveBarDesign
from kinematics.mechanisms.five_bar.forward import both_points
from kinematics.mechanisms.five_bar.inverse import elbows, mode_of, normal_angles
from kinematics.mechanisms.five_bar.joints_line import Crossing, first_crossing

_BEFORE = 1e-6  # part of the way by which a motion stops before a singularity
_UNDETERMINED = "P stands in a parallel singularity, so the joints do not determine where it goes"


class Following(FollowingFacet[FiveBarDesign]):
    """A joint that turns freely takes the shorter way round; one with a range stays within it.

    P keeps the side of the line B_1 B_2 on which it is, so nothing is traced: the first parallel
    singularity on the way is found by intervals that prove the rest free (see
    `joints_line.first_crossing`). Serial singularities are passed: there a limb changes its working
    mode.
    """

    def follow(self, start: Posture, joints: ArrayLike) -> Followed:
        design, wanted = self.design, self.wanted(joints)
        if not start.closes:
            text = "the machine is not assembled here; bring P back within the reach of both limbs"
            return Followed(start, "stalled", text, 0.0)
        q = np.array(start.joints)
        aim, blocked, share = _aim(design, q, wanted)
        side = _side(design, start)
        crossing = first_crossing(design, q.tolist(), aim.tolist())
        if side == 0 or (crossing is not None and crossing.fraction == 0.0):
            return Followed(start, "singularity", _UNDETERMINED, 0.0)
        fraction = 1.0 if crossing is None else max(0.0, crossing.fraction - _BEFORE)
        at = q + fraction * (aim - q)
        point = both_points(design, at)[0 if side > 0 else 1]
        if not np.isfinite(point).all():  # rounding at the very fold
            return Followed(start, "singularity", _singular_text(crossing), 0.0)
        moved = posture(design, point, mode_of(design, point, at)[0], known=at)
        stop: Stop = "target"
        text, limb = _events_text(start.mode, moved.mode), None
        if crossing is not None:
            stop, text = "singularity", _joined(text, _singular_text(crossing))
        elif blocked is not None:
            stop, limb = "stroke", blocked + 1
            text = _joined(text, _range_text(design, blocked, float(wanted[blocked])))
        return Followed(
            moved, stop, text, fraction * share, limb, self.other(PathsFacet).warning(moved)
        )

    def fold_ahead(self, start: Posture, joints: ArrayLike) -> Fold | None:
        """The partner is the other assembly mode: with two of them, it is who both merge with."""
        design, wanted = self.design, self.wanted(joints)
        if not start.closes or _side(design, start) == 0:
            return None
        q = np.array(start.joints)
        crossing = first_crossing(design, q.tolist(), wanted.tolist())
        if crossing is None or crossing.fraction == 0.0:
            return None
        other = both_points(design, q)[1 if _side(design, start) > 0 else 0]
        partner = posture(design, other, mode_of(design, other, q)[0], known=q)
        there = normal_angles(design, crossing.joints)
        return Fold(
            distance=crossing.fraction * float(np.linalg.norm(wanted - q)),
            joints=(float(there[0]), float(there[1])),
            pose=(float(crossing.point[0]), float(crossing.point[1])),
            mode=mode_of(design, crossing.point, crossing.joints)[0],
            partner=partner,
        )


def _aim(design: FiveBarDesign, q: Array, wanted: Array) -> Aim:
    """Where the joints go, the shorter way round where they are free; the share is of all turns."""
    low, high = design.joint_range.T
    turn = wanted - q
    shorter = turn - 2 * np.pi * np.round(turn / (2 * np.pi))
    turn = np.where(np.isfinite(low), turn, shorter)
    aim = aimed(q, q + turn, low, high)
    way = float(np.abs(turn).sum())
    share = float(np.abs(aim.joints - q).sum()) / way if way > 0.0 else 1.0
    return aim._replace(share=share)


def _side(design: FiveBarDesign, start: Posture) -> int:
    """On which side of B_1 B_2 P is: 1 left, -1 right, 0 in a parallel singularity."""
    one, two = np.array(start.pose) - elbows(design, start.joints)
    sine = (one[0] * two[1] - one[1] * two[0]) / float(np.prod(design.distal))
    return 0 if abs(sine) < 1e-12 else (1 if sine > 0.0 else -1)


def _events_text(before: str, after: str) -> str:
    """Which limbs passed into another working mode."""
    changed = [n + 1 for n, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    if not changed:
        return ""
    who = "limb 1 and limb 2" if len(changed) > 1 else f"limb {changed[0]}"
    return f"{who} passed a serial singularity into working mode {after.replace('-', '−')}"


def _singular_text(crossing: Crossing | None) -> str:
    if crossing is None:
        return "stopped at a parallel singularity"
    line = "B₁, P and B₂ come into line" if crossing.extended else "the distal links fold together"
    q = np.degrees(crossing.joints)
    return (
        f"stopped before a parallel singularity at θ₁ = {q[0]:.2f}°, θ₂ = {q[1]:.2f}°, where {line}"
    )


def _range_text(design: FiveBarDesign, i: int, wanted: float) -> str:
    end = design.joint_range[i][int(wanted > design.joint_range[i][1])]
    return f"θ{SUBSCRIPTS[i]} stopped at the end of its range, {np.degrees(end):g}°"


def _joined(*parts: str) -> str:
    return "; ".join(filter(None, parts))
