"""Searches along the time."""

from __future__ import annotations

from collections.abc import Callable

_HALVINGS = 50


def edge(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Where something that holds at ``low`` and not at ``high`` ends, by halving."""
    low, high = float(low), float(high)
    for _ in range(_HALVINGS):
        half = 0.5 * (low + high)
        if half in (low, high):
            break
        low, high = (half, high) if holds(half) else (low, half)
    return 0.5 * (low + high)


def least(function: Callable[[float], float], low: float, high: float, rounds: int = 60) -> float:
    """Where a function is least between two times, by golden sections."""
    ratio = 0.5 * (5.0**0.5 - 1.0)
    a, b = high - ratio * (high - low), low + ratio * (high - low)
    fa, fb = function(a), function(b)
    for _ in range(rounds):
        if fa <= fb:
            high, b, fb = b, a, fa
            a = high - ratio * (high - low)
            fa = function(a)
        else:
            low, a, fa = a, b, fb
            b = low + ratio * (high - low)
            fb = function(b)
    return 0.5 * (low + high)
