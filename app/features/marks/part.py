"""Marks on the page: kept where somebody looks from, pinned and measured by clicking."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from app.features.marks.compute import Thing, Things, measured, pin, thing, things
from app.features.marks.model import Anchor, Dimension, Note, SavedView, looks_of
from app.features.marks.scene import Marked
from app.features.marks.snapping import snapped
from app.features.marks.state import AddMark, Marks, Recall
from app.features.move.state import Visit
from app.features.workspace.part import SolidsPart
from app.jobs.parts import Client, Part, Stage
from app.language import tr
from app.review.changes import Change
from app.review.state import Review
from app.review.view import View
from app.scene.camera import Camera, camera_of
from app.scene.pointer import Pointer
from app.widgets.desk import Sheet

WANTED = {"pair": 2, "corner": 3, "note": 1}
"""How many things are chosen, by what for."""


@dataclass(frozen=True, slots=True)
class Picking:
    """What things are chosen for, one of `WANTED` or "" for nothing; those that are, and the text
    of the note.
    """

    what: str = ""
    anchors: tuple[Anchor, ...] = ()
    text: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class Marking:
    """What is being chosen, and from what, as the panel shows it."""

    picking: Picking
    known: Things


class MarksPart(Part):
    """Draws marks where the machine is shown, and makes new ones."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._picking = Picking()
        self._near: Thing | None = None
        self._known: Things = {}  # where the machine is shown
        self._presented: set[int] = set()  # in which browsers marks are presented

    def prepare(self) -> None:
        self._picking, self._near = Picking(), None
        self._scene = Marked(self.stage.scene)
        self.stage.scene.accompany(self._draw)

    # --- drawing

    def _draw(self, view: View) -> None:
        """The machine is shown here now."""
        marks = view.review[Marks]
        busy = bool(self._picking.what)
        shown = marks.shown and bool(marks.notes or marks.dimensions)
        self._known = things(view) if shown or busy else {}
        dimensions, pins = [], []
        for n, note in enumerate(marks.notes if shown else (), start=1):
            if (at := pin(view.review, self._known, note)) is not None:
                pins.append((str(n), at))
        for dimension in marks.dimensions if shown else ():
            found = measured(self._known, dimension, view.drawing.size)
            if found is not None:
                dimensions.append((dimension.text, found))
        there = {client.client_id for client in self.stage.server.get_clients().values()}
        self._scene.show(dimensions, pins, large=bool(self._presented & there))
        chosen = [thing(self._known, anchor) for anchor in self._picking.anchors]
        self._scene.choose([t for t in chosen if t is not None], self._near if busy else None)

    def show(self, sheet: Sheet) -> None:
        known = things(sheet.view) if self._picking.what else {}
        self.stage.tell(Marking(self._picking, known))

    def _redraw(self) -> None:
        self.late = True
        self.stage.scene.aside = bool(self._picking.what)
        self.stage.show_machine()

    # --- choosing

    def pick(self, what: str, text: str = "") -> None:
        """Have things chosen for something; "" for nothing more."""
        self._picking, self._near = Picking(what, (), text), None
        self._redraw()

    def pointed(self, pointer: Pointer) -> None:
        if not self._picking.what:
            return
        corners = self.stage.part(SolidsPart).corners
        near = snapped(pointer, self.stage.shown(), self._known, corners)
        if near is not None and pointer.pressed:
            self.stage.ask(self.choose, near.anchor, pointer.client)
        before = None if self._near is None else self._near.anchor
        if before != (None if near is None else near.anchor):
            self._near = near
            self._redraw()

    def choose(self, anchor: Anchor, client: Client) -> bool:
        """Take this thing; with the last one that is wanted the mark is made."""
        picking = self._picking
        if not picking.what:
            return False
        anchors = (*picking.anchors, anchor)
        if len(anchors) < WANTED[picking.what]:
            self._picking = Picking(picking.what, anchors, picking.text)
            self._redraw()
            return False
        self._near = None
        if picking.what == "note":
            self._picking = Picking()
            self.stage.scene.aside = False
            made: Change = AddMark("notes", self._note(picking.text, anchor, client))
        else:
            self._picking = Picking(picking.what)
            made = AddMark("dimensions", Dimension("", anchors))
        self.late = True
        return self.stage.apply(made, client)

    # --- views and notes

    def keep_view(self, name: str, with_pose: bool, client: Client) -> bool:
        """Keep from where somebody looks, and what is shown."""
        camera = _camera(client)
        if camera is None:
            self.stage.complain(tr("marks.view_of_one"), client)
            return False
        review = self.stage.review
        of_pose = (review.pose, review.mode) if with_pose else ((), "")
        view = SavedView(name, camera, looks_of(review), *of_pose)
        return self.stage.apply(AddMark("views", view), client)

    def pin_to_pose(self, text: str, client: Client) -> bool:
        """Pin a note to where O′ is now."""
        return self.stage.apply(AddMark("notes", self._note(text, None, client)), client)

    def _note(self, text: str, anchor: Anchor | None, client: Client) -> Note:
        review = self.stage.review
        return Note(text, review.pose, review.mode, anchor, _camera(client))

    def go(self, kind: str, number: int, client: Client) -> bool:
        """Look as a saved view has it, or go where a note was written."""
        marks = self.stage.review[Marks]
        entries: tuple[Any, ...] = marks.views if kind == "views" else marks.notes
        if not 0 <= number < len(entries):
            self.stage.complain(tr("marks.gone"), client)
            return False
        mark = entries[number]
        if mark.camera is not None and client is not None:
            self.stage.turn(mark.camera, client)
        change: Change = Recall(mark) if kind == "views" else Visit(mark.pose, mark.mode)
        return self.stage.apply(change, client)

    def step(self, number: int, client: Client) -> bool:
        """Go to one of the steps of a presentation: views, then notes; from 0."""
        self._presented.add(client.client_id)
        views = len(self.stage.review[Marks].views)
        at_view = number < views
        return self.go("views" if at_view else "notes", number - views * (not at_view), client)

    def end(self, client: Client) -> bool:
        """The presentation in a browser has ended."""
        self._presented.discard(client.client_id)
        return True

    def present(self, client: Client) -> None:
        """Begin the presentation in one browser."""
        review: Review = self.stage.review
        if client is None or not (review[Marks].views or review[Marks].notes):
            self.stage.complain(tr("marks.nothing_to_present"), client)
            return
        self.stage.run_script("window.bohemiaPresent();", client)


def _camera(client: Client) -> Camera | None:
    """From where somebody looks, if that is known."""
    if getattr(client, "camera", None) is None:
        return None
    camera = camera_of(client)
    return camera if camera.sound and np.isfinite(camera.fov) else None
