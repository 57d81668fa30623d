"""The Solutions tab: every assembly mode for the present actuators, and where this one ends."""

from __future__ import annotations

from functools import partial
from typing import Any

from app.features.move.state import Drive, Visit
from app.features.solutions import html
from app.features.solutions.compute import Ahead
from app.features.solutions.part import Solutions, SolutionsPart
from app.features.solutions.state import SAME_MODE, Atlas, SetAtlas, Sort
from app.review.state import Review
from app.review.view import Moment
from app.widgets.boxes import ModesMenu
from app.widgets.desk import Client, Panel, Sheet, explain
from app.widgets.header import Elsewhere
from app.widgets.markup import Markup
from app.widgets.texts import box, esc, quiet

SORTED: dict[str, Sort] = {
    "Distance from here": "distance",
    "Conditioning": "condition",
    "Height": "height",
    "Mode": "mode",
}
NO_FOLD = "none"
PAGE = 40  # rows at first and with every "more"

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

    TITLE = "Solutions"

    def build(self, review: Review) -> None:
        gui, desk, machine = self.gui, self.desk, review.machine
        self._part = desk.part(SolutionsPart)
        known = machine.modes
        self._signs = any(known)
        self._elsewhere = Elsewhere(gui)
        self._count = gui.add_html("")
        self._list = Markup(desk, self._pressed)
        self._empty = gui.add_html("", visible=False)
        self._limit = PAGE
        self._more = self.button("Show more", self._show_more)
        hint = "Forget this set and find every solution from scratch"
        self.asks("Find all anew", self._part.find_again, hint=hint)
        self._remarks = gui.add_html("")
        with self.folder("Order and filter", open=False):
            self.switch("Within strokes", Atlas, "within_stroke")
            self.menu("Sort by", SORTED, Atlas, "sort")
            modes, own = {"All modes": "", "The present mode": SAME_MODE}, ("A pattern", "Pattern")
            change = partial(SetAtlas, "modes")
            self._modes = ModesMenu(self, modes, own, change, visible=self._signs)
        with self.folder("Ghosts in the scene", "the platform in other solutions"):
            hint = "The platform in every other solution of the list; click one to go there (G)"
            command = "Ghosts", "Show or hide the platform in all other solutions", "G"
            self.switch("Ghosts", Atlas, "ghosts", hint, command)
        self._ahead = self.folder("Fold ahead", open=False)
        with self._ahead:
            self._strokes = gui.add_html("")
            self._which = gui.add_dropdown("Fold", (NO_FOLD,), visible=False)
            self.answer(self._which, self._choose_fold)
            self._words = gui.add_html("")
            self._drive = self.button("Drive to the fold", self._go_to_fold)
            self._partner = self.button("Go to the solution it merges with", self._go_to_partner)
        self._fold: Ahead | None = None
        self._folds: dict[str, Ahead] = {}
        self._table = ""
        self._drawn: object = None
        explain(gui, HELP, machine.text("solutions"))

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self._modes.draw(self.review[Atlas].modes)

    def told(self, sheet: Sheet, news: Any) -> None:
        match news:
            case Moment(away=away):
                self._elsewhere.draw(away)
            case Solutions():
                self._draw_solutions(sheet, news)

    def _draw_solutions(self, sheet: Sheet, solutions: Solutions) -> None:
        atlas = solutions.atlas
        self.say(self._count, html.count_html(atlas, solutions.trouble))
        self.say(self._remarks, html.remarks_html(atlas))
        self.say(self._empty, html.empty_html(atlas))
        self.set(self._empty, visible=not atlas.rows and bool(atlas.hidden))
        # What belongs to other actuators stays as it is and fades: the page says so at once.
        drawn = (solutions.known, sheet.view.review[Atlas], self._limit)
        if atlas.stale and drawn == self._drawn:
            self._list.say(self._table, stale=True)
        else:
            self._drawn = drawn
            wanted, axes = sheet.view.review[Atlas], self.review.machine.coordinates
            self._table = html.filter_html(atlas, wanted.only, signs=self._signs)
            self._table += html.table_html(atlas, self._limit, axes, wanted.sort, signs=self._signs)
            if atlas.rows:
                shown = f"1–{min(self._limit, len(atlas.rows))} of {len(atlas.rows)}"
                self._table += quiet(f"{shown} · mm, ° · Δ: way of the farthest point")
            self._list.say(self._table if atlas.count else "", stale=atlas.stale)
        left = len(atlas.rows) - self._limit
        self.set(self._more, visible=left > 0, label=f"Show {min(PAGE, left)} of {left} more")
        self._draw_folds(sheet, solutions)

    def _draw_folds(self, sheet: Sheet, solutions: Solutions) -> None:
        review, posture = sheet.view.review, sheet.view.posture
        fold = self._fold = solutions.fold
        self._folds = {html.title(review, a): a for a in solutions.ahead if a.fold is not None}
        known = bool(solutions.ahead)
        self._ahead.note("" if fold is None else html.title(review, fold))
        merges = fold is not None and fold.fold is not None and fold.fold.partner is not None
        self.see(known, self._strokes)
        self.see(fold is not None, self._which, self._drive)
        self.see(merges, self._partner)
        if not known:
            self.say(self._words, quiet(solutions.fold_trouble or "Known when the hand rests."))
            return
        goals = {(a.index, a.longer): a.goal for a in self._folds.values()}
        joints = zip(review.machine.joints, posture.joints, strict=True)
        spans = [
            (axis, value, goals.get((n, False)), goals.get((n, True)))
            for n, (axis, value) in enumerate(joints)
        ]
        self.say(self._strokes, box(html.strokes_html(spans)))
        self.offer(self._which, self._folds, NO_FOLD)
        if fold is None:
            text = "No actuator, driven alone, meets a fold before the end of its stroke."
            self.say(self._words, quiet(text))
            return
        self.put(self._which, html.title(review, fold))
        self.say(self._words, box(esc(html.words(review, fold, solutions.known))))

    # --- what a person asks for

    def _pressed(self, text: str, client: Client) -> None:
        what, _, which = text.partition(" ")
        match what:
            case "go":
                self.desk.ask(self._part.visit, int(which), client)
            case "sort":
                self.desk.send(SetAtlas("sort", which), client)
            case "only":
                self.desk.send(SetAtlas("only", which), client)

    def _show_more(self, _: Client) -> None:
        self._limit += PAGE
        self.desk.ask(self._part.redraw)

    def _choose_fold(self, name: str, _: Client) -> None:
        if name in self._folds:
            fold = self._folds[name]
            self.desk.ask(self._part.choose_fold, fold.index, fold.longer)

    def _go_to_fold(self, client: Client) -> None:
        if self._fold is not None:
            self.desk.send(Drive(self._fold.index, self._fold.goal), client)

    def _go_to_partner(self, client: Client) -> None:
        fold = None if self._fold is None else self._fold.fold
        if fold is not None and fold.partner is not None:
            self.desk.send(Visit(fold.partner.pose, fold.partner.mode), client)
