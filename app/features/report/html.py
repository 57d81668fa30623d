"""A report as one HTML file that asks no network for anything."""

from __future__ import annotations

import base64
import hashlib
import json
from importlib.resources import files

from app.features.report.drawing import theme_css
from app.features.report.model import (
    Block,
    Chapter,
    Figure,
    Report,
    Run,
    Runs,
    Scene,
    Section,
    Table,
    Words,
    plain,
)
from app.widgets.texts import esc

_HERE = files("app.features.report")


def page(report: Report) -> str:
    """The whole file."""
    several = len(report.chapters) > 1
    script = _read("viewer.js")
    style = _read("report.css").replace("DARK", theme_css(dark=True))
    # Nothing but what is in the file may be used, whatever a design is called.
    allowed = f"script-src '{_hashed(script)}'; style-src 'unsafe-inline'; img-src data:"
    body = "".join(_chapter(c, n, several=several) for n, c in enumerate(report.chapters))
    facts = "".join(f"<li>{esc(fact)}</li>" for fact in report.facts)
    first = report.chapters[0]
    sub = "" if several else f'<p class="sub">{esc(_subtitle(first))}</p>'
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; {allowed}; '
        f"base-uri 'none'; form-action 'none'\">"
        f'<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta name="generator" content="{esc(report.facts[-1])}">'
        f"<title>{esc(report.title)}</title><style>{style}</style></head><body>"
        f'<header class="top"><h1>{esc(report.title)}</h1>{sub}'
        f'<ul class="facts">{facts}</ul><hr class="ruled">{_contents(report)}</header>'
        f"<main>{body}</main><footer>{esc(report.foot)}</footer>"
        f"<script>{script}</script></body></html>\n"
    )


def _subtitle(chapter: Chapter) -> str:
    return " · ".join(filter(None, ("Kinematic review", chapter.subtitle)))


def _hashed(script: str) -> str:
    digest = hashlib.sha256(script.encode()).digest()
    return f"sha256-{base64.b64encode(digest).decode()}"


def _read(name: str) -> str:
    return _HERE.joinpath(name).read_text(encoding="utf-8")


def _id(chapter: int, section: int) -> str:
    return f"s{chapter + 1}-{section + 1}"


def _contents(report: Report) -> str:
    """Ways to the sections."""
    items = []
    for n, chapter in enumerate(report.chapters):
        named = f"{chapter.letter}: " if chapter.letter else ""
        for m, section in enumerate(chapter.sections):
            items.append(f'<li><a href="#{_id(n, m)}">{esc(named + section.title)}</a></li>')
    return f'<nav aria-label="Contents"><ol>{"".join(items)}</ol></nav>'


def _chapter(chapter: Chapter, n: int, *, several: bool) -> str:
    head = ""
    if several:
        named = f"{chapter.letter} · " if chapter.letter else ""
        sub = f'<p class="sub">{esc(chapter.subtitle)}</p>' if chapter.subtitle else ""
        head = f"<header><h2>{esc(named + chapter.title)}</h2>{sub}</header>"
    level = 3 if several else 2
    body = "".join(_section(s, n, m, level, chapter.letter) for m, s in enumerate(chapter.sections))
    return f'<article class="chapter">{head}{body}</article>'


def _section(section: Section, chapter: int, n: int, level: int, letter: str) -> str:
    name = _id(chapter, n)
    looks = " ".join(["fresh"] * section.fresh + ["first"] * (n == 0))
    named = f"{letter}: {section.title}" if letter else section.title
    body = "".join(_block(block) for block in section.blocks)
    return (
        f'<section id="{name}" aria-label="{esc(named)}"{_class(looks)}>'
        f"<h{level}>{esc(section.title)}</h{level}>{body}</section>"
    )


def _class(names: str) -> str:
    return f' class="{names}"' if names else ""


def _block(block: Block) -> str:
    match block:
        case Words():
            return f"<p{_class(block.tone)}>{_runs(block.runs)}</p>"
        case Table():
            return _table(block)
        case Figure():
            return _figure(block)
        case Scene():
            return _scene(block)


def _runs(runs: Runs) -> str:
    return "".join(map(_run, runs))


def _run(run: Run) -> str:
    if run.bar:
        spans = "".join(_span(*span) for span in run.bar)
        return f'<span class="track" aria-hidden="true">{spans}</span>'
    text = esc(run.text)
    if run.script:
        text = f"<{run.script}>{text}</{run.script}>"
    if run.bold:
        text = f"<b>{text}</b>"
    if run.color:
        text = f'<span style="color:{esc(run.color)}">{text}</span>'
    chip = ""
    if run.chip:
        chip = f'<span class="chip" style="background:{esc(run.chip)}" aria-hidden="true"></span>'
    return chip + run.picture + text


def _span(low: float, high: float | None, color: str) -> str:
    place = f"left:{100 * low:.1f}%"
    if high is None:
        return f'<i class="mark" style="{place};background:{esc(color)}"></i>'
    return f'<i style="{place};width:{100 * (high - low):.1f}%;background:{esc(color)}"></i>'


def _table(table: Table) -> str:
    heads = ""
    if any(table.heads):
        cells = "".join(
            f'<th scope="col"{_class("n" * right)}>{esc(head)}</th>' if head else "<td></td>"
            for head, right in zip(table.heads, table.numeric, strict=True)
        )
        heads = f"<thead><tr>{cells}</tr></thead>"
    rows = []
    for n, row in enumerate(table.rows):
        cells = "".join(
            f'<th scope="row"{_class("n" * right)}>{_runs(cell)}</th>'
            if k == 0 and table.titled and plain(cell)
            else f"<td{_class('n' * right)}>{_runs(cell)}</td>"
            for k, (cell, right) in enumerate(zip(row, table.numeric, strict=True))
        )
        here = ' class="here" aria-current="true"' if n in table.marked else ""
        rows.append(f"<tr{here}>{cells}</tr>")
    foot = ""
    if table.note:
        foot = f'<tfoot><tr><td colspan="{len(table.heads)}">{_runs(table.note)}</td></tr></tfoot>'
    caption = f"<caption>{esc(table.caption)}</caption>" if table.caption else ""
    return (
        f'<div class="wrap" tabindex="0" role="group" aria-label="{esc(table.caption)}">'
        f"<table>{caption}{heads}<tbody>{''.join(rows)}</tbody>{foot}</table></div>"
    )


def _figure(figure: Figure, look: str = "") -> str:
    wide = f' style="max-width:{100 * figure.share:g}%"' if figure.share < 1.0 else ""
    caption = f"<figcaption>{esc(figure.caption)}</figcaption>" if figure.caption else ""
    return f"<figure{_class(look)}{wide}>{_named(figure)}{caption}</figure>"


def _named(figure: Figure) -> str:
    """The drawing with its name for who does not see it."""
    tag, _, rest = figure.svg.partition(">")
    kept = tag if "aria-label=" not in tag else tag[: tag.index(" aria-label=")] + _behind(tag)
    if "role=" not in kept:
        kept += ' role="img"'
    return f'{kept} aria-label="{esc(figure.alt)}">{rest}'


def _behind(tag: str) -> str:
    """What stands behind a label in a tag."""
    start = tag.index(' aria-label="') + len(' aria-label="')
    return tag[tag.index('"', start) + 1 :]


def _scene(scene: Scene) -> str:
    packed = scene.packed
    data = json.dumps(packed.data, separators=(",", ":")).replace("<", "\\u003c")
    boxes = "".join(
        f'<label><input type="checkbox" data-group="{esc(key)}"{" checked" * on}>{esc(title)}'
        f"</label>"
        for key, title, on in packed.groups
    )
    looks = "".join(
        f'<button type="button" data-look="{n}">{esc(name)}</button>'
        for n, name in enumerate((*packed.looks, "Fit"))
    )
    play = ""
    if packed.seconds > 0.0:
        play = (
            '<div><button type="button" data-play>Play</button><label>Time <input type="range" '
            f'data-time min="0" max="{packed.seconds:.6g}" step="any" value="0"></label>'
            "<span data-told></span></div>"
        )
    keys = "Drag to turn, Shift and drag to shift, Ctrl and the wheel or + and − to zoom."
    still = _figure(scene.still, "still")
    caption = f'<p class="quiet">{esc(scene.still.caption)} {keys}</p>'
    return (
        f'<div class="scene"><div class="view"><canvas tabindex="0" role="img" '
        f'aria-label="{esc(scene.still.alt)} {keys} Arrow keys turn it."></canvas>'
        f'<div class="names" aria-hidden="true"></div></div><div class="tools">'
        f'<div role="group" aria-label="Views">{looks}</div>'
        f'<div role="group" aria-label="What is shown">{boxes}</div>{play}{caption}</div>'
        f'<p class="why"></p>{still}<script type="application/json">{data}</script></div>'
    )
