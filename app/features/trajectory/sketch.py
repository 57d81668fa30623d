"""A plot in which a person draws a path with the mouse."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from app.features.trajectory.compute import Reach
from app.language import tr
from app.review.units import tenths
from app.widgets.axes import (
    WHOLE,
    Axes,
    Figure,
    Look,
    Named,
    Table,
    columns,
    cross,
    grid,
    middles,
    named,
    named_scales,
    named_ticks,
    pointed,
    sampled,
)
from app.widgets.desk import Client, Desk
from app.widgets.plots import MOST, Plot
from app.widgets.svg import AREA, LOST, TEXT, line, tag
from kinematics.arrays import Array
from kinematics.mechanism import Coordinate

CELLS = 120  # columns and rows of which the place under the pointer is told
SIZE = 396.0


class Sketch(Plot):
    """A plot whose ``act`` is called with a whole stroke, (N, 2) in the plot's units."""

    ACT = "draw"

    def __init__(self, desk: Desk, act: Callable[[Array, Client], None]) -> None:
        super().__init__(desk, lambda _x, _y, _client: None, both=True)
        self._stroked = act

    def _pointed(self, text: str, client: Client) -> None:
        stroke = read_stroke(text)
        if stroke is not None:
            self._stroked(stroke, client)


def read_stroke(text: str) -> Array | None:
    """The points (N, 2) of a stroke as the browser writes it; what it never wrote is nothing."""
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return None
    if len(values) < 5 or len(values) % 2 == 0 or not all(map(math.isfinite, values)):
        return None
    return np.array(values[:-1]).reshape(-1, 2)[: MOST + 1]


def sketch_axes(axes: Sequence[Coordinate], reach: Reach, look: Look = WHOLE) -> Axes:
    """The plot's box, in the page's units."""
    x, y = (
        (c.outer(low), c.outer(high)) for c, (low, high) in zip(axes, reach.bounds, strict=True)
    )
    return Axes(SIZE, SIZE - 2, 46, 28, 12, 38, x, y).seen(look)


def sketch_figure(axes: Sequence[Coordinate], reach: Reach, look: Look = WHOLE) -> Figure:
    """The plane of two coordinates, shaded where the machine can be."""
    whole, box = sketch_axes(axes, reach), sketch_axes(axes, reach, look)
    first, second = axes
    names = named(first), named(second)
    shade = {"class_": "reach", "fill_opacity": 0.16, "shape_rendering": "crispEdges"}
    trace = {"points": "", "fill": "none", "stroke": "currentColor", "stroke_width": 2}
    return Figure(
        box,
        grid(box, *named_ticks(box, *names))
        + box.clipped(
            tag("path", d=columns(box, reach.inside, (whole.x, whole.y)), fill=AREA, **shade)
        )
        + _lost(axes, box, reach)
        + named_scales(box, *names)
        + tag("polyline", class_="trace", **trace),
        *pointed(box, *names, CELLS),
        [""] * CELLS**2,
        tr("trajectory.draw_here"),
        tr("trajectory.plane_name", first=first.symbol, second=second.symbol),
        partial(_table, names, whole, reach),
        title=tr("trajectory.plane_title", first=first.symbol, second=second.symbol),
    )


def _table(names: tuple[Named, Named], box: Axes, reach: Reach) -> Table:
    """How far the machine reaches along the second coordinate at values of the first."""
    (first, unit), (second, other) = names
    count = len(reach.inside)
    across, up = middles(box.x, count), middles(box.y, count)
    rows = []
    for n in sampled(count):
        inside = up[reach.inside[n]]
        ends = (tenths(inside.min()), tenths(inside.max())) if len(inside) else ("–", "–")
        rows.append((tenths(across[n]), *ends))
    heads = (
        f"{first} ({unit})",
        tr("trajectory.from_head", axis=second, unit=other),
        tr("trajectory.to_head", axis=second, unit=other),
    )
    return heads, rows


def _lost(axes: Sequence[Coordinate], box: Axes, reach: Reach) -> str:
    """The curves where control is lost, as far as they are within the box."""
    path = "".join(box.path(_in_page(axes, curve)) for curve in reach.lost)
    return box.clipped(line(path, LOST, 1.8, class_="lost")) if path else ""


def _in_page(axes: Sequence[Coordinate], points: Array) -> list[tuple[float, float]]:
    """Points (N, 2), mm and rad, in the page's units."""
    return [(axes[0].outer(x), axes[1].outer(y)) for x, y in points.tolist()]


def sketch_mark(axes: Sequence[Coordinate], box: Axes, path: Array, here: Sequence[float]) -> str:
    """The path (N, 2), mm and rad, and a cross where the machine stands."""
    drawn = ""
    if len(path):
        points = _in_page(axes, path)
        x, y = box.px(*points[0])
        drawn = line(box.path(points), TEXT, 2.4, class_="stroke")
        drawn = box.clipped(drawn + tag("circle", cx=x, cy=y, r=4, fill=TEXT))
    u, v = (c.outer(value) for c, value in zip(axes, here, strict=True))
    return drawn + cross(box, u, v)
