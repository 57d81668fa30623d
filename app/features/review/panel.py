"""The Review tab: what leaves the page, and how the page looks."""

from __future__ import annotations

from functools import partial
from typing import Any

import viser

from app.features.report.make import PAPERS, Paper
from app.features.report.part import ReportPart
from app.features.review.files import ExportedFile, sanitized
from app.features.review.part import ReviewPart
from app.features.together.panel import PeopleFolder
from app.language import tr
from app.review import session
from app.review.changes import Restore
from app.review.state import Options, Review
from app.review.units import sentence
from app.widgets.desk import Client, Group, Panel, Sheet, explain
from app.widgets.texts import quiet
from kinematics.errors import InputError

OPTIONS = ("machine", "handle", "labels", "frames", "axes", "grid", "scale", "parallel", "dark")
KEYS = {"machine": "M", "labels": "L", "axes": "E"}
"""Of the options that have one."""


class StepsFolder(Group):
    """What was done, the newest first: pressing one takes it and all after it back."""

    LOOKS = False
    HEADING = "review.changes"
    MOST = 10

    def build(self, review: Review) -> None:
        with self.folder(self.HEADING):
            self._none = self.gui.add_html(quiet(tr("review.no_changes")))
            if self.LOOKS:  # else the bar has it
                self._undo = self.button("review.look_before", partial(self._take_back, 0))
                self._redo = self.button("review.look_after", lambda _: self.desk.redo(True))
            self._steps = [
                self.button("review.change", partial(self._take_back, n), visible=False)
                for n in range(self.MOST)
            ]

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        titles = sheet.history.titles(self.LOOKS, self.MOST)
        self.see(not titles, self._none)
        if self.LOOKS:
            self.set(self._undo, disabled=not titles)
            self.set(self._redo, disabled=not sheet.history.undone(True))
        for n, button in enumerate(self._steps):
            self.set(button, visible=n < len(titles))
            if n < len(titles):
                self.set(button, label=tr("review.take_back", what=sentence(titles[n])))

    def _take_back(self, n: int, _: Client) -> None:
        self.desk.undo(self.LOOKS, n + 1)


class LooksFolder(StepsFolder):
    """The same of what is shown, and how."""

    LOOKS = True
    HEADING = "review.look_changes"
    MOST = 5


class ReviewPanel(Panel):
    """Exports, the session file, undo and redo, and what is drawn."""

    TITLE = "review.view"
    TAB = "review.tab"

    def build(self, review: Review) -> None:
        gui, desk, icon = self.gui, self.desk, viser.Icon
        part = desk.part(ReviewPart)
        self.groups.append(StepsFolder(desk, self.sheet))
        with self.folder("review.report"):
            names = {paper.capitalize(): paper for paper in PAPERS}
            self._paper = gui.add_dropdown(tr("review.paper"), tuple(names))
            for name, kind in (("review.report_html", "html"), ("review.report_pdf", "pdf")):
                self.button(name, partial(self._report, names, kind), icon=icon.FILE_TEXT)
        with self.folder("review.files"):
            self.button("review.session", self._session, icon=icon.DOWNLOAD)
            self.key("save", "ctrl+S", self._session)
            self.button("review.picture", part.picture, icon=icon.CAMERA)
            self.button("review.page", part.scene_page, icon=icon.WORLD)
            self.upload("review.open", ".json,application/json", self._open)
        with self.folder("review.drawn"):
            for name in OPTIONS:
                command = (name, KEYS[name]) if name in KEYS else None
                self.switch(f"review.{name}", Options, name, command)
            self.button("keys.fit", lambda _: desk.fit_view(), icon=icon.MAXIMIZE)
            self.groups.append(LooksFolder(desk, self.sheet))
        self.groups.append(PeopleFolder(desk, self.sheet))
        explain(gui, "review", review.machine)

    def _report(self, papers: dict[str, Paper], kind: str, client: Client) -> None:
        make = self.desk.part(ReportPart).report
        self.desk.ask(make, kind, papers[self._paper.value], client)

    def _session(self, client: Client) -> None:
        text = session.to_text(self.review)
        name = f"{sanitized(self.review.design.name)}.bohemia.json"
        self.desk.download(ExportedFile(name, text.encode()), client)

    def _open(self, file: Any, client: Client) -> None:
        if len(file.content) > session.MAX_BYTES:
            most = session.MAX_BYTES >> 10
            raise InputError(tr("review.too_large", file=file.name, most=most))
        text = file.content.decode("utf-8", errors="replace")
        self.desk.send(Restore(session.from_text(text, origin=file.name)), client)
