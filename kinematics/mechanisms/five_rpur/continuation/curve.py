"""The 5-RPUR's configurations along a straight line in joint space: a curve in eleven unknowns.

Unknowns are (X, y, Z, φ, θ), λ along the line and w_i, with X, Z the position of O' and w_i the
z' coordinate of B_i in the base frame turned by R_y(−θ). With a_i, b_i the x', z' coordinates of
A_i, each limb is two quadrics (from Tale Masouleh et al., Meccanica 46 (2011), eqs. 3-6):

    F1: (X + s'_ix − a_i)² + (w_i − b_i)² = ρ_i²        P_i² + p_i² = ρ_i²
    F2: (y + C s'_iy − S s'_iz − r_iy)² + (Z + S s'_iy + C s'_iz − w_i)² = l_i²
                                                         Y_i² + q_i² = l_i²

The combination q_i dF1 + p_i dF2 is free of dw_i, so every Newton step and every tangent is one
small linear solve. In this form a limb may pass v_i ∥ e1 (q_i = 0) smoothly, where its working
mode σ_i = sign q_i changes by itself, and by its arc length the curve passes folds as well.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, inf, isfinite, sin, sqrt
from typing import NamedTuple

import numpy as np

from kinematics.answers.solutions import Posture
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import posture, signs, wrap_angle

_TOLERANCE = 1e-11  # mm, of the closure equations while tracking; ends are polished further
_CONTRACTS = 0.25  # largest ratio of the second Newton step to the first

LAMBDA = 5
"""Where λ, how far along the line (mm), stands among a point's u."""
LAMBDA_FIXED: Array = np.eye(6)[LAMBDA]
LAMBDA_FIXED.setflags(write=False)


class Point(NamedTuple):
    """(X, y, Z, φ, θ, λ) and w, in mm and rad."""

    u: Array
    w: Array

    @property
    def along(self) -> float:
        """λ, mm."""
        return float(self.u[LAMBDA])


@dataclass(frozen=True, slots=True)
class Line:
    """The joints rho + λ direction of a design, with what the equations need at hand."""

    design: FiveRPURDesign
    rho: Array
    direction: Array
    limbs: tuple[tuple[float, ...], ...]  # numbers, as five limbs are too few for array calls
    length: float
    scale: Array
    tolerance: float

    @classmethod
    def of(cls, design: FiveRPURDesign, rho: Array, direction: Array) -> Line:
        """The line from (5,) mm in a direction of length one."""
        length = float(design.link.mean())
        size = max(float(np.abs(v).max()) for v in (design.base, design.platform, rho))
        # The last factor makes the rows of one order, without the poles of 1/ρ.
        rows = 1.0 / (design.link * np.maximum(rho, design.link))
        columns = (design.base, design.platform, design.link, rho, direction, rows)
        return cls(
            design=design,
            rho=rho,
            direction=direction,
            limbs=tuple(tuple(limb) for limb in np.column_stack(columns).tolist()),
            length=length,
            scale=np.array([length, length, length, 1.0, 1.0, length]),
            tolerance=max(_TOLERANCE, 256 * float(np.finfo(float).eps) * size),
        )

    def joints(self, along: float) -> Array:
        """(5,) mm at λ = ``along``."""
        joints: Array = self.rho + along * self.direction
        return joints

    def scaled(self, point: Point) -> Array:
        """All eleven unknowns, u and then w, in units of the link length and of a radian."""
        return np.concatenate([point.u / self.scale, point.w / self.length])


# --- the equations and Newton's method -------------------------------------------------------


class Linear(NamedTuple):
    """The equations at a point: matrix · du = −residual, dw = constant + slope · du."""

    matrix: Array  # (5, 6), scaled: du in units of the link length and of a radian
    residual: Array  # (5,)
    constant: Array  # (5,) mm
    slope: Array  # (5, 6) mm
    q: tuple[float, ...]
    error: float  # mm, of the closure equations


def linear(line: Line, point: Point) -> Linear:
    """The equations' values and derivatives at a point."""
    x, y, z, phi, theta, along = point.u.tolist()
    c, s, cf, sf = cos(theta), sin(theta), cos(phi), sin(phi)
    unit = line.length
    matrix, residual, constant, slope, heights = [], [], [], [], []
    error = 0.0
    for (rx, ry, rz, sx, sy, sz, link, rho_0, dr, row), w in zip(
        line.limbs, point.w.tolist(), strict=True
    ):
        a, b = rx * c - rz * s, rx * s + rz * c
        my, mz = cf * sy - sf * sz, sf * sy + cf * sz
        rho = rho_0 + along * dr
        big_p, p = x + sx - a, w - b
        big_y, q = y + my - ry, z + mz - w
        r1 = 0.5 * (big_p * big_p + p * p - rho * rho)
        r2 = 0.5 * (big_y * big_y + q * q - link * link)
        error = max(error, abs(r1) / max(abs(rho), 1e-9), abs(r2) / link)
        # dF1 = P dX + turn dθ − ρ dρ + p dw,  dF2 = Y dy + q dZ + tilt dφ − q dw
        turn, tilt, drho = big_p * b - p * a, q * my - big_y * mz, rho * dr * unit
        qr, pr = q * row, p * row
        matrix.append(
            (qr * big_p * unit, pr * big_y * unit, pr * q * unit, pr * tilt, qr * turn, -qr * drho)
        )
        residual.append(qr * r1 + pr * r2)
        if abs(p) >= abs(q):  # dw from the equation with the larger pivot
            pivot = p or 1e-300
            constant.append(-r1 / pivot)
            slope.append((-big_p * unit / pivot, 0.0, 0.0, 0.0, -turn / pivot, drho / pivot))
        else:
            constant.append(r2 / q)
            slope.append((0.0, big_y * unit / q, unit, tilt / q, 0.0, 0.0))
        heights.append(q)
    return Linear(
        np.array(matrix),
        np.array(residual),
        np.array(constant),
        np.array(slope),
        tuple(heights),
        error,
    )


class Corrected(NamedTuple):
    """A point on the curve and the equations there."""

    point: Point
    linear: Linear


def correct(
    line: Line, guess: Point, border: Array, *, rounds: int = 6, strict: bool = False
) -> Corrected | None:
    """Newton's method on the equations and border · (u − guess) = 0; None if it fails.

    Args:
        border: (6,), scaled as u is.
        strict: give up where the second step is not much shorter than the first.
    """
    point, before = guess, inf
    for turn in range(rounds):
        at = linear(line, point)
        if at.error <= line.tolerance:
            return Corrected(point, at)
        step = _newton_step(line, at, border)
        if step is None or (strict and turn == 1 and step.size > _CONTRACTS * before):
            return None
        point = Point(point.u + step.du, point.w + step.dw)
        before = step.size
    return None


class _Step(NamedTuple):
    du: Array  # mm and rad
    dw: Array  # mm
    size: float  # scaled


def _newton_step(line: Line, at: Linear, border: Array) -> _Step | None:
    system, right = np.empty((6, 6)), np.zeros(6)
    system[:5], system[5], right[:5] = at.matrix, border, -at.residual
    try:
        du = np.linalg.solve(system, right)
    except np.linalg.LinAlgError:
        return None
    dw = at.constant + at.slope @ du
    size = sqrt(float(du @ du + dw @ dw / line.length**2))
    return _Step(line.scale * du, dw, size) if isfinite(size) else None


def polished(line: Line, point: Point) -> Point:
    """A few more Newton steps at fixed lengths, down to rounding."""
    best, error = point, inf
    for _ in range(4):
        at = linear(line, point)
        if at.error >= error:
            break
        best, error = point, at.error
        step = _newton_step(line, at, LAMBDA_FIXED)
        if step is None:
            break
        point = Point(point.u + step.du, point.w + step.dw)
    return best


# --- places on the curve ---------------------------------------------------------------------


class Place(NamedTuple):
    """A point on the curve, its unit tangent (scaled) and dw along it."""

    point: Point
    tangent: Array  # (6,) of u, scaled
    elbow: Array  # (5,) mm
    q: tuple[float, ...]

    @property
    def slope(self) -> float:
        """dλ along the tangent, scaled: it changes its sign where the curve turns back."""
        return float(self.tangent[LAMBDA])


def place(point: Point, at: Linear, along: Array) -> Place | None:
    """The place of a point of the curve; its tangent continues ``along``."""
    system = np.vstack([at.matrix, along])
    try:
        tangent = np.asarray(np.linalg.solve(system, LAMBDA_FIXED), dtype=float)
    except np.linalg.LinAlgError:
        return None
    tangent = tangent / sqrt(float(tangent @ tangent))
    elbow = at.slope @ tangent
    if not isfinite(float(tangent.sum() + elbow.sum())):
        return None
    return Place(point, tangent, elbow, at.q)


def ahead(line: Line, here: Place, step: float, last: Place | None) -> Point:
    """A step along the tangent; with the place before, along the cubic through both."""
    du, dw = step * here.tangent, step * here.elbow
    if last is not None:
        way, elbows = (here.point.u - last.point.u) / line.scale, here.point.w - last.point.w
        length = sqrt(float(way @ way))
        part = step / length
        cubic, square = step * part * part, step * part
        du = du + (square + cubic) * last.tangent + (2.0 * square + cubic) * here.tangent
        du = du - ((3.0 * square + 2.0 * cubic) / length) * way
        dw = dw + (square + cubic) * last.elbow + (2.0 * square + cubic) * here.elbow
        dw = dw - ((3.0 * square + 2.0 * cubic) / length) * elbows
    return Point(here.point.u + line.scale * du, here.point.w + dw)


# --- between points and postures -------------------------------------------------------------


def start_point(design: FiveRPURDesign, pose: object, mode: str) -> Point:
    """The point of a pose; B_i as the working mode says, with its link along e1 if it must.

    Raises:
        InputError: not five finite numbers, or five signs.
    """
    values = finite(pose, name="a pose", last=5)
    if values.shape != (5,):
        raise InputError("one pose of 5 numbers (x, y, z, φ, θ) is needed")
    x, y, z, phi, theta = values.tolist()
    c, s, cf, sf = cos(theta), sin(theta), cos(phi), sin(phi)
    _, sy, sz = design.platform.T
    across = np.abs(y + cf * sy - sf * sz - design.base[:, 1])
    room = (design.link - across) * (design.link + across)
    q = signs(mode) * np.sqrt(np.maximum(room, 0.0))
    up = x * s + z * c
    w = up + sf * sy + cf * sz - q
    return Point(np.array([x * c - z * s, y, up, phi, theta, 0.0]), w)


def lengths(design: FiveRPURDesign, point: Point) -> Array:
    """ρ of a point (F1), (5,) mm."""
    x, theta = float(point.u[0]), float(point.u[4])
    c, s = cos(theta), sin(theta)
    a = design.base[:, 0] * c - design.base[:, 2] * s
    b = design.base[:, 0] * s + design.base[:, 2] * c
    answer: Array = np.hypot(x + design.platform[:, 0] - a, point.w - b)
    return answer


def as_posture(line: Line, point: Point, mode: str) -> Posture:
    """The posture of a point; its working mode is sign q, where q = 0 the one before."""
    x, y, z, phi, theta, along = point.u.tolist()
    c, s = cos(theta), sin(theta)
    phi, theta = wrap_angle([phi, theta]).tolist()
    q = linear(line, point).q
    mode = "".join(
        old if v == 0.0 else "+" if v > 0 else "-" for v, old in zip(q, mode, strict=True)
    )
    pose = (x * c + z * s, y, z * c - x * s, phi, theta)
    return posture(line.design, pose, mode, known=line.joints(along))
