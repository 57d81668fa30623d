"""Lines of a plane figure in the scene: edges in their limbs' colours, and lost control."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.scene import palette
from app.scene.machine import Scene
from kinematics.arrays import Array

LIMBS = 8  # nodes of edges; more than any mechanism has
NO_LINE = np.zeros((1, 2, 3), dtype=np.float32)


class Edges:
    """Scene nodes, made once for a mechanism, then only brought up to date."""

    def __init__(self, scene: Scene, parent: str, thickness: float) -> None:
        """Make them below a node, with nothing to see; ``thickness`` in px."""

        def lines(name: str, color: str) -> Any:
            return scene.server.scene.add_line_segments(
                f"{parent}/{name}",
                NO_LINE,
                palette.rgb(color),
                thickness=thickness,
                thickness_units="screen",
                visible=False,
            )

        self._limbs = [lines(f"edges{n}", palette.limb_color(n)) for n in range(1, LIMBS + 1)]
        self._locus = lines("locus", palette.BEYOND)

    def show(self, lines: Array, limb: NDArray[np.integer[Any]]) -> None:
        """Edges (S, 2, 3) mm, each of a limb (S,), from 1."""
        for n, node in enumerate(self._limbs, 1):
            _show(node, lines[limb == n])

    def show_locus(self, lines: Array) -> None:
        """Segments (L, 2, 3) mm along the curves where control is lost."""
        _show(self._locus, lines)

    def hide(self) -> None:
        """Show nothing."""
        for node in (*self._limbs, self._locus):
            _show(node, NO_LINE[:0])


def _show(node: Any, lines: NDArray[Any]) -> None:
    seen = bool(len(lines))
    if seen:
        node.points = lines.astype(np.float32)
    if node.visible != seen:
        node.visible = seen
