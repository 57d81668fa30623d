"""Following assembly modes by arc length, on curves that are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.answers.solutions import Margin, Posture
from kinematics.errors import InputError
from kinematics.facets.following import Line, Linear, along_line, fold_ahead, follow, turn_on_line


class Slider:
    """A rod of length 1 from a slider on the x axis to a point on a line through (0, offset).

    State: the height y of its end; joint: the slider's distance s; s² + y² = 1, so that s turns
    back at s = ±1, where y = 0 and both assembly modes merge.
    """

    joint_unit = 1.0
    tolerance = 1e-12

    def linear(self, state: float, joints) -> Linear:
        s, y = float(joints[0]), state
        error = s * s + y * y - 1.0
        return Linear(np.array([error]), np.array([[2.0 * y]]), np.array([[2.0 * s]]), abs(error))

    def moved(self, state: float, step) -> float:
        return state + float(step[0])


class NearCrossing:
    """(y − s)(y + s) = gap: two branches that come as near as √gap and do not meet."""

    joint_unit = 1.0
    tolerance = 1e-14

    def __init__(self, gap: float) -> None:
        self.gap = gap

    def linear(self, state: float, joints) -> Linear:
        s, y = float(joints[0]), state
        error = y * y - s * s - self.gap
        return Linear(np.array([error]), np.array([[2.0 * y]]), np.array([[-2.0 * s]]), abs(error))

    def moved(self, state: float, step) -> float:
        return state + float(step[0])


def posture(state: float, joints) -> Posture:
    return Posture((state,), "", tuple(joints.tolist()), (), 0.0, (Margin(1, "rho_max", 1.0),))


def led(joint: float, wanted: float, low: float = -np.inf, high: float = np.inf):
    start = posture(float(np.sqrt(1.0 - joint**2)), np.array([joint]))
    return follow(
        Slider(),
        start,
        start.pose[0],
        [wanted],
        strokes=np.array([[low, high]]),
        symbols=("s",),
        posture=posture,
    )


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
    line = Line(NearCrossing(gap), np.array([-1.0]), np.array([1.0]))
    found = along_line(line, float(np.sqrt(1.0 + gap)), 2.0)
    assert found.stop == "target"
    assert found.state == pytest.approx(np.sqrt(1.0 + gap))


def test_a_true_crossing_is_not_passed() -> None:
    line = Line(NearCrossing(0.0), np.array([-1.0]), np.array([1.0]))
    found = along_line(line, 1.0, 2.0)
    assert found.stop == "singularity"
    assert found.along == pytest.approx(1.0, abs=1e-3)
    assert found.along < 1.0


def test_the_other_branch_beyond_a_gap_is_not_taken() -> None:
    """y² − s² = −gap: s turns back at ±√gap, and the way ends there."""
    line = Line(NearCrossing(-1e-6), np.array([-1.0]), np.array([1.0]))
    found = along_line(line, float(np.sqrt(1.0 - 1e-6)), 2.0)
    assert found.stop == "singularity"
    assert found.along == pytest.approx(1.0 - 1e-3, abs=1e-5)
    assert found.state > 0.0


def test_the_fold_ahead_and_its_partner() -> None:
    start = posture(float(np.sqrt(0.96)), np.array([0.2]))
    fold = fold_ahead(Slider(), start, start.pose[0], [3.0], posture=posture)
    assert fold is not None
    assert fold.distance == pytest.approx(0.8, abs=1e-12)
    assert fold.joints[0] == pytest.approx(1.0, abs=1e-12)
    assert fold.pose[0] == pytest.approx(0.0, abs=1e-6)
    assert fold.partner is not None
    assert fold.partner.pose[0] == pytest.approx(-np.sqrt(0.96), abs=1e-10)
    assert fold_ahead(Slider(), start, start.pose[0], [0.9], posture=posture) is None
    line = Line(Slider(), np.array([0.2]), np.array([1.0]))
    turn = turn_on_line(line, start.pose[0], 0.7)
    assert turn is None
