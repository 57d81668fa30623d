"""Areas to rounding: loops close, faces fill their mode, and what is integrated is the true curve.

The judges are others than Green's theorem on arcs: lines across the plane, each asked which of its
intervals can be held, and polygons with very many corners.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from kinematics.facets import inverse as generic
from kinematics.machine import machine_of
from kinematics.mechanisms.five_bar import aspects, curve_pieces, curves, inverse, workspace
from kinematics.mechanisms.five_bar.curve_edges import curve_edge
from kinematics.mechanisms.five_bar.design import FiveBarDesign, Limb
from kinematics.plane import arcs
from kinematics.plane import regions as outlines
from kinematics.plane.arcs import Edge
from tests.kinematics.mechanisms.five_bar.conftest import MACHINES

COUNT = 22


@lru_cache
def designs() -> tuple[FiveBarDesign, ...]:
    """Random five-bars, a third with a range, some with equal limbs."""
    rng = np.random.default_rng(2024)

    def limits() -> tuple[float, float]:
        return float(rng.uniform(-90.0, 0.0)), float(rng.uniform(30.0, 170.0))

    found = []
    for n in range(COUNT):
        a, b, c, d = rng.uniform(20.0, 120.0, 4).tolist()
        r = float(rng.uniform(10.0, 100.0))
        one = limits() if n % 3 == 0 else None
        two = limits() if n % 6 == 0 else None
        c, d = (a, b) if n % 10 == 7 else (c, d)
        found.append(FiveBarDesign((Limb(a, b, one), Limb(c, d, two)), r))
    return tuple(found)


# A limb's circle touches the half circle at the end of its range; two limbs' holes all but touch;
# the four-bar B_1 B_2 all but lies flat; a range at whose end a singular curve runs along the rim.
SPECIAL = (
    FiveBarDesign((Limb(60.0, 80.0, (-57.0, 123.0)), Limb(90.0, 45.0, (-180.0, 180.0))), 40.0),
    FiveBarDesign((Limb(46.0, 25.7), Limb(94.8, 40.0)), 0.5 * (20.3 + 54.8 + 7e-7)),
    FiveBarDesign((Limb(46.5, 109.2), Limb(110.5, 22.4)), 0.5 * (46.5 + 110.5 + 131.6 - 92.0)),
    FiveBarDesign((Limb(140.0, 60.0), Limb(140.0, 60.0, (-180.0, -90.0))), 140.0),
)


def closing(loop: Sequence[Edge]) -> float:
    total = np.sum([edge.steps.sum(axis=0) for edge in loop], axis=0)
    return float(np.hypot(*total))


@pytest.mark.parametrize("n", range(COUNT + len(SPECIAL) + len(MACHINES)))
def test_loops_close_and_faces_fill_their_mode(n: int) -> None:
    design = [*designs(), *SPECIAL, *MACHINES.values()][n]
    found = aspects.aspects(design)
    for mode in inverse.MODES:
        rim = workspace.loops(design, (mode,))
        mine = [each for each in found if each.mode == mode]
        for loop in [*rim, *(loop for each in mine for loop in each.loops)]:
            assert closing(loop) < 3e-13 * design.size
            for k, edge in enumerate(loop):
                assert np.array_equal(edge.last, loop[(k + 1) % len(loop)].first)
                gap = edge.steps.sum(axis=0) - (edge.last - edge.first)
                assert np.hypot(*gap) < 3e-13 * design.size
        whole = outlines.section_of(rim).area
        assert whole >= 0.0
        assert all(each.area > 0.0 for each in mine)
        near = 1e-12 * whole + 1e-15 * design.size**2
        assert sum(each.area for each in mine) == pytest.approx(whole, rel=0, abs=near)
        for each in mine:
            assert 0.0 < each.area_error < 1e-11 * design.size**2
    for region, each in zip(machine_of(design).regions.of("aspects", ()), found, strict=True):
        assert region.section.area_error == each.area_error


# --- lines across the workspace ------------------------------------------------------------

_AT = np.arange(-56, 57) / 16.0  # tanh-sinh quadrature on [0, 1], from both ends
_SINH = 0.5 * np.pi * np.sinh(_AT)
_SHARE = 1.0 / (1.0 + np.exp(-2.0 * _SINH))
_REST = 1.0 / (1.0 + np.exp(2.0 * _SINH))
_WEIGHT = np.pi / 64.0 * np.cosh(_AT) / np.cosh(_SINH) ** 2


def scanned(design: FiveBarDesign, mode: str) -> float:
    """The area from the lengths of what can be held of lines y = const."""
    made = workspace.made_of(design, (mode,))
    x, y = made.center.T
    r = made.radius
    marks = [y + r, y - r, made.at(0.0)[:, 1], made.at(1.0)[:, 1]]
    n, m = np.triu_indices(len(r), 1)
    between = made.center[m] - made.center[n]
    d = np.hypot(*between.T)
    n, m, between, d = (each[d > 1e-9] for each in (n, m, between, d))
    along = 0.5 * (d + (r[n] - r[m]) * (r[n] + r[m]) / d)
    up = np.sqrt(np.maximum(r[n] ** 2 - along**2, 0.0))
    marks += [y[n] + (along * between[:, 1] + turn * up * between[:, 0]) / d for turn in (1, -1)]
    knots = np.unique(np.concatenate(marks))
    knots = knots[np.append(True, np.diff(knots) > 1e-11 * design.size)]
    width = np.diff(knots)[:, None]
    lower = knots[:-1, None] + width * _SHARE
    line = np.where(_SHARE < 0.5, lower, knots[1:, None] - width * _REST).ravel()
    weight = (width * _WEIGHT).ravel()
    square = (r - np.abs(line[:, None] - y)) * (r + np.abs(line[:, None] - y))
    half = np.sqrt(np.where(square >= 0.0, square, np.nan))
    ends = np.sort(np.concatenate([x - half, x + half], axis=1), axis=1)
    total = 0.0
    for k in range(ends.shape[1] - 1):
        length = ends[:, k + 1] - ends[:, k]
        rows = np.flatnonzero(length > 0.0)
        if len(rows):
            middle = np.stack([0.5 * (ends[rows, k] + ends[rows, k + 1]), line[rows]], axis=-1)
            held = generic.inside(design, middle, (mode,))
            total += float(weight[rows] @ (length[rows] * held))
    return total


@pytest.mark.slow
def test_areas_are_those_of_lines_across() -> None:
    # Not the last: its range ends along y = 0, where the lines crowd, and has a slack of 1e-9 rad.
    for design in (*designs(), *SPECIAL[:-1]):
        for mode in inverse.MODES:
            area = outlines.section_of(workspace.loops(design, (mode,))).area
            near = 1e-13 * design.size**2
            assert area == pytest.approx(scanned(design, mode), rel=0, abs=near)


lengths = st.floats(20.0, 120.0)
ranges = st.tuples(st.floats(-180.0, 90.0), st.floats(10.0, 360.0))


@settings(max_examples=25)
@given(lengths, lengths, lengths, lengths, ranges, st.floats(-13.0, -2.0), st.integers(0, 7))
@example(20.0, 20.0, 20.0, 20.0, (0.0, 10.0), -5.0, 1)
@example(40.0, 55.05246414045177, 73.36839898806907, 102.69026240333623, (-170.0, 340.0), -7.618, 3)
def test_near_a_touch_areas_are_those_of_lines_across(
    a: float, b: float, c: float, d: float, limits: tuple[float, float], power: float, kind: int
) -> None:
    """Circles of two limbs that touch but for a part 10^power of their size."""
    low, span = limits
    one, two = (a + b, abs(a - b)), (c + d, abs(c - d))
    apart = one[kind % 2] + (1.0 if kind & 4 else -1.0) * two[kind // 2 % 2]
    half = 0.5 * abs(apart) + (a + b) * 10.0**power
    assume(half > 5.0)
    design = FiveBarDesign((Limb(a, b, (low, low + span)), Limb(c, d)), half)
    mode = inverse.MODES[kind % 4]
    section = outlines.section_of(workspace.loops(design, (mode,)))
    # What is thinner than 1e-7 of the size may be passed over: of a sliver between two circles
    # that is 1e-10 of its square. Ranges have a slack of 1e-9 rad, which only the lines count.
    slack = 1e-10 * design.size**2 + 1e-9 * design.size * section.perimeter
    assert section.area == pytest.approx(scanned(design, mode), rel=0, abs=slack)


# --- curves --------------------------------------------------------------------------------


def polygon_area(piece: curve_pieces.Piece, about: np.ndarray) -> float:
    """½ ∮ (x dy − y dx) along a piece, from polygons by Richardson's extrapolation."""
    areas = []
    for power in (14, 15, 16):
        share = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 2**power + 1)))
        x, y = (piece.loop.points(piece.tau(share))[0] - about).T
        areas.append(0.5 * float((x[:-1] * y[1:] - x[1:] * y[:-1]).sum()))
    once = [(4.0 * areas[k + 1] - areas[k]) / 3.0 for k in range(2)]
    return (16.0 * once[1] - once[0]) / 15.0


def test_curves_are_integrated_to_what_they_state() -> None:
    """Near cusps too, and where P turns fast: a rule of one width was off by up to 1e-6."""
    told = 0
    for design in (*designs(), SPECIAL[2]):
        for piece in curve_pieces.pieces(design)[::2]:
            edge = curve_edge(design, piece)
            about = edge.nodes.mean(axis=0)
            area = float(arcs.moments(edge.nodes - about, edge.steps)[0])
            off = abs(area - polygon_area(piece, about))
            assert off <= edge.area_error + 1e-14 * design.size**2
            assert edge.area_error < 1e-12 * design.size**2
            told += 1
    assert told > 40


def test_points_are_exact_at_turning_points() -> None:
    """As near to them as one likes; with differences of lengths half the digits were lost."""
    aside = np.concatenate([[0.0], 10.0 ** np.arange(-12.0, -1.0)])
    for design in designs():
        for loop in curves.loops(design):
            if loop.kind != "swinging":
                continue
            for turn in (0.5 * np.pi, 1.5 * np.pi):
                before, after = (loop.points(turn + way * aside)[0] for way in (-1.0, 1.0))
                # P(τ) is smooth there: the second difference goes down with the square.
                bend = np.hypot(*(before + after - 2.0 * before[0]).T)
                assert (bend <= 1e-13 * design.size + 1e4 * design.size * aside**2).all()
