"""`bohemia workspace` of a mechanism whose workspace lies in a plane: regions, areas, outlines."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.terminal import common
from kinematics.errors import ComputationError, InputError

if TYPE_CHECKING:
    from kinematics.answers.sections import Region, RegionSpec, Section
    from kinematics.machine import Machine


def workspace(
    arguments: argparse.Namespace,
    machine: Machine[Any],
    turned: common.Orientation,
    modes: tuple[str, ...] | None,
) -> None:
    """Print the regions of a plane workspace, and write them if a file is wanted."""
    from app.features.section.files import FORMATS, section_bytes, section_loops
    from kinematics.answers.sections import SectionSpec, together

    specs = {spec.key: spec for spec in machine.region_specs}
    spec = specs.get(arguments.regions)
    if spec is None:
        raise InputError(f"--regions must be one of {', '.join(specs)}, got {arguments.regions!r}")
    path: Path | None = arguments.output
    kind = None if path is None else common.ending(path, FORMATS, "a plane workspace")
    from kinematics.machine import required

    with common.progress(spec.title):
        found = required(machine.regions, "plane workspace").of(spec.key, turned.pose, modes)
    common.warn(machine)
    if path is not None and kind is not None:
        if not any(region.section.loops for region in found):
            raise ComputationError(f"the workspace is empty, so {str(path)!r} was not written")
        plane = SectionSpec(spec.title, "normal", spec.axes, spec.figure)
        sections = [region.section for region in found]
        title = ", ".join(
            filter(None, (machine.design.title or machine.design.name, turned.text()))
        )
        common.write(path, section_bytes(together(sections), plane, kind, title=title))
    if not arguments.json:
        common.print_head(machine.design, ", ".join(filter(None, (spec.title, turned.text()))))
        print("\n".join(_lines(found, path)))
        return
    common.print_json(
        {
            "design": machine.design.name,
            "mechanism": machine.design.mechanism,
            "region": spec.key,
            **turned.entries(),
            "modes": "all" if modes is None else modes,
            "area_mm2": sum(region.section.area for region in found),
            "area_error_mm2": sum(region.section.area_error for region in found),
            "perimeter_mm": sum(region.section.perimeter for region in found),
            "pieces": sum(region.section.pieces for region in found),
            "volume_mm3": 0.0,
            "triangles": 0,
            "watertight": False,
            "axes": list(spec.axes),
            "transform": required(machine.regions, "plane workspace").frame(turned.pose).tolist(),
            "loops": [loop for region in found for loop in section_loops(region.section)],
            "regions": [
                {**_entry(region), "loops": section_loops(region.section)} for region in found
            ],
            "file": None if path is None else str(path),
        }
    )


def _entry(region: Region) -> dict[str, Any]:
    section = region.section
    return {
        "title": region.title,
        "working_mode": region.mode or None,
        "sign": region.sign,
        "group": region.group or None,
        "area_mm2": section.area,
        "area_error_mm2": section.area_error,
        "perimeter_mm": section.perimeter,
        "pieces": section.pieces,
        "holes": section.loops - section.pieces,
        "centroid": [common.finite(v) for v in section.centroid.tolist()],
        "inside": [common.finite(v) for v in region.inside.tolist()],
        "deviation_mm": region.deviation,
    }


def _area(section: Section) -> str:
    """In cm², with its error if that shows in the digits."""
    error = section.area_error / 100
    shown = f" ± {error:.1g}" if error > 5e-7 else ""
    return f"{section.area / 100:.6f}{shown} cm²"


def _lines(found: Sequence[Region], path: Path | None) -> list[str]:
    from app.terminal import tables

    rows: list[tuple[str, ...]] = []
    for region in found:
        section = region.section
        rows.append(
            (
                region.title,
                _area(section),
                f"{section.perimeter:.3f} mm",
                f"{section.pieces}",
                f"{len(section.start)}",
                f"{region.group}" if region.group else "",
            )
        )
    header = ["region", "area", "perimeter", "pieces", "edges", "group"]
    if not any(region.group for region in found):
        header, rows = header[:-1], [row[:-1] for row in rows]
    lines = ["", tables.table(header, rows)]
    if any(region.group for region in found):
        lines.append("Regions of one group join through serial singularities.")
    if path is not None:
        lines.append(f"file       {path} (mm)")
    return lines


def offered(machine: Machine[Any]) -> tuple[RegionSpec, ...]:
    """The regions that a mechanism has instead of a solid workspace; () where it has a solid."""
    if any(spec.key == "workspace" for spec in machine.solid_specs):
        return ()
    return machine.region_specs
