"""Arrays: their types, results that are read-only, checks of what is handed in."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import fields, is_dataclass
from math import isfinite, isinf
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.errors import InputError

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_T = TypeVar("_T", bound=np.generic)


class Frozen:
    """Base of results: arrays are read-only, also after unpickling, and shown by their shape."""

    def __init_subclass__(cls) -> None:
        if "__repr__" not in vars(cls):
            cls.__repr__ = Frozen.__repr__  # type: ignore[method-assign]

    def __repr__(self) -> str:
        shown = (f"{key}={brief(value)}" for key, value in vars(self).items())
        return f"{type(self).__name__}({', '.join(shown)})"

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON: arrays as lists, None for what is no finite number."""
        return {key: plain(value) for key, value in vars(self).items() if not callable(value)}

    def __post_init__(self) -> None:
        for value in self.__dict__.values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.__post_init__()


def plain(value: Any) -> Any:
    """A value as JSON has it; None for numbers that are not finite and what JSON has not."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    if isinstance(value, dict):
        return {str(key): plain(each) for key, each in value.items()}
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, float):
        return value if isfinite(value) else None
    return value if isinstance(value, bool | int | str) else None


def brief(value: object) -> str:
    """A value in a few words: long arrays by their shape, long sequences by their length."""
    if isinstance(value, np.ndarray):
        if value.size > 6:
            return f"<{' × '.join(map(str, value.shape))} numbers>"
        return np.array2string(value, precision=6, separator=", ").replace("\n", "")
    if isinstance(value, tuple | list):
        inside = ", ".join(map(brief, value[:9]))
        many = len(value) > 6 or len(inside) > 90
        return f"<{len(value)} of them>" if many else f"({inside}{',' * (len(value) == 1)})"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, str):
        return repr(str(value) if len(value) < 60 else f"{value[:59]}…")
    shown = repr(value)
    return shown if len(shown) < 60 else f"<{type(value).__name__}>"


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


def number(value: Any, name: str) -> float:
    """``value`` as one float; NaN stays, as what is left open.

    Raises:
        InputError: not a number, or infinite.
    """
    with suppress(TypeError, ValueError):
        if not isinstance(value, str | bytes) and not isinf(found := float(value)):
            return found
    raise InputError(f"{name} must be a finite number, got {brief(value)}")


def largest(values: Array) -> Array:
    """(...) the largest of values (..., N) that are numbers; NaN where none is."""
    return np.asarray(np.fmax.reduce(values, axis=-1))


def runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last index of every run of true values."""
    padded = np.concatenate([[False], flags, [False]])
    change = np.flatnonzero(padded[1:] != padded[:-1])
    return [(int(a), int(b) - 1) for a, b in zip(change[::2], change[1::2], strict=True)]
