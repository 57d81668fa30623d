"""The Map tab: a measure of the workspace over all orientations."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import viser
from scipy.ndimage import distance_transform_edt

from app.features.map.state import Chart, SetChart, Span
from app.features.move.state import Place
from app.review.requests import GoToBall, SaveMap, StartMap, StopMap
from app.review.units import from_page_units, in_page_units, page_unit
from app.scene import palette
from app.widgets.boxes import SpanBox
from app.widgets.desk import (
    Charted,
    Desk,
    Panel,
    Sheet,
    answer,
    box,
    button,
    clicked,
    esc,
    explain,
    put,
    put_prop,
    red,
    volume_text,
    with_error,
)
from app.widgets.plots import STEPS, TURN, Axes, Figure, Plot, nearest, number, scales, ticks
from kinematics.answers.sections import Quantity
from kinematics.errors import InputError
from kinematics.facets.map_sweeps import Map
from kinematics.machine import Machine
from kinematics.mechanism import Coordinate

KINDS = ("CSV", "NPZ", "PNG", "SVG")
SHADES = 48

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

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        self._desk = desk
        self._sheet = sheet
        spec = review.machine.map_spec
        assert spec is not None
        self._spec = spec
        known = review.machine.coordinates
        self._axes = tuple(known[n] for n in self._spec.axes)
        self._titles = {q.title: q.key for q in self._spec.quantities}
        self._quantity = gui.add_dropdown(
            "Show", tuple(self._titles), initial_value=self._title(review[Chart].quantity)
        )
        answer(desk, self._quantity, self._choose)
        self._spans = [
            SpanBox(desk, c, span, self._edit)
            for c, span in zip(self._axes, _spans(review[Chart]), strict=True)
        ]
        self._wrong = gui.add_html("", visible=False)
        self._start = button(desk, "Start", self._begin, icon=viser.Icon.PLAYER_PLAY)
        self._stop = button(
            desk, "Cancel", lambda _: desk.ask(StopMap()), icon=viser.Icon.PLAYER_STOP
        )
        self._stop.visible = False
        self._state = gui.add_html("")
        self._progress = gui.add_progress_bar(0.0, visible=False, animated=True)
        self._plot = Plot(desk, self._pointed)
        self._drawn: object = None
        self._found: Map | None = None
        button(
            desk,
            "Platform into the workspace",
            lambda client: desk.ask(GoToBall(client)),
            hint="To the centre of the largest ball inside it, at the present orientation; flips "
            "limbs where that is needed",
        )
        self._save = gui.add_button_group("Save as", KINDS)
        clicked(desk, self._save, self._saved)
        explain(gui, review.machine.text("map"), HELP)

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return machine.map_spec is not None

    def draw(self, sheet: Sheet) -> None:
        self._sheet = sheet
        review = sheet.view.review
        put(self._desk, self._quantity, self._title(review[Chart].quantity))
        if not self._wrong.visible:  # what is being typed stays until it can be used
            for typed, span in zip(self._spans, _spans(review[Chart]), strict=True):
                typed.draw(span)
        self._draw_cross()

    def draw_map(self, sheet: Sheet, charted: Charted) -> None:
        running = bool(charted.running)
        put_prop(self._progress, "visible", running)
        put_prop(self._progress, "value", round(100.0 * charted.share, 1))
        put_prop(self._start, "visible", not running)
        put_prop(self._stop, "visible", running)
        chosen = self._title(sheet.view.review[Chart].quantity)
        put_prop(self._state, "content", _state(charted, chosen))
        found = self._found = charted.map
        drawn = None if found is None else (charted.of, int(found.done.sum()), charted.stale)
        if drawn != self._drawn:
            self._drawn = drawn
            self._plot.draw(None if found is None else figure(found, stale=charted.stale))
            self._draw_cross()

    def _draw_cross(self) -> None:
        axes = None if self._plot.figure is None else self._plot.figure.axes
        pose = self._sheet.view.review.pose
        x, y = (in_page_units(c, pose[n]) for c, n in zip(self._axes, self._spec.axes, strict=True))
        if axes is None or not (axes.x[0] <= x <= axes.x[1] and axes.y[0] <= y <= axes.y[1]):
            self._plot.mark("")
            return
        u, v = axes.px(x, y)
        path = f"M{u - 8:.1f} {v:.1f}h16M{u:.1f} {v - 8:.1f}v16"
        self._plot.mark(
            f'<path class="here" d="{path}" stroke="#FFFFFF" stroke-width="4.5"/>'
            f'<path d="{path}" stroke="#101418" stroke-width="2"/>'
        )

    def _title(self, key: str) -> str:
        return next(title for title, known in self._titles.items() if known == key)

    def _choose(self, title: str, client: viser.ClientHandle | None) -> None:
        review = self._sheet.view.review
        self._desk.send(SetChart(replace(review[Chart], quantity=self._titles[title])), client)

    def _edit(self, _: Any, client: viser.ClientHandle | None) -> None:
        """Take the spans as soon as they can be used; until then say what is wrong with them."""
        review = self._sheet.view.review
        try:
            first, second = (typed.read() for typed in self._spans)
            chart = Chart(review[Chart].quantity, first, second).checked(review)
        except InputError as error:
            put_prop(self._wrong, "content", red(_sentence(str(error))))
            put_prop(self._wrong, "visible", True)
            return
        put_prop(self._wrong, "visible", False)
        self._desk.send(SetChart(chart), client)

    def _begin(self, client: viser.ClientHandle | None) -> None:
        if not self._wrong.visible:  # else it stands above the button what is wrong
            self._desk.ask(StartMap(client))

    def _pointed(self, x: float, y: float, client: viser.ClientHandle | None) -> None:
        review = self._sheet.view.review
        if self._found is None:
            return
        request = self._found.request
        pose = list(review.pose)
        for n, c, value, known in zip(
            self._spec.axes, self._axes, (x, y), (request.first, request.second), strict=True
        ):
            pose[n] = nearest(known, from_page_units(c, value))  # that of the cell that is told
        self._desk.send(Place(tuple(pose), gesture="map"), client)

    def _saved(self, client: viser.ClientHandle | None) -> None:
        self._desk.ask(SaveMap(self._save.value.lower(), client))


def _spans(chart: Chart) -> tuple[Span, Span]:
    return chart.first, chart.second


def _sentence(text: str) -> str:
    """With a capital and a full stop; a symbol at its head stays what it is."""
    head = text[0].upper() if text[0].isascii() else text[0]
    return head + text[1:].rstrip(".") + "."


def _state(charted: Charted, chosen: str) -> str:
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


# --- the drawing --------------------------------------------------------------------------


def figure(found: Map, *, stale: bool) -> Figure:
    """A map as a drawing: a cell for each point, in the page's units."""
    quantity = found.request.quantities[0]
    first, second = found.request.coordinates
    x, y = (
        np.array([in_page_units(c, v) for v in given])
        for c, given in ((first, found.request.first), (second, found.request.second))
    )
    axes = Axes(400, 342, 46, 24, 74, 38, _ends(x), _ends(y))
    values, errors = found.values[0], found.errors[0]
    known = np.isfinite(values)
    top = _top(quantity, values[known])
    content = ""
    if known.any():
        # Where nothing was computed yet stands the nearest that was.
        where = distance_transform_edt(~known, return_distances=False, return_indices=True)
        content = _cells(axes, values[tuple(where)] / top)
        content += _bar(axes, quantity, top)
    grid = scales(
        axes,
        f"{first.symbol} ({page_unit(first)})",
        f"{second.symbol} ({page_unit(second)})",
        _axis_ticks(first, axes.x),
        _axis_ticks(second, axes.y),
    )
    return Figure(
        axes,
        f'<g class="map"{" opacity=" + chr(34) + ".35" + chr(34) if stale else ""}>{content}'
        f"</g>{grid}",
        [f"{first.symbol} {_places(v)}{page_unit(first)}, " for v in x.tolist()],
        [f"{second.symbol} {_places(v)}{page_unit(second)}: " for v in y.tolist()],
        [
            told(quantity, v, e) if ok else "not computed yet"
            for v, e, ok in zip(
                values.ravel().tolist(),
                errors.ravel().tolist(),
                known.ravel().tolist(),
                strict=True,
            )
        ],
        f"{quantity.title}: point to read, click to turn the machine there",
        f"Map of {quantity.title}",
    )


def told(quantity: Quantity, value: float, error: float) -> str:
    """A value with its error, in the unit that reads best."""
    if quantity.unit == "mm³":
        return volume_text(value, error)
    if not quantity.unit:
        return f"{value:.0f}"
    if error <= 0.0:
        return f"{value:.4g} {quantity.unit}"
    return f"{with_error(value, error, 6)} {quantity.unit}"


def _places(value: float) -> str:
    return f"{value + 0.0:.1f}".replace("-", "−")


def _ends(values: np.ndarray) -> tuple[float, float]:
    """The ends of cells about evenly spaced values."""
    half = 0.5 * (values[-1] - values[0]) / (len(values) - 1)
    return float(values[0] - half), float(values[-1] + half)


def _axis_ticks(c: Coordinate, ends: tuple[float, float]) -> list[float]:
    return ticks(*ends, 7, TURN if c.unit == "rad" else STEPS)


def _top(quantity: Quantity, values: np.ndarray) -> float:
    """The end of the colours; they begin at zero."""
    if quantity.unit == "%":
        return 100.0
    return max(float(values.max(initial=0.0)), 1e-9)


def _cells(axes: Axes, shares: np.ndarray) -> str:
    """One path for each shade; neighbours upwards of one shade are one rectangle."""
    columns, rows = shares.shape
    wide, high = axes.inner[0] / columns, axes.inner[1] / rows
    shades = np.clip(np.rint(shares * (SHADES - 1)), 0, SHADES - 1).astype(int)
    paths: dict[int, list[str]] = {}
    for column in range(columns):
        breaks = np.flatnonzero(np.diff(shades[column])) + 1
        for start, end in zip([0, *breaks], [*breaks, rows], strict=True):
            x, y = axes.left + column * wide, axes.top + (rows - end) * high
            if not shares[column, start:end].any():
                continue  # an empty workspace has no colour
            paths.setdefault(int(shades[column, start]), []).append(
                f"M{x:.2f} {y:.2f}h{wide:.2f}v{(end - start) * high:.2f}h{-wide:.2f}z"
            )
    return "".join(
        f'<path fill="{palette.ramp_color(n / (SHADES - 1))}" shape-rendering="crispEdges" '
        f'd="{"".join(path)}"/>'
        for n, path in sorted(paths.items())
    )


def _bar(axes: Axes, quantity: Quantity, top: float) -> str:
    """The colours with what they stand for."""
    unit, scale = str(quantity.unit), 1.0
    if quantity.unit == "mm³":
        unit, scale = ("dm³", 1e-6) if top >= 1e5 else ("cm³", 1e-3)
    left, high = axes.width - axes.right + 14.0, axes.inner[1]
    step = high / SHADES
    parts = [
        f'<rect x="{left:g}" y="{axes.top + (SHADES - 1 - n) * step:.2f}" width="13" '
        f'height="{step + 0.3:.2f}" fill="{palette.ramp_color(n / (SHADES - 1))}"/>'
        for n in range(SHADES)
    ]
    for value in ticks(0.0, top * scale, 6):
        y = axes.top + high * (1.0 - value / (top * scale))
        parts.append(
            f'<path d="M{left + 13:g} {y:.1f}h4" stroke="currentColor" stroke-opacity=".6"/>'
            f'<text x="{left + 19:g}" y="{y + 3.8:.1f}" fill="currentColor">{number(value)}</text>'
        )
    if unit:
        parts.append(
            f'<text x="{left:g}" y="{axes.top - 7:g}" fill="currentColor">{esc(unit)}</text>'
        )
    return "".join(parts)
