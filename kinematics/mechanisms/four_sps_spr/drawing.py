"""The 4-SPS + 1-SPR as a machine: which bars, bodies and marks stand where at one posture."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinematics.answers.drawings import Bar, Body, Drawing, Mark, direction, prismatic, spot
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, SUBSCRIPTS, FourSPSSPRDesign
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
        points += [
            Mark(f"limb{limb}/A", f"A{SUBSCRIPTS[i]}", spot(design.base[i]), limb),
            Mark(f"limb{limb}/B", f"B{SUBSCRIPTS[i]}", spot(tips[i]), limb),
        ]
    reach = 2.6 * _thick(size)
    bars.append(
        Bar(
            f"limb{SPR + 1}/R_B",
            spot(tips[SPR] - reach * axis),
            spot(tips[SPR] + reach * axis),
            0.75 * _thick(size),
            "joint",
            SPR + 1,
        )
    )
    bars += _pedestals(design, size)
    placed = transform(posture.pose)
    return Drawing(
        bars=tuple(bars),
        bodies=(
            Body("platform", _hull(design.platform), 0.018 * size, "platform", "platform"),
            Body("base", _plate(design, size), 0.016 * size, "base", "base"),
        ),
        points=(*points, Mark("p", "p", spot(placed[:3, 3]))),
        axes=(Mark("n6", "n₆", spot(tips[SPR]), SPR + 1, spot(axis)),),
        size=size,
    )


def machine_size(design: FourSPSSPRDesign) -> float:
    """A typical length of the machine, mm: of a leg that is nearly stretched."""
    return float(0.8 * np.mean(design.stroke[:, 1]))


def _thick(size: float) -> float:
    return 0.018 * size


def _leg(design: FourSPSSPRDesign, i: int, end: Array, size: float) -> Iterator[Bar]:
    limb, name = i + 1, f"limb{i + 1}"
    a, thick = design.base[i], _thick(size)
    unit = direction(end - a, 1e-9 * size)
    yield from prismatic(limb, a, end, design.stroke[i], thick, 1e-9 * size)
    # A ball of a spherical joint: a bar much shorter than thick.
    ball = 0.35 * thick * unit
    yield Bar(f"{name}/S_A", spot(a - ball), spot(a + ball), 1.45 * thick, "joint", limb)
    if i != SPR:
        yield Bar(f"{name}/S_B", spot(end - ball), spot(end + ball), 1.2 * thick, "joint", limb)


def _nearest_tip(design: FourSPSSPRDesign, tip: Array, axis: Array) -> Array:
    """Where limb 5 ends that cannot reach: B_5 moved along the axis into the limb's plane."""
    end: Array = tip + ((design.base[SPR] - tip) @ axis) * axis
    return end


def _pedestals(design: FourSPSSPRDesign, size: float) -> Iterator[Bar]:
    floor = _floor(design, size)
    for i, a in enumerate(design.base):
        foot = np.array([a[0], a[1], floor])
        yield Bar(f"limb{i + 1}/pedestal", spot(foot), spot(a), 0.026 * size, "base")


def _floor(design: FourSPSSPRDesign, size: float) -> float:
    return float(design.base[:, 2].min() - 0.09 * size)


def _plate(design: FourSPSSPRDesign, size: float) -> tuple[tuple[float, float, float], ...]:
    """A round plate under all base points."""
    centre = 0.5 * (design.base[:, :2].min(axis=0) + design.base[:, :2].max(axis=0))
    radius = float(np.linalg.norm(design.base[:, :2] - centre, axis=1).max()) + 0.08 * size
    floor = _floor(design, size)
    turns = np.linspace(0.0, 2.0 * np.pi, _CORNERS, endpoint=False)
    return tuple(
        spot(np.array([centre[0] + radius * np.cos(t), centre[1] + radius * np.sin(t), floor]))
        for t in turns
    )


def _hull(points: Array) -> tuple[tuple[float, float, float], ...]:
    """The platform's joints and its origin, so that even coincident joints make a body."""
    return tuple(dict.fromkeys((*(spot(p) for p in points), (0.0, 0.0, 0.0))))
