"""A section as a picture: SVG with true arcs, for files and for the page alike (Fig. 17).

Kept edges are strong in their limb's colour, the circles and lines of which they are parts faint;
how a line is dashed says which bound it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import atan2, ceil, cos, floor, hypot, isfinite, log10, pi, sin
from typing import Any

import numpy as np

from app.language import tr
from app.review.units import number, tenths
from app.scene.painting import Scale
from app.scene.palette import limb_color
from app.widgets.axes import MOST as MARKS
from app.widgets.axes import (
    STEPS,
    WHOLE,
    Axes,
    Figure,
    Look,
    Named,
    Table,
    equal_axes,
    grid,
    pointed,
    runs,
    sampled,
    scales,
    ticks,
)
from app.widgets.axes import Bounds as Bounds
from app.widgets.svg import (
    AREA,
    LOST,
    TAGGED,
    TEXT,
    Entry,
    document,
    label,
    legend,
    line,
    tag,
)
from kinematics.answers.sections import BOUNDS, Construction, EdgeBound, Section, SectionSpec
from kinematics.arrays import Array

DASHES: dict[EdgeBound, str | None] = {
    "rho_max": None,
    "rho_min": "7 4",
    "link": "1.5 3",
    "parallel": None,
}

_PARALLEL = BOUNDS.index("parallel")
PAPER = "#FFFFFF"
LEFT = 58.0  # px
SIZE = 372.0, 440.0  # px, on the page until it is known how much room there is
CELLS = 120  # columns and rows of which the place under the pointer is told
LARGEST_TURN = 2.0  # rad; longer arcs are several, as SVG's flags are unsure near half a turn


@dataclass(frozen=True, eq=False, slots=True)
class Shade:
    """A measure over the plane: ``values`` (rows upwards, columns), NaN where there is none, over
    ``bounds``, coloured by ``steps``; of the section only ``part`` has it (None: all).
    """

    values: Array
    bounds: Bounds
    steps: Scale
    part: Section | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Picture:
    """What is drawn of a section.

    Attributes:
        faint: also the curves that made it.
        mark: (2,) mm, the platform point in the plane, drawn as a small cross.
        bounds: mm to be seen at least; None to fit the section. Keeps the picture still while
            the plane moves.
        curves: each (N, 2) mm, where control is lost.
        beyond: likewise, where the machine does not come; drawn faint.
        shade: a measure to colour the section by.
        fills: the parts of which the section consists, each with its colour; none: all in one.
        note: of what it is a section, in a few words.
    """

    section: Section
    spec: SectionSpec
    faint: bool = True
    mark: Sequence[float] | None = None
    bounds: Bounds | None = None
    curves: Sequence[Array] = ()
    beyond: Sequence[Array] = ()
    shade: Shade | None = None
    fills: Sequence[tuple[Section, str]] = ()
    note: str = ""

    @property
    def axes(self) -> tuple[Named, Named]:
        first, second = self.spec.axes
        return (first, "mm"), (second, "mm")


def section_svg(
    section: Section,
    spec: SectionSpec,
    *,
    width: float,
    height: float,
    true_size: bool = False,
    title: str = "",
    **what: Any,
) -> str:
    """A section as an SVG file, equal scale in both directions.

    Args:
        width, height: px of the whole picture, legend and labels included.
        true_size: in mm of the plane instead of pixels, a mm as large as it is.
        what: of a `Picture`.
    """
    picture = Picture(section, spec, **what)
    key, high = _legend(picture, width, height)
    frame = equal_axes(_within(picture), width, height, LEFT, 32.0 if title else 14.0, 44.0 + high)
    parts = [label(LEFT, 20, title, "start", font_size=13, font_weight=600)]
    parts += [_content(picture, frame), key]
    name = title or f"{spec.title} = {section.at:g} mm"
    drawn = document((width, height), "".join(parts), name=name, paper=PAPER)
    return frame.true_size(drawn) if true_size else drawn


def section_figure(picture: Picture, look: Look = WHOLE) -> Figure:
    """A section as the page shows it."""
    wide, high = look.size or SIZE
    key, foot = _legend(picture, wide, high - 16.0)  # above the buttons
    frame = equal_axes(_within(picture), wide, high, 44.0, 28.0, 60.0 + foot).seen(look)
    at = f"{picture.spec.normal} = {tenths(picture.section.at)} mm"
    return Figure(
        frame,
        _content(picture, frame) + key,
        *pointed(frame, *picture.axes, CELLS),
        (),
        picture.note,
        tr("section.at_name", at=at),
        partial(_table, picture),
        title=tr("section.at_title", at=at),
    )


def _table(picture: Picture) -> Table:
    """The edges: whose they are, what bounds them, from where to where."""
    section, rows = picture.section, []
    first, second = picture.spec.axes
    for n in sampled(len(section.limb)) if len(section.limb) else ():
        limb, bound = int(section.limb[n]), BOUNDS[section.bound[n]]
        ends = (*section.start[n].tolist(), *section.end[n].tolist())
        title = tr(f"bounds.{bound}", joint=picture.spec.joint)
        radius = float(section.radius[n])
        size = tenths(radius) if isfinite(radius) else tr("section.straight")
        rows.append((f"{limb}" if limb else "–", title, *map(tenths, ends), size))
    places = (
        f"{axis} {end} (mm)" for end in (tr("map.from"), tr("map.to")) for axis in (first, second)
    )
    return (
        tr("section.limb_head"),
        tr("section.bound_head"),
        *places,
        tr("section.radius_head"),
    ), rows


def _within(picture: Picture) -> Bounds:
    return picture.bounds or section_bounds(picture.section)


def _content(picture: Picture, frame: Axes) -> str:
    """The section on its axes."""
    section, shade = picture.section, picture.shade
    xs, ys = (ticks(*span, MARKS) for span in (frame.x, frame.y))
    inner = [grid(frame, xs, ys)]
    if section.loops and shade is not None:
        inner.append(_shaded(section, frame, shade))
    elif section.loops:
        inner += [
            _plain(_region(part, frame), color)
            for part, color in picture.fills or [(section, AREA)]
        ]
    if picture.faint:
        inner += _faint(section.construction, frame)
    inner += _strong(section, frame)
    inner += [_curve(run, frame, faint=True) for run in picture.beyond]
    inner += [_curve(run, frame) for run in picture.curves]
    if picture.mark is not None:
        x, y = frame.px(*picture.mark)
        cross = f"M{x - 6:.2f} {y:.2f}h12M{x:.2f} {y - 6:.2f}v12"
        inner.append(line(cross, TEXT, 1.6, class_="mark"))
        inner.append(label(x + 8, y - 6, "O′", "start", fill=TEXT))
    inner.append(_bar(frame))
    first, second = (f"{symbol} ({unit})" for symbol, unit in picture.axes)
    empty = "" if section.loops else tr("section.empty")
    return (
        frame.clipped("".join(inner))
        + scales(frame, first, second, xs, ys)
        + label(frame.left + frame.inner[0] / 2, frame.top + 24, empty, font_size=13)
    )


def _bar(frame: Axes) -> str:
    """How long some mm are, at the lower right."""
    most = 0.3 * (frame.x[1] - frame.x[0])
    decade = 10.0 ** floor(log10(most))
    size = max(step * decade for step in STEPS if step * decade <= most)
    wide = size * _scale(frame)
    right, low = frame.left + frame.inner[0] - 8.0, frame.top + frame.inner[1] - 10.0
    text = label(right - wide / 2, low - 5, f"{number(size)} mm", class_="bar", fill=TEXT, **TAGGED)
    return line(f"M{right - wide:.2f} {low:.2f}h{wide:.2f}", TEXT, 2, class_="bar") + text


def section_bounds(section: Section) -> Bounds:
    """What a picture of the section shows as a rule: the section, or what failed to make one."""
    if section.loops:
        points = np.concatenate([section.polyline(n, np.inf) for n in range(section.loops)])
    else:
        made = section.construction
        points = np.concatenate(
            [
                made.center - made.radius[:, None],
                made.center + made.radius[:, None],
                made.line.reshape(-1, 2),
            ]
        )
    if not len(points):
        return (-1.0, 1.0), (-1.0, 1.0)
    low, high = points.min(axis=0), points.max(axis=0)
    return (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))


# --- axes, legend --------------------------------------------------------------------------


def _scale(axes: Axes) -> float:
    """px a mm."""
    return axes.inner[0] / (axes.x[1] - axes.x[0])


def _legend(picture: Picture, width: float, height: float) -> tuple[str, float]:
    """Which colour is which limb and which dash which bound; and how high that is."""
    section = picture.section
    limbs = sorted({*section.limb.tolist(), *section.construction.circle_limb.tolist()} - {0})
    # An edge where control is lost, or a curve of it: in its own colour, if there is any.
    lost = bool(len(picture.curves) or len(picture.beyond))
    lost |= bool((section.bound == _PARALLEL).any())
    entries: list[Entry] = [(tr("page.limb", n=limb), limb_color(limb), None) for limb in limbs]
    entries += [
        (
            tr(f"bounds.{bound}", joint=picture.spec.joint),
            LOST if bound == "parallel" else TEXT,
            dash,
        )
        for bound, dash in DASHES.items()
        if lost or bound != "parallel"
    ]
    return legend(entries, width, height)


# --- the section itself --------------------------------------------------------------------


def _region(section: Section, frame: Axes) -> str:
    """All loops as one path; holes are left out by the even-odd rule."""
    path: list[str] = []
    for loop in range(section.loops):
        edges = range(int(section.loop_start[loop]), int(section.loop_start[loop + 1]))
        path.append(_move(frame, section.start[edges[0]]))
        path += [_to(section, edge, frame) for edge in edges]
        path.append("Z")
    return "".join(path)


def _plain(path: str, color: str = AREA) -> str:
    """A region; its holes by the even-odd rule."""
    opacity = 0.16 if color == AREA else 0.38
    look = {"fill": color, "fill_opacity": opacity, "fill_rule": "evenodd"}
    return tag("path", class_="region", d=path, stroke="none", **look)


def _shaded(section: Section, frame: Axes, shade: Shade) -> str:
    """The measure's cells in steps of colour, and over all that does not have it paper, or what
    the region is else drawn with.
    """
    (u0, u1), (v0, v1) = shade.bounds
    rows, columns = shade.values.shape
    left, low = frame.px(u0, v0)
    right, top = frame.px(u1, v1)
    wide, high = (right - left) / columns, (low - top) / rows
    step = np.searchsorted(shade.steps.edges[1:-1], np.nan_to_num(shade.values, nan=0.0))
    step[~np.isfinite(shade.values)] = -1
    parts = []
    for n in range(len(shade.steps.edges) - 1):
        path = "".join(
            f"M{left + c * wide:.2f} {low - (r + 1) * high:.2f}h{count * wide + 0.3:.2f}"
            f"v{high + 0.3:.2f}h{-count * wide - 0.3:.2f}z"
            for r, c, count in runs(step == n)
        )
        if path:
            parts.append(tag("path", class_="shade", d=path, fill=shade.steps.color(n)))
    part = _region(section if shade.part is None else shade.part, frame)
    across, up = frame.inner
    outside = f"M{frame.left - 1:g} {frame.top - 1:g}h{across + 2:g}v{up + 2:g}h{-across - 2:g}z"
    look = {"fill": f"var(--bo-bg,{PAPER})", "fill_rule": "evenodd", "stroke": "none"}
    parts.append(tag("path", class_="paper", d=outside + part, **look))
    if shade.part is not None:
        parts.append(_plain(_region(section, frame) + part))
    return "".join(parts)


def _curve(points: Array, frame: Axes, *, faint: bool = False) -> str:
    """One of the curves where control is lost."""
    path = "M" + "L".join("{:.3f} {:.3f}".format(*frame.px(*p)) for p in points.tolist())
    if faint:
        return line(path, LOST, 1.2, class_="lost-beyond", stroke_opacity=0.45)
    return line(path, LOST, 2.2, class_="lost")


def _strong(section: Section, frame: Axes) -> Iterator[str]:
    """The kept edges, one path for each limb and bound; neighbours run on without a break."""
    for limb in np.unique(section.limb).tolist():
        for n, bound in enumerate(BOUNDS):
            edges = np.flatnonzero((section.limb == limb) & (section.bound == n)).tolist()
            if not edges:
                continue
            path: list[str] = []
            for before, edge in zip([None, *edges], edges, strict=False):
                if before is None or (section.end[before] != section.start[edge]).any():
                    path.append(_move(frame, section.start[edge]))
                path.append(_to(section, edge, frame))
            look = {"class_": f"edge limb{limb} {bound}", "stroke_dasharray": DASHES[bound]}
            yield line("".join(path), limb_color(limb) if limb else LOST, 2.4, **look)


def _faint(made: Construction, frame: Axes) -> Iterator[str]:
    """The curves that made the section, where they can be seen."""

    def made_of(path: str, limb: int, bound: EdgeBound) -> str:
        look = {"class_": f"made limb{limb} {bound}", "stroke_dasharray": DASHES[bound]}
        return line(path, limb_color(limb), 1, stroke_opacity=0.18, **look)

    circles = zip(made.center, made.radius, made.circle_limb, made.circle_bound, strict=True)
    for center, radius, limb, n in circles:
        yield made_of(_visible_circle(center.tolist(), float(radius), frame), limb, BOUNDS[n])
    for ends, limb in zip(made.line.tolist(), made.line_limb, strict=True):
        (x0, y0), (x1, y1) = (frame.px(*end) for end in ends)
        yield made_of(f"M{x0:.2f} {y0:.2f}L{x1:.2f} {y1:.2f}", limb, "link")


def _visible_circle(center: Sequence[float], radius: float, frame: Axes) -> str:
    """A circle as a path, "" if it cannot be seen; of a huge one only the part that can.

    Renderers are unsure about circles of very many pixels.
    """
    away = [0.5 * sum(span) - c for span, c in zip((frame.x, frame.y), center, strict=True)]
    distance = hypot(*away)
    reach = hypot(*frame.inner) / _scale(frame) / 2
    if abs(distance - radius) > reach or not isfinite(radius):
        return ""
    start, turn = 0.0, 2 * pi
    if radius > 8 * reach:
        turn = 5 * reach / radius
        start = atan2(away[1], away[0]) - turn / 2
    first = center[0] + radius * cos(start), center[1] + radius * sin(start)
    return _move(frame, first) + _arc(center, radius, start, turn, frame)


def _move(frame: Axes, point: Sequence[float]) -> str:
    x, y = frame.px(*point)
    return f"M{x:.3f} {y:.3f}"


def _to(section: Section, edge: int, frame: Axes) -> str:
    """The path's next part: along an edge to its end."""
    radius = float(section.radius[edge])
    if not isfinite(radius):
        x, y = frame.px(*section.end[edge].tolist())
        return f"L{x:.3f} {y:.3f}"
    center = section.center[edge].tolist()
    across, up = (section.start[edge] - section.center[edge]).tolist()
    return _arc(center, radius, atan2(up, across), float(section.sweep[edge]), frame)


def _arc(center: Sequence[float], radius: float, start: float, turn: float, frame: Axes) -> str:
    parts = max(1, ceil(abs(turn) / LARGEST_TURN))
    r = radius * _scale(frame)
    flag = 0 if turn > 0 else 1  # upwards on the plane is downwards in pixels
    angles = (start + turn * n / parts for n in range(1, parts + 1))
    ends = (frame.px(center[0] + radius * cos(a), center[1] + radius * sin(a)) for a in angles)
    return "".join(f"A{r:.3f} {r:.3f} 0 0 {flag} {x:.3f} {y:.3f}" for x, y in ends)
