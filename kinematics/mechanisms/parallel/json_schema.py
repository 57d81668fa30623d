"""What design files of parallel mechanisms may say, as JSON Schema."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from kinematics.designs.schema import list_schema, number_schema, table_schema
from kinematics.mechanisms.parallel.limb_types import TYPES, LimbKey
from kinematics.mechanisms.parallel.tables import COORDINATES, JOINT_OPTIONAL, JOINTS, MOST_LIMBS

_POINT = list_schema(number_schema("mm"), 3)
_DIRECTION = list_schema(number_schema(""), 3)
_LIMITS: dict[str, dict[str, float]] = {
    "positive": {"exclusiveMinimum": 0.0},
    "ordered": {"minimum": 0.0},
}
_REPEAT = {
    "repeat": {"type": "integer", "minimum": 1, "maximum": MOST_LIMBS},
    "repeat_axis": _DIRECTION,
}


def required_schemas() -> dict[str, Any]:
    """Of the keys that every file has."""
    turned = {"turn": list_schema(number_schema("rad"), 3), "rotation": list_schema(_DIRECTION, 3)}
    platform = table_schema({"position": _POINT}, turned)
    limb = {"type": "array", "items": {"anyOf": [*_types(), _chain()]}}
    return {
        "platform": platform | {"not": {"required": list(turned)}},
        "limb": limb | {"minItems": 1, "maxItems": MOST_LIMBS},
    }


def optional_schemas() -> dict[str, Any]:
    """Of those that a file may have."""
    names = {"type": "array", "items": {"enum": list(COORDINATES)}, "uniqueItems": True}
    return {"plane": _DIRECTION, "coordinates": names}


def _types() -> Iterator[dict[str, Any]]:
    for kind in TYPES.values():
        needed = {key.name: _key(key) for key in kind.keys if key.needed}
        rest = {key.name: _key(key) for key in kind.keys if not key.needed}
        yield table_schema({"type": {"const": kind.name}, **needed}, {**rest, **_REPEAT})


def _key(key: LimbKey) -> dict[str, Any]:
    """One value, or a list with one for each limb."""
    one = _one(key)
    return {"anyOf": [one, list_schema(one, 1, MOST_LIMBS)]}


def _one(key: LimbKey) -> dict[str, Any]:
    if key.form in ("point", "direction"):
        return _POINT if key.form == "point" else _DIRECTION
    if key.form == "mode":
        return {"enum": ["+", "-"]}
    if key.form == "choice":
        return {"enum": [1, 2]}
    limit = _LIMITS.get(key.check, {})
    if key.form == "pair":
        return list_schema(number_schema(key.unit, **limit), 2)
    if key.unit == "rad":
        limit = {"exclusiveMinimum": 0.0, "exclusiveMaximum": 180.0}
    return number_schema(key.unit, **limit)


def _chain() -> dict[str, Any]:
    """A limb by its joints, from the base on."""
    joints = list_schema({"anyOf": [_joint(letter) for letter in JOINTS]}, 2, 6)
    return table_schema({"joints": joints}, _REPEAT)


def _joint(letter: str) -> dict[str, Any]:
    unit = "mm" if letter in "PC" else "rad"
    known = {
        "at": _POINT,
        "axis": _DIRECTION,
        "about": _DIRECTION,
        "axes": list_schema(_DIRECTION, 2),
        "actuated": {"const": False} if letter in "SU" else {"type": "boolean"},
        "range": list_schema(number_schema(unit), 2),
        "value": number_schema(unit),
        "cone": number_schema("rad"),
    }
    needed = {key: known[key] for key in JOINTS[letter]}
    rest = {key: known[key] for key in JOINT_OPTIONAL if key not in needed}
    return table_schema({"joint": {"const": letter}, **needed}, rest)
