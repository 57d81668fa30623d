"""Path tracking on systems whose solutions are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.homotopy.tracking import (
    CAREFUL,
    Control,
    Ending,
    determinant_columns,
    relative_size,
    solve_columns,
    track,
)


class Polynomial:
    """(1 − t)(u^n − 1) c + t p(u): the roots of unity turn into the roots of p, one unknown."""

    def __init__(self, coefficients, gamma=0.6 + 0.8j):
        self.p = np.asarray(coefficients, dtype=complex)
        self.n = len(self.p) - 1
        self.start = np.zeros(self.n + 1, dtype=complex)
        self.start[0], self.start[-1] = gamma, -gamma

    @property
    def starts(self):
        return np.exp(2j * np.pi * np.arange(self.n) / self.n)[None]

    def step(self, u, t):
        f0, f1 = np.polyval(self.start, u), np.polyval(self.p, u)
        slope = (1 - t) * np.polyval(np.polyder(self.start), u) + t * np.polyval(
            np.polyder(self.p), u
        )
        return -((1 - t) * f0 + t * f1) / slope, -(f1 - f0) / slope

    def extent(self, u):
        return np.maximum(np.abs(u[0]), 1.0)

    def take(self, columns):
        return self


def sorted_roots(values):
    return values[np.lexsort((values.imag.round(6), values.real.round(6)))]


@pytest.mark.parametrize("degree", [1, 2, 5, 12])
def test_every_root_of_a_random_polynomial_is_found(degree):
    rng = np.random.default_rng(degree)
    for _ in range(5):
        roots = rng.normal(size=degree) + 1j * rng.normal(size=degree)
        homotopy = Polynomial(np.poly(roots))
        ends = track(homotopy, homotopy.starts)
        assert (ends.endings == Ending.REGULAR).all()
        found = ends.values[0] + homotopy.step(ends.values, np.ones(degree))[0][0]
        np.testing.assert_allclose(sorted_roots(found), sorted_roots(roots), atol=1e-8)
        np.testing.assert_array_equal(ends.reached, 1.0)


def test_paths_that_run_off_to_infinity_are_told_from_the_others():
    """Three starts for a polynomial that is really of degree 1: two roots are at infinity."""
    homotopy = Polynomial([0.0, 0.0, 1.0, -0.3])
    ends = track(homotopy, homotopy.starts)
    assert sorted(ends.endings) == [Ending.REGULAR, Ending.INFINITE, Ending.INFINITE]
    assert ends.values[0, ends.ended(Ending.REGULAR)[0]] == pytest.approx(0.3, abs=1e-6)
    assert (np.abs(ends.values[0, ends.ended(Ending.INFINITE)]) > 1e3).all()


class Far:
    """u = 10^5 (1 + t), with as few digits as there are so far out: rounding of 10⁻⁷."""

    def __init__(self, size=1e5):
        self.size, self.side = size, 1.0

    def step(self, u, t):
        self.side = -self.side
        return self.size * (1.0 + t + self.side * 1e-7) - u, np.full_like(u, self.size)

    def extent(self, u):
        return np.abs(u[0])

    def take(self, columns):
        return self


def test_a_path_far_out_arrives_though_its_corrections_are_rounding():
    ends = track(Far(), np.array([[1e5 + 0j]]))
    assert ends.endings.tolist() == [Ending.REGULAR]
    assert ends.values[0, 0] == pytest.approx(2e5, rel=1e-6)
    near = track(Far(10.0), np.array([[10.0 + 0j]]))
    assert near.endings.tolist() == [Ending.LOST]  # where digits are there, they are asked for


def test_paths_that_run_off_are_told_before_digits_are_lost():
    homotopy = Polynomial([0.0, 0.0, 1.0, -0.3])
    calls = []

    def counted(u, t, step=homotopy.step):
        calls.append(len(u.T))
        return step(u, t)

    homotopy.step = counted
    ends = track(homotopy, homotopy.starts)
    assert sorted(ends.endings) == [Ending.REGULAR, Ending.INFINITE, Ending.INFINITE]
    assert len(calls) < 400


@pytest.mark.parametrize("multiplicity", [2, 3, 4])
def test_paths_that_end_at_one_solution_together_are_singular(multiplicity):
    roots = np.array([0.4 + 0.2j] * multiplicity + [-1.3, 0.9j])
    homotopy = Polynomial(np.poly(roots))
    ends = track(homotopy, homotopy.starts)
    singular = ends.ended(Ending.SINGULAR)
    assert len(singular) == multiplicity
    assert len(ends.ended(Ending.REGULAR)) == 2
    # r^(1/m) is how far a path still is from an m-fold root at 1 − t = r.
    np.testing.assert_allclose(ends.values[0, singular], roots[0], atol=0.02)


class Fold:
    """u² = 1/2 − t: two real solutions merge on the way and are real no more."""

    def step(self, u, t):
        return -(u * u - 0.5 + t) / (2 * u), -1 / (2 * u)

    def extent(self, u):
        return np.abs(u[0]) + 1.0

    def take(self, columns):
        return self


@pytest.mark.parametrize("control", [Control(), CAREFUL])
def test_a_path_through_a_singularity_is_lost_and_not_made_up(control):
    ends = track(Fold(), np.array([[1.0, -1.0]]) * np.sqrt(0.5), control)
    assert (ends.endings == Ending.LOST).all()
    np.testing.assert_allclose(ends.reached, 0.5, atol=1e-3)
    assert (ends.reached < 0.5).all()
    assert (np.sign(ends.values[0].real) == [1, -1]).all()


def test_a_path_keeps_its_distance_from_another_that_comes_near():
    """(u − a)(u − b) with roots that pass each other at a distance of 1e-3 in mid-way."""

    class Pass:
        def at(self, t):
            return (t - 0.5) + 1e-3j, (0.5 - t) - 1e-3j

        def step(self, u, t):
            a, b = self.at(t)
            slope = 2 * u - a - b
            return -(u - a) * (u - b) / slope, ((u - b) - (u - a)) / slope

        def extent(self, u):
            return np.abs(u[0]) + 1.0

        def take(self, columns):
            return self

    first = np.array([[-0.5 + 1e-3j, 0.5 - 1e-3j]])
    ends = track(Pass(), first)
    assert (ends.endings == Ending.REGULAR).all()
    np.testing.assert_allclose(ends.values[0], [0.5 + 1e-3j, -0.5 - 1e-3j], atol=1e-6)


def test_no_paths_are_no_trouble():
    ends = track(Fold(), np.zeros((1, 0), dtype=complex))
    assert ends.values.shape == (1, 0)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6), st.integers(1, 6), st.integers(1, 3))
def test_columns_are_solved_as_a_library_solves_them(seed, size, sides):
    rng = np.random.default_rng(seed)
    a = rng.normal(size=(size, size, 7)) + 1j * rng.normal(size=(size, size, 7))
    b = rng.normal(size=(size, sides, 7)) + 1j * rng.normal(size=(size, sides, 7))
    kept = a.copy(), b.copy()
    x = solve_columns(a, b)
    np.testing.assert_array_equal(a, kept[0])
    np.testing.assert_array_equal(b, kept[1])
    residual = np.einsum("ijn,jkn->ikn", a, x) - b
    # Without pivots the error grows with the solution.
    scale = 1.0 + np.abs(x).max(axis=(0, 1))
    pivots = np.abs([np.linalg.det(a[:k, :k].transpose(2, 0, 1)) for k in range(1, size + 1)])
    sound = pivots.min(axis=0) > 1e-3
    assert (np.abs(residual).max(axis=(0, 1)) < 1e-8 * scale)[sound].all()
    expected = np.linalg.det(a.transpose(2, 0, 1))
    np.testing.assert_allclose(determinant_columns(a)[sound], expected[sound], rtol=1e-7)


def test_relative_size_is_that_of_the_worst_unknown():
    du = np.array([[1e-3, 0.0], [0.0, 4.0]])
    u = np.array([[0.1, 0.0], [5.0, 100.0]])
    np.testing.assert_allclose(relative_size(du, u), [1e-3, 0.04])
