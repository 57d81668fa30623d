"""View → scene nodes, created once and updated in place. Lengths in mm, z up."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import viser
import viser.transforms as tf
from scipy.spatial import ConvexHull

from app.features.workspace.compute import SolidWish
from app.review.state import Options, is_planar
from app.review.view import View, short_title
from app.scene import painting, palette
from app.scene.creases import crease_lines
from app.scene.painting import Coat
from kinematics.answers.drawings import Bar, Body, Drawing, Mark
from kinematics.arrays import Array
from kinematics.facets.solids import SolidSpec
from kinematics.machine import machine_of
from kinematics.mechanism import Coordinate

if TYPE_CHECKING:
    from kinematics.solids.csg import BuiltSolid

# Solids are created from the inside out: with equal origins the browser draws in this order, and
# a transparent outer solid drawn first would hide the inner one.
_DRAW_ORDER = ("aspects", "workspace", "H1", "H2", "H3", "plus", "minus", "whole", "body")
COATS = max(painting.STEPS + 1, painting.PIECES + 1)
_NOTHING = np.zeros((3, 3), dtype=np.float32)  # a mesh of no area where there is no solid
_ONE_FACE = np.array([[0, 1, 2]], dtype=np.uint32)
_NO_EDGE = np.zeros((1, 2, 3), dtype=np.float32)
GRID = 100.0  # mm
_ELSEWHERE = {"position": (-1e5, -1e5, -1e5), "wxyz": (0.0, 0.0, 0.0, 1.0)}
FIELD_OF_VIEW = math.radians(38.0)  # vertical; narrow, as engineers draw


@dataclass
class Scene:
    """Handles of everything in the scene, and what they show."""

    server: viser.ViserServer
    _nodes: dict[str, Any] = field(default_factory=dict)
    _shape: dict[str, tuple[object, ...]] = field(default_factory=dict)
    _solids: dict[str, viser.MeshHandle] = field(default_factory=dict)
    _coats: dict[str, list[viser.MeshHandle]] = field(default_factory=dict)
    _painted: dict[str, tuple[Coat, ...]] = field(default_factory=dict)
    _edges: dict[str, viser.LineSegmentsHandle] = field(default_factory=dict)
    _slots: dict[str, int] = field(default_factory=dict)
    _lines: dict[str, tuple[BuiltSolid, np.ndarray]] = field(default_factory=dict)
    _solid_on: dict[str, tuple[object, ...]] = field(default_factory=dict)
    handle: viser.TransformControlsHandle | None = None

    def clear(self) -> None:
        """Take everything off the scene, as another mechanism's things come."""
        self.server.scene.reset()
        for known in (
            self._nodes,
            self._shape,
            self._solids,
            self._coats,
            self._painted,
            self._edges,
            self._slots,
            self._lines,
            self._solid_on,
        ):
            known.clear()

    def prepare(self, specs: Iterable[SolidSpec], size: float, axes: Sequence[Coordinate]) -> None:
        """The things that do not depend on the pose: light, solids' nodes, the drag handle."""
        scene = self.server.scene
        scene.set_up_direction("+z")
        # Plain lights, no environment map: colours stay what the legend says, and a browser that
        # draws without a GPU is four times as fast.
        scene.configure_environment_map(None)
        scene.configure_default_lights(False)
        scene.add_light_ambient("/lights/all", intensity=0.6)
        scene.add_light_hemisphere(
            "/lights/sky", sky_color=(255, 255, 255), ground_color=(168, 174, 184), intensity=1.1
        )
        scene.add_light_directional(
            "/lights/sun", intensity=2.2, cast_shadow=False, position=(0.5, -0.8, 1.0)
        )
        # What is told of how the platform is held stands below this, and is hidden with it.
        self._nodes["/control"] = scene.add_frame("/control", show_axes=False)
        for spec in sorted(specs, key=_draw_order):
            color = palette.solid_color(spec)
            self._solids[spec.key] = self._mesh(f"/solids/{spec.key}", color)
            if spec.limb is None:
                self._coats[spec.key] = [
                    self._mesh(f"/solids/{spec.key}/coat{n}", color) for n in range(COATS)
                ]
            self._edges[spec.key] = scene.add_line_segments(
                f"/solids/{spec.key}/edges",
                _NO_EDGE,
                palette.rgb(palette.mixed(palette.solid_color(spec), -0.35)),
                thickness=1.3,
                thickness_units="screen",
            )
        # A machine in a plane is dragged in it; one that turns may shift on the way, so any axis.
        turns = any(c.unit == "rad" for c in axes)
        keys = {c.key for c in axes}
        self.handle = scene.add_transform_controls(
            "/handle",
            scale=0.42 * size,
            line_width=3.0,
            active_axes=(turns or "x" in keys, turns or "y" in keys, turns or "z" in keys),
            disable_rotations=not turns,
            depth_test=False,
            opacity=0.85,
        )

    def _mesh(self, name: str, color: str) -> viser.MeshHandle:
        """A mesh with nothing to see."""
        return self.server.scene.add_mesh_simple(
            name,
            _NOTHING,
            _ONE_FACE,
            color=palette.rgb(color),
            opacity=0.3,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )

    # --- the machine

    def show(self, view: View, *, dragging: bool) -> None:
        """Bring the machine, its frames and marks to a view."""
        options, drawing = view.review[Options], view.drawing
        rows, bars, bodies = view.joints, drawing.bars, drawing.bodies
        if view.beside is not None:
            other = view.beside
            rows, bars = rows + other.joints, bars + other.drawing.bars
            bodies = bodies + other.drawing.bodies
        self._bars(bars, {row.limb: row.level for row in rows}, options.machine)
        for body in bodies:
            self._body(body, view.platform, options.machine)
        self._hide_others(bodies)
        self._name_machines(view)
        self._marks(drawing, options.labels, options.axes, options.dark)
        self._frames(view, options.frames)
        self._grid(view, options.grid, options.dark)
        if self.handle is not None:
            self._set("/handle", self.handle, visible=options.handle)
            if not dragging:  # the hand that holds it decides where it is
                self._pose("/handle", self.handle, view.platform)

    def veil(self, hidden: bool) -> None:
        """Hide what is told of the review's pose while the machine is shown somewhere else."""
        self._set("/control", self._nodes["/control"], visible=not hidden)

    def _bars(self, bars: tuple[Bar, ...], levels: Mapping[int, str], visible: bool) -> None:
        """All bars as one batched mesh: a few small arrays a frame, not a hundred messages."""
        for bar in bars:
            self._slots.setdefault(bar.name, len(self._slots))
        count = len(self._slots)
        start, along = np.zeros((count, 3), np.float32), np.zeros((count, 3), np.float32)
        radius, colors = np.zeros(count, np.float32), np.zeros((count, 3), np.uint8)
        for bar in bars:
            n = self._slots[bar.name]
            start[n], along[n] = bar.start, np.subtract(bar.end, bar.start)
            radius[n] = bar.radius
            colors[n] = palette.linear(palette.bar_color(bar, levels.get(bar.limb or 0, "good")))
        length = np.linalg.norm(along, axis=1)
        radius[length < 1e-6] = 0.0  # a bar that is not there this time has no size
        arrays: dict[str, Any] = {
            "batched_wxyzs": turns_z_to(along, length),
            "batched_positions": start,
            "batched_scales": np.stack([radius, radius, length], axis=1),
            "batched_colors": colors,
        }
        name = "/machine/bars"
        node = self._nodes.get(name)
        if node is None or len(node.batched_positions) != count:
            vertices, faces = _CYLINDER
            self._nodes[name] = self.server.scene.add_batched_meshes_simple(
                name, vertices, faces, lod="off", cast_shadow=False, receive_shadow=False, **arrays
            )
            self._forget(name)
        else:
            for key, array in arrays.items():
                if not np.array_equal(getattr(node, key), array):
                    setattr(node, key, array)
        self._set(name, self._nodes[name], visible=visible)

    def _body(self, body: Body, platform: Array, visible: bool) -> None:
        name = f"/machine/{body.name}"
        shape = (body.points, body.radius)
        node = self._nodes.get(name)
        if node is None or self._shape.get(name) != shape:
            vertices, faces = body_mesh(body)
            if node is None:
                color = palette.PLATFORM if body.role == "platform" else palette.BASE
                node = self._nodes[name] = self.server.scene.add_mesh_simple(
                    name, vertices, faces, color=palette.rgb(color)
                )
            else:
                node.vertices, node.faces = vertices, faces
            self._shape[name] = shape
        self._set(name, node, visible=visible)
        if body.frame == "platform":
            self._pose(name, node, platform)

    def _hide_others(self, bodies: tuple[Body, ...]) -> None:
        """A counterpart's bodies are there only while it is compared with."""
        present = {f"/machine/{body.name}" for body in bodies}
        for name, node in self._nodes.items():
            if name.startswith("/machine/other ") and name not in present:
                self._set(name, node, visible=False)

    def _name_machines(self, view: View) -> None:
        """Which machine is which, while there are two."""
        other, size = view.beside, view.drawing.size
        kinds = [short_title(view.review.machine)] if other else []
        places = [np.zeros(3)]
        if other is not None:
            kinds.append(short_title(machine_of(other.design)))
            places.append(other.offset)
        for n in range(2):
            seen = n < len(kinds)
            at = _triple(places[n] + np.array([0.0, -1.2 * size, 0.0])) if seen else (0.0,) * 3
            self._label(f"/labels/machine{n}", kinds[n] if seen else "", at, seen)

    def _marks(self, drawing: Drawing, labels: bool, axes: bool, dark: bool) -> None:
        # Points that coincide (merged joints) share one label.
        together: dict[tuple[float, ...], list[Mark]] = defaultdict(list)
        for mark in drawing.points:
            together[tuple(round(v, 3) for v in mark.position)].append(mark)
        lift = 0.05 * drawing.size
        for marks in together.values():
            text = " ".join(m.text for m in marks)
            for n, mark in enumerate(marks):
                x, y, z = mark.position
                self._label(f"/labels/{mark.name}", text, (x, y, z + lift), labels and n == 0)
        for mark in drawing.axes:
            assert mark.direction is not None
            name = f"/axes/{mark.name}"
            start = np.array(mark.position)
            end = start + 0.55 * drawing.size * np.array(mark.direction)
            points = np.stack([start, end])[None].astype(np.float32)
            ink = palette.rgb(palette.INK_DARK if dark else palette.INK)
            node = self._nodes.get(name)
            if node is None:
                node = self._nodes[name] = self.server.scene.add_arrows(
                    name,
                    points,
                    ink,
                    shaft_radius=0.006 * drawing.size,
                    head_radius=0.018 * drawing.size,
                    head_length=0.05 * drawing.size,
                )
            elif axes:
                node.points = points
                node.colors = np.array(ink, dtype=np.uint8)
            self._set(name, node, visible=axes)
            tip = end + 0.03 * drawing.size * np.array(mark.direction)
            self._label(f"/labels/{mark.name}", mark.text, _triple(tip), axes)

    def _label(
        self, name: str, text: str, position: tuple[float, float, float], visible: bool
    ) -> None:
        node = self._nodes.get(name)
        if node is None:
            node = self._nodes[name] = self.server.scene.add_label(
                name, text, position=position, visible=visible, anchor="bottom-center"
            )
        self._set(name, node, visible=visible)
        if visible:
            self._set(name, node, position=position, text=text)

    def _frames(self, view: View, visible: bool) -> None:
        size = view.drawing.size
        for name, at in (("/frames/base", np.eye(4)), ("/frames/platform", view.platform)):
            node = self._nodes.get(name)
            if node is None or self._shape.get(name) != (size,):
                node = self._nodes[name] = self.server.scene.add_frame(
                    name,
                    axes_length=0.16 * size,
                    axes_radius=0.004 * size,
                    origin_radius=0.01 * size,
                )
                self._shape[name] = (size,)
                self._forget(name)
            self._set(name, node, visible=visible)
            self._pose(name, node, at)

    def _grid(self, view: View, visible: bool, dark: bool) -> None:
        base = next(b for b in view.drawing.bodies if b.name == "base")
        floor = min(p[2] for p in base.points) - base.radius
        name = "/grid"
        shape = (round(floor, 3), view.drawing.size, dark)
        node = self._nodes.get(name)
        if node is None or self._shape.get(name) != shape:
            reach = GRID * math.ceil(4.0 * view.drawing.size / GRID)
            cell, section = (
                ((64, 68, 74), (84, 90, 98)) if dark else ((214, 218, 224), (188, 194, 202))
            )
            node = self._nodes[name] = self.server.scene.add_grid(
                name,
                width=reach,
                height=reach,
                cell_size=GRID,
                section_size=5 * GRID,
                cell_color=cell,
                section_color=section,
                cell_thickness=1.0,
                section_thickness=1.4,
                shadow_opacity=0.0,
                fade_distance=20.0 * view.drawing.size,
                position=(0.0, 0.0, floor),
            )
            self._shape[name] = shape
            self._forget(name)
            # Seen from above the corner in front is beyond the picture's edge.
            corner = 0.5 * reach
            side = -corner if is_planar(view.review.machine) else corner
            self._label("/labels/grid", f"grid {GRID:.0f} mm", (side, -corner, floor), visible)
        self._set(name, node, visible=visible)
        self._set("/labels/grid", self._nodes["/labels/grid"], visible=visible)

    # --- solids

    def show_solid(self, wish: SolidWish, solid: BuiltSolid, coats: tuple[Coat, ...]) -> None:
        """Put a solid on display, at the place of ``wish``, painted with ``coats``."""
        key = wish.spec.key
        node, edges = self._solids[key], self._edges[key]
        rotation, offset = wish.placement[:3, :3], wish.placement[:3, 3]
        # All solids keep their origin at zero, so that the drawing order above holds.
        shift = (rotation.T @ offset).astype(np.float32)
        lines = self._creases(key, solid) if solid.triangles else _NO_EDGE[:0]
        edges.points = lines + shift if len(lines) else _NO_EDGE
        # One coat is the solid's own mesh; several have a mesh each, and it has none.
        single = len(coats) == 1
        self._coat(node, coats[0] if single else None, shift)
        for n, other in enumerate(self._coats.get(key, ())):
            coat = coats[n] if not single and n < len(coats) else None
            if coat is not None:
                self._coat(other, coat, shift)
            self._set(other.name, other, visible=coat is not None)
        self._set(node.name, node, wxyz=wxyz(rotation), visible=bool(solid.triangles))
        self._solid_on[key] = (id(solid), wish.placement.tobytes(), id(coats))
        self._painted[key] = coats
        self.fade_solid(wish)

    def _coat(self, node: viser.MeshHandle, coat: Coat | None, shift: np.ndarray) -> None:
        slot = f"{node.name}#faces"
        if coat is None or not len(coat.faces):
            if self._shape.pop(slot, None) is not None:
                node.vertices, node.faces = _NOTHING, _ONE_FACE
            return
        node.vertices = coat.vertices + shift
        if self._shape.get(slot) != (id(coat.faces),):  # the same solid elsewhere keeps them
            node.faces = coat.faces
            self._shape[slot] = (id(coat.faces),)
        self._set(node.name, node, color=palette.rgb(coat.color))

    def _creases(self, key: str, solid: BuiltSolid) -> np.ndarray:
        """The crease lines of a solid where it was built; found once, then only moved."""
        known = self._lines.get(key)
        if known is None or known[0] is not solid:
            mesh = solid.shaded
            known = self._lines[key] = solid, crease_lines(mesh.vertices, mesh.faces)
        return known[1]

    def fade_solid(self, wish: SolidWish) -> None:
        """Only the opacity of a solid changed."""
        key = wish.spec.key
        coats = self._painted.get(key, ())
        node = self._solids[key]
        self._set(node.name, node, opacity=wish.opacity)
        if len(coats) > 1:
            for coat, other in zip(coats, self._coats[key], strict=False):
                opacity = min(coat.opaque * wish.opacity, 1.0)
                self._set(other.name, other, opacity=opacity)

    def hide_solid(self, key: str) -> None:
        """Take a solid off display."""
        node = self._solids[key]
        self._set(node.name, node, visible=False)
        self._solid_on.pop(key, None)

    def shows(self, wish: SolidWish, solid: BuiltSolid, coats: tuple[Coat, ...]) -> bool:
        """Whether this very solid stands at this very place already, painted like this."""
        shown = id(solid), wish.placement.tobytes(), id(coats)
        return self._solid_on.get(wish.spec.key) == shown

    # --- in-place updates that change nothing send nothing

    def _set(self, name: str, node: Any, **values: object) -> None:
        for key, value in values.items():
            slot = f"{name}#{key}"
            if self._shape.get(slot) == (value,):
                continue
            if slot not in self._shape and key in _ELSEWHERE:
                setattr(node, key, _ELSEWHERE[key])  # see `fresh`
            setattr(node, key, value)
            self._shape[slot] = (value,)

    def _pose(self, name: str, node: Any, transform: Array) -> None:
        self._set(name, node, position=_triple(transform[:3, 3]), wxyz=wxyz(transform[:3, :3]))

    def _forget(self, name: str) -> None:
        for slot in [s for s in self._shape if s.startswith(f"{name}#")]:
            del self._shape[slot]

    def release_handle(self) -> None:
        """The drag ended: put the handle back where the platform really is."""
        self._forget("/handle")

    def frame(
        self, bounds: tuple[Array, Array], *, from_above: bool = False, aspect: float = 1.0
    ) -> tuple[Array, Array]:
        """Camera position and target that show a box whole, from the front right above.

        A machine in the x-y plane is seen nearly ``from_above``. ``aspect``: width by height of
        what it is seen in; a high one needs more distance.
        """
        low, high = bounds
        centre = 0.5 * (low + high)
        radius = 0.5 * float(np.linalg.norm(high - low))
        toward = np.array([0.12, -0.45, 1.0] if from_above else [0.62, -0.95, 0.42])
        half = math.atan(math.tan(0.5 * FIELD_OF_VIEW) * min(max(aspect, 0.2), 1.0))
        distance = 1.02 * radius / math.sin(half)
        return centre + distance * toward / np.linalg.norm(toward), centre


def _draw_order(spec: SolidSpec) -> int:
    part = spec.key.partition("/")[2] or spec.key
    return _DRAW_ORDER.index(part) if part in _DRAW_ORDER else len(_DRAW_ORDER)


def fresh(node: Any) -> Any:
    """A new node, put where it will not stay, so that its first pose is sent whatever it is.

    A browser keeps the pose of the node of the same name that was taken away, and viser does not
    send one that is the default.
    """
    for key, value in _ELSEWHERE.items():
        setattr(node, key, value)
    return node


def machine_bounds(*drawings: Drawing) -> tuple[Array, Array]:
    """The box around machines, mm."""
    bars = [bar for drawing in drawings for bar in drawing.bars]
    points = np.array([p for bar in bars for p in (bar.start, bar.end)])
    return points.min(axis=0), points.max(axis=0)


def _triple(point: Array) -> tuple[float, float, float]:
    return float(point[0]), float(point[1]), float(point[2])


def wxyz(rotation: Array) -> tuple[float, ...]:
    return tuple(float(v) for v in tf.SO3.from_matrix(rotation).wxyz)


def turns_z_to(along: np.ndarray, length: np.ndarray) -> np.ndarray:
    """The shortest rotations that take +z to vectors (N, 3) of these lengths; (N, 4) wxyz."""
    x, y, z = (along / np.maximum(length, 1e-6)[:, None]).T
    w = 1.0 + z
    down = w < 1e-6
    turns = np.stack([w, np.where(down, 1.0, -y), x, np.zeros_like(x)], axis=1)
    turns[down] = (0.0, 1.0, 0.0, 0.0)
    turned: np.ndarray = turns / np.linalg.norm(turns, axis=1, keepdims=True)
    return turned.astype(np.float32)


def cylinder(sides: int) -> tuple[np.ndarray, np.ndarray]:
    """A closed unit cylinder on z from 0 to 1; caps have vertices of their own for crisp edges."""
    a = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(a), np.sin(a)], axis=1)
    low = np.column_stack([ring, np.zeros(sides)])
    high = np.column_stack([ring, np.ones(sides)])
    vertices = np.concatenate([low, high, low, high, [[0, 0, 0], [0, 0, 1]]])
    n = np.arange(sides)
    m = (n + 1) % sides
    faces = np.concatenate(
        [
            np.stack([n, m, sides + m], axis=1),
            np.stack([n, sides + m, sides + n], axis=1),
            np.stack([2 * sides + m, 2 * sides + n, np.full(sides, 4 * sides)], axis=1),
            np.stack([3 * sides + n, 3 * sides + m, np.full(sides, 4 * sides + 1)], axis=1),
        ]
    )
    return vertices.astype(np.float32), faces.astype(np.uint32)


def _ball(rings: int = 6, sides: int = 12) -> Array:
    polar = np.pi * np.arange(rings + 1) / rings
    around = 2 * np.pi * np.arange(sides) / sides
    p, q = np.meshgrid(polar, around, indexing="ij")
    return np.stack([np.sin(p) * np.cos(q), np.sin(p) * np.sin(q), np.cos(p)], axis=-1).reshape(
        -1, 3
    )


def body_mesh(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """The hull of balls about the body's points, turned outwards."""
    points = np.array(body.points, dtype=float)
    cloud = (points[:, None, :] + body.radius * _ball()[None]).reshape(-1, 3)
    hull = ConvexHull(cloud)
    corners = cloud[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0
    faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    used, faces = np.unique(faces, return_inverse=True)
    return cloud[used].astype(np.float32), faces.reshape(-1, 3).astype(np.uint32)


_CYLINDER = cylinder(24)
