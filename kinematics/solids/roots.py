"""Where many polynomials of a low degree change their sign: all at once, without companions."""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array

_NOISE = 1e-12  # part of the sum of its terms' absolute values: a polynomial below is rounding
_CLOSE = 1e-14  # of the ends of a bracket: the step of a root that is found
_NEWTON = 60  # steps between two ends that close in, of which few are used


def values(coefficients: Array, v: Array) -> Array:
    """Polynomials (N, D + 1) at v (N, M)."""
    found = np.zeros_like(v)
    for k in range(coefficients.shape[1] - 1, -1, -1):
        found = found * v + coefficients[:, k, None]
    return found


def signs(coefficients: Array, v: Array) -> NDArray[np.int8]:
    """±1 at v (N, M); where it is no more than rounding that of the place before, or +1."""
    value = values(coefficients, v)
    noise = _NOISE * values(np.abs(coefficients), np.abs(v))
    sign = np.where(np.abs(value) <= noise, 0, np.sign(value)).astype(np.int8)
    for k in range(sign.shape[1]):
        before = sign[:, k - 1] if k else np.int8(1)
        sign[:, k] = np.where(sign[:, k] == 0, before, sign[:, k])
    return sign


def crossings(coefficients: Array, low: Array, high: Array) -> Array:
    """Where polynomials (N, D + 1) change their sign between ``low`` and ``high`` (N,).

    Returns:
        (N, D), ∞ where there is none.
    """
    degree = coefficients.shape[1] - 1
    if degree <= 2:
        return _of_a_square(coefficients, low, high)
    found = np.full((len(coefficients), degree), np.inf)
    some = np.flatnonzero(_may_change(coefficients, low, high))
    if len(some):
        found[some] = _between_turns(coefficients[some], low[some], high[some])
    return found


def _may_change(coefficients: Array, low: Array, high: Array) -> NDArray[np.bool_]:
    """(N,) which polynomials may change their sign: not those whose coefficients in Bernstein's
    basis between the ends have one sign, for they are in the hull of these."""
    shifted = list(coefficients.T)
    width, degree = high - low, len(shifted) - 1
    for k in range(degree):
        for j in range(degree - 1, k - 1, -1):
            shifted[j] = shifted[j] + low * shifted[j + 1]
    power = np.ones_like(low)
    for k in range(1, degree + 1):
        power = power * width
        shifted[k] = shifted[k] * power
    hull = _bernstein(degree) @ np.stack(shifted)
    far = np.maximum(np.abs(low), np.abs(high))
    noise = _NOISE * values(np.abs(coefficients), far[:, None])[:, 0]
    return np.asarray(~((hull.min(axis=0) > noise) | (hull.max(axis=0) < -noise)))


@cache
def _bernstein(degree: int) -> Array:
    """(D + 1, D + 1): the coefficients in Bernstein's basis from those of powers, in [0, 1]."""
    count = range(degree + 1)
    return np.array([[comb(j, k) / comb(degree, k) for k in count] for j in count])


def _between_turns(coefficients: Array, low: Array, high: Array) -> Array:
    """`crossings`: between the places where the derivative changes its sign there is one at most,
    which is bracketed."""
    degree = coefficients.shape[1] - 1
    slope = coefficients[:, 1:] * np.arange(1, degree + 1)
    turns = crossings(slope, low, high)
    marks = np.concatenate(
        [low[:, None], np.where(np.isfinite(turns), turns, high[:, None]), high[:, None]], axis=1
    )
    value = values(coefficients, marks)
    found = np.full((len(marks), degree), np.inf)
    row, col = np.nonzero((value[:, :-1] < 0.0) != (value[:, 1:] < 0.0))
    a, b = marks[row, col], marks[row, col + 1]
    fa, fb = value[row, col], value[row, col + 1]
    rising = fb >= 0.0
    # Next to a turn a polynomial is like a square, between two of them like a cube.
    part = fa / (fa - fb)
    after, before = col > 0, col < degree - 1
    start = np.where(after, np.sqrt(part), part)
    start = np.where(before, 1.0 - np.sqrt(1.0 - part), start)
    both = 0.5 - np.sin(np.arcsin(1.0 - 2.0 * part) / 3.0)
    t = a + (b - a) * np.where(after & before, both, start)
    least = _CLOSE * (np.abs(a) + np.abs(b))
    most = np.maximum(np.abs(a), np.abs(b))[:, None]
    noise = 1e-16 * values(np.abs(coefficients[row]), most)[:, 0]
    active = np.arange(len(row))
    for _ in range(_NEWTON):
        if not len(active):
            break
        here, x = row[active], t[active]
        f = values(coefficients[here], x[:, None])[:, 0]
        beneath = (f < 0.0) == rising[active]
        a[active] = np.where(beneath, x, a[active])
        b[active] = np.where(beneath, b[active], x)
        with np.errstate(invalid="ignore", divide="ignore"):
            wanted = x - f / values(slope[here], x[:, None])[:, 0]
        lost = ~((wanted >= a[active]) & (wanted <= b[active]))
        wanted = np.where(lost, 0.5 * (a[active] + b[active]), wanted)
        done = (np.abs(wanted - x) <= least[active]) | (np.abs(f) <= noise[active])
        t[active] = wanted
        active = active[~done]
    found[row, col] = t
    return np.sort(found, axis=1)


def _of_a_square(coefficients: Array, low: Array, high: Array) -> Array:
    """`crossings` of degree two or less."""
    c, b, a = (
        coefficients[:, k] if k < coefficients.shape[1] else np.zeros(len(coefficients))
        for k in range(3)
    )
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        root = np.sqrt(b * b - 4.0 * a * c)
        q = -0.5 * (b + np.where(b < 0.0, -root, root))
        both = np.stack([q / a, c / q], axis=-1)
    both = np.where(np.isnan(both), np.inf, both)
    inside = (both > low[:, None]) & (both < high[:, None]) & (root > 0.0)[:, None]
    return np.sort(np.where(inside, both, np.inf), axis=1)[:, : coefficients.shape[1] - 1]
