"""The surface of a solid by columns: closed meshes of its parts of either sign, vertices exact.

Over a triangle of the base the walls between its three columns (`joining`) carry curves that close
to loops. Each is filled by a fan about a place of its own, where surfaces meet or a layer ends, so
that what two triangles have in common is the same for both, and the surface is closed whatever the
columns show. Vertices are ends of layers, places where layers end and places where surfaces meet,
all on the true surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kinematics.arrays import Array
from kinematics.solids.columns import ROOT, Ints, layers
from kinematics.solids.curves import Curves, Stand, curves_of
from kinematics.solids.tiling import Tiling

SIDE = ROOT - 1
"""The label of faces where the base ends."""
BOTH = 2
"""What such faces have below them that are of the solid as a whole, whatever its signs."""
_Ways = dict[int, dict[int, list[int]]]
_NEARER = 14  # halvings of the way to where something is
_CORE = 1e-3
"""Part of the base's length on either side of a tear that is left out."""


@dataclass(frozen=True, eq=False)
class ColumnMesh:
    """Faces between what is outside (0) and the parts of either sign.

    Attributes:
        vertices: (V, 3) mm.
        faces: (F, 3) counter-clockwise seen from ``above``.
        below, above: (F,) 0, +1 or −1, or `BOTH`.
        label: (F,) the surface, see `columns.Layers`, or `SIDE`.
        over: (F,) the triangle of the base.
        twin: (W, 2) vertices at both sides of the tear that are one place of the machine.
    """

    vertices: Array
    faces: Ints
    below: NDArray[np.int8]
    above: NDArray[np.int8]
    label: NDArray[np.int16]
    over: Ints
    twin: Ints


def column_mesh(tiling: Tiling, stood: Stand) -> ColumnMesh:
    """The mesh over a tiling."""
    curves, first, plain = curves_of(tiling, stood)
    simple = np.asarray(plain[stood.edge_of].all(axis=1))
    sheets, boundary, over = _sheets(stood, first, simple)
    fans = _fans(tiling, stood, curves, np.flatnonzero(~simple))
    upright = _rims(stood, curves)
    at = np.concatenate([curves.at, fans.at])
    torn = np.concatenate([curves.torn, np.zeros(len(fans.v), dtype=np.int64)])
    (x0, x1), _ = tiling.solid.base
    at[:, 0] += _CORE * (x1 - x0) * torn
    vertices = tiling.solid.place(at, np.concatenate([curves.v, fans.v]))
    columns, vertex = stood.walls.columns, stood.triangles.corners[over, 0]
    side = len(upright.faces)
    faces = np.concatenate([sheets, fans.faces, upright.faces])
    over = np.concatenate([over, fans.over, upright.over])
    below = np.concatenate([columns.below()[vertex, boundary], fans.below, upright.inside])
    above = np.concatenate([columns.above[vertex, boundary], fans.above, np.zeros(side, np.int8)])
    label = np.concatenate(
        [columns.label[vertex, boundary], fans.label, np.full(side, SIDE, np.int16)]
    )
    for halves in curves.halves:
        faces, of = _halved(faces, halves)
        over, below, above, label = over[of], below[of], above[of], label[of]
    turned = _turned(tiling)[stood.triangles.cell[over]]
    faces[turned] = faces[turned][:, ::-1]
    return ColumnMesh(vertices, faces, below, above, label, over, _twins(stood, first))


def _halved(faces: Ints, halves: Ints) -> tuple[Ints, NDArray[np.intp]]:
    """Faces with more nodes on their edges, and which of those before each is of."""
    size = int(max(faces.max(initial=0), halves.max(initial=0))) + 1
    ends_of = np.sort(halves[:, :2], axis=1)
    key = ends_of[:, 0] * size + ends_of[:, 1]
    order = np.argsort(key)
    key, node = key[order], halves[order, 2]
    edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1), axis=-1)
    wanted = edges[..., 0] * size + edges[..., 1]
    at = np.minimum(np.searchsorted(key, wanted), max(len(key) - 1, 0))
    between = np.where(key[at] == wanted, node[at], -1) if len(key) else np.full(faces.shape, -1)
    count = (between >= 0).sum(axis=1)
    rows = np.arange(len(faces))
    kept, of = [faces[count == 0]], [rows[count == 0]]
    # Turned so that edges with a node come first.
    one, two, three = (rows[count == n] for n in (1, 2, 3))
    for chosen, start in ((one, between >= 0), (two, np.roll(between < 0, 1, axis=1))):
        shift = start[chosen].argmax(axis=1)
        pick = (shift[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(faces[chosen], pick, axis=1).T
        m, n, _ = np.take_along_axis(between[chosen], pick, axis=1).T
        if chosen is one:
            kept += [np.stack([a, m, c], axis=-1), np.stack([m, b, c], axis=-1)]
            of += [chosen] * 2
        else:
            kept += [
                np.stack([m, b, n], axis=-1),
                np.stack([a, m, n], axis=-1),
                np.stack([a, n, c], axis=-1),
            ]
            of += [chosen] * 3
    a, b, c = faces[three].T
    m, n, o = between[three].T
    corners = ((a, m, o), (m, b, n), (o, n, c), (m, n, o))
    kept += [np.stack(corner, axis=-1) for corner in corners]
    of += [three] * 4
    return np.concatenate(kept), np.concatenate(of)


def _sheets(
    stood: Stand, first: Ints, simple: NDArray[np.bool_]
) -> tuple[Ints, Ints, NDArray[np.intp]]:
    """Over triangles of three equal columns: a face for each boundary; also which boundary, and
    over which triangle."""
    corners = stood.triangles.corners
    rows = np.flatnonzero(simple)
    count = stood.walls.columns.count[corners[rows, 0]]
    over = np.repeat(rows, count)
    own = np.arange(len(over)) - np.repeat(np.cumsum(count) - count, count)
    return first[corners[over]] + own[:, None], own, over


@dataclass(frozen=True, eq=False)
class _Fans:
    """Faces (F, 3), what is below and above them, their labels and over which triangle, (F,); the
    places ``at`` (N, 2), ``v`` (N,) of new nodes."""

    faces: Ints
    below: NDArray[np.int8]
    above: NDArray[np.int8]
    label: NDArray[np.int16]
    over: Ints
    at: Array
    v: Array


def _fans(tiling: Tiling, stood: Stand, curves: Curves, odd: NDArray[np.intp]) -> _Fans:
    """Over the other triangles: what hangs together there is filled about one of its nodes."""
    order = np.argsort(curves.wall, kind="stable")
    count = np.bincount(curves.wall, minlength=len(stood.ends))
    start = np.cumsum(count) - count
    edges = stood.edge_of[odd].ravel()
    number = count[edges]
    incidence = np.repeat(np.arange(len(edges)), number)
    own = np.arange(len(incidence)) - np.repeat(np.cumsum(number) - number, number)
    curve = order[start[edges[incidence]] + own]
    triangle = odd[incidence // 3]
    along = stood.along[odd].ravel()[incidence]
    tail = np.where(along, curves.tail[curve], curves.head[curve])
    head = np.where(along, curves.head[curve], curves.tail[curve])
    nodes = len(curves.v)
    keys, local = np.unique(
        np.concatenate([triangle * nodes + tail, triangle * nodes + head]), return_inverse=True
    )
    local = local.reshape(2, -1)
    graph = coo_array((np.ones(len(tail), bool), (local[0], local[1])), shape=(len(keys),) * 2)
    count_of, part = connected_components(graph, directed=False)
    node = keys % nodes
    apex = np.full(count_of, -1, dtype=np.int64)
    apex[part] = node
    # About an end or a crease, unless its fan would stand upright in the wall that it is on.
    special = curves.wall_of[node] >= 0
    lone = part[np.flatnonzero(special)]
    apex[lone] = -1
    on = np.zeros(len(node), dtype=np.int64)
    for k in (0, 1):
        same = curves.wall_of[node[local[k]]] == curves.wall[curve]
        on += np.bincount(local[k][same], minlength=len(node))
    walls = len(stood.ends)
    key = part * walls + np.maximum(curves.wall_of[node], 0)
    wall_keys, which = np.unique(part[local[0]] * walls + curves.wall[curve], return_inverse=True)
    edges_on = np.bincount(which)
    found = np.minimum(np.searchsorted(wall_keys, key), len(wall_keys) - 1)
    fit = special & (on == edges_on[found])
    order = np.argsort(node * fit)  # ends come after creases
    fits = order[fit[order]]
    apex[part[fits]] = node[fits]
    middle = np.flatnonzero(apex < 0)
    at, v = _middles(tiling, curves, node, part, special, middle)
    apex[middle] = nodes + np.arange(len(middle))
    tip = apex[part[local[0]]]
    proper = (tip != tail) & (tip != head)
    kept = curve[proper]
    return _Fans(
        np.stack([tail, head, tip], axis=-1)[proper],
        curves.below[kept],
        curves.above[kept],
        curves.label[kept],
        triangle[proper],
        at,
        v,
    )


def _middles(
    tiling: Tiling,
    curves: Curves,
    node: Ints,
    part: NDArray[np.intp],
    special: NDArray[np.bool_],
    chosen: NDArray[np.intp],
) -> tuple[Array, Array]:
    """Places in the midst of the special nodes of ``chosen`` parts, on a limb's surface."""
    number = np.full(int(part.max(initial=-1)) + 1, -1)
    number[chosen] = np.arange(len(chosen))
    if not len(chosen):
        return np.zeros((0, 2)), np.zeros(0)
    reference = np.zeros(len(chosen))
    own = number[part] >= 0
    reference[number[part[own]]] = curves.at[node[own], 1]

    def mean(rows: NDArray[np.bool_]) -> Array:
        of, nodes = number[part[rows]], node[rows]
        count = np.maximum(np.bincount(of, minlength=len(chosen)), 1)
        y = _beside(tiling, curves.at[nodes, 1], reference[of])
        values = (curves.at[nodes, 0], y, curves.v[nodes])
        return np.stack([np.bincount(of, v, len(chosen)) / count for v in values], axis=-1)

    middle, inside = mean(own & special), mean(own & ~special)
    at, v = middle[:, :2].copy(), middle[:, 2].copy()
    # Where nothing is over the midst, as near to it as something is.
    low, high = np.zeros(len(at)), np.ones(len(at))
    for step in range(_NEARER):
        t = low if step == 0 else 0.5 * (low + high)
        tried = middle[:, :2] + t[:, None] * (inside - middle)[:, :2]
        here = layers(tiling.solid, tried)
        some = here.count > 0
        high = np.where(some, t, high)
        low = np.where(some, low, t)
        rows = np.flatnonzero(some)
        with np.errstate(invalid="ignore"):
            away = np.abs(here.at[rows] - middle[rows, 2:])
        away = np.where((here.label[rows] == ROOT) | np.isnan(away), np.inf, away)
        nearest = away.argmin(axis=1) if away.size else np.zeros(len(rows), dtype=np.intp)
        at[rows], v[rows] = tried[rows], here.at[rows, nearest]
        if some.all():
            break
    return at, v


def _beside(tiling: Tiling, y: Array, reference: Array) -> Array:
    """The second coordinate without a jump from ``reference`` where it closes."""
    if not tiling.solid.closed:
        return y
    low, high = tiling.solid.base[1]
    turn = high - low
    return np.asarray(y - turn * np.round((y - reference) / turn))


@dataclass(frozen=True, eq=False)
class _Upright:
    """Faces (F, 3) where the base ends, what is inside of them and over which triangle, (F,)."""

    faces: Ints
    inside: NDArray[np.int8]
    over: Ints


def _rims(stood: Stand, curves: Curves) -> _Upright:
    """Faces upright where the base ends, by walking around each layer on the wall: around those of
    either sign, and, as `BOTH`, around what is inside."""
    faces: list[tuple[int, int, int]] = []
    inside: list[int] = []
    over: list[int] = []
    rim = np.flatnonzero(stood.rim[stood.edge_of])
    by_wall = np.argsort(curves.wall, kind="stable")
    bounds = np.searchsorted(curves.wall[by_wall], np.arange(len(stood.ends) + 1))
    columns = stood.walls.columns
    first = np.cumsum(columns.count) - columns.count
    for corner in rim.tolist():
        triangle, k = divmod(corner, 3)
        wall = int(stood.edge_of[triangle, k])
        own = by_wall[bounds[wall] : bounds[wall + 1]]
        if not len(own):
            continue
        along = bool(stood.along[triangle, k])
        onward: dict[int, dict[int, list[int]]] = {1: {}, -1: {}, BOTH: {}}

        def go(tail: int, head: int, left: int, right: int, ways: _Ways = onward) -> None:
            for material, way in ((left, (tail, head)), (right, (head, tail))):
                if material:
                    ways[material].setdefault(way[0], []).append(way[1])
                if material and not (left and right):
                    ways[BOTH].setdefault(way[0], []).append(way[1])

        for c in own.tolist():
            ends_of = int(curves.tail[c]), int(curves.head[c])
            go(*(ends_of if along else ends_of[::-1]), int(curves.above[c]), int(curves.below[c]))
        one, other = (int(stood.ends[wall, n]) for n in (0, 1))
        for vertex, up in ((one, not along), (other, along)):
            for n in range(int(columns.count[vertex]) - 1):
                low = int(first[vertex]) + n
                go(*((low, low + 1) if up else (low + 1, low)), int(columns.above[vertex, n]), 0)
        for material, ways in onward.items():
            for loop in _loops(ways):
                # About a place between both columns, so that no face stands in one of them.
                between = [n for n, node in enumerate(loop) if curves.wall_of[node] >= 0]
                loop = loop[between[0] :] + loop[: between[0]] if between else loop
                new = [(loop[0], loop[n], loop[n + 1]) for n in range(1, len(loop) - 1)]
                faces += new
                inside += [material] * len(new)
                over += [triangle] * len(new)
    return _Upright(
        np.array(faces, dtype=np.int64).reshape(-1, 3),
        np.array(inside, dtype=np.int8),
        np.array(over, dtype=np.int64),
    )


def _loops(onward: dict[int, list[int]]) -> list[list[int]]:
    found = []
    while onward:
        start = next(iter(onward))
        loop, node = [], start
        while node in onward:
            loop.append(node)
            ways = onward[node]
            after = ways.pop()
            if not ways:
                del onward[node]
            node = after
            if node == start:
                break
        found.append(loop)
    return found


def _turned(tiling: Tiling) -> NDArray[np.bool_]:
    """(N,) whether places over cells are mirror images of (base, v)."""
    at, half = tiling.middles(), 1e-3 * tiling.halves()
    v, step = np.zeros(len(at)), 1e-3 * float(tiling.solid.high.max())
    here = tiling.solid.place(at, v)
    x = tiling.solid.place(at + half * [1.0, 0.0], v) - here
    y = tiling.solid.place(at + half * [0.0, 1.0], v) - here
    z = tiling.solid.place(at, v + step) - here
    return np.asarray(np.einsum("ni,ni->n", np.cross(x, y), z) < 0.0)


def _twins(stood: Stand, first: Ints) -> Ints:
    left, right = stood.triangles.twin.T
    count = stood.walls.columns.count[left]
    vertex = np.repeat(np.arange(len(left)), count)
    own = np.arange(len(vertex)) - np.repeat(np.cumsum(count) - count, count)
    return np.stack([first[left[vertex]] + own, first[right[vertex]] + own], axis=-1)
