"""The axes of plots and what is drawn on them, as SVG. Knows no viser."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from app.review.units import number, page_unit
from app.scene import palette
from app.widgets.svg import DIM, EDGE, RULE, TEXT, in_mm, label, line
from kinematics.mechanism import Coordinate

Range = tuple[float, float]
Bounds = tuple[Range, Range]
"""From and to of both axes."""
Named = tuple[str, str]
"""A symbol and its unit."""
Words = Callable[[float], str] | None
Table = tuple[Sequence[str], Sequence[Sequence[str]]]
"""Heads with their units, and rows."""
MARGIN = 0.06  # of the size of what is shown to scale, left free around it
STEPS = (1.0, 2.0, 5.0)  # round numbers, times powers of ten
TURN = (1.5, 3.0, 4.5, 9.0)  # round degrees, times powers of ten
MOST = 5  # steps between ticks, which are one more
ROWS = 25  # of a table behind a plot, at the most
CLOSEST = 1e-4  # of an axis, the least that is zoomed to


@dataclass(frozen=True, slots=True)
class Look:
    """How a person looks at a plot.

    Attributes:
        part: of its axes that is shown; None for the whole of them.
        size: px for it; None where it is not known, or is the same everywhere.
    """

    part: Bounds | None = None
    size: tuple[float, float] | None = None


WHOLE = Look()


@dataclass(frozen=True, slots=True)
class Axes:
    """A plot's size and inner box (px), and what of x and y it shows."""

    width: float
    height: float
    left: float
    top: float
    right: float
    bottom: float
    x: Range
    y: Range
    digits: int = 1  # of a px, along lines
    whole: Bounds | None = None  # of which a part is shown

    def seen(self, look: Look) -> Axes:
        """The part of these axes that a person looks at."""
        if look.part is None:
            return self
        x, y = (_cut(part, span) for part, span in zip(look.part, (self.x, self.y), strict=True))
        return replace(self, x=x, y=y, whole=(self.x, self.y))

    @property
    def inner(self) -> tuple[float, float]:
        """Width and height of the box, px."""
        return self.width - self.left - self.right, self.height - self.top - self.bottom

    def holds(self, x: float, y: float) -> bool:
        """Whether a place is in the box."""
        return self.x[0] <= x <= self.x[1] and self.y[0] <= y <= self.y[1]

    def clipped(self, content: str) -> str:
        """What is drawn, as far as it is in the box.

        A nested picture clips what it holds and needs no id that might clash on a page.
        """
        wide, high = self.inner
        place = f'x="{self.left:g}" y="{self.top:g}" width="{wide:g}" height="{high:g}"'
        view = f"{self.left:g} {self.top:g} {wide:g} {high:g}"
        return f'<svg {place} viewBox="{view}">{content}</svg>'

    def path(self, points: Iterable[Sequence[float]]) -> str:
        """A line through points, for a path's ``d``."""
        n = self.digits
        ends = (self.px(x, y) for x, y in points)
        return "M" + "L".join(f"{u:.{n}f} {v:.{n}f}" for u, v in ends)

    def true_size(self, picture: str) -> str:
        """A picture with these axes, which are both mm to one scale, in mm: each place has its own
        coordinates, y downwards, as SVG counts it.
        """
        unit = (self.x[1] - self.x[0]) / self.inner[0]
        return in_mm(picture, unit, self.x[0] - self.left * unit, -self.y[1] - self.top * unit)

    def px(self, x: float, y: float) -> tuple[float, float]:
        """A place in the plot, px."""
        wide, high = self.inner
        u = (x - self.x[0]) / (self.x[1] - self.x[0])
        v = (y - self.y[0]) / (self.y[1] - self.y[0])
        return self.left + u * wide, self.top + (1.0 - v) * high


def _cut(part: Range, span: Range) -> Range:
    """A part of a span, as large as it is asked for if the span is."""
    whole = span[1] - span[0]
    size = min(max(part[1] - part[0], CLOSEST * whole), whole)
    low = min(max(part[0], span[0]), span[1] - size)
    return low, low + size


def equal_axes(
    bounds: Bounds, width: float, height: float, left: float, top: float, bottom: float
) -> Axes:
    """Equal scale both ways, the second axis upwards, the whole panel used."""
    (u0, u1), (v0, v1) = bounds
    right = 14.0
    wide, high = max(width - left - right, 20.0), max(height - top - bottom, 20.0)
    across, up = max(u1 - u0, 1e-9), max(v1 - v0, 1e-9)
    scale = (1.0 - 2 * MARGIN) * min(wide / across, high / up)
    x, y = (
        (0.5 * (low + high_) - 0.5 * size / scale, 0.5 * (low + high_) + 0.5 * size / scale)
        for (low, high_), size in zip(bounds, (wide, high), strict=True)
    )
    return Axes(left + wide + right, top + high + bottom, left, top, right, bottom, x, y)


@dataclass(frozen=True, slots=True)
class Figure:
    """A drawing on axes.

    Attributes:
        content: SVG elements; text in them went through `esc`.
        columns, rows: what to tell under the pointer of its column and of its row; they are of
            equal size and fill the box, rows upwards.
        tips: what to tell of each cell, rows running fastest.
        idle: what to tell otherwise.
        name: for who does not see it.
        table: makes the numbers behind it, for who cannot see or point.
        title, unit: stand above it.
        span: what the cells fill; None for what is shown.
    """

    axes: Axes
    content: str
    columns: Sequence[str]
    rows: Sequence[str]
    tips: Sequence[str]
    idle: str
    name: str
    table: Callable[[], Table]
    title: str = ""
    unit: str = ""
    span: Bounds | None = None


def ticks(low: float, high: float, most: int, steps: Sequence[float] = STEPS) -> list[float]:
    """At most so many round numbers from low to high; ``steps`` says what is round."""
    raw = (high - low) / max(most, 1)
    decades = 10.0 ** np.arange(math.floor(math.log10(raw)) - 2, math.log10(raw) + 2)
    round_ = np.sort(np.outer(decades, steps).ravel())
    step = float(round_[np.searchsorted(round_, raw * (1 - 1e-9))])
    return [n * step for n in range(math.ceil(low / step), math.floor(high / step + 1e-9) + 1)]


def scales(
    axes: Axes,
    x_title: str,
    y_title: str,
    x_ticks: Sequence[float],
    y_ticks: Sequence[float],
    words: tuple[Words, Words] = (number, number),
) -> str:
    """Two axes, left and below, with ticks and titles; ``words`` of the ticks, None for none."""
    wide, high = axes.inner
    left, low = axes.left, axes.top + high
    marks, texts = [], []
    for value in x_ticks:
        x, _ = axes.px(value, axes.y[0])
        marks.append(f"M{x:.2f} {low:g}v3")
        texts.append(label(x, low + 15, words[0](value) if words[0] else "", fill=TEXT))
    for value in y_ticks:
        _, y = axes.px(axes.x[0], value)
        marks.append(f"M{left:g} {y:.2f}h-3")
        text = words[1](value) if words[1] else ""
        texts.append(label(left - 6, y + 3.85, text, "end", fill=TEXT))
    middle = axes.top + high / 2
    corner = f"M{left:g} {axes.top:g}V{low:g}H{left + wide:g}"
    return (
        f"{line(corner + ''.join(marks), EDGE, 1, class_='axes')}{''.join(texts)}"
        f"{label(left + wide / 2, low + 29, x_title, fill=DIM)}"
        f"{label(12, middle, y_title, fill=DIM, transform=f'rotate(-90 12 {middle:g})')}"
    )


def named_scales(axes: Axes, x: Named, y: Named) -> str:
    """Those of two quantities."""
    titles = [f"{symbol} ({unit})" for symbol, unit in (x, y)]
    return scales(axes, titles[0], titles[1], *named_ticks(axes, x, y))


def named_ticks(axes: Axes, x: Named, y: Named) -> tuple[list[float], list[float]]:
    """Round numbers along both axes."""
    first, second = (
        ticks(*span, MOST, TURN if unit == "°" else STEPS)
        for span, (_, unit) in ((axes.x, x), (axes.y, y))
    )
    return first, second


def grid(axes: Axes, xs: Iterable[float], ys: Iterable[float]) -> str:
    """Hair lines across the box at these places."""
    wide, high = axes.inner
    up = "".join(f"M{axes.px(x, axes.y[0])[0]:.2f} {axes.top:g}v{high:g}" for x in xs)
    across = "".join(f"M{axes.left:g} {axes.px(axes.x[0], y)[1]:.2f}h{wide:g}" for y in ys)
    return line(up + across, RULE, 1, class_="grid")


def upright(axes: Axes, x: float) -> str:
    """A line over the whole height of the box; nothing outside of it."""
    if not axes.x[0] <= x <= axes.x[1]:
        return ""
    at, low = axes.px(x, axes.y[0])
    return line(f"M{at:.1f} {axes.top:g}V{low:.1f}", TEXT, 1.2, class_="cursor")


def middles(span: Range, count: int) -> NDArray[np.float64]:
    """The middles (N,) of cells of equal size that fill a span."""
    return np.asarray(span[0] + (np.arange(count) + 0.5) / count * (span[1] - span[0]))


def pointed(axes: Axes, x: Named, y: Named, count: int) -> tuple[list[str], list[str]]:
    """What to tell of so many columns and rows: where they are."""
    columns, rows = (
        [f"{symbol} = {number(round(v, 1))}{'' if unit == '°' else ' '}{unit}" for v in at.tolist()]
        for (symbol, unit), at in ((x, middles(axes.x, count)), (y, middles(axes.y, count)))
    )
    return [f"{column}, " for column in columns], rows


def thinned(count: int, most: int) -> NDArray[np.int64]:
    """About so many at the most of the indices of some points, evenly, and the last one."""
    return np.unique(np.append(np.arange(0, count, max(1, count // most)), count - 1))


def sampled(count: int, most: int = ROWS) -> list[int]:
    """The indices of no more than so many of some things, evenly, both ends among them."""
    return sorted({round(n) for n in np.linspace(0, count - 1, min(count, most)).tolist()})


def named(axis: Coordinate) -> Named:
    """A coordinate as an axis shows it."""
    return axis.symbol, page_unit(axis)


def cross(axes: Axes, x: float, y: float, reach: float = 7.0) -> str:
    """A cross at a place, readable on every colour; nothing outside of the box."""
    if not axes.holds(x, y):
        return ""
    u, v = axes.px(x, y)
    path = f"M{u - reach:.1f} {v:.1f}h{2 * reach:g}M{u:.1f} {v - reach:.1f}v{2 * reach:g}"
    halo = line(path, "#FFFFFF", 4, class_="here", stroke_opacity=0.8)
    return halo + line(path, palette.INK, 1.8)


def runs(cells: NDArray[np.bool_]) -> Iterator[tuple[int, int, int]]:
    """Row, first column and number of the neighbours in a row that are set."""
    edges = np.diff(np.pad(cells.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    rows, first = np.nonzero(edges == 1)
    behind = np.nonzero(edges == -1)[1]
    yield from zip(rows.tolist(), first.tolist(), (behind - first).tolist(), strict=True)


def columns(axes: Axes, cells: NDArray[np.bool_], span: Bounds | None = None) -> str:
    """Cells (N, M) that fill a span, or the box, the second upwards, as a path of rectangles."""
    (x0, x1), (y0, y1) = span or (axes.x, axes.y)
    (left, low), (right, top) = axes.px(x0, y0), axes.px(x1, y1)
    wide, high = (right - left) / cells.shape[0], (low - top) / cells.shape[1]
    path = []
    for column, first, count in runs(cells):
        x, y = left + column * wide, top + (cells.shape[1] - first - count) * high
        path.append(f"M{x:.2f} {y:.2f}h{wide:.2f}v{count * high:.2f}h{-wide:.2f}z")
    return "".join(path)


def nearest(values: Sequence[float], value: float) -> float:
    """The one of the values that a person pointed at."""
    return min(values, key=lambda known: abs(known - value))
