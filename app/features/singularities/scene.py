"""How the platform is held, in the scene: wrench lines, ways to what is nearest, free motion."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.features.section.inscribed_scene import Ball
from app.features.singularities.compute import Here
from app.features.singularities.state import Control
from app.review.state import Options
from app.review.units import how_far
from app.review.view import View
from app.scene import palette
from app.scene.machine import Scene, body_mesh, fresh, wxyz
from kinematics.answers.clearances import Clearance
from kinematics.answers.motion import WrenchSystem
from kinematics.answers.sections import Sphere
from kinematics.arrays import Array

MOST = 8  # wrenches, and clearances, that are drawn
REACH = 0.9  # of the machine's size: half a wrench's line
SWING = 0.22  # of the machine's size: how far the free motion is shown
PERIOD, SWINGS = 1.6, 2  # s, and how often
# Those that are named in the scene; more labels would lie one over the other.
_WHAT = {
    "parallel": "singular",
    "constraint": "singular",
    "boundary": "end of the workspace",
}
_NO_LINE = np.zeros((1, 2, 3), dtype=np.float32)


class Held:
    """Scene nodes, made once for a mechanism, then only moved."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._lines: list[Any] = []
        self._arrows: Any = None
        self._ways: Any = None
        self._labels: list[Any] = []
        self._ghost: Any = None
        self._ghost_of: object = None
        self._ball = Ball(scene, "/free", palette.FREE)

    def prepare(self, size: float) -> None:
        """Make the nodes, with nothing to see."""
        scene = self._scene.server.scene
        self._lines = [
            scene.add_line_segments(
                f"/control/wrench{n}",
                _NO_LINE,
                palette.rgb(palette.limb_color(n + 1)),
                thickness=2.0,
                thickness_units="screen",
                visible=False,
            )
            for n in range(MOST)
        ]
        self._arrows = scene.add_arrows(
            "/control/arrows",
            np.zeros((1, 2, 3), np.float32),
            palette.rgb(palette.INK),
            shaft_radius=0.008 * size,
            head_radius=0.024 * size,
            head_length=0.06 * size,
            visible=False,
        )
        self._ways = scene.add_line_segments(
            "/control/ways",
            _NO_LINE,
            palette.rgb(palette.INK),
            thickness=2.5,
            thickness_units="screen",
            visible=False,
        )
        self._labels = [
            scene.add_label(f"/control/labels/way{n}", "", anchor="bottom-center", visible=False)
            for n in range(MOST)
        ]
        self._ghost = scene.add_mesh_simple(
            "/control/ghost",
            np.zeros((3, 3), np.float32),
            np.array([[0, 1, 2]], np.uint32),
            color=palette.rgb(palette.BEYOND),
            opacity=0.6,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )
        fresh(self._ghost)
        self._ghost_of = None
        self._ball.prepare()

    def show(self, view: View, here: Here | None, ball: Sphere | None) -> None:
        """Bring them to what is known of the present place."""
        control, size = view.review[Control], view.drawing.size
        wrenches = here.wrenches if here is not None and control.wrenches else None
        self._wrenches(wrenches, size, view.review[Options].dark)
        self._clearances(view, here if control.clearances else None)
        self._ball.show(ball)

    def _wrenches(self, system: WrenchSystem | None, size: float, dark: bool) -> None:
        forces: list[tuple[Array, Array, str]] = []
        couples: list[tuple[Array, Array, str]] = []
        if system is not None:
            for name, row, point in zip(system.names, system.rows, system.point, strict=True):
                if not np.isfinite(row).all():
                    continue
                ink = palette.INK_DARK if dark else palette.INK
                color = palette.limb_color(name.limb) if name.limb else ink
                length = float(np.linalg.norm(row[:3]))
                if length > 0.0:
                    forces.append((point, row[:3] / length, color))
                else:
                    couples.append((point, row[3:] / np.linalg.norm(row[3:]), ink))
        for n, node in enumerate(self._lines):
            seen = n < len(forces)
            if node.visible != seen:
                node.visible = seen
            if seen:
                point, along, color = forces[n]
                ends = np.stack([point - REACH * size * along, point + REACH * size * along])
                node.points = ends[None].astype(np.float32)
                node.colors = np.array(palette.rgb(color), np.uint8)
        arrows = [(p, p + 0.3 * size * d, c) for p, d, c in forces]
        # A couple is an arrow with two heads, as in mechanics.
        arrows += [(p, p + 0.45 * size * d, c) for p, d, c in couples]
        arrows += [(p, p + 0.39 * size * d, c) for p, d, c in couples]
        self._arrows.visible = bool(arrows)
        if arrows:
            points = np.array([(start, end) for start, end, _ in arrows], dtype=np.float32)
            self._arrows.points = points
            colors = np.array([palette.rgb(c) for _, _, c in arrows], np.uint8)
            self._arrows.colors = colors

    def _clearances(self, view: View, here: Here | None) -> None:
        ways = () if here is None else here.clearances
        shown: list[Clearance] = []
        for way in ways:  # one of a kind is enough to see, and one at a place
            if all(way.kind != w.kind and way.point != w.point for w in shown):
                shown.append(way)
        shown = shown[:MOST]
        origin = view.platform[:3, 3]
        self._ways.visible = bool(shown)
        if shown:
            ends = np.array([(origin, way.point) for way in shown], dtype=np.float32)
            self._ways.points = ends
            colors = np.array(
                [
                    palette.rgb(
                        palette.BEYOND
                        if way.kind in ("parallel", "constraint")
                        else palette.limb_color(way.limb)
                        if way.limb
                        else palette.mixed(palette.WORKSPACE, -0.3)
                    )
                    for way in shown
                ],
                np.uint8,
            )
            self._ways.colors = np.repeat(colors[:, None], 2, axis=1)
        named = [way for way in shown if way.kind in _WHAT]
        for n, label in enumerate(self._labels):
            seen = n < len(named)
            if label.visible != seen:
                label.visible = seen
            if seen:
                label.text = f"{how_far(named[n])} · {_WHAT[named[n].kind]}"
                label.position = tuple(float(v) for v in named[n].point)

    def swing(self, view: View, motion: tuple[float, ...], elapsed: float) -> bool:
        """The platform's ghost on its free motion; False when the show is over."""
        over = elapsed > SWINGS * PERIOD
        self._ghost.visible = not over
        if over:
            return False
        bodies = tuple(b for b in view.drawing.bodies if b.frame == "platform")
        if not bodies:
            return False
        if self._ghost_of != bodies[0]:
            self._ghost_of = bodies[0]
            self._ghost.vertices, self._ghost.faces = body_mesh(bodies[0])
        review = view.review
        step = SWING * view.drawing.size * np.sin(2 * np.pi * elapsed / PERIOD)
        pose = np.array(review.pose) + step * np.array(motion)
        at = review.machine.transform(pose, review.mode)
        self._ghost.position = tuple(float(v) for v in at[:3, 3])
        self._ghost.wxyz = wxyz(at[:3, :3])
        return True

    def still(self) -> None:
        """No ghost any more."""
        if self._ghost is not None and self._ghost.visible:
            self._ghost.visible = False
