"""The paper's closed forms, corrected, against the uniform algorithm and the stored cases."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from kinematics.arrays import Array
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.arrangements import arrangements
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.forward.equations import PHI, THETA, Frame, X, Y, Z
from kinematics.mechanisms.five_rpur.forward.simplified import same_mode_roots
from kinematics.mechanisms.five_rpur.inverse import inverse
from tests.kinematics.mechanisms.five_rpur.forward.closed_forms import a1a1, a1a2, closed_form
from tests.kinematics.references import read

CASES: dict[str, dict[str, Any]] = {
    case["name"]: case
    for case in read("rpur_forward.json")["cases"]
    if case["design"] in ("A1A1", "A1A2", "MpA2")
}
CLASSES = ("A1A1", "A1A2", "MpA2")


def made(base: Any, platform: Any, link: Any) -> FiveRPURDesign:
    one, two, three, four, five = (
        Limb(tuple(map(float, a)), tuple(map(float, c)), float(length), (1.0, 1000.0))
        for a, c, length in zip(base, platform, link, strict=True)
    )
    return FiveRPURDesign((one, two, three, four, five))


def of_case(name: str) -> tuple[FiveRPURDesign, Array]:
    case = CASES[name]
    return made(case["r"], case["s_prime"], case["l"]), np.array(case["rho"])


def preset(name: str) -> FiveRPURDesign:
    design = load_design(f"rpur-{name.lower()}")
    assert isinstance(design, FiveRPURDesign)
    return design


def random_design(name: str, seed: int) -> FiveRPURDesign:
    """Of a class, standing anywhere, its limbs in any order."""
    rng = np.random.default_rng(seed)
    base, platform = rng.uniform(-120, 120, (5, 3)), rng.uniform(-90, 90, (5, 3))
    link = rng.uniform(100, 220, 5)
    ties = {"A1A1": "01A1 23A1", "A1A2": "01A1 23A2", "MpA2": "01A2 02A3"}[name]
    for tie in ties.split():
        i, j, kind = int(tie[0]), int(tie[1]), tie[2:]
        link[j], base[j, 1], platform[j, 1:] = link[i], base[i, 1], platform[i, 1:]
        if kind == "A1":
            platform[j] = platform[i]
        elif kind == "A2":
            base[j] = base[i]
    order = rng.permutation(5)
    return made(base[order], platform[order], link[order])


def invariants(poses: Array) -> Array:
    """x, y, z, e^{iφ}, e^{iθ} of complex poses: angles without their turns."""
    return np.concatenate([poses[:, :3], np.exp(1j * poses[:, 3:])], axis=1)


def uniform(design: FiveRPURDesign, joints: Array) -> Array:
    """The same of the uniform algorithm's solutions."""
    u, _ = same_mode_roots(design, joints)
    frame = Frame.of(design)
    (sx, sy, sz), (rx, ry, rz) = frame.platform, frame.base
    phi, theta = -1j * np.log(u[PHI]), -1j * np.log(u[THETA])
    c, s, cf, sf = np.cos(theta), np.sin(theta), np.cos(phi), np.sin(phi)
    x = frame.unit * u[X] - sx
    y = frame.unit * u[Y] - (cf * sy - sf * sz)
    z = frame.unit * u[Z] - (sf * sy + cf * sz)
    answer: Array = np.stack(
        [rx + c * x + s * z, ry + y, rz - s * x + c * z, u[PHI], u[THETA]], axis=1
    )
    return answer


@pytest.mark.parametrize("name", CLASSES)
@pytest.mark.parametrize("seed", range(5))
def test_closed_form_and_uniform_algorithm_agree_root_by_root(name: str, seed: int) -> None:
    design = random_design(name, seed)
    assert arrangements(design).name == f"{{{name}}}"
    joints = np.random.default_rng(1000 + seed).uniform(150, 450, 5)
    found = closed_form(design, joints)
    assert found.poses.shape == (96, 5)
    assert found.joints_b.shape == (96, 5, 3)
    ours, theirs = invariants(found.poses), uniform(design, joints)
    assert theirs.shape == (96, 5)
    distance = (np.abs(ours[:, None] - theirs) / (1.0 + np.abs(theirs))).max(axis=2)
    assert distance.min(axis=0).max() < 1e-6
    assert sorted(distance.argmin(axis=1)) == list(range(96))


@pytest.mark.parametrize("name", CASES)
def test_the_real_ones_are_the_stored_ones(name: str) -> None:
    design, joints = of_case(name)
    real = closed_form(design, joints).real_poses()
    stored = np.array(
        [[s[k] for k in ("x", "y", "z", "phi", "theta")] for s in CASES[name]["solutions"]]
    )
    assert real.shape == stored.shape
    difference = real[:, None] - stored
    difference[..., 3:] = np.angle(np.exp(1j * difference[..., 3:]))
    distance = np.abs(difference).max(axis=2)
    assert distance.min(axis=0).max() < 1e-6
    assert sorted(distance.argmin(axis=0)) == list(range(len(stored)))
    assert (np.abs(real[:, 3:]) <= math.pi).all()


def test_b_points_satisfy_the_constraints() -> None:
    # Eqs. 3 and 5 and |v| = l, with complex numbers and no conjugates.
    for name in CLASSES:
        design, joints = random_design(name, 7), np.array([210.0, 330.0, 250.0, 280.0, 300.0])
        poses, b = closed_form(design, joints)
        x, y, z, phi, theta = poses.T[:, :, None]
        c, s, cf, sf = np.cos(theta), np.sin(theta), np.cos(phi), np.sin(phi)
        sx, sy, sz = design.platform.T
        my, mz = cf * sy - sf * sz, sf * sy + cf * sz
        v = np.stack([x + c * sx + s * mz, y + my, z - s * sx + c * mz], axis=-1) - b
        r = b - design.base
        size = (
            1.0
            + np.abs(poses).max(axis=1, keepdims=True) ** 2
            + np.abs(b).max(axis=(1, 2))[:, None] ** 2
        )
        assert (np.abs(r[..., 0] ** 2 + r[..., 2] ** 2 - joints**2) < 1e-9 * size).all()
        assert (np.abs((v * v).sum(axis=-1) - design.link**2) < 1e-6 * size).all()
        assert (np.abs(v[..., 0] * c - v[..., 2] * s) < 1e-8 * size).all()
        assert (b[..., 1] == design.base[:, 1]).all()


# --- what is printed otherwise ---------------------------------------------------------------


def test_a1a2_has_96_solutions_and_not_48() -> None:
    # Section 3.2: "it can be shown that for a given θ and B_34 one solution can be found for B_1
    # and B_2". Here are 96 real ones, so two.
    design, joints = of_case("A1A2_free_maxreal")
    assert len(closed_form(design, joints).real_poses()) == 96
    linkages = list(a1a2(design, joints))
    angles = np.array([linkage.theta for linkage in linkages])
    assert len(linkages) == 8
    assert len(np.unique(np.round(angles, 9))) == 4
    for theta in np.unique(np.round(angles, 9)):
        same = [k for k in linkages if abs(k.theta - theta) < 1e-8]
        assert len(same) == 2
        one, two = (np.array(k.joints_b[2]) for k in same)
        assert np.abs(one - two).max() > 1.0


def test_eq_12_as_printed_misses_what_the_corrected_one_finds() -> None:
    design, joints = of_case("A1A1_free_maxreal")
    s = design.platform[:, 0]
    linkages = list(a1a1(design, joints))
    assert len(linkages) == 8
    printed_hits = 0
    for theta, b in linkages:
        (x12, z12), (x34, z34) = b[0], b[2]
        assert abs((x34 - x12) * np.cos(theta) - (z34 - z12) * np.sin(theta) - (s[2] - s[0])) < 1e-9
        printed = np.arccos((s[0] - s[2]) / np.hypot((x34 - x12).real, (z34 - z12).real))
        printed += np.arctan2((z12 - z34).real, (x34 - x12).real)
        printed_hits += abs(np.exp(1j * printed) - np.exp(1j * theta)) < 1e-9
    assert printed_hits == 0


def test_eq_13_needs_z_of_a5() -> None:
    # Equal to the printed one only where z_A5 = 0; the sample has 30.8 mm.
    design, joints = of_case("A1A1_free_maxreal")
    poses, b = closed_form(design, joints)
    theta, b5, b1 = poses[:, 4], b[:, 4], b[:, 0]
    ell = b1[:, 0] * np.cos(theta) - b1[:, 2] * np.sin(theta)
    ell = ell + design.platform[4, 0] - design.platform[0, 0]
    x_a, _, z_a = design.base[4]

    def eq_13(z: float) -> Array:
        c, s = np.cos(theta), np.sin(theta)
        root = np.sqrt(joints[4] ** 2 - (x_a * c - z * s - ell) ** 2 + 0j)
        straight = x_a * s * s + z * s * c + ell * c
        off: Array = np.minimum(
            np.abs(straight + s * root - b5[:, 0]), np.abs(straight - s * root - b5[:, 0])
        )
        return off

    assert eq_13(z_a).max() < 1e-8
    assert eq_13(0.0).min() > 0.1


# --- other inputs ----------------------------------------------------------------------------


def test_poses_come_back() -> None:
    for name in CLASSES:
        design = preset(name)
        pose = np.array([*design.base.mean(axis=0), 0.2, 0.15]) + np.array([5, 10, 250, 0, 0])
        joints = inverse(design, pose).joints[0]  # +++++
        assert np.isfinite(joints).all()
        off = np.abs(closed_form(design, joints).real_poses() - pose).max(axis=1)
        assert off.min() < 1e-8


def test_lengths_that_cannot_close_have_no_real_pose() -> None:
    joints = [100.0, 100.0, 300.0, 310.0, 305.0]  # A_1A_2 of Table 2 is 245
    design = load_design("rpur-table2")
    assert isinstance(design, FiveRPURDesign)
    found = closed_form(design, joints)
    assert len(found.poses) == 96
    assert len(found.real_poses()) == 0


def test_roots_at_infinity_are_left_out() -> None:
    # Two of the three legs meet on the platform: 64 instead of 96.
    some, joints = of_case("A1A2_free_maxreal")
    platform = some.platform.copy()
    platform[4, 1:] = platform[2, 1:]
    found = closed_form(made(some.base, platform, some.link), joints)
    assert len(found.poses) == 64
    assert np.isfinite(found.poses).all()


@pytest.mark.parametrize("joints", [[0.0] * 5, [1e200] * 5, [300.0] * 5])
@pytest.mark.parametrize("name", CLASSES)
def test_extreme_lengths_are_answered(name: str, joints: list[float]) -> None:
    found = closed_form(preset(name), joints)
    assert len(found.poses) == len(found.joints_b) <= 96


@pytest.mark.parametrize("name", ["a3a3", "mpa1", "table1"])
def test_other_classes_are_refused(name: str) -> None:
    with pytest.raises(InputError, match="closed forms are given for"):
        closed_form(preset(name), [300.0] * 5)


@pytest.mark.parametrize("joints", [[300.0] * 4, [[300.0] * 5] * 2, [math.inf] * 5])
def test_only_one_set_of_five_lengths_is_taken(joints: Any) -> None:
    with pytest.raises(InputError):
        closed_form(preset("A1A1"), joints)
