"""The quadrature rules: exact where they should be, nested, and good for roots at both ends."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import beta

from kinematics.five_rpur.slicing.quadrature import LONG, SHORT


@pytest.mark.parametrize("rule", [SHORT, LONG], ids=["short", "long"])
def test_nodes_and_weights(rule):
    assert (np.diff(rule.place) > 0.0).all()
    assert 0.0 < rule.place[0] < rule.place[-1] < 1.0
    np.testing.assert_allclose(rule.place + rule.place[::-1], 1.0, atol=1e-15)
    assert (rule.weights > 0.0).all()
    np.testing.assert_allclose(rule.weights, rule.weights[::-1], atol=1e-15)
    # Every coarser rule keeps to every second node, and the two to different ones.
    used = rule.coarser != 0.0
    assert used[1::2, 0].all()
    assert used[::2, 1].all()
    assert not (used[:, 0] & used[:, 1]).any()


def test_the_rules_are_nested():
    np.testing.assert_array_equal(SHORT.place, LONG.place[1::2])


def test_the_short_rules_are_exact_for_cubics_and_first_roots():
    s = SHORT.place
    for power in range(4):
        for weights in (SHORT.weights, *SHORT.coarser.T):
            assert weights @ s**power == pytest.approx(1.0 / (power + 1), rel=1e-13)
    for power in (0.5, 1.5):
        for values in (s**power, (1.0 - s) ** power):
            assert SHORT.weights @ values == pytest.approx(1.0 / (power + 1), rel=1e-13)


@pytest.mark.parametrize("left", [0.0, 0.5, 1.0, 1.5, 2.5])
@pytest.mark.parametrize("right", [0.0, 0.5, 1.0, 1.5, 2.5])
def test_the_long_rule_integrates_roots_at_both_ends(left, right):
    s = LONG.place
    true = beta(left + 1.0, right + 1.0)
    assert LONG.weights @ (s**left * (1.0 - s) ** right) == pytest.approx(true, rel=1e-11)
    for coarse in LONG.coarser.T:
        assert coarse @ (s**left * (1.0 - s) ** right) == pytest.approx(true, rel=2e-3)


def test_a_kink_seldom_deceives_both_coarser_rules():
    """Wherever a kink lies, the larger of both differences is hardly ever far below the error."""
    for rule in (SHORT, LONG):
        ratios = []
        for at in np.linspace(0.05, 0.95, 181):
            values = np.maximum(rule.place - at, 0.0)
            error = abs(rule.weights @ values - 0.5 * (1.0 - at) ** 2)
            ratios.append(error / np.abs(rule.weights @ values - rule.coarser.T @ values).max())
        assert np.median(ratios) < 0.5
        assert np.mean(np.array(ratios) < 3.0) > 0.95
