"""What a person can do to a review: plain values that know what becomes of it.

Each feature has its own, in its file `state`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any

from app.language import tr
from app.review.state import Options, Review, Slice
from app.review.units import number, page_unit

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

    def title(self, before: Review, after: Review) -> str:
        """What it did, in a few words: "φ 0 → 20 °"."""
        return difference(before, after)

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

    def title(self, before: Review, after: Review) -> str:
        return tr("changes.session", name=after.design.name)

    def apply(self, review: Review) -> Taken:
        return self.review, ""


def difference(before: Review, after: Review) -> str:
    """What is other in a review than in another one, in a few words."""
    words: list[str] = []
    if before.design != after.design:
        words = [
            f"{old.group}: {_change(old.label, number(old.value), number(new.value), old.unit)}"
            for old, new in zip(before.machine.fields, after.machine.fields, strict=False)
            if old.value != new.value
        ]
        edited = before.design.mechanism == after.design.mechanism and len(words) in (1, 2, 3)
        if not edited:
            return tr("changes.design", old=before.design.name, new=after.design.name)
    if before.mode != after.mode:
        words.append(_change(tr("modes.mode"), before.mode, after.mode).replace("-", "−"))
    for c, *values in zip(after.machine.coordinates, before.pose, after.pose, strict=True):
        old, new = (number(round(c.outer(v), 1)) for v in values)
        if old != new:
            words.append(_change(c.symbol, old, new, page_unit(c)))
    for piece in before.slices:
        other = after[type(piece)]
        words += [
            _told(piece.filed_as, f.name, getattr(piece, f.name), getattr(other, f.name))
            for f in fields(piece)
            if getattr(piece, f.name) != getattr(other, f.name)
        ]
    return (
        ", ".join(words[:2]) + (", …" if len(words) > 2 else "") if words else tr("changes.little")
    )


def _told(slice_: str, name: str, old: object, new: object) -> str:
    words = f"{slice_} {name.replace('_', ' ')}"
    if isinstance(new, bool):
        words = slice_ if name == "on" else words
        return tr("changes.on" if new else "changes.off", what=words)
    if isinstance(old, float) and isinstance(new, float):
        return _change(words, number(old), number(new))
    if isinstance(old, str) and isinstance(new, str):
        none = tr("page.none")
        return _change(words, old or none, new or none)
    return words


def _change(what: str, old: str, new: str, unit: str = "") -> str:
    return f"{what} {old} → {new} {unit}".rstrip()
