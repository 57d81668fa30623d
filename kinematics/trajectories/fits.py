"""Polynomials of time instead of joint curves, and what that costs at the platform.

As in Sosa-López et al. 2017 (eqs. 16 to 19): each joint's samples are fitted by least squares. The
machine that is driven by the polynomials is then solved again, FK(fit(IK)), and compared.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from kinematics.answers.solutions import Followed
from kinematics.answers.trajectories import Trajectory
from kinematics.arrays import Array, Frozen
from kinematics.errors import InputError
from kinematics.facets.faceted import Faceted
from kinematics.trajectories.digits import MOST, Orders, digits_needed, values_of

HIGHEST = 20


@dataclass(frozen=True, eq=False)
class Fits(Frozen):
    """Polynomials of the joints and their true errors; arrays read-only, NaN where there is no FK.

    Attributes:
        degree: of the polynomials.
        coefficients: (J, degree + 1) from t⁰ upwards; mm or rad, t in s.
        digits: significant ones of the coefficients with which the polynomials are as good as their
            errors say.
        carried: all digits of the powers of t are as good as the fit. If not, whatever stands here
            is of the polynomials as printed.
        joints: (N, J) their values at the samples.
        poses, pose_rates, pose_accelerations: (N, P) of the machine that follows them.
        joint_error: (N, J) fit − exact.
        pose_error, rate_error, acceleration_error: (N, P) likewise.
        trouble: where and why the machine that follows them does not come through; "" if it does.
    """

    degree: int
    coefficients: Array
    digits: int
    carried: bool
    joints: Array
    poses: Array
    pose_rates: Array
    pose_accelerations: Array
    joint_error: Array
    pose_error: Array
    rate_error: Array
    acceleration_error: Array
    trouble: str

    @property
    def deviation(self) -> tuple[Array, Array, Array]:
        """Standard deviations (P,) of the pose's, its rates' and its accelerations' errors, with
        n − 1 in the denominator as the paper's."""
        errors = (self.pose_error, self.rate_error, self.acceleration_error)
        a, b, c = (np.std(each, axis=0, ddof=1) for each in errors)
        return a, b, c

    @property
    def largest(self) -> tuple[Array, Array, Array]:
        """The largest errors (P,) likewise."""
        errors = (self.pose_error, self.rate_error, self.acceleration_error)
        a, b, c = (np.abs(each).max(axis=0) for each in errors)
        return a, b, c


def fit(machine: Faceted[Any], found: Trajectory, degree: int) -> Fits:
    """Fit polynomials of ``degree`` to the joints of a trajectory.

    Raises:
        InputError: the path leaves the workspace, or there are too few samples for the degree.
    """
    if not 0 <= degree <= HIGHEST:
        raise InputError(f"the degree of a fit must lie between 0 and {HIGHEST}, got {degree}")
    if degree >= len(found.times):
        raise InputError(f"a fit of degree {degree} needs more than {degree} samples")
    if not np.isfinite(found.joints).all():
        raise InputError("the path leaves the workspace, so its joints cannot be fitted")
    shapes = [
        np.polynomial.Polynomial.fit(found.times, column, degree) for column in found.joints.T
    ]
    coefficients = np.zeros((len(shapes), degree + 1))
    for n, shape in enumerate(shapes):
        plain = shape.convert().coef  # a zero leading coefficient is left out
        coefficients[n, : len(plain)] = plain
    joints, rates, accelerations = (
        np.stack([shape.deriv(k)(found.times) if k else shape(found.times) for shape in shapes], -1)
        for k in range(3)
    )
    exact = (joints, rates, accelerations)
    driven = _driven(machine, found, exact)
    digits = digits_needed(machine, found, coefficients, exact, driven.errors)
    if digits is None:  # the errors are those of the powers of t, as printed
        exact = values_of(coefficients, found.times)
        driven = _driven(machine, found, exact)
    error, rate_error, acceleration_error = driven.errors
    return Fits(
        degree=degree,
        coefficients=coefficients,
        digits=MOST if digits is None else digits,
        carried=digits is not None,
        joints=exact[0],
        poses=driven.poses,
        pose_rates=driven.rates,
        pose_accelerations=driven.accelerations,
        joint_error=exact[0] - found.joints,
        pose_error=error,
        rate_error=rate_error,
        acceleration_error=acceleration_error,
        trouble=driven.trouble,
    )


class _Driven(NamedTuple):
    """The machine whose joints follow something: (N, P) each, NaN where it does not come."""

    poses: Array
    rates: Array
    accelerations: Array
    errors: Orders
    trouble: str


def _driven(machine: Faceted[Any], found: Trajectory, joints: Orders) -> _Driven:
    poses = np.full_like(found.poses, np.nan)
    modes: list[str] = []
    trouble = ""
    for n, pose in enumerate(found.poses):
        posture = machine.inverse.posture(tuple(pose.tolist()), found.mode)
        reached = machine.following.follow(posture, joints[0][n].tolist())
        modes.append(reached.posture.mode)
        if reached.stop == "target":
            poses[n] = reached.posture.pose
        elif not trouble:
            trouble = (
                "driven by these polynomials the machine does not come through: at t = "
                f"{found.times[n]:.4f} s it {_stopped(reached)}"
            )
    rates, accelerations = np.full_like(poses, np.nan), np.full_like(poses, np.nan)
    there = np.isfinite(poses).all(axis=1)
    for mode in sorted(set(modes)):
        rows = np.flatnonzero(there & (np.array(modes) == mode))
        if len(rows):
            motion = machine.motion.forward(poses[rows], mode, joints[1][rows], joints[2][rows])
            rates[rows] = motion.pose_rates
            accelerations[rows] = motion.pose_accelerations
    error = poses - found.poses
    for k, coordinate in enumerate(machine.coordinates):
        if coordinate.unit == "rad":  # a whole turn is none
            error[:, k] -= 2 * np.pi * np.round(error[:, k] / (2 * np.pi))
    errors = (error, rates - found.pose_rates, accelerations - found.pose_accelerations)
    return _Driven(poses, rates, accelerations, errors, trouble)


def _stopped(reached: Followed) -> str:
    """ "stops before a parallel singularity at …", or whatever the mechanism says of it."""
    text = reached.text.rstrip(".")
    if text.startswith("stopped "):
        return f"stops {text.removeprefix('stopped ')}"
    return f"stops: {text}" if text else "stops"
