"""Polynomials in one unknown for many parameters at a time: arithmetic and roots."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array


class Power:
    """A polynomial with coefficients (..., N + 1), lowest degree first.

    Numbers and arrays of the parameters' shape are constants.
    """

    __array_ufunc__ = None  # so that array * polynomial is ours

    def __init__(self, coefficients: Any) -> None:
        self.coefficients: Array = np.asarray(coefficients, dtype=float)

    @classmethod
    def unknown(cls) -> Power:
        return cls([0.0, 1.0])

    def __add__(self, other: Any) -> Power:
        a, b = self.coefficients, _coefficients(other)
        shape = np.broadcast_shapes(a.shape[:-1], b.shape[:-1])
        total = np.zeros((*shape, max(a.shape[-1], b.shape[-1])))
        total[..., : a.shape[-1]] += a
        total[..., : b.shape[-1]] += b
        return Power(total)

    def __mul__(self, other: Any) -> Power:
        a, b = self.coefficients, _coefficients(other)
        shape = np.broadcast_shapes(a.shape[:-1], b.shape[:-1])
        product = np.zeros((*shape, a.shape[-1] + b.shape[-1] - 1))
        for n in range(b.shape[-1]):
            product[..., n : n + a.shape[-1]] += a * b[..., n : n + 1]
        return Power(product)

    def __neg__(self) -> Power:
        return Power(-self.coefficients)

    def __sub__(self, other: Any) -> Power:
        return self + Power(-_coefficients(other))

    def __rsub__(self, other: Any) -> Power:
        return (-self).__add__(other)

    __radd__ = __add__
    __rmul__ = __mul__

    def roots(self) -> NDArray[np.complex128]:
        """All roots, (..., N); NaN where leading coefficients vanish (roots at infinity)."""
        a = self.coefficients
        degree = a.shape[-1] - 1
        flat = a.reshape(-1, degree + 1)
        found = np.full((len(flat), degree), np.nan, dtype=complex)
        size = np.abs(flat).max(axis=-1)
        left = size > 0.0
        for top in range(degree, 0, -1):
            rows = np.flatnonzero(left & (np.abs(flat[:, top]) > 1e-15 * size))
            left[rows] = False
            companion = np.zeros((len(rows), top, top))
            companion[:, range(1, top), range(top - 1)] = 1.0
            companion[:, :, -1] = -flat[rows, :top] / flat[rows, top : top + 1]
            found[rows, :top] = np.linalg.eigvals(companion)
        return found.reshape(*a.shape[:-1], degree)


def _coefficients(value: Any) -> Array:
    if isinstance(value, Power):
        return value.coefficients
    return np.asarray(value, dtype=float)[..., None]
