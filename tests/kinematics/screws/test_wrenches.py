"""Sets of wrenches: sizes that mean nothing, balances, and what cannot be balanced."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.answers.motion import WrenchName
from kinematics.errors import InputError
from kinematics.screws.wrenches import determinant, equilibrium, normalised, singular_values

NAMES = tuple(WrenchName("actuation", n, f"F{n}") for n in range(1, 7))


def random_rows(count: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    force = rng.normal(size=(count, 6, 3))
    force[:, 5] = 0.0
    moment = 40.0 * rng.normal(size=(count, 6, 3))
    return np.concatenate([force, moment], axis=-1)


def test_rows_of_unit_size_and_a_zero_row() -> None:
    rows = random_rows(4, 1)
    rows[2, 3] = 0.0
    unit = normalised(rows, 40.0)
    sizes = np.linalg.norm(unit, axis=-1)
    assert sizes[2, 3] == 0.0
    sizes[2, 3] = 1.0
    np.testing.assert_allclose(sizes, 1.0)


def test_neither_units_nor_sizes_of_wrenches_matter() -> None:
    rows = random_rows(20, 2)
    metres = rows * [1, 1, 1, 1e-3, 1e-3, 1e-3]
    twice = rows * np.random.default_rng(3).uniform(0.1, 9.0, (20, 6, 1))
    for other, length in ((metres, 0.04), (twice, 40.0)):
        np.testing.assert_allclose(singular_values(other, length), singular_values(rows, 40.0))
        np.testing.assert_allclose(determinant(other, length), determinant(rows, 40.0))


def test_the_reference_point_does_not_change_the_determinant() -> None:
    rows = random_rows(20, 4)
    moved = rows.copy()
    moved[..., 3:] += np.cross([30.0, -10.0, 55.0], rows[..., :3])
    np.testing.assert_allclose(determinant(moved, 40.0), determinant(rows, 40.0), rtol=1e-9)


def test_what_is_not_known_stays_unknown_without_a_warning() -> None:
    rows = random_rows(3, 5)
    rows[1, 2, 4] = np.nan
    assert np.isnan(singular_values(rows, 40.0)[1]).all()
    assert np.isnan(determinant(rows, 40.0)).tolist() == [False, True, False]
    rows[0, 1] = 0.0
    assert np.isnan(determinant(rows, 40.0)).tolist() == [True, True, False]
    assert singular_values(rows, 40.0)[0, -1] == pytest.approx(0.0, abs=1e-15)
    found = equilibrium(NAMES, rows, np.ones(6), 40.0)
    assert np.isnan(found.forces).all(axis=-1).tolist() == [True, True, False]
    assert np.isnan(found.residual).tolist() == [True, True, False]


def test_wrenches_and_load_cancel() -> None:
    rows = random_rows(50, 6)
    loads = 100.0 * np.random.default_rng(7).normal(size=(50, 6))
    found = equilibrium(NAMES, rows, loads, 40.0)
    total = np.einsum("nr,nrk->nk", found.forces, rows) + loads
    np.testing.assert_allclose(total, 0.0, atol=1e-8 * np.abs(found.forces).max())
    assert found.residual.max() < 1e-10
    heavy = equilibrium(NAMES, rows, 1e12 * loads, 40.0)  # the residual is a part of the load
    assert heavy.residual.max() < 1e-10
    gain = np.array([2.0, 1.0, 1.0, -3.0, 1.0, 1.0])
    np.testing.assert_allclose(
        equilibrium(NAMES, rows, loads, 40.0, gain).forces, gain * found.forces
    )


def test_no_load_needs_no_force() -> None:
    found = equilibrium(NAMES, random_rows(3, 8), np.zeros(6), 40.0)
    assert (found.forces == 0.0).all()
    assert (found.residual == 0.0).all()


def test_one_system_holds_many_loads() -> None:
    rows = random_rows(1, 9)[0]
    loads = np.random.default_rng(10).normal(size=(4, 7, 6))
    found = equilibrium(NAMES, rows, loads, 40.0)
    assert found.forces.shape == (4, 7, 6)
    np.testing.assert_allclose(
        found.forces[2, 3], equilibrium(NAMES, rows, loads[2, 3], 40.0).forces
    )


def test_a_load_is_six_numbers() -> None:
    with pytest.raises(InputError, match="a load must have 6 numbers, got 3"):
        equilibrium(NAMES, random_rows(1, 11)[0], [1.0, 2.0, 3.0], 40.0)
