"""The marks of a review, and what people do with them."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Literal, Self

from app.features.marks.entries import (
    dimension_entry,
    dimension_of,
    note_entry,
    note_of,
    view_entry,
    view_of,
)
from app.features.marks.model import (
    FILED,
    NEVER,
    Dimension,
    Mark,
    Note,
    SavedView,
    measure_of,
    named,
)
from app.language import tr
from app.review.changes import Change, SetOne, Taken
from app.review.state import Review, Slice
from kinematics.errors import InputError

MOST = 50
"""Marks of each kind in a review."""
List = Literal["views", "notes", "dimensions"]
"""Which marks, by the name of the field that holds them."""
LISTS: tuple[List, ...] = ("views", "notes", "dimensions")


@dataclass(frozen=True)
class Marks(Slice):
    """All of them, each kind in the order in which people see it; ``shown`` in the scene."""

    filed_as: ClassVar[str] = FILED
    LOOKS: ClassVar[frozenset[str]] = frozenset(("shown",))
    views: tuple[SavedView, ...] = ()
    notes: tuple[Note, ...] = ()
    dimensions: tuple[Dimension, ...] = ()
    shown: bool = True

    def of(self, kind: List) -> tuple[Mark, ...]:
        """Those of a kind."""
        found: tuple[Mark, ...] = getattr(self, kind)
        return found

    def checked(self, review: Review) -> Self:
        count = len(review.machine.coordinates)
        for kind in LISTS:
            if len(getattr(self, kind)) > MOST:
                raise InputError(tr(f"marks.too_many.{kind}", n=MOST))
        entries: tuple[SavedView | Note, ...] = (*self.views, *self.notes)
        for entry in entries:
            if entry.pose and (
                len(entry.pose) != count
                or entry.mode not in review.machine.modes
                or not all(map(math.isfinite, entry.pose))
            ):
                raise InputError(tr("marks.other_pose", name=entry.text))
        for dimension in self.dimensions:
            measure_of(dimension.anchors)
        return self

    def carried(self, before: Review, review: Review) -> Self:
        """All of them for a machine that is built alike; else where people looked from."""
        if _built(before) == _built(review):
            return super().carried(before, review)
        views = tuple(SavedView(view.text, view.camera) for view in self.views)
        return type(self)(views, shown=self.shown)

    # --- in a session file

    def write(self, name: str, review: Review) -> Any:
        match name:
            case "views":
                return [view_entry(view, review) for view in self.views]
            case "notes":
                return [note_entry(note, review) for note in self.notes]
            case "dimensions":
                return [dimension_entry(dimension) for dimension in self.dimensions]
        return super().write(name, review)

    @classmethod
    def taken(cls, name: str, value: Any, review: Review, what: str) -> Any:
        if name not in LISTS:
            return super().taken(name, value, review, what)
        if not isinstance(value, list) or not all(isinstance(each, dict) for each in value):
            raise InputError(tr("session.wrong_kind", what=what))
        read = {"views": view_of, "notes": note_of, "dimensions": dimension_of}[name]
        return tuple(read(each, review, f"{what} {n}") for n, each in enumerate(value, start=1))


SetMarks = partial(SetOne, Marks)
"""Show marks in the scene or not."""


def _built(review: Review) -> object:
    """What machines have in common that can have each other's marks."""
    machine = review.machine
    return (
        review.design.mechanism,
        len(machine.joints),
        tuple(c.key for c in machine.coordinates),
        tuple(spec.key for spec in machine.solid_specs),
        machine.modes,
    )


# --- changes


@dataclass(frozen=True)
class AddMark(Change):
    """Add a mark; a view that is called as another one takes its place."""

    kind: List
    mark: Mark

    def title(self, before: Review, after: Review) -> str:
        return tr(f"marks.added.{self.kind}", name=_short(self.mark))

    def apply(self, review: Review) -> Taken:
        mark = named(self.mark, self.mark.text)
        known = review[Marks].of(self.kind)
        if self.kind == "views" and mark.text in (texts := [each.text for each in known]):
            n = texts.index(mark.text)
            return _with(review, self.kind, (*known[:n], mark, *known[n + 1 :]))
        return _with(review, self.kind, (*known, mark))


@dataclass(frozen=True)
class DropMark(Change):
    """Remove a mark, by its number from 0."""

    kind: List
    number: int

    def title(self, before: Review, after: Review) -> str:
        mark = before[Marks].of(self.kind)[self.number]
        return tr(f"marks.dropped.{self.kind}", name=_short(mark))

    def apply(self, review: Review) -> Taken:
        known = review[Marks].of(self.kind)
        _nth(known, self.number)
        return _with(review, self.kind, (*known[: self.number], *known[self.number + 1 :]))


@dataclass(frozen=True)
class NameMark(Change):
    """Give a mark another name, or a note another text."""

    kind: List
    number: int
    text: str

    def title(self, before: Review, after: Review) -> str:
        return tr("marks.renamed", name=_short(after[Marks].of(self.kind)[self.number]))

    def apply(self, review: Review) -> Taken:
        known = review[Marks].of(self.kind)
        mark = named(_nth(known, self.number), self.text)
        others = (*known[: self.number], *known[self.number + 1 :])
        if self.kind == "views" and any(each.text == mark.text for each in others):
            raise InputError(tr("marks.name_taken", name=mark.text))
        return _with(review, self.kind, (*known[: self.number], mark, *known[self.number + 1 :]))


@dataclass(frozen=True)
class Recall(Change):
    """Show the review as a saved view has it, and the machine there, if it is of a pose."""

    view: SavedView

    def title(self, before: Review, after: Review) -> str:
        return tr("marks.recalled", name=self.view.text)

    def apply(self, review: Review) -> Taken:
        view, pieces = self.view, []
        if view not in review[Marks].views:
            raise InputError(tr("marks.gone"))
        for look in view.looks:
            kept = {name: getattr(look, name) for name in look.LOOKS - NEVER}
            with suppress(InputError):  # of a design that has been edited since
                pieces.append(replace(review[type(look)], **kept).checked(review))
        shown = review.having(*pieces)
        if view.pose:
            shown = replace(shown, pose=view.pose, mode=view.mode)
        return shown, ""


def _with(review: Review, kind: List, marks: tuple[Mark, ...]) -> Taken:
    kept: dict[str, Any] = {kind: marks}
    wanted = replace(review[Marks], **kept)
    return review.having(wanted.checked(review)), ""


def _nth(marks: tuple[Mark, ...], number: int) -> Mark:
    if not 0 <= number < len(marks):
        raise InputError(tr("marks.gone"))
    return marks[number]


def _short(mark: Mark) -> str:
    text = mark.text or " – ".join(a.short for a in getattr(mark, "anchors", ()))
    return text if len(text) <= 30 else f"{text[:29]}…"
