"""Who draws which item, and how its parts become files."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from app.features.paper.items import Item
from app.scene.palette import INK
from app.terminal.files import picture
from kinematics.storage import csv_text

if TYPE_CHECKING:  # loaded only where a figure is drawn
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Files = dict[str, bytes]
"""The content of files by name."""
Drawer = Callable[[Item], Files]

_known: dict[tuple[str, str], Drawer] = {}


def draws(paper: str, *names: str) -> Callable[[Drawer], Drawer]:
    """Makes a function the one that draws these items of a paper."""

    def known(function: Drawer) -> Drawer:
        for name in names:
            _known[paper, name] = function
        return function

    return known


def files_of(item: Item) -> Files:
    """What an item's drawer makes of it."""
    function = _known.get((item.paper, item.name))
    return {} if function is None else function(item)


def pictures(item: Item, figure: Figure) -> Files:
    """A figure as vectors and as a picture."""
    return {f"{item.stem}.{kind}": picture(figure, kind) for kind in ("svg", "png")}


def table(item: Item, header: Iterable[str], rows: Iterable[Iterable[object]]) -> Files:
    """A table as CSV."""
    return {f"{item.stem}.csv": csv_text([list(header), *map(list, rows)]).encode()}


def figure(wide: float = 7.2, high: float = 4.6) -> Figure:
    """An empty figure, inches."""
    from matplotlib.figure import Figure as New

    return New(figsize=(wide, high), layout="constrained")


def axes(page: Figure, *, across: int = 1, equal: bool = False, **more: Any) -> list[Axes]:
    """Panels with axes left and below."""
    panels: list[Axes] = list(page.subplots(1, across, squeeze=False, **more)[0])
    for panel in panels:
        for side in ("top", "right"):
            panel.spines[side].set_visible(False)
        panel.tick_params(labelsize=8, colors=INK)
        if equal:
            panel.set_aspect("equal", adjustable="datalim")
    return panels


def named(panel: Axes, x: str, y: str, title: str = "") -> None:
    """Names of the axes."""
    panel.set_xlabel(x, fontsize=9, color=INK)
    panel.set_ylabel(y, fontsize=9, color=INK)
    panel.set_title(title, fontsize=10, color=INK)
