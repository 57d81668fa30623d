"""All solutions of a polynomial system by tracking many paths at a time.

A path u(t), 0 ≤ t ≤ 1, leads from a known solution of one system to a solution of another, both
of one family (a parameter homotopy: Sommese & Wampler, The Numerical Solution of Systems of
Polynomials Arising in Engineering and Science, 2005, ch. 7). Arrays are (K unknowns, N paths), so
that every operation runs along the paths; each path has a step of its own.

What a system has to offer is one call, `Homotopy.step`: Newton's step and the tangent at given
points of the paths. Ends that Newton's method does not reach, because solutions coincide there or
run off to infinity, are told apart by how the path grows towards t = 1 (`Ending`).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]
Index = NDArray[np.intp]
Real = NDArray[np.float64]


class Ending(IntEnum):
    """How a path ended."""

    REGULAR = 0  # at a regular solution
    SINGULAR = 1  # at a finite one where several coincide, or that lies on a curve of them
    INFINITE = 2  # it runs off to infinity
    LOST = 3  # it could not be followed


class Homotopy(Protocol):
    """A square system that depends on t, at N points each with its own t."""

    def step(self, u: Complex, t: Complex | Real) -> tuple[Complex, Complex]:
        """Newton's step at fixed t and du/dt, (K, N) each, at u (K, N) and t (N,)."""
        ...

    def take(self, columns: Index) -> Self:
        """The homotopy of some of the paths."""
        ...


@dataclass(frozen=True, slots=True)
class Control:
    """How carefully paths are followed.

    Attributes:
        first: the first step in t.
        error: largest first correction of a step, relative to max(1, |u|).
        contraction: largest ratio of the second correction to the first.
        shortest: a step below this is given up, as a part of 1 − t.
        most: steps after which a path is given up.
        ends: how close Newton's method has to settle at t = 1.
    """

    first: float = 0.05
    error: float = 2e-2
    contraction: float = 0.1
    shortest: float = 1e-6
    most: int = 400
    ends: float = 1e-11


CAREFUL = Control(first=0.01, error=2e-3, contraction=0.03, shortest=1e-9, most=4000)
"""For paths that have to be followed again."""


@dataclass(frozen=True, eq=False, slots=True)
class Tracked:
    """Where paths led: values (K, N), `Ending` (N,), the last correction (N,), steps (N,)."""

    values: Complex
    endings: NDArray[np.int8]
    error: Real
    steps: NDArray[np.int32]

    def count(self, ending: Ending) -> int:
        """How many paths ended so."""
        return int(np.count_nonzero(self.endings == ending))


def solve_columns(matrix: Complex, right: Complex) -> Complex:
    """Solutions x (K, M, N) of A x = b for A (K, K, N) and b (K, M, N), column by column of N.

    Elimination without a search for pivots: far quicker along the columns than a solver call
    each. A bad pivot spoils a single Newton step, which is seen in the next.
    """
    size = matrix.shape[0]
    a = [[matrix[i, j] for j in range(size)] for i in range(size)]
    x = [right[i] for i in range(size)]
    inverses = []
    rows: list[Complex] = [np.concatenate([matrix[i], right[i]]) for i in range(size)]
    del a, x
    for k in range(size):
        inverse = 1.0 / rows[k][k]
        inverses.append(inverse)
        for i in range(k + 1, size):
            rows[i][k + 1 :] -= (rows[i][k] * inverse) * rows[k][k + 1 :]
    answer = np.empty(right.shape, dtype=complex)
    for k in range(size - 1, -1, -1):
        x_k = rows[k][size:]
        for j in range(k + 1, size):
            x_k -= rows[k][j] * answer[j]
        np.multiply(x_k, inverses[k], out=answer[k])
    return answer


def size_of(du: Complex, u: Complex) -> Real:
    """The size of steps relative to max(1, |u|), unknown by unknown: the largest, (N,)."""
    scale = np.maximum(_modulus(u), 1.0)
    ratio: Real = (_modulus(du) / scale).max(axis=0)
    return ratio


def _modulus(u: Complex) -> Real:
    return np.sqrt(u.real * u.real + u.imag * u.imag)


def refine(homotopy: Homotopy, u: Complex, t: Complex | Real, rounds: int) -> tuple[Complex, Real]:
    """Newton's method at fixed t; the points and the size of their last correction."""
    error = np.full(u.shape[1], np.inf)
    for _ in range(rounds):
        du, _ = homotopy.step(u, t)
        u = u + du
        error = size_of(du, u)
    return u, error


def track(homotopy: Homotopy, starts: Complex, control: Control = Control()) -> Tracked:
    """Follow all paths from solutions at t = 0, (K, N), to t = 1."""
    with np.errstate(all="ignore"):  # a path at infinity is found out, not warned about
        return _Tracker(homotopy, starts, control).run()


class _Tracker:
    def __init__(self, homotopy: Homotopy, starts: Complex, control: Control) -> None:
        count = starts.shape[1]
        self.control = control
        self.homotopy = homotopy
        self.values = starts.astype(complex)
        self.endings = np.full(count, Ending.LOST, dtype=np.int8)
        self.error = np.full(count, np.inf)
        self.steps = np.zeros(count, dtype=np.int32)

    def run(self) -> Tracked:
        control = self.control
        index = np.arange(self.values.shape[1])
        active = self.homotopy
        u = self.values.copy()
        t = np.zeros(len(index))
        newton, tangent = active.step(u, t)
        u = u + newton
        before, h0 = tangent, np.ones(len(index))  # a first step along the tangent
        start = u
        h = np.full(len(index), control.first)
        fresh = np.ones(len(index), dtype=bool)
        taken = np.zeros(len(index), dtype=np.int32)
        for _ in range(control.most):
            if not len(index):
                break
            h = np.minimum(h, 1.0 - t)
            guess = _predict(u, tangent, start, before, h0, h, fresh)
            there = t + h
            last = there >= 1.0 - 1e-14
            there = np.where(last, 1.0, there)
            du, _ = active.step(guess, there)
            first = size_of(du, guess)
            point = guess + du
            du, slope = active.step(point, there)
            second = size_of(du, point)
            point = point + du
            good = (first <= control.error) & (
                second <= np.maximum(control.contraction * first, 1e-13)
            )
            good &= np.isfinite(first + second)
            taken += 1
            # accepted
            start = np.where(good, u, start)
            before = np.where(good, tangent, before)
            h0 = np.where(good, h, h0)
            u = np.where(good, point, u)
            tangent = np.where(good, slope, tangent)
            t = np.where(good, there, t)
            order = np.where(fresh, 0.5, 0.25)
            fresh = fresh & ~good
            wanted = (0.25 * control.error / np.maximum(first, 1e-12)) ** order
            wanted = np.minimum(wanted, (0.25 * control.contraction * first/ np.maximum(second, 1e-16)) ** 0.5 )
            h = h * np.where(
                good, np.clip(wanted, 0.4, 3.0), np.clip(np.nan_to_num(wanted, nan=0.2), 0.1, 0.5)
            )
            arrived = good & last
            stuck = ~arrived & (h < control.shortest * np.maximum(1.0 - t, 1e-9))
            out = arrived | stuck
            if out.any():
                who = index[out]
                self.values[:, who] = u[:, out]
                self.steps[who] = taken[out]
                self.error[who] = second[out]
                self.endings[index[arrived]] = Ending.REGULAR
                keep = np.flatnonzero(~out)
                index, u, t, tangent, start, before, h0, h, fresh, taken = (
                    index[keep], u[:, keep], t[keep], tangent[:, keep], start[:, keep],
                    before[:, keep], h0[keep], h[keep], fresh[keep], taken[keep],
                )
                active = active.take(keep)
        return Tracked(self.values, self.endings, self.error, self.steps)


def _predict(
    u: Complex, tangent: Complex, start: Complex, before: Complex, h0: Real, h: Real, fresh: NDArray[np.bool_]
) -> Complex:
    """The cubic through the last two points and tangents (a line where there is only one)."""
    s = h / h0
    chord = (u - start) / h0
    # u + h·[ tangent + s·(…) ] of the Hermite cubic, extrapolated
    c2 = 2.0 * tangent + before - 3.0 * chord
    c3 = tangent + before - 2.0 * chord
    s = np.where(fresh, 0.0, s)
    return u + h * (tangent + s * (c2 + s * c3))
