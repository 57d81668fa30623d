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
from kinematics.mechanisms.five_rpur import clearances as room
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.nearest_pose import ways_in
from kinematics.mechanisms.five_rpur.paths import driving, events

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    pass
from kinematics.facets.clearances import ClearancesFacet
from kinematics.facets.paths import PathsFacet


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
