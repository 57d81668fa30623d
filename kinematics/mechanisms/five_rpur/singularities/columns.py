"""One working mode of the 5-RPUR at one orientation by its columns along z', parted where F = 0.

At a fixed y' limb i holds (x', z') between two circles about (w'_x, w'_z + σ h(y' − w'_y)); F is a
polynomial of degree 4 in z' (`determinant`). So over (y', x') everything is exact. y' is taken as
an angle t, y' = middle − half cos t, in which h is smooth to the ends of the span. Lengths mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.offsets import PlacedLimbs
from kinematics.mechanisms.five_rpur.singularities.cells import Field
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from kinematics.solids.columns import Span, surface_of


@dataclass(frozen=True, eq=False)
class ModeColumns:
    """Columns over (t, x') along z'; see `solids.columns.Columned`.

    Args:
        determinant: of the mode and orientation; its limbs close somewhere.
        stands: the limbs; nearly equal ones may be made equal.
    """

    determinant: Determinant
    stands: PlacedLimbs

    closed = False
    pole = False
    tear: float | None = None

    @property
    def low(self) -> Array:
        return np.asarray(self.stands.stroke[:, 0])

    @property
    def high(self) -> Array:
        return np.asarray(self.stands.stroke[:, 1])

    @cached_property
    def _span(self) -> tuple[float, float]:
        low, high = Field(self.determinant).span
        return 0.5 * (low + high), 0.5 * (high - low)

    @cached_property
    def base(self) -> tuple[Span, Span]:
        at = self.stands.offset[:, 0]
        low, high = float((at - self.high).max()), float((at + self.high).min())
        return (0.0, np.pi), (low, max(high, low + 1e-9 * self.determinant.size))

    def along(self, turn: Array) -> Array:
        """y' of t."""
        middle, half = self._span
        return np.asarray(middle - half * np.cos(turn))

    def heights(self, y: Array) -> Array:
        """h of all limbs at y' (N,): (N, 5) mm."""
        stands = self.stands
        away = np.clip(y[:, None] - stands.offset[:, 1], -stands.link, stands.link)
        return np.sqrt((stands.link - away) * (stands.link + away))

    def limbs(self, at: Array) -> tuple[Array, Array]:
        stands = self.stands
        height = self.determinant.sign * self.heights(self.along(at[:, 0]))
        return at[:, 1:] - stands.offset[:, 0], -stands.offset[:, 2] - height

    def spread(self, at: Array, half: Array) -> Array:
        """x' moves all alike; h is monotonic but where y' passes w'_y, where it is the link."""
        stands = self.stands
        ends = (np.clip(at[:, 0] + s * half[:, 0], 0.0, np.pi) for s in (-1.0, 1.0))
        first, last = (self.along(turn) for turn in ends)
        here = self.heights(self.along(at[:, 0]))
        jump = np.maximum(*(np.abs(self.heights(y) - here) for y in (first, last)))
        top = (first[:, None] < stands.offset[:, 1]) & (last[:, None] > stands.offset[:, 1])
        jump = np.where(top, np.maximum(jump, stands.link - here), jump)
        return np.asarray(np.hypot(half[:, 1:], jump))

    def weight(self, at: Array) -> Array:
        """dy' = half sin t dt."""
        return np.asarray(self._span[1] * np.sin(at[:, 0]))

    def polynomial(self, at: Array) -> Array:
        """F in z'."""
        d = self.determinant
        return d.along_z(at[:, 1], self.along(at[:, 0])) / d.size ** np.arange(5)

    def place(self, at: Array, v: Array) -> Array:
        return np.stack([at[:, 1], self.along(at[:, 0]), v], axis=-1)

    def off(self, points: Array, label: NDArray[np.int16]) -> Array:
        """How far places (N, 3) are off the surfaces, see `solids.column_solids`."""
        stands, (limb, high) = self.stands, surface_of(label)
        held = np.maximum(limb, 0)
        x, y, z = (points[:, k] - stands.offset[held, k] for k in range(3))
        link = stands.link[held]
        height = np.sqrt(np.maximum((link - y) * (link + y), 0.0))
        length = np.hypot(x, z - self.determinant.sign[held] * height)
        middle, half = self._span
        beyond = half - np.abs(points[:, 1] - middle)
        bound = stands.stroke[held, high.astype(int)]
        return np.asarray(np.where(limb < 0, beyond, length - bound))
