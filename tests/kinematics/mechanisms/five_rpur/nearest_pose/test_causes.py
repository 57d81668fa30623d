"""Ways out of a pose that cannot be held: each is tried, and none smaller does."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.answers.clearances import DesignChange
from kinematics.answers.solutions import Posture
from kinematics.designs.files import load_design
from kinematics.errors import DesignError
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.nearest_pose.projection import nearest
from tests.kinematics.mechanisms.five_rpur.machines import preset

MECHANISM = mechanism_class("five_rpur")
TABLES = ("rpur-table1", "rpur-table2", "rpur-a1a1")


def allows(design, wanted: Posture, way, share: float = 1.0) -> bool:
    try:
        for c in way:
            value = c.after if share == 1.0 else c.before + share * (c.after - c.before)
            design = machine_of(design).edited(c.path, value).design
    except DesignError:
        return False
    return machine_of(design).inverse.posture(wanted.pose, wanted.mode).reachable


def beyond(seed: int):
    rng = np.random.default_rng(seed)
    design = preset(TABLES[seed % 3])
    while True:
        pose = (*rng.uniform(-450, 450, 3).tolist(), *rng.uniform(-1, 1, 2).tolist())
        posture = machine_of(design).inverse.posture(pose, str(rng.choice(inverse.MODES)))
        if not posture.reachable and len(posture.reasons) <= 1 + seed % 3:
            return design, posture


@pytest.mark.slow
@settings(max_examples=20)
@given(st.integers(0, 10_000))
def test_every_way_works_and_half_of_it_does_not(seed):
    design, wanted = beyond(seed)
    remedy = machine_of(design).clearances.nearest_pose(wanted)
    assert remedy.changes
    at_fault = {r.limb for r in wanted.reasons}
    sums = []
    for way in remedy.changes:
        assert {int(c.path[1]) + 1 for c in way} == at_fault
        assert allows(design, wanted, way)
        assert not allows(design, wanted, way, 1.0 - 1e-5)
        for c in way:
            assert c.text.startswith(f"{c.label} from ")
            assert c.text.endswith(" mm")
            assert f"limb {int(c.path[1]) + 1}" in c.label
        sums.append(sum(abs(c.after - c.before) for c in way))
    assert sums == sorted(sums)
    there = remedy.nearest
    assert there is not None
    assert there.reachable
    assert remedy.distance == pytest.approx(
        float(np.linalg.norm(np.subtract(there.pose[:3], wanted.pose[:3]))), abs=1e-9
    )
    for mode in remedy.modes:
        assert machine_of(design).inverse.posture(wanted.pose, mode).reachable


@pytest.mark.slow
@settings(max_examples=8)
@given(st.integers(0, 10_000), st.sampled_from([1.0, 300.0, 300.0, 1e4, 1e9]))
def test_any_design_at_any_pose_has_an_answer(seed, far):
    rng = np.random.default_rng(seed)
    limbs = tuple(
        Limb(
            tuple(rng.uniform(-100, 100, 3).tolist()),
            tuple(rng.uniform(-60, 60, 3).tolist()),
            float(rng.uniform(80, 250)),
            (low := float(rng.choice([0.0, 200.0])), low + float(rng.uniform(30, 250))),
        )
        for _ in range(5)
    )
    design = FiveRPURDesign(limbs)
    pose = (*(far * rng.normal(size=3)).tolist(), *rng.uniform(-3.1, 3.1, 2).tolist())
    wanted = machine_of(design).inverse.posture(pose, str(rng.choice(inverse.MODES)))
    remedy = machine_of(design).clearances.nearest_pose(wanted)
    if remedy.nearest is None:
        assert remedy.distance == np.inf
    else:
        assert remedy.nearest.reachable
        away = np.linalg.norm(np.subtract(remedy.nearest.pose[:3], pose[:3]))
        assert remedy.distance == pytest.approx(float(away), rel=1e-9, abs=1e-9)
    assert remedy.changes or wanted.reachable or far > 1e4
    assert all(allows(design, wanted, way) for way in remedy.changes)


@pytest.mark.parametrize("seed", range(0, 18, 3))
def test_no_smaller_change_of_any_number_does(seed):
    """One limb at fault: every number of it tried from its value on, in steps."""
    design, wanted = beyond(seed)
    assert len(wanted.reasons) == 1
    limb = wanted.reasons[0].limb - 1
    changes = [
        way[0]
        for way in machine_of(design).clearances.nearest_pose(wanted).changes
        if len(way) == 1
    ]
    told = {c.path: abs(c.after - c.before) for c in changes}
    for field in machine_of(design).fields:
        if field.path[1] == limb:
            below = told.get(field.path, 500.0)
            for step in np.linspace(-below, below, 42)[1:-1]:
                step = DesignChange(field.path, "", field.value, field.value + step, "")
                assert not allows(design, wanted, (step,))


def test_the_text_names_a_value_that_does():
    seen = 0
    for seed in (0, 9, 18):
        design, wanted = beyond(seed)
        for way in machine_of(design).clearances.nearest_pose(wanted).changes:
            if "stroke" in way[0].path:
                shown = float(way[0].text.split(" to ")[1].removesuffix(" mm"))
                changed = machine_of(design).edited(way[0].path, shown).design
                assert machine_of(changed).inverse.posture(wanted.pose, wanted.mode).reachable
                seen += 1
    assert seen


def test_another_mode_where_this_one_has_no_place():
    design = load_design("rpur-table1")
    far = (0.0, 300.0, 600.0, 0.0, 0.0)
    found = {mode: nearest(design, far, mode) for mode in inverse.MODES}
    empty = [mode for mode in inverse.MODES if found[mode] is None]
    held = [f for f in found.values() if f is not None]
    assert len(empty) == 5  # one of the other 27 is too thin for a grid of 40³
    assert all(f.posture.reachable for f in held)
    remedy = machine_of(design).clearances.nearest_pose(
        machine_of(design).inverse.posture(far, empty[0])
    )
    assert remedy.nearest is not None
    assert remedy.nearest.mode not in empty
    assert remedy.nearest.pose[3:] == (0.0, 0.0)
    assert remedy.distance == pytest.approx(min(f.distance for f in held), abs=1e-9)
    assert "has no place at this orientation" in remedy.text


def test_another_orientation_where_no_mode_has_a_place():
    design = load_design("rpur-table1")
    wanted = machine_of(design).inverse.posture((50.0, 50.0, 300.0, np.pi, np.pi), "+-+-+")
    remedy = machine_of(design).clearances.nearest_pose(wanted)
    assert remedy.nearest is not None
    assert remedy.nearest.reachable
    assert remedy.nearest.mode == "+-+-+"
    assert remedy.error == np.inf
    assert "φ = " in remedy.text
    # No orientation within half the turn that was found has the place itself.
    turn = np.linspace(-0.15, 0.15, 31)
    near = np.stack(np.meshgrid(turn, turn), axis=-1).reshape(-1, 2) + np.pi
    poses = np.column_stack([np.tile(wanted.pose[:3], (len(near), 1)), near])
    assert not inverse.inside(design, poses, ["+-+-+"]).any()


def test_a_pose_that_can_be_held_needs_nothing():
    design = load_design("rpur-table2")
    home = machine_of(design).home
    remedy = machine_of(design).clearances.nearest_pose(home)
    assert remedy.nearest == home
    assert remedy.distance == 0.0
    assert remedy.changes == ()


def test_a_mode_that_comes_nearer_is_told():
    design = load_design("rpur-table1")
    pose = (300.0, 73.0, 500.0, 0.0, 0.0)
    found = machine_of(design).clearances.nearest_pose(
        machine_of(design).inverse.posture(pose, "+-+-+")
    )
    assert found.nearest.mode == "+-+-+"
    assert "working mode +++++ comes as near as 62.1 mm" in found.text
    nearer = machine_of(design).clearances.nearest_pose(
        machine_of(design).inverse.posture(pose, "+++++")
    )
    assert nearer.distance == pytest.approx(62.1, abs=0.05)
    assert "comes as near" not in nearer.text
    # No posture of any mode is nearer, as far as a shell of points about the pose tells.
    rng = np.random.default_rng(0)
    ray = rng.normal(size=(4000, 3))
    ray *= (
        0.999
        * nearer.distance
        * rng.random((4000, 1)) ** (1 / 3)
        / np.linalg.norm(ray, axis=1, keepdims=True)
    )
    about = np.column_stack([np.array(pose[:3]) + ray, np.zeros((4000, 2))])
    assert not machine_of(design).inverse(about).within_stroke.any()
