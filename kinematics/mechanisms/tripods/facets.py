"""The facets of the mechanism, each a thin face of the rooms that compute."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from kinematics.answers.clearances import Clearance, Remedy
from kinematics.answers.singularities import Event
from kinematics.answers.solutions import (
    Followed,
    Posture,
)
from kinematics.mechanisms.tripods import clearances as room
from kinematics.mechanisms.tripods import (
    paths,
)
from kinematics.mechanisms.tripods.design import TripodDesign

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    pass
from kinematics.facets.clearances import ClearancesFacet
from kinematics.facets.paths import PathsFacet


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
