"""What is drawn on the walls between neighbouring columns: the curves on which faces end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.solids.columns import ROOT, Ints, Layers
from kinematics.solids.joining import Joined, Walls, joined
from kinematics.solids.meeting import creases, ends
from kinematics.solids.tiling import Tiling, Triangles


@dataclass(frozen=True, eq=False)
class Stand:
    """Columns over the vertices of a tiling, and the walls between them.

    Attributes:
        triangles: of the base.
        edge_of: (T, 3) the wall from each corner to the next.
        along: (T, 3) whether the triangle goes along it from a to b.
        walls, joints: what stands between columns, and how it hangs together.
        ends: (N, 2) the vertices of edges, on which the first walls stand.
        rim: (N,) whether an edge has a triangle on one side only.
    """

    triangles: Triangles
    edge_of: NDArray[np.intp]
    along: NDArray[np.bool_]
    walls: Walls
    joints: Joined
    ends: Ints
    rim: NDArray[np.bool_]


def stand(tiling: Tiling, columns: Layers, triangles: Triangles) -> Stand:
    """The walls of a tiling whose vertices have these ``columns``."""
    tail = triangles.corners
    head = np.roll(tail, -1, axis=1)
    along = tail < head
    a, b = np.where(along, tail, head), np.where(along, head, tail)
    key = a * len(triangles.vertices) + b
    known, first, number, count = np.unique(
        key, return_index=True, return_inverse=True, return_counts=True
    )
    edge_of = number.reshape(key.shape)
    begin = triangles.places.reshape(-1, 2)[first]
    end = np.roll(triangles.places, -1, axis=1).reshape(-1, 2)[first]
    along_first = along.ravel()[first]
    places = np.where(along_first[:, None], begin, end), np.where(along_first[:, None], end, begin)
    if tiling.solid.pole:  # straight towards it
        for one, other in (places, places[::-1]):
            at_pole = one[:, 0] == 0
            one[at_pole, 1] = other[at_pole, 1]
    ends_of = np.stack(np.divmod(known, len(triangles.vertices)), axis=-1)
    bare = Walls.on(
        tiling.points(places[0]), tiling.points(places[1]), ends_of[:, 0], ends_of[:, 1], columns
    )
    walls, joints = joined(tiling.solid, bare)
    return Stand(triangles, edge_of, along, walls, joints, ends_of, count == 1)


# --- curves on the walls -------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Curves:
    """Nodes, and curves from one to another, each on a wall from a to b.

    Attributes:
        at, v: (K, 2) and (K,) of the nodes: first those of the columns, then the others.
        torn: (K,) −1 or +1 on a side of the tear.
        wall_of: (K,) on which edge, −1 of those at its ends.
        tail, head: (C,) nodes.
        wall, below, above, label: (C,); of ``wall`` its edge.
        halves: (H, 3) two nodes that are joined, and the one between them; first one, then
            another next to the second of the two.
    """

    at: Array
    v: Array
    torn: Ints
    wall_of: Ints
    tail: Ints
    head: Ints
    wall: Ints
    below: NDArray[np.int8]
    above: NDArray[np.int8]
    label: NDArray[np.int16]
    halves: tuple[Ints, Ints]


def curves_of(tiling: Tiling, stood: Stand) -> tuple[Curves, Ints, NDArray[np.bool_]]:
    """The curves; (V,) the first node of each column; and (N,) which edges have nothing on them but
    boundaries that go on upon one surface."""
    walls, joints, columns = stood.walls, stood.joints, stood.walls.columns
    first = np.cumsum(columns.count) - columns.count
    vertex = np.repeat(np.arange(len(first)), columns.count)
    own = np.arange(len(vertex)) - first[vertex]
    where = np.concatenate([tiling.points(stood.triangles.vertices), walls.inner])
    torn_at = np.concatenate([stood.triangles.torn, _torn(stood, walls.inner_of)])
    edge_at = np.concatenate([np.full(len(stood.triangles.vertices), -1), walls.inner_of])
    at, v = [where[vertex]], [columns.at[vertex, own]]
    below_of, above_of = columns.below()[vertex, own], columns.above[vertex, own]
    label_of = columns.label[vertex, own]
    plain = joints.plain[: len(stood.ends)].copy()

    wall, i, j = joints.goes_on.T
    tail, head = first[walls.at_a[wall]] + i, first[walls.at_b[wall]] + j
    which, t, height = creases(tiling.solid, walls, joints.goes_on)
    plain[walls.of[wall[which]]] = False
    number = len(vertex)
    crease = number + np.arange(len(which))
    number += len(which)
    bent = np.zeros(len(wall), dtype=bool)
    bent[which] = True
    of_crease = wall[which]
    at.append(walls.a[of_crease] + t[:, None] * (walls.b - walls.a)[of_crease])
    v.append(height)
    tails = [tail[~bent], tail[which], crease]
    heads = [head[~bent], crease, head[which]]
    sources = [tail[~bent], tail[which], head[which]]
    on = [wall[~bent], of_crease, of_crease]

    wall, swap = joints.meets[:, 0], joints.swaps
    found = ends(tiling.solid, walls, joints)
    at += [walls.a[wall] + found.part[:, None] * (walls.b - walls.a)[wall]] * 2
    v += [found.low, found.high]
    lower, upper = number + np.arange(len(wall)), number + len(wall) + np.arange(len(wall))
    upper = np.where(swap, upper, lower)
    for side, base, to_end in ((walls.at_a, 1, True), (walls.at_b, 4, False)):
        for k in range(3):
            own = joints.meets[:, base + k]
            has = own >= 0
            node = first[side[wall[has]]] + own[has]
            end = (upper if k else lower)[has]
            tails.append(node if to_end else end)
            heads.append(end if to_end else node)
            sources.append(node)
            on.append(wall[has])
    source = np.concatenate(sources)
    below, above, label = below_of[source], above_of[source], label_of[source]
    # What ends is not as straight lines are: more places on the way there.
    number += 2 * len(wall)
    at_end, more = lower, []
    from_b = (joints.meets[:, 4:] >= 0).sum(axis=1) > (joints.meets[:, 1:4] >= 0).sum(axis=1)
    tops = np.where(from_b, joints.meets[:, 4:].max(axis=1), joints.meets[:, 1:4].max(axis=1))
    bottoms = np.where(from_b, joints.meets[:, 4], joints.meets[:, 1])
    row = first[np.where(from_b, walls.at_b[wall], walls.at_a[wall])]
    begin = np.stack([row + bottoms, row + tops])
    halves = []
    for between in found.on_the_way:
        of, top = between.of, between.highest.astype(np.intp)
        on_wall = wall[of]
        at.append(walls.a[on_wall] + between.part[:, None] * (walls.b - walls.a)[on_wall])
        v.append(between.v)
        new = np.arange(number, number + len(of))
        number += len(of)
        halves.append(np.stack([begin[top, of], at_end[of], new], axis=-1))
        begin[top, of] = new
        more.append(on_wall)
    # An upright line between both signs, seen from the other side along the way from a to b.
    tails.append(lower[swap])
    heads.append(upper[swap])
    on.append(wall[swap])
    inner = [
        columns.above[side[wall[swap]], joints.meets[swap, base]]
        for side, base in ((walls.at_b, 4), (walls.at_a, 1))
    ]
    torn = np.concatenate(
        [
            torn_at[vertex],
            _torn(stood, walls.of[np.concatenate([of_crease, wall, wall, *more])]),
        ]
    )
    curves = Curves(
        np.concatenate(at),
        np.concatenate(v),
        torn,
        np.concatenate([edge_at[vertex], walls.of[np.concatenate([of_crease, wall, wall, *more])]]),
        np.concatenate(tails),
        np.concatenate(heads),
        walls.of[np.concatenate(on)],
        np.concatenate([below, inner[0]]),
        np.concatenate([above, inner[1]]),
        np.concatenate([label, np.full(int(swap.sum()), ROOT, dtype=np.int16)]),
        (halves[0], halves[1]),
    )
    return curves, first, plain


def _torn(stood: Stand, wall: Ints) -> Ints:
    """On which side of the tear walls stand that are on it."""
    one, other = (stood.triangles.torn[stood.ends[wall, n]] for n in (0, 1))
    return np.where(one == other, one, 0)
