"""Assembly modes that keep their identity while actuators move."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from tests.kinematics.mechanisms.five_rpur.machines import forward
from tests.kinematics.references import read

FOLDS = read("rpur_folds.json")
START, WAY = np.array(FOLDS["rho0"]), np.array(FOLDS["drho"])


def by_identity(found):
    return {name: (found.modes[n], found.poses[n]) for n, name in enumerate(found.identities)}


def walk(design, stations, start):
    """Refreshed sets at several joints, one after the other."""
    (found,) = forward(design, start)
    history = [(found, (), ())]
    for joints in stations:
        answer = machine_of(design).forward.refresh(found, joints)
        found = answer.solutions
        history.append((found, answer.appeared, answer.merged))
    return history


def test_at_the_same_joints_everybody_stays():
    for name in ("rpur-table1", "rpur-a2a3"):
        design = load_design(name)
        (found,) = forward(design, START)
        again = machine_of(design).forward.refresh(found, START)
        assert not again.appeared
        assert not again.merged
        assert again.solutions.identities == found.identities
        np.testing.assert_allclose(again.solutions.poses, found.poses, atol=1e-9)


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table2", "rpur-mpa2"])
def test_small_steps_and_one_large_step_agree(name):
    """Who is whom does not depend on how often one looks, as long as it was not gone between."""
    design = load_design(name)
    end = START + 4.0 * WAY
    fine = walk(design, [START + t * WAY for t in np.linspace(0.4, 4.0, 10)], START)
    coarse = walk(design, [end], START)
    # Numbers of those that merge are given to others that appear later.
    gone = {m.identity for walked in (fine, coarse) for _, _, merged in walked for m in merged}
    first = set(fine[0][0].identities) - gone
    assert len(first) > 5
    one, other = by_identity(fine[-1][0]), by_identity(coarse[-1][0])
    assert set(one) & first == set(other) & first
    for name_ in set(one) & first:
        assert one[name_][0] == other[name_][0]
        np.testing.assert_allclose(one[name_][1], other[name_][1], atol=1e-8)


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table2"])
def test_solutions_appear_and_merge_in_pairs(name):
    design = load_design(name)
    history = walk(design, [START + t * WAY for t in (5.0, 12.0, 18.0, 25.0, 31.0)], START)
    seen = 0
    for (before, _, _), (now, appeared, merged) in pairwise(history):
        assert now.complete
        assert len(now) == len(before) + len(appeared) - len(merged)
        assert (len(appeared) + len(merged)) % 2 == 0
        assert len(set(now.identities)) == len(now)
        assert set(now.identities) - set(appeared) <= set(before.identities)
        assert not set(appeared) & set(before.identities)
        pairs = {m.identity: m.partner for m in merged}
        # Without a partner: that one had appeared on the way itself, with one that is still there.
        assert all(pairs[partner] == one for one, partner in pairs.items() if partner)
        seen += len(appeared) + len(merged)
    assert seen > 0


def test_the_two_that_merge_at_the_stored_fold_are_named():
    """reference/rpur_folds.json: at t = 33.7022 the solutions at pose_fold end."""
    design = load_design("rpur-table1")
    fold = FOLDS["folds"][0]
    (found,) = forward(design, START + (fold["t"] - 0.05) * WAY)
    answer = machine_of(design).forward.refresh(found, START + (fold["t"] + 0.05) * WAY)
    assert len(answer.merged) == 2
    one, other = answer.merged
    assert (one.partner, other.partner) == (other.identity, one.identity)
    for merged in answer.merged:
        off = np.array(merged.pose) - fold["pose_fold"]
        assert np.abs(off[:3]).max() < 3.0  # they are left a little before they meet
        assert np.abs(off[3:]).max() < 0.05
    assert not answer.appeared


def test_identities_survive_forth_and_back():
    design = load_design("rpur-a1a3")
    (found,) = forward(design, START)
    there = machine_of(design).forward.refresh(found, START + 2.0 * WAY)
    back = machine_of(design).forward.refresh(there.solutions, START)
    stayed = set(found.identities) & set(back.solutions.identities)
    lost = {m.identity for m in there.merged}
    assert stayed == set(found.identities) - lost
    one, other = by_identity(found), by_identity(back.solutions)
    for name in stayed:
        np.testing.assert_allclose(one[name][1], other[name][1], atol=1e-8)


def test_merged_limbs_pass_their_serial_singularity_as_one():
    """They flip together; the solution stays who it is."""
    design = replace(load_design("rpur-table2"), merged_joints=((1, 2), (3, 4)))
    rng = np.random.default_rng(2)
    flips = 0
    for _ in range(12):
        joints = rng.uniform(260, 390, 5)
        (found,) = forward(design, joints)
        answer = machine_of(design).forward.refresh(found, joints + rng.uniform(-8, 8, 5))
        before, now = by_identity(found), by_identity(answer.solutions)
        for name in set(before) & set(now):
            mode = now[name][0]
            assert mode[0] == mode[1]
            assert mode[2] == mode[3]
            flips += before[name][0] != mode
        assert (len(answer.merged) + len(answer.appeared)) % 2 == 0
    assert flips > 0


def test_from_no_solution_and_to_none():
    design = load_design("rpur-table2")
    (none,) = forward(design, [1.0] * 5)
    answer = machine_of(design).forward.refresh(none, START)
    assert len(answer.appeared) == len(answer.solutions) > 0
    gone = machine_of(design).forward.refresh(answer.solutions, [1.0] * 5)
    assert len(gone.solutions) == 0
    assert len(gone.merged) == len(answer.solutions)
