"""All same-mode solutions of the nine simplified 5-RPURs: found, counted, and none lost.

The three stages (`forward.stages`) give all solutions of almost every length vector.
They lose some where a resultant has a double root though the solutions are simple (a base line
of a pair parallel to e2, d_2 ∥ d_3 in the y'z' plane), where solutions coincide, or where one
θ belongs to a whole curve of them. That shows in the count; such lengths are solved a little off,
at complex ρ², and approached from there along a ray. No solution is singular on almost every
ray but at its end.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.arrangements import CLASSES, arrangements
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.forward import stages
from kinematics.mechanisms.five_rpur.forward.equations import (
    PHI,
    THETA,
    UNKNOWNS,
    Complex,
    Frame,
    Parameters,
    matrix,
    parameters,
    residuals,
    steps,
    terms,
)
from kinematics.mechanisms.five_rpur.forward.linkage import Machine
from kinematics.mechanisms.five_rpur.forward.polynomial import modulus

Index = NDArray[np.intp]

_CHUNK = 2048  # sextics at a time: their temporaries stay in the processor's cache
_SAME = 1e-8  # relative; two copies of a simple root agree to rounding
_PROBES = 3  # complex length vectors from which the number of solutions is known

_STARTS, _LAST = (-5, -7, -3), -11  # log10 of the first offsets of ρ² to try, and of the last
_FAR, _LEAVES = 100.0, 0.9  # so far out, and changing so much, a solution runs off
_SHORTEST = 4  # shortest steps at the end of a ray; two do
_SINGULAR = 1e-6  # ratio of singular values of the equations' linear parts
_CLOSED = 1e-12  # of the equations, relative to the squares in them


def expected(design: FiveRPURDesign) -> int | None:
    """How many same-mode solutions almost every length vector has, complex ones counted.

    That of the design's class in `arrangements.CLASSES`, but fewer for some special designs: 64
    instead of 96 where two of the three platform points of the y'z' plane coincide.

    Returns:
        None for a design that is none of the nine simplified ones, or architecturally singular.
    """
    known = _simplified(design)
    return known and known.total


def same_mode_roots(design: FiveRPURDesign, joints: ArrayLike) -> tuple[Complex, Index]:
    """All solutions, real and complex, in which each group of limbs stands in one working mode.

    Args:
        design: one of the nine simplified ones, see `expected`.
        joints: (..., 5) mm, of one or more length vectors, B altogether.

    Returns:
        Configurations (10, M) in the unknowns of `forward.equations`, and for each
        the number of its length vector, rising, (M,). Solutions that coincide are all there.
        Fewer than `expected` for a length vector: some are at infinity, or were not found.

    Raises:
        InputError: the design is not simplified; not five finite lengths each.
    """
    rho = finite(joints, name="the joints", last=LIMBS).reshape(-1, LIMBS).T
    known = _simplified(design)
    if known is None:
        raise InputError(
            "the design is none of the nine simplified ones: two pairs of limbs, or three limbs, "
            "must satisfy the conditions of a simplified arrangement"
        )
    size = max(1, _CHUNK // known.machine.sextics)
    parts = [(np.empty((UNKNOWNS, 0), dtype=complex), np.empty(0, dtype=np.intp))]
    with np.errstate(all="ignore"):  # what goes wrong is not finite, or shows in the count
        rho2 = np.square(rho / known.unit)
        for start in range(0, rho2.shape[1], size):
            u, owner = _all(known, rho2[:, start : start + size])
            parts.append((u, owner + start))
    if len(parts) == 2:
        return parts[1]
    return np.concatenate([u for u, _ in parts], axis=1), np.concatenate([o for _, o in parts])


class _Simplified(NamedTuple):
    """What is worked out of a design once: ``fixed`` has no lengths, ``total`` is as `expected`."""

    machine: Machine
    fixed: Parameters
    unit: float
    total: int


@lru_cache(maxsize=64)
def _simplified(design: FiveRPURDesign) -> _Simplified | None:
    found = arrangements(design)
    if found.name not in CLASSES or found.reasons:
        return None
    frame = Frame.of(design)
    fixed = parameters(design, np.zeros(LIMBS), frame)
    machine = Machine.of(fixed, found.groups)
    rng = np.random.default_rng(2011)
    probes = np.exp(rng.normal(size=(LIMBS, _PROBES)) + 1j * rng.normal(size=(LIMBS, _PROBES)))
    with np.errstate(all="ignore"):
        _, owner = _without_copies(*stages.solve(machine, probes))
    total = int(np.bincount(owner).max(initial=0))
    return _Simplified(machine, fixed, frame.unit, total) if total else None


def _all(known: _Simplified, rho2: Array) -> tuple[Complex, Index]:
    """All that can be found for ρ² (5, B), with owners in rising order."""
    u, owner = _without_copies(*stages.solve(known.machine, rho2))
    found = np.bincount(owner, minlength=rho2.shape[1])
    rng = np.random.default_rng(2011)
    for start in _STARTS:
        # Too many, where a double root came apart and its halves' conjugates were added.
        short = np.flatnonzero(found != known.total)
        if not len(short):
            break
        ray = rng.normal(size=(LIMBS, len(short))) + 1j * rng.normal(size=(LIMBS, len(short)))
        limits, of_short = _approached(known, rho2[:, short], ray, start)
        now = np.bincount(of_short, minlength=len(short))
        better = np.abs(now - known.total) < np.abs(found[short] - known.total)
        found[short[better]] = now[better]
        kept, added = ~np.isin(owner, short[better]), better[of_short]
        u = np.concatenate([u[:, kept], limits[:, added]], axis=1)
        owner = np.concatenate([owner[kept], short[of_short[added]]])
    order = np.argsort(owner, kind="stable")
    return u[:, order], owner[order]


def _approached(known: _Simplified, rho2: Array, ray: Complex, start: int) -> tuple[Complex, Index]:
    """Solutions at ρ² (5, B) as limits of those at ρ² (1 + ε ray), ε → 0; coinciding ones too."""
    m = known.machine
    ray = ray * rho2.max(axis=0)
    first, *offsets = np.logspace(start, _LAST, start - _LAST + 1)
    u, owner = _without_copies(*stages.solve(m, rho2 + first * ray))
    for offset in offsets:
        before = u.copy()
        stages.polish(m, rho2 + offset * ray, u, owner)
        far = np.maximum(_extent(before), _extent(u)) > _FAR
        moved = (modulus(u - before) / (1.0 + modulus(before))).max(axis=0)
        held = ~(far & ~(moved < _LEAVES))
        u, owner = u[:, held], owner[held]
    g = known.fixed._replace(rho2=rho2[:, owner])
    u, misfit = _closed(m, g, rho2, u, owner)
    good = misfit < _CLOSED
    u, owner, g = u[:, good], owner[good], g.take(np.flatnonzero(good))
    # Of two paths that end at one simple solution, one has left its own.
    copies = np.flatnonzero(_copies(u, owner))
    lost = copies[~_singular(g.take(copies), u[:, copies])]
    return np.delete(u, lost, axis=1), np.delete(owner, lost)


def _closed(
    m: Machine, g: Parameters, rho2: Array, u: Complex, owner: Index
) -> tuple[Complex, Array]:
    """Solutions next to u (10, M) as exact as they can be, and their misfit (M,).

    Newton's method does for simple solutions and for isolated ones that coincide; where a curve
    of them passes, its steps along the curve are arbitrary, and the shortest ones do.
    """
    newton, shortest = u.copy(), u
    stages.polish(m, rho2, newton, owner)
    for _ in range(_SHORTEST):
        f = residuals(g, shortest)
        shortest = shortest + steps(shortest, terms(g, shortest), f, solve=_shortest)[0]
    misfits = _misfit(g, newton), _misfit(g, shortest)
    better = misfits[1] < misfits[0]
    return np.where(better, shortest, newton), np.where(better, misfits[1], misfits[0])


def _shortest(rows: Complex, right: Complex) -> Complex:
    """Of rows (5, 5, M) and right sides (5, K, M): the shortest that fits, (5, K, M)."""
    rows = np.where(np.isfinite(rows), rows, 0.0).transpose(2, 0, 1)
    answer: Complex = np.linalg.pinv(rows, rcond=_SINGULAR) @ right.transpose(2, 0, 1)
    return answer.transpose(1, 2, 0)


def _singular(g: Parameters, u: Complex) -> NDArray[np.bool_]:
    """Where the equations' linear parts are dependent, (M,)."""
    rows = matrix(terms(g, u)).transpose(2, 0, 1)
    values = np.linalg.svd(rows, compute_uv=False)
    return np.asarray(values[:, -1] <= _SINGULAR * values[:, 0])


def _misfit(g: Parameters, u: Complex) -> Array:
    """The largest residual of the equations, relative to the squares in them; (M,)."""
    extent = _extent(u)
    f1, f2 = residuals(g, u)
    worst: Array = np.maximum(modulus(f1), modulus(f2)).max(axis=0) / (1.0 + extent * extent)
    return np.where(np.isfinite(worst), worst, np.inf)


def _extent(u: Complex) -> Array:
    """The largest of all moduli and of 1/|e^{iφ}|, 1/|e^{iθ}|, (M,)."""
    size = modulus(u)
    return np.asarray(np.maximum(size.max(axis=0), 1.0 / size[PHI : THETA + 1].min(axis=0)))


def _without_copies(u: Complex, owner: Index) -> tuple[Complex, Index]:
    copies = _copies(u, owner)
    return (u[:, ~copies], owner[~copies]) if copies.any() else (u, owner)


def _copies(u: Complex, owner: Index) -> NDArray[np.bool_]:
    """Which configurations are the same as another before them, of the same length vector."""
    key = np.zeros(u.shape[1])  # conjugates have the same real parts, so both parts are in it
    for c, v in zip(_WEIGHTS, u, strict=True):
        key += c.real * v.real - c.imag * v.imag
    order = np.lexsort((key, owner))
    key = key[order]
    near = (np.diff(key) < 16 * _SAME * (1.0 + np.abs(key[1:]))) & (np.diff(owner[order]) == 0)
    one, other = order[:-1][near], order[1:][near]
    off = modulus(u[:, one] - u[:, other]) / (1.0 + modulus(u[:, one]))
    answer = np.zeros(u.shape[1], dtype=bool)
    answer[other[off.max(axis=0, initial=0.0) < _SAME]] = True
    return answer


_WEIGHTS = np.exp(1j * (0.7 + 1.9 * np.arange(UNKNOWNS)))
