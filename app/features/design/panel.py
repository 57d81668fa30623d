"""The Design tab: which design, what is worth knowing about it, and every number of it."""

from __future__ import annotations

from collections import defaultdict
from functools import lru_cache, partial
from typing import Any

import viser

from app.features.design.state import EditDesign, UseDesign
from app.features.review.files import design_file
from app.scene import palette
from app.widgets.desk import (
    QUIET,
    Desk,
    Panel,
    Sheet,
    answer,
    box,
    button,
    esc,
    explain,
    put,
    put_prop,
    safely,
    tone,
)
from kinematics.answers.solutions import Finding
from kinematics.designs.files import MAX_BYTES, load_design, presets, read_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanism import Design, DesignField

OWN = "(a design of your own)"

HELP = """
Change any number and everything follows at once; undo takes it back. What was found in this design
stands above.
"""


class DesignPanel(Panel):
    """Presets, files, findings and the numbers of the design."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui = desk.gui
        self._desk = desk
        self._titles = {p.name: p.title for p in presets()}
        self._choice = gui.add_dropdown(
            "Design", (*self._titles, OWN), initial_value=_chosen(sheet, self._titles)
        )
        answer(desk, self._choice, self._choose)
        self._about = gui.add_html(_about(sheet))
        upload = gui.add_upload_button(
            "Open a design file (TOML)",
            mime_type=".toml,application/toml,text/plain",
            color=QUIET,
            icon=viser.Icon.UPLOAD,
        )
        upload.on_upload(self._uploaded)
        self._trouble = gui.add_html("", visible=False)
        button(desk, "Save this design as a file", self._download, icon=viser.Icon.DOWNLOAD)
        self._fields: dict[tuple[str | int, ...], Any] = {}
        self._groups = _grouped(sheet)
        for group, rows in self._groups.items():
            with gui.add_folder(group, expand_by_default=False):
                for stem, fields in rows:
                    self._field(stem, fields)
        explain(gui, sheet.view.review.machine.text("design"), HELP)
        self._design = sheet.view.review.design

    def draw(self, sheet: Sheet) -> None:
        if self._design != sheet.view.review.design:
            self._design = sheet.view.review.design
            self._groups = _grouped(sheet)
        put(self._desk, self._choice, _chosen(sheet, self._titles))
        put_prop(self._about, "content", _about(sheet))
        for rows in self._groups.values():
            for stem, fields in rows:
                values = tuple(f.value for f in fields)
                put(self._desk, self._fields[stem], values if len(values) > 1 else values[0])

    def _field(self, stem: tuple[str | int, ...], fields: list[DesignField]) -> None:
        gui = self._desk.gui
        label = _label(fields)
        values = tuple(f.value for f in fields)
        handle: Any
        if len(values) == 3:
            handle = gui.add_vector3(label, values, step=0.1)
        elif len(values) == 2:
            handle = gui.add_vector2(label, values, step=0.1)
        else:
            handle = gui.add_number(label, values[0], step=0.1)
        self._fields[stem] = handle
        answer(self._desk, handle, partial(self._edit, [f.path for f in fields]))

    def _edit(
        self,
        paths: list[tuple[str | int, ...]],
        value: Any,
        client: viser.ClientHandle | None,
    ) -> None:
        values = value if isinstance(value, tuple) else (value,)
        edits = tuple((path, float(v)) for path, v in zip(paths, values, strict=True))
        self._desk.send(EditDesign(edits), client)

    def _choose(self, name: str, client: viser.ClientHandle | None) -> None:
        if name != OWN:
            self._desk.send(UseDesign(load_design(name)), client)

    async def _uploaded(self, event: viser.GuiEvent[Any]) -> None:
        file = event.target.value

        def take() -> None:
            try:
                design = read_design(
                    _text(file.content, file.name), origin=file.name, name=_stem(file.name)
                )
            except InputError as error:
                self._complain(str(error))
                raise
            self._complain("")
            self._desk.send(UseDesign(design), event.client)

        safely(self._desk, event.client, take)

    def _complain(self, text: str) -> None:
        """What is wrong with an uploaded file stays readable until the next one."""
        put_prop(
            self._trouble,
            "content",
            box(f'<div style="color:{palette.BEYOND}">{esc(text)}</div>'),
        )
        put_prop(self._trouble, "visible", bool(text))

    def _download(self, client: viser.ClientHandle | None) -> None:
        self._desk.download(design_file(self._design), client)


def _text(content: bytes, name: str) -> str:
    if len(content) > MAX_BYTES:
        raise InputError(f"{name}: a design file is smaller than {MAX_BYTES // 1024} kB")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{name}: not a design file (it is not UTF-8 text)") from None


def _stem(name: str) -> str:
    return name.rsplit("/", 1)[-1].removesuffix(".toml")[:60] or "design"


def _chosen(sheet: Sheet, titles: dict[str, str]) -> str:
    design = sheet.view.review.design
    if design.name not in titles:
        return OWN
    return design.name if load_design(design.name) == design else OWN


@lru_cache(maxsize=32)
def findings(design: Design) -> tuple[Finding, ...]:
    """What is worth knowing about a design, kept while it is on the page."""
    return machine_of(design).findings


def _about(sheet: Sheet) -> str:
    design = sheet.view.review.design
    lines = [f"<b>{esc(design.title or design.name)}</b>"]
    if design.source:
        lines.append(f'<span style="opacity:0.75">{esc(design.source)}</span>')
    for finding in findings(design):
        color = palette.BEYOND if finding.severity == "warning" else tone("quiet")
        lines.append(
            f'<div style="border-left:3px solid {color};padding-left:0.6em;margin-top:0.4em">'
            f"<b>{esc(finding.title)}</b><br>{esc(finding.text)}</div>"
        )
    return box("<br>".join(lines[:2]) + "".join(lines[2:]))


def _grouped(sheet: Sheet) -> dict[str, list[tuple[tuple[str | int, ...], list[DesignField]]]]:
    """The design's numbers by group; the coordinates of one point are one row."""
    review = sheet.view.review
    groups: dict[str, dict[tuple[str | int, ...], list[DesignField]]] = defaultdict(dict)
    for field in review.machine.fields:
        last = field.path[-1]
        stem = field.path[:-1] if isinstance(last, int) and len(field.path) > 2 else field.path
        groups[field.group].setdefault(stem, []).append(field)
    return {group: list(rows.items()) for group, rows in groups.items()}


def _label(fields: list[DesignField]) -> str:
    unit = f" ({fields[0].unit})" if fields[0].unit else ""
    if len(fields) == 1:
        return fields[0].label + unit
    words = [f.label.split() for f in fields]
    shared = 0
    while all(len(w) > shared + 1 and w[shared] == words[0][shared] for w in words):
        shared += 1
    rest = ", ".join(" ".join(w[shared:]) for w in words)
    return " ".join([*words[0][:shared], rest]) + unit
