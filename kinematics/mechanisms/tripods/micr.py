"""The maximum inscribed singularity-free circle about θ = 0 (MICR), exact, for arrays of designs.

MICR is the smallest tilt θ > 0 at which some azimuth is singular (Nayak et al. 2017, section 6). P
has one sign on all azimuths until then, so there it vanishes either at an end w = ± 1 of the range
of w = sin 3φ or at an inner double root, ∂P/∂w = 0. Times c, P is the polynomial

    a3 X³ + a2 X² + a1 X + (1 − q) a0  in  X = c s³ w,

with coefficients polynomial in q = sin² θ/2, so both cases are polynomials in q: of degree up to
eleven for w = ± 1 together, up to twelve for the discriminant. All their roots are taken, polished
on P itself, and the smallest counts.

The paper prints 25.22 and 30.38 degrees for its example (3-SPR, h1 = 1, h2 = 2, Z = 1; modes 1 and
2), which is 25.180332… and 30: see `as_printed`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.circles import MicrTable
from kinematics.arrays import Array, Frozen
from kinematics.errors import InputError
from kinematics.mechanisms.tripods import polynomial
from kinematics.mechanisms.tripods.design import MODES, Kind, mode_sign
from kinematics.mechanisms.tripods.powers import Power

RING = 0.5 * np.pi
"""Tilt at which X and Y of a 3-SPR go to infinity at any fixed altitude."""

_SCAN = 97  # steps in θ between which a sign of P(θ, ± 1) is looked for; odd: 90° is no grid point
_BISECTIONS = 52
_ON_RING = 1e-5
_LAST = 1.0 - 1e-10  # q beyond which the tilt is π: there c P vanishes anyway
_IMAGINARY = 1e-5  # largest imaginary part of a root that may be a real double one
_NEWTON = 24
_STEP = 1e-30  # of the complex step
_SETTLED = 1e-9  # rad: a zero is found to within the square of that; others are none
_VANISHES = 1e-11  # P, by the size of its terms, at a zero


@dataclass(frozen=True, eq=False)
class Micr(Frozen):
    """Radii of maximum inscribed singularity-free circles, arrays of one shape.

    Attributes:
        radius: (...) rad; NaN where no tilt below π is singular.
        contact: (...) w = sin 3φ of the azimuths that are met first.
        crosses_ring: (...) the circle is beyond θ = 90°, where a 3-SPR at a fixed altitude has no
            finite position: it cannot be crossed at this altitude.
    """

    radius: Array
    contact: Array
    crosses_ring: NDArray[np.bool_]


def micr(kind: Kind, base: ArrayLike, platform: ArrayLike, altitude: ArrayLike, mode: str) -> Micr:
    """MICR about θ = 0 for actuation singularities.

    Args:
        base, platform: circumradii h1 and h2, > 0.
        altitude: Z, in the same unit; any sign, the mirror image below the base has the same.
            All three broadcast.

    Raises:
        InputError: not finite, a radius that is not positive, or an altitude of 0: there θ = 0 is
            itself singular.
    """
    h1, h2, z = _checked(base, platform, altitude)
    k = mode_sign(mode) * h2
    shape = np.broadcast_shapes(h1.shape, k.shape, z.shape)
    h1, k, z = (np.broadcast_to(a, shape).ravel() for a in (h1, k, z))
    k, z = k / h1, np.abs(z) / h1
    radius, contact = np.full(len(k), np.inf), np.full(len(k), np.nan)
    for f in (_at_ends, _at_double_roots, _by_signs):
        found = f(kind, k, z)
        if kind == "three_spr" and f is not _by_signs:
            found = _off_the_ring(found, k, z)
        order = np.lexsort((found.tilt, found.row))
        row, first = np.unique(found.row[order], return_index=True)
        tilt, w = found.tilt[order][first], found.w[order][first]
        sooner = tilt < radius[row] - _SETTLED
        radius[row[sooner]], contact[row[sooner]] = tilt[sooner], w[sooner]
    none = ~np.isfinite(radius)
    radius, contact = np.where(none, np.nan, radius), np.where(none, np.nan, contact)
    beyond = (kind == "three_spr") & (none | (radius > RING))
    return Micr(radius.reshape(shape), contact.reshape(shape), beyond.reshape(shape))


def critical_tilts(kind: Kind, k: float, z: float) -> list[float]:
    """Tilts, in order, at which a root w of P enters or leaves [−1, 1], or two meet; h1 = 1."""
    if z == 0.0:
        return []
    one = np.array([k]), np.array([abs(z)])
    found = (f(kind, *one).tilt for f in (_at_ends, _at_double_roots))
    return sorted(float(tilt) for tilt in np.concatenate(list(found)))


def contact_azimuths(contact: float) -> tuple[float, ...]:
    """The azimuths (rad, in (−π, π]) with sin 3φ = ``contact``, in order; six, or three for ± 1."""
    if not np.isfinite(contact):
        return ()
    first = float(np.arcsin(np.clip(contact, -1.0, 1.0)))
    angles = [first] if abs(contact) >= 1.0 - 1e-15 else [first, np.pi - first]
    found = [(angle + 2.0 * np.pi * n) / 3.0 for angle in angles for n in (-1, 0, 1)]
    return tuple(sorted(np.pi - (np.pi - a) % (2.0 * np.pi) for a in found))


def constraint_micr(mode: str) -> float:
    """The same circle for constraint singularities, rad: π, in both modes of both machines.

    x0 or x3 is cos θ/2 in the mode: the operation modes meet at a tilt of π and nowhere else.
    """
    mode_sign(mode)
    return float(np.pi)


# --- the paper's figures -------------------------------------------------------------------

GRID = 0.01
"""rad, the step in θ that the paper's printed values fit."""
PAPER_PI = 3.14


PRINTED_NOTE = (
    "The paper's figures print 25.22° and 30.38° where 25.1803° and 30° are exact: what a grid of "
    "0.01 rad in the tilt, rounded up, and π taken as 3.14 make of them."
)


def as_printed(radius: ArrayLike) -> Array:
    """The degrees that a grid of 0.01 rad, rounded up, and π = 3.14 make of radii in rad.

    25.180332° → 25.22, 30° → 30.38: exactly what Nayak et al. (2017) print in Figs. 3 and 5.
    """
    steps = np.ceil(np.asarray(radius, dtype=float) / GRID - 1e-9)
    return np.asarray(steps * GRID * 180.0 / PAPER_PI)


# --- inside --------------------------------------------------------------------------------


class _Found(NamedTuple):
    """Zeros of P: which machine, tilt and w, (N,) each."""

    row: NDArray[np.intp]
    tilt: Array
    w: Array


def _checked(
    base: ArrayLike, platform: ArrayLike, altitude: ArrayLike
) -> tuple[Array, Array, Array]:
    found = []
    for name, value in (
        ("base radius", base),
        ("platform radius", platform),
        ("altitude", altitude),
    ):
        try:
            array = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            raise InputError(f"the {name} must be a number") from None
        if not np.isfinite(array).all():
            raise InputError(f"the {name} must be a finite number, got NaN or infinity")
        if name != "altitude" and (array <= 0.0).any():
            raise InputError(f"the {name} must be positive, got {array.min():g}")
        if name == "altitude" and (array == 0.0).any():
            raise InputError("the altitude must not be 0: there the level platform is singular")
        found.append(array)
    h1, h2, z = found
    return h1, h2, z


def _at_ends(kind: Kind, k: Array, z: Array) -> _Found:
    """Where P(θ, ± 1) = 0."""
    q = Power.unknown()
    a = polynomial.terms(kind, 1.0, k, z, q)
    cube = q * q * q
    even = a.a0 + cube * a.a2
    odd = a.a1 + cube * (1.0 - q) * a.a3
    row, tilt = _tilts(((1.0 - q) * even * even - cube * odd * odd).roots())
    k, z = k[row], z[row]
    up, down = (np.abs(polynomial.value(kind, 1.0, k, z, tilt, w)) for w in (1.0, -1.0))
    w = np.where(up <= down, 1.0, -1.0)
    step = np.full(tilt.shape, np.inf)
    at = np.arange(len(tilt))
    for _ in range(_NEWTON):
        f, slope = _along_tilt(kind, k[at], z[at], tilt[at], w[at])
        with np.errstate(divide="ignore", invalid="ignore"):
            step[at] = np.clip(np.where(f == 0.0, 0.0, f / slope), -0.1, 0.1)
        tilt[at] -= step[at]
        at = at[np.abs(step[at]) > _SETTLED]
        if not len(at):
            break
    keep = _vanishes(kind, k, z, tilt, w, step)
    return _Found(row[keep], tilt[keep], w[keep])


def _off_the_ring(found: _Found, k: Array, z: Array) -> _Found:
    """Without zeros of P that are none of the determinant P / cos² θ of a 3-SPR.

    At θ = 90°, P = −c (Z − h1 w/2)² (Z + k w): where Z = h2 it touches zero at w = ± 1, and for
    Z < h1/2 it has a double root, on the ring that cannot be reached.
    """
    at, w = z[found.row], found.w
    touches = np.abs(at - np.abs(k[found.row])) < _ON_RING * at
    double = (np.abs(at - 0.5 * w) < _ON_RING * at) & (np.abs(w) < 1.0)
    keep = ~((np.abs(np.cos(found.tilt)) < _ON_RING) & (touches | double))
    return _Found(found.row[keep], found.tilt[keep], found.w[keep])


def _by_signs(kind: Kind, k: Array, z: Array) -> _Found:
    """The first change of sign of P(θ, ± 1) on a grid: what is left where several roots of the
    polynomial nearly coincide, as about Z = h1/2, θ = 90° of a 3-SPR."""
    grid = np.linspace(0.0, np.pi, _SCAN + 1)[:-1]
    a0, a1, a2, a3 = polynomial.terms(kind, 1.0, k[:, None], z[:, None], np.sin(0.5 * grid) ** 2)
    c, cube = np.cos(0.5 * grid), np.sin(0.5 * grid) ** 3
    even, odd = c * (a0 + a2 * cube**2), cube * (a1 + a3 * (c * cube) ** 2)
    rows, tilts, ws = [], [], []
    for w in (1.0, -1.0):
        sign = np.signbit(even + w * odd)
        change = sign[:, 1:] != sign[:, :1]
        row = np.flatnonzero(change.any(axis=1))
        first = change[row].argmax(axis=1)
        low, high = grid[first], grid[first + 1]
        start = sign[row, 0]
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            same = np.signbit(polynomial.value(kind, 1.0, k[row], z[row], middle, w)) == start
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        tilt = 0.5 * (low + high)
        if kind == "three_spr":  # a threefold zero, of which rounding leaves five digits
            tilt = np.where(np.abs(np.cos(tilt)) + np.abs(z[row] - 0.5) < 1e-4, RING, tilt)
        rows.append(row)
        tilts.append(tilt)
        ws.append(np.full(len(row), w))
    return _Found(np.concatenate(rows), np.concatenate(tilts), np.concatenate(ws))


def _at_double_roots(kind: Kind, k: Array, z: Array) -> _Found:
    """Where P has a double root |w| < 1."""
    q = Power.unknown()
    a0, a1, a2, a3 = polynomial.terms(kind, 1.0, k, z, q)
    a0 = (1.0 - q) * a0
    if kind == "three_rps":
        discriminant = a1 * a1 - a0 * a2 * 4.0
    else:
        discriminant = (
            a1 * a1 * a2 * a2
            - a0 * a2 * a2 * a2 * 4.0
            - a1 * a1 * a1 * a3 * 4.0
            - a0 * a0 * a3 * a3 * 27.0
            + a0 * a1 * a2 * a3 * 18.0
        )
    row, tilt = _tilts(discriminant.roots())
    k, z = k[row], z[row]
    c, s = np.cos(0.5 * tilt), np.sin(0.5 * tilt)
    b0, b1, b2, b3 = polynomial.terms(kind, 1.0, k, z, s * s)
    b0 = c * c * b0
    with np.errstate(divide="ignore", invalid="ignore"):
        if kind == "three_rps":
            x = -b1 / (2.0 * b2)
        else:
            x = (9.0 * b0 * b3 - b1 * b2) / (2.0 * (b2 * b2 - 3.0 * b1 * b3))
        w = x / (c * s**3)
    near = np.abs(w) <= 1.1
    row, tilt, w, k, z = row[near], tilt[near], w[near], k[near], z[near]
    step = np.full(tilt.shape, np.inf)
    at = np.arange(len(tilt))
    for _ in range(_NEWTON):
        a = polynomial.in_w(kind, 1.0, k[at], z[at], tilt[at] + _STEP * 1j)
        f, fw, fww = _in(a.real, w[at])
        ft, fwt, _ = _in(a.imag / _STEP, w[at])
        # Newton's method on P = 0 and ∂P/∂w = 0.
        with np.errstate(divide="ignore", invalid="ignore"):
            determinant = ft * fww - fw * fwt
            step[at] = np.clip((f * fww - fw * fw) / determinant, -0.1, 0.1)
            turn = np.clip((ft * fw - fwt * f) / determinant, -0.1, 0.1)
        tilt[at] -= step[at]
        w[at] -= turn
        at = at[np.abs(step[at]) > _SETTLED]
        if not len(at):
            break
    keep = _vanishes(kind, k, z, tilt, w, step) & (np.abs(w) <= 1.0)
    return _Found(row[keep], tilt[keep], w[keep])


def _along_tilt(kind: Kind, k: Array, z: Array, tilt: Array, w: Array) -> tuple[Array, Array]:
    """P and ∂P/∂θ by a complex step, which is exact to rounding."""
    f = polynomial.value(kind, 1.0, k, z, tilt + _STEP * 1j, w)
    return f.real, f.imag / _STEP


def _in(a: Array, w: Array) -> tuple[Array, Array, Array]:
    """A polynomial in w and its two derivatives."""
    return (
        a[..., 0] + w * (a[..., 1] + w * (a[..., 2] + w * a[..., 3])),
        a[..., 1] + w * (2.0 * a[..., 2] + 3.0 * w * a[..., 3]),
        2.0 * a[..., 2] + 6.0 * w * a[..., 3],
    )


def _tilts(roots: NDArray[np.complex128]) -> tuple[NDArray[np.intp], Array]:
    """Of roots (B, n) in q those that are real or nearly so, between 0 and 1: row and tilt."""
    with np.errstate(invalid="ignore"):
        good = np.abs(roots.imag) <= _IMAGINARY * np.abs(roots)
        good &= (roots.real > 0.0) & (roots.real < _LAST)
    row, _ = np.nonzero(good)
    return row, 2.0 * np.arcsin(np.sqrt(roots.real[good]))


def _vanishes(
    kind: Kind, k: Array, z: Array, tilt: Array, w: Array, step: Array
) -> NDArray[np.bool_]:
    """Whether P does vanish there, between 0 and π."""
    with np.errstate(invalid="ignore"):
        a = polynomial.in_w(kind, 1.0, k, z, tilt)
        f, _, _ = _in(a, w)
        good = (np.abs(step) < _SETTLED) & (np.abs(f) <= _VANISHES * np.abs(a).sum(axis=-1))
        good &= (tilt > 0.0) & (tilt < np.pi) & (np.sin(0.5 * tilt) ** 2 < _LAST)
    return np.asarray(good)


def table(kind: Kind, base: ArrayLike, platform: ArrayLike, altitude: ArrayLike) -> MicrTable:
    """MICR in both operation modes, mode 1 first, of radii and altitudes that broadcast (Figs. 4
    and 5: base 1, platform the ratio, altitude Z/h1).

    Raises:
        InputError: as `micr`.
    """
    each = [micr(kind, base, platform, altitude, mode) for mode in MODES]
    contact = np.stack([m.contact for m in each])
    return MicrTable(
        modes=MODES,
        radius=np.stack([m.radius for m in each]),
        contact=np.arcsin(np.clip(contact, -1.0, 1.0)) / 3.0,
        barred=np.stack([m.crosses_ring for m in each]),
        printed=np.stack([as_printed(m.radius) for m in each]),
        note=PRINTED_NOTE,
    )
