"""What of a machine can be marked where it stands, and what is measured between such things.

Lengths in mm, base frame; angles in rad.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.features.marks.model import LINE, PLANE, POINT, Anchor, Dimension, Note, measure_of
from app.language import tr
from app.review.state import Review
from app.review.units import minus, tenths
from app.review.view import View
from kinematics.answers.drawings import Bar, spot
from kinematics.arrays import Array
from kinematics.errors import BohemiaError, InputError

LINES = ("rail", "cylinder", "rod", "link")
"""Bars that are lines of the machine, by their roles; of those on one line the first."""
ARC, RAY = 0.16, 0.2  # of the machine's size: the radius of an angle, and its legs
FRAME = 0.16  # of it: how far the axes of frames are drawn
CLOSE = 1e-6  # of it: it is the same place


@dataclass(frozen=True, eq=False, slots=True)
class Thing:
    """Something of the machine, where it stands.

    Attributes:
        text: what people call it.
        at: (3,) of a line or a plane a point in it.
        along: (3,) a unit vector, of a line or across a plane; zero for a point.
        ends: (2, 3) of the drawn part of a line; else both are ``at``.
    """

    anchor: Anchor
    text: str
    at: Array
    along: Array
    ends: Array


Things = Mapping[Anchor, Thing]


def things(view: View) -> Things:
    """Everything of the machine that has a name, where it is finite."""
    found = [*_points(view), *_lines(view), *_planes(view)]
    return {t.anchor: t for t in found if np.isfinite([*t.at, *t.along, *t.ends.ravel()]).all()}


def thing(known: Things, anchor: Anchor) -> Thing | None:
    """What a mark is fixed to; None where the machine has no such thing now."""
    if anchor.at:
        x, y, z = (tenths(v) for v in anchor.at)
        return _point(anchor, f"({x}, {y}, {z})", np.array(anchor.at))
    return known.get(anchor)


def _point(anchor: Anchor, text: str, at: Array) -> Thing:
    return Thing(anchor, text, at, np.zeros(3), np.stack([at, at]))


def _line(name: str, text: str, start: Array, end: Array) -> Iterator[Thing]:
    way = end - start
    long = float(np.linalg.norm(way))
    if long > 0.0:
        yield Thing(Anchor(LINE, name), text, start, way / long, np.stack([start, end]))


def _points(view: View) -> Iterator[Thing]:
    """Joint centres, and the origins of the frames where no joint is."""
    drawing, near = view.drawing, CLOSE * view.drawing.size
    taken = []
    for mark in drawing.points:
        taken.append(np.array(mark.position))
        yield _point(Anchor(POINT, mark.name), mark.text, taken[-1])
    centres = [(b.name, _text(b), _middle(b)) for b in drawing.bars if b.role == "joint"]
    origins = [("platform", "O′", view.platform[:3, 3]), ("base", "O", np.zeros(3))]
    for name, text, at in (*centres, *origins):
        if all(float(np.linalg.norm(at - other)) > near for other in taken):
            taken.append(at)
            yield _point(Anchor(POINT, name), text, at)


def _middle(bar: Bar) -> Array:
    middle: Array = 0.5 * (np.array(bar.start) + np.array(bar.end))
    return middle


def _text(bar: Bar) -> str:
    """ "R_E 1" of limb1/R_E."""
    limb, _, part = bar.name.rpartition("/")
    if bar.role == "rail":
        return tr("marks.actuator", n=bar.limb)
    return f"{part} {bar.limb}" if limb else part


def _lines(view: View) -> Iterator[Thing]:
    """Limbs, joint axes and the axes of the frames."""
    size, taken = view.drawing.size, list[Thing]()
    bars = [bar for role in LINES for bar in view.drawing.bars if bar.role == role]
    for bar in (bar for bar in bars if bar.limb is not None):
        for made in _line(bar.name, _text(bar), np.array(bar.start), np.array(bar.end)):
            if not any(_same_line(made, other, CLOSE * size) for other in taken):
                taken.append(made)
                yield made
    for mark in view.drawing.axes:
        start, along = np.array(mark.position), np.array(mark.direction)
        yield from _line(f"axis/{mark.name}", mark.text, start, start + 0.55 * size * along)
    for name, place, sign in (("base", np.eye(4), ""), ("platform", view.platform, "′")):
        for n, axis in enumerate("xyz"):
            start, end = place[:3, 3], place[:3, 3] + FRAME * size * place[:3, n]
            yield from _line(f"{name}/{axis}", f"{axis}{sign}", start, end)


def _same_line(one: Thing, other: Thing, near: float) -> bool:
    aside = np.cross(one.ends - other.at, other.along)
    return float(np.linalg.norm(aside, axis=1).max()) <= max(near, 1e-9)


def _planes(view: View) -> Iterator[Thing]:
    """The planes of the base frame, and that of the platform."""
    for name, place, n in (
        ("base", np.eye(4), 2),
        ("platform", view.platform, 2),
        ("xz", np.eye(4), 1),
        ("yz", np.eye(4), 0),
    ):
        at = place[:3, 3]
        normal = place[:3, n]
        yield Thing(Anchor(PLANE, name), tr(f"marks.planes.{name}"), at, normal, np.stack([at, at]))


def pin(review: Review, known: Things, note: Note) -> Array | None:
    """Where (3,) a note is pinned; None where the machine has no such place now."""
    if note.anchor is not None:
        found = thing(known, note.anchor)
        return None if found is None else found.ends.mean(axis=0)
    try:
        at: Array = np.asarray(review.machine.transform(note.pose, note.mode))[:3, 3]
    except BohemiaError:
        return None
    return at if np.isfinite(at).all() else None


# --- measuring


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """A dimension as it is now.

    Attributes:
        text: its number with the unit.
        note: what else is worth saying; "" for nothing.
        at: (3,) where its label stands.
        lines: (N, 2, 3) that are drawn, with marks at the ends of those in ``marked`` (M, 2, 3).
    """

    value: float
    text: str
    note: str
    at: Array
    lines: Array
    marked: Array


def words(known: Things, dimension: Dimension) -> str:
    """Between what it is: "A₁ – B₂"."""
    found = [(thing(known, anchor), anchor) for anchor in dimension.anchors]
    return " – ".join(anchor.short if each is None else each.text for each, anchor in found)


def measured(known: Things, dimension: Dimension, size: float) -> Measured | None:
    """What it is now, drawn for a machine of a size, mm; None where a thing is missing.

    Raises:
        InputError: nothing can be measured between such things.
    """
    found = [thing(known, anchor) for anchor in dimension.anchors]
    kind = measure_of(dimension.anchors)
    there = [each for each in found if each is not None]
    if len(there) < len(found):
        return None
    if len(there) == 3:
        a, b, c = (each.at for each in there)
        if min(np.linalg.norm(a - b), np.linalg.norm(c - b)) <= CLOSE * size:
            return None
        return _angle(b, _unit(a - b), _unit(c - b), size, "")
    one, other = sorted(there, key=lambda each: (POINT, LINE, PLANE).index(each.anchor.kind))
    return _distance(one, other) if kind == "distance" else _between(one, other, size)


def _distance(point: Thing, other: Thing) -> Measured:
    """From a point to a point, a line that goes on, or a plane."""
    start, away = point.at, point.at - other.at
    note, more = "", np.empty((0, 2, 3))
    match other.anchor.kind:
        case "point":
            foot = other.at
            steps = zip("xyz", (foot - start).tolist(), strict=True)
            note = ", ".join(f"Δ{axis} {tenths(v)}" for axis, v in steps)
        case "line":
            along = float(away @ other.along)
            foot = other.at + along * other.along
            long = float(np.linalg.norm(other.ends[1] - other.ends[0]))
            if not 0.0 <= along <= long:  # as far as there
                more = np.stack([other.ends[int(along > 0.0)], foot])[None]
        case _:
            foot = start - float(away @ other.along) * other.along
    value = float(np.linalg.norm(foot - start))
    way = np.stack([start, foot])[None]
    text = minus(f"{value:.2f} mm")
    return Measured(value, text, note, way[0].mean(axis=0), np.concatenate([way, more]), way)


def _between(one: Thing, other: Thing, size: float) -> Measured:
    """The angle between lines and planes, no more than a right one."""
    u, v = one.along, other.along
    cos = float(u @ v)
    if one.anchor.kind == other.anchor.kind:
        v = v if cos >= 0.0 else -v
        apart = other.at - one.at
        across = np.cross(u, v)
        if float(np.linalg.norm(across)) < 1e-9:  # parallel
            of_line = np.linalg.norm(apart - (apart @ u) * u)
            gap = float(of_line if one.anchor.kind == LINE else abs(apart @ u))
            apex = one.ends.mean(axis=0)
        elif one.anchor.kind == LINE:
            gap = abs(float(apart @ across) / float(np.linalg.norm(across)))
            steps = np.linalg.lstsq(np.stack([u, -v], axis=1), apart, rcond=None)[0]
            apex = _on(one, float(steps[0]))
        else:
            gap, apex = 0.0, one.at
        note = tr("marks.apart", mm=tenths(gap)) if gap > CLOSE * size else ""
        return _angle(apex, u, v, size, note)
    # A line and its shadow on a plane.
    apex = one.ends.mean(axis=0)
    if abs(cos) > 1e-9:
        apex = _on(one, float((other.at - one.at) @ v) / cos)
    shadow = u - cos * v
    if float(np.linalg.norm(shadow)) < 1e-9:
        shadow = np.cross(v, np.eye(3)[int(np.abs(v).argmin())])
    return _angle(apex, u, _unit(shadow), size, "")


def _on(line: Thing, along: float) -> Array:
    """The place (3,) so far along a line; where that is not drawn, the middle of what is."""
    long = float(np.linalg.norm(line.ends[1] - line.ends[0]))
    there = -0.25 * long <= along <= 1.25 * long
    at: Array = line.at + along * line.along if there else line.ends.mean(axis=0)
    return at


def _angle(apex: Array, u: Array, v: Array, size: float, note: str) -> Measured:
    """Drawn as an arc about a point, with legs along two unit vectors."""
    cos, sin = float(u @ v), float(np.linalg.norm(np.cross(u, v)))
    value = math.atan2(sin, cos)
    across = _unit(v - cos * u) if sin > 1e-12 else np.zeros(3)
    turns = np.linspace(0.0, value, 25)[:, None]
    rim = apex + ARC * size * (np.cos(turns) * u + np.sin(turns) * across)
    arc = np.stack([rim[:-1], rim[1:]], axis=1)
    legs = np.stack([np.stack([apex, apex + RAY * size * d]) for d in (u, v)])
    text = f"{math.degrees(value):.2f}°"
    none = np.empty((0, 2, 3))
    return Measured(value, text, note, rim[12], np.concatenate([legs, arc]), none)


def _unit(vector: Array) -> Array:
    long = float(np.linalg.norm(vector))
    unit: Array = vector / long if long > 0.0 else np.array([1.0, 0.0, 0.0])
    return unit


def ticks(marked: Array, size: float) -> Array:
    """Crosses (N, 2, 3) at the ends of lines (M, 2, 3), across them."""
    made = []
    for start, end in marked:
        way = _unit(end - start)
        side = _unit(np.cross(way, np.eye(3)[int(np.abs(way).argmin())]))
        for at in (start, end):
            made += [[at - size * d, at + size * d] for d in (side, np.cross(way, side))]
    return np.array(made).reshape(-1, 2, 3)


def typed_place(values: Sequence[float] | Array) -> Anchor:
    """A place of its own, (3,) mm.

    Raises:
        InputError: it has not three coordinates.
    """
    if len(values) != 3:
        raise InputError(tr("marks.place_of"))
    return Anchor(POINT, at=spot(np.asarray(values, dtype=float)))
