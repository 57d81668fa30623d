"""The source papers item by item, as `assets/papers` has them: what is printed, what is missing."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from kinematics.designs.assets import asset_folder
from kinematics.errors import InputError

PAPERS = (
    "meccanica-2011",
    "icee-2010",
    "sps-spr-2017",
    "rps-spr-2017",
    "five-bar-2017",
)
"""In the order in which they are told."""
_WORDS = ("item", "what", "printed", "picture", "correction", "missing", "remark")


@dataclass(frozen=True, slots=True)
class Item:
    """One table, figure, numbered equation or claim (C) of a paper.

    Attributes:
        paper: the name of the paper.
        name: "Table 1", "Fig. 9", "eq. 12", "C7".
        what: what it is.
        printed: as printed; "" where nothing is, as of most figures.
        picture: of figures, what theirs shows, in words.
        correction: what is misprinted, told where the program finds that the printed form fails.
        missing: the datum without which it cannot be recomputed.
        remark: told in any case.
        data: printed numbers that are compared or computed with.
    """

    paper: str
    name: str
    what: str
    printed: str = ""
    picture: str = ""
    correction: str = ""
    missing: str = ""
    remark: str = ""
    data: Mapping[str, Any] = field(default_factory=dict, hash=False)

    @property
    def is_figure(self) -> bool:
        return self.name.startswith("Fig.")

    @property
    def stem(self) -> str:
        """Of its files: "fig-3a", "table-1"."""
        plain = self.name.lower().replace(". ", "-").replace(" ", "-")
        return "".join(letter for letter in plain if letter.isalnum() or letter == "-")


@dataclass(frozen=True, slots=True)
class Paper:
    """A paper: its bibliography, the presets that are its machines, and its items."""

    name: str
    title: str
    authors: str
    source: str
    text: str
    designs: tuple[str, ...]
    items: tuple[Item, ...]

    def item(self, name: str) -> Item:
        """One of its items."""
        return next(item for item in self.items if item.name == name)


@cache
def paper(name: str) -> Paper:
    """A paper by its name.

    Raises:
        InputError: there is none.
    """
    if name not in PAPERS:
        raise InputError(f"there is no paper {name!r}; known are {', '.join(PAPERS)}")
    path = asset_folder("papers") / f"{name}.toml"
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    return Paper(
        name=table["name"],
        title=table["title"],
        authors=table["authors"],
        source=table["source"],
        text=table["text"],
        designs=tuple(table["designs"]),
        items=tuple(_item(name, entry) for entry in table["item"]),
    )


def _item(paper: str, entry: Mapping[str, Any]) -> Item:
    texts = {key: entry.get(key, "") for key in _WORDS[1:]}
    data = {key: value for key, value in entry.items() if key not in _WORDS}
    return Item(paper=paper, name=entry["item"], data=data, **texts)
