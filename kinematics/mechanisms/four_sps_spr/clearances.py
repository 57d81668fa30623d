"""How far the platform of the 4-SPS + 1-SPR may move at its orientation until something happens."""

from __future__ import annotations

import numpy as np

from kinematics.answers.bounds import decimals as digits
from kinematics.answers.bounds import range_of
from kinematics.answers.clearances import Clearance
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.design import LIMBS, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import CONSTRAINT_SLACK, LIMITS, violation
from kinematics.mechanisms.four_sps_spr.nearest_pose import NearestPose
from kinematics.mechanisms.four_sps_spr.plane import Plane, plane, rings
from kinematics.mechanisms.four_sps_spr.singular_curve import cubic, nearest_singular
from kinematics.plane.annuli import rings_section
from kinematics.plane.regions import nearest_point

_EXACT = 1e-9  # of the machine's size


class Clearances(NearestPose):
    """In the plane that the orientation leaves."""

    def of(self, posture: Posture, *, singular: bool = True) -> tuple[Clearance, ...]:
        """To every stroke end, where it lies in the plane at all; to the boundary of the
        constant-orientation workspace; and to the nearest parallel singularity. Where a stroke end
        is passed already its distance is negative: the way back.

        Returns:
            The nearest first. None for a posture that violates the constraint.
        """
        design = self.design
        pose = np.array(posture.pose)
        if abs(float(violation(design, pose))) > CONSTRAINT_SLACK:
            return ()
        angles = tuple(pose[3:].tolist())
        here = plane(design, angles)
        uv = here.coordinates(pose[:3])
        error = _EXACT * design.size
        found = _strokes(design, here, uv, posture, error)
        if posture.reachable:
            region = rings_section(rings(design, here), here.at)
            edge = nearest_point(region, uv)
            if edge is not None:
                point, k = edge
                limb = int(region.limb[k])
                bound = range_of(LIMITS, limb)[int(region.bound[k])]
                amount = float(np.linalg.norm(point - uv))
                text = f"{_far(amount)} the boundary of the workspace (limb {limb} at {bound.name})"
                found.append(
                    Clearance("boundary", amount, _xyz(here.place(point)), text, limb, bound, error)
                )
        a, b, c = angles
        near = nearest_singular(cubic(design, (a, b, c)), uv) if singular else None
        if near is not None:
            point, amount, blur = near
            text = f"{_far(amount)} a parallel singularity"
            found.append(
                Clearance("parallel", amount, _xyz(here.place(point)), text, error=error + blur)
            )
        return tuple(sorted(found, key=lambda clearance: clearance.distance))


def _strokes(
    design: FourSPSSPRDesign, here: Plane, uv: Array, posture: Posture, error: float
) -> list[Clearance]:
    answer = []
    found = rings(design, here)
    for i in range(LIMBS):
        away = uv - found.center[i]
        length = float(np.linalg.norm(away))
        unit = away / length if length > 0.0 else np.array([1.0, 0.0])
        for bound, radius in zip(
            range_of(LIMITS, i + 1), (found.inner[i], found.outer[i]), strict=True
        ):
            if not radius > 0.0:
                continue  # the plane does not meet this sphere
            beyond = any(r.limb == i + 1 and r.bound == bound for r in posture.reasons)
            amount = abs(length - float(radius)) * (-1.0 if beyond else 1.0)
            point = here.place(found.center[i] + radius * unit)
            text = f"{_far(amount)} the end of limb {i + 1}'s stroke ({bound.name})"
            answer.append(Clearance("stroke", amount, _xyz(point), text, i + 1, bound, error))
    return answer


def _far(amount: float) -> str:
    word = "mm to" if amount >= 0.0 else "mm beyond"
    return f"{abs(amount):.{digits(abs(amount))}f} {word}"


def _xyz(point: Array) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return (x, y, z)
