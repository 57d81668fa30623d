"""One limb as numbers: what drives it and what it takes from the platform.

A limb with its actuator locked holds a point B of the platform on a sphere about a point E that the
actuator moves ("leg", "crank", "slider"), or does something like it; besides, it may take freedom
from the platform whatever its actuator does: its bond. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf
from typing import Literal, cast

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.parallel.design import (
    LimbTable,
    ParallelDesign,
    Value,
    is_list,
)
from kinematics.mechanisms.parallel.limb_types import TYPES, LimbType

Drive = Literal["leg", "crank", "slider", "elbow", "direction", "offset leg"]
"""What an actuator does: it makes |AB|; turns or slides E, with |EB| fixed; bends the elbow of two
links, which makes |AB|; turns a direction at a fixed angle to one of the platform; or makes |AQ|, Q
at a fixed distance from B."""
Bond = Literal[
    "free",
    "base plane",
    "platform plane",
    "normal axes",
    "universal",
    "parallelogram",
    "planar",
    "point",
]
"""What the limb takes: nothing; B stays in a plane of the base, or A in one of the platform; two
axes stay normal; the leg and the outer axes stay in a plane; the platform turns about one axis
only; it moves in a plane; a point of it stays."""
ANGLES = ("crank", "elbow", "direction")
Z = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Limb:
    """A limb at the reference pose; points and axes (3,), base ones in the base frame.

    Attributes:
        kind: which of the limb types it is.
        a: A, where it begins; of a slider where its joint is at 0.
        b: B, platform frame; of a direction the platform's own, of length one.
        axis: w, of a crank or slider; of a direction its first axis u; length one.
        zero: of a crank, where it points at 0, of length one; of a direction the part of the
            middle axis v normal to u at 0.
        along: of a direction u·v.
        crank, rod: mm; of a direction ``rod`` is cos α.
        normal: of the bond, base frame, of length one.
        mark: of the bond, platform frame, of length one, or the centre of a "point", mm.
        low, high: the range of its actuator; infinite where there is none.
        branch: +1 or −1 at the reference.
        shift: its joint's value is that of the drive and this.
        base_cone, platform_cone: largest angles of its rod to where it is at the reference; inf.
        skew: the largest of its parallelogram; inf.
    """

    kind: LimbType
    drive: Drive
    bond: Bond
    a: Array
    b: Array
    axis: Array
    zero: Array
    along: float
    crank: float
    rod: float
    normal: Array
    mark: Array
    low: float
    high: float
    branch: int
    shift: float = 0.0
    base_cone: float = inf
    platform_cone: float = inf
    skew: float = inf

    @property
    def turns(self) -> bool:
        """Its actuator turns."""
        return self.drive in ANGLES

    @property
    def branches(self) -> int:
        """How many postures it has for a pose."""
        return 1 if self.drive == "leg" else 2


def unit(vector: Array) -> Array:
    """Of length one; a vector of no length stays."""
    size = float(np.linalg.norm(vector))
    return np.asarray(vector / size) if size > 0.0 else vector


def normal_to(vector: Array, axis: Array) -> Array:
    """The part normal to an axis of length one, of length one."""
    return unit(vector - (vector @ axis) * axis)


def turned(axis: Array, angle: float) -> Array:
    """The rotation (3, 3) about an axis of length one."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    made: Array = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return made


def short_form(
    design: ParallelDesign, table: LimbTable, copy: int, place: int, start: Array
) -> Limb:
    """A limb of a table in short form.

    Args:
        start: (4, 4) the reference pose as it is given.
    """
    kind = TYPES[table.type]
    entries = dict(table.values)
    turn = turned(_repeat_axis(table), 2.0 * np.pi * copy / table.repeat)
    keys = {key.name: key for key in kind.keys}

    def raw(name: str) -> Value | None:
        value = entries.get(name)
        listed = value is not None and is_list(name, value)
        return cast("tuple[Value, ...]", value)[place] if listed else value

    def vector(name: str) -> Array | None:
        value = raw(name)
        if value is None:
            return None
        found = turn @ np.array(value, dtype=float)
        return unit(found) if keys[name].form == "direction" else found

    def number(name: str, default: float) -> float:
        value = raw(name)
        return default if value is None else float(cast(float, value))

    a, b = vector("base"), vector("platform")
    assert a is not None
    assert b is not None
    normal, mark, axis = design.normal, np.zeros(3), vector("axis")
    if kind.bond == "planar":
        axis = normal
        mark = start[:3, :3].T @ normal
        # Where its joints lie along the normal does not matter.
        a = a + normal * (normal @ (start[:3, :3] @ b + start[:3, 3] - a))
    slide = vector("slide")
    if kind.bond == "base plane" and axis is not None:
        normal = axis
    if kind.bond == "parallelogram" and axis is not None:
        normal, mark = axis, start[:3, :3].T @ axis
    for name, of_base in (("base_axis", True), ("platform_axis", False)):
        found = vector(name)
        if found is not None:
            normal, mark = (found, mark) if of_base else (normal, found)
    if kind.drive == "slider":
        assert slide is not None
        axis = slide
        if kind.bond == "base plane":
            axis = normal_to(slide, normal)
        if kind.bond == "planar":
            axis = normal_to(slide, normal)
    axis = Z if axis is None else axis
    zero = vector("zero")
    zero = _default_zero(axis, planar=kind.bond == "planar") if zero is None else zero
    links = cast("tuple[float, float] | None", raw("links"))
    drive: Drive = cast(Drive, kind.drive)
    if raw("actuated") == 2:
        drive = "elbow"
    span = cast("tuple[float, float] | None", raw("stroke") or raw("range"))
    low, high = span or (-inf, inf)
    if drive in ANGLES:
        low, high = np.radians(low), np.radians(high)
    angle = np.pi / 180.0
    return Limb(
        kind,
        drive,
        cast(Bond, kind.bond),
        a,
        b,
        axis,
        normal_to(zero, axis) if kind.drive == "crank" else np.zeros(3),
        0.0,
        links[0] if links else number("crank", 0.0),
        links[1] if links else number("rod", number("link", 0.0)),
        normal,
        mark,
        float(low),
        float(high),
        -1 if raw("mode") == "-" else 1,
        base_cone=number("base_cone", inf) * angle,
        platform_cone=number("platform_cone", inf) * angle,
        skew=number("parallelogram", inf) * angle,
    )


def _default_zero(axis: Array, *, planar: bool) -> Array:
    """x of planar limbs, z of others; the other one where that is along the axis."""
    first, second = (np.eye(3)[0], np.eye(3)[1]) if planar else (Z, np.eye(3)[0])
    return first if abs(first @ axis) < 0.9 else second


def _repeat_axis(table: LimbTable) -> Array:
    return unit(np.array(table.repeat_axis or (0.0, 0.0, 1.0)))


def copies(table: LimbTable, copy: int) -> Array:
    """The rotation (3, 3) of a copy."""
    return turned(_repeat_axis(table), 2.0 * np.pi * copy / table.repeat)


def settled(limb: Limb, values: Mapping[str, Array | float | int]) -> Limb:
    """The limb with other numbers."""
    return replace(limb, **values)  # type: ignore[arg-type]
