"""One page that shows papers and their recomputation side by side. It needs nothing else but the
pictures that stand beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from html import escape

from app.features.paper.figures import Files
from app.features.paper.items import Item, Paper
from app.features.paper.judging import VERDICTS, Quantity
from app.features.paper.registry import Recomputed

_MARKS = {"reproduced": "✓", "corrected": "≠", "impossible": "–"}
_SECTIONS = (
    ("Tables", "Table"),
    ("Figures", "Fig."),
    ("Equations", "eq."),
    ("Numbers and claims of the text", ""),
)
_PICTURES = ("png", "svg")

_STYLE = """
:root { --ink: #1b2430; --soft: #5a6675; --rule: #dbe1e8; --paper: #fff; --wash: #f5f7f9;
  --good: #1f7a4d; --mend: #a85400; --none: #66707c; --link: #14609f; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e9ef; --soft: #a3aebb; --rule: #333d49;
  --paper: #161b22; --wash: #1d242d; --good: #5fc08e; --mend: #eba65b; --none: #98a3af;
  --link: #79b7ee; } }
* { box-sizing: border-box; }
body { margin: 0; font: 15px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper);
  font-variant-numeric: tabular-nums; }
main, header, nav { max-width: 76rem; margin: 0 auto; padding: 0 1.5rem; }
header { padding-top: 2.2rem; }
h1 { font-size: 1.7rem; margin: 0 0 .3rem; } h2 { font-size: 1.35rem; margin: 3rem 0 .2rem; }
h3 { font-size: 1.05rem; margin: 2rem 0 .6rem; border-bottom: 1px solid var(--rule);
  padding-bottom: .3rem; }
p { margin: .3rem 0; max-width: 62rem; } .soft { color: var(--soft); } a { color: var(--link); }
table.sum { border-collapse: collapse; margin: 1rem 0; }
table.sum th, table.sum td { padding: .3rem .9rem .3rem 0; text-align: right; font-weight: 400;
  border-bottom: 1px solid var(--rule); }
table.sum th:first-child, table.sum td:first-child { text-align: left; }
article { display: grid; grid-template-columns: 1fr 1fr; gap: 0 2rem; padding: .9rem 0 1rem;
  border-bottom: 1px solid var(--rule); }
article > h4 { grid-column: 1 / -1; margin: 0 0 .35rem; font-size: 1rem; font-weight: 600; }
article > h4 span.what { font-weight: 400; }
.verdict { font-size: .85rem; font-weight: 600; margin-left: .7rem; white-space: nowrap; }
.reproduced { color: var(--good); } .corrected { color: var(--mend); }
.impossible { color: var(--none); }
.side { min-width: 0; overflow-wrap: anywhere; }
.side > b { font-size: .78rem; font-weight: 600; color: var(--soft); display: block; }
.printed { font-family: ui-serif, Georgia, serif; }
.why { grid-column: 1 / -1; margin-top: .45rem; }
table.told { border-collapse: collapse; width: 100%; font-size: .92rem; }
table.told td, table.told th { padding: .12rem .6rem .12rem 0; vertical-align: top;
  text-align: right; font-weight: 400; }
table.told td:first-child, table.told th:first-child { text-align: left; color: var(--soft); }
table.told th { color: var(--soft); font-size: .8rem; }
td.off { color: var(--mend); } td.same { color: var(--good); }
figure { grid-column: 1 / -1; margin: .7rem 0 0; }
figure img { max-width: 100%; max-height: 30rem; width: auto; height: auto;
  background: #fff; border: 1px solid var(--rule); }
figcaption { font-size: .88rem; color: var(--soft); }
nav.filter { display: flex; gap: 1.2rem; flex-wrap: wrap; padding-top: .4rem; }
nav.filter label { cursor: pointer; }
body:has(#see-reproduced:not(:checked)) article[data-verdict=reproduced],
body:has(#see-corrected:not(:checked)) article[data-verdict=corrected],
body:has(#see-impossible:not(:checked)) article[data-verdict=impossible] { display: none; }
@media (max-width: 46rem) { article { grid-template-columns: 1fr; } }
@media print { nav.filter { display: none; } article { break-inside: avoid; } }
"""


def page(
    papers: Sequence[Paper],
    found: Mapping[str, Sequence[Recomputed]],
    shown: Mapping[tuple[str, str], Files],
    place: Callable[[Item, str], str],
) -> str:
    """The page, HTML.

    Args:
        found: of each paper its items, recomputed.
        shown: files of each item, by paper and item.
        place: where a file of an item stands, seen from the page.
    """
    title = "The papers recomputed" if len(papers) > 1 else f"{papers[0].title}, recomputed"
    parts = [
        '<!doctype html><html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body>",
        f"<header><h1>{escape(title)}</h1>",
        "<p>Left what is printed, right what Bohemia computes. Each verdict was found by comparing "
        "both when this page was written. Figures of the papers are described, not copied; those "
        "shown are drawn here.</p>",
        _summary(papers, found),
        "</header>",
        _filter(),
        "<main>",
    ]
    for paper in papers:
        parts += _of_paper(paper, found[paper.name], shown, place)
    parts.append("</main></body></html>")
    return "\n".join(parts)


def _summary(papers: Sequence[Paper], found: Mapping[str, Sequence[Recomputed]]) -> str:
    rows = ["<tr><th>Paper</th><th>items</th>", *(f"<th>{v}</th>" for v in VERDICTS), "</tr>"]
    for paper in papers:
        made = found[paper.name]
        rows.append(f'<tr><td><a href="#{paper.name}">{escape(_short(paper))}</a></td>')
        rows.append(f"<td>{len(made)}</td>")
        rows += [f"<td>{sum(each.verdict == v for each in made)}</td>" for v in VERDICTS]
        rows.append("</tr>")
    return f'<table class="sum">{"".join(rows)}</table>'


def _short(paper: Paper) -> str:
    first = paper.authors.partition(",")[0]
    return f"{first} et al.: {paper.title} ({paper.source})"


def _filter() -> str:
    boxes = (
        f'<label><input type="checkbox" id="see-{v}" checked> '
        f'<span class="{v}">{_MARKS[v]} {v}</span></label>'
        for v in VERDICTS
    )
    return f'<nav class="filter">Show: {"".join(boxes)}</nav>'


def _of_paper(
    paper: Paper,
    found: Sequence[Recomputed],
    shown: Mapping[tuple[str, str], Files],
    place: Callable[[Item, str], str],
) -> Iterator[str]:
    yield f'<section id="{paper.name}"><h2>{escape(paper.title)}</h2>'
    yield f'<p class="soft">{escape(paper.authors)}. {escape(paper.source)}.</p>'
    yield f"<p>{escape(paper.text)}</p>"
    told: set[str] = set()
    for title, begins in _SECTIONS:
        some = [e for e in found if e.item.name.startswith(begins) and e.item.name not in told]
        told |= {each.item.name for each in some}
        if some:
            yield f"<h3>{title}</h3>"
        for each in some:
            files = shown.get((paper.name, each.item.name), {})
            yield _article(each, {name: place(each.item, name) for name in files})
    yield "</section>"


def _article(found: Recomputed, files: Mapping[str, str]) -> str:
    item, verdict = found.item, found.verdict
    printed = escape(item.printed or item.picture or "nothing")
    described = item.printed and item.picture
    more = f'<br><span class="soft">{escape(item.picture)}</span>' if described else ""
    about = "In the paper (described)" if item.picture and not item.printed else "Printed"
    computed = _quantities(found.outcome.quantities) or '<span class="soft">nothing</span>'
    return (
        f'<article id="{item.paper}-{item.stem}" data-verdict="{verdict}">'
        f'<h4>{escape(item.name)} <span class="what">{escape(item.what)}</span>'
        f'<span class="verdict {verdict}">{_MARKS[verdict]} {verdict}</span></h4>'
        f'<div class="side"><b>{about}</b><div class="printed">{printed}{more}</div></div>'
        f'<div class="side"><b>Computed</b>{computed}</div>'
        f'<div class="why">{escape(found.why)}</div>{_figure(item, files)}</article>'
    )


def _quantities(quantities: Sequence[Quantity]) -> str:
    """What was computed, as a table; with the printed values where there are any."""
    if not quantities:
        return ""
    beside = any(each.printed is not None for each in quantities)
    head = "<tr><th></th><th>printed</th><th>computed</th></tr>" if beside else ""
    rows = []
    for each in quantities:
        mark = "" if each.printed is None else ' class="same"' if each.agrees else ' class="off"'
        printed = f"<td>{escape(minus(each.printed or ''))}</td>" if beside else ""
        rows.append(
            f"<tr><td>{escape(each.what)}</td>{printed}<td{mark}>{escape(each.shown)}</td></tr>"
        )
    return f'<table class="told">{head}{"".join(rows)}</table>'


def minus(text: str) -> str:
    """A printed number with a true minus sign."""
    return text.replace("-", "−") if text[-1:].isdigit() else text


def _figure(item: Item, files: Mapping[str, str]) -> str:
    """The picture, if there is one, and links to all files."""
    if not files:
        return ""
    picture = next((name for name in files if name.endswith(".png")), None)
    links = " · ".join(
        f'<a href="{escape(path)}">{escape(name.rpartition(".")[2].upper())}</a>'
        for name, path in files.items()
    )
    image = ""
    if picture is not None:
        text = escape(f"{item.name}, {item.what}, drawn by Bohemia")
        image = f'<img src="{escape(files[picture])}" alt="{text}" loading="lazy">'
    return (
        f"<figure>{image}<figcaption>{escape(item.name)} drawn here: {links}</figcaption></figure>"
    )
