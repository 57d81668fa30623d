"""Along the curve of a 5-RPUR's configurations over a line in joint space, piece by proven piece.

The curve is followed by its arc length, so folds, where two assembly modes merge and λ turns
back, are points like others. Every step is a `continuation.certificate.Piece`: the branch
cannot change on it. Where branches cross, pieces become shorter and shorter, and the trace ends.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.continuation.certificate import Certifier, Piece
from kinematics.mechanisms.five_rpur.continuation.curve import (
    LAMBDA,
    LAMBDA_FIXED,
    Line,
    Place,
    Point,
    ahead,
    correct,
    linear,
    place,
)

# Steps are in units of the link length and of a radian.
_FIRST, _LONGEST, _SHORTEST = 0.1, 0.5, 1e-7
_NEAR = 1e-5  # a trace ends where steps must be this short, near enough to go back from
_FINEST = 1e-4  # a piece that is shorter need not tell how often λ turns back on it
_EFFORT = 0.25  # of a proof, aimed at
_WARNED = 1.1  # largest growth of a step after one that had to be shortened
_SINGULAR = 1e-12  # a singular value or a slope that is only rounding
_MOST_ROUNDS = 60  # of a search within one piece


class Reached(NamedTuple):
    """A piece of curve from one place to another."""

    here: Place
    there: Place
    piece: Piece
    exact: bool  # the wanted λ is met exactly

    @property
    def turned(self) -> bool:
        """λ turns back on the piece: there is a fold on it."""
        return self.here.slope * self.there.slope <= 0.0


def first_place(line: Line, point: Point) -> Place | None:
    """The place of a point of the curve, towards larger λ; None in a parallel singularity."""
    at = linear(line, point)
    rows = np.sqrt((at.matrix * at.matrix).sum(axis=1))
    if not (rows > 0.0).all():
        return None
    _, sizes, directions = np.linalg.svd(at.matrix / rows[:, None])
    tangent = directions[-1]
    if sizes[-1] < _SINGULAR or abs(tangent[LAMBDA]) < _SINGULAR:
        return None
    return place(point, at, tangent if tangent[LAMBDA] > 0.0 else -tangent)


class Tracer:
    """Follows the curve from a place on, in the direction of its tangent."""

    def __init__(self, line: Line, here: Place) -> None:
        self.line = line
        self.here = here
        self._certifier = Certifier(line)
        self._last: Place | None = None
        self._step, self._least = _FIRST, _SHORTEST

    def advance(self, level: float) -> Reached | None:
        """One piece on, not far beyond λ = ``level``.

        None where no piece can be proven, however short: at a crossing of branches.
        """
        line, here = self.line, self.here
        slope = line.length * here.slope
        rest = (level - here.point.along) / slope if slope else -1.0
        step, grows = self._step, 2.0
        while step >= self._least:
            exact = 0.0 < rest <= step
            step = min(step, rest) if exact else step
            guess = ahead(line, here, step, self._last)
            if exact:
                guess.u[LAMBDA] = level
            found = correct(line, guess, LAMBDA_FIXED if exact else here.tangent, strict=True)
            there = None if found is None else place(*found, here.tangent)
            piece = None if there is None else self._certifier.piece(here, there)
            if piece is None or there is None or (piece.turns is None and step > _FINEST):
                step, grows = 0.5 * step, _WARNED
                continue
            self._last, self.here = here, there
            if step > 4.0 * _NEAR:  # shorter steps are only for the way out
                self._least = _NEAR
            self._step = min(_LONGEST, step * min(grows, _EFFORT / piece.effort))
            return Reached(here, there, piece, exact)
        return None


def at_level(line: Line, way: Reached, level: float) -> Place:
    """The first place on a piece with λ = ``level``, which must be passed on it."""
    near = search(line, way, lambda p: level - p.point.along)
    guess = Point(near.point.u.copy(), near.point.w)
    guess.u[LAMBDA] = level
    found = correct(line, guess, LAMBDA_FIXED, strict=True)
    there = None if found is None else place(*found, way.here.tangent)
    if there is None or not way.piece.holds(line.scaled(there.point)):
        return near
    return there


def search(
    line: Line, way: Reached, value: Callable[[Place], float], *, enough: float = 0.0
) -> Place:
    """The place on a piece where ``value``, which changes its sign on it, vanishes.

    The Illinois method over planes across the piece; what is found lies on the piece.
    """
    border = way.piece.border
    far = float((way.there.point.u - way.here.point.u) @ (border / line.scale))
    low, high = (0.0, way.here, value(way.here)), (far, way.there, value(way.there))
    last = far
    for _ in range(_MOST_ROUNDS):
        (s0, p0, v0), (s1, p1, v1) = low, high
        if v0 == v1:
            break
        s = s0 + (s1 - s0) * v0 / (v0 - v1)
        guess = _between(line, p0, p1, (s - s0) / (s1 - s0), border)
        found = correct(line, guess, border)
        there = None if found is None else place(*found, border)
        if there is None or not way.piece.holds(line.scaled(there.point)):
            break
        v = value(there)
        if abs(v) <= enough or abs(s - last) <= 1e-8 * far:
            return there
        last = s
        # The end that stays is weighed down, or the search would creep towards it.
        if (v > 0) == (low[2] > 0):
            low, high = (s, there, v), (s1, p1, 0.5 * v1)
        else:
            low, high = (s0, p0, 0.5 * v0), (s, there, v)
    return low[1]


def _between(line: Line, one: Place, two: Place, part: float, border: Array) -> Point:
    """A guess at a part of the way between two places: the cubic with their tangents."""
    du, dw = two.point.u - one.point.u, two.point.w - one.point.w
    length = float(du @ (border / line.scale))
    back, on = part * (1.0 - part) ** 2, part * part * (1.0 - part)
    step = part * part * (3.0 - 2.0 * part)
    u, w = one.point.u + step * du, one.point.w + step * dw
    for weight, at in ((back, one), (-on, two)):
        rate = weight * length / float(at.tangent @ border)
        u, w = u + rate * line.scale * at.tangent, w + rate * at.elbow
    return Point(u, w)
