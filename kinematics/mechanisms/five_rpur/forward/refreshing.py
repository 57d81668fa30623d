"""The assembly modes of a 5-RPUR while its actuators move, see `homotopy.assembly_tracking`.

Solutions are followed along the straight line in joint space from the lengths before to those now.
Limbs that share a merged U joint are followed as one: they pass v ∥ e1 together, where they could
part if they were not merged.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.solutions import ForwardSolutions, Refreshed
from kinematics.arrays import Array
from kinematics.homotopy.assembly_tracking import CAREFULLY, tracked_apart
from kinematics.homotopy.tracking import Control, Ending, Index, Tracked, track
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign, Ties
from kinematics.mechanisms.five_rpur.forward.assembly import (
    MODE_SIGNS,
    Solving,
    pose_distances,
)
from kinematics.mechanisms.five_rpur.forward.coincidence import real_jacobian
from kinematics.mechanisms.five_rpur.forward.equations import (
    PHI,
    THETA,
    Complex,
    Deformation,
    Frame,
    Parameters,
    from_poses,
    from_real,
    parameters,
    polish,
    real_part,
    residuals,
    to_poses,
)
from kinematics.mechanisms.five_rpur.inverse import joint_points

_AT_ONCE = Control(first=1.0, error=2e-2, shortest=1e-4, most=200)
_THERE = 1e-6  # of the machine's size: an end and the solution that it is
_TOGETHER = 0.2  # of the machine's size: solutions left at the same fold


class Forward(Solving):
    """Solving, and who is who."""

    def refresh(self, before: ForwardSolutions, joints: Sequence[float]) -> Refreshed:
        design, now = self.design, self.tracked_on(before, joints)
        frame = Frame.of(design)
        starts = _configurations(design, frame, before)
        g0, g1 = (parameters(design, s.joints, frame) for s in (before, now))
        merged = () if before.mixed_modes else design.merged_joints
        tied = tuple(tuple(i - 1 for i in limbs) for limbs in merged)
        way = _Following(Deformation(g0, g0._replace(rho2=g1.rho2)), tied)

        def tracked(columns: Index | None) -> Tracked:
            if columns is None:
                return _followed(way, starts, _AT_ONCE)
            return _followed(way.take(columns), starts[:, columns], CAREFULLY)

        return tracked_apart(
            before,
            now,
            tracked,
            lambda ends: to_poses(frame, real_part(ends)[0]),
            partial(pose_distances, design),
            sides=(_sides(g0, starts, tied), _sides(g1, _configurations(design, frame, now), tied)),
            there=_THERE * frame.unit,
            together=_TOGETHER * frame.unit,
        )


def _followed(way: _Following, starts: Complex, control: Control) -> Tracked:
    ends = track(way, starts, control)
    arrived = ends.ended(Ending.REGULAR)
    there = np.ones(len(arrived))
    with np.errstate(all="ignore"):
        for _ in range(2):
            ends.values[:, arrived] += way.take(arrived).step(ends.values[:, arrived], there)[0]
    return ends


class _Following:
    """Real solutions of a machine whose actuators move, with the limbs of each tie as one.

    Newton's method on F1 of all limbs and F2 of one of each tie, for X, y, Z, φ, θ and the w that
    are left: regular where the whole system is not.
    """

    def __init__(self, way: Deformation, ties: Ties) -> None:
        self._way, self._ties = way, ties

    def take(self, columns: NDArray[np.intp]) -> _Following:
        return _Following(self._way.take(columns), self._ties)

    def extent(self, u: Complex) -> Array:
        return self._way.extent(u)

    def step(self, u: Complex, t: Complex | Array) -> tuple[Complex, Complex]:
        if not self._ties:
            return self._way.step(u, t)
        g, dg = self._way.at(t)
        real = from_real(*real_part(u))  # a predictor leaves the circle of e^{iφ}
        f1, f2 = residuals(g, real)
        moved = np.broadcast_to(-0.5 * dg.rho2.real, f1.shape)
        right = np.stack(
            [np.concatenate([f1.real, f2.real]), np.concatenate([moved, np.zeros_like(moved)])]
        )
        kept = _kept(self._ties)
        matrix = _tied(g, real, self._ties)
        sound = np.isfinite(matrix).all(axis=(-1, -2))
        matrix[~sound] = np.eye(matrix.shape[-1])
        sides = -right[:, kept].transpose(2, 1, 0)
        try:
            solved = np.linalg.solve(matrix, sides)
        except np.linalg.LinAlgError:  # one of many stands exactly in a singularity
            solved = np.linalg.solve(matrix + 1e-14 * np.eye(matrix.shape[-1]), sides)
        solved[~sound] = np.nan
        newton, tangent = (self._spread(real, solved[:, :, k].T) for k in range(2))
        turned = np.exp(1j * solved[:, PHI : THETA + 1, 0].T) - 1.0
        newton[PHI : THETA + 1] = real[PHI : THETA + 1] * turned
        return newton + (real - u), tangent

    def _spread(self, u: Complex, d: Array) -> Complex:
        du = np.empty_like(u)
        du[:PHI] = d[:PHI]
        du[PHI : THETA + 1] = 1j * u[PHI : THETA + 1] * d[PHI : THETA + 1]
        for k, limbs in enumerate(_classes(self._ties)):
            for i in limbs:
                du[5 + i] = d[5 + k]
        return du


def _classes(ties: Ties) -> Ties:
    tied = {i for limbs in ties for i in limbs}
    return (*ties, *((i,) for i in range(LIMBS) if i not in tied))


def _kept(ties: Ties) -> list[int]:
    """Rows of the equations that are left: F1 of all limbs, F2 of one of each class."""
    return [*range(LIMBS), *(LIMBS + limbs[0] for limbs in _classes(ties))]


def _tied(g: Parameters, u: Complex, ties: Ties) -> Array:
    whole = real_jacobian(g, u)
    columns = [whole[:, :, list(5 + np.array(limbs))].sum(axis=2) for limbs in _classes(ties)]
    answer: Array = np.concatenate([whole[:, :, :5], np.stack(columns, axis=2)], axis=2)
    return answer[:, _kept(ties)]


def _sides(g: Parameters, u: Complex, ties: Ties) -> Array:
    """The sign of the equations' determinant, which no regular path changes."""
    sides: Array = np.sign(np.linalg.det(_tied(g, u, ties)))
    return sides


def _configurations(design: FiveRPURDesign, frame: Frame, known: ForwardSolutions) -> Complex:
    sigma = np.array([MODE_SIGNS[mode] for mode in known.modes]).reshape(-1, 5)
    _, elbows, tips = joint_points(design, known.poses, sigma)
    elbows = np.where(np.isfinite(elbows), elbows, tips)  # rounding, with the link along e1
    u = from_poses(design, frame, known.poses, elbows)
    return polish(parameters(design, known.joints, frame), u, rounds=2)[0]
