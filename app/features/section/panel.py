"""The Section tab: the workspace cut by a plane, exactly."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import viser

from app.features.section.compute import Drawn
from app.features.section.state import Cut, MoveCut, ShowCut, point_in_section
from app.features.solutions.atlas import number as signed
from app.review.requests import SaveSection
from app.scene import palette
from app.widgets.desk import (
    DIGITS,
    Desk,
    Panel,
    Sections,
    Sheet,
    Slider,
    answer,
    area_text,
    box,
    button,
    chip,
    clicked,
    esc,
    explain,
    put,
    put_prop,
    red,
)
from app.widgets.plots import Axes, Figure, Plot, nearest, number, scales, ticks
from kinematics.answers.sections import Section, SectionSpec, Volume
from kinematics.machine import Machine

KINDS = ("SVG", "DXF", "CSV")
COLUMNS = 336  # places along x′ of which the profile tells the area, one a pixel
TYPED = 4  # digits of x′ that can be typed
MOST = 600  # points of the profile that are drawn
WIDTH = 320  # px of the plot's own panel; workspaces are higher than wide

HELP = """
**Strong edges** in a limb's colour are what is left of its bounds, **faint** ones were cut away. A
full line is the longest stroke ρ max, a dashed one the shortest ρ min, a dotted one the reach of
the second link.

Drag the **plane's arrow** in the scene, the slider, or point at the lower plot: the **area** of the
section against x′. Its ticks mark where arcs appear, touch or vanish; the area under it is the
workspace's volume. The cross marks the platform, where it stands in the plane.
"""


class SectionPanel(Panel):
    """Where the plane stands, the section as a plot and in numbers, its area along the way."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        self._desk = desk
        self._sheet = sheet
        spec = review.machine.section_spec
        assert spec is not None
        self._spec = spec
        self._on = gui.add_checkbox(
            "Show the section", review[Cut].on, hint="In the scene and as a plot (hotkey X)"
        )
        answer(desk, self._on, lambda on, client: desk.send(ShowCut(on), client))
        at = review[Cut].at
        lengths = [c for c in review.machine.coordinates if c.unit == "mm"]
        # Until it is known where the workspace lies.
        self._range = (min(c.lower for c in lengths), max(c.upper for c in lengths))
        self._at = Slider(
            desk,
            f"{self._spec.normal} (mm)",
            *self._range,
            0.1,
            at,
            lambda value, client: desk.send(MoveCut(value), client),
            digits=TYPED,
        )
        self._through = button(desk, "Through the platform", self._go_through)
        self._window = gui.add_panel(visible=review[Cut].on)
        self._window.dock_left()
        self._window.set_width(WIDTH)
        with self._window.add_tab(self._spec.title):
            self._plot = gui.add_html("")
        self._numbers = gui.add_html("")
        self._profile = Plot(desk, self._pointed)
        self._known: Drawn | None = None
        self._profile_of: Volume | None = None
        self._save = gui.add_button_group("Save as", KINDS)
        clicked(desk, self._save, self._saved)
        explain(gui, review.machine.text("section"), HELP)

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return machine.section_spec is not None

    def draw(self, sheet: Sheet) -> None:
        self._sheet = sheet
        cut = sheet.view.review[Cut]
        put(self._desk, self._on, cut.on)
        low, high = min(self._range[0], cut.at), max(self._range[1], cut.at)
        self._at.draw(math.floor(low), math.ceil(high), cut.at)
        self._draw_mark()
        put_prop(self._window, "visible", cut.on)
        if not cut.on:
            put_prop(self._numbers, "content", _hint())
        elif self._known is None:
            put_prop(self._numbers, "content", _first())

    def draw_sections(self, sheet: Sheet, sections: Sections) -> None:
        drawn, cut = sections.drawn, sheet.view.review[Cut]
        self._known = drawn
        if cut.on and drawn is not None:
            put_prop(self._plot, "content", _fluid(drawn.svg))
            put_prop(
                self._numbers,
                "content",
                _numbers(drawn.section, self._spec, drawn.extent.along, sections.trouble),
            )
        elif sections.trouble:
            put_prop(self._numbers, "content", red(sections.trouble))
        volume = sections.volume
        if volume is not self._profile_of:
            self._profile_of = volume
            figure = None if volume is None else profile(volume, self._spec)
            self._profile.draw(figure)
            if figure is not None:
                self._range = figure.axes.x
        elif drawn is not None and drawn.extent.along is not None and not sections.current:
            self._range = drawn.extent.along  # sooner known than the volume
        self.draw(sheet)

    def _draw_mark(self) -> None:
        if self._profile_of is None:
            return
        figure = profile_axes(self._profile_of)
        at = self._sheet.view.review[Cut].at
        if figure is None or not figure.x[0] <= at <= figure.x[1]:
            self._profile.mark("")
            return
        x, low = figure.px(at, 0.0)
        area = float(np.interp(at, *_curve(self._profile_of)))
        _, y = figure.px(at, area / 100.0)
        self._profile.mark(
            f'<path d="M{x:.1f} {figure.top:g}V{low:.1f}" stroke="currentColor" '
            f'stroke-width="1.5"/><circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="currentColor"/>'
        )

    def _pointed(self, x: float, _: float, client: viser.ClientHandle | None) -> None:
        figure = self._profile.figure
        if figure is not None:  # at what the drawing tells under the pointer
            self._desk.send(MoveCut(nearest(profile_places(figure.axes).tolist(), x)), client)

    def _go_through(self, client: viser.ClientHandle | None) -> None:
        self._desk.send(MoveCut(point_in_section(self._sheet.view.review)[0]), client)

    def _saved(self, client: viser.ClientHandle | None) -> None:
        self._desk.ask(SaveSection(self._save.value.lower(), client))


def _first() -> str:
    return box(
        "Computing the first section …<br>On the first start on a machine this takes a minute."
    )


def _hint() -> str:
    return box("Show the section to see it in the scene and as a plot.")


def _fluid(svg: str) -> str:
    """The plot as wide as its panel, in proportion."""
    return svg.replace("<svg ", '<svg style="display:block;width:100%;height:auto" ', 1)


def _numbers(
    section: Section, spec: SectionSpec, along: tuple[float, float] | None, trouble: str
) -> str:
    if trouble:
        return red(trouble)
    if not section.loops:
        if along is None:
            return box("At this orientation the workspace is empty.")
        return box(
            f"The section is empty here; the workspace lies within {esc(spec.normal)} = "
            f"{number(round(along[0], 1))} … {number(round(along[1], 1))} mm."
        )
    first, second = spec.axes
    holes = int((section.loop_area < 0).sum())
    loops = f"{section.loops} loop{'s' if section.loops > 1 else ''}"
    inner = f" ({holes} of them hole{'s' if holes > 1 else ''})" if holes else ""
    exact = f"{section.area:,.6f} mm²".replace(",", " ")
    limbs = " ".join(
        f'<span style="white-space:nowrap">{chip(palette.limb_color(n))}limb {n}</span>'
        for n in sorted(set(section.limb.tolist()))
    )
    rows = (
        ("Cut at", f"{esc(spec.normal)} = {number(round(section.at, TYPED))} mm"),
        ("Area", f'<span title="{exact}">{area_text(section.area)}</span>'),
        ("Perimeter", f"{section.perimeter:.1f} mm"),
        (
            f"Centroid ({first}, {second})",
            f"{signed(section.centroid[0])}, {signed(section.centroid[1])} mm",
        ),
        ("In all", f"{section.pieces} piece{'s' if section.pieces > 1 else ''}, {loops}{inner}"),
        ("Bounded by", limbs),
    )
    body = "".join(
        f'<tr><td style="opacity:.75;padding-right:.9em;white-space:nowrap">{esc(title)}</td>'
        f'<td style="font-variant-numeric:tabular-nums">{value}</td></tr>'
        for title, value in rows
    )
    moments = "<br>".join(
        f"I<sub>{name}</sub> = {moment:.6g}".replace("e-", "e−").replace("= -", "= −") + " mm⁴"
        for name, moment in zip(
            (2 * first, 2 * second, first + second), section.second_moments.tolist(), strict=True
        )
    )
    details = (
        f'<details style="opacity:.75"><summary>Exactly</summary>{exact}<br>second moments about '
        f"the centroid (I<sub>{first}{first}</sub> = ∫{first}² dA):<br>{moments}</details>"
    )
    return box(f"<table>{body}</table>{details}")


# --- the area against the place of the plane ----------------------------------------------


def profile_axes(volume: Volume) -> Axes | None:
    """The axes of the profile, area in cm²; None of an empty workspace."""
    if not len(volume.at) or volume.value <= 0.0:
        return None
    x, area = _curve(volume)
    return Axes(400, 150, 52, 22, 12, 36, (float(x[0]), float(x[-1])), (0.0, area.max() / 92.0))


def _curve(volume: Volume) -> tuple[np.ndarray, np.ndarray]:
    """x′ and area from end to end, where it is zero."""
    ends = (volume.at[0], volume.at[-1])
    if len(volume.events):
        ends = (min(ends[0], volume.events[0]), max(ends[1], volume.events[-1]))
    x = np.concatenate([[ends[0]], volume.at, [ends[1]]])
    return x, np.concatenate([[0.0], volume.area, [0.0]])


def profile_places(axes: Axes) -> np.ndarray:
    """The x′ (N,) of which the profile tells the area, and to which a click goes."""
    middles = (np.arange(COLUMNS) + 0.5) / COLUMNS
    places: np.ndarray = np.round(axes.x[0] + middles * (axes.x[1] - axes.x[0]), DIGITS)
    return places


def profile(volume: Volume, spec: SectionSpec) -> Figure | None:
    """The area of the sections against the place of the plane; None of an empty workspace."""
    axes = profile_axes(volume)
    if axes is None:
        return None
    x, area = _curve(volume)
    kept = np.unique(np.linspace(0, len(x) - 1, min(len(x), MOST)).astype(int))
    line = "L".join(
        f"{u:.1f} {v:.1f}"
        for u, v in (
            axes.px(a, b)
            for a, b in zip(x[kept].tolist(), (0.01 * area[kept]).tolist(), strict=True)
        )
    )
    base = axes.px(0.0, 0.0)[1]
    left, right = axes.px(axes.x[0], 0.0)[0], axes.px(axes.x[1], 0.0)[0]
    events = "".join(
        f"M{axes.px(float(e), 0.0)[0]:.1f} {base:g}v-7"
        for e in volume.events
        if axes.x[0] <= e <= axes.x[1]
    )
    content = (
        f'<path d="M{left:.1f} {base:g}L{line}L{right:.1f} {base:g}Z" fill="{palette.WORKSPACE}" '
        f'fill-opacity=".4" stroke="{palette.WORKSPACE}" stroke-width="1.6"/>'
        f'<path d="{events}" stroke="currentColor" stroke-opacity=".7"/>'
    )
    places = profile_places(axes)
    areas = np.interp(places, x, area)
    return Figure(
        axes,
        content
        + scales(axes, f"{spec.normal} (mm)", "area (cm²)", ticks(*axes.x, 7), ticks(*axes.y, 3)),
        [f"{spec.normal} = {number(round(p, 1))} mm: " for p in places.tolist()],
        ("",),
        [area_text(a) for a in areas.tolist()],
        f"Area of the section against {spec.normal}: point to cut there",
        "Area of the section",
    )
