"""The numbers of a report, each with its error and with what it is of."""

from __future__ import annotations

import math
from collections.abc import Iterator

from app.features.report.compute import Found, Shown
from app.features.report.model import Run, Runs, Table, Words, table
from app.features.section.compute import of_what
from app.features.singularities.compute import Here
from app.features.singularities.html import TOLD, limit, measure_text
from app.features.workspace.compute import piece_around
from app.features.workspace.state import ASPECTS, KEY
from app.review.units import (
    area_text,
    how_far,
    minus,
    plural,
    spaced,
    tenths,
    volume_text,
)
from app.review.view import mode_text
from app.terminal import tables
from kinematics.answers.clearances import Clearance

Row = tuple[Runs | str, Runs | str, Runs | str, Runs | str]
MOST = 8  # pieces that are told
ROUNDING = "rounding"


def verdict(found: Found) -> Words:
    """The page's status in one line."""
    status = found.view.status
    tone = status.level
    runs = (Run(status.verdict, bold=True), Run(f" · {status.text.partition(' · ')[2]}"))
    told = runs if status.text.startswith(status.verdict) else (Run(status.text, bold=True),)
    remedy = (Run(f" {status.remedy}"),) if status.remedy else ()
    return Words((*told, *remedy), tone)


def results(found: Found) -> Table:
    """What matters most."""
    rows = [*_workspace(found), *_near(found), *_modes(found), *_measures(found)]
    heads = ("Result", "Value", "Error", "Of what, and how it was found")
    return table("Results", heads, rows, [1, 2])


def _sized(value: float, error: float) -> tuple[str, str]:
    """A volume and its error, a text each."""
    told, _, unit = volume_text(value, error).rpartition(" ")
    number, _, off = told.partition(" ± ")
    return f"{number} {unit}", f"{off} {unit}" if off else ROUNDING


def _length(value: float, error: float) -> tuple[str, str]:
    return f"{value:.2f} mm", _error(error, "mm", value)


def _error(error: float, unit: str, value: float = 1.0) -> str:
    """An error; one that no double of the value shows is rounding."""
    if not error > 1e-12 * abs(value):
        return ROUNDING
    return minus(f"{error:.1g} {unit}")


def _workspace(found: Found) -> Iterator[Row]:
    measured, machine = found.measured, found.review.machine
    if measured is not None:
        angles = minus(of_what(measured.of))
        yield (
            "Workspace, this mode",
            *_sized(measured.present.value, measured.present.error),
            f"{angles}; {plural(measured.present.sections, 'exact section')}",
        )
        if len(machine.modes) > 1:
            turned = angles.partition(" · ")[0]
            yield (
                "Workspace, every mode",
                *_sized(measured.every.value, measured.every.error),
                f"{turned}, all modes together; {plural(measured.every.sections, 'exact section')}",
            )
        if measured.present.pieces:
            count = plural(len(measured.present.pieces), "piece")
            largest = measured.present.pieces[0]
            error = measured.present.error
            yield "Largest piece, this mode", *_sized(largest, error), f"of {count}; exact sections"
        if measured.ball is not None:
            center = ", ".join(map(tenths, measured.ball.center))
            value = _length(measured.ball.radius, measured.ball.error)
            yield "Radius of the largest ball, this mode", *value, f"about {center} mm, {angles}"
        if measured.box is not None:
            sides = " × ".join(f"{v:.1f}" for v in measured.box.high - measured.box.low)
            off = _length(0.0, measured.box.error)[1]
            where = ", ".join(map(tenths, 0.5 * (measured.box.low + measured.box.high)))
            volume = volume_text(measured.box.volume)
            told = f"about {where} mm, {volume}; error of a face"
            yield "Largest box, this mode", f"{sides} mm", off, told
        if measured.free is not None:
            center = ", ".join(map(tenths, measured.free.center))
            value = _length(measured.free.radius, measured.free.error)
            yield "Largest ball without a singularity", *value, f"about {center} mm, {angles}"
    for laid in found.regions[:1]:
        areas = [r.section for r in laid.regions]
        area, error = sum(s.area for s in areas), sum(s.area_error for s in areas)
        exact = "exact arcs" if all(r.deviation == 0.0 for r in laid.regions) else "curves"
        off = _error(error, "mm²", area)
        modes = "every mode together" if laid.wish.modes is None else _modes_of(found)
        yield laid.spec.title, area_text(area), off, f"{modes}; {exact}"
    if measured is None:
        for each in found.solids:
            solid = each.built.solid
            if each.spec.key == ASPECTS or not solid.triangles:
                continue
            mode = mode_text(machine, found.review.mode)
            made = f"{each.built.resolution} mesh, {plural(len(solid.pieces), 'piece')}"
            told = "; ".join(filter(None, (mode, made)))
            yield each.spec.title, *_sized(solid.volume, solid.volume_error), told


def _modes_of(found: Found) -> str:
    return mode_text(found.review.machine, found.review.mode) or "the workspace"


def _near(found: Found) -> Iterator[Row]:
    nearest = found.here.nearest("parallel", "constraint")
    if nearest is not None:
        yield (
            "Distance to a singularity",
            how_far(nearest),
            _off(nearest),
            f"{nearest.kind}; from this pose, at its orientation",
        )
    margin = found.view.posture.nearest
    if margin is not None and found.view.posture.reachable:
        fact = found.view.status.facts[0] if found.view.status.facts else None
        if fact is not None:
            yield "Travel left", fact.value, ROUNDING, fact.what.removeprefix("of travel left, ")
    for circle in found.here.circles:
        value = f"{math.degrees(circle.radius):.4f}°"
        off = _error(math.degrees(circle.error), "°").replace(" °", "°")
        yield f"Circle of orientations, {circle.limit}", value, off, circle.text


def _off(way: Clearance) -> str:
    """The error of a distance."""
    return _error(way.error, "mm", way.distance)


def _modes(found: Found) -> Iterator[Row]:
    if found.known is None:
        return
    solutions = found.known.solutions
    yield (
        "Assembly modes here",
        f"{int(solutions.multiplicity.sum())} of {solutions.complex_count}",
        "none" if solutions.complete else "not known",
        f"real of complex solutions; {tables.known(solutions)}",
    )


def _measures(found: Found) -> Iterator[Row]:
    size = f"{found.review.machine.length:.1f}"
    for measure, value in found.here.measures:
        if math.isfinite(value):
            best = ""
            if measure.limits[0] is not None and measure.limits[1] is not None:
                best = f"; {measure.limits[0]:g} to {measure.limits[1]:g}"
            told = f"at this pose, moments by L = {size} mm{best}"
            if measure.needs_load:
                told = "at this pose, under the load"
            yield measure.title, measure_text(measure, value), ROUNDING, told


def clearances(here: Here) -> Table:
    """How far it is to each limit, with its error."""
    rows = []
    for way in here.clearances[:TOLD]:
        color, what, far = limit(way, 2)
        rows.append(((Run(what, chip=color),), far, _off(way)))
    heads = ("nearest at this orientation", "how far", "±")
    return table("Limits, the nearest first", heads, rows, [1, 2])


def pieces(found: Found, each: Shown) -> Table:
    """The pieces of a solid, that of the machine marked."""
    solid = each.built.solid
    here = piece_around(found.review, each.built) if found.review.posture.reachable else None
    largest = max((piece.volume for piece in solid.pieces), default=1.0)
    rows = []
    for n, piece in enumerate(solid.pieces[:MOST]):
        own = n == here
        color = "var(--bo-work,#54677C)" if own else "var(--bo-bar,#9AA7B6)"
        bar: Runs = (Run("", bar=((0.0, piece.volume / largest, color),)),)
        share = f"{100.0 * piece.volume / solid.volume:.0f} %"
        where = "the machine is here" if own else ""
        rows.append((f"{n + 1}", where, volume_text(piece.volume), share, bar))
    left = len(solid.pieces) - MOST
    more = f" And {left} smaller ones." if left > 0 else ""
    whole = volume_text(solid.volume, solid.volume_error)
    note = f"{each.built.resolution.capitalize()} mesh, {spaced(solid.triangles)} triangles: "
    note += f"{whole} together; {tables.surface_text(solid)}.{more} {solid.note}".rstrip()
    marked = [] if here is None else [here]
    heads = ("piece", "", "volume", "share", "")
    name = each.spec.title if each.spec.key != KEY else "Pieces of the workspace"
    return table(name, heads, rows, [2, 3], marked=marked, note=minus(note))
