"""How well a posture is held, as one number: conditioning, manipulability, …"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from numpy.typing import ArrayLike

from kinematics.answers.singularities import Measure
from kinematics.arrays import Array
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class MeasuresFacet(Facet[D]):
    """The measures that a mechanism has."""

    topic = "measures"
    specs: tuple[Measure, ...] = ()

    @abstractmethod
    def __call__(
        self, poses: ArrayLike, mode: str, key: str, load: Sequence[float] | None = None
    ) -> Array:
        """The measure ``key`` at poses (..., P) in one mode, (...); NaN where they do not close.

        Args:
            load: [F, T] N and N·mm at O′, base frame, for measures that need one.

        Raises:
            InputError: there is no such measure, or it needs a load.
        """
