"""Where the names of points stand: away from the middle of the machine, apart from one another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from app.scene.camera import axes_of, toward_of
from kinematics.answers.drawings import Drawing
from kinematics.arrays import Array

SHARED = 18.0  # px; points that are nearer share a name
LETTER, MARGIN, HEIGHT = 6.5, 10.0, 18.0  # px, of a name on the screen
ACROSS = 440.0  # px that a machine has beside its solids, where all is seen whole
DOTS = 6  # along each arrow of the handle, none of which a name is to cover

Side = Literal["center", "left", "right", "top", "bottom"]


@dataclass(frozen=True, eq=False, slots=True)
class Named:
    """A text at a point (3,) mm, beside it as the anchor says."""

    text: str
    at: Array
    anchor: Any


def labels(drawing: Drawing, origin: Array, handle: float, *, flat: bool) -> dict[str, Named]:
    """The names of points by the first mark of each, as they stand in the picture at rest.

    Points whose names would lie on one another share one.

    Args:
        origin: (3,) where the handle is, whose arrows are ``handle`` mm long; no name is on it.
        flat: the machine is seen from above, not as usual.
    """
    points = np.array([mark.position for mark in drawing.points]).reshape(-1, 3)
    seen, middle, arrows = on_screen(drawing, points, origin, handle, flat=flat)
    groups = _near(seen)
    while True:
        texts = [" ".join(drawing.points[n].text for n in group) for group in groups]
        taken = [np.concatenate([at - 6.0, at + 6.0]) for at in arrows]
        anchors, rects = [], []
        for group, text in zip(groups, texts, strict=True):
            at = seen[group[0]]
            anchor, rect = _free(at, text, at - middle, np.array(taken).reshape(-1, 4))
            taken.append(rect)
            anchors.append(anchor)
            rects.append(rect)
        pair = _first_overlap(rects)
        if pair is None:
            break
        groups[pair[0]] += groups.pop(pair[1])
    return {
        drawing.points[group[0]].name: Named(text, points[group[0]], anchor)
        for group, text, anchor in zip(groups, texts, anchors, strict=True)
    }


def on_screen(
    drawing: Drawing, points: Array, origin: Array, handle: float, *, flat: bool
) -> tuple[Array, Array, Array]:
    """Points (N, 2), the middle of the machine (2,) and what the handle covers (M, 2), px to the
    right and up in the picture at rest.
    """
    right, up, _ = axes_of(toward_of(flat), flat=flat)
    to_screen = np.stack([right, up], axis=1)
    ends = np.array([end for bar in drawing.bars for end in (bar.start, bar.end)]) @ to_screen
    low, high = ends.min(axis=0), ends.max(axis=0)
    scale = ACROSS / max(float((high - low).max()), 1e-9)
    arrows = handle * np.linspace(0.0, 1.0, DOTS)[:, None, None] * np.eye(3)
    covered = (origin + arrows).reshape(-1, 3) if handle else np.empty((0, 3))
    return scale * points @ to_screen, 0.5 * scale * (low + high), scale * covered @ to_screen


def _near(seen: Array) -> list[list[int]]:
    """Points that share a name: those near to the first of them."""
    found: list[list[int]] = []
    for n, at in enumerate(seen):
        near = (g for g in found if np.linalg.norm(seen[g[0]] - at) < SHARED)
        group = next(near, None)
        if group is None:
            found.append([n])
        else:
            group.append(n)
    return found


def _free(at: Array, text: str, out: Array, taken: Array) -> tuple[str, Array]:
    """The side of a point at which a text overlaps least with others, outwards if it can."""
    away: tuple[Side, Side] = ("left", "right") if out[0] >= 0.0 else ("right", "left")
    over: tuple[Side, Side] = ("bottom", "top") if out[1] >= 0.0 else ("top", "bottom")
    sides = [(v, h) for h in (away[0], "center", away[1]) for v in (over[0], "center", over[1])]
    sides.remove(("center", "center"))
    rects = np.array([rect_of(at, text, f"{v}-{h}") for v, h in sides])
    n = int(_overlaps(rects, taken).sum(axis=1).argmin())
    return "-".join(sides[n]), rects[n]


def rect_of(at: Array, text: str, anchor: str) -> Array:
    """What a text covers beside a point (2,) on the screen: left, bottom, right, top."""
    size = np.array([MARGIN + LETTER * len(text), HEIGHT])
    shift = {"left": 0.0, "bottom": 0.0, "center": 0.5, "right": 1.0, "top": 1.0}
    vertical, horizontal = anchor.split("-")
    low = at - size * [shift[horizontal], shift[vertical]]
    rect: Array = np.concatenate([low, low + size])
    return rect


def _first_overlap(rects: list[Array]) -> tuple[int, int] | None:
    pairs = np.argwhere(np.triu(_overlaps(np.array(rects), np.array(rects)), 1) > 0.0)
    return (int(pairs[0, 0]), int(pairs[0, 1])) if len(pairs) else None


def _overlaps(some: Array, others: Array) -> Array:
    """The areas (N, M), px², that rectangles (N, 4) and (M, 4) have in common."""
    low = np.maximum(some[:, None, :2], others[None, :, :2])
    high = np.minimum(some[:, None, 2:], others[None, :, 2:])
    common: Array = np.maximum(high - low, 0.0).prod(axis=-1)
    return common
