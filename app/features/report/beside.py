"""Designs side by side, as the page compares them: the first chapter of a report of several."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.features.compare import LETTERS, compute, html, plot
from app.features.compare.state import Beside
from app.features.report import charts, drawing
from app.features.report.model import Block, Chapter, Figure, Run, Scene, Section, Words
from app.features.report.packing import pack
from app.features.report.reading import read
from app.features.workspace.state import ChooseModes
from app.review.changes import change
from app.review.state import Review, new_review
from app.review.units import minus, tenths
from app.review.view import View
from app.scene import painting
from app.scene.palette import DARK, LIGHT
from kinematics.facets.solids import Resolution

APART = "\u2003"  # between entries of a line
MOST_FACES = 30_000  # of a part that is shown; finer ones are shown coarsely


@dataclass(frozen=True, eq=False, slots=True)
class Compared:
    """A comparison with what the scene shows of it: what all reach first, then each alone."""

    found: compute.Compared
    parts: tuple[compute.Drawn, ...]
    review: Review


def compared(reviews: Sequence[Review], resolution: Resolution) -> Compared:
    """The designs of reviews at the orientation, in the modes and at the pose of the first.

    Raises:
        BohemiaError: they cannot be compared.
    """
    first = reviews[0]
    others = tuple(review.design for review in reviews[1:])
    asked = compute.request_of(first.having(replace(first[Beside], designs=others)))
    assert asked is not None
    if any(not set(asked.modes or ()) <= set(m.modes) for m in asked.machines):
        asked = replace(asked, modes=None)
    return drawn(compute.compare(asked), first, resolution)


def drawn(found: compute.Compared, first: Review, resolution: Resolution) -> Compared:
    """A comparison with what the scene shows of it; ``first`` is the review of the first design."""
    asked, parts = found.request, tuple[compute.Drawn, ...]()
    if found.common is not None:
        parts = compute.drawn(asked, resolution)
        if max(len(part.faces) for part in parts) > MOST_FACES:
            parts = compute.drawn(asked, "preview")
    return Compared(found, parts, first)


def reviews_of(request: compute.Request) -> tuple[Review, ...]:
    """A review of each design as it is compared: at its pose, in its mode, of its modes."""
    made = []
    for machine in request.machines:
        review = new_review(machine.design)
        if machine.kind == request.machines[0].kind and request.mode in machine.modes:
            review = replace(review, pose=request.pose, mode=request.mode)
            review, _ = change(review, ChooseModes(request.modes or "all"))
        made.append(review)
    return tuple(made)


def beside_of(review: Review) -> tuple[Review, ...]:
    """The review, and its others: of the designs that are compared with it."""
    return (review, *(new_review(design) for design in review[Beside].designs))


def chapter(of: Compared, view: View) -> Chapter:
    """The comparison; ``view`` of the first design."""
    found = of.found
    letters = LETTERS[: len(found.request.designs)]
    title = f"{', '.join(letters[:-1])} and {letters[-1]} side by side"
    where = _where(of)
    shapes = tuple(_shapes(of))
    blocks: list[Block] = []
    if shapes:
        alt = f"Drawing: machine A with the parts of the workspaces, {where}."
        still = Figure(drawing.picture(view, shapes, alt), f"Machine A; {where}.", alt)
        blocks.append(Scene(pack(view, shapes), still))
    legend = [
        Run(f"{letter} {design.title or design.name}{APART}", chip=color)
        for letter, design, color in zip(
            letters, found.request.designs, html.colors(LIGHT), strict=False
        )
    ]
    blocks.append(Words(tuple(legend)))
    blocks += read(html.answer_html(found), f"The workspaces over one another, {where}")
    measures = read(
        html.measures_html(found.rows, letters), f"Measures, the best one marked ◂; {where}"
    )
    differing = read(html.differences_html(found), "Numbers in which the designs differ")
    asked = read(html.pose_html(found), "The same pose asked of all")
    areas: list[Block] = []
    for figure, caption in (
        (plot.areas_figure(found), "The area of the sections against their place."),
        (plot.sections_figure(found), "The sections by one plane over one another."),
    ):
        if figure is not None:
            told = f"{caption} Each in its own base frame: {figure.idle}."
            areas.append(charts.framed(figure, told, share=0.75))
    return Chapter(
        title,
        where,
        (
            Section("Workspaces over one another", tuple(blocks)),
            Section("Measures", (*measures, *areas)),
            Section("What differs in the designs", differing),
            Section("At one pose", asked),
        ),
    )


def _where(of: Compared) -> str:
    """At which orientation, and in which modes."""
    request = of.found.request
    axes = {c.key: c for c in request.machines[0].coordinates}
    held = [
        f"{axes[key].symbol} {tenths(axes[key].outer(value))}°"
        for key, value in request.held
        if value is not None
    ]
    modes = request.modes
    named = "every mode" if modes is None else f"mode {', '.join(modes)}" if modes[0] else ""
    return minus(" · ".join(filter(None, (", ".join(held), named))))


def _shapes(of: Compared) -> Iterator[drawing.Shape]:
    letters = LETTERS
    titles = ["What all reach", *(f"Only {letter}" for letter in letters)]
    light, dark = html.colors(LIGHT), html.colors(DARK)
    for n, part in enumerate(of.parts):
        if len(part.faces):
            # What all reach is quiet; what one alone reaches has its colour.
            color = (LIGHT.dot, DARK.dot) if n == 0 else (light[n - 1], dark[n - 1])
            yield drawing.Shape(
                f"part{n}",
                titles[n],
                True,
                np.asarray(part.vertices, dtype=float),
                part.faces,
                np.asarray(part.lines, dtype=float),
                color,
                color,
                painting.PLAIN if n == 0 else painting.MEASURE,
            )
