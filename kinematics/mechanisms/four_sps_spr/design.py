"""The design of a 4-SPS + 1-SPR: five limbs and the axis of the fifth one's revolute joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from kinematics.arrays import Array, read_only
from kinematics.designs.files import (
    KeyPath,
    TableError,
    change_table,
    check_keys,
    read_numbers,
    read_tables,
    read_text,
)
from kinematics.mechanism import DesignField

Point = tuple[float, float, float]
LIMBS = 5
SPR = 4
"""The SPR limb, counted from 0."""
SUBSCRIPTS = "₁₂₃₄₅"
JOINT_SYMBOLS = tuple(f"l{index}" for index in SUBSCRIPTS)
SHORTEST_AXIS = 1e-9
"""A direction with numbers smaller than this is none."""


@dataclass(frozen=True, slots=True)
class Limb:
    """One limb; the letters of Wang et al. (2017) in brackets. All in mm.

    Attributes:
        base: centre of its spherical joint on the base (A_i), base frame.
        platform: of its joint on the platform (B_i), platform frame.
        stroke: the shortest and the longest |A_i B_i| (l_i).
    """

    base: Point
    platform: Point
    stroke: tuple[float, float]


@dataclass(frozen=True)
class FourSPSSPRDesign:
    """Five limbs, the fifth with a revolute joint on the platform. Frozen and hashable.

    Attributes:
        limbs: the SPR limb is the last.
        revolute_axis: direction of its revolute joint, platform frame, of any length.
    """

    limbs: tuple[Limb, Limb, Limb, Limb, Limb]
    revolute_axis: Point
    name: str = ""
    title: str = ""
    source: str = ""

    mechanism = "four_sps_spr"

    @cached_property
    def base(self) -> Array:
        """A_i, (5, 3) mm in the base frame, read-only."""
        return read_only([limb.base for limb in self.limbs])

    @cached_property
    def platform(self) -> Array:
        """b_i, (5, 3) mm in the platform frame, read-only."""
        return read_only([limb.platform for limb in self.limbs])

    @cached_property
    def stroke(self) -> Array:
        """(5, 2) mm: the shortest and the longest lengths, read-only."""
        return read_only([limb.stroke for limb in self.limbs])

    @cached_property
    def axis(self) -> Array:
        """n6 in the platform frame, (3,) of length one, read-only."""
        direction = np.array(self.revolute_axis)
        return read_only(direction / np.linalg.norm(direction))

    @cached_property
    def offset(self) -> float:
        """b5·n6, mm: how far from p the plane is that limb 5 moves in."""
        return float(self.platform[SPR] @ self.axis)

    @cached_property
    def length(self) -> float:
        """The characteristic length, mm, that makes rotations comparable with displacements.

        The root mean square distance of the platform points from their centroid; where they all
        coincide, a tenth of the mean of the longest limb lengths.
        """
        spread = self.platform - self.platform.mean(axis=0)
        length = float(np.sqrt((spread**2).sum(axis=1).mean()))
        longest = float(self.stroke[:, 1].mean())
        return length if length > 1e-9 * longest else 0.1 * longest

    @cached_property
    def size(self) -> float:
        """A typical length of the machine, mm."""
        return float(max(np.abs(self.base).max(), np.abs(self.platform).max(), self.stroke.max()))


# --- design files --------------------------------------------------------------------------


def design_from_table(table: Mapping[str, Any], *, origin: str, name: str) -> FourSPSSPRDesign:
    """The design that a parsed design file describes.

    Raises:
        DesignError: naming the origin, the limb, the key and the remedy.
    """
    check_keys(
        table,
        required=("mechanism", "revolute_axis", "limb"),
        optional=("title", "source"),
        origin=origin,
    )
    axis = read_numbers(
        table["revolute_axis"], 3, origin=origin, path=("revolute_axis",), unit="a direction"
    )
    if max(map(abs, axis)) < SHORTEST_AXIS:
        raise TableError(
            origin,
            ("revolute_axis",),
            "revolute_axis must be a direction in the platform frame, as [1, 0, 0]; "
            "its numbers are all zero",
        )
    entries = read_tables(table, "limb", LIMBS, origin=origin)
    one, two, three, four, five = (
        _limb_from_table(entry, origin=origin, path=("limb", i)) for i, entry in enumerate(entries)
    )
    return FourSPSSPRDesign(
        limbs=(one, two, three, four, five),
        revolute_axis=_point(axis),
        name=name,
        title=read_text(table, "title", origin=origin),
        source=read_text(table, "source", origin=origin),
    )


def design_to_table(design: FourSPSSPRDesign) -> dict[str, Any]:
    """What a design file says, as plain values; lengths in mm."""
    return {
        "mechanism": design.mechanism,
        "title": design.title,
        "source": design.source,
        "revolute_axis": list(design.revolute_axis),
        "limb": [
            {
                "base": list(limb.base),
                "platform": list(limb.platform),
                "stroke": list(limb.stroke),
            }
            for limb in design.limbs
        ],
    }


def design_fields(design: FourSPSSPRDesign) -> tuple[DesignField, ...]:
    """Every number of the design: eight a limb, in mm, and the three of the revolute axis."""
    fields: list[DesignField] = []
    for i, limb in enumerate(design.limbs):
        group = f"Limb {i + 1} (SPR)" if i == SPR else f"Limb {i + 1}"
        for key, point in (("base", limb.base), ("platform", limb.platform)):
            for axis, value in enumerate(point):
                label = f"{key} {'xyz'[axis]}"
                fields.append(DesignField(("limb", i, key, axis), label, value, "mm", group))
        for end, value in enumerate(limb.stroke):
            label = ("l min", "l max")[end]
            fields.append(DesignField(("limb", i, "stroke", end), label, value, "mm", group))
        if i == SPR:
            fields += [
                DesignField(("revolute_axis", axis), f"n₆ {'xyz'[axis]}", value, "", group)
                for axis, value in enumerate(design.revolute_axis)
            ]
    return tuple(fields)


def with_field(
    design: FourSPSSPRDesign, path: Sequence[str | int], value: float
) -> FourSPSSPRDesign:
    """The design with one number (a `DesignField.path`) changed and everything checked again.

    Raises:
        InputError: the design has no such number.
        DesignError: the design would not be valid with it.
    """
    changed = change_table(design_to_table(design), design_fields(design), path, value)
    return design_from_table(changed, origin="", name=design.name)


def _limb_from_table(entry: object, *, origin: str, path: KeyPath) -> Limb:
    limb = check_keys(entry, required=("base", "platform", "stroke"), origin=origin, path=path)
    label = f"limb {int(path[1]) + 1}"
    base = read_numbers(limb["base"], 3, origin=origin, path=(*path, "base"))
    platform = read_numbers(limb["platform"], 3, origin=origin, path=(*path, "platform"))
    low, high = read_numbers(limb["stroke"], 2, origin=origin, path=(*path, "stroke"))
    if low < 0:
        raise TableError(
            origin,
            (*path, "stroke"),
            f"{label}: stroke: the shortest length must not be negative (mm), got {low:g}",
        )
    if low >= high:
        raise TableError(
            origin,
            (*path, "stroke"),
            f"{label}: stroke must be [shortest, longest] with shortest < longest (mm), "
            f"got [{low:g}, {high:g}]",
        )
    return Limb(base=_point(base), platform=_point(platform), stroke=(low, high))


def _point(values: tuple[float, ...]) -> Point:
    x, y, z = values
    return (x, y, z)
