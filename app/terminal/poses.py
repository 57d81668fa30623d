"""Poses as commands are told them: whole, coordinate by coordinate, or as an orientation."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isnan, nan
from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.answers.solutions import Posture
    from kinematics.machine import Machine
    from kinematics.mechanism import Coordinate


@dataclass(frozen=True, slots=True)
class Given:
    """What was said of a pose, mm and degrees: NaN for "-", None where nothing was said.

    ``whole``: it was said as a whole, by --pose.
    """

    machine: Machine[Any]
    typed: tuple[float | None, ...]
    whole: bool

    @staticmethod
    def read(machine: Machine[Any], pose: str | None, said: Mapping[str, str]) -> Given:
        """By --pose, or by options of the coordinates' own names."""
        axes = machine.coordinates
        if pose is not None:
            for key in said:
                raise InputError(
                    f"--{key} is for all positions together, or for a pose coordinate by "
                    "coordinate; leave it or --pose out"
                )
            return Given(machine, (*values.of_axes("--pose", pose, axes, dash=True),), True)
        typed = [
            values.number(f"--{axis.key}: {axis.symbol}", said[axis.key], dash=True)
            if axis.key in said
            else None
            for axis in axes
        ]
        return Given(machine, tuple(typed), False)

    @property
    def positioned(self) -> bool:
        """Whether a place was said, and not only an orientation."""
        of_place = (axis.unit == "mm" for axis in self.machine.coordinates)
        return any(v is not None for v, own in zip(self.typed, of_place, strict=True) if own)

    def place(self, mode: str) -> Place:
        """The pose in a mode; what was not said is home's, but for what follows from the rest.

        Raises:
            InputError: there is no such pose, or more is open than can follow.
        """
        machine, axes = self.machine, self.machine.coordinates
        if len(free := self._open) > 1:
            raise InputError(f"--{axes[free[-1]].key}: only one coordinate may be -")
        home = tables.outer(machine.home.pose, axes) if None in self.typed else ()
        shown = [home[n] if v is None else v for n, v in enumerate(self.typed)]
        pose = tuple(tables.inner(value, axis) for value, axis in zip(shown, axes, strict=True))
        unsaid = [n for n in machine.dependent if self.typed[n] is None and not free]
        for n in unsaid:
            try:
                pose = machine.complete_pose((*pose[:n], nan, *pose[n + 1 :]), mode)
                break
            except InputError:
                if n == unsaid[-1]:
                    raise
        if free:
            pose = machine.complete_pose(pose, mode)
        inner = tables.outer(pose, axes)
        typed = (v if v is not None and not isnan(v) else nan for v in self.typed)
        shown = [w if isnan(v) else v for v, w in zip(typed, inner, strict=True)]
        return Place(machine, pose, shown, mode)

    @property
    def _open(self) -> list[int]:
        return [n for n, value in enumerate(self.typed) if value is not None and isnan(value)]

    def orientation(
        self, asked: Callable[[Sequence[float]], Hashable] | None = None, what: str = ""
    ) -> Orientation:
        """Its angles; 0 for those of which nothing was said.

        Args:
            asked: the question put at a pose, called ``what``: only angles that it depends on are
                told.

        Raises:
            InputError: a position was said, an angle that does not matter, or more angles are open
                than can follow.
        """
        machine = self.machine
        turning = [n for n, axis in enumerate(machine.coordinates) if axis.unit == "rad"]
        said = [n for n, v in enumerate(self.typed) if v is not None and not self.whole]
        pose = [
            tables.inner(value or 0.0, axis) if axis.unit == "rad" else 0.0
            for value, axis in zip(self.typed, machine.coordinates, strict=True)
        ]
        free = [n for n in self._open if n in turning]
        if len(free) > 1 or any(n not in machine.dependent for n in free):
            why = f"no angle of a {machine.title} follows from the others"
            why = "only one angle may be -" if len(free) > 1 else why
            raise InputError(f"--{machine.coordinates[free[-1]].key}: {why}")
        held = [
            n
            for n in turning
            if n in free or asked is None or asked(_turned(pose, n)) != asked(pose)
        ]
        for n in said:
            if n not in held:
                key, symbol = machine.coordinates[n].key, machine.coordinates[n].symbol
                of = f" ({what})" if what else ""
                raise InputError(
                    f"--{key}: what is asked{of} is of all values of {symbol}; leave --{key} out"
                )
        angles = [(machine.coordinates[n], self.typed[n] or 0.0) for n in held]
        return Orientation(pose, angles, free[0] if free else None)


def _turned(pose: Sequence[float], n: int) -> list[float]:
    return [value + 0.1 * (k == n) for k, value in enumerate(pose)]


@dataclass(frozen=True, slots=True)
class Orientation:
    """A pose of which only the angles matter, mm and rad; NaN for the one that is ``open``, which
    follows from the others. ``angles`` with what was typed, degrees."""

    pose: list[float]
    angles: list[tuple[Coordinate, float]]
    open: int | None

    def text(self) -> str:
        """ "φ = 10°, θ = -5°"."""
        return ", ".join(
            f"{axis.symbol} follows" if isnan(value) else f"{axis.symbol} = {value:g}°"
            for axis, value in self.angles
        )

    def entries(self) -> dict[str, float | None]:
        """For JSON; null for what is left to the mechanism."""
        return {tables.key(axis): tables.finite(value) for axis, value in self.angles}


@dataclass(frozen=True)
class Place:
    """A machine at a pose in one mode: mm and rad, and ``shown`` as typed and completed, mm and
    degrees."""

    machine: Machine[Any]
    pose: tuple[float, ...]
    shown: list[float]
    mode: str

    @cached_property
    def posture(self) -> Posture:
        return self.machine.inverse.posture(self.pose, self.mode)

    @property
    def where(self) -> str:
        """ "x = 90 mm, …, working mode +-+++"."""
        where = tables.with_units(self.shown, self.machine.coordinates)
        return f"{where}{tables.mode_text(self.machine, self.mode)}"

    @property
    def entries(self) -> dict[str, Any]:
        """The pose and the mode for JSON."""
        keys = map(tables.key, self.machine.coordinates)
        pose = dict(zip(keys, self.shown, strict=True))
        return {"pose": pose, **tables.mode_entry(self.machine, self.mode)}
