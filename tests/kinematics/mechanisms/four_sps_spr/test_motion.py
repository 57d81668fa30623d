"""Velocity and acceleration of the 4-SPS + 1-SPR: to 40 digits, and by finite differences."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from kinematics.answers.motion import Motion
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.four_sps_spr import inverse
from kinematics.mechanisms.four_sps_spr.constraint import dependent_values
from kinematics.mechanisms.four_sps_spr.statics import legs, matrix
from tests.kinematics.mechanisms.four_sps_spr.machines import (
    general,
    pentagons,
    poses,
    preset,
    reference,
)

MACHINES = [preset(), general(), pentagons()]
SAMPLES = reference("sps_spr_samples")["samples"]


def inverse_motion(design, pose, *rates) -> Motion:
    return machine_of(design).motion.inverse(pose, "", *rates)


def forward_motion(design, pose, *rates) -> Motion:
    return machine_of(design).motion.forward(pose, "", *rates)


def statics(design, poses, load):
    return machine_of(design).statics.forces(poses, "", load)


def hessians(design, pose) -> np.ndarray:
    """H_1 … H_6 of eqs. 13 and 14, (6, 6, 6): VᵀH_iV is β of the mechanism where the legs' rates
    are those of V."""
    mechanism, placement = machine_of(design).mechanism, inverse.transform(pose)
    g = matrix(legs(design, pose))

    def along(v: np.ndarray) -> np.ndarray:
        return mechanism.bias(placement, "", v, g[:5] @ v)

    answer = np.empty((6, 6, 6))
    for j, one in enumerate(np.eye(6)):
        for k, two in enumerate(np.eye(6)):
            answer[:, j, k] = 0.5 * (along(one + two) - along(one) - along(two))
    return answer


def pose_of(sample) -> np.ndarray:
    r = np.array(sample["R"]).reshape(3, 3)
    return np.append(sample["p"], inverse.euler_angles(r))


@pytest.mark.parametrize("sample", SAMPLES)
def test_the_samples_both_ways(sample) -> None:
    design, pose = pentagons(), pose_of(sample)
    velocity, acceleration = np.array(sample["V"]), np.array(sample["A"])
    assert matrix(legs(design, pose)) == pytest.approx(
        np.array(sample["G"]).reshape(6, 6), abs=1e-9
    )
    bend = np.einsum("j,ijk,k->i", velocity, hessians(design, pose), velocity)
    assert bend == pytest.approx(sample["VHV"], abs=1e-9)
    there = forward_motion(design, pose, sample["ldot"], sample["lddot"])
    assert there.twist == pytest.approx([*velocity[3:], *velocity[:3]], rel=1e-9, abs=1e-10)
    assert there.twist_rate == pytest.approx(
        [*acceleration[3:], *acceleration[:3]], rel=1e-8, abs=1e-9
    )
    back = inverse_motion(design, pose, there.pose_rates, there.pose_accelerations)
    assert back.joint_rates == pytest.approx(sample["ldot"], abs=1e-9)
    assert back.joint_accelerations == pytest.approx(sample["lddot"], abs=1e-9)


# --- to 40 digits --------------------------------------------------------------------------


def mp_rotation(alpha, beta, gamma):
    ca, sa, cb, sb = mp.cos(alpha), mp.sin(alpha), mp.cos(beta), mp.sin(beta)
    cg, sg = mp.cos(gamma), mp.sin(gamma)
    z = mp.matrix([[ca, -sa, 0], [sa, ca, 0], [0, 0, 1]])
    y = mp.matrix([[cb, 0, sb], [0, 1, 0], [-sb, 0, cb]])
    x = mp.matrix([[1, 0, 0], [0, cg, -sg], [0, sg, cg]])
    return z * y * x


class Trajectory:
    """y, z and the angles as functions of time, x by the constraint, all to 40 digits."""

    def __init__(self, design) -> None:
        self.base = [mp.matrix([mp.mpf(v) for v in row]) for row in design.base.tolist()]
        self.platform = [mp.matrix([mp.mpf(v) for v in row]) for row in design.platform.tolist()]
        axis = mp.matrix([mp.mpf(v) for v in design.revolute_axis])
        self.axis = axis / mp.norm(axis)

    def pose(self, t):
        alpha = mp.mpf("0.3") * mp.sin(mp.mpf("1.1") * t)
        beta = mp.mpf("0.25") * mp.sin(mp.mpf("0.9") * t + mp.mpf("0.2"))
        gamma = -mp.mpf("0.2") * mp.sin(mp.mpf("1.3") * t + mp.mpf("0.4"))
        y = 60 * mp.sin(t)
        z = 520 + 40 * mp.cos(mp.mpf("0.8") * t)
        m = mp_rotation(alpha, beta, gamma) * self.axis
        rest = mp.matrix([0, y, z])
        offset = self.dot(self.platform[4], self.axis)
        x = (self.dot(self.base[4] - rest, m) - offset) / m[0]
        return [x, y, z, alpha, beta, gamma]

    def length(self, i: int, t):
        pose = self.pose(t)
        leg = mp.matrix(pose[:3]) + mp_rotation(*pose[3:]) * self.platform[i] - self.base[i]
        return mp.norm(leg)

    @staticmethod
    def dot(a, b):
        return sum(a[k] * b[k] for k in range(3))


@pytest.mark.parametrize("design", MACHINES)
@pytest.mark.parametrize("t", [0.3, 1.7])
def test_rates_and_accelerations_to_forty_digits(design, t: float) -> None:
    with mp.workdps(40):
        way, when = Trajectory(design), mp.mpf(t)
        h = mp.mpf("1e-10")
        pose, first, second = (
            [mp.diff(lambda s, k=k: way.pose(s)[k], when, n, h=h) for k in range(6)]
            for n in (0, 1, 2)
        )
        rates = [float(mp.diff(lambda s, i=i: way.length(i, s), when, 1, h=h)) for i in range(5)]
        bends = [float(mp.diff(lambda s, i=i: way.length(i, s), when, 2, h=h)) for i in range(5)]
        pose, first, second = ([float(v) for v in values] for values in (pose, first, second))
    # x follows from the constraint, and so do its derivatives.
    there = inverse_motion(design, pose, [np.nan, *first[1:]], [np.nan, *second[1:]])
    assert there.pose_rates[0] == pytest.approx(first[0], rel=1e-11, abs=1e-11)
    assert there.pose_accelerations[0] == pytest.approx(second[0], rel=1e-10, abs=1e-10)
    assert there.joint_rates == pytest.approx(rates, rel=1e-11, abs=1e-11)
    assert there.joint_accelerations == pytest.approx(bends, rel=1e-10, abs=1e-10)
    back = forward_motion(design, pose, rates, bends)
    loose = 1e-8 if design == pentagons() else 1e-9
    assert back.pose_rates == pytest.approx(first, rel=loose, abs=loose)
    assert back.pose_accelerations == pytest.approx(second, rel=loose, abs=10 * loose)


@pytest.mark.parametrize("design", [preset(), general()])
def test_the_printed_hessian_is_not_the_second_derivative(design) -> None:
    """With +r̂² instead of −r̂² in H_i the accelerations come out wrong."""
    pose = poses(design, 1, seed=3)[0]
    rates = np.array([np.nan, 20.0, -30.0, 0.2, -0.3, 0.4])
    right = inverse_motion(design, pose, rates)
    printed = hessians(design, pose).copy()
    at = legs(design, pose)
    for i in range(5):
        x, y, z = at.arm[i]
        skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        printed[i, 3:, 3:] += 2.0 * skew @ skew / at.length[i]
    v = np.concatenate([right.twist[3:], right.twist[:3]])
    wrong = np.einsum("j,ijk,k->i", v, printed, v)[:5]
    good = np.einsum("j,ijk,k->i", v, hessians(design, pose), v)[:5]
    assert np.abs(wrong - good).max() > 1.0  # mm/s²


# --- a whole trajectory --------------------------------------------------------------------


def trajectory(design, count: int = 2001):
    """Poses, rates and accelerations by analytic laws; x by the constraint."""
    t = np.linspace(0.0, 6.0, count)
    laws = [
        (60.0 * np.sin(t), 60.0 * np.cos(t), -60.0 * np.sin(t)),
        (
            540.0 + 40.0 * np.cos(0.8 * t),
            -32.0 * np.sin(0.8 * t),
            -25.6 * np.cos(0.8 * t),
        ),
        (0.3 * np.sin(1.1 * t), 0.33 * np.cos(1.1 * t), -0.363 * np.sin(1.1 * t)),
        (0.2 * np.sin(0.9 * t), 0.18 * np.cos(0.9 * t), -0.162 * np.sin(0.9 * t)),
        (-0.2 * np.sin(1.3 * t), -0.26 * np.cos(1.3 * t), 0.338 * np.sin(1.3 * t)),
    ]
    free = np.full(count, np.nan)
    poses, rates, accelerations = (
        np.column_stack([free, *(law[n] for law in laws)]) for n in range(3)
    )
    poses[:, 0] = dependent_values(design, poses, 0)[:, 0]
    return t, poses, rates, accelerations


@pytest.mark.parametrize("design", [preset(), general(3)])
def test_a_trajectory_by_finite_differences_and_its_load_by_energy(design) -> None:
    t, poses_, rates, accelerations = trajectory(design)
    found = inverse_motion(design, poses_, rates, accelerations)
    step = t[1] - t[0]
    lengths = inverse.leg_lengths(design, poses_)
    first = (lengths[2:] - lengths[:-2]) / (2.0 * step)
    second = (lengths[2:] - 2.0 * lengths[1:-1] + lengths[:-2]) / step**2
    assert found.joint_rates[1:-1] == pytest.approx(first, rel=1e-4, abs=2e-3)
    assert found.joint_accelerations[1:-1] == pytest.approx(second, rel=1e-4, abs=5e-3)
    # The twist against the rotation's own difference.
    r = inverse.rotation(poses_)
    spin = (r[2:] - r[:-2]) / (2.0 * step) @ r[1:-1].swapaxes(-1, -2)
    turning = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
    assert found.twist[1:-1, :3] == pytest.approx(turning, abs=2e-6)
    # A constant force has a potential: what the legs do in all is the work against it.
    force = np.array([0.0, 10.0, -10.0])
    forces = statics(design, poses_, [*force, 0.0, 0.0, 0.0]).forces[:, :5]
    power = (forces * found.joint_rates).sum(axis=1)
    work = np.trapezoid(power, t)
    assert work == pytest.approx(-force @ (poses_[-1, :3] - poses_[0, :3]), abs=2e-3)
    # With a moment, power against power at every instant.
    load = np.array([0.0, 10.0, -10.0, 10.0, 0.0, 10.0])
    forces = statics(design, poses_, load).forces[:, :5]
    power = (forces * found.joint_rates).sum(axis=1)
    against = found.twist[:, 3:] @ load[:3] + found.twist[:, :3] @ load[3:]
    assert power == pytest.approx(-against, rel=1e-9, abs=1e-8)


@pytest.mark.parametrize("design", MACHINES)
def test_forward_and_inverse_are_each_others(design) -> None:
    rng = np.random.default_rng(5)
    there = poses(design, 30, seed=6, tilt=0.7)
    rates, accelerations = rng.normal(size=(2, 30, 5)) * 20.0
    out = forward_motion(design, there, rates, accelerations)
    back = inverse_motion(design, there, out.pose_rates, out.pose_accelerations)
    size = np.abs(out.twist_rate).max(axis=1, keepdims=True)
    assert (np.abs(back.joint_rates - rates) < 1e-9 * (1.0 + size)).all()
    assert (np.abs(back.joint_accelerations - accelerations) < 1e-8 * (1.0 + size)).all()


def test_rates_that_violate_the_constraint_are_refused() -> None:
    design = preset()
    pose = poses(design, 1)[0]
    with pytest.raises(InputError, match="leave one of"):
        inverse_motion(design, pose, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    with pytest.raises(InputError, match="one of the six may be NaN"):
        inverse_motion(design, pose, [np.nan, np.nan, 0.0, 0.0, 0.0, 0.0])


def test_nothing_is_determined_at_a_singularity_or_off_the_constraint() -> None:
    level = forward_motion(pentagons(), (0.0, 0.0, 560.0, 0.0, 0.0, 0.0), np.ones(5))
    assert np.isnan(level.twist).all()
    off = forward_motion(preset(), (9.0, 9.0, 560.0, 0.0, 0.0, 0.0), np.ones(5))
    assert np.isnan(off.twist).all()


def test_angles_have_no_rates_at_their_pole_but_the_platform_has() -> None:
    design = preset()
    pose = (*poses(design, 1)[0][:3], 0.3, np.pi / 2, 0.1)
    from kinematics.mechanisms.four_sps_spr.constraint import complete_pose

    found = forward_motion(design, complete_pose(design, pose), np.ones(5))
    assert np.isfinite(found.twist).all()
    assert np.isnan(found.pose_rates[3:]).all()
