"""The facets of the mechanism, each a thin face of the rooms that compute."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from kinematics.answers.singularities import Event
from kinematics.answers.solutions import (
    Followed,
    Posture,
)
from kinematics.mechanisms.four_sps_spr import (
    paths,
)
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    pass
from kinematics.facets.paths import PathsFacet


class SPSPaths(PathsFacet[FourSPSSPRDesign]):
    """TODO"""

    def passed(self, before: Posture, after: Posture) -> tuple[Event, ...]:
        return paths.passed(self.design, before, after)

    def drive(self, posture: Posture, poses: ArrayLike) -> Followed:
        return paths.path(self.design, posture, poses)
