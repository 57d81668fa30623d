"""Closed meshes of triangles: their connected surfaces, volumes, places and creases.

A mesh here is closed by its indices; whether it is so by position as well, as in a file that knows
its vertices by nothing else, is `closed_by_position`. Lengths in mm.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from kinematics.arrays import Array

Bounds = tuple[tuple[float, float, float], tuple[float, float, float]]

# A shell thinner on the average than this part of the solid's size, or smaller than this part of
# its volume, is what rounding leaves where faces coincide, and is dropped.
SLIVER_THICKNESS = 1e-6
SLIVER_VOLUME = 1e-8


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """Triangles, counter-clockwise seen from outside; the arrays are read-only.

    Attributes:
        vertices: (V, 3) mm.
        faces: (F, 3) indices into ``vertices``.
    """

    vertices: NDArray[Any]
    faces: NDArray[Any]

    def __post_init__(self) -> None:
        self.vertices.setflags(write=False)
        self.faces.setflags(write=False)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.__post_init__()  # unpickled arrays are writeable

    def moved(self, motion: Array) -> SolidMesh:
        """Moved by a rigid motion (4, 4)."""
        return SolidMesh(self.vertices @ motion[:3, :3].T + motion[:3, 3], self.faces)


@dataclass(frozen=True, eq=False)
class Patch:
    """A named surface where it now stands: ``tag`` as given to `Solid.from_mesh`, moved by
    ``transform`` (3, 4).
    """

    tag: Hashable
    transform: Array


@dataclass(frozen=True, eq=False)
class TracedMesh:
    """A mesh of which every face knows its origin: ``patches[patch_of[f]]``, patch_of (F,)."""

    mesh: SolidMesh
    patches: tuple[Patch, ...]
    patch_of: NDArray[np.intp]


@dataclass(frozen=True)
class Piece:
    """One connected part of a solid, with its voids.

    Attributes:
        volume: mm³.
        centroid: of the volume, mm.
        bounds: the lowest and the highest corner, mm.
        sign: of the function whose zeros part a solid into such pieces, +1 or −1; 0 of others.
        volume_error: an estimate from above of |volume − true volume|, mm³; None where unknown.
    """

    volume: float
    centroid: tuple[float, float, float]
    bounds: Bounds
    sign: int = 0
    volume_error: float | None = None


# --- surfaces ----------------------------------------------------------------------------------


def face_parts(v: Array, f: NDArray[Any]) -> tuple[Array, Array, Array]:
    """Of each face: 6 × its cone's volume, 2 × its area, and its first moments (F, 3) × 24."""
    middle = _middle(v)
    a, b, c = corners(v, f, middle)
    normal = cross(b - a, c - a)
    six = np.einsum("ji,ji->i", a, normal)
    twice = np.sqrt(np.einsum("ji,ji->i", normal, normal))
    return six, twice, (six * (a + b + c + 4.0 * middle[:, None])).T


def sag(at: Array, off: Callable[[Array], Array]) -> float:
    """mm³ between flat faces and the surfaces that their corners (F, 3, 3) are on, from above.

    Args:
        off: how far points (N, 3) are off the surface of each face, (N,): a smooth measure that is
            0 on it.
    """
    middle = at.mean(axis=1)
    step = 1e-6 * float(np.ptp(at, axis=(0, 1)).max(initial=0.0)) if len(at) else 0.0
    value = off(middle)
    slope = np.stack([(off(middle + step * axis) - value) / step for axis in np.eye(3)], axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        away = np.abs(value / np.linalg.norm(slope, axis=1))
    # Where a measure is flat it tells nothing; no surface is further off than its face is long.
    away = np.fmin(away, np.linalg.norm(at - np.roll(at, 1, axis=1), axis=2).max(axis=1))
    twice = np.linalg.norm(np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]), axis=1)
    # A quadratic that is 0 in the corners is 3/4 of its middle value on the average.
    return float((0.375 * twice * away).sum())


def volume(mesh: SolidMesh) -> float:
    """mm³."""
    a, b, c = corners(mesh.vertices, mesh.faces, _middle(mesh.vertices))
    return float(np.einsum("ji,ji->", a, cross(b, c))) / 6.0


def _middle(v: Array) -> Array:
    return np.asarray(v.mean(axis=0)) if len(v) else np.zeros(3)


def corners(v: Array, f: NDArray[Any], origin: Array) -> tuple[Array, Array, Array]:
    """The faces' corners from an origin (3,), as three arrays (3, F) of x, y, z.

    With coordinates in rows numpy is some times as fast as with points in rows.
    """
    rows = (v - origin).T.copy()
    return rows[:, f[:, 0]], rows[:, f[:, 1]], rows[:, f[:, 2]]


def cross(a: Array, b: Array) -> Array:
    """a × b of vectors (3, N)."""
    (ax, ay, az), (bx, by, bz) = a, b
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def face_shells(vertices: int, f: NDArray[Any]) -> NDArray[np.intp]:
    """To which of the connected surfaces each face belongs (F,), counted from 0."""
    row = np.concatenate([f[:, 0], f[:, 1]])
    column = np.concatenate([f[:, 1], f[:, 2]])
    graph = coo_array((np.ones(len(row), bool), (row, column)), shape=(vertices, vertices))
    _, of_vertex = connected_components(graph, directed=False)
    return np.asarray(of_vertex[f[:, 0]], dtype=np.intp)


def without_slivers(
    traced: TracedMesh, thinnest: float
) -> tuple[TracedMesh, NDArray[np.intp], float]:
    """The mesh without slivers, the shell of each face, and the volume dropped, mm³."""
    v, f = traced.mesh.vertices, traced.mesh.faces
    if not len(f):
        return traced, np.zeros(0, np.intp), 0.0
    shell = face_shells(len(v), f)
    six, twice, _ = face_parts(v, f)
    volume = np.abs(np.bincount(shell, six)) / 6.0
    area = np.bincount(shell, twice) / 2.0
    size = float(np.linalg.norm(np.ptp(v, axis=0)))
    thin = 2.0 * volume <= max(SLIVER_THICKNESS * size, thinnest) * area
    sliver = thin | (volume <= SLIVER_VOLUME * volume.max())
    if not sliver.any():
        return traced, shell, 0.0
    keep = ~sliver[shell]
    return selected(traced, keep), shell[keep], float(volume[sliver].sum())


def selected(traced: TracedMesh, keep: NDArray[np.bool_]) -> TracedMesh:
    v, f = traced.mesh.vertices, traced.mesh.faces[keep]
    used = np.zeros(len(v), dtype=bool)
    used[f] = True
    mesh = SolidMesh(v[used], (np.cumsum(used) - 1)[f].astype(np.int32))
    return TracedMesh(mesh, traced.patches, traced.patch_of[keep])


# --- positions ---------------------------------------------------------------------------------


def grid_step(v: Array) -> float:
    """A power of two: its multiples up to the size of ``v`` are float32, with 2 bits to spare."""
    return 4.0 * float(np.spacing(np.float32(np.abs(v).max())))


def fine_step(size: float) -> float:
    """A power of two, far below anything of a size, of which sums of multiples are exact."""
    return 2.0 ** (math.floor(math.log2(size)) - 44)


def on_grid(traced: TracedMesh, v: Array, step: float) -> TracedMesh:
    rounded = np.round(v / step) * step + 0.0  # no negative zeros
    return TracedMesh(SolidMesh(rounded, traced.mesh.faces), traced.patches, traced.patch_of)


def sharing(v: Array) -> NDArray[np.intp]:
    """The vertices that stand where another one stands."""
    order = np.lexsort(v.T)
    same = (v[order[1:]] == v[order[:-1]]).all(axis=1)
    found = np.zeros(len(v), bool)
    found[order[1:][same]] = True
    found[order[:-1][same]] = True
    return np.flatnonzero(found)


def close_pairs(v: Array, distance: float) -> NDArray[np.intp]:
    """(P, 2) the vertices that are nearer to each other than ``distance`` mm."""
    pairs = cKDTree(v).query_pairs(distance, output_type="ndarray")
    return np.asarray(pairs, dtype=np.intp)


def parted(traced: TracedMesh, reach: float, step: float) -> TracedMesh:
    """Vertices at a shared place moved inwards, each by another part of ``reach`` mm."""
    v, f = traced.mesh.vertices.copy(), traced.mesh.faces
    shared = sharing(v)
    a, b, c = (v[f[:, n]] for n in range(3))
    faces = np.cross(b - a, c - a)
    normal = np.zeros_like(v)
    for n in range(3):
        np.add.at(normal, f[:, n], faces)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    part = reach * (1.0 + np.arange(len(shared)) % 7) / 7.0
    v[shared] -= part[:, None] * normal[shared]
    return on_grid(traced, v, step)


def is_closed(f: NDArray[Any]) -> bool:
    """Every directed edge of faces (F, 3) meets exactly one opposite edge."""
    count = int(f.max(initial=0)) + 1
    start = f.ravel().astype(np.int64)
    end = np.roll(f, -1, axis=1).ravel().astype(np.int64)
    forth = np.sort(start * count + end)
    back = np.sort(end * count + start)
    once = bool((np.diff(forth) > 0).all())
    return once and bool((forth == back).all()) and bool((start != end).all())


def closed_by_position(v: Array, f: NDArray[Any]) -> bool:
    """Whether a mesh that is closed stays so when equal places are one vertex."""
    return not len(sharing(v)) or is_closed(welded(v, f))


def welded(v: Array, f: NDArray[Any]) -> NDArray[Any]:
    """Faces (F, 3) with one number for all vertices at a place."""
    _, place = np.unique(v, axis=0, return_inverse=True)
    return np.asarray(place.reshape(-1)[f])


# --- display -----------------------------------------------------------------------------------


def shaded(traced: TracedMesh) -> SolidMesh:
    """Vertices repeated once for each patch that meets in them."""
    v, f = traced.mesh.vertices, traced.mesh.faces
    corner = f.ravel().astype(np.int64)
    patch = np.repeat(traced.patch_of, 3)
    first = np.zeros(len(v), dtype=np.int64)
    first[corner[::-1]] = patch[::-1]
    other = patch != first[corner]
    count = len(traced.patches)
    keys, which = np.unique(corner[other] * count + patch[other], return_inverse=True)
    corner[other] = len(v) + which
    return SolidMesh(
        np.concatenate([v, v[keys // count]]).astype(np.float32),
        corner.reshape(-1, 3).astype(np.uint32),
    )


# --- pieces ------------------------------------------------------------------------------------


def pieces(
    v: Array, f: NDArray[Any], shells: NDArray[np.intp], six: Array, moments: Array
) -> tuple[tuple[Piece, ...], NDArray[np.intp]]:
    """The shells as pieces, and to which of them each face belongs (F,).

    Each void is counted to the smallest piece that encloses it; −1 are faces of one in none.
    """
    solids: list[_Shell] = []
    voids: list[_Shell] = []
    order = np.argsort(shells, kind="stable")
    numbers, starts = np.unique(shells[order], return_index=True)
    volume = np.bincount(shells, six) / 6.0
    moment = np.stack([np.bincount(shells, column) for column in moments.T], axis=-1) / 24.0
    rows = v.T.copy()
    ends = np.append(starts[1:], len(order))
    for number, start, end in zip(numbers.tolist(), starts, ends[: len(starts)], strict=True):
        own = order[start:end]
        places = rows[:, f[own].ravel()]
        low, high = places.min(axis=1), places.max(axis=1)
        shell = _Shell(number, f[own], float(volume[number]), moment[number], low, high)
        (solids if shell.volume > 0.0 else voids).append(shell)
    solids.sort(key=lambda s: s.volume)
    hollow = {s.number: (s.volume, s.moment) for s in solids}
    owner = {s.number: s.number for s in solids}
    for void in voids:
        around = next((s for s in solids if s.encloses(v, v[void.faces[0, 0]])), None)
        if around is not None:
            owner[void.number] = around.number
            full, about = hollow[around.number]
            hollow[around.number] = full + void.volume, about + void.moment
    found = []
    for s in solids:
        full, about = hollow[s.number]
        bounds = (_triple(s.low), _triple(s.high))
        found.append((Piece(full, _triple(about / full), bounds), s.number))
    found.sort(key=lambda p: (-p[0].volume, p[0].bounds))
    place = {number: n for n, (_, number) in enumerate(found)}
    of_shell = np.full(int(shells.max(initial=-1)) + 1, -1, dtype=np.intp)
    for number, belongs in owner.items():
        of_shell[number] = place[belongs]
    return tuple(p for p, _ in found), of_shell[shells]


def merged(
    v: Array,
    f: NDArray[Any],
    pieces_: tuple[Piece, ...],
    piece_of: NDArray[np.intp],
    together: Callable[[Array], NDArray[np.intp]],
) -> tuple[tuple[Piece, ...], NDArray[np.intp]]:
    """Pieces and whose faces are, where those of one number are one, by places on them."""
    first = np.array([v[f[int((piece_of == n).argmax()), 0]] for n in range(len(pieces_))])
    _, number = np.unique(together(first), return_inverse=True)
    found = []
    for k in range(int(number.max()) + 1):
        own = [piece for piece, n in zip(pieces_, number, strict=True) if n == k]
        volume = sum(piece.volume for piece in own)
        moment = np.sum([np.array(piece.centroid) * piece.volume for piece in own], axis=0)
        low, high = (np.array([piece.bounds[n] for piece in own]) for n in (0, 1))
        bounds = _triple(low.min(axis=0)), _triple(high.max(axis=0))
        found.append((Piece(volume, _triple(moment / volume), bounds), k))
    found.sort(key=lambda p: (-p[0].volume, p[0].bounds))
    place = np.full(len(found) + 1, -1, dtype=np.intp)
    place[[k for _, k in found]] = np.arange(len(found))
    of = np.append(number, len(found))[piece_of]
    return tuple(piece for piece, _ in found), place[of]


@dataclass(frozen=True, eq=False)
class _Shell:
    """One connected closed surface; its volume is negative when it bounds a void."""

    number: int
    faces: NDArray[Any]
    volume: float
    moment: Array
    low: Array
    high: Array

    def encloses(self, v: Array, point: Array) -> bool:
        """Whether the surface goes round a point."""
        if (point < self.low).any() or (point > self.high).any():
            return False
        return winds_around(v, self.faces, point)


def winds_around(v: Array, f: NDArray[Any], point: Array) -> bool:
    """Whether closed surfaces go round a point: their solid angle seen from there is 4π."""
    a, b, c = corners(v, f, point)
    la, lb, lc = (np.sqrt(np.einsum("ji,ji->i", side, side)) for side in (a, b, c))
    triple = np.einsum("ji,ji->i", a, cross(b, c))
    ab, bc, ca = (np.einsum("ji,ji->i", p, q) for p, q in ((a, b), (b, c), (c, a)))
    angle = np.arctan2(triple, la * lb * lc + ab * lc + bc * la + ca * lb)
    return bool(abs(2.0 * angle.sum()) > 2.0 * np.pi)


def _triple(values: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z
