"""Proof that two points of a 5-RPUR's curve are joined by it, without a jump and without a fold.

Between two points on the curve (see `continuation.curve`) lies a chord. Krawczyk's test
with the inverse A of the Jacobian J at its middle is made for all its points c at once: where

    |A F(c)| + |I − A J(x)| r < r    for every x with |x − c| ≤ r componentwise,

each plane across the chord holds exactly one solution within r of it, so one piece of curve runs
along the chord, and both points are its ends (Moore, Kearfott, Cloud: Introduction to Interval
Analysis, 2009, section 8.2; for pieces of curve Martin, Goldsztejn, Granvilliers, Jermann, SIAM
J. Numer. Anal. 51 (2013) 3373). F(c) and J(x) are bounded by Taylor's theorem: but for two angles
F1 and F2 are quadratic, so their second derivatives at the middle and a few bounds on the third
ones are all that it takes. The bounds hold but for the rounding of the numbers they are made of.

Bounds on the tangent and on its change along the piece then tell whether λ rises or falls all
along it (no parallel singularity: det J without λ is not 0) or turns back exactly once (a fold).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.continuation.curve import LAMBDA, Line, Place
from kinematics.mechanisms.five_rpur.design import LIMBS

# Unknowns are columns, in units of the link length and of a radian: X, y, Z, φ, θ, λ, w. Rows are
# F1 and F2 of each limb and the plane across the chord.
_X, _Y, _Z, _PHI, _THETA, _W = 0, 1, 2, 3, 4, 6
_SPAN = 2.0  # of how much the equations turn on half of the chord, what the radius allows for
_SPREAD = 0.1  # of the largest radius, what is added to all of them


def _flat(one: Sequence[tuple[int, ...]], two: Sequence[tuple[int, ...]]) -> NDArray[np.intp]:
    """Where derivatives of F1 and F2 stand in a flat array of all, limb by limb.

    The unknowns that each is by; w is the limb's own.
    """
    where = []
    for limb in range(LIMBS):
        for row, columns in ((2 * limb, one), (2 * limb + 1, two)):
            for unknowns in columns:
                place = row
                for unknown in unknowns:
                    place = 11 * place + unknown + (limb if unknown == _W else 0)
                where.append(place)
    return np.array(where)


def _both(*pairs: tuple[int, int]) -> list[tuple[int, ...]]:
    """Mixed second derivatives stand twice."""
    return [pair for one, two in pairs for pair in ((one, two), (two, one))]


_FIRST = _flat(
    ((_X,), (_THETA,), (LAMBDA,), (_W,)),
    ((_Y,), (_Z,), (_PHI,), (_W,)),
)
_SECOND = _flat(
    (*_both((_X, _THETA), (_THETA, _W)), (_THETA, _THETA)),
    (*_both((_Y, _PHI), (_Z, _PHI), (_PHI, _W)), (_PHI, _PHI)),
)
_ONES = _flat(((_X, _X), (_W, _W)), ((_Y, _Y), (_Z, _Z), (_W, _W)))
_MINUS_ONES = _flat((), _both((_Z, _W)))
_LENGTHS = _flat(((LAMBDA, LAMBDA),), ())
_VARYING = _flat(((_X,), (_THETA,), (_W,)), ((_Y,), (_Z,), (_PHI,), (_W,)))


@dataclass(frozen=True, slots=True)
class Piece:
    """A chord and the only piece of curve along it.

    Attributes:
        start, chord: where the chord begins and where it leads, (11,) scaled.
        radius: (11,) scaled; within it of the chord lies the piece and nothing else of the curve.
        effort: the contraction of Newton's method that was proven, below 1; as the length is.
        turns: how often λ turns back on the piece; None where that is not proven.
    """

    start: Array
    chord: Array
    radius: Array
    effort: float
    turns: int | None

    @property
    def length(self) -> float:
        """Of the chord, its part in u, scaled."""
        return float(np.linalg.norm(self.chord[:6]))

    @property
    def border(self) -> Array:
        """(6,) of length one; every plane across it, from end to end, holds one point."""
        answer: Array = self.chord[:6] / self.length
        return answer

    def holds(self, point: Array) -> bool:
        """Whether a point of the curve, (11,) scaled, is one of the piece."""
        along = self.chord[:6]
        offset = point - self.start
        part = float(offset[:6] @ along) / float(along @ along)
        near = np.abs(offset - part * self.chord) <= self.radius
        return bool(-1e-9 <= part <= 1.0 + 1e-9 and near.all())


class _Middle(NamedTuple):
    """The equations at the middle of a chord, times the inverse A of their Jacobian."""

    inverse: Array  # (11, 11) A
    weight: Array  # (11, 10) |A| but for the last column
    bend: Array  # (121, 11) A d²F, for products with its last index
    size: Array  # (121, 11) |A d²F|
    arms: tuple[tuple[float, float], ...]  # of each limb |(X + s'_x, w)| and |(y − r_y, Z − w)|
    error: Array  # (10,) what F may be at the ends of the chord


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


class Certifier:
    """Certifies pieces of the curve over one line."""

    def __init__(self, line: Line) -> None:
        design, unit = line.design, line.length
        self._line = line
        self._error = line.tolerance / unit
        # As five limbs are too few for array calls, their numbers.
        columns = (
            design.base / unit,
            design.platform / unit,
            design.link / unit,
            line.rho / unit,
            line.direction,
        )
        self._limbs = tuple(tuple(limb) for limb in np.column_stack(columns).tolist())
        # How far A_i is from the y axis and C_i from the x' axis: what θ and φ move.
        self._arms = tuple(
            (hypot(rx, rz), hypot(sy, sz)) for rx, _, rz, _, sy, sz, *_ in self._limbs
        )
        self._constant = np.zeros((10, 121))
        flat = self._constant.ravel()
        flat[_ONES], flat[_MINUS_ONES], flat[_LENGTHS] = 1.0, -1.0, -(line.direction**2)

    def piece(self, here: Place, there: Place) -> Piece | None:
        """The piece of curve from one place to the other, whose tangents lead that way.

        None where it is not proven that there is one: they are too far from each other for that,
        or on different branches.
        """
        start, end = self._line.scaled(here.point), self._line.scaled(there.point)
        chord = end - start
        length = sqrt(float(chord[:6] @ chord[:6]))
        border = chord[:6] / max(length, 1e-300)
        if min(float(here.tangent @ border), float(there.tangent @ border)) <= 0.0:
            return None
        m = self._middle(0.5 * (start + end), border)
        if m is None:
            return None
        along = (m.bend @ chord).reshape(11, 11)
        # What is left of F on the chord: at its ends it vanishes but for an error.
        missing = m.weight @ (0.125 * self._third(m, np.abs(chord)) + m.error)
        missing += 0.125 * np.abs(along @ chord)
        turning = 0.5 * np.abs(along)
        radius = missing
        for _ in range(3):
            radius = missing + _SPAN * (turning @ radius)
        radius = radius + _SPREAD * radius.max()
        reach = 0.5 * np.abs(chord) + radius
        spread = turning + (m.size @ radius).reshape(11, 11) + m.weight @ self._remainder(m, reach)
        needed = spread @ radius
        if not (missing + needed < radius).all():
            return None
        effort = float((needed / radius).max())
        bounds = _Bounds(spread, radius, effort)
        turns = self._turns(m, bounds, reach, (here, there), border, length)
        return Piece(start, chord, radius, effort, turns)

    def _middle(self, point: Array, border: Array) -> _Middle | None:
        x, y, z, phi, theta, along, *elbows = point.tolist()
        c, s, cf, sf = cos(theta), sin(theta), cos(phi), sin(phi)
        first: list[float] = []
        second: list[float] = []
        arms: list[tuple[float, float]] = []
        error: list[float] = []
        for (rx, ry, rz, sx, sy, sz, link, rho_0, rate), w in zip(self._limbs, elbows, strict=True):
            a, b = rx * c - rz * s, rx * s + rz * c
            my, mz = cf * sy - sf * sz, sf * sy + cf * sz
            xs, yr, zw = x + sx, y - ry, z - w
            rho, q = rho_0 + along * rate, zw + mz
            first += (xs - a, xs * b - w * a, -rho * rate, w - b)
            first += (yr + my, q, zw * my - yr * mz, -q)
            second += (b, b, -a, -a, xs * a + w * b)
            second += (-mz, -mz, my, my, -my, -my, -zw * mz - yr * my)
            arms.append((hypot(xs, w), hypot(yr, zw)))
            error += (self._error * abs(rho), self._error * link)
        jacobian = np.zeros((11, 11))
        jacobian.ravel()[_FIRST] = first
        jacobian[10, :6] = border
        try:
            inverse = np.asarray(np.linalg.inv(jacobian), dtype=float)
        except np.linalg.LinAlgError:
            return None
        derivative = self._constant.copy()
        derivative.ravel()[_SECOND] = second
        weight: Array = inverse[:, :10]
        bend = (weight @ derivative).reshape(121, 11)
        return _Middle(inverse, np.abs(weight), bend, np.abs(bend), tuple(arms), np.array(error))

    def _third(self, m: _Middle, step: Array) -> Array:
        """(10,) how much the second derivative of F along a chord varies about its middle."""
        dx, dy, dz, dphi, dtheta, _, *elbows = step.tolist()
        answer: list[float] = []
        for (r, s), (one, two), dw in zip(self._arms, m.arms, elbows, strict=True):
            up, across = dx + dw, dy + dz + dw
            answer += (
                0.5 * r * dtheta * dtheta * (3.0 * up + (one + up) * dtheta),
                0.5 * s * dphi * dphi * (3.0 * across + (two + across) * dphi),
            )
        return np.array(answer)

    def _remainder(self, m: _Middle, reach: Array) -> Array:
        """(10, 11) by how much the Jacobian within ``reach`` differs from its Taylor polynomial."""
        dx, dy, dz, dphi, dtheta, _, *elbows = reach.tolist()
        values: list[float] = []
        for (r, s), (one, two), dw in zip(self._arms, m.arms, elbows, strict=True):
            turned, tilted = 0.5 * r * dtheta * dtheta, 0.5 * s * dphi * dphi
            values += (turned, r * dtheta * (dx + dw) + turned * one, turned)
            values += (tilted, tilted, s * dphi * (dy + dz + dw) + tilted * two, tilted)
        answer = np.zeros((10, 11))
        answer.ravel()[_VARYING] = values
        return answer

    def _turns(
        self,
        m: _Middle,
        bounds: _Bounds,
        reach: Array,
        places: tuple[Place, Place],
        border: Array,
        length: float,
    ) -> int | None:
        """Changes of the sign of dλ on a piece: none, one, or unknown.

        With the length s along the chord, x' = J⁻¹ (0, …, 0, 1) and x'' = −J⁻¹ (d²F(x', x'), 0),
        and J = J_m (I + E) with |E| ≤ spread.
        """
        tangent = m.inverse[:, 10]
        size = np.abs(tangent)
        off = bounds.resolved(bounds.spread @ size)
        if abs(tangent[LAMBDA]) > off[LAMBDA]:
            return 0
        curve = (m.bend @ tangent).reshape(11, 11) @ tangent
        loose = (m.size @ (2.0 * size + off)).reshape(11, 11) @ off
        loose += m.weight @ self._varies(m, reach, size + off)
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

    def _varies(self, m: _Middle, reach: Array, tangent: Array) -> Array:
        """(10,) by how much d²F along a tangent varies within ``reach`` of the middle."""
        dx, dy, dz, dphi, dtheta, _, *elbows = reach.tolist()
        tx, ty, tz, tphi, ttheta, _, *rates = tangent.tolist()
        answer: list[float] = []
        for (r, s), (one, two), dw, tw in zip(self._arms, m.arms, elbows, rates, strict=True):
            up, across = dx + dw, dy + dz + dw
            turned = 2.0 * dtheta * (tx + tw) + (up + (one + up) * dtheta) * ttheta
            tilted = 2.0 * dphi * (ty + tz + tw) + (across + (two + across) * dphi) * tphi
            answer += (r * ttheta * turned, s * tphi * tilted)
        return np.array(answer)
