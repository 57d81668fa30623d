"""Points of a path as spreadsheets and programs write them, and the path through points."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, nan, radians
from pathlib import Path as File

from numpy.typing import ArrayLike

from kinematics.answers.coordinates import Coordinate
from kinematics.answers.trajectories import Path, TimeLaw
from kinematics.errors import InputError
from kinematics.lengths import UNITS, in_mm, unit_of
from kinematics.storage import read_text
from kinematics.trajectories.laws import law
from kinematics.trajectories.paths import SAME, polyline, spline

PACE = 100.0
"""mm/s, of a path that takes no time of its own."""
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
    without one lengths are in the unit that a line before the header names, as ``units = "cm"`` or
    ``# units: inch``, or mm; angles are degrees, times s. Other columns are not read, so that what
    Bohemia writes can be read again. Columns are parted by semicolons, tabs or commas;
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
    usual = _said_unit(lines, origin)
    kept = [n for n, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")]
    first = lines[kept[0]] if kept else ""
    part = part or next((sign for sign in ";\t," if sign in first), ",")
    header = [
        _heading(name) for name in _cells(first, part, f"{origin}, line {(kept or [0])[0] + 1}")
    ]
    found = [_column(header, axis, usual, origin) for axis in axes]
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
            if len(times) > 1 and not times[-1] - times[-2] >= SHORTEST:
                less = f"{times[-1]:g}" + (", too little later" if times[-1] > times[-2] else "")
                raise InputError(f"{where}: t must increase from line to line, got {less}")
    if len(poses) < 2:
        raise InputError(f"{origin}: a path needs at least two points, found {len(poses)}")
    return Points(tuple(poses), None if time is None else tuple(times), left)


SHORTEST = 1e-9
"""s between two points of a path with times."""
MOST = 1e9
"""No length (mm), angle (degrees) or time (s) of a path is larger."""
TIMES = ("t", "time")
SECONDS = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0}
LENGTHS = {unit: in_mm(1.0, unit) for unit in UNITS} | {"in": 25.4}
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


_SAID = re.compile(r"#?\s*units?\s*[=:]\s*[\"']?([^\s\"',;#]*)", re.IGNORECASE)


def _said_unit(lines: list[str], origin: str) -> str:
    """The unit of lengths that a line before the header names, which is left out then; or mm.

    Raises:
        InputError: there is no such unit.
    """
    for n, line in enumerate(lines):
        said = _SAID.match(line.strip())
        if said is None:
            if line.strip() and not line.lstrip().startswith("#"):
                return "mm"
            continue
        unit = unit_of(said[1])
        if not unit:
            raise InputError(
                f"{origin}, line {n + 1}: units must be one of {', '.join(UNITS)}, got "
                f"{said[1][:20]!r}"
            )
        lines[n] = ""
        return unit
    return "mm"


def _column(
    header: Sequence[tuple[str, str]], axis: Coordinate, length: str, origin: str
) -> _Column | None:
    known = LENGTHS if axis.unit == "mm" else ANGLES
    usual = length if axis.unit == "mm" else "deg"
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


def read_file(
    path: File | str, axes: Sequence[Coordinate], *, dependent: Sequence[int] = ()
) -> Points:
    """The points that a file holds, see `read_points`.

    Raises:
        InputError: it cannot be read, is too long, or says no path.
    """
    text = read_text(path, LARGEST, "a list of points")
    return read_points(text, axes, origin=str(path), dependent=dependent)


def through(
    points: ArrayLike,
    scale: Sequence[float],
    times: Sequence[float] = (),
    *,
    straight: bool = False,
    blend: float = 0.0,
) -> tuple[Path, TimeLaw]:
    """The path through points (N, P), and its own time law.

    Args:
        scale: what each coordinate counts for in the path's length.
        times: (N,) s, when each is passed; none: rest to rest at `PACE` or slower.
        straight: along straight lines, and not a spline.
        blend: mm from which on corners between straight lines are rounded.

    Raises:
        InputError: the points make no path, see `polyline` and `spline`.
    """
    if len(times):
        path = spline(points, scale, times, corners=straight)
        return path, law("linear", times[-1] - times[0])
    path = polyline(points, scale, blend) if straight else spline(points, scale)
    return path, law("quintic", max(1.0, path.length / PACE))
