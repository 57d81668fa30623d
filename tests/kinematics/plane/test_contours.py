"""Zero curves: on the curve, whole, and closed where it is."""

from __future__ import annotations

import numpy as np

from kinematics.plane.contours import zero_curves


def circle(points):
    return (points**2).sum(axis=1) - 1.0, 2.0 * points


def test_a_circle_is_one_closed_curve_of_exact_points() -> None:
    x, y = np.linspace(-2, 2, 21), np.linspace(-1.5, 1.7, 30)  # nodes lie on it
    values = x[:, None] ** 2 + y**2 - 1.0
    found = zero_curves(x, y, values, circle)
    assert len(found.start) == 2
    assert (found.points[0] == found.points[-1]).all()
    assert np.abs(np.linalg.norm(found.points, axis=1) - 1.0).max() < 1e-12
    assert found.residual.max() < 1e-12
    steps = np.linalg.norm(np.diff(found.points, axis=0), axis=1)
    assert 6.2 < steps.sum() < 2.0 * np.pi


def test_branches_are_open_where_the_rectangle_ends() -> None:
    x, y = np.linspace(-2, 2, 40), np.geomspace(1, 5, 40) - 3

    def hyperbola(points):
        return points[:, 0] * points[:, 1] - 0.5, points[:, ::-1]

    found = zero_curves(x, y, x[:, None] * y - 0.5, hyperbola)
    assert len(found.start) == 3
    assert np.abs(found.points.prod(axis=1) - 0.5).max() < 1e-11
    ends = found.points[[0, found.start[1] - 1, found.start[1], -1]]
    assert np.isclose(np.abs(ends), 2.0).any(axis=1).all()


def test_no_zero_no_curve() -> None:
    x = np.linspace(0.1, 0.2, 5)
    found = zero_curves(x, x, x[:, None] ** 2 + x**2 - 1.0, circle)
    assert found.start.tolist() == [0]
    assert found.points.shape == (0, 2)
    assert found.residual.shape == (0,)
