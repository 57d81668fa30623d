"""Which design is reviewed, and its numbers."""

from __future__ import annotations

from dataclasses import dataclass, replace

from app.features.move.state import completed
from app.review.changes import Change, Taken
from app.review.state import Review, new_review
from app.review.units import within
from kinematics.designs.origins import as_edited
from kinematics.errors import InputError
from kinematics.mechanism import Design


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
        coordinates = review.machine.coordinates
        pose = tuple(
            within(c, v, beyond=1.0)[0] for c, v in zip(coordinates, review.pose, strict=True)
        )
        edited = replace(review, design=as_edited(machine.design), pose=pose)
        try:
            return replace(edited, pose=completed(edited, pose)), ""
        except InputError:  # what the new numbers ask of the pose nothing can give; told there
            return edited, ""
