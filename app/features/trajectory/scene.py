"""The way of O′ in the scene: a line with arrows along it, red-orange where something is exceeded,
marks at way points and at warnings."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.features.trajectory.compute import Computed
from app.scene import palette
from app.scene.machine import Scene
from kinematics.arrays import Array
from kinematics.trajectories import Trajectory

_NO_LINE = np.zeros((1, 2, 3), dtype=np.float32)
_NO_ARROW = np.array([[[0, 0, 0], [0, 0, 1]]], dtype=np.float32)
_NO_POINT = np.zeros((1, 3), dtype=np.float32)
QUIET = "#4A5460"  # nothing is wrong there
ARROWS = 4  # along the way
HEAD = 0.1  # of the machine's size: an arrow's head


class Trail:
    """Scene nodes, made once for a mechanism, then only brought up to date."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._lines: list[Any] = []  # where nothing is wrong, and where something is
        self._marks: Any = None
        self._knots: Any = None
        self._arrows: Any = None
        self._size = 1.0
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

        def dots(name: str, color: str, part: float) -> Any:
            return scene.add_point_cloud(
                f"/trajectory/{name}",
                _NO_POINT,
                palette.rgb(color),
                point_size=part * size,
                point_shape="circle",
                precision="float32",
                visible=False,
            )

        self._marks = dots("marks", palette.BEYOND, 0.045)
        self._knots = dots("knots", QUIET, 0.03)
        self._arrows = scene.add_arrows(
            "/trajectory/arrows",
            _NO_ARROW,
            np.array(palette.rgb(QUIET), np.uint8),
            shaft_radius=0.06 * HEAD * size,
            head_radius=0.3 * HEAD * size,
            head_length=HEAD * size,
            visible=False,
        )
        self._size = size
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
            self._knots.points = computed.knots.astype(np.float32)
            arrows = along(spots, HEAD * self._size)
            if len(arrows):
                self._arrows.points = arrows
        marked = computed is not None and bool(computed.found.events)
        knots = computed is not None
        nodes = (*self._lines, self._marks, self._knots, self._arrows)
        pointed = computed is not None and bool(len(arrows))
        for node, visible in zip(nodes, (*seen, marked, knots, pointed), strict=True):
            if node.visible != visible:
                node.visible = visible


def along(spots: Array, length: float) -> NDArray[np.float32]:
    """Arrows (A, 2, 3) of a length, mm, that point along a way (N, 3), evenly spaced on it; none
    where it is too short for them.
    """
    steps = np.linalg.norm(np.diff(spots, axis=0), axis=1)
    gone = np.concatenate([[0.0], np.cumsum(steps)])
    if not gone[-1] > 3.0 * length:
        return np.empty((0, 2, 3), np.float32)
    count = min(ARROWS, int(gone[-1] / (3.0 * length)))
    heads = gone[-1] * (np.arange(count) + 0.5) / count + 0.5 * length
    ends = np.stack([heads - length, heads], axis=1)
    points = np.stack([np.interp(ends, gone, spots[:, k]) for k in range(3)], axis=-1)
    way = points[:, 1] - points[:, 0]
    straight = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-12)
    points[:, 0] = points[:, 1] - length * straight
    return points.astype(np.float32)


def wrong(found: Trajectory) -> np.ndarray:
    """Which of the ways from sample to sample (N − 1,) are beyond something, 0 or 1."""
    flags = np.zeros(len(found.times) - 1, dtype=int)
    for event in found.events:
        if event.kind != "near" and event.end > event.start:
            flags[(found.times[1:] > event.start) & (found.times[:-1] < event.end)] = 1
    return flags
