"""Paths and time laws: ends, derivatives, corners, limits, what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics import trajectories as t
from kinematics.errors import InputError

UNIT = (1.0, 1.0)
CORNERS = [(0.0, 0.0), (100.0, 0.0), (100.0, 60.0), (20.0, 80.0)]


def _paths() -> dict[str, t.Path]:
    rng = np.random.default_rng(1)
    angle = np.linspace(0.0, 5.0, 90)
    hand = 50 * np.stack([np.cos(angle), np.sin(angle)], axis=-1) + rng.normal(size=(90, 2)) * 0.3
    return {
        "line": t.line((1.0, 2.0), (30.0, -5.0), UNIT),
        "rounded": t.polyline(CORNERS, UNIT, 15.0),
        "wide": t.polyline(CORNERS, UNIT, 1e4),
        "spline": t.spline(CORNERS, UNIT),
        "timed": t.spline(CORNERS, UNIT, [0.0, 1.0, 3.0, 3.5]),
        "drawn": t.drawn(hand, UNIT, 0.5),
        "angles": t.polyline([(0.0, 0.0), (5.0, 0.3), (9.0, 0.1)], (1.0, 100.0), 3.0),
    }


@pytest.mark.parametrize("name", _paths())
def test_derivatives_are_those_of_differences(name: str) -> None:
    path = _paths()[name]
    s = np.linspace(0.013, 0.987, 101)
    h = 1e-6
    _, first, second = path.at(s)
    up, down, here = (path.at(s + d)[0] for d in (h, -h, 0.0))
    np.testing.assert_allclose(first, (up - down) / (2 * h), rtol=1e-5, atol=1e-4)
    up1, down1 = (path.at(s + d)[1] for d in (h, -h))
    difference = (up1 - down1) / (2 * h)
    smooth = np.abs(difference - second).max(axis=1) < 1e-2 * (1 + np.abs(second).max())
    assert smooth.mean() > 0.95  # of a polyline but for where corners begin
    assert np.isfinite(here).all()
    # The length is that of the way, but for corners, which count as their tangents.
    fine = path.at(np.linspace(0.0, 1.0, 4001))[0] * np.array(path.scale)  # type: ignore[attr-defined]
    way = float(np.linalg.norm(np.diff(fine, axis=0), axis=1).sum())
    assert way <= path.length * (1 + 1e-6)
    assert way >= 0.8 * path.length


def test_ends_and_points_are_met() -> None:
    for name in ("rounded", "spline", "timed", "wide"):
        ends = _paths()[name].at([0.0, 1.0])[0]
        np.testing.assert_allclose(ends, [CORNERS[0], CORNERS[-1]], atol=1e-12)
    timed = t.spline(CORNERS, UNIT, [0.0, 1.0, 3.0, 3.5])
    np.testing.assert_allclose(timed.at(np.array([0, 1, 3, 3.5]) / 3.5)[0], CORNERS, atol=1e-12)
    sharp = t.polyline(CORNERS, UNIT)
    dense = sharp.at(np.linspace(0, 1, 30001))[0]
    for corner in CORNERS:
        assert np.hypot(*(dense - corner).T).min() < 0.01
    rounded = t.polyline(CORNERS, UNIT, 15.0).at(np.linspace(0, 1, 30001))[0]
    # A parabola passes its corner at a quarter of the bisector of its two tangents.
    assert np.hypot(*(rounded - CORNERS[1]).T).min() == pytest.approx(15 * np.sqrt(2) / 4, abs=1e-2)
    assert isinstance(t.polyline(CORNERS[:2], UNIT), t.Line)


def test_a_velocity_is_continuous_through_blends() -> None:
    path = t.polyline(CORNERS, UNIT, 15.0)
    s = np.linspace(0.0, 1.0, 100001)
    _, first, _ = path.at(s)
    assert np.abs(np.diff(first, axis=0)).max() < 0.5
    assert np.linalg.norm(first, axis=1).max() == pytest.approx(path.length)


def test_a_drawing_is_smoothed_and_closes() -> None:
    rng = np.random.default_rng(1)
    angle = np.linspace(0.0, 2 * np.pi, 120)
    circle = 50.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    closed = t.drawn(circle + rng.normal(size=circle.shape) * 0.4, UNIT, 0.6)
    assert isinstance(closed, t.Drawn)
    assert closed.closed
    p, first, _ = closed.at(np.linspace(0.0, 1.0, 401))
    np.testing.assert_allclose(p[0], p[-1], atol=1e-9)
    np.testing.assert_allclose(first[0], first[-1], atol=1e-6)
    assert np.abs(np.hypot(*p.T) - 50.0).max() < 1.0
    hash(closed)


@pytest.mark.parametrize("kind", t.LAWS)
@pytest.mark.parametrize("ramp", [0.1, 0.25, 0.5])
def test_laws(kind: str, ramp: float) -> None:
    law = t.law(kind, 2.5, ramp=ramp)
    s, _, _ = law.at([-1.0, 0.0, 2.5, 9.0])
    np.testing.assert_allclose(s, [0.0, 0.0, 1.0, 1.0], atol=1e-15)
    times = np.linspace(0.01, 2.49, 998)
    h = 1e-6
    s, ds, dds = law.at(times)
    np.testing.assert_allclose(
        ds, (law.at(times + h)[0] - law.at(times - h)[0]) / (2 * h), atol=1e-5
    )
    difference = (law.at(times + h)[1] - law.at(times - h)[1]) / (2 * h)
    assert (np.abs(dds - difference) < 1e-4).mean() > 0.99
    assert (np.diff(s) > 0.0).all()
    if kind != "linear":
        np.testing.assert_allclose(law.at([0.0, 2.5])[1], 0.0, atol=1e-12)
    if kind == "quintic":
        np.testing.assert_allclose(law.at([0.0, 2.5])[2], 0.0, atol=1e-12)


def test_a_trapezoid_keeps_its_limits_and_is_the_fastest() -> None:
    for length, speed, acceleration in ((100.0, 50.0, 80.0), (5.0, 50.0, 80.0)):
        law = t.trapezoidal(length, speed, acceleration)
        s, ds, dds = law.at(np.linspace(0.0, law.duration, 1001))
        assert length * ds.max() <= speed * (1 + 1e-12)
        assert length * np.abs(dds).max() == pytest.approx(acceleration)
        assert s[-1] == pytest.approx(1.0)
    assert t.trapezoidal(5.0, 50.0, 80.0).ramp == 0.5


def test_the_paper_s_rest_to_rest_is_the_quintic_on_a_line() -> None:
    """Eqs. 10 to 15 with their signs corrected, in cm."""
    path = t.line((0.0, 73.8644), (24.0, 45.0), UNIT)
    time = np.linspace(0.0, 2.0, 21)
    s, ds, dds = t.law("quintic", 2.0).at(time)
    p, slope, _ = path.at(s)
    x = 4.5 * time**5 - 22.5 * time**4 + 30 * time**3
    y = -5.412075 * time**5 + 27.060375 * time**4 - 36.0805 * time**3 + 73.8644
    np.testing.assert_allclose(p, np.stack([x, y], axis=-1), atol=1e-12)
    rate = 22.5 * time**4 - 90 * time**3 + 90 * time**2
    np.testing.assert_allclose(slope[:, 0] * ds, rate, atol=1e-11)
    np.testing.assert_allclose(
        slope[:, 0] * dds, 90 * time**3 - 270 * time**2 + 180 * time, atol=1e-10
    )


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: t.line((0, 0), (0, 0), UNIT), "are one pose"),
        (lambda: t.polyline([(0, 0), (0, 0)], UNIT), "same as the one before"),
        (lambda: t.polyline([(0, 0)], UNIT), "at least two"),
        (lambda: t.polyline(CORNERS, UNIT, -1.0), "0 mm or more"),
        (lambda: t.spline([(0, 0), (1, np.nan)], UNIT), "finite"),
        (lambda: t.spline(CORNERS, UNIT, [0, 2, 1, 3]), "point 3 is not later"),
        (lambda: t.drawn([(0, 0), (0, 1e-12)], UNIT), "two different"),
        (lambda: t.law("septic", 1.0), "no time law"),
        (lambda: t.law("cubic", 0.0), "duration"),
        (lambda: t.law("cubic", float("nan")), "duration"),
        (lambda: t.law("trapezoidal", 1.0, ramp=0.6), "ramp"),
        (lambda: t.trapezoidal(1.0, 0.0, 1.0), "positive"),
    ],
)
def test_mistakes(make: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()  # type: ignore[operator]


def test_a_point_twice_in_a_row_is_told_by_its_number() -> None:
    points = [[0.0, 0.0], [10.0, 0.0], [10.0, 0.0], [10.0, 5.0]]
    for make in (t.polyline, t.spline):
        with pytest.raises(InputError, match=r"^point 3 of the path is the same as the one before"):
            make(points, (1.0, 1.0))
