"""Solids by manifold3d and their files by trimesh; the only module that imports either.

A `Solid` remembers from which named surface each of its faces stems, through Booleans and moves
(`Solid.traced`): that tells where to crease a shaded mesh, and how far each face is from the
curved surface that it stands for. Lengths in mm.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from manifold3d import Error, Manifold, Mesh64, OpType
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from kinematics.errors import ComputationError, InputError
from kinematics.spatial import Array

Bounds = tuple[tuple[float, float, float], tuple[float, float, float]]

KINDS = ("stl", "3mf", "ply", "glb", "obj")

# A shell thinner on the average than this part of the solid's size, or smaller than this part of
# its volume, is what rounding leaves where faces coincide, and is dropped.
SLIVER_THICKNESS = 1e-6
SLIVER_VOLUME = 1e-8

# In `face_id`, 32 bits inside manifold3d, the patch stands above these bits and the plane below.
_PLANE_BITS = 24


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


@dataclass(frozen=True, eq=False)
class PlacedMesh:
    """A traced mesh moved onto the curved surfaces that it stands for.

    Attributes:
        traced: the mesh; still closed and oriented.
        residual: how far those of its vertices that were put on their surfaces are from them at
            most, mm.
        unplaced: how many could not be put on all of their surfaces.
    """

    traced: TracedMesh
    residual: float
    unplaced: int


class Solid:
    """A closed, oriented solid. Immutable; an empty one is a solid like any other.

    Every operation asks manifold3d for its status and raises `ComputationError` when it has
    not led to a valid solid.
    """

    __slots__ = ("_manifold", "_tags")

    def __init__(self, manifold: Manifold, tags: Mapping[int, tuple[Hashable, ...]]) -> None:
        status = manifold.status()
        if status != Error.NoError:
            raise ComputationError(f"the solid could not be built: {_STATUS.get(status, status)}")
        self._manifold = manifold
        self._tags = tags

    @classmethod
    def from_mesh(
        cls,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        patch: ArrayLike = 0,
        plane: ArrayLike | None = None,
        tags: Sequence[Hashable] = (None,),
    ) -> Solid:
        """A solid from a closed mesh.

        Args:
            vertices: (V, 3) mm.
            faces: (F, 3) indices, counter-clockwise seen from outside.
            patch: (F,) which of ``tags`` each face belongs to.
            plane: (F,) the same number for faces in one plane; these may be retriangulated.
            tags: names of the surfaces, kept through every later operation.

        Raises:
            ComputationError: NaN, or not a closed oriented manifold.
        """
        v = np.array(vertices, dtype=float, order="C")
        f = np.array(faces, dtype=np.uint64, order="C").reshape(-1, 3)
        if not len(f):
            return cls(Manifold(), {})
        planes = np.arange(len(f)) if plane is None else np.asarray(plane)
        face_id = (np.asarray(patch, dtype=np.uint64) << np.uint64(_PLANE_BITS)) + planes.astype(
            np.uint64
        )
        source = Manifold.reserve_ids(1)
        mesh = Mesh64(
            v,
            f,
            run_index=np.array([0, f.size], dtype=np.uint64),
            run_original_id=np.array([source], dtype=np.uint32),
            face_id=face_id,
        )
        return cls(Manifold(mesh), {source: tuple(tags)})

    # --- operations

    @staticmethod
    def union(solids: Iterable[Solid]) -> Solid:
        """What lies in any of them; the empty solid of none."""
        return Solid._batch(tuple(solids), OpType.Add)

    @staticmethod
    def intersection(solids: Iterable[Solid]) -> Solid:
        """What lies in all of them.

        Raises:
            InputError: there is none to intersect.
        """
        operands = tuple(solids)
        if not operands:
            raise InputError("an intersection needs at least one solid")
        return Solid._batch(operands, OpType.Intersect)

    def difference(self, others: Iterable[Solid]) -> Solid:
        """What lies in this and in none of ``others``."""
        return Solid._batch((self, *others), OpType.Subtract)

    @staticmethod
    def _batch(solids: tuple[Solid, ...], operation: OpType) -> Solid:
        tags: dict[int, tuple[Hashable, ...]] = {}
        for solid in solids:
            tags.update(solid._tags)  # noqa: SLF001
        manifolds = [solid._manifold for solid in solids]  # noqa: SLF001
        return Solid(Manifold.batch_boolean(manifolds, operation), tags)

    def translated(self, offset: ArrayLike) -> Solid:
        """Moved by ``offset`` (3,) mm."""
        x, y, z = (float(v) for v in np.asarray(offset, dtype=float))
        return Solid(self._manifold.translate((x, y, z)), self._tags)

    def transformed(self, matrix: ArrayLike) -> Solid:
        """Moved by a rotation (3, 3) or a rigid motion (3, 4) or (4, 4)."""
        m = np.zeros((3, 4))
        given = np.asarray(matrix, dtype=float)[:3]
        m[:, : given.shape[1]] = given
        return Solid(self._manifold.transform(m), self._tags)

    def simplified(self, tolerance: float) -> Solid:
        """Without edges shorter than ``tolerance`` mm; no surface moves further than that."""
        return Solid(self._manifold.simplify(tolerance), self._tags)

    # --- measures

    @property
    def volume(self) -> float:
        """mm³."""
        return float(self._manifold.volume())

    @property
    def area(self) -> float:
        """mm²."""
        return float(self._manifold.surface_area())

    @property
    def bounds(self) -> Bounds | None:
        """The lowest and the highest corner, mm; None of an empty solid."""
        if self.is_empty:
            return None
        x0, y0, z0, x1, y1, z1 = (float(v) for v in self._manifold.bounding_box())
        return (x0, y0, z0), (x1, y1, z1)

    @property
    def is_empty(self) -> bool:
        return bool(self._manifold.is_empty())

    @property
    def triangles(self) -> int:
        return int(self._manifold.num_tri())

    def shells(self) -> tuple[Solid, ...]:
        """The connected surfaces, each as a solid; one with negative volume bounds a void."""
        return tuple(Solid(shell, self._tags) for shell in self._manifold.decompose())

    # --- meshes

    def mesh(self) -> SolidMesh:
        """The surface: float64 vertices, int32 faces."""
        return _mesh(self._manifold.to_mesh64())

    def traced(self) -> TracedMesh:
        """The surface, with the patch and the placement of every face."""
        raw = self._manifold.to_mesh64()
        mesh = _mesh(raw)
        label = np.array(raw.face_id, dtype=np.int64) >> _PLANE_BITS
        ends = np.array(raw.run_index, dtype=np.int64) // 3
        run = np.repeat(np.arange(len(ends) - 1), np.diff(ends))
        # Patches are numbered densely: (run, label) -> position among those that occur.
        stride = int(label.max(initial=0)) + 1
        keys, patch_of = np.unique(run * stride + label, return_inverse=True)
        patches = []
        for key in keys:
            r, number = divmod(int(key), stride)
            tag = self._tags[int(raw.run_original_id[r])][number]
            patches.append(Patch(tag, np.array(raw.run_transform[r]).T))
        return TracedMesh(mesh, tuple(patches), patch_of)


def _mesh(raw: Mesh64) -> SolidMesh:
    return SolidMesh(
        np.array(raw.vert_properties[:, :3], dtype=np.float64),
        np.array(raw.tri_verts, dtype=np.int32),
    )


_STATUS = {
    Error.NonFiniteVertex: "a vertex is NaN or infinite",
    Error.NotManifold: "its surface is not closed",
    Error.VertexOutOfBounds: "a face names a vertex that does not exist",
    Error.ResultTooLarge: "it has too many triangles",
}


# --- a solid made ready to show and to export ------------------------------------------------


@dataclass(frozen=True)
class Piece:
    """One connected part of a solid, with its voids.

    Attributes:
        volume: mm³.
        centroid: of the volume, mm.
        bounds: the lowest and the highest corner, mm.
    """

    volume: float
    centroid: tuple[float, float, float]
    bounds: Bounds


@dataclass(frozen=True, eq=False)
class BuiltSolid:
    """A finished solid: plain arrays and numbers, ready to cross to another process.

    Attributes:
        mesh: the closed surface in the solid's own frame, float64 and int32. Of facets every
            coordinate is also a float32, so that no file format moves a vertex; the vertices of a
            true surface stand where they should, and stay apart when a file rounds them.
        shaded: the same surface for display, float32 and uint32; a vertex is repeated where
            surfaces meet, so that normals averaged per vertex keep the creases sharp.
        volume: of ``mesh``, mm³.
        volume_error: an estimate from above of |volume − true volume|, mm³.
        area: of ``mesh``, mm².
        pieces: the connected parts, the largest first; none of an empty solid. Slivers
            (`SLIVER_THICKNESS`, `SLIVER_VOLUME`, ``thinnest`` of `finish`) are neither here nor
            in ``mesh``.
        watertight: the surface is closed, also when its vertices are known by position only.
        triangles: number of faces.
        residual: how far the vertices are from the true surfaces at most, mm, but for
            ``unplaced`` ones; None of facets, which are right on the average instead.
        unplaced: how many vertices could not be put on all of the surfaces that meet there.
    """

    mesh: SolidMesh
    shaded: SolidMesh
    volume: float
    volume_error: float
    area: float
    pieces: tuple[Piece, ...]
    watertight: bool
    triangles: int
    residual: float | None = None
    unplaced: int = 0


def finish(
    solid: Solid,
    error: Callable[[TracedMesh, float], float],
    *,
    thinnest: float = 0.0,
    place: Callable[[TracedMesh, float], PlacedMesh] | None = None,
) -> BuiltSolid:
    """Slivers dropped, vertices set on a float32 grid, pieces found, creases split.

    Args:
        solid: what to finish.
        error: estimates |mesh volume − true volume| from a traced mesh and its volume, mm³.
        thinnest: a shell thinner than this on the average (2 volume / area, mm) is dropped too.
        place: moves the mesh onto true surfaces, given the distance (mm) that its vertices must
            keep; where they do not the facets stay.
    """
    traced, shells, dropped = _without_slivers(solid.traced(), thinnest)
    traced, shells, moved = _rounded(solid, traced, shells, thinnest)
    placed: PlacedMesh | None = None
    if place is not None and len(traced.mesh.faces):
        apart = 0.75 * _grid(traced.mesh.vertices)  # facets keep a whole step
        placed = place(traced, apart)
        if len(close_pairs(placed.traced.mesh.vertices, apart)):
            placed = None
        else:
            traced = placed.traced
            shells = _shells(len(traced.mesh.vertices), traced.mesh.faces)
    v, f = traced.mesh.vertices, traced.mesh.faces
    six, twice, moments = _parts(v, f)
    volume, area = float(six.sum()) / 6.0, float(twice.sum()) / 2.0
    return BuiltSolid(
        mesh=traced.mesh,
        shaded=_shaded(traced),
        volume=volume,
        # Twice what was dropped: as much again may never have been meshed.
        volume_error=error(traced, volume) + 2.0 * dropped + moved * area,
        area=area,
        pieces=_pieces(v, f, shells, six, moments),
        watertight=_closed_by_position(v, f),
        triangles=len(f),
        residual=None if placed is None else placed.residual,
        unplaced=0 if placed is None else placed.unplaced,
    )


def _parts(v: Array, f: NDArray[Any]) -> tuple[Array, Array, Array]:
    """Of each face: 6 × its cone's volume, 2 × its area, and its first moments (F, 3) × 24."""
    middle = v.mean(axis=0) if len(v) else np.zeros(3)
    a, b, c = (v[f[:, n]] - middle for n in range(3))
    normal = np.cross(b - a, c - a)
    six = np.einsum("ij,ij->i", a, normal)
    twice = np.sqrt(np.einsum("ij,ij->i", normal, normal))
    return six, twice, six[:, None] * (a + b + c + 4.0 * middle)


def _shells(vertices: int, f: NDArray[Any]) -> NDArray[np.intp]:
    """To which of the connected surfaces each face belongs (F,), counted from 0."""
    row = np.concatenate([f[:, 0], f[:, 1]])
    column = np.concatenate([f[:, 1], f[:, 2]])
    graph = coo_array((np.ones(len(row), bool), (row, column)), shape=(vertices, vertices))
    _, of_vertex = connected_components(graph, directed=False)
    return np.asarray(of_vertex[f[:, 0]], dtype=np.intp)


def _without_slivers(
    traced: TracedMesh, thinnest: float
) -> tuple[TracedMesh, NDArray[np.intp], float]:
    """The mesh without slivers, the shell of each face, and the volume dropped, mm³."""
    v, f = traced.mesh.vertices, traced.mesh.faces
    if not len(f):
        return traced, np.zeros(0, np.intp), 0.0
    shell = _shells(len(v), f)
    six, twice, _ = _parts(v, f)
    volume = np.abs(np.bincount(shell, six)) / 6.0
    area = np.bincount(shell, twice) / 2.0
    size = float(np.linalg.norm(np.ptp(v, axis=0)))
    thin = 2.0 * volume <= max(SLIVER_THICKNESS * size, thinnest) * area
    sliver = thin | (volume <= SLIVER_VOLUME * volume.max())
    if not sliver.any():
        return traced, shell, 0.0
    keep = ~sliver[shell]
    return _selected(traced, keep), shell[keep], float(volume[sliver].sum())


def _selected(traced: TracedMesh, keep: NDArray[np.bool_]) -> TracedMesh:
    f = traced.mesh.faces[keep]
    used, packed = np.unique(f, return_inverse=True)
    mesh = SolidMesh(traced.mesh.vertices[used], packed.reshape(-1, 3).astype(np.int32))
    return TracedMesh(mesh, traced.patches, traced.patch_of[keep])


# --- positions: a file such as STL knows its vertices by nothing else ---------------------------


def _rounded(
    solid: Solid, traced: TracedMesh, shells: NDArray[np.intp], thinnest: float
) -> tuple[TracedMesh, NDArray[np.intp], float]:
    """Every vertex on the grid and, if that can be had, at a place of its own.

    Vertices that fall together are mostly ends of an edge shorter than the grid: collapse it.
    What remains are surfaces that touch: move them apart by some steps of the grid.

    Returns the mesh, the shell of each face, and how far whole surfaces may have moved, mm.
    """
    if not len(traced.mesh.faces):
        return traced, shells, 0.0
    step = _grid(traced.mesh.vertices)
    result = _on_grid(traced, traced.mesh.vertices, step)
    if not len(_shared(result.mesh.vertices)):
        return result, shells, 0.0
    moved = 0.0
    for moved in (2.0 * step, 16.0 * step):
        simpler, shells, _ = _without_slivers(solid.simplified(moved).traced(), thinnest)
        result = _on_grid(simpler, simpler.mesh.vertices, step)
        if not len(_shared(result.mesh.vertices)):
            return result, shells, moved
    for reach in (4.0, 16.0, 64.0, 256.0):
        result = _parted(result, reach * step, step)
        if not len(_shared(result.mesh.vertices)):
            break
    return result, shells, moved


def _grid(v: Array) -> float:
    """A power of two: its multiples up to the size of ``v`` are float32, with 2 bits to spare."""
    return 4.0 * float(np.spacing(np.float32(np.abs(v).max())))


def _on_grid(traced: TracedMesh, v: Array, step: float) -> TracedMesh:
    rounded = np.round(v / step) * step + 0.0  # no negative zeros
    return TracedMesh(SolidMesh(rounded, traced.mesh.faces), traced.patches, traced.patch_of)


def _shared(v: Array) -> NDArray[np.intp]:
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


def _parted(traced: TracedMesh, reach: float, step: float) -> TracedMesh:
    """Vertices at a shared place moved inwards, each by another part of ``reach`` mm."""
    v, f = traced.mesh.vertices.copy(), traced.mesh.faces
    shared = _shared(v)
    a, b, c = (v[f[:, n]] for n in range(3))
    faces = np.cross(b - a, c - a)
    normal = np.zeros_like(v)
    for n in range(3):
        np.add.at(normal, f[:, n], faces)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    part = reach * (1.0 + np.arange(len(shared)) % 7) / 7.0
    v[shared] -= part[:, None] * normal[shared]
    return _on_grid(traced, v, step)


def _closed_by_position(v: Array, f: NDArray[Any]) -> bool:
    """Every directed edge meets exactly one opposite edge when equal places are one vertex."""
    if not len(_shared(v)):
        return True  # then the surface is as closed as it came from manifold3d
    _, place = np.unique(v, axis=0, return_inverse=True)
    welded = place.reshape(-1)[f]
    start = welded.ravel()
    end = np.roll(welded, -1, axis=1).ravel()
    forth = np.sort(start * len(v) + end)
    back = np.sort(end * len(v) + start)
    once = bool((np.diff(forth) > 0).all())
    return once and bool((forth == back).all()) and bool((start != end).all())


# --- display -----------------------------------------------------------------------------------


def _shaded(traced: TracedMesh) -> SolidMesh:
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


def _pieces(
    v: Array, f: NDArray[Any], shells: NDArray[np.intp], six: Array, moments: Array
) -> tuple[Piece, ...]:
    """The shells as pieces, each void counted to the smallest piece that encloses it."""
    solids: list[_Shell] = []
    voids: list[_Shell] = []
    for number in np.unique(shells):
        own = shells == number
        corners = v[f[own]].reshape(-1, 3)
        shell = _Shell(
            f[own],
            float(six[own].sum()) / 6.0,
            moments[own].sum(axis=0) / 24.0,
            corners.min(axis=0),
            corners.max(axis=0),
        )
        (solids if shell.volume > 0.0 else voids).append(shell)
    solids.sort(key=lambda s: s.volume)
    hollow = {id(s): (s.volume, s.moment) for s in solids}
    for void in voids:
        owner = next((s for s in solids if s.encloses(v, v[void.faces[0, 0]])), None)
        if owner is not None:
            volume, moment = hollow[id(owner)]
            hollow[id(owner)] = volume + void.volume, moment + void.moment
    pieces = []
    for s in solids:
        volume, moment = hollow[id(s)]
        bounds = (_triple(s.low), _triple(s.high))
        pieces.append(Piece(volume, _triple(moment / volume), bounds))
    return tuple(sorted(pieces, key=lambda p: (-p.volume, p.bounds)))


@dataclass(frozen=True, eq=False)
class _Shell:
    """One connected closed surface; its volume is negative when it bounds a void."""

    faces: NDArray[Any]
    volume: float
    moment: Array
    low: Array
    high: Array

    def encloses(self, v: Array, point: Array) -> bool:
        """Whether the surface goes round a point: its solid angle seen from there is 4π."""
        if (point < self.low).any() or (point > self.high).any():
            return False
        a, b, c = (v[self.faces[:, n]] - point for n in range(3))
        la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        triple = np.einsum("ij,ij->i", a, np.cross(b, c))
        ab, bc, ca = (np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a)))
        angle = np.arctan2(triple, la * lb * lc + ab * lc + bc * la + ca * lb)
        return bool(abs(2.0 * angle.sum()) > 2.0 * np.pi)


def _triple(values: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z


# --- files -------------------------------------------------------------------------------------


def encode(mesh: SolidMesh, kind: str) -> bytes:
    """The bytes of a file of ``kind``, one of `KINDS`.

    Coordinates are mm in every format. 3MF says so in its unit, STL in its header, PLY and OBJ
    in a comment, GLB in ``asset.extras``: glTF means metres, but a designer who loads the same
    solid from two files wants the same numbers.

    Raises:
        InputError: there is no such kind, or the mesh has no faces.
        ComputationError: the mesh is not a closed surface of finite numbers.
    """
    if kind not in KINDS:
        raise InputError(f"there is no export as {kind!r}; use one of {', '.join(KINDS)}")
    if not len(mesh.faces):
        raise InputError("the solid is empty, there is nothing to export")
    Solid.from_mesh(mesh.vertices, mesh.faces)  # raises on NaN and on an open surface
    import trimesh  # slow to import, and only exports need it

    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    return _ENCODERS[kind](surface)


def _stl(surface: Any) -> bytes:
    data: bytes = surface.export(file_type="stl")
    return b"Bohemia: binary STL, unit mm".ljust(80) + data[80:]


def _3mf(surface: Any) -> bytes:
    surface.units = "mm"
    data: bytes = surface.export(file_type="3mf")
    return data


def _ply(surface: Any) -> bytes:
    data: bytes = surface.export(file_type="ply")
    first, rest = data.split(b"\n", 2)[:2], data.split(b"\n", 2)[2]
    return b"\n".join([*first, b"comment Bohemia, unit mm", rest])


def _glb(surface: Any) -> bytes:
    def stated(tree: dict[str, Any]) -> None:
        tree["asset"]["extras"] = {"unit": "mm"}

    scene = surface.scene()
    data: bytes = scene.export(file_type="glb", tree_postprocessor=stated)
    return data


def _obj(surface: Any) -> bytes:
    text: str = surface.export(file_type="obj", header="Bohemia, unit mm", digits=9)
    return text.encode()


_ENCODERS: dict[str, Callable[[Any], bytes]] = {
    "stl": _stl,
    "3mf": _3mf,
    "ply": _ply,
    "glb": _glb,
    "obj": _obj,
}
