"""Jacobian and wrenches against finite differences, each other, and reference determinants."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inverse import MODES, joint_points, limb_lengths, signs
from tests.kinematics.mechanisms.five_rpur.asked import (
    condition,
    inverse_jacobian,
    wrench_matrix,
    wrenches,
)
from tests.kinematics.mechanisms.five_rpur.machines import preset
from tests.kinematics.references import read


def closing_poses(design: FiveRPURDesign, count: int, seed: int) -> tuple[Any, Any]:
    """Random poses at which every limb closes, |Y| ≤ 0.98 l, with random signs."""
    rng = np.random.default_rng(seed)
    position = rng.uniform((-400, -100, -500), (400, 250, 500), (20 * count, 3))
    poses = np.column_stack([position, rng.uniform(-np.pi, np.pi, (20 * count, 2))])
    _, b, c = joint_points(design, poses, "+++++")
    poses = poses[(np.abs((c - b)[..., 1]) <= 0.98 * design.link).all(axis=-1)][:count]
    assert len(poses) == count
    return poses, rng.choice([-1.0, 1.0], (count, 5))


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table2", "rpur-mpa3"])
def test_the_inverse_jacobian_is_the_derivative_of_the_lengths(name: str) -> None:
    design = preset(name)
    poses, sigma = closing_poses(design, 400, seed=1)
    jacobian = inverse_jacobian(design, poses, sigma)

    def rho(at: Any) -> Any:
        both = limb_lengths(design, at)
        return np.where(sigma > 0, both[..., 0], both[..., 1])

    steps = np.array([1e-3, 1e-3, 1e-3, 1e-5, 1e-5])
    numeric = np.stack(
        [(rho(poses + e) - rho(poses - e)) / (2 * e.sum()) for e in np.diag(steps)], axis=-1
    )
    assert np.isfinite(jacobian).all()
    # Curvature grows like 1/ρ and (l/h)³; both are bounded here but for a few small ρ.
    close = np.abs(jacobian - numeric) <= 1e-5 * (1 + np.abs(jacobian).max(axis=-1, keepdims=True))
    ordinary = rho(poses) > 5.0
    assert ordinary.mean() > 0.95
    assert close[ordinary].all()


def test_the_six_wrenches_and_the_jacobian_tell_the_same_determinant() -> None:
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 1000, seed=2)
    six = np.linalg.det(wrench_matrix(design, poses, sigma))
    five = np.linalg.det(inverse_jacobian(design, poses, sigma))
    transmission = wrenches(design, poses, sigma).transmission.prod(axis=-1)
    np.testing.assert_allclose(six, -five * transmission, rtol=1e-9, atol=1e-9 * np.abs(six).max())
    assert np.abs(six).max() > 1.0


def test_the_actuation_force_is_reciprocal_to_the_passive_joints() -> None:
    """f through B does no work on rotations of R_A, of the U joint and of R_C."""
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 300, seed=3)
    a, b, c = joint_points(design, poses, sigma)
    w = wrenches(design, poses, sigma)
    e1 = np.array([0.0, 1.0, 0.0])
    e2 = np.stack([np.cos(poses[:, 4]), np.zeros(len(poses)), -np.sin(poses[:, 4])], axis=-1)[
        :, None
    ]
    for point, axis in ((a, e1), (b, e1), (b, e2), (c, e2)):
        work = (w.force * np.cross(np.broadcast_to(axis, b.shape), b - point)).sum(axis=-1)
        np.testing.assert_allclose(work, 0.0, atol=1e-10)
    # The moment is that of the force through B, about O'.
    about_b = w.moment - np.cross(b - poses[:, None, :3], w.force)
    np.testing.assert_allclose(about_b, 0.0, atol=1e-12)
    # The couple is normal to both axes about which the platform turns.
    np.testing.assert_allclose(np.abs(w.couple @ e1), 0.0, atol=1e-15)
    np.testing.assert_allclose((w.couple * e2[:, 0]).sum(axis=-1), 0.0, atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(w.couple, axis=-1), 1.0)


def test_the_reference_fold_is_a_parallel_singularity_and_not_a_serial_one() -> None:
    data = read("rpur_folds.json")
    fold = data["folds"][0]
    design, pose = preset("rpur-table1"), np.array(fold["pose_fold"])
    both = limb_lengths(design, pose)
    np.testing.assert_allclose(
        np.abs(both - np.array(fold["rho_fold"])[:, None]).min(axis=1), 0, atol=1e-10
    )
    mode = "".join(
        "+-"[int(np.abs(pair - rho).argmin())]
        for pair, rho in zip(both, fold["rho_fold"], strict=True)
    )
    length = design.length
    values = np.linalg.svd(wrench_matrix(design, pose, mode, length=length), compute_uv=False)
    assert values[-1] < 1e-14
    assert values[-2] > 1e-3
    assert condition(design, pose, mode) > 1e12
    assert np.abs(wrenches(design, pose, mode).transmission).min() > 0.1
    # It takes the sign with it: the branches on both sides have opposite determinants.
    others = [np.linalg.svd(wrench_matrix(design, pose, m, length=length))[1][-1] for m in MODES]
    assert sum(value < 1e-12 for value in others) == 1


def test_near_a_serial_singularity_wrenches_stay_and_the_jacobian_goes() -> None:
    limb = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 150.0, (250.0, 400.0))
    others = preset("rpur-table1").limbs[1:]
    design = FiveRPURDesign((limb, *others))
    for y in (150.0, 150.0 * (1 - 1e-13), 150.0 * (1 - 1e-6)):
        pose = (20.0, y, 300.0, 0.0, 0.0)
        row = inverse_jacobian(design, pose, "+++++")[0]
        assert np.isnan(row).all() or np.abs(row).max() > 100
        assert np.isfinite(wrench_matrix(design, pose, "+++++")).all()
        assert condition(design, pose, "+++++") > 100
    assert np.isnan(inverse_jacobian(design, (20.0, 150.0, 300.0, 0.0, 0.0), "+++++")[0]).all()
    assert condition(design, (20.0, 150.0, 300.0, 0.0, 0.0), "+++++") == np.inf


def test_rho_zero_and_open_limbs_are_nan_without_warnings() -> None:
    limb = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 150.0, (0.0, 400.0))
    design = FiveRPURDesign((limb, *preset("rpur-table1").limbs[1:]))
    folded = (0.0, 90.0, 120.0, 0.0, 0.0)  # h = 120, so B is at A
    assert limb_lengths(design, folded)[0, 0] == 0.0
    assert np.isnan(inverse_jacobian(design, folded, "+++++")[0]).all()
    assert np.isfinite(inverse_jacobian(design, folded, "-++++")[0]).all()
    assert condition(design, folded, "+++++") == np.inf
    opened = (0.0, 170.0, 120.0, 0.0, 0.0)
    assert np.isnan(inverse_jacobian(design, opened, "+++++")[0]).all()
    assert np.isnan(condition(design, opened, "+++++"))


def test_condition_depends_on_no_unit_and_no_frame() -> None:
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 50, seed=4)
    scaled = FiveRPURDesign(
        tuple(  # type: ignore[arg-type]
            Limb(
                tuple(10 * v for v in limb.base),  # type: ignore[arg-type]
                tuple(10 * v for v in limb.platform),  # type: ignore[arg-type]
                10 * limb.link,
                (10 * limb.stroke[0], 10 * limb.stroke[1]),
            )
            for limb in design.limbs
        )
    )
    assert scaled.length == pytest.approx(10 * design.length)
    larger = poses * [10, 10, 10, 1, 1]
    before, after = condition(design, poses, sigma), condition(scaled, larger, sigma)
    np.testing.assert_allclose(after, before, rtol=1e-6)
    assert (before >= 1).all()
    # With the length given, in other units for angles, it is another number.
    assert not np.allclose(condition(design, poses, sigma, length=1.0), before)


def test_condition_is_one_for_an_isotropic_matrix_only_by_its_definition() -> None:
    design = preset("rpur-table1")
    poses, sigma = closing_poses(design, 20, seed=5)
    length = design.length
    j = inverse_jacobian(design, poses, sigma) / [1, 1, 1, length, length]
    np.testing.assert_allclose(condition(design, poses, sigma), np.linalg.cond(j), rtol=1e-10)


def test_the_characteristic_length_of_coincident_platform_points_is_the_link() -> None:
    limb = Limb((0.0, 0.0, 0.0), (5.0, 6.0, 7.0), 150.0, (250.0, 400.0))
    assert FiveRPURDesign((limb,) * 5).length == 150.0


@pytest.mark.parametrize("length", [0.0, -1.0, np.nan, np.inf])
def test_a_wrong_characteristic_length_is_refused(length: float) -> None:
    with pytest.raises(InputError, match="characteristic length"):
        condition(preset("rpur-table1"), np.zeros(5), "+++++", length=length)


def test_batches_broadcast_poses_with_modes() -> None:
    design = preset("rpur-table1")
    poses, _ = closing_poses(design, 6, seed=6)
    sigma = np.array([signs(mode) for mode in MODES])
    batch = inverse_jacobian(design, poses[:, None], sigma)
    assert batch.shape == (6, 32, 5, 5)
    np.testing.assert_allclose(batch[3, 7], inverse_jacobian(design, poses[3], MODES[7]))
    assert condition(design, poses[:, None], sigma).shape == (6, 32)
    assert not batch.flags.writeable
