"""Inverse displacement of the 4-SPS + 1-SPR: leg lengths, reasons and margins, for batches.

A leg is l_i = p + R b_i − A_i with R = R_z(α) R_y(β) R_x(γ) (Wang et al. 2017, eqs. 2-5; in the
printed matrix cλ is cγ). The SPR limb can only lie normal to its revolute axis n6:

    (A_5 − p)·(R n6) = b_5·n6,

so a pose (x, y, z, α, β, γ) has five free coordinates, see `constraint`. Poses that violate this
cannot be assembled: limb 5 has no length there. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.solutions import Bound, InverseSolutions, Margin, Posture, Reason
from kinematics.arrays import Array, finite, frozen
from kinematics.errors import InputError
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, SUBSCRIPTS, FourSPSSPRDesign
from kinematics.screws.spatial import homogeneous, rotation_x, rotation_y, rotation_z

POSE = 6
MODES = ("",)
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
    turned: Array = rotation_z(p[..., 3]) @ rotation_y(p[..., 4]) @ rotation_x(p[..., 5])
    return turned


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


def wrap_angle(angle: ArrayLike) -> Array:
    """Angles in (−π, π]; those already there are untouched."""
    a = np.asarray(angle, dtype=float)
    inside_range = (a > -np.pi) & (a <= np.pi)
    return np.where(inside_range, a, np.pi - np.mod(np.pi - a, 2 * np.pi))


# --- lengths -------------------------------------------------------------------------------


def platform_points(design: FourSPSSPRDesign, poses: ArrayLike) -> Array:
    """B_i in the base frame, (..., 5, 3) mm, of poses (..., 6)."""
    p = finite(poses, name="a pose", last=POSE)
    points: Array = p[..., None, :3] + design.platform @ rotation(p).swapaxes(-1, -2)
    return frozen(points)


def violation(design: FourSPSSPRDesign, poses: ArrayLike) -> Array:
    """How far A_5 is from the plane in which limb 5 moves, (...,) mm, signed; 0 where it closes."""
    p = finite(poses, name="a pose", last=POSE)
    normal = rotation(p) @ design.axis
    apart: Array = ((design.base[SPR] - p[..., :3]) * normal).sum(axis=-1) - design.offset
    return apart


def leg_lengths(design: FourSPSSPRDesign, poses: ArrayLike) -> Array:
    """l_i, (..., 5) mm, whether the constraint holds or not."""
    legs = platform_points(design, poses) - design.base
    lengths: Array = np.sqrt((legs * legs).sum(axis=-1))
    return frozen(lengths)


def inverse(design: FourSPSSPRDesign, poses: ArrayLike) -> InverseSolutions:
    """The single working mode of poses (..., 6), mm and rad.

    Raises:
        InputError: not finite numbers, or not six a pose.
    """
    lengths = leg_lengths(design, poses).copy()
    apart = np.abs(violation(design, poses))
    held = apart <= CONSTRAINT_SLACK
    lengths[~held, SPR] = np.nan
    low, high = design.stroke[:, 0] - STROKE_SLACK, design.stroke[:, 1] + STROKE_SLACK
    within = held & ((lengths >= low) & (lengths <= high)).all(axis=-1)
    return InverseSolutions(
        modes=MODES,
        joints=frozen(lengths[..., None, :]),
        within_stroke=frozen(np.asarray(within)[..., None]),
        residual=frozen(np.asarray(np.where(held, apart, np.nan))),
    )


def inside(design: FourSPSSPRDesign, poses: ArrayLike) -> NDArray[np.bool_]:
    """Whether poses (..., 6) can be held within all strokes, (...,)."""
    return frozen(inverse(design, poses).within_stroke[..., 0].copy())


# --- one posture ---------------------------------------------------------------------------


def posture(
    design: FourSPSSPRDesign,
    pose: Sequence[float] | ArrayLike,
    *,
    known: ArrayLike | None = None,
) -> Posture:
    """The posture at one pose, with reasons where it cannot be held.

    Args:
        known: lengths (5,) mm for which the pose was solved; where the pose gives them back but
            for rounding (`SNAP`), the posture has exactly these, and its residual is theirs.

    Raises:
        InputError: the pose is not six finite numbers.
    """
    p = finite(pose, name="a pose", last=POSE)
    if p.shape != (POSE,):
        raise InputError("a posture takes one pose of 6 numbers (x, y, z, α, β, γ)")
    exact = leg_lengths(design, p)
    apart = float(violation(design, p))
    lengths = exact.copy()
    if known is not None:
        wanted = finite(known, name="the known lengths", last=LIMBS)
        lengths = np.where(np.abs(lengths - wanted) <= SNAP, wanted, lengths)
    residual = max(float(np.abs(lengths - exact).max()), abs(apart))
    reasons: list[Reason] = []
    margins: list[Margin] = []
    if abs(apart) > CONSTRAINT_SLACK:
        lengths[SPR] = np.nan
        residual = float(np.abs(lengths - exact)[:SPR].max())
        reasons.append(_constraint_reason(abs(apart)))
    for i, (limb, length) in enumerate(zip(design.limbs, lengths.tolist(), strict=True)):
        if not np.isfinite(length):
            continue
        low, high = limb.stroke
        margins.append(Margin(i + 1, "rho_min", length - low))
        margins.append(Margin(i + 1, "rho_max", high - length))
        if length < low - STROKE_SLACK:
            reasons.append(_stroke_reason(i, "rho_min", length, low))
        elif length > high + STROKE_SLACK:
            reasons.append(_stroke_reason(i, "rho_max", length, high))
    return Posture(
        pose=tuple(p.tolist()),
        mode="",
        joints=tuple(lengths.tolist()),
        reasons=tuple(reasons),
        residual=residual,
        margins=tuple(margins),
    )


def _constraint_reason(amount: float) -> Reason:
    text = (
        f"limb 5 cannot close: A₅ lies {amount:.{digits(amount)}f} mm off the plane normal to its "
        "revolute axis; let one of the six coordinates follow from the constraint"
    )
    return Reason(SPR + 1, "link", amount, text)


def _stroke_reason(i: int, bound: Bound, length: float, end: float) -> Reason:
    amount = abs(length - end)
    places = digits(amount)
    word, name = ("short", "l min") if bound == "rho_min" else ("long", "l max")
    text = (
        f"limb {i + 1} is {amount:.{places}f} mm too {word} "
        f"(l{SUBSCRIPTS[i]} = {length:.{places}f} mm, {name} = {end:g} mm)"
    )
    return Reason(i + 1, bound, amount, text)


def digits(amount: float) -> int:
    """Decimals that show an amount: one, and more for less than 0.1 mm."""
    return 1 if amount >= 0.1 or amount == 0.0 else min(12, 1 - int(np.floor(np.log10(amount))))
