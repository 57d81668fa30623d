"""Paths of a mechanism with fewer freedoms than coordinates: one follows from the others.

Between points that satisfy the constraint a path does not: everywhere the dependent coordinate is
solved for. Its rate and acceleration are left open, NaN, for the mechanism to find.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kinematics.mechanism import Design, Mechanism
from kinematics.trajectories.paths import Derivatives, Path


@dataclass(frozen=True)
class Constrained:
    """A path whose coordinate ``dependent`` gives way to the mechanism's constraint."""

    path: Path
    mechanism: Mechanism
    design: Design
    mode: str
    dependent: int

    @property
    def length(self) -> float:
        """mm, of the path as it was given."""
        return self.path.length

    def at(self, share: ArrayLike) -> Derivatives:
        """See `Path`; the derivatives of the dependent coordinate are NaN."""
        points, first, second = (np.array(each) for each in self.path.at(share))
        k = self.dependent
        for pose in points:
            full = self.mechanism.complete_pose(
                self.design, tuple(pose.tolist()), self.mode, None, k
            )
            pose[k] = full[k]
        first[:, k] = np.nan
        second[:, k] = np.nan
        return points, first, second


def constrained(
    path: Path, mechanism: Mechanism, design: Design, mode: str, dependent: int | None
) -> Path:
    """The path itself, or with the coordinate that follows from the others solved for.

    Args:
        dependent: which one gives way; None: the one that the mechanism would choose.
    """
    known = mechanism.dependent_coordinates(design)
    if not known:
        return path
    if dependent is None:
        start = path.at(np.zeros(1))[0][0]
        moved = tuple((start + 1e-3).tolist())
        change = np.abs(np.subtract(mechanism.complete_pose(design, moved, mode), moved))
        dependent = max(known, key=lambda k: float(change[k]))
    return Constrained(path, mechanism, design, mode, dependent)
