"""Regions of a plane bounded by circular arcs: which parts of given arcs are the boundary.

A mechanism hands in every arc that may bound its region, and a test that says which points are
inside. The arcs are cut where they meet; a part belongs to the boundary if the region is on one of
its sides only, and parts are chained to loops with the region on their left. Areas and moments
follow from Green's theorem. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.sections import Construction, Ints, Section
from kinematics.spatial import Array

Inside = Callable[[Array], NDArray[np.bool_]]

MEETING = 1e-9  # of the size: points closer together than this are one
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
    sweep, radius = float(one.sweep[0]), float(one.radius[0])
    panels = max(1, int(np.ceil(abs(sweep) / 1.6)))
    share = (np.arange(panels)[:, None] + 0.5 * (_NODES + 1.0)).ravel() / panels
    angle = one.start[0] + sweep * share
    ray = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    weight = np.tile(0.5 * _WEIGHTS, panels) * sweep / panels * radius
    steps = weight[:, None] * np.stack([-ray[:, 1], ray[:, 0]], axis=-1)
    ends = one.at(0.0)[0], one.at(1.0)[0]
    return Edge(
        ends[0] if first is None else first,
        ends[1] if last is None else last,
        one,
        one.center[0] + radius * ray,
        steps,
        lambda share: one.at(share)[0],
    )


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
    it can, so that parts of a region that only touch have loops of their own.
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
                turns = [(came - heading(edges[m], reach)) % (2 * np.pi) for m in ways]
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
    known: list[Array] = []
    numbers = np.empty(len(points), dtype=int)
    for n, point in enumerate(points):
        for k, other in enumerate(known):
            if np.hypot(*(point - other)) <= near:
                numbers[n] = k
                break
        else:
            numbers[n] = len(known)
            known.append(point)
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


# --- loops as a section --------------------------------------------------------------------


def section_of(loops: Sequence[Sequence[Edge]], circles: Arcs | None = None) -> Section:
    """Loops as a section; area and moments from the true edges.

    Args:
        loops: outer ones counter-clockwise, holes clockwise.
        circles: what is drawn as having made it; None: nothing.
    """
    moments = [_moments(loop) for loop in loops]
    areas = np.array([m[0] for m in moments])
    shown = [joined([edge.shown for edge in loop]) for loop in loops]
    every = joined(shown) if shown else _none()
    total = np.sum(moments, axis=0) if moments else np.zeros(6)
    area = float(total[0])
    centroid, second = np.full(2, np.nan), np.zeros(3)
    if area > 0.0:
        centroid = total[1:3] / area
        x, y = centroid
        second = total[3:] - area * np.array([x * x, y * y, x * y])
    made = _construction(circles)
    start, end = every.at(0.0), every.at(1.0)
    counts = [len(one.radius) for one in shown]
    first = np.concatenate([[0], np.cumsum(counts)]).astype(int)
    for a, b in pairwise(first.tolist()):  # neighbours meet exactly
        end[a : b - 1] = start[a + 1 : b]
        end[b - 1] = start[a]
    return Section(
        at=0.0,
        start=start,
        end=end,
        limb=every.limb,
        bound=every.bound,
        center=every.center,
        radius=every.radius,
        sweep=every.sweep,
        loop_start=first,
        loop_area=areas,
        loop_piece=_pieces(loops, areas),
        area=area,
        perimeter=float(sum(_length(edge) for loop in loops for edge in loop)),
        centroid=centroid,
        second_moments=second,
        construct=partial(_same, made),
    )


def together(sections: Sequence[Section]) -> Section:
    """Several sections as one, their loops and pieces one after another; no moments."""
    if len(sections) == 1:
        return sections[0]
    pieces = np.cumsum([0, *(s.pieces for s in sections[:-1])])
    edges = np.cumsum([0, *(len(s.start) for s in sections[:-1])])
    made = _construction(None)

    def all_of(name: str) -> Any:
        return np.concatenate([getattr(s, name) for s in sections])

    starts = [s.loop_start[:-1] + n for s, n in zip(sections, edges, strict=True)]
    return Section(
        at=0.0,
        start=all_of("start"),
        end=all_of("end"),
        limb=all_of("limb"),
        bound=all_of("bound"),
        center=all_of("center"),
        radius=all_of("radius"),
        sweep=all_of("sweep"),
        loop_start=np.concatenate([*starts, [sum(len(s.start) for s in sections)]]).astype(int),
        loop_area=all_of("loop_area"),
        loop_piece=np.concatenate(
            [s.loop_piece + n for s, n in zip(sections, pieces, strict=True)]
        ),
        area=sum(s.area for s in sections),
        perimeter=sum(s.perimeter for s in sections),
        centroid=np.full(2, np.nan),
        second_moments=np.full(3, np.nan),
        construct=partial(_same, made),
    )


def outline(loop: Sequence[Edge], step: float) -> Array:
    """A loop as a polygon (N, 2), chords about ``step`` mm; not closed."""
    points = []
    for edge in loop:
        one = edge.shown
        for n in range(len(one.radius)):
            length = abs(float(one.sweep[n])) * float(one.radius[n])
            turn = abs(float(one.sweep[n]))
            count = max(1, int(np.ceil(length / step)), int(np.ceil(turn / 0.3)))
            share = np.arange(count)[:, None] / count
            each = one.take([n])
            angle = each.start + each.sweep * share[:, 0]
            ray = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
            points.append(each.center + each.radius * ray)
    return np.concatenate(points)


def contains(polygon: Array, points: Array) -> NDArray[np.bool_]:
    """Which points (N, 2) a polygon (M, 2) contains, by the even-odd rule."""
    p, a, b = points[:, None, :], polygon[None], np.roll(polygon, -1, axis=0)[None]
    crosses = (a[..., 1] > p[..., 1]) != (b[..., 1] > p[..., 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        x = a[..., 0] + (p[..., 1] - a[..., 1]) * (b[..., 0] - a[..., 0]) / (b[..., 1] - a[..., 1])
    result: NDArray[np.bool_] = ((crosses & (p[..., 0] < x)).sum(axis=1) % 2).astype(bool)
    return result


def point_inside(loops: Sequence[Sequence[Edge]]) -> Array:
    """A point (2,) well inside a region: of a grid the one farthest from the boundary."""
    if not loops:
        return np.full(2, np.nan)
    nodes = np.concatenate([edge.nodes for loop in loops for edge in loop])
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    step = float((high - low).max()) / 60.0
    polygons = [outline(loop, step) for loop in loops]
    count = np.maximum(np.ceil((high - low) / step).astype(int), 8)
    axes = [low[k] + (high[k] - low[k]) * (np.arange(count[k]) + 0.5) / count[k] for k in range(2)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    held = sum(contains(polygon, grid).astype(int) for polygon in polygons) % 2 == 1
    held = np.asarray(held)
    if not held.any():  # a sliver: beside the middle of its longest edge
        edge = max((e for loop in loops for e in loop), key=_length)
        k = len(edge.nodes) // 2
        along = edge.steps[k] / np.hypot(*edge.steps[k])
        beside: Array = edge.nodes[k] + 1e-6 * step * np.array([-along[1], along[0]])
        return beside
    inner = grid[held]
    rim = np.concatenate(polygons)
    distance = np.array([np.hypot(*(rim - point).T).min() for point in inner])
    best: Array = inner[int(distance.argmax())]
    return best


def _moments(loop: Sequence[Edge]) -> Array:
    """∫ 1, x, y, x², y², xy over what a loop encloses, (6,)."""
    x, y = np.concatenate([edge.nodes for edge in loop]).T
    dx, dy = np.concatenate([edge.steps for edge in loop]).T
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


def _length(edge: Edge) -> float:
    return float(np.hypot(edge.steps[:, 0], edge.steps[:, 1]).sum())


def _pieces(loops: Sequence[Sequence[Edge]], areas: Array) -> Ints:
    """Which connected piece each loop bounds: a hole that of the smallest loop around it."""
    piece = np.zeros(len(loops), dtype=int)
    outer = [n for n in range(len(loops)) if areas[n] > 0.0]
    for number, n in enumerate(outer):
        piece[n] = number
    polygons = {n: outline(loops[n], np.sqrt(areas[n]) / 50.0) for n in outer}
    for n in range(len(loops)):
        if areas[n] <= 0.0:
            probe = loops[n][0].nodes[:1]
            around = [m for m in outer if contains(polygons[m], probe)[0]]
            if around:
                piece[n] = piece[min(around, key=lambda m: float(areas[m]))]
    return piece


def _construction(circles: Arcs | None) -> Construction:
    made = _none() if circles is None else circles
    return Construction(
        made.center,
        made.radius,
        made.limb,
        made.bound,
        np.zeros((0, 2, 2)),
        np.zeros(0, dtype=int),
    )


def _same(made: Construction) -> Construction:
    """A section keeps how it was made behind a call, which must cross to other processes."""
    return made


def _none() -> Arcs:
    ints = np.zeros(0, dtype=int)
    return Arcs(np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0), ints, ints)
