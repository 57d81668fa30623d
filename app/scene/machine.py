"""The machine in the scene: its bars and bodies, frames, marks, the ground, the handle to drag."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import viser

from app.review.state import Options
from app.review.view import View, short_title
from app.scene import palette
from app.scene.nodes import NO_LINE, Nodes
from app.scene.shapes import CYLINDER, body_mesh, turns_z_to
from kinematics.answers.drawings import Bar, Body, Drawing, Mark
from kinematics.arrays import Array
from kinematics.machine import machine_of
from kinematics.mechanism import Coordinate

GRID = 100.0  # mm
CLOSE = 0.12  # of the size: points that share a label


class Scene(Nodes):
    """The machine's nodes, created once and updated in place; other parts make their own.

    Attributes:
        handle: what a person drags the platform by.
        held: a hand holds it, and decides where it is.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        super().__init__(server)
        self.handle: Any = None
        self.held = False
        self._nodes: dict[str, Any] = {}
        self._shape: dict[str, object] = {}  # what a node was made of
        self._slots: dict[str, int] = {}  # of bars in their batch

    def clear(self) -> None:
        super().clear()
        self.held = False
        for known in (self._nodes, self._shape, self._slots):
            known.clear()

    def prepare(self, axes: Sequence[Coordinate]) -> None:
        """The things that do not depend on the pose: light and the handle."""
        scene = self.server.scene
        scene.set_up_direction("+y" if all(c.key in ("x", "y") for c in axes) else "+z")
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
        # A machine in a plane is dragged in it; one that turns may shift on the way, so any axis.
        turns = any(c.unit == "rad" for c in axes)
        keys = {c.key for c in axes}
        handle = scene.add_transform_controls(
            "/handle",
            line_width=3.0,
            active_axes=(turns or "x" in keys, turns or "y" in keys, turns or "z" in keys),
            disable_rotations=not turns,
            depth_test=False,
            opacity=0.85,
        )
        self.handle = self.sized(handle, scale=0.42)

    def show(self, view: View, *, dragging: bool) -> None:
        """Bring the machine, its frames and marks to a view."""
        options, drawing = view.review[Options], view.drawing
        self.resize(drawing.size)
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
        self._marks(drawing, options)
        self._frames(view, options.frames)
        self._grid(view, options)
        if self.handle is not None:
            self.set(self.handle, visible=options.handle)
            if not dragging:
                self.pose(self.handle, view.platform)

    def veil(self, hidden: bool) -> None:
        """Hide what is told of the review's pose while the machine is shown somewhere else."""
        self.set(self._nodes["/control"], visible=not hidden)

    def release_handle(self) -> None:
        """The drag ended: put the handle back where the platform really is."""
        self.forget("/handle")

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
        if node is None or self._shape.get(name) != count:
            node = self._nodes[name] = self.server.scene.add_batched_meshes_simple(
                name, *CYLINDER, lod="off", cast_shadow=False, receive_shadow=False, **arrays
            )
            self._shape[name] = count
            self.forget(name)
        self.set(node, visible=visible, **arrays)

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
        self.set(node, visible=visible)
        if body.frame == "platform":
            self.pose(node, platform)

    def _hide_others(self, bodies: tuple[Body, ...]) -> None:
        """A counterpart's bodies are there only while it is compared with."""
        present = {f"/machine/{body.name}" for body in bodies}
        for name, node in self._nodes.items():
            if name.startswith("/machine/other ") and name not in present:
                self.set(node, visible=False)

    def _name_machines(self, view: View) -> None:
        """Which machine is which, while there are two."""
        kinds, places = ["", ""], [np.zeros(3), np.zeros(3)]
        if view.beside is not None:
            kinds = [short_title(m) for m in (view.review.machine, machine_of(view.beside.design))]
            places[1] = view.beside.offset
        for n, (kind, place) in enumerate(zip(kinds, places, strict=True)):
            at = place + np.array([0.0, -1.2 * view.drawing.size, 0.0])
            self._label(f"/labels/machine{n}", kind, at if kind else None)

    def _marks(self, drawing: Drawing, options: Options) -> None:
        shown = labels(drawing) if options.labels else {}
        for mark in drawing.points:
            self._label(f"/labels/{mark.name}", *shown.get(mark.name, ("", None)))
        ink = palette.INK_DARK if options.dark else palette.INK
        for mark in drawing.axes:
            name, start, along = f"/axes/{mark.name}", np.array(mark.position), mark.direction
            end = start + 0.55 * drawing.size * np.array(along)
            if name not in self._nodes:
                self._nodes[name] = self.arrows(name, 0.006)
            node = self._nodes[name]
            if options.axes:
                self.set(node, colors=np.array(palette.rgb(ink), dtype=np.uint8))
            self.points(node, np.stack([start, end])[None] if options.axes else NO_LINE[:0])
            tip = end + 0.03 * drawing.size * np.array(along)
            self._label(f"/labels/{mark.name}", mark.text, tip if options.axes else None)

    def _label(self, name: str, text: str, position: Array | None) -> None:
        if name not in self._nodes:
            self._nodes[name] = self.label(name)
        self.text(self._nodes[name], text, position)

    def _frames(self, view: View, visible: bool) -> None:
        for name, at in (("/frames/base", np.eye(4)), ("/frames/platform", view.platform)):
            if name not in self._nodes:
                frame = self.server.scene.add_frame(name)
                parts = {"axes_length": 0.16, "axes_radius": 0.004, "origin_radius": 0.01}
                self._nodes[name] = self.sized(frame, **parts)
            self.set(self._nodes[name], visible=visible)
            self.pose(self._nodes[name], at)

    def _grid(self, view: View, options: Options) -> None:
        base = next(b for b in view.drawing.bodies if b.name == "base")
        floor = min(p[2] for p in base.points) - base.radius
        size, name = view.drawing.size, "/grid"
        shape = (round(floor, 3), size, options.dark)
        reach = GRID * math.ceil(4.0 * size / GRID)
        if self._shape.get(name) != shape:
            cell, section = (
                ((64, 68, 74), (84, 90, 98)) if options.dark else ((214, 218, 224), (188, 194, 202))
            )
            self._nodes[name] = self.server.scene.add_grid(
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
                fade_distance=20.0 * size,
                position=(0.0, 0.0, floor),
            )
            self._shape[name] = shape
            self.forget(name)
        self.set(self._nodes[name], visible=options.grid)


def labels(drawing: Drawing) -> dict[str, tuple[str, Array]]:
    """The names of points and where they stand, by the first mark of each.

    Points that are close to each other share one; the others are put outwards from the middle.
    """
    points = np.array([mark.position for mark in drawing.points]).reshape(-1, 3)
    found: list[tuple[Array, list[Mark]]] = []
    for point, mark in zip(points, drawing.points, strict=True):
        for place, marks in found:
            if np.linalg.norm(place - point) < CLOSE * drawing.size:
                marks.append(mark)
                break
        else:
            found.append((point, [mark]))
    placed = {}
    for place, marks in found:
        out = place - points.mean(axis=0)
        out[2] = 0.0
        out /= max(float(np.linalg.norm(out)), 1e-9)
        lift = drawing.size * np.array([0.1 * out[0], 0.1 * out[1], 0.05])
        placed[marks[0].name] = " ".join(m.text for m in marks), place + lift
    return placed


def machine_bounds(drawing: Drawing) -> tuple[Array, Array]:
    """The box around a machine, mm."""
    points = np.array([p for bar in drawing.bars for p in (bar.start, bar.end)])
    return points.min(axis=0), points.max(axis=0)
