"""The design of a parallel mechanism: its platform's reference pose and the tables of its limbs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np

from kinematics.arrays import Array, read_only
from kinematics.screws.spatial import rotation_x, rotation_y, rotation_z

Vector = tuple[float, float, float]
Value: TypeAlias = "str | float | bool | tuple[Value, ...]"
Entries = tuple[tuple[str, Value], ...]
"""Keys and what they say, as in a file: lengths in mm, angles in degrees."""


@dataclass(frozen=True, slots=True)
class Platform:
    """The reference pose of the platform frame, which may be a rough one.

    Attributes:
        position: mm, base frame.
        turn: degrees about x, y, z, R = Rz Ry Rx; None where ``rotation`` says it.
        rotation: the rows of R.
    """

    position: Vector
    turn: Vector | None = None
    rotation: tuple[Vector, Vector, Vector] | None = None

    def matrix(self) -> Array:
        """R (3, 3)."""
        if self.rotation is not None:
            left, _, right = np.linalg.svd(np.array(self.rotation))
            return np.asarray(left @ right)
        x, y, z = np.radians(self.turn or (0.0, 0.0, 0.0))
        return np.asarray(rotation_z(z) @ rotation_y(y) @ rotation_x(x))


@dataclass(frozen=True, slots=True)
class LimbTable:
    """One table [[limb]]; it may make several limbs.

    Attributes:
        type: a short form; "" of a chain of joints.
        values: the short form's keys.
        joints: the chain's, from the base on, points and axes in the base frame.
        repeat: how many copies, turned evenly about ``repeat_axis``.
        repeat_axis: None: z.
    """

    type: str
    values: Entries = ()
    joints: tuple[Entries, ...] = ()
    repeat: int = 1
    repeat_axis: Vector | None = None

    @property
    def count(self) -> int:
        """How many limbs a copy has: as many as the longest list of values."""
        lists = (v for k, v in self.values if isinstance(v, tuple) and is_list(k, v))
        return max((len(v) for v in lists), default=1)


def is_list(key: str, value: Value) -> bool:
    """Whether a value says one for each limb: a list of vectors or pairs, or of modes."""
    if not isinstance(value, tuple):
        return False
    return bool(value) and (isinstance(value[0], tuple | str) or key in _NUMBERS)


_NUMBERS = ("crank", "rod", "link", "base_cone", "platform_cone", "parallelogram", "actuated")


@dataclass(frozen=True)
class ParallelDesign:
    """A parallel mechanism. Frozen and hashable.

    Attributes:
        plane: the common normal of planar limbs; None: z.
        coordinates: the keys of the pose's coordinates; (): chosen by the motion.
    """

    platform: Platform
    limbs: tuple[LimbTable, ...]
    plane: Vector | None = None
    coordinates: tuple[str, ...] = ()
    name: str = ""
    title: str = ""
    source: str = ""

    mechanism = "parallel"

    @cached_property
    def normal(self) -> Array:
        """(3,) of length one, read-only: of planar limbs."""
        given = np.array(self.plane or (0.0, 0.0, 1.0))
        return read_only(given / np.linalg.norm(given))

    def each(self) -> Iterator[tuple[int, LimbTable, int, int]]:
        """Number of the table, table, copy and place in the lists of every limb, in their order."""
        for n, table in enumerate(self.limbs):
            for copy in range(table.repeat):
                for place in range(table.count):
                    yield n, table, copy, place
