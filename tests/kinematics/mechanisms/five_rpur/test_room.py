"""The room around a pose: against brute force over the tubes, inverse kinematics and motions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.facets import inverse as generic
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.feet import feet
from kinematics.mechanisms.five_rpur.inscribed import largest
from kinematics.screws.spatial import rotation_x, rotation_y
from tests.kinematics.mechanisms.five_rpur.machines import preset

TABLES = ("rpur-table1", "rpur-table1-icee", "rpur-table2", "rpur-a1a1")


def a_posture(seed: int, reachable: bool = True):
    rng = np.random.default_rng(seed)
    design = preset(TABLES[seed % len(TABLES)])
    assert isinstance(design, FiveRPURDesign)
    while True:
        poses = np.column_stack([rng.uniform(-500, 500, (4000, 3)), rng.uniform(-1, 1, (4000, 2))])
        held = inverse.inverse(design, poses).within_stroke
        at, mode = np.argwhere(held == reachable)[rng.integers(0, (held == reachable).sum())]
        return design, generic.posture(design, poses[at], inverse.MODES[mode])


def brute(relative, link, sign, radius) -> float:
    """The least distance over a fine net of the tube, refined about its best node."""
    low, high = 0.0, np.pi
    for _ in range(8):
        beta = np.linspace(low, high, 4001)
        apart = np.hypot(relative[0], relative[2] - sign * link * np.sin(beta))
        d = np.hypot(relative[1] - link * np.cos(beta), apart - radius)
        n = int(d.argmin())
        low, high = beta[max(n - 1, 0)], beta[min(n + 1, 4000)]
    return float(d.min())


lengths = st.floats(20.0, 400.0)
# Round numbers meet what is degenerate: on the axes, on the tube, at its centre.
coordinates = st.one_of(st.sampled_from([0.0, 150.0, -150.0, 250.0, -250.0]), st.floats(-700, 700))


@settings(max_examples=150)
@given(
    st.tuples(coordinates, coordinates, coordinates),
    st.one_of(st.just(150.0), lengths),
    st.sampled_from([1.0, -1.0]),
    st.one_of(st.sampled_from([0.0, 150.0, 250.0]), lengths),
    st.integers(-12, 0),
)
def test_foot_is_the_nearest_point_of_the_tube(relative, link, sign, radius, power):
    relative = np.array(relative) + 10.0**power * np.array([0.3, -0.7, 0.2])
    distance, foot = feet(relative, link, sign, radius)
    assert distance <= brute(relative, link, sign, radius) + 1e-9
    assert np.linalg.norm(foot - relative) == pytest.approx(float(distance), abs=1e-9)
    height = np.sqrt(max(link**2 - foot[1] ** 2, 0.0))
    # Near its ends the tube runs fast: there a rounding of y is more of z.
    on = abs(np.hypot(foot[0], foot[2] - sign * height) - radius)
    assert on < 1e-9 or link - abs(foot[1]) < 1e-6


def test_feet_in_batches_are_those_of_single_places():
    rng = np.random.default_rng(4)
    places = rng.normal(size=(6, 1, 3)) * 300
    distance, foot = feet(places, np.full((6, 1), 150.0), 1.0, np.array([250.0, 400.0]))
    assert distance.shape == (6, 2)
    assert foot.shape == (6, 2, 3)
    for n in range(6):
        for k, radius in enumerate((250.0, 400.0)):
            d, f = feet(places[n, 0], 150.0, 1.0, radius)
            assert d == pytest.approx(distance[n, k], rel=1e-14)
            assert f == pytest.approx(foot[n, k], abs=1e-9)


def _beside(there, clearance) -> float:
    """How far a place is from a bound, by the limb's own margin; a rounding off |Y| = l is not."""
    for margin in there.margins:
        if (margin.limb, margin.bound) == (clearance.limb, clearance.bound):
            return margin.amount
    short = next(m.amount for m in there.margins if m.limb == clearance.limb)
    assert -1e-9 < short < 0.0
    return 0.0


@pytest.mark.parametrize("seed", range(12))
def test_at_each_nearest_point_its_bound_is_met(seed):
    design, posture = a_posture(seed)
    found = machine_of(design).clearances.of(posture, singular=False)
    assert [c.distance for c in found] == sorted(c.distance for c in found)
    assert len(found) == 16  # two ends and a mode of each limb, and the boundary
    for clearance in found:
        away = np.subtract(clearance.point, posture.pose[:3])
        assert np.linalg.norm(away) == pytest.approx(clearance.distance, abs=1e-8)
        there = generic.posture(design, (*clearance.point, *posture.pose[3:]), posture.mode)
        if clearance.bound == "link":
            short = next(m.amount for m in there.margins if m.limb == clearance.limb)
            assert abs(short) < 1e-9
        else:
            assert abs(_beside(there, clearance)) < 1e-5  # near |Y| = l roundings grow
        assert clearance.error < 1e-6
        assert f"{clearance.distance:.1f} mm to" in clearance.text or clearance.distance < 0.1


@pytest.mark.parametrize("seed", range(6))
def test_boundary_is_the_largest_ball_of_the_mode(seed):
    design, posture = a_posture(seed)
    found = machine_of(design).clearances.of(posture, singular=False)
    boundary = next(c for c in found if c.kind == "boundary")
    ball = largest.sphere(design, *posture.pose[3:], (posture.mode,), posture.pose[:3])
    assert ball.radius == pytest.approx(boundary.distance, abs=1e-6)
    rng = np.random.default_rng(seed)
    ways = rng.normal(size=(2000, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)

    def all_held(radius):
        poses = np.column_stack(
            [posture.pose[:3] + radius * ways, np.tile(posture.pose[3:], (2000, 1))]
        )
        return inverse.inside(design, poses, [posture.mode]).all()

    assert all_held(boundary.distance - 1e-9)
    step = np.subtract(boundary.point, posture.pose[:3]) / boundary.distance
    outside = (*(boundary.point + 1e-6 * step), *posture.pose[3:])
    assert not generic.posture(design, outside, posture.mode).reachable


@pytest.mark.parametrize("seed", range(8))
def test_beyond_a_bound_the_way_back_is_negative(seed):
    design, posture = a_posture(seed, reachable=False)
    found = machine_of(design).clearances.of(posture, singular=False)
    beyond = {(c.limb, c.bound) for c in found if c.distance < 0.0}
    assert beyond == {(r.limb, r.bound) for r in posture.reasons}
    assert all(c.kind != "boundary" for c in found)
    for clearance in found:
        if clearance.distance < 0.0:
            assert "beyond" in clearance.text
            away = np.linalg.norm(np.subtract(clearance.point, posture.pose[:3]))
            assert away == pytest.approx(-clearance.distance, abs=1e-8)


@pytest.mark.parametrize("seed", range(4))
def test_motions_and_another_reference_point_leave_the_distances(seed):
    """The whole machine moved and turned about e₁, and another point of reference on it."""
    design, posture = a_posture(seed)
    rng = np.random.default_rng(seed)
    shift, other = rng.uniform(-300, 300, 3), rng.uniform(-80, 80, 3)
    about = rng.uniform(-1, 1)
    turn = rotation_y(about)
    limbs = tuple(
        Limb(
            tuple((turn @ limb.base + shift).tolist()),
            tuple(np.subtract(limb.platform, other).tolist()),
            limb.link,
            limb.stroke,
        )
        for limb in design.limbs
    )
    phi, theta = posture.pose[3:]
    turned = rotation_y(theta) @ rotation_x(phi)
    pose = (*(turn @ (posture.pose[:3] + turned @ other) + shift), phi, theta + about)
    moved = FiveRPURDesign(limbs)
    before = machine_of(design).clearances.of(posture, singular=False)
    there = generic.posture(moved, pose, posture.mode)
    after = machine_of(moved).clearances.of(there, singular=False)

    def table(found):
        return {(c.kind, c.limb, c.bound): c.distance for c in found if c.kind != "boundary"}

    assert table(after) == pytest.approx(table(before), abs=1e-9)


def test_a_stroke_from_zero_is_no_boundary():
    zero = (0.0, 0.0, 0.0)
    limb = Limb(zero, zero, 100.0, (0.0, 300.0))
    design = FiveRPURDesign((limb,) * 5)
    posture = generic.posture(design, (1.0, 0.0, 100.0, 0.0, 0.0), "+++++")
    found = machine_of(design).clearances.of(posture, singular=False)
    assert found[0].distance == pytest.approx(1.0)
    assert found[0].bound == "rho_min"
    boundary = next(c for c in found if c.kind == "boundary")
    assert boundary.distance == pytest.approx(100.0)
    assert boundary.bound == "link"
