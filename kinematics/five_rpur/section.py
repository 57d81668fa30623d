"""The exact section of the workspace at x' = const: loops of arcs and lines.

In x'y'z' the section of limb i's vertex space is bounded by arcs of radius l_i about (w'_iy,
w'_iz ± S(ρ, x' − w'_ix)), ρ = ρ_min and ρ_max, and by the lines y' = w'_iy ± l_i (Tale Masouleh et
al. 2011, eqs. 26-43; areas and moments by Green's theorem, with the factors derived anew). Lengths
mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

import numpy as np

from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.five_rpur.slicing.cutter import Cutter
from kinematics.sections import BOUNDS, Construction, Ints, Section
from kinematics.spatial import Array, finite

_RHO_MIN, _RHO_MAX, _LINK = (BOUNDS.index(b) for b in ("rho_min", "rho_max", "link"))
_OF_CIRCLE = np.array([_RHO_MAX, _RHO_MIN, _RHO_MIN, _RHO_MAX])  # bound of circle 4 limb + k


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
    low, high = cutter.heights(np.array([at]))
    made_by = _construction(cutter, low[0], high[0])
    limbs = cutter.limbs
    edges, end, turns, moments = cutter.outline(at)
    count = len(edges)
    circle, sense, piece, loop = edges.T
    loop_start = np.flatnonzero(np.diff(loop, prepend=-1, append=-2))
    start = np.empty_like(end)
    start[1:] = end[:-1]
    if count:
        start[loop_start[:-1]] = end[loop_start[1:] - 1]
    arc = circle >= 0
    limb = np.where(arc, circle >> 2, -1 - circle)
    k = circle & 3
    depth = np.stack([-high[0], -low[0], low[0], high[0]])[k, limb]
    center = np.where(
        arc[:, None], np.stack([limbs[1, limb], limbs[2, limb] + depth], axis=-1), np.nan
    )
    radius = np.where(arc, limbs[3, limb], np.inf)
    sweep = _sweeps(start - center, end - center, sense, turns, arc)
    # Green: the polygon of chords, and what lies between chords and arcs.
    cross = start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]
    bulge = np.where(arc, limbs[3, limb] ** 2, 0.0) * (sweep - np.sin(sweep))
    green = 0.5 * np.append(cross + bulge, 0.0)
    loop_area = np.add.reduceat(green, loop_start[:-1])[: len(loop_start) - 1]
    length = np.where(arc, np.abs(sweep) * limbs[3, limb], np.abs(end - start).sum(axis=1))
    area, centroid, second = _about_centroid(moments, cutter.origin)
    _, loop_piece = np.unique(piece[loop_start[:-1]], return_inverse=True)
    return Section(
        at=at,
        start=start,
        end=end,
        limb=limb + 1,
        bound=np.where(arc, _OF_CIRCLE[k], _LINK),
        center=center,
        radius=radius,
        sweep=sweep,
        loop_start=loop_start,
        loop_area=loop_area,
        loop_piece=loop_piece,
        area=area,
        perimeter=float(length.sum()),
        centroid=centroid,
        second_moments=second,
        construction=made_by,
    )


def _sweeps(start: Array, end: Array, sense: Ints, turns: Array, arc: Array) -> Array:
    """The arcs' signed angles from the centres' sight: exact ones next to ``turns``."""
    with np.errstate(invalid="ignore"):
        angle = np.arctan2(end[:, 1], end[:, 0]) - np.arctan2(start[:, 1], start[:, 0])
        angle = sense * angle
        angle += 2.0 * np.pi * np.round((turns - angle) / (2.0 * np.pi))
    return np.where(arc, sense * angle, 0.0)


def _about_centroid(moments: Array, origin: Array) -> tuple[float, Array, Array]:
    area = float(moments[0])
    if not area > 0.0:
        return 0.0, np.full(2, np.nan), np.zeros(3)
    v, w = moments[1:3] / area
    second = moments[3:] - area * np.array([v * v, w * w, v * w])
    return area, origin + np.array([v, w]), second


def _construction(cutter: Cutter, low: Array, high: Array) -> Construction:
    """All circles and lines of limbs that reach the plane."""
    center, radius, limb, bound, line, line_limb = [], [], [], [], [], []
    for i, (_, wy, wz, link, _, _) in enumerate(cutter.limbs.T.tolist()):
        if high[i] < 0.0:
            continue
        depths = [(-high[i], _RHO_MAX), (high[i], _RHO_MAX)]
        if low[i] > 0.0:
            depths[1:1] = [(-low[i], _RHO_MIN), (low[i], _RHO_MIN)]
        for depth, which in depths:
            center.append((wy, wz + depth))
            radius.append(link)
            limb.append(i + 1)
            bound.append(which)
        for (z0, _), (z1, _) in zip(depths[::2], depths[1::2], strict=True):
            for y in (wy - link, wy + link):
                line.append(((y, wz + z0), (y, wz + z1)))
                line_limb.append(i + 1)
    return Construction(
        np.array(center).reshape(-1, 2),
        np.array(radius, dtype=float),
        np.array(limb, dtype=np.int64),
        np.array(bound, dtype=np.int64),
        np.array(line).reshape(-1, 2, 2),
        np.array(line_limb, dtype=np.int64),
    )
