"""Between samples: largest values, limits, corners, leaps and events that no sample shows."""

from __future__ import annotations

from math import inf, nan, pi, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics import trajectories as t
from kinematics.answers.trajectories import Quantity
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.trajectories.along import Along

FIVE = load_design("five-bar")
M = machine_of(FIVE)
UNIT = (1.0, 1.0)
BENT = ((0.0, 804.0), (100.0, 700.0), (-100.0, 600.0))


def _run(path: t.Path, law: t.Law, samples: int = 101, **options: object) -> t.Trajectory:
    options = {"distances": False} | options
    return t.trajectory(M, path, law, "+-", samples=samples, **options)  # type: ignore[arg-type]


def _dense(path: t.Path, law: t.Law, what: Quantity, count: int = 40_001) -> np.ndarray:
    along = Along(M, path, law, "+-")
    times = np.linspace(0.0, law.duration, count)
    rates, accelerations, _ = along.asked(times, None)
    most: np.ndarray = np.abs(rates if what == "rate" else accelerations).max(axis=0)
    return most


def _lissajous(points: int = 5000) -> t.Path:
    a = np.linspace(0.0, 2.0 * pi, points)
    return t.spline(
        np.column_stack([120.0 * np.sin(5.0 * a), 650.0 + 60.0 * np.sin(7.0 * a + 0.4)]), UNIT
    )


@pytest.mark.parametrize("samples", [2, 3, 17, 101])
def test_the_largest_values_are_those_of_the_trajectory(samples: int) -> None:
    (way,) = [each for each in machine_of(FIVE).paths.named() if each.name == "rest-to-rest"]
    found = _run(way.path, way.law, samples)
    along = Along(M, way.path, way.law, way.mode)
    for n, what in enumerate(("rate", "acceleration")):
        most, times = found.largest(what)  # type: ignore[arg-type]
        np.testing.assert_allclose(most, _dense(way.path, way.law, what), rtol=1e-7)  # type: ignore[arg-type]
        there = np.abs(along.asked(times, None)[n])
        np.testing.assert_allclose(np.diag(there), most, rtol=1e-12)
    # Reference: the largest rate of θ₂ at 40 001 samples, 39.7073 °/s.
    slow = t.duration_within(found, t.Limits(rates=(radians(10.0), radians(10.0))))
    assert slow == pytest.approx(7.9414633, abs=1e-6)
    limits = t.Limits(rates=(radians(10.0),) * 2)
    for factor, count in ((1.0 + 1e-8, 0), (1.0 - 1e-6, 1)):
        again = _run(way.path, t.law("quintic", slow * factor), samples, limits=limits)
        assert len(again.events) == count


def test_a_path_that_is_finer_than_its_samples() -> None:
    path, law = _lissajous(), t.law("quintic", 60.0)
    found = _run(path, law)
    dense = _dense(path, law, "acceleration", 200_001)
    sampled = np.abs(found.joint_accelerations).max(axis=0)
    assert (sampled < 0.9 * dense).any()
    most, times = found.largest("acceleration")
    assert (dense <= most).all()
    np.testing.assert_allclose(most, dense, rtol=1e-3)  # it has a kink at every point
    there = np.abs(Along(M, path, law, "+-").asked(times, None)[1])
    np.testing.assert_allclose(np.diag(there), most, rtol=1e-12)
    limit = float(0.5 * (sampled[1] + dense[1]))
    told = _run(path, law, limits=t.Limits(accelerations=(1e9, limit))).events
    assert {event.kind for event in told} == {"acceleration"}
    assert max(event.value for event in told) == pytest.approx(most[1], rel=1e-9)


def test_a_limit_is_exceeded_from_when_to_when() -> None:
    (way,) = [each for each in machine_of(FIVE).paths.named() if each.name == "rest-to-rest"]
    limit = radians(39.0)
    found = _run(way.path, way.law, 4, limits=t.Limits(rates=(9.0, limit)))
    (event,) = found.events
    along = Along(M, way.path, way.law, way.mode)
    ends = np.array([event.start, event.end, event.at])
    rates = np.abs(along.asked(ends, None)[0][:, 1])
    np.testing.assert_allclose(rates[:2], limit, rtol=1e-7)
    assert rates[2] == pytest.approx(event.value, rel=1e-12)
    assert event.start < event.at < event.end
    assert "°/s at t = 1.035 s" in event.text


@pytest.mark.parametrize(("kind", "samples"), [("linear", 101), ("quintic", 5), ("cubic", 2)])
def test_corners_that_are_passed_at_speed_are_told(kind: str, samples: int) -> None:
    path, law = t.polyline(BENT, UNIT), t.law(kind, 4.0)
    found = _run(path, law, samples, limits=t.Limits(accelerations=(1e9, 1e9)))
    corner = next(event for event in found.events if event.kind == "corner")
    assert corner.pose == pytest.approx(BENT[1], abs=1e-6)
    assert corner.start == corner.end == corner.at
    along = Along(M, path, law, "+-")
    sides = along.asked(corner.at + np.array([-1e-7, 1e-7]), None)[0]
    assert corner.value == pytest.approx(np.abs(np.diff(sides, axis=0)).max(), rel=1e-4)
    assert not found.sound
    # They are infinite accelerations, beyond any limit, and no duration helps.
    assert (found.largest("acceleration")[0] == inf).all()
    assert np.isfinite(found.largest("rate")[0]).all()
    with pytest.raises(InputError, match="sharp corner"):
        t.duration_within(found, t.Limits(accelerations=(1.0, 1.0)))
    assert t.duration_within(found, t.Limits(rates=(0.1, 0.1))) > 4.0


def test_round_and_straight_corners_are_none() -> None:
    law = t.law("linear", 4.0)
    for points, blend in ((BENT, 3.0), (((0.0, 700.0), (0.0, 650.0), (0.0, 600.0)), 0.0)):
        path = t.polyline(points, UNIT, blend)
        found = _run(path, law)
        assert found.events == ()
        assert found.close.corners.size == 0
        # Of a corner that is rounded between two samples the acceleration is known.
        dense = _dense(path, law, "acceleration", 400_001)
        np.testing.assert_allclose(found.largest("acceleration")[0], dense, rtol=1e-4)


def test_many_corners_are_one_event() -> None:
    a = np.linspace(0.0, 2.0 * pi, 400)
    points = np.column_stack([80.0 * np.cos(a), 650.0 + 80.0 * np.sin(a)])
    found = _run(t.polyline(points, UNIT), t.law("quintic", 4.0))
    (event,) = found.events
    assert event.kind == "corner"
    assert "398 sharp corners" in event.text
    assert event.start < 0.5 < 3.5 < event.end


def test_the_ends_of_a_law_s_phases_count() -> None:
    path = t.line((0.0, 738.644), (200.0, 500.0), UNIT)
    law = t.law("trapezoidal", 2.0, ramp=0.23)
    found = _run(path, law, 11)
    dense = _dense(path, law, "acceleration", 400_001)
    np.testing.assert_allclose(found.largest("acceleration")[0], dense, rtol=1e-4)
    assert found.moving_ends == (False, False)
    assert found.events == ()


def test_constant_velocity_begins_and_ends_at_speed_and_that_is_no_event() -> None:
    (way,) = [each for each in machine_of(FIVE).paths.named() if each.name == "line"]
    found = _run(way.path, way.law)
    assert found.events == ()
    assert found.sound
    assert found.moving_ends == (True, True)
    assert np.isfinite(found.largest("acceleration")[0]).all()


@pytest.mark.parametrize("samples", [3, 8, 101])
def test_what_grows_without_end_is_infinite(samples: int) -> None:
    # Forces at a parallel singularity; rates where a limb is stretched.
    path, law = t.line((0.0, 700.0), (0.0, 300.0), UNIT), t.law("quintic", 4.0)
    found = _run(
        path, law, samples, load=[10.0, -50.0, 0, 0, 0, 0], limits=t.Limits(forces=(1e5, 1e5))
    )
    crossing = next(event for event in found.events if event.kind == "singularity")
    most, times = found.largest("force")
    assert (most == inf).all()
    np.testing.assert_allclose(times, crossing.start, atol=1e-6)
    assert sum("without end" in event.text for event in found.events) == 2
    out = t.line((0.0, 738.644), (200.0, 938.644), UNIT)
    found = _run(out, t.law("linear", 2.0), samples)
    most, times = found.largest("rate")
    assert most[0] == inf
    assert np.isfinite(most[1])
    assert times[0] == pytest.approx(1.42056286, abs=1e-6)
    with pytest.raises(InputError, match="leaves the workspace"):
        t.duration_within(found, t.Limits(rates=(1.0, 1.0)))


def test_where_nothing_moves_no_duration_is_the_shortest() -> None:
    design = load_design("rps-3")
    machine = machine_of(design)
    length = machine.length
    path = t.line((283.0, 0.0, 0.0), (283.0, 0.0, pi / 2.0), (1.0, length, length))
    for samples in (2, 101):
        found = t.trajectory(
            machine,
            path,
            t.law("quintic", 2.0),
            machine.home.mode,
            samples=samples,
            distances=False,
        )
        with pytest.raises(InputError, match="no actuator moves"):
            t.duration_within(found, t.Limits(rates=(10.0,) * 3))
    high = _run(t.line((0.0, 700.0), (0.0, 600.0), UNIT), t.law("cubic", 1.0), 2)
    with pytest.raises(InputError, match="more than"):
        t.duration_within(high, t.Limits(rates=(1e-12, 1e-12)))
    assert t.duration_within(high, t.Limits(rates=(1e12, 1e12))) == 1e-6


def test_forces_beyond_a_limit_need_not_be_sampled() -> None:
    path = t.line((-200.0, 425.0), (200.0, 425.0), UNIT)  # over the top of the extended curve
    load = [0.0, -100.0, 0, 0, 0, 0]
    fine = _run(path, t.law("linear", 1.0), 20_001, load=load)
    coarse = _run(path, t.law("linear", 1.0), 4, load=load)
    most = np.abs(fine.forces).max(axis=0)
    np.testing.assert_allclose(coarse.largest("force")[0], most, rtol=1e-6)
    told = _run(
        path, t.law("linear", 1.0), 4, load=load, limits=t.Limits(forces=(0.9 * most[0], 1e9))
    )
    assert "force" in {event.kind for event in told.events}


def test_an_excursion_tells_where_it_begins_how_far_it_goes_and_when_it_ends() -> None:
    away = _run(t.line((0.0, 804.0), (0.0, 3000.0), UNIT), t.law("quintic", 21.96))
    (event,) = away.events
    assert event.pose[1] == pytest.approx(np.sqrt(960.0**2 - 240.0**2), abs=1e-6)
    assert event.at == pytest.approx(21.96)
    assert event.value == pytest.approx(np.hypot(240.0, 3000.0) - 960.0, abs=1e-6)
    assert "does not come back" in event.text
    assert f"{event.value:.1f} mm beyond" in event.text
    bow = t.spline([(-300.0, 700.0), (-10.0, 980.0), (300.0, 700.0)], UNIT)
    for samples in (7, 101):
        (event,) = _run(bow, t.law("linear", 2.0), samples).events
        along = Along(M, bow, t.law("linear", 2.0), "+-")
        times = np.linspace(event.start, event.end, 4001)
        over = [max(r.amount for r in along.posture(x).reasons) for x in times[1:-1]]
        assert event.value == pytest.approx(max(over), abs=1e-4)
        assert times[1 + int(np.argmax(over))] == pytest.approx(event.at, abs=2e-3)
        assert f"comes back at t = {event.end:.4f} s" in event.text
        for side in (event.start, event.end):
            assert abs(along.room(side)) < 1e-9


def test_one_line_for_one_singularity() -> None:
    path = t.polyline([(0.0, 804.0), (0.0, 100.0), (0.0, -700.0)], UNIT)
    for samples in (51, 101, 201):
        found = _run(path, t.law("quintic", 15.04), samples, distances=True)
        assert [event.kind for event in found.events] == ["singularity", "singularity"]
    # Exactly on a sample, too.
    line = t.line((0.0, 415.69219381653 + 100.0), (0.0, 415.69219381653 - 100.0), UNIT)
    found = _run(line, t.law("linear", 2.0), 101, distances=True)
    assert [event.kind for event in found.events] == ["singularity"]


@pytest.mark.parametrize("samples", [2, 3, 5])
def test_coarse_samples_are_no_leap(samples: int) -> None:
    path = t.line((-240.0, 300.0), (240.0, 300.0), UNIT)
    for kind in ("linear", "quintic"):
        found = _run(path, t.law(kind, 1.0), samples)
        assert not [event for event in found.events if event.kind == "jump"]


@pytest.mark.parametrize("samples", [4, 100, 101])
def test_a_leap_is_told_where_it_is(samples: int) -> None:
    path = t.line((-240.0, 120.0), (-240.0, -120.0), UNIT)  # over A₁
    found = _run(path, t.law("linear", 1.0), samples)
    (leap,) = [event for event in found.events if event.kind == "jump"]
    assert leap.joint == 0
    assert leap.start <= 0.5 <= leap.end
    assert leap.end - leap.start < 1e-3
    assert leap.value == pytest.approx(pi, abs=0.02)


@settings(max_examples=25)
@given(
    st.lists(st.tuples(st.floats(-200, 200), st.floats(520, 800)), min_size=3, max_size=8),
    st.sampled_from(["linear", "cubic", "quintic", "trapezoidal"]),
    st.integers(2, 40),
)
def test_no_moment_asks_for_more_than_the_largest(
    points: list[tuple[float, float]], kind: str, samples: int
) -> None:
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if (steps < 1.0).any():
        return
    path, law = t.spline(points, UNIT), t.law(kind, 3.0)
    found = _run(path, law, samples)
    if not np.isfinite(_dense(path, law, "acceleration", 4001)).all():
        return
    for what in ("rate", "acceleration"):
        dense = _dense(path, law, what, 4001)  # type: ignore[arg-type]
        most, _ = found.largest(what)  # type: ignore[arg-type]
        assert (dense <= most * (1.0 + 1e-6)).all()
    assert nan not in found.close.times
