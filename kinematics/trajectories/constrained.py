"""Paths of a mechanism with fewer freedoms than coordinates: one follows from the others.

Between points that satisfy the constraint a path does not: everywhere the dependent coordinate is
solved for. Its rate and acceleration are left open, NaN, for the mechanism to find.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.trajectories import Derivatives, Path
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.faceted import Faceted

LOOKS = 33  # points of a path at which a coordinate is tried
_STILL = 1e-9  # mm or rad by which a coordinate that stays may vary


@dataclass(frozen=True)
class Constrained:
    """A path whose coordinate ``dependent`` gives way to the mechanism's constraint."""

    path: Path
    machine: Faceted[Any]
    mode: str
    dependent: int

    @property
    def length(self) -> float:
        """mm, of the path as it was given."""
        return self.path.length

    @property
    def knots(self) -> Array:
        """See `Path`."""
        return self.path.knots

    def at(self, share: ArrayLike) -> Derivatives:
        """See `Path`; the derivatives of the dependent coordinate are NaN."""
        points, first, second = (np.array(each) for each in self.path.at(share))
        k = self.dependent
        for pose in points:
            full = self.machine.complete_pose(tuple(pose.tolist()), self.mode, None, k)
            pose[k] = full[k]
        first[:, k] = np.nan
        second[:, k] = np.nan
        return points, first, second


def constrained(path: Path, machine: Faceted[Any], mode: str, dependent: int | None) -> Path:
    """The path itself, or with the coordinate that follows from the others solved for.

    Args:
        dependent: which one gives way; None: the one that the mechanism would choose.
    """
    known = machine.dependent
    if not known:
        return path
    if dependent is None:
        start = path.at(np.zeros(1))[0][0]
        moved = tuple((start + 1e-3).tolist())
        change = np.abs(np.subtract(machine.complete_pose(moved, mode), moved))
        dependent = max(known, key=lambda k: float(change[k]))
    return Constrained(path, machine, mode, dependent)


def giving_way(
    path: Path, machine: Faceted[Any], mode: str, wanted: int | None = None
) -> int | None:
    """The coordinate that can give way all along a path; None where there are no dependent ones.

    Args:
        wanted: this one if it can. Else one that stays the same along the path rather than one that
            the path moves, and of those the one that has to give way least.

    Raises:
        InputError: none of them can.
    """
    known = machine.dependent
    if not known:
        return None
    shares = np.linspace(0.0, 1.0, LOOKS)
    given = path.at(shares)[0]
    length = machine.length
    axes = machine.coordinates
    trouble = ""
    for group in _groups(known, given, wanted):
        found: list[tuple[float, int]] = []
        for k in group:
            try:
                points = Constrained(path, machine, mode, k).at(shares)[0]
            except InputError as error:
                trouble = trouble or str(error)
                continue
            scale = length if axes[k].unit == "rad" else 1.0
            away: Array = np.abs(points[:, k] - given[:, k]) * scale
            found.append((round(float(away.max()), 9), k))
        if found:
            return min(found)[1]
    raise InputError(f"the path cannot be kept to the mechanism's constraint: {trouble}")


def _groups(known: tuple[int, ...], points: Array, wanted: int | None) -> Iterator[tuple[int, ...]]:
    if wanted is not None and wanted in known:
        yield (wanted,)
    still = np.ptp(points, axis=0) <= _STILL
    yield tuple(k for k in known if still[k])
    yield tuple(k for k in known if not still[k])
