"""The section in the scene, and the ball and the box inside the workspace.

But for the plane, all of it is opaque: the browser draws the translucent solids over it, whereas
among translucent things it draws the nearer ones last and would leave out what is inside them. So
the section is filled, and the box is its edges.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from app.features.section.compute import Drawn, Extent
from app.language import tr
from app.scene import palette
from app.scene.nodes import NO_LINE, Edges, Nodes, triple
from app.scene.shapes import BALL
from kinematics.answers.sections import Box, Sphere
from kinematics.arrays import Array

ROOM = 0.06  # of the region's size around it in the outline of the plane
SHEET = 0.06  # opacity of the plane
BEHIND = 1e-3  # of the machine's size
INSIDE = palette.mixed(palette.WORKSPACE, -0.2)


class Plane:
    """Scene nodes of the section, made with nothing to see, then only brought up to date."""

    def __init__(self, nodes: Nodes, moved: Callable[[str, int | None, float], None]) -> None:
        self._nodes = nodes
        scene = nodes.server.scene
        self._frame = scene.add_frame("/section", show_axes=False, visible=False)
        self._cap = nodes.mesh("/section/cap", palette.LIGHT.cut, None)
        self._outline = nodes.lines("/section/outline", palette.INK, 1.2)
        self._edges = Edges(nodes, "/section", 3.2)
        self._label = nodes.label("/section/label")
        self._sheet: Any = None
        handle = scene.add_transform_controls(
            "/section/handle",
            line_width=3.0,
            active_axes=(True, False, False),
            disable_sliders=True,
            disable_rotations=True,
            translation_limits=((-1e4, 1e4),) * 3,
            depth_test=False,
            opacity=0.85,
        )
        self._handle = nodes.sized(handle, scale=0.3)
        nodes.dragged(self._handle, lambda phase, who, at: moved(phase, who, float(at.position[0])))

    def hide(self) -> None:
        """Show nothing of it."""
        self._nodes.set(self._frame, visible=False)
        if self._sheet is not None:
            self._nodes.set(self._sheet, visible=False)

    def place(
        self,
        frame: Array,
        at: float,
        extent: Extent | None,
        text: str,
        *,
        on: bool,
        dragging: bool,
    ) -> None:
        """Put plane and handle where they belong, ``text`` on its upper edge; what fills it comes
        by `fill`.
        """
        if not on:
            self.hide()
            return
        nodes, ink = self._nodes, palette.rgb(self._nodes.colors.ink)
        nodes.set(self._frame, visible=True)
        nodes.pose(self._frame, frame)
        ring, corner, top = NO_LINE[:0], (0.0, 0.0), None
        if extent is not None and extent.across is not None:
            low, high = np.array(extent.across).T
            room = ROOM * float((high - low).max())
            low, high = low - room, high + room
            flat = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
            corners = np.column_stack([np.full(4, at), flat])
            ring = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
            corner = (float(low[0]), float(high[1]))
            top = np.array([at, 0.5 * (low[0] + high[0]), high[1]])
        nodes.set(self._outline, colors=np.array(ink, np.uint8))
        nodes.points(self._outline, ring)
        nodes.text(self._label, text, top)
        self._show_sheet(ring[:, 0] @ frame[:3, :3].T + frame[:3, 3])
        if dragging:  # the hand that holds it decides where it is
            nodes.forget("/section/handle")
        else:
            nodes.set(self._handle, position=(at, *corner))

    def _show_sheet(self, corners: Array) -> None:
        """The plane itself, hardly seen. Its node stands at the origin as those of the solids do,
        and is made after them: so it is drawn after what it would hide.
        """
        if self._sheet is None:
            self._sheet = self._nodes.mesh("/sheet", palette.INK, SHEET)
            self._sheet.faces = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
        if len(corners):
            self._nodes.set(
                self._sheet,
                vertices=corners.astype(np.float32),
                color=palette.rgb(self._nodes.colors.ink),
            )
        self._nodes.set(self._sheet, visible=len(corners) > 0)

    def fill(self, drawn: Drawn) -> None:
        """Show a section in the plane."""
        corners = drawn.fill.reshape(-1, 3)
        # Behind its edges by what cannot be seen, so that they are.
        behind = corners - [BEHIND * self._nodes.size, 0.0, 0.0]
        if len(corners):
            faces = np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
            self._nodes.set(self._cap, vertices=behind.astype(np.float32), faces=faces)
            self._nodes.set(self._cap, color=palette.rgb(self._nodes.colors.cut))
        self._nodes.set(self._cap, visible=len(corners) > 0)
        self._edges.show(drawn.lines, drawn.line_limb, drawn.locus)


class Ball:
    """A ball in the scene, with its radius beside it."""

    def __init__(self, nodes: Nodes, name: str, color: str) -> None:
        self._nodes = nodes
        self._node = nodes.mesh(f"{name}/ball", color, None)
        self._node.vertices, self._node.faces = BALL
        self._label = nodes.label(f"/labels{name} ball")

    def show(self, ball: Sphere | None) -> None:
        """Bring it to this one; None hides it."""
        self._nodes.set(self._node, visible=ball is not None)
        text, top = "", None
        if ball is not None:
            self._nodes.set(self._node, position=triple(ball.center), scale=ball.radius)
            text = tr("section.radius", radius=ball.radius)
            top = ball.center + np.array([0.0, 0.0, ball.radius])
        self._nodes.text(self._label, text, top)


class Inside:
    """Scene nodes of the largest ball and of the largest box."""

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self._ball = Ball(nodes, "/inside", INSIDE)
        self._box = nodes.lines("/inside/box", palette.mixed(INSIDE, -0.4), 3.0)
        self._label = nodes.label("/labels/largest box")

    def show(self, ball: Sphere | None, box: Box | None) -> None:
        """Bring them to these; None hides one."""
        self._ball.show(ball)
        edges, text, top = NO_LINE[:0], "", None
        if box is not None:
            edges = np.where(_CORNERS, box.high, box.low)[_BOX_EDGES]
            text = " × ".join(f"{side:.1f}" for side in box.high - box.low) + " mm"
            top = np.array([*0.5 * (box.low + box.high)[:2], box.high[2]])
        self._nodes.points(self._box, edges)
        self._nodes.text(self._label, text, top)


_CORNERS = np.array([[n & 1, n >> 1 & 1, n >> 2 & 1] for n in range(8)], dtype=bool)
_BOX_EDGES = np.array([[n, n | 1 << k] for n in range(8) for k in range(3) if not n >> k & 1])
