"""Time laws: how the share s of a path grows from 0 to 1, with its first two derivatives.

All are frozen and hashable; times s.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, sqrt

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.errors import InputError

# s, s′ and s″ as polynomials of τ = t/T, from τ⁰ upwards.
_POLYNOMIALS = {
    "linear": (0.0, 1.0),
    "cubic": (0.0, 0.0, 3.0, -2.0),
    "quintic": (0.0, 0.0, 0.0, 10.0, -15.0, 6.0),
}
_SHAPES = {
    kind: tuple(np.polynomial.Polynomial(row).deriv(n) for n in range(3))
    for kind, row in _POLYNOMIALS.items()
}
LAWS: tuple[str, ...] = (*_POLYNOMIALS, "trapezoidal")
"""Constant velocity; rest to rest with velocity, and also acceleration, zero at both ends; and
constant acceleration, velocity and deceleration."""

SHORTEST, LONGEST = 1e-6, 1e6  # s that a law may take
RAMP = 0.25  # of the duration: how long a trapezoid speeds up, where nothing else is said


@dataclass(frozen=True, slots=True)
class Law:
    """A time law of some kind of `LAWS`.

    Attributes:
        kind: which.
        duration: T, s.
        ramp: of a trapezoid, the part of T in which it speeds up, and as much in which it slows
            down; 0.5 is a triangle.
    """

    kind: str
    duration: float
    ramp: float = RAMP

    def at(self, times: ArrayLike) -> tuple[Array, Array, Array]:
        """s, ds/dt and d²s/dt² at times (...), s. Before 0 and after T they rest at the ends."""
        t = np.asarray(times, dtype=float)
        tau = np.clip(t / self.duration, 0.0, 1.0)
        if self.kind == "trapezoidal":
            s, ds, dds = _trapezoid(tau, self.ramp)
        else:
            s, ds, dds = (shape(tau) for shape in _SHAPES[self.kind])
        moving = (t >= 0.0) & (t <= self.duration * (1.0 + 1e-12))
        return (
            np.asarray(s),
            np.where(moving, ds / self.duration, 0.0),
            np.where(moving, dds / self.duration**2, 0.0),
        )

    @property
    def breaks(self) -> tuple[float, ...]:
        """Times between 0 and T at which the acceleration leaps, s."""
        if self.kind != "trapezoidal":
            return ()
        inner = {self.ramp, 1.0 - self.ramp}
        return tuple(self.duration * tau for tau in sorted(inner))

    def times_of(self, shares: ArrayLike) -> Array:
        """When given shares (...) of the path are passed, s, by halving."""
        s = np.asarray(shares, dtype=float)
        low, high = np.zeros_like(s), np.full_like(s, self.duration)
        for _ in range(60 if s.size else 0):
            half = 0.5 * (low + high)
            before = self.at(half)[0] < s
            low, high = np.where(before, half, low), np.where(before, high, half)
        return np.asarray(0.5 * (low + high))


def law(kind: str, duration: float, *, ramp: float = RAMP) -> Law:
    """A checked time law.

    Raises:
        InputError: there is no such law, a duration that is not positive, or a ramp beyond 0.5.
    """
    if kind not in LAWS:
        raise InputError(f"there is no time law {kind!r}; known are {', '.join(LAWS)}")
    if not (isfinite(duration) and SHORTEST <= duration <= LONGEST):
        raise InputError(f"a duration must lie between 1e-6 and 1e6 seconds, got {duration:g}")
    if not 0.0 < ramp <= 0.5:
        raise InputError(f"a ramp is a part of the duration, above 0 and at most 0.5, got {ramp:g}")
    return Law(kind, float(duration), float(ramp))


def trapezoidal(length: float, speed: float, acceleration: float) -> Law:
    """The shortest trapezoidal law along a path within a speed and an acceleration.

    Args:
        length: of the path, mm.
        speed: at most, mm/s.
        acceleration: at most, mm/s².

    Raises:
        InputError: they are not positive.
    """
    for name, value in (("length", length), ("speed", speed), ("acceleration", acceleration)):
        if not (isfinite(value) and value > 0.0):
            raise InputError(f"the {name} of a trapezoidal law must be positive, got {value:g}")
    if length * acceleration <= speed**2:  # it never gets to full speed
        return law("trapezoidal", 2.0 * sqrt(length / acceleration), ramp=0.5)
    duration = length / speed + speed / acceleration
    return law("trapezoidal", duration, ramp=speed / acceleration / duration)


def _trapezoid(tau: Array, ramp: float) -> tuple[Array, Array, Array]:
    top = 1.0 / (1.0 - ramp)
    rise = top / ramp
    first, last = tau < ramp, tau > 1.0 - ramp
    left = 1.0 - tau

    def chosen(up: Array, level: Array, down: Array) -> Array:
        return np.where(first, up, np.where(last, down, level))

    one = np.ones_like(tau)
    return (
        chosen(0.5 * rise * tau**2, top * (tau - 0.5 * ramp), 1.0 - 0.5 * rise * left**2),
        chosen(rise * tau, top * one, rise * left),
        chosen(rise * one, 0.0 * one, -rise * one),
    )
