"""Zeros of functions along straight ways, for curves and surfaces alike."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kinematics.arrays import Array

Field = Callable[[Array], tuple[Array, Array]]
"""A function's values (N,) and gradients (N, D) at points (N, D)."""

_STEPS = 40  # bisection alone would do


def zeros_between(
    field: Field, a: Array, b: Array, fa: Array, fb: Array, tolerance: float
) -> tuple[Array, Array]:
    """The zeros of a function between points (N, D) where its signs differ, and residuals.

    Newton's method between ends that close in, halved where a step would leave them.

    Args:
        field: the function; D is 3, or what it takes.
        a, b: (N, D) the points.
        fa, fb: (N,) the values there.
        tolerance: of |F| / |∇F|, the distance to the zero to first order.
    """
    along = b - a
    length = np.linalg.norm(along, axis=1)
    rising = np.where(fb >= fa, 1.0, -1.0)
    low, high = np.zeros(len(a)), np.ones(len(a))
    t = np.abs(fa) / np.maximum(np.abs(fa) + np.abs(fb), 1e-300)
    residual = np.zeros(len(a))
    active = np.arange(len(a))
    for _ in range(_STEPS):
        if not len(active):
            break
        value, gradient = field(a[active] + t[active, None] * along[active])
        slope = np.einsum("ij,ij->i", gradient, along[active])
        steep = np.maximum(np.linalg.norm(gradient, axis=1), 1e-300)
        residual[active] = np.abs(value) / steep
        below = rising[active] * value < 0.0
        low[active] = np.where(below, t[active], low[active])
        high[active] = np.where(below, high[active], t[active])
        with np.errstate(divide="ignore", invalid="ignore"):
            step = -value / slope
        wanted = t[active] + step
        lost = ~((wanted > low[active]) & (wanted < high[active]))
        wanted = np.where(lost, 0.5 * (low[active] + high[active]), wanted)
        # Done where the zero is known, or nothing lies between the ends any more.
        done = residual[active] <= tolerance
        done |= (high[active] - low[active]) * length[active] <= 1e-3 * tolerance
        t[active] = np.where(done, t[active], wanted)
        active = active[~done]
    return a + t[:, None] * along, residual
