"""Tilings made as fine as a solid by columns needs them: where it is, and where it bends.

Cells over which nothing shows are dropped where they are proven empty, and halved where not: so
whatever there is comes to light, however small. Cells whose flat triangles miss most of the volume
are halved until what is missed is small, or there are as many as may be.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.solids.columns import Columned, Ints, Layers, both, layers
from kinematics.solids.curves import Stand, stand
from kinematics.solids.joining import parts
from kinematics.solids.measuring import bounds, changes
from kinematics.solids.tiling import Tiling, Triangles

_ROUNDS = 60
_HIDDEN = 20  # times as many cells as may show something: that many more may be looked at
_OF_ENDS = 0.1  # of the thickness that ends over a triangle: what its flat faces miss there
_SHARE = 0.7  # of what is missed: the worst cells that make it up are halved at a time
_LOOKS = 16
_FEW = 10  # columns of a part: its cells are halved
_AT_LEAST = 600  # cells that may be added to tell what hangs together
_ALIKE = 0.5  # two sides along which limbs change as much as that are halved both


@dataclass(frozen=True)
class Fineness:
    """How fine: first cells, the part of the volume that may be missed, and the most cells."""

    first: tuple[int, int]
    missed: float
    most: int


class _Known:
    """Columns over places of a lattice, each looked at once."""

    def __init__(self, tiling: Tiling) -> None:
        self._tiling = tiling
        self._keys = np.empty(0, dtype=np.int64)
        self._layers: Layers | None = None

    def at(self, places: Ints) -> Layers:
        """The columns over places (V, 2), each given once."""
        keys = places[:, 0] * (self._tiling.shape[1] + 1) + places[:, 1]
        unique, first = np.unique(keys, return_index=True)
        new = ~np.isin(unique, self._keys, assume_unique=True)
        if new.any() or self._layers is None:
            more = layers(self._tiling.solid, self._tiling.points(places[first[new]]))
            found = more if self._layers is None else both(self._layers, more)
            merged = np.concatenate([self._keys, unique[new]])
            order = np.argsort(merged)
            self._keys, self._layers = merged[order], found.take(order)
        return self._layers.take(np.searchsorted(self._keys, keys))


def refined(solid: Columned, fineness: Fineness) -> tuple[Tiling, Stand, bool]:
    """A tiling that is fine enough, its columns, and whether it is clear what hangs together."""
    tiling = Tiling(solid, fineness.first)
    known = _Known(tiling)
    missed = np.full(len(tiling.low), np.nan)
    for turn in range(_ROUNDS):
        triangles = tiling.triangles()
        columns = known.at(triangles.vertices)
        shown = np.zeros(len(tiling.low), dtype=bool)
        np.logical_or.at(shown, triangles.cell, (columns.count > 0)[triangles.corners].any(axis=1))
        fresh = np.isnan(missed) & shown
        missed[fresh] = _missed(tiling, triangles, columns, fresh)[fresh]
        fresh = np.flatnonzero(np.isnan(missed))
        missed[fresh] = bounds(solid, tiling.middles()[fresh], tiling.halves()[fresh])
        volume, total = _volume(tiling, triangles, columns), float(missed.sum())
        room = fineness.most - int(shown.sum())
        if total <= fineness.missed * volume or room <= 0 or turn == _ROUNDS - 1:
            break
        if int((~shown & (missed > 0.0)).sum()) > _HIDDEN * fineness.most:
            break
        order = np.argsort(-missed)
        enough = min(_SHARE * total, total - 0.5 * fineness.missed * volume)
        count = int(np.searchsorted(np.cumsum(missed[order]), enough)) + 1
        some = order[:count]
        chosen = np.zeros(len(shown), dtype=bool)
        chosen[some[np.cumsum(shown[some]) <= max(1, room // 2)]] = True
        missed = _halve(tiling, chosen, ~shown & (missed <= 0.0), missed)
    tiling.keep(shown)
    return tiling, *_settled(tiling, known, fineness.most)


def _settled(tiling: Tiling, known: _Known, most: int) -> tuple[Stand, bool]:
    """The walls of the tiling, made finer where it is not clear what hangs together; and whether
    it is clear then."""
    limit = len(tiling.low) + max(most // 2, _AT_LEAST)
    for _ in range(_LOOKS):
        triangles = tiling.triangles()
        stood = stand(tiling, known.at(triangles.vertices), triangles)
        doubtful = _doubtful(tiling, stood)
        if not doubtful.any() or len(tiling.low) + 3 * int(doubtful.sum()) > limit:
            break
        nothing = np.zeros(len(tiling.low), dtype=bool)
        _halve(tiling, doubtful, nothing, np.zeros(len(tiling.low)))
    return stood, not doubtful.any()


def _doubtful(tiling: Tiling, stood: Stand) -> NDArray[np.bool_]:
    """(N,) cells with a part of very few columns, and those where two parts of one sign that hang
    together nowhere come near each other, next to where layers end."""
    triangles, columns = stood.triangles, stood.walls.columns
    found = parts(stood.walls, stood.joints, triangles.twin)
    vertex, k = np.nonzero(found.of[: len(triangles.vertices)] >= 0)
    part = found.of[vertex, k]
    low, high = columns.at[vertex, k], columns.at[vertex, k + 1]
    size, number = len(tiling.low), len(found.sign)
    pairs = np.unique(
        np.stack([np.repeat(triangles.cell, 3), triangles.corners.ravel()], axis=-1), axis=0
    )
    cells, corners = pairs.T
    doubtful = np.zeros(size, dtype=bool)
    few = found.columns < _FEW
    scarce = np.zeros(len(triangles.vertices), dtype=bool)
    scarce[vertex[few[part]]] = True
    doubtful[cells[scarce[corners]]] = True
    ending = np.zeros(size, dtype=bool)
    ending[triangles.cell[(~stood.joints.plain[stood.edge_of]).any(axis=1)]] = True
    spans = _Spans.of(vertex, part, low, high, number)
    spans = spans.gathered(corners, cells).gathered(cells, corners).gathered(corners, cells)
    # Of every cell its parts, those of one sign from below.
    where, what = np.divmod(spans.key, number)
    order = np.lexsort((spans.low, found.sign[what], where))
    where, what, low, high = where[order], what[order], spans.low[order], spans.high[order]
    next_to = (where[1:] == where[:-1]) & (found.sign[what[1:]] == found.sign[what[:-1]])
    near = np.flatnonzero(next_to & (low[1:] <= high[:-1]))
    doubtful[where[near][ending[where[near]]]] = True
    return doubtful


@dataclass(frozen=True, eq=False)
class _Spans:
    """Places and parts, as one number, and the v that a part has there, from low to high."""

    key: Ints
    low: Array
    high: Array
    parts: int

    @classmethod
    def of(cls, where: Ints, part: Ints, low: Array, high: Array, parts: int) -> _Spans:
        key, number = np.unique(where * parts + part, return_inverse=True)
        lowest, highest = np.full(len(key), np.inf), np.full(len(key), -np.inf)
        np.minimum.at(lowest, number, low)
        np.maximum.at(highest, number, high)
        return cls(key, lowest, highest, parts)

    def gathered(self, source: Ints, target: Ints) -> _Spans:
        """What the places ``source`` have, given to the places ``target``."""
        where, part = np.divmod(self.key, self.parts)
        first = np.searchsorted(where, source, side="left")
        count = np.searchsorted(where, source, side="right") - first
        own = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
        row = np.repeat(first, count) + own
        return _Spans.of(
            np.repeat(target, count), part[row], self.low[row], self.high[row], self.parts
        )


def _halve(
    tiling: Tiling, chosen: NDArray[np.bool_], empty: NDArray[np.bool_], missed: Array
) -> Array:
    """Halves the chosen cells and drops the empty ones; what is missed then, NaN where unknown."""
    tiling.keep(~empty)
    chosen, missed = chosen[~empty], missed[~empty].copy()
    rows = np.flatnonzero(chosen)
    along = changes(tiling.solid, tiling.middles()[rows], tiling.halves()[rows])
    before = len(tiling.low)
    first = along[0] >= _ALIKE * along[1]
    able = tiling.split(rows[first], np.zeros(int(first.sum()), dtype=np.int64))
    made = np.arange(before, len(tiling.low))
    second = along[1] >= _ALIKE * along[0]
    twice = np.concatenate([rows[second], made[second[first][able]]])
    tiling.split(twice, np.ones(len(twice), dtype=np.int64))
    missed[rows] = np.nan
    return np.concatenate([missed, np.full(len(tiling.low) - before, np.nan)])


def _thick(columns: Layers) -> Array:
    """(N, 2) mm of either sign."""
    if columns.at.shape[1] < 2:
        return np.zeros((len(columns.at), 2))
    with np.errstate(invalid="ignore"):
        thick = np.nan_to_num(np.diff(columns.at, axis=1), nan=0.0, posinf=0.0)
    sign = columns.above[:, :-1]
    return np.stack([np.where(sign == s, thick, 0.0).sum(axis=1) for s in (1, -1)], axis=-1)


def areas(tiling: Tiling, triangles: Triangles, weighted: bool = True) -> Array:
    """(T,) of base triangles, times the weight in their middle."""
    p = tiling.points(triangles.places)
    a, b = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return np.asarray(area * tiling.solid.weight(p.mean(axis=1)))


def _volume(tiling: Tiling, triangles: Triangles, columns: Layers) -> float:
    """Roughly, mm³."""
    thick = _thick(columns).sum(axis=1)
    return float(areas(tiling, triangles) @ thick[triangles.corners].mean(axis=1))


def _missed(
    tiling: Tiling, triangles: Triangles, columns: Layers, fresh: NDArray[np.bool_]
) -> Array:
    """(N,) mm³, roughly, that flat faces over cells miss; of ``fresh`` ones."""
    rows = np.flatnonzero(fresh[triangles.cell])
    own = replace(
        triangles,
        corners=triangles.corners[rows],
        places=triangles.places[rows],
        cell=triangles.cell[rows],
    )
    points = tiling.points(own.places)
    middle = layers(tiling.solid, points.mean(axis=1))
    all_ = both(columns, middle)
    numbers = np.column_stack([own.corners, len(columns.at) + np.arange(len(rows))])
    above, count = all_.above[numbers], all_.count[numbers]
    alike = (above == above[:, :1]).all(axis=(1, 2)) & (count == count[:, :1]).all(axis=1)
    found = np.zeros(len(rows))
    # Where a surface goes on over all of a triangle: between the flat face and the surface.
    for k in range(all_.at.shape[1]):
        on = np.flatnonzero(alike & (count[:, 0] > k))
        v = all_.at[numbers[on], k]
        x = [tiling.solid.place(points[on, n], v[:, n]) for n in range(3)]
        off = tiling.solid.place(points[on].mean(axis=1), v[:, 3]) - (x[0] + x[1] + x[2]) / 3.0
        swept = np.einsum("ni,ni->n", np.cross(x[1] - x[0], x[2] - x[0]), off)
        found[on] += 0.375 * np.abs(swept)
    # Where it does not: of the thickness that ends, and of the curve along which it does.
    ends_ = np.flatnonzero(~alike)
    thick = _thick(all_)[numbers[ends_]]
    part = replace(own, places=own.places[ends_])
    found[ends_] = _OF_ENDS * np.ptp(thick, axis=1).sum(axis=1) * areas(tiling, part)
    found += _beyond_chords(tiling, own, columns)
    return np.bincount(own.cell, found, len(tiling.low)).astype(float)


def _beyond_chords(tiling: Tiling, triangles: Triangles, columns: Layers) -> Array:
    """(T,) mm³ between the base's end and the chords of triangles along it."""
    found = np.zeros(len(triangles.cell))
    places = triangles.places[:, 1:]  # the first corner is the middle of a cell
    end = np.zeros(len(found), dtype=bool)
    for axis in (0, 1):
        if axis == 1 and tiling.solid.closed:
            continue
        for limit in (0, int(tiling.shape[axis])):
            end |= (places[:, :, axis] == limit).all(axis=1)
    thick = _thick(columns).sum(axis=1)[triangles.corners[:, 1:]].mean(axis=1)
    rows = np.flatnonzero(end & (thick > 0.0))
    if len(rows):
        a, b = (tiling.points(places[rows, k]) for k in (0, 1))
        zero = np.zeros(len(rows))
        place = tiling.solid.place
        one, other, there = place(a, zero), place(b, zero), place(0.5 * (a + b), zero)
        up = place(0.5 * (a + b), thick[rows]) - there
        sag = np.cross(other - one, there - 0.5 * (one + other))
        found[rows] = 2.0 / 3.0 * np.abs(np.einsum("ni,ni->n", sag, up))
    return found
