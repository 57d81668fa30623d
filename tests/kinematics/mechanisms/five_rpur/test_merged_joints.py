"""Limbs that share a merged U joint: what the design file says, and that every answer obeys it."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from kinematics.designs.files import read_design, write_design
from kinematics.errors import DesignError, InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.design import MODES, FiveRPURDesign
from kinematics.mechanisms.five_rpur.findings import findings, singular_modes
from kinematics.mechanisms.five_rpur.inverse import inside, inverse, limb_lengths
from tests.kinematics.mechanisms.five_rpur.machines import preset

A1A1 = preset("rpur-a1a1", merged=True)
APART = replace(A1A1, merged_joints=())
TIED = [m for m in MODES if m[0] == m[1] and m[2] == m[3]]


def text(said: str, name: str = "rpur-a1a1") -> str:
    plain = write_design(preset(name))
    return plain.replace("\n\n[[limb]]", f"\n{said}\n\n[[limb]]", 1)


def read(said: str, name: str = "rpur-a1a1") -> FiveRPURDesign:
    design = read_design(text(said, name), origin="mine.toml")
    assert isinstance(design, FiveRPURDesign)
    return design


# --- the design file -------------------------------------------------------------------------


def test_the_presets_merge_what_the_paper_merges() -> None:
    """Of the arrangements only A1 has one place for both U joints; Table 2 prints no joints."""
    merged = {
        name: preset(f"rpur-{name}", merged=True).merged_joints
        for name in ("a1a1", "a1a2", "a1a3", "a2a2", "a2a3", "a3a3", "mpa1", "mpa2", "mpa3")
    }
    assert {name: limbs for name, limbs in merged.items() if limbs} == {
        "a1a1": ((1, 2), (3, 4)),
        "a1a2": ((1, 2),),
        "a1a3": ((1, 2),),
        "mpa1": ((1, 2),),
    }
    for name in ("rpur-table1", "rpur-table1-icee", "rpur-table2"):
        assert preset(name, merged=True).merged_joints == ()
        assert preset(name, merged=True).modes == MODES


def test_it_is_read_and_written() -> None:
    assert read("merged_joints = [[1, 2], [4, 3]]").merged_joints == ((1, 2), (3, 4))
    assert read("merged_joints = []").merged_joints == ()
    assert "merged_joints" not in write_design(APART)
    again = read_design(write_design(A1A1), origin="", name=A1A1.name)
    assert again == A1A1
    three = [replace(limb, platform=A1A1.limbs[0].platform) for limb in A1A1.limbs[:3]]
    three[2] = replace(three[2], base=(7.0, three[0].base[1], 50.0))
    one = replace(A1A1, limbs=(*three, *A1A1.limbs[3:]), merged_joints=((1, 2, 3),))
    assert read_design(write_design(one), origin="", name=one.name) == one
    assert len(one.modes) == 8


@pytest.mark.parametrize(
    ("said", "fragments"),
    [
        ("merged_joints = 1", ["a list of lists of two limbs or more"]),
        ("merged_joints = [1, 2]", ["a list of lists", "as merged_joints = [[1, 2], [3, 4]]"]),
        ("merged_joints = [[1]]", ["two limbs or more"]),
        ("merged_joints = [[1, 6]]", ["1 to 5"]),
        ("merged_joints = [[0, 1]]", ["1 to 5"]),
        ("merged_joints = [[1, 2.0]]", ["a list of lists"]),
        ("merged_joints = [[true, 2]]", ["a list of lists"]),
        ("merged_joints = [[1, 2], [2, 3]]", ["limb 2 is named twice"]),
        ("merged_joints = [[1, 1]]", ["limb 1 is named twice"]),
        ("merged_joints = [[1, 5]]", ["limbs 1 and 5 cannot share a U joint", "mm apart", "in y"]),
        ("merged_joint = [[1, 2]]", ["did you mean 'merged_joints'?"]),
    ],
)
def test_what_is_no_merged_joint_is_refused_in_a_sentence(said: str, fragments: list[str]) -> None:
    with pytest.raises(DesignError) as refused:
        read(said)
    message = str(refused.value)
    assert message.startswith("mine.toml, line 4: ")
    for fragment in fragments:
        assert fragment in message


@pytest.mark.parametrize("name", ["rpur-a2a2", "rpur-a3a3", "rpur-mpa3", "rpur-table1"])
def test_other_arrangements_have_two_u_joints(name: str) -> None:
    with pytest.raises(DesignError, match=r"limbs 1 and 2 cannot share a U joint: their platform "):
        read("merged_joints = [[1, 2]]", name)


def test_limbs_must_agree_to_a_billionth_of_the_machine() -> None:
    def moved(by: float) -> str:
        limbs = list(A1A1.limbs)
        limbs[1] = replace(limbs[1], link=limbs[1].link + by)
        return write_design(replace(A1A1, limbs=tuple(limbs)))

    assert read_design(moved(1e-8), origin="").merged_joints == A1A1.merged_joints
    with pytest.raises(DesignError, match="their links differ by 1e-06 mm"):
        read_design(moved(1e-6), origin="")


def test_what_merged_limbs_have_in_common_is_one_number() -> None:
    machine = machine_of(A1A1)
    assert len(machine.fields) == 45
    for field in machine.fields:
        kind, limb, *place = field.path
        changed = machine.mechanism.edited(field.path, field.value + 0.5)
        values = {f.path: f.value for f in machine_of(changed).fields}
        shared = place[0] in ("platform", "link") or place == ["base", 1]
        partner = {0: 1, 1: 0, 2: 3, 3: 2}.get(int(limb)) if shared else None
        touched = {field.path} | ({(kind, partner, *place)} if partner is not None else set())
        assert {p for p, v in values.items() if v == field.value + 0.5} >= touched
        assert {f.path for f in machine.fields if values[f.path] != f.value} == touched
        assert changed.merged_joints == A1A1.merged_joints


def test_it_is_said_what_is_merged_and_what_could_be() -> None:
    said = [f.text for f in findings(A1A1)]
    assert any("Limbs 1 and 2 share one U joint" in text and "has 8" in text for text in said)
    assert not any("add merged_joints" in text for text in said)
    said = [f.text for f in findings(APART)]
    assert any("add merged_joints = [[3, 4]] to the design file" in text for text in said)
    assert not any("merged_joints" in f.text for f in findings(preset("rpur-a3a3")))
    assert set(singular_modes(A1A1)) <= set(TIED)


# --- every answer obeys it -------------------------------------------------------------------


def poses_near_home(count: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    spread = rng.normal(size=(count, 5)) * (60.0, 40.0, 120.0, 0.4, 0.4)
    return np.array(machine_of(A1A1).home.pose) * (1.0, 1.0, 0.0, 1.0, 1.0) + spread


def test_inverse_kinematics_has_the_modes_that_exist_and_no_other() -> None:
    assert [*A1A1.modes] == TIED
    poses = poses_near_home(300, 1)
    some, every = inverse(A1A1, poses), inverse(APART, poses)
    assert some.modes == tuple(TIED)
    there = [MODES.index(mode) for mode in TIED]
    np.testing.assert_array_equal(some.joints, every.joints[:, there])
    np.testing.assert_array_equal(some.within_stroke, every.within_stroke[:, there])
    held = some.within_stroke.any(axis=1)
    np.testing.assert_array_equal(inside(A1A1, poses), held)
    assert 0 < held.sum() < every.within_stroke.any(axis=1).sum()
    np.testing.assert_array_equal(inside(A1A1, poses, TIED[2:3]), some.within_stroke[:, 2])


def test_a_mode_that_does_not_exist_is_refused_with_its_reason() -> None:
    machine = machine_of(A1A1)
    pose = machine.home.pose
    why = r"no working mode \+-\+\+\+: limbs 1 and 2 share a U joint"
    assert machine.modes == A1A1.modes
    for ask in (
        lambda: machine.inverse.posture(pose, "+-+++"),
        lambda: machine.inverse.inside(pose, ("+-+++",)),
        lambda: machine.statics.wrenches(pose, "+-+++"),
        lambda: machine.sections.volume(pose, ("+-+++",)),
        lambda: machine.sections.at(pose, ("+++++", "+-+++"), 0.0),
        lambda: machine.sections.ball(pose, ("+-+++",)),
        lambda: machine.sections.singularity_free_ball(pose, "+-+++"),
        lambda: machine.solids.request("workspace", pose, ("+-+++",), "preview"),
        lambda: machine.solids.request("aspects", pose, ("+-+++",), "preview"),
    ):
        with pytest.raises(InputError, match=why):
            ask()


@pytest.mark.parametrize("angles", [(0.0, 0.0), (0.3, -0.2)])
def test_workspaces_of_all_modes_are_of_those_that_exist(angles: tuple[float, float]) -> None:
    some, every = machine_of(A1A1), machine_of(APART)
    pose = (0.0, 0.0, 0.0, *angles)
    value = some.sections.volume(pose, None, relative=1e-5, pieces=False).value
    named = every.sections.volume(pose, tuple(TIED), relative=1e-5, pieces=False).value
    whole = every.sections.volume(pose, None, relative=1e-5, pieces=False).value
    assert value == pytest.approx(named, rel=1e-9)
    assert value < 0.9 * whole
    assert some.sections.at(pose, None, -30.0).area == pytest.approx(
        every.sections.at(pose, tuple(TIED), -30.0).area, rel=1e-12
    )
    request = some.solids.request("workspace", pose, None, "preview")
    assert request == every.solids.request("workspace", pose, tuple(TIED), "preview")
    ball, same = some.sections.ball(pose, None), every.sections.ball(pose, tuple(TIED))
    assert ball is not None
    assert same is not None
    assert ball.radius == pytest.approx(same.radius, rel=1e-9)
    (cell,) = some.maps.cells([pose], None, ["volume"]).values[0]
    assert cell == pytest.approx(value, rel=1e-3)


def test_the_way_out_of_a_pose_leads_to_a_mode_that_exists() -> None:
    machine = machine_of(A1A1)
    told = 0
    away = np.array((0.0, 150.0, 0.0, 0.0, 0.0))
    for pose, mode in product(poses_near_home(6, 7) + away, TIED[::3]):
        posture = machine.inverse.posture(pose, mode)
        if posture.reachable:
            continue
        remedy = machine.clearances.nearest_pose(posture)
        assert set(remedy.modes) <= set(TIED)
        if remedy.nearest is not None:
            told += 1
            assert remedy.nearest.mode in TIED
            assert remedy.nearest.reachable
    assert told > 3
    assert machine.home.mode in TIED


def test_merged_limbs_pass_into_the_other_mode_together() -> None:
    machine = machine_of(A1A1)
    rng = np.random.default_rng(0)
    passed = 0
    for _ in range(4000):
        mode = str(rng.choice(TIED))
        pose = np.append(rng.uniform((-80, -80, -350), (80, 160, 350)), rng.uniform(-0.8, 0.8, 2))
        posture = machine.inverse.posture(pose, mode)
        room = [m.amount for m in posture.margins if m.bound.end == "link" and m.limb < 5]
        if not posture.closes or min(room) > 4.0:
            continue
        found = machine.following.follow(
            posture, np.array(posture.joints) + rng.uniform(-40, 40, 5)
        )
        assert found.posture.mode in TIED
        if found.posture.mode[:4] != mode[:4]:
            passed += 1
            both = limb_lengths(A1A1, found.posture.pose)
            signs = [0 if sign == "+" else 1 for sign in found.posture.mode]
            np.testing.assert_allclose(
                [both[i, s] for i, s in enumerate(signs)], found.posture.joints, atol=1e-8
            )
        if passed > 3:
            break
    assert passed > 3
