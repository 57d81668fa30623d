"""What a report consists of, before it is a page or a PDF: both are written from these.

Pictures are SVG of the page's plot family; colours may be the variables of the page's style sheet,
each with its light colour.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from app.features.report.packing import Packed

Span = tuple[float, float | None, str]
"""Of a bar from 0 to 1: from, to (None for a mark) and the colour."""
Tone = Literal["", "good", "near", "bad", "quiet"]


@dataclass(frozen=True, slots=True)
class Run:
    """A piece of text with one look.

    Attributes:
        color: CSS; "" as the text around it.
        script: raised or lowered.
        chip: a small square of this colour before it.
        bar: lengths instead of a text.
        picture: a small SVG instead of a text, which then says it.
    """

    text: str
    bold: bool = False
    color: str = ""
    script: Literal["", "sup", "sub"] = ""
    chip: str = ""
    bar: tuple[Span, ...] = ()
    picture: str = ""


Runs = tuple[Run, ...]


def said(text: str, color: str = "", *, bold: bool = False, chip: str = "") -> Runs:
    """A text with one look."""
    return (Run(text, bold, color, chip=chip),)


def plain(runs: Runs) -> str:
    """What runs say, without their look."""
    return "".join(run.text for run in runs)


@dataclass(frozen=True, slots=True)
class Words:
    """A paragraph."""

    runs: Runs
    tone: Tone = ""


@dataclass(frozen=True, slots=True)
class Table:
    """A table: a head for each column, and rows of cells.

    Attributes:
        numeric: which columns hold numbers, set to the right.
        marked: the rows that are about the present state.
        titled: the first cell of a row is its head.
    """

    caption: str
    heads: tuple[str, ...]
    rows: tuple[tuple[Runs, ...], ...]
    numeric: tuple[bool, ...] = ()
    marked: frozenset[int] = frozenset()
    titled: bool = True
    note: Runs = ()


@dataclass(frozen=True, slots=True)
class Figure:
    """A drawing: a whole ``<svg>``, what stands below it, and what it is for who does not see it.

    ``share``: of the width of the text.
    """

    svg: str
    caption: str
    alt: str
    share: float = 1.0


@dataclass(frozen=True, eq=False, slots=True)
class Scene:
    """The machine to be turned; where there is no script, or on paper, its picture stands."""

    packed: Packed
    still: Figure


Block = Words | Table | Figure | Scene


@dataclass(frozen=True, slots=True)
class Section:
    """A heading with what is below it."""

    title: str
    blocks: tuple[Block, ...]
    fresh: bool = False  # begins a page on paper


@dataclass(frozen=True, slots=True)
class Chapter:
    """What is told of one design, or of several beside one another.

    Attributes:
        letter: by which a design is called where there are several; "".
        name: of the design, as files call it.
        subtitle: where it comes from.
    """

    title: str
    subtitle: str
    sections: tuple[Section, ...]
    letter: str = ""
    name: str = ""


@dataclass(frozen=True, slots=True)
class Report:
    """All of it.

    Attributes:
        facts: when it was made and by what, a text each.
        foot: stands below every page of paper.
    """

    title: str
    facts: tuple[str, ...]
    foot: str
    chapters: tuple[Chapter, ...] = field(default=())


def table(
    caption: str,
    heads: Sequence[str],
    rows: Sequence[Sequence[Runs | str]],
    numeric: Sequence[int] = (),
    *,
    marked: Sequence[int] = (),
    note: str = "",
) -> Table:
    """A table of texts and runs; ``numeric`` are the indices of columns with numbers."""
    cells = tuple(tuple(said(c) if isinstance(c, str) else c for c in row) for row in rows)
    right = tuple(n in numeric for n in range(len(heads)))
    return Table(
        caption, tuple(heads), cells, right, frozenset(marked), note=said(note) if note else ()
    )
