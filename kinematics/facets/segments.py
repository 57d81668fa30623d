"""A straight move of the pose in one mode.

Lengths mm, angles rad; where both are compared angles are times the characteristic length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.mechanism import Mechanism
from kinematics.screws.spatial import wrap_angle

ROUNDING = 1e-14
"""Part of the product of the rows' lengths below which a determinant is no more than rounding."""
_TINY = 1e-4  # of the characteristic length: the step of differences


class Measured(Protocol):
    """Who tells what poses meet: the facet of paths."""

    @property
    def mechanism(self) -> Mechanism[Any]: ...
    def consistent(self, poses: Array) -> Array: ...
    def determinant(self, poses: Array, mode: str) -> tuple[Array, Array]: ...


@dataclass(frozen=True, eq=False)
class Segment:
    """A straight move, angles the shorter way round.

    Attributes:
        facet: who tells what its poses meet.
        start: (P,) the pose at s = 0.
        change: (P,) from there to s = 1.
    """

    facet: Measured
    mode: str
    start: Array
    change: Array

    @classmethod
    def between(cls, facet: Measured, start: ArrayLike, end: ArrayLike, mode: str) -> Segment:
        first = np.asarray(start, dtype=float)
        change = np.asarray(end, dtype=float) - first
        turning = _turning(facet.mechanism)
        return cls(facet, mode, first, np.where(turning, wrap_angle(change), change))

    @property
    def length(self) -> float:
        """mm, angles times the characteristic length."""
        return float(np.linalg.norm(self.change * self.metric))

    @property
    def metric(self) -> Array:
        """(P,) mm per unit of each coordinate."""
        length = self.facet.mechanism.length
        return np.array(
            [1.0 if c.unit == "mm" else length for c in self.facet.mechanism.coordinates]
        )

    def poses(self, s: Array) -> Array:
        """(n, P) at s (n,); brought onto the constraint where coordinates depend on each other."""
        return self.facet.consistent(self.start + s[:, None] * self.change)

    def pose(self, s: float) -> tuple[float, ...]:
        """The pose at s, angles in (−π, π]."""
        pose = self.poses(np.array([s]))[0]
        return tuple(np.where(_turning(self.facet.mechanism), wrap_angle(pose), pose).tolist())

    def determinant(self, poses: Array) -> tuple[Array, Array]:
        """That of the wrenches (n,) at poses (n, P), and its rounding."""
        return self.facet.determinant(poses, self.mode)

    def to_singularity(self, pose: Sequence[float]) -> float:
        """About how far a pose is from a parallel singularity, mm: |F| / |∇F| of the determinant F
        over all coordinates; 0 where F is rounding.
        """
        step = _TINY * self.facet.mechanism.length
        shifts = np.diag(step / self.metric)
        poses = np.asarray(pose) + np.concatenate([np.zeros((1, len(shifts))), shifts, -shifts])
        value, noise = self.determinant(self.facet.consistent(poses))
        count = len(shifts)
        if abs(value[0]) <= noise[0]:
            return 0.0
        steep = float(np.linalg.norm(value[1 : count + 1] - value[count + 1 :])) / (2.0 * step)
        return abs(float(value[0])) / steep if steep > 0.0 else float("inf")


def _turning(mechanism: Mechanism[Any]) -> np.ndarray:
    """(P,) which coordinates are the same after a whole turn."""
    return np.array([c.unit == "rad" and c.upper - c.lower > 6.28 for c in mechanism.coordinates])


class Part:
    """The part a … b of a move by the angle t in [0, π], s = middle − half cos t: roots at the ends
    are smooth in it."""

    def __init__(self, a: float, b: float) -> None:
        self.a, self.b, self.middle, self.half = a, b, 0.5 * (a + b), 0.5 * (b - a)

    def s(self, t: Array) -> Array:
        """s (n,) at t (n,)."""
        return np.clip(self.middle - self.half * np.cos(t), self.a, self.b)

    def t(self, s: Array) -> Array:
        """t (n,) at s (n,)."""
        return np.arccos(np.clip((self.middle - s) / self.half, -1.0, 1.0))
