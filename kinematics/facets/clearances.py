"""How far a posture is from what ends its motion, and the ways back in."""

from __future__ import annotations

from math import nan

from kinematics.answers.clearances import Clearance, Remedy
from kinematics.answers.solutions import Posture
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class ClearancesFacet(Facet[D]):
    """Distances to bounds and singularities; the nearest pose in reach."""

    topic = "clearances"

    def of(self, posture: Posture, *, singular: bool = True) -> tuple[Clearance, ...]:
        """What is nearest of each kind; not ``singular``: without what takes longer to find."""
        return ()

    def nearest_pose(self, posture: Posture) -> Remedy:
        """The ways out of a pose that cannot be held: another pose, other modes, another design."""
        return Remedy(None, nan, (), "")
