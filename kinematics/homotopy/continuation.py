"""Along the curve of n quadratic equations in n + 1 unknowns, piece by proven piece.

The last unknown is λ, how far along a line in joint space the actuators are; the others say where
the machine is. The curve is followed by its arc length, so folds, where two assembly modes merge
and λ turns back, are points like others (Allgower & Georg, Introduction to Numerical Continuation
Methods, 2003, ch. 6). A step is taken only where it is proven that one piece of curve joins its
ends and that no other is near. Between two points of the curve lies a chord; with the inverse A of
the Jacobian J at its middle Krawczyk's test is made for all its points c at once: where

    |A F(c)| + |I − A J(x)| r < r    for every x with |x − c| ≤ r componentwise,

each plane across the chord holds exactly one solution within r of it, so one piece of curve runs
along the chord, and both points are its ends (Moore, Kearfott, Cloud: Introduction to Interval
Analysis, 2009, section 8.2; for pieces of curve Martin, Goldsztejn, Granvilliers, Jermann, SIAM
J. Numer. Anal. 51 (2013) 3373). As F is quadratic, its second derivatives at hand are all that
this takes. The bounds hold but for the rounding of the numbers they are made of. Bounds on the
tangent and on its change then tell whether λ rises or falls all along the piece (no parallel
singularity: det J without λ is not 0) or turns back exactly once (a fold).

Where branches cross, pieces become shorter and shorter, and the trace ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import Literal, NamedTuple

import numpy as np
from scipy.linalg.lapack import dgesv

from kinematics.arrays import Array
from kinematics.homotopy.quadrics import Quadrics

LAMBDA = -1
"""Where λ stands among the unknowns."""

# Steps have no unit: 1 is a length of the machine or a radian.
_FIRST, _LONGEST, _SHORTEST = 0.1, 0.7, 1e-7
_NEAR = 1e-5  # a trace ends where steps must be this short, near enough to go back from
_FINEST = 1e-4  # a piece that is shorter need not tell how often λ turns back on it
_LEAVES = 1e-4  # a step to be proven where a motion stops before a crossing: to leave it again
_EFFORT = 0.25  # of a proof, aimed at
_WARNED = 1.1  # largest growth of a step after one that had to be shortened
_CONTRACTS = 0.25  # largest ratio of the second Newton step to the first
_SINGULAR = 1e-12  # a singular value or a slope that is only rounding
_SPAN = 2.0  # of how much the equations turn on half of the chord, what the radius allows for
_SPREAD = 0.1  # of the largest radius, what is added to all of them
_FLAT = 1e-3  # a gradient that is shorter counts as this long
_BEFORE = 1e-6  # part of the way by which a motion stops before a fold
_ON = 1e-9  # of an unknown that ends a motion where it is 0: as good as that
_MOST_PIECES = 2000
_MOST_ROUNDS = 60  # of a search within one piece


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
        chord: Array = self.there.point - self.here.point
        return chord

    @property
    def length(self) -> float:
        """Of the chord."""
        return float(np.linalg.norm(self.chord))

    @property
    def border(self) -> Array:
        """(n + 1,) of length one; every plane across it, from end to end, holds one point."""
        border: Array = self.chord / self.length
        return border

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
        answer: Array = vector + once + twice + tail * self.radius
        return answer


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
    lengths: Array = np.maximum(np.sqrt(np.einsum("ij,ij->i", slopes, slopes)), _FLAT)
    return lengths


def _solve(slopes: Array, border: Array, right: Array) -> Array | None:
    """The solution with ``border`` as the last row; LAPACK itself, as it is asked for so often."""
    matrix = np.empty((len(border), len(border)))
    matrix[:-1], matrix[-1] = slopes, border
    _, _, answer, failed = dgesv(matrix, right)
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
        for _ in range(_MOST_PIECES):
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


def walk(curve: Curve, point: Array, level: float, edge: int | None = None) -> Walk:
    """From a point with λ = 0 to λ = ``level``, or to shortly before λ turns back or ends.

    Args:
        edge: an unknown that ends the way where it changes its sign; at the start it may be 0.
    """
    here = curve.first(point)
    if here is None:
        return Walk(point, "singularity", point[None], undetermined=True)
    tracer = Tracer(curve, here)
    visited = [here.point]
    safe: tuple[int, Piece] | None = None
    for _ in range(_MOST_PIECES):
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
    for _ in range(_MOST_PIECES):
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
