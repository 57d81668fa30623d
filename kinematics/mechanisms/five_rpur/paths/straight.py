"""The straight way between two poses in one working mode, as smooth functions of its part s.

Along it (X, Y, Z) = C_i − A_i in the base frame turned by R_y(−θ), h = sqrt(l² − Y²), q = σ h and
p = Z − q of each limb; actuators have ρ² = X² + p². The determinant of the wrenches, with its
factors 1/(ρ l) left out, is that of the five rows (see `singular.determinant`)

    q X,  p Y,  p q,  p (c_y q − c_z Y),  q ((c_z − q) X − c_x p),      c = R_x(φ) s'.

Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import signs, wrap_angle
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.screws.spatial import rotation_x, rotation_y

ROUNDING = 1e-14
"""Part of the product of the rows' lengths below which the determinant is no more than rounding."""
_AT_REACH = 1e-10  # part of the size, and of the rows' product, that is nothing at |Y| = l
_TINY = 1e-5  # part of the machine's size: the step of differences


@dataclass(frozen=True, eq=False)
class Limbs:
    """The limbs at n poses; each (n, 5), mm. Where |Y| > l, h is 0."""

    x: Array
    y: Array
    z: Array
    h: Array


@dataclass(frozen=True, eq=False)
class Way:
    """A straight way, angles the shorter way round.

    Attributes:
        start: (5,) the pose at s = 0.
        change: (5,) from there to s = 1.
        sign: (5,) σ_i.
    """

    design: FiveRPURDesign
    start: Array
    change: Array
    sign: Array

    @classmethod
    def between(
        cls, design: FiveRPURDesign, start: Sequence[float], end: Sequence[float], mode: str
    ) -> Way:
        first = np.asarray(start, dtype=float)
        change = np.asarray(end, dtype=float) - first
        change[3:] = wrap_angle(change[3:])
        return cls(design, first, change, signs(mode))

    @property
    def length(self) -> float:
        """mm, angles times the characteristic length."""
        return float(np.linalg.norm(self.change * self.metric))

    @property
    def metric(self) -> Array:
        unit = self.design.length
        return np.array([1.0, 1.0, 1.0, unit, unit])

    @property
    def size(self) -> float:
        """A typical length of the machine, mm."""
        return float((self.design.link + self.design.stroke[:, 1]).max())

    def poses(self, s: Array) -> Array:
        """(n, 5) at s (n,)."""
        return np.asarray(self.start + s[:, None] * self.change)

    def pose(self, s: float) -> tuple[float, ...]:
        x, y, z, phi, theta = self.poses(np.array([s]))[0].tolist()
        phi, theta = wrap_angle([phi, theta]).tolist()
        return (x, y, z, phi, theta)

    def limbs(self, poses: Array) -> Limbs:
        design = self.design
        turned = np.einsum("nji,nj->ni", rotation_y(poses[:, 4]), poses[:, :3])
        relative = turned[:, None] - offset_points(design, poses[:, 3], poses[:, 4])
        x, y, z = (relative[..., k] for k in range(3))
        return Limbs(x, y, z, np.sqrt(np.maximum((design.link - y) * (design.link + y), 0.0)))

    def reach(self, s: Array) -> Array:
        """l_i − |Y_i| in two smooth parts, l − Y and l + Y: (n, 10), limb by limb."""
        y = self.limbs(self.poses(s)).y
        both = np.stack([self.design.link - y, self.design.link + y], axis=-1)
        return both.reshape(len(s), 2 * LIMBS)

    def strokes(self, s: Array) -> Array:
        """ρ² − ρ_min² and ρ_max² − ρ² of each limb, mm², (n, 10), limb by limb."""
        at = self.limbs(self.poses(s))
        square = at.x**2 + (at.z - self.sign * at.h) ** 2
        low, high = self.design.stroke.T
        both = np.stack([square - low**2, high**2 - square], axis=-1)
        return both.reshape(len(s), 2 * LIMBS)

    def determinant(self, poses: Array) -> tuple[Array, Array]:
        """The determinant (n,) at poses (n, 5) in powers of `size`, and its rounding error."""
        at, size = self.limbs(poses), self.size
        x, y, q = at.x / size, at.y / size, self.sign * at.h / size
        p = at.z / size - q
        tip = self.design.platform @ np.swapaxes(rotation_x(poses[:, 3]), -1, -2) / size
        cx, cy, cz = (tip[..., k] for k in range(3))
        rows = np.stack(
            [q * x, p * y, p * q, p * (cy * q - cz * y), q * ((cz - q) * x - cx * p)], axis=-1
        )
        noise = ROUNDING * np.linalg.norm(rows, axis=-1).prod(axis=-1)
        return np.asarray(np.linalg.det(rows)), np.asarray(noise)

    def determinant_vanishes(self, s: float) -> bool:
        """Whether all limbs close at s, but for rounding, and the wrenches are dependent there.

        For where |Y| = l, which a rounding of s changes by the square root of it.
        """
        at = np.array([s])
        room = self.reach(at).reshape(LIMBS, 2).min(axis=1)
        value, noise = self.determinant(self.poses(at))
        closes = bool((room >= -_AT_REACH * self.size).all())
        return closes and bool(abs(value[0]) <= _AT_REACH / ROUNDING * noise[0])

    def apart(self, pose: Sequence[float]) -> float:
        """About how far a pose is from a parallel singularity, mm: |F| / |∇F| over all five
        coordinates, angles times the characteristic length; 0 where F is rounding.
        """
        tiny = _TINY * self.size / self.metric
        shifts = np.concatenate([np.zeros((1, 5)), np.diag(tiny), -np.diag(tiny)])
        values, noise = self.determinant(np.asarray(pose) + shifts)
        slope = (values[1:6] - values[6:]) / (2.0 * _TINY * self.size)
        steep = float(np.linalg.norm(slope))
        if abs(values[0]) <= noise[0]:
            return 0.0
        return abs(float(values[0])) / steep if steep > 0.0 else float("inf")
