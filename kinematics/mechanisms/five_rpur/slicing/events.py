"""Where the structure of the workspace's section may change as its plane moves along x'.

In the plane x' = const the circles of limb i stand at z' = w'_iz ± S(ρ, x' − w'_ix): their centres
run along circles of radius ρ_min and ρ_max about (w'_ix, w'_iz). Two circles of radii l_i, l_j
touch where their centres are apart by t = ±sqrt((l_i ± l_j)² − Δy²) along z': where the one's
centre circle, moved by t, crosses the other's. All of that has closed forms. (Where three circles
of three limbs meet in a point has none; `volume` finds those by looking at the sections.)
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array

_SLACK = 1e-6  # of the size: what misses the region by less counts as an event


def events(limbs: Array, signs: NDArray[np.bool_], size: float) -> Array:
    """Where sections may change their structure, increasing, without doubles, mm.

    Args:
        limbs: (6, n) w'_x, w'_y, w'_z, l, ρ_min, ρ_max.
        signs: (n, 2) which signs of each limb are asked for.
        size: mm, a length of the machine.
    """
    wx, wy, _, link, low, high = limbs
    first, last = float((wx - high).max()), float((wx + high).min())
    low_y, high_y = float((wy - link).max()), float((wy + link).min())
    if first >= last or low_y >= high_y:
        return np.empty(0)
    found = [
        np.array([first, last]),
        np.concatenate([wx - low, wx + low])[np.tile(low > 0.0, 2)],
        _tangencies(limbs, signs, size),
        *(_on_line(limbs, signs, size, y) for y in (low_y, high_y)),
    ]
    at = np.concatenate(found)
    at = np.sort(at[(at >= first) & (at <= last)])
    apart = np.diff(at, prepend=-np.inf) > 1e-9 * size
    return np.asarray(at[apart])


@lru_cache(maxsize=8)
def _pairs(n: int) -> tuple[NDArray[np.intp], ...]:
    """Pairs of centre circles (limb, bound) × (limb, bound), each pair once, own pairs too."""
    one, two = np.triu_indices(2 * n)
    return one // 2, one % 2, two // 2, two % 2


def _crossings(
    x1: Array, z1: Array, r1: Array, x2: Array, z2: Array, r2: Array
) -> tuple[Array, Array]:
    """x and z of both crossings of circles in the x'z' plane, (2, …); NaN where there is none."""
    dx, dz = x2 - x1, z2 - z1
    square = dx * dx + dz * dz
    with np.errstate(divide="ignore", invalid="ignore"):
        along = 0.5 * (square + (r1 - r2) * (r1 + r2)) / square
        rest = r1 * r1 / square - along * along
        # A touch is a crossing that rounding may have lost.
        across = np.sqrt(np.where((rest < 0.0) & (rest > -1e-12), 0.0, rest))
        x, z = x1 + along * dx, z1 + along * dz
        return np.stack([x - across * dz, x + across * dz]), np.stack(
            [z + across * dx, z - across * dx]
        )


def _tangencies(limbs: Array, signs: NDArray[np.bool_], size: float) -> Array:
    wx, wy, wz, link, low, high = limbs
    radius = np.stack([low, high], axis=-1)
    i, a, j, b = _pairs(limbs.shape[1])
    r1, r2 = radius[i, a], radius[j, b]
    dy = wy[j] - wy[i]
    sums = np.stack([link[i] + link[j], link[i] - link[j]])  # from outside, from inside
    with np.errstate(invalid="ignore"):
        apart = np.sqrt(sums * sums - dy * dy)
    apart = np.stack([apart, -apart])  # (2 signs, 2 kinds, pairs)
    x, z = _crossings(wx[i], wz[i] + apart, r1, wx[j], wz[j], r2)
    # Where the circles touch, seen from the first centre; equal circles coincide instead.
    with np.errstate(divide="ignore", invalid="ignore"):
        share = link[i] / sums
        y_touch = wy[i] + share[None] * dy
        z_touch = z - apart + share[None] * apart
    y_touch = np.broadcast_to(y_touch, z_touch.shape)
    same = np.broadcast_to((sums == 0.0) & (dy == 0.0), x.shape)
    reached = _within(limbs, signs, size, x, np.where(same, 0.0, y_touch), z_touch)
    keep = np.isfinite(x) & (reached | same)
    return np.asarray(x[keep])


def _on_line(limbs: Array, signs: NDArray[np.bool_], size: float, y: float) -> Array:
    """Where two bounds cross on the line that ends the region."""
    wx, wy, wz, link, low, high = limbs
    n = limbs.shape[1]
    t = y - wy
    h = np.sqrt(np.maximum((link - t) * (link + t), 0.0))
    radius = np.stack([low, high], axis=-1)
    i, a, j, b = _pairs(2 * n)  # of every limb both signs
    z = np.concatenate([wz + h, wz - h])
    x, height = _crossings(wx[i % n], z[i], radius[i % n, a], wx[j % n], z[j], radius[j % n, b])
    keep = np.isfinite(x) & _within(limbs, signs, size, x, np.full(x.shape, y), height)
    return np.asarray(x[keep])


def _within(
    limbs: Array, signs: NDArray[np.bool_], size: float, x: Array, y: Array, z: Array
) -> NDArray[np.bool_]:
    """Whether all limbs reach the points, give or take the slack."""
    slack = _SLACK * size
    result = np.ones(x.shape, dtype=bool)
    with np.errstate(invalid="ignore"):
        for (wx, wy, wz, link, low, high), (plus, minus) in zip(limbs.T, signs, strict=True):
            t = y - wy
            h = np.sqrt(np.maximum((link - t) * (link + t), 0.0))
            result &= np.abs(t) <= link + slack
            one = np.zeros(x.shape, dtype=bool)
            for asked, rise in ((plus, h), (minus, -h)):
                if asked:
                    rho = np.hypot(x - wx, z - wz - rise)
                    one |= (rho >= low - slack) & (rho <= high + slack)
            result &= one
    return result
