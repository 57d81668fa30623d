"""Units of length in files: mm everywhere inside, others as they come in and go out."""

from __future__ import annotations

from decimal import Decimal

UNITS = {"mm": Decimal(1), "cm": Decimal(10), "m": Decimal(1000), "inch": Decimal("25.4")}
"""How many mm each is; as files and options say it."""
ALIKE = {"in": "inch", "inches": "inch", '"': "inch"}
"""What else people write."""
_LARGEST = 1e30  # beyond it a number is none, and what it is in another unit does not matter


def unit_of(text: object) -> str:
    """The unit that somebody wrote, "" for none that is known."""
    name = text.strip().lower() if isinstance(text, str) else ""
    name = ALIKE.get(name, name)
    return name if name in UNITS else ""


def in_mm(value: float, unit: str) -> float:
    """A length of this unit, mm: rounded once, so that 0.57 m are 570 mm."""
    return _times(value, UNITS[unit])


def from_mm(value: float, unit: str, power: int = 1) -> float:
    """A length (area, volume) of mm, in this unit."""
    return _times(value, 1 / UNITS[unit] ** power)


def _times(value: float, factor: Decimal) -> float:
    if factor == 1 or not abs(value) < _LARGEST:
        return value
    return float(Decimal(repr(value)) * factor)
