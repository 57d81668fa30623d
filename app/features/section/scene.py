"""The section in the scene, and the ball and the box inside the workspace.

All of it is opaque: the browser draws the translucent solids over it, whereas among translucent
things it draws the nearer ones last and would leave out what is inside them. So the section is
hatched, as in a drawing, and the box is its edges.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from app.features.section.compute import Drawn, Extent
from app.scene import palette
from app.scene.edges import NO_LINE, Edges
from app.scene.machine import Scene, fresh, wxyz
from kinematics.arrays import Array

ROOM = 0.06  # of the region's size around it in the outline of the plane


class Plane:
    """Scene nodes of the section; made once for a mechanism, then only brought up to date."""

    def __init__(self, scene: Scene, moved: Callable[[str, int | None, float], None]) -> None:
        self._scene = scene
        self._moved = moved
        self._frame: Any = None
        self._hatch: Any = None
        self._outline: Any = None
        self._edges: Edges | None = None
        self._handle: Any = None
        self._drawn: Drawn | None = None
        self._placed: object = None

    def prepare(self, size: float) -> None:
        """Make the nodes, with nothing to see."""
        scene = self._scene.server.scene
        self._frame = fresh(scene.add_frame("/section", show_axes=False, visible=False))
        self._hatch = scene.add_line_segments(
            "/section/hatch",
            NO_LINE,
            palette.rgb(palette.mixed(palette.WORKSPACE, -0.15)),
            thickness=1.2,
            thickness_units="screen",
        )
        self._outline = scene.add_line_segments(
            "/section/outline",
            NO_LINE,
            palette.rgb(palette.WORKSPACE),
            thickness=1.5,
            thickness_units="screen",
        )
        self._edges = Edges(self._scene, "/section", 3.0)
        self._handle = scene.add_transform_controls(
            "/section/handle",
            scale=0.3 * size,
            line_width=3.0,
            active_axes=(True, False, False),
            disable_sliders=True,
            disable_rotations=True,
            translation_limits=((-1e4, 1e4),) * 3,
            depth_test=False,
            opacity=0.85,
        )
        self._drawn = self._placed = None

        async def dragged(event: Any) -> None:
            self._moved(event.phase, event.client_id, float(event.target.position[0]))

        self._handle.on_update(dragged)

    def place(
        self, frame: Array, at: float, extent: Extent | None, *, on: bool, dragging: bool
    ) -> None:
        """Put plane and handle where the review has them; what fills it comes by `fill`."""
        placed = (frame.tobytes(), at, id(extent), on, dragging)
        if placed == self._placed:
            return
        self._placed = placed
        if self._frame.visible != on:
            self._frame.visible = on
        if not on:
            return
        self._frame.wxyz = wxyz(frame[:3, :3])
        self._frame.position = frame[:3, 3]
        across = None if extent is None else extent.across
        if across is None:
            self._outline.points = NO_LINE
            corner = (0.0, 0.0)
        else:
            low, high = np.array(across).T
            room = ROOM * float((high - low).max())
            low, high = low - room, high + room
            flat = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
            ring = np.column_stack([np.full(4, at), flat])
            self._outline.points = np.stack([ring, np.roll(ring, -1, axis=0)], axis=1).astype(
                np.float32
            )
            corner = (float(low[0]), float(high[1]))
        if not dragging:  # the hand that holds it decides where it is
            self._handle.position = (at, *corner)

    def fill(self, drawn: Drawn) -> None:
        """Show a section in the plane."""
        if drawn is self._drawn:
            return
        assert self._edges is not None
        before, self._drawn = self._drawn, drawn
        self._edges.show_locus(drawn.locus)
        if before is not None and before.section is drawn.section:
            return
        self._hatch.points = drawn.hatch.astype(np.float32) if len(drawn.hatch) else NO_LINE
        self._edges.show(drawn.lines, drawn.line_limb)
