"""Study parameters, operation modes, inverse kinematics: reference poses, both ways round."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.errors import InputError
from kinematics.facets import inverse as generic
from kinematics.machine import machine_of
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import KINDS, MODES, Kind, TripodDesign
from kinematics.mechanisms.tripods.limbs import joint_points, limb_lengths, revolute_axes
from tests.kinematics.mechanisms.tripods.machines import (
    NAMES,
    machine,
    some_machines,
    some_poses,
    stored,
    to_transform,
)

CASES = stored("rps_spr_singularity.json")["poses"]


@pytest.mark.parametrize("case", CASES, ids=lambda c: f"{c['mech']}-{c['mode']}-{c['Z']}")
def test_the_reference_poses(case: dict) -> None:
    design = replace(machine(NAMES[case["mech"]], case["h1"], case["h2"]), stroke=(0.0, 10.0))
    pose, mode = np.array([case["Z"], case["theta"], case["phi"]]), str(case["mode"])
    placed = posing.transform(design, pose, mode)
    np.testing.assert_allclose(placed[:3, 3], case["t"], atol=1e-12)
    np.testing.assert_allclose(placed[:3, :3].ravel(), case["R"], atol=1e-12)
    lengths = generic.posture(design, pose, mode)
    np.testing.assert_allclose(lengths.joints, case["leg_lengths"], atol=1e-12)
    assert lengths.residual < 1e-13
    found = posing.to_study(design, posing.reduce_poses(design, pose, mode), mode)
    wanted = np.array(case["study_x"] + case["study_y"])
    np.testing.assert_allclose(found * np.sign(found @ wanted), wanted, atol=1e-12)
    np.testing.assert_allclose(to_transform(7.0 * wanted), placed, atol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mode", MODES)
def test_limbs_are_where_the_transform_puts_them(
    kind: Kind, mode: str, rng: np.random.Generator
) -> None:
    design, poses = machine(kind), some_poses(rng, 300)
    a, b = joint_points(design, poses, mode)
    lengths = limb_lengths(design, poses, mode)
    scale = 1.0 + lengths
    assert (np.abs(np.linalg.norm(b - a, axis=-1) - lengths) / scale).max() < 1e-13
    axes = revolute_axes(design, poses, mode)
    assert (np.abs(((b - a) * axes).sum(axis=-1)) / scale).max() < 1e-13
    rotation = posing.transform(design, poses, mode)[:, :3, :3]
    np.testing.assert_allclose(
        rotation @ rotation.swapaxes(-1, -2), np.broadcast_to(np.eye(3), rotation.shape), atol=1e-14
    )


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mode", MODES)
def test_poses_and_reduced_poses_and_transforms_are_one(
    kind: Kind, mode: str, rng: np.random.Generator
) -> None:
    design, poses = machine(kind), some_poses(rng, 200)
    back = posing.to_poses(design, posing.reduce_poses(design, poses, mode), mode)
    np.testing.assert_allclose(back, poses, atol=1e-10)
    for pose in poses[:20]:
        placed = posing.transform(design, pose, mode)
        np.testing.assert_allclose(
            posing.pose_from_transform(design, placed, mode), pose, atol=1e-12
        )


def test_a_3_spr_is_a_3_rps_held_by_its_platform(rng: np.random.Generator) -> None:
    """The poses of SPR(h1, h2, r) are the inverses of those of RPS(base h2, platform h1, r)."""
    for spr in some_machines(rng, 40)[1::2]:
        rps = TripodDesign("three_rps", spr.platform_radius, spr.base_radius, spr.stroke)
        for mode in MODES:
            poses = some_poses(rng, 5)
            placed = posing.transform(rps, poses, mode)
            inverted = np.linalg.inv(placed)
            there = np.array([posing.pose_from_transform(spr, m, mode) for m in inverted])
            np.testing.assert_allclose(
                limb_lengths(spr, there, mode),
                limb_lengths(rps, poses, mode),
                rtol=1e-10,
            )
            np.testing.assert_allclose(posing.transform(spr, there, mode), inverted, atol=1e-8)


@given(
    kind=st.sampled_from(KINDS),
    mode=st.sampled_from(MODES),
    tilt=st.sampled_from([0.0, 1e-12, 1e-7, np.pi - 1e-9, np.pi]),
    azimuth=st.floats(-np.pi, np.pi),
    z=st.floats(1.0, 300.0),
)
def test_level_and_turned_over(
    kind: Kind, mode: str, tilt: float, azimuth: float, z: float
) -> None:
    design = machine(kind)
    pose = np.array([z, tilt, azimuth])
    back = posing.to_poses(design, posing.reduce_poses(design, pose, mode), mode)
    apart = machine_of(design).forward.distances(pose[None], (mode,), back[None], (mode,))
    assert apart[0, 0] < 1e-9 * (1.0 + z)
    assert generic.posture(design, pose, mode).residual < 1e-10 * (1.0 + z)


def test_the_modes_differ_by_a_half_turn_at_home() -> None:
    design = machine("three_rps")
    one, two = (posing.transform(design, (100.0, 0.0, 0.0), mode) for mode in MODES)
    np.testing.assert_allclose(one[:3, :3], np.diag([-1.0, -1.0, 1.0]), atol=1e-15)
    np.testing.assert_allclose(two[:3, :3], np.eye(3), atol=1e-15)


@pytest.mark.parametrize("mode", MODES)
def test_at_90_degrees_a_3_spr_has_no_position(mode: str) -> None:
    design = machine("three_spr")
    there = generic.posture(design, (100.0, 0.5 * np.pi, 0.3), mode)
    assert not there.closes
    assert len(there.reasons) == 3
    assert "X and Y go to infinity" in there.reasons[0].text
    near = generic.posture(design, (100.0, 0.5 * np.pi - 1e-4, 0.3), mode)
    assert min(near.joints) > 1e5
    assert generic.posture(machine("three_rps"), (100.0, 0.5 * np.pi, 0.3), mode).closes
    assert not machine_of(design).clearances.of(there)
    drawn = machine_of(design).drawing(there)
    assert {bar.role for bar in drawn.bars} >= {"gap"}
    assert np.isfinite([bar.end for bar in drawn.bars]).all()


def test_reasons_name_limb_bound_and_amount() -> None:
    design = replace(machine("three_rps"), stroke=(50.0, 120.0))
    there = generic.posture(design, (115.0, 0.2, 0.0), "2")
    assert not there.reachable
    assert [r.limb for r in there.reasons] == [
        i + 1 for i, r in enumerate(there.joints) if not 50 <= r <= 120
    ]
    first = there.reasons[0]
    assert first.amount == pytest.approx(there.joints[first.limb - 1] - 120.0)
    assert "ρ max = 120 mm" in first.text
    known = machine_of(design).inverse([there.pose])
    np.testing.assert_allclose(known.joints[0, 1], there.joints)
    assert known.modes == MODES
    assert not known.within_stroke[0, 1]


def test_what_is_refused() -> None:
    design = machine("three_rps")
    with pytest.raises(InputError, match="operation mode is 1 or 2"):
        generic.posture(design, (1.0, 0.0, 0.0), "3")
    with pytest.raises(InputError, match="3 numbers"):
        generic.posture(design, (1.0, 0.0), "1")
    with pytest.raises(InputError, match="rotation"):
        posing.pose_from_transform(design, np.diag([2.0, 1.0, 1.0, 1.0]), "1")
    with pytest.raises(InputError, match="x0 y0"):
        to_transform([1, 0, 0, 0, 1, 0, 0, 0])
    with pytest.raises(InputError, match="all be zero"):
        to_transform(np.zeros(8))
