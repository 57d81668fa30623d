"""From reviews to a report, and from a report to a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Literal

from app.features.compare.compute import Compared as CompareFound
from app.features.report.beside import Compared, drawn, reviews_of
from app.features.report.beside import chapter as side_by_side
from app.features.report.compute import Depth, Found, gather
from app.features.report.content import chapter
from app.features.report.model import Report
from kinematics.errors import ComputationError
from kinematics.facets.solids import Resolution

Paper = Literal["a4", "letter"]
FORMATS = ("html", "pdf")
PAPERS: tuple[Paper, ...] = ("a4", "letter")
LARGEST = 8_000_000  # bytes of an HTML file, which is sent by mail
LETTERS = "ABCD"


def report_of(found: Sequence[Found], at: datetime, beside: Compared | None = None) -> Report:
    """A report of one design, or of several: what they are ``beside`` one another, then each."""
    several = len(found) > 1
    chapters = tuple(chapter(each, LETTERS[n] if several else "") for n, each in enumerate(found))
    names = [each.title for each in chapters]
    told = ", ".join(each.name for each in chapters)
    if beside is not None:
        chapters = (side_by_side(beside, found[0].view), *chapters)
    title = names[0] if not several else f"{', '.join(names[:-1])} and {names[-1]}"
    made = f"made from {told}"
    facts = (f"{at:%-d %B %Y}", "lengths mm, angles °, base frame", f"Bohemia {program()}")
    foot = f"Bohemia {program()} · lengths mm, angles ° · {made}"
    return Report(title, facts, foot, chapters)


def comparison(found: CompareFound, resolution: Resolution = "normal") -> Report:
    """A report of a comparison: the designs beside one another, then each as it was compared."""
    reviews = reviews_of(found.request)
    each = [gather(review, Depth(resolution, 0)) for review in reviews]
    return report_of(each, datetime.now().astimezone(), drawn(found, reviews[0], resolution))


def program() -> str:
    """The program's version."""
    try:
        return version("bohemia")
    except PackageNotFoundError:
        return "(not installed)"


@dataclass(frozen=True, slots=True)
class Written:
    """A file's content; ``pages`` of one that has such, else None."""

    data: bytes
    pages: int | None = None


def written(report: Report, kind: str, paper: Paper = "a4") -> Written:
    """The content of a file, "html" or "pdf".

    Raises:
        ComputationError: it would be too large to be handed on.
    """
    if kind == "pdf":
        from app.features.report.pdf import pdf

        return Written(*pdf(report, paper))
    from app.features.report.html import page

    data = page(report).encode()
    if len(data) > LARGEST:
        size = f"{len(data) / 1e6:.1f} MB"
        raise ComputationError(
            f"the report would be {size}, more than can be sent; take --resolution preview"
        )
    return Written(data)
