"""The Solutions tab: every assembly mode for the present actuators, and where this one ends."""

from __future__ import annotations

from functools import partial
from typing import Any

from app.features.move.state import Drive, Visit
from app.features.solutions import html
from app.features.solutions.compute import Ahead
from app.features.solutions.part import Solutions, SolutionsPart
from app.features.solutions.state import Atlas, SetAtlas
from app.language import tr
from app.review.state import Review
from app.review.view import Moment
from app.widgets.boxes import ModesMenu
from app.widgets.desk import Client, Panel, Sheet, explain
from app.widgets.header import Elsewhere
from app.widgets.markup import Markup
from app.widgets.texts import box, esc, quiet

PAGE = 40  # rows at first and with every "more"


class SolutionsPanel(Panel):
    """The list, its filters, the ghosts' switch, the folds ahead."""

    TITLE = "solutions.tab"

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
        self._more = self.button("solutions.more", self._show_more)
        self.asks("solutions.anew", self._part.find_again)
        self._remarks = gui.add_html("")
        with self.folder("solutions.order", open=False):
            self.switch("solutions.within", Atlas, "within_stroke")
            modes = {tr("solutions.all"): ""}
            change = partial(SetAtlas, "modes")
            self._modes = ModesMenu(self, modes, "solutions.own", change, visible=self._signs)
        with self.folder("solutions.in_scene"):
            self.switch("solutions.ghosts", Atlas, "ghosts", ("ghosts", "G"))
        self._ahead = self.folder("solutions.ahead", open=False)
        with self._ahead:
            self._strokes = gui.add_html("")
            self._which = gui.add_dropdown(tr("solutions.fold"), (tr("page.none"),), visible=False)
            self.answer(self._which, self._choose_fold)
            self._words = gui.add_html("")
            self._drive = self.button("solutions.to_fold", self._go_to_fold)
            self._partner = self.button("solutions.to_partner", self._go_to_partner)
        self._fold: Ahead | None = None
        self._folds: dict[str, Ahead] = {}
        self._table = ""
        self._drawn: object = None
        explain(gui, "solutions", machine)

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
                shown, of = min(self._limit, len(atlas.rows)), len(atlas.rows)
                self._table += quiet(tr("solutions.shown", shown=shown, of=of))
            self._list.say(self._table if atlas.count else "", stale=atlas.stale)
        left = len(atlas.rows) - self._limit
        label = tr("solutions.show_more", shown=min(PAGE, left), of=left)
        self.set(self._more, visible=left > 0, label=label)
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
            self.say(self._words, quiet(solutions.fold_trouble or tr("solutions.at_rest")))
            return
        goals = {(a.index, a.longer): a.goal for a in self._folds.values()}
        joints = zip(review.machine.joints, posture.joints, strict=True)
        spans = [
            (axis, value, goals.get((n, False)), goals.get((n, True)))
            for n, (axis, value) in enumerate(joints)
        ]
        self.say(self._strokes, box(html.strokes_html(spans)))
        self.offer(self._which, self._folds, tr("page.none"))
        if fold is None:
            self.say(self._words, quiet(tr("solutions.no_fold")))
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
