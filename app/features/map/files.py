"""Maps as files: pure functions from a map to CSV, NPZ and figures. Angles are degrees here."""

from __future__ import annotations

import io
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from app.terminal import tables
from app.terminal.files import picture
from kinematics.answers.sections import Quantity
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.map_sweeps import Map, MapRequest
from kinematics.storage import csv_text

if TYPE_CHECKING:  # loaded only where a figure is drawn
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS: tuple[str, ...] = ("csv", "npz", "png", "svg")
UNITS = {"mm³": "_mm3", "mm": "_mm", "%": "_percent", "": ""}
COLORS = "cividis"  # even steps for every kind of colour sight, and in grey
MOST_SHAPES = 10_000  # beyond so many cells an SVG holds them as one picture
FEWEST_FOR_LINES = 8  # points along an axis from which contour lines mean something
ANGLE_STEPS = (1, 1.5, 2, 3, 4.5, 6, 9, 10)
EMPTY, UNKNOWN = "#FFFFFF", "#D5D9DE"


def map_bytes(found: Map, kind: str) -> bytes:
    """A map as the content of a file.

    Raises:
        InputError: ``kind`` is not one of `FORMATS`.
    """
    match kind:
        case "csv":
            return map_csv(found).encode()
        case "npz":
            return map_npz(found)
        case "png" | "svg":
            return picture(map_figure(found), kind)
    raise InputError(f"there is no format {kind!r}; a map is written as {', '.join(FORMATS)}")


def columns(request: MapRequest) -> tuple[tuple[str, str], ...]:
    """What each quantity and its error are called in files: "volume_mm3", "error_mm3"."""
    return tuple(
        (
            f"{quantity.key}{UNITS[quantity.unit]}",
            f"{'' if quantity.key == 'volume' else f'{quantity.key}_'}error{UNITS[quantity.unit]}",
        )
        for quantity in request.quantities
    )


def axis_values(request: MapRequest) -> tuple[list[float], list[float]]:
    """The values of both coordinates in people's units, as they were typed."""
    first, second = (
        [round(value, 10) + 0.0 for value in map(axis.outer, values)]
        for values, axis in zip((request.first, request.second), request.coordinates, strict=True)
    )
    return first, second


def map_csv(found: Map) -> str:
    """One row a point, the second coordinate running fastest; points that are not done left out."""
    request = found.request
    named = (name for pair in columns(request) for name in pair)
    rows: list[list[object]] = [[*(axis.json_key for axis in request.coordinates), *named]]
    first, second = axis_values(request)
    for i, j in np.argwhere(found.done).tolist():
        pairs = np.stack([found.values[:, i, j], found.errors[:, i, j]], axis=1)
        rows.append([first[i], second[j], *pairs.ravel().tolist()])
    return csv_text(rows)


def map_npz(found: Map) -> bytes:
    """NumPy arrays: both coordinates (n,) and (m,), each quantity (n, m), what is done, names."""
    request = found.request
    arrays: dict[str, Any] = dict(
        zip((axis.json_key for axis in request.coordinates), axis_values(request), strict=True)
    )
    for (name, error), values, errors in zip(
        columns(request), found.values, found.errors, strict=True
    ):
        arrays[name], arrays[error] = values, errors
    arrays["done"] = found.done
    arrays["design"] = request.design.name
    arrays["modes"] = "all" if request.modes is None else request.modes
    written = io.BytesIO()
    np.savez_compressed(written, **arrays)
    return written.getvalue()


# --- figures -------------------------------------------------------------------------------


def map_figure(found: Map) -> Figure:
    """A figure with one panel a quantity; a curve where one coordinate has a single value."""
    from matplotlib.figure import Figure

    quantities = found.request.quantities
    across = min(len(quantities), 3)
    down = ceil(len(quantities) / across)
    figure = Figure(figsize=(5.4 * across, 4.6 * down + 0.4), layout="constrained")
    figure.suptitle(_title(found), fontsize=11)
    panels = figure.subplots(down, across, squeeze=False).ravel()
    for panel in panels[len(quantities) :]:
        panel.set_axis_off()
    for panel, quantity, values in zip(panels, quantities, found.values, strict=False):
        if min(found.request.shape) == 1:
            _curve(panel, found, quantity, values)
        else:
            _field(figure, panel, found, quantity, values)
    return figure


def _title(found: Map) -> str:
    request = found.request
    modes = request.modes
    if modes is None:
        which = "all working modes"
    elif len(modes) <= 3:
        which = f"working mode {', '.join(mode.replace('-', '−') for mode in modes)}"
    else:
        which = f"{len(modes)} working modes"
    part = "" if found.complete else f", {found.done.sum()} of {found.done.size} orientations"
    return f"{request.design.title or request.design.name}\n{which}{part}"


def _field(figure: Figure, panel: Axes, found: Map, quantity: Quantity, values: Array) -> None:
    """Filled cells, hatched where not done and white where there is nothing."""
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.ticker import MaxNLocator

    first, second = axis_values(found.request)
    scale, unit = _scale(quantity, values)
    shown = np.ma.array(values / scale, mask=~(values > 0))  # not done, or nothing there
    options: dict[str, Any] = {"cmap": colormaps[COLORS]}
    whole = quantity.unit == ""
    if whole:
        most = int(shown.max()) if shown.count() else 1
        edges = np.arange(0.5, most + 1)
        options = {"cmap": colormaps[COLORS].resampled(len(edges) - 1)}
        options["norm"] = BoundaryNorm(edges, len(edges) - 1)
    elif shown.count():
        options |= {"vmin": float(shown.min()), "vmax": float(shown.max())}
    panel.patch.set(facecolor=UNKNOWN, edgecolor=EMPTY, hatch="////")
    corners = _edges(first), _edges(second)
    many = values.size > MOST_SHAPES
    nothing = np.ma.masked_where(~found.done | ~shown.mask, np.zeros(values.shape))
    panel.pcolormesh(*corners, nothing.T, cmap=ListedColormap([EMPTY]), rasterized=many)
    cells = panel.pcolormesh(*corners, shown.T, rasterized=many, **options)
    varied = shown.count() > 0 and shown.min() < shown.max()
    if varied and not whole and found.complete and min(values.shape) >= FEWEST_FOR_LINES:
        panel.contour(first, second, values.T, colors=EMPTY, linewidths=0.5, alpha=0.6)
    bar = panel.inset_axes((1.03, 0.0, 0.045, 1.0))
    label = f"{quantity.title} ({unit})" if unit else quantity.title
    figure.colorbar(cells, cax=bar, label=label, ticks=MaxNLocator(integer=True) if whole else None)
    panel.xaxis.set_major_locator(MaxNLocator(7, steps=ANGLE_STEPS))
    panel.yaxis.set_major_locator(MaxNLocator(7, steps=ANGLE_STEPS))
    panel.set_xlabel(_axis_label(found, 0))
    panel.set_ylabel(_axis_label(found, 1))
    panel.set_aspect("equal" if _alike(first, second) else "auto")


def _curve(panel: Axes, found: Map, quantity: Quantity, values: Array) -> None:
    along = 0 if found.request.shape[1] == 1 else 1
    places = axis_values(found.request)
    scale, unit = _scale(quantity, values)
    panel.plot(places[along], values.ravel() / scale, color="#2E4A6B", marker=".", linewidth=1.2)
    panel.set_xlabel(_axis_label(found, along))
    panel.set_ylabel(f"{quantity.title} ({unit})" if unit else quantity.title)
    fixed = found.request.coordinates[1 - along]
    panel.set_title(tables.with_units(places[1 - along], [fixed]), fontsize=10)
    panel.set_ylim(bottom=0.0)
    panel.grid(alpha=0.25)


def _scale(quantity: Quantity, values: Array) -> tuple[float, str]:
    """By what to divide large volumes, and the unit that this gives."""
    most = np.nanmax(values, initial=0.0)
    if quantity.unit == "mm³" and most >= 1e5:
        return 1e6, "10⁶ mm³"
    return 1.0, quantity.unit


def _axis_label(found: Map, axis: int) -> str:
    coordinate = found.request.coordinates[axis]
    return f"{coordinate.symbol} ({'degrees' if coordinate.unit == 'rad' else coordinate.unit})"


def _edges(values: list[float]) -> Array:
    """Cell borders half way between the values."""
    places = np.asarray(values)
    half = np.diff(places) / 2
    return np.concatenate([[places[0] - half[0]], places[:-1] + half, [places[-1] + half[-1]]])


def _alike(first: list[float], second: list[float]) -> bool:
    """Ranges of comparable length, which equal scales leave readable."""
    ratio = abs(first[-1] - first[0]) / max(abs(second[-1] - second[0]), 1e-9)
    return 0.4 < ratio < 2.5
