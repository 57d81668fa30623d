"""Curves in the Singularities tab: singular ones, and radii of circles over the altitude."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

from app.features.move.state import Move, Place
from app.features.singularities import plot as loci
from app.features.singularities.compute import Controlled, Here
from app.features.singularities.html import circles_html, comparison_html, exactness
from app.features.singularities.part import ControlPart
from app.features.singularities.state import Control, SetControl
from app.language import tr
from app.review.state import Review
from app.review.units import number
from app.review.view import short_title
from app.widgets.axes import Figure
from app.widgets.boxes import Typed, typed_numbers
from app.widgets.desk import Client, Group, Sheet
from app.widgets.plots import Plot
from app.widgets.texts import box, esc
from kinematics.answers.circles import OrientationCircle
from kinematics.answers.loci import LocusSpec
from kinematics.machine import Machine, machine_of

PLANE = "section"
"""The chart of what lies in the plane of a section, which is drawn there."""


class ChartFolder(Group):
    """The singular curves of a chart, and beside them those of the counterpart."""

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        part = desk.part(ControlPart)
        titles = {spec.title: spec.key for spec in specs(review.machine)}
        with gui.add_folder(tr("singularities.curves")):
            self.menu("singularities.chart", {tr("page.nothing"): ""} | titles, Control, "chart")
            self._plot = Plot(desk, self._pointed, both=True)
            self._plot_beside = Plot(desk, self._pointed, both=True)
            self._named_beside = gui.add_html("")
            self._curves = gui.add_html("")
            self._save = self.saving(("CSV", "SVG"), part.save_curves)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self._draw_cross()

    def told(self, sheet: Sheet, news: Any) -> None:
        if not isinstance(news, Controlled):
            return
        spec, curves, stale = self._spec(), news.curves, news.curves_stale
        self.set(self._save, visible=curves is not None and not stale)
        told = ""
        if spec is not None and curves is not None:
            circle = None if stale else _singular_circle(news.here)
            leads = _chart_place(self.review, spec) is not None
            figure = partial(loci.figure, spec, curves, circle, leads=leads)
            self._plot.draw((curves, circle), figure, stale=stale)
            told = box(exactness(spec, curves))
        else:
            self._plot.draw(None)
            told = "" if spec is None else box(tr("singularities.tracing"))
        self.say(self._curves, told, stale)
        self._draw_beside(spec, news)
        self._draw_cross()

    def _draw_beside(self, spec: LocusSpec | None, news: Controlled) -> None:
        curves, beside = news.curves_beside, self.sheet.view.beside
        if spec is None or curves is None or beside is None:
            self._plot_beside.draw(None)
            self.say(self._named_beside, "")
            return
        circle = _singular_circle(news.beside)
        self._plot_beside.draw((curves, circle), partial(loci.figure, spec, curves, circle))
        title = esc(short_title(machine_of(beside.design)))
        self.say(self._named_beside, box(tr("singularities.beside_above", machine=title)))

    def _draw_cross(self) -> None:
        spec = self._spec()
        at = None if spec is None else _chart_place(self.review, spec)
        for plot in (self._plot, self._plot_beside):
            if spec is None or at is None:
                plot.mark()
            else:
                plot.mark(partial(_cross, spec, at))

    def _spec(self) -> LocusSpec | None:
        chart = self.review[Control].chart
        return next((s for s in specs(self.review.machine) if s.key == chart), None)

    def _pointed(self, x: float, y: float, client: Client) -> None:
        spec, review = self._spec(), self.review
        if spec is None or _chart_place(review, spec) is None:
            return
        symbols = [c.symbol for c in review.machine.coordinates]
        pose = list(review.pose)
        for symbol, value in zip(spec.axes, loci.from_units(spec, x, y), strict=True):
            pose[symbols.index(symbol)] = value
        self.desk.send(Place(tuple(pose), gesture=f"chart {spec.key}"), client)


class ProfileFolder(Group):
    """The largest circle of orientations: here, over the altitude, and of the counterpart."""

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        self._known: Controlled | None = None
        with gui.add_folder(tr("singularities.circles")):
            self._circles = gui.add_html("")
            for other in review.machine.counterparts[:1]:
                label = tr("singularities.beside", machine=short_title(machine_of(other)))
                beside = gui.add_checkbox(label, False, hint=tr("singularities.beside_hint"))
                self.field(beside, Control, "compare")
            self._plot = Plot(desk, self._pointed)
            text = gui.add_text(
                tr("singularities.ratios"), "", hint=tr("singularities.ratios_hint")
            )
            read = partial(typed_numbers, what=tr("singularities.the_ratios"))
            self._ratios = Typed(desk, text, read, lambda value: ", ".join(map(number, value)))
            self.answer(text, self._set_ratios)
            self._comparison = gui.add_html("")

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self._ratios.draw(self.review[Control].ratios)

    def told(self, sheet: Sheet, news: Any) -> None:
        if not isinstance(news, Controlled):
            return
        self._known = news
        self.say(self._circles, circles_html(news.here), news.stale)
        self.say(self._comparison, comparison_html(news.here, news.beside), news.stale)
        profiles = news.profiles
        if not self.review[Control].compare:
            profiles = profiles[:1]
        named = [(short_title(machine_of(d)), p) for d, p in profiles]
        of = tuple(p.curves for _, p in profiles) or None
        self._plot.draw(of, partial(loci.profile_figure, named))
        at = profiles[0][1].at if profiles else math.inf
        self._plot.mark(lambda figure: loci.profile_mark(figure.axes, at))

    def _set_ratios(self, _: str, client: Client) -> None:
        self.desk.send(SetControl("ratios", self._ratios.read()), client)

    def _pointed(self, x: float, _: float, client: Client) -> None:
        """Go to the altitude that was pointed at."""
        altitude = self.review.pose[0]
        known = () if self._known is None else self._known.profiles
        for _design, profile in known[:1]:
            if profile.at:
                sign = -1.0 if altitude < 0.0 else 1.0
                self.desk.send(Move(0, sign * x * abs(altitude) / profile.at), client)


def specs(machine: Machine[Any]) -> tuple[LocusSpec, ...]:
    """The charts that stand in this tab."""
    return tuple(s for s in machine.singularities.loci if s.key != PLANE)


def _cross(spec: LocusSpec, at: tuple[float, float], figure: Figure) -> str:
    return loci.mark(spec, figure.axes, at)


def _chart_place(review: Review, spec: LocusSpec) -> tuple[float, float] | None:
    """Where the machine stands in a chart; None if it has not these coordinates."""
    axes = review.machine.coordinates
    known = {c.symbol: v for c, v in zip(axes, review.pose, strict=True)}
    if not all(symbol in known for symbol in spec.axes):
        return None
    return known[spec.axes[0]], known[spec.axes[1]]


def _singular_circle(here: Here | None) -> OrientationCircle | None:
    """The circle that a singularity ends."""
    circles = () if here is None else here.circles
    return next((c for c in circles if c.limit == "parallel"), None)
