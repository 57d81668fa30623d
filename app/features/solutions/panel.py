"""The Solutions tab: every assembly mode for the present actuators, and where this one ends."""

from __future__ import annotations

import re
from functools import partial
from typing import Any

import viser

from app.features.move.state import Drive, Visit
from app.features.solutions.atlas import Listed, Row
from app.features.solutions.folds import Ahead, title, words
from app.features.solutions.state import SAME_MODE, Atlas, SetAtlas, Sort
from app.review.modes import matching, page_mode
from app.review.requests import ChooseFold, FindAgain, RedrawSolutions, VisitSolution
from app.scene import palette
from app.widgets.desk import (
    Desk,
    Elsewhere,
    Moment,
    Panel,
    Sheet,
    Solutions,
    answer,
    box,
    button,
    clicked,
    esc,
    explain,
    put,
    put_prop,
    red,
    tone,
)
from app.widgets.glyphs import key_html, row_html, strokes_html, style

SORTED: dict[Sort, str] = {
    "distance": "Distance from here",
    "condition": "Conditioning",
    "height": "Height",
    "mode": "Mode",
}
EVERY, SAME, PATTERN = "All modes", "The present mode", "A pattern"
NO_FOLD = "none"
PAGE = 20  # rows at first and with every "more": each costs the browser some time

HELP = """
The **forward kinematics**: all poses at which the machine can be assembled with its present
actuator lengths. Each is an **assembly mode**; a click puts the machine there. The list counts the
real solutions against the complex ones, and says how it is known that none is missing: their number
is that of almost every machine of this family, and with each complex solution its conjugate is
there too.

The **distance** of a solution is how far the platform's farthest point would go. A large
**condition** number means that a singularity is near. As an actuator moves, solutions appear and
merge in pairs, always at a parallel singularity: a **fold**. *Fold ahead* shows for each actuator,
driven alone, how far it can go either way until this assembly mode ends.
"""


class SolutionsPanel(Panel):
    """The list, its filters, the ghosts' switch, the folds ahead."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        machine = review.machine
        self._desk = desk
        self._axes = machine.coordinates
        self._known = machine.modes
        self._mode = review.mode
        self._elsewhere = Elsewhere(gui)
        self._style = gui.add_html(style(stale=False))
        self._count = gui.add_html("")
        self._ghosts = gui.add_checkbox(
            "Ghosts",
            review[Atlas].ghosts,
            hint="The platform in every other solution of the list; click one to go there "
            "(hotkey G)",
        )
        answer(desk, self._ghosts, lambda on, client: desk.send(SetAtlas("ghosts", on), client))
        self._mixed = gui.add_checkbox(
            "Mixed modes",
            review[Atlas].mixed,
            hint="Solutions in which the two limbs of an arrangement stand in different working "
            "modes, by the general method",
        )
        answer(desk, self._mixed, lambda on, client: desk.send(SetAtlas("mixed", on), client))
        self._within = gui.add_checkbox("Within strokes", review[Atlas].within_stroke)
        answer(
            desk, self._within, lambda on, client: desk.send(SetAtlas("within_stroke", on), client)
        )
        self._sort = gui.add_dropdown(
            "Sort by", tuple(SORTED.values()), initial_value=SORTED[review[Atlas].sort]
        )
        answer(desk, self._sort, self._sorted_by)
        has_modes = any(self._known)
        self._choice = gui.add_dropdown(
            "Of",
            (EVERY, SAME, PATTERN),
            initial_value=_choice(review[Atlas].modes),
            visible=has_modes,
        )
        answer(desk, self._choice, self._choose)
        self._pattern = gui.add_text(
            "Pattern",
            _pattern(review[Atlas].modes, review.mode),
            hint="One sign a limb, ? for either; several separated by commas: +?+++, −−+++",
            visible=False,
        )
        answer(desk, self._pattern, self._choose_pattern)
        self._remarks = gui.add_html("")
        self._folder = gui.add_folder("List")
        self._buttons: list[viser.GuiButtonHandle] = []
        self._rows: tuple[Row, ...] = ()
        self._drawn: object = None
        self._empty = gui.add_html("", visible=False)
        self._limit = PAGE
        self._more = button(desk, "Show more", self._show_more)
        self._again = button(
            desk,
            "Find all anew",
            lambda _: desk.ask(FindAgain()),
            hint="Forget this set and find every solution from scratch",
        )
        with gui.add_folder("Fold ahead"):
            self._strokes = gui.add_html("")
            self._which = gui.add_dropdown("Fold", (NO_FOLD,), visible=False)
            answer(desk, self._which, self._choose_fold)
            self._words = gui.add_html("")
            self._drive = button(desk, "Drive to the fold", self._go_to_fold)
            self._partner = button(desk, "Go to the solution it merges with", self._go_to_partner)
        self._fold: Ahead | None = None
        self._folds: dict[str, Ahead] = {}
        limbs = len(self._known[0].signs)
        gui.add_html(box(f'<div style="opacity:0.75">{key_html(self._axes, limbs)}</div>'))
        explain(gui, HELP, machine.text("solutions"))

    def draw_moment(self, sheet: Sheet, moment: Moment) -> None:
        self._elsewhere.draw(moment)

    def draw(self, sheet: Sheet) -> None:
        review = sheet.view.review
        wanted = review[Atlas]
        self._axes = review.machine.coordinates
        self._mode = review.mode
        put(self._desk, self._ghosts, wanted.ghosts)
        put(self._desk, self._mixed, wanted.mixed)
        put(self._desk, self._within, wanted.within_stroke)
        put(self._desk, self._sort, SORTED[wanted.sort])
        choice = _choice(wanted.modes)
        put(self._desk, self._choice, choice)
        put_prop(self._pattern, "visible", self._choice.value == PATTERN)
        if choice == PATTERN:
            put(self._desk, self._pattern, _pattern(wanted.modes, review.mode))

    def draw_solutions(self, sheet: Sheet, solutions: Solutions) -> None:
        atlas = solutions.atlas
        put_prop(self._mixed, "visible", atlas.offers_mixed)
        put_prop(self._count, "content", _count(atlas, solutions.trouble))
        put_prop(self._remarks, "content", _remarks(atlas))
        put_prop(self._empty, "content", _empty(atlas))
        put_prop(self._empty, "visible", not atlas.rows and bool(atlas.hidden))
        put_prop(self._style, "content", style(stale=atlas.stale))
        # What belongs to other actuators stays as it is and fades: that is one message, not many.
        drawn = (solutions.known, sheet.view.review[Atlas], self._limit)
        if not (atlas.stale and drawn == self._drawn):
            self._draw_rows(atlas)
            self._drawn = drawn
        self._draw_folds(sheet, solutions)

    def _draw_rows(self, atlas: Listed) -> None:
        rows = atlas.rows[: self._limit]
        while len(self._buttons) < len(rows):
            with self._folder:
                made = self._desk.gui.add_button("", visible=False)
            clicked(self._desk, made, partial(self._visit, len(self._buttons)))
            self._buttons.append(made)
        self._rows = rows
        for row, made in zip(rows, self._buttons, strict=False):
            put_prop(made, "_icon_html", row_html(row, self._axes))
            put_prop(made, "visible", True)
        for made in self._buttons[len(rows) :]:
            put_prop(made, "visible", False)
        put_prop(self._folder, "visible", bool(rows))
        left = len(atlas.rows) - len(rows)
        put_prop(self._more, "visible", left > 0)
        put_prop(self._more, "label", f"Show {min(PAGE, left)} of {left} more")

    def _draw_folds(self, sheet: Sheet, solutions: Solutions) -> None:
        review, posture = sheet.view.review, sheet.view.posture
        self._fold = solutions.fold
        self._folds = {title(review, a): a for a in solutions.ahead if a.fold is not None}
        if not solutions.ahead:
            for part in (self._strokes, self._which, self._drive, self._partner):
                put_prop(part, "visible", False)
            text = solutions.fold_trouble or "Known when the hand rests."
            put_prop(self._words, "content", _quiet(text))
            return
        put_prop(self._strokes, "visible", True)
        goals: dict[tuple[int, bool], float] = {
            (a.index, a.longer): a.goal for a in solutions.ahead if a.fold is not None
        }
        spans = [
            (axis, value, goals.get((n, False)), goals.get((n, True)))
            for n, (axis, value) in enumerate(
                zip(review.machine.joints, posture.joints, strict=True)
            )
        ]
        put_prop(
            self._strokes,
            "content",
            box(
                '<table style="width:100%;table-layout:fixed;border-spacing:0 3px">'
                f"{strokes_html(spans)}</table>"
            ),
        )
        names = tuple(self._folds) or (NO_FOLD,)
        if tuple(self._which.options) != names:
            self._which.options = names
        fold = self._fold
        put_prop(self._which, "visible", fold is not None)
        put_prop(self._drive, "visible", fold is not None)
        put_prop(
            self._partner,
            "visible",
            fold is not None and fold.fold is not None and fold.fold.partner is not None,
        )
        if fold is None:
            text = "No actuator, driven alone, meets a fold before the end of its stroke."
            put_prop(self._words, "content", _quiet(text))
            return
        put(self._desk, self._which, title(review, fold))
        put_prop(self._words, "content", box(esc(words(review, fold, solutions.known))))

    # --- what a person asks for

    def _visit(self, slot: int, client: viser.ClientHandle | None) -> None:
        if slot < len(self._rows) and not self._rows[slot].here:
            self._desk.ask(VisitSolution(self._rows[slot].identity, client))

    def _show_more(self, _: viser.ClientHandle | None) -> None:
        self._limit += PAGE
        self._desk.ask(RedrawSolutions())

    def _sorted_by(self, label: str, client: viser.ClientHandle | None) -> None:
        chosen = next(sort for sort, text in SORTED.items() if text == label)
        self._desk.send(SetAtlas("sort", chosen), client)

    def _choose(self, choice: str, client: viser.ClientHandle | None) -> None:
        self._pattern.visible = choice == PATTERN
        if choice == PATTERN:
            self._choose_pattern(self._pattern.value, client)
        else:
            self._desk.send(SetAtlas("modes", SAME_MODE if choice == SAME else ""), client)

    def _choose_pattern(self, text: str, client: viser.ClientHandle | None) -> None:
        if _unfinished(text, len(self._mode)):
            return
        matching(text, self._known)  # raises, and the person reads what is wrong
        self._desk.send(SetAtlas("modes", text), client)

    def _choose_fold(self, name: str, _: Any) -> None:
        if name in self._folds:
            fold = self._folds[name]
            self._desk.ask(ChooseFold(fold.index, fold.longer))

    def _go_to_fold(self, client: viser.ClientHandle | None) -> None:
        if self._fold is not None:
            self._desk.send(Drive(self._fold.index, self._fold.goal), client)

    def _go_to_partner(self, client: viser.ClientHandle | None) -> None:
        fold = None if self._fold is None else self._fold.fold
        if fold is not None and fold.partner is not None:
            self._desk.send(Visit(fold.partner.pose, fold.partner.mode), client)


def _choice(modes: str) -> str:
    return EVERY if not modes else SAME if modes == SAME_MODE else PATTERN


def _unfinished(text: str, limbs: int) -> bool:
    """Whether a person is still typing: nothing but signs so far, and not yet one a limb."""
    words = re.split(r"[,;\s]+", text.strip())
    return set("".join(words)) <= set("+-−–?") and any(len(word) < limbs for word in words)


def _pattern(modes: str, present: str) -> str:
    return page_mode(modes if modes and modes != SAME_MODE else present)


def _quiet(text: str) -> str:
    return box(f'<span style="opacity:0.75">{esc(text)}</span>')


def _count(atlas: Listed, trouble: str) -> str:
    if trouble:
        return red(trouble)
    if not atlas.count:
        return box("<b>Finding all solutions …</b>" if atlas.stale else "<b>No solutions</b>")
    color = tone("good" if atlas.complete else "near")
    late = " <b>for the lengths before</b>" if atlas.stale else ""
    return box(
        f'<div style="border-left:4px solid {color};padding-left:0.6em;'
        f'{"opacity:0.6" if atlas.stale else ""}">'
        f'<span style="font-size:1.15em;font-weight:600">{esc(atlas.count)}</span>{late}<br>'
        f"{esc(atlas.how)}</div>"
    )


def _remarks(atlas: Listed) -> str:
    lines = [
        f'<div style="padding:0.1em 0;{f"color:{palette.BEYOND}" if singular else "opacity:0.85"}">'
        f"{esc(text[:1].upper() + text[1:])}</div>"
        for text, singular in atlas.remarks
    ]
    return box("".join(lines)) if lines else ""


def _empty(atlas: Listed) -> str:
    what = "the one solution" if atlas.hidden == 1 else f"all {atlas.hidden} solutions"
    return _quiet(f"The filter leaves out {what}.")
