"""The six wrenches of the 3-RPS and 3-SPR, and statics.

Limb i exerts a force along A_i B_i (its actuator) and a force through its spherical joint along the
axis of its revolute joint (its constraint). Where the six are dependent the platform cannot be
held: actuation singularities are P = 0, constraint singularities x0 = x3 = 0, and the determinant
of the unnormed wrenches is ± 6.75 x h³ P, of which x is x0 (mode 2) or x3 (mode 1).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.motion import Statics, WrenchName, WrenchSystem
from kinematics.spatial import Array, finite
from kinematics.three_rps_spr.design import LIMBS, RADIAL, SUBSCRIPTS, TANGENT, TripodDesign
from kinematics.three_rps_spr.posing import placed, read_poses, reduce_poses, transform

NAMES = (
    *(WrenchName("actuation", i + 1, f"f{SUBSCRIPTS[i]}") for i in range(LIMBS)),
    *(WrenchName("constraint", i + 1, f"c{SUBSCRIPTS[i]}") for i in range(LIMBS)),
)
SINGULAR = 1e-12
"""Smallest singular value, of the matrix with unit rows, below which nothing is solved."""


def characteristic_length(design: TripodDesign) -> float:
    """The platform's circumradius h2, mm: its joints' root mean square distance from O′."""
    return design.platform_radius


def wrench_rows(design: TripodDesign, poses: Array, mode: str) -> tuple[Array, Array]:
    """Unit wrenches (..., 6, 6) as rows [F, T about O′], and a point of each (..., 6, 3).

    NaN where A_i and B_i coincide, and where no finite position has the pose's altitude.
    """
    matrix = transform(design, poses, mode)
    centre = matrix[..., None, :3, 3]
    b = placed(matrix, design.platform_radius * RADIAL)
    a = np.broadcast_to(design.base_radius * RADIAL, b.shape)
    along = b - a
    length = np.linalg.norm(along, axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        force = np.where(length > 0.0, along / length, np.nan)
    if design.revolute_on_base:
        through, axis = b, np.broadcast_to(TANGENT, b.shape)
    else:
        through, axis = a, TANGENT @ matrix[..., :3, :3].swapaxes(-1, -2)
    rows = np.empty((*b.shape[:-2], 2 * LIMBS, 6))
    rows[..., :LIMBS, :3], rows[..., LIMBS:, :3] = force, axis
    rows[..., :LIMBS, 3:] = np.cross(b - centre, force)
    rows[..., LIMBS:, 3:] = np.cross(through - centre, axis)
    nowhere = ~np.isfinite(reduce_poses(design, poses, mode).v)
    rows[nowhere] = np.nan
    return rows, np.concatenate([b, through], axis=-2)


def wrench_system(design: TripodDesign, poses: ArrayLike, mode: str) -> WrenchSystem:
    """Actuation and constraint wrenches of poses (..., 3)."""
    p = read_poses(poses)
    rows, point = wrench_rows(design, p, mode)
    return WrenchSystem(NAMES, rows, point, np.linalg.det(normed(design, rows)))


def normed(design: TripodDesign, rows: Array) -> Array:
    """Rows with their moments divided by the characteristic length."""
    scale = np.array([1.0] * 3 + [1.0 / characteristic_length(design)] * 3)
    scaled: Array = rows * scale
    return scaled


def smallest(design: TripodDesign, rows: Array) -> Array:
    """Smallest singular value of the normed rows, (...); NaN where there are none."""
    matrix = normed(design, rows)
    known = np.isfinite(matrix).all(axis=(-1, -2))
    values = np.linalg.svd(np.where(known[..., None, None], matrix, 0.0), compute_uv=False)
    return np.where(known, values[..., -1], np.nan)


def condition(design: TripodDesign, poses: ArrayLike, mode: str) -> Array:
    """Condition number (...) of ṙ = J · (motion that the constraints leave), ≥ 1.

    Angular velocities are multiplied by the characteristic length. Infinite at parallel and
    constraint singularities and where a limb has no length; NaN where there is no such position.
    """
    p = read_poses(poses)
    rows, _ = wrench_rows(design, p, mode)
    matrix = normed(design, rows)
    there = np.isfinite(reduce_poses(design, p, mode).v)
    known = np.isfinite(matrix).all(axis=(-1, -2))
    matrix = np.where(known[..., None, None], matrix, np.eye(6))
    _, size, axes = np.linalg.svd(matrix[..., LIMBS:, :])
    free = axes[..., LIMBS:, :].swapaxes(-1, -2)
    values = np.linalg.svd(matrix[..., :LIMBS, :] @ free, compute_uv=False)
    with np.errstate(divide="ignore"):
        number = values[..., 0] / values[..., -1]
    lost = (size[..., -1] <= SINGULAR) | (values[..., -1] <= SINGULAR) | ~known
    number = np.where(lost, np.inf, number)
    return np.where(there, number, np.nan)


def solved(design: TripodDesign, matrix: Array, right: Array) -> Array:
    """x of matrix x = right, (..., 6) each; NaN where the matrix is singular.

    ``matrix`` are power products [T, F] of unit wrenches: its angular columns and hence the
    angular part of x are scaled by the characteristic length while the solution is found.
    """
    length = characteristic_length(design)
    scale = np.array([1.0 / length] * 3 + [1.0] * 3)
    scaled = matrix * scale
    regular = np.isfinite(scaled).all(axis=(-1, -2)) & np.isfinite(right).all(axis=-1)
    least = np.linalg.svd(np.where(regular[..., None, None], scaled, 0.0), compute_uv=False)
    regular &= least[..., -1] > SINGULAR
    safe = np.where(regular[..., None, None], scaled, np.eye(6))
    found = np.linalg.solve(safe, np.where(regular[..., None], right, 0.0)[..., None])[..., 0]
    return np.where(regular[..., None], found * scale, np.nan)


def statics(design: TripodDesign, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics:
    """Actuator and constraint forces that hold loads (..., 6) [N, N·mm about O′]."""
    p = read_poses(poses)
    load = finite(loads, name="the load", last=6)
    rows, _ = wrench_rows(design, p, mode)
    shape = np.broadcast_shapes(rows.shape[:-2], load.shape[:-1])
    rows = np.broadcast_to(rows, (*shape, 6, 6))
    load = np.broadcast_to(load, (*shape, 6))
    length = characteristic_length(design)
    scale = np.array([1.0] * 3 + [1.0 / length] * 3)
    matrix = (rows * scale).swapaxes(-1, -2)
    regular = smallest(design, rows) > SINGULAR
    safe = np.where(regular[..., None, None], matrix, np.eye(6))
    forces = np.linalg.solve(safe, -(load * scale)[..., None])[..., 0]
    forces = np.where(regular[..., None], forces, np.nan)
    left = np.einsum("...r,...rn->...n", forces, rows) * scale + load * scale
    size = np.abs(load * scale).max(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        residual = np.abs(left).max(axis=-1) / np.where(size > 0.0, size, 1.0)
    return Statics(NAMES, forces, residual)
