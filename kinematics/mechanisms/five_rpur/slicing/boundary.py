"""The boundary of a section as loops of arcs and lines, with its moments. Scalars, see `sweep`."""

from __future__ import annotations

import math

import numpy as np

from kinematics.arrays import Array, Ints
from kinematics.mechanisms.five_rpur.slicing.measures import base_of, first_moments, second_moments
from kinematics.mechanisms.five_rpur.slicing.sweep import (
    LINK,
    WY,
    WZ,
    Bools,
    bounds_of,
    height,
    heights,
    offset,
    rooms,
    root,
    sweep,
)

POINT = 1e-13  # of the size: an edge no longer than that is a point


def vertex(
    limbs: Array,
    low: Array,
    high: Array,
    one: int,
    two: int,
    y: float,
    size: float,
    where: Array,
    who: Ints,
    found: int,
    out: Array,
) -> None:
    """The point at ``y`` where curves one and two meet into ``out`` (2,).

    A crossing of their circles is more exact than the curves' heights where these are steep.
    """
    first = 4 * (one >> 3) + (one & 3)
    second = 4 * (two >> 3) + (two & 3)
    nearest = 1e-7 * size
    z1, z2 = height(limbs, low, high, one, y), height(limbs, low, high, two, y)
    out[0], out[1] = y, 0.5 * (z1 + z2)
    # Steep curves give a poor height: the crossing's own is then far from it.
    reach = abs(z1 - z2) + 1e-4 * size
    for e in range(found):
        same = (who[e, 0] == first and who[e, 1] == second) or (
            who[e, 0] == second and who[e, 1] == first
        )
        if same and abs(where[e, 0] - y) <= nearest and abs(where[e, 1] - out[1]) <= reach:
            out[0], out[1] = where[e, 0], where[e, 1]
            return


def turn(limbs: Array, c: int, y0: float, y1: float) -> float:
    """The angle of curve c's circle between two y."""
    i = c >> 3
    link = limbs[LINK, i]
    one = min(max((y0 - limbs[WY, i]) / link, -1.0), 1.0)
    two = min(max((y1 - limbs[WY, i]) / link, -1.0), 1.0)
    return math.asin(two) - math.asin(one)


def without_points(
    edges: Ints, ends: Array, turns: Array, start: int, total: int, size: float
) -> int:
    """A loop of edges from ``start`` to ``total`` without those that have shrunk to a point.

    Arcs of one circle that follow each other become one, also over the loop's beginning. Returns
    the new ``total``: what is left has two edges at least, for the region lies above circles
    −S(ρ_max) and S(ρ_min) and below the others, so that none of them bounds it alone.
    """
    kept = start
    y, z = ends[total - 1, 0], ends[total - 1, 1]
    for e in range(start, total):
        far = abs(ends[e, 0] - y) + abs(ends[e, 1] - z) > POINT * size
        before = edges[kept - 1, 0] if kept > start else edges[total - 1, 0]
        after = edges[e + 1, 0] if e + 1 < total else edges[start, 0]
        between = before < 0 and after < 0 and ends[e, 0] != y  # two lines that are not one
        y, z = ends[e, 0], ends[e, 1]
        if not (far or between):
            continue
        if kept > start and edges[e, 0] == edges[kept - 1, 0] and edges[e, 1] == edges[kept - 1, 1]:
            kept -= 1
            turns[e] += turns[kept]
        edges[kept], ends[kept], turns[kept] = edges[e], ends[e], turns[e]
        kept += 1
    if (
        kept - start > 1
        and edges[start, 0] == edges[kept - 1, 0]
        and edges[start, 1] == edges[kept - 1, 1] != 0
    ):
        kept -= 1
        turns[start] += turns[kept]
    if kept - start < 2:
        return start
    for e in range(start, kept):
        if edges[e, 0] < 0:  # lines stay upright where a point was beside them
            ends[e - 1 if e > start else kept - 1, 0] = ends[e, 0]
    return kept


def outline(
    x: float,
    low: Array,
    high: Array,
    limbs: Array,
    signs: Bools,
    table: Bools,
    size: float,
    edges: Ints,
    ends: Array,
    turns: Array,
    origin: Array,
    moments: Array,
) -> int:
    """The boundary of one section as loops of edges, the region to their left.

    Args:
        low, high: (n,) out: S(ρ_min) and S(ρ_max) of every limb at x.
        edges: (E, 4) out: circle 4 limb + k, or −1 − limb of a line; +1 counter-clockwise, −1
            clockwise, 0 of a line; the piece of the region; the loop.
        ends: (E, 2) out: where each edge ends and the next one of its loop begins.
        turns: (E,) out: the arcs' angles, not quite exact.
        moments: (6,) out: ∫ of 1, v, w, v², w², vw about ``origin`` (2,).

    Returns:
        the number of edges, −1 if there was no room for them.
    """
    n = limbs.shape[1]
    room = rooms(n)
    where, who, _, _, runs, spans, parent, follow, _, _, _ = room
    range_ = np.empty(2)
    point = np.empty(2)
    first, last = bounds_of(limbs, range_)
    moments[:] = 0.0
    if not heights(x, limbs, low, high) or range_[0] >= range_[1]:
        return 0
    count, found, _ = sweep(limbs, low, high, signs, table, range_, size, room)
    for edge in range(2 * count):
        run, c = edge >> 1, runs[edge >> 1, edge & 1]
        base, sign = base_of(limbs, low, high, c), 1.0 if edge & 1 else -1.0
        y0, y1 = spans[run, 0], spans[run, 1]
        area, v, w = first_moments(limbs, c, base, y0, y1, origin[0], origin[1])
        vv, ww, vw = second_moments(limbs, c, base, y0, y1, origin[0], origin[1])
        for m, value in enumerate((area, v, w, vv, ww, vw)):
            moments[m] += sign * value
    done = np.zeros(2 * count, np.bool_)
    total = 0
    loop = 0
    for begin in range(2 * count):
        if done[begin]:
            continue
        start = total
        edge = begin
        while not done[edge]:
            if total + 3 > edges.shape[0]:
                return -1
            done[edge] = True
            run, upper = edge >> 1, edge & 1
            curve = runs[run, upper]
            circle = 4 * (curve >> 3) + (curve & 3)
            # The upper half circle is passed clockwise towards +y.
            sense = 1 if (curve & 4 != 0) == (upper == 0) else -1
            angle = turn(limbs, curve, spans[run, 0], spans[run, 1])
            if total > start and edges[total - 1, 0] == circle and edges[total - 1, 1] == sense:
                total -= 1  # the same arc goes on
                turns[total] += angle
            else:
                edges[total, 0], edges[total, 1] = circle, sense
                edges[total, 2], edges[total, 3] = root(parent, run), loop
                turns[total] = angle
            y = spans[run, 0] if upper else spans[run, 1]
            after = follow[edge]
            other = runs[after >> 1, after & 1]
            if y == range_[0] or y == range_[1]:
                # Both end on a line |y| = l; a stretch of it lies between them.
                ends[total, 0], ends[total, 1] = y, height(limbs, low, high, curve, y)
                total += 1
                z = height(limbs, low, high, other, y)
                if abs(z - ends[total - 1, 1]) > 1e-12 * size:
                    edges[total, 0] = -1 - (first if y == range_[0] else last)
                    edges[total, 1] = 0
                    edges[total, 2], edges[total, 3] = root(parent, run), loop
                    ends[total, 0], ends[total, 1] = y, z
                    turns[total] = 0.0
                    total += 1
            else:
                vertex(limbs, low, high, curve, other, y, size, where, who, found, point)
                ends[total, 0], ends[total, 1] = point[0], point[1]
                total += 1
            edge = after
        total = without_points(edges, ends, turns, start, total, size)
        if total == start:
            continue
        loop += 1
    return total


def describe(
    edges: Ints,
    ends: Array,
    turns: Array,
    limbs: Array,
    low: Array,
    high: Array,
    whose: Ints,
    places: Array,
    firsts: Ints,
    areas: Array,
    pieces: Ints,
) -> tuple[int, float]:
    """What there is to say of the edges that `outline` found (E of them), and of their loops.

    Areas by Green's theorem: the polygon of chords, and what lies between chords and arcs.

    Args:
        whose: (E, 2) out: limb from 0; 0, 1 or 2 for ρ_min, ρ_max and the line |y| = l.
        places: (E, 8) out: start, end, centre, radius and signed angle; of a line NaN, inf, 0.
        firsts, areas, pieces: (E + 1,) out: each loop's first edge, area, and piece counted from 0;
            ``firsts`` has E behind the last.

    Returns:
        the number of loops, and the sum of the edges' lengths.
    """
    count = edges.shape[0]
    perimeter = 0.0
    loops = 0
    first = 0
    while first < count:
        behind = first
        while behind < count and edges[behind, 3] == edges[first, 3]:
            behind += 1
        piece = 0
        for loop in range(loops):
            if edges[firsts[loop], 2] == edges[first, 2]:
                piece = pieces[loop]
                break
            piece = max(piece, pieces[loop] + 1)
        firsts[loops], areas[loops], pieces[loops] = first, 0.0, piece
        for e in range(first, behind):
            before = e - 1 if e > first else behind - 1
            y0, z0, y1, z1 = ends[before, 0], ends[before, 1], ends[e, 0], ends[e, 1]
            places[e, 0], places[e, 1], places[e, 2], places[e, 3] = y0, z0, y1, z1
            areas[loops] += 0.5 * (y0 * z1 - z0 * y1)
            circle = edges[e, 0]
            if circle < 0:
                whose[e, 0], whose[e, 1] = -1 - circle, 2
                places[e, 4] = places[e, 5] = math.nan
                places[e, 6], places[e, 7] = math.inf, 0.0
                perimeter += abs(y1 - y0) + abs(z1 - z0)
                continue
            i, k = circle >> 2, circle & 3
            y, z = limbs[WY, i], limbs[WZ, i] + offset(k, low[i], high[i])
            link, sense = limbs[LINK, i], edges[e, 1]
            # The exact angle next to the one that was added up.
            angle = sense * (math.atan2(z1 - z, y1 - y) - math.atan2(z0 - z, y0 - y))
            angle += 2.0 * math.pi * round((turns[e] - angle) / (2.0 * math.pi))
            whose[e, 0], whose[e, 1] = i, 1 if k == 0 or k == 3 else 0
            places[e, 4], places[e, 5], places[e, 6], places[e, 7] = y, z, link, sense * angle
            areas[loops] += 0.5 * link * link * sense * (angle - math.sin(angle))
            perimeter += link * abs(angle)
        loops += 1
        first = behind
    firsts[loops] = count
    return loops, perimeter
