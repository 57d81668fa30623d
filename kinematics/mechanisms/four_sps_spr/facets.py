"""The facets of the mechanism, each a thin face of the rooms that compute."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.clearances import Clearance, Remedy
from kinematics.answers.loci import LocusCurves
from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.sections import Region
from kinematics.answers.singularities import AT, Event, Singularity
from kinematics.answers.solutions import (
    Followed,
    ForwardSolutions,
    InverseSolutions,
    Posture,
    Refreshed,
)
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.solids import (
    Resolution,
    SolidRequest,
    SolidsFacet,
    SolidSpec,
    SurfaceKind,
)
from kinematics.mechanisms.four_sps_spr import (
    constraint,
    inverse,
    motion,
    paths,
    plane,
    workspace,
    wrenches,
)
from kinematics.mechanisms.four_sps_spr import nearest_pose as remedy
from kinematics.mechanisms.four_sps_spr import singularities as control
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.forward import assembly, refreshing

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid
from kinematics.facets.clearances import ClearancesFacet
from kinematics.facets.forward import ForwardFacet
from kinematics.facets.inverse import InverseFacet
from kinematics.facets.measures import MeasuresFacet
from kinematics.facets.motion import MotionFacet
from kinematics.facets.paths import PathsFacet
from kinematics.facets.regions import RegionsFacet
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.facets.statics import StaticsFacet


class SPSInverse(InverseFacet[FourSPSSPRDesign]):
    """TODO"""

    def posture(self, pose: Sequence[float], mode: str) -> Posture:
        return inverse.posture(self.design, pose)

    def __call__(self, poses: ArrayLike) -> InverseSolutions:
        return inverse.inverse(self.design, poses)

    def inside(self, pose: Sequence[float], modes: tuple[str, ...] | None) -> bool:
        return bool(inverse.inside(self.design, pose))


class SPSForward(ForwardFacet[FourSPSSPRDesign]):
    """TODO"""

    def __call__(
        self, joints: ArrayLike, *, mixed_modes: bool = False
    ) -> tuple[ForwardSolutions, ...]:
        return assembly.forward(self.design, joints)

    def refresh(self, before: ForwardSolutions, joints: Sequence[float]) -> Refreshed:
        return refreshing.refresh(self.design, before, joints)


class SPSMotion(MotionFacet[FourSPSSPRDesign]):
    """TODO"""

    def inverse(
        self,
        poses: ArrayLike,
        mode: str,
        pose_rates: ArrayLike,
        pose_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.inverse_motion(self.design, poses, pose_rates, pose_accelerations)

    def forward(
        self,
        poses: ArrayLike,
        mode: str,
        joint_rates: ArrayLike,
        joint_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.forward_motion(self.design, poses, joint_rates, joint_accelerations)


class SPSStatics(StaticsFacet[FourSPSSPRDesign]):
    """TODO"""

    def wrenches(self, poses: ArrayLike, mode: str) -> WrenchSystem:
        return wrenches.wrench_system(self.design, poses)

    def forces(self, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics:
        return wrenches.statics(self.design, poses, loads)


class SPSMeasures(MeasuresFacet[FourSPSSPRDesign]):
    """TODO"""

    specs = control.MEASURES

    def __call__(
        self,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        return control.measure(self.design, poses, key, load)


class SPSSingularities(SingularitiesFacet[FourSPSSPRDesign]):
    """TODO"""

    def at(self, posture: Posture, tolerance: float = AT) -> tuple[Singularity, ...]:
        return control.singularities(self.design, posture, tolerance)

    loci = control.LOCI

    def locus(
        self,
        key: str,
        pose: Sequence[float],
        mode: str,
        at: float | None = None,
    ) -> LocusCurves:
        return control.locus(self.design, key, pose)


class SPSClearances(ClearancesFacet[FourSPSSPRDesign]):
    """TODO"""

    def of(self, posture: Posture, *, singular: bool = True) -> tuple[Clearance, ...]:
        return control.clearances(self.design, posture, singular=singular)

    def nearest_pose(self, posture: Posture) -> Remedy:
        return remedy.remedy(self.design, posture)


class SPSPaths(PathsFacet[FourSPSSPRDesign]):
    """TODO"""

    def passed(self, before: Posture, after: Posture) -> tuple[Event, ...]:
        return paths.passed(self.design, before, after)

    def drive(self, posture: Posture, poses: ArrayLike) -> Followed:
        return paths.path(self.design, posture, poses)


class SPSRegions(RegionsFacet[FourSPSSPRDesign]):
    """TODO"""

    specs = plane.REGIONS

    def frame(self, pose: Sequence[float]) -> Array:
        return plane.region_frame(self.design, tuple(pose[3:]))

    def of(
        self,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
    ) -> tuple[Region, ...]:
        return plane.regions(self.design, key, tuple(pose[3:]))


class SPSSolids(SolidsFacet[FourSPSSPRDesign]):
    """TODO"""

    @property
    def specs(self) -> tuple[SolidSpec, ...]:
        return _SOLIDS

    def request(
        self,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        resolution: Resolution,
        surface: SurfaceKind = "facets",
    ) -> SolidRequest:
        index = _follows(key)
        request = workspace.request_at(self.design, tuple(pose), index)
        arguments = (self.design.limbs, self.design.revolute_axis, request)
        return SolidRequest(self.mechanism.kind, arguments, resolution)

    def placement(self, key: str, pose: Sequence[float]) -> Array:
        """It is built in the base frame."""
        _follows(key)
        return np.eye(4)

    def poses(
        self,
        key: str,
        pose: Sequence[float],
        mode: str,
        points: ArrayLike,
    ) -> Array:
        """With the angle that follows, of both the one nearer to the present one."""
        index = _follows(key)
        poses = super().poses(key, pose, mode, points)
        both = constraint.dependent_values(self.design, poses, index)
        away = np.where(np.isfinite(both), np.abs(inverse.wrap_angle(both - pose[index])), np.inf)
        nearest = away.argmin(axis=1)
        poses[:, index] = both[np.arange(len(poses)), nearest]
        return poses

    @staticmethod
    def build(request: SolidRequest) -> BuiltSolid:
        limbs, axis, what = request.arguments
        return workspace.build(FourSPSSPRDesign(limbs, axis), what, request.resolution)


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
