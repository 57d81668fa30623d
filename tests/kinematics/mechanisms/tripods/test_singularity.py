"""The polynomial P against the determinant of the wrenches, and what singular postures are told."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from kinematics.facets import inverse as generic
from kinematics.machine import machine_of
from kinematics.mechanisms.tripods import (
    polynomial,
    posing,
    singularities,
)
from kinematics.mechanisms.tripods.design import KINDS, MODES, Kind, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.limbs import limb_lengths
from tests.kinematics.mechanisms.tripods.machines import (
    NAMES,
    machine,
    some_machines,
    some_poses,
    stored,
)

STORED = stored("rps_spr_singularity.json")


@pytest.mark.parametrize("case", STORED["poses"], ids=lambda c: f"{c['mech']}-{c['mode']}-{c['Z']}")
def test_the_reference_determinants(case: dict) -> None:
    kind, mode = NAMES[case["mech"]], str(case["mode"])
    design = machine(kind, case["h1"], case["h2"])
    pose = np.array([case["Z"], case["theta"], case["phi"]])
    k = mode_sign(mode) * case["h2"]
    value = polynomial.value(kind, case["h1"], k, *pose[:2], np.sin(3 * pose[2]))
    assert value == pytest.approx(case["P"], rel=1e-11)
    lengths = np.prod(case["leg_lengths"])
    whole = machine_of(design).statics.wrenches(pose, mode).determinant * lengths * case["h2"] ** 3
    assert whole == pytest.approx(case["det6_unnormalised_wrench"], rel=1e-11)


@pytest.mark.parametrize(
    "case",
    STORED["singular_theta"],
    ids=lambda c: f"{c['mech']}-{c['mode']}-{c['h2']}-{c['phi']:.1f}",
)
def test_the_reference_singular_tilts(case: dict) -> None:
    kind = NAMES[case["mech"]]
    k = mode_sign(str(case["mode"])) * case["h2"]
    w = np.sin(3 * case["phi"])

    def p(tilt: float) -> float:
        return float(polynomial.value(kind, case["h1"], k, case["Z"], tilt, w))

    grid = np.linspace(1e-3, np.pi - 1e-3, 4000)
    signs = np.sign([p(t) for t in grid])
    found = [brentq(p, grid[n], grid[n + 1]) for n in np.flatnonzero(np.diff(signs))]
    # The 3-RPS of the paper's example has a fivefold zero at 90°, of which rounding leaves 1e-3.
    manifold = case["mech"] == "RPS" and case["mode"] == 1 and case["h2"] == 2.0
    np.testing.assert_allclose(found, case["theta_singular"], atol=1e-3 if manifold else 1e-6)


def determinant_from_polynomial(design: TripodDesign, poses: np.ndarray, mode: str) -> np.ndarray:
    """± the determinant of the unnormed wrenches by P: 6.75 x h2³ P, or 6.75 x h1³ P / cos² θ."""
    z, tilt, azimuth = poses.T
    k = mode_sign(mode) * design.platform_radius
    value = polynomial.value(
        design.mechanism, design.base_radius, k, z, tilt, np.sin(3.0 * azimuth)
    )
    found = 6.75 * np.cos(0.5 * tilt) * design.spherical_radius**3 * value
    return found if design.revolute_on_base else found / np.cos(tilt) ** 2


def test_the_determinant_is_the_polynomial_at_random_poses(rng: np.random.Generator) -> None:
    for design in some_machines(rng, 60):
        for mode in MODES:
            poses = some_poses(rng, 30)
            lengths = limb_lengths(design, poses, mode).prod(axis=-1)
            unit = machine_of(design).statics.wrenches(poses, mode).determinant
            whole = unit * lengths * design.platform_radius**3
            wanted = determinant_from_polynomial(design, poses, mode)
            sign = np.sign(whole[0] * wanted[0])
            scale = lengths * design.platform_radius**3
            assert (np.abs(whole - sign * wanted) / scale).max() < 1e-11


def test_solutions_merge_where_p_is_zero(rng: np.random.Generator) -> None:
    """At an actuation singularity two assembly modes of one operation mode coincide."""
    design, mode = machine("three_spr", 100.0, 200.0), "2"
    pose = np.array([100.0, np.pi / 6, -np.pi / 6])  # where the MICR is met
    lengths = limb_lengths(design, pose, mode)
    found = machine_of(design).forward(lengths)
    apart = machine_of(design).forward.distances(pose[None], (mode,), found.poses, found.modes)[0]
    n = int(apart.argmin())
    assert apart[n] < 1e-4
    assert found.multiplicity[n] == 2 or found.gap[n] < 1e-2


@pytest.mark.parametrize("kind", KINDS)
def test_both_modes_meet_at_180_degrees(kind: Kind) -> None:
    design = machine(kind)
    for mode in MODES:
        there = generic.posture(design, (150.0, np.pi, 0.7), mode)
        change = machine_of(design).singularities.mode_change(there)
        assert change.here
        assert change.turn == 0.0
        assert change.other.mode != mode
        one, two = (posing.transform(design, p.pose, p.mode) for p in (change.at, change.other))
        np.testing.assert_allclose(one, two, atol=1e-10)
        np.testing.assert_allclose(change.at.joints, change.other.joints, atol=1e-10)
        back = singularities.in_other_mode(design, change.other)
        np.testing.assert_allclose(back.pose, change.at.pose, atol=1e-12)
        (lost,) = machine_of(design).singularities.at(there)
        assert lost.kind == "constraint"
        assert lost.limbs == (1, 2, 3)
        assert lost.measure < 1e-12
    level = generic.posture(design, (150.0, 0.2, 0.7), "2")
    change = machine_of(design).singularities.mode_change(level)
    assert not change.here
    assert change.turn == pytest.approx(np.pi - 0.2)
    assert change.at.pose == (150.0, np.pi, 0.7)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mode", MODES)
def test_modes_meet_nowhere_else(kind: Kind, mode: str, rng: np.random.Generator) -> None:
    """The constraint wrenches alone are dependent at a tilt of 180° only."""
    design, poses = machine(kind), some_poses(rng, 300)
    rows = machine_of(design).statics.wrenches(poses, mode).rows[:, 3:] / [1, 1, 1, *(3 * [160.0])]
    least = np.linalg.svd(rows, compute_uv=False)[:, -1]
    assert (least > 1e-3 * np.cos(0.5 * poses[:, 1])).all()


def test_an_actuation_singularity_is_named_with_its_free_motion() -> None:
    design = machine("three_spr", 100.0, 200.0)
    there = generic.posture(design, (100.0, np.pi / 6, -np.pi / 6), "2")
    (lost,) = machine_of(design).singularities.at(there)
    assert lost.kind == "parallel"
    assert lost.motion is not None
    step = 1e-5 * np.array(lost.motion)
    moved = limb_lengths(design, np.array(there.pose) + step, "2")
    assert np.abs(moved - there.joints).max() < 1e-8


def test_a_limb_without_length_is_a_serial_singularity() -> None:
    design = machine("three_rps", 100.0, 100.0)
    there = generic.posture(design, (0.0, 0.0, 0.0), "2")
    (lost,) = machine_of(design).singularities.at(there)
    assert lost.kind == "serial"
    assert lost.limbs == (1, 2, 3)


def test_parasitic_motions_are_those_of_the_paper(rng: np.random.Generator) -> None:
    """RPS: X = k s² cos 2φ, Y = −k s² sin 2φ; SPR by its own formula, of the same pose."""
    for design in some_machines(rng, 10):
        for mode in MODES:
            poses = some_poses(rng, 20)
            z, tilt, azimuth = poses.T
            c, s = np.cos(tilt / 2), np.sin(tilt / 2)
            x, y = np.moveaxis(machine_of(design).mechanism.placement(poses, mode)[:, :2, 3], -1, 0)
            if design.revolute_on_base:
                k = mode_sign(mode) * design.platform_radius
                np.testing.assert_allclose(x, k * s**2 * np.cos(2 * azimuth), atol=1e-10)
                np.testing.assert_allclose(y, -k * s**2 * np.sin(2 * azimuth), atol=1e-10)
                continue
            h1, cosine = design.base_radius, np.cos(tilt)
            along = s**2 * np.cos(4 * azimuth) - c**2 * np.cos(2 * azimuth)
            across = s**2 * np.sin(4 * azimuth) + c**2 * np.sin(2 * azimuth)
            lean = z * np.sin(tilt)
            np.testing.assert_allclose(
                x * cosine, h1 * s**2 * along + lean * np.sin(azimuth), atol=1e-9
            )
            np.testing.assert_allclose(
                y * cosine, h1 * s**2 * across - lean * np.cos(azimuth), atol=1e-9
            )
