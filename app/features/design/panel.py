"""The Design tab: which design, what is worth knowing about it, and every number of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import viser

from app.features.compare.state import PutBeside
from app.features.design import html
from app.features.design.state import (
    DropMilestone,
    EditDesign,
    GoBackTo,
    KeepMilestone,
    Milestone,
    Milestones,
    UseDesign,
)
from app.features.review.files import design_file, sanitized
from app.language import tr
from app.review.changes import Change
from app.review.state import Review
from app.widgets.desk import Client, Panel, Sheet, explain
from app.widgets.markup import Markup
from app.widgets.once import Once
from app.widgets.texts import box, esc, styled, tone
from kinematics.designs.files import MAX_BYTES, load_design, presets, read_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanism import Design

_DOES: dict[str, Callable[[Milestone], Change]] = {
    "compare": lambda milestone: PutBeside(milestone.design),
    "restore": GoBackTo,
    "drop": lambda milestone: DropMilestone(milestone.name),
}


class DesignPanel(Panel):
    """Presets, files, findings and the numbers of the design."""

    TITLE = "design.view"
    TAB = "design.tab"

    def build(self, review: Review) -> None:
        gui = self.gui
        names = (*(preset.name for preset in presets()), tr("design.own"))
        self._choice = gui.add_dropdown(tr("design.design"), names, initial_value=_chosen(review))
        self.answer(self._choice, self._choose)
        self._about = gui.add_html("")
        kinds = ".toml,application/toml,text/plain"
        self.upload("design.open", kinds, self._open)
        self._trouble = gui.add_html("", visible=False)
        self.button("design.save", self._save, icon=viser.Icon.DOWNLOAD)
        with self.folder("design.dimensions"):
            self._numbers = Markup(self.desk, self._edit)
        with self.folder("design.milestones", open=bool(review[Milestones].kept)):
            self._name = gui.add_text(tr("design.name"), "", hint=tr("design.name_hint"))
            self.button("design.keep", self._keep)
            self._milestones = Markup(self.desk, self._milestone)
        explain(gui, "design", review.machine)
        self._changed = Once(self._tell)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self.put(self._choice, _chosen(self.review))
        self._changed(self.review.design)
        kept = self.review[Milestones].kept
        self._milestones.say(html.milestones_html(kept, self.review.design) if kept else "")

    def _tell(self, design: Design) -> None:
        self.say(self._about, html.about_html(design))
        self._numbers.say(html.numbers_html(machine_of(design).fields))

    def _edit(self, pressed: str, client: Client) -> None:
        key, _, value = pressed.partition(" ")
        field = next((f for f in self.review.machine.fields if html.key(f) == key), None)
        if field is not None:
            edits = ((field.path, html.inner(field, float(value))),)
            self.desk.send(EditDesign(edits), client)

    def _keep(self, client: Client) -> None:
        self.desk.send(KeepMilestone(self._name.value), client)

    def _milestone(self, pressed: str, client: Client) -> None:
        word, _, number = pressed.partition(" ")
        kept = self.review[Milestones].kept
        if not int(number) < len(kept):
            return
        chosen = kept[int(number)]
        if word == "write":
            file = design_file(chosen.design)
            self.desk.download(replace(file, name=f"{sanitized(chosen.name)}.toml"), client)
        else:
            self.desk.send(_DOES[word](chosen), client)

    def _choose(self, name: str, client: Client) -> None:
        if name != tr("design.own"):
            self.desk.send(UseDesign(load_design(name)), client)

    def _open(self, file: Any, client: Client) -> None:
        try:
            design = design_of_file(file)
        except InputError as error:
            self._complain(str(error))
            raise
        self._complain("")
        self.desk.send(UseDesign(design), client)

    def _complain(self, text: str) -> None:
        """What is wrong with an uploaded file stays readable until the next one."""
        self.say(self._trouble, box(styled(esc(text), f"color:{tone('bad')}", "div")))
        self.set(self._trouble, visible=bool(text))

    def _save(self, client: Client) -> None:
        self.desk.download(design_file(self.review.design), client)


def design_of_file(file: Any) -> Design:
    """The design in a file that a person chose.

    Raises:
        InputError: it is none; one sentence.
    """
    text = _text(file.content, file.name)
    stem = file.name.rsplit("/", 1)[-1].removesuffix(".toml")[:60] or "design"
    return read_design(text, origin=file.name, name=stem)


def _text(content: bytes, name: str) -> str:
    if len(content) > MAX_BYTES:
        raise InputError(tr("design.too_large", file=name, most=MAX_BYTES // 1024))
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(tr("design.not_text", file=name)) from None


def _chosen(review: Review) -> str:
    design = review.design
    own = design.name not in {preset.name for preset in presets()}
    return tr("design.own") if own or load_design(design.name) != design else design.name
