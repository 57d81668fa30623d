"""Singular places of the 4-SPS + 1-SPR at an orientation.

There is no constraint singularity proper: the one constraint is a unit force.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.answers.loci import LocusCurve, LocusCurves, LocusSpec
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.plane import Plane, plane, rings
from kinematics.mechanisms.four_sps_spr.singular_curve import cubic, traced

PLANE = "plane"
LOCI = (
    LocusSpec(
        PLANE,
        "Singular places at this orientation, in the plane of the constraint",
        ("u", "v"),
        ("mm", "mm"),
    ),
)


class Singularities(SingularitiesFacet[FourSPSSPRDesign]):
    """With the cubic curve in the plane of the constraint."""

    loci = LOCI

    def locus(
        self, key: str, pose: Sequence[float], mode: str, at: float | None = None
    ) -> LocusCurves:
        """The cubic curve of parallel singularities at the pose's orientation, where p can reach.

        Raises:
            InputError: there is no such chart.
        """
        design = self.design
        if key != PLANE:
            raise InputError(f"there is no chart {key!r}; known is {PLANE}")
        a, b, c = (float(v) for v in pose[3:])
        here = plane(design, (a, b, c))
        curve = cubic(design, (a, b, c))
        low, high = bounds(design, here)
        found = traced(curve, low, high)
        parts = np.split(found.points, found.start[1:-1])
        curves = [LocusCurve(part, curve.distance(part)) for part in parts if len(part)]
        return LocusCurves.of(curves, np.stack([low, high], axis=1))


def bounds(design: FourSPSSPRDesign, here: Plane) -> tuple[Array, Array]:
    """A box of the plane in which all legs may reach: the lowest and highest (u, v), mm."""
    found = rings(design, here)
    radius = np.where(found.outer > 0.0, found.outer, design.stroke[:, 1])[:, None]
    low, high = (found.center - radius).max(axis=0), (found.center + radius).min(axis=0)
    apart = low >= high
    low = np.where(apart, (found.center - radius).min(axis=0), low)
    high = np.where(apart, (found.center + radius).max(axis=0), high)
    margin = 0.05 * (high - low)
    return low - margin, high + margin
