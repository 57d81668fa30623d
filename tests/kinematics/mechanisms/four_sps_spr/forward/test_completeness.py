"""A set called complete is complete: poses of random and of nearly special machines, start sets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kinematics.homotopy.assembly_sets import CLOSES
from kinematics.homotopy.solving import StartSet
from kinematics.machine import machine_of
from kinematics.mechanisms.four_sps_spr import inverse
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.forward import roots
from kinematics.mechanisms.four_sps_spr.forward.roots import GENERAL_COUNT
from tests.kinematics.mechanisms.four_sps_spr.machines import (
    general,
    machine,
    pentagon,
    pentagons,
    pose_distances,
    poses,
    preset,
)


def lost_one() -> FourSPSSPRDesign:
    """On the straight way from the general machine one of its 40 paths passes by infinity."""
    base = [
        (-21.981, 288.455, 0.0),
        (171.142, -388.432, 0.0),
        (50.598, -320.919, 0.0),
        (289.936, -146.026, 0.0),
        (209.209, -178.641, 0.0),
    ]
    platform = [
        (-73.340, 60.005, -3.774),
        (-107.545, 114.175, -5.438),
        (-88.901, 138.989, 23.494),
        (-94.960, 146.328, -20.068),
        (49.685, 13.664, 6.243),
    ]
    return machine(base, platform, (-0.135, 1.222, 0.0), stroke=(480.0, 1030.0))


def scaled(design: FourSPSSPRDesign, by: float) -> FourSPSSPRDesign:
    def times(values):
        return tuple(by * v for v in values)

    limbs = tuple(
        replace(
            limb,
            base=times(limb.base),
            platform=times(limb.platform),
            stroke=times(limb.stroke),
        )
        for limb in design.limbs
    )
    return replace(design, limbs=limbs)


def special(seed: int) -> FourSPSSPRDesign:
    """A random machine that misses something special by 1e-11 to 10 mm."""
    rng = np.random.default_rng(seed)
    base, platform = rng.uniform(-400, 400, (5, 3)), rng.uniform(-150, 150, (5, 3))
    axis = rng.normal(size=3)
    off = 10.0 ** rng.uniform(-11, 1)
    kind = seed % 5
    if kind in (1, 4):
        base[:, 2] = 0.0
    if kind == 2:
        base[1] = base[3] + off * rng.normal(size=3)
    if kind == 3:
        platform[2] = platform[0] + off * rng.normal(size=3)
    if kind == 4:
        base, platform = pentagon(400.0), pentagon(100.0)
        turn = np.radians(288.0)
        axis = np.array((-np.sin(turn), np.cos(turn), 0.0))
        base = base + off * rng.normal(size=(5, 3))
        platform = platform + off * rng.normal(size=(5, 3))
    return machine(base, platform, axis)


def check(design: FourSPSSPRDesign, there: np.ndarray) -> bool:
    """Poses are in their sets, or the sets are not called complete; whether all are."""
    whole = True
    for pose, found in zip(
        there, machine_of(design).forward(inverse.leg_lengths(design, there)), strict=True
    ):
        off = pose_distances(design, pose[None], found.poses).min(initial=np.inf)
        assert off < 1e-3 or not found.complete, (off, found.notes)
        assert found.complete or found.notes
        whole &= found.complete
    return whole


@pytest.mark.parametrize("seed", range(25))
def test_poses_of_special_machines_are_found_or_the_set_is_not_complete(seed: int) -> None:
    design = special(seed)
    whole = check(design, poses(design, 2, seed=seed, tilt=1.0))
    assert whole or seed % 5 >= 2


def test_the_path_that_passes_by_infinity_is_followed_around_it() -> None:
    design = lost_one()
    found = machine_of(design).forward((620.0, 840.0, 780.0, 770.0, 670.0))
    assert (found.complex_count, found.expected_count) == (40, 40)
    assert found.complete
    assert not any("infinity" in note for note in found.notes)
    assert check(design, poses(design, 3, seed=5, tilt=1.0))


def test_a_start_set_that_lacks_solutions_grows_when_they_turn_up() -> None:
    design = general(77)  # whose set no other test needs
    whole = roots.own_start_set(design)
    lengths = inverse.leg_lengths(design, poses(design, 4, seed=3))
    for complete in (True, False):
        short = StartSet(whole.parameters, whole.roots[:, 2:], complete)
        roots._own.keep(roots._key(design), short)
        found = machine_of(design).forward(lengths)
        assert {each.complex_count for each in found} == {GENERAL_COUNT}
        assert {each.expected_count for each in found} == {GENERAL_COUNT}
        assert all(each.complete for each in found)
        assert roots.own_start_set(design).complete


def test_fewer_solutions_are_said_to_be_what_two_ways_agree_on() -> None:
    design = pentagons()
    answers = machine_of(design).forward(inverse.leg_lengths(design, poses(design, 12)))
    # Rounding may leave single ones open, see `test_forward`.
    found = next((one for one in answers if one.complete), None)
    assert found is not None, [one.notes for one in answers]
    assert any("has 32: along two ways to it the others ran off" in note for note in found.notes)
    assert not any("whatever the lengths" in note for note in found.notes)


@pytest.mark.parametrize("by", [1e-6, 1e-3, 1e3, 1e6])
def test_a_scaled_machine_has_the_scaled_solutions(by: float) -> None:
    design = preset()
    lengths = inverse.leg_lengths(design, poses(design, 2, seed=4))
    for here, there in zip(
        machine_of(design).forward(lengths),
        machine_of(scaled(design, by)).forward(by * lengths),
        strict=True,
    ):
        assert here.complete
        assert there.complete
        assert len(here) == len(there)
        back = there.poses * np.array([1.0 / by] * 3 + [1.0] * 3)
        assert pose_distances(design, back, here.poses).min(axis=1).max() < 1e-6
        assert there.residual.max() < 1e-10 * by


@pytest.mark.parametrize("short", [1e-2, 1e-5, 1e-8])
def test_short_legs_are_solved_to_their_own_size_or_the_set_is_not_complete(short: float) -> None:
    design = general(5)
    rng = np.random.default_rng(2)
    turns = rng.uniform(-0.5, 0.5, 3)
    place = design.base[0] - inverse.rotation((0.0, 0.0, 0.0, *turns)) @ design.platform[0]
    pose = np.array([*(place + 100.0 * short * rng.normal(size=3)), *turns])
    # The constraint of the fifth leg is that of another machine, whose axis is across it here.
    turn = inverse.rotation(pose)
    leg = turn.T @ (pose[:3] + turn @ design.platform[4] - design.base[4])
    axis = np.cross(leg, rng.normal(size=3))
    design = replace(design, revolute_axis=tuple((axis / np.linalg.norm(axis)).tolist()))
    assert abs(inverse.violation(design, pose)) < 1e-9
    lengths = inverse.leg_lengths(design, pose)
    assert lengths[0] < 500.0 * short
    found = machine_of(design).forward(lengths)
    off = pose_distances(design, pose[None], found.poses).min(initial=np.inf)
    assert off < max(short, 1e-6) or not found.complete
    if found.complete:
        assert found.residual.max() <= CLOSES * lengths.min()


@pytest.mark.parametrize("apart", [0.0, 1e-9])
@pytest.mark.parametrize("count", [4, 5])
def test_limbs_that_are_alike_leave_no_set_that_is_complete(count: int, apart: float) -> None:
    """Equal lengths of equal limbs have a whole motion, other lengths have nothing."""
    first = preset().limbs[0]
    rng = np.random.default_rng(3)

    def near(point):
        return tuple((np.array(point) * (1.0 + apart * rng.normal(size=3))).tolist())

    alike = [
        replace(first, base=near(first.base), platform=near(first.platform)) for _ in range(count)
    ]
    design = replace(preset(), limbs=(*alike, *preset().limbs[count:]))
    home = machine_of(design).home
    found = machine_of(design).forward(home.joints)
    assert home.reachable
    assert not found.complete
    assert "architecturally singular" in " ".join(found.notes)
