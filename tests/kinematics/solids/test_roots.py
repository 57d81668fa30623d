"""Where polynomials change their sign, against companion matrices."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.solids.roots import crossings


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_crossings_are_the_real_roots_between_the_ends(degree: int) -> None:
    rng = np.random.default_rng(degree)
    coefficients = rng.normal(size=(400, degree + 1))
    low = rng.normal(size=400)
    high = low + rng.exponential(size=400)
    found = crossings(coefficients, low, high)
    some = 0
    for own, a, b, places in zip(coefficients, low, high, found, strict=True):
        roots = np.roots(own[::-1])
        real = np.sort(roots[np.abs(roots.imag) < 1e-12].real)
        right = real[(real > a) & (real < b)]
        some += len(right)
        assert places[np.isfinite(places)] == pytest.approx(right, abs=1e-9)
    assert some > 80


def test_two_crossings_next_to_each_other_are_seen() -> None:
    """And none where a polynomial all but touches zero."""
    middle, apart = np.array([0.3, 0.3]), np.array([1e-4, -1e-4])
    square = np.stack([middle**2 - apart * 1e-4, -2.0 * middle, np.ones(2)], axis=-1)
    other = np.array([1.0, 0.5, 0.25])  # without a real root
    quartic = np.array([np.convolve(own, other) for own in square])
    found = crossings(quartic, np.zeros(2), np.ones(2))
    assert found[0, :2] == pytest.approx([0.3 - 1e-4, 0.3 + 1e-4], abs=1e-9)
    assert np.isinf(found[0, 2:]).all()
    assert np.isinf(found[1]).all()
