"""Lengths, areas and volumes in the unit that --units names, in what is printed and in tables.

All numbers are computed and told in mm; here they are turned over where they leave.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Collection

from kinematics.lengths import from_mm
from kinematics.storage import csv_text

# Numbers as commands print them: "6 001 738", "1,234.5", "2.4e+07", "−3.5".
_SPACES = "\u00a0\u2009\u202f"
_NUMBER = rf"[-−]?(?:\d{{1,3}}(?:[{_SPACES},]\d{{3}})+(?!\d)|\d+)(?:\.\d+)?(?:e[+-]?\d+)?"
_PAIR = rf"{_NUMBER}(?:(?: ± | × | to | and ){_NUMBER})*"
_PLACE = rf"\({_NUMBER}(?:, {_NUMBER})+\)(?: to \({_NUMBER}(?:, {_NUMBER})+\))?"
_UNIT = r"(?P<unit>mm|cm|dm)(?P<power>[²³]?)(?![\w·²³⁴])"
_SAID = re.compile(rf"(?<![\w.,])(?P<value>{_PLACE}|{_PAIR}) {_UNIT}")
_HEADED = re.compile(r"\((?:mm|cm|dm)[²³]?(?:/s²?)?\)")
_POWER = {"": 1, "²": 2, "³": 3}
_SCALE = {"mm": 1.0, "cm": 10.0, "dm": 100.0}
_COLUMN = re.compile(r"(?P<name>.*)_mm(?P<power>[234]?)(?P<tail>(?:_per_s2?)?)")


def line_in(line: str, unit: str) -> str:
    """A printed line with its lengths, areas and volumes in another unit; tables too."""
    if unit == "mm" or not line:
        return line
    rows = line.split("\n")
    if len(rows) > 1 and _HEADED.search(line):
        return "\n".join(_table(rows, unit))
    return "\n".join(_inline(row, unit) for row in rows)


def _inline(text: str, unit: str) -> str:
    def turned(found: re.Match[str]) -> str:
        power = _POWER[found["power"]]
        scale = _SCALE[found["unit"]] ** power
        value = re.sub(_NUMBER, lambda n: _number(n[0], scale, unit, power), found["value"])
        return f"{value} {unit}{found['power']}"

    return _SAID.sub(turned, text)


def _number(text: str, scale: float, unit: str, power: int) -> str:
    """A number to as many digits as it had, at least six where it was a whole one."""
    bare = re.sub(f"[{_SPACES},]", "", text).replace("−", "-")
    digits = len(re.sub(r"e.*|^[-0.]+|[^\d]", "", bare)) or 1
    value = from_mm(float(bare) * scale, unit, power)
    most = max(digits, 6) if "." not in bare and "e" not in bare else max(digits, 3)
    shown = f"{value:.{most}g}"
    return shown.replace("-", "−") if "−" in text else shown


def _table(rows: list[str], unit: str) -> list[str]:
    """A table whose columns stand apart by two spaces, with units in its header or row names."""
    from app.terminal import tables

    head = next(n for n, row in enumerate(rows) if _HEADED.search(row) or row.startswith("  "))
    last = next((n for n in range(head, len(rows)) if not rows[n].strip()), len(rows))
    starts = [found.start() for found in re.finditer(r"(?:^|(?<=  ))(?=\S)", rows[head])]
    if rows[head].startswith(" "):
        starts = [0, *starts]
    cells = [
        [row[a:b].strip() for a, b in zip(starts, [*starts[1:], None], strict=True)]
        for row in rows[head:last]
    ]
    columns = [""] * len(starts)
    for n, name in enumerate(cells[0]):
        said = _HEADED.search(name)
        columns[n] = said[0] if said else columns[n - 1] if name == "±" and n else ""
    for row in cells[1:]:
        of_row = _HEADED.search(row[0])
        for n, cell in enumerate(row):
            row[n] = _cell(cell, of_row[0] if of_row and n else columns[n], unit)
        row[0] = _renamed(row[0], unit)
    cells[0] = [_renamed(name, unit) for name in cells[0]]
    told = tables.table(tuple(cells[0]), [tuple(row) for row in cells[1:]]).split("\n")
    others = [_inline(row, unit) for row in rows[:head]], [_inline(r, unit) for r in rows[last:]]
    return [*others[0], *told, *others[1]]


def _cell(cell: str, said: str, unit: str) -> str:
    if not said:
        return _inline(cell, unit)
    if not re.fullmatch(_NUMBER, cell):
        return cell
    name = said.strip("()").partition("/")[0]
    power = _POWER[name[2:]]
    return _number(cell, _SCALE[name[:2]] ** power, unit, power)


def _renamed(name: str, unit: str) -> str:
    return _HEADED.sub(lambda said: re.sub(r"mm|cm|dm", unit, said[0]), name)


def csv_in(text: str, unit: str, lengths: Collection[str] = ()) -> str:
    """A table in CSV in another unit: columns whose names end with _mm, _mm2, … and ``lengths``,
    those of columns that are mm and do not say so; they say so then.
    """
    if unit == "mm":
        return text
    header, *rows = csv.reader(io.StringIO(text))
    powers, names = [], []
    for name in header:
        bare = re.sub(r"_per_s2?$", "", name)
        said = _COLUMN.fullmatch(f"{bare}_mm{name[len(bare) :]}" if bare in lengths else name)
        powers.append(0 if said is None else int(said["power"] or 1))
        names.append(
            name if said is None else f"{said['name']}_{unit}{said['power']}{said['tail']}"
        )
    told = (
        [
            cell if not power or not cell else repr(from_mm(float(cell), unit, power))
            for cell, power in zip(row, powers, strict=True)
        ]
        for row in rows
    )
    return csv_text([names, *told])
