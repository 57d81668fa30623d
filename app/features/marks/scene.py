"""Marks in the scene: dimensions, numbered pins, and what a pointer is on meanwhile."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.features.marks.compute import Measured, Thing, ticks
from app.features.marks.state import MOST
from app.scene import palette
from app.scene.nodes import LABEL, Nodes
from kinematics.arrays import Array

LARGE = 2.0 * LABEL  # of labels while marks are presented
TICK = 0.014  # of the machine's size: half of what is across the end of a dimension
STEM = 0.09  # of it: how high a pin stands above its place
NONE = np.empty((0, 2, 3))
Labelled = tuple[str, Array]
"""A text, and where (3,) it stands."""


class Marked:
    """Scene nodes, made with nothing to see; labels of marks are made as they are needed."""

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self._lines = nodes.lines("/marks/dimensions", palette.INK, 2.0)
        self._stems = nodes.lines("/marks/stems", palette.INK, 2.0)
        self._chosen = nodes.lines("/marks/chosen", palette.INK, 5.0)
        self._heads, self._spots = (
            nodes.sized(
                nodes.server.scene.add_point_cloud(
                    f"/marks/{name}",
                    np.zeros((1, 3), np.float32),
                    palette.rgb(palette.INK),
                    point_shape="circle",
                    precision="float32",
                    visible=False,
                ),
                point_size=part,
            )
            for name, part in (("heads", 0.03), ("spots", 0.055))
        )
        self._near = nodes.label("/labels/near")
        self._labels: dict[str, object] = {}

    def show(
        self,
        measured: Sequence[tuple[str, Measured]],
        pins: Sequence[Labelled],
        *,
        large: bool = False,
    ) -> None:
        """Bring dimensions, each with its name, and pins to these, in ``large`` letters or not."""
        nodes, size = self._nodes, self._nodes.size
        ink = np.array(palette.rgb(nodes.colors.ink), np.uint8)
        drawn = [part for _, m in measured for part in (m.lines, ticks(m.marked, TICK * size))]
        nodes.points(self._lines, np.concatenate(drawn) if drawn else NONE)
        feet = np.array([at for _, at in pins]).reshape(-1, 3)
        heads = feet + np.array([0.0, 0.0, STEM * size])
        nodes.points(self._stems, np.stack([feet, heads], axis=1))
        nodes.points(self._heads, heads)
        for node in (self._lines, self._stems, self._heads):
            nodes.set(node, colors=ink)
        texts = [(f"{name}: {m.text}" if name else m.text, m.at) for name, m in measured]
        scale = LARGE if large else LABEL
        self._name("dimension", texts, scale)
        numbers = [(text, at) for (text, _), at in zip(pins, heads, strict=True)]
        self._name("note", numbers, scale)

    def _name(self, kind: str, texts: Sequence[Labelled], scale: float) -> None:
        for n in range(MOST):
            name = f"/labels/{kind}{n}"
            if n < len(texts) and name not in self._labels:
                self._labels[name] = self._nodes.label(name)
            if name in self._labels:
                text, at = texts[n] if n < len(texts) else ("", None)
                self._nodes.text(self._labels[name], text, at)
                self._nodes.set(self._labels[name], font_screen_scale=scale)

    def choose(self, chosen: Sequence[Thing], near: Thing | None) -> None:
        """Mark what was chosen, and name what is near a pointer."""
        nodes = self._nodes
        color = np.array(palette.rgb(nodes.colors.focus), np.uint8)
        marked = [*chosen, *([near] if near is not None else [])]
        lines = [t.ends for t in marked if t.anchor.kind == "line"]
        spots = [t.at for t in marked if t.anchor.kind != "line"]
        nodes.points(self._chosen, np.array(lines).reshape(-1, 2, 3))
        nodes.points(self._spots, np.array(spots).reshape(-1, 3))
        for node in (self._chosen, self._spots):
            nodes.set(node, colors=color)
        at = None if near is None else near.ends.mean(axis=0)
        nodes.text(self._near, "" if near is None else near.text, at)
