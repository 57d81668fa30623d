"""Workspaces that lie in a plane: regions bounded by exact curves."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from kinematics.answers.sections import Region, RegionSpec
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.facet import Facet
from kinematics.mechanism import D
from kinematics.plane.arcs import Arcs


class RegionsFacet(Facet[D]):
    """Regions of the plane in which O′ moves at a constant orientation."""

    topic = "regions"
    specs: tuple[RegionSpec, ...]

    def frame(self, pose: Sequence[float]) -> Array:
        """(4, 4) from (u, v, normal) of the plane to the base frame."""
        return np.eye(4)

    def of(
        self, key: str, pose: Sequence[float], modes: tuple[str, ...] | None = None
    ) -> tuple[Region, ...]:
        """The regions ``key`` at a pose's orientation for a set of modes; None: of all together.

        Raises:
            InputError: there are no such regions, or no such mode.
        """
        known = [spec.key for spec in self.specs]
        if key not in known:
            raise InputError(
                f"there are no regions {key!r}; known are {', '.join(map(repr, known))}"
            )
        return self.found(key, pose, modes)

    def arcs(self, pose: Sequence[float], modes: tuple[str, ...] | None) -> Arcs | None:
        """Every arc that may bound the workspace, more do no harm; None where it is not known by
        arcs.
        """
        return None

    @abstractmethod
    def found(
        self, key: str, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> tuple[Region, ...]:
        """The regions of one of `specs`, see `of`."""
