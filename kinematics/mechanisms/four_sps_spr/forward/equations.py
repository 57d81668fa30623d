"""The closure equations of the 4-SPS + 1-SPR as quadrics in a dual quaternion.

A pose is x + ε y with x·y = 0 (Study's quadric): R = R̂(x) / N, p = t / N, Rᵀp = w / N with
N = x·x, t = vec(2 y x̄) and w = vec(2 x̄ y), so that p·p = 4 y·y / N (Husty, Mech. Mach. Theory 31
(1996) 365). Times N, |p + R b_i − A_i|² = l_i² and (A_5 − p)·R n = b_5·n become

    4 y·y + 2 w·b_i − 2 t·A_i − 2 A_iᵀ R̂ b_i + (A_i² + b_i² − l_i²) N = 0,    i = 1 … 5
    A_5ᵀ R̂ n − w·n − (b_5·n) N = 0.

With x·y = 0 and a patch, c·x = 1, these are eight equations in eight unknowns. The patch leaves out
x = 0, where they all hold without meaning a pose. Where N = 0 the pose is at infinity.

Everything is in units of the machine, the origins in the centroids of base and platform points.
Arrays of unknowns are (8, paths).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.arrays import Array
from kinematics.homotopy.tracking import Complex, Index, Real, relative_size, solve_columns
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, FourSPSSPRDesign

UNKNOWNS = 8
_MONOMIALS = 17  # N, y·y, w, t, R̂ row by row
SINGULAR, NEAR = 1e-11, 1e-3
"""See `homotopy.solving.Closure`."""
_FAR, _INFINITE = 1e5, 1e10  # extent of what solves the equations but is no pose


class Parameters(NamedTuple):
    """A machine and its lengths, any of them complex; (..., 5, 3), (..., 5, 3), (..., 3), (..., 5).

    Leading axes are machines; there may be one for each path.
    """

    base: NDArray[Any]
    platform: NDArray[Any]
    axis: NDArray[Any]
    squares: NDArray[Any]  # l_i²


@dataclass(frozen=True, eq=False, slots=True)
class Frame:
    """Where the equations' origins and unit stand in the design's own frames, mm."""

    base: Array
    platform: Array
    unit: float

    @classmethod
    def of(cls, design: FourSPSSPRDesign) -> Frame:
        base, platform = design.base.mean(axis=0), design.platform.mean(axis=0)
        spread = max(
            float(np.abs(design.base - base).max()),
            float(np.abs(design.platform - platform).max()),
            0.25 * float(design.stroke[:, 1].max()),
        )
        return cls(base, platform, spread)


def parameters(
    design: FourSPSSPRDesign, joints: ArrayLike, frame: Frame | None = None
) -> Parameters:
    """The parameters of a design at lengths (..., 5), mm."""
    f = Frame.of(design) if frame is None else frame
    lengths = np.asarray(joints, dtype=float) / f.unit
    return Parameters(
        (design.base - f.base) / f.unit,
        (design.platform - f.platform) / f.unit,
        design.axis,
        lengths * lengths,
    )


# --- monomials -----------------------------------------------------------------------------


def _symmetric_forms() -> Array:
    """S with M_m = uᵀ S_m u, (17, 8, 8)."""

    def product(left: Array, right: Array) -> Array:
        """Quaternion product of linear forms (4, 8) as quadratic forms (4, 8, 8)."""
        (a, b, c, d), (e, f, g, h) = left, right
        o = np.multiply.outer
        return np.stack(
            [
                o(a, e) - o(b, f) - o(c, g) - o(d, h),
                o(a, f) + o(b, e) + o(c, h) - o(d, g),
                o(a, g) - o(b, h) + o(c, e) + o(d, f),
                o(a, h) + o(b, g) - o(c, f) + o(d, e),
            ]
        )

    x, y = np.eye(8)[:4], np.eye(8)[4:]
    mirror = np.array([1.0, -1.0, -1.0, -1.0])[:, None]
    norm = np.einsum("ij,ik->jk", x, x)
    square = np.einsum("ij,ik->jk", y, y)
    w = 2.0 * product(mirror * x, y)[1:]
    t = 2.0 * product(y, mirror * x)[1:]
    o = np.multiply.outer
    a, b, c, d = x
    turned = [
        o(a, a) + o(b, b) - o(c, c) - o(d, d),
        2.0 * (o(b, c) - o(a, d)),
        2.0 * (o(b, d) + o(a, c)),
        2.0 * (o(b, c) + o(a, d)),
        o(a, a) - o(b, b) + o(c, c) - o(d, d),
        2.0 * (o(c, d) - o(a, b)),
        2.0 * (o(b, d) - o(a, c)),
        2.0 * (o(c, d) + o(a, b)),
        o(a, a) - o(b, b) - o(c, c) + o(d, d),
    ]
    forms = np.stack([norm, square, *w, *t, *turned])
    return np.asarray(0.5 * (forms + forms.swapaxes(1, 2)))


_FORMS = _symmetric_forms()
_FLAT = np.ascontiguousarray(_FORMS.transpose(1, 0, 2).reshape(UNKNOWNS, -1)).astype(complex)
PATCH = np.exp(1j * np.array([0.3, 2.1, -1.7, 0.9])) * np.array([1.0, 0.8, 1.1, 0.9])
"""c of the patch c·x = 1: complex, so that it is no real pose's way through infinity."""


def _halves(u: Complex) -> Complex:
    """S_m u, (n, 17, 8): half of the monomials' derivatives."""
    return np.asarray((u.T @ _FLAT).reshape(-1, _MONOMIALS, UNKNOWNS))


def coefficients(g: Parameters) -> Complex:
    """C with equations C M = 0, (..., 6, 17); polynomials of degree two in the parameters."""
    base, platform, axis, squares = (np.asarray(v, dtype=complex) for v in g)
    shape = np.broadcast_shapes(
        base.shape[:-2], platform.shape[:-2], axis.shape[:-1], squares.shape[:-1]
    )
    c = np.zeros((*shape, LIMBS + 1, _MONOMIALS), dtype=complex)
    legs = c[..., :LIMBS, :]
    legs[..., 0] = (base * base).sum(axis=-1) + (platform * platform).sum(axis=-1) - squares
    legs[..., 1] = 4.0
    legs[..., 2:5] = 2.0 * platform
    legs[..., 5:8] = -2.0 * base
    turned = base[..., :, None] * platform[..., None, :]
    legs[..., 8:] = -2.0 * turned.reshape(*turned.shape[:-2], 9)
    last = c[..., LIMBS, :]
    last[..., 0] = -(platform[..., SPR, :] * axis).sum(axis=-1)
    last[..., 2:5] = -axis
    spr = base[..., SPR, :, None] * axis[..., None, :]
    last[..., 8:] = spr.reshape(*spr.shape[:-2], 9)
    return c


def _system(c: Complex, u: Complex) -> tuple[Complex, Complex, Complex]:
    """Equations (n, 8), their derivatives (n, 8, 8), and the monomials (n, 17)."""
    halves = _halves(u)
    points = u.T
    monomials = (halves @ points[:, :, None])[..., 0]
    values = np.empty((len(points), UNKNOWNS), dtype=complex)
    by_u = np.zeros((len(points), UNKNOWNS, UNKNOWNS), dtype=complex)
    values[:, : LIMBS + 1] = (c @ monomials[..., None])[..., 0]
    by_u[:, : LIMBS + 1] = 2.0 * (c @ halves)
    values[:, 6] = (points[:, :4] * points[:, 4:]).sum(axis=1)
    by_u[:, 6, :4], by_u[:, 6, 4:] = points[:, 4:], points[:, :4]
    values[:, 7] = points[:, :4] @ PATCH - 1.0
    by_u[:, 7, :4] = PATCH
    return values, by_u, monomials


def _solve(matrix: Complex, right: Complex) -> Complex:
    """(n, 8, m); a matrix that cannot be solved spoils no other."""
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        moved = solve_columns(matrix.transpose(1, 2, 0), right.transpose(1, 2, 0))
        return np.ascontiguousarray(moved.transpose(2, 0, 1))


class Deformation:
    """The equations while the parameters move straight from one machine to another.

    ``around``: how far t leads through complex values on the way, as t + i t (1 − t) around.
    """

    def __init__(self, start: Parameters, end: Parameters, around: float = 0.0) -> None:
        # C is of degree two in the parameters, so three points tell it.
        middle = Parameters(*(0.5 * (a + b) for a, b in zip(start, end, strict=True)))
        c0, c1, c2 = (coefficients(g) for g in (start, middle, end))
        self._c0 = c0
        self._c1 = 4.0 * c1 - 3.0 * c0 - c2
        self._c2 = 2.0 * (c0 + c2) - 4.0 * c1
        self._around = 1j * around

    def take(self, columns: Index) -> Deformation:
        part = object.__new__(Deformation)
        part._around = self._around
        for name in ("_c0", "_c1", "_c2"):
            value = getattr(self, name)
            setattr(part, name, value[columns] if value.ndim == 3 else value)
        return part

    def extent(self, u: Complex) -> Real:
        return extent(u)

    def step(self, u: Complex, t: Complex | Real) -> tuple[Complex, Complex]:
        at = np.asarray(t)[:, None, None]
        s = at * (1.0 + (1.0 - at) * self._around)
        ds = 1.0 + (1.0 - 2.0 * at) * self._around
        c = self._c0 + s * (self._c1 + s * self._c2)
        dc = ds * (self._c1 + 2.0 * s * self._c2)
        values, by_u, monomials = _system(c, u)
        right = np.zeros((len(values), UNKNOWNS, 2), dtype=complex)
        right[:, :, 0] = -values
        right[:, : LIMBS + 1, 1] = -(dc @ monomials[..., None])[..., 0]
        solved = _solve(by_u, right)
        return np.ascontiguousarray(solved[..., 0].T), np.ascontiguousarray(solved[..., 1].T)


between = Deformation


def extent(u: Complex) -> Real:
    """|u|² / |N|, (n,): about the square of how far out a pose is, in units."""
    norm = np.abs((u[:4] * u[:4]).sum(axis=0))
    return np.asarray((np.abs(u) ** 2).sum(axis=0) / np.maximum(norm, 1e-300))


def polish(g: Parameters, u: Complex, rounds: int = 3) -> tuple[Complex, Real]:
    """Newton's method; the points, and the size of the last step relative to max(1, |u|)."""
    c = coefficients(g)
    error = np.full(u.shape[1], np.inf)
    with np.errstate(all="ignore"):
        for _ in range(rounds):
            values, by_u, _ = _system(c, u)
            step = _solve(by_u, -values[..., None])[..., 0].T
            u = u + step
            error = relative_size(step, u)
    return u, error


def regularity(g: Parameters, u: Complex) -> Real:
    """Smallest singular value of the equations relative to the largest, (n,)."""
    if not u.size:
        return np.zeros(0)
    _, by_u, _ = _system(coefficients(g), u)
    sound = np.asarray(np.isfinite(by_u).all(axis=(1, 2)))
    sizes = np.linalg.svd(np.where(sound[:, None, None], by_u, 0.0), compute_uv=False)
    return np.asarray(sizes[:, -1] / np.maximum(sizes[:, 0], 1e-300))


# --- between unknowns and poses ------------------------------------------------------------


def normal_form(u: Complex) -> Complex:
    """The same poses with x·x = 1, the largest component of x with a positive real part."""
    with np.errstate(all="ignore"):
        norm = np.sqrt((u[:4] * u[:4]).sum(axis=0))
        scaled = u / norm
    largest = np.abs(scaled[:4]).argmax(axis=0)
    sign = np.where(scaled[largest, np.arange(u.shape[1])].real < 0.0, -1.0, 1.0)
    return np.asarray(scaled * sign)


def on_patch(u: Complex) -> Complex:
    """The same poses with c·x = 1."""
    return np.asarray(u / (PATCH @ u[:4]))


def conjugate(u: Complex) -> Complex:
    """The conjugate poses, on the patch."""
    return on_patch(u.conj())


def placed(u: Complex) -> Complex:
    """R and p of each, (12, n): the same for the same pose, whatever u's scale."""
    with np.errstate(all="ignore"):
        monomials = (_halves(u) @ u.T[:, :, None])[..., 0].T
        values: Complex = np.concatenate([monomials[8:], monomials[5:8]]) / monomials[0]
    return values


def marks(u: Complex) -> tuple[Complex, Real]:
    """`placed`, see `homotopy.solving.Closure`; digits are lost with the distance."""
    values = placed(u)
    return values, np.maximum(np.abs(values).max(axis=0), 1.0)


def infinite(values: Complex, goals: Complex) -> NDArray[np.bool_]:
    """Where the norm of the rotation vanishes, or nearly so."""
    return ~((extent(values) < _FAR) | (extent(goals) < _INFINITE))


def of(g: Parameters, columns: Index) -> Parameters:
    """The machine of some targets, which differ in their lengths, for columns (n,) of them."""
    return g._replace(squares=np.atleast_2d(g.squares)[columns])


def to_transforms(frame: Frame, u: Complex) -> tuple[Array, Array]:
    """R (n, 3, 3) and p (n, 3) mm of real solutions, in the design's own frames."""
    real = normal_form(u).real
    real[:4] /= np.sqrt((real[:4] * real[:4]).sum(axis=0))
    real[4:] -= (real[:4] * real[4:]).sum(axis=0) * real[:4]  # onto Study's quadric
    m = placed(real.astype(complex)).real
    r = m[:9].T.reshape(-1, 3, 3)
    p = frame.base + frame.unit * m[9:].T - r @ frame.platform
    return r, p
