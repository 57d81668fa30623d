"""Curves of singular poses of the 5-RPUR: in a section of its workspace, and over orientations.

Both charts hold what lies within the reach of all links; the ends of the strokes are not regarded.
Where a link is at its reach, |Y_i| = l_i, its limb is in a serial singularity: in a section these
are the lines y' = w'_iy ± l_i, and over orientations, as Y does not depend on θ, lines φ = const.
Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kinematics.answers.loci import LocusCurve, LocusCurves, LocusSpec
from kinematics.arrays import Array, finite
from kinematics.errors import ComputationError, InputError
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant, at_poses
from kinematics.plane.contours import zero_curves
from kinematics.screws.spatial import wrap_angle

ORIENTATION = LocusSpec(
    "orientation", "Singular orientations at this position", ("φ", "θ"), ("rad", "rad")
)
SECTION = LocusSpec("section", "Singular poses in the section", ("y′", "z′"), ("mm", "mm"))

_NODES = 160  # along y' or over all of φ
_ACROSS = 240  # along z' or θ
_FEW = 7  # every so many nodes tell whether there is anything but zero
_EDGE = 1e-7  # rad from the ends of β, as in `nearest`
_SAME = 1e-12  # part of a limb's size: ends that are one but for rounding


class Loci(SingularitiesFacet[FiveRPURDesign]):
    """The charts, in a section and over orientations."""

    loci: tuple[LocusSpec, ...] = (ORIENTATION, SECTION)

    def locus(
        self, key: str, pose: Sequence[float], mode: str, at: float | None = None
    ) -> LocusCurves:
        """The curves of a chart, one of `loci`.

        Args:
            key: "orientation", at the pose's position; or "section", at the pose's orientation.
            pose: (x, y, z, φ, θ), mm and rad.
            at: x' of the section, mm; None: that of the pose.

        Returns:
            Parallel singularities, det = 0, and serial ones, each with its limb.

        Raises:
            InputError: no such chart, or a pose, mode or ``at`` that are not what they should be.
            ComputationError: every pose of the chart is singular.
        """
        values = finite(pose, name="a pose", last=5)
        if values.shape != (5,):
            raise InputError("a pose must be one row of 5 numbers (x, y, z, φ, θ)")
        if key == SECTION.key:
            return _section(self.design, values, mode, at)
        if key == ORIENTATION.key:
            return _orientation(self.design, values, mode)
        known = " or ".join(spec.key for spec in self.loci)
        raise InputError(f"there is no chart {key!r}; use {known}")


@dataclass(frozen=True, eq=False)
class _Strip:
    """A range of the first coordinate v between ends at which links are at their reach.

    Along it the variable is the angle β of v = middle − half cos β, times half: the determinant
    runs as the square root of the way to such an end, but smoothly in β.
    """

    low: float
    high: float

    @property
    def half(self) -> float:
        return 0.5 * (self.high - self.low)

    def nodes(self, count: int) -> Array:
        return self.half * np.linspace(_EDGE, np.pi - _EDGE, count)

    def place(self, u: Array) -> Array:
        return np.asarray(0.5 * (self.low + self.high) - self.half * np.cos(u / self.half))

    def slope(self, u: Array) -> Array:
        return np.asarray(np.sin(u / self.half))


Value = Callable[[Array, Array], tuple[Array, Array]]
"""F (...,) and its rounding at first and second coordinates (...,)."""


def _trace(
    curves: list[LocusCurve],
    strip: _Strip,
    count: int,
    across: Array,
    value: Value,
    on_grid: Callable[[Array], Array],
) -> bool:
    """Adds the curves F = 0 in a strip; whether F vanishes in all of it.

    ``on_grid`` gives F at all nodes across from first coordinates (N,).
    """
    u = strip.nodes(count)
    some, noise = value(strip.place(u)[::_FEW, None], across[None, ::_FEW])
    if (np.abs(some) <= noise).all():
        return True
    nodes = on_grid(strip.place(u))
    # Slopes by differences tell the way only; where the value is zero is exact all the same.
    tiny = 1e-6 * np.array([strip.half, 0.5 * (across[-1] - across[0])])

    def steep(points: Array) -> tuple[Array, Array]:
        shifts = np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]]) * tiny
        at = points + shifts[:, None]
        found, _ = value(strip.place(at[..., 0]), at[..., 1])
        gradient = np.stack([found[1] - found[2], found[3] - found[4]], axis=-1) / (2.0 * tiny)
        return found[0], gradient

    lines = zero_curves(u, across, nodes, steep)
    points = np.column_stack([strip.place(lines.points[:, 0]), lines.points[:, 1]])
    curves += [
        LocusCurve(points[first:last], lines.residual[first:last])
        for first, last in pairwise(lines.start)
    ]
    return False


def _lines(curves: list[LocusCurve], at: float, across: Array, limbs: Sequence[int]) -> None:
    """Adds the line at a first coordinate where links are at their reach."""
    for limb in limbs:
        points = np.array([[at, across[0]], [at, across[-1]]])
        curves.append(LocusCurve(points, np.zeros(2), "serial", limb))


def _all_singular(where: str) -> ComputationError:
    return ComputationError(
        f"every pose {where} is a parallel singularity: the wrenches of the limbs are dependent "
        "everywhere, so there are no curves"
    )


# --- the section ---------------------------------------------------------------------------------


def _section(design: FiveRPURDesign, pose: Array, mode: str, at: float | None) -> LocusCurves:
    determinant = Determinant.at(design, float(pose[3]), float(pose[4]), mode)
    x = float((pose[:3] @ determinant.turn)[0] if at is None else finite(at, name="x′"))
    wz, reach = determinant.offset[:, 2], design.link + design.stroke[:, 1]
    low, high = float((wz - reach).max()), float((wz + reach).min())
    if low >= high:  # out of reach of some limb; the chart is of poses that close all the same
        low, high = float((wz - reach).min()), float((wz + reach).max())
    bounds = np.array([determinant.span, (low, high)])
    curves: list[LocusCurve] = []
    if not determinant.closes:
        return LocusCurves.of(curves, np.sort(bounds, axis=1))
    strip = _Strip(*determinant.span)
    across = np.linspace(low, high, _ACROSS)

    def value(y: Array, z: Array) -> tuple[Array, Array]:
        y, z = np.broadcast_arrays(y, z)
        points = np.stack([np.full(y.shape, x), y, z], axis=-1)
        return determinant.value(points), determinant.roundoff(points)

    def on_grid(y: Array) -> Array:
        return np.asarray(determinant.on_grid(np.array([x]), y, across)[0])

    if _trace(curves, strip, _NODES, across, value, on_grid):
        raise _all_singular("of this section")
    wy, link = determinant.offset[:, 1], design.link
    for end, ends in zip(determinant.span, (wy - link, wy + link), strict=True):
        close = np.abs(ends - end) <= _SAME * determinant.size
        _lines(curves, end, across, (np.flatnonzero(close) + 1).tolist())
    return LocusCurves.of(curves, bounds)


# --- orientations --------------------------------------------------------------------------------


def _orientation(design: FiveRPURDesign, pose: Array, mode: str) -> LocusCurves:
    sign = inverse.signs(mode, design)
    across = np.linspace(-np.pi, np.pi, _ACROSS + 1)
    curves: list[LocusCurve] = []

    def value(phi: Array, theta: Array) -> tuple[Array, Array]:
        angles = np.stack(np.broadcast_arrays(phi, theta), axis=-1)
        place = np.broadcast_to(pose[:3], (*angles.shape[:-1], 3))
        return at_poses(design, np.concatenate([place, angles], axis=-1), sign)

    def on_grid(phi: Array) -> Array:
        return value(phi[:, None], across[None, :])[0]

    for low, high, at_low, at_high in _closing(design, float(pose[1])):
        strip = _Strip(low, high)
        count = max(24, round(_NODES * (high - low) / (2.0 * np.pi)))
        if _trace(curves, strip, count, across, value, on_grid):
            raise _all_singular("at this position")
        _lines(curves, low, across, at_low)
        _lines(curves, high, across, at_high)
    return LocusCurves.of(curves, np.array([[-np.pi, np.pi], [-np.pi, np.pi]]))


def _closing(design: FiveRPURDesign, y: float) -> list[tuple[float, float, list[int], list[int]]]:
    """The ranges of φ in [−π, π] in which every limb closes, and which limbs end them.

    Y_i = y − r_iy + s_iy cos φ − s_iz sin φ does not depend on θ.
    """
    away = y - design.base[:, 1]
    swing = np.hypot(design.platform[:, 1], design.platform[:, 2])
    lag = np.arctan2(design.platform[:, 2], design.platform[:, 1])  # Y = away + swing cos(φ + lag)
    ends: list[tuple[float, int]] = [(-np.pi, 0), (np.pi, 0)]
    for limb in range(len(away)):
        for reach in (design.link[limb], -design.link[limb]):
            if swing[limb] > 0.0 and abs(reach - away[limb]) < swing[limb]:
                turn = np.arccos((reach - away[limb]) / swing[limb])
                ends += [(float(wrap_angle(way - lag[limb])), limb + 1) for way in (turn, -turn)]
    stations = sorted({phi for phi, _ in ends})
    found: list[tuple[float, float, list[int], list[int]]] = []
    for low, high in pairwise(stations):
        if high - low < 1e-9:
            continue
        middle = away + swing * np.cos(0.5 * (low + high) + lag)
        if not (np.abs(middle) <= design.link).all():
            continue
        first, last = (
            sorted({k for phi, k in ends if k and abs(phi - at) < 1e-9}) for at in (low, high)
        )
        found.append((low, high, first, last))
    return found
