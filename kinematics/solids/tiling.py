"""The base of a solid by columns, tiled by cells that are halved where more must be known.

Corners of cells are on a lattice, so that equal places are equal numbers. Every cell is a fan of
triangles about its middle with a corner wherever a neighbour has one: together they have no gaps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.solids.columns import Columned, Ints

HALVINGS = 21
"""How often a side of the first cells can be halved."""
_UNIT = 1 << (HALVINGS + 1)


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles of the base, counter-clockwise.

    Attributes:
        vertices: (V, 2) places on the lattice, each once: what closes is at its beginning.
        corners: (T, 3) numbers of vertices.
        places: (T, 3, 2) where the corners are on the lattice, without a jump where it closes.
        cell: (T,) whose they are.
        torn: (V,) −1 or +1 for what is left or right of the tear, on it; else 0.
        twin: (W, 2) vertices at one place of the tear, the left one first.
    """

    vertices: Ints
    corners: Ints
    places: Ints
    cell: Ints
    torn: Ints
    twin: Ints


class Tiling:
    """Cells (N, 2) by their low corners and sizes on the lattice."""

    def __init__(self, solid: Columned, first: tuple[int, int]) -> None:
        self.solid = solid
        (x0, x1), (y0, y1) = solid.base
        self.shape = np.array(first, dtype=np.int64) * _UNIT
        self._origin = np.array([x0, y0])
        self._step = np.array([x1 - x0, y1 - y0]) / self.shape
        corner = np.stack(np.meshgrid(*(np.arange(n) for n in first), indexing="ij"), axis=-1)
        self.low: Ints = corner.reshape(-1, 2).astype(np.int64) * _UNIT
        self.size: Ints = np.full_like(self.low, _UNIT)
        self.tear = None
        if solid.tear is not None:
            self.tear = round((solid.tear - x0) / float(self._step[0]))

    def points(self, places: Ints) -> Array:
        """Base points of places (..., 2) on the lattice."""
        return np.asarray(self._origin + places * self._step)

    def middles(self) -> Array:
        return self.points(self.low + self.size // 2)

    def halves(self) -> Array:
        return np.asarray(0.5 * self.size * self._step)

    def split(self, chosen: NDArray[np.intp], side: Ints) -> NDArray[np.bool_]:
        """Halves cells across their sides 0 or 1; those that cannot be halved stay. Which were.

        The other halves come last, in the order of ``chosen``.
        """
        able = self.size[chosen, side] >= 4
        chosen, side = chosen[able], side[able]
        size = self.size[chosen].copy()
        rows = np.arange(len(chosen))
        size[rows, side] //= 2
        other = self.low[chosen].copy()
        other[rows, side] += size[rows, side]
        self.size[chosen] = size
        self.low, self.size = np.concatenate([self.low, other]), np.concatenate([self.size, size])
        return np.asarray(able)

    def keep(self, kept: NDArray[np.bool_]) -> None:
        self.low, self.size = self.low[kept], self.size[kept]

    # --- triangles

    def triangles(self) -> Triangles:
        """The fans of all cells; those at a pole have nothing along it."""
        low, high = self.low, self.low + self.size
        lines = _Lines(self, low, high)
        x0, y0, x1, y1 = low[:, 0], low[:, 1], high[:, 0], high[:, 1]
        sides = [
            lines.level(y0, x0, x1, up=True),
            lines.upright(x1, y0, y1, up=True),
            lines.level(y1, x0, x1, up=False),
            lines.upright(x0, y0, y1, up=False),
        ]
        counts = np.stack([side.count for side in sides], axis=1)
        ends = np.cumsum(counts.ravel())
        begins = (ends - counts.ravel()).reshape(counts.shape)
        ring = np.empty((int(ends[-1]) if len(ends) else 0, 2), dtype=np.int64)
        for k, side in enumerate(sides):
            own = np.arange(int(side.count.sum())) - np.repeat(
                np.cumsum(side.count) - side.count, side.count
            )
            ring[np.repeat(begins[:, k], side.count) + own] = side.places(own)
        total = counts.sum(axis=1)
        cell = np.repeat(np.arange(len(low)), total)
        after = np.arange(1, len(ring) + 1)
        last = np.cumsum(total) - 1
        after[last] = begins[:, 0]
        places = np.stack([(low + self.size // 2)[cell], ring, ring[after]], axis=1)
        return self._numbered(places, cell)

    def _numbered(self, places: Ints, cell: Ints) -> Triangles:
        x, y = places[..., 0], places[..., 1].copy()
        if self.solid.closed:
            y %= self.shape[1]
        if self.solid.pole:
            y[x == 0] = 0
        torn = np.zeros_like(x)
        if self.tear is not None:
            left = (self.low[cell, 0] < self.tear)[:, None]
            torn = np.where(x == self.tear, np.where(left, -1, 1), 0)
        key = (x * (self.shape[1] + 1) + y) * 3 + (torn + 1)
        known, first, number = np.unique(key, return_index=True, return_inverse=True)
        corners = number.reshape(key.shape)
        keep = (corners[:, 1] != corners[:, 2]) & (corners[:, 0] != corners[:, 1])
        vertices = np.stack([x.ravel()[first], y.ravel()[first]], axis=-1)
        side = torn.ravel()[first]
        pairs = np.flatnonzero(
            (side[:-1] == -1) & (side[1:] == 1) & (known[:-1] // 3 == known[1:] // 3)
        )
        return Triangles(
            vertices,
            corners[keep],
            places[keep],
            cell[keep],
            side,
            np.stack([pairs, pairs + 1], axis=-1),
        )


@dataclass(frozen=True, eq=False)
class _Side:
    """The corners along one side of cells, without the last one."""

    count: Ints
    start: Ints
    step: int
    table: Ints

    def places(self, own: Ints) -> Ints:
        found: Ints = self.table[np.repeat(self.start, self.count) + self.step * own]
        return found


class _Lines:
    """All corners, in order along upright and along level lines of the lattice."""

    def __init__(self, tiling: Tiling, low: Ints, high: Ints) -> None:
        corners = np.concatenate(
            [low, high, np.stack([low[:, 0], high[:, 1]], 1), np.stack([high[:, 0], low[:, 1]], 1)]
        )
        width, height = (int(n) + 1 for n in tiling.shape)
        if tiling.solid.closed:  # both ends are one line
            top = tiling.shape[1]
            begin, end = corners[corners[:, 1] == 0], corners[corners[:, 1] == top]
            shift = np.array([0, top])
            corners = np.concatenate([corners, begin + shift, end - shift])
        self._width, self._height = width, height
        self._up = np.unique(corners[:, 0] * height + corners[:, 1])
        self._along = np.unique(corners[:, 1] * width + corners[:, 0])

    def upright(self, x: Ints, y0: Ints, y1: Ints, *, up: bool) -> _Side:
        first, last = (np.searchsorted(self._up, x * self._height + y) for y in (y0, y1))
        table = np.stack(np.divmod(self._up, self._height), axis=-1)
        return _Side(last - first, first if up else last, 1 if up else -1, table)

    def level(self, y: Ints, x0: Ints, x1: Ints, *, up: bool) -> _Side:
        first, last = (np.searchsorted(self._along, y * self._width + x) for x in (x0, x1))
        table = np.stack(np.divmod(self._along, self._width)[::-1], axis=-1)
        return _Side(last - first, first if up else last, 1 if up else -1, table)
