"""`bohemia workspace` and `bohemia vertex-space`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.features.workspace import regions_command
from app.terminal import common, tables
from kinematics.errors import ComputationError, InputError

if TYPE_CHECKING:
    from kinematics.facets.solids import SurfaceKind
    from kinematics.machine import Machine

WORKSPACE = "workspace"


def register(command: common.AddCommand) -> None:
    workspace = command(
        "workspace", _workspace, "The constant-orientation workspace, as a solid or a plane region."
    )
    common.add_design(workspace)
    common.add_orientation(workspace, follows=True)
    common.add_modes(workspace)
    workspace.epilog = (
        "Where the constraint of a mechanism leaves a plane at a constant orientation, the "
        "workspace is a plane region of exact arcs, written as .svg, .dxf or .csv; with - for one "
        "of its angles it is a solid."
    )
    workspace.add_argument(
        "--surface",
        choices=("facets", "true"),
        default="facets",
        help="facets, right on the average, or true: every vertex on the exact surfaces, more "
        "triangles, not for a preview (default %(default)s)",
    )
    workspace.add_argument(
        "--regions",
        default="workspace",
        metavar="KEY",
        help="of a plane workspace: workspace, or modes or aspects where the mechanism has them; "
        "-o then writes .svg, .dxf or .csv (default %(default)s)",
    )
    _add_solid(workspace)

    vertex_space = command(
        "vertex-space", _vertex_space, "One limb's vertex space or a part of it."
    )
    common.add_design(vertex_space)
    vertex_space.add_argument("--limb", required=True, metavar="i", help="the limb, from 1")
    vertex_space.add_argument(
        "--part",
        default="whole",
        metavar="PART",
        help="whole, plus, minus, body, H1, H2 or H3 (default %(default)s)",
    )
    common.add_orientation(vertex_space)
    _add_solid(vertex_space)


def _add_solid(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--resolution",
        choices=("preview", "normal", "fine"),
        default="normal",
        help="how fine the mesh is; the volume's error is printed (default %(default)s)",
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="write .stl, .3mf, .ply, .glb or .obj"
    )
    common.add_json(parser)


def _workspace(arguments: argparse.Namespace) -> None:
    machine = common.load(arguments.design)
    modes = common.chosen_modes(arguments.modes, machine.modes)
    turned = common.orientation(arguments, machine)
    key = WORKSPACE
    if turned.open is not None:
        specs = machine.solid_specs
        key = next((spec.key for spec in specs if spec.follows == turned.open), WORKSPACE)
    elif regions_command.offered(machine):
        regions_command.workspace(arguments, machine, turned, modes)
        return
    _solid(arguments, machine, key, turned, modes, arguments.surface)


def _vertex_space(arguments: argparse.Namespace) -> None:
    machine = common.load(arguments.design)
    design = machine.design
    limbs: dict[str, dict[str, str]] = {}
    for spec in machine.solid_specs:
        if spec.limb is not None:
            part = spec.key.partition("/")[2]
            limbs.setdefault(str(spec.limb), {})[part.lower()] = spec.key
    if not limbs:
        raise InputError(f"{design.name}: a {machine.title} has no vertex spaces")
    parts = limbs.get(arguments.limb.strip())
    if parts is None:
        raise InputError(f"--limb must be one of {', '.join(limbs)}, got {arguments.limb!r}")
    key = parts.get(arguments.part.strip().lower())
    if key is None:
        known = ", ".join(key.partition("/")[2] for key in parts.values())
        raise InputError(f"--part must be one of {known}, got {arguments.part!r}")
    turned = common.orientation(arguments, machine)
    _solid(arguments, machine, key, turned, None)


def _solid(
    arguments: argparse.Namespace,
    machine: Machine[Any],
    key: str,
    turned: common.Orientation,
    modes: tuple[str, ...] | None,
    surface: SurfaceKind = "facets",
) -> None:
    """Build one solid, write it if a file is wanted, and print what it is."""
    from app.features.review import files

    spec = next((spec for spec in machine.solid_specs if spec.key == key), None)
    if spec is None:
        raise InputError(f"{machine.design.name}: a {machine.title} has no {key} solid")
    path: Path | None = arguments.output
    kind = None if path is None else common.checked(path, files.format_of(path))
    pose = turned.pose
    if surface not in spec.surfaces:
        raise InputError(f"--surface: {spec.title} is built as {' or '.join(spec.surfaces)} only")
    from kinematics.facets.solids import build_solid
    from kinematics.machine import required

    request = required(machine.solids, "solids").request(
        key, pose, modes, arguments.resolution, surface
    )
    with common.progress(f"{spec.title}, {arguments.resolution}"):
        built = build_solid(request)
    common.warn(machine)
    if path is not None and kind is not None:
        if built.triangles == 0:
            raise ComputationError(f"{spec.title} is empty, so {str(path)!r} was not written")
        data = files.solid_bytes(
            built, required(machine.solids, "solids").placement(key, pose), kind
        )
        common.write(path, data)
    if not arguments.json:
        common.print_head(machine.design)
        where = f"at {turned.text()}, {arguments.resolution}"
        file = None if path is None else str(path)
        print(tables.solid_text(built, spec.title, where, modes if spec.uses_modes else (), file))
        return
    common.print_json(
        {
            "design": machine.design.name,
            "mechanism": machine.design.mechanism,
            "solid": key,
            **turned.entries(),
            **({"modes": "all" if modes is None else modes} if spec.uses_modes else {}),
            "resolution": arguments.resolution,
            "volume_mm3": built.volume,
            "volume_error_mm3": built.volume_error,
            "pieces": len(built.pieces),
            "piece_volumes_mm3": [piece.volume for piece in built.pieces],
            "triangles": built.triangles,
            "watertight": built.watertight,
            "surface": "facets" if built.residual is None else "true",
            "surface_residual_mm": built.residual,
            "surface_unplaced": built.unplaced,
            "file": None if path is None else str(path),
        }
    )
