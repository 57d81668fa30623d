"""Polynomials with as many digits as they need, and what is said where no machine follows them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from kinematics import trajectories as t
from kinematics.designs.files import load_design
from kinematics.machine import Machine, machine_of
from kinematics.trajectories.digits import FEWEST, MOST, rounded

FIVE = load_design("five-bar")
M = machine_of(FIVE)


def _named(name: str, samples: int, duration: float | None = None) -> t.Trajectory:
    (way,) = [each for each in machine_of(FIVE).paths.named() if each.name == name]
    law = way.law if duration is None else t.law(way.law.kind, duration)
    return t.trajectory(M, way.path, law, way.mode, samples=samples, distances=False)


def _true_deviation(
    machine: Machine[Any], found: t.Trajectory, coefficients: np.ndarray
) -> np.ndarray:
    """σ of FK(polynomial) − path, by Horner's rule on the numbers as they are."""
    joints = np.zeros_like(found.joints)
    for column in coefficients.T[::-1]:
        joints = joints * found.times[:, None] + column
    error = []
    for pose, row in zip(found.poses, joints, strict=True):
        posture = machine.inverse.posture(tuple(pose.tolist()), found.mode)
        error.append(
            np.subtract(machine.following.follow(posture, row.tolist()).posture.pose, pose)
        )
    deviation: np.ndarray = np.std(error, axis=0, ddof=1)
    return deviation


@pytest.mark.parametrize(("degree", "duration"), [(3, 2.0), (8, 2.0), (12, 2.0), (12, 40.0)])
def test_printed_polynomials_do_what_their_error_says(degree: int, duration: float) -> None:
    found = _named("rest-to-rest", 101, duration)
    fits = t.fit(M, found, degree)
    assert fits.carried
    assert fits.trouble == ""
    printed = rounded(fits.coefficients, fits.digits)
    true = _true_deviation(M, found, printed)
    np.testing.assert_allclose(true, fits.deviation[0], rtol=0.0101)
    if fits.digits > FEWEST:  # with one less it is not so, of the pose, its rates or accelerations
        fewer = rounded(fits.coefficients, fits.digits - 1)
        off = np.abs(
            [np.polynomial.polynomial.polyval(found.times, a - b)
             for a, b in zip(fewer, fits.coefficients, strict=True)]
        ).max()  # fmt: skip
        exact = np.abs(
            [np.polynomial.polynomial.polyval(found.times, a - b)
             for a, b in zip(printed, fits.coefficients, strict=True)]
        ).max()  # fmt: skip
        assert off > exact


@pytest.mark.parametrize("duration", [2.0, 40.0])
def test_where_powers_of_t_cancel_the_error_is_of_what_is_printed(duration: float) -> None:
    found = _named("rest-to-rest", 201, duration)
    fits = t.fit(M, found, 20)
    assert fits.digits == MOST or fits.carried
    true = _true_deviation(M, found, rounded(fits.coefficients, fits.digits))
    np.testing.assert_allclose(true, fits.deviation[0], rtol=0.0101)


def test_a_fit_of_nothing_needs_few_digits_and_angles_are_told_in_theirs() -> None:
    design = load_design("rpur-table1")
    home = machine_of(design).home
    goal = np.add(home.pose, [15.0, -10.0, 12.0, 0.05, -0.04])
    length = machine_of(design).length
    path = t.line(home.pose, goal.tolist(), (1.0, 1.0, 1.0, length, length))
    found = t.trajectory(
        machine_of(design), path, t.law("cubic", 1.0), home.mode, samples=31, distances=False
    )
    for degree in (3, 6):
        fits = t.fit(machine_of(design), found, degree)
        assert FEWEST <= fits.digits < 14
        true = _true_deviation(machine_of(design), found, rounded(fits.coefficients, fits.digits))
        np.testing.assert_allclose(true, fits.deviation[0], rtol=0.0101)


def test_why_no_machine_follows_a_bad_fit() -> None:
    fits = t.fit(M, _named("rest-to-rest", 101), 1)
    assert np.isnan(fits.deviation[0]).all()
    assert "at t = 1.9800 s it stops before a parallel singularity" in fits.trouble
    assert fits.digits >= FEWEST
