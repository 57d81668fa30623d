"""Connected pieces of the workspace, followed from section to section.

Pieces of neighbouring sections belong together where they are built alike or, if they are not,
where they overlap. Where a piece overlaps none, a section between the two is looked at: the piece
may have begun there, or moved on. Sections are looked at all together, a halving at a time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array, Ints
from kinematics.mechanisms.five_rpur.slicing.batches import (
    components,
    curve_heights,
    first_moments,
    pairs_of,
    speeds,
)
from kinematics.mechanisms.five_rpur.slicing.sweep import WZ

Index = NDArray[np.intp]

BETWEEN = 6  # halvings of the distance of two sections, to see who belongs to whom
MOST = 4  # times as many sections as there were may be looked at between them …
FEW = 256  # … and these
SPECK = 1e-11  # of the volume: a piece that is less between two sections is not worth a third


@dataclass(frozen=True, eq=False)
class Runs:
    """Sections in runs, see `sweep.sweep`.

    Attributes:
        at: (N,) x'.
        lows, highs: (N, n) S(ρ_min) and S(ρ_max) of every limb.
        firsts: (N + 1,) the first run of each section, and their number.
        curves: (R, 2) the lower and the upper curve.
        spans: (R, 2) y' at both ends.
        pieces: (R,) of which piece a run is, counted from 0 from section to section.
        tells: (R,) numbers whose sum over a piece tells how it is built.
        marks: (N,) equal where sections are built alike, 0 where there is nothing.
        bases: (R, 2) z' of the centres of both curves' circles.
        areas: (R, 2) mm², and their derivatives by x', ends left out.
    """

    at: Array
    lows: Array
    highs: Array
    firsts: Ints
    curves: Ints
    spans: Array
    pieces: Ints
    tells: Ints
    marks: Ints
    bases: Array
    areas: Array

    @classmethod
    def of(
        cls,
        limbs: Array,
        at: Array,
        lows: Array,
        highs: Array,
        firsts: Ints,
        curves: Ints,
        spans: Array,
        pieces: Ints,
        tells: Ints,
        marks: Ints,
    ) -> Runs:
        """The runs that `measures.runs_of` told."""
        section = np.repeat(np.arange(len(at)), np.diff(firsts))
        speed = speeds(at, lows, highs, limbs)
        bases, areas = np.empty(curves.shape), np.zeros(curves.shape)
        y0, y1 = spans.T
        for end, sign in ((0, -1.0), (1, 1.0)):
            c = curves[:, end]
            i, k = c >> 3, c & 3
            away = np.where((k == 0) | (k == 3), highs[section, i], lows[section, i])
            bases[:, end] = limbs[WZ][i] + np.where(k < 2, -away, away)
            area, _, _ = first_moments(limbs, c, bases[:, end], y0, y1, np.zeros(2))
            areas[:, 0] += sign * area
            areas[:, 1] += sign * speed[section, c] * (y1 - y0)
        return cls(at, lows, highs, firsts, curves, spans, pieces, tells, marks, bases, areas)

    @property
    def sections(self) -> Index:
        """(R,) of which section each run is."""
        return np.repeat(np.arange(len(self.at)), np.diff(self.firsts))

    def with_others(self, others: Runs) -> Runs:
        """Both, the others behind."""
        columns: dict[str, Any] = {f.name: getattr(others, f.name) for f in fields(self)}
        columns["firsts"] = columns["firsts"][1:] + len(self.spans)
        columns["pieces"] = columns["pieces"] + int(self.pieces.max(initial=-1)) + 1
        both = {key: np.concatenate([getattr(self, key), new]) for key, new in columns.items()}
        return Runs(**both)


class _Pieces:
    """The pieces of some sections, as they are matched."""

    def __init__(self, runs: Runs, limbs: Array) -> None:
        self.runs, self.limbs = runs, limbs
        sections = runs.sections
        self.count = int(runs.pieces.max(initial=-1)) + 1
        self._order = np.argsort(runs.pieces, kind="stable")
        self._starts = np.searchsorted(runs.pieces[self._order], np.arange(self.count + 1))
        # Pieces of a section follow each other.
        self.section = sections[self._order[self._starts[:-1]]]
        self.firsts = np.searchsorted(self.section, np.arange(len(runs.at) + 1))
        self.told = np.zeros(self.count, np.int64)
        np.add.at(self.told, runs.pieces, runs.tells)
        self.area, self.slope = (
            np.bincount(runs.pieces, column, self.count) for column in runs.areas.T
        )
        # Those of a section that are built alike are told apart by their order.
        _, self.told = np.unique(self.told, return_inverse=True)
        order = np.lexsort((self.told, self.section))
        new = np.ones(self.count, bool)
        new[1:] = np.diff(self.section[order]) != 0
        new[1:] |= np.diff(self.told[order]) != 0
        starts = np.flatnonzero(new)
        group = np.cumsum(new) - 1
        self.rank, self.twins = np.empty(self.count, np.intp), np.empty(self.count, np.intp)
        self.rank[order] = np.arange(self.count) - starts[group]
        self.twins[order] = np.bincount(group)[group] if self.count else 0

    def match(self, left: Index, right: Index) -> tuple[Index, Index, Index, Array]:
        """Pieces of pairs of sections (Q,) that belong together, and what is alone.

        Returns:
            (L,) the pair, (L,) the pieces of the left section and (L,) of the right one; and (Q,)
            the area of the largest piece that is alone though the other section has some, mm².
        """
        pair, ones = self._members(left)
        other_pair, others = self._members(right)
        width, ranks = (int(column.max(initial=0)) + 1 for column in (self.told, self.rank))
        first = (pair * width + self.told[ones]) * ranks + self.rank[ones]
        second = (other_pair * width + self.told[others]) * ranks + self.rank[others]
        _, m, n = np.intersect1d(first, second, assume_unique=True, return_indices=True)
        alike = self.runs.marks[left] == self.runs.marks[right]
        sure = alike[pair[m]] | (self.twins[ones[m]] == 1)
        m, n = m[sure], n[sure]
        # The others changed in between: they are the same where they overlap.
        changed, others_changed = np.ones(len(ones), bool), np.ones(len(others), bool)
        changed[m] = others_changed[n] = False
        rest, others_rest = np.flatnonzero(changed), np.flatnonzero(others_changed)
        a, b = self._overlapping(
            (pair[rest], ones[rest]), (other_pair[others_rest], others[others_rest]), len(left)
        )
        a, b = rest[a], others_rest[b]
        changed[a] = others_changed[b] = False
        alone = np.zeros(len(left))
        np.maximum.at(alone, pair[changed], self.area[ones[changed]])
        np.maximum.at(alone, other_pair[others_changed], self.area[others[others_changed]])
        alone[(np.diff(self.firsts)[left] == 0) | (np.diff(self.firsts)[right] == 0)] = 0.0
        m, n = np.concatenate([m, a]), np.concatenate([n, b])
        return pair[m], ones[m], others[n], alone

    def _members(self, sections: Index) -> tuple[Index, Index]:
        """All pieces of some sections: (M,) whose, as places in ``sections``, and (M,) which."""
        many = self.firsts[sections + 1] - self.firsts[sections]
        whose = np.repeat(np.arange(len(sections)), many)
        start = np.cumsum(many) - many
        return whose, self.firsts[sections[whose]] + np.arange(len(whose)) - start[whose]

    def _overlapping(
        self, one: tuple[Index, Index], two: tuple[Index, Index], count: int
    ) -> tuple[Index, Index]:
        """Which pieces of pairs of sections have points in common: places (K,) in both lists.

        Each list has the pair, increasing, and the piece; there are ``count`` pairs.
        """
        runs, order, starts = self.runs, self._order, self._starts
        places, chosen, whose = [], [], []
        for q, p in (one, two):
            many = starts[p + 1] - starts[p]
            place = np.repeat(np.arange(len(p)), many)
            begin = np.cumsum(many) - many
            places.append(place)
            chosen.append(order[starts[p[place]] + np.arange(len(place)) - begin[place]])
            whose.append(q[place])
        a, b = pairs_of(whose[0], whose[1], count)
        run0, run1 = chosen[0][a], chosen[1][b]
        y0 = np.maximum(runs.spans[run0, 0], runs.spans[run1, 0])
        y1 = np.minimum(runs.spans[run0, 1], runs.spans[run1, 1])
        near = y1 > y0
        a, b, run0, run1 = a[near], b[near], run0[near], run1[near]
        y = 0.5 * (y0[near] + y1[near])
        z = [
            [
                curve_heights(self.limbs, runs.curves[run, end], runs.bases[run, end], y)
                for end in range(2)
            ]
            for run in (run0, run1)
        ]
        meets = np.minimum(z[0][1], z[1][1]) > np.maximum(z[0][0], z[1][0])
        found = np.unique(places[0][a[meets]] * (len(two[0]) + 1) + places[1][b[meets]])
        return found // (len(two[0]) + 1), found % (len(two[0]) + 1)


def volumes(cut: Callable[[Array], Runs], limbs: Array, at: Array, weights: Array) -> Array:
    """Of each connected piece of the workspace what its sections' areas and their derivatives
    contribute to its volume (P, 2), mm³.

    Args:
        cut: sections at x' (N,).
        limbs: (6, n) w'_x, w'_y, w'_z, l, ρ_min, ρ_max.
        at: (N,) x', increasing; weights: (N, 2) of the areas and of their derivatives.
    """
    runs = cut(at)
    pieces = _Pieces(runs, limbs)
    known = pieces.count
    own = pieces.section
    least = SPECK * float(weights[own, 0] @ pieces.area + weights[own, 1] @ pieces.slope)
    left, right = np.arange(len(at) - 1), np.arange(1, len(at))
    room = MOST * len(at) + FEW
    joined: list[tuple[Index, Index]] = []
    for depth in range(BETWEEN + 1):
        pair, one, two, alone = pieces.match(left, right)
        # First the places where most is in doubt.
        doubt = alone * np.abs(runs.at[right] - runs.at[left])
        worst = np.argsort(-doubt, kind="stable")[: room if depth < BETWEEN else 0]
        open_ = np.zeros(len(left), bool)
        open_[worst] = doubt[worst] > least
        joined.append((one[~open_[pair]], two[~open_[pair]]))
        if not open_.any():
            break
        left, right = left[open_], right[open_]
        middle = len(runs.at) + np.arange(len(left))
        room -= len(left)
        runs = runs.with_others(cut(0.5 * (runs.at[left] + runs.at[right])))
        pieces = _Pieces(runs, limbs)
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
    one, two = (np.concatenate(column) for column in zip(*joined, strict=True))
    label = components(pieces.count, one, two)[:known]
    count = int(label.max(initial=-1)) + 1
    parts = weights[own, 0] * pieces.area[:known], weights[own, 1] * pieces.slope[:known]
    return np.stack([np.bincount(label, part, count) for part in parts], axis=-1)
