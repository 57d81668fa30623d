"""Solids of the tripods: the poses of an operation mode within the strokes, and its aspects.

Poses are drawn as places: (Z, θ, φ) at (h2 θ cos φ, h2 θ sin φ, Z), so that up is the altitude,
outwards the tilt, one radian as long as the platform's circumradius.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.facets.solids import SolidRequest, SolidsFacet, SolidSpec, SurfaceKind
from kinematics.mechanisms.tripods import chart
from kinematics.mechanisms.tripods.design import TripodDesign

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid


class Solids(SolidsFacet[TripodDesign]):
    """The charts stand upright on the base's centre; each is of all poses, whatever the present."""

    specs = (
        SolidSpec(
            "workspace",
            "Orientations and altitudes within the strokes",
            "Workspace",
            of_present_mode=True,
            places=False,
        ),
        SolidSpec(
            "aspects",
            "Aspects of the present mode",
            "Singularities",
            of_present_mode=True,
            places=False,
        ),
    )

    def arguments(
        self,
        spec: SolidSpec,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        surface: SurfaceKind,
    ) -> tuple[Any, ...]:
        sizes = (self.design.base_radius, self.design.platform_radius, self.design.stroke)
        return (spec.key, *sizes, *(modes or ()))

    def point(self, key: str, pose: ArrayLike, mode: str) -> Array:
        return chart.to_chart(self.design, np.asarray(pose, dtype=float))

    def poses(self, key: str, pose: Sequence[float], mode: str, points: ArrayLike) -> Array:
        return chart.from_chart(self.design, np.asarray(points, dtype=float))

    @staticmethod
    def build(request: SolidRequest) -> BuiltSolid:
        from kinematics.mechanisms.tripods import workspace

        key, base, platform, stroke, mode = request.arguments
        design = TripodDesign(request.mechanism, base, platform, stroke)  # type: ignore[arg-type]
        build = workspace.aspects if key == "aspects" else workspace.workspace
        return build(design, mode, request.resolution)
