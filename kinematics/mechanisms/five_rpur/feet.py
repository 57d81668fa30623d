"""The point of a limb's stroke end that is nearest to a place of the platform: exact and global.

With (X, Y, Z) = C_i − A_i in the base frame turned by R_y(−θ), one stroke end ρ = r of a limb in
mode σ is the tube of circles of radius r about (0, l cos β, σ l sin β) in the planes y = l cos β,
0 ≤ β ≤ π. In each plane the nearest point of the circle is known, and along β the distance is
stationary where, with R = hypot(X, σZ − l sin β),

    R (Y sin β − σZ cos β) + r cos β (σZ − l sin β) = 0.

Squared, that is a trigonometric polynomial of degree 4: all its roots are found, so no minimum is
missed. Lengths mm, angles rad.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array

ERROR = 1e-12
"""Part of the machine's size by which rounding may falsify a distance."""

_DEGREE = 4
_NODES = 2.0 * np.pi * np.arange(2 * _DEGREE + 1) / (2 * _DEGREE + 1)
_POLISH = 4  # Newton steps from each root


def _powers() -> Array:
    """From Fourier coefficients k = 0 … 4, −4 … −1 to those of t = tan(γ/2), t⁸ first.

    exp(ikγ) (1 + t²)⁴ = (1 + it)^(4+k) (1 − it)^(4−k).
    """
    rows = []
    for k in (*range(_DEGREE + 1), *range(-_DEGREE, 0)):
        row = np.array([1.0 + 0.0j])
        for factor, times in ((1.0j, _DEGREE + k), (-1.0j, _DEGREE - k)):
            for _ in range(times):
                row = np.convolve(row, [factor, 1.0])
        rows.append(row)
    return np.array(rows)


_POWERS = _powers()
_ORDER = np.array([*range(_DEGREE + 1), *range(-_DEGREE, 0)])


def feet(
    relative: ArrayLike, link: ArrayLike, sign: ArrayLike, radius: ArrayLike
) -> tuple[Array, Array]:
    """The nearest points on tubes.

    Args:
        relative: (..., 3) mm, C − A in the turned frame, finite.
        link: (...,) mm.
        sign: (...,) ±1, the limb's working mode.
        radius: (...,) mm, ≥ 0, the stroke end.

    Returns:
        Distances (...,), mm, and points (..., 3) of C − A; wrong by rounding only (`ERROR`).
    """
    relative = np.asarray(relative, dtype=float)
    shape = np.broadcast_shapes(
        relative.shape[:-1], np.shape(link), np.shape(sign), np.shape(radius)
    )
    x, y, z = (np.broadcast_to(relative[..., k], shape).reshape(-1, 1) for k in range(3))
    ell, sigma, r = (
        np.broadcast_to(np.asarray(v, dtype=float), shape).reshape(-1, 1)
        for v in (link, sign, radius)
    )
    # In units of whatever is largest, and up where the mode is.
    unit = np.maximum(np.maximum(np.hypot(np.hypot(x, y), z), ell), r)
    x, y, a, r, ell = x / unit, y / unit, sigma * z / unit, r / unit, ell / unit
    beta = _stationary(x, y, a, r, ell)
    apart = np.hypot(x, a - ell * np.sin(beta))
    squares = (y - ell * np.cos(beta)) ** 2 + (apart - r) ** 2
    rows = np.arange(len(beta))
    best = squares.argmin(axis=1)
    distance = np.sqrt(squares[rows, best])[:, None]
    angle = beta[rows, best][:, None]
    c, s = ell * np.cos(angle), ell * np.sin(angle)
    apart = np.hypot(x, a - s)
    on_axis = apart == 0.0  # where all of the circle is as near
    scale = r / np.where(on_axis, 1.0, apart)
    points = np.concatenate(
        [np.where(on_axis, r, x * scale), c, sigma * (s + (a - s) * scale)], axis=1
    )
    return (distance * unit).reshape(shape), (points * unit).reshape(*shape, 3)


def _stationary(x: Array, y: Array, a: Array, r: Array, link: Array) -> Array:
    """β (N, 19) among which the nearest point is."""
    c, s = np.cos(_NODES), np.sin(_NODES)
    up = a - link * s
    values = (x**2 + up**2) * (y * s - a * c) ** 2 - (r * c * up) ** 2
    # With its pole where the polynomial is large, no root is sent to infinity.
    largest = np.abs(values).argmax(axis=1)
    start = (_NODES[largest] - np.pi)[:, None]
    fourier = np.fft.fft(values, axis=1) / len(_NODES) * np.exp(1j * _ORDER * start)
    coefficients = (fourier @ _POWERS).real
    leading = values[np.arange(len(values)), largest][:, None]
    coefficients = coefficients / np.where(leading == 0.0, 1.0, leading)
    companion = np.zeros((len(values), 2 * _DEGREE, 2 * _DEGREE))
    companion[:, 0, :] = -coefficients[:, 1:]
    companion[:, range(1, 2 * _DEGREE), range(2 * _DEGREE - 1)] = 1.0
    roots = np.linalg.eigvals(companion).real  # double roots come as pairs about the real axis
    beta = np.concatenate([start + 2.0 * np.arctan(roots), np.arctan2(a, y)], axis=1)
    beta = np.mod(beta, 2.0 * np.pi)
    beta = np.where(beta <= np.pi, beta, np.where(beta < 1.5 * np.pi, np.pi, 0.0))
    polished = beta
    for _ in range(_POLISH):
        c, s = np.cos(polished), np.sin(polished)
        up = a - link * s
        apart = np.maximum(np.hypot(x, up), 1e-30)
        pull = r / apart
        slope = y * s - a * c + pull * c * up
        bend = y * c + a * s - pull * (s * up + link * c * c * (x / apart) ** 2)
        step = np.where(bend > 0.0, slope / np.where(bend > 0.0, bend, 1.0), 0.0)
        polished = np.clip(polished - np.clip(step, -0.1, 0.1), 0.0, np.pi)
    ends = np.broadcast_to([0.0, np.pi], (len(beta), 2))
    return np.concatenate([beta, polished, ends], axis=1)
