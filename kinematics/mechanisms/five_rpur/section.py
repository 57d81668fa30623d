"""The exact section of the workspace at x' = const: loops of arcs and lines.

In x'y'z' the section of limb i's vertex space is bounded by arcs of radius l_i about (w'_iy,
w'_iz ± S(ρ, x' − w'_ix)), ρ = ρ_min and ρ_max, and by the lines y' = w'_iy ± l_i (Tale Masouleh et
al. 2011, eqs. 26-43; areas and moments by Green's theorem, with the factors derived anew). Lengths
mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache, partial

import numpy as np

from kinematics.answers.sections import BOUNDS, Construction, Section
from kinematics.arrays import Array, finite
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.slicing.cutter import Cutter

# Of the four circles and the four lines that a limb may have.
_OWNER = np.repeat(np.arange(1, LIMBS + 1), 4).reshape(LIMBS, 4)
_LINE_OWNER = _OWNER.reshape(LIMBS, 2, 2)
_BOUND = np.tile(
    [BOUNDS.index(b) for b in ("rho_max", "rho_min", "rho_min", "rho_max")], (LIMBS, 1)
)


def section(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    at: float,
    modes: Iterable[str] | None = None,
) -> Section:
    """The section at x' = ``at``.

    Args:
        design: the machine.
        phi: φ, rad.
        theta: θ, rad.
        at: x', mm.
        modes: working modes as "+-+++", of which any will do; None for all 32.

    Raises:
        InputError: an angle or ``at`` that is not finite, or a mode that is not five signs.
    """
    return sections(design, phi, theta, [at], modes)[0]


def sections(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    at: Iterable[float],
    modes: Iterable[str] | None = None,
) -> tuple[Section, ...]:
    """The sections at several x', see `section`."""
    cutter = _cutter(design, float(phi), float(theta), None if modes is None else frozenset(modes))
    return tuple(_section(cutter, float(x)) for x in finite(list(at), name="at"))


def section_range(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: Iterable[str] | None = None,
) -> tuple[float, float] | None:
    """The range of x' outside of which sections are empty, mm; None if all of them are.

    The limbs' reaches alone decide it: sections may be empty inside it as well.
    """
    cutter = _cutter(design, float(phi), float(theta), None if modes is None else frozenset(modes))
    low, high = cutter.range
    return (low, high) if high > low else None


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
