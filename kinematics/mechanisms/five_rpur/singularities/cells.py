"""The determinant at the nodes of a grid about a workspace. Frame x'y'z'; lengths mm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.arrays import Array
from kinematics.facets.solids import Resolution
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from kinematics.solids.isosurfaces import positive_part

CELLS: dict[Resolution, int] = {"preview": 14, "normal": 30, "fine": 60}
"""Along each side of the workspace's box, were it a cube."""

_SOME = 512  # nodes that tell whether F is anything but rounding

_INNER = 1e-9
"""Part of the span of y' that is left out at its ends: there limbs are in serial singularities,
and where two of them are at once the determinant is zero whatever x' and z'."""


class Field:
    """±F and its gradient; within the span, and constant beyond it."""

    def __init__(self, determinant: Determinant, sign: int = 1) -> None:
        low, high = determinant.span
        inner = _INNER * (high - low)
        self._determinant, self._sign = determinant, sign
        self.span = low + inner, high - inner

    def __call__(self, points: Array) -> tuple[Array, Array]:
        held = points.copy()
        held[:, 1] = np.clip(held[:, 1], *self.span)
        value, gradient = self._determinant.value_and_gradient(held)
        gradient[held[:, 1] != points[:, 1], 1] = 0.0
        return self._sign * value, self._sign * gradient


@dataclass(frozen=True, eq=False)
class Cells:
    """A grid about a workspace, and F at its nodes; NaN at those of cells that have nothing of it.

    Attributes:
        axes: x', y', z' of the nodes, mm.
        values: (nx, ny, nz).
    """

    determinant: Determinant
    axes: tuple[Array, Array, Array]
    values: Array

    @classmethod
    def about(
        cls, determinant: Determinant, stroke: Array, box: Array, count: int, margin: float
    ) -> Cells:
        """The grid about the workspace of a mode.

        Args:
            stroke: (5, 2) mm, of the limbs.
            box: (2, 3) the corners of a box about the workspace.
            count: cells along each side of the box, were it a cube.
            margin: mm, by which a mesh of the workspace may stand out of it.
        """
        low, high = box
        side = float(np.prod(np.maximum(high - low, 1e-12))) ** (1.0 / 3.0) / count
        counts = np.clip(np.round((high - low) / side), 4, 4 * count).astype(int)
        step = (high - low) / counts
        x, z = (np.linspace(low[k] - step[k], high[k] + step[k], counts[k] + 3) for k in (0, 2))
        y = _stations(determinant, low[1] - 0.5 * step[1], high[1] + 0.5 * step[1], counts[1] + 2)
        values = determinant.on_grid(x, np.clip(y, *Field(determinant).span), z)
        _mask(values, determinant, stroke, (x, y, z), margin)
        return cls(determinant, (x, y, z), values)

    def vanish(self) -> bool:
        """Whether F is no more than rounding wherever nodes count."""
        index = np.argwhere(np.isfinite(self.values))
        points = np.stack([a[index[:, k]] for k, a in enumerate(self.axes)], axis=-1)
        points[:, 1] = np.clip(points[:, 1], *Field(self.determinant).span)
        some = points[:: max(1, len(points) // _SOME)]
        size, noise = np.abs(self.determinant.value(some)), self.determinant.roundoff(some)
        return bool((size <= noise).all())

    def zeros(self) -> Array:
        """Points (N, 3) on F = 0, at distances of about a cell, in and about the workspace."""
        surface = positive_part(self.axes, self.values, Field(self.determinant))
        return surface.vertices[np.isfinite(surface.residual)]


def _stations(determinant: Determinant, low: float, high: float, count: int) -> Array:
    """Nodes along y', crowded towards ends of the span, and one beyond each end.

    At an end of the span the workspace has a flat side: that lies in the middle of a cell.
    """
    ends = Field(determinant).span
    middle, half = 0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0])
    turn = np.arccos(np.clip((middle - np.array([low, high])) / half, -1.0, 1.0))
    shift = 0.5 * (turn[1] - turn[0]) / count
    first = turn[0] + (shift if turn[0] < shift else 0.0)
    last = turn[1] - (shift if turn[1] > np.pi - shift else 0.0)
    y = middle - half * np.cos(np.linspace(first, last, count))
    step = (high - low) / count
    return np.concatenate([[min(low, y[0] - step)], y, [max(high, y[-1] + step)]])


def _mask(
    values: Array,
    determinant: Determinant,
    stroke: Array,
    axes: tuple[Array, Array, Array],
    margin: float,
) -> None:
    """Sets NaN at nodes farther than a cell from where all limbs are within their strokes."""
    x, y, z = axes
    cell = [float(np.diff(a).max()) for a in (x, z)]
    held = np.clip(y, *Field(determinant).span)
    for (wx, wy, wz), link, sign, (low, high) in zip(
        determinant.offset, determinant.link, determinant.sign, stroke, strict=True
    ):
        h = np.sqrt(np.maximum((link - (held - wy)) * (link + (held - wy)), 0.0))
        jump = np.abs(np.diff(h))
        # h is not monotonic where y' passes w'_y.
        top = (held[:-1] < wy) & (held[1:] > wy)
        jump[top] = np.maximum(link - h[:-1], link - h[1:])[top]
        jump = np.maximum(np.append(jump, 0.0), np.append(0.0, jump))
        slack = np.hypot(cell[0], cell[1] + jump) + margin
        across = (x - wx)[:, None, None] ** 2 + (z - wz - sign * h[:, None]) ** 2
        far = across > ((high + slack) ** 2)[:, None]
        near = across < (np.maximum(low - slack, 0.0) ** 2)[:, None]
        values[far | near] = np.nan
