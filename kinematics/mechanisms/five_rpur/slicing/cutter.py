"""Sections of one orientation in batches: the machine as the kernel takes it.

Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array, Ints
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inverse import chosen
from kinematics.mechanisms.five_rpur.offsets import SAME_NUMBERS, aligned_offsets
from kinematics.mechanisms.five_rpur.slicing import acceleration
from kinematics.mechanisms.five_rpur.slicing.batches import curve_heights, holds
from kinematics.mechanisms.five_rpur.slicing.sweep import MOST_RUNS
from kinematics.mechanisms.five_rpur.slicing.tracing import Runs, volumes

_MOST_EDGES = 4096  # of one section; twice what crossings of five limbs can make


@dataclass(frozen=True, eq=False)
class Cuts:
    """Sections at ``at`` (N,): ``moments`` (N, 3) of 1, v, w about the origin,
    ``marks`` (N,) equal where sections are built alike.
    """

    at: Array
    moments: Array
    marks: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Integral:
    """Sections at increasing ``at`` (N,): ``moments`` (N, 6) of 1, v, w about the origin and their
    derivatives by x', ``marks`` (N,) equal where sections are built alike; the ``weights`` (N, 2)
    of moments and derivatives make integrals of them; ``error`` is that of the volume, and
    ``sections`` so many were computed.
    """

    at: Array
    moments: Array
    marks: Ints
    weights: Array
    error: float
    sections: int


@dataclass(frozen=True, eq=False)
class Outline:
    """A section's boundary: ``low`` and ``high`` (5,) are S(ρ_min) and S(ρ_max), ``moments`` (6,)
    of 1, v, w, v², w², vw about the origin, the rest as `boundary.describe` has it.
    """

    low: Array
    high: Array
    whose: Ints
    places: Array
    firsts: Ints
    areas: Array
    pieces: Ints
    perimeter: float
    moments: Array


class Cutter:
    """The sections of a workspace at one orientation, for a set of working modes.

    Or of what the workspaces of several machines have in common: their limbs are n = 5 M together,
    whatever is said of five below.

    Args:
        design, modes: a machine and its working modes, None: all of them.
        others: further machines, each with its own.

    Attributes:
        limbs: (6, n) rows w'_x, w'_y, w'_z (eq. 27), l, ρ_min, ρ_max.
        signs: (n, 2) whether any wanted mode has limb i in + and in −.
        table: (M, 1024) whether a point is inside that lies in the halves whose bits are set.
        size: mm, a length of the machine.
        origin: (2,) y', z' about which moments are taken.
        range: x' outside of which there is nothing; equal ends if there is nothing at all.
    """

    def __init__(
        self,
        design: FiveRPURDesign,
        phi: float,
        theta: float,
        modes: Iterable[str] | None,
        others: Iterable[tuple[FiveRPURDesign, Iterable[str] | None]] = (),
    ) -> None:
        limbs, signs, tables = [], [], []
        for one, of in ((design, modes), *others):
            offsets = aligned_offsets(one, phi, theta, SAME_NUMBERS)
            limbs.append(np.array([*offsets.T, one.link, *one.stroke.T]))
            wanted = chosen(one, of)
            halves = _halves(None if wanted is None else frozenset(wanted))
            signs.append(halves[0])
            tables.append(halves[1])
        self.limbs = np.concatenate(limbs, axis=1)
        self.signs, self.table = np.concatenate(signs), np.stack(tables)
        wx, wy, wz, link, _, high = self.limbs
        self.size = float((link + high).max())
        self.origin = np.array([wy.mean(), wz.mean()])
        first, last = float((wx - high).max()), float((wx + high).min())
        low_y, high_y = float((wy - link).max()), float((wy + link).min())
        low_z, high_z = float((wz - high - link).max()), float((wz + high + link).min())
        none = (
            first >= last or low_y >= high_y or low_z >= high_z or not self.table.any(axis=1).all()
        )
        self.range = (first, first) if none else (first, last)

    def heights(self, x: Array) -> tuple[Array, Array]:
        """S(ρ_min) and S(ρ_max) of each limb at x (N,), (N, 5) each; −1 out of reach."""
        wx, low, high = self.limbs[0], self.limbs[4], self.limbs[5]
        apart = np.abs(x[:, None] - wx)
        lows = np.sqrt(np.maximum((low - apart) * (low + apart), 0.0))
        highs = np.sqrt(np.maximum((high - apart) * (high + apart), 0.0))
        return lows, np.where(apart > high, -1.0, highs)

    def cut(self, x: Array) -> Cuts:
        """The sections at x (N,)."""
        x = np.asarray(x, dtype=float)
        count = len(x)
        moments, marks = np.empty((count, 6)), np.empty(count, np.int64)
        machine = self.limbs, self.signs, self.table, self.size, self.origin
        acceleration.call("measure", x, *self.heights(x), *machine, moments, marks)
        return Cuts(x, moments[:, :3], marks)

    def runs(self, x: Array) -> Runs:
        """The sections at x (N,) in runs."""
        count = len(x)
        lows, highs = self.heights(x)
        machine = self.limbs, self.signs, self.table, self.size
        firsts, marks = np.empty(count + 1, np.int64), np.empty(count, np.int64)
        room = 64 * count + MOST_RUNS
        while True:
            curves, spans = np.empty((room, 2), np.int64), np.empty((room, 2))
            pieces, tells = np.empty(room, np.int64), np.empty(room, np.int64)
            out = firsts, curves, spans, pieces, tells, marks
            used = acceleration.call("runs_of", x, lows, highs, *machine, *out)
            if used >= 0:
                break
            room *= 4
        return Runs.of(
            self.limbs,
            x,
            lows,
            highs,
            firsts,
            curves[:used].copy(),
            spans[:used].copy(),
            pieces[:used].copy(),
            tells[:used].copy(),
            marks,
        )

    def integral(self, first: float, last: float, relative: float, most: int) -> Integral:
        """Sections that tell the volume between two x', first < last.

        Args:
            relative: the error wanted, as a part of the volume.
            most: about how many sections are taken at most; while the kernel is not compiled, a
                sixth of them.
        """
        if not acceleration.is_compiled():
            most //= 6
        machine = self.limbs, self.signs, self.table, self.size, self.origin
        at, moments, marks, weights, error, sections = acceleration.call(
            "integral", first, last, *machine, relative, most
        )
        order = np.argsort(at)
        return Integral(
            at[order], moments[order], marks[order], weights[order], float(error), int(sections)
        )

    def outline(self, x: float) -> Outline:
        """The boundary of the section at x, and its moments."""
        n = self.limbs.shape[1]
        low, high, moments = np.empty(n), np.empty(n), np.empty(6)
        room = _MOST_EDGES
        edges, ends, turns = np.empty((room, 4), np.int64), np.empty((room, 2)), np.empty(room)
        machine = self.limbs, self.signs, self.table, self.size
        count = acceleration.call(
            "outline", x, low, high, *machine, edges, ends, turns, self.origin, moments
        )
        whose, places = np.empty((count, 2), np.int64), np.empty((count, 8))
        firsts, areas = np.empty(count + 1, np.int64), np.empty(count + 1)
        pieces = np.empty(count + 1, np.int64)
        loops, perimeter = acceleration.call(
            "describe",
            edges[:count],
            ends[:count],
            turns[:count],
            self.limbs,
            low,
            high,
            whose,
            places,
            firsts,
            areas,
            pieces,
        )
        return Outline(
            low,
            high,
            whose,
            places,
            firsts[: loops + 1],
            areas[:loops],
            pieces[:loops],
            perimeter,
            moments,
        )

    def pieces(self, x: Array, weights: Array) -> Array:
        """The integrals of the connected pieces' areas, largest first (P,).

        Args:
            x: (N,) increasing.
            weights: (N, 2) of the areas and of their derivatives.
        """
        sums = volumes(self.runs, self.limbs, x, weights)
        # Derivatives take more than there is from what hardly one section met.
        whole = sums.sum(axis=1)
        whole = np.where(whole > 0.0, whole, sums[:, 0])
        return np.asarray(np.sort(whole)[::-1])

    def strokes(self, x: Array, samples: int) -> tuple[Array, Array]:
        """The shortest and the longest actuators (5,) each that occur in sections at x (N,), from
        so many points on each edge of their boundaries."""
        runs = self.runs(x)
        share = np.linspace(0.0, 1.0, samples)
        y = runs.spans[:, :1] + share * (runs.spans[:, 1:] - runs.spans[:, :1])
        c = np.repeat(runs.curves.T.ravel(), samples)
        section = np.repeat(np.tile(runs.sections, 2), samples)
        y = np.tile(y.ravel(), 2)
        z = curve_heights(self.limbs, c, np.repeat(runs.bases.T.ravel(), samples), y)
        wx, wy, wz, link, _, _ = self.limbs
        t = y[:, None] - wy
        rise = np.sqrt(np.maximum((link - t) * (link + t), 0.0))
        dz = (z[:, None] - wz)[:, :, None] - np.stack([rise, -rise], axis=-1)  # (P, 5, 2)
        rho = np.hypot((x[section, None] - wx)[:, :, None], dz)
        slack = 1e-7 * self.size
        low, high = runs.lows[section, :, None], runs.highs[section, :, None]
        held = (np.abs(dz) >= low - slack) & (np.abs(dz) <= high + slack)
        n = self.limbs.shape[1]
        bits = 1 << np.arange(2 * n)
        state = held.reshape(-1, 2 * n) @ bits
        # Some wanted mode must hold the point with the limb in this sign.
        other = bits.reshape(n, 2)[:, ::-1]
        held &= holds(self.table, state[:, None, None] & ~other)
        return (
            np.where(held, rho, np.inf).min(axis=(0, 2), initial=np.inf),
            np.where(held, rho, -np.inf).max(axis=(0, 2), initial=-np.inf),
        )


def prepare(*, here: bool = True) -> bool:
    """Compile all that sections are made with, see `acceleration.prepare`."""
    return acceleration.prepare(_exercise, here=here)


def _exercise() -> None:
    cutter = example()
    x = np.linspace(*cutter.range, 3)
    cutter.cut(x)
    cutter.runs(x)
    cutter.outline(float(x[1]))
    cutter.integral(*cutter.range, 0.5, 60)


def example() -> Cutter:
    """A small machine with something of everything in its sections."""
    one, two, three, four, five = (
        Limb((10.0 * i, 2.0 * i * i, 0.0), (3.0, -2.0 * i, 1.0), 30.0, (40.0, 70.0))
        for i in range(LIMBS)
    )
    return Cutter(FiveRPURDesign((one, two, three, four, five)), 0.1, -0.2, None)


@lru_cache(maxsize=64)
def _halves(modes: frozenset[str] | None) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which signs each limb may have, (5, 2), and which states are inside, (4^5,)."""
    states = np.arange(4**LIMBS)
    if modes is None:
        signs = np.ones((LIMBS, 2), dtype=bool)
        pairs = states[:, None] >> (2 * np.arange(LIMBS)) & 3
        table = np.asarray((pairs > 0).all(axis=1))
    else:
        signs = np.zeros((LIMBS, 2), dtype=bool)
        table = np.zeros(4**LIMBS, dtype=bool)
        for mode in modes:
            wanted = 0
            for i, sign in enumerate(mode):
                signs[i, int(sign == "-")] = True
                wanted |= 1 << (2 * i + int(sign == "-"))
            table |= states & wanted == wanted
    signs.setflags(write=False)
    table.setflags(write=False)
    return signs, table
