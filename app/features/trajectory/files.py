"""Trajectories as files: points in from CSV, samples out to CSV, in people's units. Pure functions.

Lengths mm, angles degrees, times s; forces N, torques N·mm.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees, isfinite, nan, radians

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
    """The points of a path, as spreadsheets and programs write them.

    A header names the columns: each pose coordinate by its key or symbol, and the time by t or
    time, if there is one. A unit may stand behind a name, as in "x_mm", "x [in]" or "phi (rad)";
    without one lengths are mm, angles degrees, times s. Other columns are not read, so that what
    `trajectory_csv` writes can be read again. Columns are parted by semicolons, tabs or commas;
    where it is not commas, numbers may have decimal commas. Empty lines, lines that begin with #
    and a first line "sep=;" are passed over. One of the coordinates ``dependent`` (indices) may be
    left out, to follow from the others.

    Raises:
        InputError: naming the origin, the line and what is wrong.
    """
    if len(text) > LARGEST:
        raise InputError(f"{origin}: longer than 16 MB, which no path is")
    lines = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    part = ""
    if lines[0].strip().lower().startswith("sep=") and len(lines[0].strip()) == 5:
        part, lines[0] = lines[0].strip()[4], ""
    kept = [n for n, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")]
    first = lines[kept[0]] if kept else ""
    part = part or next((sign for sign in ";\t," if sign in first), ",")
    header = [
        _heading(name) for name in _cells(first, part, f"{origin}, line {(kept or [0])[0] + 1}")
    ]
    found = [_column(header, axis, origin) for axis in axes]
    missing = [n for n, column in enumerate(found) if column is None]
    left = missing[0] if len(missing) == 1 and missing[0] in dependent else None
    if missing and left is None:
        wanted = ",".join(axis.json_key for axis in axes)
        raise InputError(
            f"{origin}: the first line must name a column {axes[missing[0]].json_key}; write "
            f"{wanted}, with a column t (s) if the points have times"
        )
    time = _named(header, TIMES, SECONDS, "s", origin)
    poses, times = [], []
    for n in kept[1:]:
        where = f"{origin}, line {n + 1}"
        row = _cells(lines[n], part, where)
        while len(row) > len(header) and not row[-1].strip():
            row.pop()
        if len(row) > len(header):
            raise InputError(
                f"{where}: {len(header)} columns are named, found {len(row)}; if these are decimal "
                "commas, part the columns by semicolons"
            )
        if len(row) < len(header):
            raise InputError(f"{where}: {len(header)} columns are named, found {len(row)}")
        poses.append(
            tuple(
                nan if at is None else at.value(row, f"{where}: {axis.key}", part)
                for at, axis in zip(found, axes, strict=True)
            )
        )
        if time is None and len(poses) > 1 and _same(poses[-2], poses[-1]):
            raise InputError(
                f"{where}: point {len(poses)} of the path is the same as the one before; leave it "
                "out"
            )
        if time is not None:
            times.append(time.value(row, f"{where}: t", part))
            if len(times) > 1 and times[-1] <= times[-2]:
                raise InputError(f"{where}: t must increase from line to line, got {times[-1]:g}")
    if len(poses) < 2:
        raise InputError(f"{origin}: a path needs at least two points, found {len(poses)}")
    return Points(tuple(poses), None if time is None else tuple(times), left)


MOST = 1e9
"""No length (mm), angle (degrees) or time (s) of a path is larger."""
TIMES = ("t", "time")
SECONDS = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0}
LENGTHS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "inch": 25.4}
ANGLES = {"deg": radians(1.0), "°": radians(1.0), "degrees": radians(1.0), "rad": 1.0}
_UNIT = re.compile(r"(.*?)(?:_|\s*[\[(/])\s*([a-z°]+)\s*[\])]?")


@dataclass(frozen=True, slots=True)
class _Column:
    """A column that is read: which, and what its numbers are to be multiplied by."""

    index: int
    factor: float

    def value(self, row: Sequence[str], name: str, part: str) -> float:
        text = row[self.index].strip().replace("\u2212", "-").replace("\u00a0", "")
        given = text.replace(",", ".") if part != "," and text.count(",") == 1 else text
        try:
            value = float(given)
        except ValueError:
            raise InputError(f"{name} must be a number, got {text[:20]!r}") from None
        if not isfinite(value):
            raise InputError(f"{name} must be a finite number, got {text[:20]}")
        if abs(value) > MOST:
            raise InputError(f"{name} must lie within ±{MOST:.0e}, got {text[:20]}")
        return value * self.factor


def _cells(line: str, part: str, where: str) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=part), [])
    except csv.Error as error:
        raise InputError(f"{where}: not a line of cells ({error})") from None


def _heading(text: str) -> tuple[str, str]:
    """A column's name and its unit, "" where it has none."""
    name = text.strip().lower()
    parted = _UNIT.fullmatch(name)
    return (parted[1].strip(), parted[2]) if parted else (name, "")


def _column(header: Sequence[tuple[str, str]], axis: Coordinate, origin: str) -> _Column | None:
    known = LENGTHS if axis.unit == "mm" else ANGLES
    usual = "mm" if axis.unit == "mm" else "deg"
    return _named(header, (axis.key.lower(), axis.symbol.lower()), known, usual, origin)


def _named(
    header: Sequence[tuple[str, str]],
    names: Sequence[str],
    known: Mapping[str, float],
    usual: str,
    origin: str,
) -> _Column | None:
    """The column of one of these names, in one of the known units.

    A name that goes on behind an underscore is another column's, as "rho1_per_s", unless what is
    behind it is a unit.
    """
    for index, (name, unit) in enumerate(header):
        if name in names:
            if (unit or usual) in known:
                return _Column(index, known[unit or usual])
            raise InputError(
                f"{origin}: the column {name} is in {unit!r}; write {', '.join(known)}"
            )
    return None


def _same(one: Sequence[float], other: Sequence[float]) -> bool:
    """Whether two points are one; what is left open, NaN, follows from the rest."""
    return all(a != a or abs(a - b) < SAME for a, b in zip(one, other, strict=True))


# --- out -----------------------------------------------------------------------------------


def columns_of(
    found: Trajectory, axes: Sequence[Coordinate], joints: Sequence[Coordinate]
) -> dict[str, list[float]]:
    """The samples by column: time, pose, joints, their rates and accelerations, forces, and how
    near a singularity is. NaN and infinity stay.
    """
    columns: dict[str, list[float]] = {"t": found.times.tolist()}
    for n, axis in enumerate(axes):
        columns[axis.json_key] = _outer(found.poses[:, n].tolist(), axis)
    for n, joint in enumerate(joints):
        columns[joint.json_key] = _outer(found.joints[:, n].tolist(), joint)
    for what, values in (
        ("per_s", found.joint_rates),
        ("per_s2", found.joint_accelerations),
    ):
        for n, joint in enumerate(joints):
            columns[f"{joint.json_key}_{what}"] = _outer(values[:, n].tolist(), joint)
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
