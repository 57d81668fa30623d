"""Solids by manifold3d; the only module that imports it.

A `Solid` remembers from which named surface each of its faces stems, through Booleans and moves
(`Solid.traced`): that tells where to crease a shaded mesh, and how far each face is from the
curved surface that it stands for. Lengths in mm.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from manifold3d import Error, Manifold, Mesh64, OpType, triangulate
from numpy.typing import ArrayLike, NDArray

from kinematics.errors import ComputationError, InputError
from kinematics.solids import meshes
from kinematics.solids.edges import crease_lines
from kinematics.solids.meshes import Bounds, Patch, Piece, SolidMesh, TracedMesh, close_pairs

__all__ = [
    "Bounds",
    "BuiltSolid",
    "LeakError",
    "Patch",
    "Piece",
    "PlacedMesh",
    "Solid",
    "SolidMesh",
    "TracedMesh",
    "close_pairs",
    "finish",
    "rounded",
]

# In `face_id`, 32 bits inside manifold3d, the patch stands above these bits and the plane below.
_PLANE_BITS = 24


class LeakError(ComputationError):
    """A solid whose surface is not closed once its vertices are known by position only."""

    def __init__(self) -> None:
        super().__init__("the solid's surface could not be closed; try another resolution")


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

    @classmethod
    def of(cls, built: BuiltSolid, vertices: ArrayLike | None = None) -> Solid:
        """A finished solid again, to be cut; its smooth patches stay apart.

        Args:
            vertices: (V, 3) where those of its mesh are to be; None: where they are.
        """
        mesh, shaded = built.mesh, built.shaded
        patch = meshes.face_shells(len(shaded.vertices), shaded.faces)
        count = int(patch.max(initial=-1)) + 1
        places = mesh.vertices if vertices is None else vertices
        return cls.from_mesh(places, mesh.faces, patch=patch, tags=range(count) or (None,))

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

    def split(self, cutter: Solid) -> tuple[Solid, Solid]:
        """What of this lies inside another solid, and what outside of it."""
        inside, outside = self._manifold.split(cutter._manifold)
        tags = {**self._tags, **cutter._tags}
        return Solid(inside, tags), Solid(outside, tags)

    @staticmethod
    def composed(shells: Iterable[Solid]) -> Solid:
        """One solid of `shells` that do not meet; voids among them go where they were."""
        chosen = tuple(shells)
        tags: dict[int, tuple[Hashable, ...]] = {}
        for shell in chosen:
            tags.update(shell._tags)  # noqa: SLF001
        return Solid(Manifold.compose([shell._manifold for shell in chosen]), tags)  # noqa: SLF001

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
        piece_of: (F,) to which of ``pieces`` a face belongs, where the solid was parted by the
            zeros of a function (`partition`), or pieces have several shells; None of others. Pieces
            that touch are closed each for itself, and what parts them is in the mesh twice, once
            for either side.
        on_locus: (F,) whether a face lies on these zeros; None likewise.
        locus_residual: how far the vertices of such faces are from the zeros at most, mm, but for
            ``locus_unplaced`` ones at the rim, which are on chords; None likewise.
        note: what else must be said of it: why its error is larger than its resolution promises,
            or what is not sure; "" as a rule.
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
    piece_of: NDArray[np.intp] | None = None
    on_locus: NDArray[np.bool_] | None = None
    locus_residual: float | None = None
    locus_unplaced: int = 0
    note: str = ""

    @cached_property
    def edges(self) -> NDArray[np.float32]:
        """The sharp edges of ``shaded``, (E, 2, 3) mm; they go along to another process once they
        have been asked for.
        """
        return crease_lines(self.shaded.vertices, self.shaded.faces)

    @cached_property
    def owner(self) -> NDArray[np.intp]:
        """(F,) to which of ``pieces`` each face belongs, or −1; goes along as ``edges`` do."""
        if self.piece_of is not None:
            return self.piece_of
        v, f = self.mesh.vertices, self.mesh.faces
        shells = meshes.face_shells(len(v), f)
        six, _, moments = meshes.face_parts(v, f)
        return meshes.pieces(v, f, shells, six, moments)[1]

    def piece_at(self, point: ArrayLike) -> int | None:
        """Which of the pieces holds a point (3,) of the solid's own frame; None: none does."""
        p = np.asarray(point, dtype=float)
        v, f = self.mesh.vertices, self.mesh.faces
        for n, piece in enumerate(self.pieces):
            low, high = piece.bounds
            near = (p >= low).all() and (p <= high).all()
            if near and meshes.winds_around(v, f[self.owner == n], p):
                return n
        return None

    def piece_mesh(self, n: int) -> SolidMesh:
        """One of the pieces of a solid that was parted, as a closed mesh of its own.

        Raises:
            InputError: there is no such piece.
        """
        if self.piece_of is None or not 0 <= n < len(self.pieces):
            raise InputError(f"there is no piece {n + 1} of {len(self.pieces)}")
        return _part_of(self.mesh, self.piece_of == n)

    def locus_mesh(self) -> SolidMesh:
        """The faces on the zeros of the function that parted the solid, once, as an open mesh.

        Its faces look from where the function is positive.
        """
        if self.piece_of is None or self.on_locus is None:
            return _part_of(self.mesh, np.zeros(len(self.mesh.faces), dtype=bool))
        sign = np.array([piece.sign for piece in self.pieces], dtype=int)
        return _part_of(self.mesh, self.on_locus & (sign[self.piece_of] > 0))


def _part_of(mesh: SolidMesh, keep: NDArray[np.bool_]) -> SolidMesh:
    used, packed = np.unique(mesh.faces[keep], return_inverse=True)
    return SolidMesh(mesh.vertices[used], packed.reshape(-1, 3).astype(np.int32))


def finish(
    solid: Solid,
    error: Callable[[TracedMesh, float], float],
    *,
    thinnest: float = 0.0,
    place: Callable[[TracedMesh, float], PlacedMesh] | None = None,
    together: Callable[[NDArray[np.float64]], NDArray[np.intp]] | None = None,
    total: bool = False,
) -> BuiltSolid:
    """Slivers dropped, vertices set on a float32 grid, pieces found, creases split.

    Args:
        solid: what to finish.
        error: estimates |mesh volume − true volume| from a traced mesh and its volume, mm³.
        thinnest: a shell thinner than this on the average (2 volume / area, mm) is dropped too.
        place: moves the mesh onto true surfaces, given the distance (mm) that its vertices must
            keep; where they do not the facets stay.
        together: numbers of pieces, by places (N, 3) on them: shells that have one number are one
            piece.
        total: ``error`` is all of it, whatever was dropped or moved.

    Raises:
        LeakError: the surface could not be closed.
    """
    traced, shells, dropped = meshes.without_slivers(solid.traced(), thinnest)
    before = meshes.volume(traced.mesh)
    traced, shells, moved = rounded(solid, traced, shells, thinnest)
    parts = meshes.face_parts(traced.mesh.vertices, traced.mesh.faces)
    shifted = abs(float(parts[0].sum()) / 6.0 - before)  # plane faces are moved as a whole
    placed: PlacedMesh | None = None
    if place is not None and len(traced.mesh.faces):
        apart = 0.75 * meshes.grid_step(traced.mesh.vertices)  # facets keep a whole step
        placed = place(traced, apart)
        moved_mesh = placed.traced.mesh
        if len(close_pairs(moved_mesh.vertices, apart)) or not meshes.is_closed(moved_mesh.faces):
            placed = None
        else:
            traced = placed.traced
            shells = meshes.face_shells(len(traced.mesh.vertices), traced.mesh.faces)
            parts = meshes.face_parts(traced.mesh.vertices, traced.mesh.faces)
    v, f = traced.mesh.vertices, traced.mesh.faces
    six, twice, moments = parts
    volume, area = float(six.sum()) / 6.0, float(twice.sum()) / 2.0
    pieces, piece_of = meshes.pieces(v, f, shells, six, moments)
    several = len(pieces)
    if together is not None and several:
        pieces, piece_of = meshes.merged(v, f, pieces, piece_of, together)
    if not meshes.closed_by_position(v, f):
        raise LeakError
    # Twice what was dropped: as much again may never have been meshed.
    lost = 0.0 if total else 2.0 * dropped + moved * area + shifted
    built = BuiltSolid(
        mesh=traced.mesh,
        shaded=meshes.shaded(traced),
        volume=volume,
        volume_error=error(traced, volume) + lost,
        area=area,
        pieces=pieces,
        watertight=True,
        triangles=len(f),
        piece_of=None if len(pieces) == several else piece_of,
        residual=None if placed is None else placed.residual,
        unplaced=0 if placed is None else placed.unplaced,
    )
    built.__dict__["owner"] = piece_of  # known already
    return built


# --- positions: a file such as STL knows its vertices by nothing else ---------------------------


def rounded(
    solid: Solid,
    traced: TracedMesh,
    shells: NDArray[np.intp],
    thinnest: float,
    step: float | None = None,
    *,
    collapse: bool = True,
) -> tuple[TracedMesh, NDArray[np.intp], float]:
    """Every vertex on a float32 grid, the surface closed also where vertices fall together.

    Vertices that do are mostly ends of an edge shorter than the grid: collapse it. What remains are
    surfaces that touch along edges: move them apart by some steps of the grid.

    Args:
        solid: of which ``traced`` is the mesh, without slivers.
        traced: the mesh.
        shells: of each of its faces.
        thinnest: as in `finish`.
        step: of the grid, mm; None: the finest that holds the mesh.
        collapse: whether edges may be; else ends that fall together are moved apart as well, and
            no other vertex moves.

    Returns:
        the mesh, the shell of each face, and how far whole surfaces may have moved, mm.
    """
    if not len(traced.mesh.faces):
        return traced, shells, 0.0
    step = meshes.grid_step(traced.mesh.vertices) if step is None else step
    result = meshes.on_grid(traced, traced.mesh.vertices, step)
    if _closed(result):
        return result, shells, 0.0
    moved = 0.0
    for moved in (2.0 * step, 16.0 * step) if collapse else ():
        simpler = solid.simplified(moved).traced()
        simpler, shells, _ = meshes.without_slivers(simpler, thinnest)
        result = meshes.on_grid(simpler, simpler.mesh.vertices, step)
        if _closed(result):
            return result, shells, moved
    for reach in (4.0, 16.0, 64.0, 256.0):
        result = meshes.parted(result, reach * step, step)
        if _closed(result):
            break
    return result, shells, moved


def _closed(traced: TracedMesh) -> bool:
    v, f = traced.mesh.vertices, traced.mesh.faces
    return not len(meshes.sharing(v)) or meshes.is_closed(meshes.welded(v, f))


def first_use() -> None:
    """An operation like any other; with the first, manifold3d settles how many threads it has."""
    ball = Manifold.sphere(1.0, 96)
    Manifold.batch_boolean([ball, ball.translate((0.5, 0.5, 0.5))], OpType.Intersect).num_tri()


def flat_mesh(loops: Sequence[ArrayLike]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """A plane region as triangles: points (V, 2) mm and faces (F, 3), counter-clockwise.

    Args:
        loops: (N, 2) mm each, its last point not the first again; the region to the left.
    """
    rings = [np.ascontiguousarray(loop, dtype=float).reshape(-1, 2) for loop in loops]
    rings = [ring for ring in rings if len(ring) > 2]
    if not rings:
        return np.empty((0, 2)), np.empty((0, 3), np.int32)
    faces = np.asarray(triangulate(rings), dtype=np.int32).reshape(-1, 3)
    return np.concatenate(rings), faces
