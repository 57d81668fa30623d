"""The scene of a report as plain text: meshes, lines and bars for the viewer in `viewer.js`.

Places of meshes are 16 bit of the box that holds them: 0.01 mm of a machine of half a metre.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from app.features.report.drawing import Shape
from app.review.state import is_planar
from app.review.view import View
from app.scene import palette
from app.scene.camera import toward_of
from app.scene.palette import DARK, LIGHT, Scheme
from app.scene.shapes import CELLS, CYLINDER, body_mesh, ground_cell
from kinematics.answers.drawings import Bar, Drawing
from kinematics.arrays import Array
from kinematics.machine import Machine

STEPS = 65535  # of a box along each of its sides
RAIL = 0.55  # of its radius: how thick a rail is drawn
GROUP = "marks"
"""Under which marks are shown and hidden."""
GROUND = 3  # times so wide as the base is the grid
Look = tuple[str, Array]
"""A view by its name, and from where it is seen, (3,)."""


@dataclass(frozen=True, eq=False, slots=True)
class Packed:
    """A scene for the viewer.

    Attributes:
        data: plain values, for JSON.
        groups: what can be shown and hidden: a key, its title and whether it is shown at first.
        looks: the names of its views.
        seconds: how long its animation takes; 0 where there is none.
    """

    data: dict[str, Any]
    groups: tuple[tuple[str, str, bool], ...]
    looks: tuple[str, ...]
    seconds: float


@dataclass(frozen=True, eq=False, slots=True)
class Motion:
    """A machine on its way: ``times`` (T,) s, and its drawing and platform (4, 4) at each."""

    times: Array
    drawings: Sequence[Drawing]
    platforms: Sequence[Array]


@dataclass(frozen=True, eq=False, slots=True)
class Stand:
    """A saved view as the report's scene has it.

    Attributes:
        toward, target: (3,) from where and at what one looks.
        away: mm from there, with the scene's field of view.
        shown: the groups that are to be seen; None leaves them as they are.
    """

    name: str
    toward: Array
    target: Array
    away: float
    shown: tuple[str, ...] | None


@dataclass(frozen=True, eq=False, slots=True)
class Drawn:
    """Marks: lines (N, 2, 3) mm, texts where they stand, (3,), and saved views."""

    lines: Array
    names: tuple[tuple[str, Array], ...]
    stands: tuple[Stand, ...]


def pack(
    view: View,
    shapes: Sequence[Shape],
    motion: Motion | None = None,
    looks: Sequence[Look] = (),
    marks: Drawn | None = None,
) -> Packed:
    """The machine of a view with solids, and on its way if there is one.

    Args:
        looks: further views than the usual ones.
        marks: of the review.
    """
    machine, drawing = view.review.machine, view.drawing
    moving = motion or Motion(np.zeros(1), (drawing,), (view.platform,))
    flat = is_planar(machine)
    meshes = [_body(drawing, n, view) for n in range(len(drawing.bodies))]
    lines = []
    for shape in shapes:
        meshes += [_shell(shape, side) for side in ("back", "front")]
        if len(shape.lines):
            lines.append(_lines(shape.key, shape.lines, shape.edge))
    low = min([_lowest(drawing), *(float(s.vertices[:, 2].min()) for s in shapes)])
    lines.append(_ground(drawing, low))
    if motion is not None:
        way = np.array([at[:3, 3] for at in motion.platforms])
        path = np.stack([way[:-1], way[1:]], axis=1)
        lines.append(_lines("way", path, (LIGHT.ink, DARK.ink)))
    names = [("names", mark.text, np.array(mark.position)) for mark in drawing.points]
    if marks is not None:
        lines.append(_lines(GROUP, marks.lines, (LIGHT.ink, DARK.ink)))
        names += [(GROUP, text, at) for text, at in marks.names]
    groups = [("machine", "Machine", True), ("names", "Joint names", False)]
    groups += [(key, title, on) for key, title, on in dict.fromkeys(_shown(shapes))]
    groups += [(GROUP, "Marks", True)] * (len(names) > len(drawing.points))
    groups += [("way", "Path of O′", True)] * (motion is not None)
    groups += [("ground", "Ground", True)]
    usual: list[Look] = [
        (name.capitalize(), toward_of(flat, name))
        for name in ("isometric", "plan", "front", "side")
    ]
    seen = [(name, np.round(toward, 6).tolist()) for name, toward in (*usual, *looks)]
    kept = () if marks is None else marks.stands
    first = toward_of(flat)
    return Packed(
        {
            "planar": flat,
            "size": drawing.size,
            "meshes": meshes,
            "lines": lines,
            "bars": _bars(moving),
            "cylinder": _mesh(*CYLINDER),
            "platform": _floats(np.array(moving.platforms)),
            "times": np.round(moving.times, 6).tolist(),
            "names": [[text, np.round(at, 3).tolist(), group] for group, text, at in names],
            "looks": [*seen, *map(_stand, kept)],
            "first": np.round(first, 6).tolist(),
            "back": [LIGHT_BACK, DARK_BACK],
        },
        tuple(groups),
        (*(name for name, _ in seen), *(stand.name for stand in kept)),
        float(moving.times[-1]),
    )


LIGHT_BACK, DARK_BACK = "#FFFFFF", "#141414"


def _stand(of: Stand) -> list[Any]:
    """A saved view, as the viewer takes it."""
    places = [np.round(at, 6).tolist() for at in (of.toward, of.target)]
    return [of.name, *places, round(of.away, 3), of.shown and list(of.shown)]


def _shown(shapes: Sequence[Shape]) -> list[tuple[str, str, bool]]:
    return [(shape.key, shape.title, shape.on) for shape in shapes]


def _pair(of: Any) -> list[str]:
    """A colour by light and by dark."""
    return [of(LIGHT), of(DARK)]


def _body(drawing: Drawing, n: int, view: View) -> dict[str, Any]:
    body = drawing.bodies[n]

    def color(of: Scheme) -> str:
        return of.platform if body.role == "platform" else of.base

    return {
        "group": "machine",
        "frame": body.frame,
        "color": _pair(color),
        "opacity": 1.0,
        "side": "both",
        **_mesh(*body_mesh(body)),
    }


def _shell(shape: Shape, side: Literal["back", "front"]) -> dict[str, Any]:
    return {
        "group": shape.key,
        "frame": "base",
        "color": list(shape.color),
        "opacity": shape.shells[side == "front"],
        "side": side,
        **_mesh(shape.vertices, shape.faces),
    }


def _mesh(vertices: ArrayLike, faces: ArrayLike) -> dict[str, Any]:
    """Vertices (V, 3) mm and faces (F, 3); equal corners stay apart where they are."""
    at, corners = np.asarray(vertices, dtype=float), np.asarray(faces)
    low = at.min(axis=0) if len(at) else np.zeros(3)
    span = float(np.ptp(at, axis=0).max(initial=0.0)) or 1.0
    steps = np.rint((at - low) / span * STEPS).astype("<u2")
    kind = "<u2" if len(at) <= STEPS else "<u4"
    return {
        "low": low.tolist(),
        "span": span,
        "at": _text(steps),
        "faces": _text(corners.astype(kind)),
        "wide": kind == "<u4",
    }


def _lines(group: str, segments: ArrayLike, color: Sequence[str]) -> dict[str, Any]:
    return {"group": group, "color": list(color), "at": _floats(segments)}


def _ground(drawing: Drawing, lowest: float) -> dict[str, Any]:
    """A grid below everything, of round cells."""
    cell = ground_cell(drawing)
    floor = np.floor((lowest - 0.1 * cell) / cell) * cell
    half = GROUND * CELLS * cell
    places = np.arange(-GROUND * CELLS, GROUND * CELLS + 1) * cell
    ends = np.array([-half, half])
    along = [[[x, ends[0], floor], [x, ends[1], floor]] for x in places.tolist()]
    across = [[[ends[0], y, floor], [ends[1], y, floor]] for y in places.tolist()]
    return _lines("ground", [*along, *across], _pair(lambda of: of.section))


def _lowest(drawing: Drawing) -> float:
    base = next(b for b in drawing.bodies if b.name == "base")
    return min(p[2] for p in base.points) - base.radius


def _bars(motion: Motion) -> dict[str, Any]:
    """Both ends of every bar at every time; of one that is not there both are the same."""
    known: dict[str, Bar] = {}
    for drawing in motion.drawings:
        known |= {bar.name: bar for bar in drawing.bars if bar.name not in known}
    names = list(known)
    ends = np.zeros((len(motion.drawings), len(names), 2, 3), dtype="<f4")
    for n, drawing in enumerate(motion.drawings):
        for bar in drawing.bars:
            ends[n, names.index(bar.name)] = bar.start, bar.end
    return {
        "ends": _text(ends),
        "count": len(names),
        "radius": [
            round(RAIL * b.radius if b.role == "rail" else b.radius, 4) for b in known.values()
        ],
        "color": [_pair(lambda of, b=b: palette.bar_color(b, "good", of)) for b in known.values()],
    }


def _floats(values: ArrayLike) -> str:
    return _text(np.asarray(values, dtype="<f4"))


def _text(values: NDArray[Any]) -> str:
    return b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii")


def still(packed: Packed) -> Packed:
    """The same without its animation."""
    return replace(packed, seconds=0.0)


def motion_of(machine: Machine[Any], poses: Array, mode: str, times: Array) -> Motion:
    """A machine at poses (T, P) of a way, in one mode, at times (T,) s."""
    drawings = [machine.drawing(machine.posture(tuple(p), mode)) for p in poses.tolist()]
    return Motion(times, drawings, [*machine.transform(poses, mode)])
