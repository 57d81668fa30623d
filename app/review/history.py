"""A review with its past and its undone future.

What is reviewed and how it is shown are taken back apart from each other: undoing a step of one
kind leaves the later ones of the other kind.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from app.review.changes import Change, change
from app.review.state import Review

QUIET_GAP = 1.0  # s; a gesture that pauses longer than this becomes a step of its own in undo
MAX_HISTORY = 300


@dataclass(frozen=True, slots=True)
class Step:
    """A change that was taken.

    Attributes:
        review: the one before it; of a step that was undone the one after it.
        looks: it changed nothing but how the review is shown.
    """

    review: Review
    change: Change
    looks: bool

    def put_into(self, review: Review) -> Review:
        """A review with what this step changed as it is in the step's own."""
        return review.shown_as(self.review) if self.looks else self.review.shown_as(review)


@dataclass(frozen=True, slots=True)
class History:
    """A review with its past and its undone future."""

    present: Review
    past: tuple[Step, ...] = ()
    future: tuple[Step, ...] = ()
    gesture: str = ""
    changed_at: float = -math.inf
    held: int = 0

    def apply(self, what: Change, now: float) -> tuple[History, str]:
        """The history after a change; the steps of one drag become one step of undo."""
        present, note = change(self.present, what)
        if present == self.present:
            return self, note
        looks = self.present.shown_as(present) == present
        joined = (
            bool(what.gesture)
            and what.gesture == self.gesture
            and (now - self.changed_at < QUIET_GAP or 0 != what.held == self.held)
            and bool(self.past)
            and not self.future
        )
        step = Step(self.past[-1].review if joined else self.present, what, looks)
        past = (*(self.past[:-1] if joined else self.past), step)[-MAX_HISTORY:]
        future = tuple(s for s in self.future if s.looks != looks)
        return History(present, past, future, what.gesture, now, what.held), note

    def undo(self, looks: bool | None = None) -> History:
        """The history without its newest step: of what is shown, of what is reviewed, or any."""
        n = next((n for n in reversed(range(len(self.past))) if _is(self.past[n], looks)), None)
        if n is None:
            return self
        step, later = self.past[n], self.past[n + 1 :]
        past = (*self.past[:n], *(replace(s, review=step.put_into(s.review)) for s in later))
        present = step.put_into(self.present) if later else step.review
        undone = replace(step, review=self.present)
        return History(present, past, (undone, *self.future))

    def redo(self, looks: bool | None = None) -> History:
        """The history with the step that was undone last; of a kind, as for `undo`."""
        n = next((n for n, step in enumerate(self.future) if _is(step, looks)), None)
        if n is None:
            return self
        step = self.future[n]
        past = (*self.past, replace(step, review=self.present))
        return History(step.put_into(self.present), past, (*self.future[:n], *self.future[n + 1 :]))

    def undone(self, looks: bool) -> str:
        """What the step of a kind did that would be done again; "" for none."""
        step = next((s for s in self.future if s.looks == looks), None)
        return "" if step is None else step.change.title(self.present, step.put_into(self.present))

    def titles(self, looks: bool, most: int) -> list[str]:
        """What the newest steps of a kind did, the newest first."""
        after = [*(step.review for step in self.past[1:]), self.present]
        steps = zip(reversed(self.past), reversed(after), strict=False)
        found = [(step, then) for step, then in steps if _is(step, looks)][:most]
        return [step.change.title(step.review, then) for step, then in found]


def _is(step: Step, looks: bool | None) -> bool:
    return looks is None or step.looks == looks
