"""The trajectory of a review in its session file: lengths in mm, angles in degrees, times in s."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from app.features.trajectory.state import Plan, Pose, axes_of, checked_plan
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate

if TYPE_CHECKING:
    from app.review.state import Review

_ENDS = ("start", "end")
_LISTS = ("points", "file", "stroke")
_TURNING = ("rates", "accelerations")  # limits that are of angles where a joint turns


def plan_table(review: Review) -> dict[str, Any]:
    """What `plan_from_table` reads; a pose is one line of numbers, so that paths stay short."""
    plan, axes = review.plan, axes_of(review)
    joints = review.machine.joints
    table: dict[str, Any] = {f.name: getattr(plan, f.name) for f in fields(Plan)}
    for name in _ENDS:
        table[name] = _written(table[name], axes)
    for name in _LISTS:
        table[name] = [_written(pose, axes) for pose in table[name]]
    table["times"] = " ".join(map(repr, plan.times))
    for name in _TURNING:
        table[name] = [_outward(c, v) for c, v in zip(joints, table[name], strict=False)]
    return table


def plan_from_table(given: Any, review: Review, origin: str) -> Plan:
    """The trajectory; sessions saved before there was one have that of a new review.

    Raises:
        InputError: naming the origin and what cannot be used.
    """
    if not isinstance(given, dict):
        raise InputError(f"{origin}: 'trajectory' is not of the right kind")
    axes = axes_of(review)
    joints = review.machine.joints
    values: dict[str, Any] = {}
    for f in fields(Plan):
        if f.name not in given:
            continue
        value, what = given[f.name], f"{origin}: trajectory: {f.name}"
        if f.name in _ENDS:
            value = _pose(value, axes, what)
        elif f.name in _LISTS:
            if not isinstance(value, list):
                raise InputError(f"{what} is not of the right kind")
            value = tuple(_pose(each, axes, what) for each in value)
        elif f.name == "times":
            value = _numbers(value, what)
        elif isinstance(value, list):
            if f.name == "plane":
                value = tuple(value) if len(value) == 2 else value
            else:
                value = tuple(_number(v, what) for v in value)
                if f.name in _TURNING and len(value) == len(joints):
                    value = tuple(_inward(c, v) for c, v in zip(joints, value, strict=True))
        elif isinstance(f.default, float):
            value = _number(value, what)
        values[f.name] = value
        # A bool is an int to Python, and not to whoever writes a file.
        if type(value) is not type(f.default):
            raise InputError(f"{what} is not of the right kind")
    if not all(isinstance(key, str) for key in values.get("plane", ())):
        raise InputError(f"{origin}: trajectory: plane is not of the right kind")
    try:
        return checked_plan(replace(review.plan, **values), review)
    except InputError as error:
        raise InputError(f"{origin}: trajectory: {error}") from None


def _written(pose: Pose, axes: Sequence[Coordinate]) -> str:
    return " ".join(repr(_outward(c, v)) for c, v in zip(axes, pose, strict=False))


def _pose(text: Any, axes: Sequence[Coordinate], what: str) -> Pose:
    values = _numbers(text, what)
    if values and len(values) != len(axes):
        raise InputError(f"{what}: a pose has {len(axes)} numbers, got {len(values)}")
    return tuple(_inward(c, v) for c, v in zip(axes, values, strict=False))


def _numbers(text: Any, what: str) -> tuple[float, ...]:
    if not isinstance(text, str):
        raise InputError(f"{what} is not of the right kind")
    try:
        return tuple(map(float, text.split()))
    except ValueError:
        raise InputError(f"{what}: not numbers with spaces between them") from None


def _number(value: Any, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{what} must be a finite number")
    return float(value)


def _outward(c: Coordinate, value: float) -> float:
    return value if c.unit == "mm" else math.degrees(value)


def _inward(c: Coordinate, value: float) -> float:
    return value if c.unit == "mm" else math.radians(value)
