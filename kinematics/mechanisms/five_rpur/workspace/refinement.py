"""Edges of a mesh on true surfaces halved where they sag, the middles on the surfaces too."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.workspace.folds import Faces, Net, looks
from kinematics.mechanisms.five_rpur.workspace.sheets import onto, residuals
from kinematics.solids.csg import close_pairs

_LEVELS = 4
_STRETCH = 1 / 32  # of an edge: what the way of its middle is measured by, see `onto`
_SHORTEST = 8.0  # sags: shorter edges are left as they are


def refine(net: Net, sag: float, on: float, apart: float) -> Net:
    """No chord farther than ``sag`` mm from its surfaces, where that folds no face.

    ``on`` as of `sheets.onto`; new vertices keep ``apart`` mm from all others.
    """
    known = 0
    for _ in range(_LEVELS):
        finer = _halved(net, known, sag, on, apart)
        if finer is None:
            break
        net, known = finer, len(net.v)
    return net


def _halved(net: Net, known: int, sag: float, on: float, apart: float) -> Net | None:
    """Every edge split once whose middle sags; None if there is none.

    Edges between the first ``known`` vertices have been looked at before.
    """
    f, size = net.f, len(net.v)
    start, end = f.astype(np.int64).ravel(), np.roll(f, -1, axis=1).astype(np.int64).ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    keys, first, edge_of = np.unique(low * size + high, return_index=True, return_inverse=True)
    edge_of = edge_of.reshape(-1, 3)
    mask = np.zeros(len(keys), np.int64)
    np.bitwise_or.at(mask, edge_of.ravel(), np.repeat(np.int64(1) << net.of_face, 3))
    a, b = low[first], high[first]
    fit = ((net.masks[a] & net.masks[b] & mask) == mask) & ((mask & net.sheets.curved) != 0)
    chosen = np.flatnonzero(fit & (b >= known))
    length = np.linalg.norm(net.v[b[chosen]] - net.v[a[chosen]], axis=1)
    chord = (net.v[a[chosen]] + net.v[b[chosen]]) / 2.0
    # The way to a curve is longer than that to its surfaces, but hardly twice as long.
    near = residuals(net.sheets, mask[chosen], chord)
    long = (length > _SHORTEST * sag) & (near > sag / 2.0)
    chosen, length, chord = chosen[long], length[long], chord[long]
    middle, done = onto(net.sheets, mask[chosen], chord, _STRETCH * length, on)
    split = done & (np.linalg.norm(middle - chord, axis=1) > sag)
    chosen, middle = chosen[split], middle[split]
    close = close_pairs(np.concatenate([net.v, middle]), apart)
    free = np.ones(size + len(middle), bool)
    free[close] = False
    chosen, middle = chosen[free[size:]], middle[free[size:]]
    where = np.full(len(keys), -1, np.int64)
    while len(chosen):
        where[:] = -1
        where[chosen] = size + np.arange(len(chosen))
        v = np.concatenate([net.v, middle])
        parts, parent = _parts(f, where[edge_of], v)
        bad = looks(net.sheets, net.of_face[parent], v, parts) * net.outward[parent] <= 0.0
        bad &= (where[edge_of[parent]] >= 0).any(axis=1)
        if not bad.any():
            return Net(
                net.sheets,
                v,
                np.concatenate([net.masks, mask[chosen]]),
                parts,
                net.of_face[parent],
                net.outward[parent],
                net.patch_of[parent],
            )
        spoilt = np.zeros(len(keys), bool)
        spoilt[edge_of[parent[bad]]] = True
        chosen, middle = chosen[~spoilt[chosen]], middle[~spoilt[chosen]]
    return None


def _parts(f: Faces, middle: NDArray[np.int64], v: Array) -> tuple[Faces, NDArray[np.int64]]:
    """The faces after a split, and the face that each was a part of.

    ``middle`` (F, 3): the vertex in the middle of edge n, from corner n to the next, or −1.
    """
    marked = middle >= 0
    count = marked.sum(axis=1)
    rows = np.arange(len(f))
    # Turn every face so that its one split edge comes first, or its one whole edge last.
    turn = np.where(count == 1, marked.argmax(axis=1), (marked.argmin(axis=1) + 1) % 3)
    turn[(count == 0) | (count == 3)] = 0
    order = (np.arange(3) + turn[:, None]) % 3
    (a, b, c), (p, q, r) = f[rows[:, None], order].T, middle[rows[:, None], order].T
    none, one, two, all_ = (count == n for n in range(4))
    across = np.linalg.norm(v[a] - v[q], axis=1) <= np.linalg.norm(v[p] - v[c], axis=1)
    near, far = two & across, two & ~across
    listed = [
        (none, (a, b, c)),
        (one, (a, p, c)),
        (one, (p, b, c)),
        (two, (p, b, q)),
        (near, (a, p, q)),
        (near, (a, q, c)),
        (far, (a, p, c)),
        (far, (p, q, c)),
        (all_, (a, p, r)),
        (all_, (p, b, q)),
        (all_, (r, q, c)),
        (all_, (p, q, r)),
    ]
    faces = np.concatenate([np.stack([i[w], j[w], k[w]], axis=1) for w, (i, j, k) in listed])
    parent = np.concatenate([rows[w] for w, _ in listed])
    return faces.astype(np.int32), parent
