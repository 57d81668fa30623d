"""The proof that a start set is whole: a trace test of the curve that one actuator moves along.

With one length let go, the solutions of a machine are a curve in the unknowns and that length's
square μ. A hyperplane h·(u, μ) = τ cuts it in as many points as its degree, and their sum is linear
in τ exactly if none is missing (Sommese, Verschelde and Wampler, SIAM J. Numer. Anal. 40 (2002)
2026). From all of these points the paths to the hyperplane μ = const end at all solutions of the
machine; the others run off to infinity.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from kinematics.homotopy.forms import PATCH, solved
from kinematics.homotopy.monodromy import Report, random_complex
from kinematics.homotopy.study import Limbs, StudyEquations
from kinematics.homotopy.tracking import Complex, Ending, Index, Real, relative_size, track

_LOOPS, _PATIENCE = 60, 6
_LINEAR = 1e-9  # second difference of the sum by the first one
_SAME = 1e-7
_SHARP = 1e-11
_FAR = 1e6  # |(u, μ)| beyond which a point is none


class Cut(NamedTuple):
    """A machine without its first length, and a hyperplane (10,): h of (u, μ), and τ."""

    limbs: Limbs
    plane: Complex


@dataclass(frozen=True, eq=False)
class Traced:
    """What the test found.

    Attributes:
        degree: points of a hyperplane.
        bend: the second difference of their sum, by the first one; rounding if none is missing.
        finite: solutions that the machine has.
    """

    degree: int
    bend: float
    finite: int

    @property
    def whole(self) -> bool:
        """None is missing."""
        return self.bend < _LINEAR


class _Way:
    """The equations while machine and hyperplane move straight from one to another."""

    def __init__(self, closure: StudyEquations, start: Cut, end: Cut) -> None:
        middle = Limbs(*(0.5 * (a + b) for a, b in zip(start.limbs, end.limbs, strict=True)))
        c0, c1, c2 = (closure.coefficients(g) for g in (start.limbs, middle, end.limbs))
        self._closure = closure
        self._c = (c0, 4.0 * c1 - 3.0 * c0 - c2, 2.0 * (c0 + c2) - 4.0 * c1)
        self._plane = (start.plane, end.plane - start.plane)

    def take(self, columns: Index) -> _Way:
        return self

    def extent(self, u: Complex) -> Real:
        return np.asarray(1.0 + (np.abs(u) ** 2).sum(axis=0))

    def step(self, u: Complex, t: Complex | Real) -> tuple[Complex, Complex]:
        at = np.asarray(t)[:, None, None]
        c0, c1, c2 = self._c
        c, dc = c0 + at * (c1 + at * c2), c1 + 2.0 * at * c2
        plane = self._plane[0] + at[:, 0] * self._plane[1]
        values, by_u, monomials = _system(self._closure, c, plane, u)
        right = np.zeros((*values.shape, 2), dtype=complex)
        right[..., 0] = -values
        right[:, : c.shape[-2], 1] = -(dc @ monomials[..., None])[..., 0]
        h = self._plane[1]
        right[:, -1, 1] = -(u.T @ h[:9] - h[9])
        found = solved(by_u, right)
        return np.ascontiguousarray(found[..., 0].T), np.ascontiguousarray(found[..., 1].T)


def _system(
    closure: StudyEquations, c: Complex, plane: Complex, u: Complex
) -> tuple[Complex, Complex, Complex]:
    """Nine equations in u and μ, their derivatives, and the forms; the first length is 0 in C."""
    values8, by8, monomials = closure.system(c, u[:8])
    halves = closure.halves(u[:8])
    count, mu = len(values8), u[8]
    values = np.empty((count, 9), dtype=complex)
    by_u = np.zeros((count, 9, 9), dtype=complex)
    values[:, :8], by_u[:, :8, :8] = values8, by8
    values[:, 0] -= mu * monomials[:, 0]
    by_u[:, 0, :8] -= 2.0 * mu[:, None] * halves[:, 0]
    by_u[:, 0, 8] = -monomials[:, 0]
    h = np.broadcast_to(plane, (count, 10))
    values[:, 8] = (u.T * h[:, :9]).sum(axis=1) - h[:, 9]
    by_u[:, 8] = h[:, :9]
    return values, by_u, monomials


def traced(
    closure: StudyEquations,
    machine: Limbs,
    root: Complex,
    rng: np.random.Generator,
    report: Report = lambda _: None,
) -> Traced:
    """The test of a machine of which one solution (8, 1) is known."""
    square = complex(np.asarray(machine.squares)[0])
    limbs = _let_go(machine)
    point = np.concatenate([root / (PATCH @ root[:4]), [[square]]])
    h = random_complex(rng, 9)
    here = Cut(limbs, np.append(h, h @ point[:, 0]))
    points, idle = point, 0
    for n in range(_LOOPS):
        stops = [here, _another(closure, limbs, rng), _another(closure, limbs, rng), here]
        moved = points
        for one, two in pairwise(stops):
            ends = track(_Way(closure, one, two), moved)
            moved = ends.values[:, ends.ended(Ending.REGULAR)]
        before = points.shape[1]
        points = _distinct(closure, here, np.concatenate([points, moved], axis=1))
        idle = idle + 1 if points.shape[1] == before else 0
        report(f"trace, loop {n + 1}: {points.shape[1]} points")
        if idle >= _PATIENCE:
            break
    sums = [points.sum(axis=1)]
    for share in (0.5, 1.0):
        plane = here.plane.copy()
        plane[9] += share * np.exp(0.7j)
        ends = track(_Way(closure, here, Cut(limbs, plane)), points)
        if len(ends.ended(Ending.REGULAR)) < points.shape[1]:
            return Traced(points.shape[1], np.inf, 0)
        there = _sharp(closure, Cut(limbs, plane), ends.values)[0]
        sums.append(there.sum(axis=1))
    first, second = sums[2] - sums[0], sums[2] - 2.0 * sums[1] + sums[0]
    bend = float(np.abs(second).max() / np.abs(first).max())
    flat = np.zeros(10, dtype=complex)
    flat[8], flat[9] = 1.0, square
    goal = Cut(limbs, flat)
    ends = track(_Way(closure, here, goal), points)
    finite = _distinct(closure, goal, ends.values[:, ends.ended(Ending.REGULAR)])
    return Traced(points.shape[1], bend, finite.shape[1])


def _let_go(machine: Limbs) -> Limbs:
    squares = np.array(machine.squares, dtype=complex)
    squares[0] = 0.0
    return machine._replace(squares=squares)


def _another(closure: StudyEquations, like: Limbs, rng: np.random.Generator) -> Cut:
    made = Limbs(*(random_complex(rng, *np.shape(part)) for part in like))
    return Cut(_let_go(made), random_complex(rng, 10))


def _sharp(closure: StudyEquations, cut: Cut, points: Complex) -> tuple[Complex, Real]:
    c = closure.coefficients(cut.limbs)
    error = np.full(points.shape[1], np.inf)
    with np.errstate(all="ignore"):
        for _ in range(4):
            values, by_u, _ = _system(closure, c, cut.plane, points)
            step = solved(by_u, -values[..., None])[..., 0].T
            points = points + step
            error = relative_size(step, points)
    return points, error


def _distinct(closure: StudyEquations, cut: Cut, points: Complex) -> Complex:
    """The sharp ones, each once; of (u, μ) with x·x = 0 there is no pose."""
    points, error = _sharp(closure, cut, points)
    norm = np.abs((points[:4] ** 2).sum(axis=0))
    size = np.abs(points).max(axis=0)
    points = points[:, (error < _SHARP) & (size < _FAR) & (norm > 1e-8)]
    kept: list[int] = []
    for n in range(points.shape[1]):
        away = [relative_size(points[:, [n]] - points[:, [k]], points[:, [n]])[0] for k in kept]
        if not away or min(away) > _SAME:
            kept.append(n)
    return points[:, kept]
