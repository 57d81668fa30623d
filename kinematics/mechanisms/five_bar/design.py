"""The design of a planar five-bar: two limbs of two links each, and the distance of their bases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import degrees, radians
from typing import Any

import numpy as np

from kinematics.arrays import Array, read_only
from kinematics.designs.files import (
    TableError,
    change_table,
    check_keys,
    read_number,
    read_numbers,
    read_text,
)
from kinematics.mechanism import DesignField

LIMBS = 2
SUBSCRIPTS = "₁₂"
WHOLE_TURN = (-180.0, 180.0)  # degrees, the range that is offered where there is none
SHORTEST = 1e-3
"""mm; below a micrometre a link is a slip of the pen."""


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


def design_from_table(table: Mapping[str, Any], *, origin: str, name: str) -> FiveBarDesign:
    """The design that a parsed design file describes.

    ``proximal`` and ``distal`` are one number for both limbs or a list of two, mm;
    ``joint_range_deg`` is left out, one pair for both limbs or a list of two pairs, degrees.

    Raises:
        DesignError: naming the origin, the key and the remedy.
    """
    check_keys(
        table,
        required=("mechanism", "proximal", "distal", "half_base"),
        optional=("title", "source", "joint_range_deg"),
        origin=origin,
    )
    proximal = _lengths(table, "proximal", origin=origin)
    distal = _lengths(table, "distal", origin=origin)
    half_base = read_number(table["half_base"], origin=origin, path=("half_base",))
    _check_length(half_base, origin=origin, path=("half_base",))
    one, two = (
        Limb(a, b, c)
        for a, b, c in zip(proximal, distal, _ranges(table, origin=origin), strict=True)
    )
    return FiveBarDesign(
        limbs=(one, two),
        half_base=half_base,
        name=name,
        title=read_text(table, "title", origin=origin),
        source=read_text(table, "source", origin=origin),
    )


def design_to_table(design: FiveBarDesign) -> dict[str, Any]:
    """What a design file says, as plain values; mm and degrees. Both limbs are written out."""
    table: dict[str, Any] = {
        "mechanism": design.mechanism,
        "title": design.title,
        "source": design.source,
        "proximal": [limb.proximal for limb in design.limbs],
        "distal": [limb.distal for limb in design.limbs],
        "half_base": design.half_base,
    }
    if design.limited:
        table["joint_range_deg"] = [
            [] if limb.joint_range_deg is None else list(limb.joint_range_deg)
            for limb in design.limbs
        ]
    return table


def design_fields(design: FiveBarDesign) -> tuple[DesignField, ...]:
    """The five lengths, mm, and the ends of the joint ranges, rad; a whole turn where there is
    none.
    """
    fields: list[DesignField] = []
    for i, limb in enumerate(design.limbs):
        group, mark = f"Limb {i + 1}", SUBSCRIPTS[i]
        fields.append(DesignField(("proximal", i), "proximal r₁", limb.proximal, "mm", group))
        fields.append(DesignField(("distal", i), "distal r₂", limb.distal, "mm", group))
        for end, value in enumerate(limb.joint_range_deg or WHOLE_TURN):
            label, path = f"θ{mark} {('min', 'max')[end]}", ("joint_range_deg", i, end)
            fields.append(DesignField(path, label, radians(value), "rad", group))
    fields.append(DesignField(("half_base",), "half base r₃", design.half_base, "mm", "Base"))
    return tuple(fields)


def with_field(design: FiveBarDesign, path: Sequence[str | int], value: float) -> FiveBarDesign:
    """The design with one number (a `DesignField.path`; mm or rad) changed and checked again.

    A joint range of a whole turn or more is none.

    Raises:
        InputError: the design has no such number.
        DesignError: the design would not be valid with it.
    """
    table, key = design_to_table(design), "joint_range_deg"
    if not path or path[0] != key:
        changed = change_table(table, design_fields(design), path, value)
        return design_from_table(changed, origin="", name=design.name)
    table[key] = [list(limb.joint_range_deg or WHOLE_TURN) for limb in design.limbs]
    changed = change_table(table, design_fields(design), path, round(degrees(value), 12))
    changed[key] = [[] if high - low >= 360.0 else [low, high] for low, high in changed[key]]
    if not any(changed[key]):
        del changed[key]
    return design_from_table(changed, origin="", name=design.name)


# --- inside --------------------------------------------------------------------------------


def _lengths(table: Mapping[str, Any], key: str, *, origin: str) -> tuple[float, float]:
    """One length for both limbs, or one for each."""
    value = table[key]
    if not isinstance(value, list | tuple):
        length = read_number(value, origin=origin, path=(key,))
        _check_length(length, origin=origin, path=(key,))
        return length, length
    one, two = read_numbers(value, LIMBS, origin=origin, path=(key,))
    for i, length in enumerate((one, two)):
        _check_length(length, origin=origin, path=(key, i))
    return one, two


def _check_length(value: float, *, origin: str, path: tuple[str | int, ...]) -> None:
    if value < SHORTEST:
        what = path[0] if len(path) == 1 else f"{path[0]}: number {int(path[1]) + 1}"
        raise TableError(
            origin, path, f"{what} must be a positive length (mm, at least 0.001), got {value:g}"
        )


def _ranges(
    table: Mapping[str, Any], *, origin: str
) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    key = "joint_range_deg"
    if key not in table:
        return None, None
    value = table[key]
    if not isinstance(value, list | tuple) or len(value) != LIMBS:
        raise TableError(
            origin, (key,), f"{key} must be [min, max] or a list of two such pairs (degrees)"
        )
    if not any(isinstance(entry, list | tuple) for entry in value):
        both = _range(value, origin=origin, path=(key,))
        return both, both
    one, two = (
        None
        if isinstance(entry, list | tuple) and not entry
        else _range(entry, origin=origin, path=(key, i))
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
