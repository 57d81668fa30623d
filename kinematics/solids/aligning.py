"""Which boundaries of two neighbouring columns go on and which end: the cheapest way through."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.solids.columns import Ints, Layers, Mask

_OTHER = 3.0  # times as far apart as they are: two boundaries of different surfaces

Group = tuple[tuple[int, ...], tuple[int, ...], int, int]
"""Boundaries of a and of b, counted from where a move begins, and how many levels; see `Joined`."""


@lru_cache(maxsize=4096)
def _moves(one: tuple[int, ...], other: tuple[int, ...]) -> dict[tuple[int, int], list[_Move]]:
    """By which moves one comes to every pair of numbers of boundaries passed."""
    found: dict[tuple[int, int], list[_Move]] = {}
    for i in range(len(one)):
        for j in range(len(other)):
            if one[i] == other[j]:
                found[i, j] = [
                    _Move(m, n, groups)
                    for m in range(i + 1)
                    for n in range(j + 1)
                    if m + n > 1 and one[i - m] == other[j - n]
                    for groups in [_meeting(one[i - m : i + 1], other[j - n : j + 1])]
                    if groups is not None
                ]
    return found


@dataclass(frozen=True)
class _Move:
    """Past m boundaries of a and n of b: they go on (1, 1), or meet in groups."""

    m: int
    n: int
    groups: tuple[Group, ...]


def _meeting(one: tuple[int, ...], other: tuple[int, ...]) -> tuple[Group, ...] | None:
    """How boundaries between layers ``one`` of a and ``other`` of b meet, if they can at once."""
    m, n = len(one) - 1, len(other) - 1
    outer = {one[0], one[-1]}
    within = [*one[1:-1], *other[1:-1]]
    if outer & set(within):
        return None
    if (m, n) == (1, 1):
        return ()
    if m == 0 or n == 0:
        ends = _ending(one if m else other, 0)
        return tuple(
            (end, (), 0, 0 if k == 0 else -1) if m else ((), end, 0 if k == 0 else -1, 0)
            for k, end in enumerate(ends)
        )
    if (m, n) in ((1, 2), (2, 1)):
        return ((tuple(range(m)), tuple(range(n)), 0, 0),)
    if (m, n) == (2, 2) and len(outer) == 1 and within[0] != within[1]:
        return (((0, 1), (0, 1), 0, 0),)
    return None


def _ending(layers_: tuple[int, ...], first: int) -> list[tuple[int, ...]]:
    """The boundaries that meet where all between two equal layers ends, the outermost first."""
    last = len(layers_) - 2
    if last < 0:
        return []
    inner = layers_[1:-1]
    again = [k for k, layer in enumerate(inner, 1) if layer == layers_[0]]
    if again:  # one after the other
        k = again[0]
        return _ending(layers_[: k + 1], first) + _ending(layers_[k:], first + k)
    if inner[0] == inner[-1]:  # one around the others
        return [(first, first + last), *_ending(inner, first + 1)]
    k = next(k for k in range(1, len(inner)) if inner[k - 1] == inner[0] and inner[k] == inner[-1])
    return [
        (first, first + k, first + last),
        *_ending(inner[:k], first + 1),
        *_ending(inner[k:], first + k + 1),
    ]


def aligned(
    a: Layers, b: Layers, chosen: NDArray[np.intp], known: Mask | None
) -> tuple[Ints, Ints]:
    """The cheapest way to come through columns ``a`` and ``b`` of walls ``chosen`` of one kind:
    which boundaries go on, and which meet with their levels; see `joining.Joined`. First of all
    layers hang together that are ``known`` to do so, and no others."""
    one, other = _sequence(a, 0), _sequence(b, 0)
    moves = _moves(one, other)
    count = len(chosen)
    never = 1e3 * np.abs(np.where(np.isfinite(a.at), a.at, 0.0)).max()
    cost: dict[tuple[int, int], Array] = {(0, 0): np.zeros(count)}
    way: dict[tuple[int, int], Ints] = {}
    for (i, j), ways in moves.items():
        if (i, j) == (0, 0):
            continue
        best, which = np.full(count, np.inf), np.full(count, -1, dtype=np.int64)
        for k, move in enumerate(ways):
            before = cost.get((i - move.m, j - move.n))
            if before is not None:
                total = before + _cost(a, b, i, j, move.m, move.n)
                which = np.where(total < best, k, which)
                best = np.minimum(total, best)
        if known is not None and one[i]:
            best = best + np.where(known[:, i - 1, j - 1], -never, never)
        cost[i, j], way[i, j] = best, which
    goes: list[Ints] = [np.empty((0, 3), dtype=np.int64)]
    meet: list[Ints] = [np.empty((0, 9), dtype=np.int64)]
    todo = [(len(one) - 1, len(other) - 1, np.arange(count))]
    while todo:
        i, j, rows = todo.pop()
        if (i, j) == (0, 0):
            continue
        for k, move in enumerate(moves[i, j]):
            own = rows[way[i, j][rows] == k]
            if not len(own):
                continue
            i0, j0 = i - move.m, j - move.n
            if move.m == move.n == 1:
                goes.append(_rows(chosen[own], i0, j0))
            for in_a, in_b, level_a, level_b in move.groups:
                numbers = [-1] * 6
                numbers[: len(in_a)] = [i0 + n for n in in_a]
                numbers[3 : 3 + len(in_b)] = [j0 + n for n in in_b]
                levels = (i0 if level_a == 0 else -1, j0 if level_b == 0 else -1)
                meet.append(_rows(chosen[own], *numbers, *levels))
            todo.append((i0, j0, own))
    return np.concatenate(goes), np.concatenate(meet)


def _rows(walls: NDArray[np.intp], *numbers: int) -> Ints:
    return np.column_stack([walls, *(np.full(len(walls), n) for n in numbers)]).astype(np.int64)


def _cost(a: Layers, b: Layers, i: int, j: int, m: int, n: int) -> Array:
    """mm: how far boundaries are apart that go on, and how thick what ends is."""
    if m == n == 1:
        apart = np.abs(a.at[:, i - 1] - b.at[:, j - 1])
        same = a.label[:, i - 1] == b.label[:, j - 1]
        return np.asarray(np.where(same, apart, _OTHER * apart))
    total = np.zeros(len(a.at))
    for column, k, number in ((a, i, m), (b, j, n)):
        if number > 1:
            total = total + (column.at[:, k - 1] - column.at[:, k - number])
    if (m, n) == (2, 2):  # if they have some v in common, or lie between the same surfaces
        one, other = (a.at[:, i - 2 : i], b.at[:, j - 2 : j])
        common = np.minimum(one[:, 1], other[:, 1]) > np.maximum(one[:, 0], other[:, 0])
        common |= (a.label[:, i - 2 : i] == b.label[:, j - 2 : j]).all(axis=1)
        total = np.where(common, 0.1, 2.0) * total
    elif m and n:  # the boundary that goes on as two
        total = total + np.abs(a.at[:, i - m : i].mean(axis=1) - b.at[:, j - n : j].mean(axis=1))
    return total


def _sequence(columns: Layers, row: int) -> tuple[int, ...]:
    """The layers of a column from below."""
    return (0, *(int(s) for s in columns.above[row, : columns.count[row]]))
