"""The facets of the mechanism, each a thin face of the rooms that compute."""

from __future__ import annotations

from numpy.typing import ArrayLike

from kinematics.answers.singularities import Event
from kinematics.answers.solutions import (
    Followed,
    Posture,
)
from kinematics.answers.trajectories import NamedTrajectory
from kinematics.facets.paths import PathsFacet
from kinematics.mechanisms.five_bar import (
    named_paths,
    paths,
)
from kinematics.mechanisms.five_bar.design import FiveBarDesign


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
