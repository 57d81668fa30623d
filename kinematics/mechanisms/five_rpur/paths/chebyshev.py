"""Zeros and extremes of smooth functions of one variable: Chebyshev polynomials, piece by piece.

An interval is halved until polynomials of degree 23 tell the functions; the zeros of these and of
their derivatives are eigenvalues (Trefethen, Approximation Theory and Approximation Practice, 2013,
ch. 18). They are where to look: what is between them is judged by the functions themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial import chebyshev
from scipy.optimize import brentq

from kinematics.arrays import Array

_COUNT = 24
_RESOLVED = 1e-10  # of the largest value
_DEEPEST = 14  # halvings
_NEARLY_REAL = 0.05
_ANGLES = np.pi * (np.arange(_COUNT) + 0.5) / _COUNT
_NODES = np.cos(_ANGLES)
_TO_COEFFICIENTS = 2.0 / _COUNT * np.cos(np.outer(np.arange(_COUNT), _ANGLES))
_TO_COEFFICIENTS[0] *= 0.5

Functions = Callable[[Array], Array]
"""Values (n, K) of K functions at (n,) arguments."""


def special_points(
    functions: Functions,
    low: float,
    high: float,
    *,
    stationary: bool = False,
    noise: Array | float = 0.0,
) -> list[Array]:
    """Where each of K functions may be zero in an interval, or nearly so, sorted, with its ends.

    Args:
        stationary: also where each may have an extreme.
        noise: (K,) values below which a function is rounding.
    """
    found: list[list[Array]] = []
    scale = np.abs(functions(low + (high - low) * np.linspace(0.0, 1.0, 2 * _COUNT + 1))).max(
        axis=0
    )
    enough = np.maximum(_RESOLVED * scale, noise)
    stack = [(low, high, 0)]
    while stack:
        a, b, depth = stack.pop()
        middle, half = 0.5 * (a + b), 0.5 * (b - a)
        coefficients = _TO_COEFFICIENTS @ functions(middle + half * _NODES)
        if depth < _DEEPEST and (np.abs(coefficients[-3:]) > enough).any():
            stack += [(a, middle, depth + 1), (middle, b, depth + 1)]
            continue
        found.append([middle + half * _special(c, stationary) for c in coefficients.T])
    ends = np.array([low, high])
    return [np.unique(np.concatenate([ends, *column])) for column in zip(*found, strict=True)]


def _special(coefficients: Array, stationary: bool) -> Array:
    """Zeros in [−1, 1] of a polynomial, and those nearly real; of its derivative too if wanted."""
    size = float(np.abs(coefficients).max())
    polynomial = chebyshev.chebtrim(coefficients, 1e-14 * size)
    zeros = [np.empty(0)]
    if abs(polynomial[0]) <= np.abs(polynomial[1:]).sum():  # else it has none
        zeros.append(chebyshev.chebroots(polynomial))
    if stationary:
        zeros.append(chebyshev.chebroots(chebyshev.chebder(polynomial)))
    roots = np.concatenate(zeros)
    kept = (np.abs(roots.imag) < _NEARLY_REAL) & (np.abs(roots.real) < 1.0 + 1e-9)
    return np.asarray(np.clip(roots.real[kept], -1.0, 1.0))


def with_middles(points: Sequence[float] | Array) -> Array:
    """Sorted points and one between each two."""
    x = np.asarray(points, dtype=float)
    both = np.empty(2 * len(x) - 1)
    both[::2], both[1::2] = x, 0.5 * (x[1:] + x[:-1])
    return both


def zero_between(function: Callable[[float], float], low: float, high: float) -> float:
    """The zero of a function whose values at both ends differ in sign, or are zero."""
    at_low, at_high = function(low), function(high)
    if at_low == 0.0 or at_high == 0.0:
        return low if at_low == 0.0 else high
    return float(brentq(function, low, high, xtol=1e-15, rtol=1e-14))
