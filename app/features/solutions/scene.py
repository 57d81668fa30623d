"""The other assembly modes in the scene as ghosts of their platforms, and the fold ahead.

Each is a dot where the platform's point would be, the nearest few are outlines of platforms, too,
and the nearest of all is filled and named: a hundred of those would be a heap. All dots, all
outlines (thin sticks) and all faces (right triangles) are one batched mesh each, so a frame is a
few small arrays however many there are, and the meshes themselves never change: they were made
before the solids, so that the browser draws the faces first and the solids do not hide them.
Clicking a ghost asks for a visit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

from app.features.solutions.compute import Ahead, Listed, Row
from app.features.solutions.state import Atlas
from app.language import tr
from app.review.state import Options
from app.review.units import joint_text, minus, tenths
from app.review.view import View
from app.scene import palette
from app.scene.nodes import Nodes
from app.scene.shapes import cylinder, turns_z_to
from kinematics.answers.drawings import Body
from kinematics.arrays import Array

THIN, THICK = 0.003, 0.006  # radius of a stick, of the machine's size: as a rule, and who is new
CAPACITY = 512  # sticks and triangles that a mesh is made for; doubled where they do not suffice
NEAREST = 6  # that are drawn as platforms
DOT = 0.012  # radius of a dot, of the machine's size
FILLED = 0.35  # opacity of a face

# The right triangle between (0, 0), (1, 0) and (0, 1).
_TRIANGLE = (
    np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32),
    np.array([[0, 1, 2]], dtype=np.uint32),
)
# An octahedron.
_DOT = (
    np.array([*np.eye(3), *-np.eye(3)], dtype=np.float32),
    np.array(
        [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]],
        dtype=np.uint32,
    ),
)


class Ghosts:
    """Scene nodes of the solutions, made empty; then only their arrays change."""

    def __init__(self, nodes: Nodes, visit: Callable[[int], None]) -> None:
        self._nodes = nodes
        # Before the solids' are made.
        self._faces = _Batch(nodes, "/ghosts/faces", _TRIANGLE, FILLED, 16, visit)
        self._dots = _Batch(nodes, "/ghosts/dots", _DOT, None, CAPACITY, visit)
        self._edges = _Batch(nodes, "/ghosts/edges", cylinder(6), None, CAPACITY, visit)
        self._fold_faces = _Batch(nodes, "/fold/faces", _TRIANGLE, FILLED, 16)
        self._fold_edges = _Batch(nodes, "/fold/edges", cylinder(6), None, 16)
        self._label = nodes.label("/labels/fold")
        self._name = nodes.label("/labels/nearest")
        self._spots: tuple[Sequence[int], Array] = (), np.empty((0, 3))

    @property
    def spots(self) -> tuple[Sequence[int], Array]:
        """The solutions that are shown, and where their dots are, (N, 3) mm."""
        return self._spots

    def show(
        self, view: View, atlas: Listed, fold: Ahead | None, pointed: int | None = None
    ) -> None:
        """Bring them to the solutions that pass the filter; all but the present one.

        Args:
            pointed: which of them is filled and named; None: the nearest.
        """
        wanted = view.review[Atlas].ghosts
        others = [n for n, row in enumerate(atlas.rows) if not row.here] if wanted else []
        others.sort(key=lambda n: (atlas.rows[n].identity != pointed, atlas.rows[n].distance))
        edges = outline([b for b in view.drawing.bodies if b.frame == "platform"])
        owners = [atlas.rows[n].identity for n in others]
        new = np.array([atlas.rows[n].new for n in others], dtype=bool)
        # Fainter while they belong to other actuators.
        dark = view.review[Options].dark
        tint = (-0.55 if dark else 0.6) if atlas.stale else 0.0
        of = self._nodes.colors
        shades = [palette.linear(palette.mixed(code, tint)) for code in (of.ghost, of.dot)]
        colors = np.array([shades[n >= NEAREST] for n in range(len(others))], np.uint8)
        colors = colors.reshape(-1, 3)
        colors[new] = palette.linear(of.platform)
        size = view.drawing.size
        placements = atlas.placements[others]
        turns = np.tile([1.0, 0.0, 0.0, 0.0], (len(others), 1))
        sizes = np.full((len(others), 3), DOT * size)
        self._spots = owners, placements[:, :3, 3]
        self._dots.show(turns, placements[:, :3, 3], sizes, colors, owners)
        placements, colors, owners = placements[:NEAREST], colors[:NEAREST], owners[:NEAREST]
        sticks = _sticks(edges, placements, np.where(new[:NEAREST], THICK, THIN) * size)
        self._edges.show(*sticks, colors, owners)
        self._faces.show(*_faces(edges, placements[:1]), colors[:1], owners[:1])
        named = others[:0] if atlas.stale else others[:1]
        name = name_of(atlas.rows[named[0]]) if named else ""
        self._nodes.text(self._name, name, placements[0, :3, 3] if named else None)

        ahead = fold if wanted and fold is not None and fold.fold is not None else None
        review = view.review
        at, text = np.empty((0, 4, 4)), ""
        if ahead is not None and ahead.fold is not None:
            there = ahead.fold
            at = review.machine.transform(there.pose, there.mode)[None]
            axis = review.machine.joints[ahead.index]
            text = tr("solutions.fold_at", joint=axis.symbol, value=joint_text(axis, ahead.goal))
        self._nodes.text(self._label, text, at[0, :3, 3] if len(at) else None)
        red = np.tile(np.array(palette.linear(of.beyond), np.uint8), (len(at), 1))
        self._fold_edges.show(*_sticks(edges, at, np.full(len(at), THICK * size)), red, [0])
        self._fold_faces.show(*_faces(edges, at), red, [0])


def name_of(row: Row) -> str:
    """ "#43 · 114.5 mm · −−−−+"."""
    parts = [f"#{row.identity}", f"{tenths(row.distance)} mm", minus(row.mode)]
    return " · ".join(filter(None, parts))


class _Batch:
    """Copies of one small shape as a batched mesh; slots that are not used have no size.

    ``act`` is called with the owner of the copy that a person clicks.
    """

    def __init__(
        self,
        nodes: Nodes,
        name: str,
        shape: tuple[np.ndarray, np.ndarray],
        opacity: float | None,
        capacity: int,
        act: Callable[[int], None] | None = None,
    ) -> None:
        self._nodes = nodes
        self._name = name
        self._shape = shape
        self._opacity = opacity
        self._act = act
        self._owners: Sequence[int] = ()
        self._each = 1
        self._make(capacity)

    def _make(self, capacity: int) -> None:
        """Make the mesh for so many copies, with none to see."""
        self._mesh: Any = self._nodes.server.scene.add_batched_meshes_simple(
            self._name,
            *self._shape,
            **_unseen(capacity),
            opacity=self._opacity,
            side="double",
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )
        if self._act is not None:
            self._mesh.on_click(self._clicked)

    async def _clicked(self, event: Any) -> None:
        owners, each = self._owners, self._each
        known = event.instance_index is not None and event.instance_index // each < len(owners)
        if known and self._act is not None:
            self._act(owners[event.instance_index // each])

    def show(
        self, turns: Array, places: Array, scales: Array, colors: np.ndarray, owners: Sequence[int]
    ) -> None:
        """Copies (N K, ·) of N owners, K for each; colours (N, 3) in linear light."""
        count = len(places)
        self._nodes.set(self._mesh, visible=bool(count))
        if not count:
            return
        self._owners, self._each = owners, max(count // max(len(owners), 1), 1)
        capacity = len(self._mesh.batched_positions)
        if capacity < count:
            while capacity < count:
                capacity *= 2
            self._make(capacity)
            self._nodes.forget(self._name)
            self._nodes.set(self._mesh, visible=True)
        arrays = _unseen(capacity)
        copies = np.repeat(colors, self._each, axis=0)
        for (key, array), values in zip(
            arrays.items(), (turns, places, scales, copies), strict=True
        ):
            array[:count] = values[:count]
            self._nodes.set(self._mesh, **{key: array})


def _unseen(count: int) -> dict[str, Any]:
    """So many copies of no size."""
    return {
        "batched_wxyzs": np.tile(np.array([1, 0, 0, 0], np.float32), (count, 1)),
        "batched_positions": np.zeros((count, 3), np.float32),
        "batched_scales": np.zeros((count, 3), np.float32),
        "batched_colors": np.zeros((count, 3), np.uint8),
    }


def _sticks(edges: Array, placements: Array, radius: Array) -> tuple[Array, Array, Array]:
    """Turns, places and scales of unit cylinders along edges (K, 2, 3) at N placements."""
    moved = np.einsum("nij,kej->nkei", placements[:, :3, :3], edges)
    ends = (moved + placements[:, None, None, :3, 3]).reshape(-1, 2, 3).astype(np.float32)
    along = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(along, axis=1)
    thick = np.repeat(radius, len(edges))
    return turns_z_to(along, length), ends[:, 0], np.stack([thick, thick, length], axis=1)


def _faces(edges: Array, placements: Array) -> tuple[Array, Array, Array]:
    """Turns, places and scales of right triangles that fill an outline at N placements."""
    corners = right_triangles(edges[:, 0])
    legs = corners[:, 1:] - corners[:, :1]
    scale = np.linalg.norm(legs, axis=2)
    x, y = np.moveaxis(legs / scale[:, :, None], 1, 0)
    frames = np.stack([x, y, np.cross(x, y)], axis=2)
    turned = np.einsum("nij,kjl->nkil", placements[:, :3, :3], frames).reshape(-1, 3, 3)
    origin = np.einsum("nij,kj->nki", placements[:, :3, :3], corners[:, 0])
    places = (origin + placements[:, None, :3, 3]).reshape(-1, 3)
    sizes = np.tile(np.column_stack([scale, np.ones(len(scale))]), (len(placements), 1))
    if not len(turned):
        return np.empty((0, 4)), places, sizes
    turns: Array = np.roll(Rotation.from_matrix(turned).as_quat(), 1, axis=1)
    return turns, places, sizes


def right_triangles(polygon: Array) -> Array:
    """Right triangles (N, 3, 3), the right angle first, that fill a polygon (K, 3) as a fan."""
    found = []
    for n in range(1, len(polygon) - 1):
        triangle = polygon[[0, n, n + 1]]
        sides = np.roll(triangle, -1, axis=0) - triangle
        longest = int(np.linalg.norm(sides, axis=1).argmax())
        a, b, apex = np.roll(triangle, -longest, axis=0)
        foot = a + (b - a) * ((apex - a) @ (b - a)) / ((b - a) @ (b - a))
        found += [[foot, a, apex], [foot, b, apex]]
    filled = np.array(found).reshape(-1, 3, 3)
    legs = np.linalg.norm(filled[:, 1:] - filled[:, :1], axis=2)
    kept: Array = filled[legs.min(axis=1, initial=np.inf) > 1e-6]
    return kept


def outline(bodies: list[Body]) -> Array:
    """Closed outlines (N, 2, 3) of bodies in the plane in which each extends most, mm."""
    lines = [_outline(np.array(body.points, dtype=float)) for body in bodies]
    return np.concatenate(lines) if lines else np.empty((0, 2, 3))


def _outline(points: Array) -> Array:
    flat = points - points.mean(axis=0)
    axes = np.linalg.svd(flat, full_matrices=False)[2]
    try:
        order = ConvexHull(flat @ axes[:2].T).vertices
    except QhullError:  # all on one line
        along = flat @ axes[0]
        return points[[[int(along.argmin()), int(along.argmax())]]]
    return np.stack([points[order], points[np.roll(order, -1)]], axis=1)
