"""How far a posture of the 3-RPS or 3-SPR is from what ends its motion, and the ways out.

Two measures, both in mm. At the pose's orientation O′ has one freedom left, a straight line: along
z (3-RPS) or along the platform's normal (3-SPR); distances on it are exact. At the pose's altitude
the platform may turn: the angle to the limit, times the platform's radius h2, which is about how
far its joints go.
"""

from __future__ import annotations

import numpy as np

from kinematics.answers.bounds import named, range_of
from kinematics.answers.clearances import Clearance
from kinematics.answers.solutions import Posture
from kinematics.mechanisms.tripods import polynomial, posing
from kinematics.mechanisms.tripods.circles import circles
from kinematics.mechanisms.tripods.design import LIMBS, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.inverse import LIMITS
from kinematics.mechanisms.tripods.limbs import offsets
from kinematics.mechanisms.tripods.nearest_pose import NearestPose, place
from kinematics.mechanisms.tripods.posing import Reduced
from kinematics.mechanisms.tripods.powers import Power

_EXACT = 1e-9  # of the machine's size


class Clearances(NearestPose):
    """Along a line, and by turning."""

    def to_bounds(self, posture: Posture) -> list[Clearance]:
        """To stroke ends and parallel singularities at the orientation, which are exact."""
        return _along(self.design, posture) if posture.closes else []

    def to_singularities(self, posture: Posture) -> list[Clearance]:
        """To singularities and stroke ends by turning at the altitude, which are searched for."""
        return _turning(self.design, posture) if posture.closes else []


def _along(design: TripodDesign, posture: Posture) -> list[Clearance]:
    """Along the straight line that the orientation leaves."""
    pose = np.array(posture.pose)
    reduced = posing.reduce_poses(design, pose, posture.mode)
    v = float(reduced.v)
    h, k = design.revolute_radius, mode_sign(posture.mode) * design.spherical_radius
    outward, upward = offsets(h, k, reduced)
    error = _EXACT * design.size
    what = "along z" if design.revolute_on_base else "along the platform's normal"
    found = []
    singular = _singular_altitudes(h, k, reduced)
    for value in sorted(singular, key=lambda value: abs(value - v))[:1]:
        amount = abs(value - v)
        text = f"{amount:.2f} mm {what} to a parallel singularity"
        point = place(design, reduced, value, posture.mode)
        found.append(Clearance("parallel", amount, point, text, error=error, along=what))
    for i in range(LIMBS):
        for bound, end in zip(range_of(LIMITS, i + 1), design.stroke, strict=True):
            if end <= abs(outward[i]):
                continue  # the line does not meet this end
            rise = float(np.sqrt(end**2 - outward[i] ** 2))
            ways = [sign * rise - float(upward[i]) for sign in (1.0, -1.0)]
            way = min(ways, key=abs)
            beyond = any(r.limb == i + 1 and r.bound == bound for r in posture.reasons)
            amount = -abs(way) if beyond else abs(way)
            word = "beyond" if beyond else "to"
            text = (
                f"{abs(way):.2f} mm {what} {word} the end of limb {i + 1}'s stroke ({bound.name})"
            )
            point = place(design, reduced, v + way, posture.mode)
            found.append(Clearance("stroke", amount, point, text, i + 1, bound, error, along=what))
    return found


def _singular_altitudes(h: float, k: float, reduced: Reduced) -> list[float]:
    """The altitudes v at which the reduced pose is singular: roots of a cubic."""
    x0, x1, x2, _ = (float(part) for part in reduced)
    q = x1 * x1 + x2 * x2
    cube = 3.0 * x1 * x1 * x2 - x2**3
    unit = abs(k)
    a0, a1, a2, _ = polynomial.terms("three_rps", h / unit, k / unit, Power.unknown(), q)
    p = a0 * x0 + a1 * cube + a2 * (x0 * cube * cube)
    roots = p.roots()
    real = roots[np.abs(roots.imag) <= 1e-9 * (1.0 + np.abs(roots))].real
    return [unit * float(root) for root in real]


def _turning(design: TripodDesign, posture: Posture) -> list[Clearance]:
    """By the circles about the orientation."""
    z, _, _ = posture.pose
    found = []
    for circle in circles(design, posture.pose, posture.mode):
        if not circle.contacts:
            continue
        if circle.limit == "stroke" and not posture.reachable:
            continue
        tilt, azimuth = circle.contacts[0]
        there = np.array([z, tilt, azimuth])
        x, y, _ = posing.positions(design, there, posture.mode).tolist()
        what = {
            "parallel": "a parallel singularity",
            "constraint": "the constraint singularity at a tilt of 180°",
            "stroke": f"the end of limb {circle.limb}'s stroke ({named(circle.bound)})",
        }[circle.limit]
        text = (
            f"{np.degrees(circle.radius):.2f}° of turning at this altitude to {what} (about "
            f"{circle.radius * design.platform_radius:.2f} mm at the platform's joints)"
        )
        found.append(
            Clearance(
                circle.limit,
                circle.radius * design.platform_radius,
                (x, y, z),
                text,
                circle.limb,
                circle.bound,
                circle.error * design.platform_radius,
                angle=circle.radius,
            )
        )
    return found
