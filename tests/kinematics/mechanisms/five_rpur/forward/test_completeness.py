"""A set called complete is complete: every pose that the inverse kinematics holds is in it.

Over random designs, designs with exact and with nearly exact arrangements, all working modes, sizes
from 1e-6 to 1e6 and limbs as short as a millionth of the machine.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kinematics.answers.solutions import ForwardSolutions
from kinematics.designs.files import load_design
from kinematics.homotopy import solving
from kinematics.homotopy.assembly_sets import CLOSES
from kinematics.homotopy.solving import StartSet, solve
from kinematics.homotopy.tracking import Ending, track
from kinematics.mechanisms.five_rpur.design import MODES, FiveRPURDesign
from kinematics.mechanisms.five_rpur.forward import equations, families, general
from kinematics.mechanisms.five_rpur.inverse import inverse, joint_points, limb_lengths
from tests.kinematics.mechanisms.five_rpur.machines import MODE_SIGNS, forward, made

N3_POSE = (190.0, 30.0, 180.0, np.radians(20.0), np.radians(-35.0))
N3_JOINTS = (
    288.65110866805077,
    316.3266882632849,
    337.70032158986197,
    375.37892838430844,
    337.1526647066503,
)
LOWEST, HIGHEST = (-200, -200, -200, -3, -3), (200, 200, 200, 3, 3)


def scaled(design: FiveRPURDesign, by: float) -> FiveRPURDesign:
    def times(values):
        return tuple(by * v for v in values)

    return replace(
        design,
        limbs=tuple(
            replace(
                limb,
                base=times(limb.base),
                platform=times(limb.platform),
                link=by * limb.link,
                stroke=times(limb.stroke),
            )
            for limb in design.limbs
        ),
    )


def random_design(rng: np.random.Generator, off: float | None) -> FiveRPURDesign:
    """Any design that can be assembled; or one with one or two relations between limbs, missed by
    ``off`` mm or so."""
    while True:
        design = _any_design(rng, off)
        poses = np.random.default_rng(0).uniform(LOWEST, HIGHEST, (2000, 5))
        if np.isfinite(limb_lengths(design, poses)).all(axis=(1, 2)).any():
            return design


def _any_design(rng: np.random.Generator, off: float | None) -> FiveRPURDesign:
    base, platform = rng.uniform(-150, 150, (5, 3)), rng.uniform(-80, 80, (5, 3))
    link = rng.uniform(80, 220, 5)
    kinds = rng.choice(["A1", "A2", "A3", "S", "R"], size=rng.integers(1, 3))
    pairs = ((0, 1), (2, 3)) if rng.random() < 0.7 else ((0, 1), (0, 2))
    for kind, (i, j) in zip(kinds if off is not None else (), pairs, strict=False):
        a, b, c = off * rng.normal(size=(3, 3))
        if kind != "R":
            platform[j, 1:] = platform[i, 1:] + a[:2]
        if kind in ("R", "A2"):
            base[j, [0, 2]] = base[i, [0, 2]] + b[:2]
        if kind in ("A1", "A2", "A3"):
            base[j, 1], link[j] = base[i, 1] + c[0], link[i] + c[1]
        if kind == "A1":
            platform[j, 0] = platform[i, 0] + c[2]
    return made(base, platform, link)


def held(design: FiveRPURDesign, rng: np.random.Generator) -> np.ndarray:
    """A pose at which all limbs close."""
    while True:
        pose = rng.uniform(LOWEST, HIGHEST)
        if np.isfinite(limb_lengths(design, pose)).all():
            return pose


def lengths(design: FiveRPURDesign, pose, mode: str) -> np.ndarray:
    both = limb_lengths(design, pose)
    return np.where(np.array(MODE_SIGNS[mode]) > 0.0, both[:, 0], both[:, 1])


def missed(found: ForwardSolutions, pose, mode: str) -> float:
    """How far the nearest solution of the mode is from a pose, mm and 0.01 rad."""
    same = [n for n, other in enumerate(found.modes) if other == mode]
    d = found.poses[same] - np.asarray(pose)
    d[:, 3:] = 100.0 * np.angle(np.exp(1j * d[:, 3:]))
    return float(np.abs(d).max(axis=1).min(initial=np.inf))


def check(design: FiveRPURDesign, pose, mode: str) -> bool:
    """The pose is in its set, or the set is not called complete; whether it is."""
    (found,) = forward(design, lengths(design, pose, mode))
    off = missed(found, pose, mode)
    assert off < 1e-3 or not found.complete, (off, design, pose, mode, found.notes)
    if not found.complete:
        assert found.notes
    return found.complete


# --- every pose ------------------------------------------------------------------------------


def test_a_pose_in_mixed_modes_is_among_the_solutions() -> None:
    """Table 2 says nothing of merged joints: all 32 modes count."""
    design = load_design("rpur-table2")
    assert lengths(design, N3_POSE, "+-+-+") == pytest.approx(N3_JOINTS, abs=1e-9)
    (found,) = forward(design, N3_JOINTS)
    assert missed(found, N3_POSE, "+-+-+") < 1e-8
    assert found.complete
    assert (found.complex_count, found.expected_count) == (1120, 1120)
    assert inverse(design, N3_POSE).within_stroke[MODES.index("+-+-+")]


@pytest.mark.parametrize("seed", range(5))
def test_poses_of_random_designs_are_in_complete_sets(seed: int) -> None:
    rng = np.random.default_rng(seed)
    design = random_design(rng, None)
    pose = held(design, rng)
    for mode in rng.choice(MODES, 2, replace=False).tolist():
        assert check(design, pose, mode)


@pytest.mark.parametrize("seed", range(5))
def test_poses_of_arranged_designs_are_in_complete_sets(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    design = random_design(rng, 0.0)
    pose = held(design, rng)
    for mode in rng.choice(MODES, 2, replace=False).tolist():
        assert check(design, pose, mode)


@pytest.mark.parametrize("off", [1e-11, 1e-9, 1e-7, 1e-5, 1e-3, 1e-1])
@pytest.mark.slow
def test_poses_of_nearly_arranged_designs_are_found_or_the_set_is_not_complete(off: float) -> None:
    rng = np.random.default_rng(int(-np.log10(off)))
    design = random_design(rng, off)
    for mode in rng.choice(MODES, 2, replace=False).tolist():
        check(design, held(design, rng), mode)


def test_a_random_design_with_solutions_far_out_is_solved_whole() -> None:
    """24 of its 1680 solutions are ten thousand to half a million units away."""
    base = [
        [-10.2, -122.4, 39.5],
        [34.9, -140.4, 92.2],
        [86.0, 124.6, 51.1],
        [57.9, -100.9, -142.8],
        [-130.3, 139.3, 43.7],
    ]
    platform = [
        [71.5, -24.1, 40.8],
        [-69.5, -53.4, -35.7],
        [8.1, 9.2, -0.2],
        [-12.1, 12.1, 74.7],
        [-6.7, 54.0, -71.1],
    ]
    design = made(np.array(base), np.array(platform), np.array([134.0, 158.5, 166.8, 115.0, 135.9]))
    (found,) = forward(design, (117.9, 142.4, 93.7, 116.5, 163.7))
    assert found.complex_count == 1680
    assert found.complete


# --- any size, any length --------------------------------------------------------------------


@pytest.mark.parametrize("name", ["rpur-a1a1", "rpur-a1a2", "rpur-table1"])
def test_a_scaled_machine_has_the_scaled_solutions(name: str) -> None:
    design = load_design(name)
    joints = np.array((303.0, 317.0, 322.0, 331.0, 342.0))
    (here,) = forward(design, joints)
    assert here.complete
    for by in (1e-6, 1e6) if name == "rpur-table1" else (1e-6, 1e-3, 1e3, 1e6):
        (found,) = forward(scaled(design, by), by * joints)
        assert found.complete
        assert found.complex_count == here.complex_count
        assert len(found) == len(here)
        assert found.residual.max() < 1e-9 * by
        back = found.poses * np.array([1.0 / by] * 3 + [1.0] * 2)
        for pose, mode in zip(back, found.modes, strict=True):
            assert missed(here, pose, mode) < 1e-6


@pytest.mark.parametrize("short", [1e-2, 1e-4, 1e-6])
def test_short_limbs_are_solved_to_their_own_size_or_the_set_is_not_complete(short: float) -> None:
    rng = np.random.default_rng(int(-np.log10(short)))
    for name in ("rpur-a1a1", "rpur-table1"):
        design = load_design(name)
        pose, mode = held(design, rng), str(rng.choice(design.modes))
        a, b, _ = joint_points(design, pose, mode)
        turn = rng.uniform(0.0, 2.0 * np.pi)
        pose[:3] += (a - b)[0] * (1.0, 0.0, 1.0)  # the U joint of limb 1 onto its base point
        pose[:3] += 100.0 * short * np.array([np.cos(turn), 0.0, np.sin(turn)])
        joints = lengths(design, pose, mode)
        assert joints[0] < 200.0 * short
        (found,) = forward(design, joints)
        off = missed(found, pose, mode)
        assert off < short or not found.complete, (name, off)
        if found.complete:
            assert found.residual.max() <= CLOSES * joints.min()


# --- start sets ------------------------------------------------------------------------------


def test_a_start_set_that_lacks_solutions_grows_when_they_turn_up() -> None:
    design = replace(load_design("rpur-a1a2"), merged_joints=())
    limbs = (*design.limbs[:4], replace(design.limbs[4], base=(-23.0, -44.0, 17.0)))
    design = replace(design, limbs=limbs)  # whose set no other test needs
    whole = general.own_start_set(design)
    assert whole.roots.shape[1] == 1104
    joints = (303.0, 317.0, 322.0, 331.0, 342.0)
    right = general.roots_at(design, joints)
    assert right.complete
    for complete in (True, False):
        short = StartSet(whole.parameters, whole.roots[:, 5:], complete)
        general._own.keep(general._key(design), short)
        found = general.roots_at(design, joints)
        assert found.count == 1104
        assert found.complete
        assert general.own_start_set(design).roots.shape == (10, 1104)
        assert general.own_start_set(design).complete


def test_what_seems_to_run_off_to_infinity_is_looked_for_along_a_second_way(monkeypatch) -> None:
    design = load_design("rpur-table1")
    joints = [301.0, 312.0, 347.0, 289.0, 333.0]
    calls: list[int] = []

    def hasty(homotopy, starts, control=None):
        ends = track(homotopy, starts, control)
        if not calls:
            ends.endings[[3, 700]] = Ending.INFINITE
            ends.values[:, [3, 700]] = 1e9
        calls.append(starts.shape[1])
        return ends

    monkeypatch.setattr(solving, "track", hasty)
    (found,) = solve(
        equations,
        families.start_set(families.membership(design)),
        general._moved(general.own_start_set(design).parameters, design, joints),
        real=False,
    )
    assert calls[:2] == [1560, 1560]
    assert (found.count, found.infinite, found.ways) == (1560, 0, 2)
    assert found.complete


def test_one_way_to_infinity_is_no_proof() -> None:
    design = load_design("rpur-a3a3")  # fewer than its family, as limbs 4 and 5 are where they are
    own = general.own_start_set(design)
    count = families.membership(design).family.count
    assert own.roots.shape[1] < count
    (found,) = forward(design, (303.0, 317.0, 322.0, 331.0, 342.0))
    assert found.complete
    assert any("along two ways to it the others ran off" in note for note in found.notes)
    once = solving.Roots(
        own.roots,
        np.ones(own.roots.shape[1], dtype=np.intp),
        infinite=count - own.roots.shape[1],
        lost=0,
        expected=count,
        closed=True,
        whole=True,
        regular=own.roots.shape[1],
        ways=1,
    )
    assert not once.complete
    assert replace(once, ways=2).complete
