"""Every complex solution of the forward kinematics of any 5-RPUR, by a parameter homotopy.

A design's own start set is all solutions for its geometry and complex actuator lengths. It is
made once, by following the start set of the design's family (`forward.families`).
From there only the lengths have to move, which takes a few steps a path. How paths are settled
and counted is `kinematics.homotopy.solving`.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.arrays import Array
from kinematics.homotopy.assembly_sets import grouped
from kinematics.homotopy.solving import AROUND, SAME, Roots, solve
from kinematics.homotopy.start_sets import OwnStartSets, grown, made
from kinematics.homotopy.tracking import Control, Index, relative_size
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign, Ties
from kinematics.mechanisms.five_rpur.forward.equations import (
    Complex,
    Deformation,
    Parameters,
    W,
    conjugate,
    extent,
    parameters,
    polish,
    regularity,
    signature,
)
from kinematics.mechanisms.five_rpur.forward.families import (
    StartSet,
    exact,
    kept_set,
    membership,
    start_set,
)

_QUICK = Control(first=0.2)  # from a start set with the same geometry
_NEAR = 10.0  # units within which regular solutions look so
_FAR, _MOST_FAR = 1e3, 1e3  # units, and how much less two solutions out there need to agree
_TIED = 1e-6  # relative difference of w of limbs whose U joints are one

_own: OwnStartSets[Parameters] = OwnStartSets(kept=16)


# --- a design's own start set ---------------------------------------------------------------


def own_start_set(design: FiveRPURDesign) -> StartSet:
    """All solutions for a design's geometry at complex lengths; kept for the next call."""
    return _own.get(_key(design), partial(_kept_or_made, design))


def has_own_start_set(design: FiveRPURDesign) -> bool:
    """The design's own start set is at hand, so that solving it takes a tenth of a second."""
    return _key(design) in _own or kept_set(design) is not None


def _key(design: FiveRPURDesign) -> tuple[object, ...]:
    return tuple((limb.base, limb.platform, limb.link) for limb in design.limbs)


def _kept_or_made(design: FiveRPURDesign) -> StartSet:
    return kept_set(design) or make_own(design)


def make_own(design: FiveRPURDesign) -> StartSet:
    """Follow the family's start set to the design's geometry."""
    member = membership(design)
    start, target = start_set(member), exact(parameters(design, np.zeros(LIMBS)), member)
    target = target._replace(rho2=_complex_lengths(target))
    return made(start, target, _solve(start, target, real=False))


def _complex_lengths(g: Parameters) -> Complex:
    """ρ² of a start set: as long as actuators are, and well away from the real ones."""
    turns = np.array([0.9, -1.3, 0.5, 1.7, -0.7])[:, None]
    size = 1.0 + float(np.mean(np.abs(g.rx) ** 2 + np.abs(g.rz) ** 2))
    sizes = size * np.array([1.1, 0.8, 1.3, 0.9, 1.0])[:, None]
    lengths: Complex = (sizes * np.exp(1j * turns)).astype(complex)
    return lengths


# --- solving --------------------------------------------------------------------------------


def roots_at(design: FiveRPURDesign, joints: ArrayLike, tied: Ties = ()) -> Roots:
    """All complex solutions for actuator lengths (5,), mm; of limbs that are ``tied`` in one mode.

    Limbs of one U joint stay together on every path, so that theirs are paths of their own.
    """

    def forth(start: StartSet) -> list[Roots]:
        some = StartSet(start.parameters, _of_ties(start.roots, tied), start.complete)
        target = _moved(start.parameters, design, joints)
        return [_solve(some, target, real=True, control=_QUICK)]

    def grow(start: StartSet, _: int, found: Roots) -> StartSet | None:
        there = _moved(start.parameters, design, joints)
        known = StartSet(there, found.values[:, : found.regular])
        back = _solve(known, start.parameters, real=False)
        return grown(start, back, cluster, membership(design).family.count)

    (found,) = _own.solve(_key(design), partial(_kept_or_made, design), forth, grow)
    return found


def _of_ties(roots: Complex, tied: Ties) -> Complex:
    """Those of the roots (10, n) in which tied limbs have one U joint."""
    one = np.ones(roots.shape[1], dtype=bool)
    for first, *others in tied:
        w = roots[W][first - 1]
        for i in others:
            one &= np.abs(roots[W][i - 1] - w) <= _TIED * (1.0 + np.abs(w))
    return roots[:, one]


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
        # Far out every solution looks singular; there it counts that Newton's method settles.
        far = np.maximum(extent(values) / _NEAR, 1.0)
        return regularity(self._target, values) * far * far

    def conjugate(self, values: Complex) -> Complex:
        return conjugate(values)

    def infinite(self, values: Complex, goals: Complex) -> NDArray[np.bool_]:
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
    # Far out digits are lost with the square of the size, as `tracking` has it.
    far = np.clip((extent(ordered) / _FAR) ** 2, 1.0, _MOST_FAR)
    scale = distance * far * (1.0 + np.abs(sorted_marks))
    pairs = [np.zeros((0, 2), dtype=np.intp)]
    for k in range(1, count):  # ends at once unless many share a real part
        near = sorted_marks[k:].real - sorted_marks[:-k].real <= 16.0 * scale[k:]
        if not near.any():
            break
        left = np.flatnonzero(near)
        away = relative_size(ordered[:, left] - ordered[:, left + k], ordered[:, left])
        one = left[away <= (distance * far)[left]]
        pairs.append(np.stack([order[one], order[one + k]], axis=1))
    return grouped(count, np.concatenate(pairs))
