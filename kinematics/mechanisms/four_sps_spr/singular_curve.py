"""Singular places of the 4-SPS + 1-SPR at a constant orientation: a cubic curve in a plane.

In the plane that the constraint leaves (`plane`) the leg vectors are linear in (u, v), and
D(u, v) = l_1 … l_5 det G, moments by the characteristic length, is a polynomial of degree three. It
is found by interpolation, to rounding; its zeros are the parallel singularities.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.plane import Plane, plane
from kinematics.mechanisms.four_sps_spr.statics import legs, matrix
from kinematics.plane.contours import Contours, zero_curves
from kinematics.screws.wrenches import scale

_DEGREE = 3
_NODES = 6  # along each axis of the interpolation
_NOWHERE = 1e-10  # of what the determinant could be: it vanishes all over the plane
_RAYS = 720
_ROUNDING = 1e-14  # of the coefficients, relative to their sum
_POWERS = [(i, j) for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)]


@dataclass(frozen=True, eq=False, slots=True)
class Cubic:
    """D as a polynomial in ((u, v) − ``center``) / ``unit``: c[i, j] of the powers i and j.

    ``everywhere``: the machine is singular all over the plane.
    """

    center: Array
    unit: float
    c: Array
    everywhere: bool

    def values(self, uv: Array) -> tuple[Array, Array]:
        """D (...,) and its gradient (..., 2) by mm at points (..., 2)."""
        x, y = np.moveaxis((uv - self.center) / self.unit, -1, 0)
        c = self.c
        value = np.polynomial.polynomial.polyval2d(x, y, c)
        by_x = np.polynomial.polynomial.polyval2d(x, y, np.polynomial.polynomial.polyder(c, axis=0))
        by_y = np.polynomial.polynomial.polyval2d(x, y, np.polynomial.polynomial.polyder(c, axis=1))
        return value, np.stack([by_x, by_y], axis=-1) / self.unit

    def second(self, uv: Array) -> Array:
        """The second derivatives (..., 2, 2) by mm² at points (..., 2)."""
        x, y = np.moveaxis((uv - self.center) / self.unit, -1, 0)
        der = np.polynomial.polynomial.polyder
        val = np.polynomial.polynomial.polyval2d
        xx, yy = val(x, y, der(self.c, 2, axis=0)), val(x, y, der(self.c, 2, axis=1))
        xy = val(x, y, der(der(self.c, axis=0), axis=1))
        rows = np.stack([np.stack([xx, xy], axis=-1), np.stack([xy, yy], axis=-1)], axis=-2)
        return np.asarray(rows / self.unit**2)

    def distance(self, uv: Array) -> Array:
        """How far points (..., 2) are from the curve, mm, by the leading term there.

        |D| / |∇D| as a rule; next to double and triple lines a root of |D| by the next derivative.
        """
        value, gradient = self.values(uv)
        slope = np.sqrt((gradient**2).sum(axis=-1))
        bend = 0.5 * np.abs(np.linalg.eigvalsh(self.second(uv))).max(axis=-1)
        top = np.abs([self.c[3, 0], self.c[2, 1], self.c[1, 2], self.c[0, 3]]).max() / self.unit**3
        size = np.abs(value)
        parts = [
            (size / np.maximum(by, 1e-300)) ** (1.0 / power)
            for power, by in ((1, slope), (2, bend), (3, np.asarray(top)))
        ]
        return np.asarray(np.minimum(np.minimum(parts[0], parts[1]), parts[2]))

    def settled(self, uv: Array, rounds: int = 8) -> Array:
        """Points (n, 2) near the curve brought onto it, across it.

        Newton's method for D/|∇D|, which finds double and triple lines as quickly as simple ones.
        """
        for _ in range(rounds):
            value, gradient = self.values(uv)
            square = (gradient**2).sum(axis=-1)
            bend = np.einsum("...i,...ij,...j->...", gradient, self.second(uv), gradient)
            # Towards where D/D' vanishes, at most three of Newton's steps: m for an m-fold line.
            slower = np.clip(
                1.0 - value * bend / np.maximum(square * square, 1e-300), 1.0 / 3.0, 2.0
            )
            uv = uv - (value / np.maximum(square, 1e-300) / slower)[..., None] * gradient
        return uv


@lru_cache(maxsize=64)
def cubic(design: FourSPSSPRDesign, angles: tuple[float, float, float]) -> Cubic:
    """The cubic at an orientation (α, β, γ), rad."""
    here = plane(design, angles)
    center = here.centers[:, 1:].mean(axis=0)
    unit = 0.5 * float(design.stroke[:, 1].mean())
    steps = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    x, y = (v.ravel() for v in np.meshgrid(steps, steps, indexing="ij"))
    values, bound = _determinants(design, here, angles, center + unit * np.stack([x, y], axis=1))
    powers = np.stack([x**i * y**j for i, j in _POWERS], axis=1)
    found = np.linalg.lstsq(powers, values, rcond=None)[0]
    everywhere = bool(np.abs(found).max() <= _NOWHERE * bound)
    # What is left of coefficients that vanish would split double and triple lines.
    found = np.where(np.abs(found) <= _ROUNDING * np.abs(found).max(), 0.0, found)
    c = np.zeros((_DEGREE + 1, _DEGREE + 1))
    for (i, j), value in zip(_POWERS, found, strict=True):
        c[i, j] = value
    return Cubic(center, unit, c, everywhere)


def _determinants(
    design: FourSPSSPRDesign, here: Plane, angles: Sequence[float], uv: Array
) -> tuple[Array, float]:
    """D at points (n, 2), and a bound of what it could be."""
    places = here.place(uv)
    poses = np.hstack([places, np.broadcast_to(np.asarray(angles), (len(places), 3))])
    at = legs(design, poses)
    rows = matrix(at) / scale(design.length)
    product = np.prod(at.length, axis=1)
    hadamard = np.prod(np.linalg.norm(rows, axis=-1), axis=-1)
    answer: Array = np.linalg.det(rows) * product
    return answer, float((product * hadamard).max())


# --- the nearest singular place ------------------------------------------------------------


class Nearest(NamedTuple):
    """A point (2,) of the curve, how far it is, and an estimate of that distance's error, mm."""

    point: Array
    distance: float
    error: float


def nearest_singular(curve: Cubic, point: Array) -> Nearest | None:
    """The point of the curve nearest to a point (2,).

    On every ray from the point the nearest zero is a root of a cubic; the nearest of all rays is
    brought down to rounding by Newton's method on Lagrange's equations. None where there is none.
    """
    if curve.everywhere:
        return Nearest(point.copy(), 0.0, 0.0)
    value, gradient = curve.values(point)
    if float(curve.distance(point)) < 1e-12 * curve.unit:
        return Nearest(point.copy(), 0.0, _ROUNDING * curve.unit)
    angle = 2.0 * np.pi * np.arange(_RAYS) / _RAYS
    ray = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    along = _along_rays(curve, point, ray, float(value), gradient)
    candidates = np.flatnonzero(
        np.isfinite(along) & (along <= np.roll(along, 1)) & (along <= np.roll(along, -1))
    )
    best: tuple[Array, float] | None = None
    for k in candidates[np.argsort(along[candidates])][:12]:
        there = _foot(curve, point, point + along[k] * ray[k])
        distance = float(np.linalg.norm(there - point))
        slack = 1e-9 * along[k] + _blur(curve, there, ray[k])
        if distance > along[k] + slack:  # it strayed: the ray's own zero is right
            there, distance = point + along[k] * ray[k], float(along[k])
        if best is None or distance < best[1]:
            best = there, distance
    if best is None:
        return None
    return Nearest(*best, _blur(curve, best[0], (best[0] - point) / max(best[1], 1e-300)))


def _blur(curve: Cubic, at: Array, direction: Array) -> float:
    """How far rounding in the coefficients may move a zero along a direction, mm.

    Much where zeros coincide: the m-th root of it for m of them.
    """
    noise = _ROUNDING * float(np.abs(curve.c).sum())
    x, y = direction
    _, gradient = curve.values(at)
    c = curve.c
    derivatives = (
        float(gradient @ direction) * curve.unit,
        float(direction @ curve.second(at) @ direction) * curve.unit**2 / 2.0,
        float(c[3, 0] * x**3 + c[2, 1] * x**2 * y + c[1, 2] * x * y**2 + c[0, 3] * y**3),
    )
    shifts = [
        (noise / abs(d)) ** (1.0 / (k + 1)) for k, d in enumerate(derivatives) if abs(d) > 0.0
    ]
    return curve.unit * min(shifts, default=np.inf)


def _along_rays(curve: Cubic, point: Array, ray: Array, value: float, gradient: Array) -> Array:
    """The distance (n,) to the first zero on each ray; infinite where there is none."""
    unit = curve.unit
    first = ray @ gradient * unit
    second = 0.5 * np.einsum("ni,ij,nj->n", ray, curve.second(point), ray) * unit**2
    top = curve.c[3, 0], curve.c[2, 1], curve.c[1, 2], curve.c[0, 3]
    x, y = ray.T
    third = top[0] * x**3 + top[1] * x**2 * y + top[2] * x * y**2 + top[3] * y**3
    # With s = 1/t: value s³ + first s² + second s + third = 0; the largest positive s is nearest.
    companion = np.zeros((len(ray), 3, 3))
    companion[:, 1, 0] = companion[:, 2, 1] = 1.0
    companion[:, 0, 2], companion[:, 1, 2], companion[:, 2, 2] = (
        -third / value,
        -second / value,
        -first / value,
    )
    roots = np.linalg.eigvals(companion)
    # A double root splits into a pair that is nearly real.
    real = np.abs(roots.imag) <= 1e-7 * np.maximum(np.abs(roots), 1e-12)
    s = np.where(real & (roots.real > 1e-9), roots.real, 0.0).max(axis=1)
    with np.errstate(divide="ignore"):
        return np.asarray(np.where(s > 0.0, unit / np.where(s > 0.0, s, 1.0), np.inf))


def _foot(curve: Cubic, point: Array, guess: Array) -> Array:
    """The foot of the perpendicular near a guess: Newton's method on D = 0, q − p = λ ∇D."""
    q = curve.settled(guess[None])[0]
    _, gradient = curve.values(q)
    factor = float((q - point) @ gradient) / max(float(gradient @ gradient), 1e-300)
    for _ in range(20):
        value, gradient = curve.values(q)
        whole = np.zeros((3, 3))
        whole[:2, :2] = np.eye(2) - factor * curve.second(q)
        whole[:2, 2] = -gradient
        whole[2, :2] = gradient
        right = np.append(q - point - factor * gradient, value)
        try:
            step = np.linalg.solve(whole, -right)
        except np.linalg.LinAlgError:
            break
        if not np.isfinite(step).all() or np.abs(step[:2]).max() > curve.unit:
            break
        q, factor = q + step[:2], factor + float(step[2])
        if np.abs(step[:2]).max() < 1e-12 * curve.unit:
            break
    return np.asarray(curve.settled(q[None], rounds=2)[0])


# --- the curve -----------------------------------------------------------------------------


def traced(curve: Cubic, low: Array, high: Array, cells: int = 200) -> Contours:
    """The curve in a box of the plane; none where the machine is singular all over it.

    Found from the signs at the nodes of a grid: a loop that is smaller than a cell is not seen.
    """
    x, y = (np.linspace(low[k], high[k], cells + 1) for k in range(2))
    if curve.everywhere:
        return Contours(np.zeros((0, 2)), np.zeros(1, dtype=np.int64), np.zeros(0))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    return zero_curves(x, y, curve.values(grid)[0], curve.values)
