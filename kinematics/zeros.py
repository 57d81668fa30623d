"""Zeros of functions: along straight lines, for curves and surfaces alike, and of one variable.

Smooth functions of one variable are told by Chebyshev polynomials, piece by piece: an interval is
halved until polynomials of degree 23 tell them; the zeros of these and of their derivatives are
eigenvalues (Trefethen, Approximation Theory and Approximation Practice, 2013, ch. 18). They are
where to look: what is between them is judged by the functions themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial import chebyshev

from kinematics.arrays import Array

Field = Callable[[Array], tuple[Array, Array]]
"""A function's values (N,) and gradients (N, D) at points (N, D)."""

_STEPS = 40  # bisection alone would do


def zeros_between(
    field: Field, a: Array, b: Array, fa: Array, fb: Array, tolerance: float
) -> tuple[Array, Array]:
    """The zeros of a function between points (N, D) where its signs differ, and residuals.

    Newton's method between ends that close in, halved where a step would leave them.

    Args:
        field: the function; D is 3, or what it takes.
        a, b: (N, D) the points.
        fa, fb: (N,) the values there.
        tolerance: of |F| / |∇F|, the distance to the zero to first order.
    """
    along = b - a
    length = np.linalg.norm(along, axis=1)
    rising = np.where(fb >= fa, 1.0, -1.0)
    low, high = np.zeros(len(a)), np.ones(len(a))
    t = np.abs(fa) / np.maximum(np.abs(fa) + np.abs(fb), 1e-300)
    residual = np.zeros(len(a))
    active = np.arange(len(a))
    for _ in range(_STEPS):
        if not len(active):
            break
        value, gradient = field(a[active] + t[active, None] * along[active])
        slope = np.einsum("ij,ij->i", gradient, along[active])
        steep = np.maximum(np.linalg.norm(gradient, axis=1), 1e-300)
        residual[active] = np.abs(value) / steep
        below = rising[active] * value < 0.0
        low[active] = np.where(below, t[active], low[active])
        high[active] = np.where(below, high[active], t[active])
        with np.errstate(divide="ignore", invalid="ignore"):
            step = -value / slope
        wanted = t[active] + step
        lost = ~((wanted > low[active]) & (wanted < high[active]))
        wanted = np.where(lost, 0.5 * (low[active] + high[active]), wanted)
        # Done where the zero is known, or nothing lies between the ends any more.
        done = residual[active] <= tolerance
        done |= (high[active] - low[active]) * length[active] <= 1e-3 * tolerance
        t[active] = np.where(done, t[active], wanted)
        active = active[~done]
    return a + t[:, None] * along, residual


# --- of one variable ---------------------------------------------------------------------

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
    from scipy.optimize import brentq

    at_low, at_high = function(low), function(high)
    if at_low == 0.0 or at_high == 0.0:
        return low if at_low == 0.0 else high
    return float(brentq(function, low, high, xtol=1e-15, rtol=1e-14))
