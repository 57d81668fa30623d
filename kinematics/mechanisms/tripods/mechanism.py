"""The 3-RPS and the 3-SPR behind the interface that every mechanism shares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.bounds import Bound
from kinematics.answers.drawings import Drawing
from kinematics.answers.motion import Wrenches
from kinematics.answers.solutions import Finding, Posture
from kinematics.arrays import Array, largest
from kinematics.mechanism import Coordinate, Facets, Mechanism
from kinematics.mechanisms.tripods import design as designs
from kinematics.mechanisms.tripods import (
    drawing,
    home,
    inverse,
    motion,
    posing,
    statics,
)
from kinematics.mechanisms.tripods.design import Kind, TripodDesign
from kinematics.mechanisms.tripods.limbs import limb_lengths


class Tripod(Mechanism[TripodDesign]):
    """Nayak et al. (2017): Z, tilt and azimuth moved by three limbs ρ₁ … ρ₃, in two modes."""

    kind: ClassVar[Kind]
    schema = designs.SCHEMA
    modes = designs.MODES
    bounds = inverse.LIMITS
    wrench_names = statics.NAMES
    facets: ClassVar = Facets(
        __package__,
        following="following:Following",
        forward="forward:Forward",
        measures="measures:Measures",
        singularities="singularities:Singularities",
        clearances="clearances:Clearances",
        paths="paths:Paths",
        circles="circles:Circles",
        solids="solids:Solids",
    )

    def findings(self) -> tuple[Finding, ...]:
        return home.findings(self.design)

    def counterparts(self) -> tuple[TripodDesign, ...]:
        """The other machine with the same radii and stroke."""
        other: Kind = "three_spr" if self.design.mechanism == "three_rps" else "three_rps"
        return (replace(self.design, mechanism=other, name=f"{self.design.name}-{other}"),)

    def pose_coordinates(self) -> tuple[Coordinate, ...]:
        reach, half_turn = home.reach(self.design), float(np.pi)
        return (
            Coordinate("z", "z", "mm", -reach, reach),
            Coordinate("tilt", "θ", "rad", 0.0, half_turn),
            Coordinate("azimuth", "φ", "rad", -half_turn, half_turn),
        )

    def joint_coordinates(self) -> tuple[Coordinate, ...]:
        return tuple(
            Coordinate(
                f"rho{i + 1}", designs.JOINT_SYMBOLS[i], "mm", *self.design.stroke, limb=i + 1
            )
            for i in range(designs.LIMBS)
        )

    def joints(self, poses: Array, mode: str) -> Array:
        return limb_lengths(self.design, posing.read_poses(poses), mode)

    def margins(self, poses: Array, mode: str, joints: Array) -> Array:
        return inverse.margins(self.design, joints)

    def residual(self, poses: Array, mode: str, joints: Array) -> Array:
        return largest(inverse.closure_residual(self.design, poses, mode, joints))

    def why_not(self, bound: Bound, pose: Array, mode: str, amount: float) -> str:
        return inverse.why_not(bound, amount)

    def home(self) -> Posture:
        return home.home(self.design)

    def transform(self, poses: ArrayLike, mode: str | Sequence[str]) -> Array:
        return posing.transform(self.design, poses, mode)

    def pose_from_transform(self, transform: ArrayLike, mode: str) -> tuple[float, ...]:
        return posing.pose_from_transform(self.design, transform, mode)

    def placement(self, poses: ArrayLike, mode: str) -> Array:
        return posing.placement(self.design, poses, mode)

    def velocity_axes(self, poses: Array, mode: str) -> Array:
        return motion.velocity_axes(self.design, poses, mode)

    def wrenches(self, placement: Array, mode: str) -> Wrenches:
        return statics.wrenches(self.design, placement)

    def drawing(self, posture: Posture) -> Drawing:
        return drawing.drawing(self.design, posture)

    @property
    def length(self) -> float:
        return self.design.platform_radius


class ThreeRPS(Tripod):
    """The 3-RPS."""

    kind = "three_rps"
    title = "3-RPS (one translation, two rotations)"


class ThreeSPR(Tripod):
    """The 3-SPR."""

    kind = "three_spr"
    title = "3-SPR (one translation, two rotations)"
