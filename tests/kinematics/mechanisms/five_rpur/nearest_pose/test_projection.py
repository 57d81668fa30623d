"""The nearest place of a mode's workspace: held by inverse kinematics, and nothing is nearer."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.designs.files import load_design
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inscribed.region import Region
from kinematics.mechanisms.five_rpur.nearest_pose.projection import nearest
from kinematics.screws.spatial import rotation_y
from tests.kinematics.mechanisms.five_rpur.machines import preset

TABLES = ("rpur-table1", "rpur-table2", "rpur-a1a1", "rpur-mpa2")
ZERO = (0.0, 0.0, 0.0)


def case(seed: int):
    rng = np.random.default_rng(seed)
    design = preset(TABLES[seed % len(TABLES)])
    pose = (*rng.uniform(-500, 500, 3).tolist(), *rng.uniform(-0.8, 0.8, 2).tolist())
    return design, pose, str(rng.choice(inverse.MODES))


def nearest_of_dice(design, pose, mode, seed: int) -> float:
    """The distance to the nearest of many points thrown, ever closer to the best of them."""
    rng = np.random.default_rng(seed)
    bounds = Region.at(design, *pose[3:], (mode,)).bounds
    if bounds is None:
        return np.inf

    def distances(points):
        poses = np.column_stack([points, np.tile(pose[3:], (len(points), 1))])
        held = inverse.inside(design, poses, [mode])
        return np.where(held, np.linalg.norm(points - pose[:3], axis=1), np.inf)

    points = rng.uniform(*bounds, (40_000, 3))
    away = distances(points)
    best, at = away.min(), points[away.argmin()]
    if np.isfinite(best):
        for width in 20.0 * 0.5 ** np.arange(18):
            points = at + width * rng.normal(size=(2000, 3))
            away = distances(points)
            if away.min() < best:
                best, at = away.min(), points[away.argmin()]
    return float(best)


@pytest.mark.parametrize("seed", range(20))
def test_nothing_thrown_is_nearer(seed):
    design, pose, mode = case(seed)
    found = nearest(design, pose, mode)
    thrown = nearest_of_dice(design, pose, mode, seed)
    if found is None:
        assert thrown == np.inf
        return
    assert found.posture.reachable
    assert found.posture.mode == mode
    assert found.posture.pose[3:] == pose[3:]
    away = np.linalg.norm(np.subtract(found.posture.pose[:3], pose[:3]))
    assert away == pytest.approx(found.distance, abs=1e-9)
    assert found.distance <= thrown + 1e-7
    assert found.error < 0.1


@pytest.mark.parametrize("seed", range(8))
def test_a_little_nearer_nothing_is_left(seed):
    design, pose, mode = case(seed)
    found = nearest(design, pose, mode)
    if found is not None:
        assert nearest(design, pose, mode, found.distance - found.error - 1e-6) is None
        same = nearest(design, pose, mode, found.distance + 1e-3)
        assert same is not None
        assert same.distance == pytest.approx(found.distance, abs=1e-9)


def test_a_place_inside_is_its_own():
    design = load_design("rpur-table1")
    pose = (326.0, 73.0, 211.0, 0.0, 0.0)
    found = nearest(design, pose, "+-+-+")
    assert found is not None
    assert found.distance == 0.0
    assert found.posture.pose == pytest.approx(pose, abs=1e-12)


def alike(link: float, low: float, high: float) -> FiveRPURDesign:
    limb = Limb(ZERO, ZERO, link, (low, high))
    return FiveRPURDesign((limb,) * 5)


@pytest.mark.parametrize(
    ("place", "wanted"),
    [
        ((500.0, 0.0, 0.0), np.hypot(500.0, 100.0) - 300.0),  # the rim, β = π/2
        ((0.0, 0.0, 500.0), 100.0),  # the top
        ((0.0, 250.0, 200.0), 150.0),  # straight onto a flat end
        ((0.0, 250.0, 0.0), np.hypot(250.0, 200.0) - 100.0),  # the wall of its tunnel
        ((0.0, 0.0, 100.0), 100.0 * np.sqrt(2.0)),  # the middle of the hole
    ],
)
def test_closed_forms_of_one_limb(place, wanted):
    design = alike(100.0, 200.0, 300.0)
    found = nearest(design, (*place, 0.0, 0.0), "+++++")
    assert found is not None
    brute = nearest_of_dice(design, (*place, 0.0, 0.0), "+++++", 0)
    assert found.distance == pytest.approx(wanted, abs=1e-9)
    assert found.distance == pytest.approx(brute, abs=0.3)
    assert found.distance <= brute
    assert found.posture.reachable


def test_a_workspace_that_is_one_point():
    """Two limbs whose solids touch in one point, top on bottom."""
    limb = Limb(ZERO, ZERO, 100.0, (200.0, 300.0))
    lower = Limb((0.0, 0.0, -800.0), ZERO, 100.0, (200.0, 300.0))
    upper = FiveRPURDesign((limb, limb, limb, limb, lower))
    # In mode −, limb 1 hangs down to z = −400; in mode +, the lower one stands up to it.
    found = nearest(upper, (50.0, 20.0, 0.0, 0.0, 0.0), "----+")
    assert found is not None
    assert found.posture.pose[:3] == pytest.approx((0.0, 0.0, -400.0), abs=1e-3)
    apart = Limb((0.0, 0.0, -800.001), ZERO, 100.0, (200.0, 300.0))
    empty = FiveRPURDesign((limb, limb, limb, limb, apart))
    assert nearest(empty, (50.0, 20.0, 0.0, 0.0, 0.0), "----+") is None


@pytest.mark.parametrize("seed", range(6))
def test_a_motion_of_the_whole_moves_the_nearest_place(seed):
    design, pose, mode = case(seed)
    rng = np.random.default_rng(seed)
    about, shift = rng.uniform(-1, 1), rng.uniform(-200, 200, 3)
    turn = rotation_y(about)
    moved = FiveRPURDesign(
        tuple(
            Limb(tuple((turn @ limb.base + shift).tolist()), limb.platform, limb.link, limb.stroke)
            for limb in design.limbs
        )
    )
    there = nearest(moved, (*(turn @ pose[:3] + shift), pose[3], pose[4] + about), mode)
    here = nearest(design, pose, mode)
    if here is None or there is None:
        assert here is there
    else:
        assert there.distance == pytest.approx(here.distance, abs=1e-8)


def test_limbs_too_far_apart_in_y():
    near, far = (
        Limb(ZERO, ZERO, 100.0, (200.0, 300.0)),
        Limb((0, 300.0, 0), ZERO, 100.0, (200, 300)),
    )
    design = FiveRPURDesign((near, near, near, near, far))
    assert nearest(design, (0.0, 0.0, 300.0, 0.0, 0.0), "+++++") is None
