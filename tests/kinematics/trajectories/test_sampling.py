"""What trajectories ask of machines, what goes wrong on the way, and fits with their true error."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from kinematics import trajectories as t
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from tests.conftest import ROOT

FIVE = load_design("five-bar")
M = machine_of(FIVE)
UNIT = (1.0, 1.0)


@pytest.fixture(scope="module")
def reference() -> dict[str, Any]:
    found: dict[str, Any] = json.loads((ROOT / "tests/reference/five_bar.json").read_text())
    return found["paper_fits_reproduced"]


def _named(name: str, samples: int) -> t.Trajectory:
    (way,) = [each for each in machine_of(FIVE).paths.named() if each.name == name]
    return t.trajectory(M, way.path, way.law, way.mode, samples=samples, distances=False)


# As printed: from the highest power down.
EQUATIONS = {
    ("line", 3, 101): (
        ("-0.0483", "0.00275", "-0.313", "1.885"),  # 16
        ("0.00679", "0.03773", "-0.04781", "1.257"),  # 17
    ),
    ("rest-to-rest", 8, 201): (
        ("0.0389", "-0.2956", "0.8108", "-0.9338", "0.4123", "-0.1316", "0.0009381", "0.0007719",
         "1.885"),  # 18
        ("0.009799", "-0.1293", "0.5938", "-1.415", "2.067", "-1.633", "0.1462", "-0.01345",
         "1.257"),  # 19
    ),
}  # fmt: skip


@pytest.mark.parametrize(("name", "degree", "samples"), EQUATIONS)
def test_equations_16_to_19_to_every_printed_digit(name: str, degree: int, samples: int) -> None:
    fits = t.fit(M, _named(name, samples), degree)
    for row, printed in zip(fits.coefficients, EQUATIONS[name, degree, samples], strict=True):
        for value, text in zip(row[::-1], printed, strict=True):
            decimals = len(text.partition(".")[2])
            assert f"{value:.{decimals}f}" == text


@pytest.mark.parametrize(
    ("name", "key", "degree", "samples"),
    [("line", "linear", 3, 101), ("rest-to-rest", "rest", 8, 201)],
)
def test_the_true_errors_of_the_fits(
    reference: dict[str, Any], name: str, key: str, degree: int, samples: int
) -> None:
    fits = t.fit(M, _named(name, samples), degree)
    known = reference[key]
    for errors, wanted in zip(fits.deviation, ("std_pos", "std_vel", "std_acc"), strict=True):
        np.testing.assert_allclose(errors / 10.0, known[wanted], rtol=1e-9)
    np.testing.assert_allclose(fits.largest[0] / 10.0, known["max_pos"], rtol=1e-9)
    for n, row in enumerate(fits.coefficients):
        np.testing.assert_allclose(row, known[f"theta{n + 1}_coef"], rtol=1e-7, atol=1e-10)
    # Without a fit, FK(IK) closes but for rounding.
    exact = _named(name, samples)
    for pose, joints in zip(exact.poses[::10], exact.joints[::10], strict=True):
        posture = machine_of(FIVE).inverse.posture(tuple(pose.tolist()), "+-")
        reached = machine_of(FIVE).following.follow(posture, joints.tolist()).posture
        assert np.abs(np.subtract(reached.pose, pose)).max() < 1e-11


def test_rates_and_accelerations_are_those_of_the_joints() -> None:
    found = _named("rest-to-rest", 2001)
    step = found.times[1]
    rates = (found.joints[2:] - found.joints[:-2]) / (2 * step)
    np.testing.assert_allclose(found.joint_rates[1:-1], rates, atol=2e-5)
    second = (found.joints[2:] - 2 * found.joints[1:-1] + found.joints[:-2]) / step**2
    np.testing.assert_allclose(found.joint_accelerations[1:-1], second, atol=2e-4)
    assert found.sound
    assert found.events == ()
    assert not found.poses.flags.writeable


def test_forces_hold_the_load_and_distances_are_told() -> None:
    (way,) = [each for each in machine_of(FIVE).paths.named() if each.name == "rest-to-rest"]
    load = [3.0, -100.0, 0, 0, 0, 0]
    found = t.trajectory(M, way.path, way.law, way.mode, samples=21, load=load)
    power = (found.forces * found.joint_rates).sum(axis=1) + found.pose_rates @ load[:2]
    np.testing.assert_allclose(power, 0.0, atol=1e-6)
    assert [name.limb for name in found.names] == [1, 2]
    assert (np.diff(found.distance) < 0.0).all()
    assert found.distance[-1] == pytest.approx(102.83426, abs=1e-4)
    assert (found.conditioning > 0.2).all()


def test_the_line_leaves_the_workspace_at_the_known_time() -> None:
    path = t.line((0.0, 738.644), (200.0, 938.644), UNIT)
    for samples in (5, 101):
        found = t.trajectory(M, path, t.law("linear", 2.0), "+-", samples=samples)
        (event,) = found.events
        assert event.kind == "outside"
        assert event.start == pytest.approx(1.42056286, abs=1e-7)
        assert f"{event.start:.4f}" == "1.4206"
        assert event.end == 2.0
        assert "limb 1" in event.text
        assert not found.sound
        assert np.isnan(found.joints[-1]).any()
        assert found.reachable[0]
    with pytest.raises(InputError, match="leaves the workspace"):
        t.fit(M, found, 3)


def test_an_excursion_between_two_samples_is_found() -> None:
    path = t.line((-150.0, 937.0), (150.0, 937.0), UNIT)  # beyond both limbs' reach near the middle
    edge = machine_of(FIVE).inverse.posture((0.0, 937.0), "+-")
    assert not edge.reachable
    found = t.trajectory(M, path, t.law("linear", 1.0), "+-", samples=2)
    assert [event.kind for event in found.events] == ["outside"]
    high = t.line((-300.0, 640.0), (300.0, 640.0), UNIT)
    assert not t.trajectory(M, high, t.law("linear", 1.0), "+-", samples=2).events


@pytest.mark.parametrize("samples", [4, 31, 101])
def test_a_crossing_is_found_with_time_and_place(samples: int) -> None:
    path = t.line((0.0, 700.0), (0.0, 300.0), UNIT)
    found = t.trajectory(M, path, t.law("linear", 4.0), "+-", samples=samples)
    crossed = [event for event in found.events if event.kind == "singularity"]
    assert len(crossed) == 1
    assert crossed[0].pose[1] == pytest.approx(415.69219381653, abs=1e-6)
    assert crossed[0].start == pytest.approx((700.0 - 415.69219381653) / 100.0, abs=1e-8)
    assert "in line" in crossed[0].text


def test_two_crossings_between_samples_are_found() -> None:
    # Through the narrow top of the extended curve and out again within one step.
    path = t.line((-60.0, 414.5), (60.0, 414.5), UNIT)
    found = t.trajectory(M, path, t.law("linear", 1.0), "+-", samples=12)
    assert any(event.kind == "singularity" for event in found.events)


def test_near_ones_are_told_but_stop_nothing() -> None:
    path = t.line((-200.0, 425.0), (200.0, 425.0), UNIT)
    found = t.trajectory(M, path, t.law("linear", 1.0), "+-", samples=101, near=15.0)
    (event,) = found.events
    assert event.kind == "near"
    assert event.value == pytest.approx(425.0 - 415.6921938, abs=1e-4)
    assert event.start < 0.5 < event.end
    assert found.sound


def test_limits_and_the_duration_that_keeps_them() -> None:
    (way,) = [each for each in machine_of(FIVE).paths.named() if each.name == "rest-to-rest"]
    limits = t.Limits(rates=(0.3, 0.3), accelerations=(1.0, 1.0), forces=(1e4, 1e9))
    load = [0, -100.0, 0, 0, 0, 0]
    found = t.trajectory(M, way.path, way.law, way.mode, load=load, limits=limits, distances=False)
    kinds = {(event.kind, event.joint) for event in found.events}
    assert ("rate", 0) in kinds
    assert ("rate", 1) in kinds
    assert ("acceleration", 1) in kinds
    assert ("force", 0) in kinds
    assert ("force", 1) not in kinds
    for event in found.events:
        assert event.text
        assert event.start <= event.end
    slow = t.duration_within(found, limits)
    assert slow > way.law.duration
    kept = t.trajectory(
        M, way.path, t.law("quintic", slow * 1.001), way.mode, distances=False,
        limits=t.Limits(limits.rates, limits.accelerations),
    )  # fmt: skip
    assert kept.events == ()
    with pytest.raises(InputError, match="2 positive numbers"):
        t.trajectory(M, way.path, way.law, way.mode, limits=t.Limits(rates=(1.0,)))


def test_a_leap_of_a_joint_is_told() -> None:
    path = t.line((-240.0, 120.0), (-240.0, -120.0), UNIT)  # over A_1
    found = t.trajectory(M, path, t.law("linear", 1.0), "++", samples=100, distances=False)
    assert any(event.kind == "jump" and event.joint == 0 for event in found.events)


def test_angles_run_on_beyond_half_a_turn() -> None:
    circle = [(-300.0 + 90 * np.cos(a), 90 * np.sin(a)) for a in np.linspace(0.3, 6.5, 60)]
    path = t.spline(circle, UNIT)
    found = t.trajectory(M, path, t.law("linear", 1.0), "++", samples=201, distances=False)
    assert np.abs(np.diff(found.joints, axis=0)).max() < 0.5


def test_playback() -> None:
    found = _named("rest-to-rest", 201)
    assert found.index_at(0.0) == 0
    assert found.index_at(1.0) == 100
    assert found.index_at(1.0, speed=0.5) == 50
    assert found.index_at(3.0, playback="loop") == 100
    assert found.index_at(5.0, playback="once") == 200
    assert found.index_at(3.0, playback="swing") == 100
    assert found.index_at(2.5, playback="swing") == 150


def test_mistakes() -> None:
    path, law = t.line((0.0, 700.0), (0.0, 600.0), UNIT), t.law("linear", 1.0)
    with pytest.raises(InputError, match="no mode"):
        t.trajectory(M, path, law, "+++++")
    with pytest.raises(InputError, match="samples"):
        t.trajectory(M, path, law, "+-", samples=1)
    with pytest.raises(InputError, match="load"):
        t.trajectory(M, path, law, "+-", load=[1.0])
    found = t.trajectory(M, path, law, "+-", samples=5, distances=False)
    with pytest.raises(InputError, match="degree"):
        t.fit(M, found, 21)
    with pytest.raises(InputError, match="more than 5"):
        t.fit(M, found, 5)


def test_another_mechanism_runs_the_same_room() -> None:
    design = load_design("rpur-table1")
    home = machine_of(design).home
    goal = np.add(home.pose, [15.0, -10.0, 12.0, 0.05, -0.04])
    length = machine_of(design).length
    scale = (1.0, 1.0, 1.0, length, length)
    path = t.line(home.pose, goal.tolist(), scale)
    found = t.trajectory(
        machine_of(design), path, t.law("cubic", 1.0), home.mode, samples=41, distances=False,
        load=[0, 0, -100.0, 0, 0, 0],
    )  # fmt: skip
    assert found.sound
    step = found.times[1]
    rates = (found.joints[2:] - found.joints[:-2]) / (2 * step)
    np.testing.assert_allclose(found.joint_rates[1:-1], rates, rtol=2e-2, atol=0.2)
    power = (found.forces[:, :5] * found.joint_rates).sum(axis=1)
    power = power + np.einsum("nk,k->n", machine_of(design).motion.inverse(
        found.poses, home.mode, found.pose_rates).twist[:, 3:], [0, 0, -100.0])  # fmt: skip
    np.testing.assert_allclose(power, 0.0, atol=1e-5)
    fits = t.fit(machine_of(design), found, 6)
    assert fits.largest[0].max() < 0.05


def test_a_dependent_coordinate_follows_the_constraint() -> None:
    design = load_design("sps-spr")
    home = machine_of(design).home
    # From home to a place off the straight way, with the angles turned.
    goal = machine_of(design).complete_pose(
        tuple(np.add(home.pose, [20.0, 15.0, 10.0, 0.05, -0.04, 0.1])), home.mode
    )
    length = machine_of(design).length
    path = t.line(home.pose, goal, (1.0, 1.0, 1.0, length, length, length))
    for dependent in (None, 5):
        found = t.trajectory(
            machine_of(design), path, t.law("quintic", 1.0), home.mode, samples=41, distances=False,
            dependent=dependent,
        )  # fmt: skip
        assert found.reachable.all(), found.events
        step = found.times[1]
        rates = (found.poses[2:] - found.poses[:-2]) / (2 * step)
        scale = np.abs(found.pose_rates).max()
        np.testing.assert_allclose(found.pose_rates[1:-1], rates, atol=1e-2 * scale)
        joints = (found.joints[2:] - found.joints[:-2]) / (2 * step)
        scale = np.abs(found.joint_rates).max()
        np.testing.assert_allclose(found.joint_rates[1:-1], joints, atol=1e-2 * scale)
