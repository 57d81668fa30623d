"""Plots of one family: what is seen of them, what a person does on them, and the numbers behind.

A plot is inline SVG; what a person does on it comes as text through a hidden box, see
`front/plots.js`. The drawing stays in the page while a person drags on it: what moves is a second
drawing over it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from app.language import tr
from app.widgets.axes import Bounds, Figure, Look
from app.widgets.desk import Client, Desk, answer, put_prop
from app.widgets.front import run
from app.widgets.svg import DIM, heading
from app.widgets.texts import esc

_FIT = run("window.bohemiaPlots&&bohemiaPlots.fit(this.parentElement)")


class Plot:
    """A place for a figure in a panel, and what it does when a person points at it.

    ``both``: a zoom is of both axes, to one scale. ``alone``: it stands in a window over the scene
    and is drawn as large as that; the wheel zooms, as nothing scrolls there.
    """

    ACT = "point"

    def __init__(
        self,
        desk: Desk,
        act: Callable[[float, float, Client], None],
        *,
        both: bool = False,
        alone: bool = False,
    ) -> None:
        gui = desk.gui
        self._desk, self._act, self._both, self._alone = desk, act, both, alone
        self.figure: Figure | None = None
        self.look = Look()
        self._base = gui.add_html(f'<div class="plot"{self._fitted()}></div>')
        self._over = gui.add_html("")
        # Neighbours in the page: the style hides this box, and the script finds it there.
        answer(desk, gui.add_text("Pointed at", ""), self._heard)
        self._make: Callable[[Look], Figure | None] = lambda look: None
        self._shown: tuple[object, bool] = (None, False)
        self._marks: Callable[[Figure], str] = lambda figure: ""
        self._behind = False

    def draw(
        self,
        of: object,
        make: Callable[[Look], Figure | None] = lambda look: None,
        *,
        stale: bool = False,
    ) -> None:
        """Show the figure that ``make`` makes of something, None for nothing; faded if it is of
        before. It is made again only when it is of something else, or is looked at otherwise.
        """
        if (of, stale) == self._shown:
            return
        self._shown, self._make = (of, stale), make
        self._redraw()

    def mark(self, make: Callable[[Figure], str] = lambda figure: "") -> None:
        """Show SVG elements over the figure: those that ``make`` makes for it."""
        self._marks = make
        self._cover()

    def _redraw(self) -> None:
        of, stale = self._shown
        self.figure = None if of is None else self._make(self.look)
        put_prop(self._base, "content", self._html(stale))
        self._cover()

    def _cover(self) -> None:
        marked = "" if self.figure is None or self._behind else self._marks(self.figure)
        if self.figure is None or not marked:
            put_prop(self._over, "content", "")
            return
        wide, high = self.figure.axes.width, self.figure.axes.height
        # As high as the drawing, which it is put over; the padding is that of both.
        put_prop(
            self._over,
            "content",
            f'<div class="over" style="margin-top:calc((8px - 100%)*{high / wide:.6f})">'
            f'<svg viewBox="0 0 {wide:g} {high:g}">{marked}</svg></div>',
        )

    # --- what a person does

    def _heard(self, text: str, client: Client) -> None:
        """What the browser wrote; what no plot wrote is nothing.

        How it is looked at changes the drawing, which the loop alone does.
        """
        word, *rest = text.split() or [""]
        match word:
            case "zoom":
                self._desk.ask(self._zoom, _numbers(rest, 5))
            case "size":
                self._desk.ask(self._resize, _numbers(rest, 3))
            case "whole":
                self._desk.ask(self._zoom, [])
            case "table":
                self._desk.ask(self._turn)
            case _:
                self._pointed(text, client)

    def _zoom(self, ends: Sequence[float]) -> None:
        """Show a part of the axes, from and to of both; none for the whole."""
        part: Bounds | None = None
        whole = None if self.figure is None else self.figure.axes.whole
        if ends and ends[0] < ends[1] and ends[2] < ends[3]:
            part = (ends[0], ends[1]), (ends[2], ends[3])
            if whole is not None and part[0][0] <= whole[0][0] and whole[0][1] <= part[0][1]:
                part = None
            elif not self._both:
                part = part[0], (-math.inf, math.inf)
        self._seen(replace(self.look, part=part))

    def _resize(self, size: Sequence[float]) -> None:
        if size:
            wide, high = (min(max(v, 80.0), 8000.0) for v in size[:2])
            self._seen(replace(self.look, size=(wide, high)))

    def _turn(self) -> None:
        """Show the numbers behind it, or the drawing again."""
        self._behind = not self._behind
        self._redraw()

    def _seen(self, look: Look) -> None:
        if look != self.look:
            self.look = look
            self._redraw()

    def _pointed(self, text: str, client: Client) -> None:
        """A person pointed at a place."""
        if place := _numbers(text.split(), 3):
            self._act(place[0], place[1], client)

    # --- the drawing

    def _fitted(self) -> str:
        """Has the browser tell how large it is."""
        if not self._alone:
            return ""
        size = "" if self.look.size is None else "known"
        return f' data-fit="{id(self)}" data-size="{size}"'

    def _html(self, stale: bool) -> str:
        figure = self.figure
        look = 'class="plot aged"' if stale else 'class="plot"'
        if figure is None:
            return f"<div {look}{self._fitted()}>{_FIT if self._alone else ''}</div>"
        flags = ' data-both="1"' * self._both + ' data-wheel="1"' * self._alone
        drawn = behind(figure) if self._behind else drawing(figure, self.ACT, flags)
        tools = _tools(zoomed=figure.axes.whole is not None, behind=self._behind)
        fit = _FIT if self._alone else ""
        return f"<div {look}{self._fitted()}>{drawn}{tools}{fit}</div>"


MOST = 600  # points of a stroke that the browser sends


def drawing(figure: Figure, act: str = "point", flags: str = "") -> str:
    """A figure with what the browser needs to answer the pointer; ``flags`` are attributes."""
    a = figure.axes
    box = " ".join(f"{v:.12g}" for v in (a.left, a.top, *a.inner, *a.x, *a.y))
    span = "" if figure.span is None else " ".join(f"{v:.12g}" for s in figure.span for v in s)
    end = a.width - a.right
    return (
        f'<svg viewBox="0 0 {a.width:g} {a.height:g}" role="img" '
        f'aria-label="{esc(figure.name)}" font-size="11" data-box="{box}" '
        f'data-act="{act}"{flags} data-span="{span}" data-most="{MOST}" '
        f'data-grid="{len(figure.columns)} {len(figure.rows)}" '
        f'data-columns="{_listed(figure.columns)}" data-rows="{_listed(figure.rows)}" '
        f'data-tips="{_listed(figure.tips)}" data-idle="{esc(figure.idle)}">'
        f'<rect width="{a.width:g}" height="{a.height:g}" fill="transparent"/>{figure.content}'
        f'<rect class="band" x="0" y="{a.top:g}" width="0" height="{a.inner[1]:g}" '
        f'fill="currentColor" fill-opacity="0.12"/>'
        f"{heading(a.left, a.top - 9, figure.title, figure.unit)}"
        f'<text class="tip" x="{end:g}" y="{a.top - 9:g}" text-anchor="end" '
        f'fill="{DIM}">{esc(figure.idle)}</text></svg>'
    )


def behind(figure: Figure) -> str:
    """The numbers of a figure as a table, as high as its drawing."""
    heads, rows = figure.table()
    a = figure.axes
    head = "".join(f'<th scope="col">{esc(text)}</th>' for text in heads)
    body = "".join(f"<tr>{''.join(f'<td>{esc(text)}</td>' for text in row)}</tr>" for row in rows)
    return (
        f'<div class="behind" tabindex="0" role="region" '
        f'aria-label="{esc(tr("plots.table_of", name=figure.name))}" '
        f'style="aspect-ratio:{a.width:g}/{a.height:g}"><table><caption>{esc(figure.name)}'
        f"</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _tools(*, zoomed: bool, behind: bool) -> str:
    """Small buttons at the foot of a plot."""
    known = [("whole", "whole")] * zoomed + [("copy", "copy")] * (not behind)
    known.append(("table", "plot" if behind else "table"))
    made = "".join(
        f'<button type="button" data-do="{do}" title="{esc(tr(f"plots.{text}_hint"))}">'
        f"{esc(tr(f'plots.{text}'))}</button>"
        for do, text in known
    )
    return f'<div class="tools">{made}</div>'


def _numbers(words: Sequence[str], count: int) -> list[float]:
    """So many finite numbers; none where something else stands there."""
    try:
        values = [float(word) for word in words]
    except ValueError:
        return []
    return values if len(values) == count and all(map(math.isfinite, values)) else []


def _listed(texts: Sequence[str]) -> str:
    return esc("|".join(text.replace("|", "/") for text in texts))
