"""What the page says, taken over: its small pieces of HTML become tables and paragraphs.

So a report has the page's own words and numbers, and changes with them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from lxml import html

from app.features.report.model import Block, Run, Runs, Span, Table, Words, plain
from app.review.units import sentence
from app.widgets.svg import DIM

_SPACE = re.compile(r"\s+")
_LEFT, _WIDE = re.compile(r"left:([\d.]+)%"), re.compile(r"width:([\d.]+)%")
_BACK = re.compile(r"background:([^;]+)")
_COLOR = re.compile(r"(?<![\w-])color:([^;]+)")
_BLOCKS = frozenset({"div", "p", "table", "br", "details", "summary"})
_LEFT_OUT = frozenset({"button", "input", "style", "script"})
"""What can only be pressed or typed into."""


def read(piece: str, caption: str = "", *, heads: tuple[str, ...] = ()) -> tuple[Block, ...]:
    """The blocks of a piece of the page's HTML.

    Args:
        caption: of its tables.
        heads: of the columns of its tables where it has none.
    """
    if not piece.strip():
        return ()
    found: list[Block] = []
    runs: list[Run] = []

    def end() -> None:
        if told := _trimmed(tuple(runs)):
            first = replace(told[0], text=sentence(told[0].text))
            found.append(Words((first, *told[1:])))
        runs.clear()

    def walk(element: Any, look: Run) -> None:
        look = _look(element, look)
        if element.tag == "table":
            end()
            found.append(_table(element, caption, heads))
            return
        if (one := _atom(element, look)) is not None:
            runs.append(one)
            return
        block = element.tag in _BLOCKS
        beside = "float:right" in element.get("style", "")  # at the other end of its line
        if block:
            end()
        if element.text:
            runs.append(replace(look, text=element.text))
        for child in element:
            if child.tag not in _LEFT_OUT:
                walk(child, look)
            if child.tail:
                runs.append(replace(look, text=child.tail))
        if block:
            end()
        elif beside:
            runs.append(Run(" · "))

    walk(html.fragment_fromstring(piece, create_parent="div"), Run(""))
    end()
    return tuple(found)


def runs_of(piece: str) -> Runs:
    """A piece of the page's HTML as one line."""
    blocks = read(piece)
    return tuple(run for block in blocks if isinstance(block, Words) for run in block.runs)


def _look(element: Any, look: Run) -> Run:
    """How text in an element looks, if text around it looks so."""
    tag, style = element.tag, element.get("style", "")
    bold = look.bold or tag in ("b", "strong", "th") or "font-weight:600" in style
    color = _COLOR.search(style)
    faint = "opacity:" in style and not look.color
    script = tag if tag in ("sup", "sub") else look.script
    tint = color.group(1) if color else DIM if faint else look.color
    return replace(look, bold=bold, script=script, color=tint)


def _atom(element: Any, look: Run) -> Run | None:
    """What is no text: a chip of a colour, lengths, a small picture."""
    style, back = element.get("style", ""), _BACK.search(element.get("style", ""))
    if element.tag == "span" and back and not element.text and not len(element):
        return replace(look, text="", chip=back.group(1))
    if element.tag == "svg":
        drawn = html.tostring(element, encoding="unicode", with_tail=False)
        return replace(look, text="", picture=drawn)
    if element.tag == "div" and "position:relative" in style and "height:" in style:
        return replace(look, text="", bar=tuple(_spans(element)))
    return None


def _spans(track: Any) -> Iterator[Span]:
    """What lies on a bar, as `app.widgets.texts.track` writes it."""
    for part in track:
        style = part.get("style", "")
        left, wide, back = (p.search(style) for p in (_LEFT, _WIDE, _BACK))
        if left is None or back is None:
            continue
        low = float(left.group(1)) / 100.0
        yield low, None if wide is None else low + float(wide.group(1)) / 100.0, back.group(1)


def _table(element: Any, caption: str, heads: tuple[str, ...]) -> Table:
    rows: list[tuple[Runs, ...]] = []
    right: list[bool] = []
    marked: set[int] = set()
    titles: tuple[str, ...] = heads
    for row in element.iter("tr"):
        cells = [cell for cell in row if cell.tag in ("td", "th")]
        read_ = tuple(_cell(cell) for cell in cells)
        if cells and all(cell.tag == "th" for cell in cells):
            titles = tuple(plain(runs) for runs in read_)
            continue
        if row.get("aria-current") is not None:
            marked.add(len(rows))
        numeric = [
            "text-align:right" in cell.get("style", "") or cell.get("class") == "n"
            for cell in cells
        ]
        right = [a or b for a, b in zip([*right, *[False] * 20], numeric, strict=False)]
        rows.append(read_)
    wide = max((len(row) for row in rows), default=0)
    titles = (*titles, *[""] * (wide - len(titles)))[:wide]
    full = [(*row, *[()] * (wide - len(row))) for row in rows]
    kept = [n for n in range(wide) if titles[n] or any(row[n] for row in full)]
    return Table(
        caption,
        tuple(titles[n] for n in kept),
        tuple(tuple(row[n] for n in kept) for row in full),
        tuple(right[n] for n in kept),
        frozenset(marked),
    )


def _cell(cell: Any) -> Runs:
    runs: list[Run] = []

    def walk(element: Any, look: Run) -> None:
        if (one := _atom(element, look)) is not None:
            runs.append(one)
            return
        look = _look(element, look) if element is not cell else look
        if element.tag == "br" and runs:
            runs.append(replace(look, text=" "))
        if element.text:
            runs.append(replace(look, text=element.text))
        for child in element:
            if child.tag not in _LEFT_OUT:
                walk(child, look)
            if child.tail:
                runs.append(replace(look, text=child.tail))

    walk(cell, Run(""))
    return _trimmed(tuple(runs))


def _trimmed(runs: Runs) -> Runs:
    """Without spaces at both ends, and with single ones between."""
    made: list[Run] = []
    for run in runs:
        text = _SPACE.sub(" ", run.text)
        if text.startswith(" ") and (not made or made[-1].text.endswith(" ")):
            text = text[1:]
        if text or run.chip or run.bar or run.picture:
            made.append(replace(run, text=text))
    if made and made[-1].text.endswith(" "):
        made[-1] = replace(made[-1], text=made[-1].text.rstrip())
        if not (made[-1].text or made[-1].chip or made[-1].bar):
            made.pop()
    return tuple(_joined(made))


def _joined(runs: list[Run]) -> Iterator[Run]:
    """A chip belongs to the text behind it."""
    chip = ""
    for run in runs:
        if run.chip and not run.text:
            chip = run.chip
            continue
        yield replace(run, chip=chip) if chip else run
        chip = ""
    if chip:
        yield Run("", chip=chip)
