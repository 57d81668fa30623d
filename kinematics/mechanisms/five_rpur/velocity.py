"""Velocities and wrenches of the 5-RPUR: the inverse Jacobian, the six wrenches, conditioning.

With the prismatic joint locked, limb i transmits a force through B_i along
f_i = (û_i × e1) × (v̂_i × e2), û = (B − A)/ρ, v̂ = (C − B)/l. In the base frame turned by
R_y(−θ), with (X, Y, Z) = C − A, p = Z − σh and q = σh, it is −(qX, pY, pq)/(ρ l) and
f·û = −q/l. All limbs together impose one more wrench, a couple along e1 × e2.

Parallel (type 2) singularities: the six wrenches are dependent. Serial (type 1): q = 0 (the two
working modes of a limb meet) or ρ = 0; there its row of the inverse Jacobian does not exist.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import joint_points

_SERIAL = 1e-12  # |f·û| below which a limb is taken to be in a serial singularity


class Wrenches(NamedTuple):
    """Actuation forces of the limbs; the arrays are read-only.

    Attributes:
        force: (..., 5, 3) f_i in the base frame, not normalised: |f_i| ≤ 1.
        moment: (..., 5, 3) mm, moment of f_i about O'.
        transmission: (..., 5) f_i·û_i, what a unit of actuator force is divided by.
        couple: (..., 3) e1 × e2, the direction of the constraint couple.
    """

    force: Array
    moment: Array
    transmission: Array
    couple: Array


def wrenches(design: FiveRPURDesign, poses: ArrayLike, modes: str | ArrayLike) -> Wrenches:
    """The actuation and constraint wrenches.

    Args:
        poses: (..., 5) mm and rad.
        modes: a working mode as "+-+++", or signs ±1 (..., 5).

    Returns:
        NaN for limbs that cannot close, and for a limb with ρ = 0.
    """
    a, b, c = joint_points(design, poses, modes)
    poses = np.asarray(poses, dtype=float)
    e1 = np.array([0.0, 1.0, 0.0])
    theta = np.broadcast_to(poses[..., 4], a.shape[:-2])
    e2 = np.stack([np.cos(theta), np.zeros_like(theta), -np.sin(theta)], axis=-1)
    u, v = b - a, c - b
    with np.errstate(invalid="ignore", divide="ignore"):
        u_hat = u / np.linalg.norm(u, axis=-1, keepdims=True)
        v_hat = v / design.link[:, None]
        force = np.cross(np.cross(u_hat, e1), np.cross(v_hat, e2[..., None, :]))
        moment = np.cross(b - poses[..., None, :3], force)
        transmission = (force * u_hat).sum(axis=-1)
    result = Wrenches(force, moment, transmission, np.cross(e1, e2))
    for array in result:
        array.setflags(write=False)
    return result


def inverse_jacobian(design: FiveRPURDesign, poses: ArrayLike, modes: str | ArrayLike) -> Array:
    """J5 = ∂ρ/∂(x, y, z, φ, θ) = [f_i, m_i·e2, m_i·e1] / (f_i·û_i).

    Returns:
        (..., 5, 5), a row a limb; mm/mm in the first three columns, mm/rad in the others. A row
        is NaN where the limb cannot close or is in a serial singularity.
    """
    rows, transmission = velocity_rows(design, poses, modes)
    with np.errstate(invalid="ignore"):
        serial = ~(np.abs(transmission) > _SERIAL)
    divisor = np.where(serial, np.nan, transmission)
    jacobian: Array = rows / divisor[..., None]
    jacobian.setflags(write=False)
    return jacobian


def velocity_rows(
    design: FiveRPURDesign, poses: ArrayLike, modes: str | ArrayLike
) -> tuple[Array, Array]:
    """Both sides of [f_i, m_i·e2, m_i·e1] (ẋ, ẏ, ż, φ̇, θ̇) = (f_i·û_i) ρ̇_i.

    Returns:
        The rows (..., 5, 5) and f·û (..., 5); finite at q = 0, unlike the inverse Jacobian.
    """
    w = wrenches(design, poses, modes)
    about_e2 = (w.moment * _e2(w)).sum(axis=-1, keepdims=True)
    rows = np.concatenate([w.force, about_e2, w.moment[..., 1:2]], axis=-1)
    return rows, w.transmission


def wrench_matrix(
    design: FiveRPURDesign,
    poses: ArrayLike,
    modes: str | ArrayLike,
    *,
    length: float = 1.0,
) -> Array:
    """The six wrenches as rows [force, moment about O' / length], (..., 6, 6).

    Rows 1-5 are the actuation forces, row 6 the couple along e1 × e2 (as a unit moment). With
    ``length`` = 1 mm the determinant is −det(J5) Π(f_i·û_i); it vanishes exactly at the parallel
    singularities, and unlike J5 the matrix is finite at serial ones.
    """
    w = wrenches(design, poses, modes)
    matrix = np.zeros((*w.force.shape[:-2], LIMBS + 1, 6))
    matrix[..., :LIMBS, :3] = w.force
    matrix[..., :LIMBS, 3:] = w.moment / length
    matrix[..., LIMBS, 3:] = w.couple
    matrix.setflags(write=False)
    return matrix


def characteristic_length(design: FiveRPURDesign) -> float:
    """The length that makes rotations comparable with displacements, mm.

    The root mean square distance of the platform points from their centroid; where they all
    coincide, the mean link length.
    """
    spread = design.platform - design.platform.mean(axis=0)
    length = float(np.sqrt((spread**2).sum(axis=1).mean()))
    return length if length > 1e-9 * float(design.link.max()) else float(design.link.mean())


def condition(
    design: FiveRPURDesign,
    poses: ArrayLike,
    modes: str | ArrayLike,
    *,
    length: float | None = None,
) -> Array:
    """Condition number (2-norm) of J5 with its angular columns divided by ``length``.

    Args:
        length: mm, > 0; by default `characteristic_length`.

    Returns:
        (...,) ≥ 1; infinite at singularities of either type, NaN where a limb cannot close.

    Raises:
        InputError: ``length`` is not a positive number.
    """
    scale = characteristic_length(design) if length is None else float(length)
    if not (np.isfinite(scale) and scale > 0):
        raise InputError("the characteristic length must be a positive number of mm")
    j = inverse_jacobian(design, poses, modes)
    j = j / np.array([1.0, 1.0, 1.0, scale, scale])
    _, b, _ = joint_points(design, poses, modes)
    closes = np.isfinite(b).all(axis=(-1, -2))
    regular = np.isfinite(j).all(axis=(-1, -2))
    values = np.linalg.svd(np.where(regular[..., None, None], j, np.eye(LIMBS)), compute_uv=False)
    with np.errstate(divide="ignore", over="ignore"):
        number = values[..., 0] / values[..., -1]
    number = np.where(closes, np.where(regular, number, np.inf), np.nan)
    number.setflags(write=False)
    return number


def _e2(w: Wrenches) -> Array:
    """e2 with an axis for the limbs; e2 = (e1 × e2) × e1."""
    return np.cross(w.couple, np.array([0.0, 1.0, 0.0]))[..., None, :]
