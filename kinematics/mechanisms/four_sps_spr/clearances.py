"""How far the platform of the 4-SPS + 1-SPR may move at its orientation until something happens."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinematics.answers.bounds import range_of
from kinematics.answers.clearances import Clearance
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.clearances import far, place, to_parallel, to_range_end
from kinematics.mechanisms.four_sps_spr.design import LIMBS
from kinematics.mechanisms.four_sps_spr.inverse import LIMITS
from kinematics.mechanisms.four_sps_spr.nearest_pose import NearestPose
from kinematics.mechanisms.four_sps_spr.plane import Plane, plane, rings
from kinematics.mechanisms.four_sps_spr.singular_curve import cubic, nearest_singular
from kinematics.plane.annuli import rings_section
from kinematics.plane.regions import nearest_point

_EXACT = 1e-9  # of the machine's size


class Clearances(NearestPose):
    """In the plane that the orientation leaves; none for a posture that violates the constraint."""

    def to_bounds(self, posture: Posture) -> Iterator[Clearance]:
        """To every stroke end, where it lies in the plane at all, and to the boundary of the
        constant-orientation workspace."""
        if not posture.closes:
            return
        design, (here, uv) = self.design, self._plane(posture)
        error, found = _EXACT * design.size, rings(design, here)
        for i in range(LIMBS):
            away = uv - found.center[i]
            length = float(np.linalg.norm(away))
            unit = away / length if length > 0.0 else np.array([1.0, 0.0])
            radii = found.inner[i], found.outer[i]
            for bound, radius in zip(range_of(LIMITS, i + 1), radii, strict=True):
                if not radius > 0.0:
                    continue  # the plane does not meet this sphere
                beyond = any(r.limb == i + 1 and r.bound == bound for r in posture.reasons)
                amount = abs(length - float(radius)) * (-1.0 if beyond else 1.0)
                yield to_range_end(
                    bound, amount, here.place(found.center[i] + radius * unit), error
                )
        if posture.reachable:
            region = rings_section(found, here.at)
            edge = nearest_point(region, uv)
            if edge is not None:
                point, k = edge
                limb = int(region.limb[k])
                bound = range_of(LIMITS, limb)[int(region.bound[k])]
                amount = float(np.linalg.norm(point - uv))
                text = f"{far(amount)} the boundary of the workspace (limb {limb} at {bound.name})"
                at = place(here.place(point))
                yield Clearance("boundary", amount, at, text, limb, bound, error)

    def to_singularities(self, posture: Posture) -> Iterator[Clearance]:
        if posture.closes:
            here, uv = self._plane(posture)
            a, b, c = posture.pose[3:]
            near = nearest_singular(cubic(self.design, (a, b, c)), uv)
            if near is not None:
                point, amount, blur = near
                yield to_parallel(amount, here.place(point), _EXACT * self.design.size + blur)

    def _plane(self, posture: Posture) -> tuple[Plane, Array]:
        """The plane, and the position (2,) in it."""
        here = plane(self.design, posture.pose[3:])
        return here, here.coordinates(np.array(posture.pose[:3]))
