"""Inverse displacement and the constraint of the 4-SPS + 1-SPR."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.errors import InputError
from kinematics.facets import inverse as generic
from kinematics.mechanisms.four_sps_spr import inverse
from kinematics.mechanisms.four_sps_spr.constraint import complete_pose, dependent_values
from kinematics.mechanisms.four_sps_spr.home import home
from kinematics.screws.spatial import wrap_angle
from tests.kinematics.mechanisms.four_sps_spr.machines import (
    angles,
    general,
    pentagons,
    places,
    poses,
    preset,
    reference,
)

MACHINES = [preset(), general(), pentagons()]
NAN = float("nan")


def test_lengths_and_constraint_of_the_samples() -> None:
    design = pentagons()
    for sample in reference("sps_spr_samples")["samples"]:
        r = np.array(sample["R"]).reshape(3, 3)
        pose = np.append(sample["p"], inverse.euler_angles(r))
        assert inverse.rotation(pose) == pytest.approx(r, abs=1e-13)
        assert inverse.leg_lengths(design, pose) == pytest.approx(sample["l"], abs=1e-10)
        assert abs(float(inverse.violation(design, pose))) < 1e-10


@given(angles, angles, angles)
def test_euler_angles_give_the_rotation_back(alpha: float, beta: float, gamma: float) -> None:
    r = inverse.rotation((0.0, 0.0, 0.0, alpha, beta, gamma))
    again = inverse.rotation(np.append(np.zeros(3), inverse.euler_angles(r)))
    assert again == pytest.approx(r, abs=1e-7 if abs(np.cos(beta)) < 1e-6 else 1e-12)


@pytest.mark.parametrize("beta", [np.pi / 2, -np.pi / 2])
def test_euler_angles_at_the_pole(beta: float) -> None:
    r = inverse.rotation((0.0, 0.0, 0.0, 0.7, beta, -0.4))
    again = inverse.rotation(np.append(np.zeros(3), inverse.euler_angles(r)))
    assert again == pytest.approx(r, abs=1e-12)


@given(st.sampled_from(MACHINES), places, angles, angles, angles, st.integers(0, 5))
def test_whichever_coordinate_follows_satisfies_the_constraint(
    design, place, alpha, beta, gamma, index
) -> None:
    pose = np.array([*place, alpha, beta, gamma])
    found = dependent_values(design, pose, index)
    scale = 1.0 + np.abs(np.nan_to_num(found)).max() if index < 3 else 1.0
    for value in found[np.isfinite(found)]:
        there = pose.copy()
        there[index] = value
        assert abs(float(inverse.violation(design, there))) < 1e-9 * scale


@pytest.mark.parametrize("design", MACHINES)
@pytest.mark.parametrize("index", range(6))
def test_the_coordinate_that_was_there_is_found_again(design, index: int) -> None:
    for pose in poses(design, 20, seed=index):
        found = dependent_values(design, pose, index)
        # Where a position has next to no say it is not well determined either.
        turned = inverse.rotation(pose) @ design.axis
        loose = 1e-9 / max(abs(turned[index]), 1e-6) if index < 3 else 1e-7
        away = found - pose[index] if index < 3 else wrap_angle(found - pose[index])
        assert np.nanmin(np.abs(away)) < loose


def test_no_value_of_an_angle_is_enough_far_away() -> None:
    design = preset()
    # Far along the axis the plane of limb 5 can no longer be turned through A5 by γ.
    with pytest.raises(InputError, match="no γ satisfies"):
        complete_pose(design, (3000.0, 0.0, 100.0, 0.0, 0.0, NAN))
    assert np.isnan(dependent_values(design, (3000.0, 0.0, 100.0, 0.0, 0.0, 0.0), 5)).all()


def test_a_position_that_has_no_say_is_refused() -> None:
    design = preset()  # level, its axis is horizontal
    with pytest.raises(InputError, match="z cannot follow"):
        complete_pose(design, (0.0, 0.0, NAN, 0.0, 0.0, 0.0))
    with pytest.raises(InputError, match="not x and y"):
        complete_pose(design, (NAN, NAN, 500.0, 0.0, 0.0, 0.0))


def test_the_angle_nearest_to_zero_or_to_its_value_is_taken() -> None:
    design = preset()
    pose = (10.0, 20.0, 560.0, 0.1, 0.05, NAN)
    both = dependent_values(design, pose, 5)
    near = complete_pose(design, pose)[5]
    assert abs(near) == pytest.approx(np.abs(both).min())
    far = both[np.abs(both).argmax()]
    there = complete_pose(design, (*pose[:5], float(far) + 0.1), dependent=5)
    assert there[5] == pytest.approx(far)


def test_by_default_the_position_that_moves_least_gives_way() -> None:
    design = preset()
    start = home(design).pose
    moved = (start[0] + 5.0, *start[1:])
    there = complete_pose(design, moved, moved=0)
    assert there[0] == moved[0]
    assert there[1] != moved[1]
    assert there[2:] == moved[2:]
    assert complete_pose(design, moved, moved=0, dependent=0)[0] == moved[0]


def test_a_pose_off_the_constraint_cannot_close_and_says_by_how_much() -> None:
    design = preset()
    pose = np.array(home(design).pose)
    pose[:3] += 3.0 * design.axis
    posture = generic.posture(design, pose)
    assert not posture.closes
    assert not posture.reachable
    (reason,) = posture.reasons
    assert (reason.limb, reason.bound) == (5, "link")
    assert reason.amount == pytest.approx(3.0)
    assert "3.0 mm off the plane" in reason.text
    answer = generic.inverse(design, pose)
    assert np.isnan(answer.joints[0, 4])
    assert not answer.within_stroke.any()


def test_reasons_name_limb_and_amount() -> None:
    design = preset()
    posture = generic.posture(design, (0.0, 0.0, 700.0, 0.0, 0.0, 0.0))
    assert {reason.bound for reason in posture.reasons} <= {"rho_max"}
    for reason in posture.reasons:
        beyond = posture.joints[reason.limb - 1] - design.stroke[reason.limb - 1, 1]
        assert reason.amount == pytest.approx(beyond)
        assert f"limb {reason.limb} is" in reason.text
    assert posture.closes


def test_batches_are_their_single_poses() -> None:
    design = general()
    batch = poses(design, 12).reshape(3, 4, 6)
    answer = generic.inverse(design, batch)
    assert answer.joints.shape == (3, 4, 1, 5)
    assert answer.within_stroke.shape == (3, 4, 1)
    for n in np.ndindex(3, 4):
        assert answer.joints[n][0] == pytest.approx(generic.posture(design, batch[n]).joints)
    with pytest.raises(ValueError, match="read-only"):
        answer.joints[0] = 0.0


@pytest.mark.parametrize("bad", [(1.0, 2.0, 3.0), (1.0, 2.0, 3.0, 4.0, 5.0, NAN)])
def test_broken_poses_are_refused(bad) -> None:
    with pytest.raises(InputError):
        generic.posture(preset(), bad)
