"""The curve of n quadratic equations in n + 1 unknowns, and what is proven of pieces of it.

The last unknown is λ, how far along a line in joint space the actuators are; the others say where
the machine is. Between two points of the curve lies a chord; with the inverse A of the Jacobian J
at its middle Krawczyk's test is made for all its points c at once: where

    |A F(c)| + |I − A J(x)| r < r    for every x with |x − c| ≤ r componentwise,

each plane across the chord holds exactly one solution within r of it, so one piece of curve runs
along the chord, and both points are its ends (Moore, Kearfott, Cloud: Introduction to Interval
Analysis, 2009, section 8.2; for pieces of curve Martin, Goldsztejn, Granvilliers, Jermann, SIAM
J. Numer. Anal. 51 (2013) 3373). As F is quadratic, its second derivatives at hand are all that
this takes. The bounds hold but for the rounding of the numbers they are made of. Bounds on the
tangent and on its change then tell whether λ rises or falls all along the piece (no parallel
singularity: det J without λ is not 0) or turns back exactly once (a fold).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from kinematics.arrays import Array
from kinematics.homotopy.quadrics import Quadrics

LAMBDA = -1
"""Where λ stands among the unknowns."""

_CONTRACTS = 0.25  # largest ratio of the second Newton step to the first
_SINGULAR = 1e-12  # a singular value or a slope that is only rounding
_SPAN = 2.0  # of how much the equations turn on half of the chord, what the radius allows for
_SPREAD = 0.1  # of the largest radius, what is added to all of them
_FLAT = 1e-3  # a gradient that is shorter counts as this long


class Place(NamedTuple):
    """A point of the curve (n + 1,) and its tangent of length one."""

    point: Array
    tangent: Array

    @property
    def along(self) -> float:
        """λ."""
        return float(self.point[LAMBDA])

    @property
    def slope(self) -> float:
        """dλ along the tangent: it changes its sign where the curve turns back."""
        return float(self.tangent[LAMBDA])


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """A chord and the only piece of curve along it.

    Attributes:
        here, there: its ends.
        radius: (n + 1,); within it of the chord lies the piece and nothing else of the curve.
        effort: the contraction of Newton's method that was proven, below 1; as the length is.
        turns: how often λ turns back on the piece; None where that is not proven.
        exact: the wanted λ is met exactly at its end.
    """

    here: Place
    there: Place
    radius: Array
    effort: float
    turns: int | None
    exact: bool = False

    @property
    def chord(self) -> Array:
        """(n + 1,) from one end to the other."""
        return np.asarray(self.there.point - self.here.point)

    @property
    def length(self) -> float:
        """Of the chord."""
        return float(np.linalg.norm(self.chord))

    @property
    def border(self) -> Array:
        """(n + 1,) of length one; every plane across it, from end to end, holds one point."""
        return np.asarray(self.chord / self.length)

    @property
    def turned(self) -> bool:
        """λ turns back on the piece: there is a fold on it."""
        return self.here.slope * self.there.slope <= 0.0

    def part(self, point: Array) -> float:
        """How far along the chord a point is, 0 to 1 on the piece."""
        chord = self.chord
        return float((point - self.here.point) @ chord) / float(chord @ chord)

    def holds(self, point: Array) -> bool:
        """Whether a point of the curve is one of the piece."""
        part = self.part(point)
        near = np.abs(point - self.here.point - part * self.chord) <= self.radius
        return bool(-1e-9 <= part <= 1.0 + 1e-9 and near.all())


class Middle(NamedTuple):
    """The equations at the middle of a chord, times the inverse A of their Jacobian."""

    inverse: Array  # (n + 1, n + 1) A, the plane across the chord as the last equation
    weight: Array  # (n + 1, n) |A| but for the last column
    bend: Array  # (n + 1, n + 1, n + 1) A d²F
    size: Array  # the same, |A d²F|
    error: Array  # (n,) what F may be at the ends of the chord


class _Bounds(NamedTuple):
    """|A J − I| ≤ spread all along a piece, and spread · radius ≤ effort · radius."""

    spread: Array
    radius: Array
    effort: float

    def resolved(self, vector: Array) -> Array:
        """A bound of (I − spread)⁻¹ vector for a vector ≥ 0, by three terms of its series."""
        once = self.spread @ vector
        twice = self.spread @ once
        tail = float((twice / self.radius).max()) * self.effort / (1.0 - self.effort)
        return np.asarray(vector + once + twice + tail * self.radius)


# --- the curve -----------------------------------------------------------------------------


class Curve:
    """The solutions of n equations in n + 1 unknowns, near a point of theirs.

    Args:
        equations: the system.
        point: (n + 1,) about where it is followed.
    """

    def __init__(self, equations: Quadrics, point: Array) -> None:
        self.equations = equations
        size = max(equations.size, float(np.abs(point).max()))
        self.tolerance = 256 * float(np.finfo(float).eps) * size
        self.level: Array = np.eye(len(point))[LAMBDA]

    def linear(self, point: Array) -> tuple[Array, Array, bool]:
        """F (n,), dF (n, n + 1) and whether the equations hold to within rounding."""
        values, slopes = self.equations.values(point), self.equations.slopes(point)
        holds = (np.abs(values) <= self.tolerance * _lengths(slopes)).all()
        return values, slopes, bool(holds)

    def correct(
        self, guess: Array, border: Array, *, rounds: int = 6, strict: bool = False
    ) -> tuple[Array, Array] | None:
        """Newton's method on F and border · (point − guess) = 0: the point and dF there.

        None if it fails; where ``strict``, also if the second step is not much shorter than the
        first.
        """
        point, before = guess, np.inf
        for turn in range(rounds):
            values, slopes, holds = self.linear(point)
            if holds:
                return point, slopes
            step = _solve(slopes, border, np.append(-values, 0.0))
            size = np.inf if step is None else sqrt(float(step @ step))
            if step is None or (strict and turn == 1 and size > _CONTRACTS * before):
                return None
            point, before = point + step, size
        return None

    def polished(self, point: Array) -> Array:
        """A few more Newton steps at fixed λ, down to rounding."""
        best, error = point, np.inf
        for _ in range(4):
            values, slopes, _ = self.linear(point)
            size = float((np.abs(values) / _lengths(slopes)).max())
            step = _solve(slopes, self.level, np.append(-values, 0.0))
            if size >= error:
                break
            best, error = point, size
            if step is None:
                break
            point = point + step
        return best

    def place(self, point: Array, slopes: Array, along: Array) -> Place | None:
        """The place of a point; its tangent continues ``along``."""
        tangent = _solve(slopes, along, self.level)
        return None if tangent is None else Place(point, tangent / sqrt(float(tangent @ tangent)))

    def first(self, point: Array) -> Place | None:
        """The place of a point, towards larger λ; None in a parallel singularity."""
        _, slopes, _ = self.linear(point)
        rows = np.sqrt((slopes * slopes).sum(axis=1))
        if not (np.isfinite(rows) & (rows > 0.0)).all():
            return None
        _, sizes, directions = np.linalg.svd(slopes / rows[:, None])
        tangent = directions[-1]
        if sizes[-1] < _SINGULAR or abs(tangent[LAMBDA]) < _SINGULAR:
            return None
        return self.place(point, slopes, tangent * np.sign(tangent[LAMBDA]))

    def middle(self, point: Array, border: Array) -> Middle | None:
        """What is known of the middle of a chord; None where its planes do not cross the curve."""
        slopes = self.equations.slopes(point)
        try:
            inverse = np.asarray(np.linalg.inv(np.vstack([slopes, border])), dtype=float)
        except np.linalg.LinAlgError:
            return None
        bends = self.equations.bends
        bend = (inverse[:, :-1] @ bends.reshape(len(bends), -1)).reshape(-1, *bends.shape[1:])
        error = self.tolerance * _lengths(slopes)
        return Middle(inverse, np.abs(inverse[:, :-1]), bend, np.abs(bend), error)

    def piece(self, here: Place, there: Place) -> Piece | None:
        """The piece of curve from one place to the other, whose tangents lead that way.

        None where it is not proven that there is one: they are too far from each other for that,
        or on different branches.
        """
        chord = there.point - here.point
        length = sqrt(float(chord @ chord))
        border = chord / max(length, 1e-300)
        if min(float(here.tangent @ border), float(there.tangent @ border)) <= 0.0:
            return None
        m = self.middle(0.5 * (here.point + there.point), border)
        if m is None:
            return None
        along = m.bend @ chord
        # What is left of F on the chord: at its ends it vanishes but for an error.
        missing = 0.125 * np.abs(along @ chord) + m.weight @ m.error
        turning = 0.5 * np.abs(along)
        radius = missing
        for _ in range(3):
            radius = missing + _SPAN * (turning @ radius)
        radius = radius + _SPREAD * radius.max()
        spread = turning + m.size @ radius
        needed = spread @ radius
        if not (missing + needed < radius).all():
            return None
        effort = float((needed / radius).max())
        turns = _turns(m, _Bounds(spread, radius, effort), (here, there), border, length)
        return Piece(here, there, radius, effort, turns)


def _lengths(slopes: Array) -> Array:
    """(n,) of the gradients."""
    return np.asarray(np.maximum(np.sqrt(np.einsum("ij,ij->i", slopes, slopes)), _FLAT))


@cache
def _dgesv() -> Any:
    from scipy.linalg.lapack import dgesv  # slow to import

    return dgesv


def _solve(slopes: Array, border: Array, right: Array) -> Array | None:
    """The solution with ``border`` as the last row; LAPACK itself, as it is asked for so often."""
    matrix = np.empty((len(border), len(border)))
    matrix[:-1], matrix[-1] = slopes, border
    _, _, answer, failed = _dgesv()(matrix, right)
    return None if failed or not np.isfinite(answer).all() else np.asarray(answer)


def _turns(
    m: Middle, bounds: _Bounds, places: tuple[Place, Place], border: Array, length: float
) -> int | None:
    """Changes of the sign of dλ on a piece: none, one, or unknown.

    With the length s along the chord, x' = J⁻¹ (0, …, 0, 1) and x'' = −J⁻¹ (d²F(x', x'), 0), and
    J = J_m (I + E) with |E| ≤ spread.
    """
    tangent = m.inverse[:, -1]
    size = np.abs(tangent)
    off = bounds.resolved(bounds.spread @ size)
    if abs(tangent[LAMBDA]) > off[LAMBDA]:
        return 0
    curve = m.bend @ tangent @ tangent
    loose = m.size @ (2.0 * size + off) @ off
    bound = bounds.resolved(bounds.spread @ np.abs(curve) + loose)[LAMBDA]
    low, high = -curve[LAMBDA] - bound, -curve[LAMBDA] + bound
    first, last = (place.slope / float(place.tangent @ border) for place in places)
    if first < 0.0:
        first, last, low, high = -first, -last, -high, -low
    if last <= 0.0:
        return 1 if high < 0.0 and first > 0.0 else None
    if low >= 0.0 or high <= 0.0:
        return 0
    part = min(max((first - last + high * length) / (high - low), 0.0), length)
    return 0 if first + low * part > 0.0 else None
