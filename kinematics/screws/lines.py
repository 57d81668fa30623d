"""Grassmann line geometry: which of some wrenches are dependent, what they have in common, and
which twists do no work on any of them.

Wrenches are rows [F, T about a reference point], twists [ω, v of that point]; lengths mm, angles
rad. Ranks are those of rows of unit size with moments divided by a characteristic length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.screws.varieties import (
    EXACT,
    FLAT,
    Screw,
    Variety,
    isotropic,
    screw,
    spectrum,
    variety,
)
from kinematics.screws.wrenches import normalised

_ALIKE = 1e-6  # singular values below which one free twist is as good as another
_AS_GOOD = 3.0  # a subset explains what is at most so many times as exact


@dataclass(frozen=True, slots=True)
class Circuit:
    """A minimal dependent set: each of its proper subsets is independent.

    Attributes:
        members: which rows, from 0.
        weights: unit vector of their multiples that cancel, rows of unit size.
        measure: what is left of them, their smallest singular value.
        variety: what the members have in common.
    """

    members: tuple[int, ...]
    weights: tuple[float, ...]
    measure: float
    variety: Variety


@dataclass(frozen=True, slots=True)
class Geometry:
    """Rank and dependences of a set of wrenches.

    Attributes:
        rank: singular values at or above the tolerance.
        singular_values: of the normalised rows, largest first.
        circuits: as many as rows can be left out without loss, the smallest first.
        twists: independent twists [ω, v], rad and mm, that do no work on any row, of unit size with
            ω times the characteristic length; translations first and pure turns where there are
            such, or those with the least work first where that is not nothing.
        screws: of each of them.
    """

    rank: int
    singular_values: tuple[float, ...]
    circuits: tuple[Circuit, ...]
    twists: tuple[tuple[float, ...], ...]
    screws: tuple[Screw, ...]


def geometry(
    rows: ArrayLike,
    length: float,
    tolerance: float,
    point: Sequence[float] = (0.0, 0.0, 0.0),
    kept: Sequence[int] = (),
) -> Geometry:
    """Rank, circuits with what they have in common, and reciprocal twists.

    Args:
        rows: (R, 6) wrenches, finite; zero rows are allowed.
        length: mm, the characteristic length, > 0.
        tolerance: singular values of normalised rows below it count as zero.
        point: mm, the reference point of moments and twists.
        kept: rows to which the twists are reciprocal exactly, where others only nearly are.
    """
    unit = normalised(rows, length)
    origin = np.asarray(point, dtype=float)
    values, right = spectrum(unit)
    rank = int((values >= tolerance).sum())
    left = list(range(len(unit)))
    circuits = []
    for _ in range(len(unit) - rank):
        found = _circuit(unit, left, length, tolerance, origin)
        circuits.append(found)
        heaviest = int(np.argmax(np.abs(found.weights)))
        left.remove(found.members[heaviest])
    null = right[rank:] if not kept else _weakest(unit, list(kept), 6 - rank, tolerance)
    exact = len(values) == rank or float(values[rank]) < _ALIKE
    null = _telling(null) if exact else null[::-1]  # the one with the least work first
    free = [np.concatenate([row[3:] / length, row[:3]]) for row in map(_upright_row, null)]
    return Geometry(
        rank=rank,
        singular_values=tuple(values.tolist()),
        circuits=tuple(circuits),
        twists=tuple(tuple(twist.tolist()) for twist in free),
        screws=tuple(screw(twist, length, origin) for twist in free),
    )


# --- circuits ------------------------------------------------------------------------------


def _circuit(
    unit: Array, left: Sequence[int], length: float, tolerance: float, origin: Array
) -> Circuit:
    """The smallest subset of the rows ``left`` that is as dependent as all of them."""
    least = _least(unit[list(left)])
    limit = max(min(EXACT, tolerance), _AS_GOOD * least)
    members = tuple(left[:7])  # any seven are dependent
    for size in range(1, min(len(left), 7)):
        subsets = np.array(list(combinations(left, size)))
        smallest = np.linalg.svd(unit[subsets], compute_uv=False)[:, -1]
        best = int(smallest.argmin())
        if smallest[best] <= limit:
            members = tuple(int(n) for n in subsets[best])
            break
    rows = unit[list(members)]
    weights, values, _ = np.linalg.svd(rows, full_matrices=True)
    measure = _least(rows)
    firm = float(values[len(members) - 2]) if len(members) > 1 else 1.0
    blur = 10.0 * measure / max(firm, 1e-300)
    scaled = rows * np.array([1.0, 1.0, 1.0, length, length, length])
    common = variety(scaled, length, origin, rank=len(members) - 1, blur=blur)
    return Circuit(members, tuple(weights[:, -1].tolist()), measure, common)


def _least(unit: Array) -> float:
    """The smallest of R singular values; 0 where there are more rows than six."""
    if len(unit) > 6:
        return 0.0
    return float(np.linalg.svd(unit, compute_uv=False)[-1])


def _weakest(unit: Array, kept: list[int], count: int, tolerance: float) -> Array:
    """The twists [v, ω length] on which the rows do least work, and the kept ones none."""
    values, right = spectrum(unit[kept])
    allowed = right[int((values >= tolerance).sum()) :]
    others = np.delete(unit, kept, axis=0)
    _, weak = np.linalg.svd(others @ allowed.T, full_matrices=True)[1:]
    return np.asarray(weak[max(len(weak) - count, 0) :] @ allowed)


def _telling(null: Array) -> Array:
    """Another basis of twists [v, ω length]: translations first, turns of two if there are two."""
    if len(null) < 2:
        return null
    left, sizes, _ = np.linalg.svd(null[:, 3:], full_matrices=True)
    sizes = np.concatenate([sizes, np.zeros(len(null) - len(sizes))])
    still = left[:, sizes <= FLAT].T @ null
    turning = left[:, sizes > FLAT].T @ null
    if len(turning) == 2 and not len(still):
        real = isotropic(turning, FLAT)
        if len(real) == 2:
            turning = np.array(real)
    return np.concatenate([still, turning])


def _upright_row(row: Array) -> Array:
    """A twist with the largest component of what it mostly is positive."""
    part = row[3:] if np.linalg.norm(row[3:]) > 1e-9 else row[:3]
    return row if part[int(np.argmax(np.abs(part)))] > 0.0 else -row
