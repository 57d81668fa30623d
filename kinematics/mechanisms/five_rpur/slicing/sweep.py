"""The exact section of a workspace, in scalars: what `numba` compiles and plain Python also runs.

In the plane x' = const every bound of limb i is an arc of radius l_i about (w'_iy, w'_iz + d),
d = ±S(ρ_max), ±S(ρ_min), that is z' = w'_iz + d + σ h(y'), or a line y' = w'_iy ± l_i (Tale
Masouleh et al. 2011, eqs. 26-43). All curves are graphs over y', so the plane is swept along y':
between two of their crossings the order of the curves does not change, and what lies between
which of them is found once, in the middle. The region thus falls into *runs*: maximal stretches
of y' with the same lower and the same upper curve. Coincident and tangent curves need no care
there: whichever of them comes first, what lies between them has no area. Lengths mm.

Numbering: curve c = 8 limb + 4 (σ < 0) + k, k = 0 … 3 for d = −S_max, −S_min, +S_min, +S_max;
circle q = 4 limb + k. Bit 2 limb + (σ < 0) of a state says that a point lies in that limb's
half B^σ, and `holds` whether it then lies in the workspace: of one machine, or in those of several
that are asked for what they have in common, five limbs each.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array, Ints

Bools = NDArray[np.bool_]
Room = tuple[Array, Ints, Ints, Array, Ints, Array, Ints, Ints, Ints, Ints, Array]

MOST_RUNS = 8192  # more than slabs of five limbs can hold
FINE = 1e-9  # of the size: two lengths that differ by less may be the same
SLACK = 1e-6  # of the size: crossings that miss the region by less are looked at all the same
TOUCH = 1e-12  # of the square of a distance: by how much it may be wrong

HALVES = 10
"""Bits of a state that one machine takes."""

# Rows of the limbs' numbers.
WX, WY, WZ, LINK, LOW, HIGH = range(6)


def heights(x: float, limbs: Array, low: Array, high: Array) -> bool:
    """S(ρ_min) and S(ρ_max) of every limb at x into (n,) each; −1 out of a limb's reach.

    Returns:
        whether all limbs reach x.
    """
    all_reach = True
    for i in range(limbs.shape[1]):
        apart = abs(x - limbs[WX, i])
        short, long = limbs[LOW, i], limbs[HIGH, i]
        low[i] = math.sqrt((short - apart) * (short + apart)) if apart < short else 0.0
        high[i] = math.sqrt((long - apart) * (long + apart)) if apart <= long else -1.0
        all_reach = all_reach and apart <= long
    return all_reach


def holds(table: Bools, state: int) -> bool:
    """Whether a point is inside of all machines, a row of ``table`` (M, 4^5) each."""
    for machine in range(table.shape[0]):
        if not table[machine, (state >> (HALVES * machine)) & ((1 << HALVES) - 1)]:
            return False
    return True


def bounds_of(limbs: Array, out: Array) -> tuple[int, int]:
    """The range of y' in which all limbs can close into ``out`` (2,), and who ends it (2,)."""
    first, last = 0, 0
    for i in range(1, limbs.shape[1]):
        if limbs[WY, i] - limbs[LINK, i] > limbs[WY, first] - limbs[LINK, first]:
            first = i
        if limbs[WY, i] + limbs[LINK, i] < limbs[WY, last] + limbs[LINK, last]:
            last = i
    out[0] = limbs[WY, first] - limbs[LINK, first]
    out[1] = limbs[WY, last] + limbs[LINK, last]
    return first, last


def offset(k: int, low: float, high: float) -> float:
    """d of the circles numbered k."""
    if k == 0:
        return -high
    if k == 1:
        return -low
    return low if k == 2 else high


def rise(limbs: Array, i: int, y: float) -> float:
    """h of limb i at y."""
    t = y - limbs[WY, i]
    square = (limbs[LINK, i] - t) * (limbs[LINK, i] + t)
    return math.sqrt(square) if square > 0.0 else 0.0


def matters(
    limbs: Array, low: Array, high: Array, table: Bools, y: float, z: float, slack: float
) -> bool:
    """Whether the region may change where two circles cross at (y, z).

    It does only if it depends there on both curves: points near a bound of another half, within
    ``slack``, may lie on either side of it.
    """
    state = 0
    free = 0
    many = 0
    for i in range(limbs.shape[1]):
        if abs(y - limbs[WY, i]) > limbs[LINK, i] + slack:
            return False
        h = rise(limbs, i, y)
        out = 0
        for s in range(2):
            d = abs(z - limbs[WZ, i] - (h if s == 0 else -h))
            if d > high[i] + slack or d < low[i] - slack:
                out += 1
                continue
            bit = 1 << (2 * i + s)
            state |= bit
            if d > high[i] - slack or (low[i] > 0.0 and d < low[i] + slack):
                free |= bit
                many += 1
        if out == 2:
            return False
    if many > 2:  # more bounds than two in one place: degenerate, looked at all the same
        return True
    if many < 2:
        return False
    first = free & -free
    second = free ^ first
    both, none = holds(table, state), holds(table, state ^ free)
    no_first, no_second = holds(table, state ^ first), holds(table, state ^ second)
    by_first = both != no_first or no_second != none
    by_second = both != no_second or no_first != none
    return bool(by_first and by_second)


def crossings(
    limbs: Array,
    low: Array,
    high: Array,
    table: Bools,
    ends: Array,
    size: float,
    where: Array,
    who: Ints,
) -> int:
    """Points where two circles cross and the region may change, unsorted.

    Into ``where`` (E, 2) as (y, z) and ``who`` (E, 2) as circles; returns how many.
    """
    n = limbs.shape[1]
    slack = SLACK * size
    floor, roof = -math.inf, math.inf
    for i in range(n):
        floor = max(floor, limbs[WZ, i] - high[i] - limbs[LINK, i])
        roof = min(roof, limbs[WZ, i] + high[i] + limbs[LINK, i])
    count = 0
    for i in range(n):
        for j in range(i, n):
            dy = limbs[WY, j] - limbs[WY, i]
            a, b = limbs[LINK, i], limbs[LINK, j]
            # Circles that touch but for rounding cross as well: no slab may reach across the point.
            most, least = (a + b) * (a + b) * (1.0 + TOUCH), (a - b) * (a - b) * (1.0 - TOUCH)
            if dy * dy > most:
                continue
            for k in range(4):
                if low[i] == 0.0 and (k == 1 or k == 2):
                    continue
                zi = limbs[WZ, i] + offset(k, low[i], high[i])
                for m in range(k + 1 if i == j else 0, 4):
                    if low[j] == 0.0 and (m == 1 or m == 2):
                        continue
                    dz = limbs[WZ, j] + offset(m, low[j], high[j]) - zi
                    square = dy * dy + dz * dz
                    if square > most or square < least or square == 0.0:
                        continue
                    # From the first centre along the line of centres, then across.
                    along = (square + (a - b) * (a + b)) / (2.0 * square)
                    rest = a * a - along * along * square
                    across = math.sqrt(rest / square) if rest > 0.0 else 0.0
                    for side in range(2):
                        y = limbs[WY, i] + along * dy - across * dz
                        z = zi + along * dz + across * dy
                        if side == 1:
                            y += 2.0 * across * dz
                            z -= 2.0 * across * dy
                        if y <= ends[0] or y >= ends[1] or z < floor or z > roof:
                            continue
                        if matters(limbs, low, high, table, y, z, slack):
                            where[count, 0], where[count, 1] = y, z
                            who[count, 0], who[count, 1] = 4 * i + k, 4 * j + m
                            count += 1
    return count


def root(parent: Ints, n: int) -> int:
    """Who stands for n in a forest of parents."""
    while parent[n] != n:
        parent[n] = parent[parent[n]]
        n = parent[n]
    return n


def rooms(n: int) -> Room:
    """Room for one section at a time: crossings, who, order, borders, runs, spans, parent, follow,
    tells, and room for `sweep` itself; what each is for, see there."""
    most = 16 * n * n
    return (
        np.empty((most, 2)),
        np.empty((most, 2), np.int64),
        np.empty(most, np.int64),
        np.empty(most + 2),
        np.empty((MOST_RUNS, 4), np.int64),
        np.empty((MOST_RUNS, 2)),
        np.empty(MOST_RUNS, np.int64),
        np.empty(2 * MOST_RUNS, np.int64),
        np.empty(MOST_RUNS, np.int64),
        np.empty((6, 8 * n), np.int64),
        np.empty((3, 8 * n)),
    )


def sweep(
    limbs: Array,
    low: Array,
    high: Array,
    signs: Bools,
    table: Bools,
    ends: Array,
    size: float,
    room: Room,
) -> tuple[int, int, int]:
    """The runs of a section.

    Args:
        limbs: (6, n) w'_x, w'_y, w'_z, l, ρ_min, ρ_max.
        low, high: (n,) S(ρ_min) and S(ρ_max).
        signs: (n, 2) which signs are asked for at all.
        table: (M, 4^5) which states are inside of each machine, see `holds`.
        ends: (2,) where all limbs can close, from `bounds_of`.
        size: mm, a length of the machine.
        room: `rooms`, in which the answer is left: the crossings; ``runs`` (R, 4) of lower curve,
            upper curve, first and last border, and ``spans`` (R, 2) of y at both; ``parent``
            (R,), runs of one piece of the region have one root; ``follow`` (2R,), the edge that
            follows each edge, see `meet`; ``tells`` (R,), numbers whose sum over the runs of a
            piece tells how it is built.

    Returns:
        the number of runs and of crossings, and a number that tells how the section is built.
    """
    where, who, order, borders, runs, spans, parent, follow, tells, ints, floats = room
    n = limbs.shape[1]
    tiny = 1e-14 * size
    found = crossings(limbs, low, high, table, ends, size, where, who)
    for e in range(found):
        y = where[e, 0]
        q = e - 1
        while q >= 0 and where[order[q], 0] > y:
            order[q + 1] = order[q]
            q -= 1
        order[q + 1] = e
    borders[0] = ends[0]
    slabs = 0
    for e in range(found + 1):
        y = where[order[e], 0] if e < found else ends[1]
        if y - borders[slabs] > tiny:
            slabs += 1
            borders[slabs] = y
        elif e == found:
            borders[slabs] = y
    # The curves in the order in which they were last found.
    curves, previous, present = ints[0], ints[1], ints[2]
    lower, upper, counts = ints[3], ints[4], ints[5]
    heights_of, bases, rises = floats[0], floats[1], floats[2]
    total = 0
    for i in range(n):
        for s in range(2):
            if signs[i, s]:
                for k in range(4):
                    if low[i] == 0.0 and (k == 1 or k == 2):
                        continue
                    c = 8 * i + 4 * s + k
                    curves[total] = c
                    bases[c] = limbs[WZ, i] + offset(k, low[i], high[i])
                    total += 1
    before = 0
    count = 0
    mark = 0
    for slab in range(slabs):
        y = 0.5 * (borders[slab] + borders[slab + 1])
        for i in range(n):
            rises[i] = rise(limbs, i, y)
        for p in range(total):
            c = curves[p]
            h = rises[c >> 3]
            heights_of[c] = bases[c] - h if c & 4 else bases[c] + h
        for p in range(1, total):  # nearly sorted already
            c = curves[p]
            z = heights_of[c]
            q = p - 1
            while q >= 0 and (
                heights_of[curves[q]] > z or (heights_of[curves[q]] == z and curves[q] > c)
            ):
                curves[q + 1] = curves[q]
                q -= 1
            curves[q + 1] = c
        # What lies inside, from below.
        state = 0
        inside = False
        intervals = 0
        for p in range(total):
            c = curves[p]
            state ^= 1 << (c >> 2)
            if holds(table, state) != inside:
                inside = not inside
                z = heights_of[c]
                if inside:
                    if intervals > 0 and z - heights_of[upper[intervals - 1]] <= tiny:
                        intervals -= 1  # it ended and begins again at the same height
                    else:
                        lower[intervals] = c
                else:
                    upper[intervals] = c
                    if z - heights_of[lower[intervals]] > tiny:
                        intervals += 1
        # Runs go on where both curves are the same as in the slab before.
        for p in range(intervals):
            run = -1
            for q in range(before):
                other = previous[q]
                if runs[other, 0] == lower[p] and runs[other, 1] == upper[p]:
                    run = other
                    break
            if run < 0:
                run = count
                count += 1
                runs[run, 0], runs[run, 1], runs[run, 2] = lower[p], upper[p], slab
                spans[run, 0] = borders[slab]
                parent[run] = run
                tells[run] = 0
            runs[run, 3] = slab + 1
            spans[run, 1] = borders[slab + 1]
            present[p] = run
        counts[0], counts[1], counts[2], counts[3] = before, intervals, slab, 1 if slab == 0 else 0
        mark += meet(
            limbs,
            bases,
            runs,
            previous,
            present,
            counts,
            borders[slab],
            size,
            rises,
            parent,
            follow,
            tells,
        )
        previous, present = present, previous
        before = intervals
    counts[0], counts[1], counts[2], counts[3] = before, 0, slabs, 2
    mark += meet(
        limbs,
        bases,
        runs,
        previous,
        present,
        counts,
        borders[slabs],
        size,
        rises,
        parent,
        follow,
        tells,
    )
    return count, found, mark


def meet(
    limbs: Array,
    bases: Array,
    runs: Ints,
    left: Ints,
    right: Ints,
    counts: Ints,
    y: float,
    size: float,
    rises: Array,
    parent: Ints,
    follow: Ints,
    tells: Ints,
) -> int:
    """Join what meets on the border y of two slabs.

    Upwards along the border, wherever exactly one of its sides is inside, the boundary of the
    region runs along it: from the edge that arrives there to the one that leaves. Edge 2r, the
    lower curve of run r, is passed towards +y, edge 2r + 1, its upper one, towards −y, so that
    the region lies to the left. In most cases that stretch has no length: a vertex.

    Args:
        left, right: runs before and behind the border, from below.
        counts: (4,) how many these are; which border; 0, or 1 and 2 on the first and the last one.
            (In an array, for numba would compile all of it again for every literal number.)
        y: where the border is.
        follow: (2R,) out: the edge that follows each edge.
        tells: (R,) changed: the vertices of each run are added.

    Returns:
        a number that tells the vertices met here.
    """
    lefts, rights, border, kind = counts[0], counts[1], counts[2], counts[3]
    for i in range(limbs.shape[1]):
        rises[i] = rise(limbs, i, y)
    mark = 0
    p = q = 0  # positions among the ends of ``left`` and ``right``, two a run
    waiting = -1
    waiting_arrives = False
    while p < 2 * lefts or q < 2 * rights:
        one = left[p >> 1] if p < 2 * lefts else -1
        two = right[q >> 1] if q < 2 * rights else -1
        if waiting < 0 and p & 1 == 0 and q & 1 == 0 and one >= 0 and one == two:
            p += 2  # it goes on
            q += 2
            continue
        # A run that goes on waits for what lies below it on the other side.
        take_left = two < 0
        if one >= 0 and two >= 0:
            z1 = at_border(bases, rises, runs[one, p & 1])
            z2 = at_border(bases, rises, runs[two, q & 1])
            take_left = z1 < z2 or (z1 == z2 and runs[one, p & 1] <= runs[two, q & 1])
            if p & 1 == 0 and runs[one, 3] > border:
                take_left = False
            elif q & 1 == 0 and runs[two, 2] < border:
                take_left = True
        if take_left:
            run, end = one, p & 1
            arrives = end == 0
            p += 1
        else:
            run, end = two, q & 1
            arrives = end == 1
            q += 1
        z = at_border(bases, rises, runs[run, end])
        edge = 2 * run + end
        if waiting < 0:
            waiting, waiting_arrives = edge, arrives
        else:
            head, tail = (waiting, edge) if waiting_arrives else (edge, waiting)
            follow[head] = tail
            before, after = runs[head >> 1, head & 1], runs[tail >> 1, tail & 1]
            if before != after or (head ^ tail) & 1:
                told = mixed(before, after, kind)
                tells[head >> 1] += told
                mark += told
            waiting = -1
        if p & 1 and q & 1:  # both sides are inside from here up to the next end
            one, two = left[p >> 1], right[q >> 1]
            top = min(at_border(bases, rises, runs[one, 1]), at_border(bases, rises, runs[two, 1]))
            if top - z > FINE * size:
                first, second = root(parent, one), root(parent, two)
                parent[max(first, second)] = min(first, second)
    return mark


def at_border(bases: Array, rises: Array, c: int) -> float:
    """z of curve c where the limbs' h are ``rises``."""
    h = rises[c >> 3]
    return float(bases[c] - h if c & 4 else bases[c] + h)


def mixed(one: int, two: int, kind: int) -> int:
    """A number for a vertex, such that sums of them hardly ever coincide."""
    key = ((int(one) * 131 + int(two)) * 4 + kind + 1) * 0x2545F491 & 0x3FFFFFFF
    key ^= key >> 15
    key = key * 0x45EBCA6B & 0x3FFFFFFF
    key ^= key >> 13
    key = key * 0x42B2AE35 & 0x3FFFFFFF
    return key ^ (key >> 16)


def height(limbs: Array, low: Array, high: Array, c: int, y: float) -> float:
    """z of curve c at y."""
    i = c >> 3
    h = rise(limbs, i, y)
    return float(limbs[WZ, i] + offset(c & 3, low[i], high[i]) + (-h if c & 4 else h))
