"""The Map tab: a measure of the workspace over all orientations."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import viser

from app.features.map.compute import Charted
from app.features.map.html import FOLDED, SPANS, state_html, window_html
from app.features.map.part import MapPart
from app.features.map.plot import ends, extremes, extremes_html, figure, here, scale_of
from app.features.map.state import Chart, SetChart, Span, map_axes, refined
from app.features.move.state import Place
from app.features.section.part import SectionPart
from app.language import menu, tr
from app.review.state import Review
from app.review.units import number, page_unit
from app.widgets.axes import nearest
from app.widgets.boxes import Typed, Typing, typed_numbers
from app.widgets.desk import TYPED, Client, Panel, Sheet, explain
from app.widgets.plots import Plot
from app.widgets.texts import box, esc
from kinematics.errors import InputError
from kinematics.facets.map_sweeps import Map
from kinematics.machine import Machine
from kinematics.mechanism import Coordinate

KINDS = ("CSV", "NPZ", "PNG", "SVG")


class MapPanel(Panel):
    """What to map over which orientations, the map, and its files."""

    TITLE = "map.tab"
    TAB = "workspace.tab"

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return machine.map_spec is not None

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        part = self._part = desk.part(MapPart)
        spec = review.machine.map_spec
        assert spec is not None
        self._indices, self._axes = spec.axes, map_axes(review)
        self._titles = {q.title: q.key for q in spec.quantities}
        self.choice(
            "map.show",
            self._titles,
            lambda review: review[Chart].quantity,
            lambda key: SetChart(replace(self.review[Chart], quantity=key)),
        )
        self._typing = Typing(desk, together=True)
        self._spans = self._add_spans()
        self._start = self.button("map.start", self._begin, icon=viser.Icon.PLAYER_PLAY)
        self._stop = self.asks(
            "page.cancel", part.give_up, icon=viser.Icon.PLAYER_STOP, visible=False
        )
        self._refine = self.button("map.refine", self._about_maximum, visible=False)
        self._state = gui.add_html("")
        self._progress = gui.add_progress_bar(0.0, visible=False, animated=True)
        self._extremes_folder = gui.add_folder(tr("map.extremes"), visible=False)
        with self._extremes_folder:
            self._extremes = gui.add_html("")
            self._ways = menu("map.go")
            self._go = gui.add_button_group(tr("map.go_to"), tuple(self._ways))
        self.clicked(self._go, self._go_to)
        self._add_colours()
        self._add_window()
        self._known: Charted | None = None
        self.asks_for(
            "map.into_workspace",
            desk.part(SectionPart).go_to_ball,
        )
        self.saving(KINDS, part.save_map)
        explain(gui, "map", review.machine)

    def _add_spans(self) -> list[tuple[Typed, Typed, Typed]]:
        """A row for each coordinate: from, to, how many; as text, because boxes for numbers keep to
        themselves what is none.
        """
        gui, desk, rows = self.gui, self.desk, []
        with gui.add_folder(tr("map.over")):
            units = {page_unit(c) for c in self._axes}
            unit = f" ({units.pop()})" if len(units) == 1 else ""
            gui.add_html(f'<div class="bo-spans"></div>{SPANS}')
            heads = tr("map.from") + unit, tr("map.to") + unit, tr("map.values")
            cells = "".join(f"<i>{esc(head)}</i>" for head in ("", *heads))
            gui.add_html(f'<div class="bo-heads">{cells}</div>')
            for c in self._axes:
                gui.add_html(f'<div class="bo-axis">{esc(c.symbol)}</div>')
                span, made = Span(), []
                for part, value in ((tr("map.from"), span.low), (tr("map.to"), span.high)):
                    handle = gui.add_text(f"{c.symbol} {part}", _end(c, value))
                    made.append(Typed(desk, handle, partial(typed_end, c), partial(_end, c)))
                handle = gui.add_text(
                    f"{c.symbol} {tr('map.values')}", f"{span.count}", hint=tr("map.values_hint")
                )
                made.append(Typed(desk, handle, partial(typed_count, c), str))
                rows.append((made[0], made[1], made[2]))
        for row in rows:
            for typed in row:
                self._typing.watch(typed, self._edit)
        return rows

    def _add_colours(self) -> None:
        gui, desk = self.gui, self.desk
        with gui.add_folder(tr("map.colours"), expand_by_default=False):
            handle = gui.add_text(tr("map.range"), "", hint=tr("map.range_hint"))
            self._range = Typed(desk, handle, self._typed_range, self._shown_range)
            self.button("map.from_0", lambda client: self._colour(client, low=0.0))
            self.button("map.from_least", lambda client: self._colour(client, low=None))
            self._step = gui.add_number(tr("map.apart"), 0.0, min=0.0, hint=tr("map.apart_hint"))
            self.set(self._step, precision=TYPED)
            self._lines = self.tick("map.contours", True)
        self.answer(handle, self._take_range)
        self.answer(self._lines, lambda on, client: self._colour(client, contours=on))
        self.answer(
            self._step,
            lambda value, client: self._colour(client, step=value / self._scale()),
        )

    def _add_window(self) -> None:
        """The map over the scene, and beside the machine once a person went somewhere on it."""
        self._window, tab = self.window(tr("map.window"), *FOLDED, visible=False)
        with tab:
            self._place = self.gui.add_html("")
            self._fold = self.button("map.beside", lambda _: self.desk.ask(self._turn))
            self._plot = Plot(self.desk, self._pointed, both=True, alone=True)
        self._folded = False

    def _turn(self, folded: bool | None = None) -> None:
        """Let it cover the scene, or give way to the machine."""
        self._folded = not self._folded if folded is None else folded
        self._draw_place()

    def _draw_place(self) -> None:
        self.set(self._place, content=window_html(folded=self._folded))
        label = tr("map.over_scene" if self._folded else "map.beside")
        self.set(self._fold, label=label)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        chart = self.review[Chart]
        if not self._typing.wrong:  # what is being typed stays until it can be used
            for row, span in zip(self._spans, chart.spans, strict=True):
                for typed, value in zip(row, (span.low, span.high, span.count), strict=True):
                    typed.draw(value)
        self._range.draw((chart.colours.low, chart.colours.high))
        self.put(self._lines, chart.colours.contours)
        self.put(self._step, chart.colours.step * self._scale())
        self._draw_map()

    def told(self, sheet: Sheet, news: Any) -> None:
        if not isinstance(news, Charted):
            return
        self._known = news
        running = bool(news.running)
        self.see(running, self._progress, self._stop)
        self.see(not running, self._start)
        self.set(self._progress, value=round(100.0 * news.share, 1))
        wanted = self.review[Chart].quantity
        chosen = next(title for title, key in self._titles.items() if key == wanted)
        self.say(self._state, state_html(news, chosen))
        self._draw_map()

    def _draw_map(self) -> None:
        """The map, its extremes, and where the machine is on it."""
        news = self._known
        found = None if news is None else news.map
        there = found is not None and bool(found.done.any())
        self.see(there, self._window, self._extremes_folder)
        self._draw_place()
        if news is None or found is None or not there:
            self.see(False, self._refine)
            self._plot.draw(None)
            return
        self.see(not news.stale and found.complete, self._refine)
        colours, pose = self.review[Chart].colours, self.review.pose
        self.say(self._extremes, box(extremes_html(found, pose)), news.stale)
        of = news.of, int(found.done.sum()), found.request, news.stale, colours
        make = partial(figure, found, stale=news.stale, colours=colours)
        self._plot.draw(of, make)
        self._plot.mark(lambda drawn: here(found, drawn.axes, pose))

    def _scale(self) -> float:
        """How many of the unit that is shown a value of one is."""
        found = None if self._known is None else self._known.map
        if found is None:
            return 1.0
        return scale_of(found.request.quantities[0], ends(found)[1])[1]

    # --- what a person does

    def _edit(self, _: object, client: Client) -> None:
        """Take the spans as soon as all can be used."""
        spans = [Span(low.read(), high.read(), count.read()) for low, high, count in self._spans]
        chart = replace(self.review[Chart], first=spans[0], second=spans[1])
        self.desk.send(SetChart(chart.checked(self.review)), client)

    def _begin(self, client: Client) -> None:
        if not self._typing.wrong:  # else it stands above the button what is wrong
            self.desk.ask(self._turn, folded=False)
            self.desk.ask(self._part.begin, client)

    def _about_maximum(self, client: Client) -> None:
        found = None if self._known is None else self._known.map
        if found is not None and (place := dict(_places_of(found)).get("max")):
            self.desk.send(SetChart(refined(self.review[Chart], place)), client)
            self.desk.ask(self._part.begin, client)

    def _go_to(self, client: Client) -> None:
        found = None if self._known is None else self._known.map
        if found is not None and (place := dict(_places_of(found)).get(self._ways[self._go.value])):
            self._visit(place, client)

    def _pointed(self, x: float, y: float, client: Client) -> None:
        if self._known is None or self._known.map is None:
            return
        request = self._known.map.request
        place = tuple(  # that of the cell that is told
            nearest(known, c.inner(value))
            for c, value, known in zip(
                self._axes, (x, y), (request.first, request.second), strict=True
            )
        )
        self._visit((place[0], place[1]), client)

    def _visit(self, place: tuple[float, float], client: Client) -> None:
        """Turn the machine there, and show it."""
        pose = list(self.review.pose)
        for n, value in zip(self._indices, place, strict=True):
            pose[n] = value
        self.desk.ask(self._turn, folded=True)
        self.desk.send(Place(tuple(pose), gesture="map"), client)

    def _colour(self, client: Client, **values: Any) -> None:
        chart = self.review[Chart]
        colours = replace(chart.colours, **values)
        self.desk.send(SetChart(replace(chart, colours=colours), gesture="colours"), client)

    def _take_range(self, _: str, client: Client) -> None:
        low, high = self._range.read()
        self._colour(client, low=low, high=high)

    def _typed_range(self, text: str) -> tuple[float | None, float | None]:
        values = typed_numbers(text, tr("map.the_range"))
        if not values:
            return None, None
        if len(values) != 2:
            raise InputError(tr("map.range_wrong"))
        return values[0] / self._scale(), values[1] / self._scale()

    def _shown_range(self, ends_: tuple[float | None, float | None]) -> str:
        found = None if self._known is None else self._known.map
        if ends_ == (None, None) or found is None:
            return ""
        low, high = (
            own if end is None else end for end, own in zip(ends_, ends(found), strict=True)
        )
        return f"{number(low * self._scale())}, {number(high * self._scale())}"


def _places_of(found: Map) -> list[tuple[str, tuple[float, float]]]:
    """Where the extremes are, mm or rad."""
    request = found.request
    return [(name, (request.first[i], request.second[j])) for name, (i, j) in extremes(found)]


def _end(axis: Coordinate, value: float) -> str:
    return number(round(axis.outer(value), 6))


def typed_end(axis: Coordinate, typed: str) -> float:
    """An end of a span, mm or rad, as a person typed it.

    Raises:
        InputError: it is no number.
    """
    values = typed_numbers(typed, tr("map.an_end", axis=axis.symbol))
    if len(values) != 1:
        raise InputError(tr("map.end_wrong", axis=axis.symbol))
    return axis.inner(values[0])


def typed_count(axis: Coordinate, typed: str) -> int:
    """How many values a span has.

    Raises:
        InputError: it is no whole number.
    """
    values = typed_numbers(typed, tr("map.how_many", axis=axis.symbol))
    if len(values) != 1 or not abs(values[0]) < 1e9 or values[0] != round(values[0]):
        raise InputError(tr("map.how_many_wrong", axis=axis.symbol))
    return int(values[0])
