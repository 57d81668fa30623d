"""The quadrature rule: exact for roots, and its doubt is larger than what kinks do to it."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.mechanisms.five_rpur.slicing.integral import KINK
from kinematics.mechanisms.five_rpur.slicing.quadrature import nulls, weights_of

SPANS = [(0.0, 1.0, 3.0, 2.0), (0.2, 0.7, -1.0, 0.5), (0.0, 0.25, 5.0, -4.0), (0.5, 1.0, 2.0, -0.1)]


def rule(span, area, slope):
    """The integral by the rule, the true ends of x', and what the null rules give."""
    span = np.array(span)
    u = np.array([span[0], 0.5 * (span[0] + span[1]), span[1]])
    x = span[2] + span[3] * u * u
    sections = np.zeros((3, 6))
    sections[:, 0] = area(x)
    with np.errstate(divide="ignore", invalid="ignore"):
        sections[:, 3] = np.where(x == span[2], 1e300, slope(x))  # it must not be asked for there
    w0, w1, w2, s0, s2 = weights_of(span)
    value = np.array([w0, w1, w2]) @ sections[:, 0] + np.array([s0, s2]) @ sections[::2, 3]
    return value, sorted((x[0], x[2])), nulls(span, *sections)


@pytest.mark.parametrize("span", SPANS)
@pytest.mark.parametrize("power", [0.0, 0.5, 1.0, 1.5, 2.0])
def test_roots_at_the_end_are_integrated_exactly(span, power):
    end = span[2]
    value, (a, b), _ = rule(
        span,
        lambda x: np.abs(x - end) ** power,
        lambda x: power * np.abs(x - end) ** (power - 1.0) * np.sign(x - end),
    )
    near, far = sorted((abs(a - end), abs(b - end)))
    true = (far ** (power + 1.0) - near ** (power + 1.0)) / (power + 1.0)
    assert value == pytest.approx(true, rel=1e-13)


@pytest.mark.parametrize("span", SPANS)
def test_null_rules_are_nothing_for_cubics_in_u(span):
    for power in (0.0, 0.5, 1.0):  # times dx'/du: powers 1, 2, 3 of u
        *_, doubt = rule(
            span,
            lambda x, p=power: np.abs(x - span[2]) ** p,
            lambda x, p=power: p * np.abs(x - span[2]) ** (p - 1.0) * np.sign(x - span[2]),
        )
        assert doubt < 1e-13
    *_, doubt = rule(span, lambda x: (x - span[2]) ** 2, lambda x: 2.0 * (x - span[2]))
    assert doubt > 1e-8


@pytest.mark.parametrize("order", [1.0, 1.5, 2.0, 2.5, 3.0])
@pytest.mark.parametrize("turned", [False, True])
def test_no_kink_does_more_than_its_doubt(order, turned):
    """Wherever a kink of these orders lies in a panel, the error stays below."""
    # Far from the root u is all but proportional to x'.
    span = (1000.0, 1001.0, -1e6 / 2000.0, 1.0 / 2000.0)
    first, last = 0.0, (1001.0**2 - 1000.0**2) / 2000.0
    seen = []
    sign = -1.0 if turned else 1.0
    for at in np.linspace(1e-3, 0.999, 500) * last:

        def beyond(x, at=at):
            return np.maximum(sign * (x - at), 0.0)

        value, (a, b), doubt = rule(
            span,
            lambda x: beyond(x) ** order,
            lambda x: (
                sign
                * order
                * np.where(beyond(x) > 0.0, beyond(x), 1.0) ** (order - 1.0)
                * (beyond(x) > 0.0)
            ),
        )
        assert (a, b) == pytest.approx((first, last), abs=1e-9)
        true = (beyond(a if turned else b)) ** (order + 1.0) / (order + 1.0)
        seen.append(abs(value - true) / doubt)
    assert max(seen) < KINK
    assert np.median(seen) > 0.01
