"""What a move of the 4-SPS + 1-SPR meets.

The position is brought back into the plane of the constraint along its normal.
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.facets.paths import PathsFacet
from kinematics.facets.segments import ROUNDING
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import rotation, violation
from kinematics.mechanisms.four_sps_spr.statics import legs, matrix
from kinematics.screws.wrenches import scale


class Paths(PathsFacet[FourSPSSPRDesign]):
    """Legs have no reach: all is smooth along a move."""

    @property
    def reach_limbs(self) -> tuple[int, ...]:
        return ()

    def consistent(self, poses: Array) -> Array:
        normal = rotation(poses) @ self.design.axis
        moved = poses.copy()
        moved[:, :3] += violation(self.design, poses)[:, None] * normal
        return moved

    def ranges(self, poses: Array, mode: str) -> Array:
        """l² − l_min² and l_max² − l² of each leg, mm²."""
        square = legs(self.design, poses).length ** 2
        low, high = self.design.stroke.T
        both = np.stack([square - low**2, high**2 - square], axis=-1)
        return both.reshape(len(poses), -1)

    def determinant(self, poses: Array, mode: str) -> tuple[Array, Array]:
        """l_1 … l_5 det G, moments by the characteristic length."""
        at = legs(self.design, poses)
        rows = np.nan_to_num(matrix(at)) / scale(self.design.length)
        lengths = at.length.prod(axis=-1)
        size = np.linalg.norm(rows, axis=-1).prod(axis=-1)
        return np.linalg.det(rows) * lengths, ROUNDING * size * lengths
