"""Boxes for whole poses, lists of poses and limits: text, one can paste into, in page units."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

import viser

from app.review.units import from_page_units, in_page_units, page_unit
from app.widgets.desk import Desk, put
from app.widgets.plots import number
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate

DIGITS = 4  # of mm and degrees; what was typed stays as it was typed


class Typed:
    """A text box for numbers: what is typed and means the same is left alone."""

    def __init__(
        self, desk: Desk, handle: viser.GuiTextHandle, axes: Sequence[Coordinate], what: str
    ) -> None:
        self._desk = desk
        self.handle = handle
        self._axes = tuple(axes)
        self._what = what

    def read(self) -> Any:
        """What stands in the box, in mm and rad.

        Raises:
            InputError: it cannot be used.
        """
        raise NotImplementedError

    def write(self, value: Any) -> str:
        """How a value can be typed."""
        raise NotImplementedError

    def draw(self, value: Any) -> None:
        """Show a value."""
        try:
            same = self.read() == value or self.write(self.read()) == self.write(value)
        except InputError:
            same = False
        if not same:
            put(self._desk, self.handle, self.write(value))


class PoseBox(Typed):
    """A pose; empty for none."""

    def read(self) -> tuple[float, ...]:
        return typed_pose(self.handle.value, self._axes, self._what)

    def write(self, value: Any) -> str:
        return shown_pose(value, self._axes)


class PosesBox(Typed):
    """Poses, one a line."""

    def read(self) -> tuple[tuple[float, ...], ...]:
        lines = [line for line in self.handle.value.splitlines() if line.strip()]
        return tuple(
            typed_pose(line, self._axes, f"{self._what} {n}") for n, line in enumerate(lines, 1)
        )

    def write(self, value: Any) -> str:
        return "\n".join(shown_pose(pose, self._axes) for pose in value)


class LimitsBox(Typed):
    """A positive number for each joint, or one for all; empty for none."""

    def __init__(
        self,
        desk: Desk,
        handle: viser.GuiTextHandle,
        joints: Sequence[Coordinate],
        what: str,
        *,
        turning: bool,
    ) -> None:
        super().__init__(desk, handle, joints, what)
        self._turning = turning  # they count angles where a joint turns

    def _scale(self, joint: Coordinate) -> float:
        return math.radians(1.0) if self._turning and joint.unit == "rad" else 1.0

    def read(self) -> tuple[float, ...]:
        values = typed_numbers(self.handle.value, self._what)
        if len(values) == 1:
            values *= len(self._axes)
        if values and len(values) != len(self._axes):
            raise InputError(
                f"{self._what}: one number for all joints, or {len(self._axes)} of them"
            )
        if any(value <= 0.0 for value in values):
            raise InputError(f"{self._what}: limits are positive")
        return tuple(v * self._scale(c) for v, c in zip(values, self._axes, strict=False))

    def write(self, value: Any) -> str:
        shown = [number(v / self._scale(c)) for v, c in zip(value, self._axes, strict=False)]
        return shown[0] if len(set(shown)) == 1 else ", ".join(shown)


def shown_pose(pose: Sequence[float], axes: Sequence[Coordinate]) -> str:
    """ "90, 110, 430, 5, −3"."""
    return ", ".join(
        number(round(in_page_units(c, v), DIGITS)) for c, v in zip(axes, pose, strict=False)
    )


def typed_pose(text: str, axes: Sequence[Coordinate], what: str) -> tuple[float, ...]:
    """A pose as it was typed, () where there is nothing.

    Raises:
        InputError: not as many finite numbers as a pose has.
    """
    values = typed_numbers(text, what)
    if values and len(values) != len(axes):
        raise InputError(f"{what} needs {len(axes)} numbers: {units(axes)}")
    return tuple(from_page_units(c, v) for c, v in zip(axes, values, strict=False))


def typed_numbers(text: str, what: str) -> tuple[float, ...]:
    """Numbers with commas, semicolons or spaces between them.

    Raises:
        InputError: something else stands there.
    """
    words = re.split(r"[\s,;]+", text.strip().replace("−", "-"))
    try:
        values = tuple(float(word) for word in words if word)
    except ValueError:
        raise InputError(f"{what}: numbers with commas between them") from None
    if not all(map(math.isfinite, values)):
        raise InputError(f"{what}: finite numbers")
    return values


def units(axes: Sequence[Coordinate]) -> str:
    """ "x, y, z (mm), φ, θ (°)"."""
    groups: list[tuple[str, list[str]]] = []
    for c in axes:
        if not groups or groups[-1][0] != page_unit(c):
            groups.append((page_unit(c), []))
        groups[-1][1].append(c.symbol)
    return ", ".join(f"{', '.join(names)} ({unit})" for unit, names in groups)
