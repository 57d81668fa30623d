"""`bohemia trajectory`: what a path asks of the actuators."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.features.move.command import wrench_entries
from app.language import tr
from app.terminal import tables, values
from app.terminal.command import Answer, Output, command, progress
from app.terminal.options import DESIGN, argument, choice, mode, option, output
from kinematics.errors import InputError

if TYPE_CHECKING:
    from app.features.trajectory.files import Points
    from app.features.trajectory.state import Through
    from kinematics.answers.coordinates import Coordinate
    from kinematics.answers.solutions import Followed
    from kinematics.machine import Machine
    from kinematics.trajectories import Fits, Trajectory

DRIVEN = 400  # poses, about, through which a machine is driven to see where it stops
LAWS = ("linear", "cubic", "quintic", "trapezoidal")
TAILS = ("", "_per_s", "_per_s2")

Numbers = list[float] | None


def _most(mm: str, turned: str, help: str) -> Any:
    """Limits of the actuators, in mm and rad but for forces."""

    def read(option: str, text: str, machine: Machine[Any]) -> tuple[float, ...]:
        joints = machine.joints
        every = text if "," in text else ",".join([text] * len(joints))
        typed = values.of_axes(option, every, joints, (mm, turned))
        return tuple(
            typed
            if mm == "N"
            else (joint.inner(value) for value, joint in zip(typed, joints, strict=True))
        )

    return option("v1,...", f"limits, one for all actuators or one for each, {help}", read)


def _names(machine: Machine[Any]) -> list[str]:
    return [each.name for each in machine.paths.named()]


@command("trajectory")
def trajectory(
    machine: Machine[Any] = DESIGN,
    path: str = argument("FILE.csv|NAME", _names, files=True),
    mode: str | None = mode(None),
    law: str | None = option(
        "LAW",
        f"{', '.join(LAWS)} (default quintic; points with times have none)",
        known=lambda machine: LAWS,
    ),
    duration: float | None = option(
        "S",
        "seconds (default: 100 mm/s along it, angles counted by the characteristic length)",
        values.number,
    ),
    samples: int = option("N", "rows to compute", values.whole, default="101"),
    through: Through = choice("how points are joined", "spline", "lines", default="spline"),
    blend: float | None = option(
        "MM", "with --through lines: round corners from this far on (default 0)", values.number
    ),
    load: Numbers = option(
        "Fx,Fy,Fz,Tx,Ty,Tz", "N and N·mm, base frame: actuator forces for it", values.load
    ),
    max_rates: Any = _most("mm/s", "degrees/s", "mm/s, angles degrees/s"),
    max_accelerations: Any = _most("mm/s²", "degrees/s²", "mm/s², angles degrees/s²"),
    max_forces: Any = _most("N", "N·mm", "N, rotary ones N·mm; goes with --load"),
    fit: int | None = option(
        "DEGREE",
        "fit polynomials of time to the joints, with the true error; as many digits are printed "
        "as that needs, and all of them with --json",
        values.whole,
    ),
    output: Output = output("the samples as .csv"),
) -> Answer:
    """Joints, rates, accelerations, forces and the distance to singularities along a path.

    The path is a CSV file of points, one a line, under a line that names the pose coordinates (and
    t, s); or a path of the mechanism by its name, as line or rest-to-rest of the five-bar. A named
    path has its own mode, a file the home mode, unless --mode names another.

    Between points a path runs straight, or by a spline, in the coordinates themselves: an angle
    from 170 to -170 degrees goes back through 0; write 190 for the short way. Largest values and
    limits are those of the whole way, not of the samples: null in JSON and ∞ in text where one
    grows without end. Where the path leaves the workspace or is singular, a last line tells how far
    a machine gets that is driven along it (driven in JSON). JSON and CSV have no number where the
    path is outside or a singularity leaves it open; singularity_mm is null in JSON and inf in CSV
    where there is no singularity.
    """
    from app.features.trajectory import state
    from app.features.trajectory.files import trajectory_csv
    from kinematics import trajectories

    kind = output.kind(("csv",), "a trajectory")
    if max_forces is not None and load is None:
        raise InputError("--max-forces goes with --load")
    if blend is not None and through != "lines":
        raise InputError("--blend goes with --through lines")
    named = next((each for each in machine.paths.named() if each.name == path), None)
    points, dependent = None, None
    if named is not None:
        mode, name = mode or named.mode, named.name
        plan = state.Plan(way=path)
    else:
        mode, name = mode or machine.home.mode, Path(path).name
        points = _points(machine, path)
        dependent, poses, times = points.dependent, points.poses, points.times or ()
        if dependent is not None:
            poses = tuple(machine.complete_pose(pose, mode) for pose in poses)
        if times and law is not None:
            raise InputError("--law: the file gives the times, so that there is no law to choose")
        plan = state.Plan(
            way=state.FILE, file=poses, times=times, through=through, blend=blend or 0.0
        )
    way, own = state.path_of(plan, machine)
    chosen = trajectories.law(law or own.kind, own.duration if duration is None else duration)
    with progress("Trajectory"):
        found = trajectories.trajectory(
            *(machine, way, chosen, mode),
            samples=samples,
            load=load,
            limits=trajectories.Limits(max_rates, max_accelerations, max_forces),
            dependent=dependent,
        )
        fits = None if fit is None else trajectories.fit(machine, found, fit)
        driven = _driven(machine, found)
    axes, joints = machine.coordinates, machine.joints
    if kind:
        note = f"{len(found.times)} rows; {output.unit}, degrees, s"
        bare = {axis.json_key for axis in (*axes, *joints) if axis.unit == "mm"}
        output.write(trajectory_csv(found, axes, joints).encode(), note, bare)
    title, told = name, "by its times, " if points and points.times else f"{chosen.kind}, "
    if named is not None:
        title = named.title if chosen.kind == own.kind else f"The way of {name}"
        told = "" if chosen.kind == own.kind else told
    head = f"{title}{tables.mode_text(machine, mode)}, {told}{chosen.duration:g} s"
    data = {
        "path": name,
        **tables.mode_entry(machine, mode),
        "law": chosen.kind,
        "duration_s": chosen.duration,
        **_data(machine, found, fits, driven),
    }
    lines = [head, *_lines(found, fits, axes, joints)]
    if driven is not None and driven.stop != "target":
        where = tables.with_units(tables.outer(driven.posture.pose, axes), axes)
        lines.append(f"A machine driven along it stops at {where}: {driven.text}")
    return Answer(data, lines)


def _points(machine: Machine[Any], path: str) -> Points:
    """What the file of a path says."""
    from app.features.trajectory.files import LARGEST, read_points
    from kinematics.storage import read_text

    names, file = _names(machine), Path(path)
    known = f"paths by name are {', '.join(names)}" if names else "none has a name"
    if "\0" in path or not file.exists():
        if file.suffix or file.name != path:
            raise InputError(f"there is no file {path!r} that can be read; {known}")
        raise InputError(
            f"there is no such path {path!r} of a {machine.title}: {known}, any other is a CSV "
            "file of points"
        )
    text = read_text(file, LARGEST, "a list of points")
    return read_points(text, machine.coordinates, origin=path, dependent=machine.dependent)


def _driven(machine: Machine[Any], found: Trajectory) -> Followed | None:
    """How far a machine gets that is driven along a path which leaves its reach or its control."""
    if not any(event.kind in ("singularity", "outside") for event in found.events):
        return None
    step = max(1, len(found.poses) // DRIVEN)
    poses = found.poses[[*range(0, len(found.poses) - 1, step), -1]]
    start = machine.inverse.posture(tuple(poses[0].tolist()), found.mode)
    return machine.paths.drive(start, poses[1:])


# --- answers -------------------------------------------------------------------------------


def _data(
    machine: Machine[Any], found: Trajectory, fits: Fits | None, driven: Followed | None
) -> dict[str, Any]:
    from app.features.trajectory.files import columns_of, force_keys

    axes, joints = machine.coordinates, machine.joints
    columns = columns_of(found, axes, joints)
    flags = columns.pop("within_stroke")
    keys = force_keys(found.names, joints)
    system = machine.statics.wrenches(found.poses, found.mode)
    wrenches = wrench_entries(machine, system) if keys else []
    # What was first written without its unit is kept, beside the whole name.
    whole = {"t": "t_s"}
    for key, wrench in zip(keys, wrenches, strict=True):
        bare = key.removesuffix("_Nmm").removesuffix("_N")
        whole[key] = wrench["key"] = f"{bare}_{wrench['unit'].replace(' ', '')}"
    for axis in (*axes, *joints):
        whole |= {f"{axis.json_key}{tail}": f"{tables.unit_key(axis)}{tail}" for tail in TAILS}

    def both(named: dict[str, Any]) -> dict[str, Any]:
        return {**{whole.get(key, key): value for key, value in named.items()}, **named}

    largest: dict[str, Any] = {}
    rates, accelerations = ([j.json_key + tail for j in joints] for tail in TAILS[1:])
    for what, named in (("rate", rates), ("acceleration", accelerations), ("force", keys)):
        sizes, times = found.largest(what)  # type: ignore[arg-type]
        shown = tables.plain(sizes) if what == "force" else tables.listed(sizes, joints)
        for key, value, at in zip(named, shown, tables.plain(times), strict=True):
            largest[key] = {"value": value, "t_s": at, "t": at}
    answer = {
        **tables.record(found, "sound", length_mm="travel", moving_at_ends="moving_ends"),
        "largest": both(largest),
        "events": [
            {
                **tables.record(event, "kind", "start_s", "end_s", "text", worst_at_s="at"),
                "pose": tables.named(event.pose, axes),
            }
            for event in found.events
        ],
        "driven": driven
        and {
            **tables.record(driven, "stop", "text", share="fraction"),
            "pose": tables.named(driven.posture.pose, axes),
        },
        "wrenches": wrenches,
        "samples": {
            **both({key: tables.plain(column) for key, column in columns.items()}),
            "within_stroke": [bool(flag) for flag in flags],
        },
    }
    if fits is not None:  # polynomials in rad as the papers print them, errors in people's units
        rows = dict(zip((joint.key for joint in joints), fits.coefficients.tolist(), strict=True))
        errors = {
            f"{axis.json_key}{tail}": {"deviation": one, "largest": two}
            for tail, spread, most in zip(TAILS, fits.deviation, fits.largest, strict=True)
            for axis, one, two in zip(
                axes, tables.listed(spread, axes), tables.listed(most, axes), strict=True
            )
        }
        answer["fit"] = {
            **tables.record(fits, "degree", "digits", "carried", "trouble"),
            "coefficients": {**{f"{j.key}_{j.unit}": rows[j.key] for j in joints}, **rows},
            "error": both(errors),
        }
    return answer


def _lines(
    found: Trajectory, fits: Fits | None, axes: Sequence[Coordinate], joints: Sequence[Coordinate]
) -> list[str]:
    import numpy as np

    rates, accelerations = found.largest("rate"), found.largest("acceleration")
    forces = found.largest("force")
    rows = []
    for n, joint in enumerate(joints):
        ends = tables.outer([found.joints[0, n], found.joints[-1, n]], [joint, joint])
        row = [*tables.headings([joint], "°")]
        row += [f"{v:.4f}" if isfinite(v) else "–" for v in ends]
        for sizes, times in (rates, accelerations):
            row.append(_at(tables.outer([float(sizes[n])], [joint])[0], float(times[n])))
        if found.names:
            unit = " N·mm" if joint.unit == "rad" else " N"
            row.append(_at(float(forces[0][n]), float(forces[1][n]), unit))
        rows.append(row)
    header = ["joint", "start", "end", "largest rate /s", "acceleration /s²"]
    header += ["force"] if found.names else []
    lines = [
        "",
        tables.table(header, rows),
        "",
        f"length     {found.travel:.1f} mm travelled by O′",
    ]
    moving = [t for t, on in zip((0.0, found.duration), found.moving_ends, strict=True) if on]
    if moving:
        when = " and ".join(f"t = {t:g} s" for t in moving)
        lines.append(f"ends       at speed at {when}: getting there and stopping is not counted")
    distance = np.where(np.isfinite(found.distance), found.distance, np.inf)
    n = int(distance.argmin())
    if isfinite(distance[n]) and not any(event.kind == "singularity" for event in found.events):
        near = [(event.value, event.at) for event in found.events if event.kind == "near"]
        least, at = min([*near, (float(distance[n]), float(found.times[n]))])
        lines.append(f"nearest    {least:.1f} mm to a singularity, at t = {at:.3f} s")
    lines += [] if fits is None else _fit_lines(fits, axes, joints)
    nothing = "Nothing on the way: inside the workspace, no singularity, no limit exceeded."
    return [*lines, *([event.text for event in found.events] or [nothing])]


def _at(value: float, time: float, unit: str = "") -> str:
    """ "39.7073 at 1.035 s"; a largest value that has no end is infinite."""
    if isfinite(value):
        return f"{tables.number_text(value)}{unit} at {time:.3f} s"
    return f"∞ at {time:.3f} s" if value > 0.0 else "–"


def _fit_lines(fits: Fits, axes: Sequence[Coordinate], joints: Sequence[Coordinate]) -> list[str]:
    from app.features.trajectory.files import polynomial

    lines = ["", f"polynomials of degree {fits.degree}, t in s"]
    for joint, row in zip(joints, fits.coefficients.tolist(), strict=True):
        lines.append(f"{joint.symbol}(t) = {polynomial(row, fits.digits)} {joint.unit}")
    shown = (
        [f"{v:.4g}" if isfinite(v) else "–" for v in tables.outer(each.tolist(), axes)]
        for each in fits.deviation
    )
    rows = [*zip(tables.headings(axes, "°"), *shown, strict=True)]
    header = ["true error, σ", "position", "velocity /s", "acceleration /s²"]
    lines.append(tables.table(header, rows))
    if fits.trouble:
        lines.append(f"No true error: {fits.trouble}.")
    elif not fits.carried:
        lines.append(tr("trajectory.digits_lost"))
    return [*lines, ""]
