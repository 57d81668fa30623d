"""Read, check and write design files (TOML), whatever the mechanism.

A design file says `mechanism = "…"`; everything else in it is the mechanism's own matter, see
`kinematics.mechanism.Mechanism.read_design`. The small checks that every mechanism needs (known
keys, finite numbers, counts) are here too, so that all messages read alike.
"""

from __future__ import annotations

import difflib
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NoReturn, cast

from kinematics import storage
from kinematics.designs.assets import asset_folder
from kinematics.errors import DesignError, InputError
from kinematics.mechanism import Design, DesignField, mechanism_class, mechanism_kinds

KeyPath = tuple[str | int, ...]

MAX_BYTES = 256 * 1024
"""A larger text is refused unread: a design is a few hundred bytes."""
MAX_MAGNITUDE = 1e6
"""No coordinate or length of a design exceeds a kilometre, in mm."""
DEEPEST = 12
"""No design nests tables, lists or dotted keys deeper."""
_LOCATED_BYTES = 32 * 1024  # a parse a line takes long in a long text
_LOCATED_LINES = 400  # looking a line up costs a parse a line; a design has some forty


@dataclass(frozen=True, slots=True)
class PresetInfo:
    """A design that comes with Bohemia."""

    name: str
    mechanism: str
    title: str
    source: str


class TableError(DesignError):
    """A value at ``path`` of a design table is wrong; `read_design` adds the line to it."""

    def __init__(self, origin: str, path: KeyPath, problem: str) -> None:
        self.origin = origin
        self.path = path
        self.problem = problem
        super().__init__(_sentence(origin, None, problem))


# --- reading and writing -------------------------------------------------------------------


def load_design(name_or_path: str | Path) -> Design:
    """The preset of this name, or the design in this file.

    Raises:
        DesignError: there is neither, it cannot be read, or it is broken.
    """
    text = str(name_or_path)
    if text in _preset_paths():
        return _preset(text)
    path = Path(name_or_path)
    if not text.strip() or not storage.exists(path):
        near = difflib.get_close_matches(text, _preset_paths(), n=3, cutoff=0.5)
        hint = f"did you mean {' or '.join(near)}?" if near else "the presets are "
        hint = hint if near else hint + ", ".join(_preset_paths())
        raise DesignError(f"there is no preset and no file {text!r}; {hint}")
    return _read_file(path)


def read_design(text: str, *, origin: str, name: str = "") -> Design:
    """The design written in ``text`` (TOML).

    Args:
        text: at most 256 kB.
        origin: what messages call it: the file's name as the user knows it.
        name: the design's short name; usually the file's stem.

    Raises:
        DesignError: with one sentence that names the origin, the line, the key and the remedy.
    """
    if len(text) > MAX_BYTES or len(text.encode("utf-8", "replace")) > MAX_BYTES:
        raise DesignError(f"{origin}: longer than 256 kB, which no design file is; choose another")
    text = text.removeprefix("\ufeff")  # some editors write a byte order mark
    if _is_deep(text):
        raise DesignError(f"{origin}: nested too deeply to be a design file")
    try:
        table = tomllib.loads(text)
    except ValueError as error:
        raise DesignError(_syntax_sentence(origin, str(error))) from None
    try:
        return _from_table(table, origin=origin, name=name)
    except TableError as error:
        line = _line_of(text, error.path)
        raise DesignError(_sentence(origin, line, error.problem)) from None


def write_design(design: Design) -> str:
    """The design as TOML text, which reads back equal (the name stands outside: the file's).

    Lengths are in mm, whatever unit they were read in, and the file says so.
    """
    table = mechanism_class(design.mechanism)(design).design_table()
    plain = [(k, v) for k, v in table.items() if not _is_table_array(v) and not _is_table(v)]
    blocks = ["\n".join(f"{_key(k)} = {_value(v)}" for k, v in plain)]
    blocks[0] = blocks[0].replace("\n", "  # lengths in mm, angles in degrees\n", 1)
    for key, value in table.items():
        if _is_table(value):
            lines = [f"{_key(k)} = {_value(v)}" for k, v in value.items()]
            blocks.append("\n".join([f"[{_key(key)}]", *lines]))
        if _is_table_array(value):
            for entry in value:
                lines = [f"{_key(k)} = {_value(v)}" for k, v in entry.items()]
                blocks.append("\n".join([f"[[{_key(key)}]]", *lines]))
    return "\n\n".join(blocks) + "\n"


@cache
def presets() -> tuple[PresetInfo, ...]:
    """The designs that come with Bohemia, by name."""
    found = ((name, _preset(name)) for name in _preset_paths())
    return tuple(PresetInfo(n, d.mechanism, d.title, d.source) for n, d in found)


# --- checks for a mechanism's own part of the table ----------------------------------------


def check_keys(
    table: object,
    *,
    required: Sequence[str],
    optional: Sequence[str] = (),
    origin: str,
    path: KeyPath = (),
) -> Mapping[str, Any]:
    """``table`` itself, if it is a table with all required and no unknown keys.

    Raises:
        TableError: naming the key, and the one that was probably meant.
    """
    if not isinstance(table, Mapping):
        kind = path[0] if path else "the design"
        _fail(origin, path, f"{path_text(path)}must be a table, written as [[{kind}]]")
    known = (*required, *optional)
    for key in table:
        if key not in known:
            near = difflib.get_close_matches(key, known, n=1, cutoff=0.6)
            remedy = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(known)}"
            _fail(origin, (*path, key), f"{path_text(path)}unknown key {key!r}; {remedy}")
    for key in required:
        if key not in table:
            _fail(origin, path, f"{path_text(path)}the key {key!r} is missing; add it")
    return table


def read_text(table: Mapping[str, Any], key: str, *, origin: str) -> str:
    """An optional piece of text, "" where there is none."""
    value = table.get(key, "")
    if not isinstance(value, str):
        _fail(origin, (key,), f"{key} must be text in quotes, got {_shown(value)}")
    return value


def read_number(value: object, *, origin: str, path: KeyPath, unit: str = "mm") -> float:
    """A finite number of at most `MAX_MAGNITUDE`; a truth value is not a number."""
    what = path_text(path, end="")
    if isinstance(value, bool) or not isinstance(value, int | float):
        _fail(origin, path, f"{what} must be a number ({unit}), got {_shown(value)}")
    if not (abs(value) <= MAX_MAGNITUDE):
        if isinstance(value, float) and not math.isfinite(value):
            _fail(origin, path, f"{what} must be a finite number ({unit}), got {value}")
        limit = f"±{MAX_MAGNITUDE:.0f}{' mm' if unit == 'mm' else ''}"
        _fail(origin, path, f"{what} must lie within {limit}; check its unit")
    return float(value)


def read_numbers(
    value: object,
    count: int,
    *,
    origin: str,
    path: KeyPath,
    unit: str = "mm",
    point: bool = False,
) -> tuple[float, ...]:
    """Exactly ``count`` finite numbers; ``point``: the coordinates of one, or of a direction."""
    what = path_text(path, end="")
    if point and isinstance(path[-1], int) and len(path) > 2:  # one of a list of points
        noun = "point" if unit == "mm" else "direction"
        what = f"{path_text(path[:-2])}{noun} {path[-1] + 1} of {path[-2]}"
    if not isinstance(value, list | tuple):
        _fail(
            origin, path, f"{what} must be a list of {count} numbers ({unit}), got {_shown(value)}"
        )
    if len(value) != count:
        named = ("x, y, z in mm" if unit == "mm" else "x, y, z") if point else unit
        _fail(origin, path, f"{what} must have {count} numbers ({named}), got {len(value)}")
    return tuple(
        read_number(v, origin=origin, path=(*path, i), unit=unit) for i, v in enumerate(value)
    )


def read_tables(
    table: Mapping[str, Any], key: str, count: int, *, origin: str
) -> Sequence[Mapping[str, Any]]:
    """Exactly ``count`` tables ``[[key]]``."""
    value = table[key]
    if not isinstance(value, list | tuple):
        _fail(origin, (key,), f"{key} must be {count} tables, each written as [[{key}]]")
    if len(value) != count:
        extra = (key, count) if len(value) > count else (key, len(value) - 1) if value else (key,)
        _fail(origin, extra, f"{count} tables [[{key}]] are needed, found {len(value)}")
    return value


def change_table(
    table: dict[str, Any], fields: Sequence[DesignField], path: Sequence[str | int], value: float
) -> dict[str, Any]:
    """``table`` with the number at ``path``, which must be one of the fields, replaced everywhere.

    Raises:
        InputError: there is no such field.
    """
    field = next((field for field in fields if field.path == tuple(path)), None)
    if field is None:
        raise InputError(_no_field(fields, path))
    changed = deepcopy(table)
    for *way, last in (field.path, *field.also):
        place: Any = changed
        for step in way:
            place = place[step]
        place[last] = value
    return changed


def _no_field(fields: Sequence[DesignField], path: Sequence[str | int]) -> str:
    """That there is no number at ``path``, and what there is from where it goes astray."""
    known = [tuple(map(str, field.path)) for field in fields]
    typed = tuple(map(str, path))
    kept = 0
    while any(one[: kept + 1] == typed[: kept + 1] for one in known) and kept < len(typed):
        kept += 1
    begun = typed[:kept]
    steps = list(dict.fromkeys(o[kept] for o in known if o[:kept] == begun and len(o) > kept))
    where = f"{'.'.join(begun)} has" if begun else "there are"
    end = f"{where} {', '.join(steps)}" if steps else f"{'.'.join(begun)} is a number itself"
    return f"the design has no number {'.'.join(typed)!r}; {end}"


def _fail(origin: str, path: KeyPath, problem: str) -> NoReturn:
    raise TableError(origin, path, problem)


# --- inside --------------------------------------------------------------------------------


def _from_table(table: Mapping[str, Any], *, origin: str, name: str) -> Design:
    kinds = mechanism_kinds()
    if "mechanism" not in table:
        near = difflib.get_close_matches("mechanism", table, n=1, cutoff=0.6)
        remedy = f"did you mean it by {near[0]!r}?" if near else f"known are {', '.join(kinds)}"
        _fail(origin, (near[0],) if near else (), f"the key 'mechanism' is missing; {remedy}")
    kind = table["mechanism"]
    if kind not in kinds:
        near = difflib.get_close_matches(str(kind), kinds, n=1, cutoff=0.6)
        remedy = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(kinds)}"
        _fail(origin, ("mechanism",), f"there is no mechanism {_shown(kind)}; {remedy}")
    design: Design = mechanism_class(kind).read_design(table, origin=origin, name=name)
    return design


def _read_file(path: Path) -> Design:
    try:
        text = storage.read_text(path, MAX_BYTES, "a design file")
    except InputError as error:
        raise DesignError(str(error)) from None
    return read_design(text, origin=str(path), name=path.stem)


_QUOTED = re.compile(
    r""""{3}(?:\\.|[^\\])*?"{3}|\'{3}.*?\'{3}"""
    r"""|"(?:\\.|[^"\\\n])*+"|\'[^\'\n]*+\'|\#[^\n]*+""",
    re.DOTALL,
)


def _is_deep(text: str) -> bool:
    """Whether keys or brackets are nested deeper than any design's: the parser takes long then."""
    bare = _QUOTED.sub("_", text)
    depth = deepest = 0
    for sign in re.findall(r"[\[{}\]]", bare):
        depth = depth + 1 if sign in "[{" else max(depth - 1, 0)
        deepest = max(deepest, depth)
    return deepest > DEEPEST or any(
        part.count(".") > DEEPEST for part in re.split(r"[=,{}\[\]\n]", bare)
    )


@cache
def _preset(name: str) -> Design:
    return _read_file(_preset_paths()[name])


@cache
def _preset_paths() -> dict[str, Path]:
    return {path.stem: path for path in sorted(asset_folder("designs").glob("*.toml"))}


def path_text(path: Sequence[str | int], end: str = ": ") -> str:
    """("limb", 2, "base", 1) → "limb 3: base: number 2"; tables in a row are counted from 1."""
    parts: list[str] = []
    for index, step in enumerate(path):
        if isinstance(step, str):
            parts.append(step)
        elif index == 1:
            parts[-1] += f" {step + 1}"
        else:
            parts.append(f"number {step + 1}")
    return ": ".join(parts) + end if parts else ""


def _sentence(origin: str, line: int | None, problem: str) -> str:
    where = origin if line is None else f"{origin}, line {line}"
    return f"{where}: {problem}" if origin else problem


def _syntax_sentence(origin: str, message: str) -> str:
    place = re.search(r"\s*\(at (?:line (\d+), column (\d+)|end of document)\)$", message)
    problem = message[: place.start()] if place else message
    problem = problem[:1].lower() + problem[1:]
    line = int(place[1]) if place and place[1] else None
    column = f" at column {place[2]}" if place and place[2] else ""
    end = " at the end of the file" if place and not place[1] else ""
    return _sentence(origin, line, f"not valid TOML: {problem}{column}{end}; correct it there")


def _line_of(text: str, path: KeyPath) -> int | None:
    """The line on which the value at ``path`` begins, found by parsing ever longer beginnings."""
    while path and isinstance(path[-1], int) and len(path) != 2:
        path = path[:-1]  # a number within a list stands on the list's line
    lines = text.splitlines(keepends=True)
    if not path or len(lines) > _LOCATED_LINES or len(text) > _LOCATED_BYTES:
        return None
    start = 1
    for count in range(1, len(lines) + 1):
        try:
            table = tomllib.loads("".join(lines[:count]))
        except ValueError:
            continue  # within a value that goes on on the next line
        if _has(table, path):
            return start
        start = count + 1
    return None


def _has(table: Any, path: KeyPath) -> bool:
    for step in path:
        try:
            table = table[step]
        except (KeyError, IndexError, TypeError):
            return False
    return True


def _shown(value: object) -> str:
    """A value as it may be quoted in a sentence."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return repr(value if len(value) <= 40 else value[:40] + "…")
    if isinstance(value, int | float):
        return str(value)[:40] if abs(value) < 1e30 else "a huge number"
    if isinstance(value, Mapping):
        return "a table"
    return "a list" if isinstance(value, list | tuple) else "something else"


def _is_table(value: object) -> bool:
    return isinstance(value, Mapping)


def _is_table_array(value: object) -> bool:
    return isinstance(value, list | tuple) and bool(value) and isinstance(value[0], Mapping)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _value(key)


def _value(value: object) -> str:
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return '"' + re.sub(r"[\x00-\x1f\x7f]", lambda m: f"\\u{ord(m[0]):04x}", escaped) + '"'
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float | int):
        return repr(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + " }"
    return "[" + ", ".join(_value(v) for v in cast(Sequence[object], value)) + "]"
