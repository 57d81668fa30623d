"""Rates and accelerations against finite differences, each other, and the platform itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inverse import transform
from tests.kinematics.mechanisms.five_rpur.asked import (
    condition,
    forward_motion,
    hessian,
    inverse_jacobian,
    inverse_motion,
    pose_rates_of,
    twists,
)
from tests.kinematics.mechanisms.five_rpur.closing import closing_poses, lengths
from tests.kinematics.mechanisms.five_rpur.machines import preset

NAMES = ["rpur-table1", "rpur-table2", "rpur-mpa3"]


def random_rates(count: int, seed: int) -> tuple[Array, Array]:
    """Rates and accelerations of the pose, of a size that a machine might have."""
    rng = np.random.default_rng(seed)
    scale = np.array([100.0, 100.0, 100.0, 1.0, 1.0])
    return scale * rng.normal(size=(count, 5)), 3.0 * scale * rng.normal(size=(count, 5))


def derivatives(values: Array, step: float) -> tuple[Array, Array]:
    """First and second derivative at the middle of nine equidistant values, axis 0."""
    first = np.array([3, -32, 168, -672, 0, 672, -168, 32, -3]) / 840.0
    second = np.array([-9, 128, -1008, 8064, -14350, 8064, -1008, 128, -9]) / 5040.0
    return (
        np.tensordot(first, values, 1) / step,
        np.tensordot(second, values, 1) / step**2,
    )


@pytest.mark.parametrize("name", NAMES)
def test_the_hessian_is_the_derivative_of_the_jacobian(name: str) -> None:
    design = preset(name)
    poses, sigma = closing_poses(design, 300, seed=1)
    bend = hessian(design, poses, sigma)
    np.testing.assert_array_equal(bend, bend.swapaxes(-1, -2))
    for k, step in enumerate([1e-2, 1e-2, 1e-2, 1e-4, 1e-4]):
        ahead = np.arange(-4, 5)[:, None, None] * step * np.eye(5)[k]
        numeric, _ = derivatives(inverse_jacobian(design, poses + ahead, sigma), step)
        size = np.abs(bend[..., k]).max()
        np.testing.assert_allclose(bend[..., k], numeric, rtol=1e-6, atol=1e-8 * size)


@pytest.mark.parametrize("name", NAMES)
def test_inverse_motion_along_a_curve_is_that_of_the_lengths(name: str) -> None:
    design = preset(name)
    poses, sigma = closing_poses(design, 300, seed=2)
    rates, second = random_rates(300, 3)
    found = inverse_motion(design, poses, sigma, rates, second)
    step = 2e-5  # s
    t = np.arange(-4, 5)[:, None, None] * step
    along = lengths(design, poses + t * rates + 0.5 * t * t * second, sigma)
    first, acceleration = derivatives(along, step)
    np.testing.assert_allclose(found.joint_rates, first, rtol=1e-7, atol=1e-5)
    size = np.abs(found.joint_accelerations).max()
    np.testing.assert_allclose(found.joint_accelerations, acceleration, rtol=1e-3, atol=1e-5 * size)
    np.testing.assert_array_equal(found.pose_rates, rates)
    np.testing.assert_array_equal(found.pose_accelerations, second)


def test_the_twist_is_that_of_the_platform() -> None:
    poses, _ = closing_poses(preset("rpur-table1"), 100, seed=4)
    rates, second = random_rates(100, 5)
    found = inverse_motion(preset("rpur-table1"), poses, "+++++", rates, second)
    step = 1e-3
    t = np.arange(-4, 5)[:, None, None] * step
    placed = transform(poses + t * rates + 0.5 * t * t * second)
    first, acceleration = derivatives(placed, step)
    turning = first[:, :3, :3] @ placed[4, :, :3, :3].swapaxes(-1, -2)
    omega = np.stack([turning[:, 2, 1], turning[:, 0, 2], turning[:, 1, 0]], axis=-1)
    np.testing.assert_allclose(found.twist[:, :3], omega, atol=1e-8)
    np.testing.assert_allclose(found.twist[:, 3:], first[:, :3, 3], atol=1e-6)
    # d/dt of Q̇ Qᵀ is α× ; Q̈ Qᵀ = α× + ω×ω×.
    product = acceleration[:, :3, :3] @ placed[4, :, :3, :3].swapaxes(-1, -2)
    skew = 0.5 * (product - product.swapaxes(-1, -2))
    alpha = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=-1)
    np.testing.assert_allclose(found.twist_rate[:, :3], alpha, atol=1e-5)
    np.testing.assert_allclose(found.twist_rate[:, 3:], second[:, :3])


@pytest.mark.parametrize("name", NAMES)
def test_forward_motion_undoes_inverse_motion(name: str) -> None:
    design = preset(name)
    poses, sigma = closing_poses(design, 400, seed=6)
    held = condition(design, poses, sigma) < 1e4
    assert held.mean() > 0.7
    poses, sigma = poses[held], sigma[held]
    rates, second = random_rates(len(poses), 7)
    there = inverse_motion(design, poses, sigma, rates, second)
    back = forward_motion(design, poses, sigma, there.joint_rates, there.joint_accelerations)
    np.testing.assert_allclose(back.pose_rates, rates, rtol=1e-8, atol=1e-8)
    size = np.abs(there.joint_accelerations).max(axis=-1, keepdims=True)
    error = np.abs(back.pose_accelerations - second) / (size + np.abs(second))
    assert error.max() < 1e-8
    np.testing.assert_allclose(back.twist, there.twist, rtol=1e-7, atol=1e-7)


def test_forward_motion_follows_the_assembly_mode() -> None:
    """The pose from its own rates and accelerations has the lengths that were asked for."""
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 300, seed=8)
    held = condition(design, poses, sigma) < 50
    poses, sigma = poses[held], sigma[held]
    rng = np.random.default_rng(9)
    rates, second = 30 * rng.normal(size=poses.shape), 50 * rng.normal(size=poses.shape)
    found = forward_motion(design, poses, sigma, rates, second)
    errors = []
    for t in (4e-4, 2e-4):
        ahead = poses + t * found.pose_rates + 0.5 * t * t * found.pose_accelerations
        wanted = lengths(design, poses, sigma) + t * rates + 0.5 * t * t * second
        errors.append(np.abs(lengths(design, ahead, sigma) - wanted).max(axis=-1))
    # What is left over is of third order.
    assert np.median(errors[0] / errors[1]) == pytest.approx(8.0, rel=0.05)
    assert errors[1].max() < 1e-3


def test_accelerations_left_out_are_zero() -> None:
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 20, seed=10)
    rates, _ = random_rates(20, 11)
    one = inverse_motion(design, poses, sigma, rates)
    two = inverse_motion(design, poses, sigma, rates, np.zeros((20, 5)))
    np.testing.assert_array_equal(one.joint_accelerations, two.joint_accelerations)
    assert np.abs(one.joint_accelerations).min() > 0.0  # a straight pose path bends in joints
    three = forward_motion(design, poses, sigma, one.joint_rates)
    assert (three.joint_accelerations == 0.0).all()


def test_batches_broadcast_and_are_read_only() -> None:
    design = preset("rpur-table1")
    poses, _ = closing_poses(design, 6, seed=12)
    rates, second = random_rates(4, 13)
    found = inverse_motion(design, poses[:, None], "+-+++", rates, second)
    assert found.joint_rates.shape == found.pose_rates.shape == (6, 4, 5)
    assert found.twist.shape == found.twist_rate.shape == (6, 4, 6)
    one = inverse_motion(design, poses[2], "+-+++", rates[3], second[3])
    np.testing.assert_allclose(found.joint_accelerations[2, 3], one.joint_accelerations)
    np.testing.assert_allclose(found.twist_rate[2, 3], one.twist_rate)
    back = forward_motion(design, poses[:, None], "+-+++", found.joint_rates[0])
    assert back.pose_rates.shape == (6, 4, 5)
    assert not any(
        getattr(found, key).flags.writeable for key in ("joint_rates", "twist", "pose_rates")
    )
    many = inverse_motion(design, poses[0], np.array([[1.0] * 5, [-1.0] * 5]), rates[0])
    assert many.joint_rates.shape == (2, 5)


def test_rates_do_not_depend_on_where_the_base_frame_stands() -> None:
    """Moved by what keeps e1: along any direction, and turned about y."""
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 50, seed=14)
    rates, second = random_rates(50, 15)
    turn, shift = 0.7, np.array([30.0, -20.0, 55.0])
    c, s = np.cos(turn), np.sin(turn)
    r = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    limbs = tuple(
        replace(limb, base=tuple((r @ np.array(limb.base) + shift).tolist()))
        for limb in design.limbs
    )
    other = replace(design, limbs=limbs)
    moved = np.column_stack([poses[:, :3] @ r.T + shift, poses[:, 3], poses[:, 4] + turn])

    def carried(values: Array) -> Array:
        return np.column_stack([values[:, :3] @ r.T, values[:, 3:]])

    one = inverse_motion(design, poses, sigma, rates, second)
    two = inverse_motion(other, moved, sigma, carried(rates), carried(second))
    np.testing.assert_allclose(two.joint_rates, one.joint_rates, rtol=1e-9, atol=1e-8)
    size = np.abs(one.joint_accelerations).max()
    np.testing.assert_allclose(
        two.joint_accelerations, one.joint_accelerations, rtol=1e-8, atol=1e-10 * size
    )
    np.testing.assert_allclose(two.twist[:, :3], one.twist[:, :3] @ r.T, atol=1e-12)
    np.testing.assert_allclose(two.twist_rate[:, :3], one.twist_rate[:, :3] @ r.T, atol=1e-11)


# --- at and near singularities -------------------------------------------------------------

SERIAL_AT = (20.0, 150.0, 300.0, 0.0, 0.0)


def with_plain_first_limb(stroke: tuple[float, float] = (250.0, 400.0)) -> FiveRPURDesign:
    limb = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 150.0, stroke)
    return FiveRPURDesign((limb, *preset("rpur-table1").limbs[1:]))


def test_at_a_serial_singularity_one_limb_is_undetermined_and_forward_rates_exist() -> None:
    design = with_plain_first_limb()
    found = inverse_motion(design, SERIAL_AT, "+++++", [1.0, 2.0, 3.0, 0.1, 0.2])
    assert np.isnan(found.joint_rates[0])
    assert np.isfinite(found.joint_rates[1:]).all()
    assert np.isnan(found.joint_accelerations[0])
    assert np.isfinite(found.joint_accelerations[1:]).all()
    assert np.isfinite(found.twist).all()
    back = forward_motion(design, SERIAL_AT, "+++++", [5.0, 1.0, -2.0, 3.0, 0.5])
    assert np.isfinite(back.pose_rates).all()
    assert np.isnan(back.pose_accelerations).all()
    # The limit from inside the workspace, and the link forbids motion along e1.
    near = forward_motion(
        design, (20.0, 150.0 - 1e-9, 300.0, 0.0, 0.0), "+++++", [5.0, 1.0, -2.0, 3.0, 0.5]
    )
    np.testing.assert_allclose(back.pose_rates, near.pose_rates, atol=1e-3)
    assert back.pose_rates[1] == pytest.approx(0.0, abs=1e-9)


def test_at_a_parallel_singularity_forward_motion_is_nan_and_inverse_is_not() -> None:
    design = preset("rpur-table2")
    # All platform points at one height about a line along e2: nobody resists a turn about it.
    limbs = tuple(
        replace(limb, platform=(limb.platform[0] + 7.0 * i, 10.0, -5.0))
        for i, limb in enumerate(design.limbs)
    )
    bad = replace(design, limbs=limbs)
    pose = (60.0, 60.0, 300.0, 0.0, 0.1)
    assert np.isfinite(inverse_motion(bad, pose, "+++++", [1, 2, 3, 0.1, 0.1]).joint_rates).all()
    found = forward_motion(bad, pose, "+++++", [1.0, 2.0, 3.0, 4.0, 5.0])
    assert np.isnan(found.pose_rates).all()
    assert np.isnan(found.twist).all()


def test_open_limbs_and_no_length_are_nan_without_warnings() -> None:
    design = with_plain_first_limb((0.0, 400.0))
    for pose in ((0.0, 90.0, 120.0, 0.0, 0.0), (0.0, 170.0, 120.0, 0.0, 0.0)):
        found = inverse_motion(design, pose, "+++++", [1.0, 1.0, 1.0, 0.1, 0.1])
        assert np.isnan(found.joint_rates[0])
        assert np.isnan(forward_motion(design, pose, "+++++", [1.0] * 5).pose_rates).all()


def test_near_a_serial_singularity_the_numbers_are_still_right() -> None:
    design = with_plain_first_limb()
    rates = np.array([10.0, 0.0, -5.0, 0.05, 0.1])  # not along e1, so it stays near
    for distance in (1.0, 1e-2, 1e-4):
        pose = np.array([20.0, 150.0 - distance, 300.0, 0.0, 0.0])
        found = inverse_motion(design, pose, "+++++", rates)
        back = forward_motion(design, pose, "+++++", found.joint_rates, found.joint_accelerations)
        np.testing.assert_allclose(back.pose_rates, rates, atol=1e-8)
        np.testing.assert_allclose(back.pose_accelerations, 0.0, atol=1e-5)


@pytest.mark.parametrize(
    ("rates", "said"),
    [
        ([1.0, 2.0], "the rates of a pose must have 5 numbers"),
        ([1.0, 2.0, 3.0, 4.0, np.nan], "the rates of a pose must be finite"),
    ],
)
def test_broken_rates_are_refused(rates: list[float], said: str) -> None:
    design = preset("rpur-table1")
    with pytest.raises(InputError, match=said):
        inverse_motion(design, SERIAL_AT, "+++++", rates)
    with pytest.raises(InputError, match="the rates of the actuators"):
        forward_motion(design, SERIAL_AT, "+++++", rates)


def test_twists_and_pose_rates_are_each_others_inverse() -> None:
    rng = np.random.default_rng(16)
    poses, rates = rng.normal(size=(30, 5)), rng.normal(size=(30, 5))
    np.testing.assert_allclose(pose_rates_of(poses, twists(poses, rates)), rates, atol=1e-14)
