"""Workspaces that lie in a plane: regions bounded by exact curves."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from kinematics.answers.sections import Region, RegionSpec
from kinematics.arrays import Array
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class RegionsFacet(Facet[D]):
    """Regions of the plane in which O′ moves at a constant orientation."""

    topic = "regions"
    specs: tuple[RegionSpec, ...]

    @abstractmethod
    def frame(self, pose: Sequence[float]) -> Array:
        """(4, 4) from (u, v, normal) of the plane to the base frame."""

    @abstractmethod
    def of(
        self, key: str, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> tuple[Region, ...]:
        """The regions ``key`` at a pose's orientation for a set of modes; None: of all together.

        Raises:
            InputError: there are no such regions.
        """
