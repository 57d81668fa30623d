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
from kinematics.solids.columns import measure
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
    """The solid that a pose lies in, or the branch with the angle nearest to the pose's.

    ``pose``: (6,) mm and rad; NaN at ``index`` is zero, as for inverse kinematics; where no place
    is given, or none that the angles allow, the home posture's.
    """
    side, _, _ = _branch(design, pose, index)
    angles = [float(v) for v in pose[3:]]
    angles[index - 3] = 0.0
    a, b, c = angles
    return Request((a, b, c), index, side)


def branch_place(
    design: FourSPSSPRDesign, pose: tuple[float, ...], index: int
) -> tuple[float, ...]:
    """A pose (6,) on the branch of `request_at`, which tells it from the other one."""
    _, place, angle = _branch(design, pose, index)
    values = [*place, *pose[3:]]
    values[index] = angle
    return tuple(float(v) for v in values)


def _branch(
    design: FourSPSSPRDesign, pose: tuple[float, ...], index: int
) -> tuple[int, tuple[float, ...], float]:
    """The branch, a place where it is told, and the angle there (rad)."""
    start = home.home(design).pose
    values = np.array(pose, dtype=float)
    near = 0.0 if np.isnan(values[index]) else float(values[index])
    places = [start[:3]] if not np.isfinite(values[:3]).all() else [tuple(values[:3]), start[:3]]
    for place in places:
        both = dependent_values(design, (*place, *values[3:]), index)
        if np.isfinite(both).all():
            away = np.abs(wrap_angle(both - near))
            k = 0 if away[0] <= away[1] else 1
            return 2 * k - 1, tuple(place), float(both[k])
    # With these angles neither is possible: the branch of the home posture with its own.
    both = np.nan_to_num(dependent_values(design, start, index))
    k = int(np.abs(wrap_angle(both - start[index])).argmin())
    return 2 * k - 1, tuple(start[:3]), float(both[k])


def _quality(resolution: Resolution) -> Quality:
    from kinematics.solids.column_solids import Quality

    if resolution == "preview":
        return Quality(Fineness((8, 24), 2e-2, 500), exact=1e-2, promised=0.1)
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
