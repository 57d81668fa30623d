"""Where the joints are when the platform is at a pose, in every mode."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from numpy.typing import ArrayLike

from kinematics.answers.solutions import InverseSolutions, Posture
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class InverseFacet(Facet[D]):
    """Inverse kinematics."""

    topic = "inverse"

    @abstractmethod
    def __call__(self, poses: ArrayLike) -> InverseSolutions:
        """Joints and reasons of poses (..., P), mm and rad, in all modes.

        Raises:
            InputError: not finite numbers, or not P of them.
        """

    @abstractmethod
    def posture(self, pose: Sequence[float], mode: str) -> Posture:
        """The whole configuration at one pose in one mode, reachable or not, with its reasons.

        Raises:
            InputError: not P finite numbers, or no such mode.
        """

    @abstractmethod
    def inside(self, pose: Sequence[float], modes: tuple[str, ...] | None) -> bool:
        """Whether the pose is within reach in one of the modes; None: in any."""
