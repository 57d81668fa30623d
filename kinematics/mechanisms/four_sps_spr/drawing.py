"""The 4-SPS + 1-SPR as a machine: which bars, bodies and marks stand where at one posture."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinematics.answers.drawings import (
    Bar,
    Body,
    Dimension,
    Drawing,
    Mark,
    Point,
    corners,
    direction,
    joint,
    letters,
    pedestals,
    prismatic,
    round_plate,
    spot,
)
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import platform_points, rotation, transform

_CORNERS = 20  # of the base plate's rim


def drawing(design: FourSPSSPRDesign, posture: Posture) -> Drawing:
    """The machine at ``posture``, in the base frame, mm."""
    tips = platform_points(design, posture.pose)
    size = machine_size(design)
    axis = rotation(posture.pose) @ design.axis
    bars: list[Bar] = []
    points: list[Mark] = []
    for i in range(LIMBS):
        limb = i + 1
        end = tips[i]
        if not np.isfinite(posture.joints[i]):  # limb 5 where the constraint is violated
            end = _nearest_tip(design, tips[i], axis)
            bars.append(Bar(f"limb{limb}/gap", spot(end), spot(tips[i]), 0.014 * size, "gap", limb))
        bars += _leg(design, i, end, size)
        points += letters(limb, A=design.base[i], B=tips[i])
    thick = _thick(size)
    bars.append(joint(SPR + 1, "R_B", tips[SPR], 2.6 * thick * axis, 0.75 * thick))
    floor = float(design.base[:, 2].min() - 0.09 * size)
    bars += pedestals(design.base, floor, 0.026 * size)
    placed = transform(posture.pose)
    # With its origin, so that even coincident joints make a body.
    platform = corners([*design.platform, np.zeros(3)])
    return Drawing(
        bars=tuple(bars),
        bodies=(
            Body("platform", platform, 0.018 * size, "platform", "platform"),
            Body("base", _plate(design, floor, size), 0.016 * size, "base", "base"),
        ),
        points=(*points, Mark("p", "p", spot(placed[:3, 3]))),
        axes=(Mark("n6", "n₆", spot(tips[SPR]), SPR + 1, spot(axis)),),
        size=size,
        dimensions=tuple(_dimensions(design, tips, placed[:3, 3], axis, 0.4 * size)),
    )


def _dimensions(
    design: FourSPSSPRDesign, tips: Array, centre: Array, axis: Array, long: float
) -> Iterator[Dimension]:
    """What the design's numbers are; that of a direction is drawn so ``long``."""
    zero, at = spot(np.zeros(3)), spot(centre)
    told = "base point A, from O, base frame", "platform point B, from p, platform frame"
    for i in range(LIMBS):
        mark, joint_a, joint_b = chr(ord("₁") + i), spot(design.base[i]), spot(tips[i])
        base, platform, stroke = ((("limb", i, key),) for key in ("base", "platform", "stroke"))
        yield Dimension(f"a{mark}", told[0], "vector", zero, joint_a, base, i + 1)
        yield Dimension(f"b{mark}", told[1], "vector", at, joint_b, platform, i + 1)
        yield Dimension(
            f"l{mark}", "actuator from A to B, l min … l max", "stroke", joint_a, joint_b, stroke,
            i + 1,
        )  # fmt: skip
    end = tips[SPR] + long * axis
    text = "axis of the revolute joint at B₅, platform frame"
    paths = (("revolute_axis",),)
    yield Dimension("n₆", text, "direction", spot(tips[SPR]), spot(end), paths, SPR + 1)


def machine_size(design: FourSPSSPRDesign) -> float:
    """A typical length of the machine, mm: of a leg that is nearly stretched."""
    return float(0.8 * np.mean(design.stroke[:, 1]))


def _thick(size: float) -> float:
    return 0.018 * size


def _leg(design: FourSPSSPRDesign, i: int, end: Array, size: float) -> Iterator[Bar]:
    limb, a, thick = i + 1, design.base[i], _thick(size)
    unit = direction(end - a, 1e-9 * size)
    yield from prismatic(limb, a, end, design.stroke[i], thick, 1e-9 * size)
    ball = 0.35 * thick * unit
    yield joint(limb, "S_A", a, ball, 1.45 * thick)
    if i != SPR:
        yield joint(limb, "S_B", end, ball, 1.2 * thick)


def _nearest_tip(design: FourSPSSPRDesign, tip: Array, axis: Array) -> Array:
    """Where limb 5 ends that cannot reach: B_5 moved along the axis into the limb's plane."""
    return np.asarray(tip + ((design.base[SPR] - tip) @ axis) * axis)


def _plate(design: FourSPSSPRDesign, floor: float, size: float) -> tuple[Point, ...]:
    """A round plate under all base points."""
    middle = 0.5 * (design.base[:, :2].min(axis=0) + design.base[:, :2].max(axis=0))
    radius = float(np.linalg.norm(design.base[:, :2] - middle, axis=1).max()) + 0.08 * size
    return round_plate(middle, radius, floor, _CORNERS)
