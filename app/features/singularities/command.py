"""`bohemia singularity`: where control is lost, why, and how far that is."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.features.singularities import aspects_command
from app.terminal import common, tables
from app.terminal.place import Place
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.answers.clearances import Clearance, Remedy
    from kinematics.answers.loci import LocusCurves, LocusSpec
    from kinematics.answers.singularities import Singularity
    from kinematics.answers.solutions import Posture
    from kinematics.mechanism import Coordinate


def register(command: common.AddCommand) -> None:
    singularity = command(
        "singularity",
        _singularity,
        "Where control is lost: at a pose, as curves, or as surfaces in the workspace.",
    )
    common.add_design(singularity)
    common.add_pose(singularity, required=False)
    common.add_mode(singularity, "that of the home posture")
    singularity.add_argument(
        "--tolerance",
        metavar="S",
        help="name singularities whose measure is below this, 0 to 1; larger than the default "
        "names near ones",
    )
    singularity.add_argument(
        "--chart", metavar="KEY", help="the loci in this chart of the mechanism, as curves"
    )
    singularity.add_argument("--at", metavar="A", help="where a section chart's plane stands, mm")
    singularity.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="write the chart as .csv or .svg; without --pose the singular surface or a piece as "
        ".stl, .3mf, .ply, .glb or .obj, the surface's points as .csv",
    )
    aspects_command.add_arguments(singularity)
    singularity.epilog = (
        "Without --pose: the workspace of the mode at an orientation, parted by its singular "
        "surface into pieces on which control is kept."
    )
    common.add_json(singularity)


def _singularity(arguments: argparse.Namespace) -> None:
    if arguments.pose is None:
        for option in ("chart", "at", "tolerance"):
            if getattr(arguments, option) is not None:
                raise InputError(f"--{option} goes with --pose")
        aspects_command.run(arguments)
        return
    foreign = aspects_command.foreign(arguments)
    if foreign is not None:
        raise InputError(f"{foreign} is for all positions together; leave it or --pose out")
    if arguments.chart is not None:
        _chart(arguments)
        return
    for option in ("at", "output"):
        if getattr(arguments, option) is not None:
            raise InputError(f"{'-o' if option == 'output' else '--at'} goes with --chart")
    _at_pose(arguments)


def _at_pose(arguments: argparse.Namespace) -> None:
    from kinematics.answers.singularities import AT, NEAR

    tolerance = AT if arguments.tolerance is None else _tolerance(arguments.tolerance)
    place = Place.of(arguments)
    machine = place.machine
    posture = place.posture()
    lost = machine.singularities.at(posture, tolerance) if posture.closes else ()
    near = machine.singularities.at(posture, NEAR) if posture.closes and not lost else ()
    held = _conditioning(place)
    with common.progress("Clearances"):
        clearances = machine.clearances.of(posture)
    remedy = None
    if not posture.reachable:
        with common.progress("The nearest posture"):
            remedy = machine.clearances.nearest_pose(posture)
    common.warn(machine)
    if not arguments.json:
        place.head()
        print("\n".join(_lost_lines(place, posture, lost, near, held, clearances, remedy)))
        return
    common.print_json(
        {
            **place.entries(),
            "within_stroke": posture.reachable,
            "reasons": [reason.text for reason in posture.reasons],
            "tolerance": tolerance,
            "singular": any(each.measure < AT for each in lost) if posture.closes else None,
            "kinds": list(dict.fromkeys(each.kind for each in lost)),
            "singularities": [_singular(each, place.axes) for each in lost],
            "conditioning": held,
            "measures": _measures(place),
            "clearances": [_clearance(each) for each in clearances],
            "remedy": None if remedy is None else _remedy(remedy, place),
        }
    )


def _tolerance(text: str) -> float:
    value = common.number(text, "--tolerance")
    if not 0.0 < value <= 1.0:
        raise InputError(f"--tolerance must lie between 0 and 1, got {text.strip()}")
    return value


def _conditioning(place: Place) -> dict[str, float | None]:
    from kinematics.screws.wrenches import singular_values

    length = place.machine.length
    system = place.machine.statics.wrenches(place.pose, place.mode)
    values = singular_values(system.rows, length).tolist()
    return {
        "smallest_singular_value": common.finite(values[-1]),
        "condition": common.finite(values[0] / values[-1]) if values[-1] else None,
        "determinant": common.finite(float(system.determinant)),
        "characteristic_length_mm": length,
    }


def _measures(place: Place) -> list[dict[str, Any]]:
    return [
        {
            "key": each.key,
            "title": each.title,
            "unit": each.unit,
            "value": common.finite(float(place.machine.measures(place.pose, place.mode, each.key))),
        }
        for each in place.machine.measures.specs
        if not each.needs_load
    ]


def _singular(lost: Singularity, axes: Sequence[Coordinate]) -> dict[str, Any]:
    motion = lost.motion
    keys = map(tables.key, axes)
    return {
        "kind": lost.kind,
        "limbs": lost.limbs,
        "cause": lost.cause,
        "text": lost.text,
        "measure": common.finite(lost.measure),
        "motion": None
        if motion is None
        else dict(zip(keys, tables.outer(motion, axes), strict=True)),
        "twist": None
        if lost.twist is None
        else {"omega_deg": [degrees(v) for v in lost.twist[:3]], "v": list(lost.twist[3:])},
    }


def _clearance(each: Clearance) -> dict[str, Any]:
    return {
        "kind": each.kind,
        "distance_mm": common.finite(each.distance),
        "error_mm": each.error,
        "angle_deg": None if each.angle is None else degrees(each.angle),
        "point_mm": list(each.point),
        "limb": each.limb,
        "bound": each.bound,
        "text": each.text,
    }


def _remedy(remedy: Remedy, place: Place) -> dict[str, Any]:
    nearest = remedy.nearest
    keys = map(tables.key, place.axes)
    return {
        "nearest": None
        if nearest is None
        else {
            "pose": dict(zip(keys, tables.outer(nearest.pose, place.axes), strict=True)),
            **common.mode_entry(place.machine, nearest.mode),
            "joints": tables.outer(nearest.joints, place.joints),
        },
        "distance_mm": common.finite(remedy.distance),
        "error_mm": common.finite(remedy.error),
        "modes": list(remedy.modes),
        "changes": [
            [
                {
                    "path": list(change.path),
                    "label": change.label,
                    "before": change.before,
                    "after": change.after,
                    "text": change.text,
                }
                for change in way
            ]
            for way in remedy.changes
        ],
        "text": remedy.text,
    }


def _lost_lines(
    place: Place,
    posture: Posture,
    lost: Sequence[Singularity],
    near: Sequence[Singularity],
    held: dict[str, float | None],
    clearances: Sequence[Clearance],
    remedy: Remedy | None,
) -> list[str]:
    lines = [""]
    if not posture.reachable:
        lines += ["Not reachable:", *(f"  {reason.text}" for reason in posture.reasons)]
    for each in lost:
        lines += [each.text, f"  {each.cause}", f"  measure {each.measure:.2g}", ""]
    if posture.closes and not lost:
        lines.append("Not singular.")
        for each in near:
            cause = each.cause.removeprefix("nearly: ")
            lines.append(f"Near a {each.kind} singularity, measure {each.measure:.2g}: {cause}.")
    smallest, condition = held["smallest_singular_value"], held["condition"]
    if smallest is not None:
        number = "infinite" if condition is None else f"{condition:.4g}"
        lines.append(
            f"Smallest singular value of the wrenches {smallest:.4g}, condition number {number} "
            f"(characteristic length {held['characteristic_length_mm']:.4g} mm)."
        )
    lines += [
        f"{each['title']}: {tables.number_text(each['value'])} {each['unit']}".rstrip()
        for each in _measures(place)
        if each["value"] is not None
    ]
    if clearances:
        lines += ["", "What is nearest, at this orientation:"]
        lines += [f"  {each.text}" for each in clearances]
    if remedy is not None and remedy.text:
        lines.append(remedy.text)
        lines += ["  " + "; ".join(change.text for change in way) for way in remedy.changes]
    return lines


# --- charts --------------------------------------------------------------------------------


def _chart(arguments: argparse.Namespace) -> None:
    from app.features.singularities import files

    path: Path | None = arguments.output
    kind = None if path is None else common.ending(path, files.FORMATS, "a chart")
    if arguments.tolerance is not None:
        raise InputError("--tolerance is about one pose; leave it out with --chart")
    place = Place.of(arguments)
    spec = _locus_spec(arguments.chart, place)
    at = None if arguments.at is None else common.number(arguments.at, "--at")
    with common.progress(spec.title):
        found = place.machine.singularities.locus(spec.key, place.pose, place.mode, at)
    common.warn(place.machine)
    if path is not None and kind is not None:
        where = tables.with_units(place.shown, place.axes)
        title = f"{place.machine.design.title or place.machine.design.name}: {spec.title}"
        note = f"{where}{common.mode_text(place.machine, place.mode)}"
        data = files.locus_bytes(found, spec, kind, title=title, note=note)
        common.write(path, data)
    if not arguments.json:
        place.head()
        print("\n".join(_chart_lines(found, spec, path)))
        return
    curves = files.curves(found, spec)
    common.print_json(
        {
            **place.entries(),
            "chart": spec.key,
            "title": spec.title,
            "at_mm": at,
            "coordinates": list(files.columns(spec)),
            "curves": curves,
            "residual": max((each["residual"] for each in curves), default=0.0),
            "bounds": files.outer(found.bounds.T, spec).T.tolist(),
            "file": None if path is None else str(path),
        }
    )


def _locus_spec(key: str, place: Place) -> LocusSpec:
    specs = place.machine.singularities.loci
    if not specs:
        raise InputError(
            f"{place.machine.design.name}: a {place.machine.title} has no charts of loci"
        )
    for spec in specs:
        if spec.key == key.strip():
            return spec
    raise InputError(f"--chart must be one of {', '.join(s.key for s in specs)}, got {key!r}")


def _chart_lines(found: LocusCurves, spec: LocusSpec, path: Path | None) -> list[str]:
    from app.features.singularities import files

    lines = [spec.title]
    rows = [
        (
            str(n + 1),
            each["kind"],
            "" if each["limb"] is None else str(each["limb"]),
            str(len(each["points"])),
            "closed" if each["closed"] else "open",
            f"{each['residual']:.1e}",
        )
        for n, each in enumerate(files.curves(found, spec))
    ]
    if rows:
        lines += [
            "",
            tables.table(("curve", "kind", "limb", "points", "", "residual"), rows),
            "",
        ]
    else:
        lines.append("There is no singularity in the chart.")
    if path is not None:
        lines.append(f"file  {path}")
    return lines
