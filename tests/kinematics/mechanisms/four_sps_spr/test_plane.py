"""The constant-orientation workspace, singular places in it, clearances and remedies."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from kinematics.errors import InputError
from kinematics.facets import inverse as generic
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.four_sps_spr import inverse
from kinematics.mechanisms.four_sps_spr.plane import plane, rings
from kinematics.mechanisms.four_sps_spr.singular_curve import cubic, nearest_singular
from kinematics.plane import annuli
from tests.kinematics.mechanisms.four_sps_spr.machines import general, pentagons, poses, preset

KIND = mechanism_class("four_sps_spr")
ANGLES = st.tuples(*(st.floats(-0.9, 0.9) for _ in range(3)))
MACHINES = [preset(), general()]


def at(design, angles, uv):
    """Poses (n, 6) of points (n, 2) of the plane."""
    places = plane(design, angles).place(np.atleast_2d(uv))
    return np.hstack([places, np.broadcast_to(angles, (len(places), 3))])


@pytest.mark.parametrize("design", MACHINES)
@settings(max_examples=25)
@given(angles=ANGLES)
def test_the_region_is_what_strokes_and_constraint_leave(design, angles) -> None:
    pose = (0.0, 0.0, 560.0, *angles)
    (region,) = machine_of(design).regions.of("workspace", pose, None)
    section, frame = region.section, machine_of(design).regions.frame(pose)
    rng = np.random.default_rng(0)
    uv = rng.uniform(-700.0, 700.0, (400, 2))
    places = (frame @ np.column_stack([uv, np.zeros(400), np.ones(400)]).T).T[:, :3]
    there = np.hstack([places, np.broadcast_to(angles, (400, 3))])
    assert np.abs(inverse.violation(design, there)).max() < 1e-9
    held = generic.inside(design, there)
    assert (held == annuli.inside(rings(design, plane(design, angles)), uv)).all()
    # Every edge is the end of the stroke that it says.
    for k in range(len(section.limb)):
        points = at(design, angles, section.edge_points(k, 50.0))
        lengths = inverse.leg_lengths(design, points)
        limb, end = section.limb[k] - 1, 0 if section.bound[k] == 0 else 1
        assert lengths[:, limb] == pytest.approx(design.stroke[limb, end], abs=1e-7)
    if section.loops:
        assert generic.inside(design, at(design, angles, region.inside))[0]
        assert section.loop_area.sum() == pytest.approx(section.area)


@pytest.mark.parametrize("design", MACHINES)
def test_the_area_is_that_of_a_fine_grid(design) -> None:
    angles = (0.2, -0.1, 0.15)
    (region,) = machine_of(design).regions.of("workspace", (0.0, 0.0, 560.0, *angles), None)
    steps = np.linspace(-900.0, 900.0, 1200, endpoint=False) + 0.75
    uv = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    held = annuli.inside(rings(design, plane(design, angles)), uv)
    counted = held.sum() * 1.5**2
    assert region.section.area == pytest.approx(counted, rel=2e-3)
    assert region.section.centroid == pytest.approx(uv[held].mean(axis=0), abs=0.5)


def test_there_is_one_kind_of_region() -> None:
    with pytest.raises(InputError, match="'workspace'"):
        machine_of(preset()).regions.of("aspects", machine_of(preset()).home.pose, None)


# --- singular places -----------------------------------------------------------------------


@pytest.mark.parametrize("design", MACHINES)
@settings(max_examples=25)
@given(angles=ANGLES)
def test_the_determinant_is_a_cubic_in_the_plane(design, angles) -> None:
    curve = cubic(design, angles)
    uv = np.random.default_rng(1).uniform(-600.0, 600.0, (40, 2))
    there = at(design, angles, uv)
    system = machine_of(design).statics.wrenches(there, "")
    known = system.determinant * np.prod(inverse.leg_lengths(design, there), axis=1)
    # unit wrenches: the determinant of G with moments by the length, as the cubic's
    values, gradient = curve.values(uv)
    assert values == pytest.approx(known, rel=1e-9, abs=1e-9 * np.abs(known).max())
    h = 1e-3
    for k in range(2):
        shift = np.eye(2)[k] * h
        slope = (curve.values(uv + shift)[0] - curve.values(uv - shift)[0]) / (2 * h)
        assert gradient[:, k] == pytest.approx(slope, rel=1e-5, abs=1e-6 * np.abs(gradient).max())


@pytest.mark.parametrize("design", MACHINES)
@settings(max_examples=25)
@given(angles=ANGLES)
@example(angles=(-0.004, 0.0, 4.15e-5))
@example(angles=(-0.364, -3.15e-5, 0.0))
@example(angles=(0.0, 0.0, 1.192092896e-07))
def test_the_locus_is_singular_and_the_nearest_place_is_on_it(design, angles) -> None:
    pose = tuple(at(design, angles, np.array([30.0, 520.0]))[0].tolist())
    found = machine_of(design).singularities.locus("plane", pose, "")
    curve = cubic(design, angles)
    here = plane(design, angles).coordinates(np.array(pose[:3]))
    near = nearest_singular(curve, here)
    # Without β and γ the cubic is a threefold line, whatever α: beside it no double knows a zero
    # better than by the cube root of its rounding, 6e-6 of the machine's size.
    beside = 0.0 < np.abs(angles[1:]).max() < 1e-4
    close, exact = (1e-4, 1e-3) if beside else (1e-6, 1e-6)
    if len(found.points):
        assert found.residual.max() < exact
        sizes = machine_of(design).measures(at(design, angles, found.points), "", "conditioning")
        assert sizes.max() < close
        assert near is not None
        away = np.linalg.norm(found.points - here, axis=1).min()
        assert near.distance <= away + close
    if near is not None:
        assert np.linalg.norm(near.point - here) == pytest.approx(near.distance)
        there = at(design, angles, near.point)
        assert machine_of(design).measures(there, "", "conditioning")[0] < close


def test_level_the_base_plane_is_a_threefold_line_of_singular_places() -> None:
    design = preset()
    home = machine_of(design).home
    (parallel,) = (c for c in machine_of(design).clearances.of(home) if c.kind == "parallel")
    assert parallel.distance == pytest.approx(home.pose[2], abs=1e-6)
    found = machine_of(design).singularities.locus("plane", home.pose, "")
    assert np.abs(at(design, home.pose[3:], found.points)[:, 2]).max() < 1e-6


def test_a_level_pentagon_is_singular_wherever_it_is() -> None:
    design = pentagons()
    pose = (0.0, 0.0, 600.0, 0.0, 0.0, 0.0)
    assert cubic(design, (0.0, 0.0, 0.0)).everywhere
    assert not len(machine_of(design).singularities.locus("plane", pose, "").points)
    (parallel,) = (
        c
        for c in machine_of(design).clearances.of(machine_of(design).inverse.posture(pose, ""))
        if c.kind == "parallel"
    )
    assert parallel.distance == 0.0


# --- clearances and remedies ---------------------------------------------------------------


@pytest.mark.parametrize("design", MACHINES)
def test_clearances_are_met_where_they_say(design) -> None:
    for pose in poses(design, 8, seed=3):
        posture = machine_of(design).inverse.posture(pose, "")
        found = machine_of(design).clearances.of(posture)
        assert [c.distance for c in found] == sorted(c.distance for c in found)
        for clearance in found:
            there = np.append(clearance.point, pose[3:])
            assert abs(float(inverse.violation(design, there))) < 1e-8
            apart = np.linalg.norm(there[:3] - pose[:3])
            assert apart == pytest.approx(abs(clearance.distance), abs=1e-8)
            if clearance.kind == "stroke":
                end = 0 if clearance.bound == "rho_min" else 1
                length = inverse.leg_lengths(design, there)[clearance.limb - 1]
                assert length == pytest.approx(design.stroke[clearance.limb - 1, end], abs=1e-8)
        kinds = {c.kind for c in found}
        assert ("boundary" in kinds) == posture.reachable
        fast = machine_of(design).clearances.of(posture, singular=False)
        assert all(c.kind != "parallel" for c in fast)


@pytest.mark.parametrize("design", MACHINES)
def test_a_remedy_is_reachable_and_none_is_nearer(design) -> None:
    rng = np.random.default_rng(2)
    for pose in poses(design, 6, seed=4):
        pose[2] += 260.0
        pose[:3] += inverse.violation(design, pose) * (inverse.rotation(pose) @ design.axis)
        wanted = machine_of(design).inverse.posture(pose, "")
        found = machine_of(design).clearances.nearest_pose(wanted)
        if wanted.reachable or found.nearest is None:
            continue
        assert found.nearest.reachable
        assert found.nearest.pose[3:] == pytest.approx(tuple(pose[3:]))
        assert found.distance == pytest.approx(
            np.linalg.norm(np.subtract(found.nearest.pose[:3], pose[:3])), abs=1e-6
        )
        here = plane(design, tuple(pose[3:]))
        tried = here.coordinates(pose[:3]) + rng.normal(size=(3000, 2)) * found.distance
        away = np.linalg.norm(tried - here.coordinates(pose[:3]), axis=1)
        held = generic.inside(design, at(design, tuple(pose[3:]), tried))
        assert not (held & (away < found.distance - 1e-6)).any()
        (change,) = found.changes
        changed = design
        for each in change:
            changed = machine_of(changed).edited(each.path, each.after).design
        assert machine_of(changed).inverse.posture(pose, "").reachable


def test_a_pose_off_the_constraint_is_led_back_onto_it() -> None:
    design = preset()
    home = machine_of(design).home
    off = np.array(home.pose)
    off[:3] += 4.0 * design.axis
    found = machine_of(design).clearances.nearest_pose(machine_of(design).inverse.posture(off, ""))
    assert found.nearest is not None
    assert found.nearest.pose == pytest.approx(home.pose, abs=1e-9)
    assert found.distance == pytest.approx(4.0)
    assert found.changes == ()


def test_at_an_orientation_without_any_place_another_is_offered() -> None:
    design = preset()
    pose = (*machine_of(design).home.pose[:5], 1.5)
    wanted = machine_of(design).inverse.posture(
        machine_of(design).complete_pose(pose, "", dependent=0), ""
    )
    region = machine_of(design).regions.of("workspace", wanted.pose, None)[0]
    found = machine_of(design).clearances.nearest_pose(wanted)
    assert found.nearest is not None
    assert found.nearest.reachable
    assert (found.error == float("inf")) == (region.section.area == 0.0)


def test_there_is_one_chart() -> None:
    assert [spec.key for spec in machine_of(preset()).singularities.loci] == ["plane"]
    with pytest.raises(InputError):
        machine_of(preset()).singularities.locus("globe", machine_of(preset()).home.pose, "")
