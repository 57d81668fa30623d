"""Inverse and forward kinematics: the reference, round trips, degenerate places."""

from __future__ import annotations

from math import atan, degrees, radians, sqrt
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.errors import InputError
from kinematics.facets import inverse as generic
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.five_bar import forward, inverse
from kinematics.mechanisms.five_bar.design import FiveBarDesign, Limb
from kinematics.mechanisms.five_bar.statics import jacobians, sines
from tests.kinematics.mechanisms.five_bar.conftest import EMPTY, MACHINES, PAPER, RANGED, UNLIKE

M = mechanism_class("five_bar")
lengths = st.floats(50.0, 500.0)


def test_the_reference(reference: dict[str, Any]) -> None:
    for case in reference["ik_fk"]:
        p = 10.0 * np.array(case["p"])
        answer = generic.inverse(PAPER, p)
        for n, mode in enumerate(answer.modes):
            wanted = case["ik"][mode]
            np.testing.assert_allclose(answer.joints[n], wanted["theta"], atol=1e-13)
            a, b = jacobians(PAPER, p, answer.joints[n])
            a, b = a.prod(), np.linalg.det(b)
            assert a / 1e4 == pytest.approx(wanted["detA"], rel=1e-13)
            assert b / 1e2 == pytest.approx(wanted["detB"], rel=1e-13)
            both = forward.both_points(PAPER, answer.joints[n]) / 10.0
            np.testing.assert_allclose(both, [wanted["fk_up"], wanted["fk_down"]], atol=1e-12)


@pytest.mark.parametrize("point", [(0.0, 738.644), (100.0, -500.0), (-300.0, 20.0), (30.0, 400.0)])
def test_signs_are_those_of_the_roots_of_equation_7(point: tuple[float, float]) -> None:
    x, y = point
    for mode in inverse.MODES:
        joints = inverse.joints_of(PAPER, point, mode)
        for i, shift in enumerate((240.0, -240.0)):
            square = 480.0**2 + y**2 + (x + shift) ** 2 - 480.0**2
            a, b, c = (
                square + 2 * (x + shift) * 480.0,
                -4 * y * 480.0,
                square - 2 * (x + shift) * 480.0,
            )
            sign = 1.0 if mode[i] == "+" else -1.0
            theta = 2.0 * atan((-b + sign * sqrt(b * b - 4 * a * c)) / (2 * a))
            assert np.sin(joints[i] - theta) == pytest.approx(0.0, abs=1e-12)
            assert np.cos(joints[i] - theta) == pytest.approx(1.0)


@pytest.mark.parametrize("name", MACHINES)
def test_forward_undoes_inverse(name: str) -> None:
    design = MACHINES[name]
    rng = np.random.default_rng(5)
    reach = float((design.proximal + design.distal).max()) + design.half_base
    p = rng.uniform(-reach, reach, (20000, 2))
    answer = generic.inverse(design, p)
    for n, mode in enumerate(answer.modes):
        ok = np.isfinite(answer.joints[:, n]).all(axis=-1)
        joints = answer.joints[ok, n]
        both = forward.both_points(design, joints)
        apart = np.linalg.norm(both - p[ok, None, :], axis=-1).min(axis=-1)
        # Near a parallel singularity P is only as sure as rounding of the angles allows.
        well = np.abs(sines(design, p[ok], joints)[1]) > 0.05
        assert apart[well].max() < 1e-11 * design.size / 10
        assert inverse.mode_of(design, p[ok], joints) == [mode] * int(ok.sum())
    assert np.nanmax(answer.residual) < 1e-12 * design.size
    inside = generic.inside(design, p)
    np.testing.assert_array_equal(inside, answer.within_stroke.any(axis=1))


@settings(max_examples=60)
@given(lengths, lengths, lengths, lengths, lengths, st.floats(-3.1, 3.1), st.floats(-3.1, 3.1))
def test_every_solution_closes_and_there_are_two(
    a: float, b: float, c: float, d: float, r: float, q1: float, q2: float
) -> None:
    design = FiveBarDesign((Limb(a, b), Limb(c, d)), r)
    found = machine_of(design).forward([q1, q2])
    assert found.complex_count == 2
    assert found.complete
    assert len(found) in (0, 1, 2)
    assert int(found.multiplicity.sum()) in (0, 2)
    elbows = inverse.elbows(design, [q1, q2])
    for point in found.roots:  # complex ones satisfy the equations too
        left = ((point - elbows) ** 2).sum(axis=-1) - design.distal**2
        assert np.abs(left).max() < 1e-6 * design.size**2
    assert (found.residual < 1e-7 * design.size).all()
    for n in range(len(found)):
        posture = machine_of(design).inverse.posture(found.poses[n], found.modes[n])
        # On a base itself its limb may point anywhere.
        away = np.linalg.norm(found.poses[n] - [[-r, 0.0], [r, 0.0]], axis=-1).min()
        if found.condition[n] < 1e3 and away > 1e-6 * design.size:
            turn = np.array(posture.joints) - [q1, q2]
            assert np.abs(np.sin(0.5 * turn)).max() < 1e-9


def test_forward_where_the_circles_touch_and_where_they_coincide() -> None:
    # B_1 and B_2 at (∓480, 0): the distal links reach each other stretched out.
    flat = FiveBarDesign((Limb(240.0, 480.0), Limb(240.0, 480.0)), 240.0)
    touching = machine_of(flat).forward([np.pi, 0.0])
    assert len(touching) == 1
    assert touching.multiplicity.tolist() == [2]
    assert np.isinf(touching.condition[0])
    np.testing.assert_allclose(touching.poses[0], [0.0, 0.0], atol=1e-9)
    together = machine_of(PAPER).forward([np.pi / 3, 2 * np.pi / 3])
    assert len(together.self_motions) == 1
    assert not together.complete
    unlike = FiveBarDesign((Limb(480.0, 400.0), Limb(480.0, 300.0)), 240.0)
    none = machine_of(unlike).forward([np.pi / 3, 2 * np.pi / 3])
    assert len(none) == 0
    assert none.complex_count == 0
    apart = machine_of(EMPTY).forward([np.pi, 0.0])
    assert len(apart) == 0
    assert "further apart" in apart.notes[0]
    assert apart.complex_count == 2


def test_a_point_on_a_base_joint_closes() -> None:
    answer = generic.inverse(PAPER, [-240.0, 0.0])
    assert np.isfinite(answer.joints).all()
    assert answer.residual < 1e-12


def test_reasons_name_limb_bound_and_amount() -> None:
    far = machine_of(PAPER).inverse.posture((0.0, 1000.0), "+-")
    assert [reason.limb for reason in far.reasons] == [1, 2]
    assert far.reasons[0].amount == pytest.approx(np.hypot(240.0, 1000.0) - 960.0)
    assert not far.closes
    near = machine_of(UNLIKE).inverse.posture((-240.0, 100.0), "+-")
    assert near.reasons[0].bound == "link"
    assert "too near the base of limb 1" in near.reasons[0].text
    turned = machine_of(RANGED).inverse.posture((-100.0, 300.0), "-+")
    assert turned.closes
    (reason,) = turned.reasons
    assert reason.unit == "rad"
    angle = turned.joints[0]
    assert reason.amount == pytest.approx(radians(-30.0) - angle)
    assert "below its range" in reason.text


def test_angles_stay_near_the_middle_of_their_range() -> None:
    design = FiveBarDesign((Limb(480.0, 480.0, (100.0, 300.0)), Limb(480.0, 480.0)), 240.0)
    joints = inverse.joints_of(design, [-500.0, 300.0], "+-")
    assert 100.0 <= degrees(joints[0]) <= 300.0 + 80.0
    free = inverse.joints_of(PAPER, [-500.0, 300.0], "+-")
    assert np.cos(joints[0] - free[0]) == pytest.approx(1.0)


@pytest.mark.parametrize("pose", [(1.0,), (1.0, np.nan), (1.0, 2.0, 3.0), ("a", 1.0)])
def test_broken_poses(pose: Any) -> None:
    with pytest.raises(InputError):
        generic.inverse(PAPER, pose)
    with pytest.raises(InputError, match="working mode"):
        generic.posture(PAPER, (0.0, 700.0), "+")


def test_transforms_lie_in_the_plane() -> None:
    matrix = machine_of(PAPER).transform([[3.0, 4.0], [5.0, 6.0]], "+-")
    np.testing.assert_allclose(matrix[1][:3, 3], [5.0, 6.0, 0.0])
    assert machine_of(PAPER).pose_from_transform(matrix[0], "+-") == (3.0, 4.0)


# --- identities ----------------------------------------------------------------------------


def test_identities_stay_with_their_side_and_merge_at_the_fold() -> None:
    before = machine_of(PAPER).forward([1.9, 1.2])
    moved = machine_of(PAPER).forward.refresh(before, [1.95, 1.1])
    assert moved.solutions.identities == before.identities
    assert not moved.appeared
    assert not moved.merged
    np.testing.assert_array_equal(np.sign(moved.solutions.determinant), [1.0, -1.0])
    gone = machine_of(PAPER).forward.refresh(moved.solutions, [3.1, 0.0])
    assert len(gone.solutions) == 0
    assert {(m.identity, m.partner) for m in gone.merged} == {(0, 1), (1, 0)}
    back = machine_of(PAPER).forward.refresh(gone.solutions, [1.9, 1.2])
    assert len(back.appeared) == 2
