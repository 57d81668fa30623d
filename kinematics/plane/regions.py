"""Loops of edges as a section with its area, moments and pieces, and points of a region."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.sections import Construction, Section, kept
from kinematics.arrays import Array, Ints
from kinematics.plane.arcs import Arcs, Edge, joined, moments, nearest


def section_of(
    loops: Sequence[Sequence[Edge]], circles: Arcs | None = None, at: float = 0.0
) -> Section:
    """Loops as a section; area and moments from the true edges.

    The pieces come largest first, each before its holes.

    Args:
        loops: outer ones counter-clockwise, holes clockwise.
        circles: what is drawn as having made it; None: nothing.
        at: where the section stands, mm.
    """
    nodes = [np.concatenate([edge.nodes for edge in loop]) for loop in loops]
    about = np.concatenate(nodes).mean(axis=0) if nodes else np.zeros(2)  # keeps the digits
    steps = [np.concatenate([edge.steps for edge in loop]) for loop in loops]
    every = np.array([_moments(n, s, about) for n, s in zip(nodes, steps, strict=True)])
    every = every.reshape(-1, 6)
    piece = _pieces(loops, every[:, 0])
    order = np.lexsort((-every[:, 0], piece))
    loops, every, piece = [loops[n] for n in order], every[order], piece[order]
    total = every.sum(axis=0)
    area = float(total[0])
    centroid, second = np.full(2, np.nan), np.zeros(3)
    if area > 0.0:
        x, y = total[1:3] / area
        centroid = about + total[1:3] / area
        second = total[3:] - area * np.array([x * x, y * y, x * y])
    shown = [joined([edge.shown for edge in loop]) for loop in loops]
    arcs = joined(shown) if shown else _none()
    start, end = arcs.at(0.0), arcs.at(1.0)
    first = np.cumsum([0, *(len(one.radius) for one in shown)]).astype(int)
    for a, b in pairwise(first.tolist()):  # neighbours meet exactly
        end[a : b - 1] = start[a + 1 : b]
        end[b - 1] = start[a]
    made = _none() if circles is None else circles
    return Section(
        at=float(at),
        start=start,
        end=end,
        limb=arcs.limb,
        bound=arcs.bound,
        center=arcs.center,
        radius=arcs.radius,
        sweep=arcs.sweep,
        loop_start=first,
        loop_area=every[:, 0],
        loop_piece=piece,
        area=area,
        perimeter=float(sum(_length(edge) for loop in loops for edge in loop)),
        centroid=centroid,
        second_moments=second,
        construct=kept(Construction.of_circles(made.center, made.radius, made.limb, made.bound)),
        area_error=float(sum(edge.area_error for loop in loops for edge in loop)),
    )


def nearest_point(section: Section, point: ArrayLike) -> tuple[Array, int] | None:
    """The point of a boundary of arcs nearest to ``point`` (2,), and on which edge it lies."""
    if not section.loops:
        return None
    away = section.start - section.center
    first = np.arctan2(away[:, 1], away[:, 0])
    arcs = Arcs(section.center, section.radius, first, section.sweep, section.limb, section.bound)
    k, place = nearest(arcs, np.asarray(point, dtype=float))
    return place, k


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
    return np.asarray(((crosses & (p[..., 0] < x)).sum(axis=1) % 2).astype(bool))


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
        return np.asarray(edge.nodes[k] + 1e-6 * step * np.array([-along[1], along[0]]))
    inner = grid[held]
    rim = np.concatenate(polygons)
    distance = np.array([np.hypot(*(rim - point).T).min() for point in inner])
    return np.asarray(inner[int(distance.argmax())])


def _moments(nodes: Array, steps: Array, about: Array) -> Array:
    """`moments` about a point, (6,), taken about the loop's own middle, where they keep digits."""
    middle = nodes.mean(axis=0)
    area, x, y, xx, yy, xy = moments(nodes - middle, steps).tolist()
    u, v = (middle - about).tolist()
    return np.array(
        [
            area,
            x + u * area,
            y + v * area,
            xx + 2.0 * u * x + u * u * area,
            yy + 2.0 * v * y + v * v * area,
            xy + u * y + v * x + u * v * area,
        ]
    )


def _length(edge: Edge) -> float:
    return float(np.hypot(edge.steps[:, 0], edge.steps[:, 1]).sum())


def _pieces(loops: Sequence[Sequence[Edge]], areas: Array) -> Ints:
    """Which connected piece each loop bounds, the largest first: a hole that of the smallest loop
    around it."""
    piece = np.zeros(len(loops), dtype=int)
    outer = sorted((n for n in range(len(loops)) if areas[n] > 0.0), key=lambda n: -areas[n])
    piece[outer] = np.arange(len(outer))
    holes = [n for n in range(len(loops)) if areas[n] <= 0.0]
    if not holes:
        return piece
    polygons = {n: outline(loops[n], np.sqrt(areas[n]) / 50.0) for n in outer}
    for n in holes:
        # A hole may touch the loop around it, whose chords lie a little further inside.
        probes = np.concatenate([edge.nodes for edge in loops[n]])
        around = [m for m in outer if contains(polygons[m], probes).mean() > 0.5]
        if around:
            piece[n] = piece[min(around, key=lambda m: float(areas[m]))]
    return piece


def _none() -> Arcs:
    ints = np.zeros(0, dtype=int)
    return Arcs(np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0), ints, ints)
