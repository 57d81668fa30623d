"""The first parallel singularity while both joints move on a straight line.

g = |B_1 B_2|² decides: both assembly modes are real while (r_2 − r_2')² < g < (r_2 + r_2')². Along
the line θ + s Δ the second derivative of g is bounded by M = 4 r_3 r_1 Δ_1² + 4 r_3 r_1' Δ_2² +
2 r_1 r_1' (Δ_1 − Δ_2)², so that on an interval of width h it leaves its chord by at most M h²/8:
intervals are halved until that proves them free, and none is passed over.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin, sqrt

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_bar.design import FiveBarDesign

FINEST = 2.0**-44  # of the way: what is not proven free in an interval of this width is a crossing
TOUCH = 1e-9
"""mm to which B_1 and B_2 may approach, where the distal links are equal, before they are one."""


@dataclass(frozen=True, eq=False)
class Crossing:
    """Where both assembly modes meet; ``fraction`` of the way, ``point`` P (2,) mm there.

    ``extended``: B_1, P and B_2 in this order on a line; else P is beyond one of the elbows.
    """

    fraction: float
    joints: tuple[float, float]
    point: Array
    extended: bool


def first_crossing(
    design: FiveBarDesign, start: Sequence[float], end: Sequence[float]
) -> Crossing | None:
    """The first parallel singularity from ``start`` to ``end`` (2,) rad; None: there is none.

    Where no assembly mode is real at ``start`` it is there, at fraction 0.
    """
    a, b = design.proximal.tolist()
    r, s = design.distal.tolist()
    w = 2.0 * design.half_base
    t1, t2 = float(start[0]), float(start[1])
    d1, d2 = float(end[0]) - t1, float(end[1]) - t2
    most, least = (r + s) ** 2, max((r - s) ** 2, TOUCH**2)
    bend = (2 * w * a * d1 * d1 + 2 * w * b * d2 * d2 + 2 * a * b * (d1 - d2) ** 2) / 8.0

    def g(f: float) -> float:
        q1, q2 = t1 + f * d1, t2 + f * d2
        x = w + b * cos(q2) - a * cos(q1)
        y = b * sin(q2) - a * sin(q1)
        return float(x * x + y * y)

    left = g(0.0)
    if not least < left < most:
        return _crossing(design, start, end, 0.0, left)
    waiting = [(0.0, left, 1.0, g(1.0))]
    while waiting:
        low, g_low, high, g_high = waiting.pop()
        leaves = bend * (high - low) ** 2
        if max(g_low, g_high) + leaves < most and min(g_low, g_high) - leaves > least:
            continue
        if high - low <= FINEST:
            inside = least < g_high < most
            at, value = (low, g_low) if inside else (high, g_high)
            return _crossing(design, start, end, at, value)
        half = 0.5 * (low + high)
        g_half = g(half)
        waiting.append((half, g_half, high, g_high))
        waiting.append((low, g_low, half, g_half))
    return None


def _crossing(
    design: FiveBarDesign, start: Sequence[float], end: Sequence[float], at: float, g: float
) -> Crossing:
    q1, q2 = (float(u) + at * (float(v) - float(u)) for u, v in zip(start, end, strict=True))
    r, s = design.distal.tolist()
    d = sqrt(g)
    extended = abs(d - (r + s)) <= abs(d - abs(r - s))
    one, two = (
        base + arm * np.array([cos(q), sin(q)])
        for base, arm, q in zip(design.base, design.proximal, (q1, q2), strict=True)
    )
    unit = (two - one) / d if d > 0.0 else np.array([1.0, 0.0])
    along = r if extended or r >= s else -r
    return Crossing(at, (q1, q2), one + along * unit, extended)
