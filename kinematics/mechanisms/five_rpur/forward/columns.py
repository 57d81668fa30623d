"""Small solvers along the columns of arrays: Newton's method, Cramer's rule, double roots."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.forward.polynomial import Complex, modulus

Index = NDArray[np.intp]

FLAT = 1e-5
"""A sine below this is as good as 0: a division by it would lose too much."""
CLOSE = 1e-4
"""Roots that differ by less may be a double root that rounding has parted."""
_SETTLED = 1e-9  # size of a step after which Newton's method has only rounding left
_ROUNDS = 12  # of Newton's method; three do for a simple root

Step = Callable[[Complex, Index], tuple[Complex, Array]]


def newton(state: Complex, step: Step) -> Array:
    """Newton's method on the columns of ``state``, in place; the size of the last step of each.

    ``step`` gives the change of some columns and how large it is.
    """
    size = np.full(state.shape[1], np.inf)
    moving = np.arange(state.shape[1])
    for _ in range(_ROUNDS):
        change, now = step(state[:, moving], moving)
        regular = np.isfinite(now)
        if not regular.all():  # at a singular point itself: there it stays
            moving, change, now = moving[regular], change[:, regular], now[regular]
        state[:, moving] += change
        size[moving] = now
        moving = moving[now > _SETTLED]
        if not len(moving):
            break
    return size


def cramer(columns: tuple[Complex, Complex, Complex], right: Complex) -> list[Complex]:
    """x with column_1 x_1 + column_2 x_2 + column_3 x_3 = −right, each (3, N)."""
    one, two, three = columns
    minors = _cross(two, three)
    scale = -1.0 / _dot(one, minors)
    return [_dot(right, v) * scale for v in (minors, _cross(three, one), _cross(one, two))]


_Three = Complex | tuple[Complex, Complex, Complex]


def _dot(u: _Three, v: _Three) -> Complex:
    return np.asarray(u[0] * v[0] + u[1] * v[1] + u[2] * v[2])


def _cross(u: Complex, v: Complex) -> tuple[Complex, Complex, Complex]:
    return (
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    )


def told_apart(both: Complex, guess: Complex, root: Complex, problem: Index) -> Complex:
    """The one of ``both`` (2, n) that a guess is nearer to, but each in turn for a double root."""
    order = np.argsort(problem, kind="stable")
    both, guess, root, problem = both[:, order], guess[order], root[order], problem[order]
    first, rank = np.arange(len(root)), np.zeros(len(root), dtype=np.intp)
    for shift in range(1, len(root)):
        same = problem[shift:] == problem[:-shift]
        if not same.any():
            break
        close = modulus(root[shift:] - root[:-shift]) < CLOSE * (1.0 + modulus(root[shift:]))
        close &= same
        rank[shift:] += close
        first[shift:] = np.where(close, np.arange(len(close)), first[shift:])
    to = guess
    for _ in range(2):  # in the second round, nearer to what the first of a double root is
        second = (modulus(both[1] - to) < modulus(both[0] - to)) ^ (rank % 2 == 1)
        chosen = np.where(second, both[1], both[0])
        to = np.where(rank > 0, chosen[first], guess)
    answer = np.empty_like(guess)
    answer[order] = chosen
    return answer


def square_root(square: Complex | Array) -> Complex:
    """The principal square root, complex."""
    return np.asarray(np.sqrt(square.astype(complex)))


def both_roots(square: Complex | Array) -> Complex:
    """Both square roots, (2, N)."""
    root = square_root(square)
    return np.stack([root, -root])
