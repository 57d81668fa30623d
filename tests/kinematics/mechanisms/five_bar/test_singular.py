"""Singularities, clearances, remedies, home and drawing of the five-bar."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.facets import inverse as generic
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.five_bar import clearances, curve_pieces, curves, inverse, workspace
from kinematics.mechanisms.five_bar.design import FiveBarDesign, Limb
from tests.kinematics.mechanisms.five_bar.conftest import (
    BOTH,
    EMPTY,
    MACHINES,
    PAPER,
    RANGED,
    UNLIKE,
)

M = mechanism_class("five_bar")


def test_a_parallel_singularity_is_named_with_its_free_motion() -> None:
    at = machine_of(PAPER).inverse.posture((0.0, 415.69219381653056), "+-")
    (found,) = machine_of(PAPER).singularities.at(at)
    assert found.kind == "parallel"
    assert found.cause == "B₁, P and B₂ are in line"
    np.testing.assert_allclose(np.abs(found.motion), [0.0, 1.0], atol=1e-6)
    assert not machine_of(PAPER).singularities.at(
        machine_of(PAPER).inverse.posture((0.0, 700.0), "+-")
    )
    near = machine_of(PAPER).inverse.posture((0.0, 416.0), "+-")
    assert not machine_of(PAPER).singularities.at(near)
    assert machine_of(PAPER).singularities.at(near, 0.02)


def test_serial_ones_and_a_self_motion() -> None:
    (stretched,) = machine_of(PAPER).singularities.at(
        machine_of(PAPER).inverse.posture((720.0, 0.0), "+-")
    )
    assert stretched.kind == "serial"
    assert stretched.limbs == (1,)
    folded = machine_of(PAPER).singularities.at(
        machine_of(PAPER).inverse.posture((-240.0, 0.0), "++")
    )
    assert folded[0].cause == "limb 1 is folded onto its base"
    (loop, *_) = [each for each in curves.loops(PAPER) if each.kind == "circle"]
    p, q = loop.points(0.4)
    at = machine_of(PAPER).inverse.posture(p.tolist(), inverse.mode_of(PAPER, p, q)[0])
    assert [each.kind for each in machine_of(PAPER).singularities.at(at)] == ["self-motion"]


@pytest.mark.parametrize("name", MACHINES)
def test_clearances_are_the_nearest_of_dense_samples(name: str) -> None:
    design = MACHINES[name]
    rng = np.random.default_rng(8)
    told = 0
    for _ in range(25):
        p = rng.uniform(-600.0, 600.0, 2)
        at = machine_of(design).inverse.posture(p.tolist(), inverse.MODES[rng.integers(4)])
        found = machine_of(design).clearances.of(at)
        if not at.reachable:
            assert found == ()
            continue
        told += 1
        assert [c.distance for c in found] == sorted(c.distance for c in found)
        for c in found:
            assert np.hypot(*(np.array(c.point[:2]) - p)) == pytest.approx(c.distance)
        points = [
            curve_pieces.sampled(piece, 2.0)[0]
            for piece in curve_pieces.pieces(design)
            if piece.mode == at.mode
        ]
        least = min((np.hypot(*(each - p).T).min() for each in points), default=np.inf)
        parallel = [c.distance for c in found if c.kind == "parallel"]
        assert len(parallel) == (1 if np.isfinite(least) else 0)
        if parallel:
            assert least - 1.1 <= parallel[0] <= least + 1e-9
        rim = [
            edge.point(s)
            for loop in workspace.loops(design, (at.mode,))
            for edge in loop
            for s in np.linspace(0.0, 1.0, 200)
        ]
        (edge,) = [c for c in found if c.kind == "boundary"]
        nearest = min(float(np.hypot(*(each - p))) for each in rim)
        assert nearest - 8.0 <= edge.distance <= nearest + 1e-9
    assert told > 3
    quick = machine_of(PAPER).clearances.of(machine_of(PAPER).home, singular=False)
    assert "parallel" not in {c.kind for c in quick}


def test_ranges_have_clearances_of_their_own() -> None:
    kinds = {
        (c.kind, c.limb)
        for c in machine_of(BOTH).clearances.of(
            machine_of(BOTH).inverse.posture((0.0, 700.0), "+-")
        )
    }
    assert ("stroke", 1) in kinds
    assert ("mode", 2) in kinds


@pytest.mark.parametrize(
    ("design", "pose", "mode"),
    [
        (PAPER, (300.0, 900.0), "+-"),
        (PAPER, (0.0, 2000.0), "--"),
        (UNLIKE, (-240.0, 100.0), "++"),
        (UNLIKE, (260.0, 20.0), "+-"),
        (RANGED, (-100.0, 300.0), "-+"),
        (RANGED, (-600.0, -600.0), "-+"),
    ],
)
def test_the_way_back_in(design: object, pose: tuple[float, float], mode: str) -> None:
    at = machine_of(design).inverse.posture(pose, mode)
    found = machine_of(design).clearances.nearest_pose(at)
    assert found.nearest is not None
    assert found.nearest.reachable
    assert found.nearest.mode == mode
    gone = float(np.hypot(*np.subtract(found.nearest.pose, pose)))
    assert found.distance == pytest.approx(gone)
    rng = np.random.default_rng(2)  # nothing nearer can be held
    angle = rng.uniform(0.0, 2 * np.pi, 4000)
    reach = found.distance * (1.0 - 1e-4) * np.sqrt(rng.uniform(0.0, 1.0, 4000))
    ring = np.array(pose) + reach[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    assert not generic.inside(design, ring, (mode,)).any()
    assert found.changes
    for changes in found.changes:
        changed = design
        for change in changes:
            changed = machine_of(changed).edited(change.path, change.after).design
            assert change.text
        assert machine_of(changed).inverse.posture(pose, mode).reachable
    for other in found.modes:
        assert machine_of(design).inverse.posture(pose, other).reachable


def test_no_way_back_where_nothing_is_reached() -> None:
    found = machine_of(EMPTY).clearances.nearest_pose(
        machine_of(EMPTY).inverse.posture((0.0, 0.0), "+-")
    )
    assert found.nearest is None
    assert "common place" in found.text
    fine = machine_of(PAPER).clearances.nearest_pose(machine_of(PAPER).home)
    assert fine.distance == 0.0
    assert not fine.changes


@pytest.mark.parametrize("name", MACHINES)
def test_home_is_held_and_far_from_singularities(name: str) -> None:
    design = MACHINES[name]
    home = machine_of(design).home
    assert home.reachable
    assert home.mode == "+-"
    assert float(machine_of(design).measures(home.pose, home.mode, "transmission")) > 0.3
    for value, c in zip(home.pose, machine_of(design).coordinates, strict=True):
        assert c.lower <= value <= c.upper


def test_home_is_on_the_side_of_positive_y_though_the_other_has_better_places() -> None:
    design = FiveBarDesign((Limb(461.0, 323.0, (-33.0, 10.0)), Limb(378.0, 295.0)), 282.0)
    home = machine_of(design).home
    assert home.reachable
    assert home.pose[1] >= 0.0
    below = machine_of(design).inverse.posture((-24.0, -340.0), home.mode)
    assert below.reachable
    measured = [
        float(machine_of(design).measures(p, home.mode, "transmission"))
        for p in (home.pose, below.pose)
    ]
    assert measured[1] > measured[0]


def test_home_of_nothing_is_still_a_posture() -> None:
    home = machine_of(EMPTY).home
    assert not home.reachable
    assert machine_of(EMPTY).drawing(home).bars


@pytest.mark.parametrize("name", MACHINES)
def test_drawings_have_links_of_their_lengths(name: str) -> None:
    design = MACHINES[name]
    for pose in ((0.0, 500.0), (100.0, 300.0), (0.0, 5000.0)):
        at = machine_of(design).inverse.posture(pose, "+-")
        drawn = machine_of(design).drawing(at)
        bars = {bar.name: bar for bar in drawn.bars}
        assert len(bars) == len(drawn.bars)
        for i, limb in enumerate(design.limbs):
            for part, length in (("proximal", limb.proximal), ("link", limb.distal)):
                bar = bars[f"limb{i + 1}/{part}"]
                assert bar.start[2] == bar.end[2] > 0.0
                assert np.linalg.norm(np.subtract(bar.end, bar.start)) == pytest.approx(length)
            assert (f"limb{i + 1}/gap" in bars) == (not np.isfinite(at.joints[i]))
            assert (f"limb{i + 1}/min" in bars) == (limb.joint_range_deg is not None)
        heights = [bars[f"limb{i}/{p}"].start[2] for i in (1, 2) for p in ("proximal", "link")]
        assert len(set(heights)) == 4  # the links pass one another
        assert all(np.isfinite([*bar.start, *bar.end]).all() for bar in drawn.bars)


def test_distances_of_many_points() -> None:
    place = np.array([0.0, 415.69219381653056 + 5.0])
    (point, _) = clearances.nearest_parallel(PAPER, "+-", place)
    assert np.hypot(*(point - place)) == pytest.approx(5.0, abs=1e-6)


def test_of_two_pieces_that_are_about_as_near_the_nearer_is_told() -> None:
    """Their samples may rank them the other way round: places along which two are equally near."""
    rng = np.random.default_rng(3)
    told = 0
    for design in (UNLIKE, PAPER):
        mine = [each for each in curve_pieces.pieces(design) if each.mode == "+-"]
        rows = [clearances._sampled(design, "+-")[n][2] for n in range(len(mine))]
        for _ in range(30):
            ends = rng.uniform(-600.0, 600.0, (2, 2))

            def distances(t: float, ends: np.ndarray = ends, rows: list = rows) -> np.ndarray:
                place = ends[0] + t * (ends[1] - ends[0])
                return np.array([np.hypot(*(each - place).T).min() for each in rows])

            low, high = 0.0, 1.0
            first = int(distances(0.0).argmin())
            if first == int(distances(1.0).argmin()):
                continue
            for _ in range(40):  # where another of the samples becomes the nearest
                middle = 0.5 * (low + high)
                low, high = (middle, high) if distances(middle).argmin() == first else (low, middle)
            place = ends[0] + low * (ends[1] - ends[0])
            near = [
                clearances._least(piece, place, max(n - 1, 0) / 256, min(n + 1, 256) / 256)[1]
                for piece, row in zip(mine, rows, strict=True)
                for n in np.argsort(np.hypot(*(row - place).T))[:3].tolist()
            ]
            (point, _) = clearances.nearest_parallel(design, "+-", place)
            assert np.hypot(*(point - place)) == pytest.approx(min(near), abs=1e-9 * design.size)
            told += 1
    assert told > 10
