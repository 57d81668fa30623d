"""The Review tab: what leaves the page, and how the page looks."""

from __future__ import annotations

from dataclasses import fields
from functools import partial
from typing import Any

import viser

from app.features.review.files import FORMATS, ExportedFile, sanitized
from app.features.workspace.compute import SolidWish
from app.jobs.worker import Built
from app.review import session
from app.review.changes import Restore, SetOption
from app.review.state import Options
from app.terminal.tables import LOCUS
from app.widgets.desk import (
    QUIET,
    Desk,
    Panel,
    Save,
    Sheet,
    answer,
    box,
    button,
    esc,
    explain,
    put,
    put_prop,
    safely,
)
from kinematics.errors import InputError
from kinematics.facets.solids import RESOLUTIONS

PIECES = 12  # of one solid that can be saved alone
OPTIONS = {
    "machine": "Machine",
    "handle": "Drag handle",
    "labels": "Joint names",
    "frames": "Frames",
    "axes": "Axes e₁, e₂",
    "grid": "Ground grid",
    "dark": "Dark page",
}

HELP = """
**Drag** to turn the view, **right-drag** to shift it, **scroll** to zoom. **Ctrl/Cmd + K** opens
the command palette with every hotkey: **F** fit the view, **H** home, **Ctrl+Z** undo,
**Ctrl+Y** redo, **L** labels, **W** workspace, **A** aspects, **X** section, **T** trajectory,
**P** play.

A solid is saved in the base frame, in mm. A **session file** holds the whole review: design, pose,
what is shown; a colleague opens it here or with `bohemia serve --session FILE`. The **scene as a
page** is one HTML file that anyone can open and turn, without Bohemia.

Whoever opens this page's address sees and steers the same review; a reload loses nothing.
"""


class ReviewPanel(Panel):
    """Exports, the session file, undo and redo, and what is drawn."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui = desk.gui
        self._desk = desk
        self._undo = button(desk, "Undo", lambda _: desk.undo(), icon=viser.Icon.ARROW_BACK_UP)
        self._redo = button(desk, "Redo", lambda _: desk.redo(), icon=viser.Icon.ARROW_FORWARD_UP)
        with gui.add_folder("Save a solid"):
            self._solid = gui.add_dropdown("Solid", ("none is shown",))
            self._format = gui.add_dropdown("Format", tuple(f.upper() for f in FORMATS))
            self._resolution = gui.add_dropdown("Resolution", RESOLUTIONS, initial_value="fine")
            self._save = button(desk, "Save", self._export, icon=viser.Icon.DOWNLOAD)
        with gui.add_folder("Save the review"):
            button(desk, "Session file", self._session, icon=viser.Icon.DOWNLOAD)
            button(desk, "Picture of the view (PNG)", desk.picture, icon=viser.Icon.CAMERA)
            button(desk, "Scene as a page (HTML)", desk.scene_page, icon=viser.Icon.WORLD)
            upload = gui.add_upload_button(
                "Open a session file",
                mime_type=".json,application/json",
                color=QUIET,
                icon=viser.Icon.UPLOAD,
            )
            upload.on_upload(self._uploaded)
        with gui.add_folder("What is drawn"):
            self._options = {
                name: gui.add_checkbox(title, getattr(sheet.view.review[Options], name))
                for name, title in OPTIONS.items()
            }
            for name, switch in self._options.items():
                answer(desk, switch, partial(self._option, name))
            button(desk, "Fit the view", lambda _: desk.fit_view(), icon=viser.Icon.MAXIMIZE)
        gui.add_html(box(f"This page: <b>{esc(desk.address)}</b>"))
        explain(gui, HELP)
        self._keys: dict[str, tuple[str, str]] = {}  # the solid's, and which part of it
        self._review = sheet.view.review

    def draw(self, sheet: Sheet) -> None:
        self._review = sheet.view.review
        put_prop(self._undo, "disabled", not sheet.can_undo)
        put_prop(self._redo, "disabled", not sheet.can_redo)
        titles = {wish.spec.title: (wish.spec.key, "") for wish in sheet.wishes}
        for wish in sheet.wishes:
            titles |= _parts(wish, sheet.built.get(wish.spec.key))
        if titles != self._keys or self._solid.options == ("none is shown",):
            self._keys = titles
            options = tuple(titles) or ("none is shown",)
            if tuple(self._solid.options) != options:
                self._solid.options = options
        put_prop(self._save, "disabled", not titles)
        for option in fields(Options):
            put(self._desk, self._options[option.name], getattr(self._review[Options], option.name))

    def _export(self, client: viser.ClientHandle | None) -> None:
        chosen = self._keys.get(self._solid.value)
        if chosen is None:
            raise InputError("no solid is shown; switch one on in the Workspace tab first")
        key, part = chosen
        kind, resolution = self._format.value.lower(), self._resolution.value
        self._desk.export(Save(key, kind, resolution, client, part))

    def _session(self, client: viser.ClientHandle | None) -> None:
        text = session.to_text(self._review)
        name = f"{sanitized(self._review.design.name)}.bohemia.json"
        self._desk.download(ExportedFile(name, text.encode(), "application/json"), client)

    async def _uploaded(self, event: viser.GuiEvent[Any]) -> None:
        file = event.target.value

        def take() -> None:
            if len(file.content) > session.MAX_BYTES:
                raise InputError(
                    f"{file.name}: a session file is smaller than {session.MAX_BYTES >> 10} kB"
                )
            text = file.content.decode("utf-8", errors="replace")
            self._desk.send(Restore(session.from_text(text, origin=file.name)), event.client)

        safely(self._desk, event.client, take)

    def _option(self, name: str, on: bool, client: viser.ClientHandle | None) -> None:
        self._desk.send(SetOption(name, on), client)


def _parts(wish: SolidWish, built: Built | None) -> dict[str, tuple[str, str]]:
    """Each piece of a solid that singularities part, and where they do."""
    if built is None or built.wish.what != wish.what or built.solid.piece_of is None:
        return {}
    key = wish.spec.key
    parts = {"Singular surface": (key, LOCUS)} if built.solid.on_locus is not None else {}
    return parts | {
        f"Aspect {n + 1}": (key, str(n + 1)) for n in range(min(len(built.solid.pieces), PIECES))
    }
