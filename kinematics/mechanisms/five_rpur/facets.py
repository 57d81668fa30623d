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
from kinematics.mechanisms.five_rpur import clearances as room
from kinematics.mechanisms.five_rpur import (
    measures,
    motion,
    statics,
)
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.nearest_pose import ways_in
from kinematics.mechanisms.five_rpur.paths import driving, events
from kinematics.mechanisms.five_rpur.singularities import curves, kinds

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    pass
from kinematics.facets.clearances import ClearancesFacet
from kinematics.facets.measures import MeasuresFacet
from kinematics.facets.motion import MotionFacet
from kinematics.facets.paths import PathsFacet
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.facets.statics import StaticsFacet


class RPURMotion(MotionFacet[FiveRPURDesign]):
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


class RPURStatics(StaticsFacet[FiveRPURDesign]):
    """TODO"""

    def wrenches(self, poses: ArrayLike, mode: str) -> WrenchSystem:
        return statics.wrench_system(self.design, poses, mode)

    def forces(self, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics:
        return statics.statics(self.design, poses, mode, loads)


class RPURSingularities(SingularitiesFacet[FiveRPURDesign]):
    """TODO"""

    def at(self, posture: Posture, tolerance: float = AT) -> tuple[Singularity, ...]:
        return kinds.singularities(self.design, posture, tolerance)

    loci = curves.SPECS

    def locus(
        self,
        key: str,
        pose: Sequence[float],
        mode: str,
        at: float | None = None,
    ) -> LocusCurves:
        return curves.locus(self.design, key, pose, mode, at)


class RPURClearances(ClearancesFacet[FiveRPURDesign]):
    """TODO"""

    def of(self, posture: Posture, *, singular: bool = True) -> tuple[Clearance, ...]:
        found = room.clearances(self.design, posture)
        return room.with_singularity(self.design, posture, found) if singular else found

    def nearest_pose(self, posture: Posture) -> Remedy:
        return ways_in.remedy(self.design, posture)


class RPURPaths(PathsFacet[FiveRPURDesign]):
    """TODO"""

    def passed(self, before: Posture, after: Posture) -> tuple[Event, ...]:
        return events.passed(self.design, before, after)

    def drive(self, posture: Posture, poses: ArrayLike) -> Followed:
        return driving.path(self.design, posture, poses)


class RPURMeasures(MeasuresFacet[FiveRPURDesign]):
    """TODO"""

    specs = measures.MEASURES

    def __call__(
        self,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        return measures.measure(self.design, poses, mode, key, load)
