"""The constraint of the SPR limb: the coordinate that follows from the other five.

With m = R n6 the constraint is (A_5 − p)·m = b_5·n6. It is linear in x, y and z, and of the form
a cos + b sin = c in each of the angles, so whichever coordinate gives way is found in closed form:
one value of a position, none or two of an angle.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.four_sps_spr.design import SPR, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import POSE, rotation
from kinematics.screws.spatial import rotation_x, rotation_y, rotation_z, wrap_angle

SYMBOLS = ("x", "y", "z", "α", "β", "γ")
_PARALLEL = 1e-9  # of a unit vector's component: the coordinate has no say in the constraint
_TOUCH = 1e-12  # by which rounding may carry |c| over its bound, relative


def dependent_values(design: FourSPSSPRDesign, poses: ArrayLike, index: int) -> Array:
    """The values that coordinate ``index`` may have, the others given.

    Args:
        poses: (..., 6) mm and rad; what stands at ``index`` does not matter, NaN too.

    Returns:
        (..., 1) mm of a position, (..., 2) rad of an angle, in (−π, π]; NaN where there is none:
        the axis is normal to the direction, or no angle is enough. Also NaN where the constraint
        holds whatever the coordinate.
    """
    p = np.array(poses, dtype=float)
    p[..., index] = 0.0
    p = finite(p, name="a pose", last=POSE)
    if index < 3:
        normal = rotation(p) @ design.axis
        apart = ((design.base[SPR] - p[..., :3]) * normal).sum(axis=-1) - design.offset
        steep = np.abs(normal[..., index]) > _PARALLEL
        values = np.where(steep, apart / np.where(steep, normal[..., index], 1.0), np.nan)
        return np.asarray(values)[..., None]
    a, b, c = angle_terms(design, p, index)
    size = np.hypot(a, b)
    scale = np.abs(design.base[SPR] - p[..., :3]).max(axis=-1) + abs(design.offset)
    some = size > _PARALLEL * np.maximum(scale, 1e-300)
    ratio = c / np.where(some, size, 1.0)
    ratio = np.where(np.abs(ratio) <= 1.0 + _TOUCH, np.clip(ratio, -1.0, 1.0), np.nan)
    middle, half = np.arctan2(b, a), np.arccos(np.where(some, ratio, np.nan))
    both = np.stack([middle - half, middle + half], axis=-1)
    return np.asarray(np.where(np.isfinite(both), wrap_angle(both), np.nan))


def angle_terms(design: FourSPSSPRDesign, poses: Array, index: int) -> tuple[Array, Array, Array]:
    """a, b, c of the constraint a cos + b sin = c in an angle (index 3, 4, 5), (...,) mm each."""
    d = design.base[SPR] - poses[..., :3]
    n = np.broadcast_to(design.axis, d.shape)
    z, y, x = (
        rotation_z(poses[..., 3]),
        rotation_y(poses[..., 4]),
        rotation_x(poses[..., 5]),
    )
    if index == 3:
        f, m, (i, j, k) = d, _turn(y @ x, n), (0, 1, 2)
    elif index == 4:
        f, m, (i, j, k) = _turn(z.swapaxes(-1, -2), d), _turn(x, n), (2, 0, 1)
    else:
        f, m, (i, j, k) = _turn((z @ y).swapaxes(-1, -2), d), n, (1, 2, 0)
    cosine = f[..., i] * m[..., i] + f[..., j] * m[..., j]
    sine = f[..., j] * m[..., i] - f[..., i] * m[..., j]
    return cosine, sine, design.offset - f[..., k] * m[..., k]


def complete_pose(
    design: FourSPSSPRDesign,
    pose: Sequence[float],
    moved: int | None = None,
    dependent: int | None = None,
) -> tuple[float, ...]:
    """The pose with one coordinate made to satisfy the constraint.

    Args:
        pose: six numbers, mm and rad; one may be NaN: that one is solved for, an angle as the one
            nearest to zero.
        moved: the coordinate that was just set by hand, which stays.
        dependent: the coordinate that gives way, where none is NaN; of two angles the one nearest
            to its value now. By default, and where that one was moved, the position that has to
            move least.

    Raises:
        InputError: not six numbers, more than one NaN, or no value of that coordinate is enough.
    """
    values = np.array(pose, dtype=float)
    if values.shape != (POSE,):
        raise InputError("a pose has 6 numbers (x, y, z, α, β, γ)")
    open_ones = np.flatnonzero(np.isnan(values))
    if len(open_ones) > 1:
        names = " and ".join(SYMBOLS[i] for i in open_ones)
        raise InputError(f"one coordinate of a pose may follow from the constraint, not {names}")
    if len(open_ones) == 1:
        index, near = int(open_ones[0]), 0.0
    else:
        index = dependent if dependent not in (None, moved) else _least(design, values, moved)
        near = float(values[index])
    found = dependent_values(design, values, index)
    found = found[np.isfinite(found)]
    if not found.size:
        raise InputError(_none_text(design, values, index))
    away = np.abs(found - near) if index < 3 else np.abs(wrap_angle(found - near))
    # The smaller of two that are as near, so that the answer does not hang on rounding.
    order = np.lexsort((found, np.round(away, 9)))
    values[index] = found[order[0]]
    return tuple(values.tolist())


def _least(design: FourSPSSPRDesign, values: Array, moved: int | None) -> int:
    normal = np.abs(rotation(values) @ design.axis)
    if moved is not None and moved < 3:
        normal[moved] = -1.0
    return int(normal.argmax())


def _none_text(design: FourSPSSPRDesign, values: Array, index: int) -> str:
    name = SYMBOLS[index]
    if index < 3:
        return (
            f"{name} cannot follow from the constraint at this pose: the revolute axis of limb 5 "
            f"is normal to {name}; let another coordinate follow"
        )
    given = values.copy()
    given[index] = 0.0
    a, b, c = angle_terms(design, given, index)
    if np.hypot(a, b) <= _PARALLEL * max(float(np.abs(c)), design.length):
        return (
            f"{name} cannot follow from the constraint at this pose, which does not depend on it; "
            "let another coordinate follow"
        )
    return (
        f"no {name} satisfies the constraint of limb 5 at this pose; "
        "let another coordinate follow, or move the platform"
    )


def _turn(r: Array, vectors: Array) -> Array:
    return np.asarray((r @ vectors[..., None])[..., 0])
