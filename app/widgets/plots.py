"""Plots that a person can point at: inline SVG whose pointer events reach the server.

viser reports no clicks on HTML. So the drawing's own handlers turn the pointer's place into the
plot's units and write it into a text box beside it, hidden, that viser does report. What is under
the pointer is told by the drawing itself, without the server. The drawing stays in the page while
a person drags on it: what moves is a second drawing that lies over it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import viser

from app.widgets.desk import Desk, answer, esc, put_prop

Range = tuple[float, float]
STEPS = (1.0, 2.0, 5.0)  # round numbers, times powers of ten
TURN = (1.5, 3.0, 4.5, 9.0)  # round degrees, times powers of ten

# Runs in the browser for every pointer event on a plot; `s` is the drawing, `e` the event. First
# where the pointer is in the box, u and v from 0 to 1, and what the drawing tells of it.
WHERE = """
const d=s.dataset,b=d.box.split(' ').map(Number),
p=new DOMPoint(e.clientX,e.clientY).matrixTransform(s.getScreenCTM().inverse()),
u=(p.x-b[0])/b[2],v=1-(p.y-b[1])/b[3],inside=u>=0&&u<=1&&v>=0&&v<=1,
t=s.querySelector('.tip');
if(t){const n=d.grid.split(' ').map(Number),a=s.tips||(s.tips=d.tips.split('|')),
x=Math.min(Math.floor(u*n[0]),n[0]-1),y=Math.min(Math.floor(v*n[1]),n[1]-1);
t.textContent=inside&&e.type!=='pointerleave'?d.columns.split('|')[x]+d.rows.split('|')[y]
+a[x*n[1]+y]:d.idle;}
const c=(w)=>Math.min(Math.max(w,0),1),
at=(u,v)=>(b[4]+c(u)*(b[5]-b[4]))+' '+(b[6]+c(v)*(b[7]-b[6])),
send=(text)=>{const i=s.closest('.plot').parentElement.nextElementSibling.nextElementSibling
.querySelector('input');
Object.getOwnPropertyDescriptor(HTMLInputElement.prototype,'value').set.call(i,text);
i.dispatchEvent(new Event('input',{bubbles:true}));};
"""
# Then what a plot does with it: every place is reported, while the button is held.
_POINT = """
if(e.type==='pointerdown'){if(!inside||e.button)return;s.held=1;s.setPointerCapture(e.pointerId);}
if(!s.held)return;
if(e.type==='pointermove'&&e.timeStamp-s.sent<60)return;
s.sent=e.timeStamp;
send(at(u,v)+' '+e.timeStamp);
if(e.type!=='pointerdown'&&e.type!=='pointermove')s.held=0;
"""
_EVENTS = ("pointerdown", "pointermove", "pointerup", "pointercancel", "pointerleave")
_STYLE = (
    "<style>div:has(>.plot)+div+div{visibility:hidden;position:absolute;height:0;overflow:hidden}"
    ".plot svg,.over svg{display:block;width:100%;height:auto;font-family:inherit}"
    ".plot svg[data-box]{touch-action:none;user-select:none;cursor:crosshair}"
    ".over{pointer-events:none;position:relative}</style>"
)


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


class Plot:
    """A place for a figure in a panel, and what it does when a person points at it."""

    script = _POINT

    def __init__(
        self, desk: Desk, act: Callable[[float, float, viser.ClientHandle | None], None]
    ) -> None:
        gui = desk.gui
        self._act = act
        self._base = gui.add_html(_base(None, self.script))
        self._over = gui.add_html("")
        # Neighbours in the page: the style hides this box, and the script finds it there.
        answer(desk, gui.add_text("Pointed at", ""), self._pointed)
        self.figure: Figure | None = None
        self._marked = ""

    def draw(self, figure: Figure | None) -> None:
        """Show a figure, None for nothing."""
        if figure != self.figure:
            self.figure = figure
            put_prop(self._base, "content", _base(figure, self.script))
            self._cover()

    def mark(self, content: str) -> None:
        """Show SVG elements over the figure."""
        self._marked = content
        self._cover()

    def _cover(self) -> None:
        if self.figure is None or not self._marked:
            put_prop(self._over, "content", "")
            return
        axes = self.figure.axes
        put_prop(
            self._over,
            "content",
            f'<div class="over" style="margin-top:-{100 * axes.height / axes.width:.4f}%">'
            f'<svg viewBox="0 0 {axes.width:g} {axes.height:g}">{self._marked}</svg></div>',
        )

    def _pointed(self, text: str, client: viser.ClientHandle | None) -> None:
        """A person pointed at a place; what no plot wrote is nothing."""
        try:
            x, y, _ = map(float, text.split())
        except ValueError:
            return
        if math.isfinite(x) and math.isfinite(y):
            self._act(x, y, client)


def _base(figure: Figure | None, act: str = _POINT) -> str:
    if figure is None:
        return f'{_STYLE}<div class="plot"></div>'
    a = figure.axes
    box = " ".join(f"{v:.12g}" for v in (a.left, a.top, *a.inner, *a.x, *a.y))
    script = esc(f"(function(s,e){{{WHERE}{act}}})(this,event)".replace("\n", " "))
    handlers = " ".join(f'on{event}="{script}"' for event in _EVENTS)
    return (
        f'{_STYLE}<div class="plot"><svg viewBox="0 0 {a.width:g} {a.height:g}" role="img" '
        f'aria-label="{esc(figure.name)}" font-size="11" data-box="{box}" '
        f'data-grid="{len(figure.columns)} {len(figure.rows)}" '
        f'data-columns="{_listed(figure.columns)}" data-rows="{_listed(figure.rows)}" '
        f'data-tips="{_listed(figure.tips)}" data-idle="{esc(figure.idle)}" {handlers}>'
        f'<rect width="{a.width:g}" height="{a.height:g}" fill="transparent"/>{figure.content}'
        f'<text class="tip" x="{a.left:g}" y="{a.top - 7:g}" fill="currentColor">'
        f"{esc(figure.idle)}</text></svg></div>"
    )


def _listed(texts: Sequence[str]) -> str:
    return esc("|".join(text.replace("|", "/") for text in texts))


def ticks(low: float, high: float, most: int, steps: Sequence[float] = STEPS) -> list[float]:
    """At most so many round numbers from low to high; ``steps`` says what is round."""
    raw = (high - low) / max(most, 1)
    decades = 10.0 ** np.arange(math.floor(math.log10(raw)) - 2, math.log10(raw) + 2)
    round_ = np.sort(np.outer(decades, steps).ravel())
    step = float(round_[np.searchsorted(round_, raw * (1 - 1e-9))])
    return [n * step for n in range(math.ceil(low / step), math.floor(high / step + 1e-9) + 1)]


def scales(
    axes: Axes, x_title: str, y_title: str, x_ticks: Sequence[float], y_ticks: Sequence[float]
) -> str:
    """The box of a plot with ticks and titles, in the page's own colour."""
    wide, high = axes.inner
    low = axes.top + high
    parts = [
        f'<rect x="{axes.left:g}" y="{axes.top:g}" width="{wide:g}" height="{high:g}" fill="none" '
        'stroke="currentColor" stroke-opacity=".45"/>'
    ]
    for value in x_ticks:
        x, _ = axes.px(value, axes.y[0])
        parts.append(
            f'<path d="M{x:.1f} {low:g}v4" stroke="currentColor" stroke-opacity=".6"/>'
            f'<text x="{x:.1f}" y="{low + 15:g}" text-anchor="middle" fill="currentColor">'
            f"{number(value)}</text>"
        )
    for value in y_ticks:
        _, y = axes.px(axes.x[0], value)
        parts.append(
            f'<path d="M{axes.left:g} {y:.1f}h-4" stroke="currentColor" stroke-opacity=".6"/>'
            f'<text x="{axes.left - 6:g}" y="{y + 3.8:.1f}" text-anchor="end" fill="currentColor">'
            f"{number(value)}</text>"
        )
    middle = axes.top + high / 2
    parts.append(
        f'<text x="{axes.left + wide / 2:g}" y="{low + 29:g}" text-anchor="middle" '
        f'fill="currentColor">{esc(x_title)}</text>'
        f'<text x="12" y="{middle:g}" text-anchor="middle" fill="currentColor" '
        f'transform="rotate(-90 12 {middle:g})">{esc(y_title)}</text>'
    )
    return "".join(parts)


def nearest(values: Sequence[float], value: float) -> float:
    """The one of the values that a person pointed at."""
    return min(values, key=lambda known: abs(known - value))


def number(value: float) -> str:
    """A tick's number, with a minus sign as wide as a digit."""
    return f"{value + 0.0:.6g}".replace("-", "−")
