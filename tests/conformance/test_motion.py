"""Rates and accelerations are the slopes of postures; forces do no work in equilibrium."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kinematics as kin
from kinematics.answers.motion import Motion
from kinematics.arrays import Array
from tests.conformance.machines import ONE_EACH, PRESETS, STEP, held, machine, sizes


def moving(name: str, seed: int = 1) -> list[tuple[object, Motion]]:
    """Postures with a motion that the machine can make, about a millimetre a second."""
    m = machine(name)
    rng = np.random.default_rng(seed)
    answer = []
    for posture in held(name)[1:4]:
        joints = rng.normal(size=len(m.joints))
        joints *= [1.0 if axis.unit == "mm" else 1.0 / m.length for axis in m.joints]
        found = m.motion.forward(posture.pose, posture.mode, joints, 0.3 * joints)
        assert np.isfinite(found.pose_rates).all()
        answer.append((posture, found))
    return answer


def along(posture: object, motion: Motion, time: float) -> Array:
    """The pose after a time, to the second order."""
    pose: Array = np.array(posture.pose)  # type: ignore[attr-defined]
    return pose + time * motion.pose_rates + 0.5 * time**2 * motion.pose_accelerations


@pytest.mark.parametrize("name", PRESETS)
def test_joints_move_as_their_rates_and_accelerations_say(name: str) -> None:
    m = machine(name)
    for posture, motion in moving(name):
        mode = posture.mode  # type: ignore[attr-defined]
        before, now, after = (
            m.mechanism.joints(along(posture, motion, t), mode) for t in (-STEP, 0.0, STEP)
        )
        speed = float(np.abs(motion.joint_rates).max())
        rates = (after - before) / (2.0 * STEP)
        assert rates == pytest.approx(motion.joint_rates, abs=2e-5 * speed)
        second = (after - 2.0 * now + before) / STEP**2
        assert second == pytest.approx(motion.joint_accelerations, abs=2e-3 * speed)


@pytest.mark.parametrize("name", PRESETS)
def test_inverse_and_forward_motion_undo_each_other(name: str) -> None:
    m = machine(name)
    for posture, motion in moving(name):
        back = m.motion.inverse(
            posture.pose,  # type: ignore[attr-defined]
            posture.mode,  # type: ignore[attr-defined]
            motion.pose_rates,
            motion.pose_accelerations,
        )
        for key in ("joint_rates", "joint_accelerations", "twist", "twist_rate"):
            wanted = getattr(motion, key)
            scale = float(np.abs(wanted).max())
            assert getattr(back, key) == pytest.approx(wanted, abs=1e-7 * scale), key


@pytest.mark.parametrize("name", PRESETS)
def test_the_twist_is_that_of_the_platform(name: str) -> None:
    m = machine(name)
    for posture, motion in moving(name):
        mode = posture.mode  # type: ignore[attr-defined]
        before, now, after = (
            m.transform(along(posture, motion, t), mode) for t in (-STEP, 0.0, STEP)
        )
        slope = (after - before) / (2.0 * STEP)
        spin = slope[:3, :3] @ now[:3, :3].T
        omega = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
        size = float(np.abs(motion.twist * np.repeat([m.length, 1.0], 3)).max())
        assert m.length * omega == pytest.approx(m.length * motion.twist[:3], abs=1e-4 * size)
        assert slope[:3, 3] == pytest.approx(motion.twist[3:], abs=1e-4 * size)


@pytest.mark.parametrize("name", PRESETS)
def test_virtual_work_vanishes(name: str) -> None:
    m = machine(name)
    rng = np.random.default_rng(2)
    for posture, motion in moving(name):
        # A load that the wrenches can hold: nothing holds what the mechanism never moves.
        rows = m.statics.wrenches(posture.pose, posture.mode).rows  # type: ignore[attr-defined]
        pushed = rng.normal(size=len(rows)) * np.linalg.norm(rows, axis=1) ** -1
        load = -pushed @ rows
        held_by = m.statics.forces(posture.pose, posture.mode, load)  # type: ignore[attr-defined]
        assert held_by.residual < 1e-9
        acting = [name.kind == "actuation" for name in held_by.names]
        work = float(held_by.forces[acting] @ motion.joint_rates)
        work += float(load[:3] @ motion.twist[3:] + load[3:] @ motion.twist[:3])
        size = float(np.abs(held_by.forces[acting] * motion.joint_rates).max())
        assert abs(work) < 1e-8 * max(size, 1.0)


@pytest.mark.parametrize("name", PRESETS)
def test_measures_are_numbers_within_their_limits(name: str) -> None:
    m = machine(name)
    assert m.measures.specs
    for spec in m.measures.specs:
        load = [1.0, -2.0, 0.0, 0.0, 0.0, 30.0] if spec.needs_load else None
        poses = [posture.pose for posture in held(name)]
        values = m.measures(poses, m.home.mode, spec.key, load)
        assert values.shape == (len(poses),)
        assert np.isfinite(values).all()
        low, high = spec.limits
        assert low is None or (values >= low - 1e-12).all()
        assert high is None or (values <= high + 1e-12).all()


@pytest.mark.parametrize("name", PRESETS)
def test_a_straight_trajectory_between_held_postures_is_sound(name: str) -> None:
    m = machine(name)
    end = np.array(held(name, spread=4.0)[1].pose)
    found = m.trajectory([m.home.pose, end], duration=1.0, samples=11, distances=False)
    assert found.joints.shape == (11, len(m.joints))
    assert found.sound, [event.text for event in found.events]
    assert found.joints[0] == pytest.approx(m.home.joints, abs=1e-9)
    step = np.linalg.norm((end - m.home.pose) / sizes(m))
    assert found.length == pytest.approx(step, rel=1e-6)


@pytest.mark.parametrize("name", ONE_EACH)
def test_a_path_is_read_from_a_file_or_told_why_not(name: str, tmp_path: Path) -> None:
    m = machine(name)
    rows = [m.at(posture).pose.to_dict() for posture in (m.home, held(name, spread=4.0)[1])]
    file = tmp_path / "way.csv"
    lines = [";".join(rows[0]), *(";".join(map(repr, row.values())) for row in rows)]
    file.write_text("\n".join(lines), encoding="utf-8")
    found = m.trajectory(file, samples=5, distances=False)
    assert found.poses[-1] == pytest.approx(held(name, spread=4.0)[1].pose, abs=1e-9)
    with pytest.raises(kin.InputError, match="no file"):
        m.trajectory("nowhere.csv")
