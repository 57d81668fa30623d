"""How the platform of a 3-RPS or 3-SPR moves with Z, the tilt θ and the azimuth φ.

It turns with ω = θ̇ n + φ̇ (e_z − e), n = (cos φ, sin φ, 0) the axis of tilt and e = R e_z the
platform's normal, in both operation modes. Its centre moves as the parasitic motions
X(Z, θ, φ), Y(Z, θ, φ) say.
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.tripods.design import mode_sign
from kinematics.mechanisms.tripods.posing import LEVEL, Triangles


def velocity_axes(design: Triangles, poses: Array, mode: str) -> Array:
    """(..., 6, 3), see `Mechanism.velocity_axes`; NaN where no finite position has the altitude."""
    z, tilt, azimuth = (poses[..., n] for n in range(3))
    c, s, versed = np.cos(tilt), np.sin(tilt), np.sin(0.5 * tilt) ** 2
    zero = np.zeros_like(z)

    def around(n: int) -> Array:
        return np.stack([np.cos(n * azimuth), np.sin(n * azimuth)])

    def turned(n: int) -> Array:
        return np.stack([-np.sin(n * azimuth), np.cos(n * azimuth)])

    if design.revolute_on_base:  # (X, Y) = k sin² θ/2 (cos 2φ, −sin 2φ)
        k = mode_sign(mode) * design.spherical_radius
        lifted = np.stack([zero, zero])
        tilted = 0.5 * k * s * around(-2)
        swung = -2.0 * k * versed * turned(-2)
    else:  # (X, Y) cos θ = h1 (s⁴ (cos 4φ, sin 4φ) − s² c² (cos 2φ, −sin 2φ)) + Z sin θ (…)
        h = design.base_radius
        level = np.where(np.abs(c.real) < LEVEL, np.nan, c)
        lifted = -s * turned(1)
        place = h * (versed**2 * around(4) - 0.25 * s * s * around(-2)) + z * lifted
        tilted = h * s * (versed * around(4) - 0.5 * c * around(-2)) - z * c * turned(1)
        tilted = (tilted + place * s / level) / level
        swung = h * (4.0 * versed**2 * turned(4) + 0.5 * s * s * turned(-2)) + z * s * around(1)
        lifted, swung = lifted / level, swung / level
    axes = np.zeros((*poses.shape, 6), dtype=poses.dtype)
    for n, velocity in enumerate((lifted, tilted, swung)):
        axes[..., n, 0], axes[..., n, 1] = velocity
    axes[..., 0, 2] = 1.0
    axes[..., 1, 3], axes[..., 1, 4] = around(1)
    axes[..., 2, 3], axes[..., 2, 4] = s * turned(1)
    axes[..., 2, 5] = 2.0 * versed
    return axes.swapaxes(-1, -2)
