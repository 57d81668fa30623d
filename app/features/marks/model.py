"""Marks as plain values: saved views, notes, dimensions, and what they are fixed to.

Lengths in mm and angles in rad. What a mark is fixed to is called by the machine's own names, so
that marks follow the machine.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, TypeVar

from app.language import tr
from app.review.state import Review, Slice
from app.scene.camera import Camera
from kinematics.errors import InputError

FILED = "marks"
"""What marks are called in a session file."""
POINT, LINE, PLANE = KINDS = ("point", "line", "plane")
Point = tuple[float, float, float]
NEVER = frozenset(("dark", "legend"))
"""Of what is shown: it is of the page, and no view of the machine has any of it."""


@dataclass(frozen=True)
class Anchor:
    """What a mark is fixed to.

    Attributes:
        kind: one of `KINDS`.
        name: what the machine calls it; "" for a place.
        at: that place, base frame; else ().
    """

    kind: str
    name: str = ""
    at: Point | tuple[()] = ()

    @property
    def short(self) -> str:
        """Its name without looking at a machine: "A₁", "rail 1", "(1, 2, 3.5)"."""
        limb, _, part = self.name.rpartition("/")
        number = limb.removeprefix("limb")
        if not self.name:
            return f"({', '.join(f'{v:g}' for v in self.at)})"
        if not number.isdecimal():
            return self.name
        return f"{part}{chr(ord('₀') + int(number))}" if len(part) == 1 else f"{part} {number}"


@dataclass(frozen=True)
class SavedView:
    """Where from, and what is shown.

    Attributes:
        text: its name.
        looks: those slices that say how something is shown, with nothing else in them.
        pose, mode: where the machine stands; () and "" where the view is of any pose.
    """

    LONGEST: ClassVar[int] = 60
    text: str
    camera: Camera
    looks: tuple[Slice, ...] = ()
    pose: tuple[float, ...] = ()
    mode: str = ""


@dataclass(frozen=True)
class Note:
    """A text, where it is pinned, and the pose at which it was written.

    Attributes:
        anchor: None for the place of O′ at that pose.
        camera: from where it was written; None where nobody looked.
    """

    LONGEST: ClassVar[int] = 500
    text: str
    pose: tuple[float, ...]
    mode: str
    anchor: Anchor | None = None
    camera: Camera | None = None


@dataclass(frozen=True)
class Dimension:
    """A distance or an angle between two things, or the angle at the second of three points.

    ``text``: its name, which may be "".
    """

    LONGEST: ClassVar[int] = 60
    text: str
    anchors: tuple[Anchor, ...]


Mark = SavedView | Note | Dimension
M = TypeVar("M", bound=Mark)


def measure_of(anchors: Sequence[Anchor]) -> str:
    """What is measured between things: "distance" or "angle".

    Raises:
        InputError: nothing that is known.
    """
    kinds = tuple(sorted((a.kind for a in anchors), key=KINDS.index))
    if any(not sound(anchor) for anchor in anchors):
        raise InputError(tr("marks.no_thing"))
    if len(set(anchors)) == len(anchors):
        if len(kinds) == 2:
            return "distance" if kinds[0] == POINT else "angle"
        if kinds == (POINT,) * 3:
            return "angle"
    raise InputError(tr("marks.no_measure"))


def looks_of(review: Review) -> tuple[Slice, ...]:
    """What is shown of a review, as a saved view has it."""
    return tuple(look_of(piece) for piece in review.slices if shows(piece))


def shows(piece: Slice) -> bool:
    """Whether a slice says how something is shown."""
    return bool(piece.LOOKS) and piece.filed_as != FILED


def look_of(piece: Slice) -> Slice:
    """A slice with nothing in it but how something is shown."""
    kept = {name: getattr(piece, name) for name in piece.LOOKS - NEVER}
    return type(piece)(**kept)


def named(mark: M, text: str) -> M:
    """The mark with a text that was typed.

    Raises:
        InputError: it needs one, and there is none; or it is too long.
    """
    text = " ".join(text.split())
    if not text and not isinstance(mark, Dimension):
        raise InputError(tr("marks.no_text" if isinstance(mark, Note) else "marks.no_name"))
    if len(text) > mark.LONGEST:
        raise InputError(tr("marks.too_long", n=mark.LONGEST))
    return replace(mark, text=text)


def sound(anchor: Anchor) -> bool:
    """Whether it is something at all; of what machine is not asked."""
    if anchor.kind == POINT and not anchor.name:
        return len(anchor.at) == 3 and all(math.isfinite(v) and abs(v) < 1e6 for v in anchor.at)
    return anchor.kind in KINDS and bool(anchor.name) and not anchor.at
