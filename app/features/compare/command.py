"""`bohemia compare`: two to four designs side by side."""

from __future__ import annotations

from math import ceil, isnan, log10
from typing import TYPE_CHECKING, Any

from app.features.compare import LETTERS
from app.terminal import tables, values
from app.terminal.command import Answer, Output, command, load, progress
from app.terminal.options import (
    DESIGN,
    MODES,
    Modes,
    argument,
    option,
    output,
    pose,
    preset_names,
    tolerance,
)
from kinematics.errors import InputError

if TYPE_CHECKING:
    from app.features.compare.compute import Asked, Compared
    from app.terminal.poses import Given
    from kinematics.machine import Machine


@command("compare")
def compare(
    machine: Machine[Any] = DESIGN,
    others: tuple[str, ...] = argument("DESIGN...", preset_names, files=True, nargs=-1),
    pose: Given = pose(
        "0. The orientation is that of all workspaces; a whole pose is asked of all designs, "
        "without one the home position of the first at that orientation"
    ),
    modes: Modes = MODES,
    tolerance: float = tolerance("1e-06"),
    at: float | None = option(
        "X", "where the plane of sections stands, mm; without it, through O'", values.number, "--x"
    ),
    output: Output = output("a folder of solids and tables, or a report: .html or .pdf"),
) -> Answer:
    """Two to four designs side by side, base frames on one another.

    How large their workspaces are, what they have in common and what each alone reaches, measures
    with the best one marked, what differs in the designs, and what each answers to one pose. Exact
    for 5-RPURs and five-bars; else solids are cut, with an error that is told.
    """
    from app.features.compare import files
    from app.features.compare.compute import Request
    from app.features.compare.compute import compare as found_of
    from kinematics.facets.comparison import MOST

    machines = (machine, *map(load, others))
    if not 2 <= len(machines) <= MOST:
        raise InputError(f"name two to {MOST} designs, as bohemia compare A B; got {len(machines)}")
    files.check(output)
    keys = [spec.key for spec in machine.solid_specs if spec.key == "workspace"]
    angles, home = pose.angles(*keys), machine.home
    mode = home.mode if modes is None else modes[0]
    whole = pose.whole and pose.positioned
    held = tuple((a.key, None if isnan(v) else a.inner(v)) for a, v in angles.held)
    request = Request(
        tuple(each.design for each in machines),
        held,
        modes,
        tuple(pose.place(mode).pose if whole else machine.pose(mode, **dict(held))),
        mode,
        at,
    )
    with progress("Comparing"):
        found = found_of(request, tolerance)
    if output.path is not None:
        with progress("Writing"):
            files.write(found, output)
    lines = [
        ", ".join(filter(None, (angles.text(), _modes(machine, modes)))),
        *_lines(found),
    ]
    warnings = [f"{m.design.name}: {text}" for m in machines[1:] for text in tables.warnings(m)]
    data = {**angles.entries(), **tables.modes_entry(modes), **_data(found), "warnings": warnings}
    return Answer(data, lines)


def _modes(machine: Machine[Any], modes: Modes) -> str:
    if modes is None and any(spec.of_present_mode for spec in machine.solid_specs[:1]):
        modes = (machine.home.mode,)
    return tables.modes_text(modes, machine.mode_noun) if machine.mode_noun else ""


def _lines(found: Compared) -> list[str]:
    """What is printed."""
    from app.features.compare.compute import differing

    request = found.request
    names = [design.name for design in request.designs]
    letters = LETTERS[: len(names)]
    lines = [f"{letter}  {name}" for letter, name in zip(letters, names, strict=True)]
    if found.common is None:
        lines += ["", f"not over one another: {found.why}"]
    else:
        parts = [*zip(letters, found.sizes, strict=True), ("common", found.common)]
        parts += [(f"only {n}", size) for n, size in zip(letters, found.only, strict=True)]
        head = ("part", f"size ({found.unit})", "±")
        rows = [
            (name, _digits(size.value, size.error), f"{size.error:.2g}") for name, size in parts
        ]
        lines += ["", tables.table(head, rows)]
    lines += ["", tables.table(("measure", *letters, "best"), _measures(found, letters))]
    told = differing(found)
    if told:
        cells = [(one["label"], *(_number(v) for v in one["values"]), one["unit"]) for one in told]
        lines += ["", tables.table(("differs", *letters, "unit"), cells)]
    else:
        lines += ["", "no number of the designs differs"]
    machine = request.machines[0]
    spec = machine.section_spec
    cut = [(n, one) for n, one in zip(letters, found.outlines, strict=True) if one is not None]
    if cut and spec is not None:
        areas = ", ".join(f"{letter} {one.area:.4f} mm²" for letter, one in cut)
        lines += ["", f"sections at {spec.normal} = {found.at:g} mm: {areas}"]
    pose = tables.with_units(tables.outer(request.pose, machine.coordinates), machine.coordinates)
    lines += ["", f"pose {pose}{tables.mode_text(machine, request.mode)}"]
    for letter, one in zip(letters, found.asked, strict=True):
        lines.append(f"{letter}  {_answer(one)}")
    return lines


def _answer(one: Asked) -> str:
    """ "reachable", or why not."""
    if one.posture is None:
        return f"not asked: {one.why}"
    if one.posture.reachable:
        return "reachable"
    return f"not reachable: {'; '.join(reason.text for reason in one.posture.reasons)}"


def _measures(found: Compared, letters: str) -> list[tuple[str, ...]]:
    rows = []
    for row in found.rows:
        title = f"{row.title} ({row.unit})" if row.unit else row.title
        values = (tables.number_text(value) for value in row.values)
        rows.append((title, *values, ", ".join(letters[n] for n in row.best)))
    return rows


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.10g}"


def _digits(value: float, error: float) -> str:
    """To the digits that the error leaves."""
    return tables.grouped(value, min(max(0, ceil(-log10(error))), 6) if error > 0.0 else 2)


def _data(found: Compared) -> dict[str, Any]:
    """For JSON."""
    from app.features.compare.compute import differing

    request = found.request
    tail = "mm3" if found.unit == "mm³" else "mm2"
    of, error = ("volume_mm3", "error_mm3") if tail == "mm3" else ("area_mm2", "area_error_mm2")
    sizes: list[Any] = [*found.sizes] or [None] * len(request.designs)
    names = [design.name for design in request.designs]
    designs = []
    for machine, size, one in zip(request.machines, sizes, found.asked, strict=True):
        posture = one.posture
        designs.append(
            {
                **tables.record(machine.design, "name", "mechanism", "title", "source"),
                **({} if size is None else {of: size.value, error: size.error}),
                "at_pose": {
                    "reachable": None if posture is None else posture.reachable,
                    "joints": None
                    if posture is None
                    else tables.listed(posture.joints, machine.joints),
                    "reasons": [one.why]
                    if posture is None
                    else [reason.text for reason in posture.reasons],
                },
            }
        )
    machine = request.machines[0]
    common = found.common
    return {
        "designs": designs,
        f"common_{tail}": None if common is None else common.value,
        f"common_error_{tail}": None if common is None else common.error,
        "only": [
            {"design": name, of: size.value, error: size.error}
            for name, size in zip(names, found.only, strict=False)
        ],
        "sections": [
            {"design": name, "x_mm": found.at, "area_mm2": one.area}
            for name, one in zip(names, found.outlines, strict=True)
            if one is not None
        ],
        "exact": found.exact,
        "why_not": found.why or None,
        "measures": [
            {
                **tables.record(row, "key", "title", "unit"),
                "values": tables.plain(row.values),
                "errors": tables.plain(row.errors),
                "best": [names[n] for n in row.best],
            }
            for row in found.rows
        ],
        "differences": differing(found),
        "pose": tables.named(request.pose, machine.coordinates),
        **tables.mode_entry(machine, request.mode),
    }
