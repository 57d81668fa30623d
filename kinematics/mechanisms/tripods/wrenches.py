"""The six wrenches of the 3-RPS and 3-SPR as Plücker lines, and statics.

Limb i exerts a force along A_i B_i (its actuator) and a force through its spherical joint along the
axis of its revolute joint (its constraint). Where the six are dependent the platform cannot be
held: actuation singularities are P = 0 (see `polynomial`), constraint singularities x0 = x3 = 0.
The determinant of the unnormed wrenches is ± 6.75 x h³ P, where x is x0 (mode 2) or x3 (mode 1).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Statics, WrenchName, WrenchSystem
from kinematics.arrays import Array
from kinematics.mechanisms.tripods.design import LIMBS, RADIAL, SUBSCRIPTS, TripodDesign
from kinematics.mechanisms.tripods.posing import (
    placed,
    read_poses,
    reduce_poses,
    revolute_axes,
    transform,
)
from kinematics.screws import wrenches as shared

NAMES: tuple[WrenchName, ...] = (
    *(WrenchName("actuation", i + 1, f"F{SUBSCRIPTS[i]}") for i in range(LIMBS)),
    *(WrenchName("constraint", i + 1, f"C{SUBSCRIPTS[i]}") for i in range(LIMBS)),
)


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
    through = b if design.revolute_on_base else a
    axis = revolute_axes(design, poses, mode)
    rows = np.empty((*b.shape[:-2], 2 * LIMBS, 6))
    rows[..., :LIMBS, :3], rows[..., LIMBS:, :3] = force, axis
    rows[..., :LIMBS, 3:] = np.cross(b - centre, force)
    rows[..., LIMBS:, 3:] = np.cross(through - centre, axis)
    rows[~np.isfinite(reduce_poses(design, poses, mode).v)] = np.nan
    return rows, np.concatenate([b, through], axis=-2)


def wrench_system(design: TripodDesign, poses: ArrayLike, mode: str) -> WrenchSystem:
    """Actuation and constraint wrenches of poses (..., 3)."""
    rows, point = wrench_rows(design, read_poses(poses), mode)
    value = shared.determinant(rows, characteristic_length(design))
    return WrenchSystem(NAMES, rows, point, value)


def statics(design: TripodDesign, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics:
    """Actuator and constraint forces that hold loads (..., 6), N and N·mm about O′.

    Raises:
        InputError: not finite numbers, or not six in a load.
    """
    rows, _ = wrench_rows(design, read_poses(poses), mode)
    return shared.equilibrium(NAMES, rows, loads, characteristic_length(design))


def condition(design: TripodDesign, poses: ArrayLike, mode: str) -> Array:
    """Condition number (...) of ṙ = J · (motion that the constraints leave), ≥ 1.

    Angular velocities are multiplied by the characteristic length. Infinite at parallel and
    constraint singularities and where a limb has no length; NaN where there is no such position.
    """
    p = read_poses(poses)
    rows, _ = wrench_rows(design, p, mode)
    matrix = rows / _scale(design)
    there = np.isfinite(reduce_poses(design, p, mode).v)
    known = np.asarray(np.isfinite(matrix).all(axis=(-1, -2)))
    matrix = np.where(known[..., None, None], matrix, np.eye(6))
    _, size, axes = np.linalg.svd(matrix[..., LIMBS:, :])
    free = axes[..., LIMBS:, :].swapaxes(-1, -2)
    values = np.linalg.svd(matrix[..., :LIMBS, :] @ free, compute_uv=False)
    lost = (size[..., -1] <= shared.RANK) | (values[..., -1] <= shared.RANK) | ~known
    number = np.where(lost, np.inf, values[..., 0] / np.where(lost, 1.0, values[..., -1]))
    return np.where(there, number, np.nan)


def least(design: TripodDesign, poses: ArrayLike, mode: str) -> Array:
    """Smallest singular value (...) of the normalised wrenches: 0 where control is lost."""
    rows, _ = wrench_rows(design, read_poses(poses), mode)
    values: Array = shared.singular_values(rows, characteristic_length(design))[..., -1]
    return values


def twist_of(design: TripodDesign, rows: Array, powers: Array) -> Array:
    """The twist [ω, v] (..., 6) on which unit wrenches do some powers (..., 6).

    NaN where the wrenches are dependent or not known.
    """
    scale = _scale(design)
    known = np.asarray(np.isfinite(rows).all(axis=(-1, -2)) & np.isfinite(powers).all(axis=-1))
    good = np.where(known[..., None, None], rows, 0.0)
    holds = shared.singular_values(good, characteristic_length(design))[..., -1] > shared.RANK
    matrix = np.where(holds[..., None, None], good / scale, np.eye(6))
    found = np.linalg.solve(matrix, np.where(holds[..., None], powers, 0.0)[..., None])[..., 0]
    found = np.where(holds[..., None], found / scale, np.nan)
    return np.concatenate([found[..., 3:], found[..., :3]], axis=-1)


def _scale(design: TripodDesign) -> Array:
    return np.array([1.0] * 3 + [characteristic_length(design)] * 3)
