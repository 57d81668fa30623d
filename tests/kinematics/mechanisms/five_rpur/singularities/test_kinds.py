"""Every kind of singularity of the 5-RPUR, named with its cause, its limbs and its free motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.answers.singularities import NEAR, Singularity
from kinematics.arrays import Array
from kinematics.facets import inverse as generic
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.screws.wrenches import singular_values
from tests.kinematics.mechanisms.five_rpur.asked import (
    pose_rates_of,
    singularities,
    twists,
    wrench_system,
)
from tests.kinematics.mechanisms.five_rpur.closing import closing_poses, lengths
from tests.kinematics.mechanisms.five_rpur.machines import forward, preset
from tests.kinematics.mechanisms.five_rpur.test_arrangements import IN_ALL_MODES, SINGULAR
from tests.kinematics.references import read

FOLDS = read("rpur_folds.json")


def at(
    design: FiveRPURDesign, pose: object, mode: str, tolerance: float = 1e-6
) -> tuple[Singularity, ...]:
    return singularities(design, generic.posture(design, np.asarray(pose), mode), tolerance)


def mode_with(design: FiveRPURDesign, pose: object, rho: object) -> str:
    both = inverse.limb_lengths(design, pose)
    return "".join(
        "+-"[int(np.abs(pair - r).argmin())] for pair, r in zip(both, np.array(rho), strict=True)
    )


def check_motion(design: FiveRPURDesign, pose: object, mode: str, found: Singularity) -> None:
    """The free motion has unit size, is its twist, and changes no length to first order."""
    assert found.motion is not None
    assert found.twist is not None
    length = design.length
    d, twist = np.array(found.motion), np.array(found.twist)
    scale = np.array([1, 1, 1, length, length])
    assert np.linalg.norm(d * scale) == pytest.approx(1.0)
    np.testing.assert_allclose(twists(pose, d), twist, atol=1e-9)
    np.testing.assert_allclose(pose_rates_of(pose, twist), d, atol=1e-12)
    rows = wrench_system(design, pose, mode).rows
    work = rows[:, :3] @ twist[3:] + rows[:, 3:] @ twist[:3]
    size = np.linalg.norm(rows / [1, 1, 1, length, length, length], axis=1)
    # More than the singular value, since the couple is kept to exactly.
    assert np.linalg.norm(work / size) < max(1e-9, 5 * found.measure)
    assert abs(work[5]) < 1e-12  # the couple forbids what it forbids


# --- parallel ------------------------------------------------------------------------------


def test_the_reference_fold_is_named_with_the_motion_that_merges_the_modes() -> None:
    design = preset("rpur-table1")
    fold = FOLDS["folds"][0]
    pose, rho = np.array(fold["pose_fold"]), np.array(fold["rho_fold"])
    mode = mode_with(design, pose, rho)
    (found,) = at(design, pose, mode)
    assert found.kind == "parallel"
    assert found.limbs == (1, 2, 3, 4, 5)
    assert found.measure < 1e-12
    assert "general linear complex" in found.cause
    assert "two assembly modes merge" in found.text
    check_motion(design, pose, mode, found)
    # The two solutions a little before the fold lie along the free motion.
    step = np.array(FOLDS["drho"])
    (before,) = forward(design, rho - 1e-3 * step / np.abs(step).max())
    away = before.poses - pose
    length = design.length
    two = np.argsort(np.linalg.norm(away * [1, 1, 1, length, length], axis=1))[:2]
    between = (before.poses[two[0]] - before.poses[two[1]]) * [1, 1, 1, length, length]
    between /= np.linalg.norm(between)
    along = np.array(found.motion) * [1, 1, 1, length, length]
    assert abs(float(between @ along)) > 0.999


def test_ordinary_postures_are_in_no_singularity() -> None:
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 60, seed=1)
    for pose, signs in zip(poses, sigma, strict=True):
        mode = "".join("+" if s > 0 else "-" for s in signs)
        assert at(design, pose, mode) == ()


def test_a_larger_tolerance_tells_what_is_near_and_says_so() -> None:
    design = preset("rpur-table1")
    fold = FOLDS["folds"][0]
    mode = mode_with(design, fold["pose_fold"], fold["rho_fold"])
    pose = np.array(fold["pose_fold"]) + np.array([2.0, -3.0, 1.0, 0.0, 0.0])
    assert at(design, pose, mode) == ()
    (found,) = at(design, pose, mode, NEAR)
    values = singular_values(wrench_system(design, pose, mode).rows, design.length)
    assert found.measure == pytest.approx(float(values[-1]))
    assert found.text.startswith("Near a parallel singularity")
    check_motion(design, pose, mode, found)


def test_two_limbs_on_one_line() -> None:
    """Limbs 1 and 2 of one platform point with their base points on both sides of B."""
    design = preset("rpur-a1a1")
    a, b, _ = inverse.joint_points(design, (0.0, 20.0, 300.0, 0.1, 0.2), "+++++")
    other = tuple((b[0] + 0.8 * (b[0] - a[0])).tolist())
    aligned = replace(
        design, limbs=(design.limbs[0], replace(design.limbs[1], base=other), *design.limbs[2:])
    )
    pose = (0.0, 20.0, 300.0, 0.1, 0.2)
    (found,) = at(aligned, pose, "+++++")
    assert found.kind == "parallel"
    assert found.limbs == (1, 2)
    assert found.cause == "the lines of limbs 1 and 2 coincide"
    check_motion(aligned, pose, "+++++", found)


def test_what_is_free_in_two_ways_is_told_twice() -> None:
    limbs = preset("rpur-table1").limbs
    twin = replace(limbs[0], base=(-55.0, 30.0, 50.0))
    twice = FiveRPURDesign((limbs[0], twin, limbs[2], limbs[2], limbs[4]))
    found = at(twice, (0.0, 80.0, 350.0, 0.1, 0.2), "+++++")
    assert {one.limbs for one in found} == {(1, 2), (3, 4)}
    assert {one.cause for one in found} == {
        "the lines of limbs 1 and 2 coincide",
        "the lines of limbs 3 and 4 coincide",
    }
    motions = np.array([one.motion for one in found])
    assert np.linalg.matrix_rank(motions) == 2
    for one in found:
        check_motion(twice, (0.0, 80.0, 350.0, 0.1, 0.2), "+++++", one)


# --- self-motions --------------------------------------------------------------------------


def locked_motion_stays(design: FiveRPURDesign, pose: Array, mode: str, found: Singularity) -> None:
    """Newton's method from a step along the motion comes back to the same lengths, elsewhere."""
    assert found.motion is not None
    length = design.length
    scale = np.array([1, 1, 1, length, length])
    rho = lengths(design, pose, mode)
    for step in (-3.0, 3.0):
        there = pose + step * np.array(found.motion)
        for _ in range(60):
            j = np.linalg.lstsq(
                _jacobian(design, there, mode) / scale,
                rho - lengths(design, there, mode),
                rcond=1e-7,
            )[0]
            there = there + j / scale
        assert np.abs(lengths(design, there, mode) - rho).max() < 1e-9
        moved = (there - pose) * scale
        assert np.linalg.norm(moved) > 0.5 * abs(step)


def _jacobian(design: FiveRPURDesign, pose: Array, mode: str) -> Array:
    steps = np.diag([1e-4, 1e-4, 1e-4, 1e-6, 1e-6])
    return np.stack(
        [
            (lengths(design, pose + e, mode) - lengths(design, pose - e, mode)) / (2 * e.sum())
            for e in steps
        ],
        axis=-1,
    )


def test_the_self_motion_of_a1a1() -> None:
    """After eq. 12: the first axes of both merged U joints are aligned; a hyperbolic congruence."""
    design = preset("rpur-table2")
    base = design.base[:4]
    joints = [*np.hypot(60 - base[:, 0], 200 - base[:, 2]).tolist(), 300.0]
    (solutions,) = forward(design, joints)
    assert solutions.self_motions
    for motion in solutions.self_motions:
        pose = np.array(motion.pose)
        (found,) = at(design, pose, motion.mode)
        assert found.kind == "self-motion"
        assert found.limbs == (1, 2, 3, 4)
        assert "the first axes of the U joints of limbs 1 and 2 and of limbs 3 and 4" in found.cause
        assert "lie on one line along e₁ through (60.0, 0.0, 200.0) mm" in found.cause
        assert "a hyperbolic congruence" in found.cause
        assert "over a finite way" in found.text
        check_motion(design, pose, motion.mode, found)
        locked_motion_stays(design, pose, motion.mode, found)


def on_the_axis(design: FiveRPURDesign, angles: tuple[float, float]) -> Array:
    """A pose of {A1A2} whose merged U joint is on the line along e1 through the shared base."""
    pose = np.array([10.0, 0.0, 150.0, *angles])
    _, b, _ = inverse.joint_points(design, pose, "+++++")
    pose[0] += design.base[2, 0] - b[0, 0]
    pose[2] += design.base[2, 2] - b[0, 2]
    return pose


@pytest.mark.parametrize("angles", [(0.1, 0.2), (-0.3, -0.4)])
def test_the_self_motion_of_a1a2(angles: tuple[float, float]) -> None:
    """After eq. 25: x_B34 = z_B34 = 0 with the shared base point at the origin."""
    design = preset("rpur-a1a2")
    # Base points of A1 off the plane of that line: its actuators are not aligned, unlike the
    # paper says, and θ is free all the same.
    first = replace(design.limbs[0], base=(-90.0, 30.0, 20.0))
    general = replace(design, limbs=(first, *design.limbs[1:]))
    for machine, cause, limbs in (
        (general, "a hyperbolic congruence", (1, 2, 3, 4)),
        (design, "the lines of limbs 1 and 2 coincide", (1, 2)),
    ):
        pose = on_the_axis(machine, angles)
        (found,) = at(machine, pose, "+++++")
        assert found.kind == "self-motion"
        assert found.limbs == limbs
        assert cause in found.cause
        assert (
            "the first axis of the U joint of limbs 1 and 2 and the base point of limbs 3 and 4 "
            "lie on one line along e₁"
        ) in found.cause
        check_motion(machine, pose, "+++++", found)
        locked_motion_stays(machine, pose, "+++++", found)


def test_next_to_a_self_motion_the_distance_is_told() -> None:
    design = preset("rpur-a1a2")
    first = replace(design.limbs[0], base=(-90.0, 30.0, 20.0))
    design = replace(design, limbs=(first, *design.limbs[1:]))
    pose = on_the_axis(design, (-0.3, -0.4))
    pose[2] += 0.3
    (found,) = at(design, pose, "+++++", NEAR)
    assert found.kind == "parallel"
    assert "are 0.3 mm from one line along e₁" in found.cause
    assert found.text.startswith("Near")


# --- architectural -------------------------------------------------------------------------


def some_pose(design: FiveRPURDesign, mode: str) -> Array:
    rng = np.random.default_rng(3)
    position = design.base.mean(axis=0) + rng.uniform(-200, 200, (3000, 3))
    position[:, 1] = design.base[:, 1].mean() + rng.uniform(-100, 100, 3000)
    poses = np.column_stack([position, rng.uniform(-1, 1, (3000, 2))])
    _, b, _ = inverse.joint_points(design, poses, mode)
    return np.asarray(poses[np.isfinite(b).all(axis=(1, 2))][0])


CAUSES = {
    "four in a group": "lie in one plane",
    "five in a group": "lie in one plane",
    "three on one platform point": "meet in the point",
    "three on one base point": "meet in the point (0.0, ",
    "coincident limbs": "coincide",
    "coincident limbs and a third": "coincide",
    "platform points on a line along e2": "all meet the line",
    "base points on a line along e1": "all meet the line through (15.0, ",
}


@pytest.mark.parametrize("name", [*SINGULAR, *IN_ALL_MODES])
def test_architectural_singularities_are_told_from_others(name: str) -> None:
    design = {**SINGULAR, **IN_ALL_MODES}[name]
    pose = some_pose(design, "+++++")
    found = at(design, pose, "+++++")
    assert found
    for one in found:
        assert one.kind == "architectural"
        assert CAUSES.get(name, "a special linear complex") in one.cause
        assert one.text.startswith("Architectural singularity: ")
        check_motion(design, pose, "+++++", one)
    if name.startswith("Mp"):
        assert f"{{Mp {name[2:4]} {name[4:]}}}" in found[0].text


def test_where_the_modes_differ_an_mp_set_holds() -> None:
    design = SINGULAR["MpA1A1"]
    pose = some_pose(design, "-++++")
    assert at(design, pose, "-++++") == ()


# --- serial --------------------------------------------------------------------------------


def first_limb_plain(stroke: tuple[float, float] = (250.0, 400.0)) -> FiveRPURDesign:
    limb = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 150.0, stroke)
    return FiveRPURDesign((limb, *preset("rpur-table1").limbs[1:]))


@pytest.mark.parametrize("y", [150.0, -150.0])
@pytest.mark.parametrize("mode", ["+++++", "-+-+-"])
def test_a_link_along_e1_is_a_serial_singularity(y: float, mode: str) -> None:
    design = first_limb_plain()
    others = (replace(limb, base=(limb.base[0], y, limb.base[2])) for limb in design.limbs[1:])
    design = replace(design, limbs=(design.limbs[0], *others))
    (found,) = at(design, (20.0, y, 300.0, 0.0, 0.0), mode)
    assert found.kind == "serial"
    assert found.limbs == (1,)
    assert found.measure == 0.0
    assert found.cause == "the link of limb 1 is parallel to e₁, at the end of its reach: h₁ = 0"
    assert "two working modes meet" in found.text
    assert found.motion is None
    assert found.twist is None


def test_near_a_serial_singularity() -> None:
    design = first_limb_plain()
    pose = (20.0, 149.99, 300.0, 0.0, 0.0)
    assert at(design, pose, "+++++") == ()
    (found,) = at(design, pose, "+++++", NEAR)
    assert found.measure == pytest.approx(np.sqrt(150.0**2 - 149.99**2) / 150.0)
    assert "h₁ = 1.7 mm" in found.cause
    assert found.text.startswith("Near a serial singularity of limb 1")


def test_an_actuator_without_length_and_one_along_e2() -> None:
    design = first_limb_plain((0.0, 400.0))
    (found,) = at(design, (0.0, 90.0, 120.0, 0.0, 0.0), "+++++")
    assert (found.kind, found.limbs) == ("serial", (1,))
    assert found.cause == "the actuator of limb 1 has no length: ρ₁ = 0"
    (found,) = at(design, (20.0, 150.0, 0.0, 0.0, 0.0), "+++++")
    assert found.cause.endswith("h₁ = 0, and its actuator to e₂")


def test_serial_and_parallel_at_a_time() -> None:
    plain = first_limb_plain().limbs[0]
    rest = preset("rpur-table1").limbs
    design = FiveRPURDesign((plain, rest[1], rest[2], rest[2], rest[4]))
    kinds = [(one.kind, one.limbs) for one in at(design, (20.0, 150.0, 300.0, 0, 0), "+++++")]
    assert kinds == [("serial", (1,)), ("architectural", (3, 4))]


def test_two_serial_limbs_at_a_time_may_be_parallel_too() -> None:
    """At q = 0 a limb's line is along e1; the lines of two such limbs are parallel, not more."""
    plain = first_limb_plain().limbs[0]
    other = replace(plain, base=(90.0, 0.0, 30.0), platform=(-30.0, 0.0, 10.0))
    design = FiveRPURDesign((plain, other, *preset("rpur-table1").limbs[2:]))
    found = at(design, (20.0, 150.0, 300.0, 0.0, 0.0), "+++++")
    assert [one.limbs for one in found if one.kind == "serial"] == [(1,), (2,)]
    rows = wrench_system(design, (20.0, 150.0, 300.0, 0.0, 0.0), "+++++").rows
    np.testing.assert_allclose(np.abs(rows[:2, 1]), 1.0)


def test_a_posture_that_does_not_close_is_in_none() -> None:
    assert at(preset("rpur-table1"), (0.0, 900.0, 300.0, 0.0, 0.0), "+++++", 1.0) == ()


# --- properties ----------------------------------------------------------------------------


@given(st.integers(0, 10**6), st.sampled_from(["+++++", "+-+-+", "--+-+"]))
def test_the_measure_is_below_the_tolerance_exactly_where_something_is_told(
    seed: int, mode: str
) -> None:
    design = preset("rpur-table1")
    rng = np.random.default_rng(seed)
    pose = np.array([*rng.uniform((-100, 20, 250), (200, 150, 450)), *rng.uniform(-0.6, 0.6, 2)])
    posture = generic.posture(design, pose, mode)
    found = singularities(design, posture, 0.05)
    if not posture.closes:
        assert found == ()
        return
    system = wrench_system(design, pose, mode)
    values = singular_values(system.rows, design.length)
    parallel = [one for one in found if one.kind != "serial"]
    assert len(parallel) == int((values < 0.05).sum())
    for one in parallel:
        assert one.measure < 0.05
        check_motion(design, pose, mode, one)
    assert all("constraint singularity" not in one.text.lower() for one in found)


def test_the_couple_never_vanishes_so_there_is_no_constraint_singularity() -> None:
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 500, seed=4)
    couple = wrench_system(design, poses, sigma).rows[:, 5, 3:]
    np.testing.assert_allclose(np.linalg.norm(couple, axis=-1), 1.0, atol=1e-15)
