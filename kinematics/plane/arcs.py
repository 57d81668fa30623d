"""Edges of plane regions, circular arcs above all, and loops of them.

Edges are chained to loops with the region on their left, neighbours sharing their ends. Areas and
moments follow from Green's theorem. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from kinematics.arrays import Array, Ints

MEETING = 1e-9  # of the size: points closer together than this are one
_PANEL = 1.6  # rad of an arc for 16 nodes
_TOUCHES = 0.05  # rad: edges whose ways back and on are so near to one another only touch
_BRIDGED = 1e-3  # of the size: over how long a lost part, slender as it is, a loop is closed
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


class Arcs(NamedTuple):
    """Circular arcs, N of them.

    Attributes:
        center: (N, 2) mm.
        radius: (N,) mm.
        start: (N,) rad, the direction from the center to the first point.
        sweep: (N,) rad, counter-clockwise positive, at most a whole turn.
        limb: (N,) whose bound it is.
        bound: (N,) indices into `kinematics.answers.sections.BOUNDS`.
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
        return np.asarray(self.center + self.radius[:, None] * ray)

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


# --- loops ---------------------------------------------------------------------------------


def chained(edges: Sequence[Edge], size: float, bridged: float = 0.0) -> list[list[Edge]]:
    """Edges as closed loops: at a point that several pass, each turns to its left as sharply as
    it can, but not straight back, so that whatever only touches has loops of its own.
    """
    if not edges:
        return []
    given = edges
    edges, tail, head = sharing(edges, 1e-7 * size, bridged)
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
        elif not bridged and any(extent(edges[m]) > 10.0 * _BRIDGED * size for m in loop):
            return chained(given, size, _BRIDGED * size)  # a loop has lost a part
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
    points = points[first_of(numbers)]
    shared = [edge.between(points[n], points[n + count]) for n, edge in enumerate(edges)]
    return shared, numbers[:count], numbers[count:]


def first_of(numbers: Ints) -> Ints:
    """(N,) where each number comes first."""
    _, first, back = np.unique(numbers, return_index=True, return_inverse=True)
    result: Ints = first[back]
    return result
