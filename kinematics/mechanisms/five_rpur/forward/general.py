"""Every complex solution of the forward kinematics of any 5-RPUR, by a parameter homotopy.

A design's own start set is all solutions for its geometry and complex actuator lengths. It is
made once, by following the start set of the design's family (`forward.families`).
From there only the lengths have to move, which takes a few steps a path. How paths are settled
and counted is `kinematics.homotopy.solving`.
"""

from __future__ import annotations

from collections import OrderedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.arrays import Array
from kinematics.homotopy.assembly_sets import grouped
from kinematics.homotopy.solving import AROUND, SAME, Roots, solve
from kinematics.homotopy.tracking import Control, Index, relative_size
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.forward.equations import (
    Complex,
    Deformation,
    Parameters,
    conjugate,
    parameters,
    polish,
    regularity,
    signature,
)
from kinematics.mechanisms.five_rpur.forward.families import (
    StartSet,
    kept_set,
    membership,
    start_set,
)

_KEPT = 16  # own start sets in memory
_QUICK = Control(first=0.2)  # from a start set with the same geometry

# --- a design's own start set ---------------------------------------------------------------

_own: OrderedDict[tuple[object, ...], StartSet] = OrderedDict()


def own_start_set(design: FiveRPURDesign) -> StartSet:
    """All solutions for a design's geometry at complex lengths; kept for the next call."""
    key = tuple((limb.base, limb.platform, limb.link) for limb in design.limbs)
    found = _own.get(key)
    if found is None:
        found = kept_set(design) or make_own(design)
        _own[key] = found
        while len(_own) > _KEPT:
            _own.popitem(last=False)
    _own.move_to_end(key)
    return found


def has_own_start_set(design: FiveRPURDesign) -> bool:
    """The design's own start set is at hand, so that solving it takes a tenth of a second."""
    key = tuple((limb.base, limb.platform, limb.link) for limb in design.limbs)
    return key in _own or kept_set(design) is not None


def make_own(design: FiveRPURDesign) -> StartSet:
    """Follow the family's start set to the design's geometry."""
    start = start_set(membership(design))
    target = parameters(design, np.zeros(LIMBS))
    target = target._replace(rho2=_complex_lengths(target))
    found = _solve(start, target, real=False)
    return StartSet(target, found.values[:, : found.regular], found.complete)


def _complex_lengths(g: Parameters) -> Complex:
    """ρ² of a start set: as long as actuators are, and well away from the real ones."""
    turns = np.array([0.9, -1.3, 0.5, 1.7, -0.7])[:, None]
    size = 1.0 + float(np.mean(np.abs(g.rx) ** 2 + np.abs(g.rz) ** 2))
    sizes = size * np.array([1.1, 0.8, 1.3, 0.9, 1.0])[:, None]
    lengths: Complex = (sizes * np.exp(1j * turns)).astype(complex)
    return lengths


# --- solving --------------------------------------------------------------------------------


def roots_at(design: FiveRPURDesign, joints: ArrayLike) -> Roots:
    """All complex solutions for actuator lengths (5,), mm."""
    start = own_start_set(design)
    return _solve(start, _moved(start.parameters, design, joints), real=True, control=_QUICK)


def roots_from(
    design: FiveRPURDesign, known: Complex, before: ArrayLike, joints: ArrayLike
) -> Roots:
    """The same from all solutions ``known`` at the lengths ``before``: quicker if they are near.

    The way leads around through complex lengths, as real solutions merge on a straight one.
    """
    own = own_start_set(design).parameters
    start = StartSet(_moved(own, design, before), known)
    target = _moved(own, design, joints)
    size = float(np.abs(target.rho2 - start.parameters.rho2).max())
    return _solve(start, target, real=True, bend=size * _BEND, control=_QUICK)


def _moved(own: Parameters, design: FiveRPURDesign, joints: ArrayLike) -> Parameters:
    return own._replace(rho2=parameters(design, joints).rho2.astype(complex))


_BEND: Complex = np.exp(1j * np.array([1.0, 2.1, 1.6, 0.7, 1.9]))[:, None]


def _solve(
    start: StartSet,
    target: Parameters,
    *,
    real: bool,
    bend: Complex | None = None,
    control: Control | None = None,
) -> Roots:
    equations = _Equations(start.parameters, target, bend)
    (found,) = solve(equations, start.roots, whole=start.complete, real=real, control=control)
    return found


class _Equations:
    """One target, see `homotopy.solving.Equations`; ``bend``: how the first way leads around."""

    singular = 1e-12
    near = 1e-4

    def __init__(self, start: Parameters, target: Parameters, bend: Complex | None) -> None:
        self._start, self._target, self._bend = start, target, bend

    def way(self, targets: Index, attempt: int) -> Deformation:
        start, target = self._start, self._target
        first = attempt == 0
        around = _only_lengths(self._bend) if first else _around(start, target, attempt)
        return Deformation(start, target, around)

    def polish(self, values: Complex, of: Index, rounds: int = 3) -> tuple[Complex, Array]:
        return polish(self._target, values, rounds=rounds)

    def regularity(self, values: Complex, of: Index) -> Array:
        return regularity(self._target, values)

    def conjugate(self, values: Complex) -> Complex:
        return conjugate(values)

    def infinite(self, values: Complex) -> NDArray[np.bool_]:
        return np.zeros(values.shape[1], dtype=bool)

    def cluster(self, values: Complex, distance: float) -> Index:
        return cluster(values, distance)

    def among(self, values: Complex, known: Complex) -> NDArray[np.bool_]:
        labels = cluster(np.concatenate([known, values], axis=1))
        count = known.shape[1]
        return np.isin(labels[count:], labels[:count])


def _around(start: Parameters, target: Parameters, n: int) -> Parameters:
    """A way around through complex t, which stays within the family."""
    turn = 1j * AROUND[n - 1]
    return Parameters(
        *(
            np.zeros((1, 1)) if a is b else np.asarray(turn * (b - a), dtype=complex)
            for a, b in zip(start, target, strict=True)
        )
    )


def _only_lengths(bend: Complex | None) -> Parameters | None:
    if bend is None:
        return None
    nothing = np.zeros((1, 1))
    return Parameters(*(nothing,) * 7, rho2=bend)


def cluster(values: Complex, distance: float = SAME) -> NDArray[np.intp]:
    """Labels 0 … m − 1 of solutions (10, n): the same for those within a relative distance."""
    count = values.shape[1]
    if count < 2:
        return np.arange(count)
    marks = signature(values)
    order = np.argsort(marks.real)
    sorted_marks, ordered = marks[order], values[:, order]
    scale = distance * (1.0 + np.abs(sorted_marks))
    pairs = [np.zeros((0, 2), dtype=np.intp)]
    for k in range(1, count):  # ends at once unless many share a real part
        near = sorted_marks[k:].real - sorted_marks[:-k].real <= 16.0 * scale[k:]
        if not near.any():
            break
        left = np.flatnonzero(near)
        away = relative_size(ordered[:, left] - ordered[:, left + k], ordered[:, left])
        one = left[away <= distance]
        pairs.append(np.stack([order[one], order[one + k]], axis=1))
    return grouped(count, np.concatenate(pairs))
