"""F in closed form: the wrenches' determinant, its slopes, and its polynomials."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.facets.inverse import posture
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inverse import MODES, joint_points
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from tests.kinematics.mechanisms.five_rpur.asked import wrench_matrix
from tests.kinematics.mechanisms.five_rpur.machines import preset
from tests.kinematics.mechanisms.five_rpur.singularities.cases import (
    always_singular,
    closing_points,
    moved_base,
    other_reference,
    poses,
    random_case,
    turned,
)
from tests.kinematics.references import read


@settings(max_examples=30)
@given(st.integers(0, 10**6))
def test_it_is_the_determinant_of_the_wrenches_times_lengths(seed: int) -> None:
    design, phi, theta, mode = random_case(seed)
    determinant = Determinant.at(design, phi, theta, mode)
    if not determinant.closes:
        return
    points = closing_points(determinant, 200, seed)
    where = poses(design, phi, theta, points)
    a, b, _ = joint_points(design, where, mode)
    lengths = np.linalg.norm(b - a, axis=-1) * design.link
    six = np.linalg.det(wrench_matrix(design, where, mode, length=determinant.size))
    want = six * lengths.prod(axis=-1) / determinant.size**10
    found = determinant.value(points)
    assert found == pytest.approx(want, abs=1e-11 * max(np.abs(want).max(), 1e-6), rel=1e-6)
    assert (np.abs(found - want) <= 1e3 * determinant.roundoff(points) + 1e-18).all()


@settings(max_examples=20)
@given(st.integers(0, 10**6))
def test_its_gradient_is_that_of_differences(seed: int) -> None:
    design, phi, theta, mode = random_case(seed)
    determinant = Determinant.at(design, phi, theta, mode)
    if not determinant.closes:
        return
    points = closing_points(determinant, 100, seed)
    low, high = determinant.span
    points[:, 1] = np.clip(points[:, 1], low + 0.02 * (high - low), high - 0.02 * (high - low))
    value, gradient = determinant.value_and_gradient(points)
    assert value == pytest.approx(determinant.value(points), abs=1e-18, rel=1e-9)
    step = 1e-4
    numeric = np.stack(
        [
            (determinant.value(points + e) - determinant.value(points - e)) / (2 * step)
            for e in step * np.eye(3)
        ],
        axis=-1,
    )
    scale = np.abs(gradient).max() + 1e-18
    assert np.abs(gradient - numeric).max() < 1e-4 * scale


@settings(max_examples=20)
@given(st.integers(0, 10**6))
def test_the_polynomials_have_its_values_on_a_grid(seed: int) -> None:
    design, phi, theta, mode = random_case(seed)
    determinant = Determinant.at(design, phi, theta, mode)
    if not determinant.closes:
        return
    points = np.sort(closing_points(determinant, 9, seed), axis=0)
    x, y, z = points.T
    grid = determinant.on_grid(x, y, z)
    nodes = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
    direct = determinant.value(nodes)
    assert np.abs(grid - direct).max() <= 1e-12 * np.abs(direct).max() + 1e-20
    assert determinant.coefficients(y, (x[0], z[0]))[:, 2, 4].max() == 0.0


@settings(max_examples=40)
@given(st.integers(0, 10**6))
def test_the_polynomials_along_lines_have_its_values(seed: int) -> None:
    determinant = Determinant.at(*random_case(seed))
    if not determinant.closes:
        return
    points = closing_points(determinant, 700, seed)  # more than are worked out at a time
    found = determinant.along_z(points[:, 0], points[:, 1])
    powers = np.power.outer(points[:, 2] / determinant.size, np.arange(5))
    noise = determinant.roundoff(points) + 1e-13 * (np.abs(found) * np.abs(powers)).sum(axis=1)
    assert (np.abs((found * powers).sum(axis=1) - determinant.value(points)) <= 10.0 * noise).all()


def test_it_changes_sign_where_assembly_modes_merge() -> None:
    design = preset("rpur-table1")
    for fold in read("rpur_folds.json")["folds"]:
        pose = np.array(fold["pose_fold"])
        for mode in MODES:
            if not np.allclose(posture(design, pose, mode).joints, fold["rho_fold"], atol=1e-6):
                continue
            determinant = Determinant.at(design, pose[3], pose[4], mode)
            point = pose[:3] @ determinant.turn
            value, gradient = determinant.value_and_gradient(point)
            assert abs(value) / np.linalg.norm(gradient) < 1e-9  # mm
            break
        else:
            raise AssertionError("no mode has the lengths of the fold")


def test_neither_the_base_frame_nor_the_reference_point_counts() -> None:
    design, phi, theta, mode = preset("rpur-table2"), 0.4, -0.7, "+-++-"
    determinant = Determinant.at(design, phi, theta, mode)
    points = closing_points(determinant, 100, 1)
    value = determinant.value(points)
    turn, shift = 0.9, np.array([120.0, -35.0, 60.0])
    moved = Determinant.at(moved_base(design, turn, shift), phi, theta + turn, mode)
    there = points + shift @ moved.turn
    assert moved.value(there) == pytest.approx(value, rel=1e-9, abs=1e-20)
    offset = np.array([30.0, -20.0, 45.0])
    other = Determinant.at(other_reference(design, offset), phi, theta, mode)
    there = points + turned(phi, 0.0) @ offset
    assert other.value(there) == pytest.approx(value, rel=1e-9, abs=1e-20)


def test_equal_limbs_leave_nothing_but_rounding() -> None:
    design = always_singular(preset("rpur-table1"))
    determinant = Determinant.at(design, 0.3, 0.2, "++-+-")
    points = closing_points(determinant, 500, 2)
    assert (np.abs(determinant.value(points)) <= determinant.roundoff(points)).all()
    other = Determinant.at(design, 0.3, 0.2, "+--+-")
    points = closing_points(other, 500, 2)
    assert (np.abs(other.value(points)) > other.roundoff(points)).mean() > 0.99


def test_limbs_that_never_close_together() -> None:
    limb = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 100.0, (50.0, 90.0))
    far = Limb((0.0, 500.0, 0.0), (0.0, 0.0, 0.0), 100.0, (50.0, 90.0))
    determinant = Determinant.at(FiveRPURDesign((limb, limb, limb, limb, far)), 0.0, 0.0, "+++++")
    assert not determinant.closes
