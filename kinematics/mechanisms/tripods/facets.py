"""The facets of the mechanism, each a thin face of the rooms that compute."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from kinematics.answers.clearances import Clearance, Remedy
from kinematics.answers.loci import LocusCurves
from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.singularities import AT, Event, ModeChange, Singularity
from kinematics.answers.solutions import (
    Followed,
    Posture,
)
from kinematics.arrays import Array
from kinematics.mechanisms.tripods import clearances as room
from kinematics.mechanisms.tripods import (
    loci,
    motion,
    paths,
    wrenches,
)
from kinematics.mechanisms.tripods import singularities as singularity
from kinematics.mechanisms.tripods.design import TripodDesign

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    pass
from kinematics.facets.clearances import ClearancesFacet
from kinematics.facets.measures import MeasuresFacet
from kinematics.facets.motion import MotionFacet
from kinematics.facets.paths import PathsFacet
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.facets.statics import StaticsFacet


class TripodMotion(MotionFacet[TripodDesign]):
    """TODO"""

    def inverse(
        self,
        poses: ArrayLike,
        mode: str,
        pose_rates: ArrayLike,
        pose_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.inverse_motion(self.design, poses, mode, pose_rates, pose_accelerations)

    def forward(
        self,
        poses: ArrayLike,
        mode: str,
        joint_rates: ArrayLike,
        joint_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.forward_motion(self.design, poses, mode, joint_rates, joint_accelerations)


class TripodStatics(StaticsFacet[TripodDesign]):
    """TODO"""

    def wrenches(self, poses: ArrayLike, mode: str) -> WrenchSystem:
        return wrenches.wrench_system(self.design, poses, mode)

    def forces(self, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics:
        return wrenches.statics(self.design, poses, mode, loads)


class TripodMeasures(MeasuresFacet[TripodDesign]):
    """TODO"""

    specs = singularity.MEASURES

    def __call__(
        self,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        return singularity.measure(self.design, poses, mode, key, load)


class TripodSingularities(SingularitiesFacet[TripodDesign]):
    """TODO"""

    def at(self, posture: Posture, tolerance: float = AT) -> tuple[Singularity, ...]:
        return singularity.singularities(self.design, posture, tolerance)

    def mode_change(self, posture: Posture, wanted: str = "") -> ModeChange:
        return singularity.mode_change(self.design, posture)

    loci = loci.LOCI

    def locus(
        self,
        key: str,
        pose: Sequence[float],
        mode: str,
        at: float | None = None,
    ) -> LocusCurves:
        return loci.locus(self.design, key, float(pose[0]), mode)


class TripodClearances(ClearancesFacet[TripodDesign]):
    """TODO"""

    def of(self, posture: Posture, *, singular: bool = True) -> tuple[Clearance, ...]:
        return room.clearances(self.design, posture, singular=singular)

    def nearest_pose(self, posture: Posture) -> Remedy:
        return room.remedy(self.design, posture)


class TripodPaths(PathsFacet[TripodDesign]):
    """TODO"""

    def passed(self, before: Posture, after: Posture) -> tuple[Event, ...]:
        return paths.passed(self.design, before, after)

    def drive(self, posture: Posture, poses: ArrayLike) -> Followed:
        return paths.path(self.design, posture, poses)
