"""The pose nearest to where a hand drags the platform, among those that the constraint allows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.constraint import complete_pose
from kinematics.mechanisms.four_sps_spr.design import SPR, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.states import State, pose_of
from kinematics.screws.spatial import cross_matrix, rigid

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
    r, place = rigid(transform)
    left, _, right = np.linalg.svd(r)
    start = State(left @ right, place)
    step = np.zeros(6)
    for _ in range(_ROUNDS):
        apart, gradient = _constraint(design, start, step)
        before = step
        # The point of the tangent plane at the present step that is nearest to the start.
        step = gradient * (float(gradient @ step) - apart) / float(gradient @ gradient)
        if np.abs(step - before).max() < _ENOUGH:
            break
    turn, _ = _turned(step[3:])
    state = State(turn @ start.r, start.p + design.length * step[:3])
    return complete_pose(design, pose_of(state))


def _constraint(design: FourSPSSPRDesign, start: State, step: Array) -> tuple[float, Array]:
    """The constraint a step away from the start, in steps, and its derivatives (6,)."""
    length = design.length
    turn, jacobian = _turned(step[3:])
    axis = turn @ start.r @ design.axis
    to_base = design.base[SPR] - start.p - length * step[:3]
    apart = design.offset - float(to_base @ axis)
    # δ(exp(ω̂) n) = (J δω) × n.
    by_turn = jacobian.T @ np.cross(to_base, axis)
    return apart / length, np.concatenate([axis, by_turn / length])


def _turned(omega: Array) -> tuple[Array, Array]:
    """exp(ω̂) and the left Jacobian J of the rotations there, as blocks of one exponential."""
    from scipy.linalg import expm  # slow to import

    block = np.zeros((6, 6))
    block[:3, :3], block[:3, 3:] = cross_matrix(omega), np.eye(3)
    whole = expm(block)
    return whole[:3, :3], whole[:3, 3:]
