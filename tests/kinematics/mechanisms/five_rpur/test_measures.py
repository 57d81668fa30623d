"""Measures: within their limits, zero where control is lost, the same machine the same number."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from kinematics.mechanisms.five_rpur.singularities.nearest import nearest_singularity
from tests.kinematics.mechanisms.five_rpur.asked import condition, measure, statics
from tests.kinematics.mechanisms.five_rpur.singularities.cases import (
    closing_points,
    moved_base,
    poses,
    preset,
)

MEASURES = machine_of(preset("rpur-table1")).measures.specs
DESIGN, PHI, THETA, MODE = preset("rpur-table1"), 0.1, -0.2, "+++++"
LOAD = [10.0, -20.0, -100.0, 300.0, 0.0, -500.0]
INDICES = ("conditioning", "manipulability", "transmission")


def places(count: int) -> np.ndarray:
    determinant = Determinant.at(DESIGN, PHI, THETA, MODE)
    return poses(DESIGN, PHI, THETA, closing_points(determinant, count, 1))


def test_they_lie_within_their_limits_and_vanish_at_parallel_singularities() -> None:
    where = places(2000)
    zero = nearest_singularity(DESIGN, [60.0, 120.0, 450.0, PHI, THETA], MODE)
    at = [*zero.point, PHI, THETA]
    for each in MEASURES:
        load = LOAD if each.needs_load else None
        values = measure(DESIGN, where, MODE, each.key, load)
        assert values.shape == (2000,)
        low, high = each.limits
        assert (values >= low).all()
        assert high is None or (values <= high).all()
        lost = float(measure(DESIGN, at, MODE, each.key, load))
        if each.better == "high":
            assert lost < 1e-7
            assert np.median(values) > 1e-3
        else:
            assert lost > 1e6


def test_serial_singularities_stop_the_input_but_hold_the_platform() -> None:
    determinant = Determinant.at(DESIGN, PHI, THETA, MODE)
    point = closing_points(determinant, 1, 3)[0]
    point[1] = determinant.span[1]
    pose = poses(DESIGN, PHI, THETA, [point])[0]
    pose[1] -= 1e-9
    assert measure(DESIGN, pose, MODE, "conditioning") < 1e-4
    assert measure(DESIGN, pose, MODE, "transmission") < 1e-4
    assert np.isfinite(measure(DESIGN, pose, MODE, "manipulability"))


def test_conditioning_and_force_are_what_they_are_made_of() -> None:
    where = places(50)
    found = measure(DESIGN, where, MODE, "conditioning")
    assert found == pytest.approx(1.0 / condition(DESIGN, where, MODE))
    forces = statics(DESIGN, where, MODE, LOAD).forces[:, :5]
    found = measure(DESIGN, where, MODE, "force", LOAD)
    assert found == pytest.approx(np.abs(forces).max(axis=-1))


def test_the_output_index_is_a_cosine_of_the_locked_platform() -> None:
    """The index is no more than each limb's own, computed by moving one actuator alone."""
    where = places(20)
    index = measure(DESIGN, where, MODE, "transmission")
    system = machine_of(DESIGN).statics.wrenches(where, MODE)
    least = np.full(len(where), np.inf)
    for limb in range(5):
        rates = np.zeros((len(where), 5))
        rates[:, limb] = 1.0
        twist = machine_of(DESIGN).motion.forward(where, MODE, rates).twist
        arm = system.point[:, limb] - where[:, :3]
        v = twist[:, 3:] + np.cross(twist[:, :3], arm)
        force = system.rows[:, limb, :3]
        cosine = np.abs((force * v).sum(axis=-1)) / np.linalg.norm(v, axis=-1)
        least = np.minimum(least, cosine)
        # Power: f·v is f·û times the actuator's rate, f a unit force.
        least = np.minimum(least, np.abs((force * v).sum(axis=-1)))
    assert index == pytest.approx(least, rel=1e-6)


@pytest.mark.parametrize("key", INDICES)
def test_the_base_frame_does_not_count(key: str) -> None:
    where = places(40)
    turn, shift = 0.8, np.array([10.0, -40.0, 90.0])
    moved = moved_base(DESIGN, turn, shift)
    spin = Determinant.at(DESIGN, 0.0, turn, MODE).turn
    there = np.column_stack([where[:, :3] @ spin.T + shift, where[:, 3], where[:, 4] + turn])
    assert measure(moved, there, MODE, key) == pytest.approx(
        measure(DESIGN, where, MODE, key), rel=1e-6, abs=1e-9
    )


def test_batches_nan_and_refusals() -> None:
    where = places(6).reshape(2, 3, 5).copy()
    where[0, 0, 1] = 900.0
    for each in MEASURES:
        values = measure(DESIGN, where, MODE, each.key, LOAD)
        assert values.shape == (2, 3)
        assert np.isnan(values).sum() == 1
        assert not values.flags.writeable
    with pytest.raises(InputError, match="no measure"):
        measure(DESIGN, where, MODE, "beauty")
    with pytest.raises(InputError, match="none is given"):
        measure(DESIGN, where, MODE, "force")
    with pytest.raises(InputError):
        measure(DESIGN, where, MODE, "force", [1.0, 2.0])
