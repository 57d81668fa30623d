"""How many digits of a fitted polynomial have to be printed for it to be as good as the fit."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinematics.answers.trajectories import Trajectory
from kinematics.arrays import Array
from kinematics.facets.faceted import Faceted

FEWEST, MOST = 4, 17  # significant digits; a double has no more
ADDS = 0.01  # of the true error: what rounding may add
_FLOOR = 1e-10  # of the characteristic length, or rad: an error that is smaller is none

Orders = tuple[Array, Array, Array]
"""Values, first and second derivatives by time."""


def values_of(coefficients: Array, times: Array) -> Orders:
    """Polynomials (J, degree + 1), from t⁰ upwards, and their derivatives at times: (N, J) each, as
    who has the printed numbers gets them."""
    found: list[Array] = []
    for order in range(3):
        rows = [np.polynomial.polynomial.polyder(row, order) for row in coefficients]
        values: Array = np.stack(
            [np.polynomial.polynomial.polyval(times, row) for row in rows], axis=-1
        )
        found.append(values)
    return found[0], found[1], found[2]


def rounded(coefficients: Array, digits: int) -> Array:
    """The numbers as they are printed with so many significant digits."""
    flat = [float(f"{value:.{digits}g}") for value in coefficients.ravel().tolist()]
    return np.array(flat).reshape(coefficients.shape)


def digits_needed(
    machine: Faceted[Any],
    found: Trajectory,
    coefficients: Array,
    exact: Orders,
    errors: Orders,
) -> int | None:
    """The fewest digits with which the platform deviates by `ADDS` of its true error at most.

    Args:
        exact: (N, J) of the polynomials, before they were powers of t.
        errors: (N, P) of the pose, its rates and accelerations; NaN where the machine does not come
            through: then the joints' own errors count.

    Returns:
        None where all 17 digits are not enough, because powers of t cancel.
    """
    length = machine.length
    axes = machine.coordinates
    scale = np.array([length if axis.unit == "mm" else 1.0 for axis in axes])
    through = all(np.isfinite(each).all() for each in errors)
    for digits in range(FEWEST, MOST + 1):
        shapes = values_of(rounded(coefficients, digits), found.times)
        off = [one - other for one, other in zip(shapes, exact, strict=True)]
        if not through:
            own = exact[0] - found.joints
            size = np.maximum(np.abs(own).max(axis=0), _FLOOR * length)
            if (np.abs(off[0]).max(axis=0) <= ADDS * size).all():
                return digits
            continue
        moved = (machine.motion.forward(found.poses, found.mode, each) for each in off)
        if all(
            _small(motion.pose_rates, error, _FLOOR * scale / found.duration**order)
            for order, (motion, error) in enumerate(zip(moved, errors, strict=True))
        ):
            return digits
    return None


def _small(added: Array, error: Array, floor: Array) -> bool:
    known = np.isfinite(added).all(axis=1)  # a singularity on the way leaves it open
    added = added[known]
    spread = np.maximum(np.std(error, axis=0, ddof=1), floor)
    most = np.maximum(np.abs(error).max(axis=0), floor)
    mean = np.sqrt(np.mean(added**2, axis=0)) if len(added) else np.zeros_like(floor)
    return bool(
        (mean <= ADDS * spread).all()
        and (np.abs(added).max(axis=0, initial=0.0) <= ADDS * most).all()
    )
