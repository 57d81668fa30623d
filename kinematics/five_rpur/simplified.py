"""All same-mode solutions of the nine simplified 5-RPURs: found, counted, and none lost.

The three stages (`kinematics.five_rpur.stages`) give all solutions of almost every length vector.
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

from kinematics.errors import InputError
from kinematics.five_rpur import stages
from kinematics.five_rpur.arrangements import CLASSES, arrangements
from kinematics.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.five_rpur.equations import (
    PHI,
    THETA,
    UNKNOWNS,
    Complex,
    Frame,
    Parameters,
    parameters,
    residuals,
)
from kinematics.five_rpur.polynomial import modulus
from kinematics.spatial import Array, finite

Index = NDArray[np.intp]

_CHUNK = 2048  # sextics at a time: their temporaries stay in the processor's cache
_SAME = 1e-8  # relative; two copies of a simple root agree to rounding
_PROBES = 3  # complex length vectors from which the number of solutions is known

_FIRST, _RATIO, _STEPS = 1e-3, 0.3, 18  # offsets of ρ² on the way back, and how many
_RAYS = 3  # to try
_CLOSED = 1e-11  # of the equations, relative to the squares in them


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
        Configurations (10, M) in the unknowns of `kinematics.five_rpur.equations`, and for each
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
    rho2 = np.square(rho / known.unit)
    size = max(1, _CHUNK // known.machine.sextics)
    parts = [(np.empty((UNKNOWNS, 0), dtype=complex), np.empty(0, dtype=np.intp))]
    for start in range(0, rho2.shape[1], size):
        u, owner = _all(known, rho2[:, start : start + size])
        parts.append((u, owner + start))
    if len(parts) == 2:
        return parts[1]
    return np.concatenate([u for u, _ in parts], axis=1), np.concatenate([o for _, o in parts])


class _Simplified(NamedTuple):
    """What is worked out of a design once: ``fixed`` has no lengths, ``total`` is as `expected`."""

    machine: stages.Machine
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
    machine = stages.Machine.of(fixed, found.groups)
    rng = np.random.default_rng(2011)
    probes = np.exp(rng.normal(size=(LIMBS, _PROBES)) + 1j * rng.normal(size=(LIMBS, _PROBES)))
    _, owner = _without_copies(*stages.solve(machine, probes))
    total = int(np.bincount(owner).max(initial=0))
    return _Simplified(machine, fixed, frame.unit, total) if total else None


def _all(known: _Simplified, rho2: Array) -> tuple[Complex, Index]:
    """All that can be found for ρ² (5, B), with owners in rising order."""
    u, owner = _without_copies(*stages.solve(known.machine, rho2))
    found = np.bincount(owner, minlength=rho2.shape[1])
    rng = np.random.default_rng(2011)
    for _ in range(_RAYS):
        short = np.flatnonzero(found < known.total)
        if not len(short):
            break
        ray = rng.normal(size=(LIMBS, len(short))) + 1j * rng.normal(size=(LIMBS, len(short)))
        limits, of_short = _approached(known, rho2[:, short], ray)
        now = np.bincount(of_short, minlength=len(short))
        better = now > found[short]
        found[short[better]] = now[better]
        kept, added = ~np.isin(owner, short[better]), better[of_short]
        u = np.concatenate([u[:, kept], limits[:, added]], axis=1)
        owner = np.concatenate([owner[kept], short[of_short[added]]])
    order = np.argsort(owner, kind="stable")
    return u[:, order], owner[order]


def _approached(known: _Simplified, rho2: Array, ray: Complex) -> tuple[Complex, Index]:
    """Solutions at ρ² (5, B) as limits of those at ρ² (1 + ε ray), ε → 0; coinciding ones too."""
    m = known.machine
    with np.errstate(all="ignore"):
        ray = ray * rho2.max(axis=0)
        offset = _FIRST
        u, owner = _without_copies(*stages.solve(m, rho2 + offset * ray))
        for _ in range(_STEPS):
            offset *= _RATIO
            stages.polish(m, rho2 + offset * ray, u, owner)
        size = stages.polish(m, rho2, u, owner)
        closed = _misfit(known, rho2, u, owner) < _CLOSED
    u, owner, size = u[:, closed], owner[closed], size[closed]
    # Of two paths that end at one simple solution, one has left its own.
    lost = _copies(u, owner) & (size <= stages.SETTLED)
    return u[:, ~lost], owner[~lost]


def _misfit(known: _Simplified, rho2: Array, u: Complex, owner: Index) -> Array:
    """The largest residual of the equations, relative to the squares in them; (M,)."""
    far = modulus(u)
    extent = np.maximum(far.max(axis=0), 1.0 / far[PHI : THETA + 1].min(axis=0))
    f1, f2 = residuals(known.fixed._replace(rho2=rho2[:, owner]), u)
    worst: Array = np.maximum(modulus(f1), modulus(f2)).max(axis=0) / (1.0 + extent * extent)
    return worst


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
