"""The mesh side of `bohemia singularity`: loci and aspects of one orientation and mode."""

from __future__ import annotations

import argparse
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

from app.terminal import common, tables
from kinematics.errors import ComputationError, InputError

if TYPE_CHECKING:
    from kinematics.facets.solids import Resolution
    from kinematics.solids.csg import BuiltSolid

KEY = "aspects"
LOCUS = tables.LOCUS
"""Of a mechanism's solids: the one that this command builds."""
CLOUD = "csv"
"""What the locus may be written as beside the formats of solids: its points."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    for name in ("phi", "theta"):
        parser.add_argument(
            f"--{name}",
            type=common.angle,
            metavar="DEG",
            help="without --pose: degrees (default 0)",
        )
    parser.add_argument(
        "--resolution",
        choices=("preview", "normal", "fine"),
        help="without --pose: how fine the meshes are (default normal)",
    )
    parser.add_argument(
        "--what",
        metavar="WHAT",
        help=f"without --pose: what -o writes, {LOCUS} or the number of a piece (default {LOCUS})",
    )


def foreign(arguments: argparse.Namespace) -> str | None:
    """An option that goes with the meshes only and was given."""
    for name in ("phi", "theta", "resolution", "what"):
        if getattr(arguments, name) is not None:
            return f"--{name}"
    return None


def run(arguments: argparse.Namespace) -> None:
    """The pieces of the workspace of a mode, and the singular surface between them."""
    machine = common.load(arguments.design)
    design = machine.design
    mode = common.chosen_mode(arguments.mode, machine)
    spec = next((s for s in machine.solid_specs if s.key == KEY), None)
    if spec is None:
        raise InputError(
            f"{design.name}: a {machine.title} has no singular surfaces at an orientation; "
            "give --pose, or --pose and --chart"
        )
    resolution: Resolution = arguments.resolution or "normal"
    what = (arguments.what or LOCUS).strip().lower()
    if what != LOCUS and not what.isdecimal():
        raise InputError(f"--what must be {LOCUS} or the number of a piece, got {arguments.what!r}")
    path: Path | None = arguments.output
    kind = None if path is None else _kind(path, what)
    typed = {name: getattr(arguments, name) or 0.0 for name in ("phi", "theta")}
    axes = machine.coordinates
    pose = [radians(typed.get(axis.key, 0.0)) for axis in axes]
    turned_by = [axis for axis in axes if axis.key in typed]
    from kinematics.facets.solids import build_solid
    from kinematics.machine import required

    solids = required(machine.solids, "solids")
    request = solids.request(KEY, pose, (mode,), resolution)
    with common.progress(f"{spec.title}, {resolution}"):
        built = build_solid(request)
    common.warn(machine)
    placement = solids.placement(KEY, pose)
    if path is not None and kind is not None:
        from app.features.review import files

        if what == LOCUS:
            mesh = built.locus_mesh()
            if not len(mesh.faces):
                raise ComputationError(
                    f"there is no singularity inside the workspace of mode {mode} at this "
                    f"orientation, so {str(path)!r} was not written"
                )
        else:
            mesh = built.piece_mesh(int(what) - 1)
        data = files.mesh_bytes(mesh, placement, kind, is_open=what == LOCUS)
        common.write(path, data)
    area = _area(built)
    file = None if path is None else str(path)
    if not arguments.json:
        where = ", ".join(f"{c.symbol} = {typed[c.key]:g}°" for c in turned_by)
        common.print_head(
            design,
            f"{f'At {where}' if where else 'All orientations'}"
            f"{common.mode_text(machine, mode)}, {resolution}",
        )
        print(_text(built, area, file, resolution))
        return
    turned = placement[:3, :3], placement[:3, 3]
    common.print_json(
        {
            "design": design.name,
            "mechanism": design.mechanism,
            **{tables.key(axis): typed[axis.key] for axis in turned_by},
            "mode": mode,
            **common.mode_entry(machine, mode),
            "resolution": resolution,
            "pieces": [
                {
                    "volume_mm3": piece.volume,
                    "volume_error_mm3": piece.volume_error,
                    "sign": piece.sign,
                    "centroid_mm": (turned[0] @ piece.centroid + turned[1]).tolist(),
                }
                for piece in built.pieces
            ],
            "volume_mm3": built.volume,
            "volume_error_mm3": built.volume_error,
            "locus_area_mm2": area,
            "locus_residual_mm": built.locus_residual,
            "locus_unplaced": built.locus_unplaced,
            "triangles": built.triangles,
            "watertight": built.watertight,
            "file": file,
        }
    )


def _kind(path: Path, what: str) -> str:
    from app.features.review import files

    if what == LOCUS:
        return common.ending(path, (*files.FORMATS, CLOUD), "a singular surface")
    return common.checked(path, files.format_of(path))


def _area(built: BuiltSolid) -> float:
    """mm² of the singular surface, taken once."""
    from kinematics.solids.meshes import face_parts

    mesh = built.locus_mesh()
    return float(face_parts(mesh.vertices, mesh.faces)[1].sum()) / 2.0


def _text(built: BuiltSolid, area: float, file: str | None, resolution: Resolution) -> str:
    lines = [""]
    if not built.pieces:
        lines.append("The workspace of this mode is empty at this orientation.")
    else:
        signs = {1: "det > 0", -1: "det < 0", 0: ""}
        rows = [
            (str(n + 1), f"{piece.volume:,.0f}", f"{piece.volume_error:,.0f}", signs[piece.sign])
            for n, piece in enumerate(built.pieces)
        ]
        lines += [
            tables.table(("piece", "volume (mm³)", "±", ""), rows),
            "",
            f"together {built.volume:,.0f} ± {built.volume_error:,.0f} mm³",
        ]
        if area > 0.0 and built.locus_residual is not None:
            lines.append(
                f"singular surface {area:,.0f} mm², its vertices exact to "
                f"{built.locus_residual:.1g} mm"
                + (f" but for {built.locus_unplaced}" if built.locus_unplaced else "")
            )
        else:
            finer = "" if resolution == "fine" else "; a finer one may show thin layers"
            lines.append(f"No singularity inside is found at this resolution{finer}.")
        lines.append(
            f"At {resolution} resolution: pieces thinner than a cell may be missed, and are told "
            "by a finer one."
        )
        lines.append(
            "These are slices of the aspects at one orientation: pieces may be joined through "
            "others."
        )
    lines += [f"{built.triangles} triangles, {'' if built.watertight else 'not '}watertight"]
    if file is not None:
        lines.append(f"file  {file}")
    return "\n".join(lines)
