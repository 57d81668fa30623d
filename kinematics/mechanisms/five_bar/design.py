"""The design of a planar five-bar: two limbs of two links each, and the distance of their bases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import degrees, radians
from typing import Any

import numpy as np

from kinematics.arrays import Array, read_only
from kinematics.designs.files import KeyPath, TableError, change_table, read_numbers
from kinematics.designs.schema import Key, Schema, list_schema, number_schema, positive
from kinematics.mechanism import DesignField

LIMBS = 2
SUBSCRIPTS = "₁₂"
WHOLE_TURN = (-180.0, 180.0)  # degrees, the range that is offered where there is none


@dataclass(frozen=True, slots=True)
class Limb:
    """One limb R̲RR from A_i over B_i to P.

    Attributes:
        proximal: |A_i B_i|, the driven link, mm (r_1 of the paper).
        distal: |B_i P|, mm (r_2).
        joint_range_deg: the least and the largest θ_i, degrees as in the file; None: it turns
            freely.
    """

    proximal: float
    distal: float
    joint_range_deg: tuple[float, float] | None = None


@dataclass(frozen=True)
class FiveBarDesign:
    """Two limbs and ``half_base`` = |O A_i|, mm (r_3): A_1 at x = −r_3, A_2 at x = r_3, y = 0."""

    limbs: tuple[Limb, Limb]
    half_base: float
    name: str = ""
    title: str = ""
    source: str = ""

    mechanism = "five_bar"

    @cached_property
    def base(self) -> Array:
        """A_i, (2, 2) mm, read-only."""
        return read_only([[-self.half_base, 0.0], [self.half_base, 0.0]])

    @cached_property
    def proximal(self) -> Array:
        """(2,) mm, read-only."""
        return read_only([limb.proximal for limb in self.limbs])

    @cached_property
    def distal(self) -> Array:
        """(2,) mm, read-only."""
        return read_only([limb.distal for limb in self.limbs])

    @cached_property
    def joint_range(self) -> Array:
        """(2, 2) rad: the least and the largest θ_i; infinite where a limb turns freely."""
        free = (-np.inf, np.inf)
        return read_only(
            [
                free if limb.joint_range_deg is None else np.radians(limb.joint_range_deg).tolist()
                for limb in self.limbs
            ]
        )

    @cached_property
    def limited(self) -> bool:
        """Some joint has a range."""
        return any(limb.joint_range_deg is not None for limb in self.limbs)

    @cached_property
    def size(self) -> float:
        """A typical length, mm: what a limb spans at most, on the average."""
        return float(np.mean(self.proximal + self.distal))


# --- design files --------------------------------------------------------------------------

_RANGE = "joint_range_deg"


class _EachLimb(Key):
    """One length for both limbs, or a list of two."""

    def read(self, value: object, *, origin: str, path: KeyPath) -> Any:
        if not isinstance(value, list | tuple):
            return (super().read(value, origin=origin, path=path),) * LIMBS
        lengths = read_numbers(value, LIMBS, origin=origin, path=path)
        for i, length in enumerate(lengths):
            problem = positive(f"{self.name}: number {i + 1}", length)
            if problem:
                raise TableError(origin, (*path, i), problem)
        return lengths

    def json_schema(self) -> dict[str, Any]:
        one = super().json_schema()
        return {"anyOf": [one, list_schema(one, LIMBS)]}

    def fields(self, value: Any, path: KeyPath, group: str) -> list[DesignField]:
        label = self.labels[0]
        return [DesignField((*path, i), label, one, "mm", group) for i, one in enumerate(value)]


class _FiveBarSchema(Schema[FiveBarDesign]):
    """``joint_range_deg`` is left out, one pair for both limbs or a list of two pairs, degrees."""

    optional = (_RANGE,)

    def further(self, table: Mapping[str, Any], *, origin: str) -> dict[str, Any]:
        return {"ranges": _ranges(table, origin=origin)}

    def optional_schemas(self) -> dict[str, Any]:
        pair = list_schema(number_schema("rad", minimum=-360.0, maximum=360.0), 2)
        each = {"anyOf": [pair, {"const": []}]}
        return {_RANGE: {"anyOf": [pair, list_schema(each, LIMBS)]}}

    def table(self, design: FiveBarDesign) -> dict[str, Any]:
        """Both limbs are written out; mm and degrees."""
        table = super().table(design)
        if design.limited:
            table[_RANGE] = [list(limb.joint_range_deg or ()) for limb in design.limbs]
        return table

    def fields(self, design: FiveBarDesign) -> tuple[DesignField, ...]:
        """The five lengths, mm, and the ends of the joint ranges, rad; a whole turn where there
        is none.
        """
        lengths = super().fields(design)
        fields: list[DesignField] = []
        for i, limb in enumerate(design.limbs):
            group = f"Limb {i + 1}"
            fields += [replace(f, group=group) for f in lengths if f.path[1:] == (i,)]
            for end, value in enumerate(limb.joint_range_deg or WHOLE_TURN):
                label, path = f"θ{SUBSCRIPTS[i]} {('min', 'max')[end]}", (_RANGE, i, end)
                fields.append(DesignField(path, label, radians(value), "rad", group))
        return (*fields, lengths[-1])

    def changed(
        self, design: FiveBarDesign, path: Sequence[str | int], value: float
    ) -> FiveBarDesign:
        """A joint range of a whole turn or more is none."""
        if not path or path[0] != _RANGE:
            return super().changed(design, path, value)
        table = self.table(design)
        table[_RANGE] = [list(limb.joint_range_deg or WHOLE_TURN) for limb in design.limbs]
        table = change_table(table, self.fields(design), path, round(degrees(value), 12))
        table[_RANGE] = [[] if high - low >= 360.0 else [low, high] for low, high in table[_RANGE]]
        if not any(table[_RANGE]):
            del table[_RANGE]
        return self.read(table, origin="", name=design.name)


def _made(
    proximal: tuple[float, float],
    distal: tuple[float, float],
    half_base: float,
    ranges: tuple[tuple[float, float] | None, tuple[float, float] | None],
    **about: str,
) -> FiveBarDesign:
    one, two = (Limb(*limb) for limb in zip(proximal, distal, ranges, strict=True))
    return FiveBarDesign((one, two), half_base, **about)


SCHEMA = _FiveBarSchema(
    _made,
    (
        _EachLimb("proximal", ("proximal r₁",), check=positive),
        _EachLimb("distal", ("distal r₂",), check=positive),
        Key("half_base", ("half base r₃",), check=positive, group="Base"),
    ),
)


def _ranges(
    table: Mapping[str, Any], *, origin: str
) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    if _RANGE not in table:
        return None, None
    value = table[_RANGE]
    if not isinstance(value, list | tuple) or len(value) != LIMBS:
        raise TableError(
            origin, (_RANGE,), f"{_RANGE} must be [min, max] or a list of two such pairs (degrees)"
        )
    if not any(isinstance(entry, list | tuple) for entry in value):
        both = _range(value, origin=origin, path=(_RANGE,))
        return both, both
    one, two = (
        None
        if isinstance(entry, list | tuple) and not entry
        else _range(entry, origin=origin, path=(_RANGE, i))
        for i, entry in enumerate(value)
    )
    return one, two


def _range(value: object, *, origin: str, path: tuple[str | int, ...]) -> tuple[float, float]:
    low, high = read_numbers(value, 2, origin=origin, path=path, unit="degrees")
    if not (-360.0 <= low < high <= 360.0 and high - low < 360.0):
        raise TableError(
            origin,
            path,
            f"{path[0]} must be [min, max] within ±360 degrees, with min < max and less than a "
            f"full turn between them, got [{low:g}, {high:g}]; leave it out where a joint turns "
            f"freely",
        )
    return low, high
