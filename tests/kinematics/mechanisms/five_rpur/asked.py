"""What the facets of a 5-RPUR answer, asked by design: the tests' own names for it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.singularities import Singularity
from kinematics.arrays import Array
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import joint_points
from tests.kinematics.mechanisms.five_rpur.machines import preset


def inverse_motion(design: FiveRPURDesign, *asked: Any) -> Motion:
    return machine_of(design).motion.inverse(*asked)


def forward_motion(design: FiveRPURDesign, *asked: Any) -> Motion:
    return machine_of(design).motion.forward(*asked)


def inverse_jacobian(design: FiveRPURDesign, poses: Any, modes: Any) -> Array:
    return machine_of(design).motion.jacobian(poses, modes)


def hessian(design: FiveRPURDesign, poses: Any, modes: Any) -> Array:
    """∂²ρ_i/∂(pose)², (..., 5, 5, 5): by accelerations at constant rates, which are xᵀ H x."""

    def along(rates: Array) -> Array:
        return inverse_motion(design, poses, modes, rates).joint_accelerations

    unit = np.eye(5)
    plain = [along(each) for each in unit]
    answer = np.empty((*plain[0].shape, 5, 5))
    for j in range(5):
        for k in range(j + 1):
            both = along(unit[j] + unit[k])
            answer[..., j, k] = answer[..., k, j] = 0.5 * (both - plain[j] - plain[k])
    return answer


def twists(poses: Any, rates: Any) -> Array:
    """[ω, v] of rates of the pose, of any 5-RPUR."""
    theta = np.asarray(poses)[..., 4]
    phi_rate, theta_rate = rates[..., 3], rates[..., 4]
    omega = [phi_rate * np.cos(theta), theta_rate, -phi_rate * np.sin(theta)]
    return np.concatenate([np.stack(omega, axis=-1), rates[..., :3]], axis=-1)


def pose_rates_of(poses: Any, twist: Any) -> Array:
    return machine_of(preset("rpur-table1")).motion.pose_rates(poses, "+++++", twist)


def wrench_system(design: FiveRPURDesign, poses: Any, modes: Any) -> WrenchSystem:
    return machine_of(design).statics.wrenches(poses, modes)


class Wrenches(NamedTuple):
    force: Array
    moment: Array
    transmission: Array
    couple: Array


def wrenches(design: FiveRPURDesign, poses: Any, modes: Any) -> Wrenches:
    """Forces as (û × e1) × (v̂ × e2), not of unit size, and what belongs to them."""
    system = wrench_system(design, poses, modes)
    rows = system.rows
    a, b, c = joint_points(design, poses, modes)
    e1 = np.array([0.0, 1.0, 0.0])
    u, v = b - a, c - b
    with np.errstate(invalid="ignore"):
        u = u / np.linalg.norm(u, axis=-1, keepdims=True)
    v = v / np.linalg.norm(v, axis=-1, keepdims=True)
    e2 = -np.cross(e1, rows[..., 5:, 3:])
    size = np.linalg.norm(np.cross(np.cross(u, e1), np.cross(v, -e2)), axis=-1)
    scaled = rows[..., :5, :] * size[..., None]
    return Wrenches(scaled[..., :3], scaled[..., 3:], system.gain * size, rows[..., 5, 3:])


def statics(design: FiveRPURDesign, poses: Any, modes: Any, loads: Any) -> Statics:
    return machine_of(design).statics.forces(poses, modes, loads)


def wrench_matrix(design: FiveRPURDesign, poses: Any, modes: Any, *, length: float = 1.0) -> Array:
    """The six wrenches as rows [force, moment about O' / length], the couple as a unit moment."""
    force, moment, _, couple = wrenches(design, poses, modes)
    last = np.concatenate([np.zeros_like(couple), couple], axis=-1)[..., None, :]
    return np.concatenate([np.concatenate([force, moment / length], axis=-1), last], axis=-2)


def condition(design: FiveRPURDesign, poses: Any, modes: Any, **more: Any) -> Array:
    return machine_of(design).measures.condition(poses, modes, **more)


def measure(design: FiveRPURDesign, *asked: Any) -> Array:
    return machine_of(design).measures(*asked)


def singularities(design: FiveRPURDesign, *asked: Any) -> tuple[Singularity, ...]:
    return machine_of(design).singularities.at(*asked)
