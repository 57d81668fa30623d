"""Plane regions in the scene: filled, with their edges and where control is lost."""

from __future__ import annotations

from typing import Any

from app.features.workspace.compute import Laid, region_colors
from app.scene import palette
from app.scene.edges import Edges
from app.scene.nodes import Nodes

MOST = 12  # regions with a mesh of their own
OPACITY, FAINT = 0.55, 0.2


class Flats:
    """Scene nodes of regions, made once for a mechanism."""

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self._fills: list[Any] = []
        self._edges: Edges | None = None

    def prepare(self, offered: bool) -> None:
        """Make them, with nothing to see; none where the mechanism has no regions."""
        self._fills, self._edges = [], None
        if offered:
            for n in range(MOST):
                fill = self._nodes.mesh(f"/regions/fill{n}", palette.WORKSPACE, OPACITY)
                fill.flat_shading = True
                self._fills.append(fill)
            self._edges = Edges(self._nodes, "/regions", 2.5)

    def show(self, laid: Laid | None, *, faint: bool) -> None:
        """Bring them to these regions; None hides them."""
        colors = () if laid is None else region_colors(laid.regions)
        fills = () if laid is None else laid.fills
        for n, node in enumerate(self._fills):
            seen = n < len(fills) and len(fills[n].faces) > 0
            if seen:
                node.vertices, node.faces = fills[n].vertices, fills[n].faces
                opacity = FAINT if faint else OPACITY
                self._nodes.set(node, color=palette.rgb(colors[n]), opacity=opacity)
            self._nodes.set(node, visible=seen)
        if self._edges is None:
            return
        if laid is None:
            self._edges.hide()
        else:
            self._edges.show(laid.lines, laid.line_limb, laid.locus)
