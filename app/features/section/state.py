"""The plane in which the workspace is cut."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Self

from app.language import tr
from app.review import content as session
from app.review.changes import Change, SetOne, Taken
from app.review.state import Review, Slice
from app.review.units import within
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.machine import Machine
from kinematics.mechanism import Coordinate

DRAWN = 384  # px over which the drawing lies at the left of the scene
FAR = 1e4  # mm; a plane may stand this far off, where it cuts nothing


@dataclass(frozen=True)
class Cut(Slice):
    """The plane: whether it is on display, where (mm), and whether solids end there (``clip``)."""

    filed_as: ClassVar[str] = "section"
    LOOKS: ClassVar[frozenset[str]] = frozenset(("on", "clip"))
    on: bool = False
    at: float = 0.0
    clip: bool = True

    @classmethod
    def fresh(cls, review: Review) -> Self:
        return cls(at=point_in_section(review)[0])

    def carried(self, before: Review, review: Review) -> Self:
        return replace(review[type(self)], on=self.on, clip=self.clip)

    @classmethod
    def read(cls, content: dict[str, Any], review: Review, origin: str) -> Self:
        given = session.table(content, cls.filed_as, origin)
        on, clip = given.get("on", False), given.get("clip", True)
        if not (isinstance(on, bool) and isinstance(clip, bool)):
            raise InputError(tr("session.wrong_kind", what=f"{origin}: {cls.filed_as!r}"))
        at = session.number(given.get("at", review[cls].at), f"{origin}: {cls.filed_as}: at")
        return cls(on, within_reach(review, at)[0], clip)


SetCut = partial(SetOne, Cut)
"""Set one thing of the section, as whether it is on display."""


@dataclass(frozen=True)
class MoveCut(Change):
    """Set where the section's plane stands, mm."""

    at: float
    gesture: str = "cut"
    held: int = 0

    def apply(self, review: Review) -> Taken:
        at, note = within_reach(review, self.at)
        return review.having(replace(review[Cut], at=at)), note


def point_in_section(review: Review) -> tuple[float, float, float]:
    """The platform's position (mm) in the frame of sections: along the normal, then in the plane.

    Zeros for a mechanism that has no sections.
    """
    return place_in_section(review.machine, review.pose, review.mode)


def place_in_section(
    machine: Machine[Any], pose: Sequence[float], mode: str
) -> tuple[float, float, float]:
    """The same of a machine at a pose in a mode."""
    if machine.sections is None:
        return 0.0, 0.0, 0.0
    frame = machine.sections.frame(pose)
    position = machine.transform(pose, mode)[:3, 3]
    x, y, z = frame[:3, :3].T @ (position - frame[:3, 3])
    return float(x), float(y), float(z)


def clipping(review: Review) -> tuple[Array, float] | None:
    """The plane beyond which solids are taken away, in the base frame: its normal (3,) and how far
    along it the plane is, mm; None while they are whole.
    """
    cut, sections = review[Cut], review.machine.sections
    if not (cut.on and cut.clip) or sections is None:
        return None
    frame = sections.frame(review.pose)
    return frame[:3, 0], cut.at + float(frame[:3, 0] @ frame[:3, 3])


def within_reach(review: Review, at: float) -> tuple[float, str]:
    """A plane's place (mm), kept where something can be, and a sentence if it had to be kept.

    Raises:
        InputError: it is no finite number.
    """
    spec = review.machine.section_spec
    name = tr("section.the_section") if spec is None else spec.normal
    sides = [max(abs(c.lower), abs(c.upper)) for c in review.machine.coordinates if c.unit == "mm"]
    far = max(FAR, float(math.ceil(math.hypot(*sides))))
    return within(Coordinate("at", name, "mm", -far, far), at)
