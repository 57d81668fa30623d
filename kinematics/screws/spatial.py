"""Rotations, frames and boxes. Lengths in mm, angles in rad."""

from __future__ import annotations

from math import floor, log10

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array, finite
from kinematics.errors import InputError


def decimals(size: float) -> int:
    """Decimals in which a machine of this size is easy to talk about, for ``np.round``.

    Whole millimetres for some hundred millimetres.
    """
    return 2 - floor(log10(size))


def common_box(centers: Array, radius: Array) -> tuple[tuple[float, ...], ...]:
    """What boxes (N, D) ± (N,) have in common, rounded outwards to 10 mm: lows and highs.

    To ten of the units that are `decimals` of the largest radius. Where they have nothing in
    common: a box about all of them.
    """
    low = (centers - radius[:, None]).max(axis=0)
    high = (centers + radius[:, None]).min(axis=0)
    apart = low >= high
    low = np.where(apart, (centers - radius[:, None]).min(axis=0), low)
    high = np.where(apart, (centers + radius[:, None]).max(axis=0), high)
    step = 10.0 ** (1 - decimals(float(radius.max())))
    return (
        tuple(float(v) for v in np.floor(low / step) * step),
        tuple(float(v) for v in np.ceil(high / step) * step),
    )


def rotation_x(angle: ArrayLike) -> Array:
    """Rotation about x. ``angle`` (...,) rad; returns (..., 3, 3)."""
    return _rotation(angle, 1, 2)


def rotation_y(angle: ArrayLike) -> Array:
    """Rotation about y. ``angle`` (...,) rad; returns (..., 3, 3)."""
    return _rotation(angle, 2, 0)


def rotation_z(angle: ArrayLike) -> Array:
    """Rotation about z. ``angle`` (...,) rad; returns (..., 3, 3)."""
    return _rotation(angle, 0, 1)


def _rotation(angle: ArrayLike, first: int, second: int) -> Array:
    a = np.asarray(angle, dtype=float)
    c, s = np.cos(a), np.sin(a)
    matrix = np.zeros((*a.shape, 3, 3))
    matrix[..., range(3), range(3)] = 1.0
    matrix[..., first, first] = c
    matrix[..., second, second] = c
    matrix[..., first, second] = -s
    matrix[..., second, first] = s
    return matrix


def wrap_angle(angle: ArrayLike) -> Array:
    """Angles in (−π, π]; those already there are untouched."""
    a = np.asarray(angle, dtype=float)
    inside_range = (a > -np.pi) & (a <= np.pi)
    return np.where(inside_range, a, np.pi - np.mod(np.pi - a, 2 * np.pi))


def cross_matrix(vectors: Array) -> Array:
    """(..., 3) → (..., 3, 3): the matrix that is v × when it is multiplied by."""
    matrix = np.zeros((*vectors.shape, 3))
    matrix[..., 2, 1], matrix[..., 0, 2], matrix[..., 1, 0] = np.moveaxis(vectors, -1, 0)
    return matrix - matrix.swapaxes(-1, -2)


def rigid(transform: ArrayLike) -> tuple[Array, Array]:
    """Rotations (..., 3, 3) and translations (..., 3) of transforms (..., 4, 4).

    Raises:
        InputError: not 4x4, or their upper left part is not a rotation (to 1e-3).
    """
    m = finite(transform, name="a transform", last=4)
    if m.ndim < 2 or m.shape[-2] != 4:
        raise InputError("a transform must be a 4x4 matrix")
    r = m[..., :3, :3]
    skew = np.abs(r @ r.swapaxes(-1, -2) - np.eye(3)).max(axis=(-1, -2))
    if (skew > 1e-3).any() or (np.linalg.det(r) < 0.0).any():
        raise InputError("the upper left 3x3 part of a transform must be a rotation")
    return r, m[..., :3, 3]


def homogeneous(rotation: ArrayLike, translation: ArrayLike) -> Array:
    """4x4 matrices from rotations (..., 3, 3) and translations (..., 3) in mm."""
    r = np.asarray(rotation, dtype=float)
    t = np.asarray(translation, dtype=float)
    shape = np.broadcast_shapes(r.shape[:-2], t.shape[:-1])
    matrix = np.zeros((*shape, 4, 4))
    matrix[..., :3, :3] = r
    matrix[..., :3, 3] = t
    matrix[..., 3, 3] = 1.0
    return matrix
