"""Solids of the 4-SPS + 1-SPR: the workspace with one angle following from the constraint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.facets.solids import SolidRequest, SolidsFacet, SolidSpec, SurfaceKind
from kinematics.mechanisms.four_sps_spr import constraint, workspace
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid


class Solids(SolidsFacet[FourSPSSPRDesign]):
    """One for each angle that may follow; they are built in the base frame."""

    specs = tuple(
        SolidSpec(
            f"workspace/{key}",
            f"Workspace, {symbol} following from the constraint",
            "Workspace",
            follows=3 + n,
        )
        for n, (key, symbol) in enumerate((("alpha", "α"), ("beta", "β"), ("gamma", "γ")))
    )

    def arguments(
        self,
        spec: SolidSpec,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        surface: SurfaceKind,
    ) -> tuple[Any, ...]:
        what = workspace.request_at(self.design, tuple(pose), self._follows(spec.key))
        return self.design.limbs, self.design.revolute_axis, what

    def branch(self, key: str, pose: Sequence[float]) -> tuple[float, ...]:
        return workspace.branch_at(self.design, tuple(pose), self._follows(key))[1]

    def poses(self, key: str, pose: Sequence[float], mode: str, points: ArrayLike) -> Array:
        """With the angle that follows, on the solid's branch."""
        index = self._follows(key)
        side, _ = workspace.branch_at(self.design, tuple(pose), index)
        poses = super().poses(key, pose, mode, points)
        poses[:, index] = constraint.dependent_values(self.design, poses, index)[:, (side + 1) // 2]
        return poses

    def _follows(self, key: str) -> int:
        follows = self.spec(key).follows
        assert follows is not None
        return follows

    @staticmethod
    def build(request: SolidRequest) -> BuiltSolid:
        limbs, axis, what = request.arguments
        return workspace.build(FourSPSSPRDesign(limbs, axis), what, request.resolution)
