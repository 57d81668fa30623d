"""The 3-RPS and the 3-SPR behind the interface that every mechanism shares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.drawings import Drawing
from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.singularities import (
    AT,
    Clearance,
    Event,
    LocusCurves,
    LocusSpec,
    Measure,
    MicrTable,
    ModeChange,
    OrientationCircle,
    Profile,
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
from kinematics.errors import InputError
from kinematics.facets.bare import Bare
from kinematics.mechanism import (
    Coordinate,
    DesignField,
    Resolution,
    SolidRequest,
    SolidSpec,
    SurfaceKind,
)
from kinematics.mechanisms.tripods import (
    chart,
    circles,
    drawing,
    following,
    forward,
    home,
    inverse,
    loci,
    motion,
    paths,
    posing,
    profile,
    refreshing,
    wrenches,
)
from kinematics.mechanisms.tripods import clearances as room
from kinematics.mechanisms.tripods import design as designs
from kinematics.mechanisms.tripods import micr as inscribed
from kinematics.mechanisms.tripods import singularities as singularity
from kinematics.mechanisms.tripods import texts as about
from kinematics.mechanisms.tripods.design import Kind, TripodDesign
from kinematics.screws.spatial import Array

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid

SOLIDS = (
    SolidSpec(
        "workspace",
        "Orientations and altitudes within the strokes",
        "Workspace",
        of_present_mode=True,
    ),
    SolidSpec("aspects", "Aspects of the present mode", "Singularities", of_present_mode=True),
)


class Tripod(Bare):
    """Nayak et al. (2017): Z, tilt and azimuth moved by three limbs ρ₁ … ρ₃, in two modes."""

    modes = designs.MODES
    has_profile = True
    mode_noun = "operation mode"

    def __init__(self, kind: Kind, title: str) -> None:
        self.kind: Kind = kind
        self.title = title

    def about(self, topic: str) -> str:
        return about.about(self.kind, topic)

    # --- designs

    def read_design(self, table: Mapping[str, Any], *, origin: str, name: str) -> TripodDesign:
        return designs.design_from_table(table, kind=self.kind, origin=origin, name=name)

    def design_table(self, design: TripodDesign) -> dict[str, Any]:
        return designs.design_to_table(design)

    def design_fields(self, design: TripodDesign) -> tuple[DesignField, ...]:
        return designs.design_fields(design)

    def with_field(
        self, design: TripodDesign, path: tuple[str | int, ...], value: float
    ) -> TripodDesign:
        return designs.with_field(design, path, value)

    def findings(self, design: TripodDesign) -> tuple[Finding, ...]:
        return home.findings(design)

    def counterparts(self, design: TripodDesign) -> tuple[TripodDesign, ...]:
        """The other machine with the same radii and stroke."""
        other: Kind = "three_spr" if design.mechanism == "three_rps" else "three_rps"
        return (replace(design, mechanism=other, name=f"{design.name}-{other}"),)

    # --- coordinates

    def pose_coordinates(self, design: TripodDesign) -> tuple[Coordinate, ...]:
        reach, half_turn = home.reach(design), float(np.pi)
        return (
            Coordinate("z", "z", "mm", -reach, reach),
            Coordinate("tilt", "θ", "rad", 0.0, half_turn),
            Coordinate("azimuth", "φ", "rad", -half_turn, half_turn),
        )

    def joint_coordinates(self, design: TripodDesign) -> tuple[Coordinate, ...]:
        return tuple(
            Coordinate(f"rho{i + 1}", designs.JOINT_SYMBOLS[i], "mm", *design.stroke, limb=i + 1)
            for i in range(designs.LIMBS)
        )

    # --- kinematics

    def home(self, design: TripodDesign) -> Posture:
        return home.home(design)

    def posture(self, design: TripodDesign, pose: Sequence[float], mode: str) -> Posture:
        return inverse.posture(design, pose, mode)

    def inverse(self, design: TripodDesign, poses: ArrayLike) -> InverseSolutions:
        return inverse.inverse(design, poses)

    def follow(self, design: TripodDesign, posture: Posture, joints: Sequence[float]) -> Followed:
        return following.follow(design, posture, joints)

    def fold_ahead(
        self, design: TripodDesign, posture: Posture, joints: Sequence[float]
    ) -> Fold | None:
        return following.fold_ahead(design, posture, joints)

    def forward(
        self, design: TripodDesign, joints: ArrayLike, *, mixed_modes: bool = False
    ) -> tuple[ForwardSolutions, ...]:
        return forward.forward(design, joints)

    def refresh(
        self, design: TripodDesign, before: ForwardSolutions, joints: Sequence[float]
    ) -> Refreshed:
        return refreshing.refresh(design, before, joints)

    def transform(self, design: TripodDesign, poses: ArrayLike, mode: str | Sequence[str]) -> Array:
        return posing.transform(design, poses, mode)

    def pose_from_transform(
        self, design: TripodDesign, transform: ArrayLike, mode: str
    ) -> tuple[float, ...]:
        return posing.pose_from_transform(design, transform, mode)

    def drawing(self, design: TripodDesign, posture: Posture) -> Drawing:
        return drawing.drawing(design, posture)

    # --- motion and statics

    def characteristic_length(self, design: TripodDesign) -> float:
        return wrenches.characteristic_length(design)

    def inverse_motion(
        self,
        design: TripodDesign,
        poses: ArrayLike,
        mode: str,
        pose_rates: ArrayLike,
        pose_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.inverse_motion(design, poses, mode, pose_rates, pose_accelerations)

    def forward_motion(
        self,
        design: TripodDesign,
        poses: ArrayLike,
        mode: str,
        joint_rates: ArrayLike,
        joint_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.forward_motion(design, poses, mode, joint_rates, joint_accelerations)

    def wrench_system(self, design: TripodDesign, poses: ArrayLike, mode: str) -> WrenchSystem:
        return wrenches.wrench_system(design, poses, mode)

    def statics(
        self, design: TripodDesign, poses: ArrayLike, mode: str, loads: ArrayLike
    ) -> Statics:
        return wrenches.statics(design, poses, mode, loads)

    # --- how well a posture is held, and where it is not

    def measures(self, design: TripodDesign) -> tuple[Measure, ...]:
        return singularity.MEASURES

    def measure(
        self,
        design: TripodDesign,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        return singularity.measure(design, poses, mode, key, load)

    def singularities(
        self, design: TripodDesign, posture: Posture, tolerance: float = AT
    ) -> tuple[Singularity, ...]:
        return singularity.singularities(design, posture, tolerance)

    def clearances(
        self, design: TripodDesign, posture: Posture, *, singular: bool = True
    ) -> tuple[Clearance, ...]:
        return room.clearances(design, posture, singular=singular)

    def passed(self, design: TripodDesign, before: Posture, after: Posture) -> tuple[Event, ...]:
        return paths.passed(design, before, after)

    def path(self, design: TripodDesign, posture: Posture, poses: ArrayLike) -> Followed:
        return paths.path(design, posture, poses)

    def remedy(self, design: TripodDesign, posture: Posture) -> Remedy:
        return room.remedy(design, posture)

    def mode_change(self, design: TripodDesign, posture: Posture, wanted: str = "") -> ModeChange:
        return singularity.mode_change(design, posture)

    def locus_specs(self, design: TripodDesign) -> tuple[LocusSpec, ...]:
        return loci.LOCI

    def locus(
        self,
        design: TripodDesign,
        key: str,
        pose: Sequence[float],
        mode: str,
        at: float | None = None,
    ) -> LocusCurves:
        return loci.locus(design, key, float(pose[0]), mode)

    def circles(
        self, design: TripodDesign, pose: Sequence[float], mode: str
    ) -> tuple[OrientationCircle, ...]:
        return circles.circles(design, tuple(pose), mode)

    def profile(
        self, design: TripodDesign, pose: Sequence[float], ratios: Sequence[float] = ()
    ) -> Profile:
        return profile.profile(design, float(pose[0]), ratios)

    def profile_place(self, design: TripodDesign, pose: Sequence[float]) -> float:
        return abs(float(pose[0])) / design.base_radius

    def micr(self, base: ArrayLike, platform: ArrayLike, altitude: ArrayLike) -> MicrTable:
        return inscribed.table(self.kind, base, platform, altitude)

    # --- solids

    def solids(self, design: TripodDesign) -> tuple[SolidSpec, ...]:
        return SOLIDS

    def solid_request(
        self,
        design: TripodDesign,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        resolution: Resolution,
        surface: SurfaceKind = "facets",
    ) -> SolidRequest:
        if key not in {spec.key for spec in SOLIDS}:
            known = ", ".join(spec.key for spec in SOLIDS)
            raise InputError(f"there is no solid {key!r}; known are {known}")
        if modes is None or len(modes) != 1:
            raise InputError(f"the {key} is that of one operation mode; choose one")
        sizes = (design.base_radius, design.platform_radius, design.stroke)
        return SolidRequest(self.kind, (key, *sizes, modes[0]), resolution)

    def solid_placement(self, design: TripodDesign, key: str, pose: Sequence[float]) -> Array:
        """The charts stand upright on the base's centre."""
        return np.eye(4)

    def solid_point(
        self, design: TripodDesign, key: str, pose: Sequence[float], mode: str
    ) -> Array:
        """The chart's place of the pose, see `workspace`."""
        return chart.to_chart(design, np.asarray(pose, dtype=float))

    def solid_poses(
        self, design: TripodDesign, key: str, pose: Sequence[float], mode: str, points: ArrayLike
    ) -> Array:
        """The poses of the chart: a solid is of all of them, whatever the pose."""
        return chart.from_chart(design, np.asarray(points, dtype=float))

    def build_solid(self, request: SolidRequest) -> BuiltSolid:
        from kinematics.mechanisms.tripods import workspace

        key, base, platform, stroke, mode = request.arguments
        design = TripodDesign(self.kind, base, platform, stroke)
        build = workspace.aspects if key == "aspects" else workspace.workspace
        return build(design, mode, request.resolution)

    def inside(
        self, design: TripodDesign, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> bool:
        return bool(inverse.inside(design, pose, modes))


THREE_RPS = Tripod("three_rps", "3-RPS (one translation, two rotations)")
THREE_SPR = Tripod("three_spr", "3-SPR (one translation, two rotations)")
