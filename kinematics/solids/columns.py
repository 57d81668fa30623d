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

Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]
Span = tuple[float, float]

ROOT = -1
"""The label of a boundary where the polynomial vanishes; see `Layers`."""

_NOISE = 1e-12  # part of the sum of its terms' absolute values: a polynomial below is rounding
_SAME = 1e-13  # part of the largest length: thinner layers are rounding
_CLOSE = 1e-14  # of the ends of a bracket: the step of a root that is found
_NEWTON = 60  # steps between two ends that close in, of which few are used


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
    scale = _SAME * float(solid.high.max())
    there = ends > begins + scale
    begins, ends = np.where(there, begins, np.inf), np.where(there, ends, np.inf)
    parting = solid.polynomial(at)
    some = there.any(axis=1)
    low = np.where(some, begins.min(axis=1), 0.0)
    high = np.where(some, np.where(there, ends, -np.inf).max(axis=1), 0.0)
    roots = np.full((len(at), 0), np.inf)
    if parting is not None:
        roots = crossings(parting, low, high)
        inside = (roots[:, :, None] > begins[:, None]) & (roots[:, :, None] < ends[:, None])
        roots = np.where(inside.any(axis=2), roots, np.inf)
    v = np.concatenate([begins, ends, roots], axis=1)
    step = np.concatenate(
        [np.ones_like(first), -np.ones_like(last), np.zeros(roots.shape, dtype=np.int64)], axis=1
    )
    label = np.concatenate([first, last, np.full(roots.shape, ROOT)], axis=1)
    order = np.argsort(v, axis=1, kind="stable")
    v, step, label = (np.take_along_axis(a, order, axis=1) for a in (v, step, label))
    real = np.isfinite(v)
    inside = (np.cumsum(np.where(real, step, 0), axis=1) > 0) & real
    above = inside.astype(np.int8)
    if parting is not None:
        after = np.concatenate([v[:, 1:], np.full((len(v), 1), np.inf)], axis=1)
        middle = np.where(inside, 0.5 * (v + after), 0.0)
        above = np.where(inside, _signs(parting, middle), 0).astype(np.int8)
    below = np.concatenate([np.zeros((len(v), 1), dtype=np.int8), above[:, :-1]], axis=1)
    kept = real & (above != below)
    v = np.where(kept, v, np.inf)
    order = np.argsort(v, axis=1, kind="stable")
    v, label, above = (np.take_along_axis(a, order, axis=1) for a in (v, label, above))
    count = kept.sum(axis=1)
    most = int(count.max(initial=0))
    above = np.where(np.isfinite(v), above, 0).astype(np.int8)
    return Layers(v[:, :most], label[:, :most].astype(np.int16), above[:, :most], count)


# --- polynomials in v ----------------------------------------------------------------------------


def values(coefficients: Array, v: Array) -> Array:
    """Polynomials (N, D + 1) at v (N, M)."""
    found = np.zeros_like(v)
    for k in range(coefficients.shape[1] - 1, -1, -1):
        found = found * v + coefficients[:, k, None]
    return found


def _signs(coefficients: Array, v: Array) -> NDArray[np.int8]:
    """±1 at v (N, M); where it is no more than rounding that of the place before, or +1."""
    value = values(coefficients, v)
    noise = _NOISE * values(np.abs(coefficients), np.abs(v))
    sign = np.where(np.abs(value) <= noise, 0, np.sign(value)).astype(np.int8)
    for k in range(sign.shape[1]):
        before = sign[:, k - 1] if k else np.int8(1)
        sign[:, k] = np.where(sign[:, k] == 0, before, sign[:, k])
    return sign


def crossings(coefficients: Array, low: Array, high: Array) -> Array:
    """Where polynomials (N, D + 1) change their sign between ``low`` and ``high`` (N,).

    Between the places where the derivative does there is one at most: that is bracketed.

    Returns:
        (N, D), ∞ where there is none.
    """
    degree = coefficients.shape[1] - 1
    if degree <= 2:
        return _of_a_square(coefficients, low, high)
    slope = coefficients[:, 1:] * np.arange(1, degree + 1)
    turns = crossings(slope, low, high)
    marks = np.concatenate(
        [low[:, None], np.where(np.isfinite(turns), turns, high[:, None]), high[:, None]], axis=1
    )
    value = values(coefficients, marks)
    found = np.full((len(marks), degree), np.inf)
    row, col = np.nonzero((value[:, :-1] < 0.0) != (value[:, 1:] < 0.0))
    a, b = marks[row, col], marks[row, col + 1]
    fa, fb = value[row, col], value[row, col + 1]
    rising = fb >= 0.0
    # Next to a turn a polynomial is like a square, between two of them like a cube.
    part = fa / (fa - fb)
    after, before = col > 0, col < degree - 1
    start = np.where(after, np.sqrt(part), part)
    start = np.where(before, 1.0 - np.sqrt(1.0 - part), start)
    both = 0.5 - np.sin(np.arcsin(1.0 - 2.0 * part) / 3.0)
    t = a + (b - a) * np.where(after & before, both, start)
    least = _CLOSE * (np.abs(a) + np.abs(b))
    most = np.maximum(np.abs(a), np.abs(b))[:, None]
    noise = 1e-16 * values(np.abs(coefficients[row]), most)[:, 0]
    active = np.arange(len(row))
    for _ in range(_NEWTON):
        if not len(active):
            break
        here, x = row[active], t[active]
        f = values(coefficients[here], x[:, None])[:, 0]
        beneath = (f < 0.0) == rising[active]
        a[active] = np.where(beneath, x, a[active])
        b[active] = np.where(beneath, b[active], x)
        with np.errstate(invalid="ignore", divide="ignore"):
            wanted = x - f / values(slope[here], x[:, None])[:, 0]
        lost = ~((wanted >= a[active]) & (wanted <= b[active]))
        wanted = np.where(lost, 0.5 * (a[active] + b[active]), wanted)
        done = (np.abs(wanted - x) <= least[active]) | (np.abs(f) <= noise[active])
        t[active] = wanted
        active = active[~done]
    found[row, col] = t
    return np.sort(found, axis=1)


def _of_a_square(coefficients: Array, low: Array, high: Array) -> Array:
    """`crossings` of degree two or less."""
    c, b, a = (
        coefficients[:, k] if k < coefficients.shape[1] else np.zeros(len(coefficients))
        for k in range(3)
    )
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        root = np.sqrt(b * b - 4.0 * a * c)
        q = -0.5 * (b + np.where(b < 0.0, -root, root))
        both = np.stack([q / a, c / q], axis=-1)
    both = np.where(np.isnan(both), np.inf, both)
    inside = (both > low[:, None]) & (both < high[:, None]) & (root > 0.0)[:, None]
    return np.sort(np.where(inside, both, np.inf), axis=1)[:, : coefficients.shape[1] - 1]


# --- the volume ----------------------------------------------------------------------------------

_INNER = np.sqrt(0.6)
_GAUSS = _INNER * np.array([(a, b) for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0)])
_SIMPSON = np.delete(_GAUSS / _INNER, 4, axis=0)
_NODES = np.concatenate([_GAUSS, _SIMPSON])
"""Of a cell from −1 to 1: those of Gauss's rule, and of Simpson's but for the middle."""
_CORNERS = _SIMPSON[[0, 2, 5, 7]]
_NINE = np.array([a * b for a in (5.0, 8.0, 5.0) for b in (5.0, 8.0, 5.0)]) / 324.0
_SAFETY = 2.0
"""Of differences between rules: halving the worst cells leaves those that look better than they
are."""


def _differences() -> Array:
    """Between Gauss's rule of nine points and others of degree 3: a cross and a quincunx of its
    own points, and Simpson's, which sees a kink next to a side."""
    found = np.zeros((3, 17))
    found[:, :9] = _NINE
    for rule, nodes, part in ((0, (1, 3, 5, 7), 5.0 / 18.0), (1, (0, 2, 6, 8), 5.0 / 36.0)):
        found[rule, list(nodes)] -= part
        found[rule, 4] -= 1.0 - 4.0 * part
    simpson = np.array([a * b for a in (1.0, 4.0, 1.0) for b in (1.0, 4.0, 1.0)]) / 36.0
    found[2, 4] -= simpson[4]
    found[2, 9:] -= np.delete(simpson, 4)
    return found


_DIFFERENCES = _differences()

_MOST = 600_000
"""Columns: no volume is worth more."""
_FIRST = 8  # cells along each side of the base


@dataclass(frozen=True)
class Measured:
    """The volume of a solid and how far it may be off, mm³; ± 0 is proven."""

    volume: float
    error: float


def measure(solid: Columned, relative: float, most: int = _MOST) -> Measured:
    """The volume by Gauss's rule over cells of the base, halved until the error is small.

    The error is the sum of the cells' differences between two rules, and of all that may be over
    cells in which no column shows anything and which are not proven empty.

    Args:
        relative: the error wanted, as a part of the volume.
        most: columns to look at; then what is known by then is told with its error.
    """
    cells = first_cells(solid, _FIRST)
    spent = 0
    # First whatever shows something, or is proven empty.
    shown: list[tuple[Array, Array]] = []
    middle, half = cells
    while len(middle) and spent < most // 3:
        possible = lengths(solid, middle, solid.spread(middle, half)) > 0.0
        spent += len(middle)
        middle, half = middle[possible], half[possible]
        seen = lengths(solid, middle) > 0.0
        shown.append((middle[seen], half[seen]))
        middle, half = middle[~seen], half[~seen]
        seen_most = sum(float(bounds(solid, *cell).sum()) for cell in shown)
        if float(bounds(solid, middle, half).sum()) <= 0.1 * relative * seen_most:
            break
        middle, half = halved(solid, middle, half)
    middle = np.concatenate([middle, *(cell[0] for cell in shown)])
    half = np.concatenate([half, *(cell[1] for cell in shown)])
    new = middle, half
    middle, half = np.empty((0, 2)), np.empty((0, 2))
    value, doubt, side = np.empty(0), np.empty(0), np.empty(0, dtype=np.int64)
    while True:
        more, unsure, rough = _integrals(solid, *new)
        spent += 18 * len(more)
        kept = (more > 0.0) | (unsure > 0.0)
        middle, half = np.concatenate([middle, new[0][kept]]), np.concatenate([half, new[1][kept]])
        value, doubt = np.append(value, more[kept]), np.append(doubt, unsure[kept])
        side = np.append(side, rough[kept])
        volume, error = float(value.sum()), float(doubt.sum())
        if error <= relative * volume or spent >= most:
            return Measured(volume, error)
        order = np.argsort(-doubt)
        gone = np.cumsum(doubt[order])
        enough = min(0.8 * error, error - 0.5 * relative * volume)
        count = int(np.searchsorted(gone, enough)) + 1
        chosen, rest = order[:count], order[count:]
        new = _cut(middle[chosen], half[chosen], side[chosen])
        middle, half, value, doubt = middle[rest], half[rest], value[rest], doubt[rest]
        side = side[rest]


def first_cells(solid: Columned, count: int) -> tuple[Array, Array]:
    """Cells that tile the base, ``count`` along each side: middles and half sides, (N, 2) each."""
    (x0, x1), (y0, y1) = solid.base
    half = np.array([x1 - x0, y1 - y0]) / (2.0 * count)
    steps = 2.0 * np.arange(count) + 1.0
    x, y = np.meshgrid(x0 + half[0] * steps, y0 + half[1] * steps, indexing="ij")
    return np.stack([x.ravel(), y.ravel()], axis=-1), np.tile(half, (count * count, 1))


def longer_side(solid: Columned, middle: Array, half: Array) -> Ints:
    """(N,) along which side of cells the limbs' lengths change more: 0 or 1."""
    none = np.zeros(len(middle))
    along = [
        solid.spread(middle, np.stack(sides, axis=-1)).max(axis=1)
        for sides in ((half[:, 0], none), (none, half[:, 1]))
    ]
    return np.asarray(along[1] > along[0], dtype=np.int64)


def halved(solid: Columned, middle: Array, half: Array) -> tuple[Array, Array]:
    """Cells cut across the side along which the limbs' lengths change more."""
    return _cut(middle, half, longer_side(solid, middle, half))


def _cut(middle: Array, half: Array, side: Ints) -> tuple[Array, Array]:
    rows = np.arange(len(middle))
    new = half.copy()
    new[rows, side] *= 0.5
    aside = np.zeros_like(middle)
    aside[rows, side] = new[rows, side]
    return np.concatenate([middle - aside, middle + aside]), np.concatenate([new, new])


def bounds(solid: Columned, middle: Array, half: Array) -> Array:
    """(N,) mm³ that there may be over cells at most."""
    corners = [solid.weight(middle + half * corner) for corner in _CORNERS]
    heaviest = np.max([solid.weight(middle), *corners], axis=0)
    slack = solid.spread(middle, half)
    tallest = lengths(solid, middle, slack)
    some = np.flatnonzero(tallest > 0.0)
    tallest[some] = np.minimum(tallest[some], _most_of_one(solid, middle[some], slack[some]))
    return np.asarray(4.0 * half[:, 0] * half[:, 1] * heaviest * tallest)


def _most_of_one(solid: Columned, at: Array, slack: Array) -> Array:
    """(N,) mm that the narrowest limb leaves of a column, on both its sides, P within ± slack."""
    p, _ = solid.limbs(at)
    least, most = np.maximum(np.abs(p) - slack, 0.0), np.abs(p) + slack
    low, high = solid.low, solid.high
    apart = np.sqrt(np.maximum((high - most) * (high + most), 0.0))
    apart = 2.0 * (apart - np.sqrt(np.maximum((low - most) * (low + most), 0.0)))
    joined = np.maximum(least, low)
    joined = 2.0 * np.sqrt(np.maximum((high - joined) * (high + joined), 0.0))
    return np.asarray(np.where(most < low, apart, joined).min(axis=1))


def _integrals(solid: Columned, middle: Array, half: Array) -> tuple[Array, Array, Ints]:
    """The volumes over cells by Gauss's rule of nine points, what they may be off, (N,) mm³, and
    across which side to cut them (N,)."""
    points = (middle[:, None] + half[:, None] * _NODES).reshape(-1, 2)
    height = (lengths(solid, points) * solid.weight(points)).reshape(len(middle), len(_NODES))
    area = 4.0 * half[:, 0] * half[:, 1]
    value = area * (height[:, :9] @ _NINE)
    doubt = _SAFETY * area * np.abs(height @ _DIFFERENCES.T).max(axis=1)
    cell, node = np.nonzero(height[:, :9] <= 0.0)
    if len(cell):  # nothing is seen there: as much as there may be over that ninth of the cell
        hidden = bounds(solid, points.reshape(*height.shape, 2)[cell, node], half[cell] / 3.0)
        doubt = np.maximum(doubt, np.bincount(cell, hidden, len(middle)))
    grid = height[:, :9].reshape(-1, 3, 3)
    bend = [np.abs(np.diff(grid, 2, axis)).sum(axis=(1, 2)) for axis in (1, 2)]
    side = np.where(bend[0] == bend[1], longer_side(solid, middle, half), bend[1] > bend[0])
    return value, doubt, side
