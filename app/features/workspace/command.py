"""`bohemia workspace` and `bohemia vertex-space`: solids, and regions where it lies in a plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from app.terminal.command import Answer, Output, command, progress
from app.terminal.options import (
    DESIGN,
    MODES,
    ORIENTATION,
    RESOLUTION,
    Modes,
    choice,
    option,
    output,
)
from kinematics.errors import ComputationError, InputError

if TYPE_CHECKING:
    from app.terminal.poses import Angles, Given
    from kinematics.answers.coordinates import Pose
    from kinematics.answers.sections import Region
    from kinematics.facets.solids import Resolution, SurfaceKind
    from kinematics.machine import Machine

WORKSPACE = "workspace"
SOLIDS = ".stl, .3mf, .ply, .glb or .obj"
_SMALLER = "Pieces smaller than the error of the volume may be missed."
SIZES = ("area_mm2", "area_error_mm2", "perimeter_mm", "pieces")


@command("workspace")
def workspace(
    machine: Machine[Any] = DESIGN,
    pose: Given = ORIENTATION,
    modes: Modes = MODES,
    surface: SurfaceKind = choice(
        "right on the average, or every vertex on the exact surfaces, not for a preview",
        *("facets", "true"),
        default="facets",
    ),
    regions: str = option(
        "KEY",
        "of a plane workspace: workspace, or modes or aspects where the mechanism has them",
        known=lambda machine: (spec.key for spec in machine.region_specs),
        default=WORKSPACE,
    ),
    resolution: Resolution = RESOLUTION,
    output: Output = output(f"{SOLIDS}; of a plane workspace .svg, .dxf or .csv"),
) -> Answer:
    """The constant-orientation workspace, as a solid or a plane region.

    Where the constraint of a mechanism leaves a plane at a constant orientation, the workspace is a
    plane region of exact arcs; with - for one of its angles, as --gamma -, it is a solid. A solid
    that is of one mode only is of the home mode unless --modes names another.
    """
    angles, specs = pose.angles(), machine.solid_specs
    keys = [spec.key for spec in specs if spec.follows == angles.follows and spec.limb is None]
    if angles.follows is None and machine.region_specs and WORKSPACE not in keys:
        return _regions(machine, angles, modes, regions, output)
    key = keys[0] if angles.follows is not None and keys else WORKSPACE
    return _solid(machine, key, pose, modes, resolution, output, surface)


@command("vertex-space")
def vertex_space(
    machine: Machine[Any] = DESIGN,
    limb: str = option(
        "i",
        "the limb, from 1",
        lambda option, text, machine: values.one_of(option, text, _limbs(machine)),
        known=lambda machine: _limbs(machine),
        required=True,
    ),
    part: str = option(
        "PART",
        "whole, plus, minus, body, H1, H2 or H3",
        known=lambda machine: _limbs(machine)["1"],
        default="whole",
    ),
    pose: Given = ORIENTATION,
    resolution: Resolution = RESOLUTION,
    output: Output = output(SOLIDS),
) -> Answer:
    """One limb's vertex space or a part of it."""
    part = values.one_of("--part", part, _limbs(machine)[limb])
    return _solid(machine, f"limb{limb}/{part}", pose, None, resolution, output)


def _limbs(machine: Machine[Any]) -> dict[str, list[str]]:
    """The limbs that have vertex spaces, and their parts."""
    limbs: dict[str, list[str]] = {}
    for spec in machine.solid_specs:
        if spec.limb is not None:
            limbs.setdefault(str(spec.limb), []).append(spec.key.partition("/")[2])
    if not limbs:
        raise InputError(f"{machine.design.name}: a {machine.title} has no vertex spaces")
    return limbs


def _solid(
    machine: Machine[Any],
    key: str,
    pose: Given,
    modes: Modes,
    resolution: Resolution,
    output: Output,
    surface: SurfaceKind = "facets",
) -> Answer:
    """Build one solid, and write it if a file is wanted."""
    from app.features.review import files

    spec = next((spec for spec in machine.solid_specs if spec.key == key), None)
    if spec is None:
        raise InputError(f"{machine.design.name}: a {machine.title} has no {key} solid")
    kind = output.kind(files.FORMATS, "a solid")
    if surface not in spec.surfaces:
        raise InputError(f"--surface: {spec.title} is built as {' or '.join(spec.surfaces)} only")
    if spec.of_present_mode and modes is None:
        modes = (machine.home.mode,)
    angles = pose.angles(key)
    with progress(f"{spec.title}, {resolution}"):
        shown = angles.space(modes).solid(resolution, key=key, surface=surface)
    built = shown.built
    if kind and built.triangles == 0:
        raise ComputationError(f"{spec.title} is empty, so {str(output.path)!r} was not written")
    if kind:
        written = files.solid_bytes(built, shown.placement, kind, output.unit)
        output.write(written, f"{output.unit_of(kind)}, base coordinates")
    moded = bool(machine.mode_noun) and (spec.uses_modes or spec.of_present_mode)
    data = {
        "solid": key,
        **angles.entries(),
        **(tables.modes_entry(modes) if moded else {}),
        "resolution": resolution,
        **shown.to_dict(),
        "surface": "facets" if built.residual is None else "true",
        "surface_residual_mm": built.residual,
        "surface_unplaced": built.unplaced,
    }
    where = f" at {angles.text()}" if angles.held else ""
    told = f", {tables.modes_text(modes, machine.mode_noun)}" if moded else ""
    volume, error = map(tables.volume_text, (built.volume, built.volume_error))
    lines = [
        f"{spec.title}{where}, {resolution}{told}",
        *([f"branch     that of {_pose(shown.branch)}"] if shown.branch is not None else []),
        f"volume     {volume} ± {error}",
        f"pieces     {tables.pieces_text(data['piece_volumes_mm3'])}",
        f"triangles  {built.triangles}{'' if built.watertight else ', not watertight'}",
        f"surface    {tables.surface_text(built)}",
        *([_SMALLER] if built.volume_error > 0.0 else []),
        *([built.note] if built.note else []),
    ]
    return Answer(data, lines)


def _pose(pose: Pose) -> str:
    return tables.with_units([*pose.degrees.values()], pose.axes)


def _regions(
    machine: Machine[Any], angles: Angles, modes: Modes, key: str, output: Output
) -> Answer:
    """The regions of a workspace that lies in a plane, written if a file is wanted."""
    from app.features.section.files import FORMATS, section_bytes, section_loops
    from kinematics.answers.sections import together
    from kinematics.facets.facet import required

    specs = {spec.key: spec for spec in machine.region_specs}
    spec = specs[values.one_of("--regions", key, specs)]
    kind, space = output.kind(FORMATS, "a plane workspace"), angles.space(modes)
    with progress(spec.title):
        found = space.regions(spec.key)
    entries = [{**_region(region), "loops": section_loops(region.section)} for region in found]
    loops = [loop for entry in entries for loop in entry["loops"]]
    if kind and not loops:
        raise ComputationError(f"the workspace is empty, so {str(output.path)!r} was not written")
    if kind:
        title = ", ".join(
            filter(None, (machine.design.title or machine.design.name, angles.text()))
        )
        whole = together([region.section for region in found])
        written = section_bytes(whole, spec.plane, kind, title=title, parts=found, unit=output.unit)
        output.write(written, output.unit_of(kind))
    frame = required(machine.regions, "plane workspace").frame(space.pose)
    data = {
        "region": spec.key,
        **angles.entries(),
        **tables.modes_entry(modes),
        **{name: sum(entry[name] for entry in entries) for name in SIZES},
        "volume_mm3": 0.0,
        "triangles": 0,
        "watertight": False,
        "axes": list(spec.axes),
        "transform": frame.tolist(),
        "loops": loops,
        "regions": entries,
    }
    grouped = any(entry["group"] for entry in entries)
    table = tables.records(
        [{**entry, "area": _area(entry)} for entry in entries],
        ("region", "title"),
        ("area", "area"),
        ("perimeter", "perimeter_mm", "{:.3f} mm".format),
        ("pieces", "pieces"),
        ("edges", "edges"),
        *([("group", "group", "")] if grouped else []),
    )
    told = ["Regions of one group join through serial singularities."] if grouped else []
    where = ", ".join(filter(None, (spec.title, angles.text())))
    return Answer(data, [where, "", table, *told])


def _region(region: Region) -> dict[str, Any]:
    section = region.section
    return {
        **tables.record(region, "title", "sign", "inside_mm", "inside", deviation_mm="deviation"),
        "working_mode": region.mode or None,
        "group": region.group or None,
        **tables.record(section, *SIZES, "centroid_mm", "centroid"),
        "holes": section.loops - section.pieces,
        "edges": len(section.start),
    }


def _area(entry: dict[str, Any]) -> str:
    """In cm², with its error if that shows in the digits."""
    error = entry["area_error_mm2"] / 100
    return f"{entry['area_mm2'] / 100:.6f}{f' ± {error:.1g}' if error > 5e-7 else ''} cm²"
