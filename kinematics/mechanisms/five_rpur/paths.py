"""What a move of the 5-RPUR meets.

With (X, Y, Z) = C_i − A_i in the base frame turned by R_y(−θ), q = σ sqrt(l² − Y²), p = Z − q and
c = R_x(φ) s' of each limb, the determinant of the wrenches, without its factors 1/(ρ l), is that of
the five rows (see `singularities.determinant`)

    q X,  p Y,  p q,  p (c_y q − c_z Y),  q ((c_z − q) X − c_x p).
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.facets.paths import PathsFacet
from kinematics.facets.segments import ROUNDING
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import limb_vectors, signs
from kinematics.screws.spatial import rotation_x


class Paths(PathsFacet[FiveRPURDesign]):
    """Along a move all is smooth but where |Y| = l."""

    gap = 0.01
    at_reach = "its link along e₁"

    def determinant(self, poses: Array, mode: str) -> tuple[Array, Array]:
        """In powers of the machine's size; q is 0 beyond the reach."""
        size = float((self.design.link + self.design.stroke[:, 1]).max())
        x, y, z = (part.T / size for part in limb_vectors(self.design, poses))
        link = self.design.link / size
        q = signs(mode, self.design) * np.sqrt(np.maximum((link - y) * (link + y), 0.0))
        p = z - q
        tip = self.design.platform @ np.swapaxes(rotation_x(poses[:, 3]), -1, -2) / size
        cx, cy, cz = np.moveaxis(tip, -1, 0)
        rows = np.stack(
            [q * x, p * y, p * q, p * (cy * q - cz * y), q * ((cz - q) * x - cx * p)], axis=-1
        )
        noise = ROUNDING * np.linalg.norm(rows, axis=-1).prod(axis=-1)
        return np.linalg.det(rows), np.asarray(noise)
