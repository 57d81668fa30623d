"""Solids known by their columns: over every point of a plane base, exactly what is in them.

Where limb i keeps a point between two lengths, lo ≤ hypot(P, v + λ) ≤ hi with P and λ functions of
two base coordinates, the third coordinate v is in an interval without a hole. A column is the
intersection of these over all limbs: some intervals, exact but for rounding. A polynomial in v may
part them by its sign. With the limbs' ranges widened by what P and λ can change over a cell of the
base, an empty column proves that nothing of the solid is over that cell.

So a volume is an integral over the base that cannot miss anything: cells are dropped where they are
proven empty, and halved where not enough is known. Lengths mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.solids.roots import crossings, signs

Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]
Span = tuple[float, float]

ROOT = -1
"""The label of a boundary where the polynomial vanishes; see `Layers`."""

_SAME = 1e-13  # part of the largest length: thinner layers are rounding


class Columned(Protocol):
    """A solid by its columns. Base points are (N, 2), in whatever unit suits the base.

    Attributes:
        low, high: (L,) mm, the limbs' ranges.
        base: the spans of both base coordinates, which hold the whole solid.
        closed: the second coordinate is an angle that returns after its span.
        pole: where the first one begins, the second does not matter.
        tear: where along the first coordinate all of a column falls on one place, if anywhere.
    """

    @property
    def low(self) -> Array: ...
    @property
    def high(self) -> Array: ...
    @property
    def base(self) -> tuple[Span, Span]: ...
    @property
    def closed(self) -> bool: ...
    @property
    def pole(self) -> bool: ...
    @property
    def tear(self) -> float | None: ...

    def limbs(self, at: Array) -> tuple[Array, Array]:
        """P and λ, (N, L) mm each."""
        ...

    def spread(self, at: Array, half: Array) -> Array:
        """(N, L) mm: by how much each limb's length changes at most, at the same v, from the
        middle ``at`` of a cell to any other place of it, ``half`` (N, 2) its half sides."""
        ...

    def weight(self, at: Array) -> Array:
        """(N,) the volume that belongs to a unit of base and a mm of v."""
        ...

    def polynomial(self, at: Array) -> Array | None:
        """(N, D + 1) coefficients of what parts the solid, lowest degree first; None: nothing."""
        ...

    def place(self, at: Array, v: Array) -> Array:
        """(N, 3) mm where (N, 2) and v (N,) are."""
        ...


@dataclass(frozen=True, eq=False)
class Layers:
    """Columns from below: boundaries between layers, of which the first and the last are outside.

    Attributes:
        at: (N, M) v of the boundaries, increasing, ∞ where there are no more.
        label: (N, M) which surface it is: 4 i for limb i's low end and 4 i + 2 for its high one,
            + 1 for their upper sides; or `ROOT`.
        above: (N, M) what is above it: 0 outside, ±1 inside with the polynomial's sign.
        count: (N,) how many there are.
    """

    at: Array
    label: NDArray[np.int16]
    above: NDArray[np.int8]
    count: Ints

    def take(self, rows: NDArray[np.intp]) -> Layers:
        return Layers(self.at[rows], self.label[rows], self.above[rows], self.count[rows])

    def below(self) -> NDArray[np.int8]:
        """(N, M) what is below each boundary."""
        found = np.zeros_like(self.above)
        found[:, 1:] = self.above[:, :-1]
        return found


def both(one: Layers, other: Layers) -> Layers:
    """All columns of two."""
    most = max(one.at.shape[1], other.at.shape[1])

    def wide(a: NDArray[np.generic], fill: float) -> NDArray[np.generic]:
        if a.shape[1] == most:
            return a
        return np.pad(a, ((0, 0), (0, most - a.shape[1])), constant_values=fill)

    return Layers(
        np.concatenate([wide(one.at, np.inf), wide(other.at, np.inf)]),
        np.concatenate([wide(one.label, 0), wide(other.label, 0)]),
        np.concatenate([wide(one.above, 0), wide(other.above, 0)]),
        np.concatenate([one.count, other.count]),
    )


# --- columns -------------------------------------------------------------------------------------


def _reaches(solid: Columned, at: Array, slack: Array | float) -> tuple[Array, ...]:
    """What each limb leaves of columns, (N, L) each: lowest and highest v, and the floor and the
    roof of the hole between, ∞ where it has none. The highest is −∞ where it leaves nothing."""
    p, lift = solid.limbs(at)
    p = np.abs(p)
    low, high = solid.low - slack, solid.high + slack
    wide = (high - p) * (high + p)
    half = np.sqrt(np.maximum(wide, 0.0))
    highest = np.where(wide < 0.0, -np.inf, half - lift)
    hole = (low - p) * (low + p)
    has = (hole > 0.0) & (low > 0.0)
    inner = np.sqrt(np.maximum(hole, 0.0))
    floor, roof = np.where(has, -inner - lift, np.inf), np.where(has, inner - lift, np.inf)
    return -half - lift, highest, floor, roof


def lengths(solid: Columned, at: Array, slack: Array | float = 0.0) -> Array:
    """(N,) mm of the columns that are inside, the limbs' ranges widened by ``slack`` mm."""
    lowest, highest, floor, roof = _reaches(solid, at, slack)
    begin, end = lowest.max(axis=1), highest.min(axis=1)
    order = np.argsort(floor, axis=1)
    roof = np.take_along_axis(roof, order, axis=1)
    floor = np.minimum(np.take_along_axis(floor, order, axis=1), end[:, None])
    found: Array = np.maximum(floor[:, 0] - begin, 0.0)
    for k in range(roof.shape[1]):  # holes from below, of which one may reach beyond the next
        begin = np.maximum(begin, roof[:, k])
        after = floor[:, k + 1] if k + 1 < roof.shape[1] else end
        with np.errstate(invalid="ignore"):
            found += np.maximum(np.minimum(after, end) - begin, 0.0)
    return found


def _intervals(solid: Columned, at: Array) -> tuple[Array, Array, Ints, Ints]:
    """The intervals of columns, begins and ends (N, L + 1), and the labels of both.

    An interval is there where its end is above its begin; ∞ begins are none.
    """
    lowest, highest, floor, roof = _reaches(solid, at, 0.0)
    count, rows = lowest.shape[1], np.arange(len(at))
    limb = 4 * np.arange(count)
    lower, upper = lowest.argmax(axis=1), highest.argmin(axis=1)
    begin, end = lowest[rows, lower], highest[rows, upper]
    order = np.argsort(floor, axis=1)
    floor = np.take_along_axis(floor, order, axis=1)
    roof = np.take_along_axis(roof, order, axis=1)
    # Holes from below, of which one may reach beyond the next.
    highest = np.maximum.accumulate(roof, axis=1)
    owner = order.copy()
    for k in range(1, count):
        stays = roof[:, k] < highest[:, k]
        owner[stays, k] = owner[stays, k - 1]
    begins = np.concatenate([begin[:, None], np.maximum(highest, begin[:, None])], axis=1)
    ends = np.concatenate([floor, np.full((len(at), 1), np.inf)], axis=1)
    first = np.concatenate([limb[lower][:, None] + 2, limb[owner] + 1], axis=1)
    first = np.where(begins == begin[:, None], first[:, :1], first)
    last = np.concatenate([limb[order], np.zeros((len(at), 1), dtype=np.int64)], axis=1)
    last = np.where(ends >= end[:, None], limb[upper][:, None] + 3, last)
    return begins, np.minimum(ends, end[:, None]), first, last


def surface_of(label: NDArray[np.int16]) -> tuple[Ints, Mask]:
    """Of labels (N,): the limb, counted from 0, negative where it is none; whether its high end."""
    return label.astype(np.int64) // 4, (label // 2) % 2 == 1


def sheets(solid: Columned, at: Array, label: NDArray[np.int16]) -> Array:
    """(N,) v of a limb's surfaces, one for each base point; NaN where a surface is not there."""
    p, lift = solid.limbs(at)
    rows, limb = np.arange(len(at)), label // 4
    bound = np.where((label // 2) % 2 == 1, solid.high[limb], solid.low[limb])
    with np.errstate(invalid="ignore"):
        half = np.sqrt((bound - p[rows, limb]) * (bound + p[rows, limb]))
    return np.asarray(np.where(label % 2 == 1, half, -half) - lift[rows, limb])


def layers(solid: Columned, at: Array) -> Layers:
    """The columns over base points (N, 2)."""
    begins, ends, first, last = _intervals(solid, at)
    there = ends > begins + _SAME * float(solid.high.max())
    some = np.flatnonzero(there.any(axis=1))
    if not len(some):
        none = np.zeros((len(at), 0))
        return Layers(
            none, none.astype(np.int16), none.astype(np.int8), np.zeros(len(at), dtype=np.int64)
        )
    # No more than there is: few columns have as many intervals as there may be.
    there = there[some]
    order = _those(there)
    there = np.take_along_axis(there, order, axis=1)
    begins, ends = (
        np.where(there, np.take_along_axis(a[some], order, axis=1), np.inf) for a in (begins, ends)
    )
    first, last = (np.take_along_axis(a[some], order, axis=1) for a in (first, last))
    v, label, above = _from_below(solid.polynomial(at[some]), begins, ends, first, last)
    below = np.zeros_like(above)
    below[:, 1:] = above[:, :-1]
    kept = np.isfinite(v) & (above != below)
    order = _those(kept)
    kept, v, label, above = (np.take_along_axis(a, order, axis=1) for a in (kept, v, label, above))
    shape = len(at), order.shape[1]
    found = Layers(
        np.full(shape, np.inf),
        np.zeros(shape, dtype=np.int16),
        np.zeros(shape, dtype=np.int8),
        np.zeros(len(at), dtype=np.int64),
    )
    found.at[some] = np.where(kept, v, np.inf)
    found.label[some], found.above[some] = np.where(kept, label, 0), np.where(kept, above, 0)
    found.count[some] = kept.sum(axis=1)
    return found


def _those(kept: Mask) -> NDArray[np.intp]:
    """(N, M) where in each row the kept ones are, in order, M the most of them; then others."""
    most = int(kept.sum(axis=1).max(initial=0))
    return np.argsort(~kept, axis=1, kind="stable")[:, :most]


def _from_below(
    parting: Array | None, begins: Array, ends: Array, first: Ints, last: Ints
) -> tuple[Array, Ints, NDArray[np.int8]]:
    """All boundaries of columns with intervals (N, K), parted by a polynomial's sign: v, label and
    what is above, (N, M) each; also such as have the same below and above."""
    roots = np.full((len(begins), 0), np.inf)
    if parting is not None:
        high = np.where(np.isfinite(ends), ends, -np.inf).max(axis=1)
        roots = crossings(parting, begins[:, 0], high)
        inside = (roots[:, :, None] > begins[:, None]) & (roots[:, :, None] < ends[:, None])
        roots = np.sort(np.where(inside.any(axis=2), roots, np.inf), axis=1)
        roots = roots[:, : int(np.isfinite(roots).sum(axis=1).max(initial=0))]
    v = np.concatenate([begins, ends, roots], axis=1)
    step = np.repeat([1, -1, 0], [begins.shape[1], ends.shape[1], roots.shape[1]])
    label = np.concatenate([first, last, np.full(roots.shape, ROOT)], axis=1)
    order = np.argsort(v, axis=1, kind="stable")
    v, label = (np.take_along_axis(a, order, axis=1) for a in (v, label))
    real = np.isfinite(v)
    inside = (np.cumsum(np.where(real, step[order], 0), axis=1) > 0) & real
    if parting is None:
        return v, label, inside.astype(np.int8)
    after = np.concatenate([v[:, 1:], np.full((len(v), 1), np.inf)], axis=1)
    middle = np.where(inside, 0.5 * (v + after), 0.0)
    return v, label, np.where(inside, signs(parting, middle), 0).astype(np.int8)
