"""How the solutions for the present actuators are shown."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Literal, Self

from app.review.changes import SetOne
from app.review.modes import matching
from app.review.state import Review, Slice
from kinematics.errors import InputError

Sort = Literal["distance", "condition", "height", "mode"]
SORTS: tuple[Sort, ...] = ("distance", "condition", "height", "mode")
SAME_MODE = "same"


@dataclass(frozen=True)
class Atlas(Slice):
    """How the solutions are shown.

    ``modes`` filters the list: "" for all, `SAME_MODE` for the present working mode, else patterns
    that `app.review.modes.matching` understands.
    """

    filed_as: ClassVar[str] = "solutions"
    ghosts: bool = False
    sort: Sort = "distance"
    within_stroke: bool = False
    modes: str = ""

    def checked(self, review: Review) -> Self:
        if self.sort not in SORTS:
            raise InputError(f"solutions are sorted by {', '.join(SORTS)}, not by {self.sort!r}")
        if self.modes not in ("", SAME_MODE):
            matching(self.modes, review.machine.modes)
        return self

    def carried(self, before: Review, review: Review) -> Self:
        try:
            return self.checked(review)
        except InputError:  # a filter in another mechanism's working modes
            return replace(self, modes="")


SLICES = (Atlas,)


@dataclass(frozen=True)
class SetAtlas(SetOne):
    """Set one thing about how solutions are shown."""

    kind = Atlas

    @property
    def gesture(self) -> str:
        return f"atlas {self.name}" if isinstance(self.value, str) else ""
