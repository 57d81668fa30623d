"""One assembly mode while the joints move: where it leads, and where it ends."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from kinematics.answers.solutions import Fold, Followed, Posture
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class FollowingFacet(Facet[D]):
    """Motion along one assembly mode."""

    topic = "following"

    @abstractmethod
    def follow(self, posture: Posture, joints: Sequence[float]) -> Followed:
        """From a posture to joints (J,), mm or rad, on a straight line in joint space.

        It stops where the assembly mode ends or a joint meets its bound, and says which.
        """

    def fold_ahead(self, posture: Posture, joints: Sequence[float]) -> Fold | None:
        """Where on the way to ``joints`` the assembly mode merges with another; None if nowhere."""
        return None
