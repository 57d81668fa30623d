"""A plot in which a person draws a path with the mouse."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np
import viser

from app.features.trajectory.compute import Reach
from app.review.units import in_page_units, page_unit
from app.scene import palette
from app.widgets.desk import Desk
from app.widgets.plots import STEPS, TURN, Axes, Figure, Plot, number, scales, ticks
from kinematics.arrays import Array
from kinematics.mechanism import Coordinate

MOST = 600  # points of a stroke that the browser sends
CELLS = 120  # columns and rows of which the place under the pointer is told
SIZE = 380.0

# The stroke is drawn by the browser itself while the button is held, and sent whole at the end.
_DRAW = f"""
const g=s.querySelector('.trace'),put=()=>g.setAttribute('points',
s.trace.map(q=>(b[0]+q[0]*b[2])+','+(b[1]+(1-q[1])*b[3])).join(' '));
if(e.type==='pointerdown'){{if(!inside||e.button)return;s.held=1;s.trace=[];
s.setPointerCapture(e.pointerId);}}
if(!s.held)return;
const l=s.trace[s.trace.length-1],w=[c(u),c(v)];
if(!l||Math.hypot((w[0]-l[0])*b[2],(w[1]-l[1])*b[3])>1.5)s.trace.push(w);
put();
if(e.type==='pointerup'||e.type==='pointercancel'){{s.held=0;
const k=Math.ceil(s.trace.length/{MOST});
if(s.trace.length>1)send(s.trace.filter((q,n)=>n%k===0||n===s.trace.length-1)
.map(q=>at(q[0],q[1])).join(' ')+' '+e.timeStamp);
setTimeout(()=>{{if(!s.held){{s.trace=[];put();}}}},1500);}}
"""


class Sketch(Plot):
    """A plot whose ``act`` is called with a whole stroke, (N, 2) in the plot's units."""

    script = _DRAW

    def __init__(self, desk: Desk, act: Callable[[Array, viser.ClientHandle | None], None]) -> None:
        super().__init__(desk, lambda _x, _y, _client: None)
        self._stroked = act

    def _pointed(self, text: str, client: viser.ClientHandle | None) -> None:
        stroke = read_stroke(text)
        if stroke is not None:
            self._stroked(stroke, client)


def read_stroke(text: str) -> Array | None:
    """The points (N, 2) of a stroke as the browser writes it; what it never wrote is nothing."""
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return None
    if len(values) < 5 or len(values) % 2 == 0 or not all(map(math.isfinite, values)):
        return None
    return np.array(values[:-1]).reshape(-1, 2)[: MOST + 1]


def sketch_axes(axes: Sequence[Coordinate], reach: Reach) -> Axes:
    """The plot's box, in the page's units."""
    x, y = (
        (in_page_units(c, low), in_page_units(c, high))
        for c, (low, high) in zip(axes, reach.bounds, strict=True)
    )
    return Axes(SIZE, SIZE - 8, 46, 22, 12, 38, x, y)


def sketch_figure(axes: Sequence[Coordinate], reach: Reach) -> Figure:
    """The plane of two coordinates, shaded where the machine can be."""
    box = sketch_axes(axes, reach)
    rows, cells = len(reach.inside), []
    wide, high = box.inner[0] / rows, box.inner[1] / rows
    for n, column in enumerate(reach.inside):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], column.astype(int), [0]])))
        for start, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            x, y = box.left + n * wide, box.top + (rows - end) * high
            cells.append(f"M{x:.2f} {y:.2f}h{wide:.2f}v{(end - start) * high:.2f}h{-wide:.2f}z")
    first, second = axes
    middles = (np.arange(CELLS) + 0.5) / CELLS
    xs, ys = (low + middles * (high - low) for low, high in (box.x, box.y))
    content = (
        f'<path class="reach" d="{"".join(cells)}" fill="{palette.WORKSPACE}" fill-opacity=".4" '
        'shape-rendering="crispEdges"/>'
        + _lost(axes, box, reach)
        + scales(
            box,
            f"{first.symbol} ({page_unit(first)})",
            f"{second.symbol} ({page_unit(second)})",
            ticks(*box.x, 6, TURN if first.unit == "rad" else STEPS),
            ticks(*box.y, 6, TURN if second.unit == "rad" else STEPS),
        )
        + '<polyline class="trace" points="" fill="none" stroke="currentColor" stroke-width="2"/>'
    )
    return Figure(
        box,
        content,
        [f"{first.symbol} = {number(round(x, 1))} {page_unit(first)}, " for x in xs.tolist()],
        [f"{second.symbol} = {number(round(y, 1))} {page_unit(second)}" for y in ys.tolist()],
        [""] * CELLS**2,
        "Hold the mouse button and draw the path",
        f"The plane of {first.symbol} and {second.symbol}",
    )


def _lost(axes: Sequence[Coordinate], box: Axes, reach: Reach) -> str:
    """The curves where control is lost, as far as they are within the box."""
    runs = [run for curve in reach.lost for run in _within(axes, box, curve)]
    path = "".join(f"M{'L'.join(run)}" for run in runs)
    if not path:
        return ""
    return f'<path class="lost" d="{path}" fill="none" stroke="{palette.BEYOND}" stroke-width="2"/>'


def _within(axes: Sequence[Coordinate], box: Axes, curve: Array) -> Iterator[list[str]]:
    """The parts of a curve (N, 2), mm and rad, that are within the box, as places in px."""
    run: list[str] = []
    for first, second in curve.tolist():
        x, y = in_page_units(axes[0], first), in_page_units(axes[1], second)
        if box.x[0] <= x <= box.x[1] and box.y[0] <= y <= box.y[1]:
            run.append("{:.1f} {:.1f}".format(*box.px(x, y)))
            continue
        if len(run) > 1:
            yield run
        run = []
    if len(run) > 1:
        yield run


def sketch_mark(axes: Sequence[Coordinate], box: Axes, path: Array, here: Sequence[float]) -> str:
    """The path (N, 2), mm and rad, and a cross where the machine stands."""
    points = [
        box.px(in_page_units(axes[0], x), in_page_units(axes[1], y)) for x, y in path.tolist()
    ]
    line = ""
    if points:
        places = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
        x, y = points[0]
        line = (
            f'<path class="stroke" d="M{places}" fill="none" stroke="{palette.WORKSPACE_DEEP}" '
            f'stroke-width="2.4"/><circle cx="{x:.1f}" cy="{y:.1f}" r="4" '
            f'fill="{palette.WORKSPACE_DEEP}"/>'
        )
    u, v = (in_page_units(c, value) for c, value in zip(axes, here, strict=True))
    if not (box.x[0] <= u <= box.x[1] and box.y[0] <= v <= box.y[1]):
        return line
    x, y = box.px(u, v)
    cross = f"M{x - 7:.1f} {y:.1f}h14M{x:.1f} {y - 7:.1f}v14"
    return f'{line}<path d="{cross}" stroke="{palette.INK}" stroke-width="1.8"/>'
