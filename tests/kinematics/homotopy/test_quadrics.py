"""Quadratic systems that are written as they read."""

from __future__ import annotations

import numpy as np

from kinematics.homotopy.quadrics import Quadrics, dot, image, square, unknowns

RNG = np.random.default_rng(14)


def system() -> Quadrics:
    x, y, z = unknowns(3)
    turned = image([[x, y], [z, 2.0 * x]], [3.0, -1.0])
    return Quadrics.of(
        [
            0.5 * ((square(x - 1.0) + 7.0) + ((y + 2.0).by(3.0 - z) - 2.5)) - 4.0,
            dot(turned, [y, x]) - 2.0 * z + 5.0,
        ]
    )


def as_written(x: float, y: float, z: float) -> list[float]:
    first = 0.5 * ((x - 1.0) ** 2 + 7.0 + (y + 2.0) * (3.0 - z) - 2.5) - 4.0
    return [first, (3.0 * x - y) * y + (3.0 * z - 2.0 * x) * x - 2.0 * z + 5.0]


def test_values_are_as_written() -> None:
    for v in RNG.normal(size=(10, 3)):
        np.testing.assert_allclose(system().values(v), as_written(*v), atol=1e-13)


def test_derivatives_are_exact() -> None:
    equations = system()
    for v, way in RNG.normal(size=(10, 2, 3)):
        there = equations.values(v) + equations.slopes(v) @ way
        there = there + 0.5 * (equations.bends @ way) @ way
        np.testing.assert_allclose(equations.values(v + way), there, atol=1e-13)


def test_a_system_along_a_plane_is_the_system_there() -> None:
    place, directions, z = RNG.normal(size=3), RNG.normal(size=(3, 2)), RNG.normal(size=2)
    along, v = system().along(place, directions), place + directions @ z
    np.testing.assert_allclose(along.values(z), system().values(v), atol=1e-13)
    np.testing.assert_allclose(along.slopes(z), system().slopes(v) @ directions, atol=1e-13)
