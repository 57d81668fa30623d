"""The designs that stand beside the present one, and what of the comparison the scene shows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Self

from app.language import tr
from app.review import content as session
from app.review.changes import Change, SetOne, Taken
from app.review.state import Review, Slice
from kinematics.errors import InputError
from kinematics.mechanism import Design

MOST = 3
"""Designs beside the present one."""
PARTS, MACHINES, NOTHING = SHOWN = ("parts", "machines", "nothing")


@dataclass(frozen=True)
class Beside(Slice):
    """Designs beside the present one; ``shown`` is one of `SHOWN`."""

    filed_as: ClassVar[str] = "compare"
    LOOKS: ClassVar[frozenset[str]] = frozenset(("shown",))
    designs: tuple[Design, ...] = ()
    shown: str = PARTS

    @property
    def over(self) -> bool:
        """Whether parts of workspaces lie where the present one's solid does."""
        return bool(self.designs) and self.shown == PARTS

    def checked(self, review: Review) -> Self:
        session.listed(self.shown, SHOWN, tr("compare.shows_what"))
        if len(self.designs) > MOST:
            raise InputError(tr("compare.too_many", n=MOST))
        return self

    def write(self, name: str, review: Review) -> Any:
        if name == "designs":
            return [session.design_entry(design) for design in self.designs]
        return self.shown

    @classmethod
    def taken(cls, name: str, value: Any, review: Review, what: str) -> Any:
        if name != "designs":
            return value
        if not isinstance(value, list) or len(value) > MOST:
            raise InputError(tr("compare.no_list", what=what, most=MOST))
        return tuple(
            session.design_of(each, f"{what} {n}") for n, each in enumerate(value, start=1)
        )


@dataclass(frozen=True)
class PutBeside(Change):
    """Compare the present design with another one, too."""

    design: Design

    def title(self, before: Review, after: Review) -> str:
        return tr("compare.put", name=self.design.name)

    def apply(self, review: Review) -> Taken:
        beside = review[Beside]
        wanted = replace(beside, designs=(*beside.designs, self.design))
        return review.having(wanted.checked(review)), ""


@dataclass(frozen=True)
class TakeAway(Change):
    """Compare no longer with one of the designs, by its number from 0."""

    number: int

    def title(self, before: Review, after: Review) -> str:
        return tr("compare.taken", name=before[Beside].designs[self.number].name)

    def apply(self, review: Review) -> Taken:
        beside = review[Beside]
        if not 0 <= self.number < len(beside.designs):
            raise InputError(tr("compare.none_there"))
        kept = (*beside.designs[: self.number], *beside.designs[self.number + 1 :])
        return review.having(replace(beside, designs=kept)), ""


SetBeside = partial(SetOne, Beside)
"""Set what the scene shows."""
