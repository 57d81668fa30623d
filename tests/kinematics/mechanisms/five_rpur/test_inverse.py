"""Inverse kinematics: the constraints of the paper, both ways, and what is said of failures."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.facets.inverse import posture
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.dragging import pose_from_transform
from kinematics.mechanisms.five_rpur.inverse import (
    MODES,
    closure_residual,
    inside,
    inverse,
    joint_points,
    limb_lengths,
    signs,
    transform,
)
from kinematics.screws.spatial import rotation_x, rotation_y, rotation_z, wrap_angle
from tests.kinematics.references import read

# Real forward solutions, refined to 40 digits and found by methods independent of this package.
CASES: list[dict[str, Any]] = read("rpur_forward.json")["cases"]


def table_1() -> FiveRPURDesign:
    design = load_design("rpur-table1")
    assert isinstance(design, FiveRPURDesign)
    return design


def of_case(case: dict[str, Any]) -> FiveRPURDesign:
    rows = zip(case["r"], case["s_prime"], case["l"], strict=True)
    one, two, three, four, five = (
        Limb(tuple(r), tuple(s), link, (250.0, 400.0)) for r, s, link in rows
    )
    return FiveRPURDesign((one, two, three, four, five))


def random_poses(count: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    position = rng.uniform((-400, -100, -500), (400, 250, 500), (count, 3))
    return np.column_stack([position, rng.uniform(-np.pi, np.pi, (count, 2))])


def same_angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.abs((np.asarray(a) - b + np.pi) % (2 * np.pi) - np.pi)


# --- lengths -------------------------------------------------------------------------------


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_every_reference_solution_gives_its_lengths_back(case: dict[str, Any]) -> None:
    design = of_case(case)
    solutions = case["solutions"]
    poses = np.array([[s[k] for k in ("x", "y", "z", "phi", "theta")] for s in solutions])
    sigma = np.array([s["working_mode"] for s in solutions])
    both = limb_lengths(design, poses)
    rho = np.where(sigma > 0, both[..., 0], both[..., 1])
    # The stored poses have 16 digits; where h is small, ρ magnifies their last one by l/h.
    _, b, c = joint_points(design, poses, sigma)
    v = c - b
    h = np.hypot(v[..., 0], v[..., 2])
    assert (np.abs(rho - case["rho"]) <= 1e-11 + 1e-10 * design.link / h).all()


def test_lengths_satisfy_the_constraints_written_out() -> None:
    """Eqs. 3-5 with a rotation matrix of eq. 1 written out here, pose by pose."""
    design = table_1()
    found = 0
    for pose in random_poses(200):
        x, y, z, phi, theta = pose
        c, s, cf, sf = math.cos(theta), math.sin(theta), math.cos(phi), math.sin(phi)
        q = np.array([[c, sf * s, cf * s], [0, cf, -sf], [-s, sf * c, cf * c]])
        for k, limb in enumerate(design.limbs):
            tip = np.array([x, y, z]) + q @ limb.platform
            for n, rho in enumerate(limb_lengths(design, pose)[k]):
                if np.isnan(rho):
                    assert abs(tip[1] - limb.base[1]) > limb.link
                    continue
                found += 1
                _, elbow, _ = joint_points(design, pose, "+-"[n] * 5)
                b = elbow[k]
                assert b[1] == pytest.approx(limb.base[1], abs=1e-12)
                assert math.hypot(b[0] - limb.base[0], b[2] - limb.base[2]) == pytest.approx(rho)
                assert np.linalg.norm(tip - b) == pytest.approx(limb.link)
                assert (tip - b) @ (c, 0.0, -s) == pytest.approx(0.0, abs=1e-10)
                # + where C lies on the +z' side of B.
                assert ((tip - b) @ (s, 0.0, c) >= 0) == (n == 0)
    assert found > 500


def test_all_modes_combine_the_two_lengths_of_each_limb_in_the_stated_order() -> None:
    design, poses = table_1(), random_poses(5000)  # more than one chunk
    lengths, solutions = limb_lengths(design, poses), inverse(design, poses)
    assert solutions.modes == MODES
    assert MODES[0] == "+++++"
    assert MODES[1] == "++++-"
    assert MODES[-1] == "-----"
    low, high = design.stroke.T
    for m, mode in enumerate(MODES):
        expected = np.stack([lengths[:, i, "+-".index(s)] for i, s in enumerate(mode)], axis=-1)
        np.testing.assert_array_equal(solutions.joints[:, m], expected)
        with np.errstate(invalid="ignore"):
            fits = ((expected >= low) & (expected <= high)).all(axis=-1)
        np.testing.assert_array_equal(solutions.within_stroke[:, m], fits)
    assert solutions.within_stroke.any()
    closes = np.isfinite(lengths).all(axis=(1, 2))
    assert 0 < closes.sum() < len(poses)
    np.testing.assert_array_equal(np.isfinite(solutions.residual), closes)
    assert solutions.residual[closes].max() < 1e-11


def test_the_shape_of_a_batch_is_kept_and_results_are_read_only() -> None:
    design, poses = table_1(), random_poses(12)
    flat, square = inverse(design, poses), inverse(design, poses.reshape(3, 4, 5))
    np.testing.assert_array_equal(square.joints, flat.joints.reshape(3, 4, 32, 5))
    np.testing.assert_array_equal(square.within_stroke, flat.within_stroke.reshape(3, 4, 32))
    assert inverse(design, poses[0]).joints.shape == (32, 5)
    assert limb_lengths(design, np.empty((0, 5))).shape == (0, 5, 2)
    assert inside(design, np.empty((0, 5))).shape == (0,)
    for array in (flat.joints, flat.within_stroke, flat.residual, limb_lengths(design, poses)):
        assert not array.flags.writeable
    for array in joint_points(design, poses, "+-+-+"):
        assert not array.flags.writeable


@pytest.mark.parametrize("pose", [[0, 0, 0, 0], [0, 0, 0, 0, np.nan], [np.inf] * 5, "pose", 5.0])
def test_what_is_not_a_pose_is_refused(pose: Any) -> None:
    design = table_1()
    for refused in (limb_lengths, inverse, inside):
        with pytest.raises(InputError, match="a pose must"):
            refused(design, pose)
    with pytest.raises(InputError, match="a pose must"):
        posture(design, pose, "+++++")
    with pytest.raises(InputError, match="a pose must"):
        transform(pose)


@pytest.mark.parametrize("mode", ["", "++++", "++++++", "++0++", "+ +++", [1, 1, 1, 1, 0]])
def test_what_is_not_a_mode_is_refused(mode: Any) -> None:
    with pytest.raises(InputError, match="working mode"):
        joint_points(table_1(), np.zeros(5), mode)
    if isinstance(mode, str):
        with pytest.raises(InputError, match="working mode"):
            inside(table_1(), np.zeros(5), [mode])


@given(st.lists(st.floats(-1e300, 1e300), min_size=5, max_size=5))
def test_any_finite_pose_gets_an_answer(pose: list[float]) -> None:
    found = posture(table_1(), pose, "+-+-+")
    assert found.closes == bool(np.isfinite(limb_lengths(table_1(), pose)).all())
    assert found.reachable == bool(inside(table_1(), pose, ["+-+-+"]))
    assert found.nearest.amount <= min(m.amount for m in found.margins)


# --- the workspace as a membership test ----------------------------------------------------


def test_inside_is_what_the_inverse_problem_says() -> None:
    design, poses = table_1(), random_poses(5000, seed=1)
    fits = inverse(design, poses).within_stroke
    np.testing.assert_array_equal(inside(design, poses), fits.any(axis=-1))
    for modes in (["+++++"], ["+-+-+", "-----", "++--+"], list(MODES)):
        columns = [MODES.index(mode) for mode in modes]
        np.testing.assert_array_equal(inside(design, poses, modes), fits[:, columns].any(axis=-1))
    assert not inside(design, poses, []).any()
    assert inside(design, poses).any()


# --- one posture ---------------------------------------------------------------------------


def test_a_posture_is_the_mode_of_the_batch() -> None:
    design = table_1()
    for pose in random_poses(60, seed=2):
        solutions = inverse(design, pose)
        for m in (0, 5, 13, 31):
            found = posture(design, tuple(pose), MODES[m])
            np.testing.assert_array_equal(found.joints, solutions.joints[m])
            assert found.reachable == solutions.within_stroke[m]
            assert found.pose == tuple(pose)
            assert found.mode == MODES[m]


def test_known_lengths_are_kept_where_only_rounding_differs() -> None:
    design, pose = table_1(), (0.0, 60.0, 300.0, 0.1, 0.2)
    plain = posture(design, pose, "+-+++")
    known = [rho + 3e-11 for rho in plain.joints]
    known[2] += 1e-3
    found = posture(design, pose, "+-+++", known=known)
    assert found.joints == (*known[:2], plain.joints[2], *known[3:])
    assert 2e-11 < found.residual < 4e-11
    with pytest.raises(InputError, match="known lengths"):
        posture(design, pose, "+-+++", known=[300.0] * 4)


def simple(stroke: tuple[float, float] = (250.0, 400.0), link: float = 150.0) -> FiveRPURDesign:
    """Five equal limbs at the origin: with X = 0 lengths can be told by hand."""
    limb = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), link, stroke)
    return FiveRPURDesign((limb,) * 5)


def test_reasons_name_limb_bound_and_amount() -> None:
    # With Y = 90, h = 120 and ρ = Z − σ 120.
    found = posture(simple(), (0.0, 90.0, 292.4, 0.0, 0.0), "++-++")
    assert found.joints[2] == pytest.approx(412.4)
    long, short = found.reasons[2], found.reasons[0]
    assert (long.limb, long.bound) == (3, "rho_max")
    assert long.amount == pytest.approx(12.4)
    assert long.text == "limb 3 is 12.4 mm too long (ρ₃ = 412.4 mm, ρ max = 400 mm)"
    assert (short.limb, short.bound) == (1, "rho_min")
    assert short.text == "limb 1 is 77.6 mm too short (ρ₁ = 172.4 mm, ρ min = 250 mm)"
    assert not found.reachable
    assert found.closes
    assert (found.nearest.limb, found.nearest.bound) == (1, "rho_min")


def test_a_limb_that_cannot_close_says_by_how_much() -> None:
    found = posture(simple(), (0.0, -168.2, 300.0, 0.0, 0.0), "+++++")
    reason = found.reasons[1]
    assert (reason.limb, reason.bound) == (2, "link")
    assert reason.amount == pytest.approx(18.2)
    assert reason.text == (
        "limb 2 cannot reach: its platform point lies 18.2 mm beyond the link length "
        "l₂ = 150 mm along e₁ (|Y| = 168.2 mm)"
    )
    assert not found.closes
    assert np.isnan(found.joints).all()
    assert np.isnan(found.residual)
    assert {m.bound for m in found.margins} == {"link"}
    assert found.nearest.amount == pytest.approx(-18.2)


def test_small_amounts_are_not_rounded_away() -> None:
    found = posture(simple(), (0.0, 90.0, 520.0034, 0.0, 0.0), "+++++")
    assert "is 0.0034 mm too long (ρ₁ = 400.0034 mm" in found.reasons[0].text


def test_reachable_postures_have_margins_to_every_bound_and_no_reasons() -> None:
    found = posture(simple(), (0.0, 90.0, 430.0, 0.0, 0.0), "+++++")
    assert found.reachable
    assert found.residual < 1e-12
    amounts = {(m.limb, m.bound): m.amount for m in found.margins}
    assert len(amounts) == 15
    assert amounts[4, "link"] == pytest.approx(60.0)
    assert amounts[4, "rho_min"] == pytest.approx(60.0)
    assert amounts[4, "rho_max"] == pytest.approx(90.0)


@pytest.mark.parametrize("link", [150.0, 0.1, 1234.567])
def test_the_edge_of_a_limb_still_closes_despite_rounding(link: float) -> None:
    """|Y| = l exactly, by a sum that rounds: both modes meet."""
    for y in (link, -link, (link - 0.3) + 0.3, (link + 0.7) - 0.7):
        both = limb_lengths(simple(link=link), (0.0, y, 300.0, 0.0, 0.0))
        assert np.isfinite(both).all()
        np.testing.assert_allclose(both, 300.0, rtol=0, atol=1e-5 * link)
    assert np.isnan(limb_lengths(simple(link=link), (0, link * (1 + 1e-11), 300, 0, 0))).all()


def test_stroke_ends_belong_to_the_stroke() -> None:
    for end in (250.0, 400.0):
        assert posture(simple(), (0.0, 0.0, end + 150.0, 0.0, 0.0), "+++++").reachable
        assert inside(simple(), (0.0, 0.0, end + 150.0, 0.0, 0.0), ["+++++"])


# --- points, frames ------------------------------------------------------------------------


def test_joint_points_close_in_every_mode_and_for_signs_of_any_shape() -> None:
    design, poses = table_1(), random_poses(300, seed=3)
    sigma = np.array([signs(mode) for mode in MODES])
    a, b, c = joint_points(design, poses[:, None], sigma)
    assert a.shape == b.shape == c.shape == (300, 32, 5, 3)
    np.testing.assert_array_equal(a, np.broadcast_to(design.base, a.shape))
    homogeneous = np.append(design.platform, np.ones((5, 1)), axis=1)
    expected = np.einsum("njk,lk->nlj", transform(poses), homogeneous)[..., :3]
    np.testing.assert_allclose(c, np.broadcast_to(expected[:, None], c.shape), atol=1e-11)
    joints = inverse(design, poses).joints
    residual = closure_residual(design, poses[:, None], sigma, joints)
    np.testing.assert_array_equal(np.isnan(residual), np.isnan(joints))
    assert np.nanmax(residual) < 1e-11
    # The residual is no identity: it sees a wrong length, link or axis.
    assert np.nanmin(closure_residual(design, poses[:, None], sigma, joints + 0.5)) > 0.49


def test_an_open_limb_has_no_elbow_but_keeps_its_ends() -> None:
    a, b, c = joint_points(simple(), (0.0, 200.0, 300.0, 0.0, 0.0), "+++++")
    assert np.isnan(b).all()
    assert np.isfinite(a).all()
    assert np.isfinite(c).all()


def test_a_rigid_motion_of_the_whole_machine_changes_no_length() -> None:
    """Turning about e1 and shifting base and pose alike."""
    design, poses = table_1(), random_poses(200, seed=4)
    angle, shift = 0.7, np.array([31.0, -12.0, 57.0])
    turn = rotation_y(angle)
    one, two, three, four, five = (
        Limb(tuple((turn @ limb.base + shift).tolist()), limb.platform, limb.link, limb.stroke)
        for limb in design.limbs
    )
    moved = poses.copy()
    moved[:, :3] = poses[:, :3] @ turn.T + shift
    moved[:, 4] += angle
    before = limb_lengths(design, poses)
    after = limb_lengths(FiveRPURDesign((one, two, three, four, five)), moved)
    np.testing.assert_allclose(after, before, atol=1e-9)


angle = st.floats(-np.pi, np.pi, exclude_min=True)


@given(st.tuples(*[st.floats(-1e4, 1e4)] * 3), angle, angle)
def test_a_frame_gives_its_pose_back(
    position: tuple[float, float, float], phi: float, theta: float
) -> None:
    frame = transform((*position, phi, theta))
    found = pose_from_transform(frame)
    np.testing.assert_array_equal(found[:3], position)
    assert -np.pi < found[3] <= np.pi
    assert -np.pi < found[4] <= np.pi
    # Ry(θ)Rx(φ) is one to one for the platform's frame.
    np.testing.assert_allclose(same_angle(found[3:], np.array([phi, theta])), 0.0, atol=1e-12)


def test_another_frame_is_projected_onto_the_nearest_admissible_one() -> None:
    rng = np.random.default_rng(5)
    grid = np.stack(np.meshgrid(*[np.linspace(-np.pi, np.pi, 91)] * 2), axis=-1).reshape(-1, 2)
    admissible = rotation_y(grid[:, 1]) @ rotation_x(grid[:, 0])
    for _ in range(60):
        a, b, c = rng.uniform(-np.pi, np.pi, 3)
        wanted = rotation_z(a) @ rotation_x(b) @ rotation_z(c)
        frame = np.eye(4)
        frame[:3, :3] = wanted
        phi, theta = pose_from_transform(frame)[3:]
        found = np.linalg.norm(rotation_y(theta) @ rotation_x(phi) - wanted)
        assert found <= np.linalg.norm(admissible - wanted, axis=(1, 2)).min() + 1e-12


def test_batches_of_frames_and_what_is_no_frame() -> None:
    poses = random_poses(50, seed=6)
    np.testing.assert_allclose(pose_from_transform(transform(poses)), poses, atol=1e-11)
    with pytest.raises(InputError, match="4x4"):
        pose_from_transform(np.zeros((3, 4)))
    for broken in (np.zeros((4, 4)), np.diag([1.0, 1.0, -1.0, 1.0]), 2.0 * np.eye(4)):
        with pytest.raises(InputError, match="rotation"):
            pose_from_transform(broken)


@given(st.floats(-1e6, 1e6))
def test_wrapped_angles_lie_in_range_and_mean_the_same(value: float) -> None:
    wrapped = float(wrap_angle(value))
    assert -np.pi < wrapped <= np.pi
    assert math.remainder(wrapped - value, 2 * np.pi) == pytest.approx(0.0, abs=1e-9)
    if -np.pi < value <= np.pi:
        assert wrapped == value
