"""How the platform of the 4-SPS + 1-SPR turns with its angles.

ω = α̇ z + β̇ y₁ + γ̇ x₂, the axes of R = R_z(α) R_y(β) R_x(γ); where β = ±90° the angles' rates are
not determined.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import CONSTRAINT_SLACK, transform, violation


def placement(design: FourSPSSPRDesign, poses: ArrayLike) -> Array:
    """(..., 4, 4) of poses (..., 6); NaN where they violate the constraint."""
    held = np.abs(violation(design, poses)) <= CONSTRAINT_SLACK
    return np.where(held[..., None, None], transform(poses), np.nan)


def angular_axes(poses: ArrayLike) -> Array:
    """E with ω = E (α̇, β̇, γ̇), (..., 3, 3): the columns are z, y₁ and x₂."""
    p = np.asarray(poses)
    alpha, beta = p[..., 3], p[..., 4]
    ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    e = np.zeros((*np.shape(alpha), 3, 3), dtype=ca.dtype)
    e[..., 2, 0] = 1.0
    e[..., 0, 1], e[..., 1, 1] = -sa, ca
    e[..., 0, 2], e[..., 1, 2], e[..., 2, 2] = ca * cb, sa * cb, -sb
    return e


def velocity_axes(poses: Array) -> Array:
    """(..., 6, 6), see `Mechanism.velocity_axes`."""
    axes = np.zeros((*poses.shape, 6), dtype=poses.dtype)
    axes[..., :3, :3] = np.eye(3)
    axes[..., 3:, 3:] = angular_axes(poses)
    return axes
