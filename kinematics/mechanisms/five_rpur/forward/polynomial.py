"""All roots of many polynomials of one degree at a time, real or complex.

A few are left to LAPACK (eigenvalues of companion matrices); of many, all roots are found
together by the Ehrlich–Aberth iteration, column by column of the arrays. Its starting points lie
on the circles that the Newton polygon of the coefficients' moduli tells (Bini, Numerical
Algorithms 13 (1996) 179), without which roots of very different moduli take many rounds.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array

Complex = NDArray[np.complex128]

_ROUNDS = 80  # of the iteration; it takes 8 or so, more where roots coincide
_SETTLED = 1e-6  # relative correction after which cubic convergence leaves little but rounding
_COMPANION = 256  # degree × columns up to which LAPACK is the quicker
_SPREAD = 1e8  # of the coefficients over the leading one, up to which it is accurate
_NO_LEAD = 1e-30  # of the largest coefficient: what stands in for a leading one that is 0
_THINNED = 0.75  # part of the columns that are still moving below which they are packed


def roots(coefficients: Complex | Array) -> Complex:
    """The n roots of polynomials of degree n ≥ 1.

    Args:
        coefficients: (n + 1, N), rising powers, a column a polynomial.

    Returns:
        (n, N). Where leading coefficients vanish, roots at infinity come out as very large; where
        all do, or one is not finite, roots are NaN.
    """
    c = np.asarray(coefficients, dtype=complex)
    with np.errstate(all="ignore"):
        largest = modulus(c).max(axis=0, initial=0.0)
        c = np.where((largest > 0.0) & np.isfinite(largest), c / largest, np.nan)
        size = modulus(c)
        c[-1] = np.where(size[-1] < _NO_LEAD, _NO_LEAD, c[-1])
        if len(c) == 3:
            return _quadratic(c)
        few = (len(c) - 1) * c.shape[1] <= _COMPANION
        if few and bool((size.max(axis=0) < _SPREAD * size[-1]).all()):
            return _eigenvalues(c)
        return _aberth(c)


def _quadratic(c: Complex) -> Complex:
    half = np.sqrt(c[1] * c[1] - 4.0 * c[0] * c[2])
    half = np.where((c[1].conj() * half).real < 0.0, -half, half)  # no cancellation
    larger = -0.5 * (c[1] + half)
    return np.stack([larger / c[2], c[0] / larger])


def _eigenvalues(c: Complex) -> Complex:
    degree = len(c) - 1
    companion = np.zeros((c.shape[1], degree, degree), dtype=complex)
    companion[:, np.arange(1, degree), np.arange(degree - 1)] = 1.0
    companion[:, :, -1] = -(c[:-1] / c[-1]).T
    values = np.linalg.eigvals(companion).astype(complex)
    return values.T


def _aberth(c: Complex) -> Complex:
    """Ehrlich–Aberth; columns that have settled are taken out as they become many."""
    answer = np.full((len(c) - 1, c.shape[1]), np.nan, dtype=complex)
    index = np.flatnonzero(np.isfinite(c).all(axis=0))
    c = c[:, index]
    z = _starts(c)
    for _ in range(_ROUNDS):
        step = _step(c, z)
        z = z - step
        moving = (modulus(step) > _SETTLED * modulus(z)).any(axis=0)
        left = np.count_nonzero(moving)
        if left == 0:
            break
        if left < _THINNED * len(index):
            answer[:, index] = z
            index, z, c = index[moving], z[:, moving], c[:, moving]
    answer[:, index] = z
    return answer


def _step(c: Complex, z: Complex) -> Complex:
    """Newton's correction at every root, less what the other roots contribute to it."""
    degree = len(z)
    value = c[-1] * z + c[-2]
    slope = np.broadcast_to(c[-1], z.shape).copy()
    for power in range(degree - 2, -1, -1):
        slope *= z
        slope += value
        value *= z
        value += c[power]
    i, j = _pairs(degree)
    inverse = 1.0 / (z[i] - z[j])
    table = np.zeros((degree, *z.shape), dtype=complex)
    table[i, j] = inverse
    table[j, i] = -inverse
    return np.asarray(value / (slope - value * table.sum(axis=1)))


def _starts(c: Complex) -> Complex:
    """On the circles of the Newton polygon, at angles without a symmetry."""
    degree = len(c) - 1
    logarithm = np.log(np.maximum(modulus(c), 1e-300))
    first, second = np.arange(degree + 1)[:, None], np.arange(degree + 1)
    gap = np.where(second > first, second - first, 1)[..., None]
    slope = (logarithm[:, None] - logarithm) / gap
    # Over [k, k + 1] the upper hull of the points (power, logarithm) has the slope
    # min over i ≤ k of max over j > k of that from i to j; here slopes have the other sign.
    edge = np.stack([slope[: k + 1, k + 1 :].min(axis=1).max(axis=0) for k in range(degree)])
    turn = np.exp(1j * (2.0 * np.pi * np.arange(degree) / degree + 0.4))
    return np.asarray(np.exp(edge) * turn[:, None])


@lru_cache(maxsize=32)
def _pairs(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    i, j = np.triu_indices(count, 1)
    return i, j


def modulus(z: Complex | Array) -> Array:
    """|z|, several times as quick as np.abs, for numbers whose squares are in range."""
    return np.asarray(np.sqrt(z.real * z.real + z.imag * z.imag))
