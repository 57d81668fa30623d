"""Every complex solution of the forward displacement of any 4-SPS + 1-SPR.

A design's own start set is all solutions for its geometry and complex lengths, made once by
following the general machine's 40. From there only the lengths move, for many vectors at a time.
How paths are settled and counted is `kinematics.homotopy.solving`.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.homotopy.assembly_sets import grouped
from kinematics.homotopy.solving import AROUND, SAME, Roots, solve
from kinematics.homotopy.start_sets import OwnStartSets, grown, made
from kinematics.homotopy.tracking import Complex, Control, Index
from kinematics.mechanisms.four_sps_spr.design import LIMBS, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.forward.equations import (
    Deformation,
    Parameters,
    conjugate,
    extent,
    marks,
    parameters,
    polish,
    regularity,
)
from kinematics.mechanisms.four_sps_spr.forward.start_set import (
    GENERAL_COUNT,
    StartSet,
    general_set,
)

SINGULAR = 1e-11
"""Regularity of a solution on a curve of them, but for rounding."""
_FAR, _INFINITE = 1e5, 1e10  # extent of what solves the equations but is no pose
_QUICK = Control(first=0.1)

_own: OwnStartSets[Parameters] = OwnStartSets(kept=64)


def own_start_set(design: FourSPSSPRDesign) -> StartSet:
    """All solutions for a design's geometry at complex lengths; kept for the next call."""
    return _own.get(_key(design), partial(_make_own, design))


def _key(design: FourSPSSPRDesign) -> tuple[object, ...]:
    return (*((limb.base, limb.platform) for limb in design.limbs), design.revolute_axis)


def _make_own(design: FourSPSSPRDesign) -> StartSet:
    """Follow the general set to the design's geometry."""
    target = parameters(design, np.zeros(LIMBS))
    turns = np.exp(1j * np.array([0.9, -1.3, 0.5, 1.7, -0.7]))
    size = 1.0 + float(np.mean((np.asarray(target.base).real ** 2).sum(axis=-1)))
    target = target._replace(squares=size * np.array([1.1, 0.8, 1.3, 0.9, 1.0]) * turns)
    start = general_set()
    (found,) = _solve(start, target, 1, real=False)
    return made(start, target, found)


def roots_at(design: FourSPSSPRDesign, joints: Array) -> list[Roots]:
    """All complex solutions for each of some vectors of lengths (B, 5), mm."""
    squares = np.asarray(parameters(design, joints).squares, dtype=complex)

    def forth(start: StartSet) -> list[Roots]:
        target = start.parameters._replace(squares=squares)
        return _solve(start, target, len(squares), real=True)

    def grow(start: StartSet, n: int, found: Roots) -> StartSet | None:
        there = StartSet(
            start.parameters._replace(squares=squares[n]), found.values[:, : found.regular]
        )
        (back,) = _solve(there, start.parameters, 1, real=False)
        return grown(start, back, cluster, GENERAL_COUNT)

    return _own.solve(_key(design), partial(_make_own, design), forth, grow)


def _solve(start: StartSet, target: Parameters, batch: int, *, real: bool) -> list[Roots]:
    """All solutions of each of a batch of targets, which differ in their lengths only."""
    equations = _Equations(start, target)
    return solve(equations, start.roots, batch, whole=start.complete, real=real, control=_QUICK)


class _Equations:
    """A batch of targets, see `kinematics.homotopy.solving.Equations`."""

    singular = SINGULAR
    near = 1e-3

    def __init__(self, start: StartSet, target: Parameters) -> None:
        self._start, self._target = start, target
        self._squares = np.atleast_2d(target.squares)

    def _of(self, columns: Index) -> Parameters:
        return self._target._replace(squares=self._squares[columns])

    def way(self, targets: Index, attempt: int) -> Deformation:
        """The first is straight, others lead around through other complex machines."""
        target = self._of(np.repeat(targets, self._start.roots.shape[1]))
        around = 0.0 if attempt == 0 else AROUND[attempt - 1]
        return Deformation(self._start.parameters, target, around)

    def polish(self, values: Complex, of: Index, rounds: int = 3) -> tuple[Complex, Array]:
        return polish(self._of(of), values, rounds)

    def regularity(self, values: Complex, of: Index) -> Array:
        return regularity(self._of(of), values)

    def conjugate(self, values: Complex) -> Complex:
        return conjugate(values)

    def infinite(self, values: Complex, goals: Complex) -> NDArray[np.bool_]:
        return ~((extent(values) < _FAR) | (extent(goals) < _INFINITE))

    def cluster(self, values: Complex, distance: float) -> Index:
        return cluster(values, distance)

    def among(self, values: Complex, known: Complex) -> NDArray[np.bool_]:
        return np.asarray(distances(values, known).min(axis=1, initial=np.inf) <= SAME)


def distances(one: Complex, other: Complex) -> Array:
    """Between the poses of roots (8, n) and (8, m), (n, m): of R and p, relative to max(1, p)."""
    a, b = marks(one), marks(other)
    apart = np.abs(a[:, :, None] - b[:, None, :]).max(axis=0)
    size = np.maximum(np.abs(a).max(axis=0)[:, None], np.abs(b).max(axis=0)[None, :])
    ratio: Array = apart / np.maximum(size, 1.0)
    return np.where(np.isfinite(ratio), ratio, np.inf)


def cluster(values: Complex, distance: float = SAME) -> Index:
    """Labels 0 … m − 1 of solutions (8, n): the same for those within a relative distance."""
    near = np.argwhere(np.triu(distances(values, values) <= distance, 1))
    return grouped(values.shape[1], near)
