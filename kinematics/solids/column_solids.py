"""Finished solids from columns: closed, in pieces that are counted on the true surfaces.

What hangs together is known from the columns, not from the mesh: where a mesh must be torn because
all of a column falls on one place, what is on both sides is one piece all the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from kinematics.arrays import Array
from kinematics.solids import meshes
from kinematics.solids.column_mesh import BOTH, SIDE, ColumnMesh, column_mesh
from kinematics.solids.columns import ROOT, Columned, Ints
from kinematics.solids.csg import BuiltSolid, Solid, finish
from kinematics.solids.joining import parts
from kinematics.solids.measuring import Measured, measure
from kinematics.solids.meshes import TracedMesh
from kinematics.solids.partition import LOCUS, assembled
from kinematics.solids.refining import Fineness, areas, refined
from kinematics.zeros import Field

Off = Callable[[Array, NDArray[np.int16]], Array]
"""How far places (N, 3) are off the surfaces ``label`` (N,): a smooth measure that is 0 on them."""


_UNSETTLED = (
    "How many pieces there are is not certain: some come nearer to each other than the cells that "
    "this resolution has can tell."
)


@dataclass(frozen=True)
class Quality:
    """How fine a mesh is, how exactly its volume is known, and what it promises, as parts of it."""

    fineness: Fineness
    exact: float
    promised: float


@dataclass(frozen=True, eq=False)
class Shape:
    """A solid by columns as a mesh, its true volume, and whether its pieces are certain."""

    mesh: ColumnMesh
    measured: Measured
    promised: float
    settled: bool = True

    def error(self, volume: float) -> float:
        """mm³ between a mesh's volume and the true one at most."""
        return abs(volume - self.measured.volume) + self.measured.error

    def note(self, built: BuiltSolid) -> str:
        """What is not as it should be, and why; "" where nothing is."""
        doubt = "" if self.settled else _UNSETTLED
        if built.volume_error <= self.promised * built.volume:
            return doubt
        if not built.pieces and self.measured.volume <= 0.0:
            return (
                "No pose was found, but it is not proven that there is none: "
                "what there may be is not larger than the error."
            )
        part = built.volume_error / max(built.volume, 1e-300)
        return (
            f"The error is {100.0 * part:.2g} % of the volume and not "
            f"{100.0 * self.promised:g} %: the solid is too thin or too rugged for as many cells "
            f"as this resolution has. {doubt}".strip()
        )


def shaped(solid: Columned, quality: Quality) -> Shape:
    """The mesh of a solid and its volume."""
    measured = measure(solid, quality.exact)
    if measured.volume <= 0.0 and measured.error <= 0.0:
        return Shape(_nothing(), measured, quality.promised)
    tiling, stood, settled = refined(solid, quality.fineness)
    return Shape(column_mesh(tiling, stood), measured, quality.promised, settled)


def layout(solid: Columned, fineness: Fineness) -> tuple[list[tuple[int, float]], bool]:
    """The sign of every piece and, roughly, its volume, mm³, without a mesh; and whether it is
    clear what hangs together."""
    tiling, stood, settled = refined(solid, fineness)
    triangles, columns = stood.triangles, stood.walls.columns
    found = parts(stood.walls, stood.joints, triangles.twin)
    corners, count = triangles.corners, len(columns.at)
    area = np.bincount(corners.ravel(), np.repeat(areas(tiling, triangles) / 3.0, 3), count)
    vertex, k = np.nonzero(found.of >= 0)
    thick = (columns.at[vertex, k + 1] - columns.at[vertex, k]) * area[vertex]
    volume = np.bincount(found.of[vertex, k], thick, len(found.sign))
    return list(zip(found.sign.tolist(), volume.tolist(), strict=True)), settled


def _nothing() -> ColumnMesh:
    none = np.zeros(0, dtype=np.int8)
    faces, label = np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=np.int16)
    twin = np.zeros((0, 2), dtype=np.int64)
    return ColumnMesh(np.zeros((0, 3)), faces, none, none, label, np.zeros(0, np.int64), twin)


def whole(shape: Shape) -> BuiltSolid:
    """The solid, both signs together."""
    mesh = shape.mesh
    signed = mesh.label == SIDE  # of either sign, where the base ends
    signed &= mesh.below != BOTH
    kept = ((mesh.below != 0) != (mesh.above != 0)) & ~signed
    solid, groups = _closed(mesh, np.flatnonzero(kept), mesh.below[kept] != 0)
    built = finish(solid, lambda _, volume: shape.error(volume), together=groups, total=True)
    return _with_note(built, shape)


def parted(shape: Shape, field: Field, off: Off) -> BuiltSolid:
    """The solid in pieces of one sign each; ``field`` is the function whose zeros part it."""
    mesh = shape.mesh
    sides, groups = [], []
    for sign in (1, -1):
        rows = np.flatnonzero((mesh.below == sign) | (mesh.above == sign))
        solid, group = _closed(mesh, rows, mesh.below[rows] == sign)
        sides.append((solid, sign))
        groups.append(group)

    def error(traced: TracedMesh, volume: float) -> float:
        return _sag(traced, volume, off)

    built = assembled(sides, field, error, together=groups, total=shape.error)
    return _with_note(built, shape)


def _with_note(built: BuiltSolid, shape: Shape) -> BuiltSolid:
    note = shape.note(built)
    return replace(built, note=note) if note else built


def _closed(
    mesh: ColumnMesh, rows: NDArray[np.intp], as_is: NDArray[np.bool_]
) -> tuple[Solid, Callable[[Array], Ints]]:
    """Faces as a solid, every vertex with one fan about it; and a function from places of its
    vertices (N, 3) to the number of the piece that they are of."""
    faces = np.where(as_is[:, None], mesh.faces[rows], mesh.faces[rows][:, ::-1])
    if not len(faces):
        return Solid.from_mesh(np.zeros((0, 3)), faces), lambda points: np.zeros(len(points), int)
    # On the grid that all of the mesh is put on, without edges that it has no place for.
    step = meshes.grid_step(mesh.vertices[np.unique(mesh.faces)])
    places = np.round(mesh.vertices / step) * step
    welded = _welded(places, faces)
    faces = welded[faces]
    kept = (faces != np.roll(faces, -1, axis=1)).all(axis=1)
    faces, source = _umbrellas(faces[kept])
    vertices = places[source]
    names, patch = np.unique(mesh.label[rows][kept], return_inverse=True)
    tags = tuple(LOCUS if name == ROOT else int(name) for name in names) or (None,)
    solid = Solid.from_mesh(vertices, faces, patch=patch.reshape(-1), tags=tags)
    piece = _pieces(faces, source, welded[mesh.twin])
    tree = cKDTree(vertices)

    def group(points: Array) -> Ints:
        found: Ints = piece[tree.query(points)[1]]
        return found

    return solid, group


def _welded(places: Array, faces: Ints) -> Ints:
    """(V,) for every vertex the one that it becomes where ends of edges fall together."""
    tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    same = (places[tail] == places[head]).all(axis=1)
    graph = coo_array(
        (np.ones(int(same.sum()), bool), (tail[same], head[same])), shape=(len(places),) * 2
    )
    number, of = connected_components(graph, directed=False)
    kept = np.zeros(number, dtype=np.int64)
    kept[of] = np.arange(len(places))
    found: Ints = kept[of]
    return found


def _umbrellas(faces: Ints) -> tuple[Ints, Ints]:
    """Faces with a vertex of its own for every fan of faces about one; and what each stands for."""
    if not len(faces):
        return faces, np.zeros(0, dtype=np.int64)
    count, size = len(faces), int(faces.max()) + 1
    tail, head = faces, np.roll(faces, -1, axis=1)
    corner = np.arange(3 * count).reshape(-1, 3)
    after = np.roll(corner, -1, axis=1)
    key, back = (tail * size + head).ravel(), (head * size + tail).ravel()
    order, other = np.argsort(key, kind="stable"), np.argsort(back, kind="stable")
    # The k-th edge from a to b meets the k-th from b to a.
    one, two = order, other
    same = key[one] == back[two]
    one, two = one[same], two[same]
    links = np.concatenate(
        [
            np.stack([corner.ravel()[one], after.ravel()[two]]),
            np.stack([after.ravel()[one], corner.ravel()[two]]),
        ],
        axis=1,
    )
    graph = coo_array((np.ones(links.shape[1], bool), (links[0], links[1])), shape=(3 * count,) * 2)
    number, fan = connected_components(graph, directed=False)
    source = np.zeros(number, dtype=np.int64)
    source[fan] = faces.ravel()
    return fan.reshape(-1, 3).astype(np.int64), source


def _pieces(faces: Ints, source: Ints, twin: Ints) -> Ints:
    """(V,) the piece of every vertex; pieces that have twins in common are one."""
    if not len(faces):
        return np.zeros(0, dtype=np.int64)
    shell = np.zeros(len(source), dtype=np.int64)
    shell[faces.ravel()] = np.repeat(meshes.face_shells(len(source), faces), 3)
    count = int(shell.max()) + 1
    of = np.full(int(max(source.max(), twin.max(initial=0))) + 1, -1)
    of[source] = shell
    one, other = of[twin[:, 0]], of[twin[:, 1]]
    both = (one >= 0) & (other >= 0)
    graph = coo_array(
        (np.ones(int(both.sum()), bool), (one[both], other[both])), shape=(count, count)
    )
    found: Ints = connected_components(graph, directed=False)[1][shell].astype(np.int64)
    return found


# --- the errors of pieces ------------------------------------------------------------------------


def _sag(traced: TracedMesh, volume: float, off: Off) -> float:
    """mm³ between flat faces and the surfaces that they stand for, an estimate from above."""
    label = np.array(
        [ROOT if patch.tag == LOCUS else patch.tag for patch in traced.patches], dtype=np.int16
    )
    of = label[traced.patch_of]
    on = of != ROOT
    corners = traced.mesh.vertices[traced.mesh.faces[on]]
    return meshes.sag(corners, lambda points: off(points, of[on]))
