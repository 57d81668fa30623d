"""Wrenches and forces: virtual work, power, reference points, rigid motions, singularities."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inverse import joint_points
from kinematics.mechanisms.five_rpur.statics import NAMES
from tests.kinematics.mechanisms.five_rpur.asked import (
    condition,
    forward_motion,
    inverse_motion,
    statics,
    twists,
    wrench_matrix,
    wrench_system,
)
from tests.kinematics.mechanisms.five_rpur.closing import closing_poses, lengths
from tests.kinematics.mechanisms.five_rpur.machines import preset


def held_poses(design: FiveRPURDesign, count: int, seed: int) -> tuple[Array, Array]:
    poses, sigma = closing_poses(design, 3 * count, seed)
    good = condition(design, poses, sigma) < 1e3
    poses, sigma = poses[good][:count], sigma[good][:count]
    assert len(poses) == count
    return poses, sigma


def loads(count: int, seed: int) -> Array:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 6)) * [50, 50, 50, 2e3, 2e3, 2e3]


def test_rows_are_unit_lines_through_the_u_joints_and_a_unit_couple() -> None:
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 200, seed=1)
    system = wrench_system(design, poses, sigma)
    assert system.names == NAMES
    assert [name.kind for name in NAMES] == ["actuation"] * 5 + ["constraint"]
    assert [name.limb for name in NAMES] == [1, 2, 3, 4, 5, None]
    force, moment = system.rows[..., :3], system.rows[..., 3:]
    np.testing.assert_allclose(np.linalg.norm(force[:, :5], axis=-1), 1.0, atol=1e-12)
    np.testing.assert_allclose((force * moment).sum(axis=-1), 0.0, atol=1e-9)  # Plücker
    _, b, _ = joint_points(design, poses, sigma)
    np.testing.assert_array_equal(system.point[:, :5], b)
    arm = system.point - poses[:, None, :3]
    np.testing.assert_allclose(moment[:, :5], np.cross(arm, force)[:, :5], atol=1e-9)
    np.testing.assert_array_equal(force[:, 5], 0.0)
    np.testing.assert_allclose(np.linalg.norm(moment[:, 5], axis=-1), 1.0)
    np.testing.assert_array_equal(system.point[:, 5], poses[:, :3])
    assert not system.rows.flags.writeable


def test_the_determinant_is_that_of_the_wrench_matrix_with_unit_forces() -> None:
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 200, seed=2)
    length = design.length
    plain = wrench_matrix(design, poses, sigma, length=length)
    size = np.linalg.norm(plain[:, :5, :3], axis=-1).prod(axis=-1)
    found = wrench_system(design, poses, sigma).determinant
    np.testing.assert_allclose(found, np.linalg.det(plain) / size, rtol=1e-9, atol=1e-12)


def test_forces_hold_the_load() -> None:
    design = preset("rpur-table1")
    poses, sigma = held_poses(design, 300, seed=3)
    load = loads(300, 4)
    found = statics(design, poses, sigma, load)
    assert found.residual.max() < 1e-12
    # Actuator forces by the multiples of their lines: F = λ f·û.
    system = wrench_system(design, poses, sigma)
    a, b, _ = joint_points(design, poses, sigma)
    u = (b - a) / np.linalg.norm(b - a, axis=-1, keepdims=True)
    gain = (system.rows[:, :5, :3] * u).sum(axis=-1)
    multiples = np.concatenate([found.forces[:, :5] / gain, found.forces[:, 5:]], axis=-1)
    total = (multiples[:, :, None] * system.rows).sum(axis=1) + load
    np.testing.assert_allclose(total, 0.0, atol=1e-8)


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table2", "rpur-a3a3"])
def test_virtual_work_vanishes(name: str) -> None:
    """Σ F_i δρ_i + load·δ = 0 for every motion that the mechanism allows."""
    design = preset(name)
    poses, sigma = held_poses(design, 200, seed=5)
    load = loads(200, 6)
    forces = statics(design, poses, sigma, load).forces
    rng = np.random.default_rng(7)
    for _ in range(5):
        rates = rng.normal(size=(200, 5)) * [100, 100, 100, 1, 1]
        motion = inverse_motion(design, poses, sigma, rates)
        done = forces[:, :5] * motion.joint_rates
        twist = motion.twist
        by_load = load * np.concatenate([twist[:, 3:], twist[:, :3]], axis=-1)
        work = done.sum(axis=-1) + by_load.sum(axis=-1)
        size = np.abs(done).sum(axis=-1) + np.abs(by_load).sum(axis=-1)
        assert (np.abs(work) / size).max() < 1e-12


def test_power_against_lengths_by_finite_differences() -> None:
    """What actuators give is what the load takes, whatever this library calls a Jacobian."""
    design = preset("rpur-table1")
    poses, sigma = held_poses(design, 100, seed=8)
    load = loads(100, 9)
    forces = statics(design, poses, sigma, load).forces
    rates = np.random.default_rng(10).normal(size=(100, 5)) * [100, 100, 100, 1, 1]
    step = 1e-6
    ahead, behind = poses + step * rates, poses - step * rates
    given = forces[:, :5] * (lengths(design, ahead, sigma) - lengths(design, behind, sigma))
    twist = twists(poses, rates)
    taken = load[:, :3] * twist[:, 3:] + load[:, 3:] * twist[:, :3]
    power = given.sum(axis=-1) / (2 * step) + taken.sum(axis=-1)
    size = np.abs(given).sum(axis=-1) / (2 * step) + np.abs(taken).sum(axis=-1)
    assert (np.abs(power) / size).max() < 1e-6


def test_the_couple_does_no_work_and_carries_what_actuators_cannot() -> None:
    design = preset("rpur-table1")
    poses, sigma = held_poses(design, 50, seed=11)
    couple = wrench_system(design, poses, sigma).rows[:, 5]
    found = statics(design, poses, sigma, 700.0 * couple)
    np.testing.assert_allclose(found.forces[:, :5], 0.0, atol=1e-7)
    np.testing.assert_allclose(found.forces[:, 5], -700.0)


def test_a_positive_force_pushes() -> None:
    """All five limbs below the platform: a weight on it is pushed up by someone."""
    design = preset("rpur-table2")
    poses, sigma = held_poses(design, 200, seed=12)
    a, b, _ = joint_points(design, poses, sigma)
    u = (b - a) / np.linalg.norm(b - a, axis=-1, keepdims=True)
    system = wrench_system(design, poses, sigma)
    push = np.zeros((200, 6))
    # The load that limb 1 alone holds: its own line, turned round.
    gain = (system.rows[:, 0, :3] * u[:, 0]).sum(axis=-1)
    push[:] = -system.rows[:, 0] * np.sign(gain)[:, None]
    forces = statics(design, poses, sigma, push).forces
    assert (forces[:, 0] > 0.0).all()
    np.testing.assert_allclose(forces[:, 0], np.abs(gain), atol=1e-9)
    np.testing.assert_allclose(forces[:, 1:5], 0.0, atol=1e-7)


# --- frames and points ---------------------------------------------------------------------


def moved_design(design: FiveRPURDesign, r: Array, shift: Array) -> FiveRPURDesign:
    limbs = tuple(
        replace(limb, base=tuple((r @ np.array(limb.base) + shift).tolist()))
        for limb in design.limbs
    )
    return replace(design, limbs=limbs)


def test_rigid_motion_changes_no_force() -> None:
    design = preset("rpur-table1")
    poses, sigma = held_poses(design, 50, seed=13)
    load = loads(50, 14)
    turn, shift = -1.1, np.array([300.0, 20.0, -80.0])
    c, s = np.cos(turn), np.sin(turn)
    r = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    other = moved_design(design, r, shift)
    moved = np.column_stack([poses[:, :3] @ r.T + shift, poses[:, 3], poses[:, 4] + turn])
    carried = np.column_stack([load[:, :3] @ r.T, load[:, 3:] @ r.T])
    one, two = statics(design, poses, sigma, load), statics(other, moved, sigma, carried)
    size = np.abs(one.forces).max(axis=-1, keepdims=True)
    assert (np.abs(two.forces - one.forces) / size).max() < 1e-9
    np.testing.assert_allclose(
        wrench_system(other, moved, sigma).determinant,
        wrench_system(design, poses, sigma).determinant,
        rtol=1e-8,
        atol=1e-12,
    )


def test_another_reference_point_on_the_platform_changes_no_force_and_no_determinant() -> None:
    """O' moved within the platform: the same machine, with other numbers for its pose and load."""
    design = preset("rpur-table1")
    poses, sigma = held_poses(design, 50, seed=15)
    load = loads(50, 16)
    offset = np.array([12.0, -30.0, 25.0])
    limbs = tuple(
        replace(limb, platform=tuple((np.array(limb.platform) - offset).tolist()))
        for limb in design.limbs
    )
    other = replace(design, limbs=limbs)
    phi, theta = poses[:, 3], poses[:, 4]
    rows = [
        [np.cos(theta), np.sin(phi) * np.sin(theta), np.cos(phi) * np.sin(theta)],
        [0 * phi, np.cos(phi), -np.sin(phi)],
        [-np.sin(theta), np.sin(phi) * np.cos(theta), np.cos(phi) * np.cos(theta)],
    ]
    arm = np.stack([sum(v * o for v, o in zip(row, offset, strict=True)) for row in rows], axis=-1)
    moved = poses.copy()
    moved[:, :3] += arm
    about = load.copy()
    about[:, 3:] -= np.cross(arm, load[:, :3])
    one, two = statics(design, poses, sigma, load), statics(other, moved, sigma, about)
    size = np.abs(one.forces).max(axis=-1, keepdims=True)
    assert (np.abs(two.forces - one.forces) / size).max() < 1e-9
    np.testing.assert_allclose(
        wrench_system(other, moved, sigma).determinant,
        wrench_system(design, poses, sigma).determinant,
        rtol=1e-7,
        atol=1e-11,
    )


# --- batches, singularities ----------------------------------------------------------------


def test_batches_broadcast() -> None:
    design = preset("rpur-table1")
    poses, _ = closing_poses(design, 3, seed=17)
    many = statics(design, poses[:, None], "+-+++", loads(4, 18))
    assert many.forces.shape == (3, 4, 6)
    assert many.residual.shape == (3, 4)
    one = statics(design, poses[1], "+-+++", loads(4, 18)[2])
    np.testing.assert_allclose(many.forces[1, 2], one.forces)
    assert not many.forces.flags.writeable


def test_a_limb_in_a_serial_singularity_needs_no_force() -> None:
    limb = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 150.0, (250.0, 400.0))
    design = FiveRPURDesign((limb, *preset("rpur-table1").limbs[1:]))
    found = statics(design, (20.0, 150.0, 300.0, 0.0, 0.0), "+++++", [1, 2, 3, 40, 50, 60])
    assert found.forces[0] == pytest.approx(0.0, abs=1e-12)
    assert np.isfinite(found.forces).all()
    assert found.residual < 1e-12


def test_nothing_holds_at_a_parallel_singularity_nor_with_an_open_limb() -> None:
    limb = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 150.0, (0.0, 400.0))
    design = FiveRPURDesign((limb, *preset("rpur-table1").limbs[1:]))
    one = FiveRPURDesign((limb, limb, *preset("rpur-table1").limbs[2:]))  # two limbs coincide
    load = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    poses = [
        (one, (20.0, 60.0, 300.0, 0.0, 0.0)),
        (design, (0.0, 170.0, 120.0, 0.0, 0.0)),  # open
        (design, (0.0, 90.0, 120.0, 0.0, 0.0)),  # ρ = 0
        (design, (20.0, 150.0, 0.0, 0.0, 0.0)),  # link along e1, actuator along e2
    ]
    for machine, pose in poses:
        found = statics(machine, pose, "+++++", load)
        assert np.isnan(found.forces).all()
        assert np.isnan(found.residual)
    assert wrench_system(one, poses[0][1], "+++++").determinant == pytest.approx(0.0, abs=1e-15)
    assert np.isnan(wrench_system(design, poses[1][1], "+++++").determinant)


def test_near_a_parallel_singularity_forces_grow_and_are_still_right() -> None:
    """Next to a fold: forces like 1/distance, residuals small, power still balanced."""
    limb = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 150.0, (250.0, 400.0))
    rest = preset("rpur-table1").limbs[2:]
    load = np.array([10.0, -20.0, 30.0, 400.0, 500.0, -600.0])
    pose = np.array([20.0, 60.0, 300.0, 0.1, 0.2])
    sizes = []
    for gap in (1e-1, 1e-3, 1e-5):
        twin = replace(limb, base=(gap, 0.0, 0.0))
        design = FiveRPURDesign((limb, twin, *rest))
        found = statics(design, pose, "+++++", load)
        assert found.residual < 1e-9
        sizes.append(np.abs(found.forces).max())
        rates = forward_motion(design, pose, "+++++", [1.0, 1.0, 0.0, 0.0, 0.0])
        back = inverse_motion(design, pose, "+++++", rates.pose_rates)
        np.testing.assert_allclose(back.joint_rates, [1.0, 1.0, 0.0, 0.0, 0.0], atol=1e-8)
    assert sizes[1] / sizes[0] == pytest.approx(100, rel=0.1)
    assert sizes[2] / sizes[1] == pytest.approx(100, rel=0.1)


@pytest.mark.parametrize("load", [[1.0, 2.0, 3.0], [1, 2, 3, 4, 5, np.nan]])
def test_broken_loads_are_refused(load: list[float]) -> None:
    with pytest.raises(InputError, match="a load must"):
        statics(preset("rpur-table1"), (20.0, 100.0, 300.0, 0.0, 0.0), "+++++", load)
