"""A review with its past and its undone future."""

from __future__ import annotations

import math
from dataclasses import dataclass

from app.review.changes import Change, change
from app.review.state import Review

QUIET_GAP = 1.0  # s; a gesture that pauses longer than this becomes a step of its own in undo
MAX_HISTORY = 300


@dataclass(frozen=True, slots=True)
class History:
    """A review with its past and its undone future."""

    present: Review
    past: tuple[Review, ...] = ()
    future: tuple[Review, ...] = ()
    gesture: str = ""
    changed_at: float = -math.inf
    held: int = 0

    def apply(self, what: Change, now: float) -> tuple[History, str]:
        """The history after a change; the steps of one drag become one step of undo."""
        present, note = change(self.present, what)
        if present == self.present:
            return self, note
        joined = (
            bool(what.gesture)
            and what.gesture == self.gesture
            and (now - self.changed_at < QUIET_GAP or 0 != what.held == self.held)
            and not self.future
        )
        past = self.past if joined else (*self.past, self.present)[-MAX_HISTORY:]
        return History(present, past, (), what.gesture, now, what.held), note

    def undo(self) -> History:
        if not self.past:
            return self
        return History(self.past[-1], self.past[:-1], (self.present, *self.future))

    def redo(self) -> History:
        if not self.future:
            return self
        return History(self.future[0], (*self.past, self.present), self.future[1:])
