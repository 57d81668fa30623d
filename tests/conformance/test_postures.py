"""Inverse and forward kinematics undo each other; margins say where poses cease to exist."""

from __future__ import annotations

import numpy as np
import pytest

import kinematics as kin
from tests.conformance.machines import ONE_EACH, PRESETS, apart, held, machine, sizes


@pytest.mark.parametrize("name", PRESETS)
def test_home_can_be_held_and_moved_from(name: str) -> None:
    m = machine(name)
    home = m.home
    assert home.reachable
    assert home.residual < 1e-9 * m.length
    middle = [0.5 * (low.lower + low.upper) for low in m.joints]
    toward = np.array(home.joints) + 0.02 * (np.array(middle) - home.joints)
    moved = m.following.follow(home, toward)
    assert moved.stop == "target"
    assert moved.posture.joints == pytest.approx(toward.tolist(), abs=1e-7)


@pytest.mark.parametrize("name", PRESETS)
def test_a_pose_is_among_the_solutions_for_its_joints(name: str) -> None:
    m = machine(name)
    for posture in held(name, 2):
        solutions = m.forward(posture.joints)
        assert solutions.complete, solutions.evidence
        same = [s for s in solutions if s.mode == posture.mode]
        near = min(same, key=lambda s: apart(m, s.pose, s.mode, posture))
        assert apart(m, near.pose, near.mode, posture) < 1e-6 * m.length
        assert near.within_stroke


@pytest.mark.parametrize("name", ONE_EACH)
def test_every_solution_has_the_joints_it_was_solved_for(name: str) -> None:
    m = machine(name)
    (found,) = m.forward([held(name)[1].joints])
    assert len(found) == len(found.modes) > 0
    for solution in found:
        posture = m.inverse.posture(solution.pose, solution.mode, known=found.joints)
        assert posture.closes
        wanted = np.array(found.joints)
        turned = np.array([axis.unit == "rad" for axis in m.joints])
        off = np.where(turned, np.sin(0.5 * (posture.joints - wanted)), posture.joints - wanted)
        assert np.abs(off).max() < 1e-6 * m.length
        assert posture.residual < 1e-6 * m.length


@pytest.mark.parametrize("name", PRESETS)
def test_a_batch_is_its_single_poses(name: str) -> None:
    m = machine(name)
    poses = np.array([posture.pose for posture in held(name)])
    answer = m.inverse(poses)
    assert answer.joints.shape == (len(poses), len(m.modes), len(m.joints))
    n = m.modes.index(m.home.mode)
    for row, posture in enumerate(held(name)):
        assert answer.joints[row, n] == pytest.approx(posture.joints, abs=1e-9)
        assert answer.within_stroke[row, n]
    assert m.inverse.inside(poses, (m.home.mode,)).all()
    assert m.inverse.inside(poses).all()
    assert m.inverse(poses[:0]).joints.shape[0] == 0


@pytest.mark.parametrize("name", ONE_EACH)
def test_margins_change_sign_where_poses_cease_to_exist(name: str) -> None:
    m, start = machine(name), np.array(machine(name).home.pose)
    rng = np.random.default_rng(3)
    reach = max(axis.upper - axis.lower for axis in m.coordinates if axis.unit == "mm")
    crossed = 0
    for _ in range(8):
        way = rng.normal(size=len(start)) * sizes(m)
        low, high = 0.0, 3.0 * reach

        def at(share: float, way: np.ndarray = way) -> object:
            wanted = tuple((start + share * way / np.linalg.norm(way / sizes(m))).tolist())
            try:
                return m.posture(m.complete_pose(wanted, m.home.mode), m.home.mode)
            except kin.InputError:
                return None

        if at(high) is None or at(high).reachable:  # type: ignore[attr-defined]
            continue
        for _ in range(60):
            middle = 0.5 * (low + high)
            posture = at(middle)
            if posture is not None and posture.reachable:  # type: ignore[attr-defined]
                low = middle
            else:
                high = middle
        inside, beyond = at(low), at(high)
        if beyond is None:
            continue
        crossed += 1
        assert all(margin.amount >= -1e-8 for margin in inside.margins)  # type: ignore[attr-defined]
        assert inside.nearest.amount == pytest.approx(0.0, abs=1e-5)  # type: ignore[attr-defined]
        assert beyond.reasons  # type: ignore[attr-defined]
        named = {(reason.limb, str(reason.bound)) for reason in beyond.reasons}  # type: ignore[attr-defined]
        touched = {
            (margin.limb, str(margin.bound))
            for margin in inside.margins  # type: ignore[attr-defined]
            if margin.amount < 1e-5
        }
        assert named & touched
        assert all(reason.amount > 0.0 for reason in beyond.reasons)  # type: ignore[attr-defined]
    assert crossed >= 2


@pytest.mark.parametrize("name", ONE_EACH)
def test_a_posture_its_margins_and_the_batch_agree_everywhere(name: str) -> None:
    m = machine(name)
    rng = np.random.default_rng(5)
    low = np.array([axis.lower for axis in m.coordinates])
    high = np.array([axis.upper for axis in m.coordinates])
    poses = low + (high - low) * rng.uniform(size=(60, len(low)))
    answer = m.inverse(poses)
    reasons = 0
    for n, mode in enumerate(m.modes[:4]):
        inside = m.inverse.inside(poses, (mode,))
        assert (inside == answer.within_stroke[:, n]).all()
        for row, pose in enumerate(poses):
            posture = m.posture(pose, mode)
            assert posture.reachable == bool(inside[row])
            beyond = [margin for margin in posture.margins if margin.amount < -1e-6]
            assert posture.reachable or beyond
            for reason in posture.reasons:
                reasons += 1
                assert reason.text
                assert reason.bound in m.mechanism.bounds
                assert reason.limb == reason.bound.limb
    assert reasons > 0


@pytest.mark.parametrize("name", ONE_EACH)
def test_what_is_no_pose_or_no_mode_is_refused_in_a_sentence(name: str) -> None:
    m = machine(name)
    for wrong in (m.home.pose[:-1], [float("nan")] * len(m.coordinates), ["a"] * 3):
        with pytest.raises(kin.InputError):
            m.inverse(wrong)
        with pytest.raises(kin.InputError):
            m.at(wrong)
    with pytest.raises(kin.InputError):
        m.at(m.home.pose, "no mode")
    with pytest.raises(kin.InputError):
        m.forward([1.0] * (len(m.joints) + 1))
    with pytest.raises(kin.InputError, match="no coordinate 'nothing'"):
        m.pose(nothing=1.0)


@pytest.mark.parametrize(("name", "part"), [("sps-spr", 0.6), ("rps-3", 0.6), ("rps-3", 1.5)])
def test_the_stroke_that_would_allow_a_pose_is_told(name: str, part: float) -> None:
    m = machine(name)
    z = next(n for n, c in enumerate(m.coordinates) if c.key == "z")
    pose = [v * part if n == z else v for n, v in enumerate(m.home.pose)]
    at = m.inverse.posture(pose, m.home.mode)
    assert not at.reachable
    assert all(reason.amount > 0.0 for reason in at.reasons)
    ways = m.clearances.nearest_pose(at).changes
    assert ways
    for way in ways:
        changed = m
        for each in way:
            changed = changed.edited(each.path, each.after)
        assert changed.inverse.posture(pose, m.home.mode).reachable
        beyond = [abs(each.after - each.before) for each in way]
        assert max(beyond) == pytest.approx(max(r.amount for r in at.reasons), rel=1e-9)


@pytest.mark.parametrize("name", ONE_EACH)
def test_lengths_of_nothing_or_less_are_refused_and_angles_are_not(name: str) -> None:
    m = machine(name)
    for joints in ([-1.0 for _ in m.joints], [0.0, *m.home.joints[1:]]):
        if all(c.unit == "mm" and not c.signed for c in m.joints):
            with pytest.raises(kin.InputError, match="must be positive"):
                m.forward(joints)
        else:
            m.forward(joints)
