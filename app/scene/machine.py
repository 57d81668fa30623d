"""The machine in the scene: bars and bodies, frames, marks, the handle to drag; and the light."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import viser

from app.review.state import Options, is_planar
from app.review.view import View, short_title
from app.scene import palette
from app.scene.ground import Ground
from app.scene.labels import labels
from app.scene.nodes import NO_LINE, Nodes
from app.scene.shapes import CYLINDER, body_mesh, turns_z_to
from kinematics.answers.drawings import Bar, Body
from kinematics.arrays import Array
from kinematics.machine import machine_of
from kinematics.mechanism import Coordinate

HANDLE = 0.3  # of the size: its arrows
RAIL = 0.55  # of its radius: how thick a rail is drawn
OUTLINE = 0.004  # of the size: how far the silhouette of a body stands out, about 1 px


class Scene(Nodes):
    """The machine's nodes, created once and updated in place; other parts make their own.

    Attributes:
        handle: what a person drags the platform by.
        held: a hand holds it, and decides where it is.
        near: it is wanted in some browser; elsewhere it would only hide the platform.
        aside: it is out of the way, as a click means something else.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        super().__init__(server)
        self.handle: Any = None
        self.held = False
        self.near = True
        self.aside = False
        self._seen: View | None = None
        self._lowest: dict[str, float] = {}  # of what parts show, mm
        self._nodes: dict[str, Any] = {}
        self._shape: dict[str, object] = {}  # what a node was made of
        self._rims: dict[str, Any] = {}
        self._slots: dict[str, int] = {}  # of bars in their batch
        self._company: list[Callable[[View], None]] = []

    def accompany(self, draw: Callable[[View], None]) -> None:
        """Call this with the view whenever the machine is drawn: something moves with it."""
        self._company.append(draw)

    def clear(self) -> None:
        super().clear()
        self._company.clear()
        self.held, self.aside, self._seen = False, False, None
        for known in (self._nodes, self._rims, self._shape, self._slots, self._lowest):
            known.clear()

    def prepare(self, axes: Sequence[Coordinate]) -> None:
        """The things that do not depend on the pose: light and the handle."""
        scene = self.server.scene
        scene.set_up_direction("+y" if all(c.key in ("x", "y") for c in axes) else "+z")
        # Plain lights, no environment map: colours stay what the legend says, and a browser that
        # draws without a GPU is four times as fast.
        scene.configure_environment_map(None)
        scene.configure_default_lights(False)
        # A second one from behind and the edges of bodies tell their form, without shadows.
        scene.add_light_ambient("/lights/all", intensity=0.5)
        self._nodes["/lights/sky"] = scene.add_light_hemisphere(
            "/lights/sky", sky_color=(255, 255, 255), intensity=1.0
        )
        for name, strength, place in (
            ("sun", 2.1, (0.5, -0.7, 1.3)),
            ("fill", 0.5, (-0.9, 0.4, 0.5)),
        ):
            scene.add_light_directional(
                f"/lights/{name}", intensity=strength, cast_shadow=False, position=place
            )
        self._ground = Ground(self)
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
        self.handle = self.sized(handle, scale=HANDLE)

    def show(self, view: View, *, dragging: bool) -> None:
        """Bring the machine, its frames and marks to a view."""
        options, drawing = view.review[Options], view.drawing
        self.resize(drawing.size)
        self.colors = palette.scheme(options.dark)
        self.set(self._nodes["/lights/sky"], ground_color=palette.rgb(self.colors.below))
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
        self._marks(view, options)
        self._frames(view, options.frames)
        self._seen = view
        self._show_ground()
        if self.handle is not None:
            near = self.near and not self.aside
            self.set(self.handle, visible=options.handle and (near or dragging))
            if not dragging:
                self.pose(self.handle, view.platform)
        for draw in self._company:
            draw(view)

    def approach(self, near: bool) -> None:
        """Whether somebody is about to take the handle, who would not see it otherwise."""
        self.near = near
        if self.handle is not None and self._seen is not None:
            shown = (near and not self.aside) or self.held
            self.set(self.handle, visible=self._seen.review[Options].handle and shown)

    def ground(self, what: str, points: Array | None) -> None:
        """Put the ground below something that is shown, by its points (N, 3) mm; None: it is not
        any more.
        """
        self._lowest[what] = math.inf if points is None else float(points[:, 2].min())
        self._show_ground()

    def _show_ground(self) -> None:
        if self._seen is not None:
            self._ground.show(self._seen, min(self._lowest.values(), default=math.inf))

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
            radius[n] = RAIL * bar.radius if bar.role == "rail" else bar.radius
            level = levels.get(bar.limb or 0, "good")
            colors[n] = palette.linear(palette.bar_color(bar, level, self.colors))
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
        """A body, and behind it a larger one of which only the rim is seen: its silhouette."""
        name = f"/machine/{body.name}"
        shape = (body.points, body.radius)
        node, rim = self._nodes.get(name), self._rims.get(name)
        if node is None or rim is None:
            node = self._nodes[name] = self.mesh(name, palette.BASE, None, "front")
            rim = self._rims[name] = self.mesh(f"{name}/rim", palette.BASE, None, "back")
            self.set(rim, visible=True)
        if self._shape.get(name) != shape:
            self._shape[name] = shape
            node.vertices, node.faces = body_mesh(body)
            wider = body.radius + OUTLINE * self.size
            rim.vertices, rim.faces = body_mesh(replace(body, radius=wider))
        color = self.colors.platform if body.role == "platform" else self.colors.base
        self.set(node, color=palette.rgb(color), visible=visible)
        self.set(rim, color=palette.rgb(self.colors.silhouette))
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

    def _marks(self, view: View, options: Options) -> None:
        drawing, shown = view.drawing, {}
        if options.labels:
            origin, flat = view.platform[:3, 3], is_planar(view.review.machine)
            shown = labels(drawing, origin, HANDLE * drawing.size, flat=flat)
        for mark in drawing.points:
            name, named = f"/labels/{mark.name}", shown.get(mark.name)
            self._label(name, named.text if named else "", named.at if named else None)
            if named is not None:
                self.set(self._nodes[name], anchor=named.anchor)
        for mark in drawing.axes:
            name, start, along = f"/axes/{mark.name}", np.array(mark.position), mark.direction
            end = start + 0.55 * drawing.size * np.array(along)
            if name not in self._nodes:
                self._nodes[name] = self.arrows(name, 0.006)
            node = self._nodes[name]
            if options.axes:
                self.set(node, colors=np.array(palette.rgb(self.colors.ink), dtype=np.uint8))
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
