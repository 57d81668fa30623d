"""Numbers that carry their first and second derivative by time, for arrays of any shape."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array


class Jet(NamedTuple):
    """A quantity, its rate and its acceleration."""

    value: Array
    rate: Array
    acceleration: Array

    @classmethod
    def constant(cls, value: float, like: Jet) -> Jet:
        zero = np.zeros_like(like.value)
        return cls(zero + value, zero, zero)


def plus(a: Jet, b: Jet) -> Jet:
    return Jet(a.value + b.value, a.rate + b.rate, a.acceleration + b.acceleration)


def scaled(factor: float, a: Jet) -> Jet:
    return Jet(factor * a.value, factor * a.rate, factor * a.acceleration)


def times(a: Jet, b: Jet) -> Jet:
    return Jet(
        a.value * b.value,
        a.rate * b.value + a.value * b.rate,
        a.acceleration * b.value + 2.0 * a.rate * b.rate + a.value * b.acceleration,
    )


def reciprocal(a: Jet) -> Jet:
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        one = 1.0 / a.value
        return Jet(
            one,
            -a.rate * one**2,
            2.0 * a.rate**2 * one**3 - a.acceleration * one**2,
        )


def cosine_and_sine(a: Jet) -> tuple[Jet, Jet]:
    c, s = np.cos(a.value), np.sin(a.value)
    square = a.rate**2
    return (
        Jet(c, -s * a.rate, -s * a.acceleration - c * square),
        Jet(s, c * a.rate, c * a.acceleration - s * square),
    )
