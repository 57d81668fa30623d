"""What is asked of sections: moments, boundary, connected pieces. Scalars, see `sweep`."""

from __future__ import annotations

import math

import numpy as np

from kinematics.five_rpur.slicing.sweep import (
    LINK,
    MOST_RUNS,
    WX,
    WY,
    WZ,
    Bools,
    Room,
    bounds_of,
    height,
    heights,
    offset,
    rise,
    rooms,
    root,
    sweep,
)
from kinematics.sections import Ints
from kinematics.spatial import Array

BETWEEN = 4  # halvings of the distance of two sections, to see who belongs to whom
POINT = 1e-13  # of the size: an edge no longer than that is a point


def first_moments(
    limbs: Array, c: int, base: float, y0: float, y1: float, v0: float, w0: float
) -> tuple[float, float, float]:
    """∫ of 1, v, w over what lies under curve c between y0 and y1, without what does not end there.

    (v, w) = (y − v0, z − w0) and z = base + σ h(t), t = y − w'_iy: ∫h dt = (t h + l² asin(t/l))/2,
    ∫t h dt = −h³/3.
    """
    i = c >> 3
    sigma = -1.0 if c & 4 else 1.0
    link, center = limbs[LINK, i], limbs[WY, i]
    t0 = min(max(y0 - center, -link), link)
    t1 = min(max(y1 - center, -link), link)
    q0, q1 = (link - t0) * (link + t0), (link - t1) * (link + t1)
    h0, h1 = math.sqrt(q0), math.sqrt(q1)
    # asin(t/l) would lose half the digits at the ends, where t is all but l.
    angle = math.atan2(t1 * h0 - t0 * h1, h0 * h1 + t0 * t1)
    ih = 0.5 * (t1 * h1 - t0 * h0 + link * link * angle)
    ith = (q0 * h0 - q1 * h1) / 3.0
    it = t1 - t0
    itt = 0.5 * it * (t1 + t0)
    ihh = it * (link * link - (t1 * t1 + t1 * t0 + t0 * t0) / 3.0)
    a, b = center - v0, base - w0  # v = t + a, w = b + σ h
    area = b * it + sigma * ih
    v = b * itt + a * area + sigma * ith
    w = 0.5 * (b * b * it + ihh) + b * sigma * ih
    return area, v, w


def second_moments(
    limbs: Array, c: int, base: float, y0: float, y1: float, v0: float, w0: float
) -> tuple[float, float, float]:
    """∫ of v², w², vw likewise, with ∫t²h dt and ∫h³ dt besides."""
    i = c >> 3
    sigma = -1.0 if c & 4 else 1.0
    link, center = limbs[LINK, i], limbs[WY, i]
    l2 = link * link
    sign = -1.0
    it = itt = ittt = ih = ith = itth = ihhh = ithh = 0.0
    for y in (y0, y1):
        t = min(max(y - center, -link), link)
        square = (link - t) * (link + t)
        h = math.sqrt(square)
        angle = math.atan2(t, h)
        area = 0.5 * (t * h + l2 * angle)
        it += sign * t
        itt += sign * 0.5 * t * t
        ittt += sign * t * t * t / 3.0
        ih += sign * area
        ith -= sign * square * h / 3.0
        itth += sign * 0.125 * (l2 * l2 * angle - t * h * (l2 - 2.0 * t * t))
        ihhh += sign * (0.25 * t * square * h + 0.75 * l2 * area)
        ithh += sign * (0.5 * l2 * t * t - 0.25 * t * t * t * t)
        sign = 1.0
    a, b = center - v0, base - w0
    ihh = l2 * it - ittt
    vv = b * (ittt + 2.0 * a * itt + a * a * it) + sigma * (itth + 2.0 * a * ith + a * a * ih)
    ww = (b * b * b * it + 3.0 * b * b * sigma * ih + 3.0 * b * ihh + sigma * ihhh) / 3.0
    vw = 0.5 * (b * b * (itt + a * it) + 2.0 * b * sigma * (ith + a * ih) + ithh + a * ihh)
    return vv, ww, vw


def base_of(limbs: Array, low: Array, high: Array, c: int) -> float:
    """z of the centre of curve c's circle."""
    return float(limbs[WZ, c >> 3] + offset(c & 3, low[c >> 3], high[c >> 3]))


def velocity(limbs: Array, low: Array, high: Array, c: int, x: float) -> float:
    """dz'/dx' of curve c; 0 where it is infinite."""
    i, k = c >> 3, c & 3
    outer = k == 0 or k == 3
    s = high[i] if outer else low[i]
    slope = (limbs[WX, i] - x) / s if s > 0.0 else 0.0
    return float(-slope if k < 2 else slope)


def run_area(
    x: float, limbs: Array, low: Array, high: Array, runs: Ints, spans: Array, run: int
) -> tuple[float, float]:
    """The area of a run, and its derivative by x', ends left out."""
    y0, y1 = spans[run, 0], spans[run, 1]
    c, d = runs[run, 0], runs[run, 1]
    area, _, _ = first_moments(limbs, d, base_of(limbs, low, high, d), y0, y1, 0.0, 0.0)
    less, _, _ = first_moments(limbs, c, base_of(limbs, low, high, c), y0, y1, 0.0, 0.0)
    slope = velocity(limbs, low, high, d, x) - velocity(limbs, low, high, c, x)
    return area - less, slope * (y1 - y0)


def measured(
    x: float,
    limbs: Array,
    low: Array,
    high: Array,
    signs: Bools,
    table: Bools,
    ends: Array,
    size: float,
    origin: Array,
    room: Room,
    moments: Array,
) -> tuple[int, int]:
    """Area and moments of one section, and how they change along x'.

    Args:
        x: x'.
        low, high: (n,) S(ρ_min) and S(ρ_max) of every limb; all of them reach x.
        limbs: (6, n) w'_x, w'_y, w'_z, l, ρ_min, ρ_max.
        signs: (n, 2) which signs are asked for at all.
        table: (4^n,) which states are inside.
        ends: (2,) where all limbs can close, from `bounds_of`.
        size: mm, a length of the machine.
        origin: (2,) about which moments are taken.
        room: `rooms`, in which the runs are left.
        moments: (6,) out: ∫ of 1, v, w, and their derivatives by x'. Edges alone move, so that of
            the area is the sum of edges' velocities along z' times their extents along y'.

    Returns:
        a number, equal where sections are built alike and 0 where there is nothing, and how many
        runs there are.
    """
    _, _, _, _, runs, spans, _, _, _, _, _ = room
    for m in range(6):
        moments[m] = 0.0
    count, _, mark = sweep(limbs, low, high, signs, table, ends, size, room)
    for run in range(count):
        y0, y1 = spans[run, 0], spans[run, 1]
        for end in range(2):
            c = runs[run, end]
            sign = 1.0 if end else -1.0
            base = base_of(limbs, low, high, c)
            area, v, w = first_moments(limbs, c, base, y0, y1, origin[0], origin[1])
            moments[0] += sign * area
            moments[1] += sign * v
            moments[2] += sign * w
            slope = sign * velocity(limbs, low, high, c, x)
            moments[3] += slope * (y1 - y0)
            moments[4] += slope * (y1 - y0) * (0.5 * (y0 + y1) - origin[0])
            moments[5] += slope * area
    return mark, count


def measure(
    at: Array,
    lows: Array,
    highs: Array,
    limbs: Array,
    signs: Bools,
    table: Bools,
    size: float,
    origin: Array,
    moments: Array,
    marks: Ints,
    parts: Ints,
) -> None:
    """Area and moments of many sections.

    Args:
        at: (N,) x' of the sections.
        lows, highs: (N, n) S(ρ_min) and S(ρ_max) of every limb; a negative ``highs`` is out of
            reach.
        limbs, signs, table, size, origin: as for `measured`.
        moments: (N, 3) out: ∫ of 1, v, w.
        marks: (N,) out: equal where the sections are built alike.
        parts: (N,) out: connected pieces.
    """
    n = limbs.shape[1]
    room = rooms(n)
    _, _, _, _, _, _, parent, _, _, _, _ = room
    ends = np.empty(2)
    bounds_of(limbs, ends)
    found = np.empty(6)
    for k in range(at.size):
        parts[k] = marks[k] = 0
        moments[k, :] = 0.0
        if ends[0] < ends[1] and highs[k].min() >= 0.0:
            marks[k], count = measured(
                at[k], limbs, lows[k], highs[k], signs, table, ends, size, origin, room, found
            )
            moments[k, :] = found[:3]
            for run in range(count):
                parts[k] += parent[run] == run


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


def overlap(
    limbs: Array,
    lows: Array,
    highs: Array,
    runs: Ints,
    spans: Array,
    run: int,
    runs0: Ints,
    spans0: Array,
    other: int,
    this: int,
) -> bool:
    """Whether a run of one section and a run of another one have points in common.

    ``lows`` and ``highs`` (2, n) are of both sections, ``this`` is the run's row in them.
    """
    y0 = max(spans[run, 0], spans0[other, 0])
    y1 = min(spans[run, 1], spans0[other, 1])
    if y1 <= y0:
        return False
    y = 0.5 * (y0 + y1)
    low, high, low0, high0 = lows[this], highs[this], lows[1 - this], highs[1 - this]
    bottom = max(
        height(limbs, low, high, runs[run, 0], y), height(limbs, low0, high0, runs0[other, 0], y)
    )
    top = min(
        height(limbs, low, high, runs[run, 1], y), height(limbs, low0, high0, runs0[other, 1], y)
    )
    return bool(top > bottom)


def trace(
    at: Array,
    weights: Array,
    limbs: Array,
    signs: Bools,
    table: Bools,
    size: float,
    forest: Ints,
    volumes: Array,
) -> int:
    """The connected pieces of the workspace, from sections at increasing x'.

    Pieces of neighbouring sections belong together where they are built alike or, if they are
    not, where they overlap. Where a piece overlaps none, sections between the two are looked at:
    it may have begun there, or moved on.

    Args:
        at: (N,) x', weights: (N, 2) of the areas and of their derivatives by x'.
        forest: (M,) room: who stands for each piece of each section.
        volumes: (M, 2) out: weight times area of each piece of each section, and the same of
            derivatives.

    Returns:
        how many of M were needed, −1 if there was no room.
    """
    n = limbs.shape[1]
    spaces = (rooms(n), rooms(n))  # of this section and of the last one
    piece = np.empty((2, MOST_RUNS), np.int64)
    lows, highs = np.empty((2, n)), np.empty((2, n))
    ends = np.empty(2)
    bounds_of(limbs, ends)
    counts, firsts, marks = np.zeros(2, np.int64), np.zeros(2, np.int64), np.zeros(2, np.int64)
    linked = np.zeros(forest.size, np.bool_)
    met = np.zeros(forest.size, np.bool_)
    told = np.zeros(forest.size, np.int64)
    waiting = np.empty(BETWEEN + 1)  # x' of sections not yet traced, the next one last
    x_last = math.nan
    used = 0
    this = 0
    for k in range(at.size):
        waits = 1
        waiting[0] = at[k]
        while waits > 0:
            x = waiting[waits - 1]
            last, this = this, 1 - this
            counts[this] = marks[this] = 0
            firsts[this] = used
            low, high = lows[this], highs[this]
            if heights(x, limbs, low, high) and ends[0] < ends[1]:
                counts[this], _, marks[this] = sweep(
                    limbs, low, high, signs, table, ends, size, spaces[this]
                )
            _, _, _, _, runs, spans, parent, _, tells, _, _ = spaces[this]
            _, _, _, _, runs0, spans0, _, _, _, _, _ = spaces[last]
            count = counts[this]
            if used + count > forest.size:
                return -1
            for run in range(count):
                if parent[run] == run:
                    piece[this, run] = used
                    forest[used] = used
                    volumes[used, 0] = volumes[used, 1] = 0.0
                    told[used] = 0
                    used += 1
            for a in range(firsts[last], used):
                linked[a] = met[a] = False
            for run in range(count):
                own = piece[this, root(parent, run)]
                piece[this, run] = own
                told[own] += tells[run]
            # Pieces that are built alike are the same, in their order if there are several.
            alike = marks[this] == marks[last]
            for a in range(firsts[this], used):
                twins, match = 0, -1
                for b in range(firsts[last], firsts[this]):
                    if told[b] == told[a]:
                        twins += 1
                        if not linked[b] and match < 0:
                            match = b
                if match >= 0 and (alike or twins == 1):
                    linked[a] = linked[match] = True
                    forest[a] = match
            # The others changed in between: they are the same where they overlap.
            for join in range(2):
                for run in range(count):
                    a = piece[this, run]
                    if linked[a]:
                        continue
                    for other in range(counts[last]):
                        b = piece[last, other]
                        if not linked[b] and overlap(
                            limbs, lows, highs, runs, spans, run, runs0, spans0, other, this
                        ):
                            met[a] = met[b] = True
                            if join:
                                one, two = root(forest, a), root(forest, b)
                                forest[max(one, two)] = min(one, two)
                if join or waits > BETWEEN or count == 0 or counts[last] == 0:
                    continue
                alone = False
                for a in range(firsts[last], used):
                    alone = alone or not (linked[a] or met[a])
                if alone:
                    break
            else:
                x_last = x
                waits -= 1
                for run in range(count):
                    if waits == 0:
                        area, slope = run_area(x, limbs, low, high, runs, spans, run)
                        volumes[piece[this, run], 0] += weights[k, 0] * area
                        volumes[piece[this, run], 1] += weights[k, 1] * slope
                continue
            # Something is alone: first what is between the two sections.
            waiting[waits] = 0.5 * (x_last + x)
            waits += 1
            used = firsts[this]
            this = last
    return used


def strokes(
    lows: Array,
    highs: Array,
    limbs: Array,
    at: Array,
    signs: Bools,
    table: Bools,
    size: float,
    samples: int,
    low_used: Array,
    high_used: Array,
) -> None:
    """The shortest and the longest actuators in sections, from points of their boundaries.

    Args:
        lows, highs: (N, n), at: (N,) x' of the sections.
        samples: how many points on each edge.
        low_used, high_used: (n,) changed: ρ_min and ρ_max that occur, ±inf before any.
    """
    n = limbs.shape[1]
    room = rooms(n)
    _, _, _, _, runs, spans, _, _, _, _, _ = room
    slack = 1e-7 * size
    ends = np.empty(2)
    bounds_of(limbs, ends)
    rho = np.empty((n, 2))
    for section in range(lows.shape[0]):
        low, high = lows[section], highs[section]
        count, _, _ = sweep(limbs, low, high, signs, table, ends, size, room)
        for run in range(count):
            for end in range(2):
                for sample in range(samples):
                    share = sample / (samples - 1.0)
                    y = spans[run, 0] + share * (spans[run, 1] - spans[run, 0])
                    z = height(limbs, low, high, runs[run, end], y)
                    state = 0
                    for i in range(n):
                        h = rise(limbs, i, y)
                        dx = at[section] - limbs[WX, i]
                        for s in range(2):
                            dz = z - limbs[WZ, i] + (h if s else -h)
                            rho[i, s] = math.sqrt(dx * dx + dz * dz)
                            if low[i] - slack <= abs(dz) <= high[i] + slack:
                                state |= 1 << (2 * i + s)
                    for i in range(n):
                        for s in range(2):
                            # Some wanted mode must hold the point with the limb in this sign.
                            if state >> (2 * i + s) & 1 and table[state & ~(1 << (2 * i + 1 - s))]:
                                low_used[i] = min(low_used[i], rho[i, s])
                                high_used[i] = max(high_used[i], rho[i, s])
