"""`bohemia trajectory`: what a path asks of the actuators."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from math import isfinite, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from app.features.move.command import load_numbers
from app.features.trajectory.text import LOST, polynomial
from app.terminal import common, tables
from kinematics.errors import InputError

if TYPE_CHECKING:
    from app.features.trajectory.files import Points
    from kinematics.answers.solutions import Followed
    from kinematics.machine import Machine
    from kinematics.mechanism import Coordinate
    from kinematics.trajectories import Event, Fits, Limits, TimeLaw, Trajectory
    from kinematics.trajectories import Path as Way

PACE = 100.0  # mm/s, where no duration is given
DRIVEN = 400  # poses, about, through which a machine is driven to see where it stops


def register(command: common.AddCommand) -> None:
    trajectory = command(
        "trajectory",
        _trajectory,
        "Joints, rates, accelerations, forces and the distance to singularities along a path.",
    )
    common.add_design(trajectory)
    trajectory.add_argument(
        "path",
        metavar="FILE.csv|NAME",
        help="points, one a line, under a line that names the pose coordinates (and t, s); or a "
        "path of the mechanism, as line or rest-to-rest of the five-bar",
    )
    common.add_mode(trajectory, "that of the named path, else of the home posture")
    trajectory.add_argument(
        "--law",
        metavar="LAW",
        help="linear, cubic, quintic or trapezoidal (default quintic; not for points with times)",
    )
    trajectory.add_argument(
        "--duration", metavar="S", help="seconds (default: 100 mm/s along the path)"
    )
    trajectory.add_argument(
        "--samples", metavar="N", default="101", help="rows to compute (default %(default)s)"
    )
    trajectory.add_argument(
        "--through",
        choices=("spline", "lines"),
        default="spline",
        help="how points are joined (default %(default)s)",
    )
    trajectory.add_argument(
        "--blend",
        metavar="MM",
        help="with --through lines: round corners from this far on (default 0, sharp)",
    )
    trajectory.add_argument(
        "--load", metavar="Fx,Fy,Fz,Tx,Ty,Tz", help="N and N·mm, base frame: actuator forces for it"
    )
    for name, what in (
        ("rates", "mm/s, angles degrees/s"),
        ("accelerations", "mm/s², angles degrees/s²"),
        ("forces", "N, of rotary actuators N·mm; goes with --load"),
    ):
        trajectory.add_argument(
            f"--max-{name}",
            metavar="v1,...",
            help=f"limits of the actuators, one number for all or one for each, {what}",
        )
    trajectory.add_argument(
        "--fit",
        metavar="DEGREE",
        help="fit polynomials of time to the joints, with the true error; as many digits are "
        "printed as that needs, and all of them with --json",
    )
    trajectory.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="write the samples as .csv"
    )
    common.add_json(trajectory)
    trajectory.epilog = (
        "Between points a path runs straight, or by a spline, in the coordinates themselves: an "
        "angle from 170 to -170 degrees goes back through 0; write 190 for the short way. Largest "
        "values and limits are those of the whole way, not of the samples: null in JSON and ∞ in "
        "text where one grows without end. "
        "Where the path leaves the workspace or is singular, a last line tells how far a machine "
        "gets that is driven along it (driven in JSON). JSON and CSV have no number where the "
        "path is outside or a singularity leaves it open; "
        "singularity_mm is null in JSON and inf in CSV where there is no singularity."
    )


def _trajectory(arguments: argparse.Namespace) -> None:
    from app.features.trajectory.files import trajectory_csv
    from kinematics import trajectories

    output: Path | None = arguments.output
    if output is not None:
        common.ending(output, ("csv",), "a trajectory")
    machine = common.load(arguments.design)
    design = machine.design
    joints = machine.joints
    axes = machine.coordinates
    way = _way(arguments, machine)
    load = None if arguments.load is None else load_numbers(arguments.load)
    limits = _limits(arguments, joints)
    degree = None if arguments.fit is None else _whole("--fit", arguments.fit)
    with common.progress("Trajectory"):
        found = trajectories.trajectory(
            machine,
            way.path,
            way.law,
            way.mode,
            samples=_whole("--samples", arguments.samples),
            load=load,
            limits=limits,
            dependent=way.dependent,
        )
        fits = None if degree is None else trajectories.fit(machine, found, degree)
        driven = _driven(machine, found)
    common.warn(machine)
    if output is not None:
        common.write(output, trajectory_csv(found, axes, joints).encode())
    if arguments.json:
        common.print_json(_answer(arguments, machine, way, found, fits, driven))
        return
    law = f"{way.kind}{way.law.duration:g} s"
    common.print_head(design, f"{way.title}{common.mode_text(machine, way.mode)}, {law}")
    print("\n".join(_lines(found, fits, axes, joints)))
    if driven is not None and driven.stop != "target":
        where = tables.with_units(tables.outer(driven.posture.pose, axes), axes)
        print(f"A machine driven along it stops at {where}: {driven.text}")
    if output is not None:
        print(f"file       {output} ({len(found.times)} rows; mm, degrees, s)")


def _driven(machine: Machine[Any], found: Trajectory) -> Followed | None:
    """How far a machine gets that is driven along a path which leaves its reach or its control."""
    if not any(event.kind in ("singularity", "outside") for event in found.events):
        return None
    step = max(1, len(found.poses) // DRIVEN)
    poses = found.poses[[*range(0, len(found.poses) - 1, step), -1]]
    start = machine.inverse.posture(tuple(poses[0].tolist()), found.mode)
    return machine.paths.drive(start, poses[1:])


# --- the path and its law ------------------------------------------------------------------


class _Asked(NamedTuple):
    """The trajectory asked for: ``name`` of a named one, or the file's.

    ``kind``: the law in words, with a comma; "" where the title tells it.
    """

    name: str
    title: str
    path: Way
    law: TimeLaw
    mode: str
    kind: str
    dependent: int | None = None


def _way(arguments: argparse.Namespace, machine: Machine[Any]) -> _Asked:
    """The path, its time law and its mode."""
    from kinematics.trajectories import law

    known = {each.name: each for each in machine.paths.named()}
    named = known.get(arguments.path)
    duration = None
    if arguments.duration is not None:
        duration = common.number(arguments.duration, "--duration")
    if arguments.blend is not None and arguments.through != "lines":
        raise InputError("--blend goes with --through lines")
    mode = named.mode if named is not None else ""
    if named is None or arguments.mode is not None:
        mode = common.chosen_mode(arguments.mode, machine)
    if named is not None:
        kind = named.law.kind if arguments.law is None else arguments.law
        seconds = named.law.duration if duration is None else duration
        own = kind == named.law.kind
        title = named.title if own else f"The way of {named.name}"
        told = "" if own else f"{kind}, "
        return _Asked(named.name, title, named.path, law(kind, seconds), mode, told)
    points = _points(arguments, machine, tuple(known))
    path = _joined(arguments, machine, points, mode)
    if points.times is not None:
        if arguments.law is not None:
            raise InputError("--law: the file gives the times, so that there is no law to choose")
        seconds = points.times[-1] - points.times[0] if duration is None else duration
        chosen, told = law("linear", seconds), "by its times, "
    else:
        seconds = max(1.0, path.length / PACE) if duration is None else duration
        chosen = law(arguments.law or "quintic", seconds)
        told = f"{chosen.kind}, "
    name = Path(arguments.path).name
    return _Asked(name, name, path, chosen, mode, told, points.dependent)


def _points(arguments: argparse.Namespace, machine: Machine[Any], known: tuple[str, ...]) -> Points:
    """What the file says."""
    from app.features.trajectory.files import LARGEST, read_points

    file = Path(arguments.path)
    try:
        if file.stat().st_size > LARGEST:
            raise InputError(f"{file}: longer than 16 MB, which no path is")
        text = file.read_bytes().decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{file}: not a text file in UTF-8, so not a list of points") from None
    except (OSError, ValueError):
        names = f"; paths by name are {', '.join(known)}" if known else ""
        raise InputError(f"there is no file {arguments.path!r} that can be read{names}") from None
    axes = machine.coordinates
    return read_points(text, axes, origin=str(file), dependent=machine.dependent)


def _joined(
    arguments: argparse.Namespace,
    machine: Machine[Any],
    points: Points,
    mode: str,
) -> Way:
    """The path through a file's points; one that leaves a coordinate open is completed first."""
    from kinematics.trajectories import polyline, spline

    poses = points.poses
    if points.dependent is not None:
        poses = tuple(machine.complete_pose(pose, mode) for pose in poses)
    length = machine.length
    axes = machine.coordinates
    scale = [length if axis.unit == "rad" else 1.0 for axis in axes]
    if points.times is not None:
        if arguments.through == "lines":
            raise InputError("--through lines: points with times are joined by a spline")
        return spline(poses, scale, points.times)
    if arguments.through == "lines":
        blend = 0.0 if arguments.blend is None else common.number(arguments.blend, "--blend")
        return polyline(poses, scale, blend)
    return spline(poses, scale)


def _whole(option: str, text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise InputError(f"{option} must be a whole number, got {text.strip()!r}") from None


def _limits(arguments: argparse.Namespace, joints: Sequence[Coordinate]) -> Limits:
    from kinematics.trajectories import Limits

    def read(
        name: str, units: tuple[str, str], *, turning: bool = True
    ) -> tuple[float, ...] | None:
        text = getattr(arguments, f"max_{name}")
        if text is None:
            return None
        if "," not in text:  # one for all
            text = ",".join([text] * len(joints))
        typed = common.numbers(f"--max-{name}", text, joints, units)
        return tuple(
            radians(value) if turning and joint.unit == "rad" else value
            for value, joint in zip(typed, joints, strict=True)
        )

    if arguments.max_forces is not None and arguments.load is None:
        raise InputError("--max-forces goes with --load")
    return Limits(
        read("rates", ("mm/s", "degrees/s")),
        read("accelerations", ("mm/s²", "degrees/s²")),
        read("forces", ("N", "N·mm"), turning=False),
    )


# --- answers -------------------------------------------------------------------------------


def _answer(
    arguments: argparse.Namespace,
    machine: Machine[Any],
    way: _Asked,
    found: Trajectory,
    fits: Fits | None,
    driven: Followed | None,
) -> dict[str, Any]:
    from app.features.trajectory.files import columns_of

    axes, joints = machine.coordinates, machine.joints
    columns = columns_of(found, axes, joints)
    flags = columns.pop("within_stroke")
    return {
        "design": machine.design.name,
        "mechanism": machine.design.mechanism,
        "path": way.name,
        **common.mode_entry(machine, found.mode),
        "law": way.law.kind,
        "duration_s": way.law.duration,
        "length_mm": found.length,
        "sound": found.sound,
        "moving_at_ends": list(found.moving_ends),
        "largest": _largest(found, joints),
        "events": [_event(event, axes) for event in found.events],
        "driven": None
        if driven is None
        else {
            "stop": driven.stop,
            "share": driven.fraction,
            "pose": dict(
                zip(map(tables.key, axes), tables.outer(driven.posture.pose, axes), strict=True)
            ),
            "text": driven.text,
        },
        "samples": {
            **{key: [common.finite(v) for v in values] for key, values in columns.items()},
            "within_stroke": [bool(flag) for flag in flags],
        },
        **({} if fits is None else {"fit": _fit(fits, axes, joints)}),
        "file": None if arguments.output is None else str(arguments.output),
    }


def _event(event: Event, axes: Sequence[Coordinate]) -> dict[str, Any]:
    return {
        "kind": event.kind,
        "start_s": event.start,
        "end_s": event.end,
        "pose": dict(zip(map(tables.key, axes), tables.outer(event.pose, axes), strict=True)),
        "text": event.text,
        "worst_at_s": common.finite(event.at),
    }


def _largest(found: Trajectory, joints: Sequence[Coordinate]) -> dict[str, Any]:
    """The largest sizes on the whole way and when; no number where one grows without end."""
    from app.features.trajectory.files import force_keys

    named: dict[str, Any] = {}
    for what, tail in (("rate", "per_s"), ("acceleration", "per_s2")):
        values, times = found.largest(what)  # type: ignore[arg-type]
        for joint, value, at in zip(
            joints, tables.outer(values.tolist(), joints), times.tolist(), strict=True
        ):
            entry = {"value": common.finite(value), "t": common.finite(at)}
            named[f"{tables.key(joint)}_{tail}"] = entry
    values, times = found.largest("force")
    for key, value, at in zip(
        force_keys(found.names, joints), values.tolist(), times.tolist(), strict=True
    ):
        named[key] = {"value": common.finite(value), "t": common.finite(at)}
    return named


def _fit(fits: Fits, axes: Sequence[Coordinate], joints: Sequence[Coordinate]) -> dict[str, Any]:
    """Polynomials in rad as the papers print them, errors in people's units."""
    named = {}
    for what, spread, most in zip(
        ("", "_per_s", "_per_s2"), fits.deviation, fits.largest, strict=True
    ):
        for axis, one, two in zip(
            axes,
            tables.outer(spread.tolist(), axes),
            tables.outer(most.tolist(), axes),
            strict=True,
        ):
            named[f"{tables.key(axis)}{what}"] = {
                "deviation": common.finite(one),
                "largest": common.finite(two),
            }
    return {
        "degree": fits.degree,
        "coefficients": {
            joint.key: row for joint, row in zip(joints, fits.coefficients.tolist(), strict=True)
        },
        "error": named,
        "digits": fits.digits,
        "carried": fits.carried,
        "trouble": fits.trouble,
    }


def _lines(
    found: Trajectory,
    fits: Fits | None,
    axes: Sequence[Coordinate],
    joints: Sequence[Coordinate],
) -> list[str]:
    import numpy as np

    rates, accelerations = found.largest("rate"), found.largest("acceleration")
    forces = found.largest("force")
    rows = []
    for n, joint in enumerate(joints):
        mark = "°" if joint.unit == "rad" else "mm"
        ends = tables.outer([found.joints[0, n], found.joints[-1, n]], [joint, joint])
        row = [f"{joint.symbol} ({mark})", *(f"{v:.4f}" if isfinite(v) else "–" for v in ends)]
        for values, times in (rates, accelerations):
            row.append(_at(tables.outer([float(values[n])], [joint])[0], float(times[n])))
        if found.names:
            unit = " N·mm" if joint.unit == "rad" else " N"
            row.append(_at(float(forces[0][n]), float(forces[1][n]), unit))
        rows.append(row)
    header = ["joint", "start", "end", "largest rate /s", "acceleration /s²"]
    header += ["force"] if found.names else []
    lines = ["", tables.table(header, rows), "", f"length     {found.length:.1f} mm"]
    moving = [t for t, on in zip((0.0, found.duration), found.moving_ends, strict=True) if on]
    if moving:
        when = " and ".join(f"t = {t:g} s" for t in moving)
        lines.append(f"ends       at speed at {when}: getting there and stopping is not counted")
    near = found.distance[np.isfinite(found.distance)]
    if near.size and not any(event.kind == "singularity" for event in found.events):
        n = int(np.nanargmin(np.where(np.isfinite(found.distance), found.distance, np.inf)))
        least, at = float(near.min()), float(found.times[n])
        least, at = min([(e.value, e.at) for e in found.events if e.kind == "near"] + [(least, at)])
        lines.append(f"nearest    {least:.1f} mm to a singularity, at t = {at:.3f} s")
    if fits is not None:
        lines += _fit_lines(fits, axes, joints)
    if found.events:
        lines += [event.text for event in found.events]
    else:
        lines.append("Nothing on the way: inside the workspace, no singularity, no limit exceeded.")
    return lines


def _at(value: float, time: float, unit: str = "") -> str:
    """ "39.7073 at 1.035 s"; a largest value that has no end is infinite."""
    if isfinite(value):
        return f"{tables.number_text(value)}{unit} at {time:.3f} s"
    return f"∞ at {time:.3f} s" if value > 0.0 else "–"


def _fit_lines(fits: Fits, axes: Sequence[Coordinate], joints: Sequence[Coordinate]) -> list[str]:
    lines = ["", f"polynomials of degree {fits.degree}, t in s"]
    for joint, row in zip(joints, fits.coefficients.tolist(), strict=True):
        unit = "rad" if joint.unit == "rad" else "mm"
        lines.append(f"{joint.symbol}(t) = {polynomial(row, fits.digits)} {unit}")
    rows = []
    for axis, *errors in zip(axes, *fits.deviation, strict=True):
        mark = "°" if axis.unit == "rad" else "mm"
        shown = [tables.outer([float(error)], [axis])[0] for error in errors]
        rows.append([f"{axis.symbol} ({mark})", *(_digits(value) for value in shown)])
    header = ["true error, σ", "position", "velocity /s", "acceleration /s²"]
    lines.append(tables.table(header, rows))
    if fits.trouble:
        lines.append(f"No true error: {fits.trouble}.")
    elif not fits.carried:
        lines.append(LOST)
    return [*lines, ""]


def _digits(value: float) -> str:
    return f"{value:.4g}" if isfinite(value) else "–"
