"""The marks of a review in its report: in its pictures, in its scene, and in tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.features.marks.compute import Measured, measured, pin, thing, things, words
from app.features.marks.model import SavedView
from app.features.marks.state import Marks
from app.features.report.compute import Found
from app.features.report.drawing import WIDTH, Eye, Shape, Sheet
from app.features.report.model import Block, Figure, Section, table
from app.features.report.packing import GROUP, Drawn, Stand
from app.features.workspace.state import Workspace
from app.review.state import Options, Review, is_planar
from app.review.units import pose_text
from app.review.view import View, view
from app.scene.camera import FIELD_OF_VIEW, Camera
from app.widgets.svg import FIELD, TAGGED, TEXT, label, line, tag
from kinematics.arrays import Array
from kinematics.errors import BohemiaError

MOST_PICTURES = 12  # of saved views
SHAPE = 0.62  # height by width of such a picture
PIN = 9.0  # px, the radius of a numbered pin


@dataclass(frozen=True, eq=False, slots=True)
class Told:
    """The marks of a review at a pose.

    Attributes:
        dimensions: by name, what it is between, and its value, None where there is none.
        pins: where (3,) each note is pinned; None where it has no place.
        places: to what notes are pinned, in words.
    """

    dimensions: tuple[tuple[str, str, Measured | None], ...]
    pins: tuple[Array | None, ...]
    places: tuple[str, ...]

    @property
    def lines(self) -> Array:
        """All lines (N, 2, 3) of dimensions, mm."""
        return np.concatenate(
            [np.empty((0, 2, 3)), *(m.lines for _, _, m in self.dimensions if m is not None)]
        )

    @property
    def names(self) -> tuple[tuple[str, Array], ...]:
        """Texts and where they stand: values of dimensions and numbers of notes."""
        values = [(_named(name, m), m.at) for name, _, m in self.dimensions if m is not None]
        pins = [(f"({n})", at) for n, at in enumerate(self.pins, 1) if at is not None]
        return (*values, *pins)


def told(seen: View) -> Told:
    """The marks of a view's review where its machine stands."""
    review, marks = seen.review, seen.review[Marks]
    known, size = things(seen), seen.drawing.size
    places = []
    for note in marks.notes:
        found = None if note.anchor is None else thing(known, note.anchor)
        name = "pose" if note.anchor is None else note.anchor.short
        places.append(name if found is None else found.text)
    return Told(
        tuple((d.text, words(known, d), measured(known, d, size)) for d in marks.dimensions),
        tuple(pin(review, known, note) for note in marks.notes),
        tuple(places),
    )


def _named(name: str, of: Measured) -> str:
    return f"{name}: {of.text}" if name else of.text


def over(sheet: Sheet, of: Told) -> str:
    """Dimensions and pins over a drawing."""
    parts = []
    for name, _, found in of.dimensions:
        if found is None:
            continue
        ends = sheet.eye.px(found.lines)
        path = "".join(f"M{a:.1f} {b:.1f}L{c:.1f} {d:.1f}" for (a, b), (c, d) in ends.tolist())
        parts.append(line(path, FIELD, 3.5, stroke_opacity=0.8) + line(path, TEXT, 1.2))
        dots = sheet.eye.px(found.marked).reshape(-1, 2).tolist()
        parts += [tag("circle", cx=x, cy=y, r=2.2, fill=TEXT) for x, y in dots]
        x, y = sheet.eye.px(found.at).tolist()
        parts.append(label(x, y - 5.0, _named(name, found), fill=TEXT, **TAGGED))
    for n, at in enumerate(of.pins, start=1):
        if at is not None:
            x, y = sheet.eye.px(at).tolist()
            top = y - 2.4 * PIN
            parts.append(line(f"M{x:.1f} {y:.1f}L{x:.1f} {top:.1f}", TEXT, 1.4))
            parts.append(tag("circle", cx=x, cy=top, r=PIN, fill=TEXT))
            look = {"fill": FIELD, "font_size": 11, "font_weight": 600}
            parts.append(label(x, top + 3.9, str(n), **look))
    return "".join(parts)


# --- saved views -----------------------------------------------------------------------------


class Framed(Eye):
    """Looks as a camera does, but from afar: what is where the camera looks at has its size."""

    def __init__(self, camera: Camera, *, flat: bool, width: float = WIDTH) -> None:
        target = np.array(camera.look_at)
        super().__init__(target[None], toward(camera, flat=flat), flat=flat, width=width)
        high = SHAPE * width
        tall = 2.0 * math.tan(0.5 * camera.fov) * distance(camera)
        self.scale, self.size = high / tall, (width, high)
        self.shift = np.array(self.size) / 2 - self.scale * (self.turn[:2] @ target)


def toward(camera: Camera, *, flat: bool) -> Array:
    """From where a camera looks, (3,) of length 1; not quite along what is up."""
    back = np.subtract(camera.position, camera.look_at) / distance(camera)
    up = 1 if flat else 2
    if abs(back[up]) > 1.0 - 1e-7:
        back[2 if flat else 1] -= 1e-3
    unit: Array = back / np.linalg.norm(back)
    return unit


def distance(camera: Camera) -> float:
    """From a camera to what it looks at, mm."""
    return float(np.linalg.norm(np.subtract(camera.position, camera.look_at)))


def in_scene(seen: View) -> Drawn | None:
    """Marks as the report's scene has them; None where there are none."""
    now, review = told(seen), seen.review
    kept = _stands(review, flat=is_planar(review.machine))
    return Drawn(now.lines, now.names, kept) if kept or now.names else None


def _stands(review: Review, *, flat: bool) -> tuple[Stand, ...]:
    """All saved views."""
    made = []
    for each in review[Marks].views:
        camera = each.camera
        share = math.tan(0.5 * camera.fov) / math.tan(0.5 * FIELD_OF_VIEW)
        back, target = toward(camera, flat=flat), np.array(camera.look_at)
        made.append(Stand(each.text, back, target, share * distance(camera), _shown(each)))
    return tuple(made)


def _shown(of: SavedView) -> tuple[str, ...] | None:
    looks = {type(piece): piece for piece in of.looks}
    options, solids = looks.get(Options), looks.get(Workspace)
    if not isinstance(options, Options) or not isinstance(solids, Workspace):
        return None
    flags = {"machine": options.machine, "names": options.labels, "ground": options.grid}
    keys = [key for key, on in flags.items() if on]
    return (*keys, *(s.key for s in solids.solids), "regions", "way", GROUP)


def _picture(found: Found, of: SavedView, shapes: Sequence[Shape]) -> Figure | None:
    """A saved view as a drawing of lines; None where its machine cannot be drawn."""
    review = found.review
    at_pose = of.pose and (of.pose, of.mode) != (review.pose, review.mode)
    try:
        seen = view(replace(review, pose=of.pose, mode=of.mode)) if at_pose else found.view
    except BohemiaError:
        return None
    sheet = Sheet(seen)
    sheet.eye = Framed(of.camera, flat=sheet.flat)
    shown = _shown(of)
    parts = [] if shown is not None and "ground" not in shown else [sheet.ground(np.inf)]
    if shown is None or "machine" in shown:
        parts.append(sheet.machine())
    if not at_pose:  # solids are of another orientation there
        keys = [s.key for s in shapes if s.on] if shown is None else shown
        parts += [sheet.solid(s)[1] for s in shapes if s.key in keys]
    if shown is None or "names" in shown:
        parts.append(sheet.names())
    parts.append(over(sheet, told(seen)))
    where = pose_text(review.machine.coordinates, seen.review.pose)
    alt = f"Drawing: the saved view {of.text}, the machine at {where}."
    wide, high = sheet.eye.size
    box = {"x": 0, "y": 0, "width": wide, "height": high, "viewBox": f"0 0 {wide:g} {high:g}"}
    drawn = sheet.page(tag("svg", "".join(parts), **box), alt)
    return Figure(drawn, f"{of.text}. The machine at {where}.", alt, 0.75)


# --- in words --------------------------------------------------------------------------------


def section(found: Found, shapes: Sequence[Shape]) -> Section | None:
    """Notes, dimensions and saved views; None where there are none."""
    review = found.review
    marks, axes, now = review[Marks], review.machine.coordinates, told(found.view)
    blocks: list[Block] = []
    if marks.notes:
        rows = [
            (str(n), note.text, place, pose_text(axes, note.pose))
            for n, (note, place) in enumerate(zip(marks.notes, now.places, strict=True), 1)
        ]
        blocks.append(table("Notes", ("", "note", "pinned to", "written at"), rows))
    if now.dimensions:
        lines = [
            (name or "–", between, "–" if m is None else m.text, "" if m is None else m.note)
            for name, between, m in now.dimensions
        ]
        caption = f"Dimensions, the machine at {pose_text(axes, review.pose)}"
        blocks.append(table(caption, ("", "between", "value", ""), lines, [2]))
    pictures = [_picture(found, each, shapes) for each in marks.views[:MOST_PICTURES]]
    blocks += [picture for picture in pictures if picture is not None]
    return Section("Marks", tuple(blocks)) if blocks else None
