"""The facets of the mechanism, each a thin face of the rooms that compute."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from kinematics.answers.clearances import Clearance, Remedy
from kinematics.answers.loci import LocusCurves
from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.singularities import AT, Event, Singularity
from kinematics.answers.solutions import (
    Followed,
    Posture,
)
from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr import (
    motion,
    paths,
    wrenches,
)
from kinematics.mechanisms.four_sps_spr import nearest_pose as remedy
from kinematics.mechanisms.four_sps_spr import singularities as control
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    pass
from kinematics.facets.clearances import ClearancesFacet
from kinematics.facets.measures import MeasuresFacet
from kinematics.facets.motion import MotionFacet
from kinematics.facets.paths import PathsFacet
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.facets.statics import StaticsFacet


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
