"""Small pieces of HTML. Only text that passed `esc` goes in."""

from __future__ import annotations

import html
import itertools
import re
from collections.abc import Iterable, Sequence
from typing import Literal

from app.scene import palette

Tone = Literal["good", "near", "bad", "quiet"]
# The style sheet has those of a dark page; without it they are those of a light one.
_TONES = {
    "good": f"var(--bo-good,{palette.LIGHT.good})",
    "near": f"var(--bo-near,{palette.LIGHT.near})",
    "bad": f"var(--bo-bad,{palette.LIGHT.bad})",
    "quiet": f"var(--bo-dim,{palette.LIGHT.quiet})",
}
NUMERIC = "text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums"


def esc(text: object) -> str:
    """Text that may come from a file or a person, harmless in HTML."""
    return html.escape(str(text))


def tone(level: Tone) -> str:
    """The CSS colour of a level."""
    return _TONES[level]


def styled(content: str, style: str, tag: str = "span") -> str:
    """A piece with a look, CSS."""
    return f'<{tag} style="{style}">{content}</{tag}>'


def faint(content: str, tag: str = "span") -> str:
    """A piece of less weight."""
    return styled(content, "opacity:.75", tag)


def edged(content: str, color: str, more: str = "") -> str:
    """A piece with a bar of a colour at its left; ``more`` CSS."""
    return styled(content, f"border-left:4px solid {color};padding-left:.6em;{more}", "div")


def box(content: str) -> str:
    """A block with the margins of the panel's other rows."""
    return f'<div class="bo-says">{content}</div>'


def aged(content: str, stale: bool, tag: str = "div") -> str:
    """What is of before, if it is."""
    return f'<{tag} class="aged">{content}</{tag}>' if stale and content else content


def prose(*texts: str) -> str:
    """Paragraphs with blank lines between them; **strong**, *stressed* and `as it is typed`."""
    written = esc("\n\n".join(text.strip() for text in texts if text.strip()))
    for mark, tag in (("**", "b"), ("*", "i"), ("`", "kbd")):
        stop = re.escape(mark)
        written = re.sub(f"{stop}(.+?){stop}", rf"<{tag}>\1</{tag}>", written, flags=re.DOTALL)
    return "".join(f"<p>{paragraph}</p>" for paragraph in written.split("\n\n"))


def red(text: str) -> str:
    """A block that tells what is wrong."""
    return box(styled(esc(text), f"color:{tone('bad')}", "b"))


def quiet(text: str) -> str:
    """A block of less weight."""
    return box(faint(esc(text)))


def chip(color: str) -> str:
    """A small square of a colour."""
    return (
        f'<span style="display:inline-block;width:0.75em;height:0.75em;border-radius:2px;'
        f'background:{color};margin-right:0.35em;vertical-align:-0.05em"></span>'
    )


def table(
    rows: Iterable[Sequence[str]],
    styles: Sequence[str] = (),
    style: str = "",
    heads: Sequence[str] = (),
    *,
    looks: Iterable[str] = (),
) -> str:
    """A table as wide as the panel; ``styles`` are those of its columns, ``heads`` their titles,
    ``looks`` further attributes of its rows.
    """
    styled = [f' style="{each}"' if each else "" for each in styles]
    lines = []
    given = itertools.chain([""] * bool(heads), looks, itertools.repeat(""))
    of_rows = [("th", heads)] * bool(heads) + [("td", row) for row in rows]
    for (tag, row), look in zip(of_rows, given, strict=False):
        pairs = zip(itertools.chain(styled, itertools.repeat("")), row, strict=False)
        cells = "".join(f"<{tag}{each}>{cell}</{tag}>" for each, cell in pairs)
        lines.append(f"<tr {look}>{cells}</tr>" if look else f"<tr>{cells}</tr>")
    return f'<table class="bo-table" style="{style}">{"".join(lines)}</table>'


def bar(share: float, color: str, height: str = ".5em") -> str:
    """A share of 1 as a bar."""
    return track([(0.0, share, color)], height)


def track(spans: Iterable[tuple[float, float | None, str]], height: str = ".5em") -> str:
    """What lies on a bar from 0 to 1: from, to (None for a mark), colour."""
    parts = []
    for low, high, color in spans:
        left, right = (100.0 * min(max(v, 0.0), 1.0) for v in (low, low if high is None else high))
        place = f"width:{right - left:.1f}%;top:0;bottom:0;border-radius:3px"
        if high is None:
            place = "width:3px;margin-left:-1px;top:-2px;bottom:-2px"
        parts.append(
            f'<div style="position:absolute;left:{left:.1f}%;{place};background:{color}"></div>'
        )
    return (
        f'<div style="position:relative;height:{height};border-radius:3px;'
        f'background:rgba(128,138,150,.25)">{"".join(parts)}</div>'
    )
