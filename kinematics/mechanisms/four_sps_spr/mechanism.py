"""The 4-SPS + 1-SPR behind the interface that every mechanism shares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

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
from kinematics.facets import following
from kinematics.facets.bare import Bare
from kinematics.mechanism import (
    Coordinate,
    DesignField,
    Resolution,
    SolidRequest,
    SolidSpec,
    SurfaceKind,
)
from kinematics.mechanisms.four_sps_spr import (
    closure,
    constraint,
    dragging,
    drawing,
    findings,
    home,
    inverse,
    motion,
    paths,
    plane,
    workspace,
    wrenches,
)
from kinematics.mechanisms.four_sps_spr import design as designs
from kinematics.mechanisms.four_sps_spr import nearest_pose as remedy
from kinematics.mechanisms.four_sps_spr import singularities as control
from kinematics.mechanisms.four_sps_spr import texts as about
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.forward import assembly, refreshing
from kinematics.screws.spatial import Array

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid


class FourSPSSPR(Bare):
    """Wang et al. (2017): x, y, z, α, β, γ under one constraint, moved by five legs l₁ … l₅."""

    kind = "four_sps_spr"
    title = "4-SPS + 1-SPR (5 DOF)"
    modes = inverse.MODES
    mode_noun = ""

    def about(self, topic: str) -> str:
        return about.ABOUT.get(topic, "")

    # --- designs

    def read_design(self, table: Mapping[str, Any], *, origin: str, name: str) -> FourSPSSPRDesign:
        return designs.design_from_table(table, origin=origin, name=name)

    def design_table(self, design: FourSPSSPRDesign) -> dict[str, Any]:
        return designs.design_to_table(design)

    def design_fields(self, design: FourSPSSPRDesign) -> tuple[DesignField, ...]:
        return designs.design_fields(design)

    def with_field(
        self, design: FourSPSSPRDesign, path: tuple[str | int, ...], value: float
    ) -> FourSPSSPRDesign:
        return designs.with_field(design, path, value)

    def findings(self, design: FourSPSSPRDesign) -> tuple[Finding, ...]:
        return findings.findings(design)

    # --- coordinates

    def pose_coordinates(self, design: FourSPSSPRDesign) -> tuple[Coordinate, ...]:
        low, high = home.reach(design)
        turn = float(np.pi)
        return (
            *(Coordinate(k, k, "mm", low[n], high[n]) for n, k in enumerate("xyz")),
            Coordinate("alpha", "α", "rad", -turn, turn),
            Coordinate("beta", "β", "rad", -turn, turn),
            Coordinate("gamma", "γ", "rad", -turn, turn),
        )

    def joint_coordinates(self, design: FourSPSSPRDesign) -> tuple[Coordinate, ...]:
        return tuple(
            Coordinate(f"l{i + 1}", designs.JOINT_SYMBOLS[i], "mm", *limb.stroke, limb=i + 1)
            for i, limb in enumerate(design.limbs)
        )

    def dependent_coordinates(self, design: FourSPSSPRDesign) -> tuple[int, ...]:
        return tuple(range(inverse.POSE))

    def complete_pose(
        self,
        design: FourSPSSPRDesign,
        pose: Sequence[float],
        mode: str,
        moved: int | None = None,
        dependent: int | None = None,
    ) -> tuple[float, ...]:
        return constraint.complete_pose(design, pose, moved, dependent)

    # --- kinematics

    def home(self, design: FourSPSSPRDesign) -> Posture:
        return home.home(design)

    def posture(self, design: FourSPSSPRDesign, pose: Sequence[float], mode: str) -> Posture:
        return inverse.posture(design, pose)

    def inverse(self, design: FourSPSSPRDesign, poses: ArrayLike) -> InverseSolutions:
        return inverse.inverse(design, poses)

    def follow(
        self, design: FourSPSSPRDesign, posture: Posture, joints: Sequence[float]
    ) -> Followed:
        if not posture.closes:
            return Followed(posture, "stalled", _not_closed(posture), 0.0)
        return following.follow(
            closure.Closure(design),
            posture,
            closure.state_of(posture.pose),
            joints,
            strokes=design.stroke,
            symbols=designs.JOINT_SYMBOLS,
            posture=closure.posture_maker(design, posture.pose),
        )

    def fold_ahead(
        self, design: FourSPSSPRDesign, posture: Posture, joints: Sequence[float]
    ) -> Fold | None:
        if not posture.closes:
            return None
        return following.fold_ahead(
            closure.Closure(design),
            posture,
            closure.state_of(posture.pose),
            joints,
            posture=closure.posture_maker(design, posture.pose),
        )

    def forward(
        self, design: FourSPSSPRDesign, joints: ArrayLike, *, mixed_modes: bool = False
    ) -> tuple[ForwardSolutions, ...]:
        return assembly.forward(design, joints)

    def refresh(
        self, design: FourSPSSPRDesign, before: ForwardSolutions, joints: Sequence[float]
    ) -> Refreshed:
        return refreshing.refresh(design, before, joints)

    def transform(
        self, design: FourSPSSPRDesign, poses: ArrayLike, mode: str | Sequence[str] = ""
    ) -> Array:
        return inverse.transform(poses)

    def pose_from_transform(
        self, design: FourSPSSPRDesign, transform: ArrayLike, mode: str = ""
    ) -> tuple[float, ...]:
        return dragging.pose_from_transform(design, transform)

    def drawing(self, design: FourSPSSPRDesign, posture: Posture) -> Drawing:
        return drawing.drawing(design, posture)

    # --- motion and statics

    def characteristic_length(self, design: FourSPSSPRDesign) -> float:
        return design.length

    def inverse_motion(
        self,
        design: FourSPSSPRDesign,
        poses: ArrayLike,
        mode: str,
        pose_rates: ArrayLike,
        pose_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.inverse_motion(design, poses, pose_rates, pose_accelerations)

    def forward_motion(
        self,
        design: FourSPSSPRDesign,
        poses: ArrayLike,
        mode: str,
        joint_rates: ArrayLike,
        joint_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.forward_motion(design, poses, joint_rates, joint_accelerations)

    def wrench_system(self, design: FourSPSSPRDesign, poses: ArrayLike, mode: str) -> WrenchSystem:
        return wrenches.wrench_system(design, poses)

    def statics(
        self, design: FourSPSSPRDesign, poses: ArrayLike, mode: str, loads: ArrayLike
    ) -> Statics:
        return wrenches.statics(design, poses, loads)

    # --- how well a posture is held

    def measures(self, design: FourSPSSPRDesign) -> tuple[Measure, ...]:
        return control.MEASURES

    def measure(
        self,
        design: FourSPSSPRDesign,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        return control.measure(design, poses, key, load)

    def singularities(
        self, design: FourSPSSPRDesign, posture: Posture, tolerance: float = AT
    ) -> tuple[Singularity, ...]:
        return control.singularities(design, posture, tolerance)

    def clearances(
        self, design: FourSPSSPRDesign, posture: Posture, *, singular: bool = True
    ) -> tuple[Clearance, ...]:
        return control.clearances(design, posture, singular=singular)

    def passed(
        self, design: FourSPSSPRDesign, before: Posture, after: Posture
    ) -> tuple[Event, ...]:
        return paths.passed(design, before, after)

    def path(self, design: FourSPSSPRDesign, posture: Posture, poses: ArrayLike) -> Followed:
        return paths.path(design, posture, poses)

    def remedy(self, design: FourSPSSPRDesign, posture: Posture) -> Remedy:
        return remedy.remedy(design, posture)

    def locus_specs(self, design: FourSPSSPRDesign) -> tuple[LocusSpec, ...]:
        return control.LOCI

    def locus(
        self,
        design: FourSPSSPRDesign,
        key: str,
        pose: Sequence[float],
        mode: str,
        at: float | None = None,
    ) -> LocusCurves:
        return control.locus(design, key, pose)

    # --- the workspace: plane at a constant orientation, a solid where one angle gives way

    def region_specs(self, design: FourSPSSPRDesign) -> tuple[RegionSpec, ...]:
        return plane.REGIONS

    def region_frame(self, design: FourSPSSPRDesign, pose: Sequence[float]) -> Array:
        return plane.region_frame(design, tuple(pose[3:]))

    def regions(
        self,
        design: FourSPSSPRDesign,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
    ) -> tuple[Region, ...]:
        return plane.regions(design, key, tuple(pose[3:]))

    def solids(self, design: FourSPSSPRDesign) -> tuple[SolidSpec, ...]:
        return _SOLIDS

    def solid_request(
        self,
        design: FourSPSSPRDesign,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        resolution: Resolution,
        surface: SurfaceKind = "facets",
    ) -> SolidRequest:
        index = _follows(key)
        request = workspace.request_at(design, tuple(pose), index)
        arguments = (design.limbs, design.revolute_axis, request)
        return SolidRequest(self.kind, arguments, resolution)

    def solid_placement(self, design: FourSPSSPRDesign, key: str, pose: Sequence[float]) -> Array:
        """It is built in the base frame."""
        _follows(key)
        return np.eye(4)

    def solid_poses(
        self,
        design: FourSPSSPRDesign,
        key: str,
        pose: Sequence[float],
        mode: str,
        points: ArrayLike,
    ) -> Array:
        """With the angle that follows, of both the one nearer to the present one."""
        index = _follows(key)
        poses = super().solid_poses(design, key, pose, mode, points)
        both = constraint.dependent_values(design, poses, index)
        away = np.where(np.isfinite(both), np.abs(inverse.wrap_angle(both - pose[index])), np.inf)
        nearest = away.argmin(axis=1)
        poses[:, index] = both[np.arange(len(poses)), nearest]
        return poses

    def build_solid(self, request: SolidRequest) -> BuiltSolid:
        limbs, axis, what = request.arguments
        return workspace.build(FourSPSSPRDesign(limbs, axis), what, request.resolution)

    def inside(
        self, design: FourSPSSPRDesign, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> bool:
        return bool(inverse.inside(design, pose))


MECHANISM = FourSPSSPR()


def _not_closed(posture: Posture) -> str:
    why = posture.reasons[0].text if posture.reasons else "the machine cannot be assembled"
    return f"there is no assembly mode to follow: {why}"


_SOLIDS = tuple(
    SolidSpec(
        f"workspace/{key}",
        f"Workspace, {symbol} following from the constraint",
        "Workspace",
        follows=3 + n,
    )
    for n, (key, symbol) in enumerate((("alpha", "α"), ("beta", "β"), ("gamma", "γ")))
)


def _follows(key: str) -> int:
    """The coordinate that gives way in a solid."""
    found = next((spec.follows for spec in _SOLIDS if spec.key == key), None)
    if found is None:
        known = ", ".join(spec.key for spec in _SOLIDS)
        raise InputError(f"there is no solid {key!r}; known are {known}")
    return found
