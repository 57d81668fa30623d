"""Exact sections of the 5-RPUR's workspace at x' = const, and its volume.

In x'y'z' the section of limb i's vertex space is bounded by arcs of radius l_i about (w'_iy,
w'_iz ± S(ρ, x' − w'_ix)), ρ = ρ_min and ρ_max, and by the lines y' = w'_iy ± l_i (Tale Masouleh et
al. 2011, eqs. 26-43; areas and moments by Green's theorem, with the factors derived anew). Lengths
mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from kinematics.answers.sections import (
    BOUNDS,
    Box,
    Construction,
    Section,
    SectionSpec,
    Sphere,
    Volume,
)
from kinematics.arrays import Array, Ints, finite
from kinematics.errors import InputError
from kinematics.facets.sections import Modes, SectionsFacet
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.slicing.cutter import Cutter
from kinematics.mechanisms.five_rpur.slicing.events import events
from kinematics.screws.spatial import homogeneous, rotation_y

MOST_SECTIONS = 60_000
"""No volume is worth more sections; what is reached by then is returned with its error."""

_SPECK = 1e-10  # of the volume: a piece that small is due to rounding

# Of the four circles and the four lines that a limb may have.
_OWNER = np.repeat(np.arange(1, LIMBS + 1), 4).reshape(LIMBS, 4)
_LINE_OWNER = _OWNER.reshape(LIMBS, 2, 2)
_BOUND = np.tile(
    [BOUNDS.index(b) for b in ("rho_max", "rho_min", "rho_min", "rho_max")], (LIMBS, 1)
)


class Sections(SectionsFacet[FiveRPURDesign]):
    """Sections at x' = const, their frame is x'y'z'; orientations are (φ, θ)."""

    spec = SectionSpec("Section at x′", "x′", ("y′", "z′"), "Fig. 17")

    def frame(self, pose: Sequence[float]) -> Array:
        """R_y(θ)."""
        return homogeneous(rotation_y(float(pose[4])), np.zeros(3))

    def range(self, pose: Sequence[float], modes: Modes = None) -> tuple[float, float] | None:
        """The limbs' reaches alone decide it: sections may be empty inside it as well."""
        low, high = self._cutter(pose, modes).range
        return (low, high) if high > low else None

    def at(self, pose: Sequence[float], modes: Modes, at: float) -> Section:
        (where,) = finite([at], name="at").tolist()
        return _section(self._cutter(pose, modes), where)

    def volume(
        self,
        pose: Sequence[float],
        modes: Modes = None,
        *,
        relative: float = 1e-6,
        pieces: bool = True,
        between: tuple[float, float] | None = None,
    ) -> Volume:
        """One quadrature over x' of exact section areas.

        The area is a smooth function of x' but for roots, whose places are known, and kinks, where
        the section changes its structure (`slicing.integral`).

        Args:
            pieces: also the pieces and the places where the section changes its structure, which
                take longer than the volume itself; without, there are none in the result.
            between: only what lies between these two x', mm.
        """
        cutter = Cutter(self.design, float(pose[3]), float(pose[4]), modes)
        return _volume(cutter, float(pose[4]), relative, pieces=pieces, between=between)

    def common(
        self,
        pose: Sequence[float],
        modes: Modes,
        others: Sequence[tuple[SectionsFacet[FiveRPURDesign], Modes]],
        *,
        relative: float = 1e-6,
        pieces: bool = True,
    ) -> Volume:
        """The limbs of all machines bound the same sections together."""
        beside = [(facet.design, its) for facet, its in others]
        cutter = Cutter(self.design, float(pose[3]), float(pose[4]), modes, beside)
        return _volume(cutter, float(pose[4]), relative, pieces=pieces)

    def ball(
        self, pose: Sequence[float], modes: Modes = None, center: Sequence[float] | None = None
    ) -> Sphere | None:
        from kinematics.mechanisms.five_rpur.inscribed import largest

        return largest.sphere(self.design, pose[3], pose[4], modes, center)

    def box(
        self, pose: Sequence[float], modes: Modes = None, center: Sequence[float] | None = None
    ) -> Box | None:
        from kinematics.mechanisms.five_rpur.inscribed import largest

        return largest.box(self.design, pose[3], pose[4], modes, center)

    def singularity_free_ball(
        self, pose: Sequence[float], mode: str, center: Sequence[float] | None = None
    ) -> Sphere | None:
        from kinematics.mechanisms.five_rpur.singularities.ball import singularity_free_ball

        return singularity_free_ball(self.design, pose[3], pose[4], mode, center)

    def _cutter(self, pose: Sequence[float], modes: Modes) -> Cutter:
        chosen = None if modes is None else frozenset(modes)
        return _cutter(self.design, float(pose[3]), float(pose[4]), chosen)


@lru_cache(maxsize=64)
def _cutter(
    design: FiveRPURDesign, phi: float, theta: float, modes: frozenset[str] | None
) -> Cutter:
    return Cutter(design, phi, theta, modes)


def _section(cutter: Cutter, at: float) -> Section:
    outline = cutter.outline(at)
    places = outline.places
    area, centroid, second = _about_centroid(outline.moments, cutter.origin)
    return Section(
        at=at,
        start=places[:, :2],
        end=places[:, 2:4],
        limb=outline.whose[:, 0] + 1,
        bound=outline.whose[:, 1],
        center=places[:, 4:6],
        radius=places[:, 6],
        sweep=places[:, 7],
        loop_start=outline.firsts,
        loop_area=outline.areas,
        loop_piece=outline.pieces,
        area=area,
        perimeter=outline.perimeter,
        centroid=centroid,
        second_moments=second,
        construct=partial(_construction, cutter.limbs, outline.low, outline.high),
    )


def _about_centroid(moments: Array, origin: Array) -> tuple[float, Array, Array]:
    area = float(moments[0])
    if not area > 0.0:
        return 0.0, np.full(2, np.nan), np.zeros(3)
    v, w = moments[1:3] / area
    second = moments[3:] - area * np.array([v * v, w * w, v * w])
    return area, origin + np.array([v, w]), second


def _construction(limbs: Array, low: Array, high: Array) -> Construction:
    """All circles and lines of limbs that reach the plane."""
    _, wy, wz, link, _, _ = limbs
    reached, hollow = high >= 0.0, low > 0.0
    # Circles −S_max, −S_min, +S_min, +S_max of every limb; those of ρ_min while they are there.
    center = np.empty((LIMBS, 4, 2))
    center[:, :, 0] = wy[:, None]
    center[:, :, 1] = wz[:, None] + np.stack([-high, -low, low, high], axis=-1)
    there = np.stack([reached, reached & hollow, reached & hollow, reached], axis=-1)
    # A line runs along both bands of a hollow limb, else along the one that there is.
    inner = np.where(hollow[:, None], center[:, 1:3, 1], center[:, 3:, 1])
    line = np.empty((LIMBS, 2, 2, 2, 2))  # limb, band, side, end, (y, z)
    line[..., 0] = (wy[:, None] + np.stack([-link, link], axis=-1))[:, None, :, None]
    line[:, 0, :, 0, 1], line[:, 0, :, 1, 1] = center[:, :1, 1], inner[:, :1]
    line[:, 1, :, 0, 1], line[:, 1, :, 1, 1] = inner[:, 1:], center[:, 3:, 1]
    lines = np.empty((LIMBS, 2, 2), dtype=bool)
    lines[:, 0], lines[:, 1] = reached[:, None], (reached & hollow)[:, None]
    return Construction(
        center[there],
        np.repeat(link, 4)[there.ravel()],
        _OWNER[there],
        _BOUND[there],
        line[lines],
        _LINE_OWNER[lines],
    )


# --- volumes -------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Integral:
    """``moments`` (3,) of the volume (∫ dx' of those of sections), ``first`` = ∫ x' A dx';
    the volume's ``error``; the sections taken, ``at`` (N,) increasing, their ``area`` and ``marks``
    (N,), and the ``weights`` (N, 2) of areas and of their derivatives by x'; ``sections`` were
    computed.
    """

    moments: Array
    first: float
    error: float
    at: Array
    area: Array
    weights: Array
    marks: Ints
    sections: int


def integrate(
    cutter: Cutter, relative: float, between: tuple[float, float] | None = None
) -> Integral:
    """Integrals over x' of the sections' moments, until the volume's error is small enough.

    Raises:
        InputError: the wanted error is not between 1e-12 and 1, or ``between`` not two numbers.
    """
    if not 1e-12 <= relative <= 1.0:
        raise InputError(f"the wanted relative error must lie between 1e-12 and 1, got {relative}")
    low, high = cutter.range
    if between is not None:
        one, other = finite(between, name="between", last=2).tolist()
        low, high = max(low, min(one, other)), min(high, max(one, other))
    if not low < high:
        none = np.empty(0)
        return Integral(
            np.zeros(3), 0.0, 0.0, none, none, np.empty((0, 2)), none.astype(np.int64), 0
        )
    found = cutter.integral(low, high, relative, MOST_SECTIONS)
    value, slope = found.weights.T
    area, change = found.moments[:, 0], found.moments[:, 3]
    return Integral(
        moments=value @ found.moments[:, :3] + slope @ found.moments[:, 3:],
        first=float(value @ (found.at * area) + slope @ (area + found.at * change)),
        error=found.error,
        at=found.at,
        area=area.copy(),
        weights=found.weights,
        marks=found.marks,
        sections=found.sections,
    )


def _volume(
    cutter: Cutter,
    theta: float,
    relative: float,
    *,
    pieces: bool = True,
    between: tuple[float, float] | None = None,
) -> Volume:
    """See `Sections.volume`."""
    found = integrate(cutter, relative, between)
    with np.errstate(invalid="ignore", divide="ignore"):
        centroid = np.array([found.first, *found.moments[1:3]]) / found.moments[0]
    centroid[1:] += cutter.origin
    return Volume(
        value=float(found.moments[0]),
        error=found.error,
        centroid=rotation_y(theta) @ centroid,
        pieces=pieces_of(cutter, found) if pieces else (),
        at=found.at,
        area=found.area,
        events=changes(cutter, found) if pieces else np.empty(0),
        sections=found.sections,
    )


def pieces_of(cutter: Cutter, found: Integral) -> tuple[float, ...]:
    """The volumes of the connected pieces, mm³, largest first; what rounding makes is left out."""
    volumes = cutter.pieces(found.at, found.weights)
    kept = volumes[volumes > _SPECK * found.moments[0]]
    if kept.size:  # what the smallest were given too much
        kept[0] -= kept.sum() - found.moments[0]
    return tuple(kept.tolist())


def changes(cutter: Cutter, found: Integral) -> Array:
    """Where the structure of sections changes, increasing, mm: where a closed form says so between
    two sections that are built differently, else in the middle between them."""
    n = np.flatnonzero(found.marks[1:] != found.marks[:-1])
    a, b = found.at[n], found.at[n + 1]
    known = events(cutter.limbs, cutter.signs, cutter.size)
    middle = 0.5 * (a + b)
    if known.size:
        k = np.clip(np.searchsorted(known, middle), 1, max(known.size - 1, 1))
        near = known[np.minimum(np.stack([k - 1, k]), known.size - 1)]
        near = np.where(middle - near[0] < near[1] - middle, near[0], near[1])
        middle = np.where((a <= near) & (near <= b), near, middle)
    return np.unique(middle)
