"""A map as a drawing that a person can point at."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import distance_transform_edt

from app.review.units import minus, number, page_unit, volume_text, with_error
from app.scene import palette
from app.widgets.axes import Axes, Figure, columns, named, named_scales, ticks
from app.widgets.svg import label, line, tag
from kinematics.answers.sections import Quantity
from kinematics.facets.map_sweeps import Map

SHADES = 48


def figure(found: Map, *, stale: bool) -> Figure:
    """A map as a drawing: a cell for each point, in the page's units."""
    quantity = found.request.quantities[0]
    first, second = found.request.coordinates
    x, y = (
        np.array([c.outer(v) for v in given])
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
    return Figure(
        axes,
        tag("g", content, class_="map", opacity=0.35 if stale else None)
        + named_scales(axes, named(first), named(second), 7),
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
    return minus(f"{value + 0.0:.1f}")


def _ends(values: np.ndarray) -> tuple[float, float]:
    """The ends of cells about evenly spaced values."""
    half = 0.5 * (values[-1] - values[0]) / (len(values) - 1)
    return float(values[0] - half), float(values[-1] + half)


def _top(quantity: Quantity, values: np.ndarray) -> float:
    """The end of the colours; they begin at zero."""
    if quantity.unit == "%":
        return 100.0
    return max(float(values.max(initial=0.0)), 1e-9)


def _cells(axes: Axes, shares: np.ndarray) -> str:
    """One path for each shade; neighbours upwards of one shade are one rectangle."""
    shades = np.clip(np.rint(shares * (SHADES - 1)), 0, SHADES - 1).astype(int)
    shades[shares == 0.0] = -1  # an empty workspace has no colour
    look = {"shape_rendering": "crispEdges"}
    return "".join(
        tag("path", d=columns(axes, shades == n), fill=palette.ramp_color(n / (SHADES - 1)), **look)
        for n in np.unique(shades[shades >= 0]).tolist()
    )


def _bar(axes: Axes, quantity: Quantity, top: float) -> str:
    """The colours with what they stand for."""
    unit, scale = str(quantity.unit), 1.0
    if quantity.unit == "mm³":
        unit, scale = ("dm³", 1e-6) if top >= 1e5 else ("cm³", 1e-3)
    left, high = axes.width - axes.right + 14.0, axes.inner[1]
    step = high / SHADES
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
    for value in ticks(0.0, top * scale, 6):
        y = axes.top + high * (1.0 - value / (top * scale))
        parts.append(line(f"M{left + 13:g} {y:.1f}h4", stroke_opacity=0.6))
        parts.append(label(left + 19, y + 3.8, number(value), "start"))
    return "".join([*parts, label(left, axes.top - 7, unit, "start")])
