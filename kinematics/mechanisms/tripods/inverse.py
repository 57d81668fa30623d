"""Joints, margins and residuals of the 3-RPS and 3-SPR, in both operation modes.

r_i = |T + h2 R u_i − h1 u_i|, with T = (X, Y, Z) as the pose and the mode say. A limb always
closes, unless its pose has no finite position at all: a 3-SPR at a tilt of 90°.
"""

from __future__ import annotations

import numpy as np

from kinematics.answers.bounds import Bound, limb_bounds
from kinematics.arrays import Array
from kinematics.mechanisms.tripods.design import JOINT_SYMBOLS, TripodDesign
from kinematics.mechanisms.tripods.limbs import joint_points, revolute_axes

STROKE_SLACK = 1e-9
"""mm by which rounding may carry an actuator over its stroke end."""
LIMITS = limb_bounds(JOINT_SYMBOLS)


def margins(design: TripodDesign, joints: Array) -> Array:
    """How far lengths (..., 3) are from each of `LIMITS`, (..., 6) mm; −∞ without a position."""
    low, high = design.stroke
    room = np.stack([joints - low, np.where(np.isnan(joints), -np.inf, high - joints)], axis=-1)
    return room.reshape(*joints.shape[:-1], len(LIMITS))


def closure_residual(design: TripodDesign, poses: Array, mode: str, lengths: Array) -> Array:
    """(..., 3) mm: the larger of | |B_i − A_i| − r_i | and |(B_i − A_i)·s_i|; NaN: no position."""
    a, b = joint_points(design, poses, mode)
    along = b - a
    off = np.abs(np.linalg.norm(along, axis=-1) - lengths)
    axis = revolute_axes(design, poses, mode)
    return np.asarray(np.maximum(off, np.abs((along * axis).sum(axis=-1))))


def why_not(bound: Bound, amount: float) -> str:
    """Why a limb has no length at all."""
    if np.isfinite(amount):
        return ""
    return (
        f"limb {bound.limb} would have to be endless: at a tilt of 90° the altitude is no longer "
        "free, X and Y go to infinity"
    )
