"""Closure equations of limbs that hold points on spheres or in planes, in Study's coordinates.

A pose is a dual quaternion x + ε y with x·y = 0 (Study's quadric): R = R̂(x) / N, p = t / N,
Rᵀp = w / N with N = x·x, t = vec(2 y x̄) and w = vec(2 x̄ y), so that p·p = 4 y·y / N (Husty, Mech.
Mach. Theory 31 (1996) 365). Times N, the equations |p + R b − a|² = l² of a sphere,
n·(p + R b − a) = 0 of a plane of the base and n·(Rᵀ(a − p) − b) = 0 of one of the platform become

    4 y·y + 2 w·b − 2 t·a − 2 aᵀ R̂ b + (a² + b² − l²) N = 0
    n·t + nᵀ R̂ b − (n·a) N = 0
    aᵀ R̂ n − w·n − (b·n) N = 0.

With x·y = 0 and a patch, c·x = 1, six of them are eight equations in eight unknowns. Where N = 0
the pose is at infinity. Everything is in units of the machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.homotopy.forms import Deformation, FormEquations, normal_form, rotation_forms
from kinematics.homotopy.tracking import Complex, Index

Plane = Literal["", "base", "platform"]
"""What else a limb says besides its sphere: that B is in a plane of the base, or A in one of the
platform."""
_MONOMIALS = 17  # N, y·y, w, t, R̂ row by row


class Limbs(NamedTuple):
    """Limbs, any number of them complex; (..., L, 3) thrice and (..., L).

    Leading axes are machines; there may be one for each path.
    """

    base: NDArray[Any]
    platform: NDArray[Any]
    axis: NDArray[Any]  # normals of planes; what it is of a limb without one does not matter
    squares: NDArray[Any]  # l²


class StudyEquations(FormEquations[Limbs]):
    """One sphere for each limb, and the planes of some.

    Args:
        planes: of each limb.
    """

    def __init__(self, planes: Sequence[Plane]) -> None:
        super().__init__(FORMS, QUADRIC)
        self.planes = tuple(planes)

    def coefficients(self, g: Limbs) -> Complex:
        base, platform, axis, squares = (np.asarray(v, dtype=complex) for v in g)
        count = len(self.planes)
        shape = np.broadcast_shapes(
            base.shape[:-2], platform.shape[:-2], axis.shape[:-2], squares.shape[:-1]
        )
        flat = [n for n, plane in enumerate(self.planes) if plane]
        c = np.zeros((*shape, count + len(flat), _MONOMIALS), dtype=complex)
        legs = c[..., :count, :]
        legs[..., 0] = (base * base).sum(axis=-1) + (platform * platform).sum(axis=-1) - squares
        legs[..., 1] = 4.0
        legs[..., 2:5] = 2.0 * platform
        legs[..., 5:8] = -2.0 * base
        legs[..., 8:] = -2.0 * _products(base, platform)
        for k, n in enumerate(flat, count):
            a, b, axis_n = base[..., n, :], platform[..., n, :], axis[..., n, :]
            row = c[..., k, :]
            if self.planes[n] == "base":
                row[..., 0] = -(a * axis_n).sum(axis=-1)
                row[..., 5:8] = axis_n
                row[..., 8:] = _products(axis_n, b)
            else:
                row[..., 0] = -(b * axis_n).sum(axis=-1)
                row[..., 2:5] = -axis_n
                row[..., 8:] = _products(a, axis_n)
        return c

    def of(self, g: Limbs, columns: Index) -> Limbs:
        """Of targets that differ in their centres and lengths."""
        base = np.asarray(g.base)
        base = base if base.ndim == 2 else base[columns]
        return g._replace(base=base, squares=np.atleast_2d(g.squares)[columns])

    def between(self, start: Limbs, end: Limbs, around: float = 0.0) -> Deformation[Limbs]:
        middle = Limbs(*(0.5 * (a + b) for a, b in zip(start, end, strict=True)))
        return Deformation(self, start, middle, end, around)

    def placed(self, u: Complex) -> Complex:
        """R and p of each, (12, n)."""
        return placed(u)


def placed(u: Complex) -> Complex:
    """R and p of each, (12, n): the same for the same pose, whatever u's scale."""
    with np.errstate(all="ignore"):
        halves = (u.T @ _FLAT).reshape(-1, _MONOMIALS, len(u))
        monomials = (halves @ u.T[:, :, None])[..., 0].T
        values: Complex = np.concatenate([monomials[8:], monomials[5:8]]) / monomials[0]
    return values


def real_poses(u: Complex) -> tuple[Array, Array]:
    """R (n, 3, 3) and p (n, 3), in units, of real solutions (8, n)."""
    real = normal_form(u).real
    real[:4] /= np.sqrt((real[:4] * real[:4]).sum(axis=0))
    real[4:] -= (real[:4] * real[4:]).sum(axis=0) * real[:4]  # onto Study's quadric
    m = placed(real.astype(complex)).real
    return m[:9].T.reshape(-1, 3, 3), np.ascontiguousarray(m[9:].T)


def _products(one: Complex, other: Complex) -> Complex:
    turned = one[..., :, None] * other[..., None, :]
    return np.asarray(turned.reshape(*turned.shape[:-2], 9))


def _quadric() -> NDArray[np.float64]:
    """x·y, (1, 8, 8)."""
    form = np.zeros((1, 8, 8))
    form[0, :4, 4:] = form[0, 4:, :4] = 0.5 * np.eye(4)
    return form


def _forms() -> NDArray[np.float64]:
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
    turned = np.zeros((9, 8, 8))
    turned[:, :4, :4] = rotation_forms()
    forms = np.stack([norm, square, *w, *t, *turned])
    return np.asarray(0.5 * (forms + forms.swapaxes(1, 2)))


FORMS = _forms()
"""(17, 8, 8) of N, y·y, w, t and R̂, row by row."""
QUADRIC = _quadric()
"""(1, 8, 8) of x·y."""
_FLAT = np.ascontiguousarray(FORMS.transpose(1, 0, 2).reshape(8, -1)).astype(complex)
