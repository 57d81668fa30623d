"""The 3-RPS and 3-SPR as machines: which bars, bodies and marks stand where at one posture."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinematics.answers.drawings import Bar, Body, Drawing, Mark, direction, prismatic, spot
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import LIMBS, RADIAL, SUBSCRIPTS, TripodDesign

_CORNERS = 24  # of the round base


def drawing(design: TripodDesign, posture: Posture) -> Drawing:
    """The machine at ``posture``, in the base frame, mm."""
    pose, mode = np.array(posture.pose), posture.mode
    a, b = posing.joint_points(design, pose, mode)
    axes = posing.revolute_axes(design, pose, mode)
    matrix = posing.transform(design, pose, mode)
    size = design.size
    bars: list[Bar] = []
    points: list[Mark] = []
    marks: list[Mark] = []
    for i in range(LIMBS):
        limb = i + 1
        if posture.closes:
            bars += _limb(design, i, a[i], b[i], axes[i], size)
        else:
            bars.append(Bar(f"limb{limb}/gap", spot(a[i]), spot(b[i]), 0.012 * size, "gap", limb))
        points += [
            Mark(f"limb{limb}/A", f"A{SUBSCRIPTS[i]}", spot(a[i]), limb),
            Mark(f"limb{limb}/B", f"B{SUBSCRIPTS[i]}", spot(b[i]), limb),
        ]
        hinge = a[i] if design.revolute_on_base else b[i]
        marks.append(Mark(f"s{limb}", f"s{SUBSCRIPTS[i]}", spot(hinge), limb, spot(axes[i])))
    bars += _pedestals(a, size)
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
            Body("platform", _platform(design), 0.02 * size, "platform", "platform"),
            Body("base", _plate(design, size), 0.02 * size, "base", "base"),
        ),
        points=tuple(points),
        axes=tuple(marks),
        size=size,
    )


def _limb(
    design: TripodDesign, i: int, a: Array, b: Array, axis: Array, size: float
) -> Iterator[Bar]:
    limb, name = i + 1, f"limb{i + 1}"
    unit, thick = direction(b - a, 1e-9 * size), 0.026 * size
    yield from prismatic(limb, a, b, np.array(design.stroke), thick, 1e-9 * size)
    # A revolute joint is a pin along its axis, a spherical one a ball: a bar shorter than thick.
    hinge, ball = (a, b) if design.revolute_on_base else (b, a)
    pin, round_ = ("R_A", "S_B") if design.revolute_on_base else ("R_B", "S_A")
    half = 1.7 * thick * axis
    yield Bar(f"{name}/{pin}", spot(hinge - half), spot(hinge + half), 0.7 * thick, "joint", limb)
    half = 0.4 * thick * unit
    yield Bar(f"{name}/{round_}", spot(ball - half), spot(ball + half), 1.3 * thick, "joint", limb)


def _pedestals(a: Array, size: float) -> Iterator[Bar]:
    for i in range(LIMBS):
        foot = a[i] - np.array([0.0, 0.0, 0.12 * size])
        yield Bar(f"limb{i + 1}/pedestal", spot(foot), spot(a[i]), 0.032 * size, "base")


def _platform(design: TripodDesign) -> tuple[tuple[float, float, float], ...]:
    """The triangle of its joints, cut at the corners, and the side at joint 1 told by a tip."""
    corners = design.platform_radius * RADIAL
    return tuple(spot(corner) for corner in corners)


def _plate(design: TripodDesign, size: float) -> tuple[tuple[float, float, float], ...]:
    turns = np.linspace(0.0, 2.0 * np.pi, _CORNERS, endpoint=False)
    radius, floor = design.base_radius + 0.1 * size, -0.12 * size
    return tuple(
        spot(np.array([radius * np.cos(turn), radius * np.sin(turn), floor])) for turn in turns
    )
