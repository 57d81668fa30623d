"""A map as a drawing that a person can point at."""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.ndimage import distance_transform_edt

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
    named,
    named_scales,
    sampled,
    ticks,
)
from app.widgets.svg import label, line, tag
from kinematics.answers.sections import Quantity
from kinematics.facets.map_sweeps import Map

SHADES = 48


def figure(found: Map, look: Look = WHOLE, *, stale: bool) -> Figure:
    """A map as a drawing: a cell for each point, in the page's units."""
    quantity = found.request.quantities[0]
    first, second = found.request.coordinates
    x, y = (
        np.array([c.outer(v) for v in given])
        for c, given in ((first, found.request.first), (second, found.request.second))
    )
    span = _ends(x), _ends(y)
    axes = Axes(396, 342, 46, 28, 74, 38, *span).seen(look)
    values, errors = found.values[0], found.errors[0]
    known = np.isfinite(values)
    there = values[known & (values != 0.0)]
    low, high = (float(there.min()), float(there.max())) if len(there) else (0.0, 1.0)
    unit, scale = _scale(quantity, high)
    content = ""
    if known.any():
        # Where nothing was computed yet stands the nearest that was.
        where = distance_transform_edt(~known, return_distances=False, return_indices=True)
        cells = _cells(axes, _shares(values[tuple(where)], low, high), span)
        content = axes.clipped(cells) + _bar(axes, unit, low * scale, high * scale)
        content += _marks(axes, found, x, y, scale)
    return Figure(
        axes,
        tag("g", content, class_="map", opacity=".35" if stale else None)
        + named_scales(axes, named(first), named(second)),
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
        "press a cell to turn the machine there",
        f"Map of {quantity.title}",
        partial(_table, found, x, y, scale, unit),
        title=quantity.title,
        unit=unit,
        span=span,
    )


def _table(found: Map, x: np.ndarray, y: np.ndarray, scale: float, unit: str) -> Table:
    """The values by both coordinates, thinned; the first one to the right."""
    (first, one), (second, other) = map(named, found.request.coordinates)
    across, down = sampled(len(x), 7), sampled(len(y))[::-1]
    corner = f"{second} ({other}) \\ {first} ({one})" + (f", {unit}" if unit else "")
    values = found.values[0]
    rows = [(_places(y[j]), *(_plain(values[i, j] * scale) for i in across)) for j in down]
    return (corner, *(_places(x[i]) for i in across)), rows


def _plain(value: float) -> str:
    return minus(f"{value:.4g}") if np.isfinite(value) else "–"


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


def extremes_text(found: Map) -> str:
    """Both in words: "Largest: 24.50 ± 0.01 dm³ at φ −5.0°, θ 0.0°"."""
    quantity = found.request.quantities[0]
    lines = []
    for name, at in extremes(found):
        value, error = float(found.values[0][at]), float(found.errors[0][at])
        place = ", ".join(
            f"{c.symbol} {_places(c.outer(given[n]))}{page_unit(c)}"
            for c, given, n in zip(
                found.request.coordinates,
                (found.request.first, found.request.second),
                at,
                strict=True,
            )
        )
        word = {"max": "Largest", "min": "Least"}[name]
        lines.append(f"{word}: {told(quantity, value, error)} at {place}")
    return "\n".join(lines)


def _scale(quantity: Quantity, high: float) -> tuple[str, float]:
    """The unit in which values up to this one are written, and how many of it one is."""
    if quantity.unit != "mm³":
        return str(quantity.unit), 1.0
    return ("dm³", 1e-6) if high >= 1e5 else ("cm³", 1e-3)


def _shares(values: np.ndarray, low: float, high: float) -> np.ndarray:
    """Where values stand from the least to the largest, up to 1; 0 where nothing is."""
    span = high - low
    shares = np.ones_like(values) if span <= 0.0 else np.maximum((values - low) / span, 1e-9)
    return np.where(values == 0.0, 0.0, shares)


def _marks(axes: Axes, found: Map, x: np.ndarray, y: np.ndarray, scale: float) -> str:
    """A ring at the largest value and a cross at the least one, named."""
    drawn = ""
    halo = {"paint_order": "stroke", "stroke": "#FFFFFF", "stroke_width": 3.0, "fill": palette.INK}
    for name, (i, j) in extremes(found):
        u, v = axes.px(float(x[i]), float(y[j]))
        ring = f"M{u - 5:.1f} {v:.1f}a5 5 0 1 0 10 0a5 5 0 1 0 -10 0"
        cross = f"M{u - 4.5:.1f} {v - 4.5:.1f}l9 9m0 -9l-9 9"
        path = ring if name == "max" else cross
        drawn += line(path, "#FFFFFF", 4.0) + line(path, palette.INK, 1.6, class_=name)
        right = u < axes.left + 0.6 * axes.inner[0]
        low = axes.top + axes.inner[1] - 4.0
        at = min(max(v - 8 if name == "max" else v + 16, axes.top + 12.0), low)
        text = f"{name} {minus(f'{found.values[0][i, j] * scale:.4g}')}"
        drawn += label(u + (9 if right else -9), at, text, "start" if right else "end", **halo)
    return drawn


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


def _bar(axes: Axes, unit: str, low: float, high: float) -> str:
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
    return "".join([*parts, label(left, axes.top - 7, unit, "start")])
