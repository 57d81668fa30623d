"""All assembly modes of the 4-SPS + 1-SPR: the reference cases, counts, completeness, identities.

The cases in reference/sps_spr_forward.json were computed outside this project.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinematics.errors import InputError
from kinematics.homotopy.study import placed
from kinematics.machine import machine_of
from kinematics.mechanisms.four_sps_spr import inverse
from kinematics.mechanisms.four_sps_spr.forward import monodromy
from kinematics.mechanisms.four_sps_spr.forward.equations import (
    CLOSURE,
    Frame,
    parameters,
    to_transforms,
)
from kinematics.mechanisms.four_sps_spr.forward.roots import (
    GENERAL_COUNT,
    general_set,
    own_start_set,
    roots_at,
)
from kinematics.mechanisms.four_sps_spr.home import home
from tests.kinematics.mechanisms.four_sps_spr.machines import (
    distances,
    general,
    machine,
    pentagon,
    pentagons,
    pose_distances,
    poses,
    preset,
    reference,
)

CASES = reference("sps_spr_forward")["cases"]


def design_of(case):
    flat = [np.column_stack([case[key], np.zeros(5)]) for key in ("A", "b")]
    return machine(*flat, (*case["n6"], 0.0), stroke=(3.0, 15.0))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["kind"])
def test_every_reference_solution_is_found_and_no_other(case) -> None:
    found = machine_of(design_of(case)).forward(case["lengths"])
    assert found.complex_count == found.expected_count == case["n_complex"]
    assert found.complete
    assert len(found) == case["n_real"]
    transforms = inverse.transform(found.poses)
    for known in case["real_solutions"]:
        r, p = np.array(known["R"]).reshape(3, 3), np.array(known["p"])
        apart = np.abs(transforms[:, :3, :3] - r).max(axis=(1, 2))
        apart = np.maximum(apart, np.abs(transforms[:, :3, 3] - p).max(axis=1))
        assert apart.min() < 1e-8
    assert found.residual.max() < 1e-12


@pytest.mark.parametrize(
    ("design", "count"), [(general(), 40), (general(2), 40), (preset(), 40), (pentagons(), 32)]
)
def test_random_poses_are_among_the_solutions_of_their_lengths(design, count: int) -> None:
    there = poses(design, 24, seed=8, tilt=0.8)
    answers = machine_of(design).forward(inverse.leg_lengths(design, there))
    # Of the pentagons, some solutions of single lengths all but coincide or go to infinity: then
    # rounding may leave it open whether they are all, and that is what is to be said.
    open_ones = [found.notes for found in answers if not found.complete]
    assert all(open_ones), "not complete, and it is not told why"
    assert count < 40 or not open_ones
    for pose, found in zip(there, answers, strict=True):
        assert found.complex_count == count
        assert pose_distances(design, pose[None], found.poses).min() < 1e-6
        assert found.residual.max() < 1e-10
        assert np.abs(inverse.violation(design, found.poses)).max() < 1e-10


def test_a_general_pair_of_planes_has_forty_too() -> None:
    rng = np.random.default_rng(4)
    base, platform = pentagon(400.0), pentagon(100.0)
    base[:, :2] += rng.normal(size=(5, 2)) * 60.0
    platform[:, :2] += rng.normal(size=(5, 2)) * 30.0
    design = machine(base, platform, (*rng.normal(size=2), 0.0))
    found = machine_of(design).forward(inverse.leg_lengths(design, poses(design, 6)))
    assert {each.complex_count for each in found} == {40}
    for each in found:  # base, platform and axis are plane: mirror images
        mirrored = each.poses * np.array([1.0, 1.0, -1.0, 1.0, -1.0, -1.0])
        assert pose_distances(design, mirrored, each.poses).min(axis=1).max() < 1e-6


def test_the_set_is_closed_under_conjugation_and_regular() -> None:
    design = general()
    (roots,) = roots_at(design, inverse.leg_lengths(design, poses(design, 1)))
    assert roots.complete
    assert (roots.multiplicity == 1).all()
    apart = distances(CLOSURE.conjugate(roots.values), roots.values)
    assert apart.min(axis=1).max() < 1e-9
    assert len(set(apart.argmin(axis=1).tolist())) == GENERAL_COUNT
    between = distances(roots.values, roots.values) + np.eye(GENERAL_COUNT)
    assert between.min() > 1e-6


def test_batches_are_their_single_vectors() -> None:
    design = preset()
    lengths = inverse.leg_lengths(design, poses(design, 20, seed=2))
    together = machine_of(design).forward(lengths.reshape(4, 5, 5))
    for one, found in zip(lengths[::7], together[::7], strict=True):
        alone = machine_of(design).forward(one)
        assert found.poses == pytest.approx(alone.poses, abs=1e-8)
        assert found.joints == tuple(one.tolist())


def test_a_level_pentagon_is_a_fourfold_solution() -> None:
    design = pentagons()
    found = machine_of(design).forward(
        inverse.leg_lengths(design, (0.0, 0.0, 560.0, 0.0, 0.0, 0.0))
    )
    assert found.multiplicity.tolist() == [4, 4, 4, 4]
    assert found.complete
    assert any("4-fold" in note for note in found.notes)
    assert np.abs(found.poses[0] - (0.0, 0.0, 560.0, 0.0, 0.0, 0.0)).max() < 1e-3
    assert (found.condition > 1e6).all()


def test_two_solutions_near_a_fold_are_both_there() -> None:
    """Shortly before legs of a home posture reach a fold, it has its partner next to it."""

    design, start = preset(), home(preset())
    goal = np.full(5, 600.0)
    fold = machine_of(design).following.fold_ahead(start, goal)
    assert fold is not None
    now = np.array(start.joints)
    before = now + (np.array(fold.joints) - now) * (1.0 - 1e-6)
    beyond = now + (np.array(fold.joints) - now) * (1.0 + 1e-6)
    near, gone = machine_of(design).forward(before), machine_of(design).forward(beyond)
    apart = pose_distances(design, np.array([fold.pose]), near.poses)[0]
    assert np.sort(apart)[1] < 1.0
    assert len(gone) == len(near) - 4  # the pair and its mirror image
    assert near.complete
    assert gone.complete


def test_lengths_that_cannot_be_assembled_have_no_real_solution() -> None:
    found = machine_of(preset()).forward((100.0, 900.0, 100.0, 900.0, 100.0))
    assert len(found) == 0
    assert found.complete
    assert any("cannot be assembled" in note for note in found.notes)


@pytest.mark.parametrize("bad", [(1.0, 2.0, 3.0), (1.0, 2.0, 3.0, 4.0, -5.0), (0.0,) * 5])
def test_broken_lengths_are_refused(bad) -> None:
    with pytest.raises(InputError):
        machine_of(preset()).forward(bad)


def test_absurdly_long_legs_are_never_called_complete() -> None:
    design = preset()
    found = machine_of(design).forward(np.full(5, 2e6))
    assert not found.complete
    assert any("digits are lost" in note for note in found.notes)


# --- identities ----------------------------------------------------------------------------


def test_solutions_keep_their_identity_while_legs_move() -> None:
    design = preset()
    before = machine_of(design).forward(home(design).joints)
    joints = np.add(home(design).joints, (3.0, -2.0, 4.0, 1.0, -3.0))
    after = machine_of(design).forward.refresh(before, joints)
    assert not after.merged
    assert not after.appeared
    names = after.solutions.identities
    assert sorted(names) == list(before.identities)
    for n, name in enumerate(names):
        was = before.poses[before.identities.index(name)]
        moved = pose_distances(design, was[None], after.solutions.poses[n : n + 1])
        assert moved[0, 0] < 60.0
    back = machine_of(design).forward.refresh(after.solutions, home(design).joints)
    for n, name in enumerate(back.solutions.identities):
        same = before.poses[before.identities.index(name)]
        assert pose_distances(design, same[None], back.solutions.poses[n : n + 1])[0, 0] < 1e-6


def test_who_merges_is_named_and_who_appears_is_new() -> None:
    design, start = preset(), home(preset())
    before = machine_of(design).forward(start.joints)
    joints = np.array(start.joints)
    joints[0] -= 40.0
    after = machine_of(design).forward.refresh(before, joints)
    partners = {each.identity: each.partner for each in after.merged}
    assert len(partners) == 4
    assert all(partners[other] == name for name, other in partners.items())
    assert len(after.appeared) == 4
    assert set(after.appeared).isdisjoint(before.identities)
    assert len(after.solutions) == len(before)
    sides = dict(zip(before.identities, np.sign(before.determinant), strict=True))
    assert all(sides[name] == -sides[other] for name, other in partners.items())


# --- equations and start set ---------------------------------------------------------------


def from_transforms(frame: Frame, r: np.ndarray, p: np.ndarray) -> np.ndarray:
    """The unknowns, on the patch, of poses (n, 3, 3) and (n, 3) mm."""
    vector = Rotation.from_matrix(r).as_quat(scalar_first=True)
    x = vector.T
    a = 0.5 * ((p + r @ frame.platform - frame.base) / frame.unit).T
    # The product of the quaternions (0, a) and x.
    y = np.concatenate([-(a * x[1:]).sum(axis=0)[None], x[0] * a + np.cross(a.T, x[1:].T).T])
    return CLOSURE.on_patch(np.concatenate([x, y]).astype(complex))


@pytest.mark.parametrize("design", [preset(), general()])
def test_real_poses_satisfy_the_equations(design) -> None:
    there = poses(design, 10, seed=3, tilt=3.0)
    frame = Frame.of(design)
    u = from_transforms(frame, inverse.rotation(there), there[:, :3])
    settled, error = CLOSURE.polish(
        parameters(design, inverse.leg_lengths(design, there)), u, rounds=1
    )
    assert error.max() < 1e-11
    r, p = to_transforms(frame, settled)
    assert r == pytest.approx(inverse.rotation(there), abs=1e-10)
    assert p == pytest.approx(there[:, :3], abs=1e-7)


def test_the_start_set_is_all_of_a_machine_that_nothing_is_special_about() -> None:
    stored = general_set()
    settled, error = CLOSURE.polish(stored.parameters, stored.roots)
    assert stored.roots.shape == (8, GENERAL_COUNT)
    assert error.max() < 1e-12
    apart = distances(settled, settled) + np.eye(GENERAL_COUNT)
    assert apart.min() > 1e-4
    assert np.isfinite(placed(settled)).all()
    assert own_start_set(pentagons()).roots.shape == (8, 32)


@pytest.mark.parametrize("planar", [False, True])
def test_a_set_made_from_one_solution_has_forty(planar: bool) -> None:
    found = monodromy.completed_set(np.random.default_rng(11), planar=planar)
    assert found.roots.shape[1] == GENERAL_COUNT
