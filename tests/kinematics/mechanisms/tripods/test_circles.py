"""Circles about any orientation, clearances and the ways out, against scans of all directions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kinematics.designs.files import load_design
from kinematics.facets import inverse as generic
from kinematics.machine import machine_of
from kinematics.mechanisms.tripods import circles, posing
from kinematics.mechanisms.tripods.design import KINDS, MODES, Kind
from kinematics.mechanisms.tripods.limbs import limb_lengths
from tests.kinematics.mechanisms.tripods.machines import circle_points, machine, some_machines


def test_the_search_agrees_with_the_exact_micr(rng: np.random.Generator) -> None:
    for design in some_machines(rng, 12):
        for mode in MODES:
            z = float(rng.uniform(30.0, 400.0))
            exact = circles.circles(design, (z, 0.0, 0.0), mode)[0]
            searched = circles.circles(design, (z, 1e-13, 0.0), mode)[0]
            assert exact.radius == pytest.approx(searched.radius, abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mode", MODES)
def test_about_other_orientations(kind: Kind, mode: str, rng: np.random.Generator) -> None:
    design = machine(kind)
    for _ in range(6):
        z, tilt, azimuth = rng.uniform(60, 200), rng.uniform(0.05, 0.6), rng.uniform(-3, 3)
        parallel, constraint, _ = circles.circles(design, (z, tilt, azimuth), mode)
        assert constraint.radius == pytest.approx(np.pi - tilt)
        radius = parallel.radius
        home = machine_of(design).statics.wrenches((z, tilt, azimuth), mode).determinant
        if radius < np.pi:
            at = np.array([z, *parallel.contacts[0]])
            assert machine_of(design).measures.singular_value(at, mode) < 1e-6
        for part in np.linspace(0.02, 0.995, 40):
            ring = circle_points(tilt, azimuth, part * min(radius, np.pi - tilt), 181)
            poses = np.concatenate([np.full((181, 1), z), ring], axis=-1)
            there = machine_of(design).statics.wrenches(poses, mode).determinant
            assert (np.sign(there) == np.sign(home)).all()


@pytest.mark.parametrize("kind", KINDS)
def test_circle_points_are_turned_by_the_radius(kind: Kind) -> None:
    design, mode = machine(kind), "2"
    here = posing.transform(design, (100.0, 0.4, 0.9), mode)[:3, :3]
    ring = circle_points(0.4, 0.9, 0.7, 37)
    poses = np.concatenate([np.full((37, 1), 100.0), ring], axis=-1)
    there = posing.transform(design, poses, mode)[:, :3, :3]
    cosine = 0.5 * (np.einsum("ij,nij->n", here, there) - 1.0)
    np.testing.assert_allclose(np.arccos(cosine), 0.7, atol=1e-12)


@pytest.mark.parametrize("name", ["rps-3", "spr-3"])
def test_the_stroke_circle_stays_within_the_strokes(name: str) -> None:
    design = load_design(name)
    home = machine_of(design).home
    stroke = next(
        c for c in machine_of(design).circles.about(home.pose, home.mode) if c.limit == "stroke"
    )
    assert stroke.limb is not None
    for tilt, azimuth in stroke.contacts:
        there = machine_of(design).inverse.posture((home.pose[0], tilt, azimuth), home.mode)
        assert abs(there.nearest.amount) < 1e-6
    for part, held in ((0.999, True), (1.001, False)):
        ring = circle_points(home.pose[1], home.pose[2], part * stroke.radius, 721)
        poses = [(home.pose[0], *point) for point in ring]
        assert all(machine_of(design).inverse.inside(pose, (home.mode,)) for pose in poses) is held


def test_beyond_a_stroke_the_circle_is_a_point() -> None:
    design = replace(machine("three_rps"), stroke=(20.0, 90.0))
    stroke = circles.circles(design, (150.0, 0.1, 0.0), "2")[2]
    assert stroke.radius == 0.0


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mode", MODES)
def test_clearances_are_where_they_say(kind: Kind, mode: str) -> None:
    design = machine(kind)
    here = generic.posture(design, (180.0, 0.3, 0.5), mode)
    found = machine_of(design).clearances.of(here)
    assert [c.distance for c in found] == sorted(c.distance for c in found)
    origin = posing.transform(design, here.pose, mode)
    for each in found:
        if "along" not in each.text:
            continue
        way = np.array(each.point) - origin[:3, 3]
        assert np.linalg.norm(way) == pytest.approx(abs(each.distance), abs=1e-6)
        line = [0.0, 0.0, 1.0] if kind == "three_rps" else origin[:3, 2]
        assert np.linalg.norm(np.cross(way, line)) < 1e-6 * (1.0 + abs(each.distance))
        there = np.array([each.point[2], *here.pose[1:]])
        if each.kind == "parallel":
            assert machine_of(design).measures.singular_value(there, mode) < 1e-6
        else:
            length = limb_lengths(design, there, mode)[each.limb - 1]
            end = design.stroke[0 if each.bound == "rho_min" else 1]
            assert length == pytest.approx(end, abs=1e-6)
    quick = machine_of(design).clearances.of(here, singular=False)
    assert all("along" in each.text for each in quick)


@pytest.mark.parametrize("name", ["rps-3", "spr-3"])
def test_ways_out(name: str) -> None:
    design = load_design(name)
    z, *_ = machine_of(design).home.pose
    high = machine_of(design).inverse.posture((z + 300.0, 0.2, 0.4), "2")
    remedy = machine_of(design).clearances.nearest_pose(high)
    assert remedy.nearest is not None
    assert remedy.nearest.reachable
    assert remedy.nearest.pose[1:] == high.pose[1:]
    # Between there and the pose nothing can be held.
    for part in np.linspace(0.001, 1.0, 50):
        between = remedy.nearest.pose[0] + part * (high.pose[0] - remedy.nearest.pose[0])
        assert not machine_of(design).inverse.posture((between, 0.2, 0.4), "2").reachable
    wider = design
    for change in remedy.changes[0]:
        wider = machine_of(wider).edited(change.path, change.after).design
    assert machine_of(wider).inverse.posture(high.pose, "2").reachable
    flat = machine_of(design).inverse.posture((z, 1.45, 0.2), "2")
    turned = machine_of(design).clearances.nearest_pose(flat)
    assert turned.nearest is not None
    assert turned.nearest.reachable
