"""What the design files of a kind of mechanism say: keys with their units, labels and checks.

Reading, checking, writing and the numbers that may be edited all follow from one description.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Literal

from kinematics.designs.files import (
    MAX_MAGNITUDE,
    KeyPath,
    TableError,
    change_table,
    check_keys,
    path_text,
    read_number,
    read_numbers,
    read_tables,
    read_text,
)
from kinematics.lengths import UNITS as LENGTHS
from kinematics.lengths import in_mm, unit_of
from kinematics.mechanism import D, DesignField

Check = Callable[[str, Any], str]
"""The problem with a value, "" if there is none; the first argument is what the value is called."""

ABOUT = ("title", "source")
"""What every design file may say besides."""
UNITS = "units"
"""And in which unit its lengths are; mm if it does not."""
SHORTEST = 1e-9
"""mm; below a picometre a length is a slip of the pen."""


class Limited:
    """A check that is a sentence to people and, in part, a limit to JSON Schema.

    Args:
        check: the sentence.
        limit: what JSON Schema says of each number.
    """

    def __init__(self, check: Check, **limit: float) -> None:
        self.check, self.limit = check, limit

    def __call__(self, what: str, value: Any) -> str:
        return self.check(what, value)


def anything(what: str, value: Any) -> str:
    """Every finite number will do."""
    return ""


def _positive(what: str, value: float) -> str:
    if value >= SHORTEST:
        return ""
    return f"{what} must be a positive length (mm, at least {SHORTEST:g}), got {value:g}"


positive = Limited(_positive, exclusiveMinimum=0.0)
"""A length that is one."""


def ordered(low_name: str, high_name: str, least: str) -> Check:
    """The ends of a stroke, as they are called; ``least`` is what must not be negative."""

    def check(what: str, ends: tuple[float, float]) -> str:
        low, high = ends
        if low < 0.0:
            return f"{what}: {least} must not be negative (mm), got {low:g}"
        if low >= high:
            return (
                f"{what} must be [{low_name}, {high_name}] with {low_name} < {high_name} (mm), "
                f"got [{low:g}, {high:g}]"
            )
        return ""

    return Limited(check, minimum=0.0)


@dataclass(frozen=True, slots=True)
class Key:
    """One key of a table: a number, or a list of numbers.

    Attributes:
        name: as it is written, and the attribute of the design or limb.
        labels: what people read beside its numbers; one label: it is a number and no list.
        unit: of the numbers.
        check: what else must hold of them.
        group: under which heading they are edited; of a limb's keys it is the limb.
        what: what messages call the unit, where that is not the unit itself.
    """

    name: str
    labels: tuple[str, ...]
    unit: Literal["mm", "rad", ""] = "mm"
    check: Check = anything
    group: str = ""
    what: str = ""

    def read(self, value: object, *, origin: str, path: KeyPath) -> Any:
        """The number, or the tuple of numbers.

        Raises:
            DesignError: it is not what it should be.
        """
        unit, count = self.what or self.unit, len(self.labels)
        if count == 1:
            found: Any = read_number(value, origin=origin, path=path, unit=unit)
        else:
            found = read_numbers(value, count, origin=origin, path=path, unit=unit)
        problem = self.check(path_text(path, end=""), found)
        if problem:
            raise TableError(origin, path, problem)
        return found

    def json_schema(self) -> dict[str, Any]:
        """What `read` takes, as far as JSON Schema can say it."""
        number = number_schema(self.unit, **getattr(self.check, "limit", {}))
        return number if len(self.labels) == 1 else list_schema(number, len(self.labels))

    def fields(self, value: Any, path: KeyPath, group: str) -> list[DesignField]:
        """Its numbers, which stand at a path of the design's table."""
        if len(self.labels) == 1:
            return [DesignField(path, self.labels[0], value, self.unit, group)]
        return [
            DesignField((*path, n), label, one, self.unit, group)
            for n, (label, one) in enumerate(zip(self.labels, value, strict=True))
        ]


def point(name: str) -> Key:
    """A point, by its coordinates in mm."""
    return Key(name, tuple(f"{name} {axis}" for axis in "xyz"))


class Schema(Generic[D]):
    """The design files of a kind; what it has of its own, it adds in a subclass.

    Args:
        make: makes the design; its arguments are named as the keys are, and "limbs".
        keys: of the table itself.
        limb: makes a limb, likewise; None where limbs have no tables.
        limb_keys: of each table [[limb]].
        limbs: how many limbs there are.
        headings: under which the limbs' numbers are edited; "Limb 1" … if not given.
    """

    def __init__(
        self,
        make: Callable[..., D],
        keys: Sequence[Key] = (),
        *,
        limb: Callable[..., Any] | None = None,
        limb_keys: Sequence[Key] = (),
        limbs: int = 0,
        headings: Sequence[str] = (),
    ) -> None:
        self.make, self.keys = make, tuple(keys)
        self.limb, self.limb_keys, self.limbs = limb, tuple(limb_keys), limbs
        self.headings = tuple(headings) or tuple(f"Limb {i + 1}" for i in range(limbs))

    optional: tuple[str, ...] = ()
    """Further keys, which a subclass reads in `further` and writes in `table`."""

    def further(self, table: Mapping[str, Any], *, origin: str) -> dict[str, Any]:
        """What the subclass's own keys say, as arguments of the design."""
        return {}

    def read(self, table: Mapping[str, Any], *, origin: str, name: str) -> D:
        """The design that a parsed design file describes.

        Raises:
            DesignError: naming the origin, the limb, the key and the remedy.
        """
        unit = _unit(table, origin)
        try:
            return self._read(self._in_mm(table, unit), origin=origin, name=name)
        except TableError as error:
            if unit == "mm" or "mm" not in error.problem:
                raise
            told = f"{error.problem}; the file's lengths are in {unit}, told here in mm"
            raise TableError(origin, error.path, told) from None

    def _in_mm(self, table: Mapping[str, Any], unit: str) -> Mapping[str, Any]:
        """The same with all lengths in mm; what is wrong with it stays."""
        if unit == "mm":
            return table

        def scaled(entry: object, keys: Sequence[Key]) -> Any:
            if not isinstance(entry, Mapping):
                return entry
            lengths = {key.name for key in keys if key.unit == "mm"}
            return {k: _scaled(v, unit) if k in lengths else v for k, v in entry.items()}

        table = scaled(table, self.keys)
        limbs = table.get("limb")
        if isinstance(limbs, list | tuple):
            return {**table, "limb": [scaled(limb, self.limb_keys) for limb in limbs]}
        return table

    def _read(self, table: Mapping[str, Any], *, origin: str, name: str) -> D:
        names = ["mechanism", *(key.name for key in self.keys), *(["limb"] if self.limb else [])]
        optional = (*ABOUT, UNITS, *self.optional)
        check_keys(table, required=names, optional=optional, origin=origin)
        values = {k.name: k.read(table[k.name], origin=origin, path=(k.name,)) for k in self.keys}
        if self.limb is not None:
            entries = read_tables(table, "limb", self.limbs, origin=origin)
            values["limbs"] = tuple(
                self.limb(**self._limb(entry, origin=origin, path=("limb", i)))
                for i, entry in enumerate(entries)
            )
        about = {key: read_text(table, key, origin=origin) for key in ABOUT}
        return self.make(**values, **self.further(table, origin=origin), name=name, **about)

    def _limb(self, entry: object, *, origin: str, path: KeyPath) -> dict[str, Any]:
        names = [key.name for key in self.limb_keys]
        table = check_keys(entry, required=names, origin=origin, path=path)
        return {
            key.name: key.read(table[key.name], origin=origin, path=(*path, key.name))
            for key in self.limb_keys
        }

    def json_schema(self, kind: str) -> dict[str, Any]:
        """What `read` takes of a kind's files, as far as JSON Schema can say it."""
        known = {key.name: key.json_schema() for key in self.keys}
        if self.limb is not None:
            limb = table_schema({key.name: key.json_schema() for key in self.limb_keys})
            known["limb"] = list_schema(limb, self.limbs)
        return file_schema(kind, known, self.optional_schemas())

    def optional_schemas(self) -> dict[str, Any]:
        """Of the keys in `optional`."""
        return {}

    def table(self, design: D) -> dict[str, Any]:
        """What the design's file says, as plain values; `read` reads it back equal."""
        table: dict[str, Any] = {key: getattr(design, key) for key in ("mechanism", *ABOUT)}
        table |= {key.name: _plain(getattr(design, key.name)) for key in self.keys}
        if self.limb is not None:
            table["limb"] = [
                {key.name: _plain(getattr(limb, key.name)) for key in self.limb_keys}
                for limb in self._limbs(design)
            ]
        return table

    def fields(self, design: D) -> tuple[DesignField, ...]:
        """Every number of the design that may be edited; paths lead into `table`."""
        fields: list[DesignField] = []
        for i, limb in enumerate(self._limbs(design)):
            for key in self.limb_keys:
                path = ("limb", i, key.name)
                fields += key.fields(getattr(limb, key.name), path, self.headings[i])
        for key in self.keys:
            fields += key.fields(getattr(design, key.name), (key.name,), key.group)
        return tuple(fields)

    def changed(self, design: D, path: Sequence[str | int], value: float) -> D:
        """The design with one number (a `DesignField.path`) changed and all checked again.

        Raises:
            InputError: the design has no such number.
            DesignError: the design would not be valid with it.
        """
        table = change_table(self.table(design), self.fields(design), path, value)
        return self.read(table, origin="", name=design.name)

    def _limbs(self, design: D) -> Sequence[Any]:
        limbs: Sequence[Any] = getattr(design, "limbs", ()) if self.limb_keys else ()
        return limbs


# --- JSON Schema ---------------------------------------------------------------------------


def number_schema(unit: str, **limit: float) -> dict[str, Any]:
    """A number; no unit of lengths is shorter than mm, so that their limit holds in all of them."""
    most = {"minimum": -MAX_MAGNITUDE, "maximum": MAX_MAGNITUDE}
    if "exclusiveMinimum" in limit:
        del most["minimum"]
    said = {"mm": "length", "rad": "degrees"}.get(unit)
    return {"type": "number", **most, **limit} | ({"description": said} if said else {})


def list_schema(each: Mapping[str, Any], least: int, most: int | None = None) -> dict[str, Any]:
    """A list of so many; of exactly ``least`` where no ``most`` is said."""
    return {"type": "array", "items": each, "minItems": least, "maxItems": most or least}


def table_schema(
    required: Mapping[str, Any], optional: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """A table with these keys and no others."""
    return {
        "type": "object",
        "properties": {**required, **(optional or {})},
        "required": list(required),
        "additionalProperties": False,
    }


def file_schema(
    kind: str, required: Mapping[str, Any], optional: Mapping[str, Any]
) -> dict[str, Any]:
    """A design file of a kind."""
    about = {key: {"type": "string"} for key in ABOUT} | {UNITS: {"enum": list(LENGTHS)}}
    return table_schema({"mechanism": {"const": kind}, **required}, {**about, **optional})


# --- inside --------------------------------------------------------------------------------


def _unit(table: Mapping[str, Any], origin: str) -> str:
    """The unit of a table's lengths.

    Raises:
        TableError: there is no such unit.
    """
    given = table.get(UNITS, "mm")
    unit = unit_of(given)
    if not unit:
        known = ", ".join(map(repr, LENGTHS))
        shown = repr(given[:40]) if isinstance(given, str) else "something else"
        raise TableError(origin, (UNITS,), f"{UNITS} must be one of {known}, got {shown}")
    return unit


def _scaled(value: object, unit: str) -> Any:
    """Numbers of a unit in mm, in lists too; what is no number stays."""
    if isinstance(value, list | tuple):
        return [_scaled(one, unit) for one in value]
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    return in_mm(value, unit)


def _plain(value: Any) -> Any:
    return [float(v) for v in value] if isinstance(value, Iterable) else value
