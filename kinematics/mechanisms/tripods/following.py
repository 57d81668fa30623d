"""One assembly mode while the actuators move: states, closure equations, folds, and the change of
operation mode on the way.

A state is the reduced pose (x0, x1, x2, v): on its sphere neither the level platform nor a tilt of
180° is special, and a 3-SPR passes 90°. Within an operation mode the closure equations are regular
at x0 = 0, where the other mode is met: there the machine may go on in either, so a motion stops.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from kinematics.answers.solutions import Fold, Followed, Posture
from kinematics.arrays import Array, finite
from kinematics.facets import following
from kinematics.facets.following import Linear
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.conics import lengths_and_slopes
from kinematics.mechanisms.tripods.design import JOINT_SYMBOLS, LIMBS, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.inverse import posture
from kinematics.mechanisms.tripods.posing import Reduced

MEETING = 1e-9
"""|x0| below which a pose belongs to both operation modes."""
_ROUNDS = 12


class State(NamedTuple):
    """x (3,) of length one, and v in mm."""

    x: Array
    v: float


def state_of(design: TripodDesign, pose: Sequence[float], mode: str) -> State:
    x0, x1, x2, v = posing.reduce_poses(design, np.array(pose, dtype=float), mode)
    return State(np.array([x0, x1, x2], dtype=float), float(v))


def pose_of(design: TripodDesign, state: State, mode: str) -> tuple[float, ...]:
    x0, x1, x2 = state.x
    if abs(x0) <= MEETING:
        x0 = 0.0
    parts = (np.array(part) for part in (x0, x1, x2, state.v))
    return tuple(posing.to_poses(design, Reduced(*parts), mode).tolist())


class Closure:
    """The closure equations, see `kinematics.facets.following.Closure`."""

    def __init__(self, design: TripodDesign, mode: str) -> None:
        self.h = design.revolute_radius
        self.k = mode_sign(mode) * design.spherical_radius
        self.joint_unit = design.spherical_radius
        self.tolerance = 64 * float(np.finfo(float).eps) * (design.size + design.stroke[1]) + 1e-12

    def linear(self, state: State, joints: Array) -> Linear:
        square, slopes = lengths_and_slopes(self.h, self.k, np.append(state.x, state.v))
        lengths = np.sqrt(square)
        slopes = slopes / (2.0 * np.maximum(lengths, 1e-300))[:, None]
        by_state = np.column_stack(
            [slopes[:, :3] @ _chart(state.x), slopes[:, 3] * self.joint_unit]
        )
        apart = lengths - joints
        unit = self.joint_unit
        return Linear(
            apart / unit, by_state / unit, -np.eye(LIMBS) / unit, float(np.abs(apart).max())
        )

    def moved(self, state: State, step: Array) -> State:
        x = state.x + _chart(state.x) @ step[:2]
        return State(x / np.linalg.norm(x), state.v + self.joint_unit * float(step[2]))


def _chart(x: Array) -> Array:
    """Two unit vectors normal to x, (3, 2): those of a mirror that takes −x to (1, 0, 0)."""
    u = x + np.array([1.0, 0.0, 0.0])
    mirror: Array = np.eye(3) - (2.0 / max(float(u @ u), 1e-300)) * np.outer(u, u)
    return mirror[:, 1:]


def follow(design: TripodDesign, start: Posture, joints: Sequence[float]) -> Followed:
    """Move the actuators on a straight line to ``joints``, the platform on its assembly mode.

    As `facets.following.follow`; besides, the motion stops in the constraint singularity at a
    tilt of 180°, exactly there, since the operation mode may change in it. From there it goes on
    in the mode of ``start``.

    Raises:
        InputError: not three finite numbers.
    """
    if not start.closes:
        finite(joints, name="the joints", last=LIMBS)
        return Followed(start, "stalled", f"nothing to follow: {start.reasons[0].text}", 0.0)
    visited: list[State] = []

    def remember(states: Sequence[State]) -> str:
        visited.extend(states)
        return ""

    closure = Closure(design, start.mode)
    found = following.follow(
        closure,
        start,
        state_of(design, start.pose, start.mode),
        joints,
        strokes=np.array([design.stroke] * LIMBS),
        symbols=JOINT_SYMBOLS,
        posture=posture_maker(design, start.mode),
        events=remember,
    )
    met = _meeting(closure, visited, np.array(start.joints), np.array(found.posture.joints))
    if met is None:
        return found
    state, share = met
    there = posture(design, pose_of(design, state, start.mode), start.mode)
    other = "1" if start.mode == "2" else "2"
    text = (
        "stopped at a constraint singularity, at a tilt of 180°: from here the machine may go on "
        f"in operation mode {start.mode} or {other}"
    )
    return replace(
        found,
        posture=there,
        stop="singularity",
        text=text,
        fraction=share * found.fraction,
        limb=None,
    )


def fold_ahead(design: TripodDesign, start: Posture, joints: Sequence[float]) -> Fold | None:
    """The parallel singularity at which the assembly mode ends on the line to ``joints``.

    None also where the operation modes meet before.
    """
    if not start.closes:
        return None
    fold = following.fold_ahead(
        Closure(design, start.mode),
        start,
        state_of(design, start.pose, start.mode),
        joints,
        posture=posture_maker(design, start.mode),
    )
    if fold is None:
        return None
    roomy = replace(design, stroke=(0.0, 2.0 * max(*fold.joints, *start.joints, 1.0)))
    way = follow(roomy, start, fold.joints)
    return None if way.posture.pose[1] == np.pi else fold


def posture_maker(design: TripodDesign, mode: str) -> Callable[[State, Array], Posture]:
    """Makes the posture of a state with its lengths."""

    def made(state: State, joints: Array) -> Posture:
        return posture(design, pose_of(design, state, mode), mode, known=joints)

    return made


def _meeting(
    closure: Closure, visited: Sequence[State], start: Array, end: Array
) -> tuple[State, float] | None:
    """Where the states visited on a straight line of lengths first reach x0 = 0, and the part of
    the line to there; None where they do not.

    That at the start does not count: it is left.
    """
    x0 = np.array([state.x[0] for state in visited])
    side = np.sign(np.where(np.abs(x0) <= MEETING, 0.0, x0))
    left = np.flatnonzero(side)
    if not len(left):
        return None
    first = int(left[0])
    crossed = np.flatnonzero(side[first:] != side[first])
    if not len(crossed):
        return None
    after = first + int(crossed[0])
    a, b = visited[after - 1], visited[after]
    part = x0[after - 1] / (x0[after - 1] - x0[after]) if x0[after] != x0[after - 1] else 1.0
    guess = (1.0 - part) * np.append(a.x, a.v) + part * np.append(b.x, b.v)
    angle, v = float(np.arctan2(guess[2], guess[1])), float(guess[3])
    here = _on_meeting(angle, v)
    move = end - start
    size = float(move @ move)
    lengths = np.sqrt(lengths_and_slopes(closure.h, closure.k, here)[0])
    along = float((lengths - start) @ move) / size if size > 0.0 else 1.0
    for _ in range(_ROUNDS):  # Newton's method on the lengths: angle, v and the part of the line
        square, slopes = lengths_and_slopes(closure.h, closure.k, here)
        lengths = np.sqrt(square)
        slopes = slopes / (2.0 * np.maximum(lengths, 1e-300))[:, None]
        turn = slopes[:, 2] * np.cos(angle) - slopes[:, 1] * np.sin(angle)
        matrix = np.column_stack([turn, slopes[:, 3], -move])
        apart = start + along * move - lengths
        step = np.linalg.lstsq(matrix, apart, rcond=None)[0]
        angle, v, along = angle + step[0], v + step[1], along + step[2]
        here = _on_meeting(angle, v)
        if np.abs(apart).max() <= closure.tolerance:
            break
    return State(here[:3], v), float(np.clip(along, 0.0, 1.0))


def _on_meeting(angle: float, v: float) -> Array:
    return np.array([0.0, np.cos(angle), np.sin(angle), v])
