"""Compare, a view of the Design tab: two to four designs side by side and over one another."""

from __future__ import annotations

from functools import partial
from typing import Any

from app.features.compare import LETTERS, html
from app.features.compare.compute import Compared
from app.features.compare.part import ComparePart, Told
from app.features.compare.plot import areas_figure, sections_figure
from app.features.compare.state import MOST, Beside, PutBeside, SetBeside, TakeAway
from app.features.design.panel import design_of_file
from app.features.design.state import UseDesign
from app.language import menu, tr
from app.review.state import Options, Review
from app.scene import palette
from app.widgets.desk import Client, Panel, Sheet, explain
from app.widgets.markup import Markup
from app.widgets.plots import Plot
from app.widgets.texts import box, esc, red
from kinematics.designs.files import load_design, presets


class ComparePanel(Panel):
    """Which designs, what they share, measures, what differs, and one pose asked of all."""

    TITLE = "compare.tab"
    TAB = "design.tab"

    def build(self, review: Review) -> None:
        gui, part = self.gui, self.desk.part(ComparePart)
        self._designs = Markup(self.desk, self._away)
        names = (tr("compare.choose"), *(preset.name for preset in presets()))
        self._choice = gui.add_dropdown(tr("compare.with"), names, initial_value=names[0])
        self.answer(self._choice, self._choose)
        self.upload("compare.open", ".toml,application/toml,text/plain", self._open)
        self._swap = self.button("compare.swap", self._exchange)
        self._shows = self.menu("compare.show", menu("compare.shows"), Beside, "shown", SetBeside)
        self._answer = gui.add_html("")
        with self.folder("compare.measures") as self._measured:
            self._measures = gui.add_html("")
        self._areas = Plot(self.desk, lambda _x, _y, _client: None)
        self._sections = Plot(self.desk, lambda _x, _y, _client: None)
        with self.folder("compare.differences") as self._differing:
            self._differences = gui.add_html("")
        with self.folder("compare.pose") as self._posed:
            self._pose = gui.add_html("")
        self._save = self.saving(("ZIP",), lambda _, client: part.save_archive(client))
        self._told = Told(None, False, "", None, False)
        explain(gui, "compare", review.machine)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        review, told = self.review, self._told
        beside, found = review[Beside], told.found
        of = palette.scheme(review[Options].dark)
        self._designs.say(html.designs_html((review.design, *beside.designs), of))
        self.put(self._choice, tr("compare.choose"))
        some = bool(beside.designs)
        self.see(some, self._swap, self._shows)
        full = len(beside.designs) >= MOST
        self.set(self._choice, disabled=full)
        known = some and found is not None
        for folder in (self._measured, self._differing, self._posed):
            folder.see(known)
        self.see(known, self._save)
        if not some:
            self.say(self._answer, box(esc(tr("compare.none"))))
        elif found is None:
            self.say(self._answer, red(told.trouble) if told.trouble else box(tr("compare.first")))
        if found is None or not some:
            self._areas.draw(None)
            self._sections.draw(None)
            return
        stale = told.stale
        self.say(
            self._answer, red(told.trouble) if told.trouble else html.answer_html(found), stale
        )
        if told.rows is None:
            self.say(self._measures, box(esc(tr("compare.measuring"))))
        else:
            letters = LETTERS[: len(found.request.designs)]
            self.say(self._measures, html.measures_html(told.rows, letters), told.old_rows)
        self.say(self._differences, html.differences_html(found), stale)
        self.say(self._pose, html.pose_html(found), stale)
        self._areas.draw(_areas(found), partial(areas_figure, found, of), stale=stale)
        cut = sections_figure(found, of) is not None
        self._sections.draw(
            found if cut else None, partial(sections_figure, found, of), stale=stale
        )

    def told(self, sheet: Sheet, news: Any) -> None:
        if isinstance(news, Told):
            self._told = news
            self.draw(sheet)

    def _choose(self, name: str, client: Client) -> None:
        if name != tr("compare.choose"):
            self.desk.send(PutBeside(load_design(name)), client)

    def _open(self, file: Any, client: Client) -> None:
        self.desk.send(PutBeside(design_of_file(file)), client)

    def _away(self, pressed: str, client: Client) -> None:
        word, _, number = pressed.partition(" ")
        if word == "away":
            self.desk.send(TakeAway(int(number)), client)

    def _exchange(self, client: Client) -> None:
        """Review B, with A beside it."""
        beside = self.review[Beside].designs
        if beside:
            rest = (self.review.design, *beside[1:])
            self.desk.send(SetBeside("designs", rest), client)
            self.desk.send(UseDesign(beside[0]), client)


def _areas(found: Compared) -> Compared | None:
    return found if any(curve is not None for curve in found.curves) else None
