"""Paths of poses stop where the machine would have to, and warnings come in time."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.facets.paths import WARNED
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.paths import Paths
from tests.kinematics.mechanisms.five_rpur.asked import wrench_matrix

MECHANISM = mechanism_class("five_rpur")


def sign_of(design, posture) -> float:
    matrix = wrench_matrix(design, posture.pose, posture.mode, length=50.0)
    return float(np.sign(np.linalg.det(matrix)))


@pytest.mark.parametrize("seed", range(16))
def test_a_path_stops_before_what_it_would_pass(seed):
    rng = np.random.default_rng(seed)
    design = load_design(("rpur-table1", "rpur-table2")[seed % 2])
    start = machine_of(design).home
    corners = np.cumsum(rng.normal(size=(4, 5)) * [60, 60, 60, 0.2, 0.2], axis=0) + start.pose
    reached = machine_of(design).paths.drive(start, corners)
    assert reached.posture.reachable
    assert reached.posture.mode == start.mode
    assert 0.0 <= reached.fraction <= 1.0
    assert sign_of(design, reached.posture) == sign_of(design, start)
    ways = [
        machine_of(design).paths.segment(a, b, start.mode)
        for a, b in zip([start.pose, *corners[:-1]], corners, strict=True)
    ]
    lengths = np.array([way.length for way in ways])
    # Up to there nothing is passed, and every pose on the way can be held.
    left = reached.fraction * lengths.sum()
    for way, length in zip(ways, lengths, strict=True):
        s = np.linspace(0.0, min(max(left / length, 0.0), 1.0), 300)
        assert inverse.inside(design, way.poses(s[:-1]), [start.mode]).all()
        left -= length
        if left <= 0.0:
            break
    if reached.stop == "target":
        assert reached.posture.pose == pytest.approx(corners[-1].tolist())
    elif reached.stop == "stroke":
        low, high = design.limbs[reached.limb - 1].stroke
        rho = reached.posture.joints[reached.limb - 1]
        assert min(abs(rho - low), abs(rho - high)) < 1e-6
        assert f"limb {reached.limb} is at the end of its stroke" in reached.text
    else:
        assert reached.stop == "singularity"
        assert "singularity" in reached.text
        way = machine_of(design).paths.segment(
            reached.posture.pose, reached.posture.pose, start.mode
        )
        if reached.limb is None:
            assert 0.0 < way.to_singularity(reached.posture.pose) <= 1.01 * Paths.gap


def test_some_paths_meet_each_kind_of_stop():
    stops = set()
    design = load_design("rpur-table1")
    start = machine_of(design).home
    for way in np.eye(5)[[0, 1, 2, 3, 4]]:
        for side in (1.0, -1.0):
            goal = start.pose + side * way * [300, 300, 300, 1.5, 1.5]
            stops.add(machine_of(design).paths.drive(start, [goal]).stop)
    near = start.pose + np.array([1.0, 1.0, 1.0, 0.01, 0.01])
    stops.add(machine_of(design).paths.drive(start, [near, start.pose]).stop)
    assert stops == {"stroke", "singularity", "target"}


def test_a_path_from_where_nothing_holds_the_machine():
    design = load_design("rpur-table1")
    start = machine_of(design).inverse.posture((900.0, 0.0, 0.0, 0.0, 0.0), "+++++")
    reached = machine_of(design).paths.drive(start, [(0.0, 0.0, 300.0, 0.0, 0.0)])
    assert reached.stop == "stalled"
    assert reached.posture == start
    assert start.reasons[0].text in reached.text


@pytest.mark.parametrize("poses", [[], [[1.0, 2.0]], [1.0, 2.0, 3.0, 4.0, 5.0], [[np.nan] * 5]])
def test_paths_that_are_none(poses):
    design = load_design("rpur-table1")
    with pytest.raises(InputError):
        machine_of(design).paths.drive(machine_of(design).home, poses)


def test_a_path_that_does_not_move():
    design = load_design("rpur-table1")
    home = machine_of(design).home
    reached = machine_of(design).paths.drive(home, [home.pose, home.pose])
    assert (reached.stop, reached.fraction, reached.text) == ("target", 1.0, "")


# --- warnings ------------------------------------------------------------------------------------


def test_actuators_driven_towards_a_fold_warn_before_they_stop():
    design = load_design("rpur-table1")
    home = machine_of(design).home
    assert machine_of(design).following.follow(home, home.joints).warning == ""
    met = 0
    for limb in range(5):
        for side in (-1.0, 1.0):
            joints = np.array(home.joints)
            joints[limb] += side * 120.0
            end = machine_of(design).following.follow(home, joints)
            if end.stop != "singularity":
                continue
            way = np.subtract(end.posture.joints, home.joints)
            nearly = machine_of(design).following.follow(home, home.joints + 0.9999 * way)
            assert nearly.stop == "target"
            assert "parallel singularity" in nearly.warning
            assert "parallel" not in end.warning  # the text says so already
            met += 1
    assert met


def test_next_to_the_reach_of_a_link_there_is_a_warning():
    design = load_design("rpur-table1")
    home = machine_of(design).home
    mode_change = min(
        (c for c in machine_of(design).clearances.of(home, singular=False) if c.kind == "mode"),
        key=lambda c: c.distance,
    )
    to = np.array([*mode_change.point, *home.pose[3:]])
    step = (to - home.pose) / mode_change.distance
    near = machine_of(design).inverse.posture(to - 0.9 * WARNED * step, home.mode)
    far = machine_of(design).inverse.posture(to - 1.1 * WARNED * step, home.mode)
    wanted = f"4.5 mm from a serial singularity of limb {mode_change.limb}"
    assert wanted in machine_of(design).paths.drive(near, [near.pose]).warning or not near.reachable
    assert "serial" not in machine_of(design).paths.drive(far, [far.pose]).warning


# --- room to parallel singularities --------------------------------------------------------------


@pytest.mark.parametrize("seed", range(6))
def test_within_the_room_no_way_crosses(seed):
    rng = np.random.default_rng(seed)
    design = load_design("rpur-table1")
    poses = np.column_stack([rng.uniform(-400, 400, (3000, 3)), rng.uniform(-1, 1, (3000, 2))])
    held = np.argwhere(inverse.inverse(design, poses).within_stroke)
    at, mode = held[rng.integers(0, len(held))]
    posture = machine_of(design).inverse.posture(poses[at], inverse.MODES[mode])
    found = machine_of(design).clearances.of(posture)
    singular = [c for c in found if c.kind == "parallel"]
    assert [c.distance for c in found] == sorted(c.distance for c in found)
    assert len(singular) == 1
    (clearance,) = singular
    assert "mm to a parallel singularity" in clearance.text
    away = np.subtract(clearance.point, posture.pose[:3])
    assert np.linalg.norm(away) == pytest.approx(clearance.distance, abs=1e-6)

    def crossings(direction, share, kind="parallel"):
        goal = (*(posture.pose[:3] + share * direction), *posture.pose[3:])
        after = machine_of(design).inverse.posture(goal, posture.mode)
        events = machine_of(design).paths.passed(posture, after)
        return [e.fraction for e in events if e.kind == kind and e.stops]

    # Where two links that are always parallel come to their reach at once, it is of both kinds.
    met = crossings(away, 1.01) or crossings(away, 1.01, "serial")
    assert min(met) == pytest.approx(1.0 / 1.01, abs=1e-4)
    for _ in range(12):
        direction = rng.normal(size=3)
        direction *= clearance.distance / np.linalg.norm(direction)
        assert crossings(direction, 0.999) == []
