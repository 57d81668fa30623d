"""A set of wrenches that holds a platform: how well, and with what forces a load.

Wrenches are rows [F, T about O′] of a `motion.WrenchSystem`, N and N·mm in any common scale. A
characteristic length makes moments comparable with forces. Everything is in batches (..., R, 6).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Statics, Wrenches, WrenchName
from kinematics.arrays import Array, finite

RANK = 1e-12
"""Smallest singular value of normalised wrenches below which no balance is computed."""
SERIAL = 1e-12
"""Part of an actuator's largest gain below which it has none: a serial singularity."""


def normalised(rows: ArrayLike, length: float) -> Array:
    """Rows with moments divided by ``length`` (mm), each of unit size; a zero row stays zero."""
    scaled = np.asarray(rows, dtype=float) / scale(length)
    size = np.linalg.norm(scaled, axis=-1, keepdims=True)
    with np.errstate(invalid="ignore"):
        unit: Array = scaled / np.where(size > 0.0, size, 1.0)
    return unit


def singular_values(rows: ArrayLike, length: float) -> Array:
    """Of the normalised wrenches, (..., min(R, 6)), largest first; NaN where a row is NaN."""
    unit = normalised(rows, length)
    good = np.asarray(np.isfinite(unit).all(axis=(-1, -2)))
    values = np.linalg.svd(np.where(good[..., None, None], unit, 0.0), compute_uv=False)
    return np.asarray(np.where(good[..., None], values, np.nan))


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
        unit = given / scale(length) / size
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
        names: of the first R of the six, whose forces are wanted.
        rows: (..., 6, 6).
        loads: (..., 6) [F, T about O′], N and N·mm; broadcasts with ``rows``.
        length: mm, the characteristic length.
        gain: (..., R) what an actuator's force is per multiple of its wrench: ∂(power)/∂(rate),
            row·twist = gain · joint rate; 1 for constraints.

    Returns:
        NaN where the wrenches are dependent (`RANK`) or not finite.

    Raises:
        InputError: a load is not six finite numbers.
    """
    load = finite(loads, name="a load", last=6)
    scaled = np.asarray(rows, dtype=float) / scale(length)
    shape = np.broadcast_shapes(scaled.shape[:-2], load.shape[:-1])
    scaled = np.broadcast_to(scaled, (*shape, 6, 6))
    target = np.broadcast_to(load / scale(length), (*shape, 6))
    holds = np.broadcast_to(independent(rows, length), shape)[..., None]
    matrix = np.where(holds[..., None], scaled.swapaxes(-1, -2), np.eye(6))
    multiples = np.linalg.solve(matrix, -target[..., None])[..., 0]
    left = np.abs((matrix @ multiples[..., None])[..., 0] + target).max(axis=-1)
    size = np.linalg.norm(target, axis=-1)
    residual = np.where(size > 0.0, left / np.where(size > 0.0, size, 1.0), left)
    wanted = multiples[..., : len(names)] * np.asarray(gain, dtype=float)
    return Statics(
        names, np.where(holds, wanted, np.nan), np.where(holds[..., 0], residual, np.nan)
    )


def independent(rows: ArrayLike, length: float) -> np.ndarray:
    """(...) whether six wrenches hold the platform; False where they are not known."""
    return np.asarray(singular_values(rows, length)[..., -1] > RANK)


def unit_motions(rows: Array, length: float) -> Array:
    """(..., 6, 6): column i is the velocity [v, ω] on which wrench i alone does work, a unit of it.

    NaN where the wrenches do not hold the platform: of the normalised ones a singular value is no
    more than `RANK`, by the Frobenius norm of their inverse.
    """
    size = np.linalg.norm(rows / scale(length), axis=-1)
    unit = normalised(rows, length)
    good = np.asarray(np.isfinite(unit).all(axis=(-1, -2)))[..., None, None]
    unit = np.where(good, unit, np.eye(6))
    good = good & (np.linalg.det(unit) != 0.0)[..., None, None]
    inverse = np.linalg.inv(np.where(good, unit, np.eye(6)))
    good = good & (np.linalg.norm(inverse, axis=(-1, -2), keepdims=True) < 1.0 / RANK)
    inverse = inverse / scale(length)[:, None]
    return np.where(good, inverse / np.where(good[..., 0], size, 1.0)[..., None, :], np.nan)


def condition(wrenches: Wrenches, length: float) -> Array:
    """Condition number (...) ≥ 1 of the map from joint rates to the motions that the constraints
    leave, angular velocities multiplied by ``length``, mm.

    Infinite at singularities and where a limb has no direction; NaN where a limb cannot close.
    """
    rows, gain, point = wrenches
    motions = unit_motions(rows, length)[..., : gain.shape[-1]] * gain[..., None, :]
    motions = motions * scale(length)[:, None]
    good = np.asarray(np.isfinite(motions).all(axis=(-1, -2)))
    values = np.linalg.svd(np.where(good[..., None, None], motions, 0.0), compute_uv=False)
    good = good & (values[..., -1] > RANK * values[..., 0])
    number = np.where(good, values[..., 0] / np.where(good, values[..., -1], 1.0), np.inf)
    return np.where(np.isfinite(point).all(axis=(-1, -2)), number, np.nan)


def scale(length: float) -> Array:
    """(6,) what forces and moments are divided by, or velocities and angular velocities times."""
    return np.array([1.0, 1.0, 1.0, length, length, length])
