"""The 3-RPS and 3-SPR as machines: which bars, bodies and marks stand where at one posture."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinematics.answers.drawings import (
    Bar,
    Body,
    Dimension,
    Drawing,
    Mark,
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
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import LIMBS, RADIAL, SUBSCRIPTS, TripodDesign
from kinematics.mechanisms.tripods.limbs import joint_points, revolute_axes

_CORNERS = 24  # of the round base


def drawing(design: TripodDesign, posture: Posture) -> Drawing:
    """The machine at ``posture``, in the base frame, mm."""
    pose, mode = np.array(posture.pose), posture.mode
    a, b = joint_points(design, pose, mode)
    axes = revolute_axes(design, pose, mode)
    matrix = posing.transform(design, pose, mode)
    size = design.size
    bars: list[Bar] = []
    points: list[Mark] = []
    marks: list[Mark] = []
    for i in range(LIMBS):
        limb = i + 1
        if posture.closes:
            bars += _limb(design, limb, a[i], b[i], axes[i], size)
        else:
            bars.append(Bar(f"limb{limb}/gap", spot(a[i]), spot(b[i]), 0.012 * size, "gap", limb))
        points += letters(limb, A=a[i], B=b[i])
        hinge = a[i] if design.revolute_on_base else b[i]
        marks.append(Mark(f"s{limb}", f"s{SUBSCRIPTS[i]}", spot(hinge), limb, spot(axes[i])))
    floor, platform = -0.12 * size, corners(design.platform_radius * RADIAL)
    bars += pedestals(a, floor, 0.032 * size)
    plate = round_plate(np.zeros(2), design.base_radius + 0.1 * size, floor, _CORNERS)
    centre, azimuth = matrix[:3, 3], float(pose[2])
    tilt_axis = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    marks += [
        Mark("tilt", "tilt axis", spot(centre), None, spot(tilt_axis)),
        Mark("normal", "platform normal", spot(centre), None, spot(matrix[:3, 2])),
    ]
    points += [Mark("O", "O′", spot(centre))]
    return Drawing(
        bars=tuple(bars),
        bodies=(
            Body("platform", platform, 0.02 * size, "platform", "platform"),
            Body("base", plate, 0.02 * size, "base", "base"),
        ),
        points=tuple(points),
        axes=tuple(marks),
        size=size,
        dimensions=tuple(_dimensions(a, b, centre)),
    )


def _dimensions(a: Array, b: Array, centre: Array) -> Iterator[Dimension]:
    """What the design's numbers are: of all limbs alike, so that those of any one are its own."""
    zero, at, stroke = spot(np.zeros(3)), spot(centre), (("stroke",),)
    base, platform = (("base_radius",),), (("platform_radius",),)
    for i in range(LIMBS):
        joint_a, joint_b = spot(a[i]), spot(b[i])
        told = "radius of the base, from O to A", "radius of the platform, from O′ to B"
        yield Dimension("h₁", told[0], "length", zero, joint_a, base, i + 1)
        yield Dimension("h₂", told[1], "length", at, joint_b, platform, i + 1)
        name, text = f"ρ{SUBSCRIPTS[i]}", "actuator from A to B, ρ min … ρ max"
        yield Dimension(name, text, "stroke", joint_a, joint_b, stroke, i + 1)


def _limb(
    design: TripodDesign, limb: int, a: Array, b: Array, axis: Array, size: float
) -> Iterator[Bar]:
    unit, thick = direction(b - a, 1e-9 * size), 0.026 * size
    yield from prismatic(limb, a, b, np.array(design.stroke), thick, 1e-9 * size)
    hinge, ball = (a, b) if design.revolute_on_base else (b, a)
    pin, round_ = ("R_A", "S_B") if design.revolute_on_base else ("R_B", "S_A")
    yield joint(limb, pin, hinge, 1.7 * thick * axis, 0.7 * thick)
    yield joint(limb, round_, ball, 0.4 * thick * unit, 1.3 * thick)
