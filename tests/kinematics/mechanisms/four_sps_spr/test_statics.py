"""Forces of the 4-SPS + 1-SPR: the samples, virtual work, and what happens at singularities."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.four_sps_spr import inverse
from kinematics.mechanisms.four_sps_spr.statics import NAMES, legs, matrix
from tests.kinematics.mechanisms.four_sps_spr.machines import (
    general,
    pentagons,
    poses,
    preset,
    reference,
)

LOADS = st.lists(st.floats(-1e3, 1e3), min_size=6, max_size=6)


def test_forces_of_the_samples() -> None:
    design = pentagons()
    for sample in reference("sps_spr_samples")["samples"]:
        pose = np.append(sample["p"], inverse.euler_angles(np.array(sample["R"]).reshape(3, 3)))
        found = machine_of(design).statics.forces(pose, "", [*sample["F"], *sample["T"]])
        assert found.forces == pytest.approx(sample["forces"], rel=1e-9)
        assert found.names == NAMES


@pytest.mark.parametrize("design", [preset(), general(), general(7)])
@given(load=LOADS, seed=st.integers(0, 1000))
def test_virtual_work_vanishes_for_every_motion(design, load, seed: int) -> None:
    """Σ F_i δl_i + F_τ δc + load · δ(twist) = 0, for motions that break the constraint too."""
    pose = poses(design, 1, seed=seed, tilt=0.7)[0]
    found = machine_of(design).statics.forces(pose, "", load)
    g = matrix(legs(design, pose))
    scale = np.array([1.0, 1.0, 1.0, design.length, design.length, design.length])
    moves = np.random.default_rng(seed).normal(size=(8, 6)) / scale
    work = moves @ g.T @ found.forces + moves @ np.array(load)
    # 1e-12 of the works that cancel
    size = np.abs(moves @ g.T) @ np.abs(found.forces) + np.abs(moves) @ np.abs(load)
    assert (np.abs(work) <= 1e-12 * size + 1e-300).all()
    assert found.residual < 1e-11


@pytest.mark.parametrize("design", [preset(), general()])
def test_forces_act_through_the_joints(design) -> None:
    pose = poses(design, 1, seed=4)[0]
    system = machine_of(design).statics.wrenches(pose, "")
    tips = inverse.platform_points(design, pose)
    assert np.linalg.norm(system.rows[:, :3], axis=1) == pytest.approx(1.0)
    arms = system.point - pose[:3]
    assert system.rows[:, 3:] == pytest.approx(np.cross(arms, system.rows[:, :3]), abs=1e-10)
    assert system.point[:5] == pytest.approx(tips, abs=1e-10)
    assert system.point[5] == pytest.approx(design.base[4])
    # A leg pushes away from the base; the constraint is along the revolute axis.
    for i in range(5):
        assert system.rows[i, :3] @ (tips[i] - design.base[i]) > 0.0
    assert system.rows[5, :3] == pytest.approx(inverse.rotation(pose) @ design.axis)


def test_the_constraint_does_no_work() -> None:
    design = preset()
    pose = poses(design, 1, seed=9)[0]
    row = machine_of(design).statics.wrenches(pose, "").rows[5]
    base = np.array([5.0, -7.0, 11.0, 0.0, 0.0, 0.0]) * 1e-6
    moved = base - row * (row @ base) / (row @ row)
    r = inverse.rotation(pose)
    x, y, z = moved[3:]
    turn = np.eye(3) + np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    there = np.append(pose[:3] + moved[:3], inverse.euler_angles(turn @ r))
    assert abs(float(inverse.violation(design, there))) < 1e-9


def test_no_numbers_at_a_singularity_or_off_the_constraint() -> None:
    load = (0.0, 10.0, -10.0, 10.0, 0.0, 10.0)
    for design, pose in (
        (pentagons(), (0.0, 0.0, 560.0, 0.0, 0.0, 0.0)),
        (preset(), (10.0, 10.0, 560.0, 0.0, 0.0, 0.0)),
    ):
        assert np.isnan(machine_of(design).statics.forces(pose, "", load).forces).all()


def test_measures() -> None:
    design = preset()
    batch = poses(design, 6).reshape(2, 3, 6)
    load = (0.0, 10.0, -10.0, 10.0, 0.0, 10.0)
    for spec in machine_of(design).measures.specs:
        values = machine_of(design).measures(batch, "", spec.key, load if spec.needs_load else None)
        assert values.shape == (2, 3)
        assert (values > 0.0).all()
        if spec.needs_load:
            with pytest.raises(InputError, match="load"):
                machine_of(design).measures(batch, "", spec.key)
    with pytest.raises(InputError, match="conditioning"):
        machine_of(design).measures(batch, "", "beauty")
    level = (0.0, 0.0, 560.0, 0.0, 0.0, 0.0)
    assert machine_of(pentagons()).measures(level, "", "conditioning") == 0.0
    assert machine_of(pentagons()).measures(level, "", "manipulability") < 1e-12
