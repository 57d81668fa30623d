"""Plane regions inside some circles and outside others."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.plane.annuli import Rings, inside, rings_moments, rings_section, roomiest
from kinematics.plane.regions import nearest_point


def rings(*each) -> Rings:
    """From (x, y, inner, outer)."""
    table = np.array(each, dtype=float)
    return Rings(table[:, :2], table[:, 2], table[:, 3], np.arange(1, len(table) + 1))


RINGS = st.lists(
    st.tuples(
        st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-0.2, 1.2), st.floats(0.3, 2.0)
    ),
    min_size=1,
    max_size=5,
).map(lambda each: rings(*each))


@settings(max_examples=60)
@given(RINGS)
def test_area_and_moments_are_those_of_a_grid(region: Rings) -> None:
    section = rings_section(region)
    steps = (np.arange(300) + 0.5) / 300.0 * 6.0 - 3.0
    points = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    held = points[inside(region, points)]
    cell = 4e-4
    slack = 0.5 * section.perimeter * 0.02 + 4 * cell
    assert section.area == pytest.approx(len(held) * cell, abs=slack)
    area, first = rings_moments(region)
    assert area == pytest.approx(section.area, abs=1e-12)
    if section.area > 0.05:
        assert first / area == pytest.approx(section.centroid, abs=1e-9)
        apart = held - section.centroid
        second = np.array([(apart**2).sum(axis=0)[0], (apart**2).sum(axis=0)[1]]) * cell
        assert section.second_moments[:2] == pytest.approx(second, abs=6.0 * slack)


@settings(max_examples=60)
@given(RINGS)
def test_loops_are_closed_and_leave_the_region_to_their_left(region: Rings) -> None:
    section = rings_section(region)
    for n in range(section.loops):
        edges = range(section.loop_start[n], section.loop_start[n + 1])
        for k in edges:
            following = k + 1 if k + 1 in edges else edges[0]
            assert np.abs(section.end[k] - section.start[following]).max() < 1e-6
            middle = section.edge_points(k, np.inf)
            chord = section.center[k] + (middle[len(middle) // 2] - section.center[k])
            if abs(section.sweep[k]) * section.radius[k] > 1e-3:
                out = (chord - section.center[k]) / section.radius[k]
                left = chord - np.sign(section.sweep[k]) * 1e-7 * out
                right = chord + np.sign(section.sweep[k]) * 1e-7 * out
                assert not inside(region, right)
                if abs(section.sweep[k]) * section.radius[k] > 1e-2:
                    assert inside(region, left)
    assert section.loop_area.sum() == pytest.approx(section.area, abs=1e-12)
    if section.loops:
        point = roomiest(region, section)
        if section.area > 1e-2:
            assert inside(region, point)


@settings(max_examples=40)
@given(RINGS, st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)))
def test_the_nearest_point_of_the_boundary(region: Rings, point) -> None:
    section = rings_section(region)
    found = nearest_point(section, point)
    if found is None:
        assert section.loops == 0
        return
    rim = np.concatenate([section.polyline(n, 0.01) for n in range(section.loops)])
    away = np.linalg.norm(rim - point, axis=1).min()
    assert np.linalg.norm(found[0] - point) <= away + 1e-9
    assert np.linalg.norm(found[0] - point) >= away - 0.01


@pytest.mark.parametrize(
    ("region", "area", "loops"),
    [
        (rings((0, 0, 0, 2)), 4.0, 1),
        (rings((0, 0, 1, 2)), 3.0, 2),
        (rings((0, 0, 1, 2), (0, 0, 0, 2)), 3.0, 2),  # one circle twice
        (rings((0, 0, 0, 2), (1, 0, 1, 5)), 3.0, 2),  # a hole that touches the rim
        (rings((0, 0, 0, 2), (3, 0, 0, 1)), 0.0, 0),  # discs that touch
        (rings((0, 0, 0, 2), (0, 0, 2, 3)), 0.0, 0),  # inside and outside of one circle
        (rings((0, 0, 2, 1)), 0.0, 0),
        (rings((0, 0, np.nan, 2)), 4.0, 1),
        (rings((0, 0, 0, 2), (0, 0, 0, np.nan)), 0.0, 0),
        (rings((0, 0, 0, 2), (9, 9, 0, np.inf)), 4.0, 1),
        (rings((0, 0, 0, 2), (-1, 0, 1, 9), (1, 0, 1, 9)), 2.0, 3),
    ],
)
def test_what_is_degenerate(region: Rings, area: float, loops: int) -> None:
    section = rings_section(region, at=7.0)
    assert section.area / np.pi == pytest.approx(area)
    assert section.loops == loops
    assert section.at == 7.0
    assert len(section.construction.radius) == len(section.construction.circle_limb)


def test_holes_belong_to_the_piece_around_them() -> None:
    section = rings_section(rings((0, 0, 0, 10), (0, 0, 8, 20), (0, 9, 0.2, 30), (0, -9, 0.3, 30)))
    assert section.pieces == 1
    assert sorted(section.loop_area / np.pi) == pytest.approx([-64.0, -0.09, -0.04, 100.0])


def test_a_large_circle_stands_for_a_line() -> None:
    half = rings((0, 0, 0, 100), (1e9, 0, 0, 1e9))
    assert rings_section(half).area == pytest.approx(0.5 * np.pi * 1e4, rel=1e-6)
