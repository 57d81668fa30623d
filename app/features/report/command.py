"""`bohemia report`: the review of designs in one file."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.terminal import tables
from app.terminal.command import Answer, Output, command, progress
from app.terminal.options import choice, designs, option, output, resolution
from app.terminal.values import counted
from kinematics.errors import BohemiaError, InputError

if TYPE_CHECKING:
    from app.features.report.make import Paper
    from app.review.state import Review
    from kinematics.facets.solids import Resolution

MOST = 4  # designs in one report
KINDS = ".html: a page that needs no network, or .pdf"


@command("report")
def report(
    designs: tuple[str, ...] = designs("DESIGN…", MOST),
    paper: Paper = choice("of a .pdf", "a4", "letter", default="a4"),
    resolution: Resolution = resolution("of the solids: "),
    map_cells: int = option(
        "N",
        "values of each angle in the map over the orientations; 0: no map",
        counted("a number of values", 0, 91),
        default="9",
    ),
    output: Output = output(KINDS),
) -> Answer:
    """The review of one design, or of up to four, in one file.

    A DESIGN is a preset, a design file, or a session file (.json) that the page has written: then
    the report is of its pose and mode, with its section, its trajectory and what it shows. It has
    the page's tables, words and plots, every number with its error, and the scene to be turned.
    Several designs are compared first, as bohemia compare does.
    """
    from datetime import datetime

    from app.features.report.beside import beside_of, compared
    from app.features.report.compute import Depth, Found, gather
    from app.features.report.make import FORMATS, report_of, written
    from app.jobs.executors import cores, local_workers

    kind = output.kind(FORMATS, "a report")
    if not kind:
        raise InputError("a report is a file: name it, as -o review.html or -o review.pdf")
    reviews = [each for name in designs for each in beside_of(_review(name))]
    if len(reviews) > MOST:
        raise InputError(f"at most {MOST} designs in one report, got {len(reviews)}")
    depth, found = Depth(resolution, map_cells), list[Found]()
    with ExitStack() as stack, progress("Report") as show:
        executor, workers = None, max(cores() - 1, 1)
        if map_cells and any(review.machine.map_spec is not None for review in reviews):
            executor = stack.enter_context(local_workers(workers)).executor
        for review in reviews:
            name = review.design.name

            def tell(text: str, name: str = name) -> None:
                show(f"Report: {name}, {text} …")

            found.append(gather(review, depth, tell, executor=executor, workers=workers))
        beside, apart = None, list[str]()
        if len(reviews) > 1:
            show("Report: the comparison …")
            try:
                beside = compared(reviews, resolution)
            except BohemiaError as error:
                apart = [f"not compared: {error}"]
        show("Report: the file …")
        made = written(report_of(found, datetime.now().astimezone(), beside), kind, paper)
    told = f", {made.pages} pages" if made.pages else ""
    output.write(made.data, f"{len(made.data) / 1e6:.2f} MB{told}")
    data: dict[str, Any] = {
        "designs": [
            {"name": r.design.name, "mechanism": r.design.mechanism, "title": r.design.title}
            for r in reviews
        ],
        "format": kind,
        "size_bytes": len(made.data),
        "pages": made.pages,
        "paper": paper if made.pages else None,
        "warnings": [
            *(f"{r.design.name}: {text}" for r in reviews for text in tables.warnings(r.machine)),
            *apart,
            *(t for each in found for t in each.failed),
        ],
    }
    lines = [f"{r.design.name}: {r.design.title or r.machine.title}" for r in reviews]
    return Answer(data, lines)


def _review(name: str) -> Review:
    """The review that a session file holds, else a new one of a design."""
    from app.review import session
    from app.review.state import new_review
    from kinematics.designs.files import load_design

    path = Path(name)
    if path.suffix.lower() == ".json":
        return session.load(path)
    return new_review(load_design(name))
