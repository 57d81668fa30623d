"""Trajectories as files: points in from CSV, samples out to CSV, in people's units. Pure functions.

Lengths mm, angles degrees, times s; forces N, torques N·mm.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, isfinite, nan

from app.terminal import tables
from kinematics.answers.motion import WrenchName
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate
from kinematics.trajectories import Trajectory
from kinematics.trajectories.paths import SAME

LARGEST = 16 * 1024 * 1024
"""Bytes; a longer file is refused unread."""


@dataclass(frozen=True, slots=True)
class Points:
    """What a CSV file says: poses (mm and rad), and times, s, where there is a column t.

    ``dependent``: the coordinate that has no column and is NaN in all poses; None: all have one.
    """

    poses: tuple[tuple[float, ...], ...]
    times: tuple[float, ...] | None
    dependent: int | None = None


def read_points(
    text: str, axes: Sequence[Coordinate], *, origin: str, dependent: Sequence[int] = ()
) -> Points:
    """The points of a path.

    The first line names the columns: each pose coordinate by its key, an angle also with "_deg"
    behind it (degrees in any case), and if wanted t (s). Other columns are not read, so that what
    `trajectory_csv` writes can be read again. Columns are parted by commas, semicolons or tabs. One
    of the coordinates ``dependent`` (indices) may be left out, to follow from the others.

    Raises:
        InputError: naming the origin, the line and what is wrong.
    """
    if len(text) > LARGEST:
        raise InputError(f"{origin}: longer than 16 MB, which no path is")
    text = text.removeprefix("\ufeff")
    first = text.split("\n", 1)[0]
    part = max(",;\t", key=first.count)
    rows = csv.reader(io.StringIO(text), delimiter=part)
    header = [name.strip().lower() for name in next(rows, [])]
    found = [_column(header, axis) for axis in axes]
    missing = [n for n, column in enumerate(found) if column is None]
    left = missing[0] if len(missing) == 1 and missing[0] in dependent else None
    if missing and left is None:
        wanted = ",".join(map(tables.key, axes))
        raise InputError(
            f"{origin}: the first line must name a column {tables.key(axes[missing[0]])}; write "
            f"{wanted}, with a column t (s) if the points have times"
        )
    time = header.index("t") if "t" in header else None
    poses, times = [], []
    for number, row in enumerate(rows, start=2):
        if not any(cell.strip() for cell in row):
            continue
        where = f"{origin}, line {number}"
        if len(row) < len(header):
            raise InputError(f"{where}: {len(header)} columns are named, found {len(row)}")
        poses.append(
            tuple(
                nan if n is None else tables.inner(_number(row[n], f"{where}: {axis.key}"), axis)
                for n, axis in zip(found, axes, strict=True)
            )
        )
        if time is None and len(poses) > 1 and _same(poses[-2], poses[-1]):
            raise InputError(
                f"{where}: point {len(poses)} of the path is the same as the one before; leave it "
                "out"
            )
        if time is not None:
            times.append(_number(row[time], f"{where}: t"))
            if len(times) > 1 and times[-1] <= times[-2]:
                raise InputError(f"{where}: t must increase from line to line, got {times[-1]:g}")
    if len(poses) < 2:
        raise InputError(f"{origin}: a path needs at least two points, found {len(poses)}")
    return Points(tuple(poses), None if time is None else tuple(times), left)


def _same(one: Sequence[float], other: Sequence[float]) -> bool:
    """Whether two points are one; what is left open, NaN, follows from the rest."""
    return all(a != a or abs(a - b) < SAME for a, b in zip(one, other, strict=True))


def _column(header: Sequence[str], axis: Coordinate) -> int | None:
    for name in (axis.key, tables.key(axis)):
        if name.lower() in header:
            return header.index(name.lower())
    return None


def _number(text: str, name: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise InputError(f"{name} must be a number, got {text.strip()[:20]!r}") from None
    if not isfinite(value):
        raise InputError(f"{name} must be a finite number, got {text.strip()[:20]}")
    return value


# --- out -----------------------------------------------------------------------------------


def columns_of(
    found: Trajectory, axes: Sequence[Coordinate], joints: Sequence[Coordinate]
) -> dict[str, list[float]]:
    """The samples by column: time, pose, joints, their rates and accelerations, forces, and how
    near a singularity is. NaN and infinity stay.
    """
    columns: dict[str, list[float]] = {"t": found.times.tolist()}
    for n, axis in enumerate(axes):
        columns[tables.key(axis)] = _outer(found.poses[:, n].tolist(), axis)
    for n, joint in enumerate(joints):
        columns[tables.key(joint)] = _outer(found.joints[:, n].tolist(), joint)
    for what, values in (
        ("per_s", found.joint_rates),
        ("per_s2", found.joint_accelerations),
    ):
        for n, joint in enumerate(joints):
            columns[f"{tables.key(joint)}_{what}"] = _outer(values[:, n].tolist(), joint)
    for n, key in enumerate(force_keys(found.names, joints)):
        columns[key] = found.forces[:, n].tolist()
    columns["within_stroke"] = [float(ok) for ok in found.reachable.tolist()]
    columns["determinant"] = found.determinant.tolist()
    columns["conditioning"] = found.conditioning.tolist()
    columns["singularity_mm"] = found.distance.tolist()
    return columns


def force_keys(names: Sequence[WrenchName], joints: Sequence[Coordinate]) -> list[str]:
    """What the columns of forces are called: "force_actuation1_Nmm", "force_constraint3"."""
    turning = {joint.limb: joint.unit == "rad" for joint in joints}
    keys = []
    for name in names:
        unit = "_Nmm" if turning.get(name.limb, False) else "_N"
        unit = unit if name.kind == "actuation" else ""
        keys.append(f"force_{name.kind}{name.limb or ''}{unit}")
    return keys


def trajectory_csv(
    found: Trajectory, axes: Sequence[Coordinate], joints: Sequence[Coordinate]
) -> str:
    """One row a sample; empty where there is no number, "inf" where there is no singularity."""
    columns = columns_of(found, axes, joints)
    written = io.StringIO()
    rows = csv.writer(written, lineterminator="\n")
    rows.writerow(columns)
    for row in zip(*columns.values(), strict=True):
        rows.writerow(["" if value != value else _plain(value) for value in row])
    return written.getvalue()


def _plain(value: float) -> float | int:
    return int(value) if isfinite(value) and value == int(value) and abs(value) < 1e15 else value


def _outer(values: Sequence[float], axis: Coordinate) -> list[float]:
    return [degrees(v) if axis.unit == "rad" else float(v) for v in values]
