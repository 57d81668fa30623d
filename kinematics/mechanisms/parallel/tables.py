"""The parts of a design file: the platform, short forms of limbs, chains of joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

import numpy as np

from kinematics.designs.files import (
    KeyPath,
    TableError,
    check_keys,
    path_text,
    read_number,
    read_numbers,
)
from kinematics.mechanisms.parallel.design import (
    Entries,
    LimbTable,
    Platform,
    Value,
    Vector,
    is_list,
)
from kinematics.mechanisms.parallel.limb_types import TYPES, LimbKey

MOST_LIMBS = 9
COORDINATES = ("x", "y", "z", "phi", "theta", "psi")
JOINTS = {
    "R": ("at", "axis"),
    "P": ("axis",),
    "U": ("at", "axes"),
    "S": ("at",),
    "C": ("at", "axis"),
}
"""Joints of a chain and the keys that each must have."""
JOINT_OPTIONAL = ("actuated", "range", "value", "cone", "about", "at")
_REPEAT = ("repeat", "repeat_axis")
_SHORTEST = 1e-9


def read_platform(value: object, origin: str) -> Platform:
    path: KeyPath = ("platform",)
    if not isinstance(value, Mapping):
        raise TableError(origin, path, "platform must be a table, written as [platform]")
    optional = ("turn", "rotation")
    table = check_keys(value, required=("position",), optional=optional, origin=origin, path=path)
    position = _vector(table["position"], origin, (*path, "position"))
    if "rotation" not in table:
        turn = table.get("turn")
        if turn is None:
            return Platform(position)
        return Platform(position, _vector(turn, origin, (*path, "turn"), "degrees"))
    here = (*path, "rotation")
    if "turn" in table:
        raise TableError(origin, here, "platform: give either turn or rotation, not both")
    rows = table["rotation"]
    if not isinstance(rows, list | tuple) or len(rows) != 3:
        raise TableError(origin, here, "platform: rotation must be three rows of three numbers")
    x, y, z = (_vector(row, origin, (*here, n), "") for n, row in enumerate(rows))
    matrix = np.array((x, y, z))
    off = float(np.abs(matrix @ matrix.T - np.eye(3)).max())
    if off > 1e-5 or np.linalg.det(matrix) < 0.0:
        problem = f"platform: rotation is no rotation: its rows are off by {off:.2g}; use turn"
        raise TableError(origin, here, problem)
    return Platform(position, None, (x, y, z))


def read_coordinates(table: Mapping[str, Any], origin: str) -> tuple[str, ...]:
    given = table.get("coordinates", ())
    known = isinstance(given, list | tuple) and all(one in COORDINATES for one in given)
    if not known or len(set(given)) != len(given):
        problem = f"coordinates must be a list of some of {', '.join(COORDINATES)}"
        raise TableError(origin, ("coordinates",), problem)
    return tuple(key for key in COORDINATES if key in given)


def read_limb(value: object, origin: str, path: KeyPath) -> LimbTable:
    if not isinstance(value, Mapping):
        raise TableError(origin, path, f"{path_text(path)}must be a table, written as [[limb]]")
    if "joints" in value:
        check_keys(value, required=("joints",), optional=_REPEAT, origin=origin, path=path)
        return LimbTable(
            "", joints=_joints(value["joints"], origin, path), **_repeat(value, origin, path)
        )
    if "type" not in value:
        problem = f"{path_text(path)}give its type, or its joints as a chain"
        raise TableError(origin, path, problem)
    kind = TYPES.get(str(value["type"]))
    if kind is None:
        problem = (
            f"{path_text(path)}there is no limb type {str(value['type'])[:20]!r}; known are "
            f"{', '.join(TYPES)}, or give its joints as a chain"
        )
        raise TableError(origin, (*path, "type"), problem)
    needed = ("type", *(key.name for key in kind.keys if key.needed))
    optional = (*(key.name for key in kind.keys if not key.needed), *_REPEAT)
    check_keys(value, required=needed, optional=optional, origin=origin, path=path)
    entries = tuple(
        (key.name, _read(key, value[key.name], origin, (*path, key.name)))
        for key in kind.keys
        if key.name in value
    )
    table = LimbTable(kind.name, entries, **_repeat(value, origin, path))
    for key, one in table.values:
        if is_list(key, one) and len(cast(Sequence[Value], one)) != table.count:
            problem = (
                f"{path_text((*path, key), end='')} has {len(cast(Sequence[Value], one))} entries, "
                f"but the table makes {table.count} limbs; give one for each, or a single one"
            )
            raise TableError(origin, (*path, key), problem)
    return table


def _repeat(table: Mapping[str, Any], origin: str, path: KeyPath) -> dict[str, Any]:
    count = table.get("repeat", 1)
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_LIMBS:
        problem = f"{path_text((*path, 'repeat'), end='')} must be a whole number from 1 to 9"
        raise TableError(origin, (*path, "repeat"), problem)
    axis = table.get("repeat_axis")
    where = (*path, "repeat_axis")
    return {
        "repeat": count,
        "repeat_axis": None if axis is None else read_direction(axis, origin, where),
    }


def _joints(value: object, origin: str, path: KeyPath) -> tuple[Entries, ...]:
    where = (*path, "joints")
    if not isinstance(value, list | tuple) or not 2 <= len(value) <= 6:
        problem = f"{path_text(where, end='')} must be a list of 2 to 6 joints from the base on"
        raise TableError(origin, where, problem)
    return tuple(_joint(one, origin, (*where, n)) for n, one in enumerate(value))


def _joint(value: object, origin: str, path: KeyPath) -> Entries:
    what = f"limb {int(path[1]) + 1}: joint {int(path[3]) + 1}"
    if not isinstance(value, Mapping):
        raise TableError(origin, path, f'{what} must be a table {{ joint = "R", … }}')
    letter = value.get("joint")
    if not isinstance(letter, str) or letter not in JOINTS:
        problem = f"{what}: joint must be one of {', '.join(JOINTS)}"
        raise TableError(origin, path, problem)
    needed = ("joint", *JOINTS[letter])
    optional = tuple(key for key in JOINT_OPTIONAL if key not in needed)
    try:
        check_keys(value, required=needed, optional=optional, origin=origin)
    except TableError as error:
        raise TableError(origin, path, f"{what}: {error.problem}") from None
    entries: list[tuple[str, Value]] = [("joint", letter)]
    if "at" in value:
        entries.append(("at", _vector(value["at"], origin, (*path, "at"))))
    entries += [
        (key, read_direction(value[key], origin, (*path, key)))
        for key in ("axis", "about")
        if key in value
    ]
    if "axes" in value:
        axes = value["axes"]
        if not isinstance(axes, list | tuple) or len(axes) != 2:
            raise TableError(origin, path, f"{what}: axes must be two directions")
        one, two = (read_direction(a, origin, (*path, "axes", n)) for n, a in enumerate(axes))
        if abs(float(np.dot(_unit(one), _unit(two)))) > 1e-6:
            raise TableError(origin, path, f"{what}: the axes of a U joint must be normal")
        entries.append(("axes", (one, two)))
    actuated = value.get("actuated", False)
    if not isinstance(actuated, bool):
        raise TableError(origin, path, f"{what}: actuated must be true or false")
    if actuated and letter in "SU":
        raise TableError(origin, path, f"{what}: only R, P and C joints can be actuated")
    if actuated:
        entries.append(("actuated", True))
    unit = "mm" if letter in "PC" else "degrees"
    if "range" in value:
        low, high = read_numbers(value["range"], 2, origin=origin, path=(*path, "range"), unit=unit)
        if not low < high:
            raise TableError(origin, path, f"{what}: range must be [min, max] with min < max")
        entries.append(("range", (low, high)))
    for key, of in (("value", unit), ("cone", "degrees")):
        if key in value:
            number = read_number(value[key], origin=origin, path=(*path, key), unit=of)
            entries.append((key, number))
    return tuple(entries)


def _read(key: LimbKey, value: object, origin: str, path: KeyPath) -> Value:
    """One value, or a list of them."""
    if isinstance(value, list | tuple) and value:
        nested = isinstance(value[0], list | tuple | str)
        if nested or key.form in ("number", "choice"):
            return tuple(_one(key, each, origin, (*path, n)) for n, each in enumerate(value))
    return _one(key, value, origin, path)


def _one(key: LimbKey, value: object, origin: str, path: KeyPath) -> Value:
    what, unit = path_text(path, end=""), "degrees" if key.unit == "rad" else "mm"
    if key.form == "point":
        return _vector(value, origin, path)
    if key.form == "direction":
        return read_direction(value, origin, path)
    if key.form == "mode":
        if value not in ("+", "-"):
            raise TableError(origin, path, f'{what} must be "+" or "-"')
        return str(value)
    if key.form == "choice":
        if value not in (1, 2) or isinstance(value, bool):
            problem = f"{what} must be 1 or 2: which of its joints is driven, from the base on"
            raise TableError(origin, path, problem)
        return int(value)
    if key.form == "number":
        number = read_number(value, origin=origin, path=path, unit=unit)
        least = _SHORTEST if key.check == "positive" or key.unit == "rad" else -np.inf
        if number < least:
            raise TableError(origin, path, f"{what} must be positive ({unit}), got {number:g}")
        if key.unit == "rad" and number >= 180.0:
            raise TableError(origin, path, f"{what} must be below 180 degrees, got {number:g}")
        return number
    low, high = read_numbers(value, 2, origin=origin, path=path, unit=unit)
    if key.check == "positive" and min(low, high) < _SHORTEST:
        raise TableError(origin, path, f"{what} must be two positive lengths (mm)")
    if key.check in ("ordered", "span") and not low < high:
        problem = f"{what} must be [min, max] with min < max ({unit}), got [{low:g}, {high:g}]"
        raise TableError(origin, path, problem)
    if key.check == "ordered" and low < 0.0:
        raise TableError(origin, path, f"{what}: the shortest must not be negative, got {low:g}")
    if key.unit == "rad" and high - low >= 360.0:
        problem = f"{what} must be less than a full turn; leave it out where the joint turns freely"
        raise TableError(origin, path, problem)
    return low, high


def _vector(value: object, origin: str, path: KeyPath, unit: str = "mm") -> Vector:
    x, y, z = read_numbers(value, 3, origin=origin, path=path, unit=unit, point=True)
    return x, y, z


def read_direction(value: object, origin: str, path: KeyPath) -> Vector:
    found = _vector(value, origin, path, "a direction")
    if max(map(abs, found)) < _SHORTEST:
        problem = f"{path_text(path, end='')} must be a direction; its numbers are all zero"
        raise TableError(origin, path, problem)
    return found


def _unit(vector: Vector) -> Any:
    return np.array(vector) / np.linalg.norm(vector)
