"""Singular curves as a plot that a person can point at: plain or polar."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from app.review.units import number
from app.scene import palette
from app.widgets.axes import STEPS, TURN, Axes, Figure, cross, scales, ticks
from app.widgets.texts import esc
from kinematics.answers.circles import OrientationCircle, Profile
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.arrays import Array

WIDTH, HEIGHT = 400.0, 360.0
CELLS = 90  # columns and rows of which the place under the pointer is told
MOST = 4000  # points of all curves that are drawn
MACHINES = (palette.WORKSPACE_DEEP, palette.COUNTERPART)
DASHES = ("", ' stroke-dasharray="6 3"', ' stroke-dasharray="2 3"')
_DASH = {"serial": ' stroke-dasharray="5 3"'}


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


def chart_axes(spec: LocusSpec, curves: LocusCurves) -> Axes:
    """The axes of a chart, in the page's units."""
    if spec.polar:
        reach = float(in_units(spec, np.array([[curves.bounds[0, 1], 0.0]]))[0, 0])
        span = (-1.04 * reach, 1.04 * reach)
        square = WIDTH - (46 + 12) + (22 + 38)  # high, so that circles are round
        return Axes(WIDTH, square, 46, 22, 12, 38, span, span)
    (x0, y0), (x1, y1) = in_units(spec, curves.bounds.T).tolist()
    return Axes(WIDTH, HEIGHT, 46, 22, 12, 38, (x0, x1), (y0, y1))


def figure(
    spec: LocusSpec,
    curves: LocusCurves,
    circle: OrientationCircle | None = None,
    *,
    leads: bool = True,
) -> Figure:
    """The curves on their axes, of a polar chart with the largest circle about its centre.

    ``leads``: the machine goes to where a person points.
    """
    axes = chart_axes(spec, curves)
    content = [_rings(spec, axes)] if spec.polar else []
    if spec.polar and circle is not None:
        content.append(_circle(spec, axes, circle))
    content += _paths(spec, curves, axes)
    columns, rows = _told(spec, axes)
    unit = ["°" if unit == "rad" else unit for unit in spec.units]
    if spec.polar:
        titles = (
            f"{spec.axes[0]} cos {spec.axes[1]} ({unit[0]})",
            (f"{spec.axes[0]} sin {spec.axes[1]} ({unit[0]})"),
        )
    else:
        titles = f"{spec.axes[0]} ({unit[0]})", f"{spec.axes[1]} ({unit[1]})"
    steps = [TURN if unit == "rad" else STEPS for unit in spec.units]
    across, up = (steps[0], steps[0]) if spec.polar else steps
    box = scales(axes, *titles, ticks(*axes.x, 6, across), ticks(*axes.y, 6, up))
    clip = axes.clipped("".join(content))
    return Figure(
        axes,
        clip + box,
        columns,
        rows,
        [""] * (len(columns) * len(rows)),
        f"{spec.title}{': point to go there' if leads else ''}",
        spec.title,
    )


def mark(spec: LocusSpec, axes: Axes, at: Sequence[float]) -> str:
    """A cross where the machine stands; nothing outside of the chart."""
    x, y = in_units(spec, np.array([at]))[0].tolist()
    return cross(axes, x, y)


def _paths(spec: LocusSpec, curves: LocusCurves, axes: Axes) -> list[str]:
    points = in_units(spec, curves.points)
    step = max(1, len(points) // MOST)
    paths = []
    for c, kind in enumerate(curves.kinds):
        run = points[curves.start[c] : curves.start[c + 1]]
        kept = np.unique(np.append(np.arange(0, len(run), step), len(run) - 1))
        line = axes.path(run[kept].tolist())
        limb = int(curves.limb[c])
        color = palette.limb_color(limb) if limb else palette.BEYOND
        width = 1.4 if kind == "serial" else 2.2
        paths.append(
            f'<path class="locus {kind}" d="{line}" fill="none" stroke="{color}" '
            f'stroke-width="{width}"{_DASH.get(kind, "")}/>'
        )
    return paths


def _circle(spec: LocusSpec, axes: Axes, circle: OrientationCircle) -> str:
    """The circle without a singularity, and where it touches one."""
    x0, y0 = axes.px(0.0, 0.0)
    radius = in_units(spec, np.array([[circle.radius, 0.0]]))[0, 0]
    scale = axes.inner[0] / (axes.x[1] - axes.x[0])
    dots = "".join(
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.2" fill="{palette.BEYOND}"/>'
        for x, y in (
            axes.px(*p) for p in in_units(spec, np.array(circle.contacts).reshape(-1, 2)).tolist()
        )
    )
    return (
        f'<circle class="micr" cx="{x0:g}" cy="{y0:g}" r="{radius * scale:.1f}" '
        f'fill="{palette.WORKSPACE}" fill-opacity=".3" stroke="{palette.WORKSPACE}" '
        f'stroke-width="1.6"/>{dots}'
    )


def profile_figure(profiles: Sequence[tuple[str, Profile]]) -> Figure:
    """Radii against a ratio of lengths: of each machine, named, and of further ratios."""
    first = profiles[0][1]
    top = max(float(np.degrees(c.radius).max()) for _, p in profiles for c in p.curves)
    axes = Axes(WIDTH, 250, 46, 22, 12, 38, (0.0, float(first.x[-1])), (0.0, min(1.05 * top, 182)))
    content = []
    modes = list(dict.fromkeys(c.mode for c in first.curves))
    for n, (name, profile) in enumerate(profiles):
        for curve in profile.curves:
            points = np.stack([profile.x, np.degrees(curve.radius)], axis=1).tolist()
            line = axes.path(points)
            dash = DASHES[modes.index(curve.mode) % len(DASHES)]
            color = MACHINES[n % len(MACHINES)]
            content.append(
                f'<path d="{line}" fill="none" stroke="{color}" '
                f'stroke-opacity="{1 if curve.own else 0.4}" '
                f'stroke-width="{2 if curve.own else 1.2}"{dash}>'
                f"<title>{esc(name)}, mode {esc(curve.mode)}, {esc(curve.title)}</title></path>"
            )
    columns = [
        f"{first.across} = {x:.2f}: "
        + " · ".join(
            f"{name} {np.degrees(np.interp(x, p.x, c.radius)):.1f}° (mode {c.mode})"
            for name, p in profiles
            for c in p.curves
            if c.own
        )
        for x in np.linspace(0.0, first.x[-1], CELLS).tolist()
    ]
    box = scales(axes, first.across, f"{first.up} (°)", ticks(*axes.x, 6), ticks(*axes.y, 5, TURN))
    return Figure(
        axes,
        axes.clipped("".join(content)) + box,
        columns,
        ("",),
        [""] * CELLS,
        f"{first.title} ({first.figure}); full mode {modes[0]}, dashed mode {modes[-1]}",
        first.title,
    )


def profile_mark(axes: Axes, at: float) -> str:
    """Where the machine stands."""
    if not axes.x[0] <= at <= axes.x[1]:
        return ""
    x, low = axes.px(at, axes.y[0])
    return f'<path d="M{x:.1f} {axes.top:g}V{low:.1f}" stroke="currentColor" stroke-width="1.5"/>'


def _rings(spec: LocusSpec, axes: Axes) -> str:
    """Circles of equal radius and rays of equal azimuth, as on a compass."""
    reach = axes.x[1] / 1.04
    x0, y0 = axes.px(0.0, 0.0)
    scale = axes.inner[0] / (axes.x[1] - axes.x[0])
    rings = [r for r in ticks(0.0, reach, 5, TURN if spec.units[0] == "rad" else STEPS) if r]
    circles = "".join(
        f'<circle cx="{x0:g}" cy="{y0:g}" r="{r * scale:.1f}"/>' for r in [*rings, reach]
    )
    rays = "".join(
        f"M{x0:g} {y0:g}l{reach * scale * math.cos(a):.1f} {reach * scale * math.sin(a):.1f}"
        for a in np.radians(np.arange(0, 360, 30))
    )
    labels = "".join(
        f'<text x="{x0 + 3:g}" y="{y0 - r * scale - 2:.1f}" fill="currentColor" '
        f'fill-opacity=".6" font-size="9">{number(r)}</text>'
        for r in rings
    )
    return (
        f'<g fill="none" stroke="currentColor" stroke-opacity=".16">{circles}<path d="{rays}"/></g>'
        f"{labels}"
    )


def _told(spec: LocusSpec, axes: Axes) -> tuple[list[str], list[str]]:
    """What is told of each column and of each row under the pointer."""
    middles = (np.arange(CELLS) + 0.5) / CELLS
    xs, ys = (low + middles * (high - low) for low, high in (axes.x, axes.y))
    if spec.polar:
        return [f"{number(round(x, 1))}, " for x in xs.tolist()], [
            number(round(y, 1)) for y in ys.tolist()
        ]
    units = ["°" if unit == "rad" else f" {unit}" for unit in spec.units]
    columns = [f"{spec.axes[0]} = {number(round(x, 1))}{units[0]}, " for x in xs.tolist()]
    rows = [f"{spec.axes[1]} = {number(round(y, 1))}{units[1]}" for y in ys.tolist()]
    return columns, rows
