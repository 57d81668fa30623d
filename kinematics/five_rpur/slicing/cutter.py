"""Sections of one orientation in batches: the machine as the kernel takes it.

Lengths mm, angles rad.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from kinematics.errors import InputError
from kinematics.five_rpur.design import LIMBS, FiveRPURDesign, Limb
from kinematics.five_rpur.offsets import SAME_NUMBERS, aligned_offsets
from kinematics.five_rpur.slicing import acceleration
from kinematics.sections import Ints
from kinematics.spatial import Array

_MOST_EDGES = 4096  # of one section; twice what crossings of five limbs can make


@dataclass(frozen=True, eq=False)
class Cuts:
    """Sections at ``at`` (N,): ``moments`` (N, 3) of 1, v, w about the origin,
    ``marks`` (N,) equal where sections are built alike, ``parts`` (N,) connected pieces.
    """

    at: Array
    moments: Array
    marks: NDArray[np.int64]
    parts: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Outline:
    """A section's boundary: ``low`` and ``high`` (5,) are S(ρ_min) and S(ρ_max), ``moments`` (6,)
    of 1, v, w, v², w², vw about the origin, the rest as `kernel.describe` has it.
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

    Attributes:
        limbs: (6, 5) rows w'_x, w'_y, w'_z (eq. 27), l, ρ_min, ρ_max.
        signs: (5, 2) whether any wanted mode has limb i in + and in −.
        table: (1024,) whether a point is inside that lies in the halves whose bits are set.
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
    ) -> None:
        offsets = aligned_offsets(design, phi, theta, SAME_NUMBERS)
        self.limbs = np.array([*offsets.T, design.link, *design.stroke.T])
        self.signs, self.table = _halves(None if modes is None else frozenset(modes))
        wx, wy, wz, link, _, high = self.limbs
        self.size = float((link + high).max())
        self.origin = np.array([wy.mean(), wz.mean()])
        first, last = float((wx - high).max()), float((wx + high).min())
        low_y, high_y = float((wy - link).max()), float((wy + link).min())
        low_z, high_z = float((wz - high - link).max()), float((wz + high + link).min())
        none = first >= last or low_y >= high_y or low_z >= high_z or not self.signs.any()
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
        return self._measure(x, *self.heights(x))

    def hull(self, x0: Array, x1: Array) -> Cuts:
        """Sections that hold all sections between ``x0`` and ``x1`` (N,), both included."""
        wx = self.limbs[0]
        lows0, highs0 = self.heights(x0)
        lows1, highs1 = self.heights(x1)
        passes = (x0[:, None] <= wx) & (wx <= x1[:, None])  # S is largest at w'_x
        highs = np.where(passes, self.limbs[5], np.maximum(highs0, highs1))
        return self._measure(x0, np.minimum(lows0, lows1), highs)

    def outline(self, x: float) -> Outline:
        """The boundary of the section at x, and its moments."""
        low, high, moments = np.empty(LIMBS), np.empty(LIMBS), np.empty(6)
        room = _MOST_EDGES
        edges, ends, turns = np.empty((room, 4), np.int64), np.empty((room, 2)), np.empty(room)
        with _working(1) as kernel:
            count = kernel.outline(
                x,
                low,
                high,
                self.limbs,
                self.signs,
                self.table,
                self.size,
                edges,
                ends,
                turns,
                self.origin,
                moments,
            )
            whose, places = np.empty((count, 2), np.int64), np.empty((count, 8))
            firsts, areas = np.empty(count + 1, np.int64), np.empty(count + 1)
            pieces = np.empty(count + 1, np.int64)
            loops, perimeter = kernel.describe(
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

    def pieces(self, x: Array, weights: Array, marks: NDArray[np.int64]) -> Array:
        """Weighted areas of sections at increasing x (N,), summed by connected pieces.

        ``marks`` (N,) of the sections tell where there is nothing. Returns (P,), largest first.
        """
        lows, highs = self.heights(x)
        room = 16 * len(x) + 64
        while True:
            forest, volumes = np.empty(room, np.int64), np.empty(room)
            with _working(len(x)) as kernel:
                used = kernel.trace(
                    lows,
                    highs,
                    weights,
                    marks,
                    self.limbs,
                    self.signs,
                    self.table,
                    self.size,
                    forest,
                    volumes,
                )
            if used >= 0:
                break
            room *= 4
        for n in range(used):  # every one points below itself
            forest[n] = forest[forest[n]]
        sums = np.bincount(forest[:used], weights=volumes[:used], minlength=1)
        return np.asarray(np.sort(sums[np.unique(forest[:used])])[::-1]) if used else np.empty(0)

    def strokes(self, x: Array, samples: int) -> tuple[Array, Array]:
        """The shortest and the longest actuators (5,) each that occur in sections at x (N,)."""
        lows, highs = self.heights(x)
        low_used, high_used = np.full(LIMBS, np.inf), np.full(LIMBS, -np.inf)
        with _working(x.size) as kernel:
            kernel.strokes(
                lows,
                highs,
                self.limbs,
                x,
                self.signs,
                self.table,
                self.size,
                samples,
                low_used,
                high_used,
            )
        return low_used, high_used

    def _measure(self, x: Array, lows: Array, highs: Array) -> Cuts:
        count = len(x)
        moments = np.empty((count, 3))
        marks, parts = np.empty(count, np.int64), np.empty(count, np.int64)
        with _working(count) as kernel:
            kernel.measure(
                lows,
                highs,
                self.limbs,
                self.signs,
                self.table,
                self.size,
                self.origin,
                moments,
                marks,
                parts,
            )
        return Cuts(x, moments, marks, parts)


@contextmanager
def _working(sections: int) -> Iterator[ModuleType]:
    """The kernel for so many sections; plain Python's time is counted."""
    kernel = acceleration.kernel(sections)
    if acceleration.is_compiled():
        yield kernel
        return
    begun = time.perf_counter()
    yield kernel
    acceleration.spent(time.perf_counter() - begun)


def example() -> Cutter:
    """A small machine with something of everything in its sections."""
    one, two, three, four, five = (
        Limb((10.0 * i, 5.0 * i * i, 0.0), (3.0, -2.0 * i, 1.0), 30.0, (40.0, 70.0))
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
            if len(mode) != LIMBS or set(mode) - set("+-"):
                raise InputError(
                    f"a working mode is {LIMBS} signs such as '+-+++', one a limb, got {mode!r}"
                )
            wanted = 0
            for i, sign in enumerate(mode):
                signs[i, int(sign == "-")] = True
                wanted |= 1 << (2 * i + int(sign == "-"))
            table |= states & wanted == wanted
    signs.setflags(write=False)
    table.setflags(write=False)
    return signs, table
