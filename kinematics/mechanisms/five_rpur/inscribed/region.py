"""The constant-orientation workspace as a formula of ten sets, and the surfaces that bound it.

In the plane y = const a limb's vertex space in mode σ is an annulus ρ_min … ρ_max about
w_i + σ h(y) n, with w_i = r_i − Q s'_i, n the z' axis and h = sqrt(l² − (y − y_i)²) (Tale
Masouleh et al. 2011, eqs. 26-27, here not turned back to x'y'z'). The workspace of a set of
modes is a monotone formula of these ten sets; their tubes and the curves in which two tubes meet
bound it. Base frame; lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import LIMBS, MODES, FiveRPURDesign
from kinematics.mechanisms.five_rpur.offsets import SAME_SOLIDS, aligned_offsets
from kinematics.screws.spatial import rotation_y

Ints = NDArray[np.integer[Any]]
Mask = NDArray[np.bool_]

DETAIL = 96  # points along each tube; four times as many where curves are sought
ROUNDS = 8  # each makes what is found between points eight times as sharp
SETS = 2 * LIMBS
"""Set 2 i is limb i + 1 in mode +, set 2 i + 1 the same limb in mode −."""
SIGN = np.array([1.0, -1.0] * LIMBS)
LIMB = np.arange(SETS) // 2
_STRICT = 1e-9  # part of the machine's size by which a set must cover a point to count


def _split(points: Array) -> tuple[Array, Array, Array]:
    return points[..., 0], points[..., 1], points[..., 2]


# --- which sets make a region ------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Formula:
    """Which sets must hold a point for it to be in the region.

    Attributes:
        table: (1024,) the answer by the bit code of the sets that hold the point.
        used: (S,) the sets that matter.
        pairs: those of which, somewhere, either one alone makes a point inside.
    """

    table: Mask
    used: Ints
    pairs: tuple[tuple[int, int], ...]


@lru_cache(maxsize=64)
def formula(modes: tuple[str, ...] | None) -> Formula:
    """The union over working modes (None: all 32) of the intersections of their sets.

    Raises:
        InputError: a mode is not five signs.
    """
    codes = np.arange(1 << SETS)
    table = np.zeros(len(codes), dtype=bool)
    for mode in MODES if modes is None else modes:
        need = sum(1 << (2 * i + int(sign < 0)) for i, sign in enumerate(inverse.signs(mode)))
        table |= (codes & need) == need
    used = [k for k in range(SETS) if (table[codes | 1 << k] & ~table[codes & ~(1 << k)]).any()]
    pairs = []
    for a, b in combinations(used, 2):
        rest = codes[(codes & (1 << a | 1 << b)) == 0]
        if (~table[rest] & table[rest | 1 << a] & table[rest | 1 << b]).any():
            pairs.append((a, b))
    return Formula(table, np.array(used, dtype=np.intp), tuple(pairs))


@dataclass(frozen=True, eq=False)
class Region:
    """The workspace at one orientation for some modes, ready for questions of distance.

    Attributes:
        offset: (5, 3) w_i = r_i − Q s'_i in the base frame.
        link: (5,).
        stroke: (5, 2).
        lean: (2,) the z' axis in the x-z plane.
        formula: what makes a point inside.
    """

    offset: Array
    link: Array
    stroke: Array
    lean: Array
    formula: Formula

    @classmethod
    def at(
        cls,
        design: FiveRPURDesign,
        phi: float,
        theta: float,
        modes: tuple[str, ...] | None,
    ) -> Region:
        offset = aligned_offsets(design, phi, theta, SAME_SOLIDS)
        turn = rotation_y(theta)
        offset = offset @ turn.T
        chosen = formula(inverse.chosen(design, modes))
        return cls(offset, design.link, design.stroke, turn[[0, 2], 2], chosen)

    @cached_property
    def size(self) -> float:
        """A typical length of the machine, mm."""
        return float((self.link + self.stroke[:, 1]).max())

    @property
    def used(self) -> Ints:
        return self.formula.used

    @cached_property
    def span(self) -> tuple[float, float]:
        """Where every limb can close: the least and the greatest y; the region lies between."""
        y = self.offset[:, 1]
        return float((y - self.link).max()), float((y + self.link).min())

    @cached_property
    def bounds(self) -> tuple[Array, Array] | None:
        """Corners (3,) of a box about the region; None where that shows it to be empty."""
        if not self.used.size or not self.span[0] < self.span[1]:
            return None
        low, high = np.full(3, -np.inf), np.full(3, np.inf)
        low[1], high[1] = self.span
        for limb in range(LIMBS):
            signs = SIGN[self.used[LIMB[self.used] == limb]]
            heights = self._heights_between(limb, *self.span)
            shift = np.array([s * h for s in signs for h in heights])
            for axis, lean in zip((0, 2), self.lean, strict=True):
                reach = self.offset[limb, axis] + shift * lean
                low[axis] = max(low[axis], reach.min() - self.stroke[limb, 1])
                high[axis] = min(high[axis], reach.max() + self.stroke[limb, 1])
        return (low, high) if (low < high).all() else None

    def _heights_between(self, limb: int, low: float, high: float) -> tuple[float, float]:
        y, link = self.offset[limb, 1], self.link[limb]
        ends = np.sqrt(np.maximum(link**2 - (np.array([low, high]) - y) ** 2, 0.0))
        return float(ends.min()), float(link if low <= y <= high else ends.max())

    # --- membership

    def covering(
        self, x: Array, y: Array, z: Array, margin: float = 0.0, half: Array | None = None
    ) -> Ints:
        """Bit codes of the sets that hold points, each by more than ``margin``; broadcasts.

        With ``half`` (3,), half the sides of a cell about each point: of all sets that may hold
        anything of the cell; none other does.
        """
        hx, hy, hz = (0.0, 0.0, 0.0) if half is None else half
        code = np.zeros(np.broadcast_shapes(x.shape, y.shape, z.shape), dtype=np.uint16)
        for limb in np.unique(LIMB[self.used]):
            (x0, y0, z0), link = self.offset[limb], self.link[limb]
            nearest = np.abs(y - y0)
            bottom = np.sqrt(np.maximum(link**2 - (nearest + hy) ** 2, 0.0))
            nearest = np.maximum(nearest - hy, 0.0)
            top = np.sqrt(np.maximum(link**2 - nearest**2, 0.0))
            h, spread = 0.5 * (top + bottom), 0.5 * (top - bottom) + np.hypot(hx, hz) - margin
            low, high = self.stroke[limb]
            near = np.where((low > spread) & (low > 0.0), low - spread, -1.0)
            near = np.where(nearest < link, np.sign(near) * near**2, np.inf)
            far = np.maximum(high + spread, 0.0) ** 2
            for k in self.used[LIMB[self.used] == limb]:
                across = (x - x0 - SIGN[k] * self.lean[0] * h) ** 2
                square = across + (z - z0 - SIGN[k] * self.lean[1] * h) ** 2
                code |= ((square > near) & (square < far)).astype(np.uint16) << np.uint16(k)
        return code

    def inside(self, points: Array, half: Array | None = None) -> Mask:
        """Whether points (..., 3) lie inside the region; of cells, whether anything may."""
        return np.asarray(self.formula.table[self.covering(*_split(points), half=half)])

    def uncovered(self, points: Array, own: Ints) -> Mask:
        """Whether points on surfaces of the sets in the bit codes ``own`` bound the region."""
        code = self.covering(*_split(points), margin=_STRICT * self.size)
        return np.asarray(~self.formula.table[code & ~own])

    def nodes(self, axes: Sequence[Array], half: Array | None = None) -> Mask:
        """`inside` of a grid with the given x, y and z, (nx, ny, nz)."""
        x, y, z = axes
        code = self.covering(x[:, None, None], y[None, :, None], z[None, None, :], half=half)
        return np.asarray(self.formula.table[code])

    # --- tubes

    @cached_property
    def tubes(self) -> tuple[Ints, Array, Mask]:
        """Set, radius and whether it is the outer one, of every tube, each (T,)."""
        rows = [(k, r, n == 1) for k in self.used for n, r in enumerate(self.stroke[LIMB[k]])]
        kept = [row for row in rows if row[1] > 0.0]
        return (
            np.array([k for k, _, _ in kept], dtype=np.intp),
            np.array([r for _, r, _ in kept], dtype=float),
            np.array([outer for _, _, outer in kept], dtype=bool),
        )

    def axis(self, sets: Ints, beta: Array) -> tuple[Array, Array, Array]:
        """x, y, z of the centre of sets' annuli at y = y_i + l cos β, as broadcast."""
        limb = LIMB[sets]
        shift = SIGN[sets] * self.link[limb] * np.sin(beta)
        return (
            self.offset[limb, 0] + shift * self.lean[0],
            self.offset[limb, 1] + self.link[limb] * np.cos(beta),
            self.offset[limb, 2] + shift * self.lean[1],
        )

    @cached_property
    def angles(self) -> Array:
        """β (5, D) at which a limb's tubes are sampled: those within `span`."""
        inner = np.clip((np.array(self.span) - self.offset[:, 1:2]) / self.link[:, None], -1, 1)
        ends = np.arccos(inner)
        return ends[:, 1:] + (ends[:, :1] - ends[:, 1:]) * np.linspace(0.0, 1.0, DETAIL)

    # --- curves where two tubes meet

    @cached_property
    def curves(self) -> Curves:
        """The pieces of curves at which the region is notched."""
        return Curves.of(self)


@dataclass(frozen=True, eq=False)
class Curves:
    """Pieces of curves where tubes of two sets meet, outside of all that would cover them.

    A whole curve runs over ``turn`` and a piece over s, both in [0, π] and both slow towards their
    ends: there a link may be at its reach, or the circles only touch, and points run fast.

    Attributes:
        pair: (P, 2) sets.
        radius: (P, 2) mm.
        side: (P,) ±1, which of the two points of the circles.
        reach: (P, 2) the part of `turn` that the piece takes up.
    """

    region: Region
    pair: Ints
    radius: Array
    side: Array
    reach: Array

    @classmethod
    def of(cls, region: Region) -> Curves:
        rows = []
        for a, b in region.formula.pairs:
            for ra, rb in product(region.stroke[LIMB[a]], region.stroke[LIMB[b]]):
                if ra > 0.0 and rb > 0.0:
                    rows += [(a, b, ra, rb, side) for side in (1.0, -1.0)]
        table = np.array(rows).reshape(-1, 5)
        if not rows:
            return cls(
                region, table[:, :2].astype(np.intp), table[:, 2:4], table[:, 4], table[:, :2]
            )
        everywhere = np.tile([0.0, np.pi], (len(table), 1))
        pair = table[:, :2].astype(np.intp)
        all_ = cls(region, pair, table[:, 2:4], table[:, 4], everywhere)
        count = 4 * DETAIL
        evenly = np.linspace(0.0, np.pi, count)
        turn = np.broadcast_to(evenly, (len(table), count))
        kept = all_._kept(np.arange(len(table)), turn)
        padded = np.zeros((len(table), count + 2), dtype=bool)
        padded[:, 1:-1] = kept
        which, first = np.nonzero(padded[:, 1:-1] & ~padded[:, :-2])
        _, last = np.nonzero(padded[:, 1:-1] & ~padded[:, 2:])
        before, after = np.maximum(first - 1, 0), np.minimum(last + 1, count - 1)
        ends = [
            all_._end(which, evenly[kept_at], evenly[lost_at])
            for kept_at, lost_at in ((first, before), (last, after))
        ]
        reach = np.stack(ends, axis=-1)
        return cls(region, pair[which], table[which, 2:4], table[which, 4], reach)

    def _end(self, which: Ints, kept: Array, lost: Array) -> Array:
        """Where a curve stops being kept between a parameter that is and one that is not."""
        split = np.linspace(0.0, 1.0, 17)
        for _ in range(ROUNDS + 2):
            t = kept[:, None] + (lost - kept)[:, None] * split
            ok = self._kept(which, t)
            ok[:, 0] = True
            count = np.argmin(np.concatenate([ok, np.zeros((len(ok), 1), bool)], axis=1), axis=1)
            rows = np.arange(len(t))
            kept, lost = t[rows, count - 1], t[rows, np.minimum(count, 16)]
        return kept

    def _kept(self, which: Ints, turn: Array) -> Mask:
        points, kept = self._meet(which[:, None], turn)
        # Where neither set of a limb counts nothing covers; other pairs are looked up.
        pair = self.pair[which]
        check = kept & (LIMB[pair[:, 0]] != LIMB[pair[:, 1]])[:, None]
        if check.any():
            own = np.broadcast_to(((1 << pair[:, 0]) | (1 << pair[:, 1]))[:, None], check.shape)
            kept[check] = self.region.uncovered(points[check], own[check])
        return kept

    def _meet(self, which: Ints, turn: Array) -> tuple[Array, Mask]:
        """Points (..., 3) of whole curves at y = middle − half cos(turn), and where they exist."""
        region = self.region
        a, b = self.pair[which, 0], self.pair[which, 1]
        ra, rb = self.radius[which, 0], self.radius[which, 1]
        low, high = region.span
        y = low + (high - low) * np.sin(0.5 * turn) ** 2
        ha, hb = (self._height(k, y) for k in (a, b))
        dx, dz = (
            region.offset[LIMB[b], axis] - region.offset[LIMB[a], axis] + (hb - ha) * lean
            for axis, lean in zip((0, 2), region.lean, strict=True)
        )
        apart = np.hypot(dx, dz)
        safe = np.where(apart > 1e-12 * region.size, apart, np.inf)
        along = 0.5 * (apart + (ra - rb) * (ra + rb) / safe)
        square = (ra - along) * (ra + along)
        # Circles that touch may be a rounding short of it.
        exists = np.isfinite(safe) & (square >= -1e-12 * ra * ra)
        across = self.side[which] * np.sqrt(np.maximum(square, 0.0))
        ux, uz = dx / safe, dz / safe
        points = np.empty((*np.broadcast_shapes(y.shape, across.shape), 3))
        points[..., 0] = region.offset[LIMB[a], 0] + ha * region.lean[0] + along * ux - across * uz
        points[..., 1] = y
        points[..., 2] = region.offset[LIMB[a], 2] + ha * region.lean[1] + along * uz + across * ux
        return points, exists

    def _height(self, k: Ints, y: Array) -> Array:
        link, dy = self.region.link[LIMB[k]], y - self.region.offset[LIMB[k], 1]
        return np.asarray(SIGN[k] * np.sqrt(np.maximum((link - dy) * (link + dy), 0.0)))

    def at(self, which: Ints, s: Array) -> Array:
        """Points (..., 3) of pieces at s in [0, π]."""
        first, last = self.reach[which, 0], self.reach[which, 1]
        points, _ = self._meet(which, first + (last - first) * np.sin(0.5 * s) ** 2)
        return points

    @cached_property
    def points(self) -> Array:
        """Samples (P, N, 3), s evenly spaced."""
        s = np.linspace(0.0, np.pi, DETAIL)
        which = np.arange(len(self.pair))
        return self.at(which[:, None], np.broadcast_to(s, (len(which), len(s))))

    @cached_property
    def gaps(self) -> Array:
        """The longest distance (P,) between samples of a piece next to each other."""
        steps = np.diff(self.points, axis=1)
        return np.asarray(np.sqrt(np.einsum("pnk,pnk->pn", steps, steps).max(axis=1)))
