"""All 16 solutions: the reference cases, both ways round, mirror pairs, doubles, self-motions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.tripods import forward, posing, study
from kinematics.mechanisms.tripods.design import KINDS, MODES, Kind, TripodDesign
from kinematics.mechanisms.tripods.limbs import limb_lengths
from tests.kinematics.mechanisms.tripods.machines import machine, some_machines, some_poses, stored

CASES = stored("rps_spr_forward.json")["cases"]


def _study(solution: dict) -> np.ndarray:
    """The Study parameters of a stored solution, from its matrix where it is complex."""
    if solution["real"]:
        return np.array(solution["study_x"] + solution["study_y"], dtype=complex)
    rotation = np.array(solution["R_re"]) + 1j * np.array(solution["R_im"])
    place = np.array(solution["t_re"]) + 1j * np.array(solution["t_im"])
    r = rotation.reshape(3, 3)
    # The column of 4 x xᵀ with the largest entry on the diagonal.
    diagonal = np.array(
        [1 + np.trace(r), *(1 - np.trace(r) + 2 * r[n, n] for n in range(3))], dtype=complex
    )
    n = int(np.abs(diagonal).argmax())
    x = np.zeros(4, dtype=complex)
    x[n] = np.sqrt(diagonal[n]) / 2
    for m in range(4):
        if m == n:
            continue
        if 0 in (n, m):
            k = max(n, m) - 1
            i, j = (k + 1) % 3, (k + 2) % 3
            x[m] = (r[j, i] - r[i, j]) / (4 * x[n])
        else:
            x[m] = (r[n - 1, m - 1] + r[m - 1, n - 1]) / (4 * x[n])
    return study.with_translation(x, place)


@pytest.mark.parametrize("case", CASES, ids=lambda c: f"{c['h1']}-{c['h2']}-{c['r']}")
def test_the_reference_cases_come_out_whole(case: dict) -> None:
    assert case["mech"] == "RPS"
    design = TripodDesign("three_rps", case["h1"], case["h2"], (0.0, 9.0))
    found = machine_of(design).forward(case["r"])
    assert found.complete
    assert found.complex_count == found.expected_count == 16
    for mode in (1, 2):
        assert found.modes.count(str(mode)) == case[f"n_real_mode{mode}"]
    roots = found.roots.T
    wanted = [_study(solution) for solution in case["solutions"]]
    assert len(wanted) == len(roots) == 16
    taken = set()
    for one in wanted:
        apart = [min(np.abs(root - s * one).max() for s in (1, -1)) for root in roots]
        nearest = int(np.argmin(apart))
        assert apart[nearest] < 1e-9
        taken.add(nearest)
    assert len(taken) == 16


@pytest.mark.parametrize("case", CASES, ids=lambda c: f"{c['h1']}-{c['h2']}-{c['r']}")
def test_the_cases_of_the_3_spr_are_the_inverses(case: dict) -> None:
    rps = TripodDesign("three_rps", case["h1"], case["h2"], (0.0, 9.0))
    spr = TripodDesign("three_spr", case["h2"], case["h1"], (0.0, 9.0))
    ours, others = machine_of(spr).forward(case["r"]), machine_of(rps).forward(case["r"])
    assert ours.complete
    assert ours.modes == others.modes
    left = np.linalg.inv(posing.transform(rps, others.poses, others.modes))
    right = posing.transform(spr, ours.poses, ours.modes)
    apart = np.abs(left[:, None] - right[None]).max(axis=(-1, -2))
    assert apart.min(axis=1).max() < 1e-9
    assert sorted(apart.argmin(axis=1)) == list(range(len(ours)))


def test_solutions_of_inverse_results_hold_the_pose(rng: np.random.Generator) -> None:
    for design in some_machines(rng, 24):
        for mode in MODES:
            poses = some_poses(rng, 10)
            lengths = limb_lengths(design, poses, mode)
            for pose, found in zip(poses, machine_of(design).forward(lengths), strict=True):
                assert found.complete
                apart = machine_of(design).forward.distances(
                    pose[None], (mode,), found.poses, found.modes
                )
                assert apart.min() < 1e-7
                assert found.residual.max() < 1e-9


def test_solutions_are_mirror_pairs(rng: np.random.Generator) -> None:
    for design in some_machines(rng, 10):
        found = machine_of(design).forward(rng.uniform(150.0, 400.0, 3))
        for mode in MODES:
            own = np.array([m == mode for m in found.modes])
            if not own.any():
                continue
            poses = found.poses[own]
            assert len(poses) % 2 == 0
            mirrored = forward.mirrored(design, poses, mode)
            modes = (mode,) * len(poses)
            apart = machine_of(design).forward.distances(mirrored, modes, poses, modes)
            assert apart.min(axis=1).max() < 1e-6
            np.testing.assert_allclose(mirrored[:, 0], -poses[:, 0], atol=1e-9)


def test_many_random_lengths_are_all_complete(rng: np.random.Generator) -> None:
    for design in some_machines(rng, 20):
        for found in machine_of(design).forward(rng.uniform(20.0, 600.0, (25, 3))):
            assert found.complete, (design, found.joints, found.complex_count)


@pytest.mark.parametrize("kind", KINDS)
def test_equal_limbs_give_the_level_platform_and_triples(kind: Kind) -> None:
    design = machine(kind)
    found = machine_of(design).forward([200.0] * 3)
    assert found.complete
    level = found.poses[found.poses[:, 1] < 1e-9]
    assert len(level) >= 2
    np.testing.assert_allclose(np.abs(level[:, 0]), np.sqrt(200.0**2 - 60.0**2), rtol=1e-12)
    # Turned by 120° every solution is one again.
    for mode in MODES:
        own = found.poses[[m == mode for m in found.modes]]
        turned = own + np.array([0.0, 0.0, 2.0 * np.pi / 3.0])
        modes = (mode,) * len(own)
        assert (
            not len(own)
            or machine_of(design).forward.distances(turned, modes, own, modes).min(1).max() < 1e-7
        )


def test_no_real_solution_is_an_answer() -> None:
    found = machine_of(machine("three_rps")).forward([30.0, 500.0, 30.0])
    assert len(found) == 0
    assert found.complete
    assert "cannot be assembled" in found.notes[0]


@pytest.mark.parametrize("kind", KINDS)
def test_a_triangle_of_twice_the_size_moves_freely_on_equal_limbs(kind: Kind) -> None:
    h = (100.0, 200.0) if kind == "three_rps" else (200.0, 100.0)
    design = machine(kind, *h)
    found = machine_of(design).forward([180.0] * 3)
    assert not found.complete
    (motion,) = found.self_motions
    pose = np.array(motion.pose)
    np.testing.assert_allclose(limb_lengths(design, pose, motion.mode), 180.0, rtol=1e-12)
    step = 1e-4 * np.array(motion.direction) / np.abs(motion.direction).max()
    for sign in (1.0, -1.0):
        moved = limb_lengths(design, pose + sign * step, motion.mode)
        assert np.abs(moved - 180.0).max() < 1e-5  # of second order in the step
    assert motion.text in found.notes
    # Nearly equal limbs are no exception any more.
    near = machine_of(design).forward([180.0, 180.001, 180.003])
    assert near.complete


@given(
    kind=st.sampled_from(KINDS),
    h2=st.sampled_from([50.0, 100.0, 199.999999, 200.0]),
    joints=st.tuples(*[st.sampled_from([60.0, 99.0, 100.0, 100.0000001, 150.0, 300.0])] * 3),
)
def test_round_lengths_never_fail(kind: Kind, h2: float, joints: tuple[float, ...]) -> None:
    found = machine_of(machine(kind, 100.0, h2)).forward(joints)
    assert found.complex_count <= 16
    if len(found):
        assert found.residual.max() < 1e-5
    if not found.complete:
        assert found.notes


def test_a_turned_over_platform_belongs_to_both_modes() -> None:
    design = machine("three_rps")
    lengths = limb_lengths(design, np.array([120.0, np.pi, 0.4]), "2")
    found = machine_of(design).forward(lengths)
    assert found.complete
    over = [n for n in range(len(found)) if abs(found.poses[n, 1] - np.pi) < 1e-6]
    assert {found.modes[n] for n in over} == {"1", "2"}
    assert np.isinf(found.condition[over]).all() or (np.abs(found.determinant[over]) < 1e-7).all()


def test_a_3_spr_at_90_degrees_is_told_by_the_pose_next_to_it() -> None:
    design = machine("three_spr", 100.0, 100.0)
    found = machine_of(design).forward([150.0] * 3)
    assert found.complete
    upright = np.abs(found.poses[:, 1] - 0.5 * np.pi) < 1e-6
    assert upright.sum() == 6
    assert found.residual.max() < 1e-5
    assert found.residual[~upright].max() < 1e-10


def test_identities_stay_while_limbs_move(rng: np.random.Generator) -> None:
    design = machine("three_rps", 200.0, 100.0)
    joints = np.array([300.0, 310.0, 305.0])
    found = machine_of(design).forward(joints)
    small = machine_of(design).forward.refresh(found, joints + np.array([1.0, -2.0, 0.5]))
    assert sorted(small.solutions.identities) == sorted(found.identities)
    assert not small.appeared
    assert not small.merged
    big = machine_of(design).forward.refresh(found, joints + np.array([150.0, 10.0, 0.0]))
    stayed = set(found.identities) & set(big.solutions.identities)
    assert len(stayed) + len(big.merged) == len(found)
    assert len(stayed) + len(big.appeared) == len(big.solutions)
    back = machine_of(design).forward.refresh(small.solutions, joints)
    for identity, pose in zip(found.identities, found.poses, strict=True):
        n = back.solutions.identities.index(identity)
        np.testing.assert_allclose(back.solutions.poses[n], pose, atol=1e-8)


def test_what_is_refused() -> None:
    with pytest.raises(InputError, match="positive"):
        machine_of(machine("three_rps")).forward([1.0, -1.0, 2.0])
    with pytest.raises(InputError, match="3 numbers"):
        machine_of(machine("three_rps")).forward([1.0, 2.0])
