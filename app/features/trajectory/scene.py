"""The way of O′ in the scene: a line with arrows along it, red-orange where something is exceeded,
marks at way points and at warnings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.features.trajectory.compute import Computed
from app.scene import palette
from app.scene.nodes import Nodes, colors
from kinematics.arrays import Array
from kinematics.trajectories import Trajectory

QUIET = "#4A5460"  # nothing is wrong there
ARROWS = 4  # along the way
HEAD = 0.1  # of the machine's size: an arrow's head


class Trail:
    """Scene nodes, made with nothing to see, then only brought up to date."""

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self._lines = [  # where nothing is wrong, and where something is
            nodes.lines("/trajectory/line", QUIET, 3.5),
            nodes.lines("/trajectory/beyond", palette.BEYOND, 3.5),
        ]
        self._marks, self._knots = (
            nodes.sized(
                nodes.server.scene.add_point_cloud(
                    f"/trajectory/{name}",
                    np.zeros((1, 3), np.float32),
                    palette.rgb(color),
                    point_shape="circle",
                    precision="float32",
                    visible=False,
                ),
                point_size=part,
            )
            for name, color, part in (("marks", palette.BEYOND, 0.045), ("knots", QUIET, 0.03))
        )
        self._arrows = nodes.arrows("/trajectory/arrows", 0.06 * HEAD, 0.3 * HEAD, HEAD, QUIET)

    def show(self, computed: Computed | None) -> None:
        """Show the way of a trajectory, None for nothing."""
        nodes = self._nodes
        if computed is None:
            for node in (*self._lines, self._marks, self._knots, self._arrows):
                nodes.set(node, visible=False)
            return
        spots, events = computed.spots, computed.found.events
        pairs = np.stack([spots[:-1], spots[1:]], axis=1)
        flags = wrong(computed.found)
        for n, node in enumerate(self._lines):
            nodes.points(node, pairs[flags == n])
        codes = [QUIET if event.kind == "near" else palette.BEYOND for event in events]
        if codes:
            nodes.set(self._marks, colors=colors(codes))
        nodes.points(self._marks, computed.marks)
        nodes.points(self._knots, computed.knots)
        nodes.points(self._arrows, along(spots, HEAD * nodes.size))


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
