"""The reachable workspace of an operation mode as a solid, and its parts without a singularity.

Poses are drawn as in `chart`. Volumes in these coordinates are mm³ that compare machines of one
size; they are no volume of places. The solids are marched on a grid, with
vertices on the exact surfaces; edges where strokes meet are cut off by a part of a cell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinematics.arrays import Array, Frozen
from kinematics.facets.solids import Resolution
from kinematics.mechanisms.tripods import polynomial
from kinematics.mechanisms.tripods.chart import from_chart
from kinematics.mechanisms.tripods.design import TripodDesign, mode_sign
from kinematics.mechanisms.tripods.home import reach
from kinematics.mechanisms.tripods.limbs import limb_lengths
from kinematics.solids.csg import BuiltSolid, Solid, finish
from kinematics.solids.isosurfaces import Isosurface, positive_part
from kinematics.solids.partition import partition

_CELLS: dict[Resolution, int] = {"preview": 20, "normal": 40, "fine": 80}
"""Along each side of the box about the workspace."""
_LOOKED = 45  # points along each side of all that there is, to find that box
_STEP = 1e-6  # of h2, of the differences that gradients are made of
_THIN = 1e-3  # of a cell: thinner pieces are scraps


def workspace(design: TripodDesign, mode: str, resolution: Resolution = "normal") -> BuiltSolid:
    """All poses of the mode within the strokes, on both sides of the base.

    Raises:
        ComputationError: manifold3d gave up.
    """
    whole, error = _whole(design, mode, resolution)
    return finish(whole, lambda mesh, volume: error)


def aspects(design: TripodDesign, mode: str, resolution: Resolution = "normal") -> BuiltSolid:
    """The workspace parted where P = 0: in every piece the machine moves without a singularity.

    A piece's sign is that of P.
    """
    whole, error = _whole(design, mode, resolution)
    field = _Field(design, mode, _polynomial)
    if whole.is_empty or whole.bounds is None:
        return partition(whole, None, 1, field, lambda mesh, volume: error)
    low, high = np.array(whole.bounds)
    step = (high - low) / _CELLS[resolution]
    axes = [np.arange(a - 1.5 * s, b + 2.0 * s, s) for a, b, s in zip(low, high, step, strict=True)]
    values = _on_grid(field, axes)
    sign = 1 if (values > 0.0).sum() <= (values < 0.0).sum() else -1
    if not ((values > 0.0).any() and (values < 0.0).any()):
        return partition(whole, None, -sign, field, lambda mesh, volume: error)
    other = _Field(design, mode, _polynomial, sign)
    cutter = positive_part(axes, sign * values, other)
    cell = float(step.max())
    return partition(
        whole,
        cutter,
        sign,
        field,
        lambda mesh, volume: error,
        thinnest=_THIN * cell,
        reach=2.0 * cell,
    )


@dataclass(frozen=True, eq=False)
class LocusSurface(Frozen):
    """The actuation singularities over all altitudes of a range, as an open mesh in the chart.

    Attributes:
        vertices: (V, 3) mm, see `to_chart`.
        faces: (T, 3) indices into ``vertices``.
        residual: (V,) mm, |P| / |∇P| at the vertices.
    """

    vertices: Array
    faces: np.ndarray
    residual: Array


def locus_surface(
    design: TripodDesign,
    mode: str,
    low: float,
    high: float,
    resolution: Resolution = "normal",
) -> LocusSurface:
    """P = 0 for altitudes from ``low`` to ``high`` and all tilts below π, as a mesh for export."""
    rim = np.pi * design.platform_radius
    count = _CELLS[resolution] + 1
    across = np.linspace(-rim, rim, count)
    axes = [across, across, np.linspace(low, high, count)]
    field = _Field(design, mode, _polynomial)
    values = _on_grid(field, axes)
    out = np.hypot(*np.meshgrid(across, across, indexing="ij")) > rim
    values[out] = np.nan
    found: Isosurface = positive_part(axes, values, field)
    kept = found.faces[found.on_zero]
    used, packed = np.unique(kept, return_inverse=True)
    return LocusSurface(
        found.vertices[used], packed.reshape(-1, 3), np.nan_to_num(found.residual[used])
    )


# --- inside --------------------------------------------------------------------------------


_Function = Callable[[TripodDesign, str, Array], Array]


class _Field:
    """A function of the chart's points with its gradient, for `isosurfaces`."""

    def __init__(self, design: TripodDesign, mode: str, function: _Function, sign: int = 1) -> None:
        self._design, self._mode, self._function, self._sign = design, mode, function, sign

    def values(self, points: Array) -> Array:
        value: Array = self._sign * self._function(self._design, self._mode, points)
        return value

    def __call__(self, points: Array) -> tuple[Array, Array]:
        step = _STEP * self._design.platform_radius
        gradient = np.empty(points.shape)
        for n in range(3):
            aside = np.zeros(3)
            aside[n] = step
            up, down = self.values(points + aside), self.values(points - aside)
            gradient[:, n] = (up - down) / (2.0 * step)
        return self.values(points), gradient


def _room(design: TripodDesign, mode: str, points: Array) -> Array:
    """The least distance to a stroke end, or to the rim at a tilt of π, mm."""
    poses = from_chart(design, points)
    lengths = limb_lengths(design, poses, mode)
    low, high = design.stroke
    room = np.minimum(lengths - low, high - lengths).min(axis=-1)
    room = np.where(np.isfinite(room), room, -high)
    rim = design.platform_radius * (np.pi - poses[..., 1])
    return np.asarray(np.minimum(np.maximum(room, -high), rim))


def _polynomial(design: TripodDesign, mode: str, points: Array) -> Array:
    """P / h1², mm."""
    z, tilt, azimuth = np.moveaxis(from_chart(design, points), -1, 0)
    k = mode_sign(mode) * design.platform_radius
    value = polynomial.value(
        design.mechanism, design.base_radius, k, z, tilt, np.sin(3.0 * azimuth)
    )
    return np.asarray(value / design.base_radius**2)


def _on_grid(field: _Field, axes: list[Array]) -> Array:
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    return field.values(grid.reshape(-1, 3)).reshape(grid.shape[:-1])


def _whole(design: TripodDesign, mode: str, resolution: Resolution) -> tuple[Solid, float]:
    """The workspace's solid and an estimate of the error of its volume: what half the cells
    change, which falls with the square of the cells."""
    field = _Field(design, mode, _room)
    box = _box(design, field)
    if box is None:
        return Solid.from_mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int)), 0.0
    solids = []
    for cells in (_CELLS[resolution], _CELLS[resolution] // 2):
        axes = [np.linspace(a, b, cells + 1) for a, b in zip(*box, strict=True)]
        found = positive_part(axes, _on_grid(field, axes), field)
        solids.append(Solid.from_mesh(found.vertices, found.faces))
    fine, coarse = solids
    return fine, abs(fine.volume - coarse.volume)


def _box(design: TripodDesign, field: _Field) -> tuple[Array, Array] | None:
    """Corners of a box about the workspace, as far as a coarse grid and the home show it."""
    rim, top = np.pi * design.platform_radius, reach(design)
    across = np.linspace(-rim, rim, _LOOKED)
    axes = [across, across, np.linspace(-top, top, 2 * _LOOKED + 1)]
    inside = np.argwhere(_on_grid(field, axes) > 0.0)
    if not len(inside):
        return None
    spans = [axis[1] - axis[0] for axis in axes]
    low, high = (
        np.array([axes[n][int(ends[n])] for n in range(3)])
        for ends in (inside.min(axis=0), inside.max(axis=0))
    )
    margin = 1.01 * np.array(spans)  # beyond the rim, where the room is zero
    return low - margin, high + margin
