"""Velocities, accelerations, wrenches and singularities against other computations."""

from __future__ import annotations

import numpy as np
import pytest

import kinematics as kin
from tests.kinematics.mechanisms.parallel.machines import case, machine


@pytest.mark.parametrize("name", ["velocity_gough", "velocity_rus6", "velocity_delta"])
def test_twists_and_accelerations(name: str) -> None:
    one = case(name)
    m = kin.read(one["toml"])
    home = m.home
    joints = np.array(home.joints) + one["actuated_change_from_reference"]
    reached = m.following.follow(home, joints)
    assert reached.stop == "target"
    there = m.transform(reached.posture.pose, reached.posture.mode)
    assert there[:3, 3] == pytest.approx(np.array(one["position"]), abs=1e-8)
    assert there[:3, :3] == pytest.approx(np.array(one["rotation"]), abs=1e-10)
    found = m.motion.forward(
        reached.posture.pose,
        reached.posture.mode,
        one["joint_rates"],
        one["joint_accelerations"],
    )
    size = np.abs(one["velocity"]).max()
    assert found.twist[:3] == pytest.approx(np.array(one["omega"]), abs=1e-9)
    assert found.twist[3:] == pytest.approx(np.array(one["velocity"]), abs=1e-9 * size)
    size = np.abs(one["acceleration"]).max()
    assert found.twist_rate[3:] == pytest.approx(np.array(one["acceleration"]), abs=1e-5 * size)
    assert found.twist_rate[:3] == pytest.approx(np.array(one["alpha"]), abs=2e-5)


def test_a_singular_posture_has_its_cause() -> None:
    one = case("singular_rrr")
    m = kin.read(one["toml"])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = one["rotation"], one["position"]
    pose = m.pose_from_transform(matrix, m.home.mode)
    wanted = np.array(m.home.joints) + one["actuated_change_from_reference"]
    both = [(mode, m.posture(pose, mode)) for mode in m.modes]
    mode, posture = min(
        both,
        key=lambda each: float(
            np.abs(np.exp(1j * np.array(each[1].joints)) - np.exp(1j * wanted)).max()
        ),
    )
    assert np.exp(1j * np.array(posture.joints)) == pytest.approx(np.exp(1j * wanted), abs=1e-9)
    (found,) = m.singularities.at(m.posture(pose, mode))
    assert found.kind == one["kind"]
    assert "lie in one plane" in found.cause
    assert "(251.9, -37.2, 0.0) mm" in found.cause
    # A turn about the point where the lines meet; v is that of O′.
    twist, reference = np.array(found.twist), np.array(one["twist_omega_v_of_O"])
    cosine = twist @ reference / np.linalg.norm(twist) / np.linalg.norm(reference)
    assert abs(cosine) == pytest.approx(1.0, abs=1e-9)


def test_a_translational_three_upu_with_radial_axes_is_lost_at_its_reference() -> None:
    limb = {
        "type": "UPU",
        "base": [333.0, 0.0, 0.0],
        "platform": [200.0, 0.0, 0.0],
        "base_axis": [1.0, 0.0, 0.0],
        "platform_axis": [1.0, 0.0, 0.0],
        "stroke": [100.0, 800.0],
        "repeat": 3,
    }
    m = machine([limb], [0.0, 0.0, 400.0], coordinates=["x", "y", "z"])
    kinds = {found.kind for found in m.singularities.at(m.home)}
    assert "constraint" in kinds
    assert any("instantaneous" in finding.text for finding in m.findings)


def test_it_agrees_with_the_five_rpur_written_by_hand() -> None:
    limb = {
        "type": "RPUR",
        "base": [[-55, 30, 50], [245, 30, 50], [20, 205, 0], [200, 180, 0], [0, 0, 0]],
        "platform": [[-50, 0, 0], [50, 0, 0], [0, 50, 0], [0, 50, -50], [0, -50, -50]],
        "base_axis": [0, 1, 0],
        "platform_axis": [1, 0, 0],
        "link": 150,
        "stroke": [250, 400],
    }
    other, m = kin.open("rpur-table1"), machine([limb], [80, 90, 400], turn=[5, 8, 0])
    rng = np.random.default_rng(3)
    poses = np.array(other.home.pose) + rng.uniform(-1, 1, (20, 5)) * [20, 20, 20, 0.2, 0.2]
    assert np.array(m.modes).tolist() == np.array(other.modes).tolist()
    one, two = m.inverse(poses).joints, other.inverse(poses).joints
    np.testing.assert_allclose(one, two, rtol=0, atol=1e-9)
    for mode in ("+++++", "+-+-+"):
        rows, hand = (each.statics.at(poses, mode) for each in (m, other))
        sign = np.sign((rows.rows * hand.rows).sum(axis=-1))
        np.testing.assert_allclose(rows.rows * sign[..., None], hand.rows, atol=1e-9)
        np.testing.assert_allclose(rows.gain * sign[:, :5], hand.gain, atol=1e-10)
        rates = rng.normal(size=(20, 5))
        for key in ("twist", "twist_rate"):
            ways = [
                getattr(each.motion.forward(poses, mode, rates, rates), key) for each in (m, other)
            ]
            np.testing.assert_allclose(*ways, rtol=1e-7, atol=1e-7)


def test_it_agrees_with_the_four_sps_spr_written_by_hand() -> None:
    other = kin.open("sps-spr")
    table = other.table
    limbs = [
        {"type": "SPS", **{key: limb[key] for key in ("base", "platform", "stroke")}}
        for limb in table["limb"][:4]
    ]
    last = {key: table["limb"][4][key] for key in ("base", "platform", "stroke")}
    limbs.append({"type": "SPR", **last, "platform_axis": table["revolute_axis"]})
    home = other.transform(other.home.pose, "")
    m = machine(limbs, home[:3, 3].tolist(), rotation=home[:3, :3].tolist())
    assert np.array(m.home.joints) == pytest.approx(np.array(other.home.joints), abs=1e-9)
    rng = np.random.default_rng(1)
    joints = np.array(other.home.joints) + rng.normal(size=5) * 20
    one, two = m.forward(joints), other.forward(joints)
    assert (one.complex_count, one.complete, len(one)) == (two.complex_count, True, len(two))
    placed = [
        np.array([each.transform(p, mode) for p, mode in zip(f.poses, f.modes, strict=True)])
        for each, f in ((m, one), (other, two))
    ]
    off = np.abs(placed[0][:, None] - placed[1][None]).max(axis=(2, 3))
    assert off.min(axis=0).max() < 1e-7
    n = int(off[:, 0].argmin())
    lengths = np.array([m.length, other.length])
    rows = [
        each.mechanism.wrenches(where[k], f.modes[k]).rows
        for each, where, f, k in ((m, placed[0], one, n), (other, placed[1], two, 0))
    ]
    values = [np.linalg.svd(r / [1, 1, 1, *[lengths[1]] * 3], compute_uv=False) for r in rows]
    np.testing.assert_allclose(*values, rtol=1e-7)


def test_it_agrees_with_the_three_rps_written_by_hand() -> None:
    other = kin.open("rps-3")
    joints = [260.0, 300.0, 280.0]
    two = other.forward(joints)
    drawn = other.drawing(other.home)
    points = {mark.name: mark.position for mark in drawn.points}
    base = [points[f"limb{n}/A"] for n in (1, 2, 3)]
    home = other.transform(other.home.pose, other.home.mode)
    platform = [
        (home[:3, :3].T @ (np.array(points[f"limb{n}/B"]) - home[:3, 3])).tolist()
        for n in (1, 2, 3)
    ]
    axis = [np.cross([0, 0, 1], point).tolist() for point in base]
    limb = {"type": "RPS", "base": base, "platform": platform, "axis": axis, "stroke": [1, 2000]}
    m = machine([limb], home[:3, 3].tolist(), rotation=home[:3, :3].tolist())
    one = m.forward(joints)
    assert (one.complex_count, len(one)) == (two.complex_count, len(two))
    placed = [
        np.array([each.transform(p, mode) for p, mode in zip(f.poses, f.modes, strict=True)])
        for each, f in ((m, one), (other, two))
    ]
    off = np.abs(placed[0][:, None] - placed[1][None]).max(axis=(2, 3))
    assert off.min(axis=0).max() < 1e-6
