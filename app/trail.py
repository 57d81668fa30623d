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
QUIET = "#4A5460"  # nothing is wrong there


class Trail:
    """Scene nodes, made once for a mechanism, then only brought up to date."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._lines: list[Any] = []  # where nothing is wrong, and where something is
        self._marks: Any = None
        self._shown: Computed | None = None

    def prepare(self, size: float) -> None:
        """Make the nodes, with nothing to see."""
        scene = self._scene.server.scene
        self._lines = [
            scene.add_line_segments(
                f"/trajectory/{name}",
                _NO_LINE,
                palette.rgb(color),
                thickness=3.5,
                thickness_units="screen",
                visible=False,
            )
            for name, color in (("line", QUIET), ("beyond", palette.BEYOND))
        ]
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
        seen = [False, False]
        if computed is not None:
            spots = computed.spots
            pairs = np.stack([spots[:-1], spots[1:]], axis=1).astype(np.float32)
            flags = wrong(computed.found)
            for n, node in enumerate(self._lines):
                own = pairs[flags == n]
                seen[n] = bool(len(own))
                if len(own):
                    node.points = own
            events = computed.found.events
            if len(events):
                self._marks.points = computed.marks.astype(np.float32)
                colors = [QUIET if event.kind == "near" else palette.BEYOND for event in events]
                self._marks.colors = np.array([palette.rgb(c) for c in colors], np.uint8)
        marked = computed is not None and bool(computed.found.events)
        for node, visible in zip((*self._lines, self._marks), (*seen, marked), strict=True):
            if node.visible != visible:
                node.visible = visible


def wrong(found: Trajectory) -> np.ndarray:
    """Which of the ways from sample to sample (N − 1,) are beyond something, 0 or 1."""
    flags = np.zeros(len(found.times) - 1, dtype=int)
    for event in found.events:
        if event.kind != "near" and event.end > event.start:
            flags[(found.times[1:] > event.start) & (found.times[:-1] < event.end)] = 1
    return flags
