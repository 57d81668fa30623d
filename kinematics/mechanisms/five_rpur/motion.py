"""How the platform of the 5-RPUR turns: ω = φ̇ e2 + θ̇ e1, e2 = R_y(θ) x and e1 = y."""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array


def velocity_axes(poses: Array) -> Array:
    """(..., 6, 5), see `Mechanism.velocity_axes`."""
    theta = poses[..., 4]
    axes = np.zeros((*poses.shape[:-1], 6, 5), dtype=poses.dtype)
    axes[..., :3, :3] = np.eye(3)
    axes[..., 3, 3], axes[..., 5, 3] = np.cos(theta), -np.sin(theta)
    axes[..., 4, 4] = 1.0
    return axes
