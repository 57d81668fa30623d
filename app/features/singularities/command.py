"""`bohemia singularity`: where control is lost, why, and how far that is."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from app.terminal.command import Answer, Output, command, progress
from app.terminal.options import DESIGN, MODE, option, output
from app.terminal.options import pose as posed
from app.terminal.options import resolution as fineness
from kinematics.errors import ComputationError, InputError

if TYPE_CHECKING:
    from app.terminal.poses import Given, Place
    from kinematics.answers.clearances import Remedy
    from kinematics.answers.singularities import Singularity
    from kinematics.facets.solids import Resolution
    from kinematics.machine import Machine

ASPECTS = "aspects"
"""Of a mechanism's solids: the one that its singular surface parts."""
CLEARANCE = (
    *("kind", "distance_mm", "error_mm", "angle_deg", "point_mm", "limb", "bound", "text"),
)


def _charts(machine: Machine[Any]) -> list[str]:
    if not machine.singularities.loci:
        raise InputError(f"{machine.design.name}: a {machine.title} has no charts of loci")
    return [spec.key for spec in machine.singularities.loci]


@command("singularity")
def singularity(
    machine: Machine[Any] = DESIGN,
    pose: Given = posed(),
    mode: str = MODE,
    tolerance: float | None = option(
        "S",
        "name singularities whose measure is below this, 0 to 1; larger than the default names "
        "near ones",
        values.number,
    ),
    chart: str | None = option(
        "KEY", "the loci in this chart of the mechanism, as curves", known=_charts
    ),
    at: float | None = option("A", "where a section chart's plane stands, mm", values.number),
    resolution: Resolution | None = fineness("without a position: ", None),
    what: str | None = option(
        "WHAT",
        f"without a position: what -o writes, {tables.LOCUS} or the number of a piece (default "
        f"{tables.LOCUS})",
        known=lambda machine: [tables.LOCUS],
    ),
    output: Output = output(
        "the chart as .csv or .svg; without a position the singular surface or a piece as .stl, "
        ".3mf, .ply, .glb or .obj, the surface's points as .csv"
    ),
) -> Answer:
    """Where control is lost: at a pose, as curves, or as surfaces in the workspace.

    Without a position: the workspace of the mode at an orientation, parted by its singular surface
    into pieces on which control is kept; where the workspace lies in a plane, the singular curves
    in it.
    """
    somewhere = pose.whole or pose.positioned
    if not somewhere and any(spec.key == ASPECTS for spec in machine.solid_specs):
        values.without("goes with --pose", chart=chart, at=at, tolerance=tolerance)
        return _surfaces(machine, pose, mode, resolution or "normal", what, output)
    all_together = "is for all positions together; leave it or --pose out"
    values.without(all_together, resolution=resolution, what=what)
    if chart is None and somewhere:
        values.without("goes with --chart", at=at, o=output.path)
        return _at_pose(pose.place(mode), tolerance)
    values.without("is about one pose; leave it out with --chart", tolerance=tolerance)
    return _chart(pose, mode, chart, at, output)


def _at_pose(place: Place, tolerance: float | None) -> Answer:
    from kinematics.answers.singularities import AT, NEAR

    if tolerance is not None and not 0.0 < tolerance <= 1.0:
        raise InputError(f"--tolerance must lie between 0 and 1, got {tolerance:g}")
    machine, posture, mode = place.machine, place.posture, place.mode
    lost = machine.singularities.at(posture, tolerance or AT) if posture.closes else ()
    near = machine.singularities.at(posture, NEAR) if posture.closes and not lost else ()
    with progress("Clearances"):
        clearances = machine.clearances.of(posture)
    remedy = None
    if not posture.reachable:
        with progress("The nearest posture"):
            remedy = machine.clearances.nearest_pose(posture)
    data: dict[str, Any] = {
        **place.entries,
        "within_stroke": posture.reachable,
        "reasons": [reason.text for reason in posture.reasons],
        "tolerance": tolerance or AT,
        "singular": any(each.measure < AT for each in lost) if posture.closes else None,
        "kinds": list(dict.fromkeys(each.kind for each in lost)),
        "singularities": [
            {
                **tables.record(each, "kind", "limbs", "cause", "text", "measure"),
                "motion": each.motion and tables.named(each.motion, machine.coordinates),
                "twist": each.twist and _twist(each.twist),
            }
            for each in lost
        ],
        "conditioning": _conditioning(place),
        "measures": [
            {
                **tables.record(each, "key", "title", "unit"),
                "value": tables.plain(float(machine.measures(place.pose, mode, each.key))),
            }
            for each in machine.measures.specs
            if not each.needs_load
        ],
        "clearances": [tables.record(each, *CLEARANCE) for each in clearances],
        "remedy": None if remedy is None else _remedy(remedy, place),
    }
    return Answer(data, [place.where, *_lost_lines(data, near)])


def _twist(twist: Sequence[float]) -> dict[str, list[float]]:
    move = list(twist[3:])
    return {"omega_deg": [degrees(value) for value in twist[:3]], "v_mm": move, "v": move}


def _conditioning(place: Place) -> dict[str, float | None]:
    from kinematics.screws.wrenches import singular_values

    length = place.machine.length
    system = place.machine.statics.wrenches(place.pose, place.mode)
    held = singular_values(system.rows, length).tolist()
    return {
        "smallest_singular_value": tables.finite(held[-1]),
        "condition": tables.finite(held[0] / held[-1]) if held[-1] else None,
        "determinant": tables.finite(float(system.determinant)),
        "characteristic_length_mm": length,
    }


def _remedy(remedy: Remedy, place: Place) -> dict[str, Any]:
    machine, nearest = place.machine, remedy.nearest
    units = {field.path: field.unit for field in machine.fields}
    return {
        **tables.record(remedy, "distance_mm", "error_mm", "modes", "text"),
        "nearest": nearest
        and {
            "pose": tables.named(nearest.pose, machine.coordinates),
            **tables.mode_entry(machine, nearest.mode),
            "joints": tables.listed(nearest.joints, machine.joints),
        },
        "changes": [
            [
                {
                    **tables.record(change, "path", "label", "before", "after", "text"),
                    "unit": units.get(tuple(change.path), ""),
                }
                for change in way
            ]
            for way in remedy.changes
        ],
    }


def _lost_lines(data: dict[str, Any], near: Sequence[Singularity]) -> list[str]:
    """What the answer says; ``near``: singularities of which none is one yet."""
    lines = [""]
    if not data["within_stroke"]:
        lines += ["Not reachable:", *(f"  {text}" for text in data["reasons"])]
    for each in data["singularities"]:
        lines += [each["text"], f"  {each['cause']}", f"  measure {each['measure']:.2g}", ""]
    if data["singular"] is False and not data["singularities"]:
        lines.append("Not singular.")
        lines += [
            f"Near a {each.kind} singularity, measure {each.measure:.2g}: "
            f"{each.cause.removeprefix('nearly: ')}."
            for each in near
        ]
    smallest, condition, _, length = data["conditioning"].values()
    if smallest is not None:
        number = "infinite" if condition is None else f"{condition:.4g}"
        lines.append(
            f"Smallest singular value of the wrenches {smallest:.4g}, condition number {number} "
            f"(characteristic length {length:.4g} mm)."
        )
    lines += [
        f"{each['title']}: {tables.number_text(each['value'])} {each['unit']}".rstrip()
        for each in data["measures"]
        if each["value"] is not None
    ]
    if data["clearances"]:
        lines += ["", "What is nearest, at this orientation:"]
        lines += [f"  {each['text']}" for each in data["clearances"]]
    remedy = data["remedy"]
    if remedy and remedy["text"]:
        lines.append(remedy["text"])
        lines += [f"  {'; '.join(change['text'] for change in way)}" for way in remedy["changes"]]
    return lines


# --- charts --------------------------------------------------------------------------------


def _chart(pose: Given, mode: str, key: str | None, at: float | None, output: Output) -> Answer:
    """The curves of a chart; without a key of the first one."""
    from app.features.singularities import files

    kind, machine = output.kind(files.FORMATS, "a chart"), pose.machine
    place, known = pose.place(mode), _charts(machine)
    key = known[0] if key is None else values.one_of("--chart", key, known)
    spec = machine.singularities.loci[known.index(key)]
    with progress(spec.title):
        found = machine.singularities.locus(key, place.pose, mode, at)
    if kind:
        title = f"{machine.design.title or machine.design.name}: {spec.title}"
        note = place.where.removeprefix("Pose ")
        output.write(files.locus_bytes(found, spec, kind, title=title, note=note))
    curves = files.curves(found, spec)
    data = {
        **place.entries,
        "chart": key,
        "title": spec.title,
        "at_mm": at,
        "coordinates": list(files.columns(spec)),
        "curves": curves,
        "residual": max((each["residual"] for each in curves), default=0.0),
        "bounds": files.outer(found.bounds.T, spec).T.tolist(),
    }
    table = tables.records(
        curves,
        *(("curve", "#"), ("kind", "kind"), ("limb", "limb", "")),
        ("points", "points", lambda points: str(len(points))),
        *(("", "closed", {True: "closed", False: "open"}), ("residual", "residual", ".1e")),
    )
    told = ["", table, ""] if curves else ["There is no singularity in the chart."]
    return Answer(data, [place.where, spec.title, *told])


# --- surfaces ------------------------------------------------------------------------------


def _surfaces(
    machine: Machine[Any],
    pose: Given,
    mode: str,
    resolution: Resolution,
    what: str | None,
    output: Output,
) -> Answer:
    """The pieces of the workspace of a mode, and the singular surface between them."""
    from app.features.review import files
    from kinematics.solids.meshes import face_parts

    wanted = (what or tables.LOCUS).strip().lower()
    if wanted != tables.LOCUS and not wanted.isdecimal():
        raise InputError(f"--what must be {tables.LOCUS} or the number of a piece, got {what!r}")
    clouds = ("csv",) if wanted == tables.LOCUS else ()
    kind = output.kind((*files.FORMATS, *clouds), "a singular surface" if clouds else "a solid")
    angles = pose.angles(ASPECTS)
    with progress(f"Aspects, {resolution}"):
        shown = angles.space((mode,)).solid(resolution, key=ASPECTS)
    built, placement = shown.built, shown.placement
    locus = built.locus_mesh()
    areas = face_parts(locus.vertices, locus.faces)[1]  # mm² twice
    if kind:
        mesh = locus if wanted == tables.LOCUS else built.piece_mesh(int(wanted) - 1)
        if not len(mesh.faces):
            raise ComputationError(
                f"there is no singularity inside the workspace of mode {mode} at this "
                f"orientation, so {str(output.path)!r} was not written"
            )
        is_open = wanted == tables.LOCUS
        output.write(files.mesh_bytes(mesh, placement, kind, is_open=is_open, unit=output.unit))
    pieces = [
        {
            **tables.record(piece, "volume_mm3", "sign", volume_error_mm3="volume_error"),
            "centroid_mm": (placement[:3, :3] @ piece.centroid + placement[:3, 3]).tolist(),
        }
        for piece in built.pieces
    ]
    data = {
        **angles.entries(),
        "mode": mode,
        **tables.mode_entry(machine, mode),
        "resolution": resolution,
        **shown.to_dict(),
        "pieces": pieces,
        "locus_area_mm2": float(areas.sum()) / 2.0,
        **tables.record(built, "locus_unplaced", locus_residual_mm="locus_residual"),
    }
    where = f"At {angles.text()}" if angles.held else "All orientations"
    head = f"{where}{tables.mode_text(machine, mode)}, {resolution}"
    return Answer(data, [head, "", *_surface_lines(data)])


def _surface_lines(data: dict[str, Any]) -> list[str]:
    resolution, area, residual = (
        data[key] for key in ("resolution", "locus_area_mm2", "locus_residual_mm")
    )
    triangles = f"{data['triangles']} triangles, {'' if data['watertight'] else 'not '}watertight"
    if not data["pieces"]:
        empty = "The workspace of this mode is empty at this orientation."
        return [data["note"] or empty, triangles]
    table = tables.records(
        data["pieces"],
        ("piece", "#"),
        ("volume (mm³)", "volume_mm3", tables.grouped),
        ("±", "volume_error_mm3", tables.grouped),
        ("", "sign", {1: "det > 0", -1: "det < 0", 0: ""}),
    )
    finer = "" if resolution == "fine" else "; a finer one may show thin layers"
    locus = f"No singularity inside is found at this resolution{finer}."
    if area > 0.0 and residual is not None:
        unplaced = f" but for {data['locus_unplaced']}" if data["locus_unplaced"] else ""
        exact = f"its vertices exact to {residual:.1g} mm{unplaced}"
        locus = f"singular surface {tables.grouped(area)} mm², {exact}"
    return [
        table,
        "",
        f"together {tables.grouped(data['volume_mm3'])} ± "
        f"{tables.grouped(data['volume_error_mm3'])} mm³",
        locus,
        f"At {resolution} resolution: pieces thinner than a cell, or smaller than the error, may "
        "be missed, and are told by a finer one.",
        *([data["note"]] if data["note"] else []),
        "These are slices of the aspects at one orientation: pieces may be joined through others.",
        triangles,
    ]
