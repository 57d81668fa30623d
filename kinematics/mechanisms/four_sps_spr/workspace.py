"""Where p of the 4-SPS + 1-SPR can be while two angles are held and the third follows: a solid.

At each place the constraint leaves the third angle θ two values or none. One of the two branches
is followed; they meet where the constraint's derivative by θ vanishes, the fold, which bounds the
solid as the ends of the strokes do. What there is is known exactly over every θ (`columns`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from kinematics.facets.solids import Resolution
from kinematics.mechanisms.four_sps_spr import home
from kinematics.mechanisms.four_sps_spr.columns import FollowingAngle
from kinematics.mechanisms.four_sps_spr.constraint import dependent_values
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.screws.spatial import wrap_angle
from kinematics.solids.measuring import measure
from kinematics.solids.refining import Fineness

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.column_solids import Quality
    from kinematics.solids.csg import BuiltSolid


@dataclass(frozen=True, slots=True)
class Request:
    """A solid: the angles (rad), which of them follows (3, 4, 5), and its branch.

    Attributes:
        angles: α, β, γ; what stands at ``index`` does not matter.
        index: among the pose's coordinates.
        side: +1 or −1; −side is the sign of ∂c/∂θ.
    """

    angles: tuple[float, float, float]
    index: int
    side: int


def request_at(design: FourSPSSPRDesign, pose: tuple[float, ...], index: int) -> Request:
    """The solid that `branch_at` is of."""
    side, _ = branch_at(design, pose, index)
    angles = [float(v) for v in pose[3:]]
    angles[index - 3] = 0.0
    a, b, c = angles
    return Request((a, b, c), index, side)


def branch_at(
    design: FourSPSSPRDesign, pose: tuple[float, ...], index: int
) -> tuple[int, tuple[float, ...]]:
    """The branch on which the angle is nearest to the pose's, as inverse kinematics takes it.

    Args:
        pose: (6,) mm and rad; NaN at ``index`` is zero. Where no place is given, or none that the
            angles allow, it is the home posture's.
        index: of the angle that follows: 3, 4 or 5.

    Returns:
        `Request.side`, and a pose (6,) on the branch, which tells it from the other one.
    """
    start = home.home(design).pose
    near = 0.0 if np.isnan(pose[index]) else pose[index]
    tried = [(pose[:3], pose[3:], near), (start[:3], pose[3:], near)]
    # With these angles neither may be possible: the home posture's branch with its own.
    for place, angles, wanted in (*tried, (start[:3], start[3:], start[index])):
        if not np.isfinite(place).all():
            continue
        found = [float(v) for v in (*place, *angles)]
        both = dependent_values(design, found, index)
        if np.isfinite(both).all():
            k = int(np.abs(wrap_angle(both - wanted)).argmin())
            found[index] = float(both[k])
            return 2 * k - 1, tuple(found)
    return 1, start


def _quality(resolution: Resolution) -> Quality:
    from kinematics.solids.column_solids import Quality

    if resolution == "preview":
        return Quality(Fineness((8, 24), 1.5e-2, 600), exact=5e-3, promised=0.1)
    if resolution == "normal":
        return Quality(Fineness((8, 32), 6e-4, 6000), exact=2e-4, promised=1e-3)
    return Quality(Fineness((12, 48), 1e-4, 24000), exact=4e-5, promised=2e-4)


def build(design: FourSPSSPRDesign, request: Request, resolution: Resolution) -> BuiltSolid:
    """The solid in the base frame; its error is the distance from the exact volume."""
    from kinematics.solids.column_solids import shaped, whole

    return whole(shaped(_columns(design, request), _quality(resolution)))


@lru_cache(maxsize=64)
def exact_volume(
    design: FourSPSSPRDesign, request: Request, relative: float = 1e-5
) -> tuple[float, float]:
    """The volume and an estimate from above of its error, mm³."""
    found = measure(_columns(design, request), relative)
    return found.volume, found.error


def _columns(design: FourSPSSPRDesign, request: Request) -> FollowingAngle:
    return FollowingAngle(design, request.angles, request.index, request.side)
