"""Numbers as people read them: mm stay mm, radians become degrees; and sentences about them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from app.language import tr
from kinematics.answers.clearances import Clearance
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate


def page_unit(coordinate: Coordinate) -> str:
    """The unit that stands behind a number on the page."""
    return "mm" if coordinate.unit == "mm" else "°"


def within(coordinate: Coordinate, value: float, beyond: float = 0.0) -> tuple[float, str]:
    """A typed number kept in the range that is offered, and a sentence if it had to be kept.

    Args:
        beyond: so many times its width on either side is taken as it is, too.

    Raises:
        InputError: it is not finite.
    """
    if not math.isfinite(value):
        raise InputError(tr("typing.one_finite", what=coordinate.symbol))
    if coordinate.free:
        return (value if abs(value) <= 4.0 * math.pi else math.remainder(value, 2.0 * math.pi)), ""
    further = beyond * (coordinate.upper - coordinate.lower)
    if further and coordinate.lower - further <= value <= coordinate.upper + further:
        return value, ""
    kept = min(max(value, coordinate.lower), coordinate.upper)
    # A round trip through degrees may leave the range by an ulp; that is not worth a sentence.
    if abs(kept - value) <= 1e-9 * max(1.0, abs(value)):
        return kept, ""
    return kept, tr("typing.kept", what=coordinate.symbol, ends=ends_text(coordinate))


def ends_text(coordinate: Coordinate) -> str:
    """The range that is offered: "−60 … 60 °"."""
    low, high = (coordinate.outer(v) for v in (coordinate.lower, coordinate.upper))
    return f"{minus(f'{low:g} … {high:g}')} {page_unit(coordinate)}"


def how_far(way: Clearance, decimals: int = 1) -> str:
    """ "47.5 mm", or of a way that is a turn "53.7°"."""
    value, unit = way.distance, " mm"
    if way.angle is not None:
        value, unit = math.copysign(math.degrees(way.angle), way.distance), "°"
    return f"{round(value, decimals) + 0.0:.{decimals}f}{unit}".replace("-", "−")


def pose_text(axes: Sequence[Coordinate], pose: Sequence[float]) -> str:
    """A pose in the page's units: "x 12.3, y 4.0, z 310.9 mm, φ 5.0°, θ −3.0°"."""
    angles = [f"{_value(c, v)}°" for c, v in zip(axes, pose, strict=True) if c.unit == "rad"]
    return ", ".join(filter(None, (place_text(axes, pose), *angles)))


def place_text(axes: Sequence[Coordinate], pose: Sequence[float]) -> str:
    """Its lengths alone: "x 12.3, y 4.0, z 310.9 mm"; "" where a pose has none."""
    lengths = [_value(c, v) for c, v in zip(axes, pose, strict=True) if c.unit == "mm"]
    return f"{', '.join(lengths)} mm" if lengths else ""


def _value(axis: Coordinate, value: float) -> str:
    return f"{axis.symbol} {tenths(axis.outer(value))}"


def joint_text(axis: Coordinate, value: float) -> str:
    """An actuated joint in the page's units: "312.4 mm"."""
    unit = page_unit(axis)
    return f"{tenths(axis.outer(value))}{'' if unit == '°' else ' '}{unit}"


def sentence(text: str) -> str:
    """With a capital letter, unless it begins with a symbol, as z, x′ or φ."""
    head, second = text[:1], text[1:2]
    symbol = not (head + second).isascii() or (second == " " and head != "a")
    return text if symbol else head.upper() + text[1:]


def minus(text: str) -> str:
    """A number, or a mode, with minus signs as long as plus signs."""
    return text.replace("-", "−")


def number(value: float) -> str:
    """A number as it is typed or marked on an axis, to six digits."""
    return minus(f"{value + 0.0:.6g}")


def tenths(value: float) -> str:
    """One decimal and a minus sign as long as a plus; no "−0.0"."""
    return minus(f"{round(value, 1) + 0.0:.1f}") if math.isfinite(value) else "–"


def spaced(value: float, decimals: int = 0) -> str:
    """Digits in groups of three."""
    return f"{value:,.{decimals}f}".replace(",", " ")


def plural(count: int, noun: str) -> str:
    """ "1 piece", "2 pieces"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def volume_text(mm3: float, error: float | None = None) -> str:
    """A volume in the unit that reads best; with an error to the digits that it leaves."""
    unit, scale = ("dm³", 1e-6) if abs(mm3) >= 1e5 else ("cm³", 1e-3)
    value = mm3 * scale
    if error is None or error <= 0:
        return f"{value:.4g} {unit}" if abs(value) < 1000 else f"{value:,.0f} {unit}"
    return f"{with_error(value, error * scale, 9)} {unit}"


def with_error(value: float, error: float, most: int) -> str:
    """A number to the digits that its error leaves, ``most`` at the most, and that error."""
    decimals = min(max(0, math.ceil(-math.log10(error))), most)
    shown = math.ceil(error * 10**decimals) / 10**decimals  # never less than it is
    return f"{value:,.{decimals}f} ± {shown:.{decimals}f}"


def area_text(mm2: float) -> str:
    """An area in the unit that reads best."""
    value, unit = (mm2 * 1e-2, "cm²") if abs(mm2) >= 1e3 else (mm2, "mm²")
    return f"{value:.4g} {unit}" if abs(value) < 1000 else f"{spaced(value, 1)} {unit}"
