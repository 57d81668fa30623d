"""`bohemia paper`: the source papers recomputed item by item, each with a verdict."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.features.paper.items import PAPERS
from app.terminal.command import Answer, command, progress
from app.terminal.options import argument, option
from kinematics.errors import InputError

if TYPE_CHECKING:
    from app.features.paper.items import Paper
    from app.features.paper.registry import Recomputed


@command("paper")
def paper(
    name: str | None = argument("[NAME]", lambda machine: PAPERS, required=False),
    folder: str | None = option(
        "FOLDER",
        "write figures (SVG and PNG, solids as STL and GLB), tables (CSV) and index.html, which "
        "shows each paper and its recomputation side by side; the folder is made if need be",
        None,
        "-o",
        "--output",
        files=True,
    ),
) -> Answer:
    """The source papers recomputed: every table, figure, numbered equation and claim.

    NAME is one of meccanica-2011, icee-2010, sps-spr-2017, rps-spr-2017, five-bar-2017; without it
    all of them. Each item has a verdict, found by computing it now: reproduced (and to how many
    digits), corrected (what is misprinted, and what fails), or impossible (which datum is
    missing). Claims of the text are called C1, C2, …
    """
    from app.features.paper import items, registry

    papers = [items.paper(each) for each in ((name,) if name else PAPERS)]
    to = None if folder is None else _folder(folder)
    found: dict[str, list[Recomputed]] = {}
    with progress("recomputing") as show:
        for one in papers:
            made = found.setdefault(one.name, [])
            for item in one.items:
                show(f"{one.name}: {item.name} …")
                made.append(registry.recompute(item))
        written: list[str] = []
        if to is not None:
            from app.features.paper.folder import write

            written = write(to, papers, found, show)
    every = [each for made in found.values() for each in made]
    data = {
        "papers": [_paper(one, found[one.name]) for one in papers],
        "counts": _counts(every),
        "items": [entry(each) for each in every],
        "folder": None if to is None else str(to),
        "files": written,
    }
    lines = [line for one in papers for line in _lines(one, found[one.name])]
    if to is not None:
        lines.append(f"files      {len(written)} in {to}; open {to / 'index.html'}")
    return Answer(data, lines)


def _folder(name: str) -> Path:
    """The folder, made; refused before any work is done."""
    path = Path(name)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot make the folder {name!r}: {reason.lower()}") from None
    return path


def entry(found: Recomputed) -> dict[str, Any]:
    """An item as JSON has it."""
    from app.features.paper.judging import as_json

    item, quantities = found.item, [as_json(each) for each in found.outcome.quantities]
    digits = [each["digits"] for each in quantities if each["digits"] is not None]
    return {
        "paper": item.paper,
        "item": item.name,
        "title": item.what,
        "verdict": found.verdict,
        "printed": item.printed or None,
        "computed": found.computed,
        "why": found.why,
        "digits": min(digits, default=None),
        "quantities": quantities,
        "picture": item.picture or None,
    }


def _counts(found: Sequence[Recomputed]) -> dict[str, int]:
    from app.features.paper.judging import VERDICTS

    told = {str(key): sum(each.verdict == key for each in found) for key in VERDICTS}
    computed = sum(each.computed is not None for each in found)
    return {"items": len(found), **told, "with_computed_value": computed}


def _paper(one: Paper, found: Sequence[Recomputed]) -> dict[str, Any]:
    return {
        "name": one.name,
        "title": one.title,
        "authors": one.authors,
        "source": one.source,
        "designs": list(one.designs),
        "note": one.text,
        "counts": _counts(found),
    }


def _lines(one: Paper, found: Sequence[Recomputed]) -> Iterator[str]:
    yield f"{one.authors}: {one.title}. {one.source}"
    told = _counts(found)
    verdicts = ", ".join(f"{told[key]} {key}" for key in ("reproduced", "corrected", "impossible"))
    yield f"{told['items']} items: {verdicts}"
    yield ""
    for each in found:
        yield f"{each.item.name:<10} {each.verdict:<11} {each.item.what}"
        if each.item.printed:
            yield f"           printed   {each.item.printed}"
        if each.computed:
            yield f"           computed  {each.computed}"
        yield f"           {each.why}"
    yield ""
