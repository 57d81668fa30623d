"""`bohemia volume` and `bohemia section`: exact answers, without a solid."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from app.terminal.command import Answer, Output, command, progress
from app.terminal.options import DESIGN, MODES, ORIENTATION, Modes, flag, option, output, tolerance
from kinematics.errors import InputError

if TYPE_CHECKING:
    from app.terminal.poses import Given
    from kinematics.answers.sections import Box, Sphere
    from kinematics.facets.sections import SectionsFacet
    from kinematics.machine import Machine


@command("volume")
def volume(
    machine: Machine[Any] = DESIGN,
    pose: Given = ORIENTATION,
    modes: Modes = MODES,
    tolerance: float = tolerance("1e-06"),
    no_pieces: bool = flag("without its connected pieces, several times as fast"),
    usable: bool = flag("also the largest sphere and box inside"),
    around: list[float] | None = option(
        "x,y,z", "their common centre, mm, base frame; implies --usable", values.point
    ),
) -> Answer:
    """The workspace's exact volume, from its sections."""
    sections, turned = _sections(machine), pose.orientation()
    began = time.perf_counter()
    with progress("Volume"):
        found = sections.volume(turned.pose, modes, relative=tolerance, pieces=not no_pieces)
    seconds, pieces = time.perf_counter() - began, list(found.pieces)
    centroid = found.centroid.tolist() if found.value > 0.0 else None
    data = {
        **turned.entries(),
        **tables.modes_entry(modes),
        **tables.record(found, "sections", volume_mm3="value", error_mm3="error"),
        "centroid_mm": centroid,
        **({} if no_pieces else {"pieces": len(pieces), "piece_volumes_mm3": pieces}),
        "seconds": seconds,
    }
    lines = [
        f"{turned.text()}, {tables.modes_text(modes)}",
        f"volume    {tables.volume_text(found.value)} ± {tables.volume_text(found.error)}",
        *([] if no_pieces else [f"pieces    {tables.pieces_text(pieces)}"]),
        *([f"centroid  {_place(centroid)}"] if centroid else []),
        f"sections  {found.sections}, in {tables.seconds_text(seconds)}",
    ]
    if usable or around is not None:
        with progress("Largest sphere and box"):
            sphere = sections.ball(turned.pose, modes, around)
            box = sections.box(turned.pose, modes, around)
        data["sphere"] = sphere and tables.record(sphere, "center_mm", "radius_mm", "error_mm")
        data["box"] = box and tables.record(box, "low_mm", "high_mm", "volume_mm3", "error_mm")
        lines += [f"sphere    {_sphere(sphere)}", f"box       {_box(box)}"]
    return Answer(data, lines)


def _sphere(found: Sphere | None) -> str:
    if found is None:
        return "none"
    about = f"about {_place(found.center.tolist())}"
    if found.radius == 0.0:
        return f"none {about}, which is not inside"
    return f"radius {found.radius:.4f} mm {about}"


def _box(found: Box | None) -> str:
    if found is None or not found.volume > 0.0:
        return "none"
    edges = " × ".join(f"{edge:.4f}" for edge in (found.high - found.low).tolist())
    return f"{edges} mm, {_place(found.low.tolist())} to {_place(found.high.tolist())}"


@command("section")
def section(
    machine: Machine[Any] = DESIGN,
    pose: Given = ORIENTATION,
    at: float = option("X", "where the plane stands, mm", values.number, "--x", required=True),
    modes: Modes = MODES,
    output: Output = output(".svg, .dxf (true arcs) or .csv"),
) -> Answer:
    """The exact section of the workspace at x' = X.

    In JSON every loop is a list of edges, the section to their left; from, to, center and radius
    are mm, and second_moments_mm4 the integrals of y'^2 (yy), z'^2 (zz) and y'z' (yz) about the
    centroid.
    """
    from app.features.section import files

    kind = output.kind(files.FORMATS, "a section")
    sections, turned = _sections(machine), pose.orientation()
    spec, where = sections.spec, f"{turned.text()}, {tables.modes_text(modes)}"
    with progress(f"{spec.title} = {at:g} mm"):
        found = sections.at(turned.pose, modes, at)
        reach = sections.range(turned.pose, modes)
    if kind:
        title = f"{machine.design.title or machine.design.name}, {where}, {spec.normal} = {at:g} mm"
        output.write(files.section_bytes(found, spec, kind, title=title))
    moments = dict(zip(("yy", "zz", "yz"), found.second_moments.tolist(), strict=True))
    data = {
        **turned.entries(),
        **tables.modes_entry(modes),
        "x_mm": at,
        **tables.record(found, "area_mm2", "perimeter_mm", "pieces", loop_pieces="loop_piece"),
        "loops": files.section_loops(found),
        "loop_areas_mm2": found.loop_area.tolist(),
        "centroid_mm": found.centroid.tolist() if found.loops else None,
        "second_moments_mm4": moments if found.loops else None,
        "range_mm": reach,
    }
    lines = [where, f"{spec.title} = {at:g} mm"]
    if found.loops:
        holes = int((found.loop_area < 0).sum())
        told = f", {holes} hole{'s' if holes > 1 else ''}" if holes else ""
        first, second = found.centroid.tolist()
        lines += [
            f"area       {found.area:.4f} mm²",
            f"perimeter  {found.perimeter:.4f} mm",
            f"pieces     {found.pieces}, bounded by {len(found.limb)} edges{told}",
            f"centroid   {spec.axes[0]} = {first:.4f} mm, {spec.axes[1]} = {second:.4f} mm",
        ]
    elif reach is None:
        lines.append("empty, as the whole workspace is")
    else:
        low, high = reach
        lines.append(
            f"empty; the workspace lies between {spec.normal} = {low:.4f} mm and {high:.4f} mm"
        )
    return Answer(data, lines)


def _sections(machine: Machine[Any]) -> SectionsFacet[Any]:
    name = machine.design.name
    if machine.sections is not None:
        return machine.sections
    if machine.region_specs:
        raise InputError(
            f"{name}: the workspace of a {machine.title} lies in a plane, so it has no volume and "
            f"no sections; bohemia workspace {name} gives its area"
        )
    raise InputError(
        f"{name}: a {machine.title} has no exact sections; bohemia workspace {name} gives the "
        "volume of its solid"
    )


def _place(point: Sequence[float]) -> str:
    return f"({', '.join(f'{value:.4f}' for value in point)}) mm"
