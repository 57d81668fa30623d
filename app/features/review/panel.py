"""The Review tab: what leaves the page, and how the page looks."""

from __future__ import annotations

from functools import partial
from typing import Any

import viser

from app.features.review.files import FORMATS, ExportedFile, sanitized
from app.features.review.part import ReviewPart
from app.features.workspace.compute import Solids, SolidWish
from app.features.workspace.part import SolidsPart
from app.review import session
from app.review.changes import Restore
from app.review.state import Options, Review
from app.review.units import sentence
from app.terminal.tables import LOCUS
from app.widgets.desk import Client, Group, Panel, Said, Sheet, explain
from app.widgets.texts import box, esc, quiet
from kinematics.errors import InputError
from kinematics.facets.solids import RESOLUTIONS

PIECES = 12  # of one solid that can be saved alone
NONE = "none is shown"
OPTIONS: dict[str, tuple[str, Said | None]] = {
    "machine": ("Machine", ("Machine", "Show or hide it", "M")),
    "handle": ("Drag handle", None),
    "labels": ("Joint names", ("Labels", "Show or hide the joints' names", "L")),
    "frames": ("Frames", None),
    "axes": ("Axes e₁, e₂", ("Axes e₁ and e₂", "Show or hide them", "E")),
    "grid": ("Ground grid", None),
    "scale": ("Scale", None),
    "parallel": ("Parallel view", None),
    "dark": ("Dark page", None),
}
"""Titles, and the commands of those that have a key."""

HELP = """
**Drag** to turn the view, **right-drag** to shift it, **scroll** to zoom. **Ctrl/Cmd + K** opens
the command palette with every hotkey: **F** fit the view, **1**–**4** isometric, plan, front and
side, **H** home, **Ctrl+Z** undo, **Ctrl+Y** redo, **L** labels, **W** workspace, **A** aspects,
**X** section, **T** trajectory, **P** play.

A solid is saved in the base frame, in mm. A **session file** holds the whole review: design, pose,
what is shown; a colleague opens it here or with `bohemia serve --session FILE`. The **scene as a
page** is one HTML file that anyone can open and turn, without Bohemia.

Whoever opens this page's address sees and steers the same review; a reload loses nothing.
"""


class StepsFolder(Group):
    """What was done, the newest first: pressing one takes it and all after it back."""

    LOOKS = False
    TITLES = ("Changes", "", "")
    MOST = 10

    def build(self, review: Review) -> None:
        title, undo, redo = self.TITLES
        with self.folder(title, "press one: it and all after it are taken back"):
            self._none = self.gui.add_html(quiet("Nothing has been changed yet."))
            if undo:  # else the bar has it
                self._undo = self.button(undo, partial(self._take_back, 0))
                self._redo = self.button(redo, lambda _: self.desk.redo(self.LOOKS))
            self._steps = [
                self.button("", partial(self._take_back, n), visible=False)
                for n in range(self.MOST)
            ]

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        titles = sheet.history.titles(self.LOOKS, self.MOST)
        self.see(not titles, self._none)
        if self.TITLES[1]:
            self.set(self._undo, disabled=not titles)
            self.set(self._redo, disabled=not sheet.history.undone(self.LOOKS))
        for n, button in enumerate(self._steps):
            self.set(button, visible=n < len(titles))
            if n < len(titles):
                self.set(button, label=sentence(titles[n]))

    def _take_back(self, n: int, _: Client) -> None:
        self.desk.undo(self.LOOKS, n + 1)


class LooksFolder(StepsFolder):
    """The same of what is shown, and how."""

    LOOKS = True
    TITLES = ("Changes of the display", "Display as before", "Display as after")
    MOST = 5


class ReviewPanel(Panel):
    """Exports, the session file, undo and redo, and what is drawn."""

    TITLE = "Review"

    def build(self, review: Review) -> None:
        gui, desk, icon = self.gui, self.desk, viser.Icon
        part = desk.part(ReviewPart)
        self.groups.append(StepsFolder(desk, self.sheet))
        with self.folder("Save a solid", "STL 3MF PLY GLB OBJ"):
            self._solid = gui.add_dropdown("Solid", (NONE,))
            self._format = gui.add_dropdown("Format", tuple(f.upper() for f in FORMATS))
            self._resolution = gui.add_dropdown("Resolution", RESOLUTIONS, initial_value="fine")
            self._save = self.button("Save", self._export, icon=icon.DOWNLOAD)
        with self.folder("Save the review", "session, picture, page"):
            self.button("Session file", self._session, icon=icon.DOWNLOAD)
            self.key("Save the review", "Save it as a session file", "ctrl+S", self._session)
            self.button("Picture of the view (PNG)", part.picture, icon=icon.CAMERA)
            self.button("Scene as a page (HTML)", part.scene_page, icon=icon.WORLD)
            self.upload("Open a session file", ".json,application/json", self._open)
        with self.folder("What is drawn"):
            for name, (title, command) in OPTIONS.items():
                self.switch(title, Options, name, command=command)
            self.button("Fit the view", lambda _: desk.fit_view(), icon=icon.MAXIMIZE)
            self.groups.append(LooksFolder(desk, self.sheet))
        gui.add_html(box(f"This page: <b>{esc(desk.address)}</b>"))
        explain(gui, HELP)
        self._keys: dict[str, tuple[str, str]] = {}  # the solid's, and which part of it

    def told(self, sheet: Sheet, news: Any) -> None:
        if not isinstance(news, Solids):
            return
        self._keys = {wish.spec.title: (wish.spec.key, "") for wish in news.wishes}
        for wish in news.wishes:
            self._keys |= _parts(wish, news)
        self.offer(self._solid, self._keys, NONE)
        self.set(self._save, disabled=not self._keys)

    def _export(self, client: Client) -> None:
        chosen = self._keys.get(self._solid.value)
        if chosen is None:
            raise InputError("no solid is shown; switch one on in the Workspace tab first")
        key, part = chosen
        kind, resolution = self._format.value.lower(), self._resolution.value
        solids = self.desk.part(SolidsPart)
        self.desk.ask(solids.save_solid, key, kind, resolution, part, client)

    def _session(self, client: Client) -> None:
        text = session.to_text(self.review)
        name = f"{sanitized(self.review.design.name)}.bohemia.json"
        self.desk.download(ExportedFile(name, text.encode()), client)

    def _open(self, file: Any, client: Client) -> None:
        if len(file.content) > session.MAX_BYTES:
            raise InputError(
                f"{file.name}: a session file is smaller than {session.MAX_BYTES >> 10} kB"
            )
        text = file.content.decode("utf-8", errors="replace")
        self.desk.send(Restore(session.from_text(text, origin=file.name)), client)


def _parts(wish: SolidWish, solids: Solids) -> dict[str, tuple[str, str]]:
    """Each piece of a solid that singularities part, and where they do."""
    key = wish.spec.key
    built = solids.built.get(key)
    if built is None or built.solid.piece_of is None:
        return {}
    parts = {"Singular surface": (key, LOCUS)} if built.solid.on_locus is not None else {}
    return parts | {
        f"Aspect {n + 1}": (key, str(n + 1)) for n in range(min(len(built.solid.pieces), PIECES))
    }
