"""Integrals of sections over x', in scalars, see `sweep`: panels are halved, the worst one first.

A section tells its moments and their derivatives by x', so that three sections of a panel, those at
its ends shared with its neighbours, make a rule of degree five (`quadrature`). Where circles of a
limb's bound ρ_min begin or end, and at both ends, the area has a root: x' = end ± κ u² makes
a smooth function of u from it. Kinks elsewhere, where the structure of the section changes, are
of higher order, and halving gets close to them fast enough.

How far a panel may be off is what two rules give that are nothing for cubics, and a part of what
its halving changed. Lengths mm.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array, Ints
from kinematics.mechanisms.five_rpur.slicing.measures import measured
from kinematics.mechanisms.five_rpur.slicing.quadrature import nulls, weights_of
from kinematics.mechanisms.five_rpur.slicing.sweep import (
    HIGH,
    LOW,
    WX,
    Bools,
    Room,
    bounds_of,
    heights,
    rooms,
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
UNSEEN = 1e-13  # of range × size²: what rounding may take


class Machine(NamedTuple):
    """What sections are made of, see `sweep`, and room for them."""

    limbs: Array
    signs: Bools
    table: Bools
    ends: Array
    size: float
    origin: Array
    low: Array
    high: Array
    other: Array
    room: Room
    taken: Ints  # (1,) how many sections were computed


class Nodes(NamedTuple):
    """Sections: x' (N,) in ``at`` and ``to``, see `cut`; moments (N, 6) and their derivatives,
    marks (N,)."""

    at: Array
    to: Array
    moments: Array
    marks: Ints


class Panels(NamedTuple):
    """``span`` (P, 4): u at both ends, and x' = span[2] + span[3] u²; ``nodes`` (P, 3) at its ends
    and in the middle; ``value`` and ``error`` (P,) of its volume.
    """

    span: Array
    nodes: Ints
    value: Array
    error: Array


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


def cut(machine: Machine, nodes: Nodes, n: int) -> None:
    """The section of node n, whose x' is known.

    Where ``to`` is another x' than ``at``: a section that holds all sections between the two.
    """
    limbs, low, high = machine.limbs, machine.low, machine.high
    x, to = nodes.at[n], nodes.to[n]
    reached = heights(x, limbs, low, high)
    if to != x:
        heights(to, limbs, machine.other[0], machine.other[1])
        reached = True
        for i in range(limbs.shape[1]):
            low[i] = min(low[i], machine.other[0, i])
            high[i] = max(high[i], machine.other[1, i])
            if min(x, to) <= limbs[WX, i] <= max(x, to):  # S is largest at w'_x
                high[i] = limbs[HIGH, i]
            reached = reached and high[i] >= 0.0
    nodes.marks[n] = 0
    nodes.moments[n, :] = 0.0
    machine.taken[0] += 1
    if reached:
        nodes.marks[n], _ = measured(
            x,
            limbs,
            low,
            high,
            machine.signs,
            machine.table,
            machine.ends,
            machine.size,
            machine.origin,
            machine.room,
            nodes.moments[n],
        )


def judge(machine: Machine, nodes: Nodes, panels: Panels, p: int, change: float) -> None:
    """The error of panel p, whose halving from a larger one changed so much; −1 for none."""
    one, two, three = panels.nodes[p, 0], panels.nodes[p, 1], panels.nodes[p, 2]
    m, marks = nodes.moments, nodes.marks
    off = nulls(panels.span[p], m[one], m[two], m[three])
    alike = marks[one] == marks[two] and marks[two] == marks[three]
    if alike:
        root = math.sqrt(off / max(abs(panels.value[p]), 1e-300))
        off *= min(KINK, max(ALIKE_LEAST, ALIKE * root))
    else:
        off *= KINK if change >= 0.0 else KINK * NOT_HALVED
    off = max(off, change * (HALF_ALIKE if alike else HALF))
    empty = (marks[one] == 0) + (marks[two] == 0) + (marks[three] == 0)
    if empty >= 2:
        x0, x1 = nodes.at[one], nodes.at[three]
        last = nodes.at.size - 1  # kept free for this
        nodes.at[last], nodes.to[last] = x0, x1
        cut(machine, nodes, last)
        most = m[last, 0]
        seen = max(m[one, 0], m[two, 0], m[three, 0])
        off = max(off, (1.0 if seen <= NOTHING * most else TIP) * most * abs(x1 - x0))
    panels.error[p] = off


def assess(panels: Panels, nodes: Nodes, p: int) -> None:
    """The volume of panel p by its rule."""
    one, two, three = panels.nodes[p, 0], panels.nodes[p, 1], panels.nodes[p, 2]
    w0, w1, w2, s0, s2 = weights_of(panels.span[p])
    m = nodes.moments
    panels.value[p] = (
        w0 * m[one, 0] + w1 * m[two, 0] + w2 * m[three, 0] + s0 * m[one, 3] + s2 * m[three, 3]
    )


def halve(machine: Machine, nodes: Nodes, panels: Panels, p: int, n: int, new: int) -> None:
    """Panel p becomes its first half, panel ``new`` the second; nodes n and n + 1 are cut."""
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
        cut(machine, nodes, n + half)
    panels.span[new, 0], panels.span[new, 1] = um, u1
    panels.span[new, 2], panels.span[new, 3] = end, kappa
    panels.span[p, 1] = um
    middle = panels.nodes[p, 1]
    panels.nodes[new, 0], panels.nodes[new, 1] = middle, n + 1
    panels.nodes[new, 2] = panels.nodes[p, 2]
    panels.nodes[p, 1], panels.nodes[p, 2] = n, middle
    change = -panels.value[p]
    for half in (p, new):
        assess(panels, nodes, half)
        change += panels.value[half]
    for half in (p, new):
        judge(machine, nodes, panels, half, abs(change))


def push(heap: Ints, filled: int, error: Array, p: int) -> None:
    """Panel p into a heap of so many panels, of which the first has the largest error."""
    q = filled
    while q > 0 and error[heap[(q - 1) >> 1]] < error[p]:
        heap[q] = heap[(q - 1) >> 1]
        q = (q - 1) >> 1
    heap[q] = p


def pop(heap: Ints, filled: int, error: Array) -> int:
    """The first panel, out of a heap of so many."""
    first, moved = heap[0], heap[filled - 1]
    q = 0
    while 2 * q + 1 < filled - 1:
        child = 2 * q + 1
        if child + 1 < filled - 1 and error[heap[child + 1]] > error[heap[child]]:
            child += 1
        if error[heap[child]] <= error[moved]:
            break
        heap[q] = heap[child]
        q = child
    heap[q] = moved
    return int(first)


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


def width(nodes: Nodes, panels: Panels, p: int) -> float:
    """Of panel p, along x'."""
    return float(abs(nodes.at[panels.nodes[p, 2]] - nodes.at[panels.nodes[p, 0]]))


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
        x' (N,), moments and their derivatives (N, 6), marks (N,), the weights (N, 2) of both, the
        volume's error, and how many sections were computed.
    """
    n = limbs.shape[1]
    machine = Machine(
        limbs,
        signs,
        table,
        np.empty(2),
        size,
        origin,
        np.empty(n),
        np.empty(n),
        np.empty((3, max(n, 6))),
        rooms(n),
        np.zeros(1, np.int64),
    )
    bounds_of(limbs, machine.ends)
    most = max(most, 4 * (math.ceil(1.0 / WIDEST) + 4 * n))  # `begin` takes less
    nodes = Nodes(np.empty(most), np.empty(most), np.empty((most, 6)), np.empty(most, np.int64))
    room = most // 2
    panels = Panels(
        np.empty((room, 4)), np.empty((room, 3), np.int64), np.empty(room), np.empty(room)
    )
    scale = (last - first) * size * size
    narrow = NARROW * size
    cuts, count = begin(limbs, nodes, panels, first, last, narrow)
    for k in range(cuts):
        cut(machine, nodes, k)
    for p in range(count):
        assess(panels, nodes, p)
    volume = panels.value[:count].sum()
    wanted = max(volume, SMALL * (last - first) ** 3) * relative
    widest = 2.0 * UNMET * wanted ** (1.0 / 3.0)
    for p in range(count):
        judge(machine, nodes, panels, p, -1.0)
    for p in range(room):
        if p == count:
            break
        while (
            panels.error[p] > 0.0 and width(nodes, panels, p) > widest and cuts + 2 < nodes.at.size
        ):
            halve(machine, nodes, panels, p, cuts, count)
            cuts += 2
            count += 1
    heap = np.empty(room, np.int64)
    for p in range(count):
        push(heap, p, panels.error, p)
    filled = count
    volume, error = panels.value[:count].sum(), panels.error[:count].sum()
    while filled > 0 and cuts + 2 < nodes.at.size:
        rounding = 1e-13 * volume + 1e-16 * scale
        allowed = max(relative * volume, UNSEEN * scale) - rounding
        if error <= allowed or count % 512 == 0:  # sums that grow and shrink lose digits
            volume, error = panels.value[:count].sum(), panels.error[:count].sum()
            if error <= allowed:
                break
        p = pop(heap, filled, panels.error)
        filled -= 1
        if width(nodes, panels, p) <= narrow:
            continue
        volume -= panels.value[p]
        error -= panels.error[p]
        halve(machine, nodes, panels, p, cuts, count)
        for half in (p, count):
            volume += panels.value[half]
            error += panels.error[half]
            push(heap, filled, panels.error, half)
            filled += 1
        cuts += 2
        count += 1
    weights = np.zeros((cuts, 2))
    for p in range(count):
        one, two, three = panels.nodes[p, 0], panels.nodes[p, 1], panels.nodes[p, 2]
        w0, w1, w2, s0, s2 = weights_of(panels.span[p])
        weights[one, 0] += w0
        weights[two, 0] += w1
        weights[three, 0] += w2
        weights[one, 1] += s0
        weights[three, 1] += s2
    error = panels.error[:count].sum() + 1e-13 * abs(volume) + 1e-16 * scale
    order = np.argsort(nodes.at[:cuts])
    return (
        nodes.at[order],
        nodes.moments[order],
        nodes.marks[order],
        weights[order],
        error,
        machine.taken[0],
    )
