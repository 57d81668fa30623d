"""How the solutions for the present actuators are shown."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Literal, Self, get_args

from app.language import tr
from app.review import content as session
from app.review.changes import SetOne
from app.review.state import Review, Slice
from kinematics.answers.modes import matching

Sort = Literal["distance", "condition", "height", "mode"]
_SAME_MODE = "same"  # what sessions of before had for ``only`` = "mode"
Only = Literal["", "mode", "new", "merging"]


@dataclass(frozen=True)
class Atlas(Slice):
    """How the solutions are shown.

    ``modes`` filters the list: "" for all, else patterns that `kinematics.answers.modes.matching`
    understands. ``only`` leaves of those the ones of the present working mode, those that appeared
    on the way, or those next to another one.
    """

    filed_as: ClassVar[str] = "solutions"
    LOOKS: ClassVar[frozenset[str]] = frozenset(
        ("ghosts", "sort", "within_stroke", "modes", "only")
    )
    ghosts: bool = False
    sort: Sort = "distance"
    within_stroke: bool = False
    modes: str = ""
    only: Only = ""

    @classmethod
    def gesture(cls, name: str, value: Any) -> str:
        return f"atlas {name}" if isinstance(value, str) else ""

    def checked(self, review: Review) -> Self:
        session.listed(self.sort, get_args(Sort), tr("solutions.sorted_by"))
        session.listed(self.only, get_args(Only), tr("solutions.shown_are"))
        if self.modes == _SAME_MODE:
            return replace(self, modes="", only="mode")
        if self.modes:
            matching(self.modes, review.machine.modes)
        return self


SetAtlas = partial(SetOne, Atlas)
"""Set one thing about how solutions are shown."""
