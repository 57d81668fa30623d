"""The Map tab: a measure of the workspace over all orientations."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from typing import Any

import viser

from app.features.map.compute import Charted
from app.features.map.part import MapPart
from app.features.map.plot import extremes_text, figure
from app.features.map.state import Chart, SetChart, Span, map_axes
from app.features.move.state import Place
from app.features.section.part import SectionPart
from app.review.state import Review
from app.review.units import number, page_unit
from app.widgets.axes import cross, nearest
from app.widgets.boxes import Typed, Typing
from app.widgets.desk import Client, Panel, Sheet, explain
from app.widgets.plots import Plot
from app.widgets.texts import box, esc, red
from kinematics.errors import InputError
from kinematics.machine import Machine
from kinematics.mechanism import Coordinate

KINDS = ("CSV", "NPZ", "PNG", "SVG")
HINT = "Three numbers; both ends are included, and more values take longer"

HELP = """
Each cell is computed from exact
sections; the errors are bounds, not guesses. It is drawn coarse first and refined cell by cell.

The **cross** is the machine's present orientation. **Point** at the map to read it; **click or
drag** to turn the machine there: x, y and z stay, so the pose may be out of reach, and undo takes
it back. A map is of one design and one choice of working modes (Workspace tab); when either
changes it stays, faded, until the next one. What was computed over the same ranges is kept: choose
it under Show to see it again. Save as saves what is shown.
"""


class MapPanel(Panel):
    """What to map over which orientations, the map, and its files."""

    TITLE = "Map"
    TAB = "Workspace"

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
            "Show",
            self._titles,
            lambda review: review[Chart].quantity,
            lambda key: SetChart(replace(self.review[Chart], quantity=key)),
        )
        self._typing = Typing(desk, together=True)
        self._spans = []
        for c in self._axes:
            title = f"{c.symbol} from, to ({page_unit(c)}), values"
            handle = gui.add_text(title, shown(c, Span()), hint=HINT)
            # Text, because number boxes keep to themselves what is no number.
            self._spans.append(Typed(desk, handle, partial(typed_span, c), partial(shown, c)))
        for typed in self._spans:
            self._typing.watch(typed, self._edit)
        self._start = self.button("Start", self._begin, icon=viser.Icon.PLAYER_PLAY)
        self._stop = self.asks("Cancel", part.give_up, icon=viser.Icon.PLAYER_STOP, visible=False)
        self._state = gui.add_html("")
        self._progress = gui.add_progress_bar(0.0, visible=False, animated=True)
        self._plot = Plot(desk, self._pointed, both=True)
        self._extremes = gui.add_html("")
        self._known: Charted | None = None
        self.asks_for(
            "Platform into the workspace",
            desk.part(SectionPart).go_to_ball,
            hint="To the centre of the largest ball inside it, at the present orientation; flips "
            "limbs where that is needed",
        )
        self.saving(KINDS, part.save_map)
        explain(gui, review.machine.text("map"), HELP)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        if not self._typing.wrong:  # what is being typed stays until it can be used
            for typed, span in zip(self._spans, self.review[Chart].spans, strict=True):
                typed.draw(span)
        self._draw_cross()

    def told(self, sheet: Sheet, news: Any) -> None:
        if not isinstance(news, Charted):
            return
        running = bool(news.running)
        self.see(running, self._progress, self._stop)
        self.see(not running, self._start)
        self.set(self._progress, value=round(100.0 * news.share, 1))
        wanted = self.review[Chart].quantity
        chosen = next(title for title, key in self._titles.items() if key == wanted)
        self.say(self._state, state_html(news, chosen))
        self._known, found = news, news.map
        told = "" if found is None else extremes_text(found)
        self.say(self._extremes, box(esc(told).replace("\n", "<br>")) if told else "", news.stale)
        if found is None:
            self._plot.draw(None)
        else:
            of = news.of, int(found.done.sum()), found.request, news.stale
            self._plot.draw(of, partial(figure, found, stale=news.stale))
        self._draw_cross()

    def _draw_cross(self) -> None:
        pose = self.review.pose
        x, y = (c.outer(pose[n]) for c, n in zip(self._axes, self._indices, strict=True))
        self._plot.mark(lambda figure: cross(figure.axes, x, y, 8.0))

    def _edit(self, _: Span, client: Client) -> None:
        """Take the spans as soon as all can be used."""
        spans = [typed.read() for typed in self._spans]
        self.desk.send(
            SetChart(Chart(self.review[Chart].quantity, *spans).checked(self.review)), client
        )

    def _begin(self, client: Client) -> None:
        if not self._typing.wrong:  # else it stands above the button what is wrong
            self.desk.ask(self._part.begin, client)

    def _pointed(self, x: float, y: float, client: Client) -> None:
        if self._known is None or self._known.map is None:
            return
        request = self._known.map.request
        pose = list(self.review.pose)
        for n, c, value, known in zip(
            self._indices, self._axes, (x, y), (request.first, request.second), strict=True
        ):
            pose[n] = nearest(known, c.inner(value))  # that of the cell that is told
        self.desk.send(Place(tuple(pose), gesture="map"), client)


def shown(axis: Coordinate, span: Span) -> str:
    """A span as it can be typed: "-90, 90, 37"."""
    low, high = (number(round(axis.outer(v), 6)) for v in (span.low, span.high))
    return f"{low}, {high}, {span.count}"


def typed_span(axis: Coordinate, typed: str) -> Span:
    """What a person typed: three numbers, with commas, semicolons or spaces between them.

    Raises:
        InputError: it is something else.
    """
    words = re.split(r"[\s,;…]+", typed.strip().replace("−", "-"))
    try:
        low, high, count = map(float, words)
    except ValueError:
        raise InputError(
            f"{axis.symbol} needs three numbers: from, to, and how many values, as "
            f"{shown(axis, Span())}"
        ) from None
    if not abs(count) < 1e9 or count != round(count):
        raise InputError(f"how many values of {axis.symbol} is a whole number")
    return Span(axis.inner(low), axis.inner(high), int(count))


def state_html(charted: Charted, chosen: str) -> str:
    """What the plot shows, and what is going on; ``chosen`` is the title of what is wanted."""
    if charted.running:
        done = f"{100 * charted.share:.0f} %" if charted.share else "starting …"
        what = "" if charted.running == chosen else f" {esc(charted.running)},"
        return box(f"Computing:{what} {done} · {charted.seconds:.0f} s{_other(charted, chosen)}")
    if charted.trouble:
        return red(charted.trouble)
    if charted.map is None or not charted.map.done.any():
        return box("Nothing is computed yet: choose what to show and start it.")
    share = 100 * charted.map.done.mean()
    if charted.stale:
        part = "" if charted.map.complete else f" It was stopped at {share:.0f} %."
        return box(
            f"<b>Of the design or working modes before.</b>{part} Press Start for the present."
        )
    if other := _other(charted, chosen):
        return box(f"{other} Press Start for {esc(_lower(chosen))}.")
    if not charted.map.complete:
        return box(f"Stopped at {share:.0f} % of the map; press Start to compute it whole.")
    return ""


def _other(charted: Charted, chosen: str) -> str:
    """A sentence when the plot shows something else than what is chosen."""
    if charted.map is None or not charted.map.done.any():
        return ""
    shown = charted.map.request.quantities[0].title
    return "" if shown == chosen else f" <b>Shown: {esc(_lower(shown))}.</b>"


def _lower(title: str) -> str:
    return title[0].lower() + title[1:]
