"""The workspace's volume and centroid: one quadrature over x' of exact section areas.

Between the places where the section changes its structure its area is a series in the roots of
the distances from both, which `quadrature` integrates well. Such places come from closed forms
(`events`) and, where three surfaces meet in a point, from sections that are built differently.
Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinematics.errors import InputError
from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.five_rpur.slicing import acceleration
from kinematics.five_rpur.slicing.cutter import Cuts, Cutter
from kinematics.five_rpur.slicing.events import events
from kinematics.five_rpur.slicing.quadrature import LONG, SHORT, Rule
from kinematics.sections import Volume
from kinematics.spatial import Array, finite, rotation_y

MOST_SECTIONS = 60_000
"""No volume is worth more sections; what is reached by then is returned with its error."""
_USUAL = 1500  # sections that a volume needs
_FOUND = 2e-3  # of the gap between two nodes: where between them the structure changes
_WIDEST = 3.0  # panels, as a part of the range for each cube root of the error wanted
_NARROW = 1e-7  # of the size: two places are one
_UNSEEN = 1e-13  # of range x size²: what rounding may take
# What a rule may be off by, as a part of its difference to the coarser ones: where all sections are
# built alike, less the smaller the relative difference is, in proportion to its root; and of the
# shorter rule at least, and of the longer one at most. Bounds of what was seen on ten thousand
# panels of random machines.
_SHORTER, _SHORTER_LEAST, _SHORTER_MOST = 15.0, 0.05, 0.3
_LONGER, _LONGER_MOST = 30.0, 0.05
# Where a kink lies between two nodes all rules may see too little of it: of the change in area
# between them times their distance, of the change in slope times the distance's square, and of the
# panel's volume.
_JUMP, _BEND, _KINK = 0.05, 0.05, 1e-6

_SPECK = 1e-10  # of the volume: a piece that small is due to rounding

_Panel_ends = tuple[Array, Array]


def volume(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: Iterable[str] | None = None,
    *,
    relative: float = 1e-6,
    between: tuple[float, float] | None = None,
) -> Volume:
    """The volume of the constant-orientation workspace by exact sections.

    Args:
        design: the machine.
        phi: φ, rad.
        theta: θ, rad.
        modes: working modes as "+-+++", of which any will do; None for all 32.
        relative: the error wanted, as a part of the volume.
        between: only what lies between these two x', mm.

    Raises:
        InputError: an angle or an end that is not finite, a mode that is not five signs, or an
            error wanted that is not between 1e-12 and 1.
    """
    cutter = Cutter(design, phi, theta, modes)
    found = integrate(cutter, relative, between)
    with np.errstate(invalid="ignore", divide="ignore"):
        centroid = np.array([found.first, *found.moments[1:3]]) / found.moments[0]
    centroid[1:] += cutter.origin
    return Volume(
        value=float(found.moments[0]),
        error=found.error,
        centroid=rotation_y(float(theta)) @ centroid,
        pieces=pieces(cutter, found),
        at=found.at,
        area=found.area,
        events=found.events,
        sections=found.sections,
    )


@dataclass(frozen=True, eq=False)
class Integral:
    """``moments`` (3,) of the volume (∫ dx' of those of sections), ``first`` = ∫ x' A dx';
    the volume's ``error``; the sections taken, ``at``, ``area``, ``weights`` and ``marks`` (N,);
    ``events`` (P,), where the structure changes.
    """

    moments: Array
    first: float
    error: float
    at: Array
    area: Array
    weights: Array
    marks: NDArray[np.int64]
    events: Array
    sections: int


def integrate(
    cutter: Cutter, relative: float, between: tuple[float, float] | None = None
) -> Integral:
    """Integrals over x' of the sections' moments, until the volume's error is small enough.

    Raises:
        InputError: the wanted error is not between 1e-12 and 1, or ``between`` not two numbers.
    """
    if not 1e-12 <= relative <= 1.0:
        raise InputError(f"the wanted relative error must lie between 1e-12 and 1, got {relative}")
    acceleration.kernel(_USUAL)
    if between is not None:
        first, last = finite(between, name="between", last=2).tolist()
        between = (first, last)
    return _Work(cutter, relative, between).run()


def pieces(cutter: Cutter, found: Integral) -> tuple[float, ...]:
    """The volumes of the connected pieces, mm³, largest first; what rounding makes is left out."""
    volumes = cutter.pieces(found.at, found.weights, found.marks)
    return tuple(float(v) for v in volumes if v > _SPECK * found.moments[0])


@dataclass(frozen=True, eq=False)
class _Panels:
    """Panels with their sections; ``begin`` and ``end`` tell the known events inside."""

    left: Array
    right: Array
    x: Array
    moments: Array
    marks: NDArray[np.int64]
    rule: Rule
    fine: Array
    error: Array
    alike: NDArray[np.bool_]
    empty: NDArray[np.bool_]
    begin: NDArray[np.intp]
    end: NDArray[np.intp]


class _Work:
    """One quadrature on its way."""

    def __init__(
        self, cutter: Cutter, relative: float, between: tuple[float, float] | None
    ) -> None:
        self.cutter = cutter
        self.relative = relative
        self.sections = 0
        low, high = cutter.range
        if between is not None:
            low = max(low, min(between))
            high = max(low, min(high, max(between)))
        self.range = (low, high)
        self.known = np.empty(0)
        self.possible = np.empty(0)  # what was not seen to change anything, too, and infinity
        self.total = np.zeros(3)
        self.first = 0.0
        self.error = 0.0
        self.taken: list[tuple[Array, Array, Array, NDArray[np.int64]]] = []
        self.edges: list[Array] = []

    def run(self) -> Integral:
        low, high = self.range
        if high > low:
            self._converge(*self._stretches())
        at, area, weights, marks = (_joined([part[n] for part in self.taken]) for n in range(4))
        order = np.argsort(at)
        at, area, weights, marks = at[order], area[order], weights[order], marks[order]
        # Of the panels' ends those on both sides of which sections are built differently.
        ends = np.unique(_joined(self.edges))
        behind = np.searchsorted(at, ends)
        around = np.concatenate([[0], marks, [0]])
        return Integral(
            self.total,
            self.first,
            float(self.error),
            at,
            area,
            weights,
            marks.astype(np.int64),
            ends[around[behind] != around[behind + 1]],
            self.sections,
        )

    def _cut(self, x: Array) -> Cuts:
        self.sections += x.size
        return self.cutter.cut(x.ravel())

    def _stretches(self) -> _Panel_ends:
        """Panels between events; events on both sides of which sections are alike are none."""
        low, high = self.range
        narrow = _NARROW * self.cutter.size
        known = events(self.cutter.limbs, self.cutter.signs, self.cutter.size)
        known = known[(known > low + narrow) & (known < high - narrow)]
        ends = np.concatenate([[low], known, [high]])
        marks = self._cut(0.5 * (ends[1:] + ends[:-1])).marks
        changes = marks[1:] != marks[:-1]
        self.known, self.possible = known[changes], np.append(known, np.inf)
        ends = ends[np.concatenate([[True], changes, [True]])]
        # Between two nodes a small piece may begin and end unseen: the smaller the error wanted,
        # the closer they must be.
        widest = _WIDEST * (high - low) * self.relative ** (1.0 / 3.0)
        parts = np.ceil((ends[1:] - ends[:-1]) / widest).astype(int)
        owner = np.repeat(np.arange(parts.size), parts)
        share = (np.arange(owner.size) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[owner]
        ends = np.append(ends[owner] + share * (ends[owner + 1] - ends[owner]), high)
        return ends[:-1], ends[1:]

    def _converge(self, left: Array, right: Array) -> None:
        """Integrate panels, and split those that are not good enough."""
        scale = (self.range[1] - self.range[0]) * self.cutter.size**2
        while left.size:
            panels = self._panels(left, right)
            volume = self.total[0] + float(panels.fine[:, 0].sum())
            allowed = max(self.relative * volume, _UNSEEN * scale)
            good = self._good(panels, allowed) & ~panels.empty
            self._take(panels, good)
            even = ~good & panels.alike & ~panels.empty
            longer = self._longer(panels, even)
            enough = self._good(longer, allowed)
            self._take(longer, enough)
            rest = ~good & ~even & ~panels.empty
            inner = rest & (panels.end > panels.begin)
            ends = [
                self._halves(longer, ~enough),
                self._at_events(panels, inner),
                self._parted(panels, rest & ~inner),
                self._look_closer(panels, panels.empty, allowed),
            ]
            left, right = _joined([a for a, _ in ends]), _joined([b for _, b in ends])
        self.error += 1e-13 * abs(self.total[0]) + 1e-16 * scale

    # --- panels

    def _panels(self, left: Array, right: Array) -> _Panels:
        x = left[:, None] + (right - left)[:, None] * SHORT.place
        cuts = self._cut(x)
        return self._weighed(
            left, right, x, cuts.moments.reshape(*x.shape, 3), cuts.marks.reshape(x.shape), SHORT
        )

    def _longer(self, panels: _Panels, which: NDArray[np.bool_]) -> _Panels:
        """Some of the panels by the longer rule; their sections serve again."""
        left, right = panels.left[which], panels.right[which]
        x = left[:, None] + (right - left)[:, None] * LONG.place
        cuts = self._cut(x[:, ::2])
        moments, marks = np.empty((*x.shape, 3)), np.empty(x.shape, np.int64)
        moments[:, ::2] = cuts.moments.reshape(*x[:, ::2].shape, 3)
        marks[:, ::2] = cuts.marks.reshape(x[:, ::2].shape)
        moments[:, 1::2], marks[:, 1::2] = panels.moments[which], panels.marks[which]
        return self._weighed(left, right, x, moments, marks, LONG)

    def _weighed(
        self,
        left: Array,
        right: Array,
        x: Array,
        moments: Array,
        marks: NDArray[np.int64],
        rule: Rule,
    ) -> _Panels:
        width = right - left
        fine = width[:, None] * np.einsum("pnm,n->pm", moments, rule.weights)
        coarser = width[:, None] * (moments[:, :, 0] @ rule.coarser)
        apart = np.abs(fine[:, :1] - coarser).max(axis=1)
        begin = np.searchsorted(self.known, left + _NARROW * self.cutter.size)
        end = np.searchsorted(self.known, right - _NARROW * self.cutter.size)
        alike = (marks == marks[:, :1]).all(axis=1) & (begin >= end)
        volume = np.maximum(np.abs(fine[:, 0]), 1e-300)
        root = np.sqrt(apart / volume)
        if rule is SHORT:
            better = np.clip(_SHORTER * root, _SHORTER_LEAST, _SHORTER_MOST)
        else:
            better = np.minimum(_LONGER * root, _LONGER_MOST)
        changed = marks[:, 1:] != marks[:, :-1]
        gap, jump = np.diff(x, axis=1), np.diff(moments[:, :, 0], axis=1)
        slope = np.divide(jump, gap, out=np.zeros_like(gap), where=gap > 0.0)
        slope = np.concatenate([slope[:, :1], slope, slope[:, -1:]], axis=1)
        bend = np.abs(slope[:, 2:] - slope[:, :-2]) * gap
        unseen = (_JUMP * np.abs(jump) + _BEND * bend) * gap * changed
        kinked = apart + _KINK * volume + unseen.sum(axis=1)
        error = np.where(alike, better * apart, kinked)
        empty = (marks == 0).all(axis=1)
        return _Panels(left, right, x, moments, marks, rule, fine, error, alike, empty, begin, end)

    def _good(self, panels: _Panels, allowed: float) -> NDArray[np.bool_]:
        """The best panels, as long as half of what is still allowed lasts."""
        order = np.argsort(panels.error)
        good = np.empty(order.size, dtype=bool)
        good[order] = np.cumsum(panels.error[order]) <= 0.5 * (allowed - self.error)
        good |= panels.right - panels.left <= _NARROW * self.cutter.size
        return good if self.sections < MOST_SECTIONS else np.ones_like(good)

    def _take(self, panels: _Panels, which: NDArray[np.bool_]) -> None:
        x, area = panels.x[which], panels.moments[which][:, :, 0]
        left, right = panels.left[which], panels.right[which]
        weights = (right - left)[:, None] * panels.rule.weights
        self.total += panels.fine[which].sum(axis=0)
        self.first += float((weights * x * area).sum())
        self.error += float(panels.error[which].sum())
        marks = panels.marks[which]
        self.taken.append((x.ravel(), area.ravel(), weights.ravel(), marks.ravel()))
        self.edges += [left, right]

    # --- splitting

    def _halves(self, panels: _Panels, which: NDArray[np.bool_]) -> _Panel_ends:
        left, right = panels.left[which], panels.right[which]
        return _halved(left, 0.5 * (left + right), right)

    def _at_events(self, panels: _Panels, which: NDArray[np.bool_]) -> _Panel_ends:
        """Panels that end at the known events inside."""
        lefts, rights = [], []
        for n in np.flatnonzero(which):
            inside = self.known[panels.begin[n] : panels.end[n]]
            stops = np.concatenate([panels.left[n : n + 1], inside, panels.right[n : n + 1]])
            lefts.append(stops[:-1])
            rights.append(stops[1:])
        return _joined(lefts), _joined(rights)

    def _parted(self, panels: _Panels, which: NDArray[np.bool_]) -> _Panel_ends:
        """Panels that end where the structure changes, found between nodes that differ."""
        left, right, x, marks = (
            v[which] for v in (panels.left, panels.right, panels.x, panels.marks)
        )
        panel, node = np.nonzero(marks[:, 1:] != marks[:, :-1])
        a, b = x[panel, node], x[panel, node + 1]
        mark = marks[panel, node]
        goal = np.maximum(_FOUND * (b - a), _NARROW * self.cutter.size)
        while (wide := np.flatnonzero(b - a > goal)).size:
            # What changes beyond the first place is for the next round.
            middle = 0.5 * (a[wide] + b[wide])
            same = self._cut(np.asarray(middle)).marks == mark[wide]
            a[wide[same]] = middle[same]
            b[wide[~same]] = middle[~same]
        # A closed form is exact, and no section there need tell.
        event = self.possible[np.searchsorted(self.possible, a)]
        found = np.where(event <= b, event, 0.5 * (a + b))
        # All ends in order of their panels; a panel's right end and the next one's left end are
        # neighbours that make no panel.
        owner = np.concatenate([np.arange(left.size), panel, np.arange(left.size)])
        stops = np.concatenate([left, found, right])
        order = np.lexsort((stops, owner))
        owner, stops = owner[order], stops[order]
        inside = (owner[1:] == owner[:-1]) & (stops[1:] > stops[:-1])
        return stops[:-1][inside], stops[1:][inside]

    def _look_closer(
        self, panels: _Panels, which: NDArray[np.bool_], allowed: float
    ) -> _Panel_ends:
        """Where nothing was seen: panels in which there is something; the rest is bounded.

        A section that holds all sections of a stretch bounds what can be there.
        """
        left, right = panels.left[which], panels.right[which]
        self.edges += [left, right]
        # Sections without area keep apart what lies on both sides of them.
        x = panels.x[which].ravel()
        self.taken.append((x, np.zeros(x.size), np.zeros(x.size), np.zeros(x.size, np.int64)))
        share = 0.25 * allowed / (self.range[1] - self.range[0])
        lefts, rights = [], []
        while left.size:
            self.sections += left.size
            bound = self.cutter.hull(left, right).moments[:, 0]
            last = right - left <= 1e-6 * self.cutter.size
            closed = (bound <= share) | last | (self.sections > MOST_SECTIONS)
            self.error += float((bound * (right - left))[closed].sum())
            left, right = left[~closed], right[~closed]
            middle = 0.5 * (left + right)
            seen = self._cut(middle).marks != 0
            lefts += [left[seen], middle[seen]]
            rights += [middle[seen], right[seen]]
            left, right = _halved(left[~seen], middle[~seen], right[~seen])
        return _joined(lefts), _joined(rights)


def _halved(left: Array, middle: Array, right: Array) -> _Panel_ends:
    return np.concatenate([left, middle]), np.concatenate([middle, right])


def _joined(parts: list[Any]) -> Any:
    return np.concatenate(parts) if parts else np.empty(0)
