"""Where two circles of a plane meet, from factors that keep their digits near a touch.

With the distance d of the centres and the radii r, s, the triangle (d, r, s) has the factors
P = r + s − d, Q = s + d − r, R = d + r − s and S = d + r + s: one of the first three vanishes where
the circles touch. The half angle h between the line of centres and a crossing, seen from the first
centre, has tan²(h/2) = P Q / (R S) (after W. Kahan), and half the common chord is
√(P Q R S) / (2 d). All of them are the same whichever circle is called the first. Lengths mm,
angles rad.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array


class Factors(NamedTuple):
    """P, Q, R, S of the triangle (d, r, s), mm; P, Q or R is negative where circles do not meet."""

    apart: Array
    beyond_first: Array
    beyond_second: Array
    whole: Array

    @property
    def least(self) -> Array:
        """By how much the circles overlap, mm; negative: by how much they miss one another."""
        return np.asarray(np.minimum(np.minimum(self.apart, self.beyond_first), self.beyond_second))


def factors(d: Array, r: Array, s: Array) -> Factors:
    """The factors of circles with radii r and s whose centres are d apart; all broadcast."""
    return Factors(_less(r, s, d), _less(s, d, r), _less(d, r, s), d + r + s)


def half_angle(f: Factors) -> Array:
    """From the line of centres to a crossing, seen from the first centre, rad; NaN: no crossing."""
    near, far = f.apart * f.beyond_first, f.beyond_second * f.whole
    meets = (near >= 0.0) & (far >= 0.0)
    with np.errstate(invalid="ignore"):
        half = 2.0 * np.arctan2(np.sqrt(near), np.sqrt(far))
    return np.where(meets, half, np.nan)


def half_chord(f: Factors, d: Array) -> Array:
    """Half the chord that the circles have in common, mm; 0 where they do not cross."""
    product = np.maximum(f.apart, 0.0) * np.maximum(f.beyond_first, 0.0)
    return np.asarray(np.sqrt(product * np.maximum(f.beyond_second, 0.0) * f.whole) / (2.0 * d))


def _less(y: Array, z: Array, x: Array) -> Array:
    """y + z − x without the rounding of y + z where x is nearly as large."""
    return np.asarray(np.minimum(y, z) + (np.maximum(y, z) - x))
