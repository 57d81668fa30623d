"""What a trajectory asks of the actuators against time: strips one above the other, one cursor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan

import numpy as np

from app.features.trajectory.compute import Computed, known_distances
from app.review.units import minus, number
from app.scene import palette
from app.widgets.axes import Axes, Figure, grid, scales, thinned, ticks
from app.widgets.svg import document, label, line, tag
from app.widgets.texts import esc
from kinematics.arrays import Array
from kinematics.trajectories import Event, Trajectory

WIDTH, NARROW = 430.0, 380.0  # px: in a file, and beside the scene
LEFT, RIGHT, TOP, FOOT = 54.0, 18.0, 20.0, 36.0
STRIP, ALONE, HEAD = 65.0, 300.0, 20.0  # px: heights of one of many, of an only one, above each
COLUMNS = 366  # places along the time of which the pointer is told, one a pixel
MOST = 700  # points of a curve that are drawn
FAR = 3.0  # a limit beyond so many times what is reached is not drawn: curves would be flat
NOTHING = 1e-6  # a quantity that is smaller, in its unit, is rounding
QUIET = "#6B7683"
ORDER = ("joints", "rates", "accelerations", "forces", "distance")


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """One quantity of one joint, in the page's units; NaN where there is none.

    ``times`` of its values, s.
    """

    symbol: str
    color: str
    times: Array
    values: Array
    limit: float | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Strip:
    """A plot of several curves of one unit; with ``both`` signs a limit is one of the size."""

    title: str
    curves: tuple[Curve, ...]
    both: bool
    note: str = ""


def strips(computed: Computed, plot: str) -> tuple[Strip, ...]:
    """What is plotted; ``plot`` is one of `ORDER`, or "all"."""
    of, found = computed.asked, computed.found
    joints = of.machine.joints
    unit = "°" if joints[0].unit == "rad" else "mm"
    plan = of.plan
    torque = joints[0].unit == "rad"
    actuators = [n for n, name in enumerate(found.names) if name.kind == "actuation"]
    named = [(found.names[n].symbol, found.names[n].limb or 0) for n in actuators]
    forces = _curves(named, found.times, found.forces[:, actuators], plan.forces)
    near = _distance(found)
    unknown = "" if np.isfinite(near.values).any() else "not known yet"

    def curves(values: Array, limits: tuple[float, ...] = ()) -> tuple[Curve, ...]:
        scale = [joint.outer(1.0) for joint in joints]
        most = [v * s for v, s in zip(limits, scale, strict=False)]
        own = [(joint.symbol, joint.limb or n + 1) for n, joint in enumerate(joints)]
        return _curves(own, found.times, values * scale, most)

    accelerations = curves(found.joint_accelerations, plan.accelerations)
    known = {
        "joints": Strip(f"joints ({unit})", curves(found.joints), both=False),
        "rates": Strip(f"rates ({unit}/s)", curves(found.joint_rates, plan.rates), both=True),
        "accelerations": Strip(f"accelerations ({unit}/s²)", accelerations, both=True),
        "forces": Strip("torques (N·mm)" if torque else "forces (N)", forces, both=True),
        "distance": Strip(
            "to a singularity (mm)",
            (near,),
            both=False,
            note="none on the way" if np.isinf(found.distance).all() else unknown,
        ),
    }
    return tuple(known[key] for key in (ORDER if plot == "all" else (plot,)))


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
    return Curve("", palette.WORKSPACE_DEEP, times, values)


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


def axes_for(shown: Sequence[Strip], duration: float, width: float = WIDTH) -> Axes:
    """The box that holds all strips: time to the right; upwards it means nothing."""
    height = ALONE if len(shown) == 1 else STRIP
    inner = len(shown) * (height + HEAD)
    return Axes(width, TOP + inner + FOOT, LEFT, TOP, RIGHT, FOOT, (0.0, duration), (0.0, 1.0))


def strip_axes(shown: Sequence[Strip], whole: Axes) -> list[Axes]:
    """The box of each strip, with its own range."""
    height = ALONE if len(shown) == 1 else STRIP
    boxes = []
    for n, strip in enumerate(shown):
        top = whole.top + n * (height + HEAD) + HEAD
        bottom = whole.height - top - height
        y = _range(strip)
        boxes.append(Axes(whole.width, whole.height, LEFT, top, RIGHT, bottom, whole.x, y))
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
    room = 0.06 * max(high - low, 1e-6 * max(abs(low), abs(high)), 1e-9)
    return low - (0.0 if low == 0.0 else room), high + room


def figure(
    computed: Computed, plot: str, *, legend: bool = False, measuring: bool = False
) -> Figure:
    """All strips as one drawing; with a legend for who has no cursor.

    While distances come in, ``measuring``, they are left to `mark`: this drawing stays as it is,
    also under a hand that drags on it.
    """
    found, shown = computed.found, strips(computed, plot)
    whole = axes_for(shown, found.duration, WIDTH if legend else NARROW)
    content = []
    for strip, axes in zip(shown, strip_axes(shown, whole), strict=True):
        content.append(_bands(found, axes))
        if not (measuring and _of_distance(strip)):
            content.append(_strip(strip, axes, last=strip is shown[-1]))
        if legend:
            content.append(_symbols(strip, axes, None))
    places = np.linspace(0.0, found.duration, COLUMNS)
    return Figure(
        whole,
        "".join(content),
        [f"t = {t:.3f} s{_told(found.events, t, places[1])}" for t in places.tolist()],
        ("",),
        [""] * COLUMNS,
        "Point to put the machine there",
        "The trajectory against time",
    )


def _strip(strip: Strip, axes: Axes, *, last: bool) -> str:
    return _curve_paths(strip, axes) + _frame(strip, axes, last=last)


def _of_distance(strip: Strip) -> bool:
    return not strip.curves[0].symbol


def mark(computed: Computed, plot: str, axes: Axes, at: float, *, measuring: bool = False) -> str:
    """The cursor where the machine is shown, and every quantity there."""
    shown = strips(computed, plot)
    boxes = strip_axes(shown, axes)
    x, _ = axes.px(at, 0.0)
    # Through the boxes only: between them stand the values.
    cursor = "".join(f"M{x:.1f} {box.top:g}v{box.inner[1]:.1f}" for box in boxes)
    parts = [line(cursor, "currentColor", 1.5, class_="cursor")]
    events = computed.found.events
    lost = any(e.kind == "singularity" and e.start <= at <= e.end for e in events)
    for strip, box in zip(shown, boxes, strict=True):
        open_ = lost and "(N" in strip.title  # no force holds the load there
        values = [nan] * len(strip.curves) if open_ else _at(strip, at)
        parts.append(_symbols(strip, box, values))
        if measuring and _of_distance(strip):
            parts.append(_strip(strip, box, last=strip is shown[-1]))
    return "".join(parts)


def plots_svg(computed: Computed, plot: str, title: str) -> str:
    """The plots as a file of their own."""
    drawn = figure(computed, plot, legend=True)
    a = drawn.axes
    heading = label(a.left, 4, title, "start", font_weight=600)
    return document((a.width, a.height), heading + drawn.content, paper="#FFFFFF", top=14.0)


def _at(strip: Strip, at: float) -> list[float]:
    return [float(np.interp(at, curve.times, curve.values)) for curve in strip.curves]


def _symbols(strip: Strip, axes: Axes, values: Sequence[float] | None) -> str:
    """The curves' names in their colours, right of the title, and with their values if given."""
    texts = []
    for n, curve in enumerate(strip.curves):
        shown = "" if values is None else _value(values[n])
        if text := " ".join(filter(None, (curve.symbol, shown))):
            texts.append(tag("tspan", esc(text), fill=curve.color, dx=5))
    look = {"text_anchor": "end", "font_size": 9, "font_weight": 600}
    place = {"x": axes.width - axes.right, "y": axes.top - 5}
    return tag("text", "".join(texts), class_="values", **place, **look)


def _value(value: float) -> str:
    if not isfinite(value):
        return "–"
    size = abs(value)
    text = f"{value:.0f}" if size >= 1000 else f"{value:.1f}" if size >= 10 else f"{value:.2f}"
    return minus(text.removeprefix("-" if not float(text) else ""))


def _curve_paths(strip: Strip, axes: Axes) -> str:
    paths = []
    limits: dict[float, str] = {}
    for curve in strip.curves:
        kept = thinned(len(curve.times), MOST)
        path = _runs(curve.times[kept], curve.values[kept], axes)
        paths.append(line(path, curve.color, 1.7, class_="curve", stroke_linejoin="round"))
        if curve.limit is not None:
            limits.setdefault(round(curve.limit, 9), curve.color)
    for limit, color in limits.items():
        for value in (limit, -limit) if strip.both else (limit,):
            if axes.y[0] <= value <= axes.y[1]:
                path = f"M{axes.left:g} {axes.px(0.0, value)[1]:.1f}h{axes.inner[0]:g}"
                color = color if len(limits) > 1 else palette.BEYOND
                paths.append(line(path, color, 1.2, class_="limit", stroke_dasharray="5 3"))
    return axes.clipped("".join(paths))


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
        color = QUIET if event.kind == "near" else palette.BEYOND
        x0, x1 = (axes.px(t, 0.0)[0] for t in (event.start, event.end))
        place = {"x": x0, "y": axes.top, "width": max(x1 - x0, 1.6), "height": axes.inner[1]}
        opacity = 0.85 if x1 - x0 < 1.6 else 0.14
        parts.append(tag("rect", class_="event", **place, fill=color, fill_opacity=opacity))
    return "".join(parts)


def _frame(strip: Strip, axes: Axes, *, last: bool) -> str:
    wide, high = axes.inner
    levels, times = _levels(axes.y, 3 if high < ALONE else 7), ticks(*axes.x, 8)
    middle = axes.left + wide / 2, axes.top + high / 2 + 4
    return (
        scales(axes, "t (s)" if last else "", "", times, levels, (number if last else None, _tick))
        + label(axes.left, axes.top - 5, strip.title, "start")
        + grid(axes, (), levels, 0.08)
        + label(*middle, strip.note, fill_opacity=0.6)
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
    names = {
        "outside": "outside of the workspace",
        "singularity": "singular",
        "near": "near a singularity",
        "jump": "a joint leaps",
        "corner": "a sharp corner",
        "rate": "too fast",
        "acceleration": "too much acceleration",
        "force": "too much force",
    }
    kinds = {e.kind: None for e in events if e.start - slack <= t <= e.end + slack}
    return "".join(f" · {names[kind]}" for kind in kinds)
