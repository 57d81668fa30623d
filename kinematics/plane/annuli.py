"""The plane region inside some circles and outside others, exactly: loops of arcs.

Where every limb bounds the reach of a point by two concentric circles, the workspace is the
intersection of such rings. Each circle is cut where others cross it, an arc stays where its middle
is inside of all that it must be inside of and outside of the others; `plane.arcs` joins arcs
to loops. Lengths mm, angles rad.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.sections import BOUNDS, Section
from kinematics.arrays import Array, Ints
from kinematics.plane.arcs import Arcs, Edge, arc_edge, chained, moments, quadrature
from kinematics.plane.circle_crossings import factors, half_angle
from kinematics.plane.regions import section_of

_SAME = 1e-11  # of the smallest outer radius: circles and points that are one
_OUTER, _INNER = BOUNDS.index("rho_max"), BOUNDS.index("rho_min")


class Rings(NamedTuple):
    """Rings about ``center`` (N, 2) between ``inner`` and ``outer`` (N,), mm, one a limb.

    An inner radius of zero or less, or NaN, is no hole; an outer one of zero or less, or NaN,
    leaves nothing; an infinite one does not bound. ``limb`` (N,) counts from 1.
    """

    center: Array
    inner: Array
    outer: Array
    limb: Ints


def rings_section(rings: Rings, at: float = 0.0) -> Section:
    """The intersection of all rings as a `Section` that stands at ``at``."""
    circles = _circles(rings)
    loops: list[list[Edge]] = []
    if circles is not None:
        kept = _kept_arcs(circles)
        edges = [arc_edge(kept.take([k])) for k in range(len(kept.radius))]
        loops = chained(edges, circles.scale)
    return section_of(loops, _drawn(rings), at)


def rings_moments(rings: Rings) -> tuple[float, Array]:
    """The area, mm², and ∫ (v, w) dA, (2,) mm³, of the intersection: quicker than the section."""
    circles = _circles(rings)
    if circles is None:
        return 0.0, np.zeros(2)
    kept = _kept_arcs(circles)
    if not len(kept.radius):
        return 0.0, np.zeros(2)
    nodes, steps = quadrature(kept)
    about = nodes.mean(axis=0)
    area, *first = moments(nodes - about, steps)[:3].tolist()
    return area, np.array(first) + area * about


def inside(rings: Rings, points: ArrayLike) -> NDArray[np.bool_]:
    """Whether points (..., 2) lie within all rings, (...,)."""
    p = np.asarray(points, dtype=float)
    away = np.sqrt(((p[..., None, :] - rings.center) ** 2).sum(axis=-1))
    within: NDArray[np.bool_] = (away <= rings.outer) & ~(away < rings.inner)
    return np.asarray(within.all(axis=-1))


def roomiest(rings: Rings, section: Section) -> Array:
    """A point (2,) well inside the region, of a grid the one with most room; NaN if it is empty."""
    if not section.loops:
        return np.full(2, np.nan)
    rim = np.concatenate([section.polyline(n, np.inf) for n in range(section.loops)])
    low, high = rim.min(axis=0), rim.max(axis=0)
    best = section.start[0]
    span = 0.5 * (high - low)
    middle = 0.5 * (low + high)
    steps = np.linspace(-1.0, 1.0, 41)
    # Of places that are as good the one with the largest second coordinate, which comes first.
    v, u = np.meshgrid(steps[::-1], steps, indexing="ij")
    grid = np.stack([u, v], axis=-1).reshape(-1, 2)
    for _ in range(3):
        tried = middle + span * grid
        away = np.sqrt(((tried[:, None, :] - rings.center) ** 2).sum(axis=-1))
        inner = np.where(rings.inner > 0.0, away - rings.inner, np.inf)
        room = np.minimum(rings.outer - away, inner).min(axis=1)
        best = tried[int(np.argmax(room >= room.max() - 1e-9 * abs(room.max())))]
        middle, span = best, 0.1 * span
    return np.asarray(best)


# --- circles and arcs ----------------------------------------------------------------------

_TURN = 2.0 * np.pi


class _Circles(NamedTuple):
    center: Array
    radius: Array
    limb: Ints
    bound: Ints
    sign: Array  # +1: the region is inside
    scale: float


def _circles(rings: Rings) -> _Circles | None:
    """The circles that matter, each once; None if nothing is left for sure."""
    outer, inner = np.asarray(rings.outer, dtype=float), np.asarray(rings.inner, dtype=float)
    if not (outer > 0.0).all():
        return None
    bounded = np.isfinite(outer)
    hole = inner > _SAME * float(outer.min())
    if (hole & (inner >= outer)).any() or not bounded.any():
        return None
    center = np.concatenate([rings.center[bounded], rings.center[hole]])
    radius = np.concatenate([outer[bounded], inner[hole]])
    limb = np.concatenate([rings.limb[bounded], rings.limb[hole]])
    count = int(bounded.sum())
    sign = np.concatenate([np.ones(count), -np.ones(int(hole.sum()))])
    scale = float(outer[bounded].min())  # nothing reaches further than that circle does
    keep: list[int] = []
    for k in range(len(radius)):
        twin = next(
            (
                j
                for j in keep
                if abs(radius[j] - radius[k]) <= _SAME * scale
                and np.abs(center[j] - center[k]).max() <= _SAME * scale
            ),
            None,
        )
        if twin is None:
            keep.append(k)
        elif sign[twin] != sign[k]:
            return None  # inside and outside of the same circle
    bound = np.where(sign > 0, _OUTER, _INNER)
    return _Circles(
        center[keep],
        radius[keep],
        np.asarray(limb[keep], dtype=np.int64),
        np.asarray(bound[keep], dtype=np.int64),
        sign[keep],
        scale,
    )


def _kept_arcs(c: _Circles) -> Arcs:
    """The parts of the circles that bound the region, which lies to their left."""
    which, first, sweep = [], [], []
    for k in range(len(c.radius)):
        cuts = np.sort(np.mod(_crossings(c, k), _TURN))
        if cuts.size:
            merged = [cuts[0]]
            for cut in cuts[1:]:
                if (cut - merged[-1]) * c.radius[k] > _SAME * c.scale:
                    merged.append(cut)
            cuts = np.array(merged)
        if len(cuts) < 2:  # whole circles, and those that others only touch, in two halves
            cuts = np.array([0.0, np.pi]) + (cuts[0] if cuts.size else 0.0)
        spans = np.diff(np.append(cuts, cuts[0] + _TURN))
        which += [k] * len(cuts)
        first += cuts.tolist()
        sweep += spans.tolist()
    w = np.array(which, dtype=np.intp)
    begin, span = np.array(first), np.array(sweep)
    middle = c.center[w] + c.radius[w, None] * _directions(begin + 0.5 * span)
    away = np.sqrt(((middle[:, None, :] - c.center) ** 2).sum(axis=-1)) - c.radius
    ok = (c.sign * away <= 0.0) | (np.arange(len(c.radius)) == w[:, None])
    # An arc must also be long enough to be one.
    good = ok.all(axis=1) & (span * c.radius[w] > _SAME * c.scale)
    w, begin, span = w[good], begin[good], span[good]
    forward = c.sign[w] > 0.0
    start_angle = np.where(forward, begin, begin + span)
    bounds = (c.limb[w], c.bound[w])
    return Arcs(c.center[w], c.radius[w], start_angle, np.where(forward, span, -span), *bounds)


def _directions(angle: Array) -> Array:
    return np.asarray(np.stack([np.cos(angle), np.sin(angle)], axis=-1))


def _crossings(c: _Circles, k: int) -> Array:
    """Angles on circle k at which others cross or touch it."""
    d = c.center - c.center[k]
    apart = np.sqrt((d * d).sum(axis=1))
    apart[k] = np.nan
    r, s = c.radius[k], c.radius
    half = np.where(apart > 0.0, half_angle(factors(apart, r, s)), np.nan)
    toward = np.arctan2(d[:, 1], d[:, 0])
    angles = np.concatenate([toward - half, toward + half])
    return np.asarray(angles[np.isfinite(angles)])


def _drawn(rings: Rings) -> Arcs:
    """All circles of the rings, whole."""
    outer = (rings.outer > 0.0) & np.isfinite(rings.outer)
    inner = rings.inner > 0.0
    radius = np.concatenate([rings.outer[outer], rings.inner[inner]])
    bound = np.repeat([_OUTER, _INNER], [int(outer.sum()), int(inner.sum())])
    return Arcs(
        np.concatenate([rings.center[outer], rings.center[inner]]),
        radius,
        np.zeros(len(radius)),
        np.full(len(radius), _TURN),
        np.concatenate([rings.limb[outer], rings.limb[inner]]),
        bound,
    )
