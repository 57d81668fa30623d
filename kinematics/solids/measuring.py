"""The volume of a solid by columns: an integral over its base that cannot miss anything.

Cells of the base are dropped where they are proven empty, and halved where not enough is known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.arrays import Array
from kinematics.solids.columns import Columned, Ints, lengths

_INNER = np.sqrt(0.6)
_GAUSS = _INNER * np.array([(a, b) for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0)])
_SIMPSON = np.delete(_GAUSS / _INNER, 4, axis=0)
_NODES = np.concatenate([_GAUSS, _SIMPSON])
"""Of a cell from −1 to 1: those of Gauss's rule, and of Simpson's but for the middle."""
_CORNERS = _SIMPSON[[0, 2, 5, 7]]
_NINE = np.array([a * b for a in (5.0, 8.0, 5.0) for b in (5.0, 8.0, 5.0)]) / 324.0
_SAFETY = 2.0
"""Of differences between rules: halving the worst cells leaves those that look better than they
are."""


def _differences() -> Array:
    """Between Gauss's rule of nine points and others of degree 3: a cross and a quincunx of its
    own points, and Simpson's, which sees a kink next to a side."""
    found = np.zeros((3, 17))
    found[:, :9] = _NINE
    for rule, nodes, part in ((0, (1, 3, 5, 7), 5.0 / 18.0), (1, (0, 2, 6, 8), 5.0 / 36.0)):
        found[rule, list(nodes)] -= part
        found[rule, 4] -= 1.0 - 4.0 * part
    simpson = np.array([a * b for a in (1.0, 4.0, 1.0) for b in (1.0, 4.0, 1.0)]) / 36.0
    found[2, 4] -= simpson[4]
    found[2, 9:] -= np.delete(simpson, 4)
    return found


_DIFFERENCES = _differences()

_MOST = 600_000
"""Columns: no volume is worth more."""
_FIRST = 8  # cells along each side of the base


@dataclass(frozen=True)
class Measured:
    """The volume of a solid and how far it may be off, mm³; ± 0 is proven."""

    volume: float
    error: float


def measure(solid: Columned, relative: float, most: int = _MOST) -> Measured:
    """The volume by Gauss's rule over cells of the base, halved until the error is small.

    The error is the sum of the cells' differences between two rules, and of all that may be over
    cells in which no column shows anything and which are not proven empty.

    Args:
        relative: the error wanted, as a part of the volume.
        most: columns to look at; then what is known by then is told with its error.
    """
    cells = first_cells(solid, _FIRST)
    spent = 0
    # First whatever shows something, or is proven empty.
    shown: list[tuple[Array, Array]] = []
    middle, half = cells
    while len(middle) and spent < most // 3:
        possible = lengths(solid, middle, solid.spread(middle, half)) > 0.0
        spent += len(middle)
        middle, half = middle[possible], half[possible]
        seen = lengths(solid, middle) > 0.0
        shown.append((middle[seen], half[seen]))
        middle, half = middle[~seen], half[~seen]
        seen_most = sum(float(bounds(solid, *cell).sum()) for cell in shown)
        if float(bounds(solid, middle, half).sum()) <= 0.1 * relative * seen_most:
            break
        middle, half = halved(solid, middle, half)
    middle = np.concatenate([middle, *(cell[0] for cell in shown)])
    half = np.concatenate([half, *(cell[1] for cell in shown)])
    new = middle, half
    middle, half = np.empty((0, 2)), np.empty((0, 2))
    value, doubt, side = np.empty(0), np.empty(0), np.empty(0, dtype=np.int64)
    while True:
        more, unsure, rough = _integrals(solid, *new)
        spent += 18 * len(more)
        kept = (more > 0.0) | (unsure > 0.0)
        middle, half = np.concatenate([middle, new[0][kept]]), np.concatenate([half, new[1][kept]])
        value, doubt = np.append(value, more[kept]), np.append(doubt, unsure[kept])
        side = np.append(side, rough[kept])
        volume, error = float(value.sum()), float(doubt.sum())
        if error <= relative * volume or spent >= most:
            return Measured(volume, error)
        order = np.argsort(-doubt)
        gone = np.cumsum(doubt[order])
        enough = min(0.8 * error, error - 0.5 * relative * volume)
        count = int(np.searchsorted(gone, enough)) + 1
        chosen, rest = order[:count], order[count:]
        new = _cut(middle[chosen], half[chosen], side[chosen])
        middle, half, value, doubt = middle[rest], half[rest], value[rest], doubt[rest]
        side = side[rest]


def first_cells(solid: Columned, count: int) -> tuple[Array, Array]:
    """Cells that tile the base, ``count`` along each side: middles and half sides, (N, 2) each."""
    (x0, x1), (y0, y1) = solid.base
    half = np.array([x1 - x0, y1 - y0]) / (2.0 * count)
    steps = 2.0 * np.arange(count) + 1.0
    x, y = np.meshgrid(x0 + half[0] * steps, y0 + half[1] * steps, indexing="ij")
    return np.stack([x.ravel(), y.ravel()], axis=-1), np.tile(half, (count * count, 1))


def changes(solid: Columned, middle: Array, half: Array) -> tuple[Array, Array]:
    """(N,) mm by which the limbs' lengths change at most along both sides of cells."""
    none = np.zeros(len(middle))
    one, other = (
        solid.spread(middle, np.stack(sides, axis=-1)).max(axis=1)
        for sides in ((half[:, 0], none), (none, half[:, 1]))
    )
    return one, other


def longer_side(solid: Columned, middle: Array, half: Array) -> Ints:
    """(N,) along which side of cells the limbs' lengths change more: 0 or 1."""
    one, other = changes(solid, middle, half)
    return np.asarray(other > one, dtype=np.int64)


def halved(solid: Columned, middle: Array, half: Array) -> tuple[Array, Array]:
    """Cells cut across the side along which the limbs' lengths change more."""
    return _cut(middle, half, longer_side(solid, middle, half))


def _cut(middle: Array, half: Array, side: Ints) -> tuple[Array, Array]:
    rows = np.arange(len(middle))
    new = half.copy()
    new[rows, side] *= 0.5
    aside = np.zeros_like(middle)
    aside[rows, side] = new[rows, side]
    return np.concatenate([middle - aside, middle + aside]), np.concatenate([new, new])


def bounds(solid: Columned, middle: Array, half: Array) -> Array:
    """(N,) mm³ that there may be over cells at most."""
    corners = [solid.weight(middle + half * corner) for corner in _CORNERS]
    heaviest = np.max([solid.weight(middle), *corners], axis=0)
    slack = solid.spread(middle, half)
    tallest = lengths(solid, middle, slack)
    some = np.flatnonzero(tallest > 0.0)
    tallest[some] = np.minimum(tallest[some], _most_of_one(solid, middle[some], slack[some]))
    return np.asarray(4.0 * half[:, 0] * half[:, 1] * heaviest * tallest)


def _most_of_one(solid: Columned, at: Array, slack: Array) -> Array:
    """(N,) mm that the narrowest limb leaves of a column, on both its sides, P within ± slack."""
    p, _ = solid.limbs(at)
    least, most = np.maximum(np.abs(p) - slack, 0.0), np.abs(p) + slack
    low, high = solid.low, solid.high
    apart = np.sqrt(np.maximum((high - most) * (high + most), 0.0))
    apart = 2.0 * (apart - np.sqrt(np.maximum((low - most) * (low + most), 0.0)))
    joined = np.maximum(least, low)
    joined = 2.0 * np.sqrt(np.maximum((high - joined) * (high + joined), 0.0))
    return np.asarray(np.where(most < low, apart, joined).min(axis=1))


def _integrals(solid: Columned, middle: Array, half: Array) -> tuple[Array, Array, Ints]:
    """The volumes over cells by Gauss's rule of nine points, what they may be off, (N,) mm³, and
    across which side to cut them (N,)."""
    points = (middle[:, None] + half[:, None] * _NODES).reshape(-1, 2)
    height = (lengths(solid, points) * solid.weight(points)).reshape(len(middle), len(_NODES))
    area = 4.0 * half[:, 0] * half[:, 1]
    value = area * (height[:, :9] @ _NINE)
    doubt = _SAFETY * area * np.abs(height @ _DIFFERENCES.T).max(axis=1)
    cell, node = np.nonzero(height[:, :9] <= 0.0)
    if len(cell):  # nothing is seen there: as much as there may be over that ninth of the cell
        hidden = bounds(solid, points.reshape(*height.shape, 2)[cell, node], half[cell] / 3.0)
        doubt = np.maximum(doubt, np.bincount(cell, hidden, len(middle)))
    grid = height[:, :9].reshape(-1, 3, 3)
    bend = [np.abs(np.diff(grid, 2, axis)).sum(axis=(1, 2)) for axis in (1, 2)]
    side = np.where(bend[0] == bend[1], longer_side(solid, middle, half), bend[1] > bend[0])
    return value, doubt, side
