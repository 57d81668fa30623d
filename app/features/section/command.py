"""`bohemia volume` and `bohemia section`: exact answers, without a solid."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.terminal import common, tables
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.answers.sections import Box, Section, SectionSpec, Sphere, Volume
    from kinematics.facets.sections import SectionsFacet
    from kinematics.machine import Machine
    from kinematics.mechanism import Design

TOLERANCE = 1e-6


def register(command: common.AddCommand) -> None:
    volume = command("volume", _volume, "The workspace's exact volume, from its sections.")
    common.add_design(volume)
    common.add_orientation(volume)
    common.add_modes(volume)
    common.add_tolerance(volume, TOLERANCE)
    volume.add_argument(
        "--usable", action="store_true", help="also the largest sphere and box inside"
    )
    volume.add_argument(
        "--around", metavar="x,y,z", help="their common centre, mm, base frame; implies --usable"
    )
    common.add_json(volume)

    section = command("section", _section, "The exact section of the workspace at x' = X.")
    common.add_design(section)
    common.add_orientation(section)
    section.add_argument("--x", required=True, metavar="X", help="where the plane stands, mm")
    common.add_modes(section)
    section.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="write .svg, .dxf (true arcs) or .csv"
    )
    section.epilog = (
        "In JSON every loop is a list of edges, the section to their left; second_moments_mm4 are "
        "the integrals of y'^2 (yy), z'^2 (zz) and y'z' (yz) about the centroid."
    )
    common.add_json(section)


# --- volume --------------------------------------------------------------------------------


def _volume(arguments: argparse.Namespace) -> None:
    machine = common.load(arguments.design)
    design = machine.design
    sections = _sections(machine)
    modes = common.chosen_modes(arguments.modes, machine.modes)
    around = None if arguments.around is None else _point(arguments.around)
    turned = common.orientation(arguments, machine)
    pose = turned.pose
    began = time.perf_counter()
    with common.progress("Volume"):
        found = sections.volume(pose, modes, relative=arguments.tolerance)
    seconds = time.perf_counter() - began
    wanted = arguments.usable or around is not None
    sphere, box = None, None
    if wanted:
        with common.progress("Largest sphere and box"):
            sphere = sections.ball(pose, modes, around)
            box = sections.box(pose, modes, around)
    common.warn(machine)
    if not arguments.json:
        common.print_head(design, _where(turned, modes))
        print("\n".join(_volume_lines(found, seconds)))
        if wanted:
            print("\n".join(_usable_lines(sphere, box)))
        return
    common.print_json(
        {
            **_about(turned, design, modes),
            "volume_mm3": found.value,
            "error_mm3": found.error,
            "centroid_mm": found.centroid.tolist() if found.value > 0.0 else None,
            "pieces": len(found.pieces),
            "piece_volumes_mm3": found.pieces,
            "sections": found.sections,
            "seconds": seconds,
            **({"sphere": _sphere(sphere), "box": _box(box)} if wanted else {}),
        }
    )


def _sphere(found: Sphere | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {
        "center_mm": found.center.tolist(),
        "radius_mm": found.radius,
        "error_mm": found.error,
    }


def _box(found: Box | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {
        "low_mm": found.low.tolist(),
        "high_mm": found.high.tolist(),
        "volume_mm3": found.volume,
        "error_mm": found.error,
    }


def _volume_lines(found: Volume, seconds: float) -> list[str]:
    pieces = ", ".join(map(tables.volume_text, found.pieces))
    count = len(found.pieces)
    lines = [
        f"volume    {tables.volume_text(found.value)} ± {tables.volume_text(found.error)}",
        f"pieces    {count}" + (f": {pieces}" if count > 1 else ""),
    ]
    if found.value > 0.0:
        lines.append(f"centroid  {_place(found.centroid.tolist())}")
    lines.append(f"sections  {found.sections}, in {tables.seconds_text(seconds)}")
    return lines


def _usable_lines(sphere: Sphere | None, box: Box | None) -> list[str]:
    lines = ["sphere    none", "box       none"]
    if sphere is not None:
        about = f"about {_place(sphere.center.tolist())}"
        lines[0] = f"sphere    radius {sphere.radius:.4f} mm {about}"
        if sphere.radius == 0.0:
            lines[0] = f"sphere    none {about}, which is not inside"
    if box is not None and box.volume > 0.0:
        low, high = box.low.tolist(), box.high.tolist()
        edges = " × ".join(f"{b - a:.4f}" for a, b in zip(low, high, strict=True))
        lines[1] = f"box       {edges} mm, {_place(low)} to {_place(high)}"
    return lines


# --- section -------------------------------------------------------------------------------


def _section(arguments: argparse.Namespace) -> None:
    from app.features.section import files

    path: Path | None = arguments.output
    kind = None if path is None else common.ending(path, files.FORMATS, "a section")
    machine = common.load(arguments.design)
    design = machine.design
    sections = _sections(machine)
    spec = sections.spec
    at = common.number(arguments.x, "--x")
    modes = common.chosen_modes(arguments.modes, machine.modes)
    turned = common.orientation(arguments, machine)
    pose = turned.pose
    with common.progress(f"{spec.title} = {at:g} mm"):
        found = sections.at(pose, modes, at)
        reach = sections.range(pose, modes)
    common.warn(machine)
    if path is not None and kind is not None:
        title = f"{design.title or design.name}, {_where(turned, modes)}, {spec.normal} = {at:g}"
        common.write(path, files.section_bytes(found, spec, kind, title=f"{title} mm"))
    if not arguments.json:
        common.print_head(design, _where(turned, modes))
        print("\n".join(_section_lines(found, spec, reach, path)))
        return
    common.print_json(
        {
            **_about(turned, design, modes),
            "x_mm": at,
            "area_mm2": found.area,
            "perimeter_mm": found.perimeter,
            "loops": files.section_loops(found),
            "loop_areas_mm2": found.loop_area.tolist(),
            "loop_pieces": found.loop_piece.tolist(),
            "pieces": found.pieces,
            "centroid_mm": found.centroid.tolist() if found.loops else None,
            "second_moments_mm4": _moments(found),
            "range_mm": reach,
            "file": None if path is None else str(path),
        }
    )


def _moments(found: Section) -> dict[str, float] | None:
    if not found.loops:
        return None
    return dict(zip(("yy", "zz", "yz"), found.second_moments.tolist(), strict=True))


def _section_lines(
    found: Section, spec: SectionSpec, reach: tuple[float, float] | None, path: Path | None
) -> list[str]:
    lines = [f"{spec.title} = {found.at:g} mm"]
    if found.loops:
        holes = int((found.loop_area < 0).sum())
        pieces = f"{found.pieces}, bounded by {len(found.limb)} edges"
        first, second = found.centroid.tolist()
        u, v = spec.axes
        lines += [
            f"area       {found.area:.4f} mm²",
            f"perimeter  {found.perimeter:.4f} mm",
            f"pieces     {pieces}" + (f", {holes} holes" if holes > 1 else ", 1 hole" * holes),
            f"centroid   {u} = {first:.4f} mm, {v} = {second:.4f} mm",
        ]
    elif reach is None:
        lines.append("empty, as the whole workspace is")
    else:
        lines.append(
            f"empty; the workspace lies between {spec.normal} = {reach[0]:.4f} mm "
            f"and {reach[1]:.4f} mm"
        )
    if path is not None:
        lines.append(f"file       {path}")
    return lines


# --- both ----------------------------------------------------------------------------------


def _sections(machine: Machine[Any]) -> SectionsFacet[Any]:
    name = machine.design.name
    if machine.sections is None:
        if machine.region_specs:
            raise InputError(
                f"{name}: the workspace of a {machine.title} lies in a plane, so it "
                f"has no volume and no sections; bohemia workspace {name} gives its area"
            )
        raise InputError(f"{name}: a {machine.title} has no exact sections")
    return machine.sections


def _point(text: str) -> list[float]:
    words = text.split(",")
    if len(words) != 3:
        raise InputError(f"--around needs 3 numbers with commas between them, got {len(words)}")
    return [
        common.number(word, f"--around: {axis}") for word, axis in zip(words, "xyz", strict=True)
    ]


def _where(turned: common.Orientation, modes: tuple[str, ...] | None) -> str:
    return f"{turned.text()}, {tables.modes_text(modes)}"


def _about(
    turned: common.Orientation, design: Design, modes: tuple[str, ...] | None
) -> dict[str, Any]:
    return {
        "design": design.name,
        "mechanism": design.mechanism,
        **turned.entries(),
        "modes": "all" if modes is None else modes,
    }


def _place(point: list[float]) -> str:
    return "({}) mm".format(", ".join(f"{value:.4f}" for value in point))
