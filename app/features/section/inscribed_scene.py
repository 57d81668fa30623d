"""The largest balls and boxes in the scene."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.scene import palette
from app.scene.machine import Scene
from kinematics.answers.sections import Box, Sphere
from kinematics.arrays import Array

INSIDE = palette.mixed(palette.WORKSPACE, -0.2)
_NO_LINE = np.zeros((1, 2, 3), dtype=np.float32)


class Ball:
    """A ball in the scene, with its radius beside it."""

    def __init__(self, scene: Scene, name: str, color: str) -> None:
        self._scene = scene
        self._name = name
        self._color = color
        self._node: Any = None
        self._label: Any = None

    def prepare(self) -> None:
        """Make the nodes, with nothing to see."""
        scene = self._scene.server.scene
        vertices, faces = _BALL
        self._node = scene.add_mesh_simple(
            f"{self._name}/ball",
            vertices.astype(np.float32),
            faces,
            color=palette.rgb(self._color),
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )
        self._label = scene.add_label(
            f"/labels{self._name} ball", "", anchor="bottom-center", visible=False
        )

    def show(self, ball: Sphere | None) -> None:
        """Bring it to this one; None hides it."""
        for node in (self._node, self._label):
            if node.visible != (ball is not None):
                node.visible = ball is not None
        if ball is not None:
            self._node.position, self._node.scale = tuple(ball.center), ball.radius
            self._label.text = f"radius {ball.radius:.1f} mm"
            self._label.position = tuple(ball.center + np.array([0.0, 0.0, ball.radius]))


class Inside:
    """Scene nodes of the largest ball and of the largest box."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._ball = Ball(scene, "/inside", INSIDE)
        self._box: Any = None
        self._label: Any = None

    def prepare(self) -> None:
        """Make the nodes, with nothing to see."""
        scene = self._scene.server.scene
        self._ball.prepare()
        self._box = scene.add_line_segments(
            "/inside/box",
            _NO_LINE,
            palette.rgb(palette.mixed(INSIDE, -0.4)),
            thickness=3.0,
            thickness_units="screen",
            visible=False,
        )
        self._label = scene.add_label(
            "/labels/largest box", "", anchor="bottom-center", visible=False
        )

    def show(self, ball: Sphere | None, box: Box | None) -> None:
        """Bring them to these; None hides one."""
        self._ball.show(ball)
        for node in (self._box, self._label):
            node.visible = box is not None
        if box is not None:
            corners = np.where(_CORNERS, box.high, box.low)
            self._box.points = corners[_BOX_EDGES].astype(np.float32)
            size = " × ".join(f"{side:.1f}" for side in box.high - box.low)
            self._label.text = f"{size} mm"
            middle = 0.5 * (box.low + box.high)
            self._label.position = (float(middle[0]), float(middle[1]), float(box.high[2]))


def _sphere(rings: int = 24, sides: int = 48) -> tuple[Array, np.ndarray]:
    """A unit sphere: vertices (V, 3) and faces (F, 3) turned outwards."""
    polar, around = np.meshgrid(
        np.pi * np.arange(rings + 1) / rings,
        2 * np.pi * np.arange(sides) / sides,
        indexing="ij",
    )
    vertices = np.stack(
        [np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1
    ).reshape(-1, 3)
    ring, side = np.meshgrid(np.arange(rings), np.arange(sides), indexing="ij")
    a, b = ring * sides + side, ring * sides + (side + 1) % sides
    faces = np.stack([a, a + sides, b, b, a + sides, b + sides], axis=-1).reshape(-1, 3)
    return vertices, faces.astype(np.uint32)


_BALL = _sphere()
_CORNERS = np.array([[n & 1, n >> 1 & 1, n >> 2 & 1] for n in range(8)], dtype=bool)
_BOX_EDGES = np.array([[n, n | 1 << k] for n in range(8) for k in range(3) if not n >> k & 1])
