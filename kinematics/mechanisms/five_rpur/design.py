"""The design of a 5-RPUR: five limbs, each a base point, a platform point, a link and a stroke."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from kinematics.arrays import Array, read_only
from kinematics.designs.files import (
    KeyPath,
    TableError,
    change_table,
    check_keys,
    read_number,
    read_numbers,
    read_tables,
    read_text,
)
from kinematics.mechanism import DesignField

Point = tuple[float, float, float]
LIMBS = 5
SUBSCRIPTS = "₁₂₃₄₅"
JOINT_SYMBOLS = tuple(f"ρ{index}" for index in SUBSCRIPTS)
SHORTEST_LINK = 1e-3
"""mm; below a micrometre a link is a slip of the pen."""


@dataclass(frozen=True, slots=True)
class Limb:
    """One RPUR limb; the letters of Tale Masouleh et al. (2011) in brackets. All in mm.

    Attributes:
        base: A_i in the base frame (r_i).
        platform: C_i in the platform frame (s'_i).
        link: |B_i C_i| (l_i).
        stroke: the shortest and the longest |A_i B_i| (ρ_min, ρ_max).
    """

    base: Point
    platform: Point
    link: float
    stroke: tuple[float, float]


@dataclass(frozen=True)
class FiveRPURDesign:
    """Five limbs and where they come from. Frozen and hashable; the arrays are cached."""

    limbs: tuple[Limb, Limb, Limb, Limb, Limb]
    name: str = ""
    title: str = ""
    source: str = ""

    mechanism = "five_rpur"

    @cached_property
    def base(self) -> Array:
        """r_i, (5, 3) mm in the base frame, read-only."""
        return read_only([limb.base for limb in self.limbs])

    @cached_property
    def platform(self) -> Array:
        """s'_i, (5, 3) mm in the platform frame, read-only."""
        return read_only([limb.platform for limb in self.limbs])

    @cached_property
    def link(self) -> Array:
        """l_i, (5,) mm, read-only."""
        return read_only([limb.link for limb in self.limbs])

    @cached_property
    def stroke(self) -> Array:
        """(5, 2) mm: ρ_min and ρ_max, read-only."""
        return read_only([limb.stroke for limb in self.limbs])


# --- design files --------------------------------------------------------------------------


def design_from_table(table: Mapping[str, Any], *, origin: str, name: str) -> FiveRPURDesign:
    """The design that a parsed design file describes.

    Raises:
        DesignError: naming the origin, the limb, the key and the remedy.
    """
    check_keys(table, required=("mechanism", "limb"), optional=("title", "source"), origin=origin)
    entries = read_tables(table, "limb", LIMBS, origin=origin)
    one, two, three, four, five = (
        _limb_from_table(entry, origin=origin, path=("limb", i)) for i, entry in enumerate(entries)
    )
    return FiveRPURDesign(
        limbs=(one, two, three, four, five),
        name=name,
        title=read_text(table, "title", origin=origin),
        source=read_text(table, "source", origin=origin),
    )


def design_to_table(design: FiveRPURDesign) -> dict[str, Any]:
    """What a design file says, as plain values; lengths in mm."""
    return {
        "mechanism": design.mechanism,
        "title": design.title,
        "source": design.source,
        "limb": [
            {
                "base": list(limb.base),
                "platform": list(limb.platform),
                "link": limb.link,
                "stroke": list(limb.stroke),
            }
            for limb in design.limbs
        ],
    }


def design_fields(design: FiveRPURDesign) -> tuple[DesignField, ...]:
    """Every number of the design: nine a limb, all in mm."""
    fields: list[DesignField] = []
    for i, limb in enumerate(design.limbs):
        group = f"Limb {i + 1}"
        for key, point in (("base", limb.base), ("platform", limb.platform)):
            for axis, value in enumerate(point):
                label = f"{key} {'xyz'[axis]}"
                fields.append(DesignField(("limb", i, key, axis), label, value, "mm", group))
        fields.append(DesignField(("limb", i, "link"), "link l", limb.link, "mm", group))
        for end, value in enumerate(limb.stroke):
            label = ("ρ min", "ρ max")[end]
            fields.append(DesignField(("limb", i, "stroke", end), label, value, "mm", group))
    return tuple(fields)


def with_field(design: FiveRPURDesign, path: Sequence[str | int], value: float) -> FiveRPURDesign:
    """The design with one number (a `DesignField.path`) changed and everything checked again.

    Raises:
        InputError: the design has no such number.
        DesignError: the design would not be valid with it.
    """
    changed = change_table(design_to_table(design), design_fields(design), path, value)
    return design_from_table(changed, origin="", name=design.name)


def _limb_from_table(entry: object, *, origin: str, path: KeyPath) -> Limb:
    limb = check_keys(
        entry, required=("base", "platform", "link", "stroke"), origin=origin, path=path
    )
    label = f"limb {int(path[1]) + 1}"
    base = read_numbers(limb["base"], 3, origin=origin, path=(*path, "base"))
    platform = read_numbers(limb["platform"], 3, origin=origin, path=(*path, "platform"))
    link = read_number(limb["link"], origin=origin, path=(*path, "link"))
    low, high = read_numbers(limb["stroke"], 2, origin=origin, path=(*path, "stroke"))
    if link < SHORTEST_LINK:
        raise TableError(
            origin,
            (*path, "link"),
            f"{label}: link must be a positive length (mm, at least 0.001), got {link:g}",
        )
    if low < 0:
        raise TableError(
            origin,
            (*path, "stroke"),
            f"{label}: stroke: ρ_min must not be negative (mm), got {low:g}",
        )
    if low >= high:
        raise TableError(
            origin,
            (*path, "stroke"),
            f"{label}: stroke must be [ρ_min, ρ_max] with ρ_min < ρ_max (mm), "
            f"got [{low:g}, {high:g}]",
        )
    return Limb(base=_point(base), platform=_point(platform), link=link, stroke=(low, high))


def _point(values: tuple[float, ...]) -> Point:
    x, y, z = values
    return (x, y, z)
