"""All assembly modes: the reference cases, both ways round, doubles, self-motions, no solution.

reference/rpur_forward.json holds every real solution refined to 40 digits, found by methods
independent of this package; its determinants are of unit wrenches with moments over 150 mm.
"""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.arrangements import arrangements
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.forward.equations import Frame, conjugate, real_part, to_poses
from kinematics.mechanisms.five_rpur.forward.simplified import same_mode_roots
from kinematics.mechanisms.five_rpur.inverse import MODES, closure_residual, limb_lengths
from tests.kinematics.mechanisms.five_rpur.asked import condition, wrench_matrix
from tests.kinematics.mechanisms.five_rpur.machines import MODE_SIGNS, forward, of_forward_case
from tests.kinematics.references import read

CASES = read("rpur_forward.json")["cases"]
FOLDS = read("rpur_folds.json")
CLASSES = ["a1a1", "a1a2", "a1a3", "a2a2", "a2a3", "a3a3", "mpa1", "mpa2", "mpa3"]


def sigma_of(modes) -> np.ndarray:
    return np.array([MODE_SIGNS[mode] for mode in modes]).reshape(-1, 5)


def apart(poses, others, length=100.0):
    """Distances (n, m) between poses, angles as chords."""

    def points(p):
        p = np.asarray(p, dtype=float).reshape(-1, 5)
        angles = p[:, 3:]
        return np.hstack([p[:, :3], length * np.cos(angles), length * np.sin(angles)])

    d = points(poses)[:, None] - points(others)[None]
    return np.sqrt((d * d).sum(axis=-1))


def merged(design: FiveRPURDesign) -> FiveRPURDesign:
    """The design with one U joint wherever limbs can have one."""
    groups = arrangements(design).groups
    return replace(
        design,
        merged_joints=tuple(
            pair.limbs for group in groups for pair in group.pairs if pair.kind == "A1"
        ),
    )


def alike(mode: str, groups) -> bool:
    """Whether the limbs, from 1, of each group stand in one working mode."""
    return all(len({mode[i - 1] for i in limbs}) == 1 for limbs in groups)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_every_solution_of_the_case_is_found_and_no_other(case):
    """The cases of simplified designs are of solutions with each arrangement in one mode."""
    design = merged(of_forward_case(case))
    (found,) = forward(design, case["rho"])
    known = [[s[k] for k in ("x", "y", "z", "phi", "theta")] for s in case["solutions"]]
    groups = [[i + 1 for i in limbs] for limbs in case.get("same_working_mode_groups") or ()]
    same = [n for n, mode in enumerate(found.modes) if alike(mode, groups)]
    assert len(same) == case["n_real"] == len(known)
    if {tuple(limbs) for limbs in groups} <= set(design.merged_joints):
        assert (found.complex_count, found.expected_count) == (case["complex_count"],) * 2
        assert len(found) == len(same)
    else:
        assert same_mode_roots(design, case["rho"])[0].shape[1] == case["complex_count"]
        assert found.complex_count > case["complex_count"]
    assert found.complete
    distance = apart(known, found.poses)
    nearest = distance.argmin(axis=1)
    assert set(nearest.tolist()) == set(same)
    assert distance.min(axis=1).max() < 1e-9
    assert len(set(nearest.tolist())) == len(known)
    for n, solution in zip(nearest, case["solutions"], strict=True):
        assert MODE_SIGNS[found.modes[n]] == tuple(solution["working_mode"])
    theirs = np.array([s["det6_normalised"] for s in case["solutions"]])
    ratio = theirs / found.determinant[nearest]
    np.testing.assert_allclose(ratio, (design.length / 150.0) ** 2, rtol=1e-7)
    assert found.residual.max() < 1e-10


@pytest.mark.parametrize("name", ["A1A2_free_maxreal", "MpA3_sample_case0", "general_T1J_case0"])
def test_condition_and_determinant_are_those_of_the_velocities(name):
    case = next(c for c in CASES if c["name"] == name)
    design = of_forward_case(case)
    (found,) = forward(design, case["rho"])
    sigma = sigma_of(found.modes)
    np.testing.assert_allclose(found.condition, condition(design, found.poses, sigma), rtol=1e-6)
    length = design.length
    matrix = wrench_matrix(design, found.poses, sigma, length=length).copy()
    matrix[:, :5] /= np.linalg.norm(matrix[:, :5, :3], axis=-1)[:, :, None]
    np.testing.assert_allclose(found.determinant, np.linalg.det(matrix), rtol=1e-6)
    assert closure_residual(design, found.poses, sigma, case["rho"]).max() < 1e-9


def reachable(design, modes, count, seed):
    """Poses that the modes can hold, with random modes of these, and the lengths it takes."""
    rng = np.random.default_rng(seed)
    poses = rng.uniform([-150, -80, -350, -1, -1], [250, 200, 350, 1, 1], (400 * count, 5))
    both = limb_lengths(design, poses)
    chosen = rng.integers(len(modes), size=len(poses))
    sigma = sigma_of([modes[n] for n in chosen])
    rho = np.where(sigma > 0, both[..., 0], both[..., 1])
    good = np.isfinite(rho).all(axis=1) & (rho > 20.0).all(axis=1)
    assert good.sum() >= count
    return poses[good][:count], [modes[n] for n in chosen[good][:count]], rho[good][:count]


@pytest.mark.parametrize("name", CLASSES)
def test_simplified_designs_give_back_the_pose_of_the_inverse_kinematics(name):
    """In whatever working mode the design has."""
    design = load_design(f"rpur-{name}")
    count = 250 if machine_of(design).forward.is_quick() else 12
    poses, modes, rho = reachable(design, list(design.modes), count, len(name))
    answers = forward(design, rho)
    for pose, mode, joints, found in zip(poses, modes, rho, answers, strict=True):
        distance = apart(pose, found.poses)[0]
        n = int(distance.argmin())
        assert distance[n] < 1e-4  # near a singularity a pose has fewer digits than its lengths
        assert distance[n] < 1e-8 * max(1.0, found.condition[n] ** 2)
        assert found.modes[n] == mode
        assert found.residual.max() < 1e-10
        assert found.complete
        np.testing.assert_array_equal(found.joints, joints)


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table1-icee"])
def test_general_designs_give_back_the_pose_of_the_inverse_kinematics(name):
    design = load_design(name)
    poses, modes, rho = reachable(design, list(MODES), 8, 5)
    for pose, mode, found in zip(poses, modes, forward(design, rho), strict=True):
        distance = apart(pose, found.poses)[0]
        n = int(distance.argmin())
        assert distance[n] < 1e-6
        assert found.modes[n] == mode
        assert found.complete
        assert found.residual.max() < 1e-10


@pytest.mark.parametrize("name", ["a1a1", "a1a2", "a1a3", "mpa1"])
def test_merged_joints_leave_the_solutions_of_the_modes_that_they_allow(name):
    design = load_design(f"rpur-{name}")
    joints = [303.0, 317.0, 322.0, 331.0, 342.0]
    (some,), (mixed,) = forward(design, joints), forward(design, joints, mixed_modes=True)
    assert machine_of(design).forward.is_quick() == (name == "a1a1")
    assert not machine_of(design).forward.is_quick(mixed_modes=True)
    assert len(mixed) > len(some) > 0
    assert set(some.modes) <= set(design.modes) < set(MODES)
    assert apart(some.poses, mixed.poses).min(axis=1).max() < 1e-8
    there = [n for n, mode in enumerate(mixed.modes) if mode in design.modes]
    assert len(there) == len(some)
    assert some.complete
    assert mixed.complete
    assert some.complex_count < mixed.complex_count
    (apart_,) = forward(replace(design, merged_joints=()), joints)
    assert apart_.modes == mixed.modes


@pytest.mark.parametrize("name", ["a2a3", "a3a3", "mpa2"])
def test_what_is_not_merged_stands_in_any_mode(name):
    """The tied solutions of the closed forms are some of all, each once."""
    design = load_design(f"rpur-{name}")
    joints = [303.0, 317.0, 322.0, 331.0, 342.0]
    (found,), (asked,) = forward(design, joints), forward(design, joints, mixed_modes=True)
    assert found.modes == asked.modes
    groups = [group.limbs for group in arrangements(design).groups]
    u, _ = same_mode_roots(design, joints)
    real = u[:, np.abs(u - conjugate(u)).max(axis=0) < 1e-7]
    tied = to_poses(Frame.of(design), real_part(real)[0])
    same = [n for n, mode in enumerate(found.modes) if alike(mode, groups)]
    assert 0 < len(tied) == len(same) < len(found)
    assert apart(tied, found.poses[same]).min(axis=1).max() < 1e-8
    assert found.complete


def test_batches_are_answered_one_by_one_in_their_order():
    design = load_design("rpur-a1a1")
    rng = np.random.default_rng(3)
    joints = rng.uniform(250, 400, (2, 90, 5))
    answers = forward(design, joints)
    assert len(answers) == 180
    for k in (0, 7, 130, 179):
        wanted = joints.reshape(-1, 5)[k]
        (alone,) = forward(design, wanted)
        assert answers[k].joints == tuple(wanted)
        assert answers[k].modes == alone.modes
        np.testing.assert_allclose(answers[k].poses, alone.poses, atol=1e-9)
        assert answers[k].identities == tuple(range(1, len(alone) + 1))
        assert not answers[k].poses.flags.writeable
    assert forward(design, np.zeros((0, 5))) == ()


# --- doubles ---------------------------------------------------------------------------------


def fold_lengths(past):
    """Table 1 at its fold in reference/rpur_folds.json, ``past`` mm short of it."""
    fold = FOLDS["folds"][0]
    return np.array(fold["rho_fold"]) - past * np.array(FOLDS["drho"]), fold["pose_fold"]


@pytest.mark.parametrize("short", [1e-2, 1e-4, 1e-6])
def test_near_doubles_are_told_and_their_distance_is_a_square_root(short):
    joints, pose = fold_lengths(short)
    (found,) = forward(load_design("rpur-table1"), joints)
    near = np.argsort(apart(pose, found.poses)[0])[:2]
    assert found.complete
    assert found.gap[near] == pytest.approx(found.gap[near[0]])
    # merge_check: 0.737 and 0.779 from the fold at 0.01 before it
    assert found.gap[near[0]] == pytest.approx(1.52 * np.sqrt(short / 1e-2), rel=0.3)
    assert (found.multiplicity == 1).all()
    assert np.prod(np.sign(found.determinant[near])) == -1
    if short < 1e-3:
        assert any("2 solutions have another one within" in note for note in found.notes)


def test_a_double_solution_counts_twice():
    joints, pose = fold_lengths(0.0)
    (found,) = forward(load_design("rpur-table1"), joints)
    here = int(apart(pose, found.poses)[0].argmin())
    assert apart(pose, found.poses[here])[0, 0] < 1e-3
    assert found.multiplicity[here] == 2 or found.gap[here] < 1e-3
    assert found.complex_count == 1560
    assert found.complete
    assert any("2-fold" in note or "next to a fold" in note for note in found.notes)


def test_pairs_that_are_about_to_be_real_are_told():
    joints, _ = fold_lengths(-1e-4)
    (found,) = forward(load_design("rpur-table1"), joints)
    assert any("nearly" in note or "of being real" in note for note in found.notes)
    assert len(found) == 64


# --- none, beyond the strokes, bad input -----------------------------------------------------


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table2", "rpur-mpa3"])
def test_lengths_that_cannot_close_are_a_normal_answer(name):
    (found,) = forward(load_design(name), [1.0, 2.0, 900.0, 3.0, 1.5])
    assert len(found) == 0
    assert found.poses.shape == (0, 5)
    assert any(note.startswith("No solution") for note in found.notes)
    assert found.complete


def test_lengths_beyond_a_stroke_are_solved_and_marked():
    design = load_design("rpur-table2")
    within, beyond = forward(design, [[300, 310, 320, 330, 340], [300, 310, 320, 330, 410]])
    assert within.within_stroke.all()
    assert not beyond.within_stroke.any()
    assert len(beyond) > 0


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        ([300.0] * 4, "5"),
        ([300.0, 300.0, float("nan"), 300.0, 300.0], "finite"),
        ([300.0, 300.0, 0.0, 300.0, 300.0], "positive.*ρ₃"),
        ([300.0, -1.0, 2.0, 300.0, 300.0], "positive.*ρ₂ = -1"),
    ],
)
def test_bad_lengths_are_refused_in_a_sentence(joints, message):
    with pytest.raises(InputError, match=message):
        forward(load_design("rpur-table1"), joints)


def test_an_architecturally_singular_design_is_never_complete():
    """Five limbs alike: whatever can be reached lies on curves of solutions."""
    limb = load_design("rpur-table2").limbs[0]
    (found,) = forward(FiveRPURDesign((limb,) * 5), [300.0] * 5)
    assert not found.complete
    assert len(found) == 0
    assert any("not isolated" in note for note in found.notes)


# --- self-motions ----------------------------------------------------------------------------


def aligned_lengths(design, x, z, last):
    """Lengths that bring all four U joints of {A1A1} onto the line along e1 through (x, z)."""
    base = design.base[:4]
    return [*np.hypot(x - base[:, 0], z - base[:, 2]).tolist(), last]


@pytest.mark.parametrize("mixed_modes", [False, True])
def test_the_self_motion_of_a1a1_is_reported_with_its_direction(mixed_modes):
    """After eq. 12 of the paper: s12 = s34, and the axes of both U joints are aligned."""
    design = load_design("rpur-table2")
    joints = aligned_lengths(design, 60.0, 200.0, 300.0)
    (found,) = forward(design, joints, mixed_modes=mixed_modes)
    assert found.self_motions
    assert any("Self-motion" in note for note in found.notes)
    length = design.length
    for motion in found.self_motions:
        d = np.array(motion.direction)
        assert np.hypot(np.linalg.norm(d[:3]), length * np.linalg.norm(d[3:])) == pytest.approx(1)
        sigma = np.array(MODE_SIGNS[motion.mode])
        for step, allowed in ((0.0, 1e-6), (0.1, 1e-3)):
            both = limb_lengths(design, np.array(motion.pose) + step * d)
            rho = np.where(sigma > 0, both[..., 0], both[..., 1])
            # Moving on by 0.1 mm changes no length to first order.
            assert np.abs(rho - joints).max() < allowed


def test_no_self_motion_is_reported_next_to_it():
    design = load_design("rpur-table2")
    joints = aligned_lengths(design, 60.0, 200.0, 300.0)
    joints[2] += 0.5
    (found,) = forward(design, joints)
    assert not found.self_motions
    assert found.complete


# --- anything ---------------------------------------------------------------------------------

length = st.floats(1e-3, 5e3)


@settings(deadline=None, max_examples=40)
@given(st.sampled_from(CLASSES), st.tuples(length, length, length, length, length))
@pytest.mark.slow
def test_any_lengths_of_a_simplified_design_are_answered(name, joints):
    design = load_design(f"rpur-{name}")
    (found,) = forward(design, joints)
    assert (found.residual < 1e-8).all()
    assert found.complex_count <= found.expected_count
    if found.complex_count < found.expected_count:
        assert found.notes


round_number = st.sampled_from([150.0, 245.0, 250.0, 300.0, 400.0])


@pytest.mark.slow
@settings(deadline=None, max_examples=30)
@given(
    st.sampled_from(CLASSES),
    st.tuples(round_number, round_number, round_number, round_number, round_number),
)
def test_round_numbers_are_no_trouble(name, joints):
    """Equal and special lengths, where solutions coincide and stages degenerate."""
    design = load_design(f"rpur-{name}")
    (found,) = forward(design, joints)
    sigma = sigma_of(found.modes)
    assert (found.residual < 1e-9).all()
    if len(found):
        inside = np.isfinite(closure_residual(design, found.poses, sigma, joints)).all(axis=1)
        folded = closure_residual(design, found.poses, sigma, joints)
        assert np.nanmax(np.where(inside[:, None], folded, 0.0)) < 1e-3


def test_strokes_do_not_change_the_solutions():
    design = load_design("rpur-a1a3")
    wide = replace(design, limbs=tuple(replace(limb, stroke=(1.0, 999.0)) for limb in design.limbs))
    (one,), (other,) = (forward(d, [305.0, 311.0, 322.0, 333.0, 290.0]) for d in (design, wide))
    np.testing.assert_allclose(one.poses, other.poses, atol=1e-9)


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-a1a1"])
def test_the_time_that_a_set_took_is_its_own(name):
    machine = machine_of(load_design(name))
    began = perf_counter()
    first = machine.forward(machine.home.joints)
    next_ = machine.forward.tracked_on(first, np.array(machine.home.joints) + 0.01)
    took = perf_counter() - began
    assert 0.0 < first.seconds < took
    assert 0.0 < next_.seconds < took - first.seconds
