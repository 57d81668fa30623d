"""Measures of the workspace over two coordinates, cell by cell."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.sections import MapCells, MapSpec
from kinematics.arrays import finite
from kinematics.errors import InputError
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class MapsFacet(Facet[D]):
    """What a map can show; `kinematics.facets.map_sweeps` runs over its points."""

    topic = "maps"
    spec: MapSpec

    @abstractmethod
    def measures(
        self,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        quantities: Sequence[str],
        relative: float,
    ) -> dict[str, tuple[float, float]]:
        """Each of the wanted quantities at a pose (P,), with its error; others may be among them.

        Args:
            relative: the error wanted of volumes, as a part of them.
        """

    def cells(
        self,
        poses: ArrayLike,
        modes: tuple[str, ...] | None,
        quantities: Sequence[str],
        *,
        relative: float = 1e-4,
    ) -> MapCells:
        """The wanted quantities at poses (N, P), with their errors.

        Args:
            modes: of which any will do; None: all.
            quantities: keys of `spec`.quantities.
            relative: the error wanted of volumes, as a part of them.

        Raises:
            InputError: there is no such quantity, or poses are not P finite numbers each.
        """
        known = [quantity.key for quantity in self.spec.quantities]
        for key in quantities:
            if key not in known:
                raise InputError(f"a map shows {', '.join(known)}, not {key!r}")
        count = len(self.mechanism.coordinates)
        flat = finite(poses, name="poses", last=count).reshape(-1, count).tolist()
        found = [self.measures(pose, modes, quantities, relative) for pose in flat]
        both = np.array([[one[key] for key in quantities] for one in found])
        both = both.reshape(len(flat), len(quantities), 2)
        return MapCells(both[..., 0].copy(), both[..., 1].copy())
