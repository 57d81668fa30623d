"""The plane region inside some circles and outside others, exactly: loops of arcs.

Where every limb bounds the reach of a point by two concentric circles, the workspace is the
intersection of such rings. Each circle is cut where others cross it, an arc stays where its middle
is inside of all that it must be inside of and outside of the others, and arcs are joined to loops,
the region to their left. Lengths mm, angles rad.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.sections import BOUNDS, Construction, Ints, Section
from kinematics.spatial import Array

_SAME = 1e-11  # of the smallest outer radius: circles and points that are one
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)  # exact to rounding for half a circle


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
    arcs = _Arcs.none() if circles is None else _kept_arcs(circles)
    loops = _loops(arcs)
    order, starts = _ordered(arcs, loops)
    arcs = arcs.take(order)
    return _section(arcs, starts, at, rings)


def rings_moments(rings: Rings) -> tuple[float, Array]:
    """The area, mm², and ∫ (v, w) dA, (2,) mm³, of the intersection: quicker than the section."""
    circles = _circles(rings)
    arcs = _Arcs.none() if circles is None else _kept_arcs(circles)
    if not len(arcs.radius):
        return 0.0, np.zeros(2)
    about = arcs.start.mean(axis=0)
    area, *first = _integrals(arcs, about)[:3].tolist()
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


def nearest_point(section: Section, point: ArrayLike) -> tuple[Array, int] | None:
    """The point of the region's boundary nearest to ``point`` (2,), and on which edge it lies."""
    if not section.loops:
        return None
    q = np.asarray(point, dtype=float)
    away = q - section.center
    angle = np.arctan2(away[:, 1], away[:, 0])
    first = section.start - section.center
    since = np.mod((angle - np.arctan2(first[:, 1], first[:, 0])) * np.sign(section.sweep), _TURN)
    radial = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    foot = section.center + section.radius[:, None] * radial
    on = since <= np.abs(section.sweep)
    ends = np.linalg.norm(section.start - q, axis=1)
    distance = np.where(on, np.linalg.norm(foot - q, axis=1), ends)
    k = int(distance.argmin())
    return (foot[k] if on[k] else section.start[k]).copy(), k


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
    bound = np.where(sign > 0, BOUNDS.index("rho_max"), BOUNDS.index("rho_min"))
    return _Circles(
        center[keep],
        radius[keep],
        np.asarray(limb[keep], dtype=np.int64),
        np.asarray(bound[keep], dtype=np.int64),
        sign[keep],
        scale,
    )


class _Arcs(NamedTuple):
    """Arcs as they are walked: ``sweep`` is negative about holes."""

    start: Array
    end: Array
    center: Array
    radius: Array
    first: Array  # angle at the start
    sweep: Array
    limb: Ints
    bound: Ints
    scale: float

    @classmethod
    def none(cls) -> _Arcs:
        zero, ints = np.zeros(0), np.zeros(0, dtype=np.int64)
        pairs = np.zeros((0, 2))
        return cls(pairs, pairs, pairs, zero, zero, zero, ints, ints, 1.0)

    def take(self, rows: list[int]) -> _Arcs:
        return _Arcs(
            self.start[rows],
            self.end[rows],
            self.center[rows],
            self.radius[rows],
            self.first[rows],
            self.sweep[rows],
            self.limb[rows],
            self.bound[rows],
            self.scale,
        )


def _kept_arcs(c: _Circles) -> _Arcs:
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
    signed = np.where(forward, span, -span)
    return _Arcs(
        start=c.center[w] + c.radius[w, None] * _directions(start_angle),
        end=c.center[w] + c.radius[w, None] * _directions(start_angle + signed),
        center=c.center[w],
        radius=c.radius[w],
        first=start_angle,
        sweep=signed,
        limb=c.limb[w],
        bound=c.bound[w],
        scale=c.scale,
    )


def _directions(angle: Array) -> Array:
    answer: Array = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return answer


def _crossings(c: _Circles, k: int) -> Array:
    """Angles on circle k at which others cross or touch it."""
    d = c.center - c.center[k]
    apart = np.sqrt((d * d).sum(axis=1))
    apart[k] = np.nan
    r, s = c.radius[k], c.radius
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = (apart * apart + r * r - s * s) / (2.0 * apart * r)
        meets = np.abs(cosine) <= 1.0
        half = np.arccos(np.where(meets, cosine, np.nan))
        toward = np.arctan2(d[:, 1], d[:, 0])
    angles = np.concatenate([toward - half, toward + half])
    return np.asarray(angles[np.isfinite(angles)])


# --- loops ---------------------------------------------------------------------------------


def _loops(arcs: _Arcs) -> list[list[int]]:
    """Arcs joined end to start; where several go on, the one that keeps the loop simple."""
    left = set(range(len(arcs.radius)))
    loops: list[list[int]] = []
    near = 1e3 * _SAME * arcs.scale
    while left:
        k = min(left)
        left.discard(k)
        loop = [k]
        while True:
            end = arcs.end[k]
            gap = np.abs(arcs.start - end).max(axis=1)
            home = gap[loop[0]]
            open_ones = [j for j in left if gap[j] <= max(near, 0.0)]
            if home <= near:
                open_ones.append(loop[0])
            if not open_ones:  # rounding where arcs nearly touch: the nearest start
                open_ones = [min((*left, loop[0]), key=lambda j: gap[j])]
            k = min(open_ones, key=lambda j: _turn(arcs, k, j))
            if k == loop[0]:
                break
            left.discard(k)
            loop.append(k)
        loops.append(loop)
    return loops


def _turn(arcs: _Arcs, one: int, other: int) -> float:
    """Clockwise from the way back along one arc to the way on along another."""
    back = _heading(arcs, one, at_end=True) + np.pi
    return float(np.mod(back - _heading(arcs, other, at_end=False) - 1e-9, _TURN))


def _heading(arcs: _Arcs, k: int, *, at_end: bool) -> float:
    angle = arcs.first[k] + (arcs.sweep[k] if at_end else 0.0)
    return float(angle + np.sign(arcs.sweep[k]) * 0.5 * np.pi)


def _ordered(arcs: _Arcs, loops: list[list[int]]) -> tuple[list[int], list[int]]:
    """The arcs loop by loop, outer loops by their size, each before its holes."""
    areas = [_integrals(arcs.take(loop))[0] for loop in loops]
    outer = sorted((n for n in range(len(loops)) if areas[n] > 0.0), key=lambda n: -areas[n])
    order: list[int] = []
    starts = [0]
    holes: dict[int, list[int]] = {n: [] for n in outer}
    for n in range(len(loops)):
        if areas[n] <= 0.0:
            point = _some_point(arcs, loops[n][0])
            around = [m for m in outer if _winding(arcs.take(loops[m]), point) > 0.5]
            holder = min(around, key=lambda m: areas[m], default=None)
            if holder is not None:
                holes[holder].append(n)
    for n in outer:
        for loop in (n, *holes[n]):
            order += loops[loop]
            starts.append(len(order))
    return order, starts


def _some_point(arcs: _Arcs, k: int) -> Array:
    angle = arcs.first[k] + 0.5 * arcs.sweep[k]
    point: Array = arcs.center[k] + arcs.radius[k] * _directions(np.array(angle))
    return point


def _winding(arcs: _Arcs, point: Array) -> float:
    """How often a loop goes round a point."""
    total = 0.0
    for k in range(len(arcs.radius)):
        count = max(8, int(abs(arcs.sweep[k]) / 0.02))
        angles = arcs.first[k] + arcs.sweep[k] * np.linspace(0.0, 1.0, count + 1)
        p = arcs.center[k] + arcs.radius[k] * _directions(angles) - point
        cross = p[:-1, 0] * p[1:, 1] - p[:-1, 1] * p[1:, 0]
        total += float(np.arctan2(cross, (p[:-1] * p[1:]).sum(axis=1)).sum())
    return total / _TURN


# --- measures ------------------------------------------------------------------------------


def _integrals(arcs: _Arcs, origin: Array | None = None) -> Array:
    """∫1, ∫v, ∫w, ∫v², ∫w², ∫vw over the region to the left, by Green's theorem."""
    if not len(arcs.radius):
        return np.zeros(6)
    about = arcs.start.mean(axis=0) if origin is None else origin
    angle = arcs.first[:, None] + 0.5 * arcs.sweep[:, None] * (1.0 + _NODES)
    x = arcs.center[:, :1] - about[0] + arcs.radius[:, None] * np.cos(angle)
    y = arcs.center[:, 1:] - about[1] + arcs.radius[:, None] * np.sin(angle)
    step = 0.5 * arcs.sweep[:, None] * arcs.radius[:, None] * _WEIGHTS
    dx, dy = -np.sin(angle) * step, np.cos(angle) * step
    values: Array = np.array(
        [
            0.5 * (x * dy - y * dx).sum(),
            0.5 * (x * x * dy).sum(),
            -0.5 * (y * y * dx).sum(),
            (x**3 * dy).sum() / 3.0,
            -(y**3 * dx).sum() / 3.0,
            0.5 * (x * x * y * dy).sum(),
        ]
    )
    return values


def _section(arcs: _Arcs, starts: list[int], at: float, rings: Rings) -> Section:
    loops = len(starts) - 1
    areas = np.array(
        [_integrals(arcs.take(list(range(starts[n], starts[n + 1]))))[0] for n in range(loops)]
    )
    pieces = np.cumsum(areas > 0.0) - 1
    centroid, moments, area = np.full(2, np.nan), np.zeros(3), 0.0
    if loops:
        area = float(areas.sum())
        about = arcs.start.mean(axis=0)
        whole = _integrals(arcs, about)
        centroid = about + whole[1:3] / whole[0]
        at_centroid = _integrals(arcs, centroid)
        moments = at_centroid[3:6]

    return Section(
        at=float(at),
        start=arcs.start,
        end=arcs.end,
        limb=arcs.limb,
        bound=arcs.bound,
        center=arcs.center,
        radius=arcs.radius,
        sweep=arcs.sweep,
        loop_start=np.array(starts, dtype=np.int64),
        loop_area=areas,
        loop_piece=np.asarray(pieces, dtype=np.int64),
        area=area,
        perimeter=float((np.abs(arcs.sweep) * arcs.radius).sum()),
        centroid=centroid,
        second_moments=moments,
        construct=partial(_construction, rings),
    )


def _construction(rings: Rings) -> Construction:
    outer, inner = rings.outer > 0.0, rings.inner > 0.0
    outer &= np.isfinite(rings.outer)
    center = np.concatenate([rings.center[outer], rings.center[inner]])
    radius = np.concatenate([rings.outer[outer], rings.inner[inner]])
    limb = np.concatenate([rings.limb[outer], rings.limb[inner]])
    names = [BOUNDS.index("rho_max")] * int(outer.sum()) + [BOUNDS.index("rho_min")] * int(
        inner.sum()
    )
    return Construction(
        center=center,
        radius=radius,
        circle_limb=np.asarray(limb, dtype=np.int64),
        circle_bound=np.array(names, dtype=np.int64),
        line=np.zeros((0, 2, 2)),
        line_limb=np.zeros(0, dtype=np.int64),
    )
