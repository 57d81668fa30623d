"""The 5-RPUR behind the interface that every mechanism shares."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.bounds import Bound
from kinematics.answers.drawings import Drawing
from kinematics.answers.modes import Mode
from kinematics.answers.motion import Wrenches
from kinematics.answers.solutions import Finding, Posture
from kinematics.arrays import Array, largest
from kinematics.mechanism import Coordinate, Facets, Mechanism
from kinematics.mechanisms.five_rpur import design as designs
from kinematics.mechanisms.five_rpur import (
    dragging,
    drawing,
    findings,
    home,
    inverse,
    motion,
    statics,
)
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.slicing import cutter


class FiveRPUR(Mechanism[FiveRPURDesign]):
    """Tale Masouleh et al. (2011): x, y, z, φ, θ moved by five actuators ρ₁ … ρ₅."""

    kind = "five_rpur"
    title = "5-RPUR (3T2R)"
    schema = designs.SCHEMA
    modes = designs.MODES
    snap = inverse.SNAP
    bounds = inverse.LIMITS
    wrench_names = statics.NAMES
    facets: ClassVar = Facets(
        __package__,
        inverse="inverse:RPURInverse",
        following="following:Following",
        forward="forward.refreshing:Forward",
        singularities="singularities.kinds:Singularities",
        clearances="clearances:Clearances",
        paths="paths:Paths",
        measures="measures:Measures",
        solids="solids:Solids",
        sections="sections:Sections",
        maps="maps:Maps",
    )

    def __init__(self, design: FiveRPURDesign) -> None:
        super().__init__(design)
        self.modes = design.modes

    def mode(self, text: str) -> Mode:
        inverse.signs(text, self.design)  # what is said of a mode that merged joints exclude
        return super().mode(text)

    def findings(self) -> tuple[Finding, ...]:
        return findings.findings(self.design)

    def pose_coordinates(self) -> tuple[Coordinate, ...]:
        low, high = home.reach(self.design)
        xyz = (Coordinate(k, k, "mm", low[n], high[n]) for n, k in enumerate("xyz"))
        half_turn = float(np.pi)
        return (
            *xyz,
            Coordinate("phi", "φ", "rad", -half_turn, half_turn),
            Coordinate("theta", "θ", "rad", -half_turn, half_turn),
        )

    def joint_coordinates(self) -> tuple[Coordinate, ...]:
        return tuple(
            Coordinate(f"rho{i + 1}", f"ρ{designs.SUBSCRIPTS[i]}", "mm", *limb.stroke, limb=i + 1)
            for i, limb in enumerate(self.design.limbs)
        )

    def joints(self, poses: Array, mode: str) -> Array:
        return inverse.joints_of(self.design, poses, mode)

    def margins(self, poses: Array, mode: str, joints: Array) -> Array:
        return inverse.margins(self.design, poses, joints)

    def residual(self, poses: Array, mode: str, joints: Array) -> Array:
        return largest(inverse.closure_residual(self.design, poses, mode, joints))

    def why_not(self, bound: Bound, pose: Array, mode: str, amount: float) -> str:
        if bound.end != "link" or bound.limb is None:
            return ""
        return inverse.why_not(bound, self.design.limbs[bound.limb - 1].link, amount)

    def home(self) -> Posture:
        return home.home(self.design)

    def transform(self, poses: ArrayLike, mode: str | Sequence[str]) -> Array:
        return inverse.transform(poses)

    def pose_from_transform(self, transform: ArrayLike, mode: str) -> tuple[float, ...]:
        return tuple(float(v) for v in dragging.pose_from_transform(transform))

    def velocity_axes(self, poses: Array, mode: str) -> Array:
        return motion.velocity_axes(poses)

    def wrenches(self, placement: Array, mode: str) -> Wrenches:
        return statics.wrenches(self.design, placement, mode)

    def drawing(self, posture: Posture) -> Drawing:
        return drawing.drawing(self.design, posture)

    @property
    def length(self) -> float:
        return self.design.length

    @classmethod
    def prepare(cls) -> None:
        cutter.prepare(here=False)
