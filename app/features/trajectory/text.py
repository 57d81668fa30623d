"""Polynomials of time as text, for the command line and the page."""

from __future__ import annotations

from collections.abc import Sequence

LOST = (
    "The powers of t lose more digits than a number holds: the true error is that of the "
    "polynomials as they are printed."
)


def polynomial(coefficients: Sequence[float], digits: int = 4) -> str:
    """ "0.5t^2 - 1.2t + 3" of coefficients from t⁰ upwards."""
    terms = [_term(value, power, digits) for power, value in enumerate(coefficients)]
    return " ".join(reversed(terms)).removeprefix("+ ")


def _term(value: float, power: int, digits: int) -> str:
    sign = "-" if value < 0 else "+"
    factor = {0: "", 1: "t"}.get(power, f"t^{power}")
    return f"{sign} {abs(value):.{digits}g}{factor}"
