"""Regions of a plane bounded by circular arcs: which parts of given arcs are the boundary.

A mechanism hands in every arc that may bound its region, and a test that says which points are
inside. The arcs are cut where they meet; a part belongs to the boundary if the region is on one of
its sides only, and parts are chained to loops with the region on their left. Areas and moments
follow from Green's theorem. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.crossings import factors, half_chord
from kinematics.sections import Ints
from kinematics.spatial import Array

Inside = Callable[[Array], NDArray[np.bool_]]

MEETING = 1e-9  # of the size: points closer together than this are one
_TOUCH = 1e-12  # of the size: circles that overlap by less only touch
_PANEL = 1.6  # rad of an arc for 16 nodes
_TOUCHES = 0.05  # rad: edges whose ways back and on are so near to one another only touch
_ASIDE = 1e-7  # of the size: how far beside a part its sides are asked for
_BRIDGED = 1e-3  # of the size: over how long a lost part, slender as it is, a loop is closed
_PROBES = (0.5, 0.27, 0.81)  # of a part: by one of them another arc may pass nearer than that
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


class Arcs(NamedTuple):
    """Circular arcs, N of them.

    Attributes:
        center: (N, 2) mm.
        radius: (N,) mm.
        start: (N,) rad, the direction from the center to the first point.
        sweep: (N,) rad, counter-clockwise positive, at most a whole turn.
        limb: (N,) whose bound it is.
        bound: (N,) indices into `kinematics.sections.BOUNDS`.
    """

    center: Array
    radius: Array
    start: Array
    sweep: Array
    limb: Ints
    bound: Ints

    def at(self, share: float | Array) -> Array:
        """Points (N, 2) at a share of each arc, 0 to 1."""
        angle = self.start + self.sweep * share
        ray = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        points: Array = self.center + self.radius[:, None] * ray
        return points

    def take(self, rows: Any) -> Arcs:
        """Some of them."""
        return Arcs(*(each[rows] for each in self))


def joined(parts: Sequence[Arcs]) -> Arcs:
    """Arcs one after another."""
    return Arcs(*(np.concatenate(each) for each in zip(*parts, strict=True)))


def arc(
    center: Sequence[float], radius: float, start: float, sweep: float, limb: int, bound: int
) -> Arcs:
    """One arc."""
    return Arcs(
        np.array([center], dtype=float),
        np.array([radius]),
        np.array([start]),
        np.array([sweep]),
        np.array([limb]),
        np.array([bound]),
    )


# --- edges of any kind ---------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Edge:
    """A part of a boundary from ``first`` to ``last`` (2,), the region on its left.

    Neighbours in a loop share their ends, which may lie beside the curve by what rounding or a
    tolerance leaves; the way from there to the curve counts as a part of the edge, so that what is
    integrated along a loop is closed.

    Attributes:
        shown: arcs one after another that are the edge, or come within ``deviation`` of it, mm.
        nodes: (Q, 2) points on the true edge.
        steps: (Q, 2) their weights: ∫ f dx ≈ Σ f(nodes) steps[:, 0], likewise dy.
        point: gives the true points (..., 2) at shares (...) of the way, 0 to 1.
        area_error: mm², an estimate from above of the error of an area that the edge bounds.
    """

    first: Array
    last: Array
    shown: Arcs
    nodes: Array
    steps: Array
    point: Callable[[float | Array], Array]
    deviation: float = 0.0
    area_error: float = 0.0

    def between(self, first: Array, last: Array) -> Edge:
        """The same edge between ends (2,) that it shares with others, no more than near its own."""
        before, after = self.first - first, last - self.last
        if not before.any() and not after.any():
            return self
        return replace(
            self,
            first=first,
            last=last,
            nodes=np.concatenate([[first + 0.5 * before], self.nodes, [self.last + 0.5 * after]]),
            steps=np.concatenate([[before], self.steps, [after]]),
            area_error=self.area_error + float(before @ before + after @ after),
        )

    def reversed(self) -> Edge:
        """The same the other way round."""
        back = self.shown.take(slice(None, None, -1))
        back = back._replace(start=back.start + back.sweep, sweep=-back.sweep)
        return Edge(
            self.last,
            self.first,
            back,
            self.nodes[::-1],
            -self.steps[::-1],
            lambda share: self.point(1.0 - share),
            self.deviation,
            self.area_error,
        )


def arc_edge(one: Arcs, first: Array | None = None, last: Array | None = None) -> Edge:
    """An edge that is one arc; its ends may be given as others know them."""
    nodes, steps = quadrature(one)
    start, end = one.at(0.0)[0], one.at(1.0)[0]
    edge = Edge(start, end, one, nodes, steps, partial(_on_arc, one))
    return edge.between(start if first is None else first, end if last is None else last)


def _on_arc(one: Arcs, share: float | Array) -> Array:
    return one.at(np.asarray(share)[..., None])[..., 0, :]


def quadrature(arcs: Arcs) -> tuple[Array, Array]:
    """Points (Q, 2) on arcs one after another and their weights (Q, 2), as those of an `Edge`.

    Exact to rounding for what `moments` integrates.
    """
    panels = np.maximum(np.ceil(np.abs(arcs.sweep) / _PANEL), 1.0).astype(int)
    of = np.repeat(np.arange(len(panels)), panels)
    number = np.arange(len(of)) - (np.cumsum(panels) - panels)[of]
    width = (arcs.sweep / panels)[of, None]
    angle = arcs.start[of, None] + width * (number[:, None] + 0.5 * (_NODES + 1.0))
    cosine, sine = np.cos(angle), np.sin(angle)
    radius = arcs.radius[of, None]
    weight = 0.5 * width * radius * _WEIGHTS
    nodes = np.stack(
        [arcs.center[of, :1] + radius * cosine, arcs.center[of, 1:] + radius * sine], axis=-1
    )
    steps = np.stack([-sine * weight, cosine * weight], axis=-1)
    return nodes.reshape(-1, 2), steps.reshape(-1, 2)


def moments(nodes: Array, steps: Array) -> Array:
    """∫ 1, x, y, x², y², xy over what edges enclose, (6,), by Green's theorem."""
    x, y = nodes.T
    dx, dy = steps.T
    return np.array(
        [
            0.5 * (x @ dy - y @ dx),
            0.5 * (x * x) @ dy,
            -0.5 * (y * y) @ dx,
            (x**3) @ dy / 3.0,
            -(y**3) @ dx / 3.0,
            0.5 * (x * x * y) @ dy,
        ]
    )


def nearest(arcs: Arcs, point: Array) -> tuple[int, Array]:
    """Which of some arcs comes nearest to a point (2,), and where."""
    away = point - arcs.center
    angle = np.arctan2(away[:, 1], away[:, 0])
    since = np.mod((angle - arcs.start) * np.sign(arcs.sweep), 2 * np.pi)
    on = (since <= np.abs(arcs.sweep)) & away.any(axis=1)
    ray = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    foot = arcs.center + arcs.radius[:, None] * ray
    # Of an arc that is not on the way outwards one of both ends.
    ends = np.stack([arcs.at(0.0), arcs.at(1.0)])
    apart = np.hypot(*np.moveaxis(ends - point, -1, 0))
    end = ends[apart.argmin(axis=0), np.arange(len(angle))]
    candidates = np.where(on[:, None], foot, end)
    k = int(np.hypot(*(candidates - point).T).argmin())
    return k, candidates[k].copy()


# --- the boundary of a region --------------------------------------------------------------


def boundary(arcs: Arcs, inside: Inside, size: float) -> list[list[Edge]]:
    """The boundary of the region, loop by loop.

    Args:
        arcs: all that may bound it, each counter-clockwise (positive sweep); more do no harm.
        inside: which of the points (N, 2) lie in the region.
        size: mm, a typical length: what is smaller than 1e-7 of it may be passed over.
    """
    parts, first, last = _cut(arcs, size)
    if not len(parts.radius):
        return []
    length = parts.radius * parts.sweep
    aside = np.minimum(_ASIDE * size, 0.05 * length)
    near, far = _sides(parts, inside, aside)
    middle = parts.at(0.5)
    edges: list[Edge] = []
    seen: list[tuple[Array, bool]] = []
    for n in np.flatnonzero(near != far):
        # Of arcs that lie on one another only the first counts.
        if any(
            turned == far[n] and np.hypot(*(middle[n] - other)) < 1e-8 * size
            for other, turned in seen
        ):
            continue
        seen.append((middle[n], bool(far[n])))
        edge = arc_edge(parts.take([n]), first[n], last[n])
        edges.append(edge.reversed() if far[n] else edge)
    return chained(edges, size)


def _sides(parts: Arcs, inside: Inside, aside: Array) -> tuple[Array, Array]:
    """Whether the region is on the center's side of each part, and on the other, (N,) each."""
    beside = []
    for share in _PROBES:
        ray = (parts.at(share) - parts.center) / parts.radius[:, None]
        beside += [parts.at(share) + side * aside[:, None] * ray for side in (-1.0, 1.0)]
    held = inside(np.concatenate(beside)).reshape(len(_PROBES), 2, -1)
    near, far = held.sum(axis=0) > len(_PROBES) // 2
    return near, far


def chained(edges: Sequence[Edge], size: float) -> list[list[Edge]]:
    """Edges as closed loops: at a point that several pass, each turns to its left as sharply as
    it can, but not straight back, so that whatever only touches has loops of its own.
    """
    if not edges:
        return []
    edges, tail, head = sharing(edges, 1e-7 * size, _BRIDGED * size)
    leaving: dict[int, list[int]] = {}
    for n, vertex in enumerate(tail.tolist()):
        leaving.setdefault(vertex, []).append(n)
    loops: list[list[Edge]] = []
    left = set(range(len(edges)))
    while left:
        first = min(left)
        loop, n = [], first
        while n in left:
            left.remove(n)
            loop.append(n)
            ways = [m for m in leaving.get(int(head[n]), ()) if m in left or m == first]
            if not ways:
                break
            if len(ways) > 1:
                back = edges[n].reversed()
                reach = 0.02 * min(extent(back), *(extent(edges[m]) for m in ways), 0.1 * size)
                came = heading(back, reach)
                turns = [(came - heading(edges[m], reach) - _TOUCHES) % (2 * np.pi) for m in ways]
                n = ways[int(np.argmin(turns))]
            else:
                n = ways[0]
        if head[loop[-1]] == tail[first]:
            loops.append([edges[m] for m in loop])
    return loops


def heading(edge: Edge, reach: float) -> float:
    """The direction in which an edge leaves its first point, seen ``reach`` mm away, rad.

    Tangent edges are so told apart by their curvature, if all are seen from the same distance.
    """

    def first_beyond(shares: Array) -> int:
        away = edge.point(shares) - edge.first
        beyond = np.hypot(away[..., 0], away[..., 1]) >= reach
        return int(beyond.argmax()) if beyond.any() else len(shares) - 1

    end = np.hypot(*(edge.point(1.0) - edge.first))
    high = 0.5 if end < reach else 1.0  # a whole loop comes back
    doubled = high * 2.0 ** np.arange(-42.0, 1.0)
    n = first_beyond(doubled)
    low, high = doubled[max(n - 1, 0)], doubled[n]
    for _ in range(7):
        shares = np.linspace(low, high, 65)
        n = first_beyond(shares)
        low, high = shares[max(n - 1, 0)], shares[n]
    away = edge.point(high) - edge.first
    return float(np.arctan2(away[1], away[0]))


def extent(edge: Edge) -> float:
    """How far an edge gets from its first point, mm."""
    away = edge.nodes - edge.first
    return float(np.hypot(away[:, 0], away[:, 1]).max())


def places(points: Sequence[Array] | Array, near: float) -> Ints:
    """Numbers (N,) of points that are told apart if they are more than ``near`` apart."""
    p = np.asarray(points, dtype=float).reshape(-1, 2)
    apart = p[:, None] - p
    close = np.hypot(apart[..., 0], apart[..., 1]) <= near
    owner = np.arange(len(p))
    known = np.ones(len(p), dtype=bool)
    for n in np.flatnonzero(np.triu(close, 1).any(axis=0)).tolist():
        owners = np.flatnonzero(close[n, :n] & known[:n])
        if owners.size:
            owner[n], known[n] = owners[0], False
    numbers: Ints = (np.cumsum(known) - 1)[owner]
    return numbers


def sharing(
    edges: Sequence[Edge], near: float, bridged: float = 0.0
) -> tuple[list[Edge], Ints, Ints]:
    """Edges between ends that they share, and the numbers (N,) of their first and last points.

    Ends that are no more than ``near`` apart are one, the first of them; so are those up to
    ``bridged`` apart at which more edges end than begin, and begin than end: between them a part
    was lost that is too slender to be told.
    """
    count = len(edges)
    points = np.array([edge.first for edge in edges] + [edge.last for edge in edges])
    numbers = places(points, near)
    surplus = np.bincount(numbers[count:], minlength=numbers.max(initial=-1) + 1)
    surplus = surplus - np.bincount(numbers[:count], minlength=len(surplus))
    if bridged > 0.0 and surplus.any():
        where = points[np.unique(numbers, return_index=True)[1]]
        begin = np.flatnonzero(surplus < 0)
        for end in np.flatnonzero(surplus > 0).tolist():
            apart = np.hypot(*(where[begin] - where[end]).T)
            if len(begin) and apart.min() <= bridged:
                numbers[numbers == begin[apart.argmin()]] = end
                begin = np.delete(begin, apart.argmin())
    points = points[_first_of(numbers)]
    shared = [edge.between(points[n], points[n + count]) for n, edge in enumerate(edges)]
    return shared, numbers[:count], numbers[count:]


def _first_of(numbers: Ints) -> Ints:
    """(N,) where each number comes first."""
    _, first, back = np.unique(numbers, return_index=True, return_inverse=True)
    result: Ints = first[back]
    return result


def _cut(arcs: Arcs, size: float) -> tuple[Arcs, Array, Array]:
    """All parts between the points in which arcs meet, and these points, (N, 2) first and last.

    Every such point is one for all arcs that pass it, and the angles of each follow from it.
    """
    near = MEETING * size
    count = len(arcs.radius)
    each = np.arange(count)
    ends = np.concatenate([arcs.at(0.0), arcs.at(1.0)])
    met, pair = _meetings(arcs, size)
    points = np.concatenate([ends, met])
    points = points[_first_of(places(points, near))]
    away = ends - arcs.center[:, None]
    on_end = np.abs(np.hypot(away[..., 0], away[..., 1]) - arcs.radius[:, None]) <= near
    on_end &= np.tile(each, 2) != each[:, None]
    on = np.concatenate([on_end, (pair == each[:, None, None]).any(axis=-1)], axis=1)
    parts: list[Arcs] = []
    vertices: list[Array] = []
    for n in range(count):
        sweep, slack = float(arcs.sweep[n]), near / float(arcs.radius[n])
        ray = points[on[n]] - arcs.center[n]
        along = (np.arctan2(ray[:, 1], ray[:, 0]) - arcs.start[n]) % (2 * np.pi)
        order = np.argsort(along)
        marks, at = along[order], points[on[n]][order]
        if sweep < 2 * np.pi - slack:
            inner = (marks > slack) & (marks < sweep - slack)
            marks = np.concatenate([[0.0], marks[inner], [sweep]])
            at = np.concatenate([points[n, None], at[inner], points[n + count, None]])
        elif len(marks):  # a whole circle begins at a meeting, not anywhere
            marks, at = np.append(marks, marks[0] + 2 * np.pi), np.concatenate([at, at[:1]])
        else:
            marks, at = np.array([0.0, 2 * np.pi]), points[[n, n]]
        apart = np.concatenate([[True], np.diff(marks[:-1]) > slack, [True]])
        marks, at = marks[apart], at[apart]
        if len(marks) == 2 and sweep >= 2 * np.pi - slack:
            half = arcs.take([n])._replace(start=arcs.start[[n]] + marks[0] + np.pi).at(0.0)
            marks, at = np.insert(marks, 1, marks[0] + np.pi), np.insert(at, 1, half, axis=0)
        rows = np.full(len(marks) - 1, n)
        parts.append(
            arcs.take(rows)._replace(start=arcs.start[n] + marks[:-1], sweep=np.diff(marks))
        )
        vertices.append(np.stack([at[:-1], at[1:]]))
    every = joined(parts)
    first, last = np.concatenate(vertices, axis=1)
    long = every.radius * every.sweep > 10.0 * near
    return every.take(long), first[long], last[long]


def _meetings(arcs: Arcs, size: float) -> tuple[Array, Ints]:
    """The points (K, 2) in which two circles meet, one or two a pair, and the pairs (K, 2)."""
    n, m = np.triu_indices(len(arcs.radius), 1)
    between = arcs.center[m] - arcs.center[n]
    d = np.hypot(between[:, 0], between[:, 1])
    apart = d > MEETING * size
    n, m, between, d = n[apart], m[apart], between[apart], d[apart]
    r, s = arcs.radius[n], arcs.radius[m]
    f = factors(d, r, s)
    meet = f.least >= -MEETING * size
    # Of circles that all but touch the crossings, so told, would be rounding.
    up = np.where(f.least > _TOUCH * size, half_chord(f, d), 0.0)
    along = 0.5 * (d + (r - s) * (r + s) / d)
    unit = between / d[:, None]
    left = np.stack([-unit[:, 1], unit[:, 0]], axis=-1)
    foot = arcs.center[n] + along[:, None] * unit
    points = np.concatenate([foot + up[:, None] * left, foot - up[:, None] * left])
    pairs = np.stack([n, m], axis=-1)
    rows = np.concatenate([meet, meet & (up > 0.0)])
    return points[rows], np.concatenate([pairs, pairs])[rows]
