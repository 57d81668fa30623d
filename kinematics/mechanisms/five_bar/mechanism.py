"""The planar five-bar behind the interface that every mechanism shares."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.bounds import Bound
from kinematics.answers.drawings import Drawing
from kinematics.answers.motion import Wrenches
from kinematics.answers.solutions import Finding, Posture
from kinematics.arrays import Array, largest
from kinematics.mechanism import Coordinate, Facets, Mechanism
from kinematics.mechanisms.five_bar import design as designs
from kinematics.mechanisms.five_bar import (
    drawing,
    home,
    inverse,
    motion,
    statics,
)
from kinematics.mechanisms.five_bar import findings as remarks
from kinematics.mechanisms.five_bar.design import FiveBarDesign


class FiveBar(Mechanism[FiveBarDesign]):
    """Sosa-López et al. (2017): P = (x, y) moved by two driven angles θ₁, θ₂."""

    kind = "five_bar"
    title = "Five-bar (planar 5R)"
    schema = designs.SCHEMA
    modes = inverse.MODES
    snap = inf  # angles that are known are taken as they are, also where a limb is stretched
    bounds = inverse.LIMITS
    wrench_names = statics.NAMES
    facets: ClassVar = Facets(
        __package__,
        following="following:Following",
        forward="forward:Forward",
        statics="statics:Statics",
        measures="measures:Measures",
        singularities="singularities:Singularities",
        clearances="clearances:Clearances",
        paths="paths:Paths",
        regions="regions:Regions",
    )

    def findings(self) -> tuple[Finding, ...]:
        return remarks.findings(self.design)

    def pose_coordinates(self) -> tuple[Coordinate, ...]:
        low, high = home.reach(self.design)
        return tuple(Coordinate(k, k, "mm", low[n], high[n]) for n, k in enumerate("xy"))

    def joint_coordinates(self) -> tuple[Coordinate, ...]:
        found = []
        for i, (low, high) in enumerate(self.design.joint_range.tolist()):
            free = bool(np.isinf(low))
            if free:
                low, high = -float(np.pi), float(np.pi)
            key, symbol = f"theta{i + 1}", f"θ{designs.SUBSCRIPTS[i]}"
            found.append(Coordinate(key, symbol, "rad", low, high, limb=i + 1, free=free))
        return tuple(found)

    def joints(self, poses: Array, mode: str) -> Array:
        return inverse.joints_of(self.design, poses, mode)

    def joints_in(self, poses: Array, modes: Sequence[str]) -> Array:
        return inverse.joints_in(self.design, poses, modes)

    def margins(self, poses: Array, mode: str, joints: Array) -> Array:
        return inverse.margins(self.design, poses, joints)

    def residual(self, poses: Array, mode: str, joints: Array) -> Array:
        return largest(inverse.closure_residual(self.design, poses, joints))

    def why_not(self, bound: Bound, pose: Array, mode: str, amount: float) -> str:
        return inverse.why_not(self.design, bound, pose, amount) if bound.end == "link" else ""

    def home(self) -> Posture:
        return home.home(self.design)

    def transform(self, poses: ArrayLike, mode: str | Sequence[str] = "") -> Array:
        return inverse.transform(poses)

    def pose_from_transform(self, transform: ArrayLike, mode: str = "") -> tuple[float, ...]:
        return inverse.pose_from_transform(transform)

    def velocity_axes(self, poses: Array, mode: str) -> Array:
        return motion.velocity_axes(poses)

    def wrenches(self, placement: Array, mode: str) -> Wrenches:
        return statics.wrenches(self.design, placement, mode)

    @property
    def largest_gain(self) -> Array:
        return self.design.proximal

    def bias(self, placement: Array, mode: str, velocity: Array, joint_rates: Array) -> Array:
        return motion.bias(self.design, placement, mode, velocity, joint_rates)

    def drawing(self, posture: Posture) -> Drawing:
        return drawing.drawing(self.design, posture)

    @property
    def length(self) -> float:
        return float(self.design.proximal.mean())
