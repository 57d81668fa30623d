"""The nine simplified designs: every stored solution, every count, and nothing lost."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.arrays import Array
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.arrangements import arrangements
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.forward import stages
from kinematics.mechanisms.five_rpur.forward.equations import (
    Complex,
    Frame,
    conjugate,
    from_poses,
    parameters,
    real_part,
    residuals,
    terms,
    to_poses,
)
from kinematics.mechanisms.five_rpur.forward.linkage import Machine
from kinematics.mechanisms.five_rpur.forward.simplified import expected, same_mode_roots
from kinematics.mechanisms.five_rpur.inverse import MODES, inverse, joint_points
from kinematics.screws.spatial import rotation_x, rotation_y
from tests.kinematics.mechanisms.five_rpur.machines import made, signature
from tests.kinematics.references import read

CASES: list[dict[str, Any]] = [
    case for case in read("rpur_forward.json")["cases"] if "same_working_mode_groups" in case
]
COUNTS = {
    "A1A1": 96,
    "A1A2": 96,
    "A1A3": 144,
    "A2A2": 96,
    "A2A3": 144,
    "A3A3": 192,
    "MpA1": 96,
    "MpA2": 96,
    "MpA3": 144,
}
CLASSES = tuple(COUNTS)


def of_case(case: dict[str, Any]) -> FiveRPURDesign:
    return made(case["r"], case["s_prime"], case["l"])


def preset(name: str) -> FiveRPURDesign:
    design = load_design(f"rpur-{name.lower()}")
    assert isinstance(design, FiveRPURDesign)
    return replace(design, merged_joints=())


def shaped(name: str, base: Array, platform: Array, link: Array) -> FiveRPURDesign:
    """The points and links, bent into a design of a class."""
    base, platform, link = base.copy(), platform.copy(), link.copy()

    def pair(i: int, j: int, kind: str) -> None:
        link[j], base[j, 1], platform[j, 1:] = link[i], base[i, 1], platform[i, 1:]
        if kind == "A1":
            platform[j] = platform[i]
        elif kind == "A2":
            base[j] = base[i]

    if name.startswith("Mp"):
        pair(0, 1, name[2:])
        pair(0, 2, "A3")
    else:
        pair(0, 1, name[:2])
        pair(2, 3, name[2:])
    return made(base, platform, link)


def random_design(name: str, rng: np.random.Generator) -> FiveRPURDesign:
    return shaped(
        name,
        rng.uniform(-120, 120, (5, 3)),
        rng.uniform(-90, 90, (5, 3)),
        rng.uniform(100, 220, 5),
    )


def poses_of(design: FiveRPURDesign, u: Complex) -> Array:
    return to_poses(Frame.of(design), real_part(u)[0])


def is_real(u: Complex, tolerance: float = 1e-7) -> np.ndarray:
    answer: np.ndarray = np.abs(conjugate(u) - u).max(axis=0) < tolerance
    return answer


def apart(ours: Array, theirs: Array) -> Array:
    """Largest differences of poses (N, 5) and (M, 5), mm and rad, angles round the circle."""
    difference = ours[:, None] - theirs
    difference[..., 3:] = np.angle(np.exp(1j * difference[..., 3:]))
    answer: Array = np.abs(difference).max(axis=-1)
    return answer


def closure(design: FiveRPURDesign, joints: Array, u: Complex) -> float:
    """The largest residual, mm: of the squares, divided by the lengths."""
    g = parameters(design, joints)
    f1, f2 = residuals(g, u)
    unit = Frame.of(design).unit
    return float(
        unit * max(np.abs(f1 / np.sqrt(g.rho2)).max(), np.abs(f2 / np.sqrt(g.link2)).max())
    )


def misfit(design: FiveRPURDesign, joints: Any, u: Complex) -> float:
    """The largest residual without unit, relative to the squares that are in it."""
    far = np.maximum(np.abs(u).max(axis=0), (1.0 / np.abs(u[3:5])).max(axis=0))
    values = [np.abs(f) / (1.0 + far * far) for f in residuals(parameters(design, joints), u)]
    return float(np.max(values, initial=0.0))


def counts(owner: np.ndarray, vectors: int) -> list[int]:
    found: list[int] = np.bincount(owner, minlength=vectors).tolist()
    return found


# --- the stored cases ------------------------------------------------------------------------


@pytest.mark.parametrize("case", CASES, ids=[case["name"] for case in CASES])
def test_every_stored_solution_is_found_and_no_other_real_one(case: dict[str, Any]) -> None:
    design = of_case(case)
    u, owner = same_mode_roots(design, case["rho"])

    assert expected(design) == case["complex_count"]
    assert u.shape == (10, case["complex_count"])
    assert not owner.any()
    assert closure(design, case["rho"], u) < 1e-10

    real = is_real(u)
    assert np.count_nonzero(real) == case["n_real"]
    stored = np.array([[s[k] for k in ("x", "y", "z", "phi", "theta")] for s in case["solutions"]])
    distance = apart(poses_of(design, u[:, real]), stored)
    assert distance.min(axis=0).max() < 1e-9
    assert sorted(distance.argmin(axis=0)) == list(range(case["n_real"]))

    modes = np.sign(terms(parameters(design, case["rho"]), u[:, real]).q.real).T
    stored_modes = np.array([s["working_mode"] for s in case["solutions"]])
    assert (modes[distance.argmin(axis=0)] == stored_modes).all()


@pytest.mark.parametrize("case", CASES, ids=[case["name"] for case in CASES])
def test_all_are_different_in_one_mode_a_group_and_closed_under_conjugation(
    case: dict[str, Any],
) -> None:
    design = of_case(case)
    u, _ = same_mode_roots(design, case["rho"])
    number, other = signature(u), signature(conjugate(u))
    distance = np.abs(number[:, None] - number) + np.eye(len(number))
    assert distance.min() > 1e-6
    assert np.abs(number[:, None] - other).min(axis=0).max() < 1e-10
    for group in case["same_working_mode_groups"]:
        w = u[5:][group]
        assert np.abs(w - w[0]).max() == 0.0


def test_designs_at_their_upper_bound_have_only_real_solutions() -> None:
    whole = [case for case in CASES if case["n_real"] == case["complex_count"]]
    assert {case["design"] for case in whole} >= {"A1A1", "A1A2"}
    for case in whole:
        u, _ = same_mode_roots(of_case(case), case["rho"])
        assert is_real(u).sum() == 96


# --- counts ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_has_the_count_of_its_class(name: str) -> None:
    rng = np.random.default_rng(len(name) + CLASSES.index(name))
    for _ in range(3):
        design = random_design(name, rng)
        joints = rng.uniform(100, 500, (40, 5))
        u, owner = same_mode_roots(design, joints)
        assert arrangements(design).name == f"{{{name}}}"
        assert expected(design) == COUNTS[name]
        assert counts(owner, 40) == [COUNTS[name]] * 40
        assert (np.diff(owner) >= 0).all()
        assert misfit(design, joints[owner], u) < 1e-13


def test_special_designs_have_fewer_solutions_than_their_class() -> None:
    # Limb 5 has the y', z' of limbs 3 and 4 on the platform: two of three legs meet there.
    some = random_design("A1A2", np.random.default_rng(0))
    platform = some.platform.copy()
    platform[4, 1:] = platform[2, 1:]
    design = made(some.base, platform, some.link)
    assert arrangements(design).name == "{A1A2}"
    assert expected(some) == 96
    assert expected(design) == 64
    _, owner = same_mode_roots(design, np.random.default_rng(1).uniform(250, 400, (50, 5)))
    assert counts(owner, 50) == [64] * 50


def test_a_batch_is_its_vectors_one_by_one() -> None:
    design = preset("A3A3")
    joints = np.random.default_rng(5).uniform(250, 400, (2, 80, 5))  # more than one portion
    u, owner = same_mode_roots(design, joints)
    for k in (0, 1, 77, 159):
        alone, _ = same_mode_roots(design, joints.reshape(-1, 5)[k])
        distance = np.abs(signature(u[:, owner == k])[:, None] - signature(alone))
        assert distance.min(axis=0).max() < 1e-9
        assert distance.min(axis=1).max() < 1e-9


def test_no_vectors_have_no_solutions() -> None:
    u, owner = same_mode_roots(preset("A1A1"), np.empty((0, 5)))
    assert u.shape == (10, 0)
    assert owner.shape == (0,)


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table1-icee"])
def test_a_general_design_is_refused(name: str) -> None:
    design = load_design(name)
    assert isinstance(design, FiveRPURDesign)
    assert expected(design) is None
    with pytest.raises(InputError, match="none of the nine simplified"):
        same_mode_roots(design, [300.0] * 5)


def test_an_architecturally_singular_design_is_refused() -> None:
    rng = np.random.default_rng(0)
    design = shaped(
        "MpA1", rng.uniform(-90, 90, (5, 3)), rng.uniform(-90, 90, (5, 3)), np.full(5, 150.0)
    )
    limbs = list(design.limbs)
    limbs[4] = Limb(
        (1.0, limbs[3].base[1], 2.0), limbs[3].platform, limbs[3].link, limbs[3].stroke
    )  # {Mp A1 A1}
    singular = FiveRPURDesign((limbs[0], limbs[1], limbs[2], limbs[3], limbs[4]))
    assert expected(singular) is None
    with pytest.raises(InputError):
        same_mode_roots(singular, [300.0] * 5)


@pytest.mark.parametrize("joints", [[300.0] * 4, [300.0] * 4 + [math.nan], "long"])
def test_what_is_not_five_numbers_is_refused(joints: Any) -> None:
    with pytest.raises(InputError):
        same_mode_roots(preset("A1A1"), joints)


# --- placement and order ---------------------------------------------------------------------


@pytest.mark.parametrize("name", CLASSES)
def test_origins_may_lie_anywhere(name: str) -> None:
    rng = np.random.default_rng(11)
    design = preset(name)
    _, joints, _ = postures(design, random_poses(design, rng, 20), rng)
    joints = joints[0]
    shift, inner = rng.uniform(-300, 300, 3), rng.uniform(-300, 300, 3)
    moved = made(design.base + shift, design.platform + inner, design.link)
    poses, others = (
        poses_of(d, u[:, is_real(u)])
        for d, u in ((d, same_mode_roots(d, joints)[0]) for d in (design, moved))
    )
    assert len(poses) > 0
    q = rotation_y(poses[:, 4]) @ rotation_x(poses[:, 3])
    poses[:, :3] += shift - q @ inner
    distance = apart(poses, others)
    assert distance.shape == (len(poses), len(poses))
    assert distance.min(axis=0).max() < 1e-8
    assert distance.min(axis=1).max() < 1e-8


@pytest.mark.parametrize("name", CLASSES)
def test_limbs_may_come_in_any_order(name: str) -> None:
    order = np.random.default_rng(CLASSES.index(name)).permutation(5)
    design, joints = preset(name), np.array([310.0, 330.0, 320.0, 305.0, 345.0])
    mixed = made(design.base[order], design.platform[order], design.link[order])
    u, _ = same_mode_roots(design, joints)
    v, _ = same_mode_roots(mixed, joints[order])
    assert u.shape == v.shape
    back = v.copy()
    back[5:][order] = v[5:]
    distance = np.abs(signature(u)[:, None] - signature(back))
    assert distance.min(axis=0).max() < 1e-9
    assert distance.min(axis=1).max() < 1e-9


# --- from a pose to its lengths and back -----------------------------------------------------


def postures(
    design: FiveRPURDesign, poses: Array, rng: np.random.Generator
) -> tuple[Array, Array, list[str]]:
    """Of these poses, those that close with each group in one mode: poses, lengths, modes."""
    groups = arrangements(design).groups
    alike = [
        k
        for k, mode in enumerate(MODES)
        if all(len({mode[i - 1] for i in group.limbs}) == 1 for group in groups)
    ]
    joints = inverse(design, poses).joints[:, alike]
    closed = np.isfinite(joints).all(axis=-1)
    kept = np.flatnonzero(closed.any(axis=1))
    chosen = np.array([rng.choice(np.flatnonzero(closed[k])) for k in kept])
    return poses[kept], joints[kept, chosen], [MODES[alike[k]] for k in chosen]


def random_poses(design: FiveRPURDesign, rng: np.random.Generator, count: int) -> Array:
    position = design.base.mean(axis=0) + rng.uniform(-220, 220, (count, 3))
    return np.concatenate([position, rng.uniform(-3.1, 3.1, (count, 2))], axis=1)


def nearest(
    design: FiveRPURDesign, poses: Array, joints: Array, modes: list[str]
) -> tuple[Array, list[int]]:
    """How far the nearest solution is from each configuration, without unit; the counts."""
    u, owner = same_mode_roots(design, joints)
    signs = [[1.0 if sign == "+" else -1.0 for sign in mode] for mode in modes]
    _, elbows, _ = joint_points(design, poses, signs)
    true = from_poses(Frame.of(design), poses, elbows)
    off = np.abs(u - true[:, owner]).max(axis=0)
    return np.array([off[owner == k].min() for k in range(len(poses))]), counts(owner, len(poses))


@pytest.mark.parametrize("name", CLASSES)
def test_every_pose_is_among_the_solutions_of_its_lengths(name: str) -> None:
    rng = np.random.default_rng(100 + CLASSES.index(name))
    design = preset(name)
    poses, joints, modes = postures(design, random_poses(design, rng, 800), rng)
    assert len(poses) > 200
    distance, found = nearest(design, poses, joints, modes)
    assert found == [expected(design)] * len(poses)
    assert np.quantile(distance, 0.9) < 1e-11
    assert distance.max() < 1e-7  # near singular poses
    u, owner = same_mode_roots(design, joints)
    real = is_real(u)
    assert closure(design, joints[owner[real]], u[:, real]) < 1e-10


@pytest.mark.parametrize("name", CLASSES)
def test_base_lines_parallel_to_e2_lose_nothing(name: str) -> None:
    # There β = 0: the resultant has a double root, but the solutions are simple.
    rng = np.random.default_rng(200 + CLASSES.index(name))
    design = preset(name)
    poses = random_poses(design, rng, 200)
    lines = [
        design.base[pair.limbs[1] - 1] - design.base[pair.limbs[0] - 1]
        for group in arrangements(design).groups
        for pair in group.pairs
        if pair.kind != "A2"
    ]
    for dx, _, dz in lines:
        poses[:, 4] = np.arctan2(-dz, dx)
        some, joints, modes = postures(design, poses, rng)
        distance, found = nearest(design, some, joints, modes)
        assert found == [expected(design)] * len(some)
        assert distance.max() < 1e-6


def test_parallel_legs_lose_nothing() -> None:
    # There two of the three vectors d are equal: the sextic has a double root.
    checked = 0
    for name in CLASSES:
        rng = np.random.default_rng(300 + CLASSES.index(name))
        design = random_design(name, rng)
        groups = arrangements(design).groups
        i, j = groups[0].limbs[0] - 1, (groups[1].limbs[0] - 1 if len(groups) > 1 else 3)
        _, my, mz = design.platform[j] - design.platform[i]
        ratio = (design.base[j, 1] - design.base[i, 1]) / math.hypot(my, mz)
        if abs(ratio) > 1.0 or design.link[i] == design.link[j]:
            continue
        links = design.link.copy()
        links[[k - 1 for k in groups[-1].limbs] if len(groups) > 1 else [j]] = links[i]
        alike = made(design.base, design.platform, links)
        if arrangements(alike).name != f"{{{name}}}":
            continue
        poses = random_poses(alike, rng, 200)
        poses[:, 3] = math.acos(ratio) - math.atan2(mz, my)
        some, joints, modes = postures(alike, poses, rng)
        kept = [k for k, mode in enumerate(modes) if mode[i] == mode[j]]
        distance, found = nearest(alike, some[kept], joints[kept], [modes[k] for k in kept])
        assert found == [COUNTS[name]] * len(kept)
        assert distance.max() < 1e-6
        checked += len(kept)
    assert checked > 100


# --- where solutions coincide, run off or do not exist ---------------------------------------


def straight(design: FiveRPURDesign, joints: list[float]) -> int:
    """How many the three stages find by themselves."""
    groups = arrangements(design).groups
    g = parameters(design, joints)
    with np.errstate(all="ignore"):
        u, _ = stages.solve(Machine.of(g, groups), np.real(g.rho2))
    number = np.sort_complex(np.round(signature(u), 7))
    return 1 + int(np.count_nonzero(np.abs(np.diff(number)) > 1e-6))


def test_double_solutions_are_counted_twice() -> None:
    # The circles of limbs 1 and 2 touch: B_12 is one point instead of two, all solutions double.
    design = preset("table2")
    joints = [400.0, 155.0, 300.0, 310.0, 305.0]
    assert straight(design, joints) < 96
    u, _ = same_mode_roots(design, joints)
    assert u.shape == (10, 96)
    assert closure(design, np.array(joints), u) < 1e-10
    number = signature(u)
    distance = np.abs(number[:, None] - number) + 9 * np.eye(96)
    assert distance.min(axis=1).max() < 1e-5


def test_both_places_of_a_shared_base_may_coincide() -> None:
    design = preset("A2A2")
    sigma = abs(design.platform[1, 0] - design.platform[0, 0])
    joints = [300.0, 300.0 + sigma, 310.0, 320.0, 330.0]  # A_1 B_1 is parallel to e2
    u, _ = same_mode_roots(design, joints)
    assert u.shape == (10, 96)
    assert closure(design, np.array(joints), u) < 1e-9
    w = u[5] - terms(parameters(design, joints), u).b[0]
    assert np.abs(w).max() < 1e-5


def test_lengths_that_cannot_close_have_complex_solutions_only() -> None:
    design = preset("table2")
    joints = [100.0, 100.0, 300.0, 310.0, 305.0]  # A_1A_2 is 245
    u, _ = same_mode_roots(design, joints)
    assert u.shape == (10, 96)
    assert not is_real(u).any()


def test_self_motion_gives_points_of_the_curve() -> None:
    # B_12 = B_34 and s_12 = s_34 leave θ free (Meccanica, after eq. 12).
    design = preset("table2")
    point = np.array([100.0, -200.0])
    joints = np.hypot(*(design.base[:, [0, 2]] - point).T)
    joints[4] = 300.0
    u, owner = same_mode_roots(design, joints)
    assert closure(design, joints, u) < 1e-9
    b12, b34 = u[5], u[7]
    assert np.count_nonzero(np.abs(b12 - b34) < 1e-6) >= 24  # as many as are on the curve
    # The other placements of B_12 and B_34 are not touched by that.
    isolated = np.abs(b12 - b34) > 1e-3
    assert np.count_nonzero(isolated) >= 72
    assert len(owner) <= 96


def test_solutions_at_infinity_are_left_out() -> None:
    # Two of four θ of this {MpA2} run off as the lengths come to these values.
    design = made(
        [[20, -90, 70], [20, -90, 70], [20, -90, -90], [60, -40, 30], [0, 50, -10]],
        [[20, 0, -70], [-80, 0, -70], [70, 0, -70], [60, 30, -60], [-90, 50, -40]],
        [150.0] * 5,
    )
    joints = np.array([250.0, 450.0, 100.0, 350.0, 300.0])
    assert expected(design) == 96
    u, _ = same_mode_roots(design, joints)
    assert u.shape == (10, 48)
    assert closure(design, joints, u) < 1e-10
    near, _ = same_mode_roots(design, joints + np.array([0, 1, 0, 0, 0]))
    assert near.shape == (10, 96)


@pytest.mark.parametrize("name", CLASSES)
@pytest.mark.parametrize(
    "joints",
    [
        [0.0] * 5,
        [300.0] * 5,
        [0.0, 300.0, 0.0, 300.0, 0.0],
        [1e7, 300.0, 300.0, 300.0, 300.0],
        [1e200] * 5,
        [-300.0, 310.0, 305.0, 290.0, 300.0],
    ],
)
def test_extreme_lengths_are_answered(name: str, joints: list[float]) -> None:
    design = preset(name)
    u, owner = same_mode_roots(design, joints)
    most = expected(design)
    assert most is not None
    assert u.shape == (10, len(owner))
    assert len(owner) <= most
    assert np.isfinite(u).all()


coordinate = st.integers(-6, 6).map(lambda n: 15.0 * n)
points = st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=5, max_size=5)
lengths = st.lists(st.integers(0, 12).map(lambda n: 50.0 * n), min_size=5, max_size=5)


@settings(max_examples=100)
@given(
    name=st.sampled_from(CLASSES),
    base=points,
    platform=points,
    link=st.lists(st.sampled_from([100.0, 150.0]), min_size=5, max_size=5),
    joints=lengths,
)
def test_round_numbers_never_break_it(
    name: str, base: Any, platform: Any, link: Any, joints: list[float]
) -> None:
    design = shaped(name, np.array(base), np.array(platform), np.array(link))
    most = expected(design)
    if most is None:
        return
    u, owner = same_mode_roots(design, joints)
    assert np.isfinite(u).all()
    assert not owner.any()
    assert misfit(design, joints, u) < 1e-10
    number = signature(u)
    gap = (np.abs(number[:, None] - number) + 9 * np.eye(len(number))).min(initial=9.0)
    if len(owner) == most and gap > 1e-3 and np.abs(u).max() < 1e3:  # all of them, and simple
        distance = np.abs(number[:, None] - signature(conjugate(u)))
        assert distance.min(axis=0).max() < 1e-6
