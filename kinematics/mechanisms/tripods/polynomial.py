"""The actuation singularities as P(Z, θ, w) = 0 with w = sin 3φ: a polynomial of degree two (3-RPS)
or three (3-SPR) in w.

Nayak et al. (2017), section 5.2, give the singularity as det J = 0 and plot it; this is the factor
p⁷ of eq. 14 written out in tilt and azimuth. Operation mode 1 is mode 2 with −h2 for h2. The
determinant of the six unnormed wrenches is ± 6.75 c h2³ P (3-RPS) or ± 6.75 c h1³ P / cos² θ
(3-SPR), c = cos θ/2: its other factor is the constraint singularity at θ = π.

With q = s² = sin² θ/2 and S = s³ w: P = c a0 + a1 S + c a2 S² + c² a3 S³. Lengths mm, P mm³, angles
rad; P is homogeneous of degree three in the lengths, so any other unit will do.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.mechanisms.tripods.design import Kind
from kinematics.mechanisms.tripods.powers import Power

Values = NDArray[Any]


class Terms(NamedTuple):
    """P = c a0 + a1 S + c a2 S² + c² a3 S³ with S = s³ w; a_n are polynomials in q = s²."""

    a0: Any
    a1: Any
    a2: Any
    a3: Any


def terms(kind: Kind, h1: Any, k: Any, z: Any, q: Any) -> Terms:
    """The coefficients of P at q = sin² θ/2; numbers, arrays, or `powers.Power` series in q.

    Args:
        h1: base radius.
        k: ± platform radius, + in operation mode 2.
        z: altitude.
    """
    p = 1.0 - q  # c²
    cosine = 1.0 - 2.0 * q
    zero = 0.0 * q * (h1 + k + z)
    if kind == "three_rps":
        inner = (
            p * p * (2.0 * k * k)
            + p * (4.0 * h1 * k - 5.0 * k * k)
            - (4.0 * h1 * h1 + 2.0 * h1 * k - 2.0 * k * k)
        )
        return Terms(
            (cosine * (z * z) + q * inner) * z,
            (p * (3.0 * k) + (h1 - k)) * (2.0 * z * z)
            - p * (p * k - (h1 + k)) * (p * k + 2.0 * (h1 - k)) * (2.0 * k),
            zero + 4.0 * k * k * z,
            zero,
        )
    inner = (
        p * p * (2.0 * h1 * h1)
        + p * (4.0 * h1 * k - 5.0 * h1 * h1)
        + (2.0 * h1 * h1 - 2.0 * h1 * k - 4.0 * k * k)
    )
    return Terms(
        (q * cosine * inner + z * z) * (-z),
        2.0 * (h1 - k) * z * z
        - p * cosine * (p * p * (2.0 * h1) - p * (5.0 * h1) + 2.0 * (h1 + k)) * (2.0 * h1 * k),
        (q * (-h1) + 2.0 * k) * (4.0 * h1 * z),
        zero - 8.0 * h1 * h1 * k,
    )


def in_w(kind: Kind, h1: ArrayLike, k: ArrayLike, z: ArrayLike, tilt: ArrayLike) -> Values:
    """Coefficients (..., 4) of 1, w, w², w³ at a tilt, mm³; the tilt may be complex."""
    h1, k, z = (np.asarray(value, dtype=float) for value in (h1, k, z))
    c, s = np.cos(0.5 * np.asarray(tilt)), np.sin(0.5 * np.asarray(tilt))
    a0, a1, a2, a3 = terms(kind, h1, k, z, s * s)
    parts = (c * a0, s**3 * a1, c * s**6 * a2, c * c * s**9 * a3)
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def value(
    kind: Kind, h1: ArrayLike, k: ArrayLike, z: ArrayLike, tilt: ArrayLike, w: ArrayLike
) -> Values:
    """P itself, mm³; tilt and w may be complex."""
    a = in_w(kind, h1, k, z, tilt)
    w = np.asarray(w)
    return np.asarray(a[..., 0] + w * (a[..., 1] + w * (a[..., 2] + w * a[..., 3])))


def roots_in_w(kind: Kind, h1: float, k: float, z: float, tilt: Values) -> Values:
    """The three (3-SPR) or two (3-RPS) roots w of P at tilts (n,), complex; NaN at infinity.

    P of a 3-SPR has a double root near w = 2 Z/h1 about θ = 90°. There it is solved for v instead,
    the altitude seen from the platform, Z = h1 s² sin θ w − v cos θ: in v it stays regular.
    """
    if kind == "three_rps":
        return Power(in_w(kind, h1, k, z, tilt)[:, :3]).roots()
    c, s, cosine, sine = np.cos(0.5 * tilt), np.sin(0.5 * tilt), np.cos(tilt), np.sin(tilt)
    q = s * s
    spread = h1 * q * sine
    side = np.sign(k)
    with np.errstate(divide="ignore", invalid="ignore"):
        # P = cos² θ P′, where P′ is that of the 3-RPS with base |k| and platform ± h1 at v and the
        # azimuth of the inverse: its s³ sin 3φ is ∓ s³ w, which is linear in v.
        cube = Power(-side * (s**3 / spread)[:, None] * np.stack([z + 0.0 * s, cosine], axis=-1))
        a0, a1, a2, _ = terms("three_rps", abs(k), side * h1, Power.unknown(), q)
    v = a0 * c + cube * a1 + cube * cube * a2 * c
    regular = np.isfinite(v.coefficients).all(axis=-1)
    roots = Power(np.where(regular[:, None], v.coefficients, 0.0)).roots()
    with np.errstate(divide="ignore", invalid="ignore"):
        found = (z + roots * cosine[:, None]) / spread[:, None]
    return np.where(regular[:, None], found, np.nan)
