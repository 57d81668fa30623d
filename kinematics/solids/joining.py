"""How the layers of two neighbouring columns hang together: what is drawn on the wall between them.

Boundaries of one column that go on in the other are joined. A layer that only one of them has ends
between them: its two boundaries meet there, or all three where it is between two others that go on.
Where a layer of one sign has the place of one of the other, an upright line parts them. Ends are
where they are, by search along the wall.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kinematics.arrays import Array
from kinematics.solids.aligning import aligned
from kinematics.solids.columns import ROOT, Columned, Ints, Layers, Mask, both, layers

_BETWEEN = 8  # parts of the way between columns, to see what hangs together
_LOOKS = 6  # times that such parts are parted again


@dataclass(frozen=True, eq=False)
class Walls:
    """Between columns a and b, numbered alike: N walls.

    Attributes:
        a, b: (N, 2) base points.
        at_a, at_b: (N,) which rows of ``columns`` stand there.
        columns: of all.
        of: (N,) the edge of the base on which a wall stands: walls that are parts of one come
            after those of all edges.
        inner: (K, 2) base points of the last of ``columns``, between parts of walls.
        inner_of: (K,) on which edge.
    """

    a: Array
    b: Array
    at_a: NDArray[np.intp]
    at_b: NDArray[np.intp]
    columns: Layers
    of: NDArray[np.intp]
    inner: Array
    inner_of: NDArray[np.intp]

    @classmethod
    def on(
        cls, a: Array, b: Array, at_a: NDArray[np.intp], at_b: NDArray[np.intp], columns: Layers
    ) -> Walls:
        """One wall on every edge."""
        none = np.zeros(0, dtype=np.intp)
        return cls(a, b, at_a, at_b, columns, np.arange(len(a)), np.zeros((0, 2)), none)

    def take(self, rows: NDArray[np.intp]) -> Walls:
        """Some of them alone."""
        ends = self.a[rows], self.b[rows], self.at_a[rows], self.at_b[rows]
        return Walls.on(*ends, self.columns)


@dataclass(frozen=True, eq=False)
class Joined:
    """What joins what on walls.

    Attributes:
        goes_on: (G, 3) wall, boundary of a, boundary of b.
        meets: (E, 7) wall, and the boundaries of a and of b that meet in one place, three each,
            −1 where there are fewer. Two of each: an upright line parts layers of both signs.
        level: (E, 2) the layers of a and of b that lie next to them from below, counted from 0 for
            what is below all; −1 where what ends is within what ends.
        plain: (N,) whether all of a wall's boundaries go on, and it is not parted.
    """

    goes_on: Ints
    meets: Ints
    level: Ints
    plain: Mask

    @property
    def swaps(self) -> Mask:
        """(E,) which are upright lines."""
        return np.asarray((self.meets[:, 2] >= 0) & (self.meets[:, 5] >= 0))


def joined(solid: Columned, walls: Walls) -> tuple[Walls, Joined]:
    """Which boundaries go on and which meet, so that what is joined is as near as can be.

    Where that leaves a choice of what hangs together, columns between the two decide; and where
    boundaries that go on or meet all at once cannot tell it, the wall is parted at these.

    Returns:
        the walls, with parts of some after them, and what is on them; nothing on those parted.
    """
    plain, goes, meets = _joined(walls, None)
    look = np.arange(len(walls.a))
    for _ in range(_LOOKS):
        look = look[_has_choice(walls, look, plain)]
        if not len(look):
            break
        chain = _Chain.along(solid, walls, look)
        wrong = _differs(walls, look, goes, meets, chain)
        if not wrong.any():
            break
        # Again, so that first of all hangs together what does.
        again = np.flatnonzero(wrong & ~plain[look])
        rows = look[again]
        _, more_goes, more_meets = _joined(walls.take(rows), chain.linked()[again])
        goes, meets = _instead(goes, rows, more_goes), _instead(meets, rows, more_meets)
        wrong[again] = _differs(walls, rows, goes, meets, chain.take(again))
        rows = look[wrong]
        if not len(rows):
            break
        number = len(walls.a)
        walls = chain.take(np.flatnonzero(wrong)).parted(walls, rows)
        look = np.arange(number, len(walls.a))
        more_plain, more_goes, more_meets = _joined(walls.take(look), None)
        more_goes[:, 0] += number
        more_meets[:, 0] += number
        goes = np.concatenate([_instead(goes, rows, goes[:0]), more_goes])
        meets = np.concatenate([_instead(meets, rows, meets[:0]), more_meets])
        plain = np.concatenate([plain, more_plain])
        plain[rows] = False
    return walls, Joined(goes, meets[:, :7], meets[:, 7:], plain)


def _instead(all_: Ints, walls: NDArray[np.intp], new: Ints) -> Ints:
    """Rows with those of some walls taken out; ``new`` ones count these walls."""
    gone = np.isin(all_[:, 0], walls)
    new = new.copy()
    new[:, 0] = walls[new[:, 0]] if len(new) else new[:, 0]
    return np.concatenate([all_[~gone], new])


def _joined(walls: Walls, known: Mask | None) -> tuple[Mask, Ints, Ints]:
    """`Joined.plain`, ``goes_on``, and ``meets`` with ``level``."""
    columns = walls.columns
    count, above = columns.count, columns.above
    plain = count[walls.at_a] == count[walls.at_b]
    plain &= (above[walls.at_a] == above[walls.at_b]).all(axis=1)
    likely = np.flatnonzero(plain)
    plain[likely] = ~_jumps(columns.take(walls.at_a[likely]), columns.take(walls.at_b[likely]))
    number = count[walls.at_a[plain]]
    wall = np.repeat(np.flatnonzero(plain), number)
    own = np.arange(len(wall)) - np.repeat(np.cumsum(number) - number, number)
    on = [np.stack([wall, own, own], axis=-1)]
    met: list[Ints] = [np.empty((0, 9), dtype=np.int64)]
    rest = np.flatnonzero(~plain)
    if len(rest):
        weights = 3 ** np.arange(above.shape[1], dtype=np.int64)
        code = (1 + above.astype(np.int64)) @ weights
        pair = np.stack([code[walls.at_a[rest]], code[walls.at_b[rest]]], axis=-1)
        _, group = np.unique(pair, axis=0, return_inverse=True)
        group = group.reshape(-1)
        order = np.argsort(group, kind="stable")
        for rows in np.split(rest[order], np.flatnonzero(np.diff(group[order])) + 1):
            goes, meet = aligned(
                columns.take(walls.at_a[rows]),
                columns.take(walls.at_b[rows]),
                rows,
                None if known is None else known[rows],
            )
            on.append(goes)
            met.append(meet)
    return plain, np.concatenate(on), np.concatenate(met)


# --- what hangs together -------------------------------------------------------------------------


def _jumps(a: Layers, b: Layers) -> Mask:
    """(R,) whether some layers of columns that have as many of the same signs have neither v nor a
    surface in common: one ends, and the other begins."""
    if a.at.shape[1] < 2:
        return np.zeros(len(a.at), dtype=bool)
    apart = np.minimum(a.at[:, 1:], b.at[:, 1:]) <= np.maximum(a.at[:, :-1], b.at[:, :-1])
    apart &= (a.label[:, :-1] != b.label[:, :-1]) & (a.label[:, 1:] != b.label[:, 1:])
    return np.asarray((apart & (a.above[:, :-1] != 0)).any(axis=1))


def _has_choice(walls: Walls, rows: NDArray[np.intp], plain: Mask) -> Mask:
    """(R,) walls that may hang together in more than one way: layers of one sign that are more
    than two; or two that go on but have no v in common, and not the same surfaces."""
    a, b = walls.columns.take(walls.at_a[rows]), walls.columns.take(walls.at_b[rows])
    found = np.zeros(len(rows), dtype=bool)
    for sign in (1, -1):
        number = (a.above == sign).sum(axis=1) + (b.above == sign).sum(axis=1)
        found |= ~plain[rows] & (number > 1)
    if a.at.shape[1] > 1:
        with np.errstate(invalid="ignore"):
            apart = np.minimum(a.at[:, 1:], b.at[:, 1:]) <= np.maximum(a.at[:, :-1], b.at[:, :-1])
        inside = (a.above[:, :-1] != 0) & np.isfinite(a.at[:, 1:]) & np.isfinite(b.at[:, 1:])
        same = (a.label[:, :-1] == b.label[:, :-1]) & (a.label[:, 1:] == b.label[:, 1:])
        found |= plain[rows] & (apart & inside & ~same).any(axis=1)
    return found


@dataclass(frozen=True, eq=False)
class _Chain:
    """Columns along walls, and what hangs together from one to the next.

    Attributes:
        inner: (R, B − 1, 2) base points between the ends.
        columns: (R · (B + 1),) of each wall one after the other, its ends first and last.
        label: (R, B + 1, M) numbers of what hangs together; −1 − … of what is outside.
    """

    inner: Array
    columns: Layers
    label: NDArray[np.intp]

    @classmethod
    def along(cls, solid: Columned, walls: Walls, rows: NDArray[np.intp]) -> _Chain:
        steps = np.arange(1, _BETWEEN) / _BETWEEN
        a, b = walls.a[rows], walls.b[rows]
        inner = a[:, None] + steps[:, None] * (b - a)[:, None]
        known = walls.columns.take(np.concatenate([walls.at_a[rows], walls.at_b[rows]]))
        count = len(rows)
        number = np.column_stack(
            [
                np.arange(count),
                2 * count + np.arange(count * len(steps)).reshape(count, -1),
                count + np.arange(count),
            ]
        )
        columns = both(known, layers(solid, inner.reshape(-1, 2))).take(number.ravel())
        most = max(columns.at.shape[1] - 1, 0)
        size = count * (_BETWEEN + 1)
        here = np.arange(size).reshape(count, -1)
        one, other = here[:, :-1].ravel(), here[:, 1:].ravel()
        wall, i, j = np.nonzero(_next_to(columns.take(one), columns.take(other)))
        graph = coo_array(
            (np.ones(len(wall), bool), (one[wall] * most + i, other[wall] * most + j)),
            shape=(size * most,) * 2,
        )
        label = connected_components(graph, directed=False)[1].reshape(size, most)
        label = np.pad(label, ((0, 0), (0, 1)), constant_values=-1)
        label = np.where(columns.above != 0, label, -1)
        return cls(inner, columns, label.reshape(count, _BETWEEN + 1, -1))

    def take(self, rows: NDArray[np.intp]) -> _Chain:
        own = (rows[:, None] * (_BETWEEN + 1) + np.arange(_BETWEEN + 1)).ravel()
        return _Chain(self.inner[rows], self.columns.take(own), self.label[rows])

    def linked(self) -> Mask:
        """(R, M, M) which layers of a and of b hang together, by the boundaries below them."""
        one, other = self.label[:, 0, :, None], self.label[:, -1, None, :]
        return np.asarray((one == other) & (one >= 0))

    def parted(self, walls: Walls, rows: NDArray[np.intp]) -> Walls:
        """The walls with parts of ``rows``, which are those of the chain, after them."""
        count, parts_ = len(rows), _BETWEEN
        new = self.columns.take(
            (np.arange(count)[:, None] * (parts_ + 1) + np.arange(1, parts_)).ravel()
        )
        first = len(walls.columns.at)
        number = np.column_stack(
            [
                walls.at_a[rows],
                first + np.arange(count * (parts_ - 1)).reshape(count, -1),
                walls.at_b[rows],
            ]
        )
        places = np.concatenate(
            [walls.a[rows][:, None], self.inner, walls.b[rows][:, None]], axis=1
        )
        edge = walls.of[rows]
        return Walls(
            np.concatenate([walls.a, places[:, :-1].reshape(-1, 2)]),
            np.concatenate([walls.b, places[:, 1:].reshape(-1, 2)]),
            np.concatenate([walls.at_a, number[:, :-1].ravel()]),
            np.concatenate([walls.at_b, number[:, 1:].ravel()]),
            both(walls.columns, new),
            np.concatenate([walls.of, np.repeat(edge, parts_)]),
            np.concatenate([walls.inner, self.inner.reshape(-1, 2)]),
            np.concatenate([walls.inner_of, np.repeat(edge, parts_ - 1)]),
        )


def _next_to(one: Layers, other: Layers) -> Mask:
    """(N, M − 1, M − 1) which layers of columns next to each other hang together: one by one where
    there are as many of the same signs and none jumps; else those that have some v in common, or
    lie between the same two surfaces."""
    low = one.at[:, :-1, None], other.at[:, None, :-1]
    high = one.at[:, 1:, None], other.at[:, None, 1:]
    sign = one.above[:, :-1, None], other.above[:, None, :-1]
    label = (one.label[:, :-1, None], one.label[:, 1:, None])
    same = (label[0] == other.label[:, None, :-1]) & (label[1] == other.label[:, None, 1:])
    same &= (label[0] != ROOT) | (label[1] != ROOT)
    common = np.minimum(*high) > np.maximum(*low)
    alike = (sign[0] == sign[1]) & (sign[0] != 0) & np.isfinite(high[0]) & np.isfinite(high[1])
    one_by_one = (one.above == other.above).all(axis=1) & (one.count == other.count)
    one_by_one[one_by_one] = ~_jumps(one.take(one_by_one), other.take(one_by_one))
    one_by_one = one_by_one[:, None, None]
    own = np.eye(low[0].shape[1], dtype=bool)
    return np.asarray(alike & np.where(one_by_one, own, common | same))


def _differs(walls: Walls, rows: NDArray[np.intp], goes: Ints, meets: Ints, chain: _Chain) -> Mask:
    """(R,) whether layers hang together otherwise by what joins them than by the chain."""
    count = len(rows)
    number = np.full(len(walls.a), -1)
    number[rows] = np.arange(count)
    alone = Walls.on(
        np.zeros((count, 2)),
        np.zeros((count, 2)),
        np.arange(count),
        count + np.arange(count),
        walls.columns.take(np.concatenate([walls.at_a[rows], walls.at_b[rows]])),
    )
    own = []
    for all_ in (goes, meets):
        kept = all_[number[all_[:, 0]] >= 0].copy()
        kept[:, 0] = number[kept[:, 0]]
        own.append(kept)
    joints = Joined(own[0], own[1][:, :7], own[1][:, 7:], np.zeros(0, dtype=bool))
    found = parts(alone, joints).of
    most = found.shape[1]
    label = np.concatenate([chain.label[:, 0, :most], chain.label[:, -1, :most]], axis=1)
    found = np.concatenate([found[:count], found[count:]], axis=1)
    inside = (found >= 0)[:, :, None] & (found >= 0)[:, None, :]
    together = [x[:, :, None] == x[:, None, :] for x in (found, label)]
    return np.asarray((inside & (together[0] != together[1])).any(axis=(1, 2)))


@dataclass(frozen=True, eq=False)
class Parts:
    """What hangs together, over all columns.

    Attributes:
        of: (V, M) the part of the layer above each boundary, −1 of what is outside.
        sign: (P,) of the parts.
        columns: (P,) over how many columns.
    """

    of: NDArray[np.intp]
    sign: NDArray[np.int8]
    columns: Ints


def parts(walls: Walls, joints: Joined, more: Ints | None = None) -> Parts:
    """The connected parts of either sign.

    Args:
        more: (W, 2) columns that are one and the same.
    """
    columns = walls.columns
    rows, most = columns.above.shape
    wide = most + 1  # layer 0 is what is below all
    wall, i, j = joints.goes_on.T
    one, other = walls.at_a[wall] * wide, walls.at_b[wall] * wide
    links = [np.stack([one + i + k, other + j + k]) for k in (0, 1)]
    wall, level = joints.meets[:, 0], joints.level
    ends_of = []
    for side, k in ((walls.at_a, 0), (walls.at_b, 1)):
        own = joints.meets[:, 1 + 3 * k : 4 + 3 * k]
        some, row = own[:, 0] >= 0, side[wall] * wide
        known = some | (level[:, k] >= 0)
        under = np.where(some, own[:, 0], level[:, k])
        over = np.where(some, own.max(axis=1) + 1, level[:, k])
        ends_of.append((np.where(known, row + under, -1), np.where(known, row + over, -1)))
    for below in (0, 1):
        one, other = ends_of[0][below], ends_of[1][below]
        # What ends within what ends has nothing on the other side: then around itself.
        alone = np.where(one < 0, other, one), np.where(one < 0, ends_of[1][1 - below], other)
        alone = alone[0], np.where(other < 0, ends_of[0][1 - below], alone[1])
        links.append(np.stack(alone))
    if more is not None and len(more):
        for k in range(1, wide):
            twins = np.stack([more[:, 0] * wide + k, more[:, 1] * wide + k])
            links.append(twins[:, columns.count[more[:, 0]] > k])
    a, b = np.concatenate(links, axis=1)
    inside = np.zeros((rows, wide), dtype=np.int8)
    inside[:, 1:] = columns.above
    sign = inside.ravel()
    kept = (sign[a] != 0) & (sign[a] == sign[b])
    graph = coo_array((np.ones(int(kept.sum()), bool), (a[kept], b[kept])), shape=(len(sign),) * 2)
    _, label = connected_components(graph, directed=False)
    used, number = np.unique(label[sign != 0], return_inverse=True)
    of = np.full(len(sign), -1)
    of[sign != 0] = number
    signs = np.zeros(len(used), dtype=np.int8)
    signs[number] = sign[sign != 0]
    return Parts(of.reshape(rows, wide)[:, 1:], signs, np.bincount(number, minlength=len(used)))
