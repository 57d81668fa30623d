"""Following assembly modes by arc length, on curves that are known in closed form."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from kinematics.answers.solutions import Fold, Followed, Margin, Posture
from kinematics.errors import InputError
from kinematics.facets.following import ClosureFollowing
from kinematics.homotopy.continuation import turn_ahead, walk
from kinematics.homotopy.curve import Curve
from kinematics.homotopy.quadrics import Quadrics, square, unknowns
from kinematics.mechanism import Coordinate


class Slider(ClosureFollowing):
    """A rod of length 1 from a slider on the x axis to a point on a line through (0, offset).

    State: the height y of its end; joint: the slider's distance s; s² + y² = 1, so that s turns
    back at s = ±1, where y = 0 and both assembly modes merge.
    """

    unit = 1.0

    def __init__(self, low: float, high: float) -> None:
        stroke = (Coordinate("s", "s", "mm", low, high, limb=1),)
        super().__init__(SimpleNamespace(design=None, actuators=stroke))

    def closure(self, mode: str) -> Quadrics:
        y, s = unknowns(2)
        return Quadrics.of([square(s) + square(y) - 1.0])

    def unknowns(self, pose, mode: str):
        return np.array(pose)

    def posture(self, unknowns, joints, pose, mode: str) -> Posture:
        return posture(float(unknowns[0]), joints)


def near_crossing(gap: float) -> Curve:
    """(y − s)(y + s) = gap, s = λ − 1: two branches that come as near as √gap and do not meet."""
    y, along = unknowns(2)
    start = np.array([np.sqrt(1.0 + gap), 0.0])
    return Curve(Quadrics.of([square(y) - square(along - 1.0) - gap]), start)


def posture(state: float, joints) -> Posture:
    return Posture((state,), "", tuple(joints.tolist()), (), 0.0, (Margin(1, "rho_max", 1.0),))


def at(joint: float) -> Posture:
    return posture(math.sqrt(1.0 - joint**2), np.array([joint]))


def led(joint: float, wanted: float, low: float = -np.inf, high: float = np.inf) -> Followed:
    return Slider(low, high).follow(at(joint), [wanted])


def fold_ahead(joint: float, wanted: float) -> Fold | None:
    return Slider(-np.inf, np.inf).fold_ahead(at(joint), [wanted])


@pytest.mark.parametrize("wanted", [0.9, -0.9, 0.3, 0.99999, 0.2000001])
def test_a_target_on_the_branch_is_reached(wanted: float) -> None:
    found = led(0.2, wanted)
    assert found.stop == "target"
    assert found.posture.joints == (wanted,)
    assert found.posture.pose[0] == pytest.approx(np.sqrt(1.0 - wanted**2), abs=1e-11)
    assert found.fraction == 1.0
    assert found.text == ""


def test_a_fold_stops_the_way_a_millionth_before_it() -> None:
    found = led(0.2, 1.8)
    assert found.stop == "singularity"
    way = 1.6
    assert 1.0 - found.posture.joints[0] == pytest.approx(1e-6 * way, rel=0.6)
    assert found.posture.joints[0] < 1.0
    assert found.posture.pose[0] > 0.0
    assert found.fraction == pytest.approx(0.5, rel=1e-4)
    assert "s cannot go beyond 1.0 mm" in found.text


def test_a_stroke_end_stops_the_way() -> None:
    found = led(0.2, 0.9, high=0.7)
    assert (found.stop, found.limb) == ("stroke", 1)
    assert found.posture.joints == (0.7,)
    assert found.fraction == pytest.approx(5.0 / 7.0)
    assert "s max = 0.7 mm" in found.text
    beyond = led(0.8, 0.9, high=0.7)  # it may stay there, but not go further
    assert beyond.posture.joints == (0.8,)
    assert beyond.stop == "stroke"
    assert led(0.8, 0.75, high=0.7).stop == "target"


def test_no_way_is_none() -> None:
    found = led(0.2, 0.2)
    assert found.stop == "target"
    assert found.posture.pose[0] == pytest.approx(np.sqrt(0.96))
    with pytest.raises(InputError):
        led(0.2, float("nan"))


def test_a_start_in_a_fold_is_undetermined() -> None:
    found = led(1.0, 0.5)
    assert found.stop == "singularity"
    assert "move the platform out of it first" in found.text
    assert found.fraction == 0.0


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6, 1e-8])
def test_branches_that_nearly_cross_are_not_exchanged(gap: float) -> None:
    """y² − s² = gap: y stays positive however narrow the gap is."""
    found = walk(near_crossing(gap), np.array([np.sqrt(1.0 + gap), 0.0]), 2.0)
    assert found.stop == "target"
    assert found.point[0] == pytest.approx(np.sqrt(1.0 + gap))


def test_a_true_crossing_is_not_passed() -> None:
    found = walk(near_crossing(0.0), np.array([1.0, 0.0]), 2.0)
    assert found.stop == "singularity"
    assert found.point[-1] == pytest.approx(1.0, abs=1e-3)
    assert found.point[-1] < 1.0


def test_the_other_branch_beyond_a_gap_is_not_taken() -> None:
    """y² − s² = −gap: s turns back at ±√gap, and the way ends there."""
    found = walk(near_crossing(-1e-6), np.array([np.sqrt(1.0 - 1e-6), 0.0]), 2.0)
    assert found.stop == "singularity"
    assert found.point[-1] == pytest.approx(1.0 - 1e-3, abs=1e-5)
    assert found.point[0] > 0.0


def test_a_way_ends_where_the_unknown_that_ends_it_changes_its_sign() -> None:
    """On the line y = s − 0.5, which begins at s = −1: at s = 0.5, exactly there."""
    y, along = unknowns(2)
    curve = Curve(Quadrics.of([(y - along + 1.5).by(y + along + 7.0)]), np.array([-1.5, 0.0]))
    found = walk(curve, np.array([-1.5, 0.0]), 2.0, edge=0)
    assert found.stop == "edge"
    assert found.point == pytest.approx([0.0, 1.5], abs=1e-12)
    assert walk(curve, np.array([-1.5, 0.0]), 1.0, edge=0).stop == "target"


def test_the_fold_ahead_and_its_partner() -> None:
    fold = fold_ahead(0.2, 3.0)
    assert fold is not None
    assert fold.distance == pytest.approx(0.8, abs=1e-12)
    assert fold.joints[0] == pytest.approx(1.0, abs=1e-12)
    assert fold.pose[0] == pytest.approx(0.0, abs=1e-6)
    assert fold.partner is not None
    assert fold.partner.pose[0] == pytest.approx(-np.sqrt(0.96), abs=1e-10)
    assert fold_ahead(0.2, 0.9) is None
    y, along = unknowns(2)
    curve = Curve(Quadrics.of([square(along + 0.2) + square(y) - 1.0]), np.array([0.98, 0.0]))
    assert turn_ahead(curve, np.array([math.sqrt(0.96), 0.0]), 0.7) is None
