"""Velocity and acceleration of the 4-SPS + 1-SPR, both ways.

With G of `wrenches` and V = (v; ω) of the platform at p:

    G V = (l̇_1 … l̇_5, 0),    l̈_i = G_i A + Vᵀ H_i V,    0 = G_6 A + Vᵀ H_6 V

(Wang et al. 2017, eqs. 10, 13 and 14), A = (a; ε). In H_i the lower right block of the first matrix
is −r̂_i² (printed without its sign); H_6 is as printed. Angles and ω are related by
ω = α̇ z + β̇ y₁ + γ̇ x₂, the axes of R = R_z(α) R_y(β) R_x(γ); where β = ±90° the angles' rates are
not determined, and NaN.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Motion
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.four_sps_spr.constraint import SYMBOLS
from kinematics.mechanisms.four_sps_spr.design import LIMBS, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import POSE
from kinematics.mechanisms.four_sps_spr.wrenches import Legs, closes, legs, matrix, scaled, solve

HELD = 1e-9
"""Part of the rates' size by which they may violate the constraint, as rounding does."""
UPRIGHT = 1e-9
"""|cos β| below which the angles do not determine how they change."""


# --- angles and angular velocity -----------------------------------------------------------


def angular_axes(poses: ArrayLike) -> Array:
    """E with ω = E (α̇, β̇, γ̇), (..., 3, 3): the columns are z, y₁ and x₂."""
    p = np.asarray(poses, dtype=float)
    return _axes(p[..., 3], p[..., 4])


def _axes(alpha: Array, beta: Array) -> Array:
    ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    e = np.zeros((*np.shape(alpha), 3, 3))
    e[..., 2, 0] = 1.0
    e[..., 0, 1], e[..., 1, 1] = -sa, ca
    e[..., 0, 2], e[..., 1, 2], e[..., 2, 2] = ca * cb, sa * cb, -sb
    return e


def _axes_rate(poses: Array, rates: Array) -> Array:
    """dE/dt, (..., 3, 3)."""
    alpha, beta = poses[..., 3], poses[..., 4]
    da, db = rates[..., 3], rates[..., 4]
    ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    e = np.zeros((*np.broadcast_shapes(alpha.shape, da.shape), 3, 3))
    e[..., 0, 1], e[..., 1, 1] = -ca * da, -sa * da
    e[..., 0, 2] = -sa * cb * da - ca * sb * db
    e[..., 1, 2] = ca * cb * da - sa * sb * db
    e[..., 2, 2] = -cb * db
    return e


# --- second order --------------------------------------------------------------------------


def hessians(design: FourSPSSPRDesign, poses: ArrayLike) -> Array:
    """H_1 … H_6 of eqs. 13 and 14, corrected: (..., 6, 6, 6), for V = (v; ω), mm and rad."""
    return _hessians(legs(design, finite(poses, name="a pose", last=POSE)))


def _hessians(at: Legs) -> Array:
    r, n = _skew(at.arm), _skew(at.unit)
    h = np.zeros((*r.shape[:-2], 6, 6))
    legs_r, legs_n = r[..., :LIMBS, :, :], n[..., :LIMBS, :, :]
    first = h[..., :LIMBS, :, :]
    first[..., :3, :3] = np.eye(3)
    first[..., :3, 3:] = -legs_r
    first[..., 3:, :3] = legs_r
    first[..., 3:, 3:] = -legs_r @ legs_r
    rows = matrix(at)[..., :LIMBS, :]
    first -= rows[..., :, None] * rows[..., None, :]
    with np.errstate(invalid="ignore", divide="ignore"):
        first /= at.length[..., None, None]
    first[..., 3:, 3:] += legs_r @ legs_n
    h[..., LIMBS, :3, 3:] = -n[..., LIMBS, :, :]
    h[..., LIMBS, 3:, :3] = n[..., LIMBS, :, :]
    h[..., LIMBS, 3:, 3:] = -n[..., LIMBS, :, :] @ r[..., LIMBS, :, :]
    return h


def _skew(v: Array) -> Array:
    s = np.zeros((*v.shape, 3))
    s[..., 2, 1], s[..., 0, 2], s[..., 1, 0] = v[..., 0], v[..., 1], v[..., 2]
    s[..., 1, 2], s[..., 2, 0], s[..., 0, 1] = -v[..., 0], -v[..., 1], -v[..., 2]
    return s


# --- both ways -----------------------------------------------------------------------------


class _Frame(NamedTuple):
    """What both ways need at poses (..., 6): G, the H_i, and V by the pose's rates."""

    poses: Array
    g: Array
    h: Array
    by_pose: Array


def _frame(design: FourSPSSPRDesign, poses: Array) -> _Frame:
    at = legs(design, poses)
    g = np.where(closes(design, poses)[..., None, None], matrix(at), np.nan)
    by_pose = np.zeros((*poses.shape[:-1], 6, 6))
    by_pose[..., :3, :3] = np.eye(3)
    by_pose[..., 3:, 3:] = angular_axes(poses)
    return _Frame(poses, g, _hessians(at), by_pose)


def inverse_motion(
    design: FourSPSSPRDesign,
    poses: ArrayLike,
    pose_rates: ArrayLike,
    pose_accelerations: ArrayLike | None = None,
) -> Motion:
    """Leg rates and accelerations of a moving platform.

    Args:
        poses: (..., 6) mm and rad.
        pose_rates: (..., 6) mm/s and rad/s. One of the six may be NaN, the same at all poses: it
            follows from the constraint.
        pose_accelerations: (..., 6) mm/s² and rad/s², likewise; None is zero, but for the
            coordinate that follows, the first of x … γ where no rate is NaN that can.

    Raises:
        InputError: not numbers, or the rates violate the constraint.
    """
    p = finite(poses, name="a pose", last=POSE)
    f = _frame(design, p)
    rates, _ = _completed(f, pose_rates, np.zeros(p.shape[:-1]), "rates")
    v = _times(f.by_pose, rates)
    bend = _quadratic(f.h, v)  # (..., 6)
    turning = np.zeros((*rates.shape[:-1], 6))
    turning[..., 3:] = _times(_axes_rate(p, rates), rates[..., 3:])
    quadratic = bend[..., LIMBS] + (f.g[..., LIMBS, :] * turning).sum(axis=-1)
    wanted = pose_accelerations
    if wanted is None:
        wanted = np.zeros_like(rates)
        wanted[..., _follows(f, pose_rates)] = np.nan
    accelerations, _ = _completed(f, wanted, quadratic, "accelerations")
    a = _times(f.by_pose, accelerations) + turning
    return _motion(rates, accelerations, v, a, _times(f.g, v), _times(f.g, a) + bend)


def forward_motion(
    design: FourSPSSPRDesign,
    poses: ArrayLike,
    joint_rates: ArrayLike,
    joint_accelerations: ArrayLike | None = None,
) -> Motion:
    """How the platform moves with given leg rates and accelerations.

    Args:
        poses: (..., 6) mm and rad.
        joint_rates: (..., 5) mm/s.
        joint_accelerations: (..., 5) mm/s²; None is zero.

    Raises:
        InputError: not numbers.
    """
    p = finite(poses, name="a pose", last=POSE)
    rates = finite(joint_rates, name="the joint rates", last=LIMBS)
    given = np.zeros(LIMBS) if joint_accelerations is None else joint_accelerations
    accelerations = finite(given, name="the joint accelerations", last=LIMBS)
    shape = np.broadcast_shapes(p.shape[:-1], rates.shape[:-1], accelerations.shape[:-1])
    p = np.broadcast_to(p, (*shape, POSE))
    f = _frame(design, p)
    rates = np.broadcast_to(rates, (*shape, LIMBS))
    accelerations = np.broadcast_to(accelerations, (*shape, LIMBS))
    v = _solved(design, f.g, _with_zero(rates))
    bend = _quadratic(f.h, v)
    a = _solved(design, f.g, _with_zero(accelerations) - bend)
    upright = np.abs(np.cos(p[..., 4])) <= UPRIGHT
    safe = np.where(upright[..., None, None], np.eye(6), f.by_pose)

    def of_pose(twist: Array) -> Array:
        values = np.linalg.solve(safe, twist[..., None])[..., 0]
        values[..., 3:] = np.where(upright[..., None], np.nan, values[..., 3:])
        return np.asarray(values)

    pose_rates = of_pose(v)
    turning = np.zeros((*shape, 6))
    turning[..., 3:] = _times(_axes_rate(p, pose_rates), pose_rates[..., 3:])
    return _motion(pose_rates, of_pose(a - turning), v, a, _times(f.g, v), _times(f.g, a) + bend)


def _motion(
    rates: Array, accelerations: Array, v: Array, a: Array, first: Array, second: Array
) -> Motion:
    return Motion(
        pose_rates=rates,
        pose_accelerations=accelerations,
        twist=np.concatenate([v[..., 3:], v[..., :3]], axis=-1),
        twist_rate=np.concatenate([a[..., 3:], a[..., :3]], axis=-1),
        joint_rates=first[..., :LIMBS].copy(),
        joint_accelerations=second[..., :LIMBS].copy(),
    )


def _completed(f: _Frame, values: ArrayLike, rest: Array, name: str) -> tuple[Array, Array]:
    """Rates or accelerations of a pose that satisfy c·values + rest = 0, c the constraint's row."""
    given = np.array(values, dtype=float)
    if given.ndim == 0 or given.shape[-1] != POSE:
        raise InputError(f"the pose {name} must have {POSE} numbers")
    shape = np.broadcast_shapes(f.poses.shape[:-1], given.shape[:-1])
    given = np.broadcast_to(given, (*shape, POSE)).copy()
    row = np.broadcast_to(
        (f.g[..., LIMBS, :, None] * f.by_pose).sum(axis=-2), (*shape, POSE)
    )  # mm/mm, mm/rad
    rest = np.broadcast_to(rest, shape)
    open_ones = np.isnan(given)
    columns = np.flatnonzero(open_ones.reshape(-1, POSE).any(axis=0))
    if len(columns) > 1 or np.isinf(given).any():
        raise InputError(
            f"the pose {name} must be finite numbers; one of the six may be NaN, to follow from "
            "the constraint"
        )
    if len(columns) == 1:
        k = int(columns[0])
        here = open_ones[..., k]
        others = np.where(open_ones, 0.0, given)
        along = row[..., k]
        steep = np.abs(along) > 1e-9 * np.abs(row).max(axis=-1)
        solved = -(rest + (row * others).sum(axis=-1)) / np.where(steep, along, np.nan)
        given[..., k] = np.where(here, solved, given[..., k])
    left = rest + (row * given).sum(axis=-1)
    size = np.abs(rest) + np.abs(row * given).max(axis=-1)
    if (np.abs(left) > HELD * size + 1e-12).any():
        worst = float(np.nanmax(np.abs(left)))
        unit = "mm/s" if name == "rates" else "mm/s²"
        raise InputError(
            f"the pose {name} violate the constraint of limb 5 by {worst:.3g} {unit}; leave one of "
            f"{', '.join(SYMBOLS)} open (NaN), so that it follows"
        )
    return given, row


def _follows(f: _Frame, rates: ArrayLike) -> int:
    """Which coordinate gives way where no accelerations are given: the one that does already."""
    columns = np.flatnonzero(np.isnan(np.asarray(rates, dtype=float)).reshape(-1, POSE).any(axis=0))
    if len(columns):
        return int(columns[0])
    row = np.abs((f.g[..., LIMBS, :, None] * f.by_pose).sum(axis=-2)[..., :3])
    least = np.nan_to_num(row.reshape(-1, 3), nan=np.inf).min(axis=0, initial=np.inf)
    return int(least.argmax())


def _times(m: Array, v: Array) -> Array:
    product: Array = (m @ v[..., None])[..., 0]
    return product


def _quadratic(h: Array, v: Array) -> Array:
    """Vᵀ H_i V, (..., 6)."""
    bend: Array = np.einsum("...j,...ijk,...k->...i", v, h, v)
    return bend


def _with_zero(values: Array) -> Array:
    zero = np.zeros((*values.shape[:-1], 1))
    joined: Array = np.concatenate([values, zero], axis=-1)
    return joined


def _solved(design: FourSPSSPRDesign, g: Array, right: Array) -> Array:
    length = design.length
    answer = solve(scaled(g, length), right)
    return np.asarray(answer / np.array([1.0, 1.0, 1.0, length, length, length]))
