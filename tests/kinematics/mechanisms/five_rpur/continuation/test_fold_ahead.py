"""The fold ahead: against the reference fold, its laws, and where there is none."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.inverse import posture
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import inverse, limb_lengths
from tests.kinematics.mechanisms.five_rpur.asked import inverse_jacobian, wrench_matrix
from tests.kinematics.mechanisms.five_rpur.machines import following, forward, preset
from tests.kinematics.references import read

# A fold of Table 1 (journal) along rho0 + t drho, found with 40 digits apart from this package;
# "dt" is how far before it, with the two solutions that merge: how far they are from it ("near",
# the largest coordinate's part) and their determinants.
DATA: dict[str, Any] = read("rpur_folds.json")
FOLD = DATA["folds"][0]
RHO0, DRHO = np.array(DATA["rho0"]), np.array(DATA["drho"])
RATE = float(np.linalg.norm(DRHO))


def roomy(name: str) -> FiveRPURDesign:
    """The preset with strokes that stop nothing."""
    design = preset(name)
    one, two, three, four, five = (replace(limb, stroke=(1.0, 2e3)) for limb in design.limbs)
    return replace(design, limbs=(one, two, three, four, five))


def gaps(one: Posture, pose: Any) -> Array:
    """mm and rad, of each coordinate."""
    gap: Array = np.subtract(one.pose, pose)
    gap[3:] = (gap[3:] + np.pi) % (2 * np.pi) - np.pi
    return np.abs(gap)


def distance(one: Posture, two: Posture) -> float:
    """mm; angles at 100 mm."""
    return float((gaps(one, two.pose) * [1, 1, 1, 100, 100]).max())


def determinant(design: FiveRPURDesign, pose: Any, mode: str, length: float) -> float:
    return float(np.linalg.det(wrench_matrix(design, pose, mode, length=length)))


def unit_determinant(design: FiveRPURDesign, at: Posture) -> float:
    matrix = wrench_matrix(design, at.pose, at.mode, length=150.0)
    size: float = np.linalg.norm(matrix[:5, :3], axis=1).prod()
    return float(np.linalg.det(matrix)) / size


@cache
def merging(dt: float) -> tuple[Posture, Posture]:
    """The two assembly modes that merge, ``dt`` before the reference fold."""
    design = roomy("rpur-table1")
    pose, rho = np.array(FOLD["pose_fold"]), np.array(FOLD["rho_fold"])
    both = limb_lengths(design, pose)
    mode = "".join("+-"[int(np.abs(both[i] - rho[i]).argmin())] for i in range(5))
    length = design.length
    scale = np.array([1, 1, 1, length, length])
    free = np.linalg.svd(inverse_jacobian(design, pose, mode) / scale)[2][-1] / scale
    joints = RHO0 + (FOLD["t"] - dt) * DRHO
    size = 8.0 * np.sqrt(dt)  # of the merging solutions' distance
    one, two = (following(design).polish(pose + s * size * free, mode, joints) for s in (1, -1))
    assert one is not None
    assert two is not None
    return one, two


@pytest.mark.parametrize("dt", [1e-7, 1e-5, 1e-3, 0.1, 1.0, 10.0])
def test_the_reference_fold_is_seen_from_both_sides_and_joins_them(dt: float) -> None:
    design = roomy("rpur-table1")
    goal = RHO0 + (FOLD["t"] + 5.0) * DRHO
    if dt > 1.0:
        joints = RHO0 + (FOLD["t"] - dt) * DRHO
        one, two = (following(design).follow(start, joints).posture for start in merging(1.0))
    else:
        one, two = merging(dt)
    assert distance(one, two) > 0
    for start, other in ((one, two), (two, one)):
        fold = following(design).fold_ahead(start, goal)
        assert fold is not None
        assert fold.distance == pytest.approx(dt * RATE, abs=1e-9)
        np.testing.assert_allclose(fold.joints, FOLD["rho_fold"], rtol=0, atol=1e-9)
        at = posture(design, fold.pose, fold.mode)
        assert gaps(at, FOLD["pose_fold"]).max() < 1e-6
        np.testing.assert_allclose(at.joints, FOLD["rho_fold"], rtol=0, atol=1e-6)
        assert fold.partner is not None
        assert distance(fold.partner, other) < 1e-9 / np.sqrt(dt)
        assert fold.partner.mode == other.mode
        assert fold.partner.residual < 1e-10
        np.testing.assert_allclose(fold.partner.joints, start.joints, rtol=0, atol=1e-9)


@pytest.mark.parametrize("check", [m for m in DATA["merge_check"] if m["dt"] > 0], ids=str)
def test_distances_and_determinants_go_with_the_square_root(check: dict[str, Any]) -> None:
    """Each as the reference has it."""
    design = roomy("rpur-table1")
    one, two = merging(check["dt"])
    found = sorted(gaps(p, FOLD["pose_fold"]).max() for p in (one, two))
    np.testing.assert_allclose(found, sorted(check["near"]), rtol=1e-8)
    # "det6" is of unit forces, with moments in link lengths.
    ours = sorted(unit_determinant(design, p) for p in (one, two))
    np.testing.assert_allclose(ours, sorted(check["det6"]), rtol=1e-7)
    assert ours[0] < 0 < ours[1]
    last = DATA["merge_check"][4]
    law = np.sqrt(check["dt"] / last["dt"])
    np.testing.assert_allclose(found, law * np.array(sorted(last["near"])), rtol=0.4)
    np.testing.assert_allclose(ours, law * np.array(sorted(last["det6"])), rtol=0.05)


def test_the_partner_is_one_of_the_full_set_and_the_rest_of_it_does_not_end_there() -> None:
    design = roomy("rpur-table1")
    solutions = forward(design, RHO0)[0]
    assert solutions.complete
    all_there = [
        posture(design, tuple(pose), mode)
        for pose, mode in zip(solutions.poses.tolist(), solutions.modes, strict=True)
    ]
    pairs = {}
    for n, start in enumerate(all_there):
        fold = following(design).fold_ahead(start, RHO0 + 100 * DRHO)
        if fold is None:
            continue
        assert 0 < fold.distance < 100 * RATE
        if fold.partner is not None:
            near = [distance(fold.partner, other) for other in all_there]
            partner = int(np.argmin(near))
            assert near[partner] < 1e-7
            assert partner != n
            assert solutions.determinant[n] * solutions.determinant[partner] < 0
            pairs[n] = (partner, fold.distance)
    # Merging is mutual, at one and the same place.
    assert len(pairs) >= 6
    for n, (partner, along) in pairs.items():
        assert pairs[partner][0] == n
        assert pairs[partner][1] == pytest.approx(along, abs=1e-9)
    there = [n for n, (_, along) in pairs.items() if abs(along - FOLD["t"] * RATE) < 1e-9]
    assert len(there) == 2


def start_in(design: FiveRPURDesign, seed: int) -> Posture:
    """A reachable posture, away from singularities."""
    rng = np.random.default_rng(seed)
    length = design.length
    while True:
        position = rng.uniform((-350, -20, -450), (350, 160, 450), (200, 3))
        poses = np.column_stack([position, rng.uniform(-1.2, 1.2, (200, 2))])
        solved = inverse(design, poses)
        for n, m in np.argwhere(solved.within_stroke):
            at = posture(design, tuple(poses[n].tolist()), solved.modes[m])
            if abs(determinant(design, at.pose, at.mode, length)) > 0.05:
                return at


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table2", "rpur-a2a3", "rpur-mpa1"])
def test_it_is_where_following_stops(name: str) -> None:
    """Of every actuator, both ways; and the partner comes back to the same fold."""
    design = preset(name)
    seen = {"free": 0, "partner": 0, "alone": 0}
    for seed in range(2):
        start = start_in(design, seed)
        for i in range(5):
            for end in design.limbs[i].stroke:
                joints = list(start.joints)
                joints[i] = end
                moved = following(design).follow(start, joints)
                fold = following(design).fold_ahead(start, joints)
                if fold is None:
                    seen["free"] += 1
                    assert moved.stop == "target"
                    continue
                assert moved.stop == "singularity"
                whole = abs(end - start.joints[i])
                # Before a fold by a millionth of the way, before a crossing by what it takes to
                # leave again.
                gap = 0.05 if fold.partner is None else 2e-6 * whole
                assert -1e-9 <= fold.distance - moved.fraction * whole < gap
                assert fold.joints[i] == pytest.approx(moved.posture.joints[i], abs=gap)
                at = posture(design, fold.pose, fold.mode)
                # Off the fold the lengths would be matched to first order only.
                np.testing.assert_allclose(at.joints, fold.joints, rtol=0, atol=1e-5)
                if fold.partner is None:
                    seen["alone"] += 1
                    continue
                seen["partner"] += 1
                length = design.length
                before, after = (
                    determinant(design, p.pose, p.mode, length) for p in (start, fold.partner)
                )
                assert before * after < 0
                again = following(design).fold_ahead(fold.partner, joints)
                assert again is not None
                assert again.distance == pytest.approx(fold.distance, abs=1e-8)
                assert gaps(at, again.pose).max() < 1e-6
                assert again.partner is not None
                assert distance(again.partner, start) < 1e-7
    assert min(seen.values()) >= 1


def test_beyond_strokes_it_is_seen_too() -> None:
    """Unlike `follow`: what ends beyond a stroke is worth knowing."""
    design = preset("rpur-table1")
    one, _ = merging(1.0)
    goal = RHO0 + (FOLD["t"] + 5.0) * DRHO
    short = replace(
        design, limbs=tuple(replace(limb, stroke=(1.0, 352.0)) for limb in design.limbs)
    )
    assert following(short).follow(one, goal).stop == "stroke"
    fold = following(short).fold_ahead(one, goal)
    assert fold is not None
    np.testing.assert_allclose(fold.joints, FOLD["rho_fold"], rtol=0, atol=1e-9)


def test_where_branches_cross_there_is_no_partner() -> None:
    """Both limbs of an A1 pair with their links along e1: the curve with unlike modes crosses."""
    design = roomy("rpur-a1a1")
    crossed = 0
    for seed in range(5):
        start = start_in(preset("rpur-a1a1"), 30 + seed)
        for i in range(5):
            for end in (200.0, 450.0):
                joints = list(start.joints)
                joints[i] = end
                fold = following(design).fold_ahead(start, joints)
                if fold is None or fold.partner is not None:
                    continue
                at = posture(design, fold.pose, fold.mode)
                links = [m.amount for m in at.margins if m.bound == "link"]
                if min(links) > 1e-6:
                    continue
                crossed += 1
                pair = [n for n, room in enumerate(links) if room < 1e-6]
                assert len(pair) >= 2
                size = determinant(design, fold.pose, fold.mode, design.length)
                assert abs(size) < 1e-4
                assert following(design).follow(start, joints).stop == "singularity"
    assert crossed >= 2


def test_none_where_there_is_nothing_to_follow() -> None:
    design = preset("rpur-table1")
    start = start_in(design, 1)
    assert following(design).fold_ahead(start, start.joints) is None
    assert following(design).fold_ahead(start, np.add(start.joints, 1e-3)) is None
    open_there = posture(design, (0.0, 900.0, 300.0, 0.0, 0.0), "+++++")
    assert following(design).fold_ahead(open_there, [300.0] * 5) is None
    limbs = design.limbs
    twice = FiveRPURDesign((limbs[0], limbs[0], *limbs[2:]))
    stuck = posture(twice, start.pose, start.mode[0] * 2 + start.mode[2:])
    assert stuck.closes
    assert (
        following(twice).fold_ahead(stuck, np.add(stuck.joints, [3.0, -3.0, 0.0, 0.0, 0.0])) is None
    )


@pytest.mark.parametrize("joints", [[300.0] * 4, [np.nan] * 5, [[300.0] * 5] * 2, "joints"])
def test_what_are_not_joints_is_refused(joints: Any) -> None:
    design = preset("rpur-table1")
    with pytest.raises(InputError, match="joints"):
        following(design).fold_ahead(start_in(design, 2), joints)


def test_negative_lengths_are_refused() -> None:
    design = preset("rpur-table1")
    with pytest.raises(InputError, match=r"must not be negative, got ρ₂ = -3 mm"):
        following(design).fold_ahead(start_in(design, 2), [300.0, -3.0, 300.0, 300.0, 300.0])
