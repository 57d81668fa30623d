"""Where the platform can be when the joints are known: all assembly modes."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from numpy.typing import ArrayLike

from kinematics.answers.solutions import ForwardSolutions, Refreshed
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class ForwardFacet(Facet[D]):
    """Forward kinematics: every solution, with how it is known that they are all."""

    topic = "forward"

    @abstractmethod
    def __call__(
        self, joints: ArrayLike, *, mixed_modes: bool = False
    ) -> tuple[ForwardSolutions, ...]:
        """The sets of solutions for joints (..., J), mm or rad, one after another.

        Args:
            mixed_modes: also solutions outside of a simplified design's closed form.

        Raises:
            InputError: not finite numbers, or not J of them.
        """

    @abstractmethod
    def refresh(self, before: ForwardSolutions, joints: Sequence[float]) -> Refreshed:
        """The set for joints near those of ``before``, whose solutions keep their identity."""

    def is_quick(self, *, mixed_modes: bool = False) -> bool:
        """Whether a set takes a few milliseconds at most, so that a page may wait for it."""
        return False
