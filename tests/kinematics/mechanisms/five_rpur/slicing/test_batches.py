"""Many sections at once in numpy, against the kernel's one by one."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kinematics.mechanisms.five_rpur.slicing import batches, measures
from kinematics.mechanisms.five_rpur.slicing.cutter import Cutter
from tests.kinematics.mechanisms.five_rpur.machines import preset
from tests.kinematics.mechanisms.five_rpur.nearly_equal import case

pytestmark = pytest.mark.usefixtures("compiled")

MODES = [None, ("+++++",), ("+-+-+", "-++++", "-----")]


def measured(module, cutter: Cutter, x):
    moments, marks = np.full((len(x), 6), np.nan), np.full(len(x), -1)
    machine = cutter.limbs, cutter.signs, cutter.table, cutter.size, cutter.origin
    module.measure(x, *cutter.heights(x), *machine, moments, marks)
    return moments, marks


def in_runs(module, cutter: Cutter, x):
    """A set for each section: of each run the curves, the ends, the first run of its piece."""
    room = 8192
    firsts, marks = np.empty(len(x) + 1, np.int64), np.empty(len(x), np.int64)
    curves, spans = np.empty((room, 2), np.int64), np.empty((room, 2))
    pieces, tells = np.empty(room, np.int64), np.empty(room, np.int64)
    machine = cutter.limbs, cutter.signs, cutter.table, cutter.size
    out = firsts, curves, spans, pieces, tells, marks
    used = module.runs_of(x, *cutter.heights(x), *machine, *out)
    assert used == firsts[-1]
    known = np.maximum.accumulate(pieces[:used])
    assert (np.diff(known, prepend=-1) <= 1).all()  # counted from section to section
    found = []
    for a, b in pairwise(firsts.tolist()):
        order = np.lexsort((curves[a:b, 1], curves[a:b, 0], np.round(spans[a:b, 0], 6)))
        own = pieces[a:b]
        first = [int(np.flatnonzero(own[order] == piece)[0]) for piece in own[order]]
        found.append((curves[a:b][order], spans[a:b][order], tells[a:b][order], first))
    return found, marks


@pytest.mark.parametrize("name", ["rpur-table1", "rpur-table2", "rpur-table1-icee"])
@pytest.mark.parametrize("modes", MODES)
def test_numpy_cuts_as_the_kernel_does(name, modes):
    r = np.random.default_rng(len(name))
    for _ in range(3):
        cutter = Cutter(preset(name), *r.uniform(-1.5, 1.5, 2), modes)
        low, high = cutter.range
        x = np.linspace(low - 1.0, high + 1.0, 120)
        (one, marks), (two, others) = (measured(m, cutter, x) for m in (measures, batches))
        for column in range(6):
            assert two[:, column] == pytest.approx(
                one[:, column], rel=1e-10, abs=1e-12 * np.abs(one[:, column]).max(initial=1e-9)
            )
        np.testing.assert_array_equal(marks, others)
        (runs, marks), (other_runs, others) = (in_runs(m, cutter, x) for m in (measures, batches))
        np.testing.assert_array_equal(marks, others)
        for (a, b, c, d), (e, f, g, h) in zip(runs, other_runs, strict=True):
            np.testing.assert_array_equal(a, e)
            assert f == pytest.approx(b, abs=1e-9)
            np.testing.assert_array_equal(c, g)
            assert d == h


@pytest.mark.parametrize("seed", range(40))
def test_numpy_measures_nearly_equal_limbs_as_the_kernel_does(seed):
    """Their crossings come in any order: only how sections are told to be built may differ."""
    this = case(seed)
    cutter = Cutter(this.design, this.phi, this.theta, this.modes)
    if not cutter.range[0] < cutter.range[1]:
        return
    x = np.linspace(*cutter.range, 25)
    (one, marks), (two, others) = (measured(m, cutter, x) for m in (measures, batches))
    assert two[:, 0] == pytest.approx(one[:, 0], rel=1e-9, abs=1e-13 * cutter.size**2)
    np.testing.assert_array_equal(marks == 0, others == 0)


def test_without_room_nothing_is_told():
    cutter = Cutter(preset("rpur-table1"), 0.0, 0.0, None)
    x = np.linspace(*cutter.range, 20)
    machine = cutter.limbs, cutter.signs, cutter.table, cutter.size
    for module in (measures, batches):
        out = [np.empty(21, np.int64), np.empty((7, 2), np.int64), np.empty((7, 2))]
        out += [np.empty(7, np.int64), np.empty(7, np.int64), np.empty(20, np.int64)]
        assert module.runs_of(x, *cutter.heights(x), *machine, *out) == -1


@pytest.mark.parametrize("seed", range(20))
def test_components_are_those_of_the_graph_in_their_order(seed):
    r = np.random.default_rng(seed)
    count = int(r.integers(1, 300))
    one, two = r.integers(0, count, (2, int(r.integers(0, 2 * count))))
    found = batches.components(count, one, two)
    graph = coo_array((np.ones(len(one)), (one, two)), shape=(count, count))
    number, label = connected_components(graph, directed=False)
    assert len(set(zip(found.tolist(), label.tolist(), strict=True))) == number
    _, first = np.unique(found, return_index=True)
    assert (np.diff(first) > 0).all()


def test_pairs_are_all_within_a_group():
    one, two = np.array([0, 0, 2, 5]), np.array([0, 2, 2, 3, 5, 5])
    a, b = batches.pairs_of(one, two, 6)
    assert list(zip(a.tolist(), b.tolist(), strict=True)) == [
        (0, 0),
        (1, 0),
        (2, 1),
        (2, 2),
        (3, 4),
        (3, 5),
    ]
