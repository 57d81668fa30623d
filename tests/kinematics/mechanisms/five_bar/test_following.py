"""Motion along an assembly mode, the fold ahead, straight ways of P."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.five_bar import forward, inverse
from kinematics.mechanisms.five_bar.joints_line import first_crossing
from kinematics.mechanisms.five_bar.statics import sines
from tests.kinematics.mechanisms.five_bar.conftest import BOTH, MACHINES, PAPER, UNLIKE

M = mechanism_class("five_bar")
angles = st.floats(-3.1, 3.1)


@settings(max_examples=80)
@given(st.sampled_from(sorted(MACHINES)), angles, angles, angles, angles)
def test_the_first_crossing_is_where_dense_samples_lose_the_solutions(
    name: str, a: float, b: float, c: float, d: float
) -> None:
    design = MACHINES[name]
    start, end = np.array([a, b]), np.array([c, d])
    s = np.linspace(0.0, 1.0, 4001)[:, None]
    real = np.isfinite(forward.both_points(design, start + s * (end - start))).all(axis=(1, 2))
    found = first_crossing(design, start.tolist(), end.tolist())
    lost = np.flatnonzero(~real)
    if found is None:
        assert not lost.size
        return
    sampled = float(s[lost[0], 0]) if lost.size else 2.0
    assert found.fraction <= sampled + 1e-9
    if found.fraction > 0.0:  # there the two solutions meet
        elbows = inverse.elbows(design, found.joints)
        between = np.hypot(*(elbows[1] - elbows[0]))
        r, t = design.distal
        assert min(abs(between - r - t), abs(between - abs(r - t))) < 1e-6 * design.size
        reach = np.linalg.norm(found.point - elbows, axis=-1)
        np.testing.assert_allclose(reach, design.distal, atol=1e-6 * design.size)


def test_a_way_that_is_free_keeps_its_side() -> None:
    start = machine_of(PAPER).inverse.posture((0.0, 738.644), "+-")
    goal = machine_of(PAPER).inverse.posture((240.0, 450.0), "+-")
    moved = machine_of(PAPER).following.follow(start, goal.joints)
    assert moved.stop == "target"
    assert moved.fraction == 1.0
    np.testing.assert_allclose(moved.posture.pose, goal.pose, atol=1e-9)
    assert moved.posture.joints == pytest.approx(goal.joints, abs=1e-15)
    assert moved.posture.residual < 1e-10


def test_it_stops_before_a_parallel_singularity_and_says_where() -> None:
    start = machine_of(PAPER).home
    wanted = (start.joints[0] + 2.0, start.joints[1])
    moved = machine_of(PAPER).following.follow(start, wanted)
    assert moved.stop == "singularity"
    assert "B₁, P and B₂ come into line" in moved.text
    fold = machine_of(PAPER).following.fold_ahead(start, wanted)
    assert fold is not None
    assert fold.distance == pytest.approx(2.0 * moved.fraction, abs=1e-5)
    _, sine = sines(PAPER, np.array(fold.pose), np.array(fold.joints))
    assert abs(sine) < 1e-6
    assert fold.partner is not None
    both = forward.both_points(PAPER, start.joints)
    assert np.linalg.norm(both - fold.partner.pose, axis=-1).min() < 1e-9
    assert np.linalg.norm(np.subtract(fold.partner.pose, start.pose)) > 1.0
    assert (
        machine_of(PAPER).following.fold_ahead(start, (start.joints[0] + 0.1, start.joints[1]))
        is None
    )


def test_serial_singularities_are_passed_and_told() -> None:
    start = machine_of(PAPER).inverse.posture((600.0, 0.0), "++")
    moved = machine_of(PAPER).following.follow(
        start, (start.joints[0] - 1.2, start.joints[1] - 0.5)
    )
    assert moved.stop == "target"
    assert moved.posture.mode[0] == "-"
    assert "passed a serial singularity" in moved.text
    back = machine_of(PAPER).following.follow(moved.posture, start.joints)
    np.testing.assert_allclose(back.posture.pose, start.pose, atol=1e-8)


def test_free_joints_take_the_shorter_way_round() -> None:
    start = machine_of(PAPER).inverse.posture((-600.0, 200.0), "-+")
    start = machine_of(PAPER).following.follow(start, (3.0, start.joints[1])).posture
    assert start.joints[0] == pytest.approx(3.0)
    moved = machine_of(PAPER).following.follow(start, (-3.1, start.joints[1]))
    assert moved.stop == "target"
    assert moved.posture.joints[0] == pytest.approx(-3.1)


def test_ranges_stop_a_joint() -> None:
    start = machine_of(BOTH).inverse.posture((0.0, 738.644), "+-")
    moved = machine_of(BOTH).following.follow(start, (start.joints[0], np.radians(-80.0)))
    assert moved.stop in ("stroke", "singularity")
    if moved.stop == "stroke":
        assert moved.limb == 2
        assert np.degrees(moved.posture.joints[1]) == pytest.approx(-30.0)
    small = machine_of(BOTH).following.follow(start, (np.radians(211.0), start.joints[1]))
    assert "singularity" in small.stop or small.limb == 1


def test_a_machine_that_is_not_assembled_stays() -> None:
    apart = machine_of(PAPER).inverse.posture((0.0, 2000.0), "+-")
    assert machine_of(PAPER).following.follow(apart, (0.0, 0.0)).stop == "stalled"
    assert machine_of(PAPER).following.fold_ahead(apart, (0.0, 0.0)) is None


def events(design, start: np.ndarray, end: np.ndarray, mode: str):
    paths = machine_of(design).paths
    return paths.events(paths.segment(start, end, mode))


# --- ways of P -----------------------------------------------------------------------------


@settings(max_examples=60)
@given(
    st.sampled_from(sorted(MACHINES)),
    st.sampled_from(inverse.MODES),
    *(st.floats(-700.0, 700.0) for _ in range(4)),
)
def test_what_a_way_passes_is_what_dense_samples_see(
    name: str, mode: str, a: float, b: float, c: float, d: float
) -> None:
    design = MACHINES[name]
    start, end = np.array([a, b]), np.array([c, d])
    found = events(design, start, end, mode)
    s = np.linspace(0.0, 1.0, 2001)
    p = start + s[:, None] * (end - start)
    q = inverse.joints_of(design, p, mode)
    with np.errstate(invalid="ignore"):
        sine = sines(design, p, q)[1]
        sign = np.where(np.abs(sine) < 1e-9, np.nan, np.sign(sine))  # a sample in a singularity
        based = np.linalg.norm(p[:, None] - design.base, axis=-1).min(axis=-1) < 1.0
        sign = np.where(based, np.nan, sign)  # where a limb turns about its base joint
    ok = inverse.in_range(design, q).all(axis=-1)
    times = np.array([event.fraction for event in found])
    assert (np.diff(times) >= 0.0).all()
    for n in np.flatnonzero(ok[1:] != ok[:-1]):  # every change of samples is an event
        assert ((times >= s[n] - 1e-9) & (times <= s[n + 1] + 1e-9)).any()
    closing = np.isfinite(sign)
    with np.errstate(invalid="ignore"):
        crossed = closing[1:] & closing[:-1] & (sign[1:] * sign[:-1] < 0.0)
    parallel = np.array([event.fraction for event in found if event.kind == "parallel"])
    for n in np.flatnonzero(crossed):
        assert ((parallel >= s[n] - 1e-9) & (parallel <= s[n + 1] + 1e-9)).any()
    for event in found:
        if event.kind == "parallel" and "crossed" in event.text:
            _, left = sines(
                design, np.array(event.pose), inverse.joints_of(design, event.pose, mode)
            )
            assert abs(float(left)) < 1e-5


def test_paths_stop_before_a_singularity() -> None:
    start = machine_of(PAPER).home
    moved = machine_of(PAPER).paths.drive(start, [(0.0, 600.0), (0.0, 200.0), (0.0, 0.0)])
    assert moved.stop == "singularity"
    assert moved.posture.pose[1] == pytest.approx(415.692193816, abs=1e-5)
    assert moved.posture.pose[1] > 415.69219381
    assert machine_of(PAPER).paths.drive(start, [(0.0, 600.0)]).stop == "target"
    outside = machine_of(UNLIKE).paths.drive(machine_of(UNLIKE).home, [(0.0, 2000.0)])
    assert outside.stop == "singularity"
    assert outside.posture.reachable


def test_a_change_of_mode_is_no_way() -> None:
    (event,) = machine_of(PAPER).paths.passed(
        machine_of(PAPER).inverse.posture((0.0, 700.0), "+-"),
        machine_of(PAPER).inverse.posture((0.0, 700.0), "++"),
    )
    assert event.limb == 2
    assert event.stops


def test_a_base_joint_is_passed() -> None:
    found = events(PAPER, np.array([-240.0, 300.0]), np.array([-240.0, -300.0]), "++")
    assert [e.limb for e in found if "A₁" in e.text] == [1]


def test_ways_with_corners_are_told_as_one() -> None:
    before, after = (
        machine_of(PAPER).inverse.posture(pose, "+-") for pose in ((0.0, 700.0), (100.0, 500.0))
    )
    (one, two) = machine_of(PAPER).paths.passed(before, after, [(0.0, 400.0), (100.0, 400.0)])
    assert one.pose[1] == pytest.approx(415.692193816, abs=1e-6)
    assert one.fraction == pytest.approx((700.0 - one.pose[1]) / 500.0)
    assert one.fraction < two.fraction < 1.0


# --- working modes meet --------------------------------------------------------------------


@pytest.mark.parametrize("name", MACHINES)
def test_modes_meet_in_serial_singularities(name: str) -> None:
    design = MACHINES[name]
    start = machine_of(design).home
    for wanted in ("", *(mode for mode in inverse.MODES if mode != start.mode)):
        way = machine_of(design).singularities.mode_change(start, wanted)
        assert way is not None
        assert not way.here
        assert way.text
        assert way.at.mode == start.mode
        (changed,) = [i for i in range(2) if way.other.mode[i] != start.mode[i]]
        if wanted:
            assert way.other.mode[changed] == wanted[changed]
        turn = np.subtract(way.at.joints, way.other.joints)
        base = np.hypot(*np.subtract(way.at.pose, design.base[changed])) < 1e-9 * design.size
        assert base or np.abs(np.angle(np.exp(1j * turn))).max() < 1e-5
        stops = [
            e
            for e in machine_of(design).paths.passed(start, way.at)
            if e.stops and e.fraction < 0.999
        ]
        assert bool(stops) == way.blocked
        there = machine_of(design).singularities.mode_change(way.at, way.other.mode)
        assert there is not None
        assert there.here
        assert there.other.mode == way.other.mode


def test_no_meeting_where_nothing_is_held() -> None:
    assert (
        machine_of(PAPER).singularities.mode_change(
            machine_of(PAPER).inverse.posture((0.0, 2000.0), "+-")
        )
        is None
    )
