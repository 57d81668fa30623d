"""`bohemia volume` and `bohemia section`: exact answers where the machine has exact sections."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from app.terminal.command import Answer, Output, command, progress
from app.terminal.options import DESIGN, MODES, ORIENTATION, Modes, flag, option, output, tolerance
from kinematics.errors import InputError

if TYPE_CHECKING:
    from app.terminal.poses import Angles, Given
    from kinematics.answers.sections import Box, Sphere
    from kinematics.facets.sections import SectionsFacet
    from kinematics.facets.solids import SolidSpec
    from kinematics.facets.spaces import Space
    from kinematics.machine import Machine


@command("volume")
def volume(
    machine: Machine[Any] = DESIGN,
    pose: Given = ORIENTATION,
    modes: Modes = MODES,
    tolerance: float | None = tolerance("1e-06, of a solid 0.001", None),
    no_pieces: bool = flag("without its connected pieces, several times as fast"),
    usable: bool = flag("also the largest sphere and box inside"),
    around: list[float] | None = option(
        "x,y,z", "their common centre, mm, base frame; implies --usable", values.point
    ),
) -> Answer:
    """The workspace's volume: exact, from its sections, or of its solid with a stated error.

    A workspace that is of one mode only is of the home mode unless --modes names another.
    """
    angles, began = pose.angles(), time.perf_counter()
    spec = _solid(machine, angles)
    if spec is not None:
        if usable or around is not None:
            _sections(machine)
        angles = pose.angles(spec.key)
        if spec.of_present_mode and modes is None:
            modes = (machine.home.mode,)
    space = angles.space(modes)
    with progress("Volume"):
        relative = tolerance or (1e-6 if spec is None else 1e-3)
        found = space.volume(relative, pieces=not no_pieces)
    seconds = time.perf_counter() - began
    centroid = tables.plain(found.centroid) if found.value > 0.0 else None
    data: dict[str, Any] = {
        **angles.entries(),
        **tables.modes_entry(modes),
        **tables.record(found, "sections", volume_mm3="value", error_mm3="error"),
        "centroid_mm": centroid,
        "seconds": seconds,
    }
    if not no_pieces:
        data |= {"pieces": len(found.pieces), "piece_volumes_mm3": found.pieces}
    noun = machine.mode_noun
    lines = [
        ", ".join(filter(None, (angles.text(), noun and tables.modes_text(modes, noun)))),
        f"volume    {tables.volume_text(found.value)} ± {tables.volume_text(found.error)}",
        *([] if no_pieces else [f"pieces    {tables.pieces_text(found.pieces)}"]),
        *([f"centroid  {_place(centroid)}"] if centroid else []),
        f"sections  {found.sections}, in {tables.seconds_text(seconds)}"
        if spec is None
        else f"of        {spec.title}, a mesh, in {tables.seconds_text(seconds)}",
    ]
    if usable or around is not None:
        together, home = modes is None and len(machine.modes) > 1, machine.home.mode
        with progress("Largest sphere and box"):
            if together:
                told, own = _usable(angles.space((home,)), around)
                data["home_mode"] = {"mode": home, **own}
                named = tables.modes_text((home,), machine.mode_noun)
                lines += ["", f"{named}, which a machine keeps on its way", *told, ""]
                lines += [f"{tables.modes_text(None, machine.mode_noun)} together"]
            told, own = _usable(space, around)
        data |= own
        lines += told
    return Answer(data, lines)


def _usable(space: Space[Any], around: list[float] | None) -> tuple[list[str], dict[str, Any]]:
    """The largest sphere and box in a workspace, in lines and for JSON."""
    sphere, box = space.largest_ball(around), space.largest_box(around)
    data = {
        "sphere": sphere and tables.record(sphere, "center_mm", "radius_mm", "error_mm"),
        "box": box and tables.record(box, "low_mm", "high_mm", "volume_mm3", "error_mm"),
    }
    return [f"sphere    {_sphere(sphere)}", f"box       {_box(box)}"], data


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


def _place(point: Sequence[float]) -> str:
    return f"({', '.join(f'{value:.4f}' for value in point)}) mm"


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

    kind, facet, angles = output.kind(files.FORMATS, "a section"), _sections(machine), pose.angles()
    spec, where = facet.spec, f"{angles.text()}, {tables.modes_text(modes)}"
    space = angles.space(modes)
    with progress(f"{spec.title} = {at:g} mm"):
        found = space.section(at)
        reach = facet.range(space.pose, modes)
    if kind:
        title = f"{machine.design.title or machine.design.name}, {where}, {spec.normal} = {at:g} mm"
        written = files.section_bytes(found, spec, kind, title=title, unit=output.unit)
        output.write(written, output.unit_of(kind))
    moments = dict(zip(("yy", "zz", "yz"), found.second_moments.tolist(), strict=True))
    data = {
        **angles.entries(),
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
        between = f"{spec.normal} = {reach[0]:.4f} mm and {reach[1]:.4f} mm"
        lines.append(f"empty; the workspace lies between {between}")
    return Answer(data, lines)


def _solid(machine: Machine[Any], angles: Angles) -> SolidSpec | None:
    """The solid that is to be measured; None where exact sections are."""
    if machine.sections is not None:
        return None
    specs = [s for s in machine.solid_specs if s.key.partition("/")[0] == "workspace"]
    found = next((s for s in specs if s.follows == angles.follows), None)
    if found is None:
        name = machine.design.name
        more = f", bohemia volume {name} with - for one angle a volume" if specs else ""
        raise InputError(_in_a_plane(machine) + more)
    return found


def _sections(machine: Machine[Any]) -> SectionsFacet[Any]:
    if machine.sections is not None:
        return machine.sections
    if machine.region_specs:
        raise InputError(_in_a_plane(machine))
    raise InputError(f"{machine.design.name}: a {machine.title} has no exact sections")


def _in_a_plane(machine: Machine[Any]) -> str:
    name = machine.design.name
    return (
        f"{name}: the workspace of a {machine.title} lies in a plane; "
        f"bohemia workspace {name} gives its area"
    )
