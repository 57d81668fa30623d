"""Forward kinematics against sets of solutions computed by other means."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kinematics as kin
from kinematics.homotopy.solving import cluster, solve
from kinematics.mechanisms.parallel.forward import monodromy, searching, study, trace
from kinematics.mechanisms.parallel.limbs import turned
from tests.kinematics.mechanisms.parallel.machines import (
    apart,
    case,
    machine,
    placements,
    wanted,
)


def agree(m: kin.Machine[Any], joints: Any, poses: Any, count: int, near: float = 1e-7) -> None:
    """All reference poses are found and no others, and the count is complete."""
    found = m.forward(joints)
    assert found.complex_count == count
    assert found.complete, found.evidence
    assert found.residual.max() < 1e-9 * m.length
    there, reference = placements(found, m), wanted(poses)
    assert len(there) == len(reference)
    assert apart(there, reference) < near
    assert apart(reference, there) < near


def ups(one: dict[str, Any], start: int = 0) -> kin.Machine[Any]:
    pose = one["real_poses"][start]
    limbs = [{"type": "UPS", "base": one["base"], "platform": one["platform"], "stroke": [1, 3000]}]
    return machine(limbs, pose["position"], rotation=pose["rotation"])


@pytest.mark.parametrize("name", ["gough_dietmaier", "gough_hexagons_a", "random6ups_21"])
def test_gough_platforms(name: str) -> None:
    one = case(name)
    agree(ups(one), one["lengths"], one["real_poses"], one["complex_count"], near=1e-6)


@pytest.mark.parametrize(("name", "count"), [("rus6_open", 40), ("prs_open", 16)])
def test_cranks_and_sliders(name: str, count: int) -> None:
    one = case(name)
    agree(kin.read(one["toml"]), one["actuated"], one["real_poses"], count, near=1e-6)


@pytest.mark.parametrize("name", ["rps_general_5", "rps_equilateral_4"])
def test_three_rps(name: str) -> None:
    one = case(name)
    pose = one["real_poses"][-1]
    keys = ("base", "platform", "axis")
    limb = {"type": "RPS", **{key: one[key] for key in keys}, "stroke": [1, 3000]}
    m = machine([limb], pose["position"], rotation=pose["rotation"])
    assert len(m.modes) == 2
    agree(m, one["lengths"], one["real_poses"], 16)


@pytest.mark.parametrize(("name", "kind"), [("planar_3rpr_1", "RPR"), ("planar_3rrr_1", "RRR")])
def test_planar_machines(name: str, kind: str) -> None:
    one = case(name)
    limb: dict[str, Any] = {"type": kind}
    limb |= {key: [[*point, 0.0] for point in one[key]] for key in ("base", "platform")}
    if kind == "RPR":
        limb["stroke"] = [1, 3000]
    else:
        links = zip(one["crank"], one["rod"], strict=True)
        limb |= {"links": [list(pair) for pair in links], "actuated": 1}
    x, y, turn = one["real_poses"][0]
    m = machine([limb], [x, y, 0.0], turn=[0.0, 0.0, float(np.degrees(turn))])
    found = m.forward(one.get("lengths") or one["actuated"])
    assert (found.complex_count, found.complete, len(found)) == (6, True, len(one["real_poses"]))
    off = np.abs(found.poses[:, None] - np.array(one["real_poses"])[None]).max(axis=2)
    assert off.min(axis=0).max() < 1e-9 * 300.0


def spherical(one: dict[str, Any]) -> kin.Machine[Any]:
    axes = zip(one["u"], one["v"], one["w"], strict=True)
    limbs = [
        {
            "joints": [
                {"joint": "R", "at": [0, 0, 0], "axis": axis}
                | ({"actuated": True} if not n else {})
                for n, axis in enumerate(each)
            ]
        }
        for each in axes
    ]
    return machine(limbs, [0.0, 0.0, 0.0])


@pytest.mark.parametrize("name", ["spherical_31", "agile_eye"])
def test_spherical_machines(name: str) -> None:
    one = case(name)
    m = spherical(one)
    found = m.forward(one["actuated"])
    assert (found.complex_count, found.complete) == (8, True)
    reference = wanted([{"rotation": r} for r in one["real_rotations"]])
    assert len(found) == len(reference)
    assert apart(placements(found, m), reference) < 1e-9


def test_delta() -> None:
    one, m = case("delta_irb340"), kin.open("delta")
    for each in one["forward"]:
        found = m.forward(each["actuated"])
        assert (found.complex_count, found.complete) == (2, True)
        off = np.abs(found.poses[:, None] - np.array(each["positions"])[None]).max(axis=2)
        assert off.min(axis=0).max() < 1e-4  # the file's dimensions have four decimals
    for each in one["inverse"]:
        both = np.array(m.inverse(each["pose"]).joints)[[-1, 0]].T
        turned = np.exp(1j * both) - np.exp(1j * np.array(each["actuated_by_limb_small_large"]))
        assert np.abs(turned).max() < 1e-6


@pytest.mark.parametrize("preset", ["upu-3", "rus-6", "gough", "prs-3"])
def test_closed_forms_and_paths_agree_with_a_search(preset: str) -> None:
    """Newton's method from many places finds no solution that is not in the set."""
    m = kin.open(preset)
    rng = np.random.default_rng(5)
    joints = np.array(m.home.joints) + 1e-2 * rng.normal(size=len(m.joints)) * [
        1.0 if axis.unit == "rad" else m.length for axis in m.joints
    ]
    found = m.forward(joints)
    (searched,) = searching.solve(m.mechanism.machine, joints[None])  # type: ignore[attr-defined]
    there = searched.placements
    if preset == "upu-3":  # its limbs can be assembled with a turned platform as well
        there = there[np.abs(there[:, :3, :3] - np.eye(3)).max(axis=(1, 2)) < 1e-6]
    assert len(there) >= 1
    assert apart(placements(found, m), there) < 1e-6 * m.length


def test_it_is_told_that_a_search_may_miss_solutions() -> None:
    limb = {
        "type": "RPUR",
        "base": [[-55, 30, 50], [245, 30, 50], [20, 205, 0], [200, 180, 0], [0, 0, 0]],
        "platform": [[-50, 0, 0], [50, 0, 0], [0, 50, 0], [0, 50, -50], [0, -50, -50]],
        "base_axis": [0, 1, 0],
        "platform_axis": [1, 0, 0],
        "link": 150,
        "stroke": [150, 500],
    }
    m = machine([limb], [80, 90, 400], turn=[5, 8, 0])
    found = m.forward(m.home.joints)
    assert not found.complete
    assert apart(placements(found, m), m.transform(m.home.pose, m.home.mode)[None]) < 1e-6
    assert any("may be missing" in note for note in found.notes)


# --- start sets ----------------------------------------------------------------------------


@pytest.mark.parametrize("of", list(monodromy.COUNTS))
def test_stored_sets_are_solutions_that_differ(of: study.Signature) -> None:
    stored, closure = study.general_set(of), study.equations(of)
    settled, error = closure.polish(stored.parameters, stored.roots)
    assert error.max() < 1e-11
    assert len(np.unique(cluster(closure, settled))) == stored.roots.shape[1]
    assert stored.roots.shape[1] == monodromy.COUNTS[of]


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("of", list(monodromy.COUNTS))
def test_a_trace_proves_that_none_is_missing(of: study.Signature) -> None:
    stored, closure = study.general_set(of), study.equations(of)
    root, _ = closure.polish(stored.parameters, stored.roots[:, :1])
    found = trace.traced(closure, stored.parameters, root, np.random.default_rng(3))
    assert found.whole
    assert found.finite == monodromy.COUNTS[of]


def test_loops_in_the_lengths_alone_are_never_called_complete() -> None:
    """Part of a start set: what is missing shows, as conjugates are."""
    of = (6, 0, 0)
    m = ups(case("random6ups_21"))
    whole = study.general_set(of)
    frame = study.Frame.of(m.mechanism.machine)  # type: ignore[attr-defined]
    target = frame.limbs(m.mechanism.machine, np.array([m.home.joints]))  # type: ignore[attr-defined]
    short = replace(whole, roots=whole.roots[:, :31])
    (found,) = solve(study.equations(of), short, target, real=True)
    assert found.count < 40
    assert not found.complete


# --- limb types mixed ----------------------------------------------------------------------


def mixed(kinds: str, seed: int) -> kin.Machine[Any]:
    """A random machine of some limbs, about a circle."""
    rng = np.random.default_rng(seed)
    types = kinds.split()

    def about(vector: Any, n: int, by: float) -> list[float]:
        turn = turned(np.array([0.0, 0.0, 1.0]), 2.0 * np.pi * n / len(types))
        found = turn @ np.array(vector, dtype=float) + rng.uniform(-by, by, 3)
        return [float(v) for v in found]

    limbs = []
    for n, kind in enumerate(types):
        limb: dict[str, Any] = {"type": kind, "base": about((250, 0, 0), n, 12.0)}
        limb["platform"] = about((120, 20, 0), n, 12.0)
        axis = about((0, 1, 0), n, 0.15)
        if kind in ("UPS", "RPS", "SPR"):
            limb["stroke"] = [100, 900]
        if kind in ("RPS", "PRS", "RUS"):
            limb["axis"] = axis
        if kind == "SPR":
            limb["platform_axis"] = axis
        if kind in ("PUS", "PRS"):
            limb |= {"slide": [0, 0, 1], "rod": 430, "mode": "-"}
        if kind == "RUS":
            limb |= {"zero": [0, 0, 1], "crank": 200, "rod": 350}
        limbs.append(limb)
    return machine(limbs, [5.0, 3.0, 300.0], turn=[3.0, -4.0, 5.0])


@pytest.mark.parametrize(
    ("kinds", "count"),
    [
        ("UPS RUS PUS UPS RUS PUS", 40),
        ("UPS RUS PUS UPS RPS", 40),
        ("UPS PUS RPS PRS", 32),
        ("UPS RUS RPS SPR", 24),
        ("RPS PRS SPR", 16),
    ],
)
def test_limb_types_may_be_mixed(kinds: str, count: int) -> None:
    m = mixed(kinds, 4)
    found = m.forward(m.home.joints)
    assert (found.complex_count, found.complete) == (count, True), found.evidence
    there = placements(found, m)
    (searched,) = searching.solve(m.mechanism.machine, np.array([m.home.joints]))  # type: ignore[attr-defined]
    assert apart(there, searched.placements) < 1e-6 * m.length
    assert apart(there, m.transform(m.home.pose, m.home.mode)[None]) < 1e-6 * m.length
