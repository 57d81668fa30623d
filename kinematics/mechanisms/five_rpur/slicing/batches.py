"""Many sections at once in numpy: what `measure` and `runs_of` of `measures` do, not compiled.

The same sweep as in `sweep`, for the slabs of all sections together: some hundred operations on
arrays, whatever the number of sections. The results are the same but for rounding, and stand in
for those of the kernel until that is compiled.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array, Ints
from kinematics.mechanisms.five_rpur.slicing.sweep import (
    FINE,
    HALVES,
    LINK,
    SLACK,
    TOUCH,
    WX,
    WY,
    WZ,
    Bools,
)

_AT_ONCE = 96  # sections; more take more memory than a processor keeps at hand
_K = np.arange(4)


@dataclass(frozen=True, eq=False)
class _Cells:
    """Sections in slabs along y', and in each slab what lies between two curves.

    Attributes:
        section: (S,) of each slab.
        left, right: (S,) y' at its ends.
        slab: (C,) of each cell; cells of a slab stand from below.
        curves: (C, 2) the lower and the upper one.
        bases: (N, 8n) z' of the centre of each curve's circle, of all sections.
    """

    section: NDArray[np.intp]
    left: Array
    right: Array
    slab: NDArray[np.intp]
    curves: Ints
    bases: Array


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
    """Area and moments of many sections, see `measures.measure`."""
    moments[:] = 0.0
    marks[:] = 0
    for chosen in _chunks(lows, highs, limbs):
        low, high = lows[chosen], highs[chosen]
        cells = _cells(low, high, limbs, signs, table, size)
        _, told, where = _vertices(cells, limbs)
        marks[chosen] = _sums(told, where, len(chosen))
        of = cells.section[cells.slab]
        y0, y1 = cells.left[cells.slab], cells.right[cells.slab]
        for end, sign in ((0, -1.0), (1, 1.0)):
            c = cells.curves[:, end]
            speed = sign * speeds(at[chosen], low, high, limbs)[of, c]
            area, v, w = first_moments(limbs, c, cells.bases[of, c], y0, y1, origin)
            swept = speed * (y1 - y0)
            parts = (
                sign * area,
                sign * v,
                sign * w,
                swept,
                swept * (0.5 * (y0 + y1) - origin[0]),
                speed * area,
            )
            for n, part in enumerate(parts):
                moments[chosen, n] += np.bincount(of, part, len(chosen))


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
    """The runs of many sections, see `measures.runs_of`."""
    firsts[:] = 0
    marks[:] = 0
    used = known = 0
    for chosen in _chunks(lows, highs, limbs):
        cells = _cells(lows[chosen], highs[chosen], limbs, signs, table, size)
        run_of, first, last = _joined(cells)
        count = len(first)
        if used + count > len(spans):
            return -1
        here = slice(used, used + count)
        curves[here] = cells.curves[first]
        spans[here, 0] = cells.left[cells.slab[first]]
        spans[here, 1] = cells.right[cells.slab[last]]
        heads, told, where = _vertices(cells, limbs)
        tells[here] = _sums(told, run_of[heads], count)
        marks[chosen] = _sums(told, where, len(chosen))
        one, two = _touching(cells, limbs, size)
        pieces[here] = known + components(count, run_of[one], run_of[two])
        firsts[chosen + 1] = np.bincount(cells.section[cells.slab[first]], minlength=len(chosen))
        used += count
        known = int(pieces[here].max(initial=known - 1)) + 1
    np.cumsum(firsts, out=firsts)
    return used


def _chunks(lows: Array, highs: Array, limbs: Array) -> list[NDArray[np.intp]]:
    """Which sections there are anything in, some at a time."""
    if not (limbs[WY] - limbs[LINK]).max() < (limbs[WY] + limbs[LINK]).min():
        return []
    there = np.flatnonzero((highs >= 0.0).all(axis=1))
    return [there[n : n + _AT_ONCE] for n in range(0, len(there), _AT_ONCE)]


def _sums(values: Ints, where: NDArray[np.intp], count: int) -> Ints:
    """Sums of whole numbers, which floats would not hold."""
    result = np.zeros(count, np.int64)
    np.add.at(result, where, values)
    return result


# --- slabs and cells -----------------------------------------------------------------------------


def _cells(
    low: Array, high: Array, limbs: Array, signs: Bools, table: Bools, size: float
) -> _Cells:
    """What lies in the workspace, slab by slab, of sections that all limbs reach."""
    sections, n = low.shape
    tiny = 1e-14 * size
    ends = (limbs[WY] - limbs[LINK]).max(), (limbs[WY] + limbs[LINK]).min()
    offset = np.stack([-high, -low, low, high], axis=-1)
    centers = limbs[WZ][:, None] + offset  # (N, n, 4)
    there = np.ones(centers.shape, bool)
    there[:, :, 1:3] = (low > 0.0)[:, :, None]
    where, y = _crossings(low, high, limbs, table, ends, size, centers, there)
    # Borders of slabs: those that are all but one are one.
    where = np.concatenate([np.arange(sections), where, np.arange(sections)])
    y = np.concatenate([np.full(sections, ends[0]), y, np.full(sections, ends[1])])
    order = np.lexsort((y, where))
    where, y = where[order], y[order]
    new = np.ones(len(y), bool)
    new[1:] = (where[1:] != where[:-1]) | (y[1:] - y[:-1] > tiny)
    where, y = where[new], y[new]
    # (Where the end itself is near another border that stands for it.)
    same = where[1:] == where[:-1]
    section, left, right = where[:-1][same], y[:-1][same], y[1:][same]
    middle = 0.5 * (left + right)
    # The order of all curves in the middle of each slab.
    asked = np.flatnonzero(np.repeat(signs.ravel(), 4))
    limb = asked >> 3
    circle = 4 * limb + (asked & 3)
    bases = centers.reshape(sections, -1)[:, 4 * np.repeat(np.arange(n), 8) + np.tile(_K, 2 * n)]
    sign = np.where(asked & 4, -1.0, 1.0)
    rises = _rises(limbs, middle[:, None], np.arange(n))
    heights = bases[section][:, asked] + sign * rises[:, limb]
    present = there.reshape(sections, -1)[:, circle][section]
    heights[~present] = np.inf
    order = np.argsort(heights, axis=1, kind="stable")
    rows = np.arange(len(section))[:, None]
    heights = heights[rows, order]
    bits = 1 << (asked >> 2)
    state = np.bitwise_xor.accumulate(np.where(present, bits, 0)[rows, order], axis=1)
    inside = holds(table, state)
    before = np.zeros_like(inside)
    before[:, 1:] = inside[:, :-1]
    slab, enters = np.nonzero(inside & ~before)
    _, leaves = np.nonzero(before & ~inside)
    bottom, top = heights[slab, enters], heights[slab, leaves]
    lower, upper = asked[order[slab, enters]], asked[order[slab, leaves]]
    # What ends and begins again at the same height goes on; what has no height is nothing.
    goes_on = (slab[1:] == slab[:-1]) & (bottom[1:] - top[:-1] <= tiny)
    begins, stops = np.ones(len(slab), bool), np.ones(len(slab), bool)
    begins[1:], stops[:-1] = ~goes_on, ~goes_on
    slab, lower, upper = slab[begins], lower[begins], upper[stops]
    thick = top[stops] - bottom[begins] > tiny
    curves = np.stack([lower[thick], upper[thick]], axis=-1)
    return _Cells(section, left, right, slab[thick], curves, bases)


def _rises(limbs: Array, y: Array, limb: NDArray[np.intp]) -> Array:
    """h of limbs at y, broadcast together."""
    t = y - limbs[WY][limb]
    link = limbs[LINK][limb]
    return np.asarray(np.sqrt(np.maximum((link - t) * (link + t), 0.0)))


@lru_cache(maxsize=8)
def _pairs(n: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Pairs of circles, each once."""
    return np.triu_indices(4 * n, k=1)


def _crossings(
    low: Array,
    high: Array,
    limbs: Array,
    table: Bools,
    ends: tuple[float, float],
    size: float,
    centers: Array,
    there: Bools,
) -> tuple[NDArray[np.intp], Array]:
    """Where two circles cross and the region may change: the section, and y', unsorted."""
    sections, n = low.shape
    centers, there = centers.reshape(sections, -1), there.reshape(sections, -1)
    one, two = _pairs(n)
    i, j = one >> 2, two >> 2
    dy = limbs[WY][j] - limbs[WY][i]
    a, b = limbs[LINK][i], limbs[LINK][j]
    most, least = (a + b) ** 2 * (1.0 + TOUCH), (a - b) ** 2 * (1.0 - TOUCH)
    dz = centers[:, two] - centers[:, one]
    square = dy * dy + dz * dz
    able = there[:, one] & there[:, two] & (square <= most) & (square >= least) & (square != 0.0)
    where, p = np.nonzero(able)
    square, dy, dz, a, b = square[where, p], dy[p], dz[where, p], a[p], b[p]
    along = (square + (a - b) * (a + b)) / (2.0 * square)
    across = np.sqrt(np.maximum(a * a - along * along * square, 0.0) / square)
    y, z = limbs[WY][i[p]] + along * dy, centers[where, one[p]] + along * dz
    where = np.concatenate([where, where])
    y = np.concatenate([y - across * dz, y + across * dz])
    z = np.concatenate([z + across * dy, z - across * dy])
    floor = (limbs[WZ] - high - limbs[LINK]).max(axis=1)
    roof = (limbs[WZ] + high + limbs[LINK]).min(axis=1)
    near = (y > ends[0]) & (y < ends[1]) & (z >= floor[where]) & (z <= roof[where])
    where, y, z = where[near], y[near], z[near]
    counts = _matter(low[where], high[where], limbs, table, y, z, SLACK * size)
    return where[counts], y[counts]


def _matter(
    low: Array, high: Array, limbs: Array, table: Bools, y: Array, z: Array, slack: float
) -> Bools:
    """Whether the region may change at points where two circles cross, see `sweep.matters`."""
    n = limbs.shape[1]
    closes = (np.abs(y[:, None] - limbs[WY]) <= limbs[LINK] + slack).all(axis=1)
    rises = _rises(limbs, y[:, None], np.arange(n))
    away = (z[:, None] - limbs[WZ])[:, :, None]
    d = np.abs(away - np.stack([rises, -rises], axis=-1))
    low, high = low[:, :, None], high[:, :, None]
    held = (d <= high + slack) & (d >= low - slack)
    near = held & ((d > high - slack) | ((low > 0.0) & (d < low + slack)))
    bits = 1 << np.arange(2 * n)
    held, near = held.reshape(-1, 2 * n), near.reshape(-1, 2 * n)
    state, free = held @ bits, near @ bits
    many = near.sum(axis=1)
    first = free & -free
    second = free ^ first
    both, none = holds(table, state), holds(table, state ^ free)
    no_first, no_second = holds(table, state ^ first), holds(table, state ^ second)
    by_first = (both != no_first) | (no_second != none)
    by_second = (both != no_second) | (no_first != none)
    reached = closes & held.reshape(-1, n, 2).any(axis=2).all(axis=1)
    return np.asarray(reached & ((many > 2) | ((many == 2) & by_first & by_second)))


def holds(table: Bools, state: Ints) -> Bools:
    """Which states are inside of all machines, see `sweep.holds`."""
    found = table[0, state & ((1 << HALVES) - 1)]
    for machine in range(1, len(table)):
        found = found & table[machine, state >> (HALVES * machine) & ((1 << HALVES) - 1)]
    return np.asarray(found)


# --- what cells are part of ----------------------------------------------------------------------


def _joined(cells: _Cells) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """The run of each cell (C,), and the first and the last cell of each run (R,).

    Cells of neighbouring slabs between the same curves are one run.
    """
    count = len(cells.slab)
    section = cells.section[cells.slab]
    lower, upper = cells.curves.T
    order = np.lexsort((cells.slab, upper, lower, section))
    new = np.ones(count, bool)
    for column in (section, lower, upper):
        column = column[order]
        new[1:] &= column[1:] == column[:-1]
    slab = cells.slab[order]
    new[1:] = ~new[1:] | (slab[1:] != slab[:-1] + 1)
    starts = np.flatnonzero(new)
    stops = np.append(starts[1:], count) - 1 if count else starts
    first, last = order[starts], order[stops]
    # In the order of their first cells.
    by_first = np.argsort(first)
    place = np.empty(len(starts), np.intp)
    place[by_first] = np.arange(len(starts))
    run_of = np.empty(count, np.intp)
    run_of[order] = place[np.cumsum(new) - 1]
    return run_of, first[by_first], last[by_first]


def _vertices(cells: _Cells, limbs: Array) -> tuple[NDArray[np.intp], Ints, NDArray[np.intp]]:
    """Where edges of the region meet, see `sweep.meet`: at the border of two slabs, of those that
    are not the same on both sides, every two that follow each other upwards.

    Returns:
        of each vertex the cell whose edge arrives there, a number that tells it, its section.
    """
    count = len(cells.slab)
    none = np.zeros(0, np.intp)
    if not count:
        return none, none.astype(np.int64), none
    section = cells.section[cells.slab]
    # Rows: of each cell its lower and its upper edge, at its left and at its right border.
    cell = np.tile(np.repeat(np.arange(count), 2), 2)
    side = np.tile([0, 1], 2 * count)
    right = np.repeat([0, 1], 2 * count)
    curve = cells.curves[cell, side]
    border = cells.slab[cell] + section[cell] + right
    key = (border * 2 + side) * (8 * limbs.shape[1]) + curve
    order = np.argsort(key)
    alike = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    ends = np.ones(len(key), bool)
    ends[order[alike]] = ends[order[alike + 1]] = False
    cell, side, right, curve, border = (
        column[ends] for column in (cell, side, right, curve, border)
    )
    slab, of = cells.slab[cell], section[cell]
    y = np.where(right == 1, cells.right[slab], cells.left[slab])
    z = curve_heights(limbs, curve, cells.bases[of, curve], y)
    order = np.lexsort((curve, z, border)).reshape(-1, 2)
    # An edge arrives that is passed to its end: a lower one from the left, an upper one from the
    # right.
    arrives = (right == 1) == (side == 0)
    order = np.where(arrives[order[:, :1]], order, order[:, ::-1])
    head, tail = order.T
    slabs = np.flatnonzero(np.diff(cells.section, prepend=-1))
    first = np.zeros(len(cells.bases), np.intp)
    first[cells.section[slabs]] = slabs
    last = np.zeros(len(cells.bases), np.intp)
    last[cells.section] = np.arange(len(cells.section))
    of, border = of[head], border[head]
    kind = np.where(border == first[of] + of, 1, np.where(border == last[of] + of + 1, 2, 0))
    return cell[head], _mixed(curve[head], curve[tail], kind), of


def _mixed(one: Ints, two: Ints, kind: Ints) -> Ints:
    """`sweep.mixed` of many."""
    key = ((one * 131 + two) * 4 + kind + 1) * 0x2545F491 & 0x3FFFFFFF
    key ^= key >> 15
    key = key * 0x45EBCA6B & 0x3FFFFFFF
    key ^= key >> 13
    key = key * 0x42B2AE35 & 0x3FFFFFFF
    return np.asarray(key ^ (key >> 16), dtype=np.int64)


def pairs_of(
    one: NDArray[np.intp], two: NDArray[np.intp], count: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """All pairs of members of two lists that are of one group: places (P,) in both.

    ``one`` and ``two`` are each member's group, increasing; there are ``count`` groups.
    """
    starts = np.searchsorted(two, np.arange(count + 1))
    many = np.diff(starts)[one]
    first = np.repeat(np.arange(len(one)), many)
    begin = np.cumsum(many) - many
    return first, starts[one[first]] + np.arange(len(first)) - begin[first]


def curve_heights(limbs: Array, c: Ints, base: Array, y: Array) -> Array:
    """z' of curves at y'; ``base`` is that of the centres of their circles."""
    rise = _rises(limbs, y, c >> 3)
    return np.asarray(base + np.where(c & 4, -rise, rise))


def _touching(
    cells: _Cells, limbs: Array, size: float
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Pairs of cells of neighbouring slabs that have a stretch of the border in common."""
    follows = np.append(cells.section[1:] == cells.section[:-1], False)
    last = np.flatnonzero(follows[cells.slab])
    one, two = pairs_of(cells.slab[last] + 1, cells.slab, len(cells.section))
    one = last[one]
    y, of = cells.right[cells.slab[one]], cells.section[cells.slab[one]]
    z = np.empty((2, 2, len(one)))
    for n, chosen in enumerate((one, two)):
        for end in range(2):
            c = cells.curves[chosen, end]
            z[n, end] = curve_heights(limbs, c, cells.bases[of, c], y)
    thick = np.minimum(z[0, 1], z[1, 1]) - np.maximum(z[0, 0], z[1, 0]) > FINE * size
    thick |= (cells.curves[one] == cells.curves[two]).all(axis=1)
    return one[thick], two[thick]


def components(count: int, one: NDArray[np.intp], two: NDArray[np.intp]) -> NDArray[np.intp]:
    """(count,) which component each of some things is of, counted in their order; ``one`` and
    ``two`` belong together."""
    stands = np.arange(count)  # for each thing one of its component, in the end the first
    while True:
        a, b = stands[one], stands[two]
        apart = a != b
        if not apart.any():
            break
        one, two, a, b = one[apart], two[apart], a[apart], b[apart]
        np.minimum.at(stands, np.maximum(a, b), np.minimum(a, b))
        while (stands[stands] != stands).any():
            stands = stands[stands]
    _, which = np.unique(stands, return_inverse=True)
    return np.asarray(which, dtype=np.intp)


# --- integrals -----------------------------------------------------------------------------------


def first_moments(
    limbs: Array, c: Ints, base: Array, y0: Array, y1: Array, origin: Array
) -> tuple[Array, Array, Array]:
    """`measures.first_moments` of many."""
    i = c >> 3
    sigma = np.where(c & 4, -1.0, 1.0)
    link, center = limbs[LINK][i], limbs[WY][i]
    t0 = np.clip(y0 - center, -link, link)
    t1 = np.clip(y1 - center, -link, link)
    q0, q1 = (link - t0) * (link + t0), (link - t1) * (link + t1)
    h0, h1 = np.sqrt(q0), np.sqrt(q1)
    angle = np.arctan2(t1 * h0 - t0 * h1, h0 * h1 + t0 * t1)
    ih = 0.5 * (t1 * h1 - t0 * h0 + link * link * angle)
    ith = (q0 * h0 - q1 * h1) / 3.0
    it = t1 - t0
    itt = 0.5 * it * (t1 + t0)
    ihh = it * (link * link - (t1 * t1 + t1 * t0 + t0 * t0) / 3.0)
    a, b = center - origin[0], base - origin[1]
    area = b * it + sigma * ih
    v = b * itt + a * area + sigma * ith
    w = 0.5 * (b * b * it + ihh) + b * sigma * ih
    return area, v, w


def speeds(at: Array, low: Array, high: Array, limbs: Array) -> Array:
    """dz'/dx' (N, 8n) of all curves, 0 where it is infinite."""
    with np.errstate(divide="ignore", invalid="ignore"):
        away = limbs[WX] - at[:, None]
        outer = np.where(high > 0.0, away / high, 0.0)
        inner = np.where(low > 0.0, away / low, 0.0)
    four = np.stack([-outer, -inner, inner, outer], axis=-1)
    return np.repeat(four[:, :, None, :], 2, axis=2).reshape(len(at), 8 * low.shape[1])
