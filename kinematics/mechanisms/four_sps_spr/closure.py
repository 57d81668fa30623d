"""States of the platform as rotation and position, and the closure equations in them.

Where angles would have a pole, rotations are turned by small vectors instead. Steps are
(v / L, ω) with the characteristic length L: a turn of 1 rad counts as much as a way of L.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import euler_angles, rotation, wrap_angle


class State(NamedTuple):
    """R (3, 3) and p (3,) mm."""

    r: Array
    p: Array


def state_of(pose: Sequence[float]) -> State:
    values = np.array(pose, dtype=float)
    return State(rotation(values), values[:3])


def pose_of(state: State, near: Sequence[float] | None = None) -> tuple[float, ...]:
    """The pose; of the two triples of angles the one nearer to those of ``near``, if given."""
    angles = euler_angles(state.r)
    if near is not None:
        other = wrap_angle(np.array([np.pi, np.pi, np.pi]) * [1, 1, 1] + angles * [1, -1, 1])
        old = np.array(near[3:], dtype=float)
        if np.abs(wrap_angle(other - old)).sum() < np.abs(wrap_angle(angles - old)).sum():
            angles = other
    return (*state.p.tolist(), *angles.tolist())


def turned(r: Array, omega: Array) -> Array:
    """exp(ω̂) R, (3, 3)."""
    angle = float(np.sqrt(omega @ omega))
    x, y, z = omega.tolist()
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    if angle < 1e-8:
        first, second = 1.0, 0.5
    else:
        first, second = np.sin(angle) / angle, (1.0 - np.cos(angle)) / angle**2
    moved: Array = r + (first * k + second * (k @ k)) @ r
    # Rounding away from a rotation does not add up: one step of Newton's iteration for it.
    corrected: Array = moved @ (1.5 * np.eye(3) - 0.5 * moved.T @ moved)
    return corrected


class Linear(NamedTuple):
    """The closure equations at a state, and their derivatives.

    Attributes:
        residual: (6,) in the unit of the steps.
        by_state: (6, 6) by the components of a step.
        error: the largest violation, mm.
    """

    residual: Array
    by_state: Array
    error: float


class Closure:
    """The closure equations with lengths (5,) mm, and ``tolerance``, mm, of their rounding."""

    def __init__(self, design: FourSPSSPRDesign, longest: float = 0.0) -> None:
        """``longest``: of the legs, mm, where they may be longer than their strokes."""
        self.design = design
        size = max(design.size, longest)
        self.tolerance = max(1e-11, 64 * float(np.finfo(float).eps) * size)
        self._weights = np.array([1.0, 1.0, 1.0, *(3 * (1.0 / design.length,))])

    def linear(self, state: State, joints: Array) -> Linear:
        d = self.design
        arms = np.vstack([d.platform @ state.r.T, d.base[SPR] - state.p])
        vectors = state.p + arms[:LIMBS] - d.base
        lengths = np.sqrt((vectors * vectors).sum(axis=1))
        axis = state.r @ d.axis
        units = np.vstack([vectors / np.maximum(lengths, 1e-300)[:, None], axis])
        g = np.hstack([units, np.cross(arms, units)]) * self._weights
        apart = np.append(lengths - joints, d.offset - arms[LIMBS] @ axis)
        return Linear(apart / d.length, g, float(np.abs(apart).max()))

    def moved(self, state: State, step: Array) -> State:
        return State(turned(state.r, step[3:]), state.p + self.design.length * step[:3])


def closed(closure: Closure, state: State, joints: Array, rounds: int = 12) -> State | None:
    """The state with these lengths that Newton's method reaches; None if it does not."""
    best, error = state, np.inf
    for _ in range(rounds):
        at = closure.linear(state, joints)
        if at.error < error:
            best, error = state, at.error
        elif error <= closure.tolerance:
            break
        try:
            step = np.asarray(np.linalg.solve(at.by_state, -at.residual), dtype=float)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(step).all() or np.abs(step).max() > 10.0:
            return None
        state = closure.moved(state, step)
    return best if error <= closure.tolerance else None
