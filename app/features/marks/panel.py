"""Marks, a view of the Review tab: saved views, notes, dimensions, and the presentation of them."""

from __future__ import annotations

from typing import Any

import viser

from app.features.marks import html
from app.features.marks.compute import things, typed_place
from app.features.marks.part import WANTED, Marking, MarksPart, Picking
from app.features.marks.state import LISTS, DropMark, Marks, NameMark
from app.language import tr
from app.review.state import Review
from app.review.view import Moment
from app.widgets.boxes import typed_numbers
from app.widgets.desk import Client, Panel, Sheet, explain
from app.widgets.header import Elsewhere
from app.widgets.markup import Markup
from kinematics.errors import InputError


class MarksPanel(Panel):
    """What people marked, and how they mark more."""

    TITLE = "marks.tab"
    TAB = "review.tab"

    def build(self, review: Review) -> None:
        gui, icon = self.gui, viser.Icon
        self._part = part = self.desk.part(MarksPart)
        self._steps = Markup(self.desk, self._pressed)
        self._elsewhere = Elsewhere(gui)
        self.switch("marks.show", Marks, "shown", ("marks", "N"))
        self.asks_for("marks.present", part.present, icon=icon.PRESENTATION)
        self.key("present", "B", lambda client: self.desk.ask(part.present, client))
        with self.folder("marks.choosing") as self._choosing:
            self._said = Markup(self.desk, lambda _, __: self.desk.ask(part.pick, ""))
            self._things = gui.add_dropdown(
                tr("marks.thing"), (tr("marks.choose"),), hint=tr("marks.thing_hint")
            )
            self._place = gui.add_text(tr("marks.place"), "", hint=tr("marks.place_hint"))
        with self.folder("marks.views"):
            self._views = Markup(self.desk, self._pressed)
            self._name = gui.add_text(tr("marks.view_name"), "")
            self._posed = self.tick("marks.with_pose")
            self.button("marks.keep", self._keep, icon=icon.CAMERA)
        with self.folder("marks.notes"):
            self._notes = Markup(self.desk, self._pressed)
            self._text = gui.add_text(tr("marks.note"), "", multiline=True)
            self.button("marks.pin_point", self._pin_to_point, icon=icon.PIN)
            self.button("marks.pin_pose", self._pin_to_pose, icon=icon.PIN)
        with self.folder("marks.dimensions"):
            self._dimensions = Markup(self.desk, self._pressed)
            self.asks("marks.measure", part.pick, "pair", icon=icon.RULER_2)
            self.asks("marks.measure_corner", part.pick, "corner", icon=icon.ANGLE)
        self.answer(self._things, self._choose)
        self.answer(self._place, self._take_place)
        explain(gui, "marks", review.machine)
        self._marking = Marking(Picking(), {})
        self._written = 0

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        review, view = self.review, sheet.view
        marks = review[Marks]
        known = things(view) if marks.notes or marks.dimensions else {}
        size = view.drawing.size
        self._steps.say(html.steps_html(marks))
        self._views.say(html.views_html(marks.views, review) or _none("views"))
        self._notes.say(html.notes_html(marks.notes, review, known) or _none("notes"))
        self._dimensions.say(html.dimensions_html(marks, known, size) or _none("dimensions"))
        if len(marks.notes) > self._written:
            self.put(self._text, "")
        self._written = len(marks.notes)
        self._draw_choosing()

    def told(self, sheet: Sheet, news: Any) -> None:
        if isinstance(news, Marking):
            self._marking = news
            self._draw_choosing()
        if isinstance(news, Moment):
            self._elsewhere.draw(news.away)

    def _draw_choosing(self) -> None:
        """What is to be chosen next, and of what."""
        picking, known = self._marking.picking, self._marking.known
        self._choosing.see(bool(picking.what))
        if not picking.what:
            self._said.say("")
            return
        count, wanted = len(picking.anchors), WANTED[picking.what]
        taken = ", ".join(
            known[a].text if a in known else tr("marks.a_place") for a in picking.anchors
        )
        told = (
            tr("marks.choose_note")
            if wanted == 1
            else tr("marks.choose_of", n=count + 1, of=wanted)
        )
        so_far = f" {tr('marks.taken', what=taken)}" if taken else ""
        self._said.say(html.asked_html(told + so_far))
        names = (tr("marks.choose"), *dict.fromkeys(each.text for each in known.values()))
        self.set(self._things, options=names)
        self.put(self._things, names[0])
        self.put(self._place, "")

    # --- what people do

    def _keep(self, client: Client) -> None:
        name, posed = self._name.value, bool(self._posed.value)
        self.desk.ask(self._part.keep_view, name, posed, client)

    def _pin_to_point(self, _: Client) -> None:
        if not self._text.value.strip():
            raise InputError(tr("marks.no_text"))
        self.desk.ask(self._part.pick, "note", self._text.value)

    def _pin_to_pose(self, client: Client) -> None:
        self.desk.ask(self._part.pin_to_pose, self._text.value, client)

    def _choose(self, text: str, client: Client) -> None:
        known = self._marking.known
        anchor = next((a for a, each in known.items() if each.text == text), None)
        if anchor is not None:
            self.desk.ask(self._part.choose, anchor, client)

    def _take_place(self, text: str, client: Client) -> None:
        values = typed_numbers(text, tr("marks.place"))
        if values:
            self.desk.ask(self._part.choose, typed_place(values), client)

    def _pressed(self, text: str, client: Client) -> None:
        """ "go views 0", "name notes 2 a text", "step at 3"."""
        word, of, number, *rest = text.split(" ", 3)
        n, kind = int(number), next((known for known in LISTS if known == of), None)
        if word == "step":
            self.desk.ask(self._part.step, n, client)
        elif word == "end":
            self.desk.ask(self._part.end, client)
        elif kind is not None and word == "go":
            self.desk.ask(self._part.go, kind, n, client)
        elif kind is not None:
            change = DropMark(kind, n) if word == "drop" else NameMark(kind, n, "".join(rest))
            self.desk.send(change, client)


def _none(kind: str) -> str:
    return html.none_html(tr(f"marks.none.{kind}"))
