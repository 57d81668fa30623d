"""Rotations, frames and checks on arrays. Lengths in mm, angles in rad."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.errors import InputError

Array = NDArray[np.float64]

_T = TypeVar("_T", bound=np.generic)


class Frozen:
    """Base of results: their arrays are read-only, also after unpickling."""

    def __post_init__(self) -> None:
        for value in self.__dict__.values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.__post_init__()


def frozen(values: NDArray[_T]) -> NDArray[_T]:
    """The array itself, read-only from now on; of a number one without axes."""
    array = np.asarray(values)
    array.setflags(write=False)
    return array


def read_only(values: ArrayLike) -> Array:
    """Values as an array of floats of its own, read-only."""
    return frozen(np.array(values, dtype=float))


def common_box(centers: Array, radius: Array, step: float) -> tuple[tuple[float, ...], ...]:
    """What boxes (N, 3) ± (N,) have in common, rounded outwards to steps: lows and highs.

    Where they have nothing in common: a box about all of them.
    """
    low = (centers - radius[:, None]).max(axis=0)
    high = (centers + radius[:, None]).min(axis=0)
    apart = low >= high
    low = np.where(apart, (centers - radius[:, None]).min(axis=0), low)
    high = np.where(apart, (centers + radius[:, None]).max(axis=0), high)
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


def finite(values: Any, *, name: str, last: int | None = None) -> Array:
    """``values`` as a float array (..., last), or one sentence about what is wrong with it.

    Raises:
        InputError: not numbers, NaN or infinite, or the last axis has another length.
    """
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be numbers") from None
    if last is not None and (array.ndim == 0 or array.shape[-1] != last):
        count = 1 if array.ndim == 0 else array.shape[-1]
        raise InputError(f"{name} must have {last} numbers, got {count}")
    if not np.isfinite(array).all():
        raise InputError(f"{name} must be finite numbers, got NaN or infinity")
    return array
