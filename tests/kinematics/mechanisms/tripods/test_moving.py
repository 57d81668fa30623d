"""Moving by limb lengths and along poses: no branch is left, and no operation mode unnoticed."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.designs.files import load_design
from kinematics.facets import inverse as generic
from kinematics.facets.segments import Segment
from kinematics.machine import machine_of
from kinematics.mechanisms.tripods.design import KINDS, MODES, Kind, TripodDesign
from kinematics.mechanisms.tripods.limbs import joint_points, limb_lengths
from tests.kinematics.mechanisms.tripods.machines import machine, some_machines, some_poses


def test_a_followed_motion_ends_on_its_own_assembly_mode(rng: np.random.Generator) -> None:
    targets = 0
    for design in some_machines(rng, 30):
        mode = MODES[int(rng.integers(2))]
        here = generic.posture(design, some_poses(rng, 1)[0], mode)
        goal = np.abs(np.array(here.joints) + rng.uniform(-60.0, 60.0, 3)) + 1.0
        found = machine_of(design).following.follow(here, goal)
        there = found.posture
        assert there.mode == mode
        size = 1.0 + max(there.joints)
        lengths = limb_lengths(design, np.array(there.pose), mode)
        np.testing.assert_allclose(lengths, there.joints, atol=1e-8 * size)
        if found.stop != "target":
            continue
        targets += 1
        # The full sets, matched on their own way along the same line, say the same.
        before = machine_of(design).forward(here.joints)
        after = machine_of(design).forward.refresh(before, there.joints).solutions
        start, end = (
            machine_of(design)
            .forward.distances(np.array([p.pose]), (mode,), s.poses, s.modes)
            .argmin()
            for p, s in ((here, before), (there, after))
        )
        assert before.identities[int(start)] == after.identities[int(end)]
    assert targets > 8


@pytest.mark.parametrize("kind", KINDS)
def test_a_motion_stops_where_the_operation_modes_meet(kind: Kind) -> None:
    """Through a tilt of 180°: it stops there exactly, and goes on in either mode."""
    design = TripodDesign(kind, 100.0, 160.0, (1.0, 2000.0))
    poses = [(150.0, tilt, 0.4) for tilt in (np.pi - 0.05, np.pi, np.pi - 0.05)]
    here, meet, _ = (generic.posture(design, pose, "2") for pose in poses)
    beyond = 2.0 * np.array(meet.joints) - np.array(here.joints)
    found = machine_of(design).following.follow(here, beyond)
    assert found.stop == "singularity"
    assert "constraint singularity" in found.text
    assert found.posture.pose[1] == np.pi
    assert found.fraction == pytest.approx(0.5, abs=0.05)
    change = machine_of(design).singularities.mode_change(found.posture)
    assert change is not None
    assert change.here
    for start in (change.at, change.other):
        aside = generic.posture(
            design, (start.pose[0] + 3.0, np.pi - 0.02, start.pose[2]), start.mode
        )
        on = machine_of(design).following.follow(start, aside.joints)
        assert on.posture.mode == start.mode
        assert on.stop == "target" or on.fraction > 0.0


def test_a_motion_stops_at_a_fold_and_at_a_stroke() -> None:
    design = load_design("spr-3")
    home = machine_of(design).home
    low, high = design.stroke
    stroke = machine_of(design).following.follow(home, [high + 50.0] * 3)
    assert stroke.stop == "stroke"
    assert stroke.posture.joints == pytest.approx((high,) * 3)
    wide = TripodDesign("three_spr", 100.0, 200.0, (1.0, 900.0))
    fold = machine_of(wide).following.follow(home, [home.joints[0] + 700.0, *home.joints[1:]])
    assert fold.stop == "singularity"
    assert 0.0 < fold.fraction < 1.0
    ahead = machine_of(wide).following.fold_ahead(home, [home.joints[0] + 700.0, *home.joints[1:]])
    assert ahead is not None
    assert ahead.joints[0] == pytest.approx(fold.posture.joints[0], rel=1e-4)
    assert low < ahead.joints[1]


def test_what_a_move_of_the_pose_passes() -> None:
    wide = TripodDesign("three_spr", 100.0, 200.0, (1.0, 900.0))
    before = generic.posture(wide, (100.0, 0.1, -np.pi / 6), "2")
    after = generic.posture(wide, (100.0, 0.8, -np.pi / 6), "2")
    (event,) = machine_of(wide).paths.passed(before, after)
    assert event.kind == "parallel"
    assert event.pose[1] == pytest.approx(np.pi / 6, abs=1e-9)
    assert event.stops
    reached = machine_of(wide).paths.drive(before, [after.pose])
    assert reached.stop == "singularity"
    assert reached.posture.pose[1] == pytest.approx(np.pi / 6, abs=1e-5)
    design = load_design("spr-3")
    home = machine_of(design).home
    up = generic.posture(design, (200.0, 0.0, 0.0), "2")
    events = machine_of(design).paths.passed(home, up)
    assert {event.limb for event in events} == {1, 2, 3}
    way = machine_of(design).paths.drive(home, [(120.0, 0.0, 0.0), up.pose])
    assert way.stop == "stroke"
    assert way.posture.joints == pytest.approx((design.stroke[1],) * 3, abs=1e-6)
    other = generic.posture(design, home.pose, "1")
    assert "operation mode" in machine_of(design).paths.passed(home, other)[0].text


@pytest.mark.parametrize("name", ["rps-3", "spr-3"])
def test_home_is_level_and_the_machine_is_drawn(name: str) -> None:
    design = load_design(name)
    home = machine_of(design).home
    assert home.reachable
    assert home.pose[1] == 0.0
    drawn = machine_of(design).drawing(home)
    roles = {bar.role for bar in drawn.bars}
    assert roles == {"base", "cylinder", "rod", "rail", "stop", "joint"}
    for limb in (1, 2, 3):
        rod = next(b for b in drawn.bars if b.name == f"limb{limb}/rod")
        cylinder = next(b for b in drawn.bars if b.name == f"limb{limb}/cylinder")
        a, b = joint_points(design, np.array(home.pose), home.mode)
        np.testing.assert_allclose(cylinder.start, a[limb - 1], atol=1e-12)
        np.testing.assert_allclose(rod.end, b[limb - 1], atol=1e-12)
    (other,) = machine_of(design).counterparts
    assert other.mechanism != design.mechanism
    assert other.base_radius == design.base_radius
    for axis, value in zip(machine_of(design).coordinates, home.pose, strict=True):
        assert axis.lower <= value <= axis.upper


def test_a_design_out_of_reach_has_a_home_with_reasons() -> None:
    design = machine("three_rps", 300.0, 100.0)
    short = TripodDesign("three_rps", 300.0, 100.0, (10.0, 30.0))
    assert machine_of(design).home.reachable
    assert not machine_of(short).home.reachable
    assert any(f.severity == "warning" for f in machine_of(short).findings)


def test_moves_of_a_3_spr_are_broken_at_90_degrees() -> None:
    """There its chart goes to infinity; those of a 3-RPS are not broken."""
    for kind, broken in (("rps-3", ()), ("spr-3", (0.25,))):
        paths = machine_of(load_design(kind)).paths
        for azimuth in (0.0, 0.4):
            start = (120.0, 0.5 * np.pi - 0.1, 0.3)
            end = (130.0, 0.5 * np.pi + 0.3, 0.3 + azimuth)
            assert paths.breaks(Segment.between(paths, start, end, "1")) == pytest.approx(broken)
            level = (130.0, start[1], 0.3 + azimuth)
            assert paths.breaks(Segment.between(paths, start, level, "1")) == ()
