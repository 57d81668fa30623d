"""Connected pieces of the workspace, followed from section to section. Scalars, see `sweep`."""

from __future__ import annotations

import math

import numpy as np

from kinematics.arrays import Array, Ints
from kinematics.mechanisms.five_rpur.slicing.measures import run_area
from kinematics.mechanisms.five_rpur.slicing.sweep import (
    MOST_RUNS,
    Bools,
    bounds_of,
    height,
    heights,
    rooms,
    root,
    sweep,
)

BETWEEN = 4  # halvings of the distance of two sections, to see who belongs to whom


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
