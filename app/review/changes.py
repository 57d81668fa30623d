"""What a person can do to a review: plain values that know what becomes of it.

Each feature has its own, in its file `state`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from app.review.state import Options, Review, Slice

Taken = tuple[Review, str]
"""The review after a change, and a sentence about it for the user ("" when all went well)."""


@dataclass(frozen=True)
class Change:
    """Something that a person does.

    Attributes:
        gesture: joins the steps of one drag for undo; "" is a step of its own.
        held: numbers the grips of a hand: one grip is one step, however long it pauses.
    """

    @property
    def gesture(self) -> str:
        return ""

    @property
    def held(self) -> int:
        return 0

    def apply(self, review: Review) -> Taken:
        """The review after it.

        Raises:
            InputError: it cannot be taken; the review stays as it is.
        """
        raise NotImplementedError


def change(review: Review, what: Change) -> Taken:
    """The review after ``what``, and a sentence about it for the user.

    Raises:
        InputError: the change cannot be taken; the review stays as it is.
    """
    return what.apply(review)


@dataclass(frozen=True)
class SetOne(Change):
    """Set one thing of a slice of a kind; the value is of the kind that the slice has there."""

    kind: type[Slice]
    name: str
    value: Any

    @property
    def gesture(self) -> str:
        return self.kind.gesture(self.name, self.value)

    def apply(self, review: Review) -> Taken:
        wanted = replace(review[self.kind], **{self.name: self.value})
        return review.having(wanted.checked(review)), ""


SetOption = partial(SetOne, Options)
"""Switch something that is drawn."""


@dataclass(frozen=True)
class Restore(Change):
    """Open a saved review."""

    review: Review

    def apply(self, review: Review) -> Taken:
        return self.review, ""
