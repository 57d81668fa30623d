"""Roots of many polynomials at a time, against roots that are known."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.mechanisms.five_rpur.forward.polynomial import roots


def with_roots(values: np.ndarray) -> np.ndarray:
    """Coefficients (n + 1, N), rising powers, of given roots (n, N)."""
    return np.stack([np.poly(column)[::-1] for column in values.T], axis=1)


def worst(found: np.ndarray, true: np.ndarray) -> float:
    distance = np.abs(found[:, None] - true[None]) / (1.0 + np.abs(true))
    return float(max(distance.min(axis=0).max(), distance.min(axis=1).max()))


def random_roots(degree: int, count: int, spread: float = 0.8) -> np.ndarray:
    rng = np.random.default_rng(degree * count)
    size = np.exp(rng.normal(0, spread, (degree, count)))
    values: np.ndarray = size * np.exp(2j * np.pi * rng.uniform(size=(degree, count)))
    return values


@pytest.mark.parametrize("degree", [1, 2, 3, 6, 8, 12])
@pytest.mark.parametrize("count", [1, 7, 400])
def test_known_roots_are_found(degree: int, count: int) -> None:
    true = random_roots(degree, count)
    found = roots(with_roots(true))
    assert found.shape == (degree, count)
    assert worst(found, true) < 1e-6
    assert np.quantile(np.abs(found[:, None] - true).min(axis=0), 0.99) < 1e-9


@pytest.mark.parametrize("count", [1, 400])
def test_both_ways_find_all_of_a_double_root(count: int) -> None:
    true = random_roots(6, count)
    true[1] = true[0]
    found = roots(with_roots(true))
    near = np.abs(found - true[0]) < 1e-4
    assert (near.sum(axis=0) >= 2).all()


@pytest.mark.parametrize("count", [1, 400])
def test_roots_of_very_different_size(count: int) -> None:
    true = random_roots(6, count)
    true[0] *= 1e5
    true[1] *= 1e-5
    found = roots(with_roots(true))
    distance = np.abs(found[:, None] - true) / np.abs(true)
    assert distance.min(axis=0).max() < 1e-6


@pytest.mark.parametrize("count", [1, 400])
def test_a_missing_leading_term_is_a_root_at_infinity(count: int) -> None:
    true = random_roots(5, count)
    coefficients = np.concatenate([with_roots(true), np.zeros((1, count))])
    found = roots(coefficients)
    assert (np.abs(found).max(axis=0) > 1e10).all()
    assert np.abs(found[:, None] - true).min(axis=0).max() < 1e-6


def test_what_is_no_polynomial_has_no_roots_and_spoils_no_other() -> None:
    for count in (3, 400):
        true = random_roots(6, count)
        coefficients = with_roots(true)
        coefficients[:, 0] = 0.0
        coefficients[3, 1] = np.nan
        found = roots(coefficients)
        assert not np.isfinite(found[:, :2]).any()
        assert worst(found[:, 2:], true[:, 2:]) < 1e-6


def test_none_are_none() -> None:
    assert roots(np.empty((7, 0))).shape == (6, 0)
