"""The Design tab: which design, what is worth knowing about it, and every number of it."""

from __future__ import annotations

from collections import defaultdict
from functools import lru_cache, partial
from typing import Any

import viser

from app.features.design.state import EditDesign, UseDesign
from app.features.review.files import design_file
from app.review.state import Review
from app.scene import palette
from app.widgets.desk import Client, Panel, Sheet, explain
from app.widgets.texts import box, edged, esc, faint, styled, tone
from kinematics.answers.solutions import Finding
from kinematics.designs.files import MAX_BYTES, load_design, presets, read_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanism import Design, DesignField

OWN = "(a design of your own)"
Path = tuple[str | int, ...]

HELP = """
Change any number and everything follows at once; undo takes it back. What was found in this design
stands above.
"""


class DesignPanel(Panel):
    """Presets, files, findings and the numbers of the design."""

    TITLE = "Design"

    def build(self, review: Review) -> None:
        gui = self.gui
        names = (*(preset.name for preset in presets()), OWN)
        self._choice = gui.add_dropdown("Design", names, initial_value=_chosen(review))
        self.answer(self._choice, self._choose)
        self._about = gui.add_html("")
        kinds = ".toml,application/toml,text/plain"
        self.upload("Open a design file (TOML)", kinds, self._open)
        self._trouble = gui.add_html("", visible=False)
        self.button("Save this design as a file", self._save, icon=viser.Icon.DOWNLOAD)
        self._fields: dict[Path, Any] = {}
        for group, rows in _grouped(review).items():
            with gui.add_folder(group, expand_by_default=False):
                for stem, fields in rows:
                    self._field(stem, fields)
        explain(gui, review.machine.text("design"), HELP)
        self._drawn: Design | None = None

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self.put(self._choice, _chosen(self.review))
        self.say(self._about, _about(self.review))
        held = [h for h in self._fields.values() if self.desk.hands.hold(h)]
        if self._drawn == self.review.design and not held:
            return
        self._drawn = self.review.design
        for rows in _grouped(self.review).values():
            for stem, fields in rows:
                values = tuple(f.value for f in fields)
                self.put(self._fields[stem], values if len(values) > 1 else values[0])

    def _field(self, stem: Path, fields: list[DesignField]) -> None:
        values: Any = tuple(f.value for f in fields)
        makers: dict[int, Any] = {2: self.gui.add_vector2, 3: self.gui.add_vector3}
        make = makers.get(len(values), self.gui.add_number)
        handle = make(_label(fields), values if len(values) in makers else values[0], step=0.1)
        self._fields[stem] = handle
        self.answer(handle, partial(self._edit, [f.path for f in fields]))

    def _edit(self, paths: list[Path], value: Any, client: Client) -> None:
        values = value if isinstance(value, tuple) else (value,)
        edits = tuple((path, float(v)) for path, v in zip(paths, values, strict=True))
        self.desk.send(EditDesign(edits), client)

    def _choose(self, name: str, client: Client) -> None:
        if name != OWN:
            self.desk.send(UseDesign(load_design(name)), client)

    def _open(self, file: Any, client: Client) -> None:
        try:
            text = _text(file.content, file.name)
            stem = file.name.rsplit("/", 1)[-1].removesuffix(".toml")[:60] or "design"
            design = read_design(text, origin=file.name, name=stem)
        except InputError as error:
            self._complain(str(error))
            raise
        self._complain("")
        self.desk.send(UseDesign(design), client)

    def _complain(self, text: str) -> None:
        """What is wrong with an uploaded file stays readable until the next one."""
        self.say(self._trouble, box(styled(esc(text), f"color:{palette.BEYOND}", "div")))
        self.set(self._trouble, visible=bool(text))

    def _save(self, client: Client) -> None:
        self.desk.download(design_file(self.review.design), client)


@lru_cache(maxsize=32)
def findings(design: Design) -> tuple[Finding, ...]:
    """What is worth knowing about a design, kept while it is on the page."""
    return machine_of(design).findings


def _text(content: bytes, name: str) -> str:
    if len(content) > MAX_BYTES:
        raise InputError(f"{name}: a design file is smaller than {MAX_BYTES // 1024} kB")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{name}: not a design file (it is not UTF-8 text)") from None


def _chosen(review: Review) -> str:
    design = review.design
    if design.name not in {preset.name for preset in presets()}:
        return OWN
    return design.name if load_design(design.name) == design else OWN


def _about(review: Review) -> str:
    design = review.design
    lines = [f"<b>{esc(design.title or design.name)}</b>"]
    if design.source:
        lines.append(faint(esc(design.source)))
    colors = {"warning": palette.BEYOND}
    found = "".join(
        edged(
            f"<b>{esc(finding.title)}</b><br>{esc(finding.text)}",
            colors.get(finding.severity, tone("quiet")),
            "margin-top:0.4em",
        )
        for finding in findings(design)
    )
    return box("<br>".join(lines) + found)


def _grouped(review: Review) -> dict[str, list[tuple[Path, list[DesignField]]]]:
    """The design's numbers by group; the coordinates of one point are one row."""
    groups: dict[str, dict[Path, list[DesignField]]] = defaultdict(dict)
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
