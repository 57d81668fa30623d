"""Inverse displacement of the 4-SPS + 1-SPR: leg lengths, reasons and margins, for batches.

A leg is l_i = p + R b_i − A_i with R = R_z(α) R_y(β) R_x(γ) (Wang et al. 2017, eqs. 2-5; in the
printed matrix cλ is cγ). The SPR limb can only lie normal to its revolute axis n6:

    (A_5 − p)·(R n6) = b_5·n6,

so a pose (x, y, z, α, β, γ) has five free coordinates, see `constraint`. Poses that violate this
cannot be assembled: limb 5 has no length there. Lengths mm, angles rad.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.bounds import Bound, decimals, limb_bounds
from kinematics.answers.modes import Mode
from kinematics.arrays import Array, finite, frozen
from kinematics.mechanisms.four_sps_spr.design import JOINT_SYMBOLS, LIMBS, SPR, FourSPSSPRDesign
from kinematics.screws.spatial import homogeneous, rotation_x, rotation_y, rotation_z

POSE = 6
MODES = (Mode(),)
"""A leg of given ends has one length: there is a single working mode."""
STROKE_SLACK = 1e-9
"""mm by which rounding may carry a leg over its stroke end."""
CONSTRAINT_SLACK = 1e-6
"""mm by which A_5 may be off the plane of limb 5; a pose written with fewer digits is refused."""
SNAP = 1e-10
"""mm within which a length is the one that was wanted."""


# --- frames --------------------------------------------------------------------------------


def rotation(poses: ArrayLike) -> Array:
    """R of poses (..., 6), (..., 3, 3)."""
    p = np.asarray(poses, dtype=float)
    return np.asarray(rotation_z(p[..., 3]) @ rotation_y(p[..., 4]) @ rotation_x(p[..., 5]))


def transform(poses: ArrayLike) -> Array:
    """From platform to base coordinates: poses (..., 6) → (..., 4, 4)."""
    p = finite(poses, name="a pose", last=POSE)
    return homogeneous(rotation(p), p[..., :3])


def euler_angles(r: ArrayLike) -> Array:
    """(α, β, γ) of rotations (..., 3, 3), each in (−π, π], β in [−π/2, π/2].

    Where β = ±π/2 only α ∓ γ is determined; γ is 0 there.
    """
    m = np.asarray(r, dtype=float)
    level = np.hypot(m[..., 0, 0], m[..., 1, 0])
    upright = level < 1e-12
    beta = np.arctan2(-m[..., 2, 0], level)
    alpha = np.where(
        upright,
        np.arctan2(-m[..., 0, 1], m[..., 1, 1]),
        np.arctan2(m[..., 1, 0], m[..., 0, 0]),
    )
    gamma = np.where(upright, 0.0, np.arctan2(m[..., 2, 1], m[..., 2, 2]))
    return np.stack([alpha, beta, gamma], axis=-1)


# --- lengths -------------------------------------------------------------------------------


def platform_points(design: FourSPSSPRDesign, poses: ArrayLike) -> Array:
    """B_i in the base frame, (..., 5, 3) mm, of poses (..., 6)."""
    p = finite(poses, name="a pose", last=POSE)
    points: Array = p[..., None, :3] + design.platform @ rotation(p).swapaxes(-1, -2)
    return frozen(points)


def violation(design: FourSPSSPRDesign, poses: ArrayLike) -> Array:
    """How far A_5 is from the plane in which limb 5 moves, (...,) mm, signed; 0 where it closes."""
    return _closing(design, poses)[1]


def leg_lengths(design: FourSPSSPRDesign, poses: ArrayLike) -> Array:
    """l_i, (..., 5) mm, whether the constraint holds or not."""
    return frozen(_closing(design, poses)[0])


def _closing(design: FourSPSSPRDesign, poses: ArrayLike) -> tuple[Array, Array]:
    """`leg_lengths` and `violation`."""
    p = finite(poses, name="a pose", last=POSE)
    r, at = rotation(p), p[..., :3]
    legs = design.platform @ r.swapaxes(-1, -2) + (at[..., None, :] - design.base)
    apart = ((design.base[SPR] - at) * (r @ design.axis)).sum(axis=-1) - design.offset
    return np.sqrt((legs * legs).sum(axis=-1)), apart


LIMITS = (
    Bound(JOINT_SYMBOLS[SPR], "link", "constraint", limb=SPR + 1),
    *limb_bounds(JOINT_SYMBOLS),
)


def joints_of(design: FourSPSSPRDesign, poses: Array) -> Array:
    """l_i, (..., 5) mm, of poses (..., 6); that of limb 5 is NaN where its constraint fails."""
    lengths, apart = _closing(design, poses)
    lengths[np.abs(apart) > CONSTRAINT_SLACK, SPR] = np.nan
    return lengths


def margins(design: FourSPSSPRDesign, poses: Array, joints: Array) -> Array:
    """How far poses (..., 6) with lengths (..., 5) are from each of `LIMITS`, (..., 11) mm.

    The constraint has no inside: NaN where it holds, else how far it is from that, negative.
    """
    room = np.stack([joints - design.stroke[:, 0], design.stroke[:, 1] - joints], axis=-1)
    off = np.full(poses.shape[:-1], np.nan)
    broken = np.isnan(joints[..., SPR])
    if broken.any():
        off[broken] = -np.abs(violation(design, poses[broken]))
    return np.concatenate([off[..., None], room.reshape(*joints.shape[:-1], 2 * LIMBS)], axis=-1)


def closure_residual(design: FourSPSSPRDesign, poses: Array, joints: Array) -> Array:
    """(..., 6) mm: how far given lengths are from closing, then how far the constraint is."""
    exact, apart = _closing(design, poses)
    off = np.abs(joints - exact)
    return np.concatenate([off, (np.abs(apart) + 0.0 * off[..., SPR])[..., None]], axis=-1)


def why_not(amount: float) -> str:
    """Why limb 5 cannot close."""
    return (
        f"limb 5 cannot close: A₅ lies {amount:.{decimals(amount)}f} mm off the plane normal to "
        "its revolute axis; let one of the six coordinates follow from the constraint"
    )
