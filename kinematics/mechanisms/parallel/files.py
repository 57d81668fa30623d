"""Design files of parallel mechanisms: read, checked, written and edited."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from math import degrees, radians
from typing import Any, Literal

import numpy as np

from kinematics.designs.files import TableError, change_table, check_keys, read_text
from kinematics.designs.schema import ABOUT, UNITS, Schema, file_schema
from kinematics.lengths import in_mm
from kinematics.mechanism import DesignField
from kinematics.mechanisms.parallel.assembly import check
from kinematics.mechanisms.parallel.design import LimbTable, ParallelDesign, Value
from kinematics.mechanisms.parallel.json_schema import optional_schemas, required_schemas
from kinematics.mechanisms.parallel.limb_types import TYPES
from kinematics.mechanisms.parallel.tables import (
    MOST_LIMBS,
    read_coordinates,
    read_direction,
    read_limb,
    read_platform,
)


class ParallelSchema(Schema[ParallelDesign]):
    """A table [platform], and tables [[limb]]."""

    def __init__(self) -> None:
        super().__init__(ParallelDesign)

    # --- reading

    def _in_mm(self, table: Mapping[str, Any], unit: str) -> Mapping[str, Any]:
        if unit == "mm":
            return table
        copy = deepcopy(dict(table))
        if isinstance(copy.get("platform"), dict) and "position" in copy["platform"]:
            copy["platform"]["position"] = _scaled(copy["platform"]["position"], unit)
        limbs = copy.get("limb")
        for limb in limbs if isinstance(limbs, list) else []:
            if not isinstance(limb, dict):
                continue
            kind = TYPES.get(str(limb.get("type", "")))
            for key in () if kind is None else kind.keys:
                if key.name in limb and key.unit == "mm" and key.form != "choice":
                    limb[key.name] = _scaled(limb[key.name], unit)
            joints = limb.get("joints")
            for joint in joints if isinstance(joints, list) else []:
                if isinstance(joint, dict):
                    lengths = ("at", "value", "range") if joint.get("joint") == "P" else ("at",)
                    joint.update({k: _scaled(joint[k], unit) for k in lengths if k in joint})
        return copy

    def _read(self, table: Mapping[str, Any], *, origin: str, name: str) -> ParallelDesign:
        check_keys(
            table,
            required=("mechanism", "platform", "limb"),
            optional=(*ABOUT, UNITS, "plane", "coordinates"),
            origin=origin,
        )
        limbs = table["limb"]
        if not isinstance(limbs, list | tuple) or not limbs:
            raise TableError(origin, ("limb",), "limb must be tables, each written as [[limb]]")
        read = tuple(read_limb(limb, origin, ("limb", n)) for n, limb in enumerate(limbs))
        count = sum(limb.repeat * limb.count for limb in read)
        if not 2 <= count <= MOST_LIMBS:
            problem = f"a parallel mechanism has 2 to {MOST_LIMBS} limbs, these tables make {count}"
            raise TableError(origin, ("limb",), problem)
        design = ParallelDesign(
            platform=read_platform(table["platform"], origin),
            limbs=read,
            plane=read_direction(table["plane"], origin, ("plane",)) if "plane" in table else None,
            coordinates=read_coordinates(table, origin),
            name=name,
            **{key: read_text(table, key, origin=origin) for key in ABOUT},
        )
        check(design, origin)
        return design

    def json_schema(self, kind: str) -> dict[str, Any]:
        return file_schema(kind, required_schemas(), optional_schemas())

    # --- writing and editing

    def table(self, design: ParallelDesign) -> dict[str, Any]:
        table: dict[str, Any] = {key: getattr(design, key) for key in ("mechanism", *ABOUT)}
        if design.plane is not None:
            table["plane"] = list(design.plane)
        if design.coordinates:
            table["coordinates"] = list(design.coordinates)
        platform: dict[str, Any] = {"position": list(design.platform.position)}
        if design.platform.turn is not None:
            platform["turn"] = list(design.platform.turn)
        if design.platform.rotation is not None:
            platform["rotation"] = [list(row) for row in design.platform.rotation]
        table["platform"] = platform
        table["limb"] = [_table_of(limb) for limb in design.limbs]
        return table

    def fields(self, design: ParallelDesign) -> tuple[DesignField, ...]:
        return tuple(_fields(design))

    def changed(
        self, design: ParallelDesign, path: Sequence[str | int], value: float
    ) -> ParallelDesign:
        fields = self.fields(design)
        field = next((field for field in fields if field.path == tuple(path)), None)
        if field is not None and field.unit == "rad" and np.isfinite(value):
            value = round(degrees(value), 12)
        table = change_table(self.table(design), fields, path, value)
        return self.read(table, origin="", name=design.name)


SCHEMA = ParallelSchema()


def _scaled(value: object, unit: str) -> Any:
    if isinstance(value, list | tuple):
        return [_scaled(one, unit) for one in value]
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    return in_mm(value, unit)


def _table_of(limb: LimbTable) -> dict[str, Any]:
    table: dict[str, Any] = {"type": limb.type} if limb.type else {}
    table |= {key: _plain(value) for key, value in limb.values}
    if limb.joints:
        table["joints"] = [{key: _plain(v) for key, v in joint} for joint in limb.joints]
    if limb.repeat != 1:
        table["repeat"] = limb.repeat
    if limb.repeat_axis is not None:
        table["repeat_axis"] = list(limb.repeat_axis)
    return table


def _plain(value: Value) -> Any:
    return [_plain(one) for one in value] if isinstance(value, tuple) else value


def _fields(design: ParallelDesign) -> Iterator[DesignField]:
    platform = design.platform
    yield from _numbers(("platform", "position"), "O′", platform.position, "mm", "Platform")
    if platform.turn is not None:
        yield from _numbers(("platform", "turn"), "turn", platform.turn, "rad", "Platform")
    first = 1
    for n, limb in enumerate(design.limbs):
        last = first + limb.repeat * limb.count - 1
        group = f"Limb {first}" if first == last else f"Limbs {first} to {last}"
        first = last + 1
        units = {key.name: key.unit for key in TYPES[limb.type].keys} if limb.type else {}
        for key, value in limb.values:
            if key != "actuated":
                yield from _numbers(("limb", n, key), key, value, units[key], group)
        for k, joint in enumerate(limb.joints):
            entries = dict(joint)
            sliding = entries["joint"] in ("P", "C")
            for key, value in joint:
                turned: Literal["mm", "rad"] = "mm" if sliding and key != "cone" else "rad"
                unit = "mm" if key == "at" else "" if key in ("axis", "axes", "about") else turned
                path = ("limb", n, "joints", k, key)
                label = f"{entries['joint']}{k + 1} {key}"
                yield from _numbers(path, label, value, unit, group)


def _numbers(
    path: tuple[str | int, ...],
    label: str,
    value: Value,
    unit: Literal["mm", "rad", ""],
    group: str,
) -> Iterator[DesignField]:
    if isinstance(value, str | bool):
        return
    if not isinstance(value, tuple):
        shown = radians(value) if unit == "rad" else float(value)
        yield DesignField(path, label, shown, unit, group)
        return
    nested = bool(value) and isinstance(value[0], tuple)
    names = {2: ("min", "max"), 3: ("x", "y", "z")}.get(len(value), ())
    if label.endswith(("links", "axes")) or nested or not names:
        names = tuple(str(n + 1) for n in range(len(value)))
    for n, (one, name) in enumerate(zip(value, names, strict=True)):
        yield from _numbers((*path, n), f"{label} {name}", one, unit, group)
