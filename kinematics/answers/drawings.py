"""How a machine is drawn: shapes with a role, no colours and no widgets. mm, base frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinematics.arrays import Array

Role = Literal["base", "platform", "cylinder", "rod", "link", "joint", "rail", "stop", "gap"]
Frame = Literal["base", "platform"]
Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Bar:
    """A round bar from ``start`` to ``end`` (base frame, mm).

    A "rail" runs along the whole stroke, a "stop" marks one end of it, and a "gap" is what a
    limb that cannot close is short of.
    """

    name: str
    start: Point
    end: Point
    radius: float
    role: Role
    limb: int | None = None


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid body: the hull of balls of ``radius`` about ``points``, fixed in ``frame``."""

    name: str
    points: tuple[Point, ...]
    radius: float
    role: Role
    frame: Frame


@dataclass(frozen=True, slots=True)
class Mark:
    """A named point or axis to label on demand (base frame, mm)."""

    name: str
    text: str
    position: Point
    limb: int | None = None
    direction: Point | None = None


@dataclass(frozen=True, slots=True)
class Dimension:
    """What numbers of a design measure in the drawing: from ``start`` to ``end``, base frame, mm.

    Attributes:
        symbol: as "l₁" or "r₁".
        text: what it is, in a few words.
        kind: a "length"; a "vector" whose components are the numbers; a "stroke", whose ends they
            are; a "direction"; an "angle" from +x to the line from start to end.
        paths: where its numbers stand in the design's table, each a path or the beginning of one.
        limb: whose it is, from 1; None of the whole machine's.
    """

    symbol: str
    text: str
    kind: Literal["length", "vector", "stroke", "direction", "angle"]
    start: Point
    end: Point
    paths: tuple[tuple[str | int, ...], ...]
    limb: int | None = None


@dataclass(frozen=True, slots=True)
class Drawing:
    """A machine at one posture; ``size`` is a typical length of it, mm.

    ``dimensions`` say what the numbers of its design are; of all limbs alike.
    """

    bars: tuple[Bar, ...]
    bodies: tuple[Body, ...]
    points: tuple[Mark, ...]
    axes: tuple[Mark, ...]
    size: float
    dimensions: tuple[Dimension, ...] = ()


def prismatic(
    limb: int, start: Array, end: Array, stroke: Array, thick: float, upright: float
) -> Iterator[Bar]:
    """A prismatic actuator of a limb (from 1): cylinder, rod, the rail of its stroke with stops.

    Args:
        start, end: (3,) mm, where it is fixed and where its rod ends.
        stroke: (2,) mm, its shortest and longest length.
        thick: mm, the cylinder's radius.
        upright: mm; an actuator that is not longer is drawn along z.
    """
    name, (low, high) = f"limb{limb}", stroke
    unit = direction(end - start, upright)
    # A real cylinder is as long as the shortest actuator; with ρ_min = 0 a third of the longest.
    barrel = min(
        float(np.linalg.norm(end - start)), 0.92 * low if low > 0.25 * high else 0.33 * high
    )
    joint = start + barrel * unit
    yield Bar(f"{name}/cylinder", spot(start), spot(joint), thick, "cylinder", limb)
    yield Bar(f"{name}/rod", spot(joint), spot(end), 0.55 * thick, "rod", limb)
    ends = start + low * unit, start + high * unit
    yield Bar(f"{name}/rail", spot(ends[0]), spot(ends[1]), 0.16 * thick, "rail", limb)
    half = 0.12 * thick * unit
    for key, at in zip(("min", "max"), ends, strict=True):
        yield Bar(f"{name}/{key}", spot(at - half), spot(at + half), 0.95 * thick, "stop", limb)


def direction(along: Array, short: float) -> Array:
    """The unit vector along (3,); that of z where it is no longer than ``short``, mm."""
    length = float(np.linalg.norm(along))
    return np.asarray(along / length if length > short else np.array([0.0, 0.0, 1.0]))


def spot(point: Array) -> Point:
    """A point (3,) as drawings have it."""
    x, y, z = point.tolist()
    return x, y, z


def joint(limb: int, key: str, at: Array, half: Array, radius: float) -> Bar:
    """A joint of a limb (from 1) at (3,): a bar of ``half`` (3,) to both sides, mm.

    A revolute joint is a pin along its axis, a spherical one a bar that is shorter than thick.
    """
    return Bar(f"limb{limb}/{key}", spot(at - half), spot(at + half), radius, "joint", limb)


def letters(limb: int, **points: Array) -> list[Mark]:
    """Joint points of a limb (from 1) by their letters, as ``A=(3,)``."""
    mark = chr(ord("₀") + limb)
    return [Mark(f"limb{limb}/{key}", f"{key}{mark}", spot(at), limb) for key, at in points.items()]


def pedestals(base: Array, floor: float, radius: float) -> Iterator[Bar]:
    """What base points (N, 3) stand on, from the floor up."""
    for i, point in enumerate(base):
        foot = np.array([point[0], point[1], floor])
        yield Bar(f"limb{i + 1}/pedestal", spot(foot), spot(point), radius, "base")


def corners(points: Iterable[Array]) -> tuple[Point, ...]:
    """The corners of a body, each once."""
    return tuple(dict.fromkeys(spot(point) for point in points))


def round_plate(middle: Array, radius: float, floor: float, count: int) -> tuple[Point, ...]:
    """The rim of a round plate about (2,), mm."""
    turns = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    x, y = middle[0] + radius * np.cos(turns), middle[1] + radius * np.sin(turns)
    return corners(np.stack([x, y, np.full(count, floor)], axis=-1))
