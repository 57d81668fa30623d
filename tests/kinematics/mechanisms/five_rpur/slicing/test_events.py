"""Events of sections in closed form: what changes, changes there or where three curves meet."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.distance import pdist

from kinematics.designs.files import load_design
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.slicing.cutter import Cutter
from kinematics.mechanisms.five_rpur.slicing.events import events

pytestmark = pytest.mark.usefixtures("compiled")

ZERO = (0.0, 0.0, 0.0)


def machine(*limbs) -> FiveRPURDesign:
    """Limbs of (w', l, ρ_min, ρ_max), the last one as often as it takes to make five."""
    limbs = (*limbs, *[limbs[-1]] * (5 - len(limbs)))
    return FiveRPURDesign(tuple(Limb(w, ZERO, li, (low, high)) for w, li, low, high in limbs))


def events_of(cutter: Cutter) -> np.ndarray:
    return events(cutter.limbs, cutter.signs, cutter.size)


def changes(cutter: Cutter, steps: int) -> list[float]:
    """Where sections on a grid change their marks, each found by halving."""
    x = np.linspace(*cutter.range, steps)
    marks = cutter.cut(x).marks
    found = []
    for n in np.flatnonzero(marks[1:] != marks[:-1]):
        a, b = x[n], x[n + 1]
        for _ in range(60):
            middle = 0.5 * (a + b)
            if cutter.cut(np.array([middle])).marks[0] == marks[n]:
                a = middle
            else:
                b = middle
        found.append(0.5 * (a + b))
    return found


def test_one_limb():
    """Its circles begin and end, touch each other from outside, and nothing else happens."""
    link, low, high = 150.0, 250.0, 400.0
    cutter = Cutter(machine((ZERO, link, low, high)), 0.0, 0.0, None)
    found = events_of(cutter)
    assert (np.diff(found) > 0.0).all()
    assert (found[0], found[-1]) == cutter.range == (-high, high)
    for end in (low, high):
        assert np.abs(found - end).min() < 1e-9
        assert np.abs(found + end).min() < 1e-9
        # Circles ±S(ρ) touch where S(ρ) = l.
        assert np.abs(found - np.sqrt(end**2 - link**2)).min() < 1e-9
    # Circles S(ρ_max) and S(ρ_min) touch where S(ρ_max) − S(ρ_min) = 2l.
    x = np.linspace(0.0, low, 100_001)
    apart = np.sqrt(high**2 - x**2) - np.sqrt(low**2 - x**2) - 2 * link
    crossing = x[np.flatnonzero(np.diff(np.sign(apart)))]
    assert crossing.size == 1
    assert np.abs(found - crossing).min() < 5e-3


@pytest.mark.parametrize("seed", range(12))
def test_every_change_between_two_limbs_is_an_event(seed):
    """In one mode a limb's arcs do not meet each other: no three curves meet in a point."""
    rng = np.random.default_rng(seed)
    limbs = []
    for _ in range(2):
        low = rng.uniform(0.0, 300.0)
        stroke = (low, low + rng.uniform(40.0, 250.0))
        limbs.append((tuple(rng.uniform(-120, 120, 3).tolist()), rng.uniform(80, 220), *stroke))
    mode = str(rng.choice(["+++++", "+----", "-++++", "-----"]))
    cutter = Cutter(machine(*limbs), 0.0, 0.0, (mode,))
    found = events_of(cutter)
    seen = changes(cutter, 400)
    assert len(seen) >= 2
    for change in seen:
        assert np.abs(found - change).min() < 1e-6 * cutter.size


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table2"])
def test_between_events_only_triple_points_change_anything(name):
    """Where a change is no event, corners of the section meet: three curves share a point."""
    design = load_design(name)
    assert isinstance(design, FiveRPURDesign)
    cutter = Cutter(design, 0.3, -0.4, None)
    found = events_of(cutter)
    others = [c for c in changes(cutter, 300) if np.abs(found - c).min() > 1e-6 * cutter.size]
    assert len(others) > 20
    for change in others:
        # An edge shrinks to a point, or two corners meet.
        nearest = [
            pdist(cutter.outline(change + step).places[:, :2]).min() for step in (-1e-4, 1e-4)
        ]
        assert 0.0 < min(nearest) < 0.05


def test_limbs_out_of_each_others_reach_have_no_events():
    far = (ZERO, 100.0, 50.0, 200.0), ((0.0, 300.0, 0.0), 100.0, 50.0, 200.0)
    assert events_of(Cutter(machine(*far), 0.0, 0.0, None)).size == 0


def test_sections_alike_between_events_change_smoothly():
    """Between neighbouring changes the area has no jump: its steps shrink with the grid."""
    design = load_design("rpur-table1")
    assert isinstance(design, FiveRPURDesign)
    cutter = Cutter(design, 0.0, 0.0, None)
    judged = 0
    for a, b in pairwise(changes(cutter, 300)):
        x = np.linspace(a + 0.3 * (b - a), b - 0.3 * (b - a), 65)
        cuts, runs = cutter.cut(x), cutter.runs(x)
        if b - a < 1.0 or len(set(cuts.marks.tolist())) > 1:
            continue
        judged += 1
        _, first = np.unique(runs.pieces, return_index=True)
        assert len(set(np.bincount(runs.sections[first], minlength=len(x)).tolist())) == 1
        coarse, fine = (np.abs(np.diff(cuts.moments[::k, 0])).max() for k in (8, 1))
        assert fine <= 0.3 * coarse + 1e-9
    assert judged > 20
