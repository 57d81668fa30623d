"""Verdicts: each is decided by comparing what is printed with what was computed.

An item is "reproduced" where the printed numbers, or the printed formula at random postures, agree
with the library; "corrected" where they do not and the correction does; "impossible" where a datum
is missing. Where neither the printed nor the corrected form holds there is no verdict but an error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from math import floor, isfinite, log10
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import plain
from kinematics.errors import ComputationError

Verdict = Literal["reproduced", "corrected", "impossible"]
VERDICTS: tuple[Verdict, ...] = ("reproduced", "corrected", "impossible")

HOLDS = 1e-8
"""Relative error below which a formula holds: rounding, and what a condition number makes of it."""
FAILS = 1e-4
"""Above which it does not."""
_MOST = 15  # digits that a double has


@dataclass(frozen=True, slots=True)
class Quantity:
    """One computed value beside what is printed of it.

    Attributes:
        what: which.
        computed: by the library.
        printed: as printed, with its digits; None where it is not.
        unit: of both.
    """

    what: str
    computed: float | str
    printed: str | None = None
    unit: str = ""

    @property
    def digits(self) -> tuple[int, int] | None:
        """How many significant digits agree, and how many are printed; None without numbers."""
        if self.printed is None or isinstance(self.computed, str):
            return None
        return agreement(self.printed, self.computed)

    @property
    def agrees(self) -> bool:
        """What is printed is what was computed, rounded."""
        if self.printed is None:
            return True
        found = self.digits
        return found[0] == found[1] if found else self.printed == self.computed

    @property
    def shown(self) -> str:
        """The computed value with its unit."""
        if isinstance(self.computed, str):
            value = self.computed
        elif self.printed is None:
            value = number(self.computed)
        else:
            value = rounded(self.computed, self.printed)
        return f"{value} {self.unit}".strip()


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of an item.

    Attributes:
        verdict: decided by what was computed.
        quantities: what was computed.
        proof: how the verdict was found, one sentence without its stop.
    """

    verdict: Verdict
    quantities: tuple[Quantity, ...]
    proof: str


# --- numbers as printed --------------------------------------------------------------------


def agreement(printed: str, computed: float) -> tuple[int, int]:
    """Of a number's significant digits: how many agree with a computed one, and how many there are.

    All agree where the computed value rounds to the printed one.
    """
    try:
        value = Decimal(printed.replace("−", "-"))
    except InvalidOperation:
        raise ComputationError(f"{printed!r} is not a number that can be compared") from None
    _, digits, exponent = value.as_tuple()
    count, last = len(digits), 10.0 ** int(exponent)
    off = abs(float(value) - computed)
    if off <= 0.5000001 * last:
        return count, count
    size = max(abs(float(value)), abs(computed))
    return max(0, min(count - 1, floor(-log10(2.0 * off / size)))), count


def rounded(value: float, printed: str) -> str:
    """A computed value with two digits more than are printed, so that a difference is seen."""
    places = -int(Decimal(printed.replace("−", "-")).as_tuple().exponent)
    if "e" in printed.lower() or abs(places) > _MOST:
        return number(value)
    text = f"{value:.{max(places + 2, 0)}f}" if places > 0 else f"{value:.10g}"
    return text.replace("-", "−")


def number(value: float) -> str:
    """Ten digits at most, and no more than are there."""
    if not isfinite(value):
        return "none"
    if value == int(value) and abs(value) < 1e12:  # as 81 397 500 is read best
        return f"{int(value):,}".replace(",", "\u202f").replace("-", "−")
    digits = 2 if abs(value) < 1e-6 else 10
    return f"{value:.{digits}g}".replace("-", "−")


def error(left: ArrayLike, right: ArrayLike) -> float:
    """The largest difference of two sides of an equation, relative to their largest size."""
    a, b = np.asarray(left), np.asarray(right)
    size = max(float(np.abs(a).max(initial=0.0)), float(np.abs(b).max(initial=0.0)), 1e-300)
    return float(np.abs(a - b).max(initial=0.0)) / size


# --- verdicts ------------------------------------------------------------------------------


def compared(*quantities: Quantity) -> Outcome:
    """Printed numbers beside computed ones: reproduced where all agree, else corrected."""
    told = [q for q in quantities if q.printed is not None]
    off = [q for q in told if not q.agrees]
    if off:
        worst = "; ".join(f"{q.what}: printed {q.printed}, computed {q.shown}" for q in off[:3])
        return Outcome("corrected", quantities, worst)
    if not told:
        raise ComputationError("nothing printed to compare with")
    counts = sorted({q.digits[1] for q in told if q.digits})
    if not counts:
        return Outcome(
            "reproduced", quantities, "what is printed and what is computed are the same"
        )
    span = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
    noun = "digit" if span == "1" else "digits"
    return Outcome("reproduced", quantities, f"to all printed digits ({span} {noun})")


def identity(
    printed: float, corrected: float | None = None, *, where: str, of: str = "relative error"
) -> Outcome:
    """A formula as printed and, if need be, as corrected: its largest errors at many postures."""
    quantities = [Quantity(f"largest {of} as printed, {where}", _short(printed))]
    if corrected is not None:
        quantities.append(Quantity("of the corrected form", _short(corrected)))
    if printed <= HOLDS:
        return Outcome("reproduced", tuple(quantities), f"holds {where}, {_within(printed)}")
    if not printed >= FAILS or corrected is None or not corrected <= HOLDS:  # NaN is neither
        raise ComputationError(f"neither form holds {where}: {printed:.1e}, {corrected}")
    proof = f"as printed it fails {where} ({of} {printed:.2g}), corrected it holds"
    return Outcome("corrected", tuple(quantities), f"{proof}, {_within(corrected)}")


def _short(value: float) -> float:
    """Two digits of an error are enough."""
    return float(f"{value:.2g}")


def _within(value: float) -> str:
    return f"to {value:.0e}" if value > 0.0 else "exactly"


def claimed(holds: bool, *quantities: Quantity, proof: str) -> Outcome:
    """A statement of the text, which holds or does not."""
    return Outcome("reproduced" if holds else "corrected", quantities, proof)


def drawn(sound: bool, *quantities: Quantity, proof: str) -> Outcome:
    """What is drawn from given data, without printed numbers, and agrees with a second way.

    Raises:
        ComputationError: it does not.
    """
    if not sound:
        raise ComputationError(f"two ways do not agree: {proof}")
    return Outcome("reproduced", quantities, proof)


def missing(*quantities: Quantity) -> Outcome:
    """It cannot be recomputed; what can be told all the same stands beside it."""
    return Outcome("impossible", quantities, "")


def counts(
    printed: Sequence[int], *computed: tuple[str, int], more: Sequence[Quantity] = ()
) -> Outcome:
    """Printed numbers of things beside counted ones."""
    pairs = zip(printed, computed, strict=True)
    told = [Quantity(what, float(found), str(said)) for said, (what, found) in pairs]
    return compared(*told, *more)


def as_json(quantity: Quantity) -> dict[str, Any]:
    """A quantity as the command line's JSON has it."""
    digits = quantity.digits
    return {
        "what": quantity.what,
        "printed": quantity.printed,
        "computed": plain(quantity.computed),
        "unit": quantity.unit,
        "digits": None if digits is None else digits[0],
        "printed_digits": None if digits is None else digits[1],
    }
