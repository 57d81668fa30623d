"""A plot in which a person draws a path with the mouse."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from app.features.trajectory.compute import Reach
from app.scene import palette
from app.widgets.axes import Axes, Figure, columns, cross, named, named_scales, pointed
from app.widgets.desk import Client, Desk
from app.widgets.plots import Plot
from app.widgets.svg import line, tag
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

    def __init__(self, desk: Desk, act: Callable[[Array, Client], None]) -> None:
        super().__init__(desk, lambda _x, _y, _client: None)
        self._stroked = act

    def _pointed(self, text: str, client: Client) -> None:
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
        (c.outer(low), c.outer(high)) for c, (low, high) in zip(axes, reach.bounds, strict=True)
    )
    return Axes(SIZE, SIZE - 8, 46, 22, 12, 38, x, y)


def sketch_figure(axes: Sequence[Coordinate], reach: Reach) -> Figure:
    """The plane of two coordinates, shaded where the machine can be."""
    box = sketch_axes(axes, reach)
    first, second = axes
    names = named(first), named(second)
    look = {"class_": "reach", "fill_opacity": 0.4, "shape_rendering": "crispEdges"}
    trace = {"points": "", "fill": "none", "stroke": "currentColor", "stroke_width": 2}
    return Figure(
        box,
        tag("path", d=columns(box, reach.inside), fill=palette.WORKSPACE, **look)
        + _lost(axes, box, reach)
        + named_scales(box, *names)
        + tag("polyline", class_="trace", **trace),
        *pointed(box, *names, CELLS),
        [""] * CELLS**2,
        "Hold the mouse button and draw the path",
        f"The plane of {first.symbol} and {second.symbol}",
    )


def _lost(axes: Sequence[Coordinate], box: Axes, reach: Reach) -> str:
    """The curves where control is lost, as far as they are within the box."""
    path = "".join(box.path(_in_page(axes, curve)) for curve in reach.lost)
    return box.clipped(line(path, palette.BEYOND, 2, class_="lost")) if path else ""


def _in_page(axes: Sequence[Coordinate], points: Array) -> list[tuple[float, float]]:
    """Points (N, 2), mm and rad, in the page's units."""
    return [(axes[0].outer(x), axes[1].outer(y)) for x, y in points.tolist()]


def sketch_mark(axes: Sequence[Coordinate], box: Axes, path: Array, here: Sequence[float]) -> str:
    """The path (N, 2), mm and rad, and a cross where the machine stands."""
    drawn = ""
    if len(path):
        points = _in_page(axes, path)
        x, y = box.px(*points[0])
        drawn = line(box.path(points), palette.WORKSPACE_DEEP, 2.4, class_="stroke")
        drawn += tag("circle", cx=x, cy=y, r=4, fill=palette.WORKSPACE_DEEP)
    u, v = (c.outer(value) for c, value in zip(axes, here, strict=True))
    return drawn + cross(box, u, v)
