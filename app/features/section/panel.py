"""The Section tab: the workspace cut by a plane, exactly."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

from app.features.section.compute import Sections
from app.features.section.html import (
    WINDOW_HTML,
    largest,
    mark,
    numbers_html,
    profile,
    profile_axes,
    profile_places,
)
from app.features.section.part import SectionPart
from app.features.section.plot import section_figure
from app.features.section.state import DRAWN, Cut, MoveCut, SetCut, point_in_section
from app.language import tr
from app.review.state import Review
from app.widgets.axes import nearest
from app.widgets.boxes import Slider
from app.widgets.desk import TYPED, Client, Panel, Sheet, explain
from app.widgets.icons import icon_button
from app.widgets.markup import Markup
from app.widgets.plots import Plot
from app.widgets.texts import box, red
from kinematics.answers.sections import Volume
from kinematics.machine import Machine

KINDS = ("SVG", "DXF", "CSV")
WINDOW = DRAWN, 505  # px of the drawing over the scene; workspaces are higher than wide


class SectionPanel(Panel):
    """Where the plane stands, the section as a plot and in numbers, its area along the way."""

    TITLE = "section.tab"
    TAB = "workspace.tab"

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return machine.section_spec is not None

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        part = desk.part(SectionPart)
        spec = review.machine.section_spec
        assert spec is not None
        self._spec = spec
        self.switch("section.show", Cut, "on", ("section", "X"))
        self.switch("section.clip", Cut, "clip")
        lengths = [c for c in review.machine.coordinates if c.unit == "mm"]
        # Until it is known where the workspace lies.
        self._range = (min(c.lower for c in lengths), max(c.upper for c in lengths))
        self._at = Slider(
            desk,
            f"{spec.normal} (mm)",
            *self._range,
            0.1,
            review[Cut].at,
            lambda value, client: desk.send(MoveCut(value), client),
            digits=TYPED,
        )
        self._ways = [
            self.button("section.through", self._go_through),
            self.button("section.largest", self._go_largest),
        ]
        self._window, tab = self.window(spec.title, *WINDOW, visible=review[Cut].on)
        with tab:
            gui.add_html(WINDOW_HTML)
            shut = icon_button("cancel", tr("section.close"), tr("section.close_hint"))
            Markup(desk, lambda _, who: desk.send(SetCut("on", False), who)).say(
                f'<div class="bo-shut">{shut}</div>'
            )
            self._drawing = Plot(desk, lambda _x, _y, _client: None, both=True, alone=True)
        self._numbers = gui.add_html("")
        self._begin = self.button("section.cut", self._cut)
        self._profile = Plot(desk, self._pointed)
        self._known: Sections | None = None
        self._profile_of: Volume | None = None
        self.saving(KINDS, part.save_section)
        explain(gui, "section", review.machine)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        cut, known = self.review[Cut], self._known
        low, high = min(self._range[0], cut.at), max(self._range[1], cut.at)
        self._at.draw(math.floor(low), math.ceil(high), cut.at)
        if self._profile_of is not None:
            known_volume, at = self._profile_of, cut.at
            self._profile.mark(lambda figure: mark(known_volume, figure.axes, at))
        self.see(cut.on, *self._ways)
        self.see(cut.on and known is not None and known.drawn is not None, self._window)
        self.see(not cut.on, self._begin)
        if not cut.on:
            self.say(self._numbers, box(tr("section.none_yet")))
        elif known is not None and known.trouble:
            self.say(self._numbers, red(known.trouble))
        elif known is None or known.drawn is None:
            self.say(self._numbers, box(tr("section.first")))
        else:
            drawn = known.drawn
            figure = partial(section_figure, drawn.picture)
            self._drawing.draw(drawn, figure, stale=known.stale)
            told = numbers_html(drawn.section, self._spec, drawn.extent.along)
            self.say(self._numbers, told, known.stale)

    def told(self, sheet: Sheet, news: Any) -> None:
        if not isinstance(news, Sections):
            return
        self._known, drawn = news, news.drawn
        volume = self._profile_of = news.volume or news.old_volume
        if volume is not None:
            self._profile.draw(
                volume, partial(profile, volume, self._spec), stale=news.volume is None
            )
        else:
            self._profile.draw(None)
        axes = None if news.volume is None else profile_axes(news.volume)
        if axes is not None:
            self._range = axes.x
        elif drawn is not None and not news.stale and drawn.extent.along is not None:
            self._range = drawn.extent.along  # sooner known than the volume
        self.draw(sheet)

    def _pointed(self, x: float, _: float, client: Client) -> None:
        figure = self._profile.figure
        if figure is not None:  # at what the drawing tells under the pointer
            self.desk.send(MoveCut(nearest(profile_places(figure.axes).tolist(), x)), client)

    def _cut(self, client: Client) -> None:
        self._go_through(client)
        self.desk.send(SetCut("on", True), client)

    def _go_largest(self, client: Client) -> None:
        if self._profile_of is not None:
            self.desk.send(MoveCut(round(largest(self._profile_of), 1)), client)

    def _go_through(self, client: Client) -> None:
        self.desk.send(MoveCut(point_in_section(self.review)[0]), client)
