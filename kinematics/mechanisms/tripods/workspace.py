"""The reachable workspace of an operation mode as a solid, and its parts without a singularity.

Poses are drawn as in `chart`. Volumes in these coordinates are mm³ that compare machines of one
size; they are no volume of places. What there is is known exactly over every orientation
(`columns`), so that nothing is missed, however thin; vertices are on the true surfaces.

What a 3-SPR can do on both sides of a tilt of 90°, where the chart has all altitudes seen from the
platform on one place, is one piece if the machine can go from one to the other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array, Frozen
from kinematics.facets.solids import Resolution
from kinematics.mechanisms.tripods import polynomial
from kinematics.mechanisms.tripods.chart import from_chart, to_chart
from kinematics.mechanisms.tripods.columns import TripodColumns
from kinematics.mechanisms.tripods.design import TripodDesign, mode_sign
from kinematics.mechanisms.tripods.limbs import limb_lengths
from kinematics.mechanisms.tripods.posing import placement
from kinematics.mechanisms.tripods.statics import wrenches
from kinematics.screws.wrenches import determinant
from kinematics.solids.column_solids import Quality, Shape, parted, shaped, whole
from kinematics.solids.columns import surface_of
from kinematics.solids.csg import BuiltSolid
from kinematics.solids.isosurfaces import Isosurface, positive_part
from kinematics.solids.refining import Fineness

_QUALITY: dict[Resolution, Quality] = {
    "preview": Quality(Fineness((8, 18), 2e-2, 500), exact=1e-2, promised=0.1),
    "normal": Quality(Fineness((12, 36), 6e-4, 6000), exact=2e-4, promised=1e-3),
    "fine": Quality(Fineness((16, 48), 1e-4, 24000), exact=4e-5, promised=2e-4),
}
_CELLS: dict[Resolution, int] = {"preview": 20, "normal": 40, "fine": 80}
"""Along each side of the box about a locus."""
_STEP = 1e-6  # of h2, of the differences that gradients are made of


def workspace(design: TripodDesign, mode: str, resolution: Resolution = "normal") -> BuiltSolid:
    """All poses of the mode within the strokes, on both sides of the base.

    Raises:
        ComputationError: manifold3d gave up.
    """
    return whole(_shape(_bare(design), mode, resolution))


def aspects(design: TripodDesign, mode: str, resolution: Resolution = "normal") -> BuiltSolid:
    """The workspace parted where P = 0: in every piece the machine moves without a singularity.

    A piece's sign is that of the wrenches' determinant.
    """
    bare = _bare(design)
    field = _Field(bare, mode, _polynomial)
    built = parted(_shape(bare, mode, resolution), field, _Limits(bare, mode))
    side = _side(bare, mode)
    return replace(built, pieces=tuple(replace(p, sign=side * p.sign) for p in built.pieces))


def _side(design: TripodDesign, mode: str) -> int:
    """+1 or −1: the sign of the wrenches' determinant where P > 0.

    They differ by ± 6.75 x h³ (see `statics`), which has one sign all over a mode, as x ≥ 0 there.
    So any pose tells it.
    """
    pose = np.array([1.1 * design.base_radius, 0.3, 0.2])
    rows = wrenches(design, placement(design, pose, mode)).rows
    value = _polynomial(design, mode, to_chart(design, pose))
    return int(np.sign(determinant(rows, design.platform_radius)) * np.sign(value))


def _bare(design: TripodDesign) -> TripodDesign:
    """Without its names, so that equal machines are one."""
    return TripodDesign(design.mechanism, design.base_radius, design.platform_radius, design.stroke)


@lru_cache(maxsize=4)
def _shape(design: TripodDesign, mode: str, resolution: Resolution) -> Shape:
    """Parted already, so that a workspace and its aspects are of the same faces."""
    return shaped(TripodColumns(design, mode), _QUALITY[resolution])


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


class _Limits:
    """How far places are from ends of strokes, or from the rim, for `column_solids`."""

    def __init__(self, design: TripodDesign, mode: str) -> None:
        self._design, self._mode = design, mode

    def __call__(self, points: Array, label: NDArray[np.int16]) -> Array:
        poses = from_chart(self._design, points)
        lengths = limb_lengths(self._design, poses, self._mode)
        limb, high = surface_of(label)
        bound = np.where(high, self._design.stroke[1], self._design.stroke[0])
        off = lengths[np.arange(len(points)), np.maximum(limb, 0)] - bound
        return np.asarray(np.where(limb >= 0, off, np.pi - poses[:, 1]))


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
