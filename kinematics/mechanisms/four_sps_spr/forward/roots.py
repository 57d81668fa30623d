"""Every complex solution of the forward displacement of any 4-SPS + 1-SPR.

A design's own start set is all solutions for its geometry and complex lengths, made once by
following the general machine's 40. From there only the lengths move, for many vectors at a time.
How paths are settled and counted is `kinematics.homotopy.solving`.
"""

from __future__ import annotations

from collections import OrderedDict

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.homotopy.assembly_sets import grouped
from kinematics.homotopy.solving import AROUND, SAME, Roots, solve
from kinematics.homotopy.tracking import Complex, Control, Index
from kinematics.mechanisms.four_sps_spr.design import LIMBS, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.forward.equations import (
    Deformation,
    Parameters,
    conjugate,
    marks,
    parameters,
    polish,
    regularity,
)
from kinematics.mechanisms.four_sps_spr.forward.start_set import StartSet, general_set

SINGULAR = 1e-11
"""Regularity of a solution on a curve of them, but for rounding."""
_INFINITE = 1e10  # extent of what is a solution of the equations but no pose
_KEPT = 64  # own start sets in memory
_QUICK = Control(first=0.1)

# --- a design's own start set ---------------------------------------------------------------

_own: OrderedDict[tuple[object, ...], StartSet] = OrderedDict()


def own_start_set(design: FourSPSSPRDesign) -> StartSet:
    """All solutions for a design's geometry at complex lengths; kept for the next call."""
    key = (*((limb.base, limb.platform) for limb in design.limbs), design.revolute_axis)
    found = _own.get(key)
    if found is None:
        found = _own[key] = _make_own(design)
        while len(_own) > _KEPT:
            _own.popitem(last=False)
    _own.move_to_end(key)
    return found


def _make_own(design: FourSPSSPRDesign) -> StartSet:
    """Follow the general set to the design's geometry."""
    target = parameters(design, np.zeros(LIMBS))
    turns = np.exp(1j * np.array([0.9, -1.3, 0.5, 1.7, -0.7]))
    size = 1.0 + float(np.mean((np.asarray(target.base).real ** 2).sum(axis=-1)))
    target = target._replace(squares=size * np.array([1.1, 0.8, 1.3, 0.9, 1.0]) * turns)
    (found,) = _solve(general_set(), target, 1, real=False)
    return StartSet(target, found.values[:, : found.regular], found.complete)


# --- solving --------------------------------------------------------------------------------


def roots_at(design: FourSPSSPRDesign, joints: Array) -> list[Roots]:
    """All complex solutions for each of some vectors of lengths (B, 5), mm."""
    start = own_start_set(design)
    squares = np.asarray(parameters(design, joints).squares, dtype=complex)
    target = start.parameters._replace(squares=squares)
    return _solve(start, target, len(joints), real=True)


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
        """The first is straight, others lead around through other complex lengths."""
        start = self._start.parameters
        target = self._of(np.repeat(targets, self._start.roots.shape[1]))
        if attempt == 0:
            return Deformation(start, target)
        around: Complex = 1j * AROUND[attempt - 1] * (target.squares - start.squares)
        return Deformation(start, target, around)

    def polish(self, values: Complex, of: Index, rounds: int = 3) -> tuple[Complex, Array]:
        return polish(self._of(of), values, rounds)

    def regularity(self, values: Complex, of: Index) -> Array:
        return regularity(self._of(of), values)

    def conjugate(self, values: Complex) -> Complex:
        return conjugate(values)

    def infinite(self, values: Complex) -> NDArray[np.bool_]:
        norm = np.abs((values[:4] * values[:4]).sum(axis=0))
        extent = (np.abs(values) ** 2).sum(axis=0) / np.maximum(norm, 1e-300)
        return ~(np.asarray(extent) < _INFINITE)

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
