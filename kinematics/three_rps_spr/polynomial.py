"""The actuation singularities as P(Z, θ, w) = 0 with w = sin 3φ: a polynomial of degree two (3-RPS)
or three (3-SPR) in w.

Nayak et al. (2017), section 5.2, give the singularity as det J = 0 and plot it; this is the factor
p⁷ of eq. 14 written out in tilt and azimuth. Operation mode 1 is mode 2 with −h2 for h2. The
determinant of the six unnormed wrenches is ± 6.75 c h2³ P (3-RPS) or ± 6.75 c h1³ P / cos² θ (3-SPR),
c = cos θ/2: its other factor is the constraint singularity at θ = π.

Written with q = s² = sin² θ/2 and S = s³ w: P = c [a0 + a2 S² (+ …)] + a1 S + …, see `terms`. All
functions take arrays and complex numbers. Lengths mm (or anything), angles rad.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.three_rps_spr.design import Kind

Values = NDArray[Any]


class Terms(NamedTuple):
    """P = c a0 + a1 S + c a2 S² + c² a3 S³ with S = s³ w; a_n are polynomials in q = s²."""

    a0: Values
    a1: Values
    a2: Values
    a3: Values


def terms(kind: Kind, h1: ArrayLike, k: ArrayLike, z: ArrayLike, q: ArrayLike) -> Terms:
    """The coefficients of P at q = sin² θ/2.

    Args:
        h1: base radius.
        k: ± platform radius, + in operation mode 2.
        z: altitude.
    """
    h1, k, z, q = (np.asarray(value) for value in (h1, k, z, q))
    p = 1.0 - q  # c²
    cosine = 1.0 - 2.0 * q
    zero = 0.0 * (h1 + k + z + q)
    if kind == "three_rps":
        inner = (
            2 * p * p * k * k
            + 4 * p * h1 * k
            - 5 * p * k * k
            - 4 * h1 * h1
            - 2 * h1 * k
            + 2 * k * k
        )
        return Terms(
            z * (cosine * z * z + q * inner),
            2 * (3 * p * k + h1 - k) * z * z
            - 2 * p * k * (p * k - h1 - k) * (p * k + 2 * h1 - 2 * k),
            4 * k * k * z + zero,
            zero,
        )
    inner = (
        2 * p * p * h1 * h1
        - 5 * p * h1 * h1
        + 4 * p * h1 * k
        + 2 * h1 * h1
        - 2 * h1 * k
        - 4 * k * k
    )
    return Terms(
        -z * (z * z + q * cosine * inner),
        2 * (h1 - k) * z * z
        - 2 * p * cosine * h1 * k * (2 * p * p * h1 - 5 * p * h1 + 2 * h1 + 2 * k),
        4 * h1 * (2 * k - q * h1) * z,
        -8 * h1 * h1 * k + zero,
    )


def in_w(kind: Kind, h1: ArrayLike, k: ArrayLike, z: ArrayLike, tilt: ArrayLike) -> Values:
    """Coefficients (..., 4) of 1, w, w², w³ at a tilt, mm³ (mm⁵ … by the design: see `terms`)."""
    c, s = np.cos(0.5 * np.asarray(tilt)), np.sin(0.5 * np.asarray(tilt))
    a0, a1, a2, a3 = terms(kind, h1, k, z, s * s)
    parts = (c * a0, s**3 * a1, c * s**6 * a2, c * c * s**9 * a3)
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def value(
    kind: Kind, h1: ArrayLike, k: ArrayLike, z: ArrayLike, tilt: ArrayLike, w: ArrayLike
) -> Values:
    """P itself."""
    a = in_w(kind, h1, k, z, tilt)
    w = np.asarray(w)
    found: Values = a[..., 0] + w * (a[..., 1] + w * (a[..., 2] + w * a[..., 3]))
    return found


def slopes(
    kind: Kind, h1: ArrayLike, k: ArrayLike, z: ArrayLike, tilt: ArrayLike, w: ArrayLike
) -> tuple[Values, Values]:
    """∂P/∂θ and ∂P/∂w; the first by a complex step, which is exact to rounding."""
    step = 1e-30
    by_tilt = value(kind, h1, k, z, np.asarray(tilt) + 1j * step, w).imag / step
    a = in_w(kind, h1, k, z, tilt)
    w = np.asarray(w)
    by_w = a[..., 1] + w * (2.0 * a[..., 2] + 3.0 * w * a[..., 3])
    return by_tilt, by_w
