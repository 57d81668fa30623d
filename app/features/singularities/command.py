"""`bohemia singularity`: where control is lost, why, and how far that is."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import TYPE_CHECKING, Any

from app.features.singularities import aspects_command
from app.terminal import tables, values
from app.terminal.command import Answer, Output, command, progress
from app.terminal.options import DESIGN, MODE, option, output
from app.terminal.options import pose as posed
from app.terminal.options import resolution as fineness
from kinematics.errors import InputError

if TYPE_CHECKING:
    from app.terminal.poses import Given, Place
    from kinematics.answers.clearances import Remedy
    from kinematics.answers.singularities import Singularity
    from kinematics.facets.solids import Resolution
    from kinematics.machine import Machine


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
    if not somewhere and any(spec.key == aspects_command.KEY for spec in machine.solid_specs):
        for name, value in {"chart": chart, "at": at, "tolerance": tolerance}.items():
            if value is not None:
                raise InputError(f"--{name} goes with --pose")
        return aspects_command.surfaces(machine, pose, mode, resolution or "normal", what, output)
    for name, value in (("--resolution", resolution), ("--what", what)):
        if value is not None:
            raise InputError(f"{name} is for all positions together; leave it or --pose out")
    if chart is None and somewhere:
        if at is not None or output.path is not None:
            raise InputError(f"{'-o' if at is None else '--at'} goes with --chart")
        return _at_pose(pose.place(mode), tolerance)
    if tolerance is not None:
        raise InputError("--tolerance is about one pose; leave it out with --chart")
    return _chart(pose, mode, chart, at, output)


def _at_pose(place: Place, tolerance: float | None) -> Answer:
    from kinematics.answers.singularities import AT, NEAR

    if tolerance is not None and not 0.0 < tolerance <= 1.0:
        raise InputError(f"--tolerance must lie between 0 and 1, got {tolerance:g}")
    machine, posture = place.machine, place.posture
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
        "singularities": [_singular(each, place) for each in lost],
        "conditioning": _conditioning(place),
        "measures": _measures(place),
        "clearances": [tables.record(each, *CLEARANCE) for each in clearances],
        "remedy": None if remedy is None else _remedy(remedy, place),
    }
    return Answer(data, [f"Pose {place.where}", *_lost_lines(data, near)])


def _singular(lost: Singularity, place: Place) -> dict[str, Any]:
    entry = tables.record(lost, "kind", "limbs", "cause", "text", "measure")
    entry["motion"] = lost.motion and tables.named(lost.motion, place.machine.coordinates)
    entry["twist"] = lost.twist and {
        "omega_deg": [degrees(value) for value in lost.twist[:3]],
        "v_mm": list(lost.twist[3:]),
        "v": list(lost.twist[3:]),
    }
    return entry


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


def _measures(place: Place) -> list[dict[str, Any]]:
    asked = place.machine.measures
    return [
        {
            **tables.record(each, "key", "title", "unit"),
            "value": tables.finite(float(asked(place.pose, place.mode, each.key))),
        }
        for each in asked.specs
        if not each.needs_load
    ]


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
        output.write(files.locus_bytes(found, spec, kind, title=title, note=place.where))
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
        [{**curve, "number": n} for n, curve in enumerate(curves, start=1)],
        ("curve", "number"),
        ("kind", "kind"),
        ("limb", lambda curve: str(curve["limb"] or "")),
        ("points", lambda curve: str(len(curve["points"]))),
        ("", lambda curve: "closed" if curve["closed"] else "open"),
        ("residual", lambda curve: f"{curve['residual']:.1e}"),
    )
    told = ["", table, ""] if curves else ["There is no singularity in the chart."]
    return Answer(data, [f"Pose {place.where}", spec.title, *told])
