"""Where a coordinate can go while the others are held, against looks of its own along the way."""

from __future__ import annotations

import numpy as np
import pytest

import kinematics
from kinematics.facets.reach import reach

FREE = ["rpur-table1", "rpur-table2", "rps-3", "spr-3", "five-bar"]
PARTS = 16_000  # of a coordinate's range, to which ends are right


def _along(machine, pose, mode: str, n: int, values: np.ndarray) -> np.ndarray:
    """Whether the pose can be held with coordinate ``n`` at these values."""
    poses = np.tile(np.array(pose, dtype=float), (len(values), 1))
    poses[:, n] = values
    return machine.inverse.inside(poses, (mode,))


@pytest.mark.parametrize("name", FREE)
def test_the_ends_are_where_reach_ends(name: str) -> None:
    machine = kinematics.open(name)
    pose, mode = machine.home.pose, machine.home.mode
    spans = reach(machine.inverse, pose, mode)
    assert len(spans) == len(machine.coordinates)
    for n, (axis, span) in enumerate(zip(machine.coordinates, spans, strict=True)):
        step = (axis.upper - axis.lower) / PARTS
        assert (np.diff(span.ravel()) >= 0.0).all()
        assert any(low <= pose[n] <= high for low, high in span)
        for side, ends in ((1.0, span[:, 0]), (-1.0, span[:, 1])):
            assert _along(machine, pose, mode, n, ends + side * 1e-9 * step).all()
            inner = ends[(ends > axis.lower) & (ends < axis.upper)]
            assert not _along(machine, pose, mode, n, inner - side * step).any()


@pytest.mark.parametrize("name", FREE)
def test_nothing_wider_than_a_step_is_passed_over(name: str) -> None:
    machine = kinematics.open(name)
    mode = machine.home.mode
    rng = np.random.default_rng(5)
    size = np.array([c.upper - c.lower for c in machine.coordinates])
    for _ in range(12):
        pose = np.array(machine.home.pose) + 0.03 * size * rng.standard_normal(len(size))
        for n, (axis, span) in enumerate(
            zip(machine.coordinates, reach(machine.inverse, pose.tolist(), mode), strict=True)
        ):
            looks = np.linspace(axis.lower, axis.upper, 4001)
            held = _along(machine, pose, mode, n, looks)
            told = ((looks[:, None] >= span[:, 0]) & (looks[:, None] <= span[:, 1])).any(axis=1)
            wrong = np.flatnonzero(held != told)
            # Only at the ends of an interval, or within one that is narrower than a step.
            runs = np.split(wrong, np.flatnonzero(np.diff(wrong) > 1) + 1)
            assert max(map(len, runs)) <= 4000 / 128 + 1


def test_a_coordinate_that_others_follow_is_moved_with_them() -> None:
    machine = kinematics.open("sps-spr")
    pose, mode = machine.home.pose, machine.home.mode
    spans = reach(machine.inverse, pose, mode)
    low, high = spans[2][-1]  # z above the base, by the lengths of the limbs
    assert low < pose[2] < high
    for z, held in ((low + 1e-3, True), (high - 1e-3, True), (high + 1.0, False)):
        moved = machine.complete_pose((*pose[:2], z, *pose[3:]), mode, 2)
        assert machine.at(moved, mode).reachable is held


def test_a_pose_that_nothing_reaches_has_no_interval_of_its_own() -> None:
    machine = kinematics.open("five-bar")
    spans = reach(machine.inverse, (2000.0, 2000.0), machine.home.mode)
    assert [len(span) for span in spans] == [0, 0]
