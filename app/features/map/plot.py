"""A map as a drawing that a person can point at."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np
from contourpy import contour_generator
from scipy.ndimage import distance_transform_edt

from app.features.map.state import Colours
from app.language import tr
from app.review.units import minus, number, page_unit, volume_text, with_error
from app.scene import palette
from app.widgets.axes import (
    MOST,
    WHOLE,
    Axes,
    Bounds,
    Figure,
    Look,
    Table,
    columns,
    cross,
    named,
    named_scales,
    runs,
    sampled,
    ticks,
)
from app.widgets.svg import EDGE, label, line, tag
from app.widgets.texts import NUMERIC, faint, table
from kinematics.answers.sections import Quantity
from kinematics.facets.map_sweeps import Map

SHADES = 48
USUAL = Colours()
SIZE = 408.0, 380.0  # px, until it is known how much room there is
PITCH = 7.0  # px between the lines where there is no workspace
MOST_LINES = 60  # contours; more are none that one could read


def figure(found: Map, look: Look = WHOLE, *, stale: bool, colours: Colours = USUAL) -> Figure:
    """A map as a drawing: a cell for each point, in the page's units."""
    quantity = found.request.quantities[0]
    first, second = found.request.coordinates
    x, y = (
        np.array([c.outer(v) for v in given])
        for c, given in ((first, found.request.first), (second, found.request.second))
    )
    span = _ends(x), _ends(y)
    axes = _box(span, look).seen(look)
    values, errors = found.values[0], found.errors[0]
    known = np.isfinite(values)
    least, most = ends(found)
    low = least if colours.low is None else colours.low
    high = max(most if colours.high is None else colours.high, low)
    unit, scale = scale_of(quantity, most)
    content = ""
    if known.any():
        # Where nothing was computed yet stands the nearest that was.
        where = distance_transform_edt(~known, return_distances=False, return_indices=True)
        shown = values[tuple(where)]
        content = _cells(axes, _shares(shown, low, high), span)
        content += _hatched(axes, shown == 0.0, span)
        if colours.contours and quantity.unit:
            step = colours.step or _round_step(low, high, scale)
            content += _contours(axes, x, y, values, low, high, step)
        content = axes.clipped(content) + _bar(axes, low * scale, high * scale)
        content += _marks(axes, found, x, y, scale)
    return Figure(
        axes,
        tag("g", content, class_="map", opacity=".35" if stale else None)
        + named_scales(axes, named(first), named(second)),
        [f"{first.symbol} {_places(v)}{page_unit(first)}, " for v in x.tolist()],
        [f"{second.symbol} {_places(v)}{page_unit(second)}: " for v in y.tolist()],
        [
            told(quantity, v, e) if ok else tr("map.not_computed")
            for v, e, ok in zip(
                values.ravel().tolist(),
                errors.ravel().tolist(),
                known.ravel().tolist(),
                strict=True,
            )
        ],
        tr("map.press") if axes.width > 500.0 else "",
        tr("map.of", what=quantity.title),
        partial(_table, found, x, y, scale, unit),
        title=quantity.title,
        unit=unit,
        span=span,
    )


def _box(span: Bounds, look: Look) -> Axes:
    """The box of a map: in the middle of its room, to one scale if that leaves it readable."""
    wide, high = look.size or SIZE
    left, top, right, bottom = 50.0, 34.0, 74.0, 42.0
    (x0, x1), (y0, y1) = span
    across, up = wide - left - right, high - top - bottom
    ratio = (x1 - x0) / (y1 - y0)
    if 0.4 < ratio < 2.5:
        across, up = min(across, up * ratio), min(up, across / ratio)
    spare, rest = wide - left - right - across, high - top - bottom - up
    edges = left + 0.5 * spare, top + 0.5 * rest, right + 0.5 * spare, bottom + 0.5 * rest
    return Axes(wide, high, *edges, *span)


def ends(found: Map) -> tuple[float, float]:
    """The least and the largest value of a workspace that is not empty."""
    values = found.values[0]
    there = values[np.isfinite(values) & (values != 0.0)]
    return (float(there.min()), float(there.max())) if len(there) else (0.0, 1.0)


def _round_step(low: float, high: float, scale: float) -> float:
    """A round step of about a seventh of a range."""
    found = ticks(low * scale, high * scale, 7) if high > low else []
    return (found[1] - found[0]) / scale if len(found) > 1 else 0.0


def _contours(
    axes: Axes,
    x: np.ndarray,
    y: np.ndarray,
    values: np.ndarray,
    low: float,
    high: float,
    step: float,
) -> str:
    """Lines of equal value at multiples of a step, by marching squares between the points."""
    if min(values.shape) < 2 or not step > 0.0 or (high - low) / step > MOST_LINES:
        return ""
    known = np.ma.masked_where(~(np.isfinite(values) & (values != 0.0)), values)
    lines = contour_generator(x, y, known.T)
    paths = [
        axes.path(np.asarray(run).tolist())
        for n in range(math.ceil(low / step), math.floor(high / step) + 1)
        for run in lines.lines(n * step)
    ]
    return line("".join(paths), "#FFFFFF", 1.1, class_="contour", stroke_opacity=0.75)


def _hatched(axes: Axes, cells: np.ndarray, span: Bounds) -> str:
    """Cells without a workspace: slanted lines, one pattern over all of them."""
    (x0, x1), (y0, y1) = span
    (left, low), (right, top) = axes.px(x0, y0), axes.px(x1, y1)
    wide, high = (right - left) / cells.shape[0], (low - top) / cells.shape[1]
    path = []
    for column, first, count in runs(cells):
        x, y = left + column * wide, top + (cells.shape[1] - first - count) * high
        tall = count * high
        for n in range(math.ceil((x + y) / PITCH), math.floor((x + wide + y + tall) / PITCH) + 1):
            u, v = max(x, n * PITCH - y - tall), min(x + wide, n * PITCH - y)
            path.append(f"M{u:.1f} {n * PITCH - u:.1f}L{v:.1f} {n * PITCH - v:.1f}")
    return line("".join(path), EDGE, 1, class_="empty", stroke_opacity=0.6)


def _table(found: Map, x: np.ndarray, y: np.ndarray, scale: float, unit: str) -> Table:
    """The values by both coordinates, thinned; the first one to the right."""
    (first, one), (second, other) = map(named, found.request.coordinates)
    across, down = sampled(len(x), 7), sampled(len(y))[::-1]
    corner = f"{second} ({other}) \\ {first} ({one})" + (f", {unit}" if unit else "")
    values = found.values[0]
    rows = [(_places(y[j]), *(_plain(values[i, j] * scale) for i in across)) for j in down]
    return (corner, *(_places(x[i]) for i in across)), rows


def _plain(value: float, digits: int = 4) -> str:
    return minus(f"{value:.{digits}g}") if np.isfinite(value) else "–"


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
    return minus(f"{value + 0.0:.1f}")


def _ends(values: np.ndarray) -> tuple[float, float]:
    """The ends of cells about evenly spaced values."""
    half = 0.5 * (values[-1] - values[0]) / (len(values) - 1)
    return float(values[0] - half), float(values[-1] + half)


def extremes(found: Map) -> tuple[tuple[str, tuple[int, int]], ...]:
    """Which cells hold the largest and the least value of a workspace that is not empty."""
    values = found.values[0]
    there = np.isfinite(values) & (values != 0.0)
    if not there.any():
        return ()
    high, low = np.where(there, values, -np.inf), np.where(there, values, np.inf)
    cells = {"max": int(high.argmax()), "min": int(low.argmin())}
    return tuple(
        (name, (cell // values.shape[1], cell % values.shape[1])) for name, cell in cells.items()
    )


def cell_at(found: Map, pose: Sequence[float]) -> tuple[int, int] | None:
    """The cell in which a pose is; None beyond the map."""
    cell = []
    for n, given in zip(
        found.request.axes, (found.request.first, found.request.second), strict=True
    ):
        known = np.array(given)
        half = 0.5 * (known[-1] - known[0]) / max(len(known) - 1, 1)
        if not known[0] - half <= pose[n] <= known[-1] + half:
            return None
        cell.append(int(np.abs(known - pose[n]).argmin()))
    return cell[0], cell[1]


def extremes_html(found: Map, pose: Sequence[float]) -> str:
    """The largest and the least value, that of the machine's cell and the mean, with where."""
    quantity, values = found.request.quantities[0], found.values[0]
    unit, scale = scale_of(quantity, ends(found)[1])
    coordinates = found.request.coordinates
    given = found.request.first, found.request.second
    known = dict(extremes(found))
    rows = []
    for sign, name, at in (
        ("○", tr("map.largest"), known.get("max")),
        ("×", tr("map.smallest"), known.get("min")),
        ("+", tr("map.is_here"), cell_at(found, pose)),
    ):
        if at is not None:
            place = [_places(c.outer(v[n])) for c, v, n in zip(coordinates, given, at, strict=True)]
            error = found.errors[0][at] * scale
            shown = _plain(float(values[at]) * scale, 5), f"{error:.1g}" if error > 0.0 else ""
            rows.append((f"{sign} {name}", *shown, *place))
    there = values[np.isfinite(values) & (values != 0.0)]
    if len(there):
        mean = _plain(float(there.mean()) * scale, 5)
        rows.append((faint(tr("map.mean")), mean, "", "", ""))
    heads = ("", unit, "±", *(f"{c.symbol} ({page_unit(c)})" for c in coordinates))
    return table(rows, ("", *[NUMERIC] * 4), heads=heads) if rows else ""


def scale_of(quantity: Quantity, high: float) -> tuple[str, float]:
    """The unit in which values up to this one are written, and how many of it one is."""
    if quantity.unit != "mm³":
        return str(quantity.unit), 1.0
    return ("dm³", 1e-6) if high >= 1e5 else ("cm³", 1e-3)


def _shares(values: np.ndarray, low: float, high: float) -> np.ndarray:
    """Where values stand from the least to the largest, up to 1; 0 where nothing is."""
    span = high - low
    shares = np.ones_like(values)
    if span > 0.0:
        shares = np.clip((values - low) / span, 1e-9, 1.0)
    return np.where(values == 0.0, 0.0, shares)


def _marks(axes: Axes, found: Map, x: np.ndarray, y: np.ndarray, scale: float) -> str:
    """A ring at the largest value and a cross at the least one, each named on a white tag."""
    drawn = ""
    for name, (i, j) in extremes(found):
        place = float(x[i]), float(y[j])
        if not axes.holds(*place):
            continue
        u, v = axes.px(*place)
        ring = f"M{u - 6:.1f} {v:.1f}a6 6 0 1 0 12 0a6 6 0 1 0 -12 0"
        saltire = f"M{u - 5:.1f} {v - 5:.1f}l10 10m0 -10l-10 10"
        path = ring if name == "max" else saltire
        drawn += line(path, "#FFFFFF", 4.0) + line(path, palette.INK, 1.8, class_=name)
        text = tr(
            "map.extreme",
            name=tr(f"map.ends.{name}"),
            value=_plain(float(found.values[0][i, j]) * scale),
            place=_at(found, x, y, i, j),
        )
        drawn += _tag(axes, u, v, text, above=name == "max")
    return drawn


def _at(found: Map, x: np.ndarray, y: np.ndarray, i: int, j: int) -> str:
    units = [page_unit(c) for c in found.request.coordinates]
    gaps = ["" if unit == "°" else " " for unit in units]
    values = (number(round(float(v), 1)) for v in (x[i], y[j]))
    return ", ".join(f"{v}{gap}{unit}" for v, gap, unit in zip(values, gaps, units, strict=True))


def _tag(axes: Axes, u: float, v: float, text: str, *, above: bool) -> str:
    """A text on white beside a mark, within the box; ink, whatever the page is."""
    wide, high = 5.7 * len(text) + 10.0, 17.0
    right, low = axes.left + axes.inner[0], axes.top + axes.inner[1]
    x = min(max(u - wide - 10.0 if above else u + 10.0, axes.left + 2.0), right - wide - 2.0)
    y = min(max(v - high - 8.0 if above else v + 8.0, axes.top + 2.0), low - high - 2.0)
    look = {"fill": "#FFFFFF", "fill_opacity": 0.92, "rx": 3}
    box = tag("rect", x=x, y=y, width=wide, height=high, **look)
    return box + label(x + 5, y + 12.5, text, "start", fill=palette.INK)


def here(found: Map, axes: Axes, pose: Sequence[float]) -> str:
    """A cross where the machine is, with what the map has there."""
    first, second = found.request.coordinates
    n, m = found.request.axes
    x, y = first.outer(pose[n]), second.outer(pose[m])
    at = cell_at(found, pose)
    named_here = ""
    if at is not None and axes.holds(x, y) and np.isfinite(found.values[0][at]):
        _, scale = scale_of(found.request.quantities[0], ends(found)[1])
        place = _at(found, np.array([x]), np.array([y]), 0, 0)
        text = tr("map.here", value=_plain(float(found.values[0][at]) * scale), place=place)
        named_here = _tag(axes, *axes.px(x, y), text, above=False)
    return named_here + cross(axes, x, y, 8.0)


def _cells(axes: Axes, shares: np.ndarray, span: Bounds | None = None) -> str:
    """One path for each shade; neighbours upwards of one shade are one rectangle."""
    shades = np.clip(np.rint(shares * (SHADES - 1)), 0, SHADES - 1).astype(int)
    shades[shares == 0.0] = -1  # an empty workspace has no colour
    look = {"shape_rendering": "crispEdges"}
    return "".join(
        tag(
            "path",
            d=columns(axes, shades == n, span),
            fill=palette.ramp_color(n / (SHADES - 1)),
            **look,
        )
        for n in np.unique(shades[shades >= 0]).tolist()
    )


def _bar(axes: Axes, low: float, high: float) -> str:
    """The colours with what they stand for, from the least value to the largest."""
    left, tall = axes.width - axes.right + 14.0, axes.inner[1]
    step = tall / SHADES
    parts = [
        tag(
            "rect",
            x=left,
            y=axes.top + (SHADES - 1 - n) * step,
            width=13,
            height=step + 0.3,
            fill=palette.ramp_color(n / (SHADES - 1)),
        )
        for n in range(SHADES)
    ]
    for value in ticks(low, high, MOST) if high > low else [high]:
        y = axes.top + tall * (1.0 - (value - low) / (high - low) if high > low else 0.0)
        parts.append(line(f"M{left + 13:g} {y:.1f}h4", stroke_opacity=0.6))
        parts.append(label(left + 19, y + 3.8, number(value), "start"))
    return "".join(parts)
