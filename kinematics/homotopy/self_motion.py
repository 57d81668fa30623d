"""Curves of solutions: what stays free with all joints locked.

At a singular solution something is free to first order. Solutions are sought a finite way along it:
at a fold there are none, on a self-motion they exist on both sides.
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.homotopy.quadrics import Quadrics

TRIES = (0.03, 0.15)
"""How far along a free direction solutions must exist, in steps of the unknowns."""
_SINGULAR = 1e-4  # smallest singular value of the equations, relative to the largest
_CLOSES = 1e-12  # of the equations, relative
_ROUNDS = 40


def curve_of_solutions(
    equations: Quadrics, guess: Array, tries: tuple[float, ...] = TRIES
) -> tuple[Array, Array] | None:
    """A solution (n,) near a guess that lies on a curve of them, and its unit direction (n,).

    Args:
        equations: n in n unknowns.
        tries: how far along it solutions must exist, on both sides.

    Returns:
        None where there is no solution near, or only that one.
    """
    here = _closed(equations, guess)
    if here is None:
        return None
    _, sizes, vectors = np.linalg.svd(equations.slopes(here))
    for direction in _directions(vectors[sizes <= _SINGULAR * sizes[0]]):
        steps = (sign * step * direction for step in tries for sign in (1.0, -1.0))
        if all(_reaches(equations, here, step) for step in steps):
            return here, direction
    return None


def _directions(free: Array) -> list[Array]:
    """The free directions, and between two of them some more."""
    if len(free) < 2:
        return list(free)
    angles = np.linspace(0.0, np.pi, 12, endpoint=False)
    return [np.cos(a) * free[-1] + np.sin(a) * free[-2] for a in angles]


def _reaches(equations: Quadrics, here: Array, step: Array) -> bool:
    """There is a solution about ``step`` away."""
    there = _closed(equations, here + step)
    if there is None:
        return False
    moved = there - here
    size = float(np.linalg.norm(step))
    return bool(moved @ step > 0.5 * size * size and np.linalg.norm(moved) < 3.0 * size)


def _closed(equations: Quadrics, guess: Array) -> Array | None:
    """The nearest solution by Gauss-Newton steps of least length; None if there is none."""
    point = guess
    for _ in range(_ROUNDS):
        values = equations.values(point)
        if np.abs(values).max() <= _CLOSES * equations.size**2:
            return point
        step = np.linalg.lstsq(equations.slopes(point), -values, rcond=1e-9)[0]
        point = point + step * min(1.0, 0.2 / max(float(np.abs(step).max()), 1e-300))
    return None
