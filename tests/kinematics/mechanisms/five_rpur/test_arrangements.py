"""Arrangements by the paper's conditions; architectural singularity against the wrenches."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import combinations, permutations
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.designs.files import presets
from kinematics.mechanisms.five_rpur.arrangements import (
    Pair,
    arrangements,
)
from kinematics.mechanisms.five_rpur.design import MODES, TOLERANCE, FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.findings import findings, singular_modes
from kinematics.mechanisms.five_rpur.inverse import inside, joint_points
from tests.kinematics.mechanisms.five_rpur.asked import wrench_matrix
from tests.kinematics.mechanisms.five_rpur.machines import preset
from tests.kinematics.references import read

CASES: list[dict[str, Any]] = read("rpur_forward.json")["cases"]
CLASSES = ("A1A1", "A1A2", "A1A3", "A2A2", "A2A3", "A3A3", "MpA1", "MpA2", "MpA3")


def of(*limbs: tuple[Any, Any], link: float = 150.0) -> FiveRPURDesign:
    made = [
        Limb(tuple(map(float, a)), tuple(map(float, c)), link, (250.0, 400.0)) for a, c in limbs
    ]
    one, two, three, four, five = made
    return FiveRPURDesign((one, two, three, four, five))


def random_points(count: int, seed: int = 0) -> tuple[list[Any], list[Any]]:
    rng = np.random.default_rng(seed)
    base, platform = rng.uniform(-200, 200, (count, 3)), rng.uniform(-80, 80, (count, 3))
    base[:, 1] = rng.uniform(-40, 40, count)
    return base.tolist(), platform.tolist()


def pair(kind: str, a: Any, c: Any, seed: int) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    x, z, s = np.random.default_rng(seed).uniform(-90, 90, 3)
    other_a = a if kind in ("A2", "same") else [x, a[1], z]
    other_c = c if kind in ("A1", "same") else [s, c[1], c[2]]
    return (a, c), (other_a, other_c)


def build(name: str, seed: int = 0) -> FiveRPURDesign:
    """A random design of a class: "A1A3", "MpA2", "MpA1A3", …"""
    base, platform = random_points(5, seed)
    kinds = [name[k : k + 2] for k in range(0, len(name), 2)]
    middle, kinds = kinds[0] == "Mp", [k for k in kinds if k != "Mp"]
    limbs: list[tuple[Any, Any]] = []
    for n, kind in enumerate(kinds):
        limbs += pair(kind, base[n], platform[n], seed + 10 * n)
        if middle and n == 0:
            limbs.append(pair("A3", base[n], platform[n], seed + 5)[1])
    limbs += [(base[n], platform[n]) for n in range(2, 2 + 5 - len(limbs))]
    return of(*limbs)


# --- recognising ---------------------------------------------------------------------------


@pytest.mark.parametrize("name", CLASSES)
def test_presets_are_exactly_of_their_class(name: str) -> None:
    design = preset(f"rpur-{name.lower()}")
    found = arrangements(design)
    assert found.name == f"{{{name}}}"
    assert not found.reasons
    assert singular_modes(design) == ()
    assert not [f for f in findings(design) if f.severity == "warning"]
    assert not [f for f in findings(design) if f.title == "Nearly an arrangement"]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_reference_geometries_are_of_the_class_that_they_say(case: dict[str, Any]) -> None:
    rows = zip(case["r"], case["s_prime"], case["l"], strict=True)
    limbs = tuple(Limb(tuple(r), tuple(s), link, (250.0, 400.0)) for r, s, link in rows)
    found = arrangements(FiveRPURDesign(limbs))  # type: ignore[arg-type]
    if case["design"].startswith("general"):
        assert found.name in ("", "{A3}")
        return
    assert found.name == f"{{{case['design']}}}"
    groups = [[i - 1 for i in group.limbs] for group in found.groups]
    assert sorted(groups) == sorted(case["same_working_mode_groups"])


def test_the_paper_tables() -> None:
    for name in ("rpur-table1", "rpur-table1-icee"):
        found = arrangements(preset(name))
        assert found.name == "{A3}"
        assert [group.limbs for group in found.groups] == [(1, 2)]
    found = arrangements(preset("rpur-table2"))
    assert found.name == "{A1A1}"
    assert [group.pairs for group in found.groups] == [
        (Pair((1, 2), "A1"),),
        (Pair((3, 4), "A1"),),
    ]


@pytest.mark.parametrize("name", CLASSES)
def test_the_class_depends_on_no_order_and_no_frame(name: str) -> None:
    design = build(name, seed=3)
    assert arrangements(design).name == f"{{{name}}}"
    rng = np.random.default_rng(1)
    for order in list(permutations(range(5)))[::17]:
        shift, offset = rng.uniform(-100, 100, 3), rng.uniform(-50, 50, 3)
        limbs = tuple(
            replace(
                design.limbs[i],
                base=tuple((design.base[i] + shift).tolist()),
                platform=tuple((design.platform[i] + offset).tolist()),
            )
            for i in order
        )
        found = arrangements(FiveRPURDesign(limbs))  # type: ignore[arg-type]
        assert found.name == f"{{{name}}}"
        before = [sorted(group.limbs) for group in arrangements(design).groups]
        after = [sorted(order[i - 1] + 1 for i in group.limbs) for group in found.groups]
        assert sorted(before) == sorted(after)


def test_each_condition_counts() -> None:
    """Breaking one of the three undoes the arrangement; within the tolerance it holds."""
    design = preset("rpur-table2")
    limb = design.limbs[0]
    x, y, z = limb.base
    sx, sy, sz = limb.platform
    assert design.size == 400.0
    for by, expected in ((1e-3, "{A1}"), (0.4 * TOLERANCE * design.size, "{A1A1}")):
        for changed in (
            replace(limb, base=(x, y + by, z)),
            replace(limb, link=limb.link + by),
            replace(limb, platform=(sx, sy + by, sz)),
            replace(limb, platform=(sx, sy, sz - by)),
        ):
            found = arrangements(FiveRPURDesign((changed, *design.limbs[1:])))
            assert found.name == expected
    moved = replace(limb, platform=(sx + 1e-3, sy, sz))
    assert arrangements(FiveRPURDesign((moved, *design.limbs[1:]))).name == "{A1A3}"


def test_same_mode_pairs_keep_their_second_links_parallel() -> None:
    """What the conditions are for: v_i ∥ v_j and B_i B_j ∥ e2, eqs. 7 and 8."""
    rng = np.random.default_rng(2)
    for name in ("A1A2", "A2A3", "MpA3"):
        design = build(name, seed=5)
        poses = np.column_stack([rng.uniform(-150, 150, (4000, 3)), rng.uniform(-1, 1, (4000, 2))])
        _, b, c = joint_points(design, poses, "+++++")
        ok = np.isfinite(b).all(axis=(1, 2))
        assert ok.sum() > 50
        e2 = np.stack([np.cos(poses[:, 4]), 0 * poses[:, 4], -np.sin(poses[:, 4])], axis=-1)[ok]
        for group in arrangements(design).groups:
            for i, j in combinations([k - 1 for k in group.limbs], 2):
                v = (c - b)[ok]
                np.testing.assert_allclose(v[:, i], v[:, j], atol=1e-10)
                offset = design.platform[j, 0] - design.platform[i, 0]
                np.testing.assert_allclose((b[:, j] - b[:, i])[ok], offset * e2, atol=1e-9)


# --- architectural singularity, against the wrenches themselves ------------------------------


def smallest_singular_values(design: FiveRPURDesign, mode: str) -> np.ndarray:
    """Of the six wrenches at random poses at which all limbs close, stroke or not."""
    rng = np.random.default_rng(7)
    count = 6000
    position = design.base.mean(axis=0) + rng.uniform(-300, 300, (count, 3))
    position[:, 1] = design.base[:, 1].mean() + rng.uniform(-150, 150, count)
    poses = np.column_stack([position, rng.uniform(-np.pi, np.pi, (count, 2))])
    _, b, _ = joint_points(design, poses, mode)
    poses = poses[np.isfinite(b).all(axis=(1, 2))]
    assert len(poses) >= 20
    matrix = wrench_matrix(design, poses, mode, length=design.length)
    return np.asarray(np.linalg.svd(matrix, compute_uv=False)[:, -1])


def alike(design: FiveRPURDesign, mode: str) -> bool:
    groups = arrangements(design).groups
    return all(len({mode[i - 1] for i in group.limbs}) == 1 for group in groups)


SINGULAR = {
    **{f"Mp{i}{j}": build(f"Mp{i}{j}", 2) for i in ("A1", "A2", "A3") for j in ("A1", "A2", "A3")},
    "four in a group": of(
        ([0, 0, 0], [0, 10, 0]),
        ([90, 0, 10], [50, 10, 0]),
        ([-80, 0, 30], [-60, 10, 0]),
        ([40, 0, -70], [20, 10, 0]),
        ([30, 40, 20], [-10, -50, 20]),
    ),
    "five in a group": of(
        *[([40 * k, 0, 5 * k * k], [20 * k - 50, 10, 0]) for k in range(5)],
    ),
    "three on one platform point": of(
        ([0, 0, 0], [30, 10, 0]),
        ([90, 0, 10], [30, 10, 0]),
        ([-80, 0, 30], [30, 10, 0]),
        ([40, 30, -70], [-20, -40, 15]),
        ([30, 40, 20], [-10, -50, 20]),
    ),
    "three on one base point": of(
        ([0, 0, 0], [30, 10, 0]),
        ([0, 0, 0], [-40, 10, 0]),
        ([0, 0, 0], [5, 10, 0]),
        ([40, 30, -70], [-20, -40, 15]),
        ([30, 40, 20], [-10, -50, 20]),
    ),
    "coincident limbs": of(
        ([0, 0, 0], [30, 10, 0]),
        ([0, 0, 0], [30, 10, 0]),
        ([-80, 10, 30], [30, -30, 10]),
        ([40, 30, -70], [-20, -40, 15]),
        ([30, 40, 20], [-10, -50, 20]),
    ),
    "coincident limbs and a third": of(
        ([0, 0, 0], [30, 10, 0]),
        ([0, 0, 0], [30, 10, 0]),
        ([-80, 0, 30], [-30, 10, 0]),
        ([40, 30, -70], [-20, -40, 15]),
        ([30, 40, 20], [-10, -50, 20]),
    ),
}
IN_ALL_MODES = {
    "platform points on a line along e2": of(
        *[([60 * k - 100, 20 * k - 40, 9 * k * k], [30 * k - 70, 12, -5]) for k in range(5)]
    ),
    "base points on a line along e1": of(
        *[([15, 25 * k - 50, -7], [13 * k - 30, 10 * k * k - 70, 20 - 9 * k]) for k in range(5)]
    ),
}


@pytest.mark.parametrize("name", SINGULAR)
def test_singular_combinations_are_named_and_are_singular(name: str) -> None:
    design = SINGULAR[name]
    found = arrangements(design)
    assert found.architecturally_singular
    mode = "+++++"
    assert smallest_singular_values(design, mode).max() < 1e-10
    expected = {m for m in MODES if alike(design, m)}
    modes = set(singular_modes(design))
    assert expected <= modes
    # Not more than said: some mode that moves a group's limbs differently can hold the platform.
    if name not in ("four in a group", "five in a group"):
        other = next(m for m in MODES if m not in modes)
        assert np.median(smallest_singular_values(design, other)) > 1e-4
    warnings = [f for f in findings(design) if f.severity == "warning"]
    assert warnings
    assert {f.title for f in warnings} == {"Architecturally singular"}


@pytest.mark.parametrize("name", IN_ALL_MODES)
def test_lines_of_points_are_singular_in_all_modes(name: str) -> None:
    design = IN_ALL_MODES[name]
    assert set(singular_modes(design)) == set(MODES)
    assert smallest_singular_values(design, "+-+--").max() < 1e-10
    assert "in any working mode" in arrangements(design).reasons[0]


@pytest.mark.parametrize("name", CLASSES)
@pytest.mark.parametrize("seed", [11, 12])
def test_the_nine_classes_are_not_singular(name: str, seed: int) -> None:
    design = build(name, seed)
    assert arrangements(design).name == f"{{{name}}}"
    assert not arrangements(design).architecturally_singular
    assert singular_modes(design) == ()
    assert np.median(smallest_singular_values(design, "+++++")) > 1e-4


@given(st.integers(0, 10**6))
def test_random_designs_are_general(seed: int) -> None:
    base, platform = random_points(5, seed)
    design = of(*zip(base, platform, strict=True))
    found = arrangements(design)
    assert (found.groups, found.name, found.reasons) == ((), "", ())
    assert singular_modes(design) == ()


# --- what is said --------------------------------------------------------------------------


def titles(design: FiveRPURDesign) -> list[str]:
    return [finding.title for finding in findings(design)]


def test_a_simplified_design_is_explained() -> None:
    said = {f.title: f for f in findings(preset("rpur-table2"))}
    assert "96 solutions" in said["Simplified design {A1A1}"].text
    assert "closed form" in said["Simplified design {A1A1}"].text
    assert said["Arrangement A1"].limbs == (3, 4)
    assert "limbs 1 and 2" in said["Self-motion"].text
    assert all(finding.severity == "info" for finding in said.values())
    # {A3A3}: univariate; the general design: neither.
    a3a3 = next(f for f in findings(preset("rpur-a3a3")) if "A3A3" in f.title)
    assert "192" in a3a3.text
    assert "polynomial" in a3a3.text


def lengths_and_smallest(design: FiveRPURDesign, pose: Any) -> tuple[np.ndarray, float]:
    a, b, _ = joint_points(design, pose, "+++++")
    matrix = wrench_matrix(design, pose, "+++++", length=design.length)
    return np.linalg.norm(b - a, axis=-1), float(np.linalg.svd(matrix, compute_uv=False)[-1])


def test_the_a1a1_self_motion_is_there_and_is_told() -> None:
    """s12 = s34, and both U joints on one line along e1: θ is free (after eq. 12)."""
    design = preset("rpur-table2")
    assert "Self-motion" in titles(design)
    assert "Self-motion" not in titles(preset("rpur-a1a1"))  # its x' differ
    # At φ = 0, y = 63.5 both pairs have the same |Y| = 13.5, so the same h.
    x_b, z_b, h = 120.0, 260.0, np.sqrt(150.0**2 - 13.5**2)
    found = []
    for theta in np.linspace(-0.8, 0.8, 9):
        c, s = np.cos(theta), np.sin(theta)
        pose = (x_b + h * s, 63.5, z_b + h * c, 0.0, theta)
        lengths, smallest = lengths_and_smallest(design, pose)
        assert smallest < 1e-13
        found.append(lengths[:4])
    np.testing.assert_allclose(found, np.broadcast_to(found[0], (9, 4)), rtol=1e-13)
    _, smallest = lengths_and_smallest(design, (x_b + 100.0, 63.5, z_b + 100.0, 0.1, 0.2))
    assert smallest > 1e-3


def test_the_a1a2_self_motion_is_there_and_is_told() -> None:
    """B of the A1 pair on the line along e1 through the base point of A2 (after eq. 25)."""
    design = preset("rpur-a1a2")
    text = next(f.text for f in findings(design) if f.title == "Self-motion")
    told = re.search(r"ρ₄² − ρ₃² = (-?[0-9.]+) mm²", text)
    assert told is not None
    (s12, y1, z1), (s3, _, _), (s4, _, _) = (design.platform[i] for i in (0, 2, 3))
    phi, y = 0.2, float(design.base[:4, 1].mean())
    big_y = y + np.cos(phi) * y1 - np.sin(phi) * z1 - design.base[0, 1]
    above = np.sqrt(150.0**2 - big_y**2) - np.sin(phi) * y1 - np.cos(phi) * z1
    found = []
    for theta in np.linspace(-0.8, 0.8, 9):
        c, s = np.cos(theta), np.sin(theta)
        pose = design.base[2] + (-s12 * c + above * s, 0.0, s12 * s + above * c)
        pose[1] = y
        lengths, smallest = lengths_and_smallest(design, (*pose, phi, theta))
        assert smallest < 1e-12
        found.append(lengths[:4])
    np.testing.assert_allclose(found, np.broadcast_to(found[0], (9, 4)), rtol=1e-13)
    rho = found[0]
    assert rho[3] ** 2 - rho[2] ** 2 == pytest.approx(float(told[1]))
    assert float(told[1]) == pytest.approx((s4 - s12) ** 2 - (s3 - s12) ** 2)
    _, smallest = lengths_and_smallest(design, (*(pose + 40.0), phi, 0.3))
    assert smallest > 1e-3


def test_an_empty_workspace_is_warned_of_and_a_roomy_one_not() -> None:
    for info in presets():
        if info.mechanism == "five_rpur":
            assert "No reachable pose found" not in titles(preset(info.name))
    design = preset("rpur-table1")
    apart = replace(design.limbs[0], base=(5000.0, 30.0, 50.0))
    empty = FiveRPURDesign((apart, *design.limbs[1:]))
    assert "No reachable pose found" in titles(empty)
    rng = np.random.default_rng(3)
    poses = np.column_stack([rng.uniform(-900, 5900, (20000, 3)), rng.uniform(-3, 3, (20000, 2))])
    assert not inside(empty, poses).any()
    # Limbs side by side along e1, too far for their links.
    wide = replace(design.limbs[4], base=(0.0, 700.0, 0.0))
    assert "No reachable pose found" in titles(FiveRPURDesign((*design.limbs[:4], wide)))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"base": (0.0, 1.5, 0.0)}, "differ by 1.5 mm along e₁"),
        ({"link": 151.0}, "links differ by 1 mm"),
        ({"platform": (0.0, -50.0, 0.25)}, "0.25 mm off a line along e₂"),
    ],
)
def test_a_narrow_miss_is_hinted_at(change: dict[str, Any], said: str) -> None:
    design = preset("rpur-table2")
    changed = FiveRPURDesign((replace(design.limbs[0], **change), *design.limbs[1:]))
    hints = [f for f in findings(changed) if f.title == "Nearly an arrangement"]
    assert [f.limbs for f in hints] == [(1, 2)]
    assert said in hints[0].text


def test_a_general_design_says_so() -> None:
    base, platform = random_points(5, 5)
    assert "General design" in titles(of(*zip(base, platform, strict=True)))
