"""The part of a box where a function is positive, as a closed mesh with exact vertices.

Marching tetrahedra: each cell of a grid is six tetrahedra about its long diagonal (Freudenthal
1942), so that the surface is a closed oriented manifold whatever the signs at the nodes. A vertex
lies on an edge at whose ends the signs differ, at the function's zero there: it is exact and never
leaves its edge, so the mesh cannot fold. Nodes that lie nearly on the surface are first moved off
it a little, which keeps vertices apart and faces well shaped. Only cells in which the sign changes
are looked at.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations, product
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.arrays import Array, Frozen, Ints
from kinematics.errors import InputError
from kinematics.zeros import Field, zeros_between

Mask = NDArray[np.bool_]
_T = TypeVar("_T", bound=np.generic)

_NEAR = 0.12  # part of an edge within which a node counts as lying nearly on the surface
_AWAY = 0.2  # part of a cell by which it is moved
_PAD = 1e-3  # part of a cell by which the sides stand outside the box

# The edges of the tetrahedra lead from a node to its upper neighbours in these directions.
_DIRECTIONS = np.array([d for d in product((0, 1), repeat=3) if any(d)])


@dataclass(frozen=True, eq=False)
class Isosurface(Frozen):
    """The closed surface of {F > 0} in a box, counter-clockwise seen from outside of it.

    Attributes:
        vertices: (V, 3).
        faces: (T, 3) indices into ``vertices``.
        on_zero: (T,) whether a face lies on F = 0, as against a side of the box.
        residual: (V,) |F| / |∇F| at the vertices on F = 0, NaN at those on a side.
    """

    vertices: Array
    faces: Ints
    on_zero: Mask
    residual: Array


def positive_part(
    axes: Sequence[ArrayLike],
    values: ArrayLike,
    field: Field,
    *,
    tolerance: float | None = None,
) -> Isosurface:
    """The part of a box in which a continuous function is positive.

    Args:
        axes: the nodes' three coordinates, each increasing, at least two: they may be graded.
        values: (nx, ny, nz) the function at the nodes; a zero counts as positive, and NaN as
            outside of the box.
        field: the function and its gradient anywhere in the box.
        tolerance: how near to the zeros vertices must be, in units of length; by default a
            1e-12th of the box's diagonal, or what rounding in ``field`` allows.

    Returns:
        The surface; no faces where the function is nowhere positive. A side of the box stands
        half a thousandth of a cell outside of it, and one that NaN makes half a cell.

    Raises:
        InputError: axes or values that do not make a grid, or are infinite.
    """
    grid = _Grid.of(axes, values)
    if tolerance is None:
        tolerance = 1e-12 * float(np.linalg.norm([a[-1] - a[0] for a in grid.axes]))
    moved = _moved_off(grid, field)
    lower, upper, vertex_at = _crossings(grid)
    vertices, residual = _placed(grid, moved, field, lower, upper, tolerance)
    faces = _faces(grid, vertex_at)
    on_zero = np.isfinite(residual)[faces].all(axis=1)
    return Isosurface(vertices, faces, np.asarray(on_zero), residual)


# --- the grid ------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Grid:
    """The nodes with one layer more around, where the function counts as negative.

    Nodes are numbered in C order. ``values`` is NaN in the layer.
    """

    axes: tuple[Array, Array, Array]
    shape: tuple[int, int, int]
    values: Array
    positive: Mask

    @classmethod
    def of(cls, axes: Sequence[ArrayLike], values: ArrayLike) -> _Grid:
        given = [np.asarray(a, dtype=float) for a in axes]
        inner = np.asarray(values, dtype=float)
        if len(given) != 3 or any(
            a.ndim != 1 or len(a) < 2 or not (np.diff(a) > 0.0).all() for a in given
        ):
            raise InputError("a grid needs three increasing axes of at least two nodes each")
        if inner.shape != tuple(len(a) for a in given):
            raise InputError(
                f"the values must have the grid's shape {tuple(len(a) for a in given)}, "
                f"got {inner.shape}"
            )
        if np.isinf(inner).any():
            raise InputError("the values at the nodes must not be infinite")
        x, y, z = (
            np.concatenate([[a[0] - _PAD * (a[1] - a[0])], a, [a[-1] + _PAD * (a[-1] - a[-2])]])
            for a in given
        )
        padded = np.pad(inner, 1, constant_values=np.nan)
        with np.errstate(invalid="ignore"):
            positive = padded >= 0.0
        return cls((x, y, z), padded.shape, padded.ravel(), positive.ravel())

    def points(self, nodes: Ints) -> Array:
        """Where nodes (N,) stand, (N, 3)."""
        index = np.unravel_index(nodes, self.shape)
        return np.stack([a[i] for a, i in zip(self.axes, index, strict=True)], axis=-1)

    @property
    def strides(self) -> Ints:
        _, ny, nz = self.shape
        return np.array([ny * nz, nz, 1])

    def ends(self, array: NDArray[_T], direction: Ints) -> tuple[NDArray[_T], NDArray[_T]]:
        """Views of a node array at the lower and upper ends of all edges in a direction."""
        whole = array.reshape(self.shape)
        low = tuple(slice(None, -1) if d else slice(None) for d in direction)
        high = tuple(slice(1, None) if d else slice(None) for d in direction)
        return whole[low], whole[high]


def _moved_off(grid: _Grid, field: Field) -> tuple[Ints, Array]:
    """Nodes that stand nearly on the surface, and where they are moved to; values follow."""
    near = np.zeros(len(grid.values), dtype=bool)
    size = np.abs(grid.values)
    for direction in _DIRECTIONS:
        a, b = grid.ends(size, direction)
        pa, pb = grid.ends(grid.positive, direction)
        change = np.nonzero((pa != pb) & np.isfinite(a + b))
        lower = np.ravel_multi_index(change, grid.shape)
        upper = lower + direction @ grid.strides
        fa, fb = size[lower], size[upper]
        near[lower[fa <= _NEAR * (fa + fb)]] = True
        near[upper[fb <= _NEAR * (fa + fb)]] = True
    nodes = np.flatnonzero(near)
    if not len(nodes):
        return nodes, np.empty((0, 3))
    index = np.stack(np.unravel_index(nodes, grid.shape), axis=-1)
    points = grid.points(nodes)
    _, gradient = field(points)
    room = np.empty_like(points)
    for k, (axis, count) in enumerate(zip(grid.axes, grid.shape, strict=True)):
        i = index[:, k]
        room[:, k] = np.minimum(axis[i] - axis[i - 1], axis[i + 1] - axis[i])
        room[(i == 1) | (i == count - 2), k] = 0.0  # a side stays where it is
    uphill = gradient * room
    length = np.linalg.norm(uphill, axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        uphill = np.where(np.isfinite(length) & (length > 0.0), uphill / length, 0.0)
    side = np.where(grid.positive[nodes], 1.0, -1.0)
    there = points + _AWAY * side[:, None] * uphill * room
    value, _ = field(there)
    better = side * value > size[nodes]
    grid.values[nodes[better]] = value[better]
    return nodes[better], there[better]


# --- vertices ------------------------------------------------------------------------------------


def _crossings(grid: _Grid) -> tuple[Ints, Ints, Ints]:
    """The edges at whose ends the signs differ, by their lower and upper nodes (E,).

    Also (7, nodes): the number of the edge that leads from a node in each direction, or −1.
    """
    lower, upper = [], []
    number = np.full((len(_DIRECTIONS), len(grid.values)), -1, dtype=np.int64)
    count = 0
    for k, direction in enumerate(_DIRECTIONS):
        a, b = grid.ends(grid.positive, direction)
        nodes = np.ravel_multi_index(np.nonzero(a != b), grid.shape).astype(np.int64)
        number[k, nodes] = count + np.arange(len(nodes))
        count += len(nodes)
        lower.append(nodes)
        upper.append(nodes + direction @ grid.strides)
    return np.concatenate(lower), np.concatenate(upper), number


def _placed(
    grid: _Grid,
    moved: tuple[Ints, Array],
    field: Field,
    lower: Ints,
    upper: Ints,
    tolerance: float,
) -> tuple[Array, Array]:
    """The vertices (E, 3) and their residuals."""
    a, b = grid.points(lower), grid.points(upper)
    nodes, there = moved
    if len(nodes):
        for ends, points in ((lower, a), (upper, b)):
            at = np.minimum(np.searchsorted(nodes, ends), len(nodes) - 1)
            hit = nodes[at] == ends
            points[hit] = there[at[hit]]
    fa, fb = grid.values[lower], grid.values[upper]
    within = np.isfinite(fa + fb)
    vertices = 0.5 * (a + b)
    residual = np.full(len(vertices), np.nan)
    vertices[within], residual[within] = zeros_between(
        field, a[within], b[within], fa[within], fb[within], tolerance
    )
    return vertices, residual


# --- faces ---------------------------------------------------------------------------------------


@lru_cache(maxsize=1)
def _table() -> tuple[Ints, Ints, Ints]:
    """The tetrahedra of a cell and their faces.

    Returns:
        corners (6, 4, 3) of the tetrahedra in units of the cell; how many faces each has by the
        signs of its corners (6, 16), bit k set where corner k is positive; and the faces (6, 16,
        2, 3, 4): each corner is an edge's lower node (3 numbers) and direction.
    """
    unit = np.eye(3, dtype=np.int64)
    corners = np.array(
        [np.cumsum([np.zeros(3, np.int64), *unit[list(p)]], axis=0) for p in permutations(range(3))]
    )
    counts = np.zeros((6, 16), dtype=np.int64)
    faces = np.zeros((6, 16, 2, 3, 4), dtype=np.int64)
    for k, tetrahedron in enumerate(corners):
        for code in range(1, 15):
            plus = [n for n in range(4) if code >> n & 1]
            minus = [n for n in range(4) if not code >> n & 1]
            if len(plus) == 2:
                (i, j), (m, n) = plus, minus
                ring = [(i, m), (i, n), (j, n), (j, m)]
                triangles = [ring[:3], [ring[0], *ring[2:]]]
            else:
                triangles = [[(i, m) for i in plus for m in minus]]
            out = tetrahedron[minus].mean(axis=0) - tetrahedron[plus].mean(axis=0)
            for n, triangle in enumerate(triangles):
                middle = np.array([tetrahedron[list(edge)].mean(axis=0) for edge in triangle])
                normal = np.cross(middle[1] - middle[0], middle[2] - middle[0])
                for m, edge in enumerate(triangle if normal @ out > 0.0 else triangle[::-1]):
                    lower, upper = sorted(edge)  # corners are in order along a tetrahedron
                    direction = tetrahedron[upper] - tetrahedron[lower]
                    which = np.flatnonzero((direction == _DIRECTIONS).all(axis=1))[0]
                    faces[k, code, n, m] = *tetrahedron[lower], which
            counts[k, code] = len(triangles)
    return corners, counts, faces


def _faces(grid: _Grid, vertex_at: Ints) -> Ints:
    """The faces (T, 3) of all tetrahedra in which signs differ."""
    corners, counts, table = _table()
    count = np.zeros(tuple(n - 1 for n in grid.shape), dtype=np.int8)
    whole = grid.positive.reshape(grid.shape)
    for corner in product((slice(None, -1), slice(1, None)), repeat=3):
        count += whole[corner]
    cells = np.ravel_multi_index(np.nonzero((count > 0) & (count < 8)), grid.shape)
    strides = grid.strides
    found = []
    for k in range(len(corners)):
        nodes = cells[:, None] + corners[k] @ strides
        code = grid.positive[nodes] @ np.array([1, 2, 4, 8])
        for n in range(2):
            some = counts[k, code] > n
            edges = table[k, code[some], n]  # (N, 3, 4)
            lower = cells[some, None] + edges[..., :3] @ strides
            found.append(vertex_at[edges[..., 3], lower])
    return np.concatenate(found)
