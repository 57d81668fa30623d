"""Plane regions in the scene: filled, with their edges and where control is lost."""

from __future__ import annotations

from app.features.workspace.compute import Laid, region_colors
from app.scene import palette
from app.scene.nodes import Edges, Nodes

MOST = 12  # regions with a mesh of their own
OPACITY, FAINT = 0.28, 0.12


class Flats:
    """Scene nodes of regions, made with nothing to see."""

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self._fills = [
            nodes.mesh(f"/regions/fill{n}", palette.WORKSPACE, OPACITY) for n in range(MOST)
        ]
        for fill in self._fills:
            fill.flat_shading = True
        self._edges = Edges(nodes, "/regions", 2.5)

    def show(self, laid: Laid | None, *, faint: bool) -> None:
        """Bring them to these regions; None hides them."""
        colors = () if laid is None else region_colors(laid.regions, self._nodes.colors)
        fills = () if laid is None else laid.fills
        for n, node in enumerate(self._fills):
            seen = n < len(fills) and len(fills[n].faces) > 0
            if seen:
                node.vertices, node.faces = fills[n].vertices, fills[n].faces
                opacity = FAINT if faint else OPACITY
                self._nodes.set(node, color=palette.rgb(colors[n]), opacity=opacity)
            self._nodes.set(node, visible=seen)
        if laid is None:
            self._edges.hide()
        else:
            self._edges.show(laid.lines, laid.line_limb, laid.locus)
