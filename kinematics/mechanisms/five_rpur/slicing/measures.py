"""What is measured in sections: area, moments, their runs and pieces. Scalars, see `sweep`."""

from __future__ import annotations

import math

import numpy as np

from kinematics.arrays import Array, Ints
from kinematics.mechanisms.five_rpur.slicing.sweep import (
    LINK,
    WX,
    WY,
    WZ,
    Bools,
    Room,
    bounds_of,
    offset,
    rooms,
    root,
    sweep,
)


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
) -> int:
    """Area and moments of one section, and how they change along x'.

    Args:
        x: x'.
        low, high: (n,) S(ρ_min) and S(ρ_max) of every limb; all of them reach x.
        limbs: (6, n) w'_x, w'_y, w'_z, l, ρ_min, ρ_max.
        signs: (n, 2) which signs are asked for at all.
        table: (M, 4^5) which states are inside of each machine, see `sweep.holds`.
        ends: (2,) where all limbs can close, from `bounds_of`.
        size: mm, a length of the machine.
        origin: (2,) about which moments are taken.
        room: `rooms`, in which the runs are left.
        moments: (6,) out: ∫ of 1, v, w, and their derivatives by x'. Edges alone move, so that of
            the area is the sum of edges' velocities along z' times their extents along y'.

    Returns:
        a number, equal where sections are built alike and 0 where there is nothing.
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
    return mark


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
) -> None:
    """Area and moments of many sections.

    Args:
        at: (N,) x' of the sections.
        lows, highs: (N, n) S(ρ_min) and S(ρ_max) of every limb; a negative ``highs`` is out of
            reach.
        limbs, signs, table, size, origin: as for `measured`.
        moments: (N, 6) out, as of `measured`.
        marks: (N,) out: equal where the sections are built alike, 0 where there is nothing.
    """
    n = limbs.shape[1]
    room = rooms(n)
    ends = np.empty(2)
    bounds_of(limbs, ends)
    for k in range(at.size):
        marks[k] = 0
        moments[k, :] = 0.0
        if ends[0] < ends[1] and highs[k].min() >= 0.0:
            marks[k] = measured(
                at[k],
                limbs,
                lows[k],
                highs[k],
                signs,
                table,
                ends,
                size,
                origin,
                room,
                moments[k],
            )


def runs_of(
    at: Array,
    lows: Array,
    highs: Array,
    limbs: Array,
    signs: Bools,
    table: Bools,
    size: float,
    firsts: Ints,
    curves: Ints,
    spans: Array,
    pieces: Ints,
    tells: Ints,
    marks: Ints,
) -> int:
    """The runs of many sections.

    Args:
        at, lows, highs, limbs, signs, table, size: as for `measure`.
        firsts: (N + 1,) out: the first run of each section, and their number.
        curves, spans: (R, 2) out: each run's lower and upper curve, and y' at its ends.
        pieces: (R,) out: of which piece it is; those of all sections are counted from 0.
        tells: (R,) out: numbers whose sum over the runs of a piece tells how it is built.
        marks: (N,) out: as of `measure`.

    Returns:
        the number of runs, −1 if there was no room for them.
    """
    n = limbs.shape[1]
    room = rooms(n)
    _, _, _, _, runs, ends_of, parent, _, told, _, _ = room
    ends = np.empty(2)
    bounds_of(limbs, ends)
    used = known = 0
    firsts[0] = 0
    for k in range(at.size):
        marks[k] = 0
        if ends[0] < ends[1] and highs[k].min() >= 0.0:
            count, _, marks[k] = sweep(limbs, lows[k], highs[k], signs, table, ends, size, room)
            if used + count > spans.shape[0]:
                return -1
            for run in range(count):
                stands = root(parent, run)  # none later than the run itself
                curves[used + run, 0], curves[used + run, 1] = runs[run, 0], runs[run, 1]
                spans[used + run, 0], spans[used + run, 1] = ends_of[run, 0], ends_of[run, 1]
                tells[used + run] = told[run]
                if stands == run:
                    pieces[used + run] = known
                    known += 1
                else:
                    pieces[used + run] = pieces[used + stands]
            used += count
        firsts[k + 1] = used
    return used
