"""Rates, accelerations and forces against finite differences, each other and virtual work."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.machine import machine_of
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import KINDS, MODES, Kind
from kinematics.mechanisms.tripods.limbs import limb_lengths
from tests.kinematics.mechanisms.tripods.machines import machine, some_poses

BOTH = [(kind, mode) for kind in KINDS for mode in MODES]


@pytest.mark.parametrize(("kind", "mode"), BOTH)
def test_motion_is_that_of_finite_differences(
    kind: Kind, mode: str, rng: np.random.Generator
) -> None:
    design, poses = machine(kind), some_poses(rng, 40, farthest=1.2)
    rates, second = rng.normal(size=(2, 40, 3))
    found = machine_of(design).motion.inverse(poses, mode, rates, second)
    step = 1e-4

    def at(time: float) -> np.ndarray:
        return poses + time * rates + 0.5 * time**2 * second

    before, now, after = (limb_lengths(design, at(t), mode) for t in (-step, 0.0, step))
    np.testing.assert_allclose(
        found.joint_rates, (after - before) / (2 * step), rtol=1e-5, atol=1e-4
    )
    np.testing.assert_allclose(
        found.joint_accelerations, (after - 2 * now + before) / step**2, rtol=1e-4, atol=1e-2
    )
    before, now, after = (posing.transform(design, at(t), mode) for t in (-step, 0.0, step))
    spin = ((after - before)[:, :3, :3] / (2 * step)) @ now[:, :3, :3].swapaxes(1, 2)
    omega = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=-1)
    np.testing.assert_allclose(found.twist[:, :3], omega, atol=1e-6)
    moved = (after - before)[:, :3, 3] / (2 * step)
    np.testing.assert_allclose(found.twist[:, 3:], moved, rtol=1e-5, atol=1e-4)
    early, late = (
        machine_of(design).motion.inverse(at(t), mode, rates + t * second, second).twist
        for t in (-step, step)
    )
    np.testing.assert_allclose(found.twist_rate, (late - early) / (2 * step), rtol=1e-4, atol=1e-3)


@pytest.mark.parametrize(("kind", "mode"), BOTH)
def test_forward_motion_undoes_inverse_motion(
    kind: Kind, mode: str, rng: np.random.Generator
) -> None:
    design, poses = machine(kind), some_poses(rng, 100)
    good = np.abs(machine_of(design).statics.wrenches(poses, mode).determinant) > 1e-3
    poses = poses[good]
    rates, second = rng.normal(size=(2, len(poses), 3))
    there = machine_of(design).motion.inverse(poses, mode, rates, second)
    back = machine_of(design).motion.forward(
        poses, mode, there.joint_rates, there.joint_accelerations
    )
    np.testing.assert_allclose(back.pose_rates, rates, atol=1e-8)
    np.testing.assert_allclose(back.twist, there.twist, atol=1e-7, rtol=1e-9)
    np.testing.assert_allclose(back.pose_accelerations, second, atol=1e-5)


@pytest.mark.parametrize(("kind", "mode"), BOTH)
def test_forces_do_the_work_of_the_load(kind: Kind, mode: str, rng: np.random.Generator) -> None:
    design, poses = machine(kind), some_poses(rng, 100)
    rates = rng.normal(size=(100, 3))
    moved = machine_of(design).motion.inverse(poses, mode, rates)
    load = rng.normal(size=(100, 6)) * [1, 1, 1, 100, 100, 100]
    found = machine_of(design).statics.forces(poses, mode, load)
    work = (load[:, :3] * moved.twist[:, 3:]).sum(1) + (load[:, 3:] * moved.twist[:, :3]).sum(1)
    driven = (found.forces[:, :3] * moved.joint_rates).sum(axis=1)
    size = np.abs(found.forces[:, :3] * moved.joint_rates).sum(axis=1) + np.abs(work)
    assert (np.abs(driven + work) / size).max() < 1e-10
    assert found.residual.max() < 1e-10


@pytest.mark.parametrize(("kind", "mode"), BOTH)
def test_the_level_platform(kind: Kind, mode: str) -> None:
    """There the azimuth says nothing: lifting and tilting about it can be told, other turns not."""
    design, level = machine(kind), np.array([120.0, 0.0, 0.3])
    there = machine_of(design).motion.inverse(level, mode, [3.0, 0.5, 0.0], [1.0, 0.2, 0.0])
    back = machine_of(design).motion.forward(
        level, mode, there.joint_rates, there.joint_accelerations
    )
    np.testing.assert_allclose(back.pose_rates, [3.0, 0.5, 0.0], atol=1e-12)
    other = machine_of(design).motion.forward(level, mode, [1.0, -2.0, 0.7])
    assert np.isfinite(other.twist).all()
    assert np.isnan(other.pose_rates[1:]).all()
    assert np.isfinite(other.pose_rates[0])


@pytest.mark.parametrize(("kind", "mode"), BOTH)
def test_nothing_is_told_in_the_constraint_singularity(kind: Kind, mode: str) -> None:
    design, over = machine(kind), np.array([120.0, np.pi, 0.3])
    assert np.isnan(machine_of(design).motion.forward(over, mode, [1.0, 0.0, 0.0]).twist).all()
    assert np.isnan(machine_of(design).statics.forces(over, mode, [0, 0, -1, 0, 0, 0]).forces).all()
    assert np.isinf(machine_of(design).measures.condition(over, mode))
    assert machine_of(design).measures.singular_value(over, mode) < 1e-14
