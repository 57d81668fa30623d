"""What a move of the pose passes, paths as a machine is driven along them, and paths by name."""

from __future__ import annotations

from abc import abstractmethod

from numpy.typing import ArrayLike

from kinematics.answers.singularities import Event
from kinematics.answers.solutions import Followed, Posture
from kinematics.answers.trajectories import NamedTrajectory
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class PathsFacet(Facet[D]):
    """Straight moves in the pose coordinates and what they meet."""

    topic = "paths"

    def passed(self, before: Posture, after: Posture) -> tuple[Event, ...]:
        """What the straight move from one posture to another of the same mode passes, in order."""
        return ()

    @abstractmethod
    def drive(self, posture: Posture, poses: ArrayLike) -> Followed:
        """From a posture through poses (N, P), as driven, up to what would stop the machine.

        Raises:
            InputError: no poses, or not P finite numbers each.
        """

    def named(self) -> tuple[NamedTrajectory, ...]:
        """Trajectories that the mechanism's paper or trade runs, by name."""
        return ()
