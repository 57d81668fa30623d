"""Files of parallel mechanisms: short forms, chains, mobility, and what is said of wrong ones."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
import pytest

import kinematics as kin
from kinematics.mechanisms.parallel.limbs import turned
from tests.kinematics.mechanisms.parallel.machines import machine, text

WORDS = {
    "spherical-agile-eye": (3, "spherical", "φ θ ψ"),
    "delta": (3, "3T", "x y z"),
    "gough": (6, "6 degrees", "x y z φ θ ψ"),
    "prs-3": (3, "1T2R", "z φ θ"),
    "rrr-3": (3, "planar", "x y ψ"),
    "upu-3": (3, "3T", "x y z"),
}


@pytest.mark.parametrize("name", list(WORDS))
def test_motions_have_their_words_and_coordinates(name: str) -> None:
    m = kin.open(name)
    free, words, coordinates = WORDS[name]
    found = m.mechanism.machine.mobility  # type: ignore[attr-defined]
    assert found.free == free
    assert words in found.words
    assert [axis.symbol for axis in m.coordinates] == coordinates.split()


def test_parasitic_coordinates_are_told() -> None:
    assert any("x, y, ψ follow" in finding.text for finding in kin.open("prs-3").findings)


def test_every_sample_is_short() -> None:
    from kinematics.designs.assets import asset_folder

    for file in asset_folder("designs").glob("*.toml"):
        lines = file.read_text(encoding="utf-8").splitlines()
        if 'mechanism = "parallel"' in lines:
            assert len(lines) <= 25


# --- chains are the same as short forms ----------------------------------------------------


def short_and_long() -> list[tuple[str, dict[str, Any], Any, list[dict[str, Any]]]]:
    """A short form three or six times, and the chain of its first limb at the reference pose."""
    p = np.array([0.0, 0.0, 300.0])
    a, b = np.array([200.0, 10.0, 0.0]), np.array([90.0, 20.0, 5.0])
    leg = (p + b - a) / np.linalg.norm(p + b - a)
    y = np.array([0.0, 1.0, 0.0])
    side = np.cross(leg, y) / np.linalg.norm(np.cross(leg, y))

    def r(at: Any, axis: Any, **more: Any) -> dict[str, Any]:
        return {"joint": "R", "at": at, "axis": axis, **more}

    def s(at: Any) -> dict[str, Any]:
        return {"joint": "S", "at": at}

    slide = {"joint": "P", "axis": leg, "actuated": True}
    ups = [{"joint": "U", "at": a, "axes": [y, side]}, slide, s(p + b)]
    flat = p + np.array([90.0, 10.0, 5.0])
    straight = (flat - a) / np.linalg.norm(flat - a)
    rps = [r(a, y), {"joint": "P", "axis": straight, "actuated": True}, s(flat)]
    elbow = a + np.array([40.0, 0.0, 60.0])
    rus = [r(a, y, actuated=True), {"joint": "U", "at": elbow, "axes": [y, [1, 0, 0]]}, s(p + b)]
    prs = [{"joint": "P", "axis": [0, 0, 1], "actuated": True}, r(a, y), s(flat)]
    rrs = [r(a, y, actuated=True), r(elbow, y), s(flat)]
    stroke = [1.0, 2000.0]
    arm = elbow - a
    crank = float(np.linalg.norm(arm))
    rod, flat_rod = (float(np.linalg.norm(end - elbow)) for end in (p + b, flat))
    return [
        ("UPS", {"base": a, "platform": b, "stroke": stroke}, 6, ups),
        ("RPS", {"base": a, "axis": y, "platform": flat - p, "stroke": stroke}, 3, rps),
        (
            "RUS",
            {"base": a, "axis": y, "zero": arm, "platform": b, "crank": crank, "rod": rod},
            6,
            rus,
        ),
        (
            "PRS",
            {
                "base": a,
                "slide": [0, 0, 1],
                "axis": y,
                "platform": flat - p,
                "rod": float(np.linalg.norm(flat - a)),
            },
            3,
            prs,
        ),
        (
            "RRS",
            {"base": a, "axis": y, "zero": arm, "platform": flat - p, "links": [crank, flat_rod]},
            3,
            rrs,
        ),
    ]


@pytest.mark.parametrize("each", short_and_long(), ids=lambda each: each[0])
def test_a_chain_is_its_short_form(each: Any) -> None:
    name, keys, count, chain = each
    copies = 3
    position = [0.0, 0.0, 300.0]
    more: list[dict[str, Any]] = []
    if count == 6:  # three of another kind of place, so that nothing is singular
        other = turned(np.array([0.0, 0.0, 1.0]), 0.5)
        place = other @ np.array([210.0, 0.0, 0.0])
        more = [
            {
                "type": "UPS",
                "base": place,
                "platform": turned(np.array([0.0, 0.0, 1.0]), 1.4) @ np.array([95.0, 0.0, 0.0]),
                "stroke": [1.0, 2000.0],
                "repeat": 3,
            }
        ]
    one = machine([{"type": name, **keys, "repeat": copies}, *more], position)
    two = machine([{"joints": chain, "repeat": copies}, *more], position)
    assert one.coordinates == two.coordinates or [c.key for c in one.coordinates] == [
        c.key for c in two.coordinates
    ]
    rng = np.random.default_rng(2)
    sizes = np.array([0.1 if axis.unit == "rad" else 10.0 for axis in one.coordinates])
    poses = np.array(one.home.pose) + sizes * rng.uniform(-1, 1, (12, len(sizes)))
    shift = np.array(two.home.joints) - np.array(one.posture(one.home.pose, two.home.mode).joints)
    first, second = (m.mechanism.joints(poses, two.home.mode) for m in (one, two))
    np.testing.assert_allclose(first + shift, second, rtol=0, atol=1e-9)
    rows = [m.statics.at(poses, two.home.mode) for m in (one, two)]
    np.testing.assert_allclose(rows[0].rows, rows[1].rows, atol=1e-9)
    np.testing.assert_allclose(rows[0].gain, rows[1].gain, atol=1e-9)


# --- what is wrong is told -----------------------------------------------------------------

UPS = {"type": "UPS", "base": [200, 0, 0], "platform": [100, 0, 0], "stroke": [200, 500]}


def test_a_wrong_mobility_is_told_with_its_reason() -> None:
    with pytest.raises(kin.DesignError, match=r"mobility is 6 .*but 4 joints are actuated"):
        machine([{**UPS, "repeat": 4}], [0, 0, 300])
    flat = {
        "type": "RRR",
        "actuated": 1,
        "base": [[260, 0, 0], [-130, 225, 0]],
        "platform": [[80, 0, 0], [-40, 69, 0]],
        "links": [150, 150],
    }
    axis = [0.0, float(np.sin(np.radians(10))), float(np.cos(np.radians(10)))]
    across = np.array([0.0, axis[2], -axis[1]])
    start, end = np.array([-130.0, -225.0, 0.0]), np.array([-40.0, -69.0, 0.0])
    middle = start + 100.0 * across
    joints = [
        {"joint": "R", "at": at, "axis": axis, **({"actuated": True} if not n else {})}
        for n, at in enumerate((start, middle, end))
    ]
    with pytest.raises(kin.DesignError, match=r"mobility is 1 .*limbs 1 and 2 together.*limb 3"):
        machine([flat, {"joints": joints}], [0, 0, 0])


@pytest.mark.parametrize(
    ("limb", "said"),
    [
        ({"type": "UPZ"}, "no limb type 'UPZ'"),
        ({**UPS, "strok": [1, 2]}, "did you mean 'stroke'"),
        ({**UPS, "stroke": [500, 200]}, "min < max"),
        ({**UPS, "base": [[1, 0, 0], [2, 0, 0]], "platform": [[0, 0, 0]] * 3}, "3 limbs"),
        ({**UPS, "repeat": 20}, "whole number from 1 to 9"),
        ({"joints": [{"joint": "R", "at": [0, 0, 0], "axis": [0, 0, 1]}]}, "2 to 6 joints"),
        (
            {**UPS, "base": [[1, 0, 0], [2, 0]]},
            r"point 2 of base must have 3 numbers \(x, y, z in mm\), got 2",
        ),
        (
            {"joints": [{"joint": "R", "at": [0, 0, 0], "axis": [0, 0, 0]}] * 2},
            "limb 1: .*axis.* must be a direction",
        ),
        (
            {
                "joints": [
                    {"joint": "R", "at": [0, 0, 0], "axis": [1, 0, 0], "actuated": True},
                    {"joint": "R", "at": [0, 5, 0], "axis": [0, 1, 0]},
                    {"joint": "P", "axis": [0, 0, 1]},
                ],
                "repeat": 3,
            },
            "limb 1: the chain R R P .* known are UPS",
        ),
        (
            {
                "joints": [
                    {"joint": "U", "at": [200, 0, 0], "axes": [[1, 0, 0], [0, 1, 0]]},
                    {"joint": "P", "axis": [0, 0, 1], "actuated": True},
                    {"joint": "S", "at": [100, 0, 300]},
                ],
                "repeat": 6,
            },
            "limb 1: its P joint must slide along the line",
        ),
        (
            {
                "type": "RUS",
                "base": [200, 0, 0],
                "axis": [0, 1, 0],
                "platform": [100, 0, 0],
                "crank": 10,
                "rod": 50,
                "repeat": 6,
            },
            r"limb 1 \(RUS\) cannot reach the reference pose",
        ),
    ],
)
def test_wrong_limbs_are_refused_with_place_and_remedy(limb: dict[str, Any], said: str) -> None:
    with pytest.raises(kin.DesignError, match=said):
        machine([limb], [0, 0, 300])


def test_a_rough_reference_pose_is_closed() -> None:
    limb = {
        "type": "RPS",
        "base": [200, 0, 0],
        "axis": [0, 1, 0],
        "platform": [120, 0, 0],
        "stroke": [100, 600],
        "repeat": 3,
    }
    m = machine([limb], [3.0, -2.0, 300.0], turn=[4.0, 0.0, 3.0])
    assert m.home.residual < 1e-10
    assert any("moved by" in finding.text for finding in m.findings)


def test_lengths_may_be_in_another_unit() -> None:
    legs = {
        "base": [[0.3, -0.06, 0], [0.3, 0.06, 0]],
        "platform": [[0.1, -0.11, 0], [0.1, 0.11, 0]],
    }
    metres = text([{"type": "UPS", **legs, "stroke": [0.3, 0.7], "repeat": 3}], [0, 0, 0.4])
    m = kin.read('units = "m"\n' + metres)
    assert m.home.pose[2] == 400.0
    assert m.home.joints[0] == pytest.approx(np.hypot(np.hypot(200.0, 50.0), 400.0))
    again = kin.read(kin.write(m))
    assert again.design == m.design


@pytest.mark.parametrize("name", [p.name for p in kin.presets() if p.mechanism == "parallel"])
def test_every_length_of_a_sample_is_read_in_its_unit(name: str) -> None:
    m = kin.open(name)
    table = deepcopy(m.table)
    for field in m.fields:
        if field.unit == "mm":
            *way, last = field.path
            place: Any = table
            for step in way:
                place = place[step]
            place[last] = place[last] / 10.0
    again = m.mechanism.read_design({**table, "units": "cm"}, origin="", name=name)
    mechanism = type(m.mechanism)(again)
    assert [axis.unit for axis in mechanism.coordinates] == [axis.unit for axis in m.coordinates]
    for one, two in zip(mechanism.design_fields(), m.fields, strict=True):
        assert one.value == pytest.approx(two.value, rel=1e-14)


def test_the_number_of_modes_is_that_of_the_branches() -> None:
    counts = {"gough": 1, "rus-6": 64, "delta": 8, "prs-3": 16, "rrr-3": 8}
    assert {name: len(kin.open(name).modes) for name in counts} == counts
