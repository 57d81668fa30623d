"""The workspace's volume and centroid: one quadrature over x' of exact section areas.

Between the places where the section changes its structure its area is an analytic function of x'
but for square roots at the ends, which x' = m − r cos πu takes away; there a Gauss-Kronrod rule
converges geometrically. Such places come from closed forms (`events`) and, where three surfaces
meet in a point, from sections that are built differently. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.errors import InputError
from kinematics.five_rpur.cutting import Cutter, Cuts
from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.five_rpur.events import events
from kinematics.sections import Volume
from kinematics.spatial import Array, rotation_y

MOST_SECTIONS = 60_000
"""No volume is worth more sections; what is reached by then is returned with its error."""
_FOUND = 2e-3  # of the gap between two nodes: where between them the structure changes
_COARSE = 1e-5  # a relative error that is reached without placing panels at every event
_NARROW = 1e-7  # of the size: a place is known well enough
_UNSEEN = 1e-13  # of the whole range's volume: what rounding may take


@dataclass(frozen=True, eq=False)
class _Rule:
    """A Gauss-Kronrod rule on u in [0, 1] for an integral over x' = a + (b − a) s(u).

    ``place`` (N,) s(u) = (1 − cos πu)/2; ``weights`` (N,); ``coarser`` (N, 2) are two rules on every
    second node: where the integrand has a kink, one of the two may by chance agree with the fine
    rule, hardly both. All weights contain ds/du.
    """

    place: Array
    weights: Array
    coarser: Array


def _rule(nodes: tuple[float, ...], kronrod: tuple[float, ...], gauss: tuple[float, ...]) -> _Rule:
    """Of the nodes > 0 from the largest on, and 0; Gauss's are every second one from the second."""
    half = np.array(nodes)
    u = 0.5 + 0.5 * np.concatenate([-half, half[-2::-1]])
    mirrored = [*range(len(half)), *range(len(half) - 2, -1, -1)]
    fine = np.array(kronrod)[mirrored]
    coarse = np.zeros(len(half))
    coarse[1::2] = gauss
    # The nodes that Gauss leaves out, with the weights that integrate all polynomials they can.
    left = np.flatnonzero(coarse[mirrored] == 0.0)
    basis = np.polynomial.legendre.legvander(2.0 * u[left] - 1.0, left.size - 1)
    other = np.zeros(u.size)
    other[left] = np.linalg.solve(basis.T, 2.0 * (np.arange(left.size) == 0))
    slope = 0.25 * np.pi * np.sin(np.pi * u)
    return _Rule(
        0.5 - 0.5 * np.cos(np.pi * u),
        fine * slope,
        np.stack([coarse[mirrored], other], axis=-1) * slope[:, None],
    )


_RULE = _rule(
    (
        0.991455371120812640,
        0.949107912342758525,
        0.864864423359769073,
        0.741531185599394440,
        0.586087235467691130,
        0.405845151377397167,
        0.207784955007898468,
        0.0,
    ),
    (
        0.022935322010529225,
        0.063092092629978553,
        0.104790010322250184,
        0.140653259715525919,
        0.169004726639267903,
        0.190350578064785410,
        0.204432940075298892,
        0.209482141084727828,
    ),
    (
        0.129484966168869693,
        0.279705391489276668,
        0.381830050505118945,
        0.417959183673469388,
    ),
)


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
        InputError: an angle that is not finite, a mode that is not five signs, or an error
            wanted that is not between 1e-12 and 1.
    """
    cutter = Cutter(design, phi, theta, modes)
    found = integrate(cutter, relative, between)
    first = found.moments
    with np.errstate(invalid="ignore", divide="ignore"):
        centroid = np.array([found.first, first[1], first[2]]) / first[0]
    centroid[1:] += cutter.origin
    return Volume(
        value=float(first[0]),
        error=found.error,
        centroid=rotation_y(float(theta)) @ centroid,
        pieces=(),
        at=found.at,
        area=found.area,
        events=found.events,
        sections=found.sections,
    )


@dataclass(frozen=True, eq=False)
class Integral:
    """``moments`` (6,) of the volume (∫ dx' of those of sections), ``first`` = ∫ x' A dx'."""

    moments: Array
    first: float
    error: float
    at: Array
    area: Array
    events: Array
    sections: int


def integrate(
    cutter: Cutter, relative: float, between: tuple[float, float] | None = None
) -> Integral:
    """Integrals over x' of the sections' moments, until the volume's error is small enough.

    Raises:
        InputError: the wanted error is not between 1e-12 and 1.
    """
    if not 1e-12 <= relative <= 1.0:
        raise InputError(f"the wanted relative error must lie between 1e-12 and 1, got {relative}")
    work = _Work(cutter, relative, between)
    return work.run()


class _Work:
    """One quadrature on its way."""

    def __init__(
        self, cutter: Cutter, relative: float, between: tuple[float, float] | None
    ) -> None:
        self.cutter = cutter
        self.relative = relative
        self.sections = 0
        self.range = cutter.range
        if between is not None:
            low, high = max(between[0], self.range[0]), min(between[1], self.range[1])
            self.range = (low, max(low, high))
        self.known = np.empty(0)
        self.total = np.zeros(6)
        self.first = 0.0
        self.error = 0.0
        self.kept_at: list[Array] = []
        self.kept_area: list[Array] = []
        self.edges: list[Array] = []

    def cut(self, x: Array) -> Cuts:
        self.sections += x.size
        return self.cutter.cut(x)

    def run(self) -> Integral:
        low, high = self.range
        if high > low:
            left, right = self._stretches()
            self._converge(left, right)
        order = np.argsort(at := _joined(self.kept_at))
        area = _joined(self.kept_area)
        return Integral(
            self.total,
            self.first,
            float(self.error),
            at[order],
            area[order],
            np.unique(_joined(self.edges)),
            self.sections,
        )

    # --- panels

    def _stretches(self) -> tuple[Array, Array]:
        """Panels between events; events on both sides of which sections are alike are none."""
        low, high = self.range
        size = self.cutter.size
        known = events(self.cutter.limbs, self.cutter.signs, size)
        known = known[(known > low + 1e-9 * size) & (known < high - 1e-9 * size)]
        ends = np.concatenate([[low], known, [high]])
        cuts = self.cut(0.5 * (ends[1:] + ends[:-1]))
        changes = cuts.marks[1:] != cuts.marks[:-1]
        self.known = known[changes]
        if self.relative >= _COARSE:  # only where pieces begin and end; more where it is needed
            changes = cuts.parts[1:] != cuts.parts[:-1]
        ends = ends[np.concatenate([[True], changes, [True]])]
        return ends[:-1], ends[1:]

    def _converge(self, left: Array, right: Array) -> None:
        """Integrate panels, and split those that are not good enough, worst first."""
        size = self.cutter.size
        rule = _RULE
        scale = (self.range[1] - self.range[0]) * size * size
        floor = _UNSEEN * scale
        while left.size:
            width = right - left
            x = left[:, None] + width[:, None] * rule.place
            cuts = self.cut(x.ravel())
            count = rule.place.size
            moments = cuts.moments.reshape(-1, count, 6)
            marks = cuts.marks.reshape(-1, count)
            fine = width[:, None] * np.einsum("pnm,n->pm", moments, rule.weights)
            coarser = width[:, None] * (moments[:, :, 0] @ rule.coarser)
            error = np.abs(fine[:, :1] - coarser).max(axis=1)
            alike = (marks == marks[:, :1]).all(axis=1)
            empty = (marks == 0).all(axis=1)
            volume = self.total[0] + fine[:, 0].sum()
            allowed = max(self.relative * volume, floor)
            out_of_room = self.sections > MOST_SECTIONS
            # Where all sections of a panel are built alike the finer rule is far better than its
            # difference to the coarser one; elsewhere that difference is all that is known.
            part = error / np.maximum(np.abs(fine[:, 0]), 1e-300)
            error *= np.where(alike, np.minimum(1.0, 10.0 * part**0.6), 8.0)
            # The best panels are taken as long as half of what is allowed lasts.
            order = np.argsort(error)
            good = np.empty(left.size, dtype=bool)
            good[order] = np.cumsum(error[order]) <= 0.5 * (allowed - self.error)
            good |= (width <= _NARROW * size) | out_of_room
            good &= ~empty | out_of_room
            self._take(x[good], width[good], rule, moments[good], fine[good])
            self.error += float(error[good].sum())
            for a, b in zip(left[good], right[good], strict=True):
                self.edges.append(np.array([a, b]))
            # Where nothing was seen something small may still hide.
            hidden_left, hidden_right = left[empty & ~good], right[empty & ~good]
            more: list[tuple[Array, Array]] = []
            if hidden_left.size:
                more.append(self._look_closer(hidden_left, hidden_right, allowed))
            split = ~good & ~empty
            begin = np.searchsorted(self.known, left + _NARROW * size)
            end = np.searchsorted(self.known, right - _NARROW * size)
            inner = split & (end > begin)
            if inner.any():
                more.append(self._at_events(left[inner], right[inner], begin[inner], end[inner]))
            uneven = split & ~alike & ~inner
            if uneven.any():
                more.append(self._parted(x[uneven], left[uneven], right[uneven], marks[uneven]))
            even = split & alike & ~inner
            if even.any():
                middle = 0.5 * (left[even] + right[even])
                more.append(_halves(left[even], middle, right[even]))
            left = _joined([a for a, _ in more])
            right = _joined([b for _, b in more])
        self.error += 1e-13 * abs(self.total[0]) + 1e-16 * scale

    def _take(self, x: Array, width: Array, rule: _Rule, moments: Array, fine: Array) -> None:
        if not x.size:
            return
        self.total += fine.sum(axis=0)
        self.first += float(np.einsum("p,pn,pn,n->", width, x, moments[:, :, 0], rule.weights))
        self.kept_at.append(x.ravel())
        self.kept_area.append(moments[:, :, 0].ravel())

    def _parted(
        self, x: Array, left: Array, right: Array, marks: NDArray[np.int64]
    ) -> tuple[Array, Array]:
        """Panels that end where the structure changes, found between nodes that differ."""
        panel, node = np.nonzero(marks[:, 1:] != marks[:, :-1])
        a, b = x[panel, node], x[panel, node + 1]
        mark = marks[panel, node]
        goal = np.maximum(_FOUND * (b - a), _NARROW * self.cutter.size)
        while (wide := np.flatnonzero(b - a > goal)).size:
            # What changes beyond the first place is for the next round.
            middle = 0.5 * (a[wide] + b[wide])
            same = self.cut(middle).marks == mark[wide]
            a[wide[same]] = middle[same]
            b[wide[~same]] = middle[~same]
        lefts, rights = [], []
        for p in range(len(left)):
            mine = panel == p
            stops = np.unique(np.concatenate([[left[p]], 0.5 * (a + b)[mine], [right[p]]]))
            lefts.append(stops[:-1])
            rights.append(stops[1:])
        return np.concatenate(lefts), np.concatenate(rights)

    def _at_events(
        self, left: Array, right: Array, begin: NDArray[np.intp], end: NDArray[np.intp]
    ) -> tuple[Array, Array]:
        """Panels that end at known events: at the middle one, or at all where there are few."""
        few = end - begin <= 2
        first = np.where(few, begin, (begin + end) // 2)
        last = np.where(few, end - 1, first)
        stops = np.stack([left, self.known[first], self.known[last], right])
        a, b = stops[:-1].ravel(), stops[1:].ravel()
        return a[b > a], b[b > a]

    def _look_closer(self, left: Array, right: Array, allowed: float) -> tuple[Array, Array]:
        """Where nothing was seen: panels in which there is something; the rest is bounded.

        A section that holds all sections of a stretch bounds what can be there.
        """
        found: list[tuple[float, float]] = []
        share = 0.25 * allowed / (self.range[1] - self.range[0])
        for _ in range(40):
            if not left.size:
                break
            self.sections += left.size
            bound = self.cutter.hull(left, right).moments[:, 0]
            hidden = bound * (right - left)
            open_ = bound > share
            narrow = (right - left <= 1e-6 * self.cutter.size) | (self.sections > MOST_SECTIONS)
            self.error += float(hidden[~open_ | narrow].sum())
            left, right = left[open_ & ~narrow], right[open_ & ~narrow]
            if not left.size:
                break
            middle = 0.5 * (left + right)
            something = self.cut(middle).marks != 0
            for a, m, b in zip(
                left[something], middle[something], right[something], strict=True
            ):
                found += [(a, m), (m, b)]
            left, middle, right = left[~something], middle[~something], right[~something]
            left, right = _halves(left, middle, right)
        pairs = np.array(found).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]


def _halves(left: Array, middle: Array, right: Array) -> tuple[Array, Array]:
    return np.concatenate([left, middle]), np.concatenate([middle, right])


def _joined(parts: list[Array]) -> Array:
    return np.concatenate(parts) if parts else np.empty(0)
