"""What a straight way passes: against dense sampling, at known folds, and made to touch."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from kinematics.designs.files import load_design
from kinematics.facets.paths import PathsFacet
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from tests.kinematics.mechanisms.five_rpur.asked import wrench_matrix
from tests.kinematics.mechanisms.five_rpur.machines import preset
from tests.kinematics.references import read

MECHANISM = mechanism_class("five_rpur")
TABLES = ("rpur-table1", "rpur-table2", "rpur-a1a1")


def a_way(seed: int):
    rng = np.random.default_rng(seed)
    design = preset(TABLES[seed % 3])
    while True:
        a = np.concatenate([rng.uniform(-300, 300, 3), rng.uniform(-1, 1, 2)])
        held = np.flatnonzero(inverse.inverse(design, a).within_stroke)
        if len(held):
            break
    move = rng.choice([5.0, 50.0, 200.0]) * rng.normal(size=3)
    b = a + np.concatenate([move, rng.choice([0.0, 0.1, 1.0]) * rng.normal(size=2)])
    mode = inverse.MODES[rng.choice(held)]
    return (
        design,
        machine_of(design).inverse.posture(a, mode),
        machine_of(design).inverse.posture(b, mode),
    )


@pytest.mark.parametrize("seed", range(40))
def test_events_are_those_of_dense_samples(seed):
    design, before, after = a_way(seed)
    events = machine_of(design).paths.passed(before, after)
    assert [e.fraction for e in events] == sorted(e.fraction for e in events)
    way = machine_of(design).paths.segment(before.pose, after.pose, before.mode)
    s = np.linspace(0.0, 1.0, 4001)
    near = 2.0 / len(s)
    poses = way.poses(s)
    rho = _lengths(design, poses, before.mode)
    closes = np.isfinite(rho).all(axis=1)
    signs = np.zeros(len(s))
    matrix = wrench_matrix(design, poses[closes], before.mode, length=50.0)
    signs[closes] = np.sign(np.linalg.det(matrix))
    crossings = s[:-1][signs[1:] * signs[:-1] < 0]
    assert_same(crossings, [e for e in events if e.kind == "parallel" and e.stops], near)
    for limb in range(5):
        own = rho[:, limb]
        finite = np.isfinite(own)
        mine = [e for e in events if e.limb == limb + 1]
        reach = [e for e in mine if e.kind == "serial"]
        assert_same(s[:-1][finite[1:] != finite[:-1]], reach, near)
        low, high = design.limbs[limb].stroke
        passes = []
        for within in (own >= low - 1e-9, own <= high + 1e-9):
            passes += s[:-1][(within[1:] != within[:-1]) & finite[1:] & finite[:-1]].tolist()
        # Next to a link's reach a stroke end may fall between the last samples.
        ends = [e.fraction for e in reach]
        strokes = [e.fraction for e in mine if e.kind == "stroke"]
        for here, there in ((passes, strokes), (strokes, passes)):
            for fraction in here:
                if all(abs(fraction - end) > 2.0 * near for end in ends):
                    assert min(abs(fraction - f) for f in there) <= near


def _lengths(design, poses, mode):
    columns = [0 if sign == "+" else 1 for sign in mode]
    return inverse.limb_lengths(design, poses)[:, range(5), columns]


def assert_same(sampled, events, near: float) -> None:
    assert len(sampled) == len(events)
    for s, event in zip(sampled, events, strict=True):
        assert abs(s - event.fraction) <= near


@pytest.mark.parametrize("seed", range(12))
def test_at_each_event_its_bound_is_met(seed):
    design, before, after = a_way(seed)
    for event in machine_of(design).paths.passed(before, after):
        there = machine_of(design).inverse.posture(event.pose, before.mode)
        if event.kind == "stroke":
            ends = design.limbs[event.limb - 1].stroke
            assert min(abs(there.joints[event.limb - 1] - end) for end in ends) < 1e-8
        elif event.kind == "serial":
            short = next(m.amount for m in there.margins if m.limb == event.limb)
            assert abs(short) < 1e-9
        elif event.stops:
            matrix = wrench_matrix(design, event.pose, before.mode, length=50.0)
            assert abs(np.linalg.det(matrix)) < 1e-12


# --- at the folds of the reference ---------------------------------------------------------------


def folds():
    """(design, mode, pose, normal): where two assembly modes merge, and d det there."""
    table = read("rpur_folds.json")
    design = load_design("rpur-table1")
    for fold in table["folds"]:
        pose, rho = np.array(fold["pose_fold"]), np.array(fold["rho_fold"])
        lengths = inverse.limb_lengths(design, pose)
        mode = "".join(
            "+" if abs(a - r) < abs(b - r) else "-" for (a, b), r in zip(lengths, rho, strict=True)
        )
        way = machine_of(design).paths.segment(pose, pose, mode)
        steps = 1e-4 * np.diag(1.0 / way.metric)
        slope = way.determinant(pose + steps)[0] - way.determinant(pose - steps)[0]
        yield design, mode, pose, slope / way.metric, way


@pytest.mark.parametrize("case", list(folds()), ids=lambda case: case[1])
def test_the_way_through_a_fold_crosses_there(case):
    design, mode, pose, normal, way = case
    normal = normal / np.linalg.norm(normal * way.metric)
    before, after = (
        machine_of(design).inverse.posture(pose + d * normal, mode) for d in (-0.4, 0.6)
    )
    events = [e for e in machine_of(design).paths.passed(before, after) if e.kind == "parallel"]
    assert [e.stops for e in events] == [True]
    assert events[0].fraction == pytest.approx(0.4, abs=1e-6)
    assert events[0].pose == pytest.approx(pose.tolist(), abs=1e-6)
    assert "another aspect" in events[0].text
    back = [e for e in machine_of(design).paths.passed(after, before) if e.kind == "parallel"]
    assert back[0].fraction == pytest.approx(0.6, abs=1e-6)


@pytest.mark.parametrize("case", list(folds())[:4], ids=lambda case: case[1])
def test_ways_that_touch_come_near_or_cut_twice(case):
    """A way along the singular surface, shifted until the determinant only dips to zero."""
    design, mode, pose, normal, way = case
    normal = normal / np.linalg.norm(normal * way.metric)
    rng = np.random.default_rng(1)
    along = rng.normal(size=5) / way.metric
    weights = way.metric**2
    along -= (along @ (weights * normal)) * normal
    along *= 3.0 / np.linalg.norm(along * way.metric)

    def dip(shift: float) -> float:
        """The extreme of the determinant along the shifted way, by the sign of its bend."""

        def at(u: float) -> float:
            return float(way.determinant((pose + shift * normal + u * along)[None])[0][0])

        bend = np.sign(at(1.0) + at(-1.0) - 2.0 * at(0.0))
        found = minimize_scalar(
            lambda u: bend * at(u), bounds=(-0.9, 0.9), method="bounded", options={"xatol": 1e-10}
        )
        return bend * at(found.x) * bend

    touching = brentq(dip, -0.9, 0.9, xtol=1e-14)

    def events(shift: float):
        ends = [
            machine_of(design).inverse.posture(pose + shift * normal + u * along, mode)
            for u in (-1.0, 1.0)
        ]
        return [e for e in machine_of(design).paths.passed(*ends) if e.kind == "parallel"]

    at_both_sides = [events(touching - 1e-2), events(touching + 1e-2)]
    at_both_sides.sort(key=len)
    near, cut = at_both_sides
    assert [e.stops for e in near] == [False]
    assert "came as near as 0.01" in near[0].text
    assert [e.stops for e in cut] == [True, True]
    touched = events(touching)
    assert touched
    assert all(abs(e.fraction - touched[0].fraction) < 1e-3 for e in touched)
    assert any(e.stops for e in touched)


# --- beside the way ------------------------------------------------------------------------------


def test_nothing_is_passed_where_nothing_moves():
    design = load_design("rpur-table1")
    home = machine_of(design).home
    assert machine_of(design).paths.passed(home, home) == ()


def test_another_mode_is_told():
    design = load_design("rpur-table1")
    home = machine_of(design).home
    other = machine_of(design).inverse.posture(home.pose, "++-++")
    (event,) = machine_of(design).paths.passed(home, other)
    assert event.stops
    assert "another working mode of limbs 2, 4" in event.text or "limb" in event.text


def test_angles_go_the_shorter_way():
    design = load_design("rpur-table1")
    way = machine_of(design).paths.segment((0, 0, 0, 3.0, -3.0), (0, 0, 0, -3.0, 3.0), "+++++")
    turn = 2.0 * np.pi - 6.0
    assert way.change[3:] == pytest.approx([turn, -turn])
    assert way.pose(1.0)[3:] == pytest.approx((-3.0, 3.0))


def test_a_design_that_is_always_singular_says_so():
    limb = Limb((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 150.0, (50.0, 400.0))
    design = FiveRPURDesign((limb,) * 5)
    ends = [
        machine_of(design).inverse.posture((x, 20.0, 250.0, 0.0, 0.0), "+++++") for x in (0.0, 50.0)
    ]
    (event,) = machine_of(design).paths.passed(*ends)
    assert event.kind == "parallel"
    assert "all along the way" in event.text


@pytest.mark.parametrize("seed", range(0, 40, 8))
def test_a_motion_of_the_whole_leaves_the_events(seed):
    design, before, after = a_way(seed)
    shift = np.random.default_rng(seed).uniform(-300, 300, 3)
    limbs = tuple(
        Limb(tuple(np.add(limb.base, shift).tolist()), limb.platform, limb.link, limb.stroke)
        for limb in design.limbs
    )
    moved = FiveRPURDesign(limbs)
    ends = [
        machine_of(moved).inverse.posture((*np.add(p.pose[:3], shift), *p.pose[3:]), p.mode)
        for p in (before, after)
    ]
    there = machine_of(moved).paths.passed(*ends)
    here = machine_of(design).paths.passed(before, after)
    assert [(e.kind, e.limb, e.stops) for e in there] == [(e.kind, e.limb, e.stops) for e in here]
    assert [e.fraction for e in there] == pytest.approx([e.fraction for e in here], abs=1e-7)


@pytest.mark.parametrize("seed", range(1, 40, 8))
def test_a_way_in_parts_passes_the_same(seed):
    design, before, after = a_way(seed)
    way = machine_of(design).paths.segment(before.pose, after.pose, before.mode)
    whole = machine_of(design).paths.passed(before, after)
    parts = machine_of(design).paths.passed(before, after, way.poses(np.array([0.211, 0.658])))
    assert [(e.kind, e.limb, e.stops, e.text) for e in parts] == [
        (e.kind, e.limb, e.stops, e.text) for e in whole
    ]
    assert [e.fraction for e in parts] == pytest.approx([e.fraction for e in whole], abs=1e-9)


def test_two_parallel_links_at_their_reach_are_singular_in_both_ways():
    """Limbs 1 and 2 of Table 1 hold their links in parallel: there both are along e₁."""
    design = load_design("rpur-table1")
    home = machine_of(design).home
    goal = machine_of(design).inverse.posture(
        (*home.pose[:1], home.pose[1] + 200.0, *home.pose[2:]), home.mode
    )
    told = {
        e.limb: e.text for e in machine_of(design).paths.passed(home, goal) if e.kind == "serial"
    }
    assert "a serial and a parallel singularity at once" in told[1]
    assert "a serial and a parallel singularity at once" in told[2]
    back = machine_of(design).inverse.posture(
        (*home.pose[:1], home.pose[1] - 90.0, *home.pose[2:]), home.mode
    )
    (alone,) = [e for e in machine_of(design).paths.passed(home, back) if e.kind == "serial"]
    assert "a serial singularity" in alone.text


def test_a_mechanism_without_it_passes_nothing() -> None:
    machine = machine_of(load_design("rpur-table1"))
    assert PathsFacet.passed(machine.paths, machine.home, machine.home) == ()
