"""The 5-RPUR as a machine: which bars, bodies and marks stand where at one posture."""

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
    joint,
    letters,
    pedestals,
    prismatic,
    spot,
)
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import joint_points, transform
from kinematics.screws.spatial import rotation_y

E1 = np.array([0.0, 1.0, 0.0])


def drawing(design: FiveRPURDesign, posture: Posture) -> Drawing:
    """The machine at ``posture``, in the base frame, mm."""
    base, elbow, tip = joint_points(design, posture.pose, posture.mode)
    theta = posture.pose[4]
    e2 = rotation_y(theta)[:, 0]
    size = machine_size(design)
    bars: list[Bar] = []
    points: list[Mark] = []
    measured: list[Dimension] = []
    centre = transform(posture.pose)[:3, 3]
    for i in range(len(design.limbs)):
        limb = i + 1
        a, b, c = base[i], elbow[i], tip[i]
        gap_end = None
        if not np.isfinite(b).all():
            b, gap_end = _nearest_closure(design, i, c, a)
        bars += _limb(design, i, a, b, gap_end if gap_end is not None else c, e2, size)
        if gap_end is not None:
            bars.append(Bar(f"limb{limb}/gap", spot(gap_end), spot(c), 0.012 * size, "gap", limb))
        points += letters(limb, A=a, B=b, C=c)
        measured += _dimensions(limb, a, b, c, centre)
    floor = float(design.base[:, 2].min() - 0.2 * size)
    bars += pedestals(design.base, floor, 0.03 * size)
    # With O', so that even coincident joints make a body.
    platform = corners([*design.platform, np.zeros(3)])
    below = design.base.mean(axis=0) * [1, 1, 0] + [0, 0, floor]
    return Drawing(
        bars=tuple(bars),
        bodies=(
            Body("platform", platform, 0.028 * size, "platform", "platform"),
            Body("base", _slab(design, floor, size), 0.02 * size, "base", "base"),
        ),
        points=tuple(points),
        axes=(
            Mark("e1", "e₁", spot(below), None, spot(E1)),
            Mark("e2", "e₂", spot(centre), None, spot(e2)),
        ),
        size=size,
        dimensions=tuple(measured),
    )


def _dimensions(limb: int, a: Array, b: Array, c: Array, centre: Array) -> Iterator[Dimension]:
    """What a limb's numbers are."""
    i, mark = ("limb", limb - 1), chr(ord("₀") + limb)
    zero, at, joint_a, joint_b, joint_c = spot(np.zeros(3)), *map(spot, (centre, a, b, c))
    base, platform, link, stroke = (((*i, k),) for k in ("base", "platform", "link", "stroke"))
    told = "base point A, from O, base frame", "platform point C, from O′, platform frame"
    yield Dimension(f"r{mark}", told[0], "vector", zero, joint_a, base, limb)
    yield Dimension(f"s′{mark}", told[1], "vector", at, joint_c, platform, limb)
    yield Dimension(f"l{mark}", "link from B to C", "length", joint_b, joint_c, link, limb)
    yield Dimension(
        f"ρ{mark}", "actuator from A to B, ρ min … ρ max", "stroke", joint_a, joint_b, stroke, limb
    )


def machine_size(design: FiveRPURDesign) -> float:
    """A typical length of the machine, mm: half of what a limb spans when fully stretched."""
    return float(0.6 * np.mean(design.stroke[:, 1] + design.link))


def _limb(
    design: FiveRPURDesign, i: int, a: Array, b: Array, c: Array, e2: Array, size: float
) -> Iterator[Bar]:
    limb, thick = i + 1, 0.026 * size
    yield from prismatic(limb, a, b, design.stroke[i], thick, 1e-9 * size)
    yield Bar(f"limb{limb}/link", spot(b), spot(c), 0.5 * thick, "link", limb)
    # R joint at A about e1; U joint at B about e1 and e2; R joint at C about e2.
    for key, at, axis in (("R_A", a, E1), ("U_B1", b, E1), ("U_B2", b, e2), ("R_C", c, e2)):
        reach = (1.5 if key == "R_A" else 1.15) * thick
        yield joint(limb, key, at, reach * axis, 0.62 * thick)


def _nearest_closure(design: FiveRPURDesign, i: int, c: Array, a: Array) -> tuple[Array, Array]:
    """Where a limb that cannot close ends: its U joint, and the tip it can reach instead of C."""
    tip = c.copy()
    tip[1] = a[1] + np.clip(c[1] - a[1], -design.link[i], design.link[i])
    elbow = c.copy()
    elbow[1] = a[1]
    return elbow, tip


def _slab(design: FiveRPURDesign, floor: float, size: float) -> tuple[Point, ...]:
    reach = 0.12 * size
    return corners(
        np.array([x + dx, y + dy, floor])
        for x, y, _ in design.base
        for dx in (-reach, reach)
        for dy in (-reach, reach)
    )
