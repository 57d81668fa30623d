"""Measures of the workspace over two coordinates, cell by cell."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from numpy.typing import ArrayLike

from kinematics.answers.sections import MapCells, MapSpec
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class MapsFacet(Facet[D]):
    """What a map can show; `kinematics.facets.map_sweeps` runs over its points."""

    topic = "maps"
    spec: MapSpec

    @abstractmethod
    def cells(
        self,
        poses: ArrayLike,
        modes: tuple[str, ...] | None,
        quantities: Sequence[str],
        *,
        relative: float = 1e-4,
    ) -> MapCells:
        """The wanted quantities at poses (N, P), with their errors.

        Raises:
            InputError: there is no such quantity.
        """
