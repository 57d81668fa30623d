"""The limbs of a 3-RPS and a 3-SPR: each stays in its plane, between two joints of known places.

With ζ = x1 + i x2 of the reduced pose (`posing`), u = e^{iα_i} and q = |ζ|², the spherical joint i
stands, seen from the revolute one i, at

    p_i = 2 k Re(ζ² u) + k x0² − h  outwards and  z_i = v + 2 k x0 Im(ζ̄ u)  upwards,

and r_i² = p_i² + z_i², since the limb stays in its plane. Lengths mm.
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.tripods import study
from kinematics.mechanisms.tripods.design import (
    AZIMUTHS,
    LIMBS,
    RADIAL,
    TANGENT,
    TripodDesign,
    mode_sign,
)
from kinematics.mechanisms.tripods.posing import Reduced, quaternion, reduce_poses, transform
from kinematics.mechanisms.tripods.study import Values

_COS, _SIN = np.cos(AZIMUTHS), np.sin(AZIMUTHS)


def offsets(h: float, k: Values | float, reduced: Reduced) -> tuple[Values, Values]:
    """p_i outwards and z_i upwards from revolute joint i to spherical joint i, (..., 3) mm each."""
    x0, x1, x2, v = (np.asarray(part)[..., None] for part in reduced)
    outward = 2.0 * k * ((x1 * x1 - x2 * x2) * _COS - 2.0 * x1 * x2 * _SIN) + k * x0 * x0 - h
    upward = v + 2.0 * k * x0 * (x1 * _SIN - x2 * _COS)
    return outward, upward


def limb_lengths(design: TripodDesign, poses: Array, mode: str) -> Array:
    """r_i (..., 3), mm; NaN where no finite position has this altitude."""
    k = mode_sign(mode) * design.spherical_radius
    p, z = offsets(design.revolute_radius, k, reduce_poses(design, poses, mode))
    return np.hypot(p, z)


def joint_points(design: TripodDesign, poses: Array, mode: str) -> tuple[Array, Array]:
    """A_i and B_i in the base frame, (..., 3, 3) mm each."""
    b = placed(transform(design, poses, mode), design.platform_radius * RADIAL)
    return np.broadcast_to(design.base_radius * RADIAL, b.shape).copy(), b


def revolute_axes(design: TripodDesign, poses: Array, mode: str) -> Array:
    """s_i in the base frame, (..., 3, 3): at rest (3-RPS), or turned with the platform (3-SPR)."""
    if design.revolute_on_base:
        return np.broadcast_to(TANGENT, (*poses.shape[:-1], LIMBS, 3))
    return np.asarray(TANGENT @ study.rotation(quaternion(poses, mode)).swapaxes(-1, -2))


def placed(matrix: Array, points: Array) -> Array:
    """Points (N, 3) of a frame, seen from outside: (..., 4, 4) → (..., N, 3)."""
    turned: Array = points @ matrix[..., :3, :3].swapaxes(-1, -2)
    return turned + matrix[..., None, :3, 3]
