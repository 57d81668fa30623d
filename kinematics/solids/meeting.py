"""Where on a wall boundaries meet, and where they pass from one surface to another, by search.

See `joining` for what goes on and what meets. Lengths mm; places are parts of the way along a wall.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.solids.columns import ROOT, Columned, Ints, Layers, Mask, layers, sheets
from kinematics.solids.joining import Joined, Walls

_ENDS = 40  # steps of the search for where a layer ends
_FINE = 1e-7  # of the way: how near to where a layer ends
_HALF_AS_THICK = 0.75  # of the way to where a surface turns round
_CORNER = 1e-4  # of the way
_MEETS = 20  # steps of the search for where two surfaces cross


@dataclass(frozen=True, eq=False)
class Ends:
    """Where boundaries meet on walls.

    Attributes:
        part: (E,) of the way from a to b.
        low, high: (E,) v, the same but where one sign takes the other's place.
        on_the_way: places where the lowest or the highest boundary of what ends passes from one
            surface to another on its way there; and places where it is about half as far from
            there as it was, where the surface turns round and it goes there like a root.
    """

    part: Array
    low: Array
    high: Array
    on_the_way: tuple[Between, Between]


@dataclass(frozen=True, eq=False)
class Between:
    """Places on the way of boundaries to where they meet, (K,) each: which of those that meet,
    whether it is the highest boundary rather than the lowest, the part of the way from a to b, v.
    """

    of: NDArray[np.intp]
    highest: Mask
    part: Array
    v: Array


def ends(solid: Columned, walls: Walls, joints: Joined) -> Ends:
    """Where the boundaries that meet do so, by search."""
    wall, swap = joints.meets[:, 0], joints.swaps
    in_a, in_b = joints.meets[:, 1:4], joints.meets[:, 4:7]
    from_b = (in_b >= 0).sum(axis=1) > (in_a >= 0).sum(axis=1)
    near = walls.columns.take(np.where(from_b, walls.at_b[wall], walls.at_a[wall]))
    start = np.where(from_b[:, None], walls.b[wall], walls.a[wall])
    way = np.where(from_b[:, None], walls.a[wall], walls.b[wall]) - start
    own = np.where(from_b[:, None], in_b, in_a)
    rows, first, last = np.arange(len(wall)), own[:, 0], own.max(axis=1)
    low, high = near.at[rows, first].copy(), near.at[rows, last].copy()
    labels = near.label[rows, first].copy(), near.label[rows, last].copy()
    # What ends: the one layer that does, or whatever is between two equal ones.
    below, above = near.below()[rows, first], near.above[rows, last]
    inner = near.above[rows, first]
    all_between = (below == above) & (last > first + 1)
    ending = np.stack([np.where(all_between, s != below, s == inner) for s in (0, 1, -1)], -1)
    there, gone = np.zeros(len(wall)), np.ones(len(wall))
    # The thickness, or its square where one limb or a double root bounds both sides, falls to
    # nothing as a straight line does: its last two values say where.
    fold = (labels[0] // 4 == labels[1] // 4) & ((labels[0] // 2) % 2 == (labels[1] // 2) % 2)
    power = np.where(fold, 2.0, 1.0)
    thick = (high - low) ** power
    before_t, before_thick = np.zeros(len(wall)), np.full(len(wall), np.nan)
    active = rows
    for step in range(_ENDS):
        if not len(active):
            break
        t0, t1 = there[active], gone[active]
        with np.errstate(invalid="ignore", divide="ignore"):
            slope = (thick[active] - before_thick[active]) / (t0 - before_t[active])
            guess = t0 - thick[active] / slope
            aside = np.maximum(0.02 * (guess - t0), 0.4 * _FINE)
            guess = guess + (aside if step % 2 else -aside)
        usable = (guess > t0) & (guess < t1) & (step % 6 != 5) & ~swap[active]
        t = np.where(usable, guess, 0.5 * (t0 + t1))
        # A long step may have lost it: once more from next to where it seemed to end.
        close = t1 - t0 <= _FINE
        t = np.where(close, t1, t)
        here = layers(solid, start[active] + t[:, None] * way[active])
        found = _tracked(
            here, ending[active], low[active], high[active], (labels[0][active], labels[1][active])
        )
        alive = np.isfinite(found[0])
        own = active[alive]
        before_t[own], before_thick[own] = there[own], thick[own]
        there[own] = t[alive]
        low[own], high[own] = found[0][alive], found[1][alive]
        labels[0][own], labels[1][own] = found[2][alive], found[3][alive]
        thick[own] = (high[own] - low[own]) ** power[own]
        gone[active[~alive]] = t[~alive]
        again = close & alive & (t1 < 1.0)
        gone[active[again]] = 1.0
        active = active[~close | again]
    middle = 0.5 * (low + high)
    names = near.label[rows, first], near.label[rows, last]
    on_the_way = _on_the_way(solid, start, way, there, names, labels, fold & ~swap, middle)
    for between in on_the_way:
        between.part[:] = np.where(from_b[between.of], 1.0 - between.part, between.part)
    return Ends(
        np.where(from_b, 1.0 - there, there),
        np.where(swap, low, middle),
        np.where(swap, high, middle),
        on_the_way,
    )


def _on_the_way(
    solid: Columned,
    start: Array,
    way: Array,
    there: Array,
    before: tuple[NDArray[np.int16], NDArray[np.int16]],
    after: tuple[NDArray[np.int16], NDArray[np.int16]],
    fold: Mask,
    middle: Array,
) -> tuple[Between, Between]:
    """`Ends.on_the_way`, with parts of the way from where something is to where it ends."""
    passes, halves = [], []
    for k in (0, 1):
        rows = np.flatnonzero((before[k] != after[k]) & (before[k] >= 0) & (after[k] >= 0))
        t, v, known = _crossing(
            solid, start[rows], way[rows], (before[k][rows], after[k][rows]), there[rows]
        )
        known &= (t > _CORNER) & (t < there[rows] - _CORNER)
        rows, t, v = rows[known], t[known], v[known]
        passes.append((rows, np.full(len(rows), k == 1), t, v))
        begin = np.zeros(len(there))
        begin[rows] = t
        turns = np.flatnonzero(fold)
        t = begin[turns] + _HALF_AS_THICK * (there - begin)[turns]
        at = start[turns] + t[:, None] * way[turns]
        v = sheets(solid, at, np.maximum(after[k][turns], 0))
        roots = np.flatnonzero(after[k][turns] < 0)
        if len(roots):
            here = layers(solid, at[roots])
            with np.errstate(invalid="ignore"):
                off = here.at - middle[turns[roots], None]
            side = (here.label == ROOT) & np.isfinite(here.at) & ((off > 0.0) == (k == 1))
            off = np.where(side, np.abs(off), np.inf)
            nearest = off.argmin(axis=1) if off.shape[1] else np.zeros(len(roots), dtype=np.intp)
            good = np.isfinite(off).any(axis=1)
            v[roots[good]] = here.at[np.flatnonzero(good), nearest[good]]
            v[roots[~good]] = np.nan
        good = np.isfinite(v) & (there[turns] - t > _CORNER)
        halves.append((turns[good], np.full(int(good.sum()), k == 1), t[good], v[good]))
    one, other = (
        Between(*(np.concatenate(p) for p in zip(*b, strict=True))) for b in (passes, halves)
    )
    return one, other


def _tracked(
    here: Layers,
    ending: Mask,
    low: Array,
    high: Array,
    labels: tuple[NDArray[np.int16], NDArray[np.int16]],
) -> tuple[Array, Array, NDArray[np.int16], NDArray[np.int16]]:
    """What goes on of layers between ``low`` and ``high``: its ends and their labels, NaN if
    nothing does. Neighbours that may both end are one."""
    rows = np.arange(len(low))
    best = np.full(len(low), -np.inf)
    found = np.full(len(low), np.nan), np.full(len(low), np.nan)
    names = np.zeros(len(low), dtype=np.int16), np.zeros(len(low), dtype=np.int16)
    begin = np.zeros(len(low), dtype=np.intp)
    open_ = np.zeros(len(low), dtype=bool)
    for k in range(here.at.shape[1] - 1):
        inside = (k < here.count - 1) & ending[rows, here.above[:, k]]
        begin = np.where(inside & ~open_, k, begin)
        open_ = inside
        after = (k + 1 < here.count - 1) & ending[rows, here.above[:, k + 1]]
        done = np.flatnonzero(inside & ~after)
        if not len(done):
            continue
        bottom, top = here.at[done, begin[done]], here.at[done, k + 1]
        name = here.label[done, begin[done]], here.label[done, k + 1]
        same = (name[0] == labels[0][done]) & (name[1] == labels[1][done])
        common = np.minimum(top, high[done]) - np.maximum(bottom, low[done])
        common = np.where(same, np.inf, np.where(common > 0.0, common, -np.inf))
        better = common > best[done]
        own = done[better]
        best[own], found[0][own], found[1][own] = common[better], bottom[better], top[better]
        names[0][own], names[1][own] = name[0][better], name[1][better]
    return *found, *names


def creases(solid: Columned, walls: Walls, goes_on: Ints) -> tuple[NDArray[np.intp], Array, Array]:
    """Where a boundary that goes on passes from one surface to another.

    Returns:
        which of ``goes_on``, (C,), the part of the way from a to b, and v.
    """
    wall, i, j = goes_on.T
    one = walls.columns.label[walls.at_a[wall], i]
    other = walls.columns.label[walls.at_b[wall], j]
    which = np.flatnonzero(one != other)
    wall, i, j = wall[which], i[which], j[which]
    t, v, known = _crossing(
        solid,
        walls.a[wall],
        walls.b[wall] - walls.a[wall],
        (one[which], other[which]),
        np.ones(len(which)),
    )
    # A corner next to one of the columns is that column's.
    known &= (t > _CORNER) & (t < 1.0 - _CORNER)
    return which[known], t[known], v[known]


def _crossing(
    solid: Columned,
    start: Array,
    way: Array,
    labels: tuple[NDArray[np.int16], NDArray[np.int16]],
    most: Array,
) -> tuple[Array, Array, Mask]:
    """Where limbs' surfaces cross between parts 0 and ``most`` of the way: the part, v, and
    whether they do; (N,) each."""

    def apart(t: Array) -> tuple[Array, Array]:
        at = start + t[:, None] * way
        first, second = (sheets(solid, at, label) for label in labels)
        return first - second, first

    low, high = np.zeros(len(most)), most.copy()
    f_low, f_high = apart(low)[0], apart(high)[0]
    known = np.isfinite(f_low) & np.isfinite(f_high) & ((f_low < 0.0) != (f_high < 0.0))
    begins, ends_ = f_low < 0.0, f_high.copy()
    t = 0.5 * high
    for step in range(_MEETS):
        with np.errstate(invalid="ignore", divide="ignore"):
            t = low + (high - low) * f_low / (f_low - f_high)
        t = np.where((t > low) & (t < high) & (step % 3 != 2), t, 0.5 * (low + high))
        value, _ = apart(t)
        value = np.where(np.isfinite(value), value, ends_)
        left = (value < 0.0) == begins
        low, f_low = np.where(left, t, low), np.where(left, value, f_low)
        high, f_high = np.where(left, high, t), np.where(left, f_high, value)
    v = apart(t)[1]
    return t, v, known & np.isfinite(v)
