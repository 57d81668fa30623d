"""Solids in the scene, painted with coats, and the sharp edges that make them readable."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.scene import painting, palette
from app.scene.camera import axes_of, toward_of
from app.scene.nodes import NO_LINE, NOTHING, ONE_FACE, Nodes, Side, colors, wxyz
from app.scene.painting import Coat
from kinematics.arrays import Array
from kinematics.facets.solids import SolidSpec

if TYPE_CHECKING:
    from kinematics.solids.csg import BuiltSolid

# Solids are created from the inside out: with equal origins the browser draws in this order, and
# a transparent outer solid drawn first would hide the inner one.
_DRAW_ORDER = ("aspects", "workspace", "H1", "H2", "H3", "plus", "minus", "whole", "body")
COATS = max(painting.STEPS + 1, painting.PIECES + 1)
SIDES: tuple[Side, Side] = ("back", "front")
HERE = 1.5  # as opaque as others is the piece with the machine
FAN = (10.0, 170.0)  # degrees on the screen, from the right over the top: where names stand
_PARTS = {"H1": "H₁", "H2": "H₂", "H3": "H₃", "plus": "+", "minus": "−", "body": "body"}
OUTLINE = (0.0, 0.03)  # opacities of a solid of which only the edges matter

Plane = tuple[Array, float]
"""A normal (3,) and how far along it a plane is, mm: what is beyond is taken away."""


@dataclass(frozen=True, slots=True)
class Look:
    """How a solid is shown.

    Attributes:
        power: of the usual opacities: 0 is opaque, 1 usual, more is fainter.
        faint: of the opacity then, for what is of before.
        outlined: only its edges matter; ``bare``: and nothing else of it is there.
        here: the piece with the machine.
    """

    power: float = 1.0
    faint: float = 1.0
    outlined: bool = False
    bare: bool = False
    here: int | None = None


class Solids:
    """For each solid two meshes, of what is seen from within and from outside; further ones for
    coats, and its edges; made with nothing to see.
    """

    def __init__(self, nodes: Nodes, specs: Iterable[SolidSpec]) -> None:
        self._nodes = nodes
        self._frames: dict[str, Any] = {}
        self._meshes: dict[str, dict[str, list[Any]]] = {}  # of either side, one for each coat
        self._edges: dict[str, Any] = {}
        self._labels: dict[str, Any] = {}  # of the limbs' solids
        self._specs = {spec.key: spec for spec in specs}
        self._faces: dict[str, object] = {}  # which faces a mesh has
        self._shown: dict[str, tuple[object, ...]] = {}
        self._coats: dict[str, tuple[Coat, ...]] = {}
        self._others = nodes.lines("/solids/others", palette.LIGHT.others, 1.0)
        for spec in sorted(self._specs.values(), key=_draw_order):
            name, count = f"/solids/{spec.key}", COATS if spec.limb is None else 1
            add = nodes.server.scene.add_frame
            self._frames[spec.key] = add(name, show_axes=False, visible=False)
            self._meshes[spec.key] = {
                side: [
                    nodes.mesh(f"{name}/{side}{n}", palette.WORKSPACE, side=side)
                    for n in range(count)
                ]
                for side in SIDES
            }
            if spec.limb is not None:
                self._labels[spec.key] = nodes.label(f"/labels/{spec.key}")
            self._edges[spec.key] = nodes.lines(f"{name}/edges", palette.WORKSPACE, 1.0)

    def show(
        self,
        key: str,
        solid: BuiltSolid,
        placement: Array,
        coats: tuple[Coat, ...],
        look: Look,
        cut: Plane | None = None,
    ) -> None:
        """Put a solid on display at a place (4, 4), painted with ``coats``."""
        where = None if cut is None else (cut[0].tobytes(), cut[1])
        shown = (id(solid), placement.tobytes(), id(coats), where)
        if self._shown.get(key) != shown:
            self._shown[key], self._coats[key] = shown, coats
            self._put(key, solid, placement, coats, cut)
        self._fade(key, look)

    def beside(self, solid: BuiltSolid | None, placement: Array) -> None:
        """Show the edges of another solid, pale, at a place (4, 4); None: of none."""
        lines: NDArray[Any] = NO_LINE[:0]
        if solid is not None and solid.triangles:
            lines = solid.edges @ placement[:3, :3].T + placement[:3, 3]
        self._nodes.set(self._others, colors=colors([self._nodes.colors.others])[0])
        self._nodes.points(self._others, lines)

    def hide(self, key: str) -> None:
        """Take a solid off display."""
        self._nodes.set(self._frames[key], visible=False)
        self._shown.pop(key, None)

    def name(self, shown: Mapping[str, tuple[BuiltSolid, Array]]) -> None:
        """Name the limbs' solids on display, each where it stands out in a direction of its own.

        Args:
            shown: each solid with its place (4, 4).
        """
        right, up, _ = axes_of(toward_of(False))
        placed = {
            key: solid.mesh.vertices @ at[:3, :3].T + at[:3, 3]
            for key, (solid, at) in shown.items()
            if key in self._labels and solid.triangles
        }
        # From the right to the left, as they lie there.
        keys = sorted(placed, key=lambda key: -float((placed[key] @ right).mean()))
        for key, label in self._labels.items():
            tip = None
            if key in placed:
                share = (keys.index(key) + 0.5) / len(keys)
                turn = np.radians(FAN[0] + (FAN[1] - FAN[0]) * share)
                far = placed[key] @ (np.cos(turn) * right + np.sin(turn) * up)
                tip = placed[key][int(far.argmax())]
            self._nodes.text(label, title_of(self._specs[key]), tip)

    def _put(
        self,
        key: str,
        solid: BuiltSolid,
        placement: Array,
        coats: tuple[Coat, ...],
        cut: Plane | None,
    ) -> None:
        rotation, offset = placement[:3, :3], placement[:3, 3]
        # All solids keep their origin at zero, so that the drawing order above holds.
        shift = (rotation.T @ offset).astype(np.float32)
        lines = solid.edges + shift if solid.triangles else NO_LINE[:0]
        if cut is not None:
            cut = rotation.T @ cut[0], cut[1]
            lines = painting.below_lines(lines, *cut)
        self._nodes.points(self._edges[key], lines)
        for n in range(len(self._meshes[key]["back"])):
            coat = coats[n] if n < len(coats) and len(coats[n].faces) else None
            self._coat([self._meshes[key][side][n] for side in SIDES], coat, shift, cut)
        shown = {"wxyz": wxyz(rotation), "visible": bool(solid.triangles)}
        self._nodes.set(self._frames[key], **shown)

    def _coat(
        self, both: list[Any], coat: Coat | None, shift: np.ndarray, cut: Plane | None
    ) -> None:
        if coat is None:
            for node in both:
                if self._faces.pop(node.name, None) is not None:
                    node.vertices, node.faces = NOTHING, ONE_FACE
            return
        vertices, faces = coat.vertices + shift, coat.faces
        if cut is not None:
            vertices, faces = painting.below(vertices, faces, *cut)
        for node in both:
            node.vertices = vertices
            if self._faces.get(node.name) is not faces:  # the same solid elsewhere keeps them
                node.faces = self._faces[node.name] = faces
            self._nodes.set(node, color=palette.rgb(coat.color))

    def _fade(self, key: str, look: Look) -> None:
        spec, of = self._specs[key], self._nodes.colors
        line = of.workspace if key == _DRAW_ORDER[0] else of.edge
        if spec.limb is not None:
            line = palette.mixed(palette.solid_color(spec), 0.25 if of is palette.DARK else -0.35)
        self._nodes.set(self._edges[key], colors=colors([line])[0])
        for side, number in zip(SIDES, (0, 1), strict=True):
            for n, node in enumerate(self._meshes[key][side]):
                coat = self._coats[key][n] if n < len(self._coats[key]) else None
                opacity = 0.0
                if coat is not None and not look.bare:
                    shells = OUTLINE if look.outlined else coat.shells
                    opacity = float(shells[number] ** look.power) * look.faint
                    if coat.piece is not None and coat.piece == look.here:
                        opacity *= HERE
                # What is not seen must not hide what is behind it.
                self._nodes.set(node, opacity=min(opacity, 1.0), visible=opacity > 0.0)


def title_of(spec: SolidSpec) -> str:
    """A limb's solid in short: "limb 3", "H₁ limb 3"."""
    part = _PARTS.get(spec.key.partition("/")[2], "")
    return f"{part} limb {spec.limb}".strip()


def _draw_order(spec: SolidSpec) -> int:
    part = spec.key.partition("/")[2] or spec.key
    return _DRAW_ORDER.index(part) if part in _DRAW_ORDER else len(_DRAW_ORDER)
