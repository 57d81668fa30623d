"""The planar five-bar behind the interface that every mechanism shares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.drawings import Drawing
from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.sections import Region, RegionSpec
from kinematics.answers.singularities import (
    AT,
    Clearance,
    Event,
    LocusCurves,
    LocusSpec,
    Measure,
    ModeChange,
    Remedy,
    Singularity,
)
from kinematics.answers.solutions import (
    Finding,
    Fold,
    Followed,
    ForwardSolutions,
    InverseSolutions,
    Posture,
    Refreshed,
)
from kinematics.facets.bare import Bare
from kinematics.mechanism import Coordinate, DesignField
from kinematics.mechanisms.five_bar import design as designs
from kinematics.mechanisms.five_bar import (
    drawing,
    following,
    forward,
    home,
    inverse,
    loci,
    mode_changes,
    motion,
    named_paths,
    paths,
    regions,
)
from kinematics.mechanisms.five_bar import findings as remarks
from kinematics.mechanisms.five_bar import singularities as control
from kinematics.mechanisms.five_bar import texts as about
from kinematics.mechanisms.five_bar.design import FiveBarDesign
from kinematics.screws.spatial import Array
from kinematics.trajectories import NamedTrajectory


class FiveBar(Bare):
    """Sosa-López et al. (2017): P = (x, y) moved by two driven angles θ₁, θ₂."""

    kind = "five_bar"
    title = "Five-bar (planar 5R)"
    modes = inverse.MODES

    def about(self, topic: str) -> str:
        return about.ABOUT.get(topic, "")

    # --- designs

    def read_design(self, table: Mapping[str, Any], *, origin: str, name: str) -> FiveBarDesign:
        return designs.design_from_table(table, origin=origin, name=name)

    def design_table(self, design: FiveBarDesign) -> dict[str, Any]:
        return designs.design_to_table(design)

    def design_fields(self, design: FiveBarDesign) -> tuple[DesignField, ...]:
        return designs.design_fields(design)

    def with_field(
        self, design: FiveBarDesign, path: tuple[str | int, ...], value: float
    ) -> FiveBarDesign:
        return designs.with_field(design, path, value)

    def findings(self, design: FiveBarDesign) -> tuple[Finding, ...]:
        return remarks.findings(design)

    # --- coordinates

    def pose_coordinates(self, design: FiveBarDesign) -> tuple[Coordinate, ...]:
        low, high = home.reach(design)
        return tuple(Coordinate(k, k, "mm", low[n], high[n]) for n, k in enumerate("xy"))

    def joint_coordinates(self, design: FiveBarDesign) -> tuple[Coordinate, ...]:
        found = []
        for i, (low, high) in enumerate(design.joint_range.tolist()):
            if bool(np.isinf(low)):
                low, high = -float(np.pi), float(np.pi)
            symbol = f"θ{designs.SUBSCRIPTS[i]}"
            found.append(Coordinate(f"theta{i + 1}", symbol, "rad", low, high, limb=i + 1))
        return tuple(found)

    # --- kinematics

    def home(self, design: FiveBarDesign) -> Posture:
        return home.home(design)

    def posture(self, design: FiveBarDesign, pose: Sequence[float], mode: str) -> Posture:
        return inverse.posture(design, pose, mode)

    def inverse(self, design: FiveBarDesign, poses: ArrayLike) -> InverseSolutions:
        return inverse.inverse(design, poses)

    def follow(self, design: FiveBarDesign, posture: Posture, joints: Sequence[float]) -> Followed:
        return following.follow(design, posture, joints)

    def fold_ahead(
        self, design: FiveBarDesign, posture: Posture, joints: Sequence[float]
    ) -> Fold | None:
        return following.fold_ahead(design, posture, joints)

    def forward(
        self, design: FiveBarDesign, joints: ArrayLike, *, mixed_modes: bool = False
    ) -> tuple[ForwardSolutions, ...]:
        return forward.forward(design, joints)

    def refresh(
        self, design: FiveBarDesign, before: ForwardSolutions, joints: Sequence[float]
    ) -> Refreshed:
        return forward.refresh(design, before, joints)

    def transform(
        self, design: FiveBarDesign, poses: ArrayLike, mode: str | Sequence[str] = ""
    ) -> Array:
        return inverse.transform(poses)

    def pose_from_transform(
        self, design: FiveBarDesign, transform: ArrayLike, mode: str = ""
    ) -> tuple[float, ...]:
        return inverse.pose_from_transform(transform)

    def drawing(self, design: FiveBarDesign, posture: Posture) -> Drawing:
        return drawing.drawing(design, posture)

    def inside(
        self, design: FiveBarDesign, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> bool:
        return bool(inverse.inside(design, pose, modes))

    # --- motion and statics

    def characteristic_length(self, design: FiveBarDesign) -> float:
        return motion.characteristic_length(design)

    def inverse_motion(
        self,
        design: FiveBarDesign,
        poses: ArrayLike,
        mode: str,
        pose_rates: ArrayLike,
        pose_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.inverse_motion(design, poses, mode, pose_rates, pose_accelerations)

    def forward_motion(
        self,
        design: FiveBarDesign,
        poses: ArrayLike,
        mode: str,
        joint_rates: ArrayLike,
        joint_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.forward_motion(design, poses, mode, joint_rates, joint_accelerations)

    def wrench_system(self, design: FiveBarDesign, poses: ArrayLike, mode: str) -> WrenchSystem:
        return motion.wrench_system(design, poses, mode)

    def statics(
        self, design: FiveBarDesign, poses: ArrayLike, mode: str, loads: ArrayLike
    ) -> Statics:
        return motion.statics(design, poses, mode, loads)

    # --- how well, and where not

    def measures(self, design: FiveBarDesign) -> tuple[Measure, ...]:
        return motion.MEASURES

    def measure(
        self,
        design: FiveBarDesign,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        return motion.measure(design, poses, mode, key, load)

    def singularities(
        self, design: FiveBarDesign, posture: Posture, tolerance: float = AT
    ) -> tuple[Singularity, ...]:
        return control.singularities(design, posture, tolerance)

    def clearances(
        self, design: FiveBarDesign, posture: Posture, *, singular: bool = True
    ) -> tuple[Clearance, ...]:
        return control.clearances(design, posture, singular=singular)

    def remedy(self, design: FiveBarDesign, posture: Posture) -> Remedy:
        return control.remedy(design, posture)

    def passed(
        self,
        design: FiveBarDesign,
        before: Posture,
        after: Posture,
        through: ArrayLike = (),
    ) -> tuple[Event, ...]:
        return paths.passed(design, before, after, through)

    def path(self, design: FiveBarDesign, posture: Posture, poses: ArrayLike) -> Followed:
        return paths.path(design, posture, poses)

    def mode_change(
        self, design: FiveBarDesign, posture: Posture, wanted: str = ""
    ) -> ModeChange | None:
        return mode_changes.mode_change(design, posture, wanted)

    def locus_specs(self, design: FiveBarDesign) -> tuple[LocusSpec, ...]:
        return loci.SPECS

    def locus(
        self,
        design: FiveBarDesign,
        key: str,
        pose: Sequence[float],
        mode: str,
        at: float | None = None,
    ) -> LocusCurves:
        return loci.locus(design, key, mode)

    # --- the plane

    def region_specs(self, design: FiveBarDesign) -> tuple[RegionSpec, ...]:
        return regions.SPECS

    def region_frame(self, design: FiveBarDesign, pose: Sequence[float]) -> Array:
        return regions.frame()

    def regions(
        self,
        design: FiveBarDesign,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
    ) -> tuple[Region, ...]:
        return regions.regions(design, key, modes)

    def trajectories(self, design: FiveBarDesign) -> tuple[NamedTrajectory, ...]:
        return named_paths.named(design)


MECHANISM = FiveBar()
