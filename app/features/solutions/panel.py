"""The Solutions tab: every assembly mode for the present actuators, and where this one ends."""

from __future__ import annotations

from functools import partial
from typing import Any

from app.features.move.state import Drive, Visit
from app.features.solutions import html
from app.features.solutions.compute import Ahead, Listed, Row
from app.features.solutions.part import Solutions, SolutionsPart
from app.features.solutions.state import SAME_MODE, Atlas, SetAtlas, Sort
from app.review.state import Review
from app.review.view import Moment
from app.widgets.boxes import ModesMenu
from app.widgets.desk import Client, Panel, Sheet, explain
from app.widgets.header import Elsewhere
from app.widgets.texts import box, esc, quiet

SORTED: dict[str, Sort] = {
    "Distance from here": "distance",
    "Conditioning": "condition",
    "Height": "height",
    "Mode": "mode",
}
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

    TITLE = "Solutions"

    def build(self, review: Review) -> None:
        gui, desk, machine = self.gui, self.desk, review.machine
        self._part = desk.part(SolutionsPart)
        known = machine.modes
        self._elsewhere = Elsewhere(gui)
        self._style = gui.add_html(html.style(stale=False))
        self._count = gui.add_html("")
        hint = "The platform in every other solution of the list; click one to go there (hotkey G)"
        command = "Ghosts", "Show or hide the platform in all other solutions", "G"
        self.switch("Ghosts", Atlas, "ghosts", hint, command)
        self.switch("Within strokes", Atlas, "within_stroke")
        self.menu("Sort by", SORTED, Atlas, "sort")
        modes, own = {"All modes": "", "The present mode": SAME_MODE}, ("A pattern", "Pattern")
        change = partial(SetAtlas, "modes")
        self._modes = ModesMenu(self, modes, own, change, visible=any(known))
        self._remarks = gui.add_html("")
        self._folder = gui.add_folder("List")
        self._buttons: list[Any] = []
        self._rows: tuple[Row, ...] = ()
        self._drawn: object = None
        self._empty = gui.add_html("", visible=False)
        self._limit = PAGE
        self._more = self.button("Show more", self._show_more)
        self.asks(
            "Find all anew",
            self._part.find_again,
            hint="Forget this set and find every solution from scratch",
        )
        with gui.add_folder("Fold ahead"):
            self._strokes = gui.add_html("")
            self._which = gui.add_dropdown("Fold", (NO_FOLD,), visible=False)
            self.answer(self._which, self._choose_fold)
            self._words = gui.add_html("")
            self._drive = self.button("Drive to the fold", self._go_to_fold)
            self._partner = self.button("Go to the solution it merges with", self._go_to_partner)
        self._fold: Ahead | None = None
        self._folds: dict[str, Ahead] = {}
        limbs = len(known[0].signs)
        gui.add_html(quiet(html.key_text(machine.coordinates, limbs)))
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
        self.say(self._style, html.style(stale=atlas.stale))
        # What belongs to other actuators stays as it is and fades: that is one message, not many.
        drawn = (solutions.known, sheet.view.review[Atlas], self._limit)
        if not (atlas.stale and drawn == self._drawn):
            self._draw_rows(atlas)
            self._drawn = drawn
        self._draw_folds(sheet, solutions)

    def _draw_rows(self, atlas: Listed) -> None:
        rows = self._rows = atlas.rows[: self._limit]
        while len(self._buttons) < len(rows):
            with self._folder:
                made = self.gui.add_button("", visible=False)
            self.clicked(made, partial(self._visit, len(self._buttons)))
            self._buttons.append(made)
        axes = self.review.machine.coordinates
        for n, made in enumerate(self._buttons):
            if n < len(rows):
                self.set(made, _icon_html=html.row_html(rows[n], axes))
            self.set(made, visible=n < len(rows))
        self.see(bool(rows), self._folder)
        left = len(atlas.rows) - len(rows)
        self.set(self._more, visible=left > 0, label=f"Show {min(PAGE, left)} of {left} more")

    def _draw_folds(self, sheet: Sheet, solutions: Solutions) -> None:
        review, posture = sheet.view.review, sheet.view.posture
        fold = self._fold = solutions.fold
        self._folds = {html.title(review, a): a for a in solutions.ahead if a.fold is not None}
        known = bool(solutions.ahead)
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

    def _visit(self, slot: int, client: Client) -> None:
        if slot < len(self._rows) and not self._rows[slot].here:
            self.desk.ask(self._part.visit, self._rows[slot].identity, client)

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
