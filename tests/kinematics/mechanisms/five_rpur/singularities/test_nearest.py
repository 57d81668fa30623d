"""The nearest singularity: a zero, and no change of sign nearer to the pose."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from kinematics.mechanisms.five_rpur.singularities.nearest import nearest_singularity
from tests.kinematics.mechanisms.five_rpur.asked import wrench_matrix
from tests.kinematics.mechanisms.five_rpur.machines import preset
from tests.kinematics.mechanisms.five_rpur.singularities.cases import (
    always_singular,
    closing_points,
    moved_base,
    poses,
    random_case,
)


@pytest.mark.slow
@settings(max_examples=25)
@given(st.integers(0, 10**6))
def test_nothing_nearer_changes_the_sign(seed: int) -> None:
    design, phi, theta, mode = random_case(seed)
    determinant = Determinant.at(design, phi, theta, mode)
    if not determinant.closes:
        return
    center = closing_points(determinant, 1, seed)[0]
    pose = poses(design, phi, theta, [center])[0]
    found = nearest_singularity(design, pose, mode)
    if found is None:
        return
    assert np.linalg.norm(found.point - pose[:3]) == pytest.approx(found.distance, abs=1e-9)
    zero = determinant.turn.T @ found.point
    value, gradient = determinant.value_and_gradient(zero)
    noise = determinant.roundoff(zero)
    assert abs(value) <= found.error * np.linalg.norm(gradient) + noise
    rng = np.random.default_rng(seed)
    v = rng.normal(size=(6000, 3))
    v *= (rng.random(len(v)) ** (1 / 3) / np.linalg.norm(v, axis=1))[:, None]
    near = center + 0.999 * found.distance * v
    near = near[(near[:, 1] > determinant.span[0]) & (near[:, 1] < determinant.span[1])]
    values = determinant.value(near)
    sure = np.abs(values) > determinant.roundoff(near)
    assert (np.sign(values[sure]) == np.sign(determinant.value(center))).all()


def test_the_wrenches_are_dependent_there() -> None:
    design, mode = preset("rpur-table1"), "+++++"
    pose = [60.0, 120.0, 450.0, 0.1, -0.2]
    found = nearest_singularity(design, pose, mode)
    assert found is not None
    length = 50.0
    there = wrench_matrix(design, [*found.point, 0.1, -0.2], mode, length=length)
    sizes = np.linalg.svd(there, compute_uv=False)
    assert sizes[-1] < 1e-12 * sizes[0]


def test_it_moves_with_the_machine() -> None:
    design, mode, pose = preset("rpur-table1"), "-----", np.array([90.0, 90.0, 200.0, 0.3, -0.4])
    found = nearest_singularity(design, pose, mode)
    turn, shift = 0.5, np.array([100.0, 50.0, -70.0])
    moved = moved_base(design, turn, shift)
    spin = Determinant.at(design, 0.0, turn, mode).turn
    there = nearest_singularity(moved, [*(spin @ pose[:3] + shift), 0.3, -0.4 + turn], mode)
    assert there.distance == pytest.approx(found.distance, abs=1e-8)
    assert there.point == pytest.approx(spin @ found.point + shift, abs=1e-5)


def test_a_singular_pose_is_at_no_distance() -> None:
    design, mode = preset("rpur-table1"), "+++++"
    found = nearest_singularity(design, [60.0, 120.0, 450.0, 0.1, -0.2], mode)
    again = nearest_singularity(design, [*found.point, 0.1, -0.2], mode)
    assert again.distance <= again.error
    always = always_singular(design)
    assert nearest_singularity(always, [60.0, 120.0, 450.0, 0.1, -0.2], mode).distance == 0.0


def test_a_pose_that_does_not_close_has_none() -> None:
    assert nearest_singularity(preset("rpur-table1"), [0.0, 900.0, 0.0, 0.0, 0.0], "+++++") is None


def test_bad_input_is_refused() -> None:
    design = preset("rpur-table1")
    with pytest.raises(InputError):
        nearest_singularity(design, [0.0, 100.0, 0.0, 0.0], "+++++")
    with pytest.raises(InputError):
        nearest_singularity(design, [0.0, 100.0, 0.0, 0.0, 0.0], "++++")
