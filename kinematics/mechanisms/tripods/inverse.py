"""Inverse kinematics of the 3-RPS and 3-SPR: limb lengths, postures, reasons; both modes.

r_i = |T + h2 R u_i − h1 u_i|, with T = (X, Y, Z) as the pose and the mode say. A limb always
closes, unless its pose has no finite position at all: a 3-SPR at a tilt of 90°.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.solutions import Bound, InverseSolutions, Margin, Posture, Reason
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import LIMBS, MODES, SUBSCRIPTS, TripodDesign, mode_sign

STROKE_SLACK = 1e-9
"""mm by which rounding may carry an actuator over its stroke end."""
SNAP = 1e-9
"""mm within which a length is the one that was wanted."""


def inverse(design: TripodDesign, poses: ArrayLike) -> InverseSolutions:
    """Both operation modes, in the order of `MODES`, of poses (..., 3) in mm and rad.

    Raises:
        InputError: not finite numbers, or not three a pose.
    """
    p = posing.read_poses(poses)
    joints = np.stack([posing.limb_lengths(design, p, mode) for mode in MODES], axis=-2)
    low, high = design.stroke
    able = (joints >= low - STROKE_SLACK) & (joints <= high + STROKE_SLACK)
    within = np.asarray(able.all(axis=-1))
    miss = np.stack([_residual(design, p, mode, joints[..., n, :]) for n, mode in enumerate(MODES)])
    with np.errstate(invalid="ignore"):
        residual = np.fmax.reduce(miss.max(axis=-1), axis=0)
    for array in (joints, within, residual):
        array.setflags(write=False)
    return InverseSolutions(MODES, joints, within, residual)


def inside(design: TripodDesign, poses: ArrayLike, modes: Sequence[str] | None = None) -> Array:
    """(...) whether poses can be held within all strokes in one of ``modes`` (None: of both)."""
    found = inverse(design, poses)
    chosen = [MODES.index(mode) for mode in (MODES if modes is None else modes)]
    return np.asarray(found.within_stroke[..., chosen].any(axis=-1))


def posture(
    design: TripodDesign,
    pose: Sequence[float] | ArrayLike,
    mode: str,
    *,
    known: ArrayLike | None = None,
) -> Posture:
    """The posture at one pose in one operation mode, with reasons where it cannot be held.

    Args:
        known: lengths (3,) mm for which the pose was solved; where the pose gives them back but
            for rounding (`SNAP`), the posture has exactly these.

    Raises:
        InputError: the pose is not three finite numbers, or there is no such mode.
    """
    p = posing.read_poses(pose)
    if p.shape != (posing.POSE,):
        raise InputError("a posture takes one pose of 3 numbers (z, tilt, azimuth)")
    mode_sign(mode)
    lengths = posing.limb_lengths(design, p, mode)
    if known is not None:
        wanted = finite(known, name="the known lengths", last=LIMBS)
        lengths = np.where(np.abs(lengths - wanted) <= SNAP, wanted, lengths)
    values = tuple(float(v) for v in p)
    if not np.isfinite(lengths).all():
        return _nowhere(values, mode)
    residual = _residual(design, p, mode, lengths)
    reasons: list[Reason] = []
    margins: list[Margin] = []
    low, high = design.stroke
    for i, r in enumerate(lengths.tolist()):
        margins.append(Margin(i + 1, "rho_min", r - low))
        margins.append(Margin(i + 1, "rho_max", high - r))
        if r < low - STROKE_SLACK:
            reasons.append(_reason(i, "rho_min", r, low))
        elif r > high + STROKE_SLACK:
            reasons.append(_reason(i, "rho_max", r, high))
    return Posture(
        values,
        mode,
        tuple(lengths.tolist()),
        tuple(reasons),
        float(residual.max()),
        tuple(margins),
    )


def _nowhere(pose: tuple[float, ...], mode: str) -> Posture:
    nan = float("nan")
    reasons = tuple(
        Reason(
            i + 1,
            "rho_max",
            float("inf"),
            f"limb {i + 1} would have to be endless: at a tilt of 90° the altitude is no longer "
            "free, X and Y go to infinity",
        )
        for i in range(LIMBS)
    )
    margins = tuple(Margin(i + 1, "rho_max", -float("inf")) for i in range(LIMBS))
    return Posture(pose, mode, (nan,) * LIMBS, reasons, nan, margins)


def _reason(i: int, bound: Bound, r: float, end: float) -> Reason:
    amount = abs(r - end)
    digits = 1 if amount >= 0.1 else min(12, 1 - int(np.floor(np.log10(amount))))
    word, name = ("short", "ρ min") if bound == "rho_min" else ("long", "ρ max")
    text = (
        f"limb {i + 1} is {amount:.{digits}f} mm too {word} "
        f"(ρ{SUBSCRIPTS[i]} = {r:.{digits}f} mm, {name} = {end:g} mm)"
    )
    return Reason(i + 1, bound, amount, text)


def _residual(design: TripodDesign, poses: Array, mode: str, lengths: Array) -> Array:
    """(..., 3) mm: the larger of | |B_i − A_i| − r_i | and |(B_i − A_i)·s_i|; NaN: no position."""
    a, b = posing.joint_points(design, poses, mode)
    along = b - a
    off = np.abs(np.linalg.norm(along, axis=-1) - lengths)
    axis = posing.revolute_axes(design, poses, mode)
    return np.asarray(np.maximum(off, np.abs((along * axis).sum(axis=-1))))
