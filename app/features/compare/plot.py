"""The area of sections along the normal, of several designs over one another."""

from __future__ import annotations

from functools import partial

import numpy as np

from app.features.compare import LETTERS
from app.features.compare.compute import Compared
from app.features.compare.html import colors
from app.language import tr
from app.review.units import area_text, number, tenths
from app.scene.palette import LIGHT, Scheme
from app.widgets.axes import MOST as MARKS
from app.widgets.axes import (
    WHOLE,
    Axes,
    Figure,
    Look,
    Table,
    grid,
    middles,
    sampled,
    scales,
    thinned,
    ticks,
)
from app.widgets.svg import label, line
from kinematics.arrays import Array

COLUMNS = 336  # places of which the areas are told
MOST = 500  # points of a curve that are drawn
DASHES = ("", "6 3", "2 3", "8 3 2 3")
Curves = list[tuple[str, Array, Array]]


def areas_figure(found: Compared, of: Scheme = LIGHT, look: Look = WHOLE) -> Figure | None:
    """A curve for each design whose sections are exact; None where there are none."""
    curves: Curves = [
        (letter, one.at, 0.01 * one.area)
        for letter, one in zip(LETTERS, found.curves, strict=False)
        if one is not None and len(one.at)
    ]
    if not curves:
        return None
    span = min(float(x[0]) for _, x, _ in curves), max(float(x[-1]) for _, x, _ in curves)
    top = max(float(a.max()) for _, _, a in curves)
    if not (span[1] > span[0] and top > 0.0):
        return None
    axes = Axes(396, 170, 40, 28, 12, 36, span, (0.0, top / 0.8)).seen(look)
    content = ""
    for letter, x, area in curves:
        n = LETTERS.index(letter)
        kept = thinned(len(x), MOST)
        more = {"stroke_dasharray": DASHES[n]} if DASHES[n] else {}
        path = axes.path(np.column_stack([x, area])[kept].tolist())
        content += line(path, colors(of)[n], 1.8, **more)
        k = int(area.argmax())
        u, v = axes.px(float(x[k]), float(area[k]))
        content += label(u, v - 4, letter, fill=colors(of)[n])
    xs, ys = ticks(*axes.x, MARKS), ticks(*axes.y, 3)
    places = middles(axes.x, COLUMNS)
    told = [np.interp(places, x, area, left=0.0, right=0.0) for _, x, area in curves]
    spec = found.request.machines[0].section_spec
    normal = "x" if spec is None else spec.normal
    return Figure(
        axes,
        grid(axes, (), ys) + axes.clipped(content) + scales(axes, f"{normal} (mm)", "", xs, ys),
        [f"{normal} = {number(round(p, 1))} mm: " for p in places.tolist()],
        ("",),
        [
            ", ".join(
                f"{letter} {area_text(100.0 * float(a[n]))}"
                for (letter, _, _), a in zip(curves, told, strict=True)
            )
            for n in range(COLUMNS)
        ],
        tr("compare.areas_idle"),
        tr("compare.areas"),
        partial(_table, normal, curves),
        title=tr("compare.areas"),
        unit="cm²",
    )


def _table(normal: str, curves: Curves) -> Table:
    places = np.linspace(
        min(float(x[0]) for _, x, _ in curves), max(float(x[-1]) for _, x, _ in curves), 200
    )
    told = [np.interp(places, x, area, left=0.0, right=0.0) for _, x, area in curves]
    rows = [(tenths(float(places[n])), *(f"{float(a[n]):.2f}" for a in told)) for n in sampled(200)]
    return (f"{normal} (mm)", *(f"{letter} (cm²)" for letter, _, _ in curves)), rows
