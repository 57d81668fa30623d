"""All complex solutions of one operation mode for given limb lengths: two conics and their four
common points.

Seen as a 3-RPS (`posing.Reduced`), the limb lengths say with u_i = e^{iα_i} that
r_i² = D0 + Re(D1 u_i). With V = x0 v, S = Im ζ³, a = Re ζ³, γ = 4 k (V + k S), C = 2 k² − 4 k h and
E = D0 − (k − h)², these are equivalent to

    C ζ² − i γ ζ̄ = D1,   γ a = Im(D̄1 ζ²),   C a = Re(D1 ζ),
    γ²/(16 k²) + ½ Re(D̄1 ζ²) − k² a² + (E + 2 k h) |ζ|² = E,

where the third makes one of (x1, x2, γ, a) redundant and the others are quadratic forms equal to a
constant: three central quadrics in three-space, hence 8 solutions in pairs ± (the mirror images
v → −v), found as the four common points of two conics. (Of the last equation the terms of third
degree in q cancel.) Both operation modes together are the 16 solutions of Nayak et al. (2017),
eqs. 7 and 8.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.tripods.design import AZIMUTHS, LIMBS
from kinematics.mechanisms.tripods.limbs import offsets
from kinematics.mechanisms.tripods.posing import Reduced
from kinematics.mechanisms.tripods.study import Values

Complex = NDArray[np.complex128]

PAIRS = 4
_U = np.exp(1j * np.array(AZIMUTHS))
_COS, _SIN = np.cos(AZIMUTHS), np.sin(AZIMUTHS)
_NEWTON = 8
_CLOSE = 1e-15  # relative miss that rounding leaves
_LOST = 1e-13  # relative size of a quartic that vanishes: the conics have a curve in common
# An orthogonal matrix like any other, so that no two common points share a first coordinate.
_TURN = np.linalg.qr(np.random.default_rng(20170104).normal(size=(3, 3)))[0]


class Roots(NamedTuple):
    """Solutions for B vectors of lengths; those of a pair ± follow one another.

    Attributes:
        x0, x1, x2, v: (B, 8) complex, x0² + x1² + x2² = 1, v in units of ``k``.
        miss: (B, 8) what is left of the equations, by the size of their terms.
        curve: (B,) the solutions form a curve: the four points are some of it, or none.
    """

    x0: Complex
    x1: Complex
    x2: Complex
    v: Complex
    miss: Array
    curve: NDArray[np.bool_]


def roots(h: float, sign: float, lengths: Array) -> Roots:
    """All solutions of the mode with k = ``sign`` = ±1, for lengths (B, 3) and a revolute radius
    ``h`` in units of the spherical radius."""
    k, square = sign, lengths**2
    mean = square.mean(axis=-1)
    d = (2.0 / 3.0) * (square * _U.conj()).sum(axis=-1)
    slope, e = 2.0 * k * k - 4.0 * k * h, mean - (k - h) ** 2
    scale = 4.0 * (1.0 + np.sqrt(mean))  # of γ, so that all unknowns are of the same size
    forms, constants = _evened(*_forms(h, k, slope, e, d, scale))
    plane = _plane(slope, d)
    inner = plane.swapaxes(-1, -2)[:, None] @ forms @ plane[:, None]  # (B, 4, 3, 3)
    first, second, level, size = _conics(inner, constants)
    points, curve = _common_points(first, second)  # (B, 4, 3)
    height = np.einsum("bpi,bij,bpj->bp", points, level, points)
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.sqrt(size[:, None] / height)  # both signs of the root are solutions
    unknowns = np.einsum("bij,bpj->bpi", plane, points * reach[..., None])
    x1, x2, gamma = unknowns[..., 0], unknowns[..., 1], unknowns[..., 2] * scale[:, None]
    x1, x2, gamma = (np.stack([u, -u], axis=-1).reshape(len(u), -1) for u in (x1, x2, gamma))
    q = x1 * x1 + x2 * x2
    x0 = np.sqrt(1.0 - q)
    lift = gamma / (4.0 * k) - k * (3.0 * x1 * x1 * x2 - x2**3)
    altitude = np.sqrt(e[:, None] - k * k * q * q - 2.0 * k * h * q)
    with np.errstate(divide="ignore", invalid="ignore"):
        v = lift / x0
    # Where x0 is small v is known from the lengths' mean alone, but for its sign.
    near = np.abs(v - altitude) <= np.abs(v + altitude)
    v = np.where(np.abs(x0) < 0.1, np.where(near, altitude, -altitude), v)
    ends = np.abs(x0) < 1e-12
    v = np.where(ends, altitude * np.tile([1.0, -1.0], PAIRS), v)
    rough = np.stack([x0, x1, x2, v], axis=-1).reshape(-1, 4)
    found, miss = _polished(h, k, np.repeat(square, 2 * PAIRS, axis=0), rough)
    found = found.reshape(len(square), 2 * PAIRS, 4)
    a, b, c, d = (found[..., n] for n in range(4))
    return Roots(a, b, c, d, miss.reshape(len(square), -1), curve)


def lengths_and_slopes(h: float, k: float, u: Values) -> tuple[Values, Values]:
    """r_i² (..., 3) and its derivatives by x0, x1, x2, v (..., 3, 4); complex numbers allowed."""
    x0, x1, x2, v = (u[..., n] for n in range(4))
    p, z = offsets(h, k, Reduced(x0, x1, x2, v))
    x0, x1, x2 = (a[..., None] for a in (x0, x1, x2))
    one = np.ones(LIMBS)
    out = [
        2.0 * k * x0 * one,
        4.0 * k * (x1 * _COS - x2 * _SIN),
        -4.0 * k * (x2 * _COS + x1 * _SIN),
    ]
    up = [2.0 * k * (x1 * _SIN - x2 * _COS), 2.0 * k * x0 * _SIN, -2.0 * k * x0 * _COS]
    parts = [2.0 * (p * a + z * b) for a, b in zip(out, up, strict=True)]
    slopes = np.stack([*parts, 2.0 * z], axis=-1)
    return p * p + z * z, slopes


# --- inside --------------------------------------------------------------------------------


def _forms(h: float, k: float, c: float, e: Array, d: Complex, scale: Array) -> tuple[Array, Array]:
    """The four quadratic forms in (x1, x2, γ/scale, a), (B, 4, 4, 4), and their values (B, 4)."""
    forms = np.zeros((len(d), 4, 4, 4))

    def add(form: int, i: int, j: int, value: Array | float) -> None:
        forms[:, form, i, j] += 0.5 * np.asarray(value)
        forms[:, form, j, i] += 0.5 * np.asarray(value)

    add(0, 0, 0, c)
    add(0, 1, 1, -c)
    add(0, 1, 2, -scale)
    add(1, 0, 1, 2.0 * c)
    add(1, 0, 2, -scale)
    add(2, 2, 3, scale)
    add(2, 0, 1, -2.0 * d.real)
    add(2, 0, 0, d.imag)
    add(2, 1, 1, -d.imag)
    add(3, 2, 2, scale**2 / (16.0 * k * k))
    add(3, 0, 0, 0.5 * d.real + e + 2.0 * k * h)
    add(3, 1, 1, -0.5 * d.real + e + 2.0 * k * h)
    add(3, 0, 1, d.imag)
    add(3, 3, 3, -k * k)
    return forms, np.stack([d.real, d.imag, np.zeros(len(d)), e], axis=-1)


def _evened(forms: Array, constants: Array) -> tuple[Array, Array]:
    """Each equation counts alike; in the plane one may vanish, which is then no equation."""
    weight = np.linalg.norm(forms, axis=(-1, -2)) + np.abs(constants)
    weight = np.where(weight > 0.0, weight, 1.0)
    return forms / weight[..., None, None], constants / weight


def _plane(c: float, d: Complex) -> Array:
    """Orthonormal coordinates of C a = Re(D1 ζ), (B, 4, 3), turned at random."""
    row = np.stack([d.real, -d.imag, np.zeros(len(d)), np.full(len(d), -c)], axis=-1)
    _, _, axes = np.linalg.svd(row[:, None, :])
    return np.asarray(axes[:, 1:].swapaxes(-1, -2) @ _TURN)


def _conics(forms: Array, constants: Array) -> tuple[Array, Array, Array, Array]:
    """Two forms that vanish at all solutions, one that does not, and the value of that one."""
    # Combined so that one constant is left.
    _, size, turn = np.linalg.svd(constants[:, None, :])
    mixed = np.einsum("bmn,bnij->bmij", turn, forms)
    level = mixed[:, 0] * np.sign(np.einsum("bn,bn->b", turn[:, 0], constants))[:, None, None]
    upper = np.triu_indices(3)
    flat = mixed[:, 1:][..., upper[0], upper[1]] * np.where(upper[0] == upper[1], 1.0, 2.0)
    _, _, basis = np.linalg.svd(flat)
    return basis[:, 0], basis[:, 1], level, size[:, 0]


def _common_points(first: Array, second: Array) -> tuple[Complex, NDArray[np.bool_]]:
    """The four common points (B, 4, 3) of two conics (B, 6): xx, xy, xz, yy, yz, zz."""
    a, b = ([conic[:, n] for n in range(6)] for conic in (first, second))

    def by_y(conic: list[Array]) -> tuple[Array, Array, Array]:
        xx, xy, xz, yy, yz, zz = conic  # with z = 1, polynomials in x: lowest degree first
        zero = np.zeros_like(xx)
        return (
            np.stack([zz, xz, xx], axis=-1),
            np.stack([yz, xy, zero], axis=-1),
            np.stack([yy, zero, zero], axis=-1),
        )

    a0, a1, a2 = by_y(a)
    b0, b1, b2 = by_y(b)
    outer = _times(a2, b0) - _times(a0, b2)
    upper = _times(a2, b1) - _times(a1, b2)
    lower = _times(a1, b0) - _times(a0, b1)
    quartic = (_times(outer, outer) - _times(upper, lower))[:, :5]
    size = np.abs(quartic).max(axis=-1)
    curve = size < _LOST
    quartic = np.where(curve[:, None], np.array([-1.0, 0, 0, 0, 1.0]), quartic)
    leading = quartic[:, -1]
    leading = np.where(leading == 0.0, 1e-300, leading)
    companion = np.zeros((len(quartic), 4, 4))
    companion[:, range(1, 4), range(3)] = 1.0
    companion[:, :, 3] = -quartic[:, :4] / leading[:, None]
    x = np.linalg.eigvals(companion).astype(complex)
    power = x[..., None] ** np.arange(5)
    top, bottom = ((power * p[:, None, :]).sum(axis=-1) for p in (outer, upper))
    with np.errstate(divide="ignore", invalid="ignore"):
        y = -top / bottom
    y = np.where(np.isfinite(y), y, 0.0)
    points = np.stack([x, y, np.ones_like(x)], axis=-1)
    return points / np.linalg.norm(points, axis=-1, keepdims=True), curve


def _times(a: Array, b: Array) -> Array:
    found = np.zeros((len(a), a.shape[1] + b.shape[1] - 1))
    for n in range(a.shape[1]):
        found[:, n : n + b.shape[1]] += a[:, n : n + 1] * b
    return found


def _miss(h: float, k: float, square: Array, u: Complex) -> Array:
    """How far points (N, 4) are from being solutions (N,), by what rounding may leave.

    p and z of a limb are sums of terms that may cancel, which matters where limbs are short.
    """
    p, z = offsets(h, k, Reduced(*(u[..., n] for n in range(4))))
    x0, x1, x2, v = (np.abs(u[..., n, None]) for n in range(4))
    outward, upward = x0**2 + 2.0 * (x1 + x2) ** 2 + h, v + 2.0 * x0 * (x1 + x2)
    terms = np.abs(p) * outward + np.abs(z) * upward
    off = (np.abs(p * p + z * z - square) / (square + terms)).max(axis=-1)
    x0, x1, x2 = (x[..., 0] for x in (x0, x1, x2))
    norm = np.abs((u[..., :3] ** 2).sum(axis=-1) - 1.0) / (1.0 + x0**2 + x1**2 + x2**2)
    return np.asarray(np.maximum(off, norm))


def _polished(h: float, k: float, square: Array, u: Complex) -> tuple[Complex, Array]:
    """Newton's method on the lengths themselves; a step that makes it worse is not taken.

    Points (N, 4) for squares (N, 3); also returns what they miss by.
    """
    miss = _miss(h, k, square, u)
    at = np.arange(len(u))
    for _ in range(_NEWTON):
        at = at[miss[at] > _CLOSE]
        if not len(at):
            break
        here, wanted = u[at], square[at]
        found, slopes = lengths_and_slopes(h, k, here)
        matrix = np.empty((len(at), 4, 4), complex)
        matrix[:, :3] = slopes
        matrix[:, 3, :3], matrix[:, 3, 3] = 2.0 * here[:, :3], 0.0
        one = (here[:, :3] ** 2).sum(axis=-1, keepdims=True)
        right = np.concatenate([wanted - found, 1.0 - one], axis=-1)
        regular = np.isfinite(matrix).all(axis=(-1, -2)) & np.isfinite(right).all(axis=-1)
        matrix = np.where(regular[:, None, None], matrix, np.eye(4))
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            tried = here + _solve(matrix, np.where(regular[:, None], right, 0.0))
            new = _miss(h, k, wanted, tried)
        better = new < miss[at]
        at, tried, new = at[better], tried[better], new[better]
        u[at], miss[at] = tried, new
    return u, miss


def _solve(matrix: Complex, right: Complex) -> Complex:
    try:
        found = np.linalg.solve(matrix, right[..., None])[..., 0]
    except np.linalg.LinAlgError:  # exactly singular at a double solution
        found = (np.linalg.pinv(matrix) @ right[..., None])[..., 0]
    return found.astype(complex)
