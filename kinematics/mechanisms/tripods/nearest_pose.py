"""The ways out of a pose of a 3-RPS or 3-SPR that cannot be held."""

from __future__ import annotations

import numpy as np

from kinematics.answers.solutions import Posture
from kinematics.facets.clearances import ClearancesFacet, Nearest
from kinematics.facets.inverse import posture as posture_at
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import LIMBS, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.limbs import offsets
from kinematics.mechanisms.tripods.posing import Reduced
from kinematics.mechanisms.tripods.study import translation

_EXACT = 1e-9  # of the machine's size


class NearestPose(ClearancesFacet[TripodDesign]):
    """Exact along the straight line that the orientation leaves, searched for at others."""

    def nearest(self, posture: Posture, modes: tuple[str, ...]) -> tuple[Nearest | None, str]:
        """At the orientation the nearest altitude is exact; if there is none, the nearest
        orientation at the same altitude is searched for.
        """
        design = self.design
        straight = _nearest_altitude(design, posture) if posture.closes else None
        if straight is not None:
            altitude = straight.posture.pose[0]
            return straight, f"The nearest altitude at this orientation is Z = {altitude:.2f} mm."
        turned = self.searched(posture, (posture.mode,), (1, 2))
        if turned is None:
            return None, (
                "No altitude at this orientation and no orientation at this altitude is within the "
                "strokes."
            )
        here, there = (
            posing.positions(design, np.array(p.pose), p.mode) for p in (posture, turned)
        )
        _, tilt, azimuth = np.degrees(turned.pose)
        return Nearest(turned, float(np.linalg.norm(there - here)), float("inf")), (
            f"The nearest orientation found at this altitude is a tilt of {tilt:.2f}° about the "
            f"azimuth {azimuth:.2f}°."
        )


def _nearest_altitude(design: TripodDesign, posture: Posture) -> Nearest | None:
    """The nearest v at which all limbs are within their strokes: intervals, intersected."""
    pose = np.array(posture.pose)
    reduced = posing.reduce_poses(design, pose, posture.mode)
    h, k = design.revolute_radius, mode_sign(posture.mode) * design.spherical_radius
    outward, upward = offsets(h, k, reduced)
    v = float(reduced.v)
    lift = np.asarray(upward) - v
    low, high = design.stroke
    allowed = [(-np.inf, np.inf)]
    for i in range(LIMBS):
        far = high**2 - float(outward[i]) ** 2
        if far < 0.0:
            return None
        top, bottom = np.sqrt(far), np.sqrt(max(low**2 - float(outward[i]) ** 2, 0.0))
        own = [(-top - lift[i], -bottom - lift[i]), (bottom - lift[i], top - lift[i])]
        allowed = [
            (max(a, c), min(b, d)) for a, b in allowed for c, d in own if max(a, c) <= min(b, d)
        ]
    if not allowed:
        return None
    # A hair inside, so that rounding does not put the posture beyond an end again.
    inside = [
        float(np.clip(v, a, b)) if b - a < 2e-9 else float(np.clip(v, a + 1e-9, b - 1e-9))
        for a, b in allowed
    ]
    best = min(inside, key=lambda value: abs(value - v))
    z = place(design, reduced, best, posture.mode)[2]
    found = posture_at(design, (z, *posture.pose[1:]), posture.mode)
    return Nearest(found, abs(best - v), _EXACT * design.size) if found.reachable else None


def place(
    design: TripodDesign, reduced: Reduced, v: float, mode: str
) -> tuple[float, float, float]:
    there = reduced._replace(v=np.array(v))
    x, y, z = translation(posing.to_study(design, there, mode)).tolist()
    return x, y, z
