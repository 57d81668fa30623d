"""A set of wrenches that holds a platform: how well, and with what forces a load.

Wrenches are rows [F, T about O′] of a `motion.WrenchSystem`, N and N·mm in any common scale. A
characteristic length makes moments comparable with forces. Everything is in batches (..., R, 6).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Statics, WrenchName
from kinematics.arrays import Array, finite

RANK = 1e-12
"""Smallest singular value of normalised wrenches below which no balance is computed."""


def normalised(rows: ArrayLike, length: float) -> Array:
    """Rows with moments divided by ``length`` (mm), each of unit size; a zero row stays zero."""
    scaled = np.asarray(rows, dtype=float) / _scale(length)
    size = np.linalg.norm(scaled, axis=-1, keepdims=True)
    with np.errstate(invalid="ignore"):
        unit: Array = scaled / np.where(size > 0.0, size, 1.0)
    return unit


def singular_values(rows: ArrayLike, length: float) -> Array:
    """Of the normalised wrenches, (..., min(R, 6)), largest first; NaN where a row is NaN."""
    unit = normalised(rows, length)
    good = np.asarray(np.isfinite(unit).all(axis=(-1, -2)))
    values = np.linalg.svd(np.where(good[..., None, None], unit, 0.0), compute_uv=False)
    answer: Array = np.where(good[..., None], values, np.nan)
    return answer


def determinant(rows: ArrayLike, length: float) -> Array:
    """Of six unit wrenches, forces with their moments divided by ``length`` (mm); (...,).

    Rows are taken as unit forces, or unit couples where the force vanishes; so it has no unit, and
    the reference point changes nothing. NaN where a row is NaN or vanishes.
    """
    given = np.asarray(rows, dtype=float)
    force = np.linalg.norm(given[..., :3], axis=-1, keepdims=True)
    couple = np.linalg.norm(given[..., 3:], axis=-1, keepdims=True)
    size = np.where(force > 0.0, force, couple / length)
    with np.errstate(invalid="ignore", divide="ignore"):
        unit = given / _scale(length) / size
    good = np.asarray(np.isfinite(unit).all(axis=(-1, -2)))
    value: Array = np.linalg.det(np.where(good[..., None, None], unit, 0.0))
    return np.where(good, value, np.nan)


def equilibrium(
    names: tuple[WrenchName, ...],
    rows: ArrayLike,
    loads: ArrayLike,
    length: float,
    gain: ArrayLike = 1.0,
) -> Statics:
    """The multiples of six wrenches that balance loads: Σ λ_i row_i + load = 0.

    Args:
        names: of the six.
        rows: (..., 6, 6).
        loads: (..., 6) [F, T about O′], N and N·mm; broadcasts with ``rows``.
        length: mm, the characteristic length.
        gain: (..., 6) what an actuator's force is per multiple of its wrench: ∂(power)/∂(rate),
            row·twist = gain · joint rate; 1 for constraints.

    Returns:
        NaN where the wrenches are dependent (`RANK`) or not finite.

    Raises:
        InputError: a load is not six finite numbers.
    """
    load = finite(loads, name="a load", last=6)
    scale = _scale(length)
    scaled = np.asarray(rows, dtype=float) / scale
    shape = np.broadcast_shapes(scaled.shape[:-2], load.shape[:-1])
    scaled = np.broadcast_to(scaled, (*shape, 6, 6))
    target = np.broadcast_to(load / scale, (*shape, 6))
    holds = singular_values(rows, length)[..., -1] > RANK  # False for NaN
    holds = np.broadcast_to(holds, shape)[..., None]
    matrix = np.where(holds[..., None], scaled.swapaxes(-1, -2), np.eye(6))
    multiples = np.linalg.solve(matrix, -target[..., None])[..., 0]
    left = np.abs((matrix @ multiples[..., None])[..., 0] + target).max(axis=-1)
    size = np.linalg.norm(target, axis=-1)
    residual = np.where(size > 0.0, left / np.where(size > 0.0, size, 1.0), left)
    forces = np.where(holds, multiples * np.asarray(gain, dtype=float), np.nan)
    return Statics(names, forces, np.where(holds[..., 0], residual, np.nan))


def _scale(length: float) -> Array:
    return np.array([1.0, 1.0, 1.0, length, length, length])
