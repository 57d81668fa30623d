"""Curves in the Singularities tab: singular ones, and radii of circles over the altitude."""

from __future__ import annotations

import math

import viser

from app.features.move.state import Move, Place
from app.features.singularities import plot as loci
from app.features.singularities.compute import Here
from app.features.singularities.html import circles_html, comparison_html
from app.features.singularities.state import Control, SetControl
from app.review.requests import SaveLoci
from app.review.view import short_title
from app.widgets.desk import Controlled, Desk, Sheet, answer, box, clicked, esc, put, put_prop
from app.widgets.plots import Plot
from kinematics.answers.circles import OrientationCircle
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.errors import InputError
from kinematics.machine import machine_of

NOTHING = "Nothing"
PLANE = "section"
"""The chart of what lies in the plane of a section, which is drawn there."""


class ChartFolder:
    """The singular curves of a chart, and beside them those of the counterpart."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui = desk.gui
        self._desk = desk
        self._sheet = sheet
        self._specs = {spec.title: spec for spec in specs(sheet)}
        with gui.add_folder("Singular curves"):
            self._chart = gui.add_dropdown("Chart", (NOTHING, *self._specs))
            answer(desk, self._chart, self._choose)
            self._plot = Plot(desk, self._pointed)
            self._plotted: object = None
            self._plot_beside = Plot(desk, self._pointed)
            self._named_beside = gui.add_html("")
            self._curves = gui.add_html("")
            self._save = gui.add_button_group("Save as", ("CSV", "SVG"))
            clicked(
                desk,
                self._save,
                lambda client: desk.ask(SaveLoci(self._save.value.lower(), client)),
            )

    def draw(self, sheet: Sheet) -> None:
        self._sheet = sheet
        titles = {spec.key: title for title, spec in self._specs.items()}
        put(self._desk, self._chart, titles.get(sheet.view.review[Control].chart, NOTHING))
        self._draw_cross()

    def draw_control(self, controlled: Controlled) -> None:
        spec, curves = self._spec(), controlled.curves
        put_prop(self._save, "visible", curves is not None)
        if spec is None:
            self._plotted = None
            for plot in (self._plot, self._plot_beside):
                plot.draw(None)
                plot.mark("")
            for text in (self._curves, self._named_beside):
                put_prop(text, "content", "")
            return
        if curves is None:
            if self._plotted is None:
                put_prop(self._curves, "content", box("Tracing the curves …"))
            return
        circle = _singular_circle(controlled.here)
        if (curves, circle) != self._plotted:
            self._plotted = curves, circle
            leads = _chart_place(self._sheet, spec) is not None
            self._plot.draw(loci.figure(spec, curves, circle, leads=leads))
            put_prop(self._curves, "content", box(_exactness(spec, curves)))
        self._draw_beside(spec, controlled)
        self._draw_cross()

    def _draw_beside(self, spec: LocusSpec, controlled: Controlled) -> None:
        curves, beside = controlled.curves_beside, self._sheet.view.beside
        if curves is None or beside is None:
            self._plot_beside.draw(None)
            put_prop(self._named_beside, "content", "")
            return
        self._plot_beside.draw(loci.figure(spec, curves, _singular_circle(controlled.beside)))
        title = short_title(machine_of(beside.design))
        put_prop(
            self._named_beside,
            "content",
            box(f"Above: this machine, then the {esc(title)} beside it."),
        )

    def _draw_cross(self) -> None:
        spec = self._spec()
        at = None if spec is None else _chart_place(self._sheet, spec)
        for plot in (self._plot, self._plot_beside):
            if spec is not None and plot.figure is not None:
                plot.mark("" if at is None else loci.mark(spec, plot.figure.axes, at))

    def _spec(self) -> LocusSpec | None:
        chart = self._sheet.view.review[Control].chart
        return next((spec for spec in self._specs.values() if spec.key == chart), None)

    def _choose(self, title: str, client: viser.ClientHandle | None) -> None:
        self._plotted = None
        key = "" if title == NOTHING else self._specs[title].key
        self._desk.send(SetControl("chart", key), client)

    def _pointed(self, x: float, y: float, client: viser.ClientHandle | None) -> None:
        spec = self._spec()
        if spec is None:
            return
        review = self._sheet.view.review
        pose = list(review.pose)
        axes = review.machine.coordinates
        for symbol, value in zip(spec.axes, loci.from_units(spec, x, y), strict=True):
            index = next((n for n, c in enumerate(axes) if c.symbol == symbol), None)
            if index is None:
                return
            pose[index] = value
        self._desk.send(Place(tuple(pose), gesture=f"chart {spec.key}"), client)


class ProfileFolder:
    """The largest circle of orientations: here, over the altitude, and of the counterpart."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        self._desk = desk
        self._sheet = sheet
        self._controlled: Controlled | None = None
        with gui.add_folder("Largest circle of orientations"):
            self._circles = gui.add_html("")
            self._compare: viser.GuiCheckboxHandle | None = None
            others = review.machine.counterparts
            if others:
                self._compare = gui.add_checkbox(
                    f"Beside the {short_title(machine_of(others[0]))}",
                    review[Control].compare,
                    hint="The same radii, stroke, altitude and orientation; in the scene too",
                )
                answer(
                    desk,
                    self._compare,
                    lambda on, client: desk.send(SetControl("compare", on), client),
                )
            self._plot = Plot(desk, self._pointed)
            self._plotted: object = None
            self._ratios = gui.add_text(
                "Further h₂/h₁",
                _shown(review[Control].ratios),
                hint="Numbers, as 0.5, 1, 2",
            )
            answer(desk, self._ratios, self._set_ratios)
            self._comparison = gui.add_html("")

    def draw(self, sheet: Sheet) -> None:
        self._sheet = sheet
        control = sheet.view.review[Control]
        if self._compare is not None:
            put(self._desk, self._compare, control.compare)
        if _read(self._ratios.value) != control.ratios:
            put(self._desk, self._ratios, _shown(control.ratios))

    def draw_control(self, controlled: Controlled) -> None:
        self._controlled = controlled
        here, profiles = controlled.here, controlled.profiles
        put_prop(self._circles, "content", circles_html(here))
        put_prop(self._comparison, "content", comparison_html(here, controlled.beside))
        if not profiles:
            return
        compared = self._sheet.view.review[Control].compare
        drawn = tuple(p.curves for _, p in profiles), compared
        if drawn != self._plotted:
            self._plotted = drawn
            shown = profiles if compared else profiles[:1]
            named = [(short_title(machine_of(d)), p) for d, p in shown]
            self._plot.draw(loci.profile_figure(named))
        figure = self._plot.figure
        if figure is not None:
            self._plot.mark(loci.profile_mark(figure.axes, profiles[0][1].at))

    def _set_ratios(self, text: str, client: viser.ClientHandle | None) -> None:
        ratios = _read(text)
        if ratios is None:
            raise InputError("ratios are numbers with commas between them, as 0.5, 1, 2")
        self._desk.send(SetControl("ratios", ratios), client)

    def _pointed(self, x: float, _: float, client: viser.ClientHandle | None) -> None:
        """Go to the altitude that was pointed at."""
        review, controlled = self._sheet.view.review, self._controlled
        if controlled is None or not controlled.profiles or not controlled.profiles[0][1].at:
            return
        scale = abs(review.pose[0]) / controlled.profiles[0][1].at
        sign = -1.0 if review.pose[0] < 0.0 else 1.0
        self._desk.send(Move(0, sign * x * scale), client)


def specs(sheet: Sheet) -> tuple[LocusSpec, ...]:
    """The charts that stand in this tab."""
    review = sheet.view.review
    return tuple(s for s in review.machine.singularities.loci if s.key != PLANE)


def _exactness(spec: LocusSpec, curves: LocusCurves) -> str:
    count = len(curves.kinds)
    if not count:
        return "No singularity in this chart."
    worst = float(curves.residual.max(initial=0.0))
    size = f"{math.degrees(worst):.0e}°" if spec.units[0] == "rad" else f"{worst:.0e} mm"
    return f"{count} curve{'' if count == 1 else 's'}, every point exact to {size}"


def _chart_place(sheet: Sheet, spec: LocusSpec) -> tuple[float, float] | None:
    """Where the machine stands in a chart; None if it has not these coordinates."""
    review = sheet.view.review
    axes = review.machine.coordinates
    known = {c.symbol: v for c, v in zip(axes, review.pose, strict=True)}
    if not all(symbol in known for symbol in spec.axes):
        return None
    return known[spec.axes[0]], known[spec.axes[1]]


def _singular_circle(here: Here | None) -> OrientationCircle | None:
    """The circle that a singularity ends."""
    circles = () if here is None else here.circles
    return next((c for c in circles if c.limit == "parallel"), None)


def _read(text: str) -> tuple[float, ...] | None:
    try:
        return tuple(float(word) for word in text.replace(";", ",").split(",") if word.strip())
    except ValueError:
        return None


def _shown(ratios: tuple[float, ...]) -> str:
    return ", ".join(f"{ratio:g}" for ratio in ratios)
