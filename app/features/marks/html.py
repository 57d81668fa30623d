"""Marks as lists: saved views, notes, dimensions with their numbers; and the steps to present."""

from __future__ import annotations

import json
from collections.abc import Sequence

from app.features.marks.compute import Things, measured, thing, words
from app.features.marks.model import Note, SavedView
from app.features.marks.state import Marks
from app.language import tr
from app.review.state import Review
from app.review.units import pose_text
from app.widgets.texts import NUMERIC, box, esc, faint, table

LETTERS = 34  # of a line of a note
_ROWS = ("width:2.2em", "", NUMERIC, "width:1.8em;text-align:right")


def views_html(views: Sequence[SavedView], review: Review) -> str:
    """A row for each saved view: pressing its number shows it."""
    rows = []
    for n, view in enumerate(views):
        of = tr("marks.of_pose") if view.pose else ""
        hint = pose_text(review.machine.coordinates, view.pose) if view.pose else ""
        go = _go("views", n, tr("marks.show_view", name=view.text))
        rows.append(
            (go, _name("views", n, view.text), _aside(of, hint), _drop("views", n, view.text))
        )
    return _list(rows)


def notes_html(notes: Sequence[Note], review: Review, known: Things) -> str:
    """A row for each note: pressing its number goes there."""
    rows = []
    for n, note in enumerate(notes):
        hint = pose_text(review.machine.coordinates, note.pose)
        go = _go("notes", n, tr("marks.go_to_note", n=n + 1))
        place = _aside(place_of(note, known), hint)
        rows.append((go, _text(n, note.text), place, _drop("notes", n, note.text)))
    return _list(rows)


def place_of(note: Note, known: Things) -> str:
    """To what a note is pinned, in a few words."""
    if note.anchor is None:
        return tr("marks.at_pose")
    found = thing(known, note.anchor)
    return note.anchor.short if found is None else found.text


def dimensions_html(marks: Marks, known: Things, size: float) -> str:
    """A row for each dimension with its number."""
    rows = []
    for n, dimension in enumerate(marks.dimensions):
        between, found = words(known, dimension), measured(known, dimension, size)
        value = "–" if found is None else f"<b>{esc(found.text)}</b>"
        note = "" if found is None or not found.note else f"<br>{faint(esc(found.note))}"
        name = _name("dimensions", n, dimension.text, between)
        rows.append((esc(between) + note, name, value, _drop("dimensions", n, between)))
    return _list(rows, ("", "width:34%", NUMERIC, "width:1.8em;text-align:right"))


def steps_html(marks: Marks) -> str:
    """What a presentation steps through, for the script that does it: not to be seen."""
    views = [(tr("marks.step_view"), view.text) for view in marks.views]
    notes = [(tr("marks.step_note", n=n), note.text) for n, note in enumerate(marks.notes, 1)]
    steps = esc(json.dumps([*views, *notes], ensure_ascii=False))
    keys = esc(tr("marks.present_keys"))
    return f'<div class="bo-steps" hidden data-steps="{steps}" data-keys="{keys}"></div>'


def _list(rows: Sequence[Sequence[str]], styles: Sequence[str] = _ROWS) -> str:
    return f'<div class="bo-marks">{table(rows, styles)}</div>' if rows else ""


def asked_html(told: str) -> str:
    """What is to be clicked next, over the scene, with a way to stop."""
    stop = _button("stop", "×", tr("marks.stop"))
    return f'<div class="bo-ask" role="status">{esc(told)} {stop}</div>'


def none_html(text: str) -> str:
    """What stands where there is no mark yet."""
    return box(faint(esc(text)))


def _button(sends: str, text: str, label: str) -> str:
    return (
        f'<button type="button" class="bo-button" data-send="{esc(sends)}" '
        f'aria-label="{esc(label)}" title="{esc(label)}">{esc(text)}</button>'
    )


def _go(kind: str, n: int, label: str) -> str:
    return _button(f"go {kind} {n}", str(n + 1), label)


def _drop(kind: str, n: int, name: str) -> str:
    return _button(f"drop {kind} {n}", "×", tr("marks.remove", name=name))


def _name(kind: str, n: int, text: str, beside: str = "") -> str:
    """A box with a text that can be changed."""
    label = tr(f"marks.name_of.{kind}", n=n + 1)
    return (
        f'<input type="text" data-write="name {kind} {n}" value="{esc(text)}" '
        f'aria-label="{esc(label)}" title="{esc(text or beside)}" '
        f'placeholder="{esc(tr("marks.unnamed")) if kind == "dimensions" else ""}">'
    )


def _text(n: int, text: str) -> str:
    """A box with the whole text of a note."""
    label, high = esc(tr("marks.name_of.notes", n=n + 1)), 1 + len(text) // LETTERS
    return (
        f'<textarea rows="{high}" data-write="name notes {n}" aria-label="{label}">'
        f"{esc(text)}</textarea>"
    )


def _aside(text: str, hint: str) -> str:
    return f'<span title="{esc(hint)}">{faint(esc(text))}</span>'
