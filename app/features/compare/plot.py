"""Sections, and their areas along the normal, of several designs over one another."""

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
    equal_axes,
    grid,
    middles,
    sampled,
    scales,
    thinned,
    ticks,
)
from app.widgets.svg import label, line, tag
from kinematics.arrays import Array

SECTION = 396.0, 300.0  # px
CHORD = 4.0  # mm
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


def sections_figure(found: Compared, of: Scheme = LIGHT, look: Look = WHOLE) -> Figure | None:
    """The sections by one plane over one another; None where no design has exact ones there."""
    outlines = [(n, one) for n, one in enumerate(found.outlines) if one is not None and one.loops]
    spec = found.request.machines[0].section_spec
    if not outlines or spec is None:
        return None
    drawn = [
        (n, [one.polyline(k, CHORD) for k in range(one.loops)], one.area) for n, one in outlines
    ]
    every = np.concatenate([loop for _, loops, _ in drawn for loop in loops])
    (u0, v0), (u1, v1) = every.min(axis=0).tolist(), every.max(axis=0).tolist()
    wide, high = look.size or SECTION
    axes = equal_axes(((u0, u1), (v0, v1)), wide, high, 44.0, 28.0, 44.0).seen(look)
    content = ""
    for n, loops, _ in drawn:
        color = colors(of)[n]
        more = {"stroke_dasharray": DASHES[n]} if DASHES[n] else {}
        path = "".join(f"{axes.path(loop.tolist())}Z" for loop in loops)
        content += tag("path", d=path, fill=color, fill_opacity="0.12", fill_rule="evenodd")
        content += line(path, color, 1.8, **more)
    names = tuple((f"{name} (mm)", name, "mm") for name in spec.axes)
    xs, ys = ticks(*axes.x, MARKS), ticks(*axes.y, MARKS)
    at = f"{spec.normal} = {tenths(found.at)} mm"
    areas = ", ".join(f"{LETTERS[n]} {area_text(area)}" for n, _, area in drawn)
    return Figure(
        axes,
        grid(axes, xs, ys) + axes.clipped(content) + scales(axes, names[0][0], names[1][0], xs, ys),
        (),
        (),
        (),
        areas,
        tr("compare.sections_name", at=at),
        lambda: (
            (tr("compare.design"), "cm²"),
            [(LETTERS[n], f"{0.01 * area:.2f}") for n, _, area in drawn],
        ),
        title=tr("compare.sections", at=at),
    )


def _table(normal: str, curves: Curves) -> Table:
    places = np.linspace(
        min(float(x[0]) for _, x, _ in curves), max(float(x[-1]) for _, x, _ in curves), 200
    )
    told = [np.interp(places, x, area, left=0.0, right=0.0) for _, x, area in curves]
    rows = [(tenths(float(places[n])), *(f"{float(a[n]):.2f}" for a in told)) for n in sampled(200)]
    return (f"{normal} (mm)", *(f"{letter} (cm²)" for letter, _, _ in curves)), rows
