"""Equations that are combinations of some quadratic forms in a pose, as closures of mechanisms are.

A pose is a point of a quadric in projective space: x, of which the rotation is R = R̂(x) / x·x, and
perhaps more. Each closure equation is a combination C M = 0 of forms M in it, C a polynomial of
degree two in the parameters of a machine; with fixed equations and a patch, c·x = 1, they are as
many as the unknowns. The patch leaves out x = 0, where the forms mean no pose.

Arrays of unknowns are (K, paths).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from kinematics.homotopy.tracking import Complex, Index, Real, relative_size, solve_columns

P = TypeVar("P", bound=tuple[Any, ...])

_FAR, _INFINITE = 1e5, 1e10  # extent of what solves the equations but is no pose
PATCH = np.exp(1j * np.array([0.3, 2.1, -1.7, 0.9])) * np.array([1.0, 0.8, 1.1, 0.9])
"""c of the patch c·x = 1: complex, so that it is no real pose's way through infinity."""


class FormEquations(ABC, Generic[P]):
    """The closure equations of some machines, see `homotopy.solving.Closure`.

    Args:
        forms: (M, K, K) symmetric.
        fixed: (F, K, K) symmetric: forms that vanish.
    """

    SINGULAR = 1e-11
    NEAR = 1e-3

    def __init__(self, forms: NDArray[np.float64], fixed: NDArray[np.float64]) -> None:
        self.unknowns, self.monomials = forms.shape[1], len(forms)
        flat = forms.transpose(1, 0, 2).reshape(self.unknowns, -1)
        self._flat = np.ascontiguousarray(flat).astype(complex)
        self._fixed = fixed.astype(complex)

    @abstractmethod
    def coefficients(self, g: P) -> Complex:
        """C (..., E, M): polynomials of degree two in the parameters."""

    @abstractmethod
    def of(self, g: P, columns: Index) -> P:
        """Parameters for n points, ``columns`` (n,) the target of each."""

    @abstractmethod
    def placed(self, u: Complex) -> Complex:
        """What tells poses apart, (L, n): the same for the same pose, whatever u's scale."""

    @abstractmethod
    def between(self, start: P, end: P, around: float = 0.0) -> Deformation[P]:
        """From one machine to another."""

    # --- the equations

    def halves(self, u: Complex) -> Complex:
        """S_m u, (n, M, K): half of the forms' derivatives."""
        return np.asarray((u.T @ self._flat).reshape(-1, self.monomials, self.unknowns))

    def system(self, c: Complex, u: Complex) -> tuple[Complex, Complex, Complex]:
        """Equations (n, K), their derivatives (n, K, K), and the forms (n, M)."""
        halves, points = self.halves(u), u.T
        monomials = (halves @ points[:, :, None])[..., 0]
        count, more = c.shape[-2], len(self._fixed)
        values = np.empty((len(points), self.unknowns), dtype=complex)
        by_u = np.zeros((len(points), self.unknowns, self.unknowns), dtype=complex)
        values[:, :count] = (c @ monomials[..., None])[..., 0]
        by_u[:, :count] = 2.0 * (c @ halves)
        for k, form in enumerate(self._fixed, count):
            half = points @ form
            values[:, k] = (half * points).sum(axis=1)
            by_u[:, k] = 2.0 * half
        values[:, count + more] = points[:, :4] @ PATCH - 1.0
        by_u[:, count + more, :4] = PATCH
        return values, by_u, monomials

    def polish(self, g: P, u: Complex, rounds: int = 3) -> tuple[Complex, Real]:
        """Newton's method; the points, and the size of the last step relative to max(1, |u|)."""
        c = self.coefficients(g)
        error = np.full(u.shape[1], np.inf)
        with np.errstate(all="ignore"):
            for _ in range(rounds):
                values, by_u, _ = self.system(c, u)
                step = solved(by_u, -values[..., None])[..., 0].T
                u = u + step
                error = relative_size(step, u)
        return u, error

    def regularity(self, g: P, u: Complex) -> Real:
        """Smallest singular value of the equations relative to the largest, (n,)."""
        if not u.size:
            return np.zeros(0)
        _, by_u, _ = self.system(self.coefficients(g), u)
        sound = np.asarray(np.isfinite(by_u).all(axis=(1, 2)))
        sizes = np.linalg.svd(np.where(sound[:, None, None], by_u, 0.0), compute_uv=False)
        return np.asarray(sizes[:, -1] / np.maximum(sizes[:, 0], 1e-300))

    # --- what solutions are

    def on_patch(self, u: Complex) -> Complex:
        """The same poses with c·x = 1."""
        return np.asarray(u / (PATCH @ u[:4]))

    def conjugate(self, u: Complex) -> Complex:
        """The conjugate poses, on the patch."""
        return self.on_patch(u.conj())

    def marks(self, u: Complex) -> tuple[Complex, Real]:
        """`placed`, see `homotopy.solving.Closure`; digits are lost with the distance."""
        values = self.placed(u)
        return values, np.maximum(np.abs(values).max(axis=0), 1.0)

    def infinite(self, values: Complex, goals: Complex) -> NDArray[np.bool_]:
        """Where the norm of the rotation vanishes, or nearly so."""
        return ~((extent(values) < _FAR) | (extent(goals) < _INFINITE))


class Deformation(Generic[P]):
    """The equations while the parameters move straight from one machine to another.

    ``around``: how far t leads through complex values on the way, as t + i t (1 − t) around.
    """

    def __init__(
        self, equations: FormEquations[P], start: P, middle: P, end: P, around: float = 0.0
    ) -> None:
        # C is of degree two in the parameters, so three points tell it.
        c0, c1, c2 = (equations.coefficients(g) for g in (start, middle, end))
        self._equations = equations
        self._c0 = c0
        self._c1 = 4.0 * c1 - 3.0 * c0 - c2
        self._c2 = 2.0 * (c0 + c2) - 4.0 * c1
        self._around = 1j * around

    def take(self, columns: Index) -> Deformation[P]:
        part: Deformation[P] = object.__new__(Deformation)
        part._equations = self._equations
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
        values, by_u, monomials = self._equations.system(c, u)
        right = np.zeros((*values.shape, 2), dtype=complex)
        right[:, :, 0] = -values
        right[:, : c.shape[-2], 1] = -(dc @ monomials[..., None])[..., 0]
        found = solved(by_u, right)
        return np.ascontiguousarray(found[..., 0].T), np.ascontiguousarray(found[..., 1].T)


def extent(u: Complex) -> Real:
    """|u|² / |x·x|, (n,): about the square of how far out a pose is, in units."""
    norm = np.abs((u[:4] * u[:4]).sum(axis=0))
    return np.asarray((np.abs(u) ** 2).sum(axis=0) / np.maximum(norm, 1e-300))


def normal_form(u: Complex) -> Complex:
    """The same poses with x·x = 1, the largest component of x with a positive real part."""
    with np.errstate(all="ignore"):
        norm = np.sqrt((u[:4] * u[:4]).sum(axis=0))
        scaled = u / norm
    largest = np.abs(scaled[:4]).argmax(axis=0)
    sign = np.where(scaled[largest, np.arange(u.shape[1])].real < 0.0, -1.0, 1.0)
    return np.asarray(scaled * sign)


def solved(matrix: Complex, right: Complex) -> Complex:
    """(n, K, m); a matrix that cannot be solved spoils no other."""
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        moved = solve_columns(matrix.transpose(1, 2, 0), right.transpose(1, 2, 0))
        return np.ascontiguousarray(moved.transpose(2, 0, 1))


def rotation_forms() -> NDArray[np.float64]:
    """(9, 4, 4) of R̂(x), row by row."""
    a, b, c, d = np.eye(4)
    o = np.multiply.outer
    forms = np.stack(
        [
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
    )
    return np.asarray(0.5 * (forms + forms.swapaxes(1, 2)))
