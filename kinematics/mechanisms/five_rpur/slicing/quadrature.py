"""A rule of degree five on a panel's ends and middle, with derivatives at the ends, and its doubt.

The panel lies between u0 and u1, x' = end + κ u², and integrals over x' of A are those over u of
f = A |dx'/du|. The rule is H/30 (7 f0 + 16 f1 + 7 f2) + H²/60 (f0' − f2'), H = u1 − u0: the
integral of the quintic with f and f' in all three places, exact for A in {1, √s, s, s^³ᐟ², s²},
s = |x' − end|. Scalars, see `sweep`.
"""

from __future__ import annotations

import math

from kinematics.arrays import Array


def weights_of(span: Array) -> tuple[float, float, float, float, float]:
    """The weights of A at both ends and between them, in the order 0, 1, 2, and of dA/dx' at 0, 2.

    Args:
        span: (4,) u0, u1, end, κ.
    """
    h = span[1] - span[0]
    curve = 2.0 * abs(span[3])  # d²x'/du², its sign left out as the panel runs that way
    x0, x2 = curve * span[0], curve * span[1]
    x1 = 0.5 * (x0 + x2)
    slope = h * h / 60.0 * (1.0 if span[3] > 0.0 else -1.0)
    return (
        h * 7.0 / 30.0 * x0 + h * h / 60.0 * curve,
        h * 16.0 / 30.0 * x1,
        h * 7.0 / 30.0 * x2 - h * h / 60.0 * curve,
        slope * x0 * x0,
        -slope * x2 * x2,
    )


def nulls(span: Array, one: Array, two: Array, three: Array) -> float:
    """What two rules give that are nothing for cubics, an even one and twice an odd one, together.

    Args:
        span: (4,) u0, u1, end, κ.
        one, two, three: (6,) sections at u0, in the middle and at u1: A comes first, and dA/dx' at
            3. It is not asked for at u = 0, where it may be infinite.
    """
    h = span[1] - span[0]
    curve = 2.0 * abs(span[3])
    sign = 1.0 if span[3] > 0.0 else -1.0
    x0, x2 = curve * span[0], curve * span[1]
    x1 = 0.5 * (x0 + x2)
    f0, f1, f2 = one[0] * x0, two[0] * x1, three[0] * x2
    d0 = (sign * one[3] * x0 * x0 if x0 > 0.0 else 0.0) + one[0] * curve
    d1 = sign * two[3] * x1 * x1 + two[0] * curve
    d2 = sign * three[3] * x2 * x2 + three[0] * curve
    even = (f0 - 2.0 * f1 + f2) - 0.25 * h * (d2 - d0)
    odd = (f2 - f0) - h / 6.0 * (d0 + 4.0 * d1 + d2)
    return float(h * math.sqrt(even * even + 4.0 * odd * odd))
