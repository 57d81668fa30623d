"""Velocities and accelerations of platform and actuators, both ways.

With the rows w of the wrenches, their gains g and second-order terms β, the velocity V = [v, ω] of
the platform and its axes E by the pose: w·V = g q̇ for actuators and w·V = 0 for constraints,
V = E ẋ; once more, w·V̇ + β = g q̈ (0), V̇ = E ẍ + Ė ẋ. All of them are primitives of the mechanism.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Motion
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.facets.facet import Facet
from kinematics.mechanism import TINY, D
from kinematics.screws.wrenches import RANK, SERIAL, scale, unit_motions

HELD = 1e-9
"""Part of the rates' size by which they may violate a constraint, as rounding does."""
_WORDS = ("none", "one", "two", "three", "four", "five", "six")
_SWAPPED = [3, 4, 5, 0, 1, 2]  # [v, ω] of the equations ↔ [ω, v] of twists


class MotionFacet(Facet[D]):
    """First and second order motion of a batch of postures in one mode."""

    topic = "motion"

    def inverse(
        self,
        poses: ArrayLike,
        mode: str,
        pose_rates: ArrayLike,
        pose_accelerations: ArrayLike | None = None,
    ) -> Motion:
        """What the actuators do when the pose changes.

        Args:
            poses: (..., P) mm and rad.
            pose_rates: (..., P) mm/s and rad/s; broadcasts with the poses. Where the mechanism has
                dependent coordinates one of them may be NaN, the same at all poses: it follows.
            pose_accelerations: (..., P) mm/s² and rad/s², likewise; None: zero, but for the
                coordinate that follows.

        Returns:
            NaN for limbs that cannot close or are in a serial singularity.

        Raises:
            InputError: not finite numbers, or not P of them, or a constraint is violated.
        """
        m, (count, joints) = self.mechanism, self._counts
        p = finite(poses, name="a pose", last=count)
        axes = m.velocity_axes(p, mode)
        placement = m.placement(p, mode)
        rows, gain = self._driven(placement, mode)
        bound = rows[..., joints, :] if count > joints else None
        rule = None if bound is None else _times(axes.swapaxes(-1, -2), bound)
        rates = _given(pose_rates, count, "the rates of a pose", rule, 0.0)
        v = _times(axes, rates)
        joint_rates = _times(rows[..., :joints, :], v) / gain
        bias = m.bias(placement, mode, v, joint_rates)
        drift = self._drift(p, mode, rates)
        if pose_accelerations is None:
            pose_accelerations = np.zeros(count)
            if rule is not None:
                pose_accelerations[_follows(rule, pose_rates)] = np.nan
        rest = 0.0 if bound is None else bias[..., joints] + (bound * drift).sum(axis=-1)
        second = _given(pose_accelerations, count, "the accelerations of a pose", rule, rest)
        a = _times(axes, second) + drift
        joint_second = (_times(rows, a) + bias)[..., :joints] / gain
        return _motion(rates, second, v, a, joint_rates, joint_second)

    def forward(
        self,
        poses: ArrayLike,
        mode: str,
        joint_rates: ArrayLike,
        joint_accelerations: ArrayLike | None = None,
    ) -> Motion:
        """What the platform does when the actuators move.

        Args:
            poses: (..., P) mm and rad.
            joint_rates: (..., J) mm/s or rad/s; broadcasts with the poses.
            joint_accelerations: (..., J) mm/s² or rad/s²; None: zero.

        Returns:
            NaN where a limb cannot close and at parallel singularities; rates of the pose, but not
            the twist, also where the angles do not tell how the platform turns.

        Raises:
            InputError: not finite numbers, or not J of them.
        """
        m, (count, joints) = self.mechanism, self._counts
        p = finite(poses, name="a pose", last=count)
        first = finite(joint_rates, name="the rates of the actuators", last=joints)
        if joint_accelerations is None:
            joint_accelerations = np.zeros(joints)
        second = finite(joint_accelerations, name="the accelerations of the actuators", last=joints)
        placement = m.placement(p, mode)
        rows, gain, _ = m.wrenches(placement, mode)
        motions = unit_motions(rows, m.length)

        def moved(power: Array, rest: Array) -> Array:
            full = np.zeros((*power.shape[:-1], 6)) - rest
            full[..., :joints] += power
            found = _times(motions, full)
            return found + _times(motions, full - _times(rows, found))  # to the last digit

        v = moved(gain * first, np.zeros(6))
        a = moved(gain * second, m.bias(placement, mode, v, first))
        told = self._from_velocity(p, mode)
        rates = told(v)
        drift = self._drift(p, mode, np.where(np.isfinite(rates), rates, 0.0))
        return _motion(rates, told(a - drift) + 0.0 * rates, v, a, first, second)

    def pose_rates(self, poses: ArrayLike, mode: str, twist: ArrayLike) -> Array:
        """The rates (..., P) of the pose that give a twist [ω, v] (..., 6), as near as they can.

        What the mechanism's freedoms do not allow is left out. NaN for angles where they do not
        tell how the platform turns, unless the twist is one that they tell.
        """
        velocity = np.asarray(twist, dtype=float)[..., _SWAPPED]
        return self._from_velocity(np.asarray(poses, dtype=float), mode)(velocity)

    def jacobian(self, poses: ArrayLike, mode: str) -> Array:
        """∂(joints)/∂(pose), (..., J, P), in mm and rad.

        A row is NaN where the limb cannot close or is in a serial singularity.
        """
        m, (count, joints) = self.mechanism, self._counts
        p = finite(poses, name="a pose", last=count)
        rows, gain = self._driven(m.placement(p, mode), mode)
        answer: Array = rows[..., :joints, :] @ m.velocity_axes(p, mode) / gain[..., None]
        answer.setflags(write=False)
        return answer

    # --- inside

    def _driven(self, placement: Array, mode: str) -> tuple[Array, Array]:
        """The rows and the gains, NaN in serial singularities."""
        rows, gain, _ = self.mechanism.wrenches(placement, mode)
        with np.errstate(invalid="ignore"):
            moves = np.abs(gain) > SERIAL * self.mechanism.largest_gain
        return rows, np.where(moves, gain, np.nan)

    def _drift(self, poses: Array, mode: str, rates: Array) -> Array:
        """Ė ẋ, (..., 6) [v, ω]."""
        shape = np.broadcast_shapes(poses.shape, rates.shape)
        moved = np.broadcast_to(poses, shape) + 1j * TINY * rates
        return _times(self.mechanism.velocity_axes(moved, mode).imag / TINY, rates)

    def _from_velocity(self, poses: Array, mode: str) -> Callable[[Array], Array]:
        """The function from velocities [v, ω] to rates of the pose, see `pose_rates`."""
        length = self.mechanism.length
        unit = np.where(self._angles, 1.0 / length, 1.0)
        axes = scale(length)[:, None] * self.mechanism.velocity_axes(poses, mode) * unit
        known = np.asarray(np.isfinite(axes).all(axis=(-1, -2)))[..., None]
        axes = np.where(known[..., None], axes, 0.0)
        q, r = np.linalg.qr(axes)
        weak = np.abs(np.diagonal(r, axis1=-2, axis2=-1)) <= RANK
        # Where coordinates do not tell anything, they are left alone.
        r = np.where(weak[..., None, :] | weak[..., :, None], np.eye(len(unit)), r)
        back = np.linalg.inv(r) @ np.where(weak[..., None], 0.0, q.swapaxes(-1, -2))

        def told(velocity: Array) -> Array:
            wanted = velocity * scale(length)
            rates = _times(back, wanted)
            missed = np.linalg.norm(wanted - _times(axes, rates), axis=-1)
            turn = np.linalg.norm(wanted[..., 3:], axis=-1)
            vague = weak.any(axis=-1) & (missed > RANK * turn)
            blank = ~known | (vague[..., None] & self._angles)
            return np.where(blank, np.nan, rates * unit)

        return told

    @cached_property
    def _counts(self) -> tuple[int, int]:
        """P and J."""
        return len(self.mechanism.coordinates), len(self.mechanism.actuators)

    @cached_property
    def _angles(self) -> np.ndarray:
        """(P,) which coordinates of a pose are angles."""
        return np.array([each.unit == "rad" for each in self.mechanism.coordinates])


def _times(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _motion(
    rates: Array, second: Array, v: Array, a: Array, joint_rates: Array, joint_second: Array
) -> Motion:
    parts = (rates, second, v[..., _SWAPPED], a[..., _SWAPPED], joint_rates, joint_second)
    shape = np.broadcast_shapes(*(part.shape[:-1] for part in parts))
    return Motion(*(np.broadcast_to(part, (*shape, part.shape[-1])).copy() for part in parts))


# --- dependent coordinates -----------------------------------------------------------------


def _given(values: ArrayLike, count: int, name: str, rule: Array | None, rest: ArrayLike) -> Array:
    """Rates or accelerations of a pose; with a constraint, such that rule · values + rest = 0."""
    if rule is None:
        return finite(values, name=name, last=count)
    given = np.array(values, dtype=float)
    open_ones = np.isnan(given)
    finite(np.where(open_ones, 0.0, given), name=name, last=count)
    columns = np.flatnonzero(open_ones.reshape(-1, count).any(axis=0))
    if len(columns) > 1:
        raise InputError(
            f"{name} must be finite numbers; one of the {_WORDS[count]} may be NaN, to follow from "
            "the constraint"
        )
    shape = np.broadcast_shapes(rule.shape, given.shape)
    rule, given = np.broadcast_to(rule, shape), np.broadcast_to(given, shape).copy()
    if len(columns):
        k = int(columns[0])
        others = np.where(np.isnan(given), 0.0, given)
        steep = np.abs(rule[..., k]) > 1e-9 * np.abs(rule).max(axis=-1)
        solved = -(rest + (rule * others).sum(axis=-1)) / np.where(steep, rule[..., k], np.nan)
        given[..., k] = np.where(np.isnan(given[..., k]), solved, given[..., k])
    left = np.abs(rest + (rule * given).sum(axis=-1))
    size = np.abs(rest) + np.abs(rule * given).max(axis=-1)
    if (left > HELD * size + 1e-12).any():
        raise InputError(
            f"{name} violate the constraint by {float(np.nanmax(left)):.3g}; leave one of the "
            f"{_WORDS[count]} open (NaN), so that it follows"
        )
    return given


def _follows(rule: Array, rates: ArrayLike) -> int:
    """Which coordinate gives way where no accelerations are given: the one that does already, or a
    position that can."""
    count = rule.shape[-1]
    columns = np.flatnonzero(
        np.isnan(np.asarray(rates, dtype=float)).reshape(-1, count).any(axis=0)
    )
    if len(columns):
        return int(columns[0])
    least = np.nan_to_num(np.abs(rule[..., :3]).reshape(-1, 3), nan=np.inf).min(
        axis=0, initial=np.inf
    )
    return int(least.argmax())
