"""The 4-SPS + 1-SPR behind the interface that every mechanism shares."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.bounds import Bound
from kinematics.answers.drawings import Drawing
from kinematics.answers.motion import Wrenches
from kinematics.answers.solutions import Finding, Posture
from kinematics.arrays import Array, largest
from kinematics.mechanism import Coordinate, Facets, Mechanism
from kinematics.mechanisms.four_sps_spr import (
    constraint,
    dragging,
    drawing,
    findings,
    home,
    inverse,
    motion,
    statics,
)
from kinematics.mechanisms.four_sps_spr import design as designs
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign


class FourSPSSPR(Mechanism[FourSPSSPRDesign]):
    """Wang et al. (2017): x, y, z, α, β, γ under one constraint, moved by five legs l₁ … l₅."""

    kind = "four_sps_spr"
    title = "4-SPS + 1-SPR (5 DOF)"
    schema = designs.SCHEMA
    modes = inverse.MODES
    snap = inverse.SNAP
    bounds = inverse.LIMITS
    wrench_names = statics.NAMES
    facets: ClassVar = Facets(
        __package__,
        following="following:Following",
        forward="forward.assembly:Forward",
        measures="measures:Measures",
        singularities="singularities:Singularities",
        clearances="clearances:Clearances",
        paths="paths:Paths",
        regions="regions:Regions",
        solids="solids:Solids",
    )

    def findings(self) -> tuple[Finding, ...]:
        return findings.findings(self.design)

    def pose_coordinates(self) -> tuple[Coordinate, ...]:
        low, high = home.reach(self.design)
        turn = float(np.pi)
        return (
            *(Coordinate(k, k, "mm", low[n], high[n]) for n, k in enumerate("xyz")),
            Coordinate("alpha", "α", "rad", -turn, turn),
            Coordinate("beta", "β", "rad", -turn, turn),
            Coordinate("gamma", "γ", "rad", -turn, turn),
        )

    def joint_coordinates(self) -> tuple[Coordinate, ...]:
        return tuple(
            Coordinate(f"l{i + 1}", designs.JOINT_SYMBOLS[i], "mm", *limb.stroke, limb=i + 1)
            for i, limb in enumerate(self.design.limbs)
        )

    def dependent_coordinates(self) -> tuple[int, ...]:
        return tuple(range(inverse.POSE))

    def complete_pose(
        self,
        pose: Sequence[float],
        mode: str,
        moved: int | None = None,
        dependent: int | None = None,
    ) -> tuple[float, ...]:
        return constraint.complete_pose(self.design, pose, moved, dependent)

    def joints(self, poses: Array, mode: str) -> Array:
        return inverse.joints_of(self.design, poses)

    def margins(self, poses: Array, mode: str, joints: Array) -> Array:
        return inverse.margins(self.design, poses, joints)

    def residual(self, poses: Array, mode: str, joints: Array) -> Array:
        return largest(inverse.closure_residual(self.design, poses, joints))

    def why_not(self, bound: Bound, pose: Array, mode: str, amount: float) -> str:
        return inverse.why_not(amount) if bound.end == "link" else ""

    def home(self) -> Posture:
        return home.home(self.design)

    def transform(self, poses: ArrayLike, mode: str | Sequence[str] = "") -> Array:
        return inverse.transform(poses)

    def pose_from_transform(self, transform: ArrayLike, mode: str = "") -> tuple[float, ...]:
        return dragging.pose_from_transform(self.design, transform)

    def placement(self, poses: ArrayLike, mode: str) -> Array:
        return motion.placement(self.design, poses)

    def velocity_axes(self, poses: Array, mode: str) -> Array:
        return motion.velocity_axes(poses)

    def wrenches(self, placement: Array, mode: str) -> Wrenches:
        return statics.wrenches(self.design, placement)

    def drawing(self, posture: Posture) -> Drawing:
        return drawing.drawing(self.design, posture)

    @property
    def length(self) -> float:
        return self.design.length
