"""Designs side by side on the page: compared when the hand rests, parts coarse first."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from app.features.compare import LETTERS, compute
from app.features.compare.html import colors
from app.features.compare.scene import Overlaid
from app.features.compare.state import MACHINES, PARTS, Beside
from app.features.review.files import ExportedFile, sanitized
from app.jobs.answers import Asked
from app.jobs.lane import Lane
from app.jobs.parts import Client, Part
from app.jobs.process import apart, load_finer_solids
from app.language import tr
from app.review.state import Options, Review
from app.review.view import Legend, View
from app.scene import palette
from app.widgets.desk import Sheet
from kinematics.answers.drawings import Drawing
from kinematics.arrays import Array
from kinematics.errors import BohemiaError
from kinematics.machine import machine_of


@dataclass(frozen=True, eq=False, slots=True)
class Told:
    """The comparison as the panel shows it; ``stale`` while another is computed."""

    found: compute.Compared | None
    stale: bool
    trouble: str
    rows: tuple[compute.Row, ...] | None
    old_rows: bool


class ComparePart(Part):
    """Keeps the comparison true to the review and to the designs beside it."""

    LANES = ("compare", "parts")
    DRAWN_LAST = True

    def lane(self, name: str) -> Lane:
        return Lane(name, self.stage.put, prepare=load_finer_solids)

    def prepare(self) -> None:
        self._scene = Overlaid(self.stage.scene)

    def wished(self, view: View) -> Iterable[Asked[Any]]:
        request = compute.request_of(view.review)
        if request is None:
            return
        if view.review[Beside].shown == PARTS and not self._apart:
            for question in compute.DRAWN.values():
                yield question(request)
        yield compute.COMPARED(request)
        yield compute.MEASURED(request)

    @property
    def _apart(self) -> bool:
        """Whether the workspaces are known not to lie over one another."""
        found = self.answers[compute.COMPARED].now
        return found is not None and found.common is None

    def show(self, sheet: Sheet) -> None:
        review = sheet.view.review
        beside, told = review[Beside], self.answers[compute.COMPARED]
        shown, measured = told.shown if beside.designs else None, self.answers[compute.MEASURED]
        rows, old = (measured.shown, measured.stale) if shown is not None else (None, False)
        self.stage.tell(Told(shown, told.stale, told.trouble, rows, old))
        fine, rough = (self.answers[compute.DRAWN[r]] for r in ("normal", "preview"))
        parts = fine.now or rough.now or rough.shown
        on = bool(beside.designs) and beside.shown == PARTS and not self._apart
        faint = fine.now is None and self.aged(rough)
        self._scene.parts(parts if on and parts else (), faint=faint)
        machines = beside.designs if beside.shown == MACHINES else ()
        self._scene.machines([_drawn(review, design) for design in machines])
        self.stage.tell(Legend("compare", tuple(_key(review, on))))

    def save_archive(self, client: Client) -> None:
        """Save solids and tables in one archive."""
        found, rows = self.answers[compute.COMPARED].now, self.answers[compute.MEASURED].now
        whole = None if found is None or rows is None else replace(found, rows=rows)
        self.save(whole, partial(apart, archive), client, tr("compare.nothing_to_save"))


def archive(found: compute.Compared) -> ExportedFile:
    """Solids and tables of a comparison in one file, in whatever process this is called."""
    from app.features.compare.files import contents

    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as pack:
        for name, data in contents(found):
            pack.writestr(name, data)
    names = "_".join(sanitized(design.name) for design in found.request.designs)
    return ExportedFile(f"compare_{names}.zip", held.getvalue())


def _drawn(review: Review, design: Any) -> tuple[Drawing, Array] | None:
    """A machine at the present pose, with its platform's place; None where it has no such pose."""
    machine = machine_of(design)
    posture = compute.asked(machine, review.machine, review.pose, review.mode).posture
    if posture is None:
        return None
    try:
        place = machine.transform(review.pose, review.mode)
        return machine.drawing(posture), np.asarray(place)
    except BohemiaError:
        return None


def _key(review: Review, parts: bool) -> Iterator[tuple[str, str]]:
    """What the colours in the scene stand for."""
    beside = review[Beside]
    if not beside.designs or not (parts or beside.shown == MACHINES):
        return
    of = palette.scheme(review[Options].dark)
    letters = LETTERS[: 1 + len(beside.designs)]
    if parts:
        yield of.ghost, tr("compare.shared")
    for letter, color in list(zip(letters, colors(of), strict=False))[0 if parts else 1 :]:
        yield color, tr("compare.alone" if parts else "compare.machine", letter=letter)
