"""Which design is reviewed, and its numbers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

from app.features.move.state import completed
from app.language import tr
from app.review import content as session
from app.review.changes import Change, Taken
from app.review.state import Review, Slice, new_review
from app.review.units import within
from kinematics.designs.origins import as_edited
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanism import Design

MOST = 50
"""Milestones of a review."""
LONGEST = 60
"""Letters of a milestone's name."""


@dataclass(frozen=True)
class UseDesign(Change):
    """Review another design, from its home posture; what is shown stays as far as it can."""

    design: Design

    def apply(self, review: Review) -> Taken:
        fresh = new_review(self.design)
        kept = fresh.having(*(piece.carried(review, fresh) for piece in review.slices))
        try:
            return kept.giving_way(review.gives_way), ""
        except InputError:
            return kept, ""


@dataclass(frozen=True)
class Milestone:
    """A state of the design that somebody named."""

    name: str
    design: Design


@dataclass(frozen=True)
class Milestones(Slice):
    """The states of the design that were kept, in the order in which they were."""

    filed_as: ClassVar[str] = "milestones"
    kept: tuple[Milestone, ...] = ()

    def checked(self, review: Review) -> Self:
        if len(self.kept) > MOST:
            raise InputError(tr("design.too_many_milestones", n=MOST))
        return self

    def write(self, name: str, review: Review) -> Any:
        return [{"milestone": m.name, **session.design_entry(m.design)} for m in self.kept]

    @classmethod
    def taken(cls, name: str, value: Any, review: Review, what: str) -> Any:
        found = []
        for n, entry in enumerate(value if isinstance(value, list) else [None], start=1):
            design = session.design_of(entry, f"{what} {n}")
            found.append(Milestone(str(entry.get("milestone", design.name)), design))
        return tuple(found)


@dataclass(frozen=True)
class KeepMilestone(Change):
    """Keep the present state of the design under a name."""

    name: str

    def title(self, before: Review, after: Review) -> str:
        return tr("design.kept", name=self.name)

    def apply(self, review: Review) -> Taken:
        name = " ".join(self.name.split())[:LONGEST]
        if not name:
            raise InputError(tr("design.no_name"))
        kept = [m for m in review[Milestones].kept if m.name != name]
        wanted = Milestones((*kept, Milestone(name, review.design)))
        return review.having(wanted.checked(review)), ""


@dataclass(frozen=True)
class DropMilestone(Change):
    """Forget a milestone, by its name."""

    name: str

    def title(self, before: Review, after: Review) -> str:
        return tr("design.dropped", name=self.name)

    def apply(self, review: Review) -> Taken:
        kept = tuple(m for m in review[Milestones].kept if m.name != self.name)
        return review.having(Milestones(kept)), ""


@dataclass(frozen=True)
class GoBackTo(Change):
    """Review a milestone; the pose stays where the machine has the same coordinates."""

    milestone: Milestone

    def title(self, before: Review, after: Review) -> str:
        return tr("design.restored", name=self.milestone.name)

    def apply(self, review: Review) -> Taken:
        design = self.milestone.design
        if (
            design.mechanism != review.design.mechanism
            or review.mode not in machine_of(design).modes
        ):
            return UseDesign(design).apply(review)
        return replaced(review, design)


@dataclass(frozen=True)
class EditDesign(Change):
    """Set some numbers of the design; the pose stays."""

    edits: tuple[tuple[tuple[str | int, ...], float], ...]

    @property
    def gesture(self) -> str:
        return f"edit {self.edits[0][0][:-1]}"

    def apply(self, review: Review) -> Taken:
        machine = review.machine
        for path, value in self.edits:
            machine = machine.edited(path, value)
        return replaced(review, as_edited(machine.design))


def replaced(review: Review, design: Design) -> Taken:
    """The review of another design of the same kind, at the same pose."""
    coordinates = review.machine.coordinates
    pose = tuple(within(c, v, beyond=1.0)[0] for c, v in zip(coordinates, review.pose, strict=True))
    edited = replace(review, design=design, pose=pose)
    try:
        return replace(edited, pose=completed(edited, pose)), ""
    except InputError:  # what the new numbers ask of the pose nothing can give; told there
        return edited, ""
