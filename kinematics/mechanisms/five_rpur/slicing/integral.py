"""Integrals of sections over x', in scalars, see `sweep`: panels are halved, the worst ones first.

A section tells its moments and their derivatives by x', so that three sections of a panel, those at
its ends shared with its neighbours, make a rule of degree five (`quadrature`). Where circles of a
limb's bound ρ_min begin or end, and at both ends, the area has a root: x' = end ± κ u² makes
a smooth function of u from it. Kinks elsewhere, where the structure of the section changes, are
of higher order, and halving gets close to them fast enough.

Sections are cut many at a time, for what cuts them may be numpy (`batches`) as well as the kernel.

How far a panel may be off is what two rules give that are nothing for cubics, and a part of what
its halving changed. Lengths mm.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array, Ints
from kinematics.mechanisms.five_rpur.slicing.measures import measure
from kinematics.mechanisms.five_rpur.slicing.quadrature import nulls, weights_of
from kinematics.mechanisms.five_rpur.slicing.sweep import (
    HIGH,
    LOW,
    WX,
    Bools,
    heights,
)

# What a panel may be off by, as a part of what its null rules give. A kink of any order from 1 on,
# wherever it stands in the panel, stays below `KINK` (tests/…/test_quadrature.py). Where all three
# sections are built alike: the less, the smaller that is beside the panel's volume, in proportion
# to the root, as it is for what is a series.
KINK = 0.13
ALIKE, ALIKE_LEAST = 1.0, 0.02
# Kinks may also agree by chance: a panel that was not yet halved may be off by so much more, and
# one half by that part of what the halving changed.
NOT_HALVED = 10.0
HALF, HALF_ALIKE = 0.125, 0.03
# Where at least two of three sections are empty: of the volume between sections that hold all
# others.
TIP = 0.03
# The distance of sections, as a part of the range, and of the error's cube root: a piece that no
# section met is smaller than that.
WIDEST, UNMET = 0.05, 1.0
SMALL = 3e-3  # of the range's cube: volumes that are less are no reason for narrower panels
NARROW = 1e-10  # of the size: two places are one
NOTHING = 1e-9  # of the bound of an area
NOWHERE = 6000  # sections at most, as long as there is nothing in any of them
UNSEEN = 1e-13  # of range × size²: what rounding may take
REST = 0.85  # of the error allowed: as much may be left in panels that are not halved at once


class Machine(NamedTuple):
    """What sections are made of, see `sweep`."""

    limbs: Array
    signs: Bools
    table: Bools
    size: float
    origin: Array
    taken: Ints  # (1,) how many sections were computed


class Nodes(NamedTuple):
    """Sections: x' (N,) in ``at`` and ``to``, see `cut`; S(ρ_min) and S(ρ_max) (N, n) of limbs,
    moments and their derivatives (N, 6), marks (N,)."""

    at: Array
    to: Array
    lows: Array
    highs: Array
    moments: Array
    marks: Ints


class Panels(NamedTuple):
    """``span`` (P, 4): u at both ends, and x' = span[2] + span[3] u²; ``nodes`` (P, 3) at its ends
    and in the middle; ``value`` and ``error`` (P,) of its volume, and ``change`` (P,), by how much
    halving the larger one was of which it is a half has changed that, −1 for none.
    """

    span: Array
    nodes: Ints
    value: Array
    error: Array
    change: Array


def places_of_roots(limbs: Array, first: float, last: float, narrow: float, out: Array) -> int:
    """Where the area has a root as a function of x', ends included, increasing; how many."""
    out[0] = first
    count = 1
    for i in range(limbs.shape[1]):
        for side in range(2):
            x = limbs[WX, i] + (limbs[LOW, i] if side else -limbs[LOW, i])
            if limbs[LOW, i] == 0.0 or x <= first + narrow or x >= last - narrow:
                continue
            q = count
            while out[q - 1] > x:
                q -= 1
            if x - out[q - 1] <= narrow or (q < count and out[q] - x <= narrow):
                continue
            for k in range(count, q, -1):
                out[k] = out[k - 1]
            out[q] = x
            count += 1
    out[count] = last
    return count + 1


def cut(machine: Machine, nodes: Nodes, first: int, count: int) -> None:
    """The sections of so many nodes, whose x' are known.

    Where ``to`` is another x' than ``at``: a section that holds all sections between the two.
    """
    limbs = machine.limbs
    stop = first + count
    other = np.empty((2, limbs.shape[1]))
    for k in range(first, stop):
        x, to, low, high = nodes.at[k], nodes.to[k], nodes.lows[k], nodes.highs[k]
        heights(x, limbs, low, high)
        if to != x:
            heights(to, limbs, other[0], other[1])
            for i in range(limbs.shape[1]):
                low[i] = min(low[i], other[0, i])
                high[i] = max(high[i], other[1, i])
                if min(x, to) <= limbs[WX, i] <= max(x, to):  # S is largest at w'_x
                    high[i] = limbs[HIGH, i]
    measure(
        nodes.at[first:stop],
        nodes.lows[first:stop],
        nodes.highs[first:stop],
        limbs,
        machine.signs,
        machine.table,
        machine.size,
        machine.origin,
        nodes.moments[first:stop],
        nodes.marks[first:stop],
    )
    machine.taken[0] += count


def mostly_empty(marks: Ints, one: int, two: int, three: int) -> bool:
    """Whether at least two of three sections are empty."""
    empty = 0
    for n in (one, two, three):
        if marks[n] == 0:
            empty += 1
    return empty >= 2


def judge(machine: Machine, nodes: Nodes, panels: Panels, which: Ints, free: int) -> None:
    """The errors of some panels; nodes from ``free`` on are kept free for this."""
    m, marks = nodes.moments, nodes.marks
    held = 0
    for p in which:
        one, two, three = panels.nodes[p, 0], panels.nodes[p, 1], panels.nodes[p, 2]
        change = panels.change[p]
        off = nulls(panels.span[p], m[one], m[two], m[three])
        alike = marks[one] == marks[two] and marks[two] == marks[three]
        if alike:
            root = math.sqrt(off / max(abs(panels.value[p]), 1e-300))
            off *= min(KINK, max(ALIKE_LEAST, ALIKE * root))
        else:
            off *= KINK if change >= 0.0 else KINK * NOT_HALVED
        panels.error[p] = max(off, change * (HALF_ALIKE if alike else HALF))
        if mostly_empty(marks, one, two, three):
            nodes.at[free + held], nodes.to[free + held] = nodes.at[one], nodes.at[three]
            held += 1
    if held == 0:
        return
    cut(machine, nodes, free, held)
    held = free
    for p in which:
        one, two, three = panels.nodes[p, 0], panels.nodes[p, 1], panels.nodes[p, 2]
        if mostly_empty(marks, one, two, three):
            most = m[held, 0]
            seen = max(m[one, 0], m[two, 0], m[three, 0])
            part = 1.0 if seen <= NOTHING * most else TIP
            panels.error[p] = max(panels.error[p], part * most * width(nodes, panels, p))
            held += 1


def assess(panels: Panels, nodes: Nodes, p: int) -> None:
    """The volume of panel p by its rule."""
    one, two, three = panels.nodes[p, 0], panels.nodes[p, 1], panels.nodes[p, 2]
    w0, w1, w2, s0, s2 = weights_of(panels.span[p])
    m = nodes.moments
    panels.value[p] = (
        w0 * m[one, 0] + w1 * m[two, 0] + w2 * m[three, 0] + s0 * m[one, 3] + s2 * m[three, 3]
    )


def halve(
    machine: Machine, nodes: Nodes, panels: Panels, which: Ints, cuts: int, count: int
) -> None:
    """Some panels become their first halves; the second ones follow behind the ``count`` panels
    that there are, the sections in the middles of both behind the ``cuts`` nodes."""
    many = which.size
    for k in range(many):
        p, n, new = which[k], cuts + 2 * k, count + k
        u0, u1, end, kappa = (
            panels.span[p, 0],
            panels.span[p, 1],
            panels.span[p, 2],
            panels.span[p, 3],
        )
        um = 0.5 * (u0 + u1)
        for half in range(2):
            u = 0.5 * (um + (u1 if half else u0))
            nodes.at[n + half] = nodes.to[n + half] = end + kappa * u * u
        panels.span[new, 0], panels.span[new, 1] = um, u1
        panels.span[new, 2], panels.span[new, 3] = end, kappa
        panels.span[p, 1] = um
        middle = panels.nodes[p, 1]
        panels.nodes[new, 0], panels.nodes[new, 1] = middle, n + 1
        panels.nodes[new, 2] = panels.nodes[p, 2]
        panels.nodes[p, 1], panels.nodes[p, 2] = n, middle
    cut(machine, nodes, cuts, 2 * many)
    halves = np.empty(2 * many, np.int64)
    for k in range(many):
        p, new = which[k], count + k
        change = -panels.value[p]
        for half in (p, new):
            assess(panels, nodes, half)
            change += panels.value[half]
        panels.change[p] = panels.change[new] = abs(change)
        halves[2 * k], halves[2 * k + 1] = p, new
    judge(machine, nodes, panels, halves, cuts + 2 * many)


def width(nodes: Nodes, panels: Panels, p: int) -> float:
    """Of panel p, along x'."""
    return float(abs(nodes.at[panels.nodes[p, 2]] - nodes.at[panels.nodes[p, 0]]))


def too_wide(nodes: Nodes, panels: Panels, count: int, widest: float) -> Ints:
    """Which panels are wider than ``widest`` and may be off by anything."""
    which = np.empty(count, np.int64)
    many = 0
    for p in range(count):
        if panels.error[p] > 0.0 and width(nodes, panels, p) > widest:
            which[many] = p
            many += 1
    return which[:many]


def worst(
    nodes: Nodes, panels: Panels, count: int, relative: float, scale: float, narrow: float
) -> Ints:
    """Which panels to halve next, so that what the others are off by is allowed; none at the end.

    Panels narrower than ``narrow`` stay: once most of the error is theirs, all is done.
    """
    volume = total = stuck = most = 0.0
    for p in range(count):
        volume += panels.value[p]
        total += panels.error[p]
        if width(nodes, panels, p) > narrow:
            most = max(most, panels.error[p])
        else:
            stuck += panels.error[p]
    rounding = 1e-13 * volume + 1e-16 * scale
    allowed = max(max(relative * volume, UNSEEN * scale) - rounding, 2.0 * stuck)
    which = np.empty(count, np.int64)
    many = 0
    if total <= allowed:
        return which[:many]
    rest = total - stuck
    while rest > REST * (allowed - stuck) and most > 0.0:
        most *= 0.75
        rest = 0.0
        many = 0
        for p in range(count):
            if width(nodes, panels, p) > narrow:
                if panels.error[p] >= most:
                    which[many] = p
                    many += 1
                else:
                    rest += panels.error[p]
    return which[:many]


def begin(
    limbs: Array, nodes: Nodes, panels: Panels, first: float, last: float, narrow: float
) -> tuple[int, int]:
    """Panels from each root to the middle between it and the next one; how many nodes, panels."""
    places = np.empty(2 * limbs.shape[1] + 2)
    stops = places_of_roots(limbs, first, last, narrow, places)
    nodes.at[0] = first
    n, p = 1, 0
    for k in range(stops - 1):
        half = 0.5 * (places[k + 1] - places[k])
        parts = math.ceil(half / (WIDEST * (last - first)))
        for side in range(2):
            end = places[k + side]
            kappa = -half if side else half
            for part in range(parts):
                u0 = (parts - part if side else part) / parts
                u1 = (parts - part - 1 if side else part + 1) / parts
                um = 0.5 * (u0 + u1)
                nodes.at[n], nodes.at[n + 1] = end + kappa * um * um, end + kappa * u1 * u1
                panels.span[p, 0], panels.span[p, 1] = min(u0, u1), max(u0, u1)
                panels.span[p, 2], panels.span[p, 3] = end, kappa
                panels.nodes[p, 0], panels.nodes[p, 2] = (n + 1, n - 1) if side else (n - 1, n + 1)
                panels.nodes[p, 1] = n
                n += 2
                p += 1
    nodes.to[:n] = nodes.at[:n]
    return n, p


def integral(
    first: float,
    last: float,
    limbs: Array,
    signs: Bools,
    table: Bools,
    size: float,
    origin: Array,
    relative: float,
    most: int,
) -> tuple[Array, Array, Ints, Array, float, int]:
    """Sections between two x', and weights that make integrals of them.

    Args:
        limbs, signs, table, size, origin: as `measured` takes them.
        relative: the error wanted, as a part of the volume.
        most: about how many sections are taken at most.

    Returns:
        x' (N,) in no order, moments and their derivatives (N, 6), marks (N,), the weights (N, 2) of
        both, the volume's error, and how many sections were computed.
    """
    n = limbs.shape[1]
    machine = Machine(limbs, signs, table, size, origin, np.zeros(1, np.int64))
    most = max(most, 4 * (math.ceil(1.0 / WIDEST) + 4 * n))  # `begin` takes less
    nodes = Nodes(
        np.empty(2 * most),  # as many are kept free for `judge`
        np.empty(2 * most),
        np.empty((2 * most, n)),
        np.empty((2 * most, n)),
        np.empty((2 * most, 6)),
        np.empty(2 * most, np.int64),
    )
    panels = Panels(
        np.empty((most, 4)),
        np.empty((most, 3), np.int64),
        np.empty(most),
        np.empty(most),
        np.full(most, -1.0),
    )
    scale = (last - first) * size * size
    narrow = NARROW * size
    cuts, count = begin(limbs, nodes, panels, first, last, narrow)
    cut(machine, nodes, 0, cuts)
    for p in range(count):
        assess(panels, nodes, p)
    judge(machine, nodes, panels, np.arange(count), cuts)
    volume = 0.0
    for p in range(count):
        volume += panels.value[p]
    wanted = max(volume, SMALL * (last - first) ** 3) * relative
    widest = 2.0 * UNMET * wanted ** (1.0 / 3.0)
    wide = True
    found = False
    for k in range(cuts):
        found = found or nodes.marks[k] != 0
    while True:
        if wide:
            which = too_wide(nodes, panels, count, widest)
            wide = which.size > 0
        if not wide:
            which = worst(nodes, panels, count, relative, scale, narrow)
        room = most if found else min(most, NOWHERE)
        which = which[: max(room - cuts, 0) // 2]
        if which.size == 0:
            break
        halve(machine, nodes, panels, which, cuts, count)
        for k in range(cuts, cuts + 2 * which.size):
            found = found or nodes.marks[k] != 0
        cuts += 2 * which.size
        count += which.size
    weights = np.zeros((cuts, 2))
    volume = error = 0.0
    for p in range(count):
        volume += panels.value[p]
        error += panels.error[p]
        one, two, three = panels.nodes[p, 0], panels.nodes[p, 1], panels.nodes[p, 2]
        w0, w1, w2, s0, s2 = weights_of(panels.span[p])
        weights[one, 0] += w0
        weights[two, 0] += w1
        weights[three, 0] += w2
        weights[one, 1] += s0
        weights[three, 1] += s2
    error += 1e-13 * abs(volume) + 1e-16 * scale
    at, moments, marks = nodes.at[:cuts], nodes.moments[:cuts], nodes.marks[:cuts]
    return at, moments, marks, weights, error, machine.taken[0]
