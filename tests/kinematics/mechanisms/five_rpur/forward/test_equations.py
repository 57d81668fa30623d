"""The constraints over the complex numbers against the inverse kinematics and differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.designs.files import load_design
from kinematics.mechanisms.five_rpur.forward import equations
from kinematics.mechanisms.five_rpur.forward.equations import (
    Deformation,
    Frame,
    Parameters,
    conjugate,
    from_poses,
    parameters,
    polish,
    real_part,
    regularity,
    residuals,
    to_poses,
)
from kinematics.mechanisms.five_rpur.inverse import joint_points, limb_lengths
from tests.kinematics.mechanisms.five_rpur.asked import wrench_matrix
from tests.kinematics.mechanisms.five_rpur.machines import signature

SIGNS = np.array([1.0, -1.0, 1.0, 1.0, -1.0])


def random_poses(design, count, seed):
    """Poses at which every limb closes, and the lengths in one working mode."""
    rng = np.random.default_rng(seed)
    poses = rng.uniform([-80, 0, 150, -0.6, -0.6], [120, 120, 350, 0.6, 0.6], (40 * count, 5))
    both = limb_lengths(design, poses)
    rho = np.where(SIGNS > 0, both[..., 0], both[..., 1])
    closes = np.isfinite(rho).all(axis=1)
    assert closes.sum() >= count
    return poses[closes][:count], rho[closes][:count]


def random_machine(rng):
    def complex_columns(count=1):
        return rng.normal(size=(5, count)) + 1j * rng.normal(size=(5, count))

    return Parameters(*(complex_columns() for _ in range(8)))


def random_configurations(rng, count):
    return rng.normal(size=(10, count)) + 1j * rng.normal(size=(10, count))


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-a1a2", "rpur-mpa3"])
def test_reachable_poses_solve_the_equations_and_come_back(name):
    design = load_design(name)
    frame = Frame.of(design)
    poses, rho = random_poses(design, 20, 1)
    _, elbows, _ = joint_points(design, poses, SIGNS)
    u = from_poses(frame, poses, elbows)
    g = parameters(design, rho, frame)
    assert np.abs(np.concatenate(residuals(g, u))).max() < 1e-13
    np.testing.assert_allclose(np.abs(u[3:5]), 1.0, atol=1e-15)
    np.testing.assert_allclose(conjugate(u), u, atol=1e-14)
    values, w = real_part(u)
    np.testing.assert_allclose(to_poses(frame, values), poses, atol=1e-10)
    np.testing.assert_allclose(equations.from_real(values, w), u, atol=1e-14)
    signs = np.where(equations.terms(g, u).q.real > 0, 1.0, -1.0)
    np.testing.assert_array_equal(signs.T, np.broadcast_to(SIGNS, (20, 5)))


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10**6))
def test_newton_and_tangent_against_differences(seed):
    """u + du solves to second order; u + ε du/dt solves the moved machine to second order."""
    rng = np.random.default_rng(seed)
    here, there = random_machine(rng), random_machine(rng)
    u = random_configurations(rng, 3)
    t = rng.uniform(0.2, 0.8, 3)
    around = rng.uniform(-0.8, 0.8)
    way = Deformation(here, there, around)
    g, _ = way.at(t)
    # Lengths that make u a solution at t.
    f1, f2 = residuals(g._replace(link2=np.zeros((5, 1)), rho2=np.zeros((5, 1))), u)
    shift = Parameters(*(np.zeros((5, 1)),) * 6, 2 * f2 - g.link2, 2 * f1 - g.rho2)
    moved = [a + s for a, s in zip(here, shift, strict=True)]
    other = [a + s for a, s in zip(there, shift, strict=True)]
    way = Deformation(Parameters(*moved), Parameters(*other), around)
    newton, tangent = way.step(u, t)
    size = 1.0 + np.abs(tangent).max()
    if size > 1e3:  # next to a singularity
        return
    assert np.abs(newton).max() < 1e-9 * size
    errors = []
    for eps in (1e-4, 1e-5):
        near, _ = way.at(t + eps / size)
        errors.append(np.abs(np.concatenate(residuals(near, u + eps / size * tangent))).max())
    assert errors[1] < 0.02 * errors[0] + 1e-12


def test_one_newton_step_squares_the_distance():
    design = load_design("rpur-table1")
    frame = Frame.of(design)
    poses, rho = random_poses(design, 30, 2)
    _, elbows, _ = joint_points(design, poses, SIGNS)
    u = from_poses(frame, poses, elbows)
    g = parameters(design, rho, frame)
    regular = regularity(g, u) > 1e-2
    assert regular.sum() > 5
    rng = np.random.default_rng(3)
    d = rng.normal(size=u.shape) + 1j * rng.normal(size=u.shape)
    for size in (1e-4, 1e-6):
        off = u + size * d
        closer, _ = polish(g, off, rounds=1)
        left = np.abs(closer - u)[:, regular].max()
        assert left < 1e4 * size * size
    ends, error = polish(g, u + 1e-4 * d, rounds=6)
    np.testing.assert_allclose(ends[:, regular], u[:, regular], atol=1e-11)
    assert (error[regular] < 1e-12).all()


def test_what_does_not_move_is_left_alone():
    rng = np.random.default_rng(4)
    here, there = random_machine(rng), random_machine(rng)
    only = here._replace(rho2=there.rho2)
    u, t = random_configurations(rng, 4), np.array([0.1, 0.4, 0.7, 1.0])
    full = Deformation(here, Parameters(*(v.copy() for v in only)))
    part = Deformation(here, only)
    for a, b in zip(part.step(u, t), full.step(u, t), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-10)
    some = np.array([2, 0])
    for a, b in zip(part.take(some).step(u[:, some], t[some]), part.step(u, t), strict=True):
        np.testing.assert_allclose(a, b[:, some], rtol=1e-10)


def test_conjugates_solve_real_machines_and_have_conjugate_signatures():
    design = load_design("rpur-table1")
    g = parameters(design, [300.0, 310.0, 320.0, 330.0, 340.0])
    u = random_configurations(np.random.default_rng(5), 6)
    f1, f2 = residuals(g, u)
    c1, c2 = residuals(g, conjugate(u))
    np.testing.assert_allclose(c1, f1.conj(), rtol=1e-10)
    np.testing.assert_allclose(c2, f2.conj(), rtol=1e-10)
    np.testing.assert_allclose(conjugate(conjugate(u)), u, rtol=1e-12)
    np.testing.assert_allclose(signature(conjugate(u)), signature(u).conj(), rtol=1e-10)


def test_regularity_vanishes_with_the_determinant_of_the_wrenches():
    design = load_design("rpur-table1")
    frame = Frame.of(design)
    poses, rho = random_poses(design, 200, 6)
    _, elbows, _ = joint_points(design, poses, SIGNS)
    u = from_poses(frame, poses, elbows)
    found = regularity(parameters(design, rho, frame), u)
    matrix = wrench_matrix(design, poses, SIGNS, length=frame.unit)
    rows = matrix / np.linalg.norm(matrix, axis=-1, keepdims=True)
    # Both are |det| of the same wrenches, about different points: equal to within their size.
    ratio = found / np.abs(np.linalg.det(rows))
    assert ratio.min() > 1e-3
    assert ratio.max() < 1e3
