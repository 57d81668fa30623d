"""Rates, accelerations, statics and measures: finite differences, both ways, work."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.five_bar import statics
from kinematics.mechanisms.five_bar.inverse import MODES, joints_of
from tests.kinematics.mechanisms.five_bar.conftest import MACHINES, PAPER

M = mechanism_class("five_bar")


def _regular(name: str, mode: str) -> tuple[np.ndarray, np.ndarray]:
    """Poses of a machine that are well inside and away from singularities, with their joints."""
    design = MACHINES[name]
    rng = np.random.default_rng(11)
    reach = design.size + design.half_base
    p = rng.uniform(-reach, reach, (4000, 2))
    q = joints_of(design, p, mode)
    with np.errstate(invalid="ignore"):
        limbs, between = statics.sines(design, p, q)
        ok = (np.abs(limbs) > 0.2).all(axis=-1) & (np.abs(between) > 0.2)
    return p[ok][:100], q[ok][:100]


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("mode", MODES)
def test_rates_and_accelerations_are_those_of_differences(name: str, mode: str) -> None:
    design = MACHINES[name]
    p, q = _regular(name, mode)
    assert len(p) > 5
    rng = np.random.default_rng(1)
    v, w = rng.normal(size=(2, *p.shape)) * 100.0
    h = 1e-4

    def at(t: float) -> np.ndarray:
        turned = joints_of(design, p + t * v + 0.5 * t * t * w, mode)
        return q + np.angle(np.exp(1j * (turned - q)))

    found = machine_of(design).motion.inverse(p, mode, v, w)
    np.testing.assert_allclose(found.joint_rates, (at(h) - at(-h)) / (2 * h), rtol=1e-5, atol=1e-5)
    second = (at(h) - 2 * q + at(-h)) / h**2
    np.testing.assert_allclose(found.joint_accelerations, second, rtol=2e-3, atol=2e-3)
    back = machine_of(design).motion.forward(p, mode, found.joint_rates, found.joint_accelerations)
    np.testing.assert_allclose(back.pose_rates, v, atol=1e-9)
    np.testing.assert_allclose(back.pose_accelerations, w, atol=1e-8)
    np.testing.assert_allclose(back.twist[:, 3:5], v, atol=1e-9)
    assert (back.twist[:, [0, 1, 2, 5]] == 0.0).all()


def test_equations_21_to_28() -> None:
    """The paper's matrices as printed, row 2 of eq. 27 with θ̇_2, in the paper's own letters."""
    x, y, r1, r3 = 40.0, 600.0, 480.0, 240.0
    t1, t2 = joints_of(PAPER, [x, y], "+-")
    a, b = statics.jacobians(PAPER, [x, y], [t1, t2])
    s1, c1, s2, c2 = np.sin(t1), np.cos(t1), np.sin(t2), np.cos(t2)
    np.testing.assert_allclose(
        a, [r1 * (y * c1 - (x + r3) * s1), r1 * (y * c2 + (r3 - x) * s2)], rtol=1e-12
    )
    np.testing.assert_allclose(
        b, [[x + r3 - r1 * c1, y - r1 * s1], [x - r3 - r1 * c2, y - r1 * s2]], rtol=1e-12
    )
    det_a = y * y * c1 * c2 - x * y * (c1 * s2 + s1 * c2) + y * r3 * (c1 * s2 - s1 * c2)
    det_a += (x * x - r3 * r3) * s1 * s2
    assert a.prod() == pytest.approx(r1 * r1 * det_a)
    det_b = 2 * y * r3 - y * r1 * c1 + y * r1 * c2 + x * r1 * s1 - x * r1 * s2
    det_b += -r1 * r3 * s1 - r1 * r3 * s2 - r1 * r1 * np.sin(t1 - t2)
    assert abs(np.linalg.det(b)) == pytest.approx(abs(det_b))
    v, w = np.array([30.0, -70.0]), np.array([11.0, 5.0])
    d1, d2 = (b @ v) / a
    f2 = r1 * (v[1] * c1 - y * s1 * d1 - v[0] * s1 - (x + r3) * c1 * d1)
    f = v[0] * (v[0] + r1 * s1 * d1) + v[1] * (v[1] - r1 * c1 * d1) - d1 * f2
    g2 = r1 * (v[1] * c2 - y * s2 * d2 - v[0] * s2 + (r3 - x) * c2 * d2)
    g = v[0] * (v[0] + r1 * s2 * d2) + v[1] * (v[1] - r1 * c2 * d2) - d2 * g2
    found = machine_of(PAPER).motion.inverse([x, y], "+-", v, w)
    np.testing.assert_allclose(found.joint_accelerations, (b @ w + [f, g]) / a, rtol=1e-11)


@pytest.mark.parametrize("name", MACHINES)
def test_torques_do_the_load_s_work(name: str) -> None:
    design = MACHINES[name]
    for mode in MODES:
        p, _ = _regular(name, mode)
        rng = np.random.default_rng(2)
        v, f = rng.normal(size=(2, *p.shape))
        rates = machine_of(design).motion.inverse(p, mode, v).joint_rates
        load = np.zeros((len(p), 6))
        load[:, :2] = f
        held = machine_of(design).statics.forces(p, mode, load)
        power = (held.forces * rates).sum(axis=-1) + (f * v).sum(axis=-1)
        np.testing.assert_allclose(power, 0.0, atol=1e-10)
        assert held.residual.max() < 1e-12
        system = machine_of(design).statics.wrenches(p, mode)
        np.testing.assert_allclose(np.linalg.norm(system.rows[..., :3], axis=-1), 1.0)


def test_a_moment_about_the_hinge_is_left_over() -> None:
    forces = machine_of(PAPER).statics.forces
    held = forces([0.0, 700.0], "+-", [0.0, 0.0, 9.0, 0.0, 0.0, 480.0])
    assert held.residual == pytest.approx(1.0)
    assert (
        machine_of(PAPER).statics.forces([0.0, 700.0], "+-", [0.0, 0.0, 9.0, 0, 0, 0]).forces == 0
    ).all()


def test_singular_answers_are_nan_and_what_was_given_stays() -> None:
    edge = (960.0 - 240.0, 0.0)  # limb 1 stretched
    found = machine_of(PAPER).motion.inverse(edge, "+-", [1.0, 0.0])
    assert np.isnan(found.joint_rates[0])
    assert np.isfinite(found.joint_rates[1])
    np.testing.assert_array_equal(found.pose_rates, [1.0, 0.0])
    outside = machine_of(PAPER).motion.inverse([0.0, 2000.0], "+-", [1.0, 0.0])
    assert np.isnan(outside.joint_rates).all()
    middle = (0.0, 415.69219381653056)  # B_1, P, B_2 in line in "+-"
    back = machine_of(PAPER).motion.forward(middle, "+-", [1.0, 0.0])
    assert np.isnan(back.pose_rates).all()
    assert np.isnan(
        machine_of(PAPER).statics.forces(middle, "+-", [0, 1.0, 0, 0, 0, 0]).forces
    ).all()


def test_measures() -> None:
    keys = [measure.key for measure in machine_of(PAPER).measures.specs]
    assert keys == ["conditioning", "manipulability", "transmission", "force"]
    p, _ = _regular("paper", "+-")
    jacobian = machine_of(PAPER).motion.jacobian(p, "+-")
    kappa = machine_of(PAPER).measures(p, "+-", "conditioning")
    np.testing.assert_allclose(kappa, 1.0 / np.linalg.cond(jacobian), rtol=1e-9)
    held = machine_of(PAPER).measures(p, "+-", "manipulability")
    np.testing.assert_allclose(
        held, np.abs(machine_of(PAPER).statics.wrenches(p, "+-").determinant)
    )
    least = machine_of(PAPER).measures(p, "+-", "transmission")
    assert (least <= held + 1e-15).all()
    force = machine_of(PAPER).measures(p, "+-", "force", [1.0, 2.0, 0, 0, 0, 0])
    torques = machine_of(PAPER).statics.forces(p, "+-", [1.0, 2.0, 0, 0, 0, 0]).forces
    np.testing.assert_allclose(force, np.abs(torques).max(axis=-1))
    with pytest.raises(InputError, match="needs a load"):
        machine_of(PAPER).measures(p, "+-", "force")
    with pytest.raises(InputError, match="no measure"):
        machine_of(PAPER).measures(p, "+-", "beauty")
    assert np.isnan(machine_of(PAPER).measures([0.0, 5000.0], "+-", "conditioning"))
    assert np.isinf(
        machine_of(PAPER).measures([0.0, 415.69219381653056], "+-", "force", [0, 1.0, 0, 0, 0, 0])
    )
