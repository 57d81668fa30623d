"""The pose nearest to where a hand drags the platform, among those that the constraint allows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.four_sps_spr.constraint import complete_pose
from kinematics.mechanisms.four_sps_spr.design import SPR, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.states import State, pose_of, turned

_ROUNDS = 60
_ENOUGH = 1e-13  # last correction, in steps


def pose_from_transform(design: FourSPSSPRDesign, transform: ArrayLike) -> tuple[float, ...]:
    """The nearest pose to a 4x4 matrix, mm and rad, that satisfies the constraint.

    Near is |Δp|² + L² |Δφ|², the angle Δφ of the turn between both orientations and L the
    characteristic length: as the revolute axis is far from p, the platform mostly follows the hand
    and turns a little. Found by projections on the constraint's tangent plane, from where the
    matrix stands.

    Raises:
        InputError: not 4x4, or its upper left part is not a rotation (to 1e-3).
    """
    m = finite(transform, name="a transform", last=4)
    if m.shape != (4, 4):
        raise InputError("a transform must be a 4x4 matrix")
    r = m[:3, :3]
    if np.abs(r @ r.T - np.eye(3)).max() > 1e-3 or np.linalg.det(r) < 0.0:
        raise InputError("the upper left 3x3 part of a transform must be a rotation")
    left, _, right = np.linalg.svd(r)
    start = State(left @ right, m[:3, 3])
    step = np.zeros(6)
    for _ in range(_ROUNDS):
        apart, gradient = _constraint(design, start, step)
        before = step
        # The point of the tangent plane at the present step that is nearest to the start.
        step = gradient * (float(gradient @ step) - apart) / float(gradient @ gradient)
        if np.abs(step - before).max() < _ENOUGH:
            break
    state = State(turned(start.r, step[3:]), start.p + design.length * step[:3])
    return complete_pose(design, pose_of(state))


def _constraint(design: FourSPSSPRDesign, start: State, step: Array) -> tuple[float, Array]:
    """The constraint a step away from the start, in steps, and its derivatives (6,)."""
    length = design.length
    axis = turned(start.r, step[3:]) @ design.axis
    to_base = design.base[SPR] - start.p - length * step[:3]
    apart = design.offset - float(to_base @ axis)
    # δ(exp(ω̂) n) = (J δω) × n with J the left Jacobian of the rotations.
    turn = _left_jacobian(step[3:]).T @ np.cross(to_base, axis)
    return apart / length, np.concatenate([axis, turn / length])


def _left_jacobian(omega: Array) -> Array:
    angle = float(np.sqrt(omega @ omega))
    x, y, z = omega.tolist()
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    if angle < 1e-4:
        first, second = 0.5 - angle**2 / 24.0, 1.0 / 6.0 - angle**2 / 120.0
    else:
        first = (1.0 - np.cos(angle)) / angle**2
        second = (angle - np.sin(angle)) / angle**3
    return np.asarray(np.eye(3) + first * k + second * (k @ k))
