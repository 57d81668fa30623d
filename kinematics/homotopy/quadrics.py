"""Systems of quadratic equations, written as they read: sums of products of affine forms.

    x, y, s = unknowns(3)
    rod = Quadrics.of([0.5 * (square(x - s) + square(y) - 4.0)])

The closure equations of most mechanisms are such a system when sines and cosines, or the entries of
a rotation, count as unknowns. Products are evaluated factor by factor, so that differences of large
numbers lose no digits; derivatives are exact, and the second ones are constant.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import add

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array


class Form:
    """An affine form: (n,) coefficients of the unknowns and a constant."""

    __array_ufunc__ = None  # so that array · form is refused instead of taken apart

    def __init__(self, slopes: Array, constant: float = 0.0) -> None:
        self.slopes, self.constant = slopes, constant

    def __add__(self, other: Form | float) -> Form:
        if isinstance(other, Form):
            return Form(self.slopes + other.slopes, self.constant + other.constant)
        return Form(self.slopes, self.constant + float(other))

    def __mul__(self, factor: float) -> Form:
        return Form(self.slopes * float(factor), self.constant * float(factor))

    def __sub__(self, other: Form | float) -> Form:
        return self + -1.0 * other

    def __rsub__(self, other: float) -> Form:
        return -1.0 * self + other

    __radd__, __rmul__ = __add__, __mul__

    def by(self, other: Form) -> Quadric:
        """The product of two forms."""
        return Quadric([(self, other)])


class Quadric:
    """A sum of products of two forms each, and a constant."""

    def __init__(self, products: list[tuple[Form, Form]], constant: float = 0.0) -> None:
        self.products, self.constant = products, constant

    def __add__(self, other: Quadric | Form | float) -> Quadric:
        if isinstance(other, Form):
            other = other.by(Form(0.0 * other.slopes, 1.0))
        if isinstance(other, Quadric):
            return Quadric(self.products + other.products, self.constant + other.constant)
        return Quadric(self.products, self.constant + float(other))

    def __mul__(self, factor: float) -> Quadric:
        return Quadric([(factor * a, b) for a, b in self.products], factor * self.constant)

    def __sub__(self, other: Quadric | Form | float) -> Quadric:
        return self + -1.0 * other

    __radd__, __rmul__ = __add__, __mul__


def unknowns(count: int) -> list[Form]:
    """The unknowns themselves."""
    return [Form(row) for row in np.eye(count)]


def square(form: Form) -> Quadric:
    """The square of a form."""
    return form.by(form)


def dot(one: Iterable[Form], other: Iterable[Form]) -> Quadric:
    """The scalar product of two vectors of forms."""
    return Quadric(list(zip(one, other, strict=True)))


def image(matrix: Iterable[Iterable[Form]], vector: ArrayLike) -> list[Form]:
    """A matrix of forms times a vector of numbers."""
    numbers = np.asarray(vector, dtype=float).tolist()
    return [reduce(add, [v * f for v, f in zip(numbers, row, strict=True)]) for row in matrix]


@dataclass(frozen=True, eq=False)
class Quadrics:
    """M equations F(v) = 0 in N unknowns: F = constant + sums @ ((left v + l) * (right v + r)).

    Attributes:
        left, right: (K, N).
        left_at, right_at: (K,).
        sums: (M, K) 0 or 1: which products belong to an equation.
        constant: (M,).
    """

    left: Array
    left_at: Array
    right: Array
    right_at: Array
    sums: Array
    constant: Array

    @classmethod
    def of(cls, equations: Sequence[Quadric]) -> Quadrics:
        """The system of some equations, all in the same unknowns."""
        pairs = [pair for equation in equations for pair in equation.products]
        left, right = ([pair[side] for pair in pairs] for side in (0, 1))
        owner = np.repeat(np.arange(len(equations)), [len(e.products) for e in equations])
        return cls(
            np.array([form.slopes for form in left]),
            np.array([form.constant for form in left]),
            np.array([form.slopes for form in right]),
            np.array([form.constant for form in right]),
            (owner == np.arange(len(equations))[:, None]).astype(float),
            np.array([equation.constant for equation in equations]),
        )

    def along(self, place: Array, directions: Array) -> Quadrics:
        """The system in z (n,) where v = place (N,) + directions (N, n) z."""
        return Quadrics(
            self.left @ directions,
            self.left_at + self.left @ place,
            self.right @ directions,
            self.right_at + self.right @ place,
            self.sums,
            self.constant,
        )

    def values(self, v: Array) -> Array:
        """F at v (N,), (M,)."""
        left, right = self.left @ v + self.left_at, self.right @ v + self.right_at
        return np.asarray(self.constant + self.sums @ (left * right))

    def slopes(self, v: Array) -> Array:
        """dF at v (N,), (M, N)."""
        return np.asarray(self._level + self.bends @ v)

    @cached_property
    def bends(self) -> Array:
        """d²F, (M, N, N)."""
        half = np.einsum("mk,ki,kj->mij", self.sums, self.left, self.right)
        return np.asarray(half + half.swapaxes(1, 2))

    @cached_property
    def _level(self) -> Array:
        level: Array = self.sums @ (
            self.left * self.right_at[:, None] + self.right * self.left_at[:, None]
        )
        return level

    @cached_property
    def size(self) -> float:
        """The largest of the numbers that the forms are made of, at least 1: scale of rounding."""
        return max(1.0, *(float(np.abs(a).max()) for a in (self.left_at, self.right_at)))
