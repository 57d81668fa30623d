"""The facets of the mechanism, each a thin face of the rooms that compute."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from kinematics.answers.clearances import Clearance, Remedy
from kinematics.answers.loci import LocusCurves
from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.singularities import AT, Event, ModeChange, Singularity
from kinematics.answers.solutions import (
    Followed,
    Posture,
)
from kinematics.answers.trajectories import NamedTrajectory
from kinematics.arrays import Array
from kinematics.facets.clearances import ClearancesFacet
from kinematics.facets.measures import MeasuresFacet
from kinematics.facets.motion import MotionFacet
from kinematics.facets.paths import PathsFacet
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.facets.statics import StaticsFacet
from kinematics.mechanisms.five_bar import (
    loci,
    mode_changes,
    motion,
    named_paths,
    paths,
)
from kinematics.mechanisms.five_bar import singularities as control
from kinematics.mechanisms.five_bar.design import FiveBarDesign


class FiveBarMotion(MotionFacet[FiveBarDesign]):
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


class FiveBarStatics(StaticsFacet[FiveBarDesign]):
    """TODO"""

    def wrenches(self, poses: ArrayLike, mode: str) -> WrenchSystem:
        return motion.wrench_system(self.design, poses, mode)

    def forces(self, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics:
        return motion.statics(self.design, poses, mode, loads)


class FiveBarMeasures(MeasuresFacet[FiveBarDesign]):
    """TODO"""

    specs = motion.MEASURES

    def __call__(
        self,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        return motion.measure(self.design, poses, mode, key, load)


class FiveBarSingularities(SingularitiesFacet[FiveBarDesign]):
    """TODO"""

    def at(self, posture: Posture, tolerance: float = AT) -> tuple[Singularity, ...]:
        return control.singularities(self.design, posture, tolerance)

    def mode_change(self, posture: Posture, wanted: str = "") -> ModeChange | None:
        return mode_changes.mode_change(self.design, posture, wanted)

    loci = loci.SPECS

    def locus(
        self,
        key: str,
        pose: Sequence[float],
        mode: str,
        at: float | None = None,
    ) -> LocusCurves:
        return loci.locus(self.design, key, mode)


class FiveBarClearances(ClearancesFacet[FiveBarDesign]):
    """TODO"""

    def of(self, posture: Posture, *, singular: bool = True) -> tuple[Clearance, ...]:
        return control.clearances(self.design, posture, singular=singular)

    def nearest_pose(self, posture: Posture) -> Remedy:
        return control.remedy(self.design, posture)


class FiveBarPaths(PathsFacet[FiveBarDesign]):
    """TODO"""

    def passed(
        self,
        before: Posture,
        after: Posture,
        through: ArrayLike = (),
    ) -> tuple[Event, ...]:
        return paths.passed(self.design, before, after, through)

    def drive(self, posture: Posture, poses: ArrayLike) -> Followed:
        return paths.path(self.design, posture, poses)

    def named(self) -> tuple[NamedTrajectory, ...]:
        return named_paths.named(self.design)
