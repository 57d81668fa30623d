"""Designs over one another in the scene: the parts of their workspaces, and their machines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.features.compare import LETTERS
from app.features.compare.compute import Drawn
from app.features.compare.html import colors
from app.features.compare.state import MOST
from app.features.solutions.scene import outline
from app.scene import palette
from app.scene.nodes import NO_LINE, Nodes, Side
from app.scene.solids import SIDES
from kinematics.answers.drawings import Drawing
from kinematics.arrays import Array

SHELLS = (0.14, 0.24)  # opacities of what is seen from within and from outside
FAINT = 0.4
ROLES = ("cylinder", "rod", "link")


class Overlaid:
    """Scene nodes, made with nothing to see: parts, what is shared first, and machines."""

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self._parts = [
            (
                [self._mesh(f"/compare/part{n}/{side}", side) for side in SIDES],
                nodes.lines(f"/compare/part{n}/edges", palette.WORKSPACE, 1.0),
            )
            for n in range(MOST + 2)
        ]
        self._machines = [
            (
                nodes.lines(f"/compare/machine{n}/bars", palette.WORKSPACE, 3.0),
                nodes.lines(f"/compare/machine{n}/bodies", palette.WORKSPACE, 1.4),
                nodes.label(f"/labels/compare{n}"),
            )
            for n in range(MOST)
        ]
        self._shown: Sequence[Drawn] = ()

    def _mesh(self, name: str, side: Side) -> object:
        return self._nodes.mesh(name, palette.WORKSPACE, side=side)

    def parts(self, found: Sequence[Drawn], *, faint: bool = False) -> None:
        """Bring the parts to these; none hides them."""
        of = self._nodes.colors
        tones = (of.ghost, *colors(of))
        for n, (both, edges) in enumerate(self._parts):
            one = found[n] if n < len(found) and len(found[n].faces) else None
            for opacity, node in zip(SHELLS, both, strict=True):
                if one is not None:
                    if n >= len(self._shown) or self._shown[n] is not one:
                        node.vertices, node.faces = one.vertices, one.faces  # type: ignore[attr-defined]
                    look = opacity * (FAINT if faint else 1.0)
                    self._nodes.set(node, color=palette.rgb(tones[n]), opacity=look)
                self._nodes.set(node, visible=one is not None)
            lines = NO_LINE[:0] if one is None else one.lines
            self._nodes.points(edges, lines)
            color = np.array(palette.rgb(palette.mixed(tones[n], 0.2)), np.uint8)
            self._nodes.set(edges, colors=color)
        self._shown = tuple(found)

    def machines(self, drawings: Sequence[tuple[Drawing, Array] | None]) -> None:
        """Bring the machines beside the present one to these, each with its platform's place
        (4, 4); None where one cannot be drawn.
        """
        tones = colors(self._nodes.colors)[1:]
        for n, (bars, bodies, label) in enumerate(self._machines):
            one = drawings[n] if n < len(drawings) else None
            if one is None:
                for node in (bars, bodies):
                    self._nodes.points(node, NO_LINE[:0])
                self._nodes.text(label, "", None)
                continue
            drawing, place = one
            color = np.array(palette.rgb(tones[n]), np.uint8)
            kept = [(b.start, b.end) for b in drawing.bars if b.role in ROLES]
            self._nodes.points(bars, np.array(kept).reshape(-1, 2, 3))
            frames = {"base": np.eye(4), "platform": place}
            rims = [
                outline([body]) @ frames[body.frame][:3, :3].T + frames[body.frame][:3, 3]
                for body in drawing.bodies
            ]
            self._nodes.points(bodies, np.concatenate(rims) if rims else NO_LINE[:0])
            for node in (bars, bodies):
                self._nodes.set(node, colors=color)
            self._nodes.text(label, LETTERS[n + 1], place[:3, 3])
