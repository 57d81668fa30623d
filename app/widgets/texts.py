"""Small pieces of HTML. Only text that passed `esc` goes in."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import Literal

from app.scene import palette

Tone = Literal["good", "near", "bad", "quiet"]
_TONES = {"good": "#009E73", "near": "#B59B00", "bad": palette.BEYOND, "quiet": "#7A828C"}
NUMERIC = "text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums"
# What is of before fades, once it has been so for longer than a moving hand leaves it.
AGED_STYLE = (
    "<style>@keyframes aged{to{opacity:.4}}.aged{animation:aged .2s ease .4s forwards}</style>"
)


def esc(text: object) -> str:
    """Text that may come from a file or a person, harmless in HTML."""
    return html.escape(str(text))


def tone(level: Tone) -> str:
    """The CSS colour of a level."""
    return _TONES[level]


def box(content: str) -> str:
    """A block with the margins of the panel's other rows."""
    return f'<div style="padding:0.3em 0.75em;font-size:0.82em;line-height:1.45">{content}</div>'


def aged(content: str, stale: bool, tag: str = "div") -> str:
    """What is of before, if it is."""
    return f'<{tag} class="aged">{content}</{tag}>' if stale and content else content


def red(text: str) -> str:
    """A block that tells what is wrong."""
    return box(f'<b style="color:{palette.BEYOND}">{esc(text)}</b>')


def quiet(text: str) -> str:
    """A block of less weight."""
    return box(f'<span style="opacity:0.75">{esc(text)}</span>')


def chip(color: str) -> str:
    """A small square of a colour."""
    return (
        f'<span style="display:inline-block;width:0.75em;height:0.75em;border-radius:2px;'
        f'background:{color};margin-right:0.35em;vertical-align:-0.05em"></span>'
    )


def table(rows: Iterable[Sequence[str]], styles: Sequence[str] = (), style: str = "") -> str:
    """A table as wide as the panel; ``styles`` are those of its columns."""
    lines = []
    for row in rows:
        cells = "".join(
            f'<td style="{styles[n]}">{cell}</td>'
            if n < len(styles) and styles[n]
            else f"<td>{cell}</td>"
            for n, cell in enumerate(row)
        )
        lines.append(f"<tr>{cells}</tr>")
    return f'<table style="width:100%;{style}">{"".join(lines)}</table>'


def bar(share: float, color: str, height: str = ".5em") -> str:
    """A share of 1 as a bar."""
    wide = 100.0 * min(max(share, 0.0), 1.0)
    return (
        f'<div style="height:{height};border-radius:3px;background:rgba(128,138,150,.25)">'
        f'<div style="height:100%;width:{wide:.1f}%;border-radius:3px;background:{color}"></div>'
        "</div>"
    )
