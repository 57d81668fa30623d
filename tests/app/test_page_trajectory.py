"""The Trajectory tab of every mechanism, used as a person uses it, without a browser."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from app.features.move.state import Place
from app.features.singularities.state import SetControl
from app.features.trajectory.part import TrajectoryPart
from app.features.trajectory.state import Plan, SetPlan
from app.review.changes import Restore
from app.review.state import new_review
from kinematics.designs.files import load_design
from tests.app import seats
from tests.app.seats import Seat, seat
from tests.conftest import rarely

TO = {
    "rpur-table1": "300, 90, 230, 5, -5",
    "five-bar": "100, 700",
    "sps-spr": "20, 10, 600, 5, 5, 0",
    "rps-3": "300, 10, 60",
    "spr-3": "110, 10, 60",
}


@pytest.fixture(scope="module")
def shared() -> Iterator[Seat]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(seats, "INLINE", ("trajectory",))
        with seat("five-bar") as made:
            yield made


def _open(shared: Seat, name: str) -> Seat:
    shared.do(Restore(new_review(load_design(name))))
    shared.told.clear()
    shared.files.clear()
    shared.do(SetPlan((("on", True), ("way", "straight"), ("samples", 5))))
    return shared


def _part(page: Seat) -> TrajectoryPart:
    return page.page.part(TrajectoryPart)


def _spot(page: Seat) -> np.ndarray:
    return np.array(page.node("/handle").position)


@pytest.mark.parametrize("name", [n if n == "rpur-table1" else rarely(n) for n in TO])
def test_each_machine_runs_stops_and_is_taken_back(shared: Seat, name: str) -> None:
    page = _open(shared, name)
    assert "Trajectory" in page.tabs
    assert "press “To here”" in page.text()
    assert not page.seen("/trajectory/")
    home = page.review.pose
    page.paste("To", TO[name])
    assert "5 samples" in page.text()
    assert page.seen("/trajectory/line")
    points = np.array(page.node("/trajectory/line").points)
    np.testing.assert_allclose(points[0, 0], _spot(page), atol=1e-3)
    page.ask(_part(page).playing.scrub, 1e9)
    np.testing.assert_allclose(points[-1, 1], _spot(page), atol=1e-3)
    assert page.review.pose == home
    assert "Reachable" in page.text()
    assert not page.node("/control").visible
    page.ask(_part(page).playing.go_back)
    np.testing.assert_allclose(points[0, 0], _spot(page), atol=1e-3)
    assert page.node("/control").visible
    page.ask(_part(page).playing.scrub, 1e9)
    page.ask(_part(page).playing.stop_here)
    assert page.review.pose == pytest.approx(_part(page).current.pose_at(1e9), abs=1e-9)  # type: ignore[union-attr]
    page.page.undo()
    page.settle()
    assert page.review.pose == home
    np.testing.assert_allclose(points[0, 0], _spot(page), atol=1e-3)
    assert page.told == []


def test_way_points_are_taken_typed_and_removed(shared: Seat) -> None:
    page = _open(shared, "five-bar")
    page.put("It runs", "Through way points")
    page.press("Present pose", "Add here")
    page.press("Present pose", "Add here")
    assert "the last way point already" in page.told[-1]
    page.do(Place((50.0, 760.0)))
    page.press("Present pose", "Add here")
    assert page.widget("Way points").value == "0, 804\n50, 760"
    assert "5 samples" in page.text()
    page.put("Way points", "0, 804\n50, 76o")
    assert "Way point 2: numbers" in page.text()
    assert len(page.review[Plan].points) == 2
    page.put("Way points", "0, 804\n50, 760\n-40, 700")
    assert page.review[Plan].points[2] == (-40.0, 700.0)
    page.press("Present pose", "Remove last")
    assert len(page.review[Plan].points) == 2
    page.press("Present pose", "Clear")
    assert page.review[Plan].points == ()
    assert "at least two way points" in page.text()


def test_laws_limits_and_polynomials(shared: Seat) -> None:
    page = _open(shared, "five-bar")
    page.put("It runs", "Straight line from rest to rest, quintic")
    page.put("Rates (°/s)", "20")
    assert np.degrees(page.review[Plan].rates) == pytest.approx((20.0, 20.0))
    assert "Rate of θ₂ reaches" in page.text()
    page.put("Rates (°/s)", "20, 30, 40")
    assert "one number for all joints, or 2" in page.text()
    page.press("Shortest duration that keeps them")
    assert "Nothing on the way" in page.text()
    page.put("Degree", "3")
    assert "True error" in page.text()
    page.put("Time law", "Trapezoidal")
    assert page.widget("Speed (mm/s)").visible
    assert "trapezoidal" in page.text()
    page.put("Duration (s)", 1.5)
    page.put("Time law", "Constant velocity")
    assert "in 1.5 s, constant velocity" in page.text()


def test_a_stroke_is_drawn_and_undone(shared: Seat) -> None:
    page = _open(shared, "five-bar")
    page.put("It runs", "Drawn with the mouse")
    assert any("The plane of x and y" in piece for piece in page.html())
    handles = [h for h in page._handles() if getattr(h, "label", "") == "Pointed at"]
    sketch = next(h for h in handles if h.order > page.widget("Upwards").order)
    sketch._impl.value = "0 700 20 690 45 700 60 720 1234.5"
    page._tell(sketch)
    assert page.review[Plan].stroke[1] == (20.0, 690.0)
    assert "5 samples" in page.text()
    page.page.undo()
    page.settle()
    assert page.review[Plan].stroke == ()
    assert not page.seen("/trajectory/")


def test_files(shared: Seat) -> None:
    page = _open(shared, "five-bar")
    page.put("It runs", "Straight line at constant velocity")
    page.do(SetControl("load", (10.0, 0.0, 0.0, 0.0, 0.0, 0.0)))
    for kind in ("csv", "svg"):
        page.ask(_part(page).save_trajectory, kind)
    table, drawing = (file.data.decode() for file in page.files)
    assert table.splitlines()[0].startswith("t,x,y,theta1_deg")
    assert len(table.splitlines()) == 6
    assert drawing.startswith("<?xml")
    assert [file.name for file in page.files] == [
        "five-bar_trajectory_+-.csv",
        "five-bar_trajectory_+-.svg",
    ]


def test_another_machine_leaves_nothing_of_the_last(shared: Seat) -> None:
    page = _open(shared, "five-bar")
    page.paste("To", "100, 700")
    assert page.seen("/trajectory/line")
    page.open("rps-3")
    assert page.review[Plan].on
    assert not page.seen("/trajectory/")
    assert "press “To here”" in page.text()


def test_a_way_with_a_law_of_its_own_runs_by_that(shared: Seat) -> None:
    page = _open(shared, "five-bar")
    page.put("Time law", "Quintic, rest to rest")
    page.paste("To", "100, 700")
    assert page.review[Plan].law == "quintic"
    page.put("It runs", "Straight line at constant velocity")
    assert page.review[Plan].law == ""
    assert "quintic" not in page.text()


def test_on_the_way_actuators_follow_and_what_does_not_says_so(shared: Seat) -> None:
    page = _open(shared, "five-bar")
    page.paste("To", "100, 700")
    said = "the trajectory shows the machine elsewhere"
    before = page.widget("x (mm)").value
    assert said not in page.text()
    page.ask(_part(page).playing.scrub, 1e9)
    assert page.widget("x (mm)").value == 100.0
    assert page.widget("y (mm)").value == 700.0
    assert said in page.text()
    page.ask(_part(page).playing.go_back)
    assert page.widget("x (mm)").value == before
    assert said not in page.text()
