"""The mesh side of `bohemia singularity`: loci and aspects of one orientation and mode."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from app.features.workspace.command import build
from app.terminal import tables
from app.terminal.command import Answer, Output
from kinematics.errors import ComputationError, InputError

if TYPE_CHECKING:
    from app.terminal.poses import Given
    from kinematics.facets.solids import Resolution
    from kinematics.machine import Machine
    from kinematics.solids.csg import BuiltSolid

KEY = "aspects"
LOCUS = tables.LOCUS
"""Of a mechanism's solids: the one that this command builds."""
CLOUD = "csv"
"""What the locus may be written as beside the formats of solids: its points."""
SIGNS = {1: "det > 0", -1: "det < 0", 0: ""}


def surfaces(
    machine: Machine[Any],
    pose: Given,
    mode: str,
    resolution: Resolution,
    what: str | None,
    output: Output,
) -> Answer:
    """The pieces of the workspace of a mode, and the singular surface between them."""
    from app.features.review import files
    from kinematics.machine import required

    wanted = (what or LOCUS).strip().lower()
    if wanted != LOCUS and not wanted.isdecimal():
        raise InputError(f"--what must be {LOCUS} or the number of a piece, got {what!r}")
    clouds = (CLOUD,) if wanted == LOCUS else ()
    kind = output.kind((*files.FORMATS, *clouds), "a singular surface" if clouds else "a solid")
    built, turned = build(machine, KEY, pose, (mode,), resolution)
    placement = required(machine.solids, "solids").placement(KEY, turned.pose)
    if kind:
        mesh = built.locus_mesh() if wanted == LOCUS else built.piece_mesh(int(wanted) - 1)
        if not len(mesh.faces):
            raise ComputationError(
                f"there is no singularity inside the workspace of mode {mode} at this "
                f"orientation, so {str(output.path)!r} was not written"
            )
        output.write(files.mesh_bytes(mesh, placement, kind, is_open=wanted == LOCUS))
    pieces = [
        {
            **tables.record(piece, "volume_mm3", "sign", volume_error_mm3="volume_error"),
            "centroid_mm": (placement[:3, :3] @ piece.centroid + placement[:3, 3]).tolist(),
        }
        for piece in built.pieces
    ]
    data = {
        **turned.entries(),
        "mode": mode,
        **tables.mode_entry(machine, mode),
        "resolution": resolution,
        **tables.solid_entry(built),
        "pieces": pieces,
        "locus_area_mm2": _area(built),
        "locus_residual_mm": built.locus_residual,
        "locus_unplaced": built.locus_unplaced,
    }
    where = f"At {turned.text()}" if turned.angles else "All orientations"
    head = f"{where}{tables.mode_text(machine, mode)}, {resolution}"
    return Answer(data, [head, "", *_lines(data)])


def _area(built: BuiltSolid) -> float:
    """mm² of the singular surface, taken once."""
    from kinematics.solids.meshes import face_parts

    mesh = built.locus_mesh()
    return float(face_parts(mesh.vertices, mesh.faces)[1].sum()) / 2.0


def _lines(data: dict[str, Any]) -> list[str]:
    resolution, area, residual = (
        data[key] for key in ("resolution", "locus_area_mm2", "locus_residual_mm")
    )
    triangles = f"{data['triangles']} triangles, {'' if data['watertight'] else 'not '}watertight"
    if not data["pieces"]:
        return ["The workspace of this mode is empty at this orientation.", triangles]
    table = tables.records(
        [{**piece, "number": n} for n, piece in enumerate(data["pieces"], start=1)],
        ("piece", "number"),
        ("volume (mm³)", lambda piece: f"{piece['volume_mm3']:,.0f}"),
        ("±", lambda piece: f"{piece['volume_error_mm3']:,.0f}"),
        ("", lambda piece: SIGNS[piece["sign"]]),
    )
    if area > 0.0 and residual is not None:
        unplaced = f" but for {data['locus_unplaced']}" if data["locus_unplaced"] else ""
        locus = (
            f"singular surface {area:,.0f} mm², its vertices exact to {residual:.1g} mm{unplaced}"
        )
    else:
        finer = "" if resolution == "fine" else "; a finer one may show thin layers"
        locus = f"No singularity inside is found at this resolution{finer}."
    return [
        table,
        "",
        f"together {data['volume_mm3']:,.0f} ± {data['volume_error_mm3']:,.0f} mm³",
        locus,
        f"At {resolution} resolution: pieces thinner than a cell may be missed, and are told by a "
        "finer one.",
        "These are slices of the aspects at one orientation: pieces may be joined through others.",
        triangles,
    ]
