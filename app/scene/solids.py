"""Solids in the scene, painted with coats, and the sharp edges that make them readable."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from app.scene import painting, palette
from app.scene.creases import crease_lines
from app.scene.nodes import NO_LINE, NOTHING, ONE_FACE, Nodes, wxyz
from app.scene.painting import Coat
from kinematics.arrays import Array
from kinematics.facets.solids import SolidSpec

if TYPE_CHECKING:
    from kinematics.solids.csg import BuiltSolid

# Solids are created from the inside out: with equal origins the browser draws in this order, and
# a transparent outer solid drawn first would hide the inner one.
_DRAW_ORDER = ("aspects", "workspace", "H1", "H2", "H3", "plus", "minus", "whole", "body")
COATS = max(painting.STEPS + 1, painting.PIECES + 1)


class Solids:
    """A mesh for each solid, further ones for coats, and its edges; made with nothing to see."""

    def __init__(self, nodes: Nodes, specs: Iterable[SolidSpec]) -> None:
        self._nodes = nodes
        self._meshes: dict[str, list[Any]] = {}  # the solid's own, then those of its coats
        self._edges: dict[str, Any] = {}
        self._lines: dict[str, tuple[BuiltSolid, np.ndarray]] = {}
        self._faces: dict[str, object] = {}  # which faces a mesh has
        self._shown: dict[str, tuple[object, ...]] = {}
        self._coats: dict[str, tuple[Coat, ...]] = {}
        for spec in sorted(specs, key=_draw_order):
            color, name = palette.solid_color(spec), f"/solids/{spec.key}"
            meshes = [self._nodes.mesh(name, color)]
            if spec.limb is None:
                meshes += [self._nodes.mesh(f"{name}/coat{n}", color) for n in range(COATS)]
            self._meshes[spec.key] = meshes
            edges = palette.mixed(color, -0.35)
            self._edges[spec.key] = self._nodes.lines(f"{name}/edges", edges, 1.3, visible=True)

    def show(
        self, key: str, solid: BuiltSolid, placement: Array, coats: tuple[Coat, ...], opacity: float
    ) -> None:
        """Put a solid on display at a place (4, 4), painted with ``coats``."""
        shown = (id(solid), placement.tobytes(), id(coats))
        if self._shown.get(key) != shown:
            self._shown[key], self._coats[key] = shown, coats
            self._put(key, solid, placement, coats)
        self._fade(key, opacity)

    def hide(self, key: str) -> None:
        """Take a solid off display."""
        self._nodes.set(self._meshes[key][0], visible=False)
        self._shown.pop(key, None)

    def _put(self, key: str, solid: BuiltSolid, placement: Array, coats: tuple[Coat, ...]) -> None:
        node, *others = self._meshes[key]
        rotation, offset = placement[:3, :3], placement[:3, 3]
        # All solids keep their origin at zero, so that the drawing order above holds.
        shift = (rotation.T @ offset).astype(np.float32)
        lines = self._creases(key, solid) if solid.triangles else NO_LINE[:0]
        self._edges[key].points = lines + shift if len(lines) else NO_LINE
        # One coat is the solid's own mesh; several have a mesh each, and it has none.
        single = len(coats) == 1
        self._coat(node, coats[0] if single else None, shift)
        for n, other in enumerate(others):
            coat = coats[n] if not single and n < len(coats) else None
            if coat is not None:
                self._coat(other, coat, shift)
            self._nodes.set(other, visible=coat is not None)
        self._nodes.set(node, wxyz=wxyz(rotation), visible=bool(solid.triangles))

    def _coat(self, node: Any, coat: Coat | None, shift: np.ndarray) -> None:
        if coat is None or not len(coat.faces):
            if self._faces.pop(node.name, None) is not None:
                node.vertices, node.faces = NOTHING, ONE_FACE
            return
        node.vertices = coat.vertices + shift
        if self._faces.get(node.name) is not coat.faces:  # the same solid elsewhere keeps them
            node.faces = self._faces[node.name] = coat.faces
        self._nodes.set(node, color=palette.rgb(coat.color))

    def _creases(self, key: str, solid: BuiltSolid) -> np.ndarray:
        """The crease lines of a solid where it was built; found once, then only moved."""
        known = self._lines.get(key)
        if known is None or known[0] is not solid:
            mesh = solid.shaded
            known = self._lines[key] = solid, crease_lines(mesh.vertices, mesh.faces)
        return known[1]

    def _fade(self, key: str, opacity: float) -> None:
        node, *others = self._meshes[key]
        self._nodes.set(node, opacity=opacity)
        coats = self._coats[key]
        if len(coats) > 1:
            for coat, other in zip(coats, others, strict=False):
                self._nodes.set(other, opacity=min(coat.opaque * opacity, 1.0))


def _draw_order(spec: SolidSpec) -> int:
    part = spec.key.partition("/")[2] or spec.key
    return _DRAW_ORDER.index(part) if part in _DRAW_ORDER else len(_DRAW_ORDER)
