"""Numbers in the units that people read: mm stay mm, radians become degrees."""

from __future__ import annotations

import math

from kinematics.answers.clearances import Clearance
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate


def in_page_units(coordinate: Coordinate, value: float) -> float:
    """mm stay, radians become degrees."""
    return value if coordinate.unit == "mm" else math.degrees(value)


def from_page_units(coordinate: Coordinate, value: float) -> float:
    """mm stay, degrees become radians."""
    return value if coordinate.unit == "mm" else math.radians(value)


def page_unit(coordinate: Coordinate) -> str:
    """The unit that stands behind a number on the page."""
    return "mm" if coordinate.unit == "mm" else "°"


def within(coordinate: Coordinate, value: float) -> tuple[float, str]:
    """A typed number kept in the range that is offered, and a sentence if it had to be kept.

    Raises:
        InputError: it is not finite.
    """
    if not math.isfinite(value):
        raise InputError(f"{coordinate.symbol} must be a finite number")
    kept = min(max(value, coordinate.lower), coordinate.upper)
    # A round trip through degrees may leave the range by an ulp; that is not worth a sentence.
    if abs(kept - value) <= 1e-9 * max(1.0, abs(value)):
        return kept, ""
    low, high = (in_page_units(coordinate, v) for v in (coordinate.lower, coordinate.upper))
    unit = " mm" if coordinate.unit == "mm" else " °"
    text = f"{coordinate.symbol} is kept within {low:g} … ".replace("-", "−")
    return kept, f"{text}{high:g}{unit}."


def how_far(way: Clearance, decimals: int = 1) -> str:
    """ "47.5 mm", or of a way that is a turn "53.7°"."""
    value, unit = way.distance, " mm"
    if way.angle is not None:
        value, unit = math.copysign(math.degrees(way.angle), way.distance), "°"
    return f"{round(value, decimals) + 0.0:.{decimals}f}{unit}".replace("-", "−")
