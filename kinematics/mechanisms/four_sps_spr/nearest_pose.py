"""Why a pose of the 4-SPS + 1-SPR cannot be held, and the ways out: another pose, other strokes."""

from __future__ import annotations

from math import ceil, floor

import numpy as np

from kinematics.answers.bounds import decimals as digits
from kinematics.answers.clearances import DesignChange, Remedy
from kinematics.answers.solutions import Posture
from kinematics.facets.clearances import ClearancesFacet
from kinematics.facets.inverse import posture
from kinematics.mechanisms.four_sps_spr.constraint import complete_pose
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.home import home
from kinematics.mechanisms.four_sps_spr.plane import nearest_place

_HALVINGS = 40


class NearestPose(ClearancesFacet[FourSPSSPRDesign]):
    """Exact at the orientation: a plane region bounded by arcs."""

    def nearest_pose(self, posture: Posture) -> Remedy:
        """The ways out of a posture that cannot be held.

        Where the region is empty, the orientation is turned towards that of home as little as it
        takes, which is not proven to be the nearest of all.
        """
        design, wanted = self.design, posture
        if wanted.reachable:
            return Remedy(wanted, 0.0, (), "this pose can be held")
        found = _at(design, wanted, wanted.pose[3:])
        error = 0.0
        if found is not None:
            text = f"the nearest pose that can be held is {_mm(found[1])} away"
        else:
            found = _turned(design, wanted)
            error = float("inf")
            text = (
                "no place can be held at this orientation, and none was found at others"
                if found is None
                else "no place can be held at this orientation; one that can, turned towards home, "
                f"is {_mm(found[1])} away"
            )
        return Remedy(
            nearest=None if found is None else found[0],
            distance=float("inf") if found is None else found[1],
            changes=_changes(design, wanted),
            text=text,
            error=error,
        )


def _at(
    design: FourSPSSPRDesign, wanted: Posture, angles: tuple[float, ...]
) -> tuple[Posture, float] | None:
    position = np.array(wanted.pose[:3])
    found = nearest_place(design, angles, position)
    if found is None:
        return None
    # The constraint and the strokes to the last digit: a hair further inside.
    pose = complete_pose(design, (*found[0].tolist(), *angles))
    there = posture(design, pose)
    if not there.reachable and max(r.amount for r in there.reasons) > 1e-6:
        return None
    known = np.clip(there.joints, design.stroke[:, 0], design.stroke[:, 1])
    return posture(design, pose, known=known), float(np.linalg.norm(found[0] - position))


def _turned(design: FourSPSSPRDesign, wanted: Posture) -> tuple[Posture, float] | None:
    """The least part of the way to the angles of home that makes room."""
    start, goal = np.array(wanted.pose[3:]), np.array(home(design).pose[3:])
    low, high, best = 0.0, 1.0, None
    for _ in range(_HALVINGS):
        part = high if best is None else 0.5 * (low + high)
        a, b, c = (start + part * (goal - start)).tolist()
        found = _at(design, wanted, (a, b, c))
        if found is not None:
            best, high = found, part
        elif best is None:
            return None
        else:
            low = part
        if high - low < 1e-3:
            break
    return best


def _changes(design: FourSPSSPRDesign, wanted: Posture) -> tuple[tuple[DesignChange, ...], ...]:
    """Longer strokes for all limbs at fault together; none where the constraint is violated."""
    if any(reason.bound == "link" for reason in wanted.reasons):
        return ()
    ends: list[DesignChange] = []
    for reason in wanted.reasons:
        limb = reason.limb - 1
        end = 0 if reason.bound == "rho_min" else 1
        before, after = design.limbs[limb].stroke[end], wanted.joints[limb]
        places = digits(abs(after - before))
        scale = 10.0**places
        outwards = floor(after * scale) if end == 0 else ceil(after * scale)
        name = ("l min", "l max")[end]
        label = f"{name} of limb {limb + 1}"
        text = f"{label} from {before:g} to {outwards / scale:.{places}f} mm"
        ends.append(DesignChange(("limb", limb, "stroke", end), label, before, after, text))
    return (tuple(ends),) if ends else ()


def _mm(distance: float) -> str:
    return f"{distance:.{digits(distance)}f} mm"
