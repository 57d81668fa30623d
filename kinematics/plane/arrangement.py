"""Regions of a plane bounded by circular arcs: which parts of given arcs are the boundary.

A mechanism hands in every arc that may bound its region, and a test that says which points are
inside. The arcs are cut where they meet; a part belongs to the boundary if the region is on one of
its sides only, and `kinematics.plane.arcs` chains parts to loops. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array, Ints
from kinematics.plane.arcs import MEETING, Arcs, Edge, arc_edge, chained, first_of, joined, places
from kinematics.plane.circle_crossings import factors, half_chord

Inside = Callable[[Array], NDArray[np.bool_]]

_TOUCH = 1e-12  # of the size: circles that overlap by less only touch
_ASIDE = 1e-7  # of the size: how far beside a part its sides are asked for
_PROBES = (0.5, 0.27, 0.81)  # of a part: by one of them another arc may pass nearer than that


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
    points = points[first_of(places(points, near))]
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
