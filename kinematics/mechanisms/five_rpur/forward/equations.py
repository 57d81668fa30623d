"""The 5-RPUR's constraints over the complex numbers, for many configurations at a time.

In the base frame turned by R_y(−θ) (Tale Masouleh et al., Meccanica 46 (2011), eqs. 3-6), with
a_i, b_i the x', z' coordinates of A_i, each limb is two quadrics:

    F1: P² + p² = ρ²,  P = X + s'_x − a,              p = w − b
    F2: Y² + q² = l²,  Y = y + C s'_y − S s'_z − r_y,  q = Z + S s'_y + C s'_z − w

Unknowns are u = (X, y, Z, e^{iφ}, e^{iθ}, w_1 … w_5), one column a configuration. With the
exponentials everything is rational, so no step needs a sine. Where the exponentials have modulus
one and the rest is real, the configuration is real; in general the conjugate of a solution of a
real machine is (X*, y*, Z*, 1/e^{iφ}*, 1/e^{iθ}*, w*).

Lengths here are divided by the machine's unit, and counted from the centroids of the base and of
the platform points: so all machines are of one size and near each other.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.arrays import Array
from kinematics.homotopy.tracking import determinant_columns, relative_size, solve_columns
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.screws.spatial import wrap_angle

Complex = NDArray[np.complex128]

UNKNOWNS = 10
X, Y, Z, PHI, THETA, W = 0, 1, 2, 3, 4, slice(5, 10)


class Parameters(NamedTuple):
    """What a machine with given actuator lengths consists of, without unit.

    Each (5, 1), or (5, n) with a column a configuration; real or complex.
    """

    rx: Complex | Array
    ry: Complex | Array
    rz: Complex | Array
    sx: Complex | Array
    sy: Complex | Array
    sz: Complex | Array
    link2: Complex | Array
    rho2: Complex | Array

    def take(self, columns: NDArray[np.intp]) -> Parameters:
        """The parameters of some of the configurations."""
        return Parameters(*(v if v.shape[1] == 1 else v[:, columns] for v in self))


class Frame(NamedTuple):
    """How a design's millimetres become numbers: the origin and the unit on both sides."""

    unit: float
    base: Array
    platform: Array

    @staticmethod
    @lru_cache(maxsize=64)
    def of(design: FiveRPURDesign) -> Frame:
        """The unit is a root mean square of the design's lengths, whatever the strokes."""
        base, platform = design.base.mean(axis=0), design.platform.mean(axis=0)
        squares = (
            ((design.base - base) ** 2).sum(axis=1).mean(),
            ((design.platform - platform) ** 2).sum(axis=1).mean(),
            (design.link**2).mean(),
        )
        return Frame(float(np.sqrt(np.sum(squares))), base, platform)


def parameters(design: FiveRPURDesign, joints: ArrayLike, frame: Frame | None = None) -> Parameters:
    """The parameters of a design at actuator lengths (..., 5) mm; a column a length vector."""
    frame = frame or Frame.of(design)
    rho = np.asarray(joints, dtype=float).reshape(-1, LIMBS).T / frame.unit
    r = ((design.base - frame.base) / frame.unit).T[:, :, None]
    s = ((design.platform - frame.platform) / frame.unit).T[:, :, None]
    link = (design.link / frame.unit)[:, None]
    return Parameters(r[0], r[1], r[2], s[0], s[1], s[2], link * link, rho * rho)


SINGULAR, NEAR = 1e-12, 1e-4
"""See `homotopy.solving.Closure`."""
_NEAR_ENOUGH = 10.0  # units within which regular solutions look so
_FAR, _MOST_FAR = 1e3, 1e3  # units, and how much less two solutions out there need to agree


# --- the equations -------------------------------------------------------------------------


class Terms(NamedTuple):
    """The pieces of the equations at some configurations: each (5, n) but the four of angles."""

    big_p: Complex
    p: Complex
    big_y: Complex
    q: Complex
    a: Complex
    b: Complex
    my: Complex  # C s'_y − S s'_z
    mz: Complex  # S s'_y + C s'_z
    cos_phi: Complex
    sin_phi: Complex
    cos_theta: Complex
    sin_theta: Complex


def terms(g: Parameters, u: Complex) -> Terms:
    """The pieces of the equations of machines ``g`` at configurations u (10, n)."""
    inverse = 1.0 / u[PHI : THETA + 1]
    cosine = 0.5 * (u[PHI : THETA + 1] + inverse)
    sine = -0.5j * (u[PHI : THETA + 1] - inverse)
    cf, c = cosine
    sf, s = sine
    a, b = g.rx * c - g.rz * s, g.rx * s + g.rz * c
    my, mz = g.sy * cf - g.sz * sf, g.sy * sf + g.sz * cf
    w = u[W]
    return Terms(
        u[X] + g.sx - a, w - b, u[Y] + my - g.ry, u[Z] + mz - w, a, b, my, mz, cf, sf, c, s
    )


def residuals(g: Parameters, u: Complex) -> tuple[Complex, Complex]:
    """F1 and F2, halved, (5, n) each."""
    t = terms(g, u)
    return _residuals(g, t)


def _residuals(g: Parameters, t: Terms) -> tuple[Complex, Complex]:
    return (
        0.5 * (t.big_p * t.big_p + t.p * t.p - g.rho2),
        0.5 * (t.big_y * t.big_y + t.q * t.q - g.link2),
    )


def matrix(t: Terms) -> Complex:
    """q dF1 + p dF2 over (X, θ, y, Z, φ), free of dw: (5 limbs, 5 columns, n).

    In this order no leading minor vanishes for good: limbs in one working mode of a simplified
    arrangement have parallel entries in the last three columns.
    """
    rows = np.empty((LIMBS, 5, t.p.shape[1]), dtype=complex)
    np.multiply(t.q, t.big_p, out=rows[:, 0])
    np.multiply(t.q, t.big_p * t.b - t.p * t.a, out=rows[:, 1])
    np.multiply(t.p, t.big_y, out=rows[:, 2])
    np.multiply(t.p, t.q, out=rows[:, 3])
    np.multiply(t.p, t.q * t.my - t.big_y * t.mz, out=rows[:, 4])
    return rows


def steps(
    u: Complex,
    t: Terms,
    *sides: tuple[Complex, Complex],
    solve: Callable[[Complex, Complex], Complex] = solve_columns,
) -> list[Complex]:
    """du with dF1 = −f1 and dF2 = −f2 for every pair (f1, f2) of (5, n), halved as F1, F2 are."""
    rows = matrix(t)
    right = np.empty((LIMBS, len(sides), u.shape[1]), dtype=complex)
    for k, (f1, f2) in enumerate(sides):
        right[:, k] = -(t.q * f1 + t.p * f2)
    solved = solve(rows, right)
    # dw by least squares from its two equations, which agree: one of p, q may vanish.
    cp, cq = t.p.conj(), t.q.conj()
    weight = (t.p * cp + t.q * cq).real
    cp, cq = cp / weight, cq / weight
    turn, tilt = t.big_p * t.b - t.p * t.a, t.q * t.my - t.big_y * t.mz
    answer = []
    for k, (f1, f2) in enumerate(sides):
        dx, dtheta, dy, dz, dphi = solved[:, k]
        du = np.empty_like(u)
        du[X], du[Y], du[Z] = dx, dy, dz
        du[PHI] = 1j * u[PHI] * dphi
        du[THETA] = 1j * u[THETA] * dtheta
        e1 = f1 + t.big_p * dx + turn * dtheta
        e2 = f2 + t.big_y * dy + t.q * dz + tilt * dphi
        du[W] = cq * e2 - cp * e1
        answer.append(du)
    return answer


def extent(u: Complex) -> Array:
    """How far out: the largest of all moduli and of 1/|e^{iφ}|, 1/|e^{iθ}|, (n,)."""
    size = np.abs(u)
    with np.errstate(all="ignore"):
        answer: Array = np.maximum(size.max(axis=0), (1.0 / size[PHI : THETA + 1]).max(axis=0))
    return answer


def regularity(g: Parameters, u: Complex) -> Array:
    """As `steepness`, but far out every solution looks singular: there it counts that Newton's
    method settles."""
    far = np.maximum(extent(u) / _NEAR_ENOUGH, 1.0)
    return steepness(g, u) * far * far


def steepness(g: Parameters, u: Complex) -> Array:
    """How far the equations are from singular at configurations u (10, n): 0 … 1, (n,).

    |det| of the matrix over (X, θ, y, Z, φ), displacements in the size of the configuration,
    with rows of length one.
    """
    with np.errstate(all="ignore"):
        rows = matrix(terms(g, u))
        size = np.maximum(np.abs(u[:PHI]).max(axis=0), 1.0)
        rows[:, 0] *= size
        rows[:, 2:4] *= size
        lengths = np.sqrt((rows.real**2 + rows.imag**2).sum(axis=1)).prod(axis=0)
        answer: Array = np.abs(determinant_columns(rows)) / lengths
    return np.nan_to_num(answer, nan=0.0, posinf=0.0)


def polish(
    g: Parameters, u: Complex, rounds: int = 3, enough: float = 0.0
) -> tuple[Complex, Array]:
    """Newton's method with a pivoting solver, until all corrections are small ``enough``: the
    points, and their last correction (n,)."""
    error = np.full(u.shape[1], np.inf)
    with np.errstate(all="ignore"):
        for _ in range(rounds):
            t = terms(g, u)
            du = steps(u, t, _residuals(g, t), solve=_solve_pivoting)[0]
            u = u + du
            error = relative_size(du, u)
            if (error <= enough).all():
                break
    return u, error


def _solve_pivoting(rows: Complex, right: Complex) -> Complex:
    a, b = rows.transpose(2, 0, 1), right.transpose(2, 0, 1)
    # Rows of one order; where nothing can be solved the step is nonsense, and long.
    size = np.abs(a).max(axis=2, keepdims=True)
    size[~(size > 0.0)] = 1.0
    a, b = a / size, b / size
    bad = ~np.isfinite(a).all(axis=(1, 2)) | ~np.isfinite(b).all(axis=(1, 2))
    if bad.any():
        a, b = np.where(bad[:, None, None], np.eye(5), a), np.where(bad[:, None, None], 1.0, b)
    try:
        x = np.linalg.solve(a, b)
    except np.linalg.LinAlgError:
        x = np.linalg.pinv(a) @ b  # one of many is singular to the last digit
    return np.asarray(x.transpose(1, 2, 0).astype(complex, copy=False))


class Deformation:
    """A machine that turns into another, straight: g(s) = (1 − s) start + s end.

    What stays the same may be given as the same array on both sides; then it costs nothing.
    ``around``: how far s leads through complex values on the way, as t + i t (1 − t) around.
    """

    def __init__(self, start: Parameters, end: Parameters, around: float = 0.0) -> None:
        self._start, self._end, self._around = start, end, 1j * around
        self._moving = tuple(a is not b for a, b in zip(start, end, strict=True))

    def take(self, columns: NDArray[np.intp]) -> Deformation:
        """The same for some of the paths."""
        part = object.__new__(Deformation)
        part._start, part._end = self._start.take(columns), self._end.take(columns)
        part._around, part._moving = self._around, self._moving
        return part

    def at(self, t: Complex | Array) -> tuple[Parameters, Parameters]:
        """The machine at t and its derivative."""
        s: NDArray[Any] = t
        ds: NDArray[Any] = _ONCE
        if self._around:
            s, ds = t * (1.0 + (1.0 - t) * self._around), 1.0 + (1.0 - 2.0 * t) * self._around
        pairs = zip(self._start, self._end, self._moving, strict=True)
        ways = [(a, b - a if moving else None) for a, b, moving in pairs]
        now = Parameters(*(a if way is None else a + s * way for a, way in ways))
        return now, Parameters(*(_NOTHING if way is None else ds * way for _, way in ways))

    def step(self, u: Complex, t: Complex | Array) -> tuple[Complex, Complex]:
        """Newton's step at fixed t, and du/dt along the path; (10, n) each."""
        g, dg = self.at(t)
        at = terms(g, u)
        moved = (dg.rho2, dg.link2)
        f1: Complex = -0.5 * moved[0] + np.zeros_like(at.p)
        f2: Complex = -0.5 * moved[1] + np.zeros_like(at.p)
        if self._moving[0] or self._moving[2] or self._moving[3]:
            f1 += at.big_p * (dg.sx - dg.rx * at.cos_theta + dg.rz * at.sin_theta)
            f1 -= at.p * (dg.rx * at.sin_theta + dg.rz * at.cos_theta)
        if self._moving[1] or self._moving[4] or self._moving[5]:
            f2 += at.big_y * (dg.sy * at.cos_phi - dg.sz * at.sin_phi - dg.ry)
            f2 += at.q * (dg.sy * at.sin_phi + dg.sz * at.cos_phi)
        newton, tangent = steps(u, at, _residuals(g, at), (f1, f2))
        return newton, tangent

    def extent(self, u: Complex) -> Array:
        return extent(u)


_NOTHING, _ONCE = np.zeros((1, 1)), np.ones(1)


# --- real and complex ----------------------------------------------------------------------


def conjugate(u: Complex) -> Complex:
    """The conjugate configurations; a real one is its own."""
    answer: Complex = u.conj()
    answer[PHI : THETA + 1] = 1.0 / answer[PHI : THETA + 1]
    return answer


def from_real(values: Array, w: Array) -> Complex:
    """Configurations from (5, n) X, y, Z, φ, θ and (5, n) w."""
    u = np.empty((UNKNOWNS, values.shape[1]), dtype=complex)
    u[:3] = values[:3]
    u[PHI : THETA + 1] = np.exp(1j * values[3:])
    u[W] = w
    return u


def real_part(u: Complex) -> tuple[Array, Array]:
    """The real configuration next to u: X, y, Z, φ, θ (5, n) and w (5, n)."""
    values = np.empty((5, u.shape[1]))
    values[:3] = u[:3].real
    values[3:] = np.angle(u[PHI : THETA + 1])
    return values, u[W].real.copy()


def to_poses(frame: Frame, values: Array) -> Array:
    """Poses (n, 5), mm and rad, of X, y, Z, φ, θ (5, n) in a design's frame."""
    x, y, z, phi, theta = values
    c, s, cf, sf = np.cos(theta), np.sin(theta), np.cos(phi), np.sin(phi)
    sx, sy, sz = frame.platform
    x = frame.unit * x - sx
    y = frame.unit * y - (cf * sy - sf * sz)
    z = frame.unit * z - (sf * sy + cf * sz)
    rx, ry, rz = frame.base
    return np.stack(
        [rx + c * x + s * z, ry + y, rz - s * x + c * z, wrap_angle(phi), wrap_angle(theta)],
        axis=-1,
    )


def from_poses(frame: Frame, poses: Array, elbows: Array) -> Complex:
    """Configurations of poses (n, 5) with B_i (n, 5, 3), mm, in the base frame."""
    c, s = np.cos(poses[:, 4]), np.sin(poses[:, 4])
    cf, sf = np.cos(poses[:, 3]), np.sin(poses[:, 3])
    rx, ry, rz = frame.base
    sx, sy, sz = frame.platform
    px, py, pz = poses[:, 0] - rx, poses[:, 1] - ry, poses[:, 2] - rz
    values = np.stack(
        [
            (px * c - pz * s + sx) / frame.unit,
            (py + cf * sy - sf * sz) / frame.unit,
            (px * s + pz * c + sf * sy + cf * sz) / frame.unit,
            poses[:, 3],
            poses[:, 4],
        ]
    )
    w = ((elbows[..., 0] - rx).T * s + (elbows[..., 2] - rz).T * c) / frame.unit
    return from_real(values, w)


def marks(u: Complex) -> tuple[Complex, Array]:
    """The unknowns themselves, see `homotopy.solving.Closure`.

    Far out digits are lost with the square of the size, as `tracking` has it.
    """
    return u, np.clip((extent(u) / _FAR) ** 2, 1.0, _MOST_FAR)


def infinite(values: Complex, goals: Complex) -> NDArray[np.bool_]:
    """None: what solves the equations is a pose."""
    return np.zeros(values.shape[1], dtype=bool)


between = Deformation


def of(g: Parameters, columns: NDArray[np.intp]) -> Parameters:
    """The machine of some targets, which differ in their lengths, for columns (n,) of them."""
    return g if g.rho2.shape[1] == 1 else g._replace(rho2=g.rho2[:, columns])
