"""Folds in a mesh whose vertices have been moved onto their true surfaces, and their repair."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.workspace.sheets import (
    Masks,
    Sheets,
    count_of,
    distances,
    onto,
)

Faces = NDArray[np.int32]

_ROUNDS = 12  # of repair at most
_PATIENCE = 3  # rounds without fewer folds


@dataclass(eq=False)
class Net:
    """A mesh at work on its true surfaces.

    Attributes:
        sheets: the true surfaces.
        v: (V, 3) mm.
        masks: (V,) the surfaces that each vertex has been put on, as bits.
        f: (F, 3) indices into ``v``.
        of_face: (F,) which surface each face stands for.
        outward: (F,) +1 where the solid lies inside its surface's normal, else −1.
        patch_of: (F,) as of `solids.TracedMesh`.
    """

    sheets: Sheets
    v: Array
    masks: Masks
    f: Faces
    of_face: NDArray[np.int64]
    outward: Array
    patch_of: NDArray[np.intp]

    def folded(self, rows: NDArray[np.intp]) -> NDArray[np.intp]:
        """Those of some faces that look into the true surface behind them."""
        look = looks(self.sheets, self.of_face[rows], self.v, self.f[rows])
        return rows[look * self.outward[rows] <= 0.0]

    def around(self, rows: NDArray[np.intp]) -> NDArray[np.intp]:
        """Those faces and all that share a vertex with them."""
        touched = np.zeros(len(self.v), bool)
        touched[self.f[rows]] = True
        return np.flatnonzero(touched[self.f].any(axis=1))


@dataclass(frozen=True, eq=False)
class _Flips:
    """Pairs of faces (N, 2) whose diagonals were changed at once, and the corners that they had.

    ``gone`` and ``come`` (N,) tell the diagonals that they lost and got: equal numbers, one edge.
    """

    pairs: NDArray[np.intp]
    before: tuple[Faces, Faces]
    gone: NDArray[np.int64]
    come: NDArray[np.int64]

    def part(self, which: NDArray[np.bool_]) -> _Flips:
        first, second = self.before
        before = first[which], second[which]
        return _Flips(self.pairs[which], before, self.gone[which], self.come[which])


def looks(sheets: Sheets, of_face: NDArray[np.int64], v: Array, f: Faces) -> Array:
    """(F,) the part of twice a face's area that looks along its surface's normal, mm²."""
    a, b, c = (v[f[:, n]] for n in range(3))
    _, g, _ = distances(sheets, of_face, np.zeros(len(f), bool), (a + b + c) / 3.0)
    return np.asarray(np.einsum("ij,ij->i", np.cross(b - a, c - a), g))


def unfold(net: Net, original: Array, deviation: float, on: float) -> None:
    """Where faces have turned over: other diagonals, vertices moved along their surfaces, or
    back to where they stood.

    ``original`` (V, 3) mm is a place of every vertex in which no face is folded; ``deviation``
    and ``on`` are those of `sheets.onto`.
    """
    flips: list[_Flips] = []
    bad = net.folded(np.arange(len(net.f)))
    fewest, since = len(bad), 0
    for _ in range(_ROUNDS):
        if not len(bad):
            return
        region = net.around(bad)
        flips.append(_flip(net, bad, region))
        bad = net.folded(region)
        if len(bad):
            region = net.around(bad)
            _smooth(net, bad, region, deviation, on)
            bad = net.folded(region)
        fewest, since = (len(bad), 0) if len(bad) < fewest else (fewest, since + 1)
        if since == _PATIENCE:
            break
    while len(stuck := _retreat(net, original)) and _undone(net, flips, stuck):
        pass  # with the diagonals that it came with, a mesh moved back has no folds


def _retreat(net: Net, original: Array) -> NDArray[np.intp]:
    """Of each folded face the vertex that moved farthest goes back; returns what stays folded."""
    bad = net.folded(np.arange(len(net.f)))
    while len(bad):
        corners = net.f[bad]
        moved = np.linalg.norm(net.v[corners] - original[corners], axis=2)
        moved[net.masks[corners] == 0] = -1.0
        farthest = corners[np.arange(len(bad)), moved.argmax(axis=1)]
        back = np.unique(farthest[moved.max(axis=1) >= 0.0])
        if not len(back):
            break
        region = net.around(bad)
        net.v[back], net.masks[back] = original[back], 0
        bad = net.folded(region)
    return bad


def _smooth(
    net: Net, bad: NDArray[np.intp], region: NDArray[np.intp], deviation: float, on: float
) -> None:
    """Vertices of bad faces to the mean of their neighbours, and back onto their surfaces.

    Along a curve only its own vertices count, on a face all around; corners stay.
    """
    size = len(net.v)
    free = np.zeros(size, bool)
    free[net.f[bad]] = True
    free &= (net.masks != 0) & (count_of(net.masks) <= 2)
    near = net.f[region]
    edges = np.concatenate([near[:, [0, 1]], near[:, [1, 2]], near[:, [2, 0]]])
    edges = np.concatenate([edges, edges[:, ::-1]])
    start, end = edges[free[edges[:, 0]]].T
    along = (net.masks[start] & net.masks[end]) == net.masks[start]
    start, end = start[along], end[along]
    number = np.bincount(start, minlength=size)
    chosen = np.flatnonzero(number)
    if not len(chosen):
        return
    sums = [np.bincount(start, net.v[end, n], minlength=size)[chosen] for n in range(3)]
    mean = np.stack(sums, axis=1) / number[chosen, None]
    tried, done = onto(net.sheets, net.masks[chosen], mean, deviation, on)
    net.v[chosen[done]] = tried[done]


def _flip(net: Net, bad: NDArray[np.intp], region: NDArray[np.intp]) -> _Flips:
    """The other diagonal of a bad face and its neighbour on the same surface, where that helps."""
    f, size = net.f[region], np.int64(len(net.v))
    start, end = f.astype(np.int64).ravel(), np.roll(f, -1, axis=1).astype(np.int64).ravel()
    forth = start * size + end
    order = np.argsort(forth)
    known = forth[order]
    # The edges of bad faces, and across each the neighbour's.
    mine = (3 * np.searchsorted(region, bad)[:, None] + np.arange(3)).ravel()
    other = order[np.searchsorted(known, end[mine] * size + start[mine])]
    t, n = mine // 3, other // 3
    sheet, patch = net.of_face[region], net.patch_of[region]
    same = (sheet[t] == sheet[n]) & (patch[t] == patch[n])
    mine, other, t, n = mine[same], other[same], t[same], n[same]
    a, b = f[t, mine % 3], f[n, other % 3]
    c, d = f[t, (mine + 2) % 3], f[n, (other + 2) % 3]
    wanted = c.astype(np.int64) * size + d
    at = np.minimum(np.searchsorted(known, wanted), len(known) - 1)
    able = (c != d) & (known[at] != wanted)
    first, second = np.stack([a, d, c], axis=1), np.stack([d, b, c], axis=1)
    for faces in (first, second):
        able &= looks(net.sheets, sheet[t], net.v, faces) * net.outward[region[t]] > 0.0
    # One flip a face, and no edge twice.
    rows = np.flatnonzero(able)
    best = np.full(len(f), len(t), np.int64)
    np.minimum.at(best, t[rows], rows)
    np.minimum.at(best, n[rows], rows)
    chosen = rows[(best[t[rows]] == rows) & (best[n[rows]] == rows)]
    come = np.minimum(c, d).astype(np.int64) * size + np.maximum(c, d)
    gone = np.minimum(a, b).astype(np.int64) * size + np.maximum(a, b)
    chosen = chosen[np.unique(come[chosen], return_index=True)[1]]
    t, n = region[t[chosen]], region[n[chosen]]
    before = net.f[t], net.f[n]
    done = _Flips(np.stack([t, n], axis=1), before, gone[chosen], come[chosen])
    net.f[t], net.f[n] = first[chosen], second[chosen]
    return done


def _undone(net: Net, flips: list[_Flips], stuck: NDArray[np.intp]) -> bool:
    """Take back all flips that led to some faces; whether there were any.

    With a flip go those of the same faces, and those that have since put an edge where it took one
    away.
    """
    linked = np.zeros(len(net.f), bool)
    linked[stuck] = True
    back = [np.zeros(len(each.pairs), bool) for each in flips]
    before = -1
    while (known := sum(int(mine.sum()) for mine in back)) > before:
        before = known
        gone = [each.gone[mine] for each, mine in zip(flips, back, strict=True)]
        for each, mine in zip(flips, back, strict=True):
            mine |= linked[each.pairs].any(axis=1) | np.isin(each.come, np.concatenate(gone))
            linked[each.pairs[mine]] = True
    for n in reversed(range(len(flips))):
        part = flips[n].part(back[n])
        net.f[part.pairs[:, 0]], net.f[part.pairs[:, 1]] = part.before
        flips[n] = flips[n].part(~back[n])
    return any(mine.any() for mine in back)
