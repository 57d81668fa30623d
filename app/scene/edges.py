"""Lines of a plane figure in the scene: edges in their limbs' colours, and lost control."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from app.scene import palette
from app.scene.nodes import Nodes
from kinematics.arrays import Array

LIMBS = 8  # nodes of edges; more than any mechanism has


class Edges:
    """Scene nodes, made once for a mechanism, then only brought up to date."""

    def __init__(self, nodes: Nodes, parent: str, thickness: float) -> None:
        """Make them below a node, with nothing to see; ``thickness`` in px."""
        self._nodes = nodes
        self._limbs = [
            nodes.lines(f"{parent}/edges{n}", palette.limb_color(n), thickness)
            for n in range(1, LIMBS + 1)
        ]
        self._locus = nodes.lines(f"{parent}/locus", palette.BEYOND, thickness)

    def show(self, lines: Array, limb: NDArray[Any], locus: Array) -> None:
        """Edges (S, 2, 3) mm, each of a limb (S,), from 1; segments (L, 2, 3) mm along the curves
        where control is lost.
        """
        for n, node in enumerate(self._limbs, 1):
            self._nodes.points(node, lines[limb == n])
        self._nodes.points(self._locus, locus)

    def hide(self) -> None:
        """Show nothing."""
        for node in (*self._limbs, self._locus):
            self._nodes.set(node, visible=False)
