"""What a move of the 5-RPUR meets, in the limbs' own smooth functions.

(X, Y, Z) = C_i − A_i in the base frame turned by R_y(−θ), h = sqrt(l² − Y²), q = σ h and p = Z − q
of each limb; actuators have ρ² = X² + p². The determinant of the wrenches, with its factors 1/(ρ l)
left out, is that of the five rows (see `singularities.determinant`)

    q X,  p Y,  p q,  p (c_y q − c_z Y),  q ((c_z − q) X − c_x p),      c = R_x(φ) s'.

Where |Y| > l, h is 0.
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.facets.paths import PathsFacet
from kinematics.facets.segments import ROUNDING
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import signs
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.screws.spatial import rotation_x, rotation_y


class Paths(PathsFacet[FiveRPURDesign]):
    """Along a move all is smooth but where |Y| = l."""

    gap = 0.01
    at_reach = "its link along e₁"

    @property
    def reach_limbs(self) -> tuple[int, ...]:
        return tuple(np.repeat(np.arange(1, LIMBS + 1), 2).tolist())

    def reach(self, poses: Array, mode: str) -> Array:
        """l − |Y| in two smooth parts, l − Y and l + Y, both by l."""
        part = self._limbs(poses)[1] / self.design.link
        return np.stack([1.0 - part, 1.0 + part], axis=-1).reshape(len(poses), 2 * LIMBS)

    def ranges(self, poses: Array, mode: str) -> Array:
        """ρ² − ρ_min² and ρ_max² − ρ² of each limb, mm²."""
        x, _, z, h = self._limbs(poses)
        square = x**2 + (z - signs(mode, self.design) * h) ** 2
        low, high = self.design.stroke.T
        both = np.stack([square - low**2, high**2 - square], axis=-1)
        return both.reshape(len(poses), 2 * LIMBS)

    def determinant(self, poses: Array, mode: str) -> tuple[Array, Array]:
        """In powers of the machine's size."""
        size = float((self.design.link + self.design.stroke[:, 1]).max())
        x, y, z, h = (part / size for part in self._limbs(poses))
        q = signs(mode, self.design) * h
        p = z - q
        tip = self.design.platform @ np.swapaxes(rotation_x(poses[:, 3]), -1, -2) / size
        cx, cy, cz = (tip[..., k] for k in range(3))
        rows = np.stack(
            [q * x, p * y, p * q, p * (cy * q - cz * y), q * ((cz - q) * x - cx * p)], axis=-1
        )
        noise = ROUNDING * np.linalg.norm(rows, axis=-1).prod(axis=-1)
        return np.asarray(np.linalg.det(rows)), np.asarray(noise)

    def _limbs(self, poses: Array) -> tuple[Array, Array, Array, Array]:
        """X, Y, Z and h, (n, 5) mm each."""
        turned = np.einsum("nji,nj->ni", rotation_y(poses[:, 4]), poses[:, :3])
        relative = turned[:, None] - offset_points(self.design, poses[:, 3], poses[:, 4])
        x, y, z = (relative[..., k] for k in range(3))
        link = self.design.link
        return x, y, z, np.sqrt(np.maximum((link - y) * (link + y), 0.0))
