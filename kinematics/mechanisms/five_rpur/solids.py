"""Solids of the 5-RPUR: the constant-orientation workspace, its aspects, the vertex spaces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kinematics.arrays import Array
from kinematics.facets.solids import SURFACES, SolidRequest, SolidsFacet, SolidSpec, SurfaceKind
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inverse import chosen
from kinematics.screws.spatial import homogeneous, rotation_x, rotation_y

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid

_PARTS = {
    "whole": ("vertex space", "Fig. 13"),
    "plus": ("half of mode +", ""),
    "minus": ("half of mode −", ""),
    "body": ("main body", "Fig. 12"),
    "H1": ("hole H₁", "Fig. 9"),
    "H2": ("hole H₂", "Fig. 10"),
    "H3": ("hole H₃", "Fig. 11"),
}
_SPECS = (
    SolidSpec(
        "workspace",
        "Constant-orientation workspace",
        "Workspace",
        figure="Figs. 14, 15, 18",
        uses_modes=True,
        surfaces=SURFACES,
    ),
    SolidSpec("aspects", "Aspects of the present mode", "Singularities", of_present_mode=True),
    *(
        SolidSpec(f"limb{i}/{part}", f"Limb {i}: {title}", f"Limb {i}", limb=i, figure=figure)
        for i in range(1, LIMBS + 1)
        for part, (title, figure) in _PARTS.items()
    ),
)


class Solids(SolidsFacet[FiveRPURDesign]):
    """The workspace and the aspects are built in x'y'z' (paper, section 4), a vertex space too but
    about A_i, to be offset by w'_i (eq. 27).
    """

    specs = _SPECS
    known = (
        "it is 'workspace', 'aspects' or 'limbN/PART' with N from 1 to 5 and PART one of "
        f"{', '.join(_PARTS)}"
    )

    def arguments(
        self,
        spec: SolidSpec,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        surface: SurfaceKind,
    ) -> tuple[Any, ...]:
        if spec.limb is not None:
            limb = self.design.limbs[spec.limb - 1]
            return "part", limb.link, *limb.stroke, spec.key.partition("/")[2]
        orientation, wanted = (float(pose[3]), float(pose[4])), chosen(self.design, modes)
        last = (wanted, surface) if spec.uses_modes else wanted
        return (spec.key, self.design.limbs, *orientation, *(last or ()))

    def placement(self, key: str, pose: Sequence[float]) -> Array:
        phi, theta = float(pose[3]), float(pose[4])
        turned = rotation_y(theta)
        offset, limb = np.zeros(3), self.spec(key).limb
        if limb is not None:
            i = limb - 1
            offset = self.design.base[i] - turned @ rotation_x(phi) @ self.design.platform[i]
        return homogeneous(turned, offset)

    @staticmethod
    def build(request: SolidRequest) -> BuiltSolid:
        from kinematics.mechanisms.five_rpur.singularities.aspects import aspects
        from kinematics.mechanisms.five_rpur.workspace.workspace import limb_part, workspace

        what, *arguments = request.arguments
        if what == "workspace":
            limbs, phi, theta, modes, surface = arguments
            return workspace(FiveRPURDesign(limbs), phi, theta, modes, request.resolution, surface)
        if what == "aspects":
            limbs, phi, theta, mode = arguments
            return aspects(FiveRPURDesign(limbs), phi, theta, mode, request.resolution)
        link, low, high, part = arguments
        zero = (0.0, 0.0, 0.0)
        limb = Limb(zero, zero, link, (low, high))
        alone = FiveRPURDesign((limb, limb, limb, limb, limb))
        return limb_part(alone, 1, part, request.resolution)
