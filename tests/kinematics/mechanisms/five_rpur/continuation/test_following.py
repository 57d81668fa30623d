"""Continuation: round trips, the reference fold, serial passes, strokes, and no jumps."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from kinematics.answers.solutions import Posture
from kinematics.errors import InputError
from kinematics.facets.inverse import posture
from kinematics.homotopy import continuation
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inverse import MODES, inverse, joint_points, limb_lengths
from tests.kinematics.mechanisms.five_rpur.asked import inverse_jacobian, wrench_matrix, wrenches
from tests.kinematics.mechanisms.five_rpur.machines import distance, following, preset
from tests.kinematics.references import read

CASES: list[dict[str, Any]] = read("rpur_forward.json")["cases"]
# A fold of Table 1 (journal) along rho0 + t drho, found with 40 digits apart from this package.
FOLD: dict[str, Any] = read("rpur_folds.json")


def with_stroke(design: FiveRPURDesign, low: float, high: float) -> FiveRPURDesign:
    one, two, three, four, five = (replace(limb, stroke=(low, high)) for limb in design.limbs)
    return replace(design, limbs=(one, two, three, four, five))


def of_case(case: dict[str, Any]) -> FiveRPURDesign:
    rows = zip(case["r"], case["s_prime"], case["l"], strict=True)
    one, two, three, four, five = (
        Limb(tuple(r), tuple(s), link, (0.0, 1e4)) for r, s, link in rows
    )
    return FiveRPURDesign((one, two, three, four, five))


def determinant(design: FiveRPURDesign, at: Posture) -> float:
    length = design.length
    return float(np.linalg.det(wrench_matrix(design, at.pose, at.mode, length=length)))


def starts(design: FiveRPURDesign, count: int, seed: int) -> list[Posture]:
    """Reachable postures in random working modes."""
    rng = np.random.default_rng(seed)
    found: list[Posture] = []
    while len(found) < count:
        position = rng.uniform((-350, -20, -450), (350, 160, 450), (2000, 3))
        poses = np.column_stack([position, rng.uniform(-1.2, 1.2, (2000, 2))])
        fits = inverse(design, poses).within_stroke
        for n, m in zip(*np.nonzero(fits), strict=True):
            if rng.uniform() < 0.02:
                found.append(posture(design, tuple(poses[n].tolist()), MODES[m]))
    return found[:count]


# --- polish --------------------------------------------------------------------------------


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_polishing_finds_every_reference_solution_again(case: dict[str, Any]) -> None:
    """FK∘IK: from a disturbed pose, to the pose and its working mode."""
    design, rng = of_case(case), np.random.default_rng(0)
    for solution in case["solutions"]:
        pose = np.array([solution[k] for k in ("x", "y", "z", "phi", "theta")])
        mode = "".join("+" if sign > 0 else "-" for sign in solution["working_mode"])
        matrix = wrench_matrix(design, pose, mode, length=design.length)
        weakest = float(np.linalg.svd(matrix, compute_uv=False)[-1])
        limbs = np.abs(wrenches(design, pose, mode).transmission).min()
        if min(weakest, limbs) < 1e-3:
            continue  # so near a singularity another solution may be nearer than the guess
        push = min(weakest, limbs) * 1e-2 * rng.normal(size=5) * [1, 1, 1, 0.01, 0.01]
        found = following(design).polish(pose + push, mode, case["rho"])
        assert found is not None
        assert found.mode == mode
        gap = np.abs(np.subtract(found.pose, pose))
        gap[3:] = np.abs((gap[3:] + np.pi) % (2 * np.pi) - np.pi)
        assert (gap <= 1e-12 * np.abs(pose).max() / weakest).all()
        assert found.residual < 1e-10
        np.testing.assert_allclose(found.joints, case["rho"], rtol=1e-12)


def test_inverse_after_forward_closes_to_twelve_digits() -> None:
    design = preset("rpur-table1")
    checked = 0
    for start in starts(design, 60, seed=1):
        if abs(determinant(design, start)) < 0.02:
            continue
        checked += 1
        found = following(design).polish(
            np.add(start.pose, [0.3, -0.2, 0.1, 1e-3, -1e-3]), start.mode, start.joints
        )
        assert found is not None
        both = limb_lengths(design, found.pose)
        rho = [both[i, "+-".index(sign)] for i, sign in enumerate(found.mode)]
        np.testing.assert_allclose(rho, start.joints, rtol=1e-12)
        assert distance(found, start) < 1e-9
    assert checked > 20


def test_polishing_says_none_where_there_is_nothing_to_find() -> None:
    design = preset("rpur-table1")
    assert (
        following(design).polish((0, 60, 300, 0, 0), "+++++", [1.0, 4000.0, 1.0, 4000.0, 1.0])
        is None
    )
    with pytest.raises(InputError, match="joints"):
        following(design).polish((0, 60, 300, 0, 0), "+++++", [300.0] * 4)
    with pytest.raises(InputError, match="working mode"):
        following(design).polish((0, 60, 300, 0, 0), "+++", [300.0] * 5)


# --- the reference fold --------------------------------------------------------------------


def fold_branches(dt: float = 1.0) -> list[tuple[FiveRPURDesign, Posture]]:
    """The two assembly modes that merge, ``dt`` before the fold."""
    design = with_stroke(preset("rpur-table1"), 200.0, 450.0)
    fold = FOLD["folds"][0]
    pose, rho = np.array(fold["pose_fold"]), np.array(fold["rho_fold"])
    both = limb_lengths(design, pose)
    mode = "".join("+-"[int(np.abs(both[i] - rho[i]).argmin())] for i in range(5))
    length = design.length
    scale = np.array([1, 1, 1, length, length])
    free = np.linalg.svd(inverse_jacobian(design, pose, mode) / scale)[2][-1] / scale
    found = []
    # In this line real solutions exist at larger t ("dt" > 0 counts more of them).
    joints = np.array(FOLD["rho0"]) + (fold["t"] - dt) * np.array(FOLD["drho"])
    for side in (8.0, -8.0):
        start = following(design).polish(pose + side * free, mode, joints)
        assert start is not None
        found.append((design, start))
    return found


def test_both_merging_assembly_modes_stop_at_the_reference_fold() -> None:
    fold, rho0, drho = FOLD["folds"][0], np.array(FOLD["rho0"]), np.array(FOLD["drho"])
    ends, signs = [], []
    for design, start in fold_branches():
        end = following(design).follow(start, rho0 + (fold["t"] + 5.0) * drho)
        assert end.stop == "singularity"
        assert end.text == "stopped at a parallel singularity after 16.7 % of the way"
        t = (np.array(end.posture.joints) - rho0) / drho
        # Just before it: a millionth of the 6 units of the way, and never past it.
        assert (t < fold["t"]).all()
        np.testing.assert_allclose(t, fold["t"] - 6e-6, rtol=0, atol=2e-6)
        assert end.fraction == pytest.approx(1.0 / 6.0, abs=2e-6)
        gap = np.abs(np.subtract(end.posture.pose, fold["pose_fold"]))
        assert (gap < [0.04, 0.04, 0.04, 2e-4, 2e-4]).all()
        assert end.posture.residual < 1e-10
        assert end.posture.mode == start.mode
        ends.append(end.posture)
        signs.append(np.sign(determinant(design, end.posture)))
        assert np.sign(determinant(design, start)) == signs[-1]
        # Pushing on stays there; going back leads where it came from.
        again = following(design).follow(end.posture, rho0 + (fold["t"] + 9.0) * drho)
        assert again.stop == "singularity"
        assert again.fraction < 1e-5
        back = following(design).follow(again.posture, start.joints)
        assert back.stop == "target"
        assert distance(back.posture, start) < 1e-8
    assert signs[0] == -signs[1]
    assert 0.01 < distance(*ends) < 0.1


def test_a_target_shortly_before_the_fold_is_reached_on_the_own_branch() -> None:
    fold, rho0, drho = FOLD["folds"][0], np.array(FOLD["rho0"]), np.array(FOLD["drho"])
    for before in (1e-1, 1e-3, 1e-6):
        reached = []
        for design, start in fold_branches():
            end = following(design).follow(start, rho0 + (fold["t"] - before) * drho)
            assert end.stop == "target"
            assert np.sign(determinant(design, end.posture)) == np.sign(determinant(design, start))
            reached.append(end.posture)
        # "near" of the reference: the distance of the two solutions goes with the square root.
        stored = {m["dt"]: m["near"] for m in FOLD["merge_check"]}
        assert 0 < distance(*reached) < 60 * np.sqrt(before)
        assert before not in stored or distance(*reached) < 2 * sum(stored[before])


def test_the_limit_of_one_actuator_is_told() -> None:
    design, start = fold_branches()[0]
    told = []
    for i in range(5):
        for far in (200.0, 450.0):
            joints = list(start.joints)
            joints[i] = far
            end = following(design).follow(start, joints)
            if end.stop == "singularity":
                where = "beyond" if far > start.joints[i] else "below"
                told.append(i)
                assert end.text.endswith(
                    f"stopped at a parallel singularity: ρ{'₁₂₃₄₅'[i]} cannot go {where} "
                    f"{end.posture.joints[i]:.1f} mm on this assembly mode"
                )
                others = np.delete(np.subtract(end.posture.joints, start.joints), i)
                np.testing.assert_allclose(others, 0.0, atol=1e-10)
    assert len(told) >= 3


# --- walks ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table2", "rpur-mpa1"])
def test_walks_come_back_and_do_not_depend_on_their_steps(name: str) -> None:
    design = preset(name)
    rng = np.random.default_rng(2)
    stops = []
    for start in starts(design, 16, seed=3):
        here = np.array(start.joints)
        goal = np.clip(here + 30 * rng.normal(size=5), 250.0, 400.0)
        end = following(design).follow(start, goal)
        stops.append(end.stop)
        assert end.stop in ("target", "singularity")
        assert end.posture.residual < 1e-10
        walked = start
        for part in np.linspace(0, 1, 11)[1:]:
            step = following(design).follow(walked, here + part * (goal - here))
            walked = step.posture
            if step.stop != "target":
                break
        assert step.stop == end.stop
        if end.stop == "target":
            assert end.fraction == 1.0
            np.testing.assert_allclose(end.posture.joints, goal, rtol=0, atol=1e-9)
            assert distance(walked, end.posture) < 1e-7
            assert walked.mode == end.posture.mode
            back = following(design).follow(end.posture, start.joints)
            assert back.stop == "target"
            assert distance(back.posture, start) < 1e-7
            assert back.posture.mode == start.mode
        else:
            covered = np.linalg.norm(np.subtract(walked.joints, here))
            assert covered / np.linalg.norm(goal - here) == pytest.approx(end.fraction, abs=1e-5)
            assert abs(determinant(design, end.posture)) < 0.02
    assert {"target", "singularity"} <= set(stops)


def test_the_determinant_keeps_its_sign_all_along() -> None:
    """The very meaning of one assembly mode: no parallel singularity in between."""
    design = preset("rpur-table1")
    rng = np.random.default_rng(4)
    for start in starts(design, 30, seed=5):
        goal = np.clip(np.add(start.joints, 40 * rng.normal(size=5)), 250.0, 400.0)
        end = following(design).follow(start, goal)
        assert determinant(design, end.posture) * determinant(design, start) > 0


def test_from_shortly_before_a_crossing_of_branches_the_way_back_is_open() -> None:
    """Where the limbs of a pair have their links along e1 together; lengths from a pose are noisy
    there.
    """
    design = with_stroke(preset("rpur-a2a3"), 30.0, 900.0)
    pose = (97.859981566907, 48.341123015920, 458.349869152177, 0.9207985576152, -0.2262865965464)
    goal = (
        549.516904133195,
        415.221422472442,
        456.584338896316,
        499.687400914983,
        231.148986055673,
    )
    start = posture(design, pose, "+++++")
    end = following(design).follow(start, goal)
    assert end.stop == "singularity"
    assert abs(determinant(design, end.posture)) < 1e-5
    links = [m.amount for m in end.posture.margins if m.bound == "link"]
    assert sorted(links)[1] < 1e-6
    again = following(design).follow(end.posture, goal)
    assert again.stop == "singularity"
    assert distance(again.posture, end.posture) < 0.05
    for there in (end.posture, again.posture):
        back = following(design).follow(there, start.joints)
        assert back.stop == "target"
        assert distance(back.posture, start) < 1e-6


# --- serial singularities are passed ---------------------------------------------------------


def serial_postures(design: FiveRPURDesign, limb: int, count: int, seed: int) -> list[Posture]:
    """Postures with v ∥ e1 in one limb (|Y| = l), the others closed, away from parallel ones."""
    rng = np.random.default_rng(seed)
    found: list[Posture] = []
    while len(found) < count:
        x, z = rng.uniform((-250, 50), (250, 400))
        phi, theta = rng.uniform(-0.8, 0.8, 2)
        _, sy, sz = design.platform[limb]
        end = rng.choice([-1.0, 1.0]) * design.link[limb]
        y = design.base[limb, 1] - np.cos(phi) * sy + np.sin(phi) * sz + end
        at = posture(design, (x, y, z, phi, theta), MODES[rng.integers(32)])
        if at.closes and abs(determinant(design, at)) > 0.05:
            found.append(at)
    return found


def test_a_limb_passes_into_its_other_working_mode_and_says_so() -> None:
    """v_i ∥ e1 is a point like any other of the path: σ_i changes there, and nothing jumps."""
    design = with_stroke(preset("rpur-table1"), 1.0, 1000.0)
    rng = np.random.default_rng(6)
    passed = 0
    for limb in (2, 3, 4):  # limbs 1 and 2, an A3 pair, would both pass at once
        for middle in serial_postures(design, limb, 10, seed=limb):
            rho = np.array(middle.joints)
            move = 0.5 * rng.normal(size=5)
            one, two = (following(design).follow(middle, rho + sign * move) for sign in (1, -1))
            if not one.stop == two.stop == "target":
                continue
            one, two = one.posture, two.posture
            others = np.delete(np.arange(5), limb)
            assert [one.mode[i] for i in others] == [two.mode[i] for i in others]
            assert one.mode[limb] != two.mode[limb]
            passed += 1
            across = following(design).follow(two, rho + move)
            assert across.stop == "target"
            sign = "−" if one.mode[limb] == "-" else "+"
            assert across.text == f"limb {limb + 1} passed into working mode {sign}"
            assert across.posture.mode == one.mode
            assert distance(across.posture, one) < 1e-5
            # Through it in small steps: each moves the platform by its share.
            walked, longest = two, 0.0
            for part in np.linspace(-1, 1, 21)[1:]:
                step = following(design).follow(walked, rho + part * move)
                longest = max(longest, distance(walked, step.posture))
                walked = step.posture
            assert distance(walked, one) < 1e-5
            assert longest < 0.2 * distance(one, two)
    assert passed > 15


def height(design: FiveRPURDesign, at: Posture, limb: int) -> float:
    """q = σ h, mm: what of v is along z'."""
    _, b, c = joint_points(design, at.pose, at.mode)
    v = (c - b)[limb]
    return float(v[0] * np.sin(at.pose[4]) + v[2] * np.cos(at.pose[4]))


def test_passing_to_and_fro_is_told_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    """Along a line in joint space with dq = 0 somewhere, q may change its sign and back again.

    The excursion is small here, so the steps are made short enough to see it.
    """
    monkeypatch.setattr(continuation, "_LONGEST", 0.003)
    monkeypatch.setattr(continuation, "_FIRST", 0.003)
    design = with_stroke(preset("rpur-table1"), 1.0, 1000.0)
    rng = np.random.default_rng(8)
    told = 0
    for limb in (2, 3, 4):
        for middle in serial_postures(design, limb, 5, seed=20 + limb):
            rho, move = np.array(middle.joints), rng.normal(size=5)
            near = [following(design).follow(middle, rho + 1e-3 * e).posture for e in np.eye(5)]
            slope = np.array([height(design, at, limb) for at in near]) / 1e-3
            move -= slope * (slope @ move) / (slope @ slope)
            for apex in (0.05, -0.05):  # q there; the path may bend back over 0 on both sides
                top = following(design).follow(middle, rho + apex * slope / (slope @ slope))
                goal = np.array(top.posture.joints)
                one = following(design).follow(top.posture, goal - 4 * move)
                two = following(design).follow(top.posture, goal + 4 * move)
                if {top.stop, one.stop, two.stop} != {"target"}:
                    continue
                q = [height(design, end.posture, limb) for end in (one, top, two)]
                if not q[0] * q[1] < 0 or not q[1] * q[2] < 0:
                    continue
                end = following(design).follow(one.posture, goal + 4 * move)
                other = "+" if q[1] > 0 else "−"
                line = f"limb {limb + 1} passed into working mode {other} and back"
                assert line in end.text.split("; ")
                assert end.posture.mode[limb] == one.posture.mode[limb]
                told += 1
    assert told >= 3


# --- strokes, starts, input ----------------------------------------------------------------


@cache
def roomy() -> tuple[FiveRPURDesign, Posture]:
    """A start from which ρ₃ reaches both ends of its stroke unhindered."""
    design = preset("rpur-a3a3")
    for start in starts(design, 12, seed=30):
        ends = [following(design).follow(start, _moved(start, 2, to)) for to in (250.0, 400.0)]
        if all(end.stop == "target" and not end.text for end in ends):
            return design, start
    raise AssertionError("no such start")


def _moved(start: Posture, i: int, to: float) -> list[float]:
    joints = list(start.joints)
    joints[i] = to
    return joints


def test_a_motion_stops_at_the_end_of_a_stroke() -> None:
    design, start = roomy()
    for to, end, name in ((470.0, 400.0, "max"), (200.0, 250.0, "min")):
        stopped = following(design).follow(start, _moved(start, 2, to))
        assert (stopped.stop, stopped.limb) == ("stroke", 3)
        assert stopped.text == f"limb 3 is at the end of its stroke (ρ₃ {name} = {end:g} mm)"
        assert stopped.posture.joints[2] == end
        assert stopped.posture.reachable
        whole = to - start.joints[2]
        assert stopped.fraction == pytest.approx((end - start.joints[2]) / whole)
        reached = following(design).follow(start, _moved(start, 2, end))
        assert (reached.stop, reached.text, reached.fraction) == ("target", "", 1.0)
        assert distance(reached.posture, stopped.posture) < 1e-9
        # At the end already: nothing moves.
        still = following(design).follow(stopped.posture, _moved(stopped.posture, 2, to))
        assert (still.stop, still.limb) == ("stroke", 3)
        assert still.fraction == pytest.approx(0.0, abs=1e-9)
        assert distance(still.posture, stopped.posture) < 1e-9


def test_a_limb_beyond_its_stroke_may_come_back_but_not_go_further() -> None:
    design, start = roomy()
    middle = start.joints[2]
    low, high = with_stroke(design, middle + 5, 400.0), with_stroke(design, 250.0, 400.0)
    assert high == design
    short = posture(low, start.pose, start.mode)
    assert not short.reachable
    # Moving another limb leaves it where it is.
    other = following(low).follow(short, _moved(short, 0, short.joints[0] + 1e-3))
    assert other.posture.joints[2] == pytest.approx(middle, abs=1e-9)
    back = following(low).follow(short, _moved(short, 2, middle + 8))
    assert back.posture.joints[2] == pytest.approx(middle + 8)
    further = following(low).follow(short, _moved(short, 2, middle - 3))
    assert (further.stop, further.limb) == ("stroke", 3)
    assert further.posture.joints[2] == pytest.approx(middle, abs=1e-9)


def test_staying_is_arriving() -> None:
    design, start = roomy()
    end = following(design).follow(start, start.joints)
    assert (end.stop, end.text, end.fraction) == ("target", "", 1.0)
    assert distance(end.posture, start) < 1e-10


def test_from_an_open_posture_there_is_nothing_to_follow() -> None:
    design = preset("rpur-table1")
    start = posture(design, (0.0, 900.0, 300.0, 0.0, 0.0), "+++++")
    end = following(design).follow(start, [300.0] * 5)
    assert (end.stop, end.fraction) == ("stalled", 0.0)
    np.testing.assert_array_equal(end.posture.joints, start.joints)
    assert end.text.startswith("limbs 1, 2, 3, 4, 5 cannot close at this pose")


@pytest.mark.parametrize("joints", [[300.0] * 4, [np.nan] * 5, [[300.0] * 5] * 2, "joints"])
def test_what_are_not_joints_is_refused(joints: Any) -> None:
    design, start = preset("rpur-table1"), starts(preset("rpur-table1"), 1, seed=9)[0]
    with pytest.raises(InputError, match="joints"):
        following(design).follow(start, joints)


def test_in_an_architecturally_singular_design_nothing_moves() -> None:
    limbs = preset("rpur-table1").limbs
    design = FiveRPURDesign((limbs[0], limbs[0], *limbs[2:]))
    for start in starts(design, 20, seed=10):
        if start.mode[0] != start.mode[1]:
            continue
        goal = np.add(start.joints, [3.0, -3.0, 0.0, 0.0, 0.0])
        end = following(design).follow(start, goal)
        assert (end.stop, end.fraction) == ("singularity", 0.0)
        assert "stands in a parallel singularity" in end.text
        assert distance(end.posture, start) == 0.0


coordinate = st.integers(-1, 1).map(lambda n: 40.0 * n)
point = st.tuples(coordinate, coordinate, coordinate)
level = st.integers(0, 4).map(lambda n: 75.0 * n)


@settings(max_examples=60)
@given(
    st.lists(st.tuples(point, point), min_size=5, max_size=5),
    st.tuples(coordinate, coordinate, level, st.sampled_from([0.0, np.pi / 2, 0.3]), st.just(0.0)),
    st.sampled_from(MODES),
    st.lists(st.sampled_from([-40.0, 0.0, 1e-9, 0.5, 60.0]), min_size=5, max_size=5),
)
def test_degenerate_machines_always_get_an_answer_that_holds(
    limbs: Any, pose: Any, mode: str, move: list[float]
) -> None:
    """Coincident, aligned and symmetric limbs at round poses, where singularities abound."""
    one, two, three, four, five = (Limb(a, c, 150.0, (0.0, 500.0)) for a, c in limbs)
    design = FiveRPURDesign((one, two, three, four, five))
    start = posture(design, pose, mode)
    assume(start.closes)
    goal = np.add(start.joints, move)
    end = following(design).follow(start, goal)
    assert end.posture.closes
    assert end.posture.residual < 1e-9
    assert 0.0 <= end.fraction <= 1.0
    assert (end.text == "") <= (end.stop == "target")
    if end.stop == "target":
        np.testing.assert_allclose(end.posture.joints, goal, rtol=0, atol=1e-6)
