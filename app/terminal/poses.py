"""Poses as commands are told them: whole, coordinate by coordinate, or as an orientation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import isnan
from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.answers.coordinates import Coordinate, Pose
    from kinematics.answers.solutions import Posture
    from kinematics.facets.spaces import Space
    from kinematics.machine import Machine


@dataclass(frozen=True, slots=True)
class Given:
    """What was said of a pose: numbers by coordinate, mm and degrees, NaN for "-".

    ``whole``: it was said as a whole, by --pose.
    """

    machine: Machine[Any]
    typed: Mapping[str, float]
    whole: bool

    @staticmethod
    def read(machine: Machine[Any], pose: str | None, said: Mapping[str, str]) -> Given:
        """By --pose, or by options of the coordinates' own names."""
        axes = machine.coordinates
        if pose is None:
            told = {
                axis.key: values.number(f"--{axis.key}: {axis.symbol}", said[axis.key], dash=True)
                for axis in axes
                if axis.key in said
            }
            return Given(machine, told, False)
        for key in said:
            raise InputError(
                f"--{key} is for all positions together, or for a pose coordinate by coordinate; "
                "leave it or --pose out"
            )
        numbers = values.of_pose("--pose", pose, machine)
        told = {axis.key: value for axis, value in zip(axes, numbers, strict=True)}
        return Given(machine, told, True)

    @property
    def positioned(self) -> bool:
        """Whether a place was said, and not only an orientation."""
        return any(
            axis.unit == "mm" and axis.key in self.typed for axis in self.machine.coordinates
        )

    @property
    def _free(self) -> list[str]:
        """What is left to the mechanism."""
        return [key for key, value in self.typed.items() if isnan(value)]

    def place(self, mode: str) -> Place:
        """The pose in a mode; what was not said is home's, but for what follows from the rest.

        Raises:
            InputError: there is no such pose, or more is open than can follow.
        """
        if len(self._free) > 1:
            raise InputError(f"--{self._free[-1]}: only one coordinate may be -")
        axes = [axis for axis in self.machine.coordinates if axis.key in self.typed]
        pose = self.machine.pose(mode, **_named((axis, self.typed[axis.key]) for axis in axes))
        said = {key: value for key, value in self.typed.items() if not isnan(value)}
        return Place(self.machine, pose, {**pose.degrees, **said}, mode)

    def angles(self, solid: str = "") -> Angles:
        """Its angles; 0 for those of which nothing was said.

        Args:
            solid: the key of a solid that is asked for: only angles that it depends on are told.

        Raises:
            InputError: a position was said, an angle that does not matter, or more angles are open
                than can follow.
        """
        machine = self.machine
        turned = [(a, self.typed.get(a.key, 0.0)) for a in machine.coordinates if a.unit == "rad"]
        free = [axis.key for axis, value in turned if isnan(value)]
        allowed = {machine.coordinates[n].key for n in machine.dependent}
        if len(free) > 1 or not allowed.issuperset(free):
            why = f"no angle of a {machine.title} follows from the others"
            why = "only one angle may be -" if len(free) > 1 else why
            raise InputError(f"--{free[-1]}: {why}")
        held = [each for each in turned if not solid or _matters(machine, solid, turned, each[0])]
        for axis in machine.coordinates:
            if axis.key in self.typed and axis not in dict(held) and not self.whole:
                raise InputError(
                    f"--{axis.key}: what is asked is of all values of {axis.symbol}; leave "
                    f"--{axis.key} out"
                )
        return Angles(machine, turned, held)


Typed = list[tuple["Coordinate", float]]


def _named(typed: Iterable[tuple[Coordinate, float]]) -> dict[str, float | None]:
    """As the library takes coordinates by name."""
    return {axis.json_key: None if isnan(value) else value for axis, value in typed}


def _matters(machine: Machine[Any], key: str, turned: Typed, asked: Coordinate) -> bool:
    """Whether a solid is another one, or stands elsewhere, at another angle."""
    from kinematics.facets.facet import required

    solids, found = required(machine.solids, "solids"), []
    for more in (0.0, 10.0):
        angles = {axis: axis.inner(value + more * (axis is asked)) for axis, value in turned}
        pose = [angles.get(axis, 0.0) for axis in machine.coordinates]
        request = solids.request(key, pose, (machine.home.mode,), "preview")
        found.append((request, solids.placement(key, pose).tobytes()))
    return isnan(angles[asked]) or found[0] != found[1]


@dataclass(frozen=True, slots=True)
class Angles:
    """An orientation, degrees; NaN for the angle that follows from the others.

    ``held``: the angles on which depends what is asked.
    """

    machine: Machine[Any]
    turned: Typed
    held: Typed

    @property
    def follows(self) -> int | None:
        """Which coordinate follows."""
        free = [axis for axis, value in self.turned if isnan(value)]
        return self.machine.coordinates.index(free[0]) if free else None

    def space(self, modes: tuple[str, ...] | None) -> Space[Any]:
        """The workspace at it."""
        return self.machine.workspace(modes, **_named(self.turned))

    def text(self) -> str:
        """ "φ = 10°, θ = -5°"."""
        return ", ".join(
            f"{axis.symbol} follows" if isnan(value) else f"{axis.symbol} = {value:g}°"
            for axis, value in self.held
        )

    def entries(self) -> dict[str, float | None]:
        """For JSON; null for what is left to the mechanism."""
        return {axis.json_key: tables.finite(value) for axis, value in self.held}


@dataclass(frozen=True)
class Place:
    """A machine at a pose in one mode, and the pose as typed and completed, mm and degrees."""

    machine: Machine[Any]
    pose: Pose
    shown: Mapping[str, float]
    mode: str

    @cached_property
    def posture(self) -> Posture:
        return self.machine.posture(self.pose, self.mode)

    @property
    def pose_text(self) -> str:
        """ "Pose x = 90 mm, φ = 5°"."""
        return f"Pose {tables.with_units([*self.shown.values()], self.machine.coordinates)}"

    @property
    def where(self) -> str:
        """ "Pose x = 90 mm, …, working mode +-+++"."""
        return f"{self.pose_text}{tables.mode_text(self.machine, self.mode)}"

    @property
    def entries(self) -> dict[str, Any]:
        """The pose and the mode for JSON."""
        pose = {axis.json_key: self.shown[axis.key] for axis in self.machine.coordinates}
        return {"pose": pose, **tables.mode_entry(self.machine, self.mode)}
