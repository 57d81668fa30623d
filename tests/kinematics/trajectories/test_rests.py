"""Points with times: where a point follows itself the way rests; corners are a choice."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.trajectories import spline

SCALE = (1.0, 1.0)


def test_a_pause_stays() -> None:
    path = spline([(60.0, 250.0), (60.0, 250.0)], SCALE, [1.0, 2.0])
    places, rates, bends = path.at(np.linspace(0.0, 1.0, 50))
    assert (places == [60.0, 250.0]).all()
    assert not np.any(rates)
    assert not np.any(bends)


@given(st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=1, max_size=6))
def test_every_pause_on_the_way_stays_and_is_reached_without_speed(
    points: list[tuple[float, float]],
) -> None:
    way = [(-20.0, 0.0), *points, *points[-1:], (20.0, 0.0)]
    times = np.arange(len(way), dtype=float)
    path = spline(way, SCALE, times)
    last = len(way) - 2
    between = np.linspace(last - 1.0, last, 20) / times[-1]
    np.testing.assert_allclose(path.at(between)[0], np.tile(points[-1], (20, 1)), atol=1e-9)
    ends = np.array([last - 1.0 - 1e-9, last + 1e-9]) / times[-1]
    assert np.abs(path.at(ends)[1]).max() < 1e-5 * (1.0 + np.abs(way).max()) * times[-1] ** 2
    np.testing.assert_allclose(path.at(times / times[-1])[0], way, atol=1e-9)


def test_without_pauses_it_is_the_natural_spline() -> None:
    way = [(0.0, 0.0), (1.0, 2.0), (3.0, 1.0), (4.0, 4.0)]
    path = spline(way, SCALE, [0.0, 1.0, 2.0, 3.0])
    assert np.abs(path.at([0.0, 1.0])[2]).max() < 1e-9
    step = 1e-6
    _, before, _ = path.at([1 / 3 - step])
    _, after, _ = path.at([1 / 3 + step])
    np.testing.assert_allclose(before, after, atol=1e-3)


def test_corners_are_passed_at_the_times_given() -> None:
    way = [(0.0, 0.0), (10.0, 0.0), (10.0, 0.0), (10.0, 5.0)]
    path = spline(way, SCALE, [0.0, 1.0, 3.0, 4.0], corners=True)
    places, rates, bends = path.at(np.array([0.5, 2.0, 3.5]) / 4.0)
    np.testing.assert_allclose(places, [[5.0, 0.0], [10.0, 0.0], [10.0, 2.5]])
    np.testing.assert_allclose(rates, [[40.0, 0.0], [0.0, 0.0], [0.0, 20.0]])
    assert not np.any(bends)
    assert path.length == pytest.approx(15.0)
