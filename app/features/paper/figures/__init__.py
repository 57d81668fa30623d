"""Figures, solids and tables of the items, as the content of files; nothing of the papers' own."""

from __future__ import annotations

from importlib import import_module

from app.features.paper.figures.drawers import Files, files_of
from app.features.paper.items import Item

__all__ = ["Files", "drawn"]

_ROOMS = {
    "meccanica-2011": ("rpur", "rpur_solids"),
    "icee-2010": ("rpur", "rpur_solids"),
    "sps-spr-2017": (),
    "rps-spr-2017": ("tripods",),
    "five-bar-2017": ("five_bar",),
}


def drawn(item: Item) -> Files:
    """The files of an item by name; none of those that nobody draws."""
    for room in _ROOMS[item.paper]:
        import_module(f"app.features.paper.figures.{room}")
    return files_of(item)
