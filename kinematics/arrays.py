"""Arrays: their types, results that are read-only, checks of what is handed in."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.errors import InputError

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

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


def largest(values: Array) -> Array:
    """(...) the largest of values (..., N) that are numbers; NaN where none is."""
    return np.asarray(np.fmax.reduce(values, axis=-1))
