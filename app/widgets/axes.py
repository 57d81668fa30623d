"""The axes of plots and what is drawn on them, as SVG. Knows no viser."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.review.units import number
from app.scene import palette
from app.widgets.texts import esc
from kinematics.mechanism import Coordinate

Range = tuple[float, float]
Words = Callable[[float], str] | None
STEPS = (1.0, 2.0, 5.0)  # round numbers, times powers of ten
TURN = (1.5, 3.0, 4.5, 9.0)  # round degrees, times powers of ten


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
        return "M" + "L".join("{:.1f} {:.1f}".format(*self.px(x, y)) for x, y in points)

    def px(self, x: float, y: float) -> tuple[float, float]:
        """A place in the plot, px."""
        wide, high = self.inner
        u = (x - self.x[0]) / (self.x[1] - self.x[0])
        v = (y - self.y[0]) / (self.y[1] - self.y[0])
        return self.left + u * wide, self.top + (1.0 - v) * high


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
    """

    axes: Axes
    content: str
    columns: Sequence[str]
    rows: Sequence[str]
    tips: Sequence[str]
    idle: str
    name: str


def ticks(low: float, high: float, most: int, steps: Sequence[float] = STEPS) -> list[float]:
    """At most so many round numbers from low to high; ``steps`` says what is round."""
    raw = (high - low) / max(most, 1)
    decades = 10.0 ** np.arange(math.floor(math.log10(raw)) - 2, math.log10(raw) + 2)
    round_ = np.sort(np.outer(decades, steps).ravel())
    step = float(round_[np.searchsorted(round_, raw * (1 - 1e-9))])
    return [n * step for n in range(math.ceil(low / step), math.floor(high / step + 1e-9) + 1)]


def label(x: float, y: float, text: str, anchor: str = "middle", opacity: float = 1.0) -> str:
    """A text in the page's own colour; nothing for none."""
    if not text:
        return ""
    faint = "" if opacity == 1.0 else f' fill-opacity="{opacity:g}"'
    return (
        f'<text x="{x:.5g}" y="{y:.5g}" text-anchor="{anchor}" fill="currentColor"{faint}>'
        f"{esc(text)}</text>"
    )


def scales(
    axes: Axes,
    x_title: str,
    y_title: str,
    x_ticks: Sequence[float],
    y_ticks: Sequence[float],
    words: tuple[Words, Words] = (number, number),
) -> str:
    """The box of a plot with ticks and titles, in the page's own colour; ``words`` of its ticks,
    None for none.
    """
    wide, high = axes.inner
    left, low = axes.left, axes.top + high
    marks, texts = [], []
    for value in x_ticks:
        x, _ = axes.px(value, axes.y[0])
        marks.append(f"M{x:.2f} {low:g}v4")
        texts.append(label(x, low + 15, words[0](value) if words[0] else ""))
    for value in y_ticks:
        _, y = axes.px(axes.x[0], value)
        marks.append(f"M{left:g} {y:.2f}h-4")
        texts.append(label(left - 6, y + 3.85, words[1](value) if words[1] else "", "end"))
    middle = axes.top + high / 2
    up = label(12, middle, y_title).replace(">", f' transform="rotate(-90 12 {middle:g})">', 1)
    return (
        f'<rect x="{left:g}" y="{axes.top:g}" width="{wide:g}" height="{high:g}" fill="none" '
        'stroke="currentColor" stroke-opacity=".45"/>'
        f'<path d="{"".join(marks)}" stroke="currentColor" stroke-opacity=".6"/>{"".join(texts)}'
        f"{label(left + wide / 2, low + 29, x_title)}{up}"
    )


def steps(axis: Coordinate) -> Sequence[float]:
    """What is round on the axis of a coordinate."""
    return TURN if axis.unit == "rad" else STEPS


def cross(axes: Axes, x: float, y: float, reach: float = 7.0) -> str:
    """A cross at a place, readable on every colour; nothing outside of the box."""
    if not axes.holds(x, y):
        return ""
    u, v = axes.px(x, y)
    path = f"M{u - reach:.1f} {v:.1f}h{2 * reach:g}M{u:.1f} {v - reach:.1f}v{2 * reach:g}"
    return (
        f'<path class="here" d="{path}" stroke="#FFFFFF" stroke-width="4" stroke-opacity=".8"/>'
        f'<path d="{path}" stroke="{palette.INK}" stroke-width="1.8"/>'
    )


def runs(cells: NDArray[np.bool_]) -> Iterator[tuple[int, int, int]]:
    """Row, first column and number of the neighbours in a row that are set."""
    edges = np.diff(np.pad(cells.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    rows, first = np.nonzero(edges == 1)
    behind = np.nonzero(edges == -1)[1]
    yield from zip(rows.tolist(), first.tolist(), (behind - first).tolist(), strict=True)


def columns(axes: Axes, cells: NDArray[np.bool_]) -> str:
    """Cells (N, M) that fill the box, the second upwards, as a path of rectangles."""
    wide, high = axes.inner[0] / cells.shape[0], axes.inner[1] / cells.shape[1]
    path = []
    for column, first, count in runs(cells):
        x, y = axes.left + column * wide, axes.top + (cells.shape[1] - first - count) * high
        path.append(f"M{x:.2f} {y:.2f}h{wide:.2f}v{count * high:.2f}h{-wide:.2f}z")
    return "".join(path)


def nearest(values: Sequence[float], value: float) -> float:
    """The one of the values that a person pointed at."""
    return min(values, key=lambda known: abs(known - value))
