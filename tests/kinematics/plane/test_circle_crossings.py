"""Where two circles meet, near a touch too, against rational arithmetic."""

from __future__ import annotations

from decimal import Decimal, localcontext

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinematics.plane.circle_crossings import factors, half_angle, half_chord

lengths = st.floats(1e-2, 1e4)


def true_half_chord(d: float, r: float, s: float) -> float:
    with localcontext() as context:
        context.prec = 60
        a, b, c = Decimal(d), Decimal(r), Decimal(s)
        square = (a + b + c) * (b + c - a) * (c + a - b) * (a + b - c)
        return float(square.sqrt() / (2 * a)) if square > 0 else 0.0


@given(lengths, lengths, st.floats(1e-15, 1e-3), st.sampled_from(["apart", "within", "around"]))
def test_the_common_chord_keeps_its_digits(r: float, s: float, part: float, touch: str) -> None:
    gap = part * min(r, s)
    d = {"apart": r + s - gap, "within": abs(r - s) + gap, "around": abs(r - s) - gap}[touch]
    if d <= 0.0:
        return
    one, other = (np.array([length]) for length in (r, s))
    found = half_chord(factors(np.array([d]), one, other), np.array([d]))[0]
    wanted = true_half_chord(d, r, s)
    assert abs(found - wanted) <= 1e-14 * wanted
    # Both circles tell the same chord.
    here = half_angle(factors(np.array([d]), one, other))[0]
    there = half_angle(factors(np.array([d]), other, one))[0]
    assert bool(np.isnan(here)) == bool(np.isnan(there))
    if wanted > 0.0:
        assert abs(r * np.sin(here) - wanted) <= 1e-14 * wanted + 4e-16 * r
        assert abs(s * np.sin(there) - wanted) <= 1e-14 * wanted + 4e-16 * s


@given(lengths, lengths, lengths)
def test_factors_are_the_same_whichever_circle_is_first(d: float, r: float, s: float) -> None:
    here = factors(np.array(d), np.array(r), np.array(s))
    there = factors(np.array(d), np.array(s), np.array(r))
    assert here.apart == there.apart
    assert here.beyond_first == there.beyond_second
    assert here.least == there.least
