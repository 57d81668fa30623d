"""The ground below everything that is shown: a grid that tells lengths, the base's footprint on it,
and on demand a scale with numbers along x, y and z.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from app.review.state import Options, is_planar
from app.review.view import View
from app.scene import palette
from app.scene.nodes import NO_LINE, NOTHING, ONE_FACE, Nodes
from app.scene.shapes import base_floor, ground_cell
from kinematics.answers.drawings import Drawing
from kinematics.arrays import Array

SECTION = 5  # cells from one stronger line to the next
REACH = 8.0  # of the machine's size: where the grid has faded
FOOT = 0.05  # opacity of the footprint
MARKS = 8  # along the longest axis, and one more
NUMBERS = 2 * MARKS  # labels that there are for each
TICK = 0.12  # of a cell


class Ground:
    """Scene nodes; made before anything translucent, so that it is drawn before."""

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self._grid: Any = nodes.server.scene.add_grid(
            "/grid",
            cell_thickness=0.9,
            section_thickness=1.2,
            shadow_opacity=0.0,
            fade_strength=1.6,
            fade_from="origin",
            visible=False,
        )
        self._foot = nodes.mesh("/footprint", palette.INK, FOOT)
        self._foot_of: object = None
        self._lines = nodes.lines("/scale", palette.INK, 1.2)
        self._numbers = [
            [nodes.label(f"/labels/{axis}{n}") for n in range(NUMBERS)] for axis in "xyz"
        ]

    def show(self, view: View, lowest: float) -> None:
        """Put it below what is lowest (mm), be it the base or a solid."""
        drawing, options = view.drawing, view.review[Options]
        cell = ground_cell(drawing)
        # By whole cells, so that it stays where it is while what is above it changes a little.
        low = min(lowest, base_floor(drawing))
        floor = math.floor((low - 0.1 * cell) / cell) * cell
        fade = cell * math.ceil(REACH * drawing.size / cell)
        nodes, of = self._nodes, self._nodes.colors
        nodes.set(
            self._grid,
            cell_size=cell,
            section_size=SECTION * cell,
            width=2.0 * fade,
            height=2.0 * fade,
            fade_distance=fade,
            cell_color=palette.rgb(of.cell),
            section_color=palette.rgb(of.section),
            position=(0.0, 0.0, floor),
            visible=options.grid,
        )
        self._show_footprint(drawing, floor + 0.002 * drawing.size, on=options.grid)
        self._show_scale(view, cell, floor, on=options.scale)

    def _show_footprint(self, drawing: Drawing, height: float, *, on: bool) -> None:
        base = next(b for b in drawing.bodies if b.name == "base")
        if self._foot_of != base:
            self._foot_of = base
            self._foot.vertices, self._foot.faces = footprint(np.array(base.points), base.radius)
        color = palette.rgb(self._nodes.colors.ink)
        self._nodes.set(self._foot, position=(0.0, 0.0, height), color=color, visible=on)

    def _show_scale(self, view: View, cell: float, floor: float, *, on: bool) -> None:
        lines, numbers = scale_of(view, cell, floor) if on else (NO_LINE[:0], [[], [], []])
        self._nodes.set(self._lines, colors=np.array(palette.rgb(self._nodes.colors.quiet)))
        self._nodes.points(self._lines, lines)
        for labels, axis in zip(self._numbers, numbers, strict=True):
            for n, label in enumerate(labels):
                text, at = axis[n] if n < len(axis) else ("", None)
                self._nodes.text(label, text, at)


def footprint(points: Array, radius: float) -> tuple[Any, Any]:
    """The outline (N, 3) of a body on the ground, filled: vertices and faces."""
    turns = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    round_about = radius * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    cloud = (points[:, None, :2] + round_about).reshape(-1, 2)
    try:
        ring = cloud[ConvexHull(cloud).vertices]
    except QhullError:  # no area
        return NOTHING, ONE_FACE
    n = np.arange(1, len(ring) - 1)
    faces = np.stack([np.zeros_like(n), n, n + 1], axis=1).astype(np.uint32)
    return np.column_stack([ring, np.zeros(len(ring))]).astype(np.float32), faces


Numbers = list[list[tuple[str, Array | None]]]
"""Of each axis: texts, and where they stand, (3,) mm."""


def scale_of(view: View, cell: float, floor: float) -> tuple[Array, Numbers]:
    """Lines (N, 2, 3) along the sides of the machine's box on the ground, with a tick at every cell
    or every second, fifth, … one; and the numbers of the ticks, the last with the axis' name.
    """
    points = np.array([p for bar in view.drawing.bars for p in (bar.start, bar.end)])
    low = np.floor(points.min(axis=0) / cell) * cell
    high = np.ceil(points.max(axis=0) / cell) * cell
    low[2] = floor
    planar = is_planar(view.review.machine)
    tick = TICK * cell
    lines: list[tuple[Array, Array]] = []
    numbers: Numbers = []
    # x along the front, y along the right, z up at the left.
    starts = ((low[0], low[1], floor), (high[0], low[1], floor), (low[0], high[1], floor))
    outward = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0))
    most = float((high - low).max()) / MARKS
    step = cell * next((s for s in (1, 2, 5, 10, 20) if s * cell >= most), 50)
    for k, name in enumerate("xyz"):
        numbers.append([])
        if planar and name == "z":
            continue
        start, out = np.array(starts[k]), np.array(outward[k])
        end = start.copy()
        end[k] = high[k]
        lines.append((start, end))
        values = np.arange(np.ceil(low[k] / step), np.floor(high[k] / step) + 1.0) * step
        for value in values:
            at = start.copy()
            at[k] = value
            lines.append((at, at + tick * out))
            text = f"{value:.10g}".replace("-", "−")
            last = value == values[-1]
            numbers[-1].append((f"{name} {text} mm" if last else text, at + 3.0 * tick * out))
    return np.array(lines), numbers
