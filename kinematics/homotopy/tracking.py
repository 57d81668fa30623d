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
from typing import NamedTuple, Protocol, Self

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

    def extent(self, u: Complex) -> Real:
        """How far out the points are, (N,) > 0: grows without bound only towards infinity."""
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
        shortest: a step below this part of 1 − t is given up.
        most: steps after which a path is given up.
        edge: 1 − t at which a path that has not arrived is judged by its growth.
    """

    first: float = 0.05
    error: float = 5e-2
    contraction: float = 0.1
    shortest: float = 1e-7
    most: int = 400
    edge: float = 1e-10


CAREFUL = Control(first=0.005, error=2e-3, contraction=0.02, shortest=1e-10, most=800)
"""For paths that have to be followed again."""

_ROUNDING = 1e-10  # a correction below this may be rounding
_FAR_ROUNDING, _DIGITS = 1e-6, 1e4  # the same so far out; digits are lost with the square of that
_AIM = 0.25  # of what is allowed, for the next step
_SPAN = 10.0  # ratio of 1 − t between the marks by which a path's growth is judged
_NEAR_END = 1e-4  # 1 − t below which a path that is stuck may be judged
_FAR, _NEAR_END_FAR = 1e3, 1e-2  # out there, where paths are ill-conditioned, it is judged earlier
_CREEPS, _POLE = 1e-2, 0.96  # step relative to 1 − t; exponent of growth, of a simple pole one
_GROWS = 0.04  # growth exponent beyond which a path runs off; at least 1/winding number if so


@dataclass(frozen=True, eq=False, slots=True)
class Tracked:
    """Where paths led.

    Attributes:
        values: (K, N) at t = 1, or where a path was left.
        endings: (N,) `Ending`.
        reached: (N,) t there.
    """

    values: Complex
    endings: NDArray[np.int8]
    reached: Real

    def ended(self, ending: Ending) -> Index:
        """Which paths ended so."""
        return np.flatnonzero(self.endings == ending)


def solve_columns(matrix: Complex, right: Complex) -> Complex:
    """Solutions x (K, M, N) of A x = b for A (K, K, N) and b (K, M, N), for each of N.

    Elimination without a search for pivots: far quicker along the columns than one solver call
    each. A bad pivot spoils a single Newton step, which is seen in the next.
    """
    size = matrix.shape[0]
    rows: list[Complex] = [np.concatenate([matrix[i], right[i]]) for i in range(size)]
    inverses = _eliminate(rows)
    answer = np.empty(right.shape, dtype=complex)
    for k in range(size - 1, -1, -1):
        rest = rows[k][size:]
        for j in range(k + 1, size):
            rest -= rows[k][j] * answer[j]
        np.multiply(rest, inverses[k], out=answer[k])
    return answer


def determinant_columns(matrix: Complex) -> Complex:
    """det A (N,) for A (K, K, N), in the same way; NaN where a pivot vanishes."""
    rows = [row.copy() for row in matrix]
    inverses = _eliminate(rows)
    return np.asarray(1.0 / np.prod(inverses, axis=0))


def _eliminate(rows: list[Complex]) -> list[Complex]:
    """Clear what is below the diagonal; the inverses of the pivots."""
    inverses = []
    for k, row in enumerate(rows):
        inverse = 1.0 / row[k]
        inverses.append(inverse)
        for below in rows[k + 1 :]:
            below[k + 1 :] -= (below[k] * inverse) * row[k + 1 :]
    return inverses


def relative_size(du: Complex, u: Complex) -> Real:
    """The size of steps relative to max(1, |u|), the largest over the unknowns: (N,)."""
    return np.asarray((_modulus(du) / np.maximum(_modulus(u), 1.0)).max(axis=0))


def _modulus(u: Complex) -> Real:
    return np.sqrt(u.real * u.real + u.imag * u.imag)


def track(homotopy: Homotopy, starts: Complex, control: Control | None = None) -> Tracked:
    """Follow all paths from solutions at t = 0, (K, N), to t = 1."""
    with np.errstate(all="ignore"):  # a path that runs off is found out, not warned about
        return _Tracker(homotopy, starts, control or Control()).run()


class _Mark(NamedTuple):
    """How far out the paths were when 1 − t was ``rest``."""

    extent: Real
    rest: Real

    def take(self, keep: Index) -> _Mark:
        return _Mark(self.extent[keep], self.rest[keep])


@dataclass(eq=False, slots=True)
class _Paths:
    """The paths under way; ``back`` is the place before."""

    index: Index
    homotopy: Homotopy
    u: Complex
    tangent: Complex
    t: Real
    h: Real
    back: Complex
    back_tangent: Complex
    back_h: Real
    fresh: NDArray[np.bool_]
    marks: tuple[_Mark, _Mark]  # the older one first

    def take(self, keep: Index) -> _Paths:
        return _Paths(
            self.index[keep],
            self.homotopy.take(keep),
            self.u[:, keep],
            self.tangent[:, keep],
            self.t[keep],
            self.h[keep],
            self.back[:, keep],
            self.back_tangent[:, keep],
            self.back_h[keep],
            self.fresh[keep],
            (self.marks[0].take(keep), self.marks[1].take(keep)),
        )


class _Tracker:
    def __init__(self, homotopy: Homotopy, starts: Complex, control: Control) -> None:
        count = starts.shape[1]
        self.control = control
        self.values = starts.astype(complex)
        self.endings = np.full(count, Ending.LOST, dtype=np.int8)
        self.reached = np.zeros(count)
        zero = np.zeros(count)
        newton, tangent = homotopy.step(self.values, zero)
        u = self.values + newton
        far = homotopy.extent(u)
        self.paths = _Paths(
            index=np.arange(count),
            homotopy=homotopy,
            u=u,
            tangent=tangent,
            t=zero,
            h=np.full(count, control.first),
            back=u,
            back_tangent=tangent,
            back_h=np.ones(count),
            fresh=np.ones(count, dtype=bool),
            marks=(_Mark(far, zero + 1.0), _Mark(far.copy(), zero + 1.0)),
        )

    def run(self) -> Tracked:
        for _ in range(self.control.most):
            if not len(self.paths.index):
                break
            self._advance()
        if len(self.paths.index):
            every = np.ones(len(self.paths.index), dtype=bool)
            self._leave(~every, every)
        return Tracked(self.values, self.endings, self.reached)

    def _advance(self) -> None:
        """One step of every path."""
        control, p = self.control, self.paths
        h = np.minimum(p.h, 1.0 - p.t)
        last = p.t + h >= 1.0 - 1e-15
        there = np.where(last, 1.0, p.t + h)
        guess = _predict(p, h)
        step, _ = p.homotopy.step(guess, there)
        point = guess + step
        first = relative_size(step, point)
        step, slope = p.homotopy.step(point, there)
        point += step
        second = relative_size(step, point)
        extent = p.homotopy.extent(point)
        rounding = _rounding(extent)
        good = (first <= control.error) & (
            second <= np.maximum(control.contraction * first, rounding)
        )
        # Far out the first correction only leads to where Newton's method converges.
        again = np.flatnonzero(
            ~good & (extent > _FAR) & (np.maximum(first, second) <= control.error)
        )
        if again.size:
            step, bent = p.homotopy.take(again).step(point[:, again], there[again])
            point[:, again] += step
            slope[:, again] = bent
            first[again], second[again] = second[again], relative_size(step, point[:, again])
            good[again] = second[again] <= np.maximum(
                control.contraction * first[again], rounding[again]
            )
        arrived = good & last
        # Both corrections say how long the next step may be: the first grows as the predictor's
        # error, the second as the square of the first.
        room = (_AIM * control.error / np.maximum(first, rounding)) ** np.where(p.fresh, 0.5, 0.25)
        sharp = _AIM * control.contraction * first / second
        room = np.where(second > rounding, np.minimum(room, np.sqrt(np.sqrt(sharp))), room)
        room = np.where(np.isnan(room), 0.1, room)
        p.h = h * np.where(good, np.clip(room, 0.4, 3.0), np.clip(room, 0.1, 0.5))
        if good.all():
            p.back, p.back_tangent, p.back_h = p.u, p.tangent, h
            p.u, p.tangent, p.t = point, slope, there
            p.fresh = np.zeros_like(good)
        else:
            g = np.flatnonzero(good)
            p.back, p.back_tangent = p.back.copy(), p.back_tangent.copy()
            p.u, p.tangent = p.u.copy(), p.tangent.copy()
            p.back[:, g], p.back_tangent[:, g] = p.u[:, g], p.tangent[:, g]
            p.u[:, g], p.tangent[:, g] = point[:, g], slope[:, g]
            p.back_h = np.where(good, h, p.back_h)
            p.t = np.where(good, there, p.t)
            p.fresh = p.fresh & ~good
        rest = 1.0 - p.t
        self._mark(rest)
        stuck = ~arrived & ((p.h < control.shortest * rest) | (rest < control.edge))
        stuck |= ~arrived & self._runs_off(extent, rest)
        if arrived.any() or stuck.any():
            self._leave(arrived, stuck)

    def _mark(self, rest: Real) -> None:
        """Note how far out the paths are, at every tenth of 1 − t."""
        p = self.paths
        older, newer = p.marks
        due = np.flatnonzero(rest * _SPAN < newer.rest)
        if due.size:
            older.extent[due], older.rest[due] = newer.extent[due], newer.rest[due]
            newer.extent[due], newer.rest[due] = p.homotopy.extent(p.u)[due], rest[due]

    def _leave(self, arrived: NDArray[np.bool_], stuck: NDArray[np.bool_]) -> None:
        p = self.paths
        out = arrived | stuck
        who = p.index[out]
        self.values[:, who] = p.u[:, out]
        self.reached[who] = p.t[out]
        self.endings[p.index[arrived]] = Ending.REGULAR
        self.endings[p.index[stuck]] = self._judge()[stuck]
        self.paths = p.take(np.flatnonzero(~out))

    def _judge(self) -> NDArray[np.int8]:
        """What the growth of the paths towards t = 1 says of their ends."""
        p = self.paths
        rest = np.maximum(1.0 - p.t, 1e-16)
        extent = p.homotopy.extent(p.u)
        growth, lately = self._growth(extent, rest)
        steady = (lately > 0.5 * growth) & (lately < 2.0 * growth)
        far = (extent > _FAR) & (rest < _NEAR_END_FAR) & steady
        near = (rest < _NEAR_END) | far
        runs_off = near & ((growth > _GROWS) | ~np.isfinite(growth))
        kinds = np.where(runs_off, Ending.INFINITE, np.where(near, Ending.SINGULAR, Ending.LOST))
        return kinds.astype(np.int8)

    def _runs_off(self, extent: Real, rest: Real) -> NDArray[np.bool_]:
        """Which paths creep along far out, and still grow as towards infinity.

        Towards a finite place growth slackens: in the last tenth of 1 − t, its exponent falls below
        `_POLE` where that place is nearer than some ten times as far out.
        """
        creeps = (extent > _DIGITS) & (rest < _NEAR_END_FAR) & (self.paths.h < _CREEPS * rest)
        if creeps.any():
            growth, lately = self._growth(extent, rest)
            creeps &= (lately > _POLE * np.minimum(growth, 1.0)) & (growth > _GROWS)
        return creeps

    def _growth(self, extent: Real, rest: Real) -> tuple[Real, Real]:
        """The exponents with which the extent grows as 1 − t shrinks: on the whole, and lately."""
        older, newer = self.paths.marks
        growth: Real = np.log(extent / older.extent) / np.log(older.rest / rest)
        lately: Real = np.log(extent / newer.extent) / np.log(newer.rest / rest)
        return growth, lately


def _rounding(extent: Real) -> Real:
    """A correction below this may be rounding: digits are lost with the square of the size."""
    return np.asarray(np.clip(_FAR_ROUNDING * (extent / _DIGITS) ** 2, _ROUNDING, _FAR_ROUNDING))


def _predict(p: _Paths, h: Real) -> Complex:
    """The cubic through the last two points and tangents; a line where there is only one."""
    chord = (p.u - p.back) / p.back_h
    s = np.where(p.fresh, 0.0, h / p.back_h)
    square = 2.0 * p.tangent + p.back_tangent - 3.0 * chord
    cube = p.tangent + p.back_tangent - 2.0 * chord
    return np.asarray(p.u + h * (p.tangent + s * (square + s * cube)))
