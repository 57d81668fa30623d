"""`bohemia workspace` and `bohemia vertex-space`: solids, and regions where it lies in a plane."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from app.terminal.command import Answer, Output, command, progress
from app.terminal.options import DESIGN, MODES, ORIENTATION, Modes, choice, option, output
from app.terminal.options import resolution as fineness
from kinematics.errors import ComputationError, InputError

if TYPE_CHECKING:
    from app.terminal.poses import Given, Orientation
    from kinematics.answers.sections import Region
    from kinematics.facets.solids import Resolution, SurfaceKind
    from kinematics.machine import Machine
    from kinematics.solids.csg import BuiltSolid

WORKSPACE = "workspace"
SOLIDS = ".stl, .3mf, .ply, .glb or .obj"


@command("workspace")
def workspace(
    machine: Machine[Any] = DESIGN,
    pose: Given = ORIENTATION,
    modes: Modes = MODES,
    surface: SurfaceKind = choice(
        "right on the average, or every vertex on the exact surfaces, more triangles, not for a "
        "preview",
        *("facets", "true"),
        default="facets",
    ),
    regions: str = option(
        "KEY",
        "of a plane workspace: workspace, or modes or aspects where the mechanism has them; -o "
        "then writes .svg, .dxf or .csv",
        known=lambda machine: (spec.key for spec in machine.region_specs),
        default=WORKSPACE,
    ),
    resolution: Resolution = fineness(),
    output: Output = output(SOLIDS),
) -> Answer:
    """The constant-orientation workspace, as a solid or a plane region.

    Where the constraint of a mechanism leaves a plane at a constant orientation, the workspace is a
    plane region of exact arcs, written as .svg, .dxf or .csv; with - for one of its angles, as
    --gamma -, it is a solid. A solid that is of one mode only is of the home mode unless --modes
    names another.
    """
    specs = machine.solid_specs
    turned = pose.orientation()
    if turned.open is not None:
        key = next((spec.key for spec in specs if spec.follows == turned.open), WORKSPACE)
    elif machine.region_specs and all(spec.key != WORKSPACE for spec in specs):
        return _regions(machine, turned, modes, regions, output)
    else:
        key = WORKSPACE
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
    resolution: Resolution = fineness(),
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


# --- solids --------------------------------------------------------------------------------


def build(
    machine: Machine[Any],
    key: str,
    pose: Given,
    modes: Modes,
    resolution: Resolution,
    surface: SurfaceKind = "facets",
) -> tuple[BuiltSolid, Orientation]:
    """A solid of the machine, and the angles that it depends on."""
    from kinematics.facets.solids import build_solid
    from kinematics.machine import required

    solids = required(machine.solids, "solids")
    title = next(spec.title for spec in solids.specs if spec.key == key)

    def asked(pose: Sequence[float]) -> tuple[Any, bytes]:
        request = solids.request(key, pose, modes, resolution, surface)
        return request, solids.placement(key, pose).tobytes()

    turned = pose.orientation(asked, title.lower())
    with progress(f"{title}, {resolution}"):
        return build_solid(asked(turned.pose)[0]), turned


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
    from kinematics.machine import required

    spec = next((spec for spec in machine.solid_specs if spec.key == key), None)
    if spec is None:
        raise InputError(f"{machine.design.name}: a {machine.title} has no {key} solid")
    kind = output.kind(files.FORMATS, "a solid")
    if surface not in spec.surfaces:
        raise InputError(f"--surface: {spec.title} is built as {' or '.join(spec.surfaces)} only")
    if spec.of_present_mode and modes is None:
        modes = (machine.home.mode,)
    built, turned = build(machine, key, pose, modes, resolution, surface)
    if kind and built.triangles == 0:
        raise ComputationError(f"{spec.title} is empty, so {str(output.path)!r} was not written")
    if kind:
        placement = required(machine.solids, "solids").placement(key, turned.pose)
        output.write(files.solid_bytes(built, placement, kind), "mm, base coordinates")
    moded = bool(machine.mode_noun) and (spec.uses_modes or spec.of_present_mode)
    data = {
        "solid": key,
        **turned.entries(),
        **(tables.modes_entry(modes) if moded else {}),
        "resolution": resolution,
        **tables.solid_entry(built),
        "surface": "facets" if built.residual is None else "true",
        "surface_residual_mm": built.residual,
        "surface_unplaced": built.unplaced,
    }
    where = f" at {turned.text()}" if turned.angles else ""
    told = f", {tables.modes_text(modes, machine.mode_noun)}" if moded else ""
    volume, error = map(tables.volume_text, (built.volume, built.volume_error))
    lines = [
        f"{spec.title}{where}, {resolution}{told}",
        f"volume     {volume} ± {error}",
        f"pieces     {tables.pieces_text(data['piece_volumes_mm3'])}",
        f"triangles  {built.triangles}{'' if built.watertight else ', not watertight'}",
        f"surface    {tables.surface_text(built)}",
    ]
    return Answer(data, lines)


# --- regions of a plane --------------------------------------------------------------------


def _regions(
    machine: Machine[Any],
    turned: Orientation,
    modes: Modes,
    key: str,
    output: Output,
) -> Answer:
    """The regions of a workspace that lies in a plane, written if a file is wanted."""
    from app.features.section.files import FORMATS, section_bytes, section_loops
    from kinematics.answers.sections import together
    from kinematics.machine import required

    specs = {spec.key: spec for spec in machine.region_specs}
    spec = specs[values.one_of("--regions", key, specs)]
    kind = output.kind(FORMATS, "a plane workspace")
    plane = required(machine.regions, "plane workspace")
    with progress(spec.title):
        found = plane.of(spec.key, turned.pose, modes)
    entries = [{**_region(region), "loops": section_loops(region.section)} for region in found]
    loops = [loop for entry in entries for loop in entry["loops"]]
    where = ", ".join(filter(None, (spec.title, turned.text())))
    if kind and not loops:
        raise ComputationError(f"the workspace is empty, so {str(output.path)!r} was not written")
    if kind:
        title = ", ".join(
            filter(None, (machine.design.title or machine.design.name, turned.text()))
        )
        of = spec.plane
        all_of_them = together([region.section for region in found])
        output.write(section_bytes(all_of_them, of, kind, title=title), "mm")
    sums = ("area_mm2", "area_error_mm2", "perimeter_mm", "pieces")
    data = {
        "region": spec.key,
        **turned.entries(),
        **tables.modes_entry(modes),
        **{name: sum(entry[name] for entry in entries) for name in sums},
        "volume_mm3": 0.0,
        "triangles": 0,
        "watertight": False,
        "axes": list(spec.axes),
        "transform": plane.frame(turned.pose).tolist(),
        "loops": loops,
        "regions": entries,
    }
    grouped = any(entry["group"] for entry in entries)
    table = tables.records(
        entries,
        ("region", "title"),
        ("area", _area),
        ("perimeter", lambda entry: f"{entry['perimeter_mm']:.3f} mm"),
        ("pieces", "pieces"),
        ("edges", "edges"),
        *([("group", lambda entry: str(entry["group"] or ""))] if grouped else []),
    )
    told = ["Regions of one group join through serial singularities."] if grouped else []
    return Answer(data, [where, "", table, *told])


def _region(region: Region) -> dict[str, Any]:
    section = region.section
    sizes = ("area_mm2", "area_error_mm2", "perimeter_mm", "pieces", "centroid_mm")
    return {
        **tables.record(region, "title", "sign", "inside_mm", "inside", deviation_mm="deviation"),
        "working_mode": region.mode or None,
        "group": region.group or None,
        **tables.record(section, *sizes, "centroid"),
        "holes": section.loops - section.pieces,
        "edges": len(section.start),
    }


def _area(entry: dict[str, Any]) -> str:
    """In cm², with its error if that shows in the digits."""
    error = entry["area_error_mm2"] / 100
    return f"{entry['area_mm2'] / 100:.6f}{f' ± {error:.1g}' if error > 5e-7 else ''} cm²"
