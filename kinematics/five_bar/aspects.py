"""The aspects of the five-bar: parts of a working mode's workspace without a singularity inside.

In one working mode a point P has one configuration, so that the curves of parallel singularities
neither cross nor touch each other there; they end on the boundary, where the working mode changes,
or run through a base point that a limb folds onto. So the workspace and its curves are a plane map:
its faces are the aspects, and the wrenches' determinant has one sign on each.

Aspects of one sign in two working modes join where a limb is stretched or folded (or folded onto
its base point): what can be joined so, without crossing a parallel singularity, has one group, as
the workspaces of the assembly modes of Macho et al., Robotica 26 (2008). Lengths mm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from kinematics import arcs, outlines
from kinematics.arcs import Arcs, Edge
from kinematics.five_bar import workspace
from kinematics.five_bar.curves import Piece, pieces
from kinematics.five_bar.design import LIMBS, FiveBarDesign
from kinematics.five_bar.inverse import MODES, joints_of
from kinematics.five_bar.velocity import sines
from kinematics.sections import BOUNDS
from kinematics.spatial import Array

DEVIATION = 1e-6
"""Part of the size by which a drawn arc may leave the true curve."""
_SNAP = 2e-7  # of the size: an end of a curve this near to the boundary is on it
_NODES = 12
_PARALLEL = BOUNDS.index("parallel")
_LINK = BOUNDS.index("link")


@dataclass(frozen=True, eq=False)
class Aspect:
    """One part: its boundary loops, working mode, sign of the determinant, and group from 1."""

    mode: str
    sign: int
    loops: tuple[tuple[Edge, ...], ...]
    area: float
    group: int

    def holds(self, points: Array, size: float) -> np.ndarray:
        """Which points (N, 2) lie in it, to within the chords' deviation of about size/1e4."""
        held = np.zeros(len(points), dtype=bool)
        for loop in self.loops:
            held ^= outlines.contains(outlines.outline(loop, 0.01 * size), points)
        return held


@lru_cache(maxsize=64)
def aspects(design: FiveBarDesign) -> tuple[Aspect, ...]:
    """All aspects, by working mode, sign + first, the largest first."""
    found: list[Aspect] = []
    for mode in MODES:
        faces = _faces(design, mode)
        found += sorted(faces, key=lambda each: (-each.sign, -each.area))
    return _grouped(design, found)


# --- the plane map of one working mode -----------------------------------------------------


def _faces(design: FiveBarDesign, mode: str) -> list[Aspect]:
    size = design.size
    rim = [edge for loop in workspace.loops(design, (mode,)) for edge in loop]
    if not rim:
        return []
    inner = [
        curve_edge(design, piece)
        for piece in pieces(design)
        if piece.mode == mode and not piece.serial
    ]
    rim = _split(rim, [end for edge in inner for end in (edge.first, edge.last)], size)
    loops = _traced(rim, inner, size)
    areas = [_area(loop) for loop in loops]
    faces: list[list[int]] = [[n] for n, area in enumerate(areas) if area > 0.0]
    polygons = {face[0]: outlines.outline(loops[face[0]], 0.01 * size) for face in faces}
    for n, area in enumerate(areas):
        if area <= 0.0:
            probe = loops[n][0].nodes[:1]
            around = [f for f in faces if outlines.contains(polygons[f[0]], probe)[0]]
            if around:
                min(around, key=lambda f: areas[f[0]]).append(n)
    return [
        Aspect(
            mode,
            _sign(design, mode, [edge for n in face for edge in loops[n]]),
            tuple(tuple(loops[n]) for n in face),
            sum(areas[n] for n in face),
            0,
        )
        for face in faces
    ]


def _split(rim: list[Edge], points: Sequence[Array], size: float) -> list[Edge]:
    """The boundary's edges, cut where curves end on them."""
    near = _SNAP * size
    done: list[Edge] = []
    for edge in rim:
        one = edge.shown
        center, radius = one.center[0], float(one.radius[0])
        start, sweep = float(one.start[0]), float(one.sweep[0])
        at: list[tuple[float, Array]] = []
        for point in points:
            away = point - center
            if abs(float(np.hypot(*away)) - radius) > near:
                continue
            turned = float((np.arctan2(away[1], away[0]) - start) * np.sign(sweep) % (2 * np.pi))
            if near / radius < turned < abs(sweep) - near / radius:
                at.append((turned / abs(sweep), point))
        at.sort(key=lambda each: each[0])
        shares, ends = [0.0], [edge.first]
        for share, point in at:
            if share - shares[-1] > near / (radius * abs(sweep)):
                shares.append(share)
                ends.append(point)
        shares.append(1.0)
        ends.append(edge.last)
        for a, b, first, last in zip(shares[:-1], shares[1:], ends[:-1], ends[1:], strict=True):
            part = one._replace(
                start=np.array([start + sweep * a]), sweep=np.array([sweep * (b - a)])
            )
            done.append(arcs.arc_edge(part, first, last))
    return done


def _traced(rim: list[Edge], inner: list[Edge], size: float) -> list[list[Edge]]:
    """The faces' boundary loops: at each vertex the next edge to the right of the one come by.

    The outside of the boundary is no face: its edges are walked one way only.
    """
    walks = [*rim, *inner, *(edge.reversed() for edge in inner)]
    count, step = len(walks), len(inner)

    def twin(n: int) -> int:
        """The same curve the other way; the boundary has none."""
        return -1 if n < len(rim) else n + step if n < len(rim) + step else n - step

    walks, tail, head = arcs.sharing(walks, _SNAP * size)
    leaving: dict[int, list[int]] = {}
    for n in range(count):
        leaving.setdefault(int(tail[n]), []).append(n)
    back = [edge.reversed() for edge in walks]
    arriving: dict[int, list[int]] = {}
    for n in range(count):
        arriving.setdefault(int(head[n]), []).append(n)
    following: dict[int, int] = {}
    for at, comers in arriving.items():
        ways = leaving.get(at, [])
        if len(ways) == 1 == len(comers):
            following[comers[0]] = ways[0]
            continue
        # Seen from one distance, so that tangent edges are told apart by their curvatures.
        around = [*(back[n] for n in comers), *(walks[m] for m in ways)]
        reach = 0.02 * min(*(arcs.extent(edge) for edge in around), 0.1 * size)
        toward = {m: arcs.heading(walks[m], reach) for m in ways}
        for n in comers:
            came = arcs.heading(back[n], reach)
            turns = {m: (came - toward[m]) % (2 * np.pi) for m in ways}
            # Back along a curve only where there is no other way.
            turns = {m: 2 * np.pi if m == twin(n) else turn for m, turn in turns.items()}
            following[n] = min(turns, key=lambda m: turns[m])
    loops: list[list[Edge]] = []
    left = set(range(count))
    while left:
        first = min(left)
        loop, n = [], first
        while n in left:
            left.remove(n)
            loop.append(walks[n])
            n = following.get(n, -1)
        if n == first:
            loops.append(loop)
    return loops


def _sign(design: FiveBarDesign, mode: str, edges: Sequence[Edge]) -> int:
    """The determinant's sign on the left of a face's edges, by their length."""
    vote = 0.0
    for edge in edges:
        k = len(edge.nodes) // 2
        step = edge.steps[k] / np.hypot(*edge.steps[k])
        beside = edge.nodes[k] + 1e-5 * arcs.extent(edge) * np.array([-step[1], step[0]])
        joints = joints_of(design, beside, mode)
        if np.isfinite(joints).all():
            vote += float(np.sign(sines(design, beside, joints)[1])) * arcs.extent(edge)
    return 1 if vote >= 0.0 else -1


def _area(loop: Sequence[Edge]) -> float:
    return float(
        sum(0.5 * (e.nodes[:, 0] @ e.steps[:, 1] - e.nodes[:, 1] @ e.steps[:, 0]) for e in loop)
    )


# --- curves as edges -----------------------------------------------------------------------


@lru_cache(maxsize=512)
def curve_edge(design: FiveBarDesign, piece: Piece) -> Edge:
    """A piece of a curve as an edge: arcs through three points each, and a spectral rule.

    On panels of τ the points are interpolated in Chebyshev nodes and differentiated there, which
    leaves a relative error of about 1e-12 in areas.
    """
    panels = max(2, int(np.ceil(abs(piece.end - piece.start) / 0.2)))
    nodes, weights, slope = _chebyshev(_NODES)
    share = (np.arange(panels)[:, None] + 0.5 * (nodes + 1.0)) / panels
    points, _ = piece.loop.points(piece.tau(share))  # (panels, nodes, 2)
    steps = weights[:, None] * (slope @ points)
    shown, off = _as_arcs(design, piece)
    ends, _ = piece.loop.points(piece.tau([0.0, 1.0]))
    return Edge(
        ends[0],
        ends[1],
        shown,
        points.reshape(-1, 2),
        steps.reshape(-1, 2),
        lambda share: piece.loop.points(piece.tau(share))[0],
        off,
    )


def _as_arcs(design: FiveBarDesign, piece: Piece) -> tuple[Arcs, float]:
    """Arcs through three points each, and by how much they leave the curve, mm."""
    wanted = DEVIATION * design.size
    share = np.linspace(0.0, 1.0, 9)
    off = np.zeros(1)
    for _ in range(12):
        middle = 0.5 * (share[:-1] + share[1:])
        first, last = (piece.loop.points(piece.tau(s))[0] for s in (share[:-1], share[1:]))
        between = piece.loop.points(piece.tau(middle))[0]
        found = _three_points(first, between, last)
        quarters = [0.5 * (share[:-1] + middle), 0.5 * (middle + share[1:])]
        probes = [piece.loop.points(piece.tau(s))[0] - found.center for s in quarters]
        off = np.max([np.abs(np.hypot(p[:, 0], p[:, 1]) - found.radius) for p in probes], axis=0)
        wide = (off > wanted) | (np.abs(found.sweep) > 2.0)
        if not wide.any():
            break
        share = np.sort(np.concatenate([share, middle[wide]]))
    return found, float(off.max())


def _three_points(a: Array, b: Array, c: Array) -> Arcs:
    """The arcs from a over b to c, each (N, 2); of points in line one of a very large radius."""
    u, v = b - a, c - a
    twice = 2.0 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    length = np.hypot(v[:, 0], v[:, 1])
    least = 1e-12 * length**2
    twice = np.where(np.abs(twice) < least, np.where(twice < 0.0, -least, least), twice)
    uu, vv = (u**2).sum(axis=1), (v**2).sum(axis=1)
    offset = np.stack([v[:, 1] * uu - u[:, 1] * vv, u[:, 0] * vv - v[:, 0] * uu], axis=-1)
    center = a + offset / twice[:, None]
    radius = np.hypot(*(a - center).T)
    start = np.arctan2(a[:, 1] - center[:, 1], a[:, 0] - center[:, 0])
    end = np.arctan2(c[:, 1] - center[:, 1], c[:, 0] - center[:, 0])
    left = twice > 0.0
    sweep = np.where(left, (end - start) % (2 * np.pi), -((start - end) % (2 * np.pi)))
    none = np.zeros(len(a), dtype=int)
    return Arcs(center, radius, start, sweep, none, np.full(len(a), _PARALLEL))


@lru_cache(maxsize=4)
def _chebyshev(count: int) -> tuple[Array, Array, Array]:
    """Nodes on [−1, 1], Gauss weights, and the matrix that differentiates at them."""
    x, weights = np.polynomial.legendre.leggauss(count)
    apart = x[:, None] - x[None, :] + np.eye(count)
    scale = apart.prod(axis=1)
    slope = scale[:, None] / scale[None, :] / apart
    np.fill_diagonal(slope, 0.0)
    np.fill_diagonal(slope, -slope.sum(axis=1))
    return x, weights, slope


# --- what joins ----------------------------------------------------------------------------


def _grouped(design: FiveBarDesign, found: Sequence[Aspect]) -> tuple[Aspect, ...]:
    """The aspects with the numbers of their groups, from 1."""
    parent = list(range(len(found)))

    def root(n: int) -> int:
        while parent[n] != n:
            n = parent[n]
        return n

    for n, aspect in enumerate(found):
        for edge in (edge for loop in aspect.loops for edge in loop):
            if int(edge.shown.bound[0]) == _LINK:
                for m in _beyond(design, found, aspect, edge):
                    parent[root(m)] = root(n)
    for i in range(LIMBS):
        for n, m in _about_base(design, found, i):
            parent[root(m)] = root(n)
    roots = sorted({root(n) for n in range(len(found))})
    return tuple(replace(aspect, group=roots.index(root(n)) + 1) for n, aspect in enumerate(found))


def _beyond(
    design: FiveBarDesign, found: Sequence[Aspect], aspect: Aspect, edge: Edge
) -> list[int]:
    """Aspects of the same sign on the other side of a limb's stretched or folded position."""
    i = int(edge.shown.limb[0]) - 1
    flipped = _flipped(aspect.mode, i)
    k = len(edge.nodes) // 2
    middle = edge.nodes[k]
    met: list[int] = []
    for m, other in enumerate(found):
        if other.mode != flipped or other.sign != aspect.sign:
            continue
        for part in (e for loop in other.loops for e in loop):
            one = part.shown
            if int(one.bound[0]) != _LINK or int(one.limb[0]) != i + 1:
                continue
            away = middle - one.center[0]
            if abs(np.hypot(*away) - one.radius[0]) > _SNAP * design.size:
                continue
            sweep = float(one.sweep[0])
            turned = float((np.arctan2(away[1], away[0]) - one.start[0]) * np.sign(sweep))
            if turned % (2 * np.pi) <= abs(sweep):
                met.append(m)
                break
    return met


def _about_base(design: FiveBarDesign, found: Sequence[Aspect], i: int) -> list[tuple[int, int]]:
    """Pairs that join where limb i, folded onto its base point, may turn about it.

    Only where it turns freely: within a range the two sides of A_i need not be connected.
    """
    limb = design.limbs[i]
    if limb.joint_range_deg is not None:
        return []
    if abs(limb.proximal - limb.distal) > arcs.MEETING * design.size:
        return []
    angle = np.linspace(0.0, 2 * np.pi, 64, endpoint=False) + 0.01
    ring = design.base[i] + 3e-3 * design.size * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    touching = [aspect.holds(ring, design.size).any() for aspect in found]
    return [
        (n, m)
        for n, one in enumerate(found)
        for m, other in enumerate(found)
        if touching[n]
        and touching[m]
        and other.mode == _flipped(one.mode, i)
        and other.sign == one.sign
    ]


def _flipped(mode: str, i: int) -> str:
    sign = "-" if mode[i] == "+" else "+"
    return mode[:i] + sign + mode[i + 1 :]
