"""Inverse kinematics of the five-bar: driven angles, joint points and reasons, for batches.

Limb i closes where ρ_i = |P − A_i| lies between |r_1 − r_2| and r_1 + r_2. With φ_i the direction
of P from A_i, θ_i = φ_i ± ψ_i, where r_2² = r_1² + ρ_i² − 2 r_1 ρ_i cos ψ_i: the two roots of
Sosa-López et al. 2017, eq. 7, in the same order, the sign of the working mode being that of its
root. Sign +: the elbow B_i lies to the left of the way from A_i to P. (In the paper's a_2 and c_2,
x + r_3 is a misprint for x − r_3.)

Poses are (x, y), mm; angles rad, in (−π, π] or, where a joint has a range, nearest to its middle.
Where P stands on A_i (r_1 = r_2), θ_i is free, and φ_i is taken as 0.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.bounds import Bound, decimals, limb_bounds
from kinematics.answers.modes import one_of, working_modes
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.five_bar.design import LIMBS, SUBSCRIPTS, FiveBarDesign
from kinematics.screws.spatial import homogeneous

MODES = working_modes(LIMBS)
"""The four working modes "++", "+-", "-+", "--"."""

REACH_SLACK = 1e-13
"""Part of r_1 + r_2 by which rounding may carry P over the end of a limb's reach."""
RANGE_SLACK = 1e-9
"""rad by which rounding may carry an angle over the end of its range."""


def limb_angles(design: FiveBarDesign, poses: ArrayLike) -> Array:
    """θ_i with both signs of every limb, (..., 2, 2) rad, sign + first; NaN where none closes."""
    p = np.asarray(poses, dtype=float)
    away = p[..., None, :] - design.base
    rho = np.hypot(away[..., 0], away[..., 1])
    r1, r2 = design.proximal, design.distal
    # tan²(ψ/2) as a quotient of products keeps its digits where a limb is stretched or folded.
    over = (r2 - rho + r1) * (r2 + rho - r1)
    under = (rho + r1 + r2) * (rho + r1 - r2)
    slack = REACH_SLACK * (r1 + r2)
    open_ = (rho > r1 + r2 + slack) | (rho < np.abs(r1 - r2) - slack)
    half = np.arctan2(np.sqrt(np.maximum(over, 0.0)), np.sqrt(np.maximum(under, 0.0)))
    half = np.where(open_, np.nan, half)
    phi = np.arctan2(away[..., 1], away[..., 0])
    angles = phi[..., None] + 2.0 * half[..., None] * np.array([1.0, -1.0])
    return normal_angles(design, angles.swapaxes(-1, -2)).swapaxes(-1, -2)


def joints_of(design: FiveBarDesign, poses: ArrayLike, mode: str) -> Array:
    """θ of one working mode, (..., 2) rad; NaN where a limb cannot close."""
    one_of(mode, MODES)
    return _pick(limb_angles(design, finite(poses, name="a pose", last=2)), mode)


def joints_in(design: FiveBarDesign, poses: Array, modes: Sequence[str]) -> Array:
    """θ of several working modes, (..., M, 2) rad."""
    both = limb_angles(design, poses)
    return np.stack([_pick(both, mode) for mode in modes], axis=-2)


def normal_angles(design: FiveBarDesign, angles: ArrayLike) -> Array:
    """Angles (..., 2) turned by whole turns: into (−π, π], or nearest to the middle of a range."""
    a = np.asarray(angles, dtype=float)
    low, high = design.joint_range.T
    middle = np.where(np.isfinite(low), 0.5 * (low + np.where(np.isfinite(high), high, 0.0)), 0.0)
    with np.errstate(invalid="ignore"):
        turns = np.ceil((a - middle - np.pi) / (2 * np.pi))
    return np.where(turns == 0.0, a, a - 2 * np.pi * turns)


def in_range(design: FiveBarDesign, joints: ArrayLike) -> NDArray[np.bool_]:
    """(..., 2): which joints close and lie within their range."""
    q = np.asarray(joints, dtype=float)
    low, high = design.joint_range.T
    with np.errstate(invalid="ignore"):
        answer: NDArray[np.bool_] = (q >= low - RANGE_SLACK) & (q <= high + RANGE_SLACK)
    return answer


def elbows(design: FiveBarDesign, joints: ArrayLike) -> Array:
    """B_i (..., 2, 2) mm from angles (..., 2) rad (eq. 2)."""
    q = np.asarray(joints, dtype=float)
    e = np.stack([np.cos(q), np.sin(q)], axis=-1)
    return np.asarray(design.base + design.proximal[:, None] * e)


def mode_of(design: FiveBarDesign, poses: ArrayLike, joints: ArrayLike) -> list[str]:
    """The working modes of configurations (N, 2), (N, 2); + where a limb is stretched or folded."""
    p = np.asarray(poses, dtype=float).reshape(-1, 2)
    away = p[:, None, :] - design.base
    arm = elbows(design, np.asarray(joints, dtype=float).reshape(-1, 2)) - design.base
    left = away[..., 0] * arm[..., 1] - away[..., 1] * arm[..., 0]
    slack = -1e-12 * design.proximal * (design.proximal + design.distal)
    return ["".join("+" if one else "-" for one in row) for row in left >= slack]


# --- margins, residuals --------------------------------------------------------------------

LIMITS = limb_bounds(
    [f"θ{mark}" for mark in SUBSCRIPTS], "rad", [f"r{mark}" for mark in SUBSCRIPTS], "reach"
)


def margins(design: FiveBarDesign, poses: Array, joints: Array) -> Array:
    """How far poses (..., 2) with angles (..., 2) are from each of `LIMITS`, (..., 6)."""
    away = _distance(poses, design.base)
    longest = design.proximal + design.distal
    shortest = np.abs(design.proximal - design.distal)
    near = np.where(shortest > 0.0, away - shortest, np.inf)
    low, high = design.joint_range.T
    room = (np.minimum(longest - away, near), joints - low, high - joints)
    return np.stack(room, axis=-1).reshape(*joints.shape[:-1], len(LIMITS))


def closure_residual(design: FiveBarDesign, poses: Array, joints: Array) -> Array:
    """How far each distal link is from its length with given angles, (..., 2) mm."""
    return np.asarray(np.abs(_distance(poses, elbows(design, joints)) - design.distal))


def _distance(poses: Array, points: Array) -> Array:
    """From P to points (..., 2, 2), (..., 2) mm."""
    away = poses[..., None, :] - points
    return np.hypot(away[..., 0], away[..., 1])


def why_not(design: FiveBarDesign, bound: Bound, pose: Array, amount: float) -> str:
    """Why a limb cannot close."""
    i = (bound.limb or 1) - 1
    rho = float(np.hypot(*(pose - design.base[i])))
    longest = float(design.proximal[i] + design.distal[i])
    far, digits = rho > longest, decimals(amount)
    word = "beyond the reach of" if far else "too near the base of"
    end = abs(float(design.proximal[i] - design.distal[i]))
    told = f"r₁ + r₂ = {longest:g} mm" if far else f"|r₁ − r₂| = {end:g} mm"
    return (
        f"P lies {amount:.{digits}f} mm {word} limb {i + 1} "
        f"(|A{SUBSCRIPTS[i]}P| = {rho:.{digits}f} mm, {told})"
    )


def transform(poses: ArrayLike) -> Array:
    """From coordinates about P to base coordinates, (..., 2) → (..., 4, 4).

    The linkage moves in the plane z = 0 of the base frame, whose x and y are the paper's. P is a
    hinge, no body: the frame at P keeps the base's directions.
    """
    p = finite(poses, name="a pose", last=2)
    origin = np.concatenate([p, np.zeros((*p.shape[:-1], 1))], axis=-1)
    return homogeneous(np.eye(3), origin)


def pose_from_transform(matrix: ArrayLike) -> tuple[float, float]:
    """The pose whose P is nearest to the origin of a frame (4, 4).

    Raises:
        InputError: not a 4x4 matrix of finite numbers.
    """
    m = finite(matrix, name="a transform", last=4)
    if m.shape != (4, 4):
        raise InputError("a transform must be a 4x4 matrix")
    return float(m[0, 3]), float(m[1, 3])


def _pick(both: Array, mode: str) -> Array:
    """The angles of a mode (..., 2) out of those with both signs (..., 2, 2)."""
    return np.stack([both[..., i, int(sign == "-")] for i, sign in enumerate(mode)], axis=-1)
