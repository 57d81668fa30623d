"""First and second order motion of the five-bar.

A θ̇ = B ṗ (Sosa-López et al. 2017, eqs. 20 to 22), see `statics`. Differentiated once more,
a_i θ̈_i = (P − B_i)·p̈ + r_1 θ̇_i² (P − B_i)·e(θ_i) + |ṗ − Ḃ_i|²: eqs. 26 to 28, whose g_2 in row 2
of eq. 27 is multiplied by θ̇_2. P is a hinge: it does not turn.
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_bar.design import LIMBS, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import joints_of
from kinematics.mechanisms.five_bar.statics import jacobians


def velocity_axes(poses: Array) -> Array:
    """(..., 6, 2), see `Mechanism.velocity_axes`."""
    axes = np.zeros((*poses.shape[:-1], 6, 2), dtype=poses.dtype)
    axes[..., 0, 0] = axes[..., 1, 1] = 1.0
    return axes


def bias(
    design: FiveBarDesign, placement: Array, mode: str, velocity: Array, rates: Array
) -> Array:
    """(..., 6), see `Mechanism.bias`: C of eq. 27 by the lengths of the distal links.

    Exact in serial singularities too, where the angles cannot be differentiated by P.
    """
    p = placement[..., :2, 3]
    q = joints_of(design, p, mode)
    _, b = jacobians(design, p, q)
    e = np.stack([np.cos(q), np.sin(q)], axis=-1)
    across = np.stack([-e[..., 1], e[..., 0]], axis=-1)
    relative = velocity[..., None, :2] - (design.proximal * rates)[..., None] * across
    along = design.proximal * rates**2 * (b * e).sum(axis=-1)
    answer = np.zeros((*along.shape[:-1], 6))
    answer[..., :LIMBS] = (along + (relative**2).sum(axis=-1)) / design.distal
    return answer
