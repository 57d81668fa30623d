"""What a move of the 4-SPS + 1-SPR meets.

The position is brought back into the plane of the constraint along its normal.
"""

from __future__ import annotations

from kinematics.arrays import Array
from kinematics.facets.paths import PathsFacet
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import rotation, violation


class Paths(PathsFacet[FourSPSSPRDesign]):
    """Legs have no reach: all is smooth along a move."""

    reach_limbs = ()

    def consistent(self, poses: Array) -> Array:
        normal = rotation(poses) @ self.design.axis
        moved = poses.copy()
        moved[:, :3] += violation(self.design, poses)[:, None] * normal
        return moved
