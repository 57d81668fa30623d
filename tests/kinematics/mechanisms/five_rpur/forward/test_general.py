"""All complex solutions of the general 5-RPUR: counts, families, start sets, completeness.

The counts are those of the specification (1680: Mech. Mach. Theory 46 (2011) 945); the cases in
reference/rpur_forward.json were computed by other methods and refined to 40 digits.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kinematics.designs.files import load_design
from kinematics.errors import ComputationError
from kinematics.homotopy import monodromy as loops
from kinematics.homotopy import solving as homotopies
from kinematics.homotopy.solving import cluster, solve
from kinematics.homotopy.tracking import Ending, track
from kinematics.mechanisms.five_rpur.forward import equations, families, monodromy
from kinematics.mechanisms.five_rpur.forward.equations import (
    Deformation,
    conjugate,
    parameters,
    polish,
    residuals,
)
from kinematics.mechanisms.five_rpur.forward.families import FAMILIES, membership, start_set
from kinematics.mechanisms.five_rpur.forward.general import roots_at, roots_from
from tests.kinematics.mechanisms.five_rpur.machines import of_forward_case
from tests.kinematics.references import read

CASES = {case["name"]: case for case in read("rpur_forward.json")["cases"]}


def closes(design, joints, roots) -> float:
    """The largest violation of the equations, relative to the squares in them."""
    g = parameters(design, joints)
    f1, f2 = residuals(g, roots)
    size = 1.0 + np.abs(roots).max(axis=0) ** 2
    return float((np.abs(np.concatenate([f1, f2])) / size).max())


# --- families and their start sets -----------------------------------------------------------


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_a_stored_set_is_distinct_solutions_of_its_machine(family):
    stored = start_set(families.Membership(family, (0, 1, 2, 3, 4)))
    assert stored.roots.shape == (10, family.count)
    roots, error = polish(stored.parameters, stored.roots, rounds=3)
    assert error.max() < 1e-9
    assert len(np.unique(cluster(equations, roots))) == family.count
    sizes = 1.0 + np.abs(roots).max(axis=0) ** 2
    f1, f2 = residuals(stored.parameters, roots)
    assert (np.abs(np.concatenate([f1, f2])) / sizes).max() < 1e-11
    g = stored.parameters
    for kind, i, j in family.relations:  # the machine belongs to its family
        if kind != "R":
            assert g.sy[i] == g.sy[j]
            assert g.sz[i] == g.sz[j]
        if kind in ("R", "A2"):
            assert g.rx[i] == g.rx[j]


def test_families_go_from_the_general_to_the_special():
    counts = [family.count for family in FAMILIES]
    assert counts[0] == 1680
    assert counts == sorted(counts, reverse=True)


@pytest.mark.parametrize(
    ("name", "family", "count"),
    [
        ("rpur-table1", "s", 1560),
        ("rpur-table1-icee", "s-s", 1440),
        ("rpur-table2", "a1-a1", 1120),
        ("rpur-a1a1", "a1-a1", 1120),
        ("rpur-a1a2", "a1-a2", 1104),
        ("rpur-a1a3", "a1-s", 1280),
        ("rpur-a2a2", "a2-a2", 1088),
        ("rpur-a2a3", "a2-s", 1264),
        ("rpur-a3a3", "s-s", 1440),
        ("rpur-mpa1", "mp-a1", 1112),
        ("rpur-mpa2", "mp-a2", 1072),
        ("rpur-mpa3", "s3", 1272),
    ],
)
def test_presets_are_recognised_in_any_order_of_their_limbs(name, family, count):
    design = load_design(name)
    rng = np.random.default_rng(count)
    for order in [np.arange(5), rng.permutation(5)]:
        member = membership(replace(design, limbs=tuple(design.limbs[i] for i in order)))
        assert (member.family.name, member.family.count) == (family, count)


def test_a_design_that_misses_a_condition_is_general():
    design = load_design("rpur-table1")
    one = replace(design.limbs[0], platform=(-50.0, 1e-3, 0.0))
    assert membership(replace(design, limbs=(one, *design.limbs[1:]))).family.name == "general"


@pytest.mark.slow
def test_monodromy_finds_the_general_set_again_from_a_part_of_it(monkeypatch):
    """Loops from 1100 of the 1680 solutions bring back all of them and nothing else."""
    monkeypatch.setattr(monodromy, "_PATIENCE", 1)
    stored = start_set(families.Membership(FAMILIES[0], (0, 1, 2, 3, 4)))
    rng = np.random.default_rng(0)
    some = stored.roots[:, rng.permutation(1680)[:1100]]
    lines: list[str] = []
    found = monodromy._completed(
        families.StartSet(stored.parameters, some), FAMILIES[0], rng, lines.append
    )
    assert found.roots.shape == (10, 1680)
    both = np.concatenate([polish(stored.parameters, stored.roots)[0], found.roots], axis=1)
    assert len(np.unique(cluster(equations, both))) == 1680
    assert len(lines) >= 2


def test_the_surplus_of_the_general_set_runs_off_to_infinity():
    rng = np.random.default_rng(1)
    machine = monodromy._random_machine(rng, FAMILIES[-1])
    general_set = start_set(families.Membership(FAMILIES[0], (0, 1, 2, 3, 4)))
    ends = track(Deformation(general_set.parameters, machine), general_set.roots)
    assert np.count_nonzero(ends.endings == Ending.REGULAR) == FAMILIES[-1].count
    assert np.count_nonzero(ends.endings == Ending.INFINITE) >= 1680 - FAMILIES[-1].count - 8


def test_a_set_that_does_not_come_out_whole_is_refused(monkeypatch):
    stored = start_set(families.Membership(FAMILIES[-1], (0, 1, 2, 3, 4)))
    monkeypatch.setattr(loops, "MOST_LOOPS", 1)
    few = families.StartSet(stored.parameters, stored.roots[:, :1])
    with pytest.raises(ComputationError, match="not 1072"):
        monodromy._completed(few, FAMILIES[-1], np.random.default_rng(2), lambda _: None)


def test_written_sets_read_back(tmp_path, monkeypatch):
    stored = start_set(families.Membership(FAMILIES[-1], (0, 1, 2, 3, 4)))
    few = families.StartSet(stored.parameters, stored.roots[:, :7])
    monodromy.write(tmp_path, "few", few)
    monkeypatch.setattr(families, "asset_folder", lambda _: tmp_path)
    families._stored.cache_clear()
    try:
        again = families._stored("few")
        with pytest.raises(ComputationError, match="make start-solutions"):
            families._stored("absent")
    finally:
        families._stored.cache_clear()
    np.testing.assert_allclose(again.roots, few.roots, rtol=1e-6)
    for a, b in zip(again.parameters, few.parameters, strict=True):
        np.testing.assert_array_equal(a, b)


# --- solving ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["general_T1C_case0", "general_T1J_case0", "general_generic_case0"]
)
def test_the_cases_have_as_many_complex_solutions_as_they_must(name):
    case = CASES[name]
    design = of_forward_case(case)
    found = roots_at(design, case["rho"])
    assert found.complete
    assert (found.count, found.infinite, found.lost) == (case["complex_count"], 0, 0)
    assert closes(design, case["rho"], found.values) < 1e-12
    mirrored = np.concatenate([found.values, conjugate(found.values)], axis=1)
    assert len(np.unique(cluster(equations, mirrored))) == found.count


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table1-icee", "rpur-mpa1"])
def test_random_lengths_leave_no_path_unaccounted_for(name):
    design = load_design(name)
    rng = np.random.default_rng(8)
    for _ in range(4):
        joints = rng.uniform(250, 400, 5)
        found = roots_at(design, joints)
        assert found.complete
        assert found.count == membership(design).family.count
        assert closes(design, joints, found.values) < 1e-11


def test_two_start_sets_lead_to_the_same_solutions():
    """From the design's own set, and from its family's on an entirely different way."""
    design = load_design("rpur-table1-icee")
    joints = [287.0, 331.0, 302.0, 366.0, 341.0]
    one = roots_at(design, joints)
    other = solve(equations, start_set(membership(design)), parameters(design, joints), real=True)[
        0
    ]
    assert one.count == other.count == 1440
    assert len(np.unique(cluster(equations, np.hstack([one.values, other.values])))) == 1440


@pytest.mark.parametrize("change", [0.05, 3.0, 30.0])
def test_solutions_are_tracked_on_from_known_ones(change):
    design = load_design("rpur-table1")
    before = np.array([301.0, 312.0, 347.0, 289.0, 333.0])
    after = before + change * np.array([1.0, -0.6, 0.3, 0.8, -0.2])
    known = roots_at(design, before)
    moved, fresh = roots_from(design, known.values, before, after), roots_at(design, after)
    assert moved.complete
    assert moved.count == fresh.count == 1560
    assert len(np.unique(cluster(equations, np.hstack([moved.values, fresh.values])))) == 1560


def test_lost_paths_are_reported_and_then_found(monkeypatch):
    """A tracker that loses paths at first, or all along one way: the set is whole all the same."""
    design = load_design("rpur-table1")
    joints = [301.0, 312.0, 347.0, 289.0, 333.0]
    calls = []

    def forgetful(homotopy, starts, control=None):
        ends = track(homotopy, starts, control)
        if not calls:
            ends.endings[:30] = Ending.LOST
        calls.append(starts.shape[1])
        return ends

    monkeypatch.setattr(homotopies, "track", forgetful)
    found = roots_at(design, joints)
    assert calls == [1560, 30]
    assert found.complete
    assert found.ways == 1
    calls.clear()

    def hopeless(homotopy, starts, control=None):
        ends = track(homotopy, starts, control)
        if len(calls) < 2:  # the first way and its repair lose whatever leads to eight solutions
            ends.endings[:8] = Ending.LOST
        calls.append(starts.shape[1])
        return ends

    monkeypatch.setattr(homotopies, "track", hopeless)
    found = solve(equations, start_set(membership(design)), parameters(design, joints), real=False)[
        0
    ]
    assert calls[:3] == [1560, 8, 1560]  # then all take another way, and the union is taken
    assert found.ways == 2
    assert found.count == 1560
    assert found.lost == 0


def test_jumped_paths_are_seen_and_followed_again(monkeypatch):
    """Two paths that claim one solution are both followed again."""
    design = load_design("rpur-table1")
    calls = []

    def jumping(homotopy, starts, control=None):
        ends = track(homotopy, starts, control)
        if not calls:
            ends.values[:, 5] = ends.values[:, 900]
        calls.append(starts.shape[1])
        return ends

    monkeypatch.setattr(homotopies, "track", jumping)
    found = roots_at(design, [301.0, 312.0, 347.0, 289.0, 333.0])
    assert calls == [1560, 2]
    assert found.complete


def test_clusters_are_of_solutions_that_agree():
    rng = np.random.default_rng(3)
    values = rng.normal(size=(10, 6)) + 1j * rng.normal(size=(10, 6))
    values[:, 4] = values[:, 1] * (1 + 1e-9)
    values[:, 5] = values[:, 1]
    labels = cluster(equations, values)
    assert len(np.unique(labels)) == 4
    assert labels[1] == labels[4] == labels[5]
    assert cluster(equations, values[:, :0]).shape == (0,)


@pytest.mark.slow
def test_a_design_of_coincident_limbs_says_what_it_could_not_follow():
    """Architecturally singular in some modes: whatever comes out is accounted for, or said."""
    design = load_design("rpur-table2")
    four = tuple(replace(design.limbs[0], base=(60.0 * i, 0.0, 20.0 * i * i)) for i in range(4))
    design = replace(design, limbs=(*four, design.limbs[4]))
    found = roots_at(design, [300.0, 305.0, 310.0, 320.0, 330.0])
    assert found.complete == (
        found.closed
        and found.whole
        and found.lost == 0
        and found.count + found.infinite == found.expected
    )
    assert found.count < membership(design).family.count
