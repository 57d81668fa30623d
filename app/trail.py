"""The way of O′ in the scene: a line, red-orange where something is exceeded, marks at warnings."""

from __future__ import annotations

from typing import Any

import numpy as np

from app import palette
from app.scene import Scene
from app.trajectory import Computed
from kinematics.trajectories import Trajectory

_NO_LINE = np.zeros((1, 2, 3), dtype=np.float32)
_NO_POINT = np.zeros((1, 3), dtype=np.float32)
QUIET = "#6B7683"  # nothing is wrong there


class Trail:
    """Scene nodes, made once for a mechanism, then only brought up to date."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._line: Any = None
        self._marks: Any = None
        self._shown: Computed | None = None

    def prepare(self, size: float) -> None:
        """Make the nodes, with nothing to see."""
        scene = self._scene.server.scene
        self._line = scene.add_line_segments(
            "/trajectory/line",
            _NO_LINE,
            palette.rgb(QUIET),
            thickness=3.0,
            thickness_units="screen",
            visible=False,
        )
        self._marks = scene.add_point_cloud(
            "/trajectory/marks",
            _NO_POINT,
            palette.rgb(palette.BEYOND),
            point_size=0.045 * size,
            point_shape="circle",
            precision="float32",
            visible=False,
        )
        self._shown = None

    def show(self, computed: Computed | None) -> None:
        """Show the way of a trajectory, None for nothing."""
        if computed is self._shown:
            return
        self._shown = computed
        seen = computed is not None
        if computed is not None:
            spots = computed.spots
            self._line.points = np.stack([spots[:-1], spots[1:]], axis=1).astype(np.float32)
            colors = np.array([palette.rgb(QUIET), palette.rgb(palette.BEYOND)], np.uint8)
            self._line.colors = np.repeat(colors[wrong(computed.found)][:, None], 2, axis=1)
            events = computed.found.events
            if len(events):
                self._marks.points = computed.marks.astype(np.float32)
                near = np.array([event.kind != "near" for event in events], dtype=int)
                self._marks.colors = colors[near]
        marked = computed is not None and bool(computed.found.events)
        for node, visible in ((self._line, seen), (self._marks, marked)):
            if node.visible != visible:
                node.visible = visible


def wrong(found: Trajectory) -> np.ndarray:
    """Which of the ways from sample to sample (N − 1,) are beyond something, 0 or 1."""
    flags = np.zeros(len(found.times) - 1, dtype=int)
    for event in found.events:
        if event.kind != "near" and event.end > event.start:
            flags[(found.times[1:] > event.start) & (found.times[:-1] < event.end)] = 1
    return flags
