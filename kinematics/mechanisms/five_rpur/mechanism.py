"""The 5-RPUR behind the interface that every mechanism shares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.drawings import Drawing
from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.sections import Box, MapCells, MapSpec, Section, SectionSpec, Sphere, Volume
from kinematics.answers.singularities import (
    AT,
    Clearance,
    Event,
    LocusCurves,
    LocusSpec,
    Measure,
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
    SURFACES,
    Coordinate,
    DesignField,
    Resolution,
    SolidRequest,
    SolidSpec,
    SurfaceKind,
)
from kinematics.mechanisms.five_rpur import (
    arrangements,
    drawing,
    home,
    inverse,
    maps,
    measures,
    motion,
    section,
    statics,
    velocity,
    volume,
)
from kinematics.mechanisms.five_rpur import clearances as room
from kinematics.mechanisms.five_rpur import design as designs
from kinematics.mechanisms.five_rpur import texts as about
from kinematics.mechanisms.five_rpur.continuation import following
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.forward import assembly, refreshing
from kinematics.mechanisms.five_rpur.inscribed import largest
from kinematics.mechanisms.five_rpur.nearest_pose import ways_in
from kinematics.mechanisms.five_rpur.paths import driving, events, nearness
from kinematics.mechanisms.five_rpur.singularities import ball, curves, kinds
from kinematics.mechanisms.five_rpur.slicing import acceleration
from kinematics.screws.spatial import Array, homogeneous, rotation_x, rotation_y

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


_ASPECTS = SolidSpec(
    "aspects", "Aspects of the present mode", "Singularities", of_present_mode=True
)


class FiveRPUR(Bare):
    """Tale Masouleh et al. (2011): x, y, z, φ, θ moved by five actuators ρ₁ … ρ₅."""

    kind = "five_rpur"
    title = "5-RPUR (3T2R)"
    modes = inverse.MODES

    def about(self, topic: str) -> str:
        return about.ABOUT.get(topic, "")

    # --- designs

    def read_design(self, table: Mapping[str, Any], *, origin: str, name: str) -> FiveRPURDesign:
        return designs.design_from_table(table, origin=origin, name=name)

    def design_table(self, design: FiveRPURDesign) -> dict[str, Any]:
        return designs.design_to_table(design)

    def design_fields(self, design: FiveRPURDesign) -> tuple[DesignField, ...]:
        return designs.design_fields(design)

    def with_field(
        self, design: FiveRPURDesign, path: tuple[str | int, ...], value: float
    ) -> FiveRPURDesign:
        return designs.with_field(design, path, value)

    def findings(self, design: FiveRPURDesign) -> tuple[Finding, ...]:
        return arrangements.findings(design)

    # --- coordinates

    def pose_coordinates(self, design: FiveRPURDesign) -> tuple[Coordinate, ...]:
        low, high = home.reach(design)
        xyz = (Coordinate(k, k, "mm", low[n], high[n]) for n, k in enumerate("xyz"))
        half_turn = float(np.pi)
        return (
            *xyz,
            Coordinate("phi", "φ", "rad", -half_turn, half_turn),
            Coordinate("theta", "θ", "rad", -half_turn, half_turn),
        )

    def joint_coordinates(self, design: FiveRPURDesign) -> tuple[Coordinate, ...]:
        return tuple(
            Coordinate(f"rho{i + 1}", f"ρ{designs.SUBSCRIPTS[i]}", "mm", *limb.stroke, limb=i + 1)
            for i, limb in enumerate(design.limbs)
        )

    # --- kinematics

    def home(self, design: FiveRPURDesign) -> Posture:
        return home.home(design)

    def posture(self, design: FiveRPURDesign, pose: Sequence[float], mode: str) -> Posture:
        return inverse.posture(design, pose, mode)

    def inverse(self, design: FiveRPURDesign, poses: ArrayLike) -> InverseSolutions:
        return inverse.inverse(design, poses)

    def follow(self, design: FiveRPURDesign, posture: Posture, joints: Sequence[float]) -> Followed:
        followed = following.follow(design, posture, joints)
        stopped = followed.stop == "singularity"
        return replace(
            followed, warning=nearness.warning(design, followed.posture, stopped=stopped)
        )

    def fold_ahead(
        self, design: FiveRPURDesign, posture: Posture, joints: Sequence[float]
    ) -> Fold | None:
        return following.fold_ahead(design, posture, joints)

    def forward(
        self, design: FiveRPURDesign, joints: ArrayLike, *, mixed_modes: bool = False
    ) -> tuple[ForwardSolutions, ...]:
        return assembly.forward(design, joints, mixed_modes=mixed_modes)

    def refresh(
        self, design: FiveRPURDesign, before: ForwardSolutions, joints: Sequence[float]
    ) -> Refreshed:
        return refreshing.refresh(design, before, joints)

    def forward_is_quick(self, design: FiveRPURDesign, *, mixed_modes: bool = False) -> bool:
        return assembly.forward_is_quick(design, mixed_modes=mixed_modes)

    def transform(
        self, design: FiveRPURDesign, poses: ArrayLike, mode: str | Sequence[str]
    ) -> Array:
        return inverse.transform(poses)

    def pose_from_transform(
        self, design: FiveRPURDesign, transform: ArrayLike, mode: str
    ) -> tuple[float, ...]:
        return tuple(float(v) for v in inverse.pose_from_transform(transform))

    def drawing(self, design: FiveRPURDesign, posture: Posture) -> Drawing:
        return drawing.drawing(design, posture)

    # --- motion and statics

    def characteristic_length(self, design: FiveRPURDesign) -> float:
        return velocity.characteristic_length(design)

    def inverse_motion(
        self,
        design: FiveRPURDesign,
        poses: ArrayLike,
        mode: str,
        pose_rates: ArrayLike,
        pose_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.inverse_motion(design, poses, mode, pose_rates, pose_accelerations)

    def forward_motion(
        self,
        design: FiveRPURDesign,
        poses: ArrayLike,
        mode: str,
        joint_rates: ArrayLike,
        joint_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.forward_motion(design, poses, mode, joint_rates, joint_accelerations)

    def wrench_system(self, design: FiveRPURDesign, poses: ArrayLike, mode: str) -> WrenchSystem:
        return statics.wrench_system(design, poses, mode)

    def statics(
        self, design: FiveRPURDesign, poses: ArrayLike, mode: str, loads: ArrayLike
    ) -> Statics:
        return statics.statics(design, poses, mode, loads)

    def singularities(
        self, design: FiveRPURDesign, posture: Posture, tolerance: float = AT
    ) -> tuple[Singularity, ...]:
        return kinds.singularities(design, posture, tolerance)

    # --- how far to the bounds, and the ways out

    def clearances(
        self, design: FiveRPURDesign, posture: Posture, *, singular: bool = True
    ) -> tuple[Clearance, ...]:
        found = room.clearances(design, posture)
        return room.with_singularity(design, posture, found) if singular else found

    def remedy(self, design: FiveRPURDesign, posture: Posture) -> Remedy:
        return ways_in.remedy(design, posture)

    # --- what a move of the pose passes

    def passed(self, design: FiveRPURDesign, before: Posture, after: Posture) -> tuple[Event, ...]:
        return events.passed(design, before, after)

    def path(self, design: FiveRPURDesign, posture: Posture, poses: ArrayLike) -> Followed:
        return driving.path(design, posture, poses)

    def measures(self, design: FiveRPURDesign) -> tuple[Measure, ...]:
        return measures.MEASURES

    def measure(
        self,
        design: FiveRPURDesign,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        return measures.measure(design, poses, mode, key, load)

    def locus_specs(self, design: FiveRPURDesign) -> tuple[LocusSpec, ...]:
        return curves.SPECS

    def locus(
        self,
        design: FiveRPURDesign,
        key: str,
        pose: Sequence[float],
        mode: str,
        at: float | None = None,
    ) -> LocusCurves:
        return curves.locus(design, key, pose, mode, at)

    # --- solids

    def solids(self, design: FiveRPURDesign) -> tuple[SolidSpec, ...]:
        workspace = SolidSpec(
            "workspace",
            "Constant-orientation workspace",
            "Workspace",
            figure="Figs. 14, 15, 18",
            uses_modes=True,
            surfaces=SURFACES,
        )
        return (workspace, _ASPECTS, *_limb_specs())

    def solid_request(
        self,
        design: FiveRPURDesign,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        resolution: Resolution,
        surface: SurfaceKind = "facets",
    ) -> SolidRequest:
        if key == "workspace":
            orientation = float(pose[3]), float(pose[4])
            arguments: tuple[Any, ...] = (key, design.limbs, *orientation, modes, surface)
        elif key == _ASPECTS.key:
            if modes is None or len(modes) != 1:
                raise InputError("aspects are those of one working mode; choose one")
            arguments = (key, design.limbs, float(pose[3]), float(pose[4]), modes[0])
        else:
            i, part = _limb_part(key)
            limb = design.limbs[i]
            arguments = ("part", limb.link, *limb.stroke, part)
        return SolidRequest(self.kind, arguments, resolution)

    def solid_placement(self, design: FiveRPURDesign, key: str, pose: Sequence[float]) -> Array:
        """4x4 from the frame in which the solid is built to the base frame.

        The workspace and the aspects are built in x'y'z' (paper, section 4), a vertex space too
        but about A_i, to be offset by w'_i (eq. 27).
        """
        phi, theta = float(pose[3]), float(pose[4])
        turned = rotation_y(theta)
        offset = np.zeros(3)
        if key not in ("workspace", _ASPECTS.key):
            i, _ = _limb_part(key)
            offset = design.base[i] - turned @ rotation_x(phi) @ design.platform[i]
        return homogeneous(turned, offset)

    def build_solid(self, request: SolidRequest) -> BuiltSolid:
        from kinematics.mechanisms.five_rpur.workspace import workspace

        what, *arguments = request.arguments
        if what == "workspace":
            limbs, phi, theta, modes, surface = arguments
            design = FiveRPURDesign(limbs)
            return workspace.workspace(design, phi, theta, modes, request.resolution, surface)
        if what == _ASPECTS.key:
            from kinematics.mechanisms.five_rpur.singularities import aspects

            limbs, phi, theta, mode = arguments
            design = FiveRPURDesign(limbs)
            return aspects.aspects(design, phi, theta, mode, request.resolution)
        link, low, high, part = arguments
        zero = (0.0, 0.0, 0.0)
        limb = Limb(zero, zero, link, (low, high))
        alone = FiveRPURDesign((limb, limb, limb, limb, limb))
        return workspace.limb_part(alone, 1, part, request.resolution)

    def inside(
        self, design: FiveRPURDesign, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> bool:
        return bool(inverse.inside(design, pose, modes))

    # --- sections and volumes

    def prepare(self) -> None:
        acceleration.prepare()

    def section_spec(self, design: FiveRPURDesign) -> SectionSpec:
        return SectionSpec("Section at x′", "x′", ("y′", "z′"), "Fig. 17")

    def section_frame(self, design: FiveRPURDesign, pose: Sequence[float]) -> Array:
        """4x4 from (x', y', z') to the base frame: R_y(θ)."""
        return homogeneous(rotation_y(float(pose[4])), np.zeros(3))

    def section_range(
        self, design: FiveRPURDesign, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> tuple[float, float] | None:
        return section.section_range(design, pose[3], pose[4], modes)

    def section(
        self,
        design: FiveRPURDesign,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        at: float,
    ) -> Section:
        return section.section(design, pose[3], pose[4], at, modes)

    def volume(
        self,
        design: FiveRPURDesign,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        *,
        relative: float = 1e-6,
    ) -> Volume:
        return volume.volume(design, pose[3], pose[4], modes, relative=relative)

    def sphere(
        self,
        design: FiveRPURDesign,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        center: Sequence[float] | None = None,
    ) -> Sphere | None:
        return largest.sphere(design, pose[3], pose[4], modes, center)

    def box(
        self,
        design: FiveRPURDesign,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        center: Sequence[float] | None = None,
    ) -> Box | None:
        return largest.box(design, pose[3], pose[4], modes, center)

    def singularity_free_ball(
        self,
        design: FiveRPURDesign,
        pose: Sequence[float],
        mode: str,
        center: Sequence[float] | None = None,
    ) -> Sphere | None:
        return ball.singularity_free_ball(design, pose[3], pose[4], mode, center)

    def map_spec(self, design: FiveRPURDesign) -> MapSpec:
        return maps.SPEC

    def map_cells(
        self,
        design: FiveRPURDesign,
        poses: ArrayLike,
        modes: tuple[str, ...] | None,
        quantities: Sequence[str],
        *,
        relative: float = 1e-4,
    ) -> MapCells:
        return maps.map_cells(design, poses, modes, quantities, relative=relative)


MECHANISM = FiveRPUR()


@cache
def _limb_specs() -> tuple[SolidSpec, ...]:
    return tuple(
        SolidSpec(f"limb{i}/{part}", f"Limb {i}: {title}", f"Limb {i}", limb=i, figure=figure)
        for i in range(1, designs.LIMBS + 1)
        for part, (title, figure) in _PARTS.items()
    )


def _limb_part(key: str) -> tuple[int, str]:
    name, _, part = key.partition("/")
    number = name.removeprefix("limb")
    if number not in {str(i) for i in range(1, designs.LIMBS + 1)} or part not in _PARTS:
        raise InputError(
            f"there is no solid {key!r}; it is 'workspace', 'aspects' or 'limbN/PART' with N "
            f"from 1 to 5 and PART one of {', '.join(_PARTS)}"
        )
    return int(number) - 1, part
