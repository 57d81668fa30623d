"""First and second order motion of the 3-RPS and 3-SPR, analytic and for batches.

The platform turns with ω = θ̇ n + φ̇ (e_z − e), n = (cos φ, sin φ, 0) the axis of tilt and e = R e_z
the platform's normal, in both operation modes. Its centre moves as the parasitic motions
X(Z, θ, φ), Y(Z, θ, φ) say. Actuators: r_i ṙ_i = (B_i − A_i)·ḃ_i. The other way round the twist is
solved for from the six wrenches: actuation wrench · twist = ṙ_i, constraint wrench · twist = 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Motion
from kinematics.arrays import Array, finite
from kinematics.mechanisms.tripods.design import LIMBS, RADIAL, TANGENT, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.jets import Jet, cosine_and_sine, plus, reciprocal, scaled, times
from kinematics.mechanisms.tripods.posing import LEVEL, POSE, placed, read_poses, transform
from kinematics.mechanisms.tripods.wrenches import twist_of, wrench_rows

_UPRIGHT = 1e-13  # sin θ/2 below which the azimuth says nothing
_STILL = 1e-12  # part of |ω| that is none


def inverse_motion(
    design: TripodDesign,
    poses: ArrayLike,
    mode: str,
    pose_rates: ArrayLike,
    pose_accelerations: ArrayLike | None = None,
) -> Motion:
    """What platform and actuators do when the pose changes.

    Args:
        poses: (..., 3) mm and rad.
        pose_rates: (..., 3) mm/s and rad/s.
        pose_accelerations: (..., 3) mm/s² and rad/s²; none by default.

    Raises:
        InputError: not finite numbers, or not three of each.
    """
    p = read_poses(poses)
    rates = finite(pose_rates, name="the rates of the pose", last=POSE)
    second = np.zeros(POSE) if pose_accelerations is None else pose_accelerations
    accelerations = finite(second, name="the accelerations of the pose", last=POSE)
    p, rates, accelerations = (a.copy() for a in np.broadcast_arrays(p, rates, accelerations))
    twist, twist_rate = _platform(design, mode, p, rates, accelerations)
    joint_rates, joint_accelerations = _actuators(design, mode, p, twist, twist_rate)
    return Motion(rates, accelerations, twist, twist_rate, joint_rates, joint_accelerations)


def forward_motion(
    design: TripodDesign,
    poses: ArrayLike,
    mode: str,
    joint_rates: ArrayLike,
    joint_accelerations: ArrayLike | None = None,
) -> Motion:
    """What the platform does when the actuators move.

    NaN at parallel and constraint singularities. At a tilt of 0 the azimuth says nothing: there
    only motions that keep it (φ̇ = 0) can be told in pose coordinates, the twist always.

    Args:
        poses: (..., 3) mm and rad.
        joint_rates: (..., 3) mm/s.
        joint_accelerations: (..., 3) mm/s²; none by default.

    Raises:
        InputError: not finite numbers, or not three of each.
    """
    p = read_poses(poses)
    rates = finite(joint_rates, name="the rates of the actuators", last=LIMBS)
    second = np.zeros(LIMBS) if joint_accelerations is None else joint_accelerations
    accelerations = finite(second, name="the accelerations of the actuators", last=LIMBS)
    p, rates, accelerations = (a.copy() for a in np.broadcast_arrays(p, rates, accelerations))
    rows, _ = wrench_rows(design, p, mode)
    zero = np.zeros_like(rates)
    twist = twist_of(design, rows, np.concatenate([rates, zero], axis=-1))
    still = np.zeros_like(twist)
    _, bias = _actuators(design, mode, p, twist, still)
    drift = _constraint_drift(design, mode, p, twist)
    twist_rate = twist_of(design, rows, np.concatenate([accelerations - bias, -drift], axis=-1))
    pose_rates = pose_change(p, twist)
    known = np.where(np.isfinite(pose_rates), pose_rates, 0.0)
    _, carried = _platform(design, mode, p, known, np.zeros_like(known))
    pose_accelerations = pose_change(p, twist_rate - carried)
    pose_accelerations = pose_accelerations + 0.0 * pose_rates
    lost = np.isnan(twist).any(axis=-1, keepdims=True)
    rates = np.where(lost, np.nan, rates)
    accelerations = np.where(lost, np.nan, accelerations)
    return Motion(pose_rates, pose_accelerations, twist, twist_rate, rates, accelerations)


# --- inside --------------------------------------------------------------------------------


def _platform(
    design: TripodDesign, mode: str, p: Array, rates: Array, accelerations: Array
) -> tuple[Array, Array]:
    """Twist and its rate, (..., 6) each; NaN where no finite position has the altitude."""
    z, tilt, azimuth = (Jet(p[..., n], rates[..., n], accelerations[..., n]) for n in range(POSE))
    cos_t, sin_t = cosine_and_sine(tilt)
    cos_a, sin_a = cosine_and_sine(azimuth)
    cos_2a, sin_2a = cosine_and_sine(scaled(2.0, azimuth))
    one = Jet.constant(1.0, tilt)
    versed = scaled(0.5, plus(one, scaled(-1.0, cos_t)))  # s² = sin² θ/2
    if design.revolute_on_base:
        k = mode_sign(mode) * design.platform_radius
        x = scaled(k, times(versed, cos_2a))
        y = scaled(-k, times(versed, sin_2a))
    else:
        cos_4a, sin_4a = cosine_and_sine(scaled(4.0, azimuth))
        other = plus(one, scaled(-1.0, versed))  # c²
        out = scaled(design.base_radius, versed)
        along = plus(times(versed, cos_4a), scaled(-1.0, times(other, cos_2a)))
        across = plus(times(versed, sin_4a), times(other, sin_2a))
        lean = times(z, sin_t)
        level = np.where(np.abs(cos_t.value) < LEVEL, np.nan, cos_t.value)
        divisor = reciprocal(Jet(level, cos_t.rate, cos_t.acceleration))
        x = times(plus(times(out, along), times(lean, sin_a)), divisor)
        y = times(plus(times(out, across), scaled(-1.0, times(lean, cos_a))), divisor)
    # ω = θ̇ n + φ̇ (e_z − e); its rate by the product rule.
    axis = _stack([cos_a.value, sin_a.value, np.zeros_like(cos_a.value)])
    axis_rate = _stack([cos_a.rate, sin_a.rate, np.zeros_like(cos_a.value)])
    e_x, e_y = times(sin_t, sin_a), scaled(-1.0, times(sin_t, cos_a))
    turn = _stack([-e_x.value, -e_y.value, 2.0 * versed.value])
    turn_rate = _stack([-e_x.rate, -e_y.rate, -cos_t.rate])
    dt, da = tilt.rate[..., None], azimuth.rate[..., None]
    omega = dt * axis + da * turn
    alpha = (
        tilt.acceleration[..., None] * axis
        + dt * axis_rate
        + azimuth.acceleration[..., None] * turn
        + da * turn_rate
    )
    velocity = _stack([x.rate, y.rate, z.rate])
    acceleration = _stack([x.acceleration, y.acceleration, z.acceleration])
    return np.concatenate([omega, velocity], axis=-1), np.concatenate([alpha, acceleration], -1)


def _actuators(
    design: TripodDesign, mode: str, p: Array, twist: Array, twist_rate: Array
) -> tuple[Array, Array]:
    """ṙ and r̈, (..., 3) each; NaN where A_i and B_i coincide."""
    matrix = transform(design, p, mode)
    b = placed(matrix, design.platform_radius * RADIAL)
    arm = b - matrix[..., None, :3, 3]
    omega, v = twist[..., None, :3], twist[..., None, 3:]
    alpha, a = twist_rate[..., None, :3], twist_rate[..., None, 3:]
    swing = np.cross(omega, arm)
    velocity = v + swing
    acceleration = a + np.cross(alpha, arm) + np.cross(omega, swing)
    along = b - design.base_radius * RADIAL
    length = np.linalg.norm(along, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        length = np.where(length > 0.0, length, np.nan)
        rate = (along * velocity).sum(axis=-1) / length
        second = (along * acceleration).sum(axis=-1) + (velocity**2).sum(axis=-1) - rate**2
        return rate, second / length


def _constraint_drift(design: TripodDesign, mode: str, p: Array, twist: Array) -> Array:
    """(..., 3): what the constraint wrenches' power changes by while they move along."""
    matrix = transform(design, p, mode)
    centre = matrix[..., None, :3, 3]
    omega, v = twist[..., None, :3], twist[..., None, 3:]
    if design.revolute_on_base:
        # s_i·(v + ω × b) = 0 with s_i at rest: s_i·(a + α × b + ω × (ω × b)) = 0.
        arm = placed(matrix, design.platform_radius * RADIAL) - centre
        at_rest: Array = (TANGENT * np.cross(omega, np.cross(omega, arm))).sum(axis=-1)
        return at_rest
    # The platform's point at A_i, which stays while s_i = R s′_i turns along with the platform.
    arm = design.base_radius * RADIAL - centre
    axis = TANGENT @ matrix[..., :3, :3].swapaxes(-1, -2)
    turning = (np.cross(omega, axis) * (v + np.cross(omega, arm))).sum(axis=-1)
    drift: Array = turning - (axis * np.cross(omega, v)).sum(axis=-1)
    return drift


def pose_change(p: Array, twist: Array) -> Array:
    """(Ż, θ̇, φ̇) of twists (..., 6) at poses (..., 3); NaN where the azimuth says nothing."""
    tilt, azimuth = p[..., 1], p[..., 2]
    c, s = np.cos(0.5 * tilt), np.sin(0.5 * tilt)
    omega = twist[..., :3]
    along = np.cos(azimuth) * omega[..., 0] + np.sin(azimuth) * omega[..., 1]
    # e_z − e = 2 s (−c sin φ, c cos φ, s), of which the bracket has length one.
    across = c * (np.cos(azimuth) * omega[..., 1] - np.sin(azimuth) * omega[..., 0])
    across = across + s * omega[..., 2]
    upright = np.abs(s) < _UPRIGHT
    size = np.linalg.norm(omega, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = np.where(upright, 0.0 * across, across / (2.0 * s))
    told = ~upright | (np.abs(across) <= _STILL * size)
    return _stack([twist[..., 5], np.where(told, along, np.nan), np.where(told, turn, np.nan)])


def _stack(parts: list[Array]) -> Array:
    return np.stack(np.broadcast_arrays(*parts), axis=-1)
