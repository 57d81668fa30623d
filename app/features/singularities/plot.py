"""Singular curves as a plot that a person can point at: plain or polar."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from app.language import tr
from app.review.units import number, tenths
from app.scene import palette
from app.widgets.axes import MOST as MARKS
from app.widgets.axes import (
    STEPS,
    TURN,
    WHOLE,
    Axes,
    Figure,
    Look,
    Named,
    Table,
    cross,
    equal_axes,
    grid,
    middles,
    named_scales,
    named_ticks,
    pointed,
    sampled,
    scales,
    thinned,
    ticks,
    upright,
)
from app.widgets.svg import AREA, LOST, RULE, document, label, legend, line, tag
from app.widgets.texts import esc
from kinematics.answers.circles import OrientationCircle, Profile
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.answers.singularities import SingularityKind
from kinematics.arrays import Array

WIDTH, HEIGHT = 396.0, 360.0
FILE = 560.0, 500.0
CELLS = 90  # columns and rows of which the place under the pointer is told
MOST = 4000  # points of all curves that are drawn
MACHINES = (AREA, palette.COUNTERPART)
DASHES = (None, "6 3", "2 3")
_DASH: dict[SingularityKind, str] = {
    "serial": "5 3",
    "constraint": "9 2",
    "self-motion": "1.5 3",
    "architectural": "7 3 1.5 3",
}


def in_units(spec: LocusSpec, points: Array) -> Array:
    """Chart coordinates (..., 2) in the page's units; of a polar chart as x and y."""
    scale = [math.degrees(1.0) if unit == "rad" else 1.0 for unit in spec.units]
    if not spec.polar:
        return np.asarray(points * scale)
    radius, azimuth = points[..., 0] * scale[0], points[..., 1]
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth)], axis=-1)


def from_units(spec: LocusSpec, x: float, y: float) -> tuple[float, float]:
    """The chart's coordinates (mm and rad) of a place in the plot."""
    scale = [math.radians(1.0) if unit == "rad" else 1.0 for unit in spec.units]
    if not spec.polar:
        return x * scale[0], y * scale[1]
    return math.hypot(x, y) * scale[0], math.atan2(y, x)


def chart_axes(
    spec: LocusSpec,
    curves: LocusCurves,
    size: tuple[float, float] = (WIDTH, HEIGHT),
    top: float = 22,
) -> Axes:
    """The axes of a chart, in the page's units; of a polar one as high as it is wide."""
    wide, high = size
    if spec.polar:
        reach = float(in_units(spec, np.array([[curves.bounds[0, 1], 0.0]]))[0, 0])
        span = (-1.04 * reach, 1.04 * reach)
        return Axes(wide, wide - (46 + 12) + (top + 38), 46, top, 12, 38, span, span)
    (x0, y0), (x1, y1) = in_units(spec, curves.bounds.T).tolist()
    return Axes(wide, high, 46, top, 12, 38, (x0, x1), (y0, y1))


def figure(
    spec: LocusSpec,
    curves: LocusCurves,
    circle: OrientationCircle | None = None,
    look: Look = WHOLE,
    *,
    leads: bool = True,
) -> Figure:
    """The curves on their axes, of a polar chart with the largest circle about its centre.

    ``leads``: the machine goes to where a person points.
    """
    axes = chart_axes(spec, curves, top=28).seen(look)
    titles = _titles(spec)
    lines = "" if spec.polar else grid(axes, *named_ticks(axes, *titles))
    content = [_rings(spec, axes)] if spec.polar else []
    if spec.polar and circle is not None:
        content.append(_circle(spec, axes, circle))
    content += _paths(spec, curves, axes)
    columns, rows = _told(spec, axes)
    return Figure(
        axes,
        lines + axes.clipped("".join(content)) + named_scales(axes, *titles),
        columns,
        rows,
        [""] * (len(columns) * len(rows)),
        tr("singularities.point") if leads else "",
        spec.title,
        partial(_table, spec, curves),
        title=spec.title,
    )


def _table(spec: LocusSpec, curves: LocusCurves) -> Table:
    """Points of the curves, each with what is lost there."""
    (first, unit), (second, other) = _names(spec)
    scale = [math.degrees(1.0) if u == "rad" else 1.0 for u in spec.units]
    rows = []
    for n in sampled(len(curves.points)) if len(curves.points) else ():
        c = int(np.searchsorted(curves.start, n, side="right")) - 1
        limb = int(curves.limb[c])
        x, y = (tenths(v) for v in (curves.points[n] * scale).tolist())
        rows.append((curves.kinds[c], f"{limb}" if limb else "–", x, y))
    return ("lost", "limb", f"{first} ({unit})", f"{second} ({other})"), rows


def _names(spec: LocusSpec) -> tuple[Named, Named]:
    """The two coordinates with the page's units."""
    units = ["°" if unit == "rad" else unit for unit in spec.units]
    return (spec.axes[0], units[0]), (spec.axes[1], units[1])


def _titles(spec: LocusSpec) -> tuple[Named, Named]:
    """Those of the axes."""
    first, second = _names(spec)
    if not spec.polar:
        return first, second
    return ((f"{first[0]} cos {second[0]}", first[1]), (f"{first[0]} sin {second[0]}", first[1]))


def chart_svg(spec: LocusSpec, curves: LocusCurves, *, title: str = "", note: str = "") -> str:
    """The curves as a file of their own, with a legend; those in a plane are of true size, mm."""
    wide, top = FILE[0], 58.0
    axes = chart_axes(spec, curves, FILE, top)
    if not spec.polar and spec.units[0] == spec.units[1]:
        axes = replace(equal_axes((axes.x, axes.y), *FILE, 46, top, 38), digits=3)
    entries = {}
    for kind, limb in zip(curves.kinds, curves.limb.tolist(), strict=True):
        name = tr("singularities.kind_limb", kind=kind, limb=limb) if limb else kind
        entries[name] = palette.limb_color(limb), _DASH.get(kind)
    if spec.polar and curves.barriers:
        entries[tr("singularities.no_posture")] = "currentColor", "1.5 3"
    foot = [(name, *look) for name, look in entries.items()]
    high = axes.height + legend(foot, wide, 0.0)[1]
    x0, y0 = axes.px(0.0, 0.0)
    scale = axes.inner[0] / (axes.x[1] - axes.x[0])
    radii = np.degrees(curves.barriers).tolist() if spec.polar else []
    barred = {"fill": "none", "stroke": "currentColor", "stroke_dasharray": "1.5 3"}
    drawn = [
        *([_rings(spec, axes)] if spec.polar else []),
        *_paths(spec, curves, axes),
        *(tag("circle", cx=x0, cy=y0, r=r * scale, **barred) for r in radii),
        named_scales(axes, *_titles(spec)),
        label(wide / 2, 20, title, font_size=13, font_weight=600),
        label(wide / 2, 38, note),
        label(wide / 2, axes.height / 2, "" if curves.kinds else tr("singularities.none_here")),
        legend(foot, wide, high)[0],
    ]
    drawing = document((wide, high), "".join(drawn), name=title or spec.title, paper="#FFFFFF")
    return axes.true_size(drawing) if spec.units == ("mm", "mm") else drawing


def mark(spec: LocusSpec, axes: Axes, at: Sequence[float]) -> str:
    """A cross where the machine stands; nothing outside of the chart."""
    x, y = in_units(spec, np.array([at]))[0].tolist()
    return cross(axes, x, y)


def _paths(spec: LocusSpec, curves: LocusCurves, axes: Axes) -> list[str]:
    points = in_units(spec, curves.points)
    paths = []
    for c, kind in enumerate(curves.kinds):
        run = points[curves.start[c] : curves.start[c + 1]]
        kept = thinned(len(run), max(MOST * len(run) // len(points), 1))
        limb, width = int(curves.limb[c]), 1.4 if kind == "serial" else 2.2
        look = {"class_": f"locus {kind}", "stroke_dasharray": _DASH.get(kind)}
        color = palette.limb_color(limb) if limb else LOST
        paths.append(line(axes.path(run[kept].tolist()), color, width, **look))
    return paths


def _circle(spec: LocusSpec, axes: Axes, circle: OrientationCircle) -> str:
    """The circle without a singularity, and where it touches one."""
    x0, y0 = axes.px(0.0, 0.0)
    radius = in_units(spec, np.array([[circle.radius, 0.0]]))[0, 0]
    contacts = in_units(spec, np.array(circle.contacts).reshape(-1, 2)).tolist()
    dots = "".join(
        tag("circle", cx=x, cy=y, r=3.2, fill=LOST)
        for x, y in (axes.px(*point) for point in contacts)
    )
    size = radius * axes.inner[0] / (axes.x[1] - axes.x[0])
    look = {"fill": AREA, "fill_opacity": 0.16, "stroke": AREA}
    return tag("circle", class_="micr", cx=x0, cy=y0, r=size, stroke_width=1.8, **look) + dots


def profile_figure(profiles: Sequence[tuple[str, Profile]], look: Look = WHOLE) -> Figure:
    """Radii against a ratio of lengths: of each machine, named, and of further ratios."""
    first = profiles[0][1]
    top = max(float(np.degrees(c.radius).max()) for _, p in profiles for c in p.curves)
    spans = (0.0, float(first.x[-1])), (0.0, min(1.05 * top, 182))
    axes = Axes(WIDTH, 250, 46, 28, 12, 38, *spans).seen(look)
    content = []
    modes = list(dict.fromkeys(c.mode for c in first.curves))
    for n, (name, profile) in enumerate(profiles):
        for curve in profile.curves:
            points = np.stack([profile.x, np.degrees(curve.radius)], axis=1).tolist()
            title = tr(
                "singularities.curve", name=esc(name), mode=esc(curve.mode), what=esc(curve.title)
            )
            look_of = {
                "stroke": MACHINES[n % len(MACHINES)],
                "stroke_opacity": 1 if curve.own else 0.4,
                "stroke_width": 1.8 if curve.own else 1.2,
                "stroke_dasharray": DASHES[modes.index(curve.mode) % len(DASHES)],
            }
            path = axes.path(points)
            content.append(tag("path", tag("title", title), d=path, fill="none", **look_of))
    columns = [
        f"{first.across} = {x:.2f}: "
        + " · ".join(
            tr(
                "singularities.radius",
                machine=name,
                value=np.degrees(np.interp(x, p.x, c.radius)),
                mode=c.mode,
            )
            for name, p in profiles
            for c in p.curves
            if c.own
        )
        for x in middles(axes.x, CELLS).tolist()
    ]
    xs, ys = ticks(*axes.x, MARKS), ticks(*axes.y, 4, TURN)
    return Figure(
        axes,
        grid(axes, (), ys)
        + axes.clipped("".join(content))
        + scales(axes, first.across, "", xs, ys),
        columns,
        ("",),
        [""] * CELLS,
        tr("singularities.profile", figure=first.figure, full=modes[0], dashed=modes[-1]),
        first.title,
        partial(_radii, profiles),
        title=first.up,
        unit="°",
    )


def _radii(profiles: Sequence[tuple[str, Profile]]) -> Table:
    own = [(name, p, c) for name, p in profiles for c in p.curves if c.own]
    first = profiles[0][1]
    heads = [
        first.across,
        *(tr("singularities.radius_head", machine=name, mode=c.mode) for name, _, c in own),
    ]
    places = first.x[sampled(len(first.x))].tolist()
    rows = [
        (f"{x:.2f}", *(tenths(math.degrees(np.interp(x, p.x, c.radius))) for _, p, c in own))
        for x in places
    ]
    return heads, rows


def profile_mark(axes: Axes, at: float) -> str:
    """Where the machine stands."""
    return upright(axes, at)


def _rings(spec: LocusSpec, axes: Axes) -> str:
    """Circles of equal radius and rays of equal azimuth, as on a compass."""
    reach = (axes.whole[0] if axes.whole else axes.x)[1] / 1.04
    x0, y0 = axes.px(0.0, 0.0)
    scale = axes.inner[0] / (axes.x[1] - axes.x[0])
    rings = [r for r in ticks(0.0, reach, 5, TURN if spec.units[0] == "rad" else STEPS) if r]
    circles = "".join(tag("circle", cx=x0, cy=y0, r=r * scale) for r in [*rings, reach])
    rays = "".join(
        f"M{x0:g} {y0:g}l{reach * scale * math.cos(a):.1f} {reach * scale * math.sin(a):.1f}"
        for a in np.radians(np.arange(0, 360, 30))
    )
    look = {"fill_opacity": 0.6, "font_size": 9}
    labels = (label(x0 + 3, y0 - r * scale - 2, number(r), "start", **look) for r in rings)
    drawn = circles + tag("path", d=rays)
    faint = tag("g", drawn, fill="none", stroke=RULE)
    return faint + "".join(labels)


def _told(spec: LocusSpec, axes: Axes) -> tuple[list[str], list[str]]:
    """What is told of each column and of each row under the pointer."""
    if not spec.polar:
        return pointed(axes, *_names(spec), CELLS)
    xs, ys = (middles(span, CELLS).tolist() for span in (axes.x, axes.y))
    return [f"{number(round(x, 1))}, " for x in xs], [number(round(y, 1)) for y in ys]
