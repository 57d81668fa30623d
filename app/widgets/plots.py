"""Plots that a person can point at: inline SVG whose pointer events reach the server.

viser reports no clicks on HTML. So the drawing's own handlers turn the pointer's place into the
plot's units and write it into a text box beside it, hidden, that viser does report. What is under
the pointer is told by the drawing itself, without the server. The drawing stays in the page while
a person drags on it: what moves is a second drawing that lies over it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from app.widgets.axes import Figure
from app.widgets.desk import Client, Desk, answer, put_prop
from app.widgets.texts import esc

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
    ".plot svg,.over svg{display:block;width:100%;height:auto;font-family:inherit;font-size:11px}"
    ".plot svg[data-box]{touch-action:none;user-select:none;cursor:crosshair}"
    ".over{pointer-events:none;position:relative}</style>"
)


class Plot:
    """A place for a figure in a panel, and what it does when a person points at it."""

    script = _POINT

    def __init__(self, desk: Desk, act: Callable[[float, float, Client], None]) -> None:
        gui = desk.gui
        self._act = act
        self._base = gui.add_html(_base(None, self.script))
        self._over = gui.add_html("")
        # Neighbours in the page: the style hides this box, and the script finds it there.
        answer(desk, gui.add_text("Pointed at", ""), self._pointed)
        self.figure: Figure | None = None
        self._shown: tuple[object, bool] = (None, False)
        self._marked = ""

    def draw(
        self, of: object, make: Callable[[], Figure | None] = lambda: None, *, stale: bool = False
    ) -> None:
        """Show the figure that ``make`` makes of something, None for nothing; faded if it is of
        before. It is made again only when it is of something else.
        """
        if (of, stale) == self._shown:
            return
        self._shown = of, stale
        self.figure = None if of is None else make()
        base = _base(self.figure, self.script)
        if stale:
            base = base.replace('class="plot"', 'class="plot aged"', 1)
        put_prop(self._base, "content", base)
        self._cover()

    def mark(self, content: str) -> None:
        """Show SVG elements over the figure."""
        if content != self._marked:
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

    def _pointed(self, text: str, client: Client) -> None:
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
