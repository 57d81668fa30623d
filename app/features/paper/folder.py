"""The folder that `bohemia paper -o` writes: figures, tables, solids, and one page for all."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from app.features.paper import figures
from app.features.paper.html import page
from app.features.paper.items import Item, Paper
from app.features.paper.judging import as_json
from app.features.paper.registry import Recomputed
from kinematics.storage import csv_text, write_file

PAGE = "index.html"
COLUMNS = ("paper", "item", "what", "verdict", "quantity", "printed", "computed", "unit", "digits")


def write(
    to: Path,
    papers: Sequence[Paper],
    found: Mapping[str, Sequence[Recomputed]],
    show: Callable[[str], None],
) -> list[str]:
    """Write everything about papers into a folder that exists; the names of the files.

    Raises:
        InputError: a file cannot be written.
    """
    written: dict[str, bytes] = {}
    shown: dict[tuple[str, str], figures.Files] = {}
    for paper in papers:
        written[f"{paper.name}.csv"] = items_csv(found[paper.name]).encode()
        for item in paper.items:
            show(f"{paper.name}: drawing {item.name} …")
            files = figures.drawn(item)
            shown[item.paper, item.name] = files
            written |= {_place(item, name): data for name, data in files.items()}
    written[PAGE] = page(papers, found, shown, _place).encode()
    for name, data in written.items():
        place = to / name
        place.parent.mkdir(parents=True, exist_ok=True)
        write_file(place, data)
    return list(written)


def _place(item: Item, name: str) -> str:
    """Where a file of an item stands in the folder."""
    return f"{item.paper}/{name}"


def items_csv(found: Sequence[Recomputed]) -> str:
    """One row a computed value, or one an item that has none."""
    rows: list[Sequence[object]] = [COLUMNS]
    for each in found:
        head = (each.item.paper, each.item.name, each.item.what, each.verdict)
        for quantity in each.outcome.quantities:
            told = as_json(quantity)
            keys = ("what", "printed", "computed", "unit", "digits")
            values = ("" if told[key] is None else told[key] for key in keys)
            rows.append([*head, *(v if isinstance(v, str) else json.dumps(v) for v in values)])
        if not each.outcome.quantities:
            rows.append([*head, "", each.item.printed, "", "", ""])
    return csv_text(rows)
