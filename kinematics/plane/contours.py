"""The curves on which a function of two variables vanishes, with exact points.

A grid tells which way the curves run; each of their points lies on an edge of the grid, at the
function's zero there.
"""

from __future__ import annotations

from dataclasses import dataclass

import contourpy
import numpy as np

from kinematics.arrays import Array, Frozen, Ints
from kinematics.zeros import Field, zeros_between


@dataclass(frozen=True, eq=False)
class Contours(Frozen):
    """Curves: curve c is points[start[c]:start[c + 1]], closed if its ends are equal.

    Attributes:
        points: (N, 2).
        start: (C + 1,).
        residual: (N,) |f| / |∇f|.
    """

    points: Array
    start: Ints
    residual: Array


def zero_curves(
    x: Array, y: Array, values: Array, field: Field, tolerance: float | None = None
) -> Contours:
    """The curves f = 0 in a rectangle.

    Args:
        x, y: the nodes' coordinates, each increasing; they may be graded.
        values: (nx, ny) the function at the nodes.
        field: the function and its gradient (N, 2) at points (N, 2).
        tolerance: how near to the zeros points must be, in units of ``x``; by default a 1e-13th
            of the rectangle's diagonal, or what rounding in ``field`` allows.
    """
    if tolerance is None:
        tolerance = 1e-13 * float(np.hypot(x[-1] - x[0], y[-1] - y[0]))
    # No node lies exactly on a curve: it counts as being a little on the positive side of it.
    values = np.where(values == 0.0, np.finfo(float).tiny, values)
    lines = contourpy.contour_generator(x, y, values.T).lines(0.0)
    found = [np.asarray(line, dtype=float) for line in lines]
    if not found:
        return Contours(np.empty((0, 2)), np.zeros(1, np.int64), np.empty(0))
    points = np.concatenate(found)
    start = np.concatenate([[0], np.cumsum([len(line) for line in found])]).astype(np.int64)
    (i, across), (j, along) = (_nearest(axis, points[:, k]) for k, axis in enumerate((x, y)))
    # The edge on which a point lies runs along the axis on whose nodes it does not stand.
    upright = across <= along
    i0, j0 = (_below(axis, points[:, k]) for k, axis in enumerate((x, y)))
    first = np.where(upright, i, i0), np.where(upright, j0, j)
    last = np.where(upright, i, i0 + 1), np.where(upright, j0 + 1, j)
    a, b = (np.stack([x[u], y[v]], axis=-1) for u, v in (first, last))
    fa, fb = values[first], values[last]
    differ = (fa > 0.0) != (fb > 0.0)
    residual = np.empty(len(points))
    points[differ], residual[differ] = zeros_between(
        field, a[differ], b[differ], fa[differ], fb[differ], tolerance
    )
    if not differ.all():
        value, gradient = field(points[~differ])
        residual[~differ] = np.abs(value) / np.maximum(np.linalg.norm(gradient, axis=1), 1e-300)
    return Contours(points, start, residual)


def _nearest(axis: Array, at: Array) -> tuple[Ints, Array]:
    """The nearest node, and how far it is in steps."""
    low = _below(axis, at)
    part = (at - axis[low]) / (axis[low + 1] - axis[low])
    return np.where(part < 0.5, low, low + 1), np.minimum(np.abs(part), np.abs(1.0 - part))


def _below(axis: Array, at: Array) -> Ints:
    return np.clip(np.searchsorted(axis, at, side="right") - 1, 0, len(axis) - 2)
