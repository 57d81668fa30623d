"""The workspace of an operation mode by its columns, in the reduced form of `posing`.

Over tilt θ and azimuth φ the altitude v of the spherical triangle, seen from the revolute one, is
all that is left: limb i keeps hypot(p_i, v + λ_i) within its stroke, with p_i and λ_i functions of
the orientation. What parts the workspace into aspects is a cubic in v. Everything is regular over
all tilts, at 90° too, where the altitude Z of a 3-SPR says nothing of v. Lengths mm, angles rad.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.tripods import polynomial
from kinematics.mechanisms.tripods.design import AZIMUTHS, LIMBS, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.powers import Power
from kinematics.solids.columns import Span

_ALPHA = np.array(AZIMUTHS)
_START = 0.0617
"""rad: no azimuth at which the machine is symmetric is a simple part of a turn from here, so that
surfaces seldom pass through corners of cells."""
_RIM = 2e-6
"""rad short of a tilt of π, where both modes meet and aspects that are apart touch."""


@dataclass(frozen=True)
class TripodColumns:
    """Columns over (θ, φ) along v; places are those of `chart`.

    Args:
        mode: the operation mode.
        parted: whether the zeros of P part the workspace.
    """

    design: TripodDesign
    mode: str
    parted: bool = True

    @property
    def low(self) -> Array:
        return np.full(LIMBS, self.design.stroke[0])

    @property
    def high(self) -> Array:
        return np.full(LIMBS, self.design.stroke[1])

    @property
    def base(self) -> tuple[Span, Span]:
        return (0.0, np.pi - _RIM), (_START - np.pi, _START + np.pi)

    @property
    def closed(self) -> bool:
        return True

    @property
    def pole(self) -> bool:
        return True

    @property
    def tear(self) -> float | None:
        """Of a 3-SPR at 90° all v have the same Z."""
        return None if self.design.revolute_on_base else 0.5 * self.base[0][1]

    @property
    def _k(self) -> float:
        return mode_sign(self.mode) * self.design.spherical_radius

    @property
    def _side(self) -> float:
        """Of the axis about which the spherical triangle is tilted: an inverse turns it round."""
        return 1.0 if self.design.revolute_on_base else -mode_sign(self.mode)

    def limbs(self, at: Array) -> tuple[Array, Array]:
        """p_i and λ_i, see `posing`: ζ = s e^{iφ}."""
        tilt, azimuth = at[:, :1], at[:, 1:]
        k = self._k
        s, c = np.sin(0.5 * tilt), np.cos(0.5 * tilt)
        outward = k * (2.0 * s * s * np.cos(2.0 * azimuth + _ALPHA) + c * c)
        upward = self._side * k * np.sin(tilt) * np.sin(_ALPHA - azimuth)
        return outward - self.design.revolute_radius, upward

    def spread(self, at: Array, half: Array) -> Array:
        """By the slopes in the middle, and by bounds of the second derivatives:
        |p_θθ| ≤ 3/2 k, |p_θφ| ≤ 2 k, |p_φφ| ≤ 8 k; |λ_θθ|, |λ_θφ|, |λ_φφ| ≤ k."""
        tilt, azimuth = at[:, :1], at[:, 1:]
        k, sine = abs(self._k), np.sin(tilt)
        a, b = half[:, :1], half[:, 1:]
        double = 2.0 * azimuth + _ALPHA
        out_tilt = sine * np.abs(np.cos(double) - 0.5)
        out_turn = 4.0 * np.sin(0.5 * tilt) ** 2 * np.abs(np.sin(double))
        up_tilt = np.abs(np.cos(tilt) * np.sin(_ALPHA - azimuth))
        up_turn = np.abs(sine * np.cos(_ALPHA - azimuth))
        out = out_tilt * a + out_turn * b + 0.75 * a * a + 2.0 * a * b + 4.0 * b * b
        up = up_tilt * a + up_turn * b + 0.5 * (a + b) ** 2
        return np.asarray(k * np.hypot(out, up))

    def weight(self, at: Array) -> Array:
        """dX dY = h2² θ dθ dφ, and dZ = |cos θ| dv of a 3-SPR."""
        tilt = at[:, 0]
        area = self.design.platform_radius**2 * tilt
        return np.asarray(area if self.design.revolute_on_base else area * np.abs(np.cos(tilt)))

    def polynomial(self, at: Array) -> Array | None:
        """P in v, in units of the spherical radius³; of a 3-SPR P / cos² θ, that of its inverse."""
        if not self.parted:
            return None
        unit = self.design.spherical_radius
        s, c = np.sin(0.5 * at[:, 0]), np.cos(0.5 * at[:, 0])
        cube = self._side * s**3 * np.sin(3.0 * at[:, 1])
        h, k = self.design.revolute_radius / unit, self._k / unit
        a0, a1, a2, _ = polynomial.terms("three_rps", h, k, Power.unknown(), s * s)
        found = (a0 * c + a1 * cube + a2 * (c * cube * cube)).coefficients
        return np.asarray(found / unit ** np.arange(4))

    def place(self, at: Array, v: Array) -> Array:
        """Z = v, or Z = h1 s² sin θ sin 3φ − v cos θ of a 3-SPR."""
        tilt, azimuth = at[:, 0], at[:, 1]
        out = self.design.platform_radius * tilt
        z = v
        if not self.design.revolute_on_base:
            s = np.sin(0.5 * tilt)
            lift = self.design.base_radius * s * s * np.sin(tilt) * np.sin(3.0 * azimuth)
            z = lift - v * np.cos(tilt)
        return np.stack([out * np.cos(azimuth), out * np.sin(azimuth), z], axis=-1)
