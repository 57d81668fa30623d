"""Poses and joints that know their coordinates: names, symbols, units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import degrees, radians
from typing import Any, Literal, TypeVar

from kinematics.answers.bounds import Unit
from kinematics.arrays import number
from kinematics.errors import InputError

V = TypeVar("V", bound="Values")


@dataclass(frozen=True, slots=True)
class Coordinate:
    """One pose or joint coordinate: how it is called, its unit and the range worth offering.

    ``signed``: it may be negative, as an angle or the place of a slider, and not a leg's length.
    ``free``: it turns round and round; the range is one turn, and no stroke.
    """

    key: str
    symbol: str
    unit: Unit
    lower: float
    upper: float
    limb: int | None = None
    signed: bool = False
    free: bool = False

    @property
    def json_key(self) -> str:
        """Its key in JSON and in tables, where angles are degrees: "x", "phi_deg"."""
        return f"{self.key}_deg" if self.unit == "rad" else self.key

    def outer(self, value: float) -> float:
        """A value, mm or rad, as people write it: mm or degrees."""
        return degrees(value) if self.unit == "rad" else value

    def inner(self, value: float) -> float:
        """The other way: mm or rad of what people write."""
        return radians(value) if self.unit == "rad" else value


class Values(tuple[float, ...]):
    """Numbers, mm and rad, one for each of some coordinates; a tuple that knows its names.

    They can be asked for by name, ``pose.phi`` or ``pose["phi"]``, and taken wherever a sequence
    of numbers is.

    Attributes:
        axes: the coordinates.
    """

    axes: tuple[Coordinate, ...]

    def __new__(cls: type[V], values: Iterable[float], axes: tuple[Coordinate, ...]) -> V:
        made = super().__new__(cls, map(float, values))
        made.axes = axes
        return made

    def __getnewargs__(self) -> Any:
        return tuple(self), self.axes

    def __getattr__(self, name: str) -> float:
        if not name.startswith("_"):
            for value, axis in zip(self, self.axes, strict=True):
                if axis.key == name:
                    return value
        raise AttributeError(f"there is no coordinate {name!r}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(axis.key for axis in self.axes)]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self})"

    def __str__(self) -> str:
        """ "x = 90 mm, φ = 5.7296°"."""
        units: dict[Literal["mm", "rad"], str] = {"mm": " mm", "rad": "°"}
        return ", ".join(
            f"{axis.symbol} = {axis.outer(value):.10g}{units[axis.unit]}"
            for value, axis in zip(self, self.axes, strict=True)
        )

    @property
    def degrees(self) -> dict[str, float]:
        """By key, mm and degrees, for people."""
        return {a.key: a.outer(v) for v, a in zip(self, self.axes, strict=True)}

    def to_dict(self) -> dict[str, float]:
        """As the command line's JSON has it, angles in degrees: "x", "phi_deg"."""
        return {a.json_key: a.outer(v) for v, a in zip(self, self.axes, strict=True)}

    def with_values(self: V, **values: float) -> V:
        """The same with some of them replaced: ``pose.with_values(x=10.0)``, mm and rad.

        Raises:
            InputError: there is no such coordinate.
        """
        return type(self)(filled(self, self.axes, values), self.axes)


class Pose(Values):
    """Where a platform is: mm and rad in the machine's own coordinates, see `Values`.

    Example:
        >>> import kinematics as kin
        >>> pose = kin.open("rpur-table1").pose(x=90, y=110, z=430, phi=0.1)
        >>> pose.phi, round(pose.degrees["phi"], 4)
        (0.1, 5.7296)
    """


class Joints(Values):
    """The actuated joints of a machine, mm and rad, see `Values`."""


def filled(
    start: Iterable[float], axes: tuple[Coordinate, ...], named: Mapping[str, float]
) -> list[float]:
    """Values with those that are named replaced.

    Raises:
        InputError: there is no such coordinate, or it is no number.
    """
    known = [axis.key for axis in axes]
    for key in named:
        if key not in known:
            raise InputError(f"there is no coordinate {key!r}; there are {', '.join(known)}")
    named = {key: number(value, key) for key, value in named.items()}
    return [named.get(key, value) for key, value in zip(known, start, strict=True)]
