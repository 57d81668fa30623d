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

from kinematics.answers.sections import BOUNDS
from kinematics.arrays import Array
from kinematics.mechanisms.five_bar import workspace
from kinematics.mechanisms.five_bar.curve_edges import curve_edge
from kinematics.mechanisms.five_bar.curve_pieces import pieces
from kinematics.mechanisms.five_bar.design import LIMBS, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import MODES, joints_of
from kinematics.mechanisms.five_bar.statics import sines
from kinematics.plane import arcs, regions
from kinematics.plane.arcs import Edge

_SNAP = 2e-7  # of the size: an end of a curve this near to the boundary is on it
_ON = 1e-9  # of the size: a curve this near to the boundary all along is a part of it
_OTHERS = (1e-9, 3e-6, 1e-11)  # where that fails
_FILLED = 1e-12  # of the size²: by how much all faces together may miss the workspace
_LINK = BOUNDS.index("link")


@dataclass(frozen=True, eq=False)
class Aspect:
    """One part: its boundary loops, working mode, sign of the determinant, and group from 1.

    ``area_error``: mm², an estimate from above of the error of ``area``.
    """

    mode: str
    sign: int
    loops: tuple[tuple[Edge, ...], ...]
    area: float
    group: int
    area_error: float

    def holds(self, points: Array, size: float) -> np.ndarray:
        """Which points (N, 2) lie in it, to within the chords' deviation of about size/1e4."""
        held = np.zeros(len(points), dtype=bool)
        for loop in self.loops:
            held ^= regions.contains(regions.outline(loop, 0.01 * size), points)
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
    """The faces of one mode's map, which together fill its workspace.

    What does not is told again with points held apart, or together, that are nearer or farther; if
    nothing helps, the faces say by how much they fail.
    """
    loops = workspace.loops(design, (mode,))
    if not loops:
        return []
    inner = [
        curve_edge(design, piece)
        for piece in pieces(design)
        if piece.mode == mode and not piece.serial
    ]
    rim = [edge for loop in loops for edge in loop]
    inner = [edge for edge in inner if not _on(edge, rim, _ON * design.size)]
    whole = sum(_area(loop) for loop in loops)
    best: list[Aspect] = []
    least = np.inf
    for near in (_SNAP, *_OTHERS):
        faces = _told(design, mode, rim, inner, near)
        missing = abs(sum(face.area for face in faces) - whole)
        negative = -sum(min(face.area, 0.0) for face in faces)
        if missing + negative < least:
            best, least = faces, missing + negative
        if least <= _FILLED * design.size**2:
            return best
    return [replace(face, area_error=face.area_error + least) for face in best]


def _on(edge: Edge, rim: Sequence[Edge], near: float) -> bool:
    """Whether a curve runs along an edge of the boundary, and so divides nothing."""
    k = len(edge.nodes) // 2
    for one in (each.shown for each in rim):
        away = edge.nodes - one.center
        if np.abs(np.hypot(away[:, 0], away[:, 1]) - one.radius).max() <= near:
            turned = (np.arctan2(away[k, 1], away[k, 0]) - one.start[0]) * np.sign(one.sweep[0])
            if turned % (2 * np.pi) <= abs(one.sweep[0]):
                return True
    return False


def _told(
    design: FiveBarDesign, mode: str, rim: list[Edge], inner: list[Edge], near: float
) -> list[Aspect]:
    """The faces between a boundary and the curves within; points ``near`` (of the size) are one."""
    size = design.size
    rim = _split(rim, [end for edge in inner for end in (edge.first, edge.last)], near * size)
    loops = _traced(rim, inner, size, near * size)
    areas = [_area(loop) for loop in loops]
    faces: list[list[int]] = [[n] for n, area in enumerate(areas) if area > 0.0]
    polygons = {face[0]: regions.outline(loops[face[0]], 0.01 * size) for face in faces}
    for n, area in enumerate(areas):
        if area <= 0.0:
            # What lies within a hole has no larger area; the face around it has.
            probes = np.concatenate([edge.nodes for edge in loops[n]])
            around = [
                f
                for f in faces
                if areas[f[0]] > (1.0 + 1e-9) * abs(area)
                and regions.contains(polygons[f[0]], probes).mean() > 0.5
            ]
            if around:
                min(around, key=lambda f: areas[f[0]]).append(n)
    return [
        Aspect(
            mode,
            _sign(design, mode, [edge for n in face for edge in loops[n]]),
            tuple(tuple(loops[n]) for n in face),
            sum(areas[n] for n in face),
            0,
            sum(edge.area_error for n in face for edge in loops[n]),
        )
        for face in faces
    ]


def _split(rim: list[Edge], points: Sequence[Array], near: float) -> list[Edge]:
    """The boundary's edges, cut where curves end on them."""
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


def _traced(rim: list[Edge], inner: list[Edge], size: float, near: float) -> list[list[Edge]]:
    """The faces' boundary loops: at each vertex the next edge to the right of the one come by.

    The outside of the boundary is no face: its edges are walked one way only.
    """
    walks = [*rim, *inner, *(edge.reversed() for edge in inner)]
    count, step = len(walks), len(inner)

    def twin(n: int) -> int:
        """The same curve the other way; the boundary has none."""
        return -1 if n < len(rim) else n + step if n < len(rim) + step else n - step

    walks, tail, head = arcs.sharing(walks, near)
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
    nodes = np.concatenate([edge.nodes for edge in loop])
    steps = np.concatenate([edge.steps for edge in loop])
    return float(arcs.moments(nodes - nodes.mean(axis=0), steps)[0])  # so it keeps its digits


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
