"""Along a curve of closure equations, piece by proven piece: how far a way leads, and what ends it.

The curve (`homotopy.curve`) is followed by its arc length, so folds, where two assembly modes merge
and λ turns back, are points like others (Allgower & Georg, Introduction to Numerical Continuation
Methods, 2003, ch. 6). A step is taken only where it is proven that one piece of curve joins its
ends and that no other is near. Where branches cross, pieces become shorter and shorter, and the
trace ends.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Literal, NamedTuple

import numpy as np

from kinematics.arrays import Array
from kinematics.homotopy.curve import LAMBDA, Curve, Piece, Place

# Steps have no unit: 1 is a length of the machine or a radian.
_FIRST, _LONGEST, _SHORTEST = 0.1, 0.7, 1e-7
_NEAR = 1e-5  # a trace ends where steps must be this short, near enough to go back from
_FINEST = 1e-4  # a piece that is shorter need not tell how often λ turns back on it
_LEAVES = 1e-4  # a step to be proven where a motion stops before a crossing: to leave it again
_EFFORT = 0.25  # of a proof, aimed at
_WARNED = 1.1  # largest growth of a step after one that had to be shortened
_BEFORE = 1e-6  # part of the way by which a motion stops before a fold
_ON = 1e-9  # of an unknown that ends a motion where it is 0: as good as that
MOST_PIECES = 2000
"""Of a way, before it is given up as stalled."""
_MOST_ROUNDS = 60  # of a search within one piece


# --- piece after piece -----------------------------------------------------------------------


class Tracer:
    """Follows a curve from a place on, in the direction of its tangent."""

    def __init__(self, curve: Curve, here: Place) -> None:
        self.curve, self.here = curve, here
        self._last: Place | None = None
        self._step, self._least = _FIRST, _SHORTEST

    def advance(self, level: float) -> Piece | None:
        """One piece on, not far beyond λ = ``level``.

        None where no piece can be proven, however short: at a crossing of branches.
        """
        curve, here = self.curve, self.here
        rest = (level - here.along) / here.slope if here.slope else -1.0
        step, grows = self._step, 2.0
        while step >= self._least:
            exact = 0.0 < rest <= step
            step = min(step, rest) if exact else step
            guess = ahead(here, step, self._last)
            if exact:
                guess[LAMBDA] = level
            found = curve.correct(guess, curve.level if exact else here.tangent, strict=True)
            there = None if found is None else curve.place(*found, here.tangent)
            piece = None if there is None else curve.piece(here, there)
            if piece is None or (piece.turns is None and step > _FINEST):
                step, grows = 0.5 * step, _WARNED
                continue
            self._last, self.here = here, piece.there
            if step > 4.0 * _NEAR:  # shorter steps are only for the way out
                self._least = _NEAR
            self._step = min(_LONGEST, step * min(grows, _EFFORT / piece.effort))
            return Piece(here, piece.there, piece.radius, piece.effort, piece.turns, exact)
        return None

    def until(self, level: float) -> Piece | None:
        """The piece on which λ = ``level`` is passed or λ turns back; None where the trace ends."""
        below = self.here.along < level
        for _ in range(MOST_PIECES):
            piece = self.advance(level)
            if piece is None or piece.exact or piece.turned:
                return piece
            if (piece.there.along < level) != below:
                return piece
        return None


def ahead(here: Place, step: float, last: Place | None) -> Array:
    """A step along the tangent; with the place before, along the cubic through both."""
    guess: Array = here.point + step * here.tangent
    if last is not None:
        way = here.point - last.point
        length = sqrt(float(way @ way))
        part = step / length
        cubic, square = step * part * part, step * part
        guess = guess + (square + cubic) * last.tangent + (2.0 * square + cubic) * here.tangent
        guess = guess - ((3.0 * square + 2.0 * cubic) / length) * way
    return guess


def search(
    curve: Curve, piece: Piece, value: Callable[[Place], float], *, enough: float = 0.0
) -> Place:
    """The place on a piece where ``value``, which changes its sign on it, vanishes.

    The Illinois method over planes across the piece; what is found lies on the piece.
    """
    border, far = piece.border, piece.length
    low, high = (0.0, piece.here, value(piece.here)), (far, piece.there, value(piece.there))
    last = far
    for _ in range(_MOST_ROUNDS):
        (s0, p0, v0), (s1, p1, v1) = low, high
        if v0 == v1:
            break
        s = s0 + (s1 - s0) * v0 / (v0 - v1)
        found = curve.correct(_between(p0, p1, (s - s0) / (s1 - s0), border), border)
        there = None if found is None else curve.place(*found, border)
        if there is None or not piece.holds(there.point):
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


def _between(one: Place, two: Place, part: float, border: Array) -> Array:
    """A guess at a part of the way between two places: the cubic with their tangents."""
    way = two.point - one.point
    length = float(way @ border)
    guess: Array = one.point + part * part * (3.0 - 2.0 * part) * way
    for weight, at in ((part * (1.0 - part) ** 2, one), (-part * part * (1.0 - part), two)):
        guess = guess + weight * length / float(at.tangent @ border) * at.tangent
    return guess


def at_level(curve: Curve, piece: Piece, level: float, unknown: int = LAMBDA) -> Place:
    """The first place on a piece with an unknown at ``level``, which must be passed on it."""
    near = search(curve, piece, lambda p: level - float(p.point[unknown]))
    guess = near.point.copy()
    guess[unknown] = level
    found = curve.correct(guess, np.eye(len(guess))[unknown], strict=True)
    there = None if found is None else curve.place(*found, piece.here.tangent)
    return near if there is None or not piece.holds(there.point) else there


def _meets(curve: Curve, piece: Piece, level: float) -> Place | None:
    """Where λ = ``level`` first on a piece; None if it turns back before or does not get there."""
    if piece.exact:
        return piece.there
    below = piece.here.along < level
    there = search(curve, piece, lambda p: p.slope) if piece.turned else piece.there
    if (there.along < level) == below:
        return None
    return at_level(curve, _up_to(piece, there), level)


def _up_to(piece: Piece, there: Place) -> Piece:
    """The first part of a piece."""
    return Piece(piece.here, there, piece.radius, piece.effort, piece.turns)


def _before_turn(curve: Curve, piece: Piece, gap: float) -> Place:
    """A place where λ is ``gap`` below where it turns back on a piece; ``here`` if that is less."""
    edge = search(curve, piece, lambda p: p.slope)
    top = edge.along
    if top - piece.here.along <= gap:
        return piece.here

    def rest(at: Place) -> float:  # nearly straight in arc length, unlike λ itself
        return sqrt(max(top - at.along, 0.0)) - sqrt(gap)

    before = search(curve, _up_to(piece, edge), rest, enough=0.1 * sqrt(gap))
    # The gap may be below what rounding resolves.
    return before if before.slope * piece.here.slope > 0.0 else piece.here


# --- a whole way ---------------------------------------------------------------------------


class Walk(NamedTuple):
    """Where a way along a curve led.

    Attributes:
        point: (n + 1,) there.
        stop: "target"; "singularity"; "edge", where the unknown that ends the way is 0; "stalled".
        visited: (K, n + 1) points on the way, the first and the last among them.
        undetermined: it begins in a singularity.
    """

    point: Array
    stop: Literal["target", "singularity", "edge", "stalled"]
    visited: Array
    undetermined: bool = False


def walk(
    curve: Curve, point: Array, level: float, edge: int | None = None, most: int = MOST_PIECES
) -> Walk:
    """From a point with λ = 0 to λ = ``level``, or to shortly before λ turns back or ends.

    Args:
        edge: an unknown that ends the way where it changes its sign; at the start it may be 0.
        most: pieces, before it is given up as stalled.
    """
    here = curve.first(point)
    if here is None:
        return Walk(point, "singularity", point[None], undetermined=True)
    tracer = Tracer(curve, here)
    visited = [here.point]
    safe: tuple[int, Piece] | None = None
    for _ in range(most):
        piece = tracer.advance(level)
        if piece is None:
            if safe is not None:
                count, last = safe
                visited = [*visited[:count], _shortly_before_end(curve, last).point]
            return _ended(curve, visited, "singularity")
        if piece.length > _LEAVES:
            safe = len(visited), piece
        found = _meets(curve, piece, level)
        stop: Literal["target", "singularity", "edge"] = "target"
        if found is None and piece.turned:
            found, stop = _before_turn(curve, piece, _BEFORE * level), "singularity"
        met = None if edge is None else _crossed(curve, piece, edge)
        if met is not None and (found is None or piece.part(met.point) <= piece.part(found.point)):
            found, stop = met, "edge"
        if found is not None:
            return _ended(curve, [*visited, found.point], stop)
        visited.append(piece.there.point)
    return _ended(curve, visited, "stalled")


def _shortly_before_end(curve: Curve, piece: Piece) -> Place:
    """A place on a piece from which there is a step to its end that may be left again."""
    part = 1.0 - _LEAVES / piece.length
    found = curve.correct(_between(piece.here, piece.there, part, piece.border), piece.border)
    there = None if found is None else curve.place(*found, piece.border)
    return piece.here if there is None or not piece.holds(there.point) else there


def _ended(
    curve: Curve, visited: list[Array], stop: Literal["target", "singularity", "edge", "stalled"]
) -> Walk:
    end = visited[-1] if stop == "edge" else curve.polished(visited[-1])
    return Walk(end, stop, np.array([*visited, end]))


def _crossed(curve: Curve, piece: Piece, unknown: int) -> Place | None:
    """Where an unknown changes its sign on a piece; one that begins as 0 does not."""
    before, after = (float(p.point[unknown]) for p in (piece.here, piece.there))
    if abs(before) <= _ON or (before * after > 0.0 and abs(after) > _ON):
        return None
    return piece.there if abs(after) <= _ON else at_level(curve, piece, 0.0, unknown)


class Turn(NamedTuple):
    """Where λ turns back, and the point of the other branch where it is 0 again, if that is."""

    point: Array
    partner: Array | None


def turn_ahead(curve: Curve, point: Array, level: float, edge: int | None = None) -> Turn | None:
    """The first place up to λ = ``level`` at which λ turns back, or beyond which nothing is proven.

    None where the way is free, where it begins in a singularity, and where ``edge`` ends it before.
    """
    here = curve.first(point)
    if here is None:
        return None
    tracer = Tracer(curve, here)
    for _ in range(MOST_PIECES):
        piece = tracer.advance(level)
        if piece is None:
            return Turn(tracer.here.point, None)
        top = search(curve, piece, lambda p: p.slope) if piece.turned else None
        met = None if edge is None else _crossed(curve, piece, edge)
        if met is not None and (top is None or piece.part(met.point) <= piece.part(top.point)):
            return None
        if top is not None:
            break
        if piece.exact or piece.there.along >= level:
            return None
    else:
        return None
    if top.along >= level:
        return None
    if piece.there.along <= 0.0:
        down = Piece(top, piece.there, piece.radius, piece.effort, piece.turns)
        return Turn(top.point, curve.polished(at_level(curve, down, 0.0).point))
    back = tracer.until(0.0)
    partner = None if back is None else _meets(curve, back, 0.0)
    return Turn(top.point, None if partner is None else curve.polished(partner.point))
