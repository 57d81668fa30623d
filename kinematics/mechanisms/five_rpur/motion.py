"""Velocity and acceleration of the 5-RPUR, both ways, in closed form.

In the base frame turned by R_y(−θ), with (X, Y, Z) = C − A, q = σh and p = Z − q:
ρ² = X² + p² and q² + Y² = l² (see `five_rpur.inverse`). Derivatives by the pose follow
from those of X, Y, Z; with them ρ̇ = J ẋ and ρ̈ = J ẍ + ẋᵀ H ẋ for each limb. The other way round
the rows are the wrenches themselves, f·v + … = (f·û) ρ̇, which stay finite at serial singularities.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Motion
from kinematics.arrays import Array, finite
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import joint_points
from kinematics.mechanisms.five_rpur.velocity import (
    characteristic_length,
    inverse_jacobian,
    velocity_rows,
)
from kinematics.screws.wrenches import RANK


def inverse_motion(
    design: FiveRPURDesign,
    poses: ArrayLike,
    modes: str | ArrayLike,
    pose_rates: ArrayLike,
    pose_accelerations: ArrayLike | None = None,
) -> Motion:
    """Actuator rates and accelerations for given ones of the pose.

    Args:
        poses: (..., 5) mm and rad.
        modes: a working mode as "+-+++", or signs ±1 (..., 5).
        pose_rates: (..., 5) mm/s and rad/s; broadcasts with the poses.
        pose_accelerations: (..., 5) mm/s² and rad/s²; None: zero.

    Returns:
        NaN for the actuators of limbs that cannot close or are in a serial singularity, where
        the platform's rates need not be possible.

    Raises:
        InputError: not finite numbers, or not five.
    """
    p = finite(poses, name="a pose", last=5)
    rates = finite(pose_rates, name="the rates of a pose", last=5)
    second = _given(pose_accelerations, rates, "the accelerations of a pose")
    jacobian, bend = inverse_jacobian(design, p, modes), hessian(design, p, modes)
    joint_rates = np.einsum("...ij,...j->...i", jacobian, rates)
    joint_second = np.einsum("...ij,...j->...i", jacobian, second)
    joint_second = joint_second + _bending(bend, rates)
    return _motion(p, rates, second, joint_rates, joint_second)


def forward_motion(
    design: FiveRPURDesign,
    poses: ArrayLike,
    modes: str | ArrayLike,
    joint_rates: ArrayLike,
    joint_accelerations: ArrayLike | None = None,
) -> Motion:
    """Rates and accelerations of the pose for given ones of the actuators.

    Args:
        joint_rates: (..., 5) mm/s; broadcasts with the poses.
        joint_accelerations: (..., 5) mm/s²; None: zero.

    Returns:
        NaN where a limb cannot close and at parallel singularities; at serial ones the rates are
        determined, the accelerations NaN.

    Raises:
        InputError: not finite numbers, or not five.
    """
    p = finite(poses, name="a pose", last=5)
    rates = finite(joint_rates, name="the rates of the actuators", last=5)
    second = _given(joint_accelerations, rates, "the accelerations of the actuators")
    rows, transmission = velocity_rows(design, p, modes)
    length = characteristic_length(design)
    pose_rates = _solved(rows, transmission * rates, length)
    bend = hessian(design, p, modes)
    pose_second = _solved(rows, transmission * (second - _bending(bend, pose_rates)), length)
    return _motion(p, pose_rates, pose_second, rates, second)


def hessian(design: FiveRPURDesign, poses: ArrayLike, modes: str | ArrayLike) -> Array:
    """∂²ρ_i/∂(x, y, z, φ, θ)², (..., 5, 5, 5), limbs first.

    Returns:
        NaN for limbs that cannot close or are in a serial singularity (q = 0 or ρ = 0).
    """
    a, b, c = joint_points(design, poses, modes)
    pose = np.asarray(poses, dtype=float)
    phi, theta = (np.broadcast_to(pose[..., k, None], a.shape[:-1]) for k in (3, 4))
    cos, sin = np.cos(theta), np.sin(theta)
    _, sy, sz = design.platform.T
    my = sy * np.cos(phi) - sz * np.sin(phi)
    mz = sy * np.sin(phi) + sz * np.cos(phi)
    u, v = b - a, c - b
    # X, p of A→B and Y, q of B→C; across, along are C − A without the platform's own offset.
    x, p = cos * u[..., 0] - sin * u[..., 2], sin * u[..., 0] + cos * u[..., 2]
    y, q = v[..., 1], sin * v[..., 0] + cos * v[..., 2]
    across, along = x - design.platform[:, 0], p + q - mz
    zero = np.zeros_like(x)
    grad_x = np.stack([cos, zero, -sin, zero, -along], axis=-1)
    grad_y = np.stack([zero, zero + 1.0, zero, -mz, zero], axis=-1)
    grad_z = np.stack([sin, zero, cos, my, across], axis=-1)
    second_x, second_y, second_z = (np.zeros((*x.shape, 5, 5)) for _ in range(3))
    for matrix, first, third, turn in (
        (second_x, -sin, -cos, -across),
        (second_z, cos, -sin, -along),
    ):
        matrix[..., 0, 4] = matrix[..., 4, 0] = first
        matrix[..., 2, 4] = matrix[..., 4, 2] = third
        matrix[..., 4, 4] = turn
    second_y[..., 3, 3] = -my
    second_z[..., 3, 3] = -mz
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        rho, x, p, y, q = (
            value[..., None] for value in (np.hypot(x, p), x, p, y, np.where(q == 0, np.nan, q))
        )
        grad_q = -y * grad_y / q
        grad_p = grad_z - grad_q
        grad = (x * grad_x + p * grad_p) / rho
        rho, x, p, y, q = (value[..., None] for value in (rho, x, p, y, q))
        second_q = -(_square(grad_y) + y * second_y + _square(grad_q)) / q
        result: Array = (
            _square(grad_x)
            + _square(grad_p)
            + x * second_x
            + p * (second_z - second_q)
            - _square(grad)
        ) / rho
    result[~np.isfinite(result).all(axis=(-1, -2))] = np.nan
    result.setflags(write=False)
    return result


def twists(poses: ArrayLike, pose_rates: ArrayLike) -> Array:
    """The platform's twist [ω, v], ω = θ̇ e1 + φ̇ e2; (..., 6) rad/s and mm/s."""
    p, rates = np.asarray(poses, dtype=float), np.asarray(pose_rates, dtype=float)
    theta = p[..., 4]
    turning = _about(theta, rates[..., 3], rates[..., 4])
    shape = np.broadcast_shapes(turning.shape[:-1], rates.shape[:-1])
    return np.concatenate(
        [np.broadcast_to(turning, (*shape, 3)), np.broadcast_to(rates[..., :3], (*shape, 3))],
        axis=-1,
    )


def pose_rates_of(poses: ArrayLike, twist: ArrayLike) -> Array:
    """The pose rates (..., 5) of a twist (..., 6) that the mechanism's freedoms allow.

    The component of ω along e1 × e2, which the constraint couple forbids, is left out.
    """
    p, t = np.asarray(poses, dtype=float), np.asarray(twist, dtype=float)
    theta = p[..., 4]
    phi_rate = np.cos(theta) * t[..., 0] - np.sin(theta) * t[..., 2]
    rates: Array = np.concatenate([t[..., 3:], phi_rate[..., None], t[..., 1:2]], axis=-1)
    return rates


# --- inside --------------------------------------------------------------------------------


def _motion(pose: Array, rates: Array, second: Array, joint: Array, joint_second: Array) -> Motion:
    shape = np.broadcast_shapes(pose.shape[:-1], rates.shape[:-1], joint.shape[:-1])

    def full(values: Array) -> Array:
        return np.broadcast_to(values, (*shape, values.shape[-1])).copy()

    theta = pose[..., 4]
    phi_rate, theta_rate = rates[..., 3], rates[..., 4]
    turning = _about(theta, second[..., 3], second[..., 4])
    # e2 turns about e1 with θ: its derivative is θ̇ e1 × e2.
    twisting = phi_rate * theta_rate
    turning = turning + np.stack(
        [-twisting * np.sin(theta), 0.0 * twisting * theta, -twisting * np.cos(theta)], axis=-1
    )
    return Motion(
        pose_rates=full(rates),
        pose_accelerations=full(second),
        twist=full(twists(pose, rates)),
        twist_rate=np.concatenate([full(turning), full(second[..., :3])], axis=-1),
        joint_rates=full(joint),
        joint_accelerations=full(joint_second),
    )


def _about(theta: Array, phi_part: Array, theta_part: Array) -> Array:
    """theta_part e1 + phi_part e2."""
    theta, phi_part, theta_part = np.broadcast_arrays(theta, phi_part, theta_part)
    return np.stack([phi_part * np.cos(theta), theta_part, -phi_part * np.sin(theta)], axis=-1)


def _given(values: ArrayLike | None, rates: Array, name: str) -> Array:
    return np.zeros_like(rates) if values is None else finite(values, name=name, last=5)


def _square(gradient: Array) -> Array:
    return gradient[..., :, None] * gradient[..., None, :]


def _bending(bend: Array, rates: Array) -> Array:
    """ẋᵀ H ẋ of each limb."""
    answer: Array = np.einsum("...ijk,...j,...k->...i", bend, rates, rates)
    return answer


def _solved(rows: Array, right: Array, length: float) -> Array:
    """x of rows x = right; NaN where the rows are dependent or not finite."""
    scale = np.array([1.0, 1.0, 1.0, length, length])
    scaled = rows / scale
    size = np.linalg.norm(scaled, axis=-1, keepdims=True)
    good = np.isfinite(scaled).all(axis=(-1, -2)) & (size > 0.0).all(axis=(-1, -2))
    unit = np.where(good[..., None, None], scaled / np.where(size > 0.0, size, 1.0), np.eye(5))
    good = good & (np.linalg.svd(unit, compute_uv=False)[..., -1] > RANK)
    unit = np.where(good[..., None, None], unit, np.eye(5))
    shape = np.broadcast_shapes(unit.shape[:-2], right.shape[:-1])
    right = right / np.where(size > 0.0, size, np.nan)[..., 0]
    value = np.linalg.solve(np.broadcast_to(unit, (*shape, 5, 5)), right[..., None])[..., 0]
    return np.where(good[..., None], value / scale, np.nan)
