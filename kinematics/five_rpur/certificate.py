"""Proof that two points of a 5-RPUR's curve are joined by it, without a jump and without a fold.

Between two points on the curve (see `kinematics.five_rpur.curve`) lies a chord. Krawczyk's test
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

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kinematics.five_rpur.curve import LAMBDA, Line, Place
from kinematics.spatial import Array

# Unknowns are columns, in units of the link length and of a radian; rows are F1, F2 and the
# plane across the chord.
_X, _Y, _Z, _PHI, _THETA = range(5)
_W = slice(6, 11)
_FIRST = np.arange(5)
_OTHER, _ELBOW = _FIRST + 5, _FIRST + 6
_SPAN = 2.0  # radius tried, of what the first estimate asks for
_SPREAD = 0.15  # and of the largest radius of all unknowns


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
    def border(self) -> Array:
        """(6,) of length one; every plane across it, from end to end, holds one point."""
        answer: Array = self.chord[:6] / np.linalg.norm(self.chord[:6])
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
    bend: Array  # (11, 11, 11) A d²F
    size: Array  # |A d²F|
    first: Array  # (5,) |(X + s'_x, w)|, without unit
    second: Array  # (5,) |(y − r_y, Z − w)|
    error: Array  # (10,) what F may be at the ends of the chord


class Certifier:
    """Certifies pieces of the curve over one line."""

    def __init__(self, line: Line) -> None:
        design, unit = line.design, line.length
        self._line = line
        self._base = design.base.T / unit
        self._platform = design.platform.T / unit
        self._link = design.link / unit
        self._base_arm = np.hypot(self._base[0], self._base[2])
        self._platform_arm = np.hypot(self._platform[1], self._platform[2])

    def piece(self, here: Place, there: Place) -> Piece | None:
        """The piece of curve from one place to the other, whose tangents lead that way.

        None where it is not proven that there is one: they are too far from each other for that,
        or on different branches.
        """
        start, end = self._line.scaled(here.point), self._line.scaled(there.point)
        chord = end - start
        length = float(np.sqrt(chord[:6] @ chord[:6]))
        border = chord[:6] / max(length, 1e-300)
        if min(float(here.tangent @ border), float(there.tangent @ border)) <= 0.0:
            return None
        m = self._middle(0.5 * (start + end), border)
        if m is None:
            return None
        along = m.bend @ chord
        # What is left of F on the chord: at its ends it vanishes but for an error.
        missing = m.weight @ (0.125 * self._third(m, np.abs(chord)) + m.error)
        missing += 0.125 * np.abs(along @ chord)
        radius = _SPAN * missing + _SPREAD * missing.max()
        reach = 0.5 * np.abs(chord) + radius
        spread = 0.5 * np.abs(along) + m.size @ radius + m.weight @ self._remainder(m, reach)
        needed = spread @ radius
        if not (missing + needed < radius).all():
            return None
        effort = float((needed / radius).max())
        turns = self._turns(m, spread, reach, (here, there), border, length)
        return Piece(start, chord, radius, effort, turns)

    def _middle(self, point: Array, border: Array) -> _Middle | None:
        (rx, ry, rz), (sx, sy, sz) = self._base, self._platform
        x, y, z, phi, theta, along = point[:6].tolist()
        w = point[_W]
        c, s, cf, sf = np.cos(theta), np.sin(theta), np.cos(phi), np.sin(phi)
        a, b = rx * c - rz * s, rx * s + rz * c
        my, mz = cf * sy - sf * sz, sf * sy + cf * sz
        xs, yr, zw = x + sx, y - ry, z - w
        rate = self._line.direction
        rho = self._line.joints(along * self._line.length) / self._line.length
        jacobian = np.zeros((11, 11))
        jacobian[:5, _X] = xs - a
        jacobian[:5, _THETA] = xs * b - w * a
        jacobian[:5, LAMBDA] = -rho * rate
        jacobian[_FIRST, _ELBOW] = w - b
        jacobian[5:10, _Y] = yr + my
        jacobian[5:10, _Z] = zw + mz
        jacobian[5:10, _PHI] = zw * my - yr * mz
        jacobian[_OTHER, _ELBOW] = -(zw + mz)
        jacobian[10, :6] = border
        try:
            inverse = np.asarray(np.linalg.inv(jacobian), dtype=float)
        except np.linalg.LinAlgError:
            return None
        second = np.zeros((10, 11, 11))
        one, two, first, other = second[:5], second[5:], _FIRST, _ELBOW
        one[:, _X, _X] = one[first, other, other] = 1.0
        one[:, _X, _THETA] = one[:, _THETA, _X] = b
        one[first, _THETA, other] = one[first, other, _THETA] = -a
        one[:, _THETA, _THETA] = xs * a + w * b
        one[:, LAMBDA, LAMBDA] = -rate * rate
        two[:, _Y, _Y] = two[:, _Z, _Z] = two[first, other, other] = 1.0
        two[first, _Z, other] = two[first, other, _Z] = -1.0
        two[:, _Y, _PHI] = two[:, _PHI, _Y] = -mz
        two[:, _Z, _PHI] = two[:, _PHI, _Z] = my
        two[first, _PHI, other] = two[first, other, _PHI] = -my
        two[:, _PHI, _PHI] = -(zw * mz + yr * my)
        weight: Array = inverse[:, :10]
        bend = (weight @ second.reshape(10, 121)).reshape(11, 11, 11)
        error = self._line.tolerance / self._line.length * np.concatenate([rho, self._link])
        return _Middle(
            inverse, np.abs(weight), bend, np.abs(bend), np.hypot(xs, w), np.hypot(yr, zw), error
        )

    def _third(self, m: _Middle, step: Array) -> Array:
        """(10,) how much the second derivative of F along a chord varies about its middle."""
        dx, dy, dz, dphi, dtheta, _ = step[:6].tolist()
        dw = step[_W]
        one = self._base_arm * dtheta**2 * (3.0 * (dx + dw) + (m.first + dx + dw) * dtheta)
        two = (
            self._platform_arm * dphi**2 * (3.0 * (dy + dz + dw) + (m.second + dy + dz + dw) * dphi)
        )
        return 0.5 * np.concatenate([one, two])

    def _remainder(self, m: _Middle, reach: Array) -> Array:
        """(10, 11) by how much the Jacobian within ``reach`` differs from its Taylor polynomial."""
        dx, dy, dz, dphi, dtheta, _ = reach[:6].tolist()
        dw = reach[_W]
        r, s = self._base_arm, self._platform_arm
        turned, tilted = 0.5 * dtheta * dtheta * r, 0.5 * dphi * dphi * s
        answer = np.zeros((10, 11))
        answer[:5, _X] = answer[_FIRST, _ELBOW] = turned
        answer[:5, _THETA] = r * dtheta * (dx + dw) + turned * m.first
        answer[5:, _Y] = answer[5:, _Z] = answer[_OTHER, _ELBOW] = tilted
        answer[5:, _PHI] = s * dphi * (dy + dz + dw) + tilted * m.second
        return answer

    def _turns(
        self,
        m: _Middle,
        spread: Array,
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
        whole = np.eye(11) - spread
        off = np.linalg.solve(whole, spread @ size)
        if abs(tangent[LAMBDA]) > off[LAMBDA]:
            return 0
        curve = m.bend @ tangent @ tangent
        loose = (m.size @ (2.0 * size + off)) @ off + m.weight @ self._varies(m, reach, size + off)
        bound = np.linalg.solve(whole, spread @ np.abs(curve) + loose)
        low, high = -curve[LAMBDA] - bound[LAMBDA], -curve[LAMBDA] + bound[LAMBDA]
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
        dx, dy, dz, dphi, dtheta, _ = reach[:6].tolist()
        dw = reach[_W]
        tx, ty, tz, tphi, ttheta, _ = tangent[:6].tolist()
        tw = tangent[_W]
        moved = dx + dw
        one = 2.0 * dtheta * (tx + tw) + (moved + (m.first + moved) * dtheta) * ttheta
        shifted = dy + dz + dw
        two = 2.0 * dphi * (ty + tz + tw) + (shifted + (m.second + shifted) * dphi) * tphi
        return np.concatenate([self._base_arm * ttheta * one, self._platform_arm * tphi * two])
