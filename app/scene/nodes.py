"""Scene nodes that are made once and then only brought up to date. Lengths in mm, z up."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
import viser
import viser.transforms as tf
from numpy.typing import ArrayLike, NDArray

from app.scene import palette
from kinematics.arrays import Array

NO_LINE = np.zeros((1, 2, 3), dtype=np.float32)
NOTHING = np.zeros((3, 3), dtype=np.float32)  # a mesh of no area
ONE_FACE = np.array([[0, 1, 2]], dtype=np.uint32)
LABEL = 0.85  # of viser's size of labels: 11 px
LIMBS = 8  # nodes of edges; more than any mechanism has
Side = Literal["front", "back", "double"]
"""From which sides the faces of a mesh are seen."""
_ELSEWHERE = {"position": (-1e5, -1e5, -1e5), "wxyz": (0.0, 0.0, 0.0, 1.0)}


class Nodes:
    """The server's scene: makes nodes with nothing to see, and sets what changes."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.server = server
        self._set: dict[tuple[str, str], object] = {}
        self.size = 1.0  # of the machine, mm
        self.colors = palette.LIGHT  # of the page
        self._sized: list[tuple[Any, dict[str, float]]] = []

    def clear(self) -> None:
        """Take everything off the scene, as another mechanism's things come."""
        self.server.scene.reset()
        self._set.clear()
        self._sized.clear()

    # --- making

    def lines(self, name: str, color: str, thickness: float, *, visible: bool = False) -> Any:
        """Line segments, ``thickness`` px."""
        return self.server.scene.add_line_segments(
            name,
            NO_LINE,
            palette.rgb(color),
            thickness=thickness,
            thickness_units="screen",
            visible=visible,
        )

    def mesh(
        self, name: str, color: str, opacity: float | None = 0.3, side: Side = "double"
    ) -> Any:
        """A mesh without shadows."""
        return self.server.scene.add_mesh_simple(
            name,
            NOTHING,
            ONE_FACE,
            color=palette.rgb(color),
            opacity=opacity,
            side=side,
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )

    def arrows(
        self,
        name: str,
        shaft: float,
        wide: float = 0.0,
        head: float = 0.06,
        color: str = palette.INK,
    ) -> Any:
        """Arrows: their radius, that of their heads and the length of these, of the machine's
        size.
        """
        points = np.array([[[0, 0, 0], [0, 0, 1]]], np.float32)
        made = self.server.scene.add_arrows(name, points, palette.rgb(color), visible=False)
        wide = wide or 3.0 * shaft
        return self.sized(made, shaft_radius=shaft, head_radius=wide, head_length=head)

    def sized(self, node: Any, **parts: float) -> Any:
        """A node some of whose properties are parts of the machine's size."""
        self._sized.append((node, parts))
        self.set(node, **{key: part * self.size for key, part in parts.items()})
        return node

    def resize(self, size: float) -> None:
        """The machine has another size, mm."""
        if size != self.size:
            self.size = size
            for node, parts in self._sized:
                self.set(node, **{key: part * size for key, part in parts.items()})

    def label(self, name: str) -> Any:
        """A text above a point."""
        return self.server.scene.add_label(
            name, "", anchor="bottom-center", font_screen_scale=LABEL, visible=False
        )

    def dragged(self, handle: Any, act: Callable[[str, int | None, Any], None]) -> None:
        """Call ``act(phase, client, handle)`` when a hand moves a handle."""

        async def moved(event: Any) -> None:
            act(event.phase, event.client_id, event.target)

        handle.on_update(moved)

    # --- bringing up to date

    def set(self, node: Any, **values: Any) -> None:
        """Set properties of a node; what it has already is not sent."""
        for key, value in values.items():
            slot = node.name, key
            known = value.tobytes() if isinstance(value, np.ndarray) else value
            if slot in self._set and self._set[slot] == known:
                continue
            if slot not in self._set and key in _ELSEWHERE:
                # A browser keeps the pose of the node of the same name that was taken away, and
                # viser does not send one that is the default: so it is somewhere else at first.
                setattr(node, key, _ELSEWHERE[key])
            setattr(node, key, value)
            self._set[slot] = known

    def pose(self, node: Any, transform: Array) -> None:
        """Put a node somewhere, (4, 4)."""
        self.set(node, position=triple(transform[:3, 3]), wxyz=wxyz(transform[:3, :3]))

    def points(self, node: Any, points: NDArray[Any]) -> None:
        """Bring lines or arrows (N, 2, 3), or dots (N, 3), to these, if there are any."""
        if len(points):
            self.set(node, points=np.asarray(points, dtype=np.float32))
        self.set(node, visible=bool(len(points)))

    def text(self, label: Any, text: str, position: ArrayLike | None) -> None:
        """Bring a label to a text at a place, and hide it where there is no place."""
        if position is not None:
            self.set(label, text=text, position=triple(np.asarray(position)))
        self.set(label, visible=position is not None)

    def forget(self, name: str) -> None:
        """A node was made anew, or a hand has moved it: what it has is not known."""
        for slot in [slot for slot in self._set if slot[0] == name]:
            del self._set[slot]


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


def colors(codes: Sequence[str]) -> np.ndarray:
    """Colours as arrays have them, (N, 3)."""
    return np.array([palette.rgb(code) for code in codes], dtype=np.uint8).reshape(-1, 3)


def triple(point: Array) -> tuple[float, float, float]:
    """A point as plain numbers."""
    return float(point[0]), float(point[1]), float(point[2])


def wxyz(rotation: Array) -> tuple[float, ...]:
    """A rotation matrix as a quaternion."""
    return tuple(float(v) for v in tf.SO3.from_matrix(rotation).wxyz)


def transform(node: Any) -> Array:
    """Where a node is, (4, 4)."""
    placed = np.eye(4)
    placed[:3, :3] = tf.SO3(np.array(node.wxyz)).as_matrix()
    placed[:3, 3] = node.position
    return placed
