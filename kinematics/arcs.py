"""Regions of a plane bounded by circular arcs: which parts of given arcs are the boundary.

A mechanism hands in every arc that may bound its region, and a test that says which points are
inside. The arcs are cut where they meet; a part belongs to the boundary if the region is on one of
its sides only, and parts are chained to loops with the region on their left. Areas and moments
follow from Green's theorem. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.sections import Ints
from kinematics.spatial import Array

Inside = Callable[[Array], NDArray[np.bool_]]

MEETING = 1e-9  # of the size: points closer together than this are one
_PANEL = 1.6  # rad of an arc for 16 nodes
_TOUCHES = 0.05  # rad: edges whose ways back and on are so near to one another only touch
_ASIDE = 1e-7  # of the size: how far beside a part its sides are asked for
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

    Attributes:
        shown: arcs one after another that are the edge, or come within ``deviation`` of it, mm.
        nodes: (Q, 2) points on the true edge.
        steps: (Q, 2) their weights: ∫ f dx ≈ Σ f(nodes) steps[:, 0], likewise dy.
        point: gives the true point (2,) at a share of the way, 0 to 1.
    """

    first: Array
    last: Array
    shown: Arcs
    nodes: Array
    steps: Array
    point: Callable[[float], Array]
    deviation: float = 0.0

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
        )


def arc_edge(one: Arcs, first: Array | None = None, last: Array | None = None) -> Edge:
    """An edge that is one arc; its ends may be given more exactly, or as others know them."""
    nodes, steps = quadrature(one)
    ends = one.at(0.0)[0], one.at(1.0)[0]
    return Edge(
        ends[0] if first is None else first,
        ends[1] if last is None else last,
        one,
        nodes,
        steps,
        lambda share: one.at(share)[0],
    )


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
    parts = _cut(arcs, MEETING * size)
    if not len(parts.radius):
        return []
    length = parts.radius * parts.sweep
    parts = parts.take(length > 10.0 * MEETING * size)
    length = parts.radius * parts.sweep
    aside = np.minimum(_ASIDE * size, 0.05 * length)
    middle = parts.at(0.5)
    ray = (middle - parts.center) / parts.radius[:, None]
    near = inside(middle - aside[:, None] * ray)
    far = inside(middle + aside[:, None] * ray)
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
        edge = arc_edge(parts.take([n]))
        edges.append(edge.reversed() if far[n] else edge)
    return chained(edges, size)


def chained(edges: Sequence[Edge], size: float) -> list[list[Edge]]:
    """Edges as closed loops: at a point that several pass, each turns to its left as sharply as
    it can, but not straight back, so that whatever only touches has loops of its own.
    """
    if not edges:
        return []
    tail = places([e.first for e in edges] + [e.last for e in edges], 1e-7 * size)
    tail, head = tail[: len(edges)], tail[len(edges) :]
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

    def gone(share: float) -> float:
        return float(np.hypot(*(edge.point(share) - edge.first)))

    high = 0.5 if gone(1.0) < reach else 1.0  # a whole loop comes back
    while high > 1e-12 and gone(0.5 * high) >= reach:
        high *= 0.5
    low = 0.5 * high
    for _ in range(50):
        half = 0.5 * (low + high)
        low, high = (low, half) if gone(half) >= reach else (half, high)
    away = edge.point(high) - edge.first
    return float(np.arctan2(away[1], away[0]))


def extent(edge: Edge) -> float:
    """How far an edge gets from its first point, mm."""
    away = edge.nodes - edge.first
    return float(np.hypot(away[:, 0], away[:, 1]).max())


def places(points: Sequence[Array], near: float) -> Ints:
    """Numbers (N,) of points that are told apart if they are more than ``near`` apart."""
    known = np.empty((len(points), 2))
    count = 0
    numbers = np.empty(len(points), dtype=int)
    for n, point in enumerate(points):
        close = np.flatnonzero(np.hypot(*(known[:count] - point).T) <= near)
        if close.size:
            numbers[n] = close[0]
        else:
            known[count], numbers[n] = point, count
            count += 1
    return numbers


def _cut(arcs: Arcs, near: float) -> Arcs:
    """All parts between the points in which arcs meet."""
    parts: list[Arcs] = []
    count = len(arcs.radius)
    ends = np.concatenate([arcs.at(0.0), arcs.at(1.0)])
    for n in range(count):
        points = [ends[[m, m + count]] for m in range(count) if m != n]
        points += [_meeting(arcs, n, m, near) for m in range(count) if m != n]
        at = np.concatenate([p.reshape(-1, 2) for p in points]) if points else np.zeros((0, 2))
        away = at - arcs.center[n]
        on = np.abs(np.hypot(away[:, 0], away[:, 1]) - arcs.radius[n]) <= near
        angle = np.arctan2(away[on, 1], away[on, 0])
        along = (angle - arcs.start[n]) % (2 * np.pi)
        sweep, slack = float(arcs.sweep[n]), near / float(arcs.radius[n])
        whole = sweep >= 2 * np.pi - slack
        cuts = np.sort(along[(along > slack) & (along < sweep - slack)])
        cuts = cuts[np.concatenate([[True], np.diff(cuts) > slack])] if len(cuts) else cuts
        if whole and len(cuts) and not (along < slack).any():
            marks = np.append(cuts, cuts[0] + 2 * np.pi)  # it begins at a meeting, not anywhere
        else:
            marks = np.concatenate([[0.0], cuts, [sweep]])
        if whole and len(marks) == 2:
            marks = np.append(marks[0] + np.array([0.0, np.pi]), marks[0] + 2 * np.pi)
        rows = np.full(len(marks) - 1, n)
        parts.append(
            arcs.take(rows)._replace(start=arcs.start[n] + marks[:-1], sweep=np.diff(marks))
        )
    return joined(parts)


def _meeting(arcs: Arcs, n: int, m: int, near: float) -> Array:
    """The points (K, 2) in which two circles meet, K up to 2."""
    between = arcs.center[m] - arcs.center[n]
    d = float(np.hypot(*between))
    r, s = float(arcs.radius[n]), float(arcs.radius[m])
    if d <= near or d > r + s + near or d < abs(r - s) - near:
        return np.zeros((0, 2))
    along = 0.5 * (d + (r - s) * (r + s) / d)
    square = max((r + s + d) * (r + s - d), 0.0) * max((d + r - s) * (d - r + s), 0.0)
    up = np.sqrt(square) / (2.0 * d)
    unit = between / d
    left = np.array([-unit[1], unit[0]])
    foot = arcs.center[n] + along * unit
    return np.array([foot + up * left, foot - up * left])
