"""The 4-SPS + 1-SPR behind the shared interface: home, findings, following, dragging, drawing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.four_sps_spr import inverse
from kinematics.mechanisms.four_sps_spr.constraint import complete_pose
from kinematics.mechanisms.four_sps_spr.home import reach
from kinematics.screws.spatial import homogeneous
from tests.kinematics.mechanisms.four_sps_spr.machines import (
    general,
    machine,
    pentagon,
    pentagons,
    poses,
    preset,
)

KIND = mechanism_class("four_sps_spr")


# --- home and findings ---------------------------------------------------------------------


def test_home_of_the_preset_is_level_on_the_axis_and_well_held() -> None:
    design = preset()
    home = machine_of(design).home
    assert home.pose[:2] == (0.0, 0.0)
    assert home.pose[3:] == (0.0, 0.0, 0.0)
    assert home.reachable
    assert min(margin.amount for margin in home.margins) > 100.0
    assert machine_of(design).measures.condition(home.pose, "") < 100.0
    assert all(finding.severity == "info" for finding in machine_of(design).findings)


@pytest.mark.parametrize("design", [general(), general(5)])
def test_home_of_a_general_machine_satisfies_the_constraint(design) -> None:
    home = machine_of(design).home
    assert home.reachable
    assert abs(float(inverse.violation(design, home.pose))) < 1e-8


def test_two_pentagons_are_warned_of() -> None:
    (warning,) = (f for f in machine_of(pentagons()).findings if f.severity == "warning")
    assert warning.title == "Singular at home"
    assert "rank 4" in warning.text
    assert "two regular pentagons" in warning.text


@pytest.mark.parametrize("pose", [(0.0, 0.0, z, 0.0, 0.0, 0.0) for z in (300.0, 560.0, 700.0)])
def test_two_pentagons_have_rank_four_whenever_they_are_level(pose) -> None:
    rows = machine_of(pentagons()).statics.wrenches(pose, "").rows.copy()
    rows[:, 3:] /= 100.0
    sizes = np.linalg.svd(rows, compute_uv=False)
    assert (sizes > 1e-12 * sizes[0]).sum() == 4
    (one, two) = machine_of(pentagons()).singularities.at(
        machine_of(pentagons()).inverse.posture(pose, "")
    )
    assert one.kind == two.kind == "parallel"


def test_a_machine_that_is_singular_everywhere_is_warned_of() -> None:
    base = np.zeros((5, 3))  # all legs from one point: they cannot hold a turn about it
    design = machine(base, pentagon(100.0), (0.0, 1.0, 0.0))
    assert machine_of(design).findings[0].title == "Architecturally singular"


def test_an_empty_workspace_is_warned_of() -> None:
    design = machine(pentagon(4000.0), pentagon(100.0), (1.0, 0.3, 0.1), stroke=(10.0, 20.0))
    assert any(finding.title == "Out of reach" for finding in machine_of(design).findings)
    assert not machine_of(design).home.reachable


# --- following -----------------------------------------------------------------------------


@pytest.mark.parametrize("design", [preset(), general()])
def test_legs_lead_the_platform_along_its_assembly_mode(design) -> None:
    home = machine_of(design).home
    side = np.sign(machine_of(design).statics.wrenches(home.pose, "").determinant)
    rng = np.random.default_rng(0)
    for _ in range(6):
        goal = np.array(home.joints) + rng.uniform(-15.0, 15.0, 5)
        reached = machine_of(design).following.follow(home, goal)
        posture = reached.posture
        if reached.stop == "target":
            assert posture.joints == tuple(goal.tolist())
            assert posture.residual < 1e-10
        assert inverse.leg_lengths(design, posture.pose) == pytest.approx(posture.joints, abs=1e-9)
        assert np.sign(machine_of(design).statics.wrenches(posture.pose, "").determinant) == side
        back = machine_of(design).following.follow(posture, home.joints)
        assert back.posture.pose == pytest.approx(home.pose, abs=1e-6)


def test_a_stroke_end_stops_the_way() -> None:
    design = preset()
    home = machine_of(design).home
    goal = list(home.joints)
    goal[2] = design.stroke[2, 1] + 300.0
    reached = machine_of(design).following.follow(home, goal)
    assert reached.stop == "stroke"
    assert reached.limb == 3
    assert reached.posture.joints[2] == design.stroke[2, 1]
    assert "limb 3 is at the end of its stroke (l₃ max = 800 mm)" in reached.text
    assert 0.0 < reached.fraction < 1.0


def test_a_singularity_stops_the_way_shortly_before_it() -> None:
    design = preset()
    home = machine_of(design).home
    goal = np.full(5, 600.0)
    reached = machine_of(design).following.follow(home, goal)
    fold = machine_of(design).following.fold_ahead(home, goal)
    assert reached.stop == "singularity"
    assert "parallel singularity" in reached.text
    assert fold is not None
    way = np.linalg.norm(goal - home.joints)
    assert reached.fraction * way == pytest.approx(fold.distance, rel=1e-5)
    assert reached.fraction * way < fold.distance
    assert reached.posture.residual < 1e-9
    assert machine_of(design).measures.condition(fold.pose, "") > 1e5
    assert machine_of(design).measures.condition(reached.posture.pose, "") > 1e3
    assert fold.partner is not None
    assert fold.partner.joints == pytest.approx(home.joints, abs=1e-9)
    sides = [
        np.sign(machine_of(design).statics.wrenches(each.pose, "").determinant)
        for each in (home, fold.partner)
    ]
    assert sides[0] == -sides[1]
    left = machine_of(design).following.follow(
        reached.posture, home.joints
    )  # and it can be left again
    assert left.posture.pose == pytest.approx(home.pose, abs=1e-5)


def test_a_machine_in_a_singularity_is_not_led_anywhere() -> None:
    design = pentagons()
    level = machine_of(design).inverse.posture((0.0, 0.0, 605.0, 0.0, 0.0, 0.0), "")
    reached = machine_of(design).following.follow(level, np.array(level.joints) + 5.0)
    assert reached.stop == "singularity"
    assert reached.posture == level
    assert "move the platform out of it first" in reached.text


def test_a_pose_off_the_constraint_is_not_followed() -> None:
    posture = machine_of(preset()).inverse.posture((10.0, 10.0, 560.0, 0.0, 0.0, 0.0), "")
    reached = machine_of(preset()).following.follow(posture, np.full(5, 600.0))
    assert reached.stop == "stalled"
    assert "limb 5 cannot close" in reached.text


def test_what_a_move_passes() -> None:
    design = preset()
    home = machine_of(design).home
    up = machine_of(design).inverse.posture((0.0, 0.0, 760.0, 0.0, 0.0, 0.0), "")
    events = machine_of(design).paths.passed(home, up)
    assert {event.kind for event in events} == {"stroke"}
    assert [e.fraction for e in events] == sorted(e.fraction for e in events)
    for event in events:
        length = inverse.leg_lengths(design, event.pose)[event.limb - 1]
        assert length == pytest.approx(design.stroke[event.limb - 1, 1], abs=1e-6)
    down = machine_of(design).inverse.posture((0.0, 0.0, -600.0, 0.0, 0.0, 0.0), "")
    (crossed,) = (e for e in machine_of(design).paths.passed(home, down) if e.kind == "parallel")
    assert crossed.pose[2] == pytest.approx(0.0, abs=1e-6)  # in the base plane
    assert crossed.stops


# --- dragging ------------------------------------------------------------------------------


@pytest.mark.parametrize("design", [preset(), general()])
def test_a_dragged_platform_takes_the_nearest_pose(design) -> None:
    rng = np.random.default_rng(1)
    for pose in poses(design, 4, seed=5):
        turned = Rotation.from_rotvec(rng.normal(size=3) * 0.1).as_matrix()
        hand = homogeneous(turned @ inverse.rotation(pose), pose[:3] + rng.normal(size=3) * 20.0)
        found = np.array(machine_of(design).pose_from_transform(hand, ""))
        assert abs(float(inverse.violation(design, found))) < 1e-10

        def far(p, hand=hand):
            turn = Rotation.from_matrix(inverse.rotation(p) @ hand[:3, :3].T).magnitude()
            return ((p[:3] - hand[:3, 3]) ** 2).sum() + (design.length * turn) ** 2

        index = int(np.abs(inverse.rotation(found) @ design.axis).argmax())
        free = [k for k in range(6) if k != index]

        def of_free(values, index=index, free=free, far=far):
            p = np.empty(6)
            p[free], p[index] = values, np.nan
            return far(np.array(complete_pose(design, p)))

        best = minimize(of_free, found[free], method="Nelder-Mead", options={"maxiter": 1500})
        assert far(found) <= best.fun + 1e-6


def test_a_pose_that_is_allowed_stays_where_it_is() -> None:
    design = preset()
    for pose in poses(design, 10):
        again = machine_of(design).pose_from_transform(machine_of(design).transform(pose, ""), "")
        assert again == pytest.approx(pose, abs=1e-9)
    with pytest.raises(InputError, match="rotation"):
        machine_of(design).pose_from_transform(np.diag([2.0, 1.0, 1.0, 1.0]), "")


# --- drawing -------------------------------------------------------------------------------


def test_the_drawing_has_every_part_where_the_posture_says() -> None:
    design = preset()
    posture = machine_of(design).home
    drawn = machine_of(design).drawing(posture)
    names = {bar.name for bar in drawn.bars}
    assert len(names) == len(drawn.bars)
    for i in range(1, 6):
        rod = next(bar for bar in drawn.bars if bar.name == f"limb{i}/rod")
        cylinder = next(bar for bar in drawn.bars if bar.name == f"limb{i}/cylinder")
        length = np.linalg.norm(np.subtract(rod.end, cylinder.start))
        assert length == pytest.approx(posture.joints[i - 1])
        assert rod.limb == i
    assert "limb5/R_B" in names
    assert "limb5/S_B" not in names
    assert {body.role for body in drawn.bodies} == {"base", "platform"}
    off = machine_of(design).inverse.posture((10.0, 10.0, 560.0, 0.0, 0.0, 0.0), "")
    gap = next(bar for bar in machine_of(design).drawing(off).bars if bar.role == "gap")
    assert np.linalg.norm(np.subtract(gap.end, gap.start)) == pytest.approx(np.sqrt(200.0))


def test_a_path_is_followed_up_to_what_stops_the_machine() -> None:
    design = preset()
    home = machine_of(design).home
    near = (*home.pose[:2], home.pose[2] + 40.0, 0.1, 0.05, -0.1)
    reached = machine_of(design).paths.drive(home, [near, home.pose])
    assert reached.stop == "target"
    assert reached.fraction == 1.0
    assert reached.posture.pose == pytest.approx(home.pose, abs=1e-9)
    # Downwards a leg comes to its end first, and the machine can be held there.
    down = (home.pose[0], home.pose[1], 0.3 * home.pose[2], 0.0, 0.0, 0.0)
    reached = machine_of(design).paths.drive(home, [near, down])
    assert reached.stop == "stroke"
    assert reached.limb is not None
    assert reached.posture.reachable
    ends = design.stroke[reached.limb - 1]
    assert np.abs(reached.posture.joints[reached.limb - 1] - ends).min() < 1e-6
    # With legs of any length it goes on, up to the singularity of the level platform.
    free = replace(
        design, limbs=tuple(replace(limb, stroke=(1.0, 2000.0)) for limb in design.limbs)
    )
    home = machine_of(free).inverse.posture(home.pose, "")
    reached = machine_of(free).paths.drive(
        home, [(home.pose[0], home.pose[1], -200.0, 0.0, 0.0, 0.0)]
    )
    assert reached.stop == "singularity"
    assert abs(reached.posture.pose[2]) < 0.01
    assert reached.fraction == pytest.approx(home.pose[2] / (home.pose[2] + 200.0), rel=1e-4)
    with pytest.raises(InputError, match="a path must be a list of poses of 6 numbers"):
        machine_of(design).paths.drive(home, home.pose)


def test_home_is_above_the_whole_base_or_in_the_upper_half_of_reach() -> None:
    """A machine with base points at two heights, which could be held lower with more room."""
    base = [[384, -6, 400], [108, 334, 400], [-359, 209, 0], [-346, -258, 400], [133, -324, 400]]
    platform = [[104, 17, 8], [31, 78, 0], [-92, 44, 0], [-69, -67, 11], [32, -109, 19]]
    design = machine(base, platform, (0.57, -0.4, -0.72), (250.0, 600.0))
    home = machine_of(design).home
    low, high = (c[2] for c in reach(design))
    assert home.reachable
    assert home.pose[2] >= min(400.0, 0.5 * (low + high)) - 1e-9


def test_a_leg_without_length_is_drawn_upright() -> None:
    design = preset()
    for length, along in ((1e-3, (1.0, 0.0, 0.0)), (1e-8, (0.0, 0.0, 1.0))):
        position = design.base[0] - design.platform[0] + np.array([length, 0.0, 0.0])
        at = machine_of(design).inverse.posture((*position, 0.0, 0.0, 0.0), "")
        bars = {bar.name: bar for bar in machine_of(design).drawing(at).bars}
        rail = np.subtract(bars["limb1/rail"].end, bars["limb1/rail"].start)
        np.testing.assert_allclose(rail / np.linalg.norm(rail), along, atol=1e-6)
