"""What a trajectory asks of the actuators against time: strips one above the other, one cursor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import isfinite, nan

import numpy as np

from app.features.trajectory.compute import Computed, known_distances
from app.language import tr
from app.review.units import minus, number
from app.scene import palette
from app.widgets.axes import MOST as MARKS
from app.widgets.axes import (
    ROWS,
    WHOLE,
    Axes,
    Figure,
    Look,
    Table,
    grid,
    middles,
    scales,
    thinned,
    ticks,
)
from app.widgets.svg import AREA, BAD, DIM, LOST, TAGGED, TEXT, document, heading, label, line, tag
from kinematics.arrays import Array
from kinematics.trajectories import Event, Trajectory

WIDTH = 860.0  # px: in a file, and over the scene until it is known how wide that is
LEFT, RIGHT, TOP, FOOT = 54.0, 100.0, 6.0, 24.0
STRIP, ALONE, HEAD = 78.0, 260.0, 20.0  # px: heights of one of many, of an only one, above each
ROW, COLUMN = 13.0, 80.0  # px of a value at the right
COLUMNS = 600  # places along the time of which the pointer is told
MOST = 900  # points of a curve that are drawn
FAR = 3.0  # a limit beyond so many times what is reached is not drawn: curves would be flat
CLOSE = 0.35  # of what the joints run through: an end of their strokes that is no farther is drawn
NOTHING = 1e-6  # a quantity that is smaller, in its unit, is rounding
QUIET = DIM
ORDER = ("joints", "rates", "accelerations", "forces", "distance")
MAIN = ("joints", "rates", "distance")
GROUPS = {"main": MAIN, "all": ORDER}


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """One quantity of one joint, in the page's units; NaN where there is none.

    ``times`` of its values, s. ``ends`` are those of a joint's stroke.
    """

    symbol: str
    color: str
    times: Array
    values: Array
    limit: float | None = None
    ends: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Strip:
    """A plot of several curves of one unit; with ``both`` signs a limit is one of the size."""

    title: str
    unit: str
    curves: tuple[Curve, ...]
    both: bool
    note: str = ""


def strips(computed: Computed, plot: str) -> tuple[Strip, ...]:
    """What is plotted; ``plot`` is one of `ORDER` or of `GROUPS`."""
    of, found = computed.asked, computed.found
    joints = of.machine.joints
    unit = "°" if joints[0].unit == "rad" else "mm"
    plan = of.plan
    torque = joints[0].unit == "rad"
    actuators = [n for n, name in enumerate(found.names) if name.kind == "actuation"]
    named = [(found.names[n].symbol, found.names[n].limb or 0) for n in actuators]
    forces = _curves(named, found.times, found.forces[:, actuators], plan.forces)
    near = _distance(found)
    unknown = "" if np.isfinite(near.values).any() else tr("trajectory.not_known")

    def curves(values: Array, limits: tuple[float, ...] = ()) -> tuple[Curve, ...]:
        scale = [joint.outer(1.0) for joint in joints]
        most = [v * s for v, s in zip(limits, scale, strict=False)]
        own = [(joint.symbol, joint.limb or n + 1) for n, joint in enumerate(joints)]
        return _curves(own, found.times, values * scale, most)

    ends = [None if c.free else (c.outer(c.lower), c.outer(c.upper)) for c in joints]
    placed = tuple(
        replace(curve, ends=end) for curve, end in zip(curves(found.joints), ends, strict=True)
    )
    accelerations = curves(found.joint_accelerations, plan.accelerations)
    known = {
        "joints": Strip(tr("trajectory.plots.joints"), unit, placed, both=False),
        "rates": Strip(
            tr("trajectory.plots.rates"),
            f"{unit}/s",
            curves(found.joint_rates, plan.rates),
            both=True,
        ),
        "accelerations": Strip(
            tr("trajectory.plots.accelerations"), f"{unit}/s²", accelerations, both=True
        ),
        "forces": Strip(
            tr("trajectory.torques") if torque else tr("trajectory.plots.forces"),
            "N·mm" if torque else "N",
            forces,
            both=True,
        ),
        "distance": Strip(
            tr("trajectory.plots.distance"),
            "mm",
            (near,),
            both=False,
            note=tr("trajectory.none_near") if np.isinf(found.distance).all() else unknown,
        ),
    }
    return tuple(known[key] for key in GROUPS.get(plot, (plot,)))


def _distance(found: Trajectory) -> Curve:
    """To singularities; between known places a straight line until those are known, too."""
    places, known = known_distances(found)
    times, values = found.times, np.where(np.isfinite(found.distance), found.distance, np.nan)
    if len(places):
        open_ = np.isnan(found.distance) & found.reachable
        values[open_] = np.interp(times[open_], places, known)
        more = ~np.isin(places, times)
        order = np.argsort(np.concatenate([times, places[more]]), kind="stable")
        times = np.concatenate([times, places[more]])[order]
        values = np.concatenate([values, known[more]])[order]
    return Curve("", AREA, times, values)


def _curves(
    joints: Sequence[tuple[str, int]], times: Array, values: Array, limits: Sequence[float]
) -> tuple[Curve, ...]:
    """Those of quantities, each with its symbol and its limb, 0 for none."""
    return tuple(
        Curve(
            symbol,
            palette.limb_color(limb) if limb else palette.PLATFORM,
            times,
            values[:, n],
            limits[n] if n < len(limits) else None,
        )
        for n, (symbol, limb) in enumerate(joints)
    )


# --- the drawing ---------------------------------------------------------------------------


def axes_for(shown: Sequence[Strip], duration: float, look: Look = WHOLE) -> Axes:
    """The box that holds all strips: time to the right; upwards it means nothing."""
    wide = WIDTH
    high = TOP + FOOT + len(shown) * (HEAD + (ALONE if len(shown) == 1 else STRIP))
    if look.size is not None:
        wide, high = max(look.size[0], 320.0), max(look.size[1], 160.0)
    most = max(len(strip.curves) for strip in shown)
    each = _height(len(shown), high)
    right = RIGHT + COLUMN * (math.ceil(most / max(int(each / ROW), 1)) - 1)
    x = 0.0, duration
    return Axes(wide, high, LEFT, TOP + HEAD, right, FOOT, x, (0.0, 1.0)).seen(look)


def _height(count: int, high: float) -> float:
    """px of one of so many strips in a plot of a height."""
    return (high - TOP - FOOT) / count - HEAD


def strip_axes(shown: Sequence[Strip], whole: Axes) -> list[Axes]:
    """The box of each strip, with its own range."""
    height = _height(len(shown), whole.height)
    boxes = []
    for n, strip in enumerate(shown):
        top = whole.top + n * (height + HEAD)
        bottom = whole.height - top - height
        boxes.append(replace(whole, top=top, bottom=bottom, y=_range(strip), whole=None))
    return boxes


def _range(strip: Strip) -> tuple[float, float]:
    values = [c.values[np.isfinite(c.values)] for c in strip.curves]
    flat = np.concatenate([*values, np.empty(0)])
    if not len(flat):
        return 0.0, 1.0
    if np.abs(flat).max() < NOTHING:
        return -1.0, 1.0
    # Near a singularity a quantity grows beyond all bounds: what is usual stays readable.
    low, high = float(flat.min()), float(flat.max())
    if len(flat) > 20:
        q1, q3 = np.percentile(flat, [5, 95])
        room = 4.0 * max(float(q3 - q1), 1e-12)
        low, high = max(low, float(q1) - room), min(high, float(q3) + room)
    if strip.both:
        most = max(abs(low), abs(high))
        for curve in strip.curves:
            if curve.limit is not None and curve.limit <= FAR * most:
                low = min(low, -curve.limit) if low < 0.0 else low
                high = max(high, curve.limit)
        low, high = min(low, 0.0), max(high, 0.0)
    elif _of_distance(strip):
        low = 0.0
    else:
        reach = CLOSE * max(high - low, 1e-9)
        for end in {e for c in strip.curves for e in c.ends or ()}:
            if low - reach <= end <= high + reach:
                low, high = min(low, end), max(high, end)
    room = 0.06 * max(high - low, 1e-6 * max(abs(low), abs(high)), 1e-9)
    return low - (0.0 if low == 0.0 else room), high + room


def figure(
    computed: Computed,
    plot: str,
    look: Look = WHOLE,
    *,
    legend: bool = False,
    measuring: bool = False,
) -> Figure:
    """All strips as one drawing; with a legend for who has no cursor.

    While distances come in, ``measuring``, they are left to `mark`: this drawing stays as it is,
    also under a hand that drags on it.
    """
    found, shown = computed.found, strips(computed, plot)
    whole = axes_for(shown, found.duration, look)
    content = []
    for strip, axes in zip(shown, strip_axes(shown, whole), strict=True):
        content.append(_bands(found, axes))
        if not (measuring and _of_distance(strip)):
            content.append(_strip(strip, axes, last=strip is shown[-1]))
        if legend:
            content.append(_values(strip, axes, None))
    places = middles(whole.x, COLUMNS)
    slack = float(places[1] - places[0])
    return Figure(
        whole,
        "".join(content),
        [f"t = {t:.3f} s{_told(found.events, t, slack)}" for t in places.tolist()],
        ("",),
        [""] * COLUMNS,
        tr("trajectory.point_at"),
        tr("trajectory.against_time"),
        partial(_table, shown, found.duration),
    )


def _table(shown: Sequence[Strip], duration: float) -> Table:
    """Every quantity at some times."""
    heads = ["t (s)"]
    for strip in shown:
        heads += [f"{c.symbol or strip.title.lower()} ({strip.unit})" for c in strip.curves]
    rows = []
    for t in np.linspace(0.0, duration, ROWS).tolist():
        values = (value for strip in shown for value in _at(strip, t))
        rows.append((f"{t:.3f}", *map(_value, values)))
    return heads, rows


def _strip(strip: Strip, axes: Axes, *, last: bool) -> str:
    return _frame(strip, axes, last=last) + _curve_paths(strip, axes)


def _of_distance(strip: Strip) -> bool:
    return not strip.curves[0].symbol


def mark(computed: Computed, plot: str, axes: Axes, at: float, *, measuring: bool = False) -> str:
    """The cursor where the machine is shown, and every quantity there."""
    shown = strips(computed, plot)
    boxes = strip_axes(shown, axes)
    x, _ = axes.px(at, 0.0)
    # Through the boxes only: between them stand the titles.
    cursor = "".join(f"M{x:.1f} {box.top:g}v{box.inner[1]:.1f}" for box in boxes)
    seen = axes.x[0] <= at <= axes.x[1]
    parts = [line(cursor if seen else "", TEXT, 1.2, class_="cursor")]
    events = computed.found.events
    lost = any(e.kind == "singularity" and e.start <= at <= e.end for e in events)
    for strip, box in zip(shown, boxes, strict=True):
        open_ = lost and strip.unit.startswith("N")  # no force holds the load there
        values = [nan] * len(strip.curves) if open_ else _at(strip, at)
        parts.append(_values(strip, box, values))
        if measuring and _of_distance(strip):
            parts.append(_strip(strip, box, last=strip is shown[-1]))
    return "".join(parts)


def plots_svg(computed: Computed, plot: str, title: str) -> str:
    """The plots as a file of their own."""
    drawn = figure(computed, plot, legend=True)
    a = drawn.axes
    head = label(a.left, 2, title, "start", font_size=13, font_weight=600)
    return document((a.width, a.height), head + drawn.content, paper="#FFFFFF", top=18.0)


def _at(strip: Strip, at: float) -> list[float]:
    return [float(np.interp(at, curve.times, curve.values)) for curve in strip.curves]


def _values(strip: Strip, axes: Axes, values: Sequence[float] | None) -> str:
    """The curves' names with chips in their colours, right of the box, the largest first: by their
    values if given, else by those at the end.
    """
    high = axes.inner[1]
    rows = max(int(high / ROW), 1)
    last = [c.values[np.isfinite(c.values)][-1:].sum() for c in strip.curves]
    sizes = [-v if isfinite(v) else math.inf for v in (last if values is None else values)]
    parts = []
    for place, n in enumerate(sorted(range(len(sizes)), key=sizes.__getitem__)):
        curve = strip.curves[n]
        x = axes.width - axes.right + 12 + COLUMN * (place // rows)
        y = axes.top + ROW * (place % rows) + 9
        if curve.symbol or values is not None:
            parts.append(tag("rect", x=x, y=y - 7.5, width=7, height=7, rx=1, fill=curve.color))
            parts.append(label(x + 11, y, curve.symbol, "start", fill=DIM))
        if values is not None:
            parts.append(label(x + COLUMN - 10, y, _value(values[n]), "end", fill=TEXT))
    return tag("g", "".join(parts), class_="values")


def _value(value: float) -> str:
    if not isfinite(value):
        return "–"
    size = abs(value)
    text = f"{value:.0f}" if size >= 1000 else f"{value:.1f}" if size >= 10 else f"{value:.2f}"
    return minus(text.removeprefix("-" if not float(text) else ""))


def _curve_paths(strip: Strip, axes: Axes) -> str:
    paths = []
    for curve in strip.curves:
        kept = thinned(len(curve.times), MOST)
        path = _runs(curve.times[kept], curve.values[kept], axes)
        paths.append(line(path, curve.color, 1.8, class_="curve", stroke_linejoin="round"))
    names = []
    for value, (name, color) in _limits(strip).items():
        if axes.y[0] <= value <= axes.y[1]:
            v = axes.px(0.0, value)[1]
            path = f"M{axes.left:g} {v:.1f}h{axes.inner[0]:g}"
            paths.append(line(path, color, 1.2, class_="limit", stroke_dasharray="5 3"))
            low = v - 3 if v - 12 > axes.top else v + 11
            look = {"fill": BAD, "font_size": 10, **TAGGED}
            names.append(label(axes.left + 4, low, name, "start", **look))
    return axes.clipped("".join([*paths, *names]))


def _limits(strip: Strip) -> dict[float, tuple[str, str]]:
    """What bounds a strip: its name and colour; what is of all curves has no limb's."""
    found: dict[float, list[tuple[str, str, str]]] = {}
    for curve in strip.curves:
        given = [("min", curve.ends[0]), ("max", curve.ends[1])] if curve.ends else []
        if curve.limit is not None:
            given += [("max", curve.limit)] + [("max", -curve.limit)] * strip.both
        for which, value in given:
            found.setdefault(round(value, 9), []).append((curve.symbol, which, curve.color))
    told = {}
    for value, of in found.items():
        symbol, which, color = of[0]
        every = len(of) == len(strip.curves)
        symbol = symbol.rstrip("₀₁₂₃₄₅₆₇₈₉") if every else symbol
        told[value] = f"{symbol} {which} {number(value)}", LOST if every else color
    return told


def _runs(times: Array, values: Array, axes: Axes) -> str:
    """A curve as a path, with its gaps; far outside of the box it is cut."""
    span = axes.y[1] - axes.y[0]
    near = np.clip(values, axes.y[0] - span, axes.y[1] + span)
    known = np.isfinite(values)
    edges = np.flatnonzero(np.diff(np.pad(known.astype(int), 1)))
    return "".join(
        axes.path(zip(times[a:b].tolist(), near[a:b].tolist(), strict=True))
        for a, b in edges.reshape(-1, 2).tolist()
    )


def _bands(found: Trajectory, axes: Axes) -> str:
    """Where on the way something is wrong: red-orange, grey where it is only near."""
    parts = []
    for event in found.events:
        color = QUIET if event.kind == "near" else LOST
        x0, x1 = (axes.px(t, 0.0)[0] for t in (event.start, event.end))
        place = {"x": x0, "y": axes.top, "width": max(x1 - x0, 1.6), "height": axes.inner[1]}
        opacity = 0.85 if x1 - x0 < 1.6 else 0.12
        parts.append(tag("rect", class_="event", **place, fill=color, fill_opacity=opacity))
    return axes.clipped("".join(parts))


def _frame(strip: Strip, axes: Axes, *, last: bool) -> str:
    wide, high = axes.inner
    levels, times = _levels(axes.y, max(2, min(5, int(high / 22)))), ticks(*axes.x, MARKS)
    middle = axes.left + wide / 2, axes.top + high / 2 + 4
    low = axes.top + high
    return (
        grid(axes, (), levels)
        + scales(axes, "", "", times, levels, (number if last else None, _tick))
        + heading(axes.left, axes.top - 6, strip.title, strip.unit)
        + label(axes.left - 14, low + 15, "t (s)" if last else "", "end", fill=DIM)
        + label(*middle, strip.note, fill=DIM)
    )


def _levels(span: tuple[float, float], most: int) -> list[float]:
    """Round numbers that are marked, two at least: one alone tells no scale."""
    found = ticks(*span, most)
    while len(found) < 2 and most < 10:
        most += 1
        found = ticks(*span, most)
    return found


def _tick(value: float) -> str:
    return number(value / 1000.0) + "k" if abs(value) >= 1e4 else number(value)


def _told(events: Sequence[Event], t: float, slack: float) -> str:
    kinds = {e.kind: None for e in events if e.start - slack <= t <= e.end + slack}
    return "".join(f" · {tr(f'trajectory.events.{kind}')}" for kind in kinds)
