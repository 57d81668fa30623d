"""The Trajectory tab, used as a person uses it."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import pytest

from tests.browser.conftest import Tab

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from playwright.sync_api import Locator

pytestmark = pytest.mark.browser

WIDE = {"width": 1280, "height": 800}


@pytest.fixture
def way(tab: Tab) -> Iterator[Tab]:
    """The Trajectory tab with a straight way from home."""
    before = tab.page.viewport_size
    tab.page.set_viewport_size(WIDE)  # type: ignore[arg-type]
    tab.open_tab("Trajectory")
    tab.check("Show the trajectory").click()
    tab.wait_for_text(r"press “To here”")
    tab.type_into("Samples", 21)
    tab.type_line("end", "300, 90, 230, 5, -5")
    tab.wait_for_text(r"[\d.]+ mm in 1 s, quintic, 21 samples")
    yield tab
    assert before is not None
    tab.page.set_viewport_size(before)


def _x(tab: Tab) -> float:
    return float(tab.props("/handle")["position"][0])


def test_it_plays_stops_and_is_taken_back(way: Tab) -> None:
    way.wait(lambda: bool(way.props("/trajectory/line").get("visible")), "the way in the scene")
    assert way.props("/trajectory/line")["points"] == 20 * 2 * 3 * 4
    way.wait_for_text(r"nearest to a singularity: [\d.]+ mm")
    way.page.get_by_role("button", name="Play", exact=True).click()
    way.wait_for_text(r"At 0\.\d\d of 1\.00 s · Reachable")
    places = set()
    way.wait(lambda: places.add(_x(way)) or len(places) > 2, "the machine moves")
    way.page.get_by_role("button", name="Pause").click()
    way.page.get_by_role("button", name="Back to where it was").click()
    way.wait(lambda: abs(_x(way) - 326.0) < 1e-3, "the machine is where it was")
    way.type_into("Time (s)", 1)
    way.wait(lambda: abs(_x(way) - 300.0) < 1e-3, "the machine at the end")
    way.open_tab("Move")
    way.wait(lambda: abs(way.value("x (mm)") - 300.0) < 0.06, "the review follows when it rests")
    way.shot("trajectory-stopped")
    way.page.keyboard.press("Escape")
    way.open_tab("Review")
    way.page.get_by_role("button", name="Undo").click()
    way.open_tab("Move")
    way.wait(lambda: abs(way.value("x (mm)") - 326.0) < 0.06, "one undo")


@pytest.mark.slow
def test_limits_a_click_a_fit_and_files(way: Tab, tmp_path: Path) -> None:
    way.page.get_by_text("Limits of the actuators").click()
    way.type_into("Rates (mm/s)", "20")
    way.wait_for_text(r"Rate of ρ\S reaches [\d.]+ mm/s at t = [\d.]+ s")
    way.wait(lambda: bool(way.props("/trajectory/beyond").get("visible")), "what is too fast")
    plot = way.page.get_by_label("The trajectory against time")
    way.wait(lambda: "Cancel the distances" not in way.text(), "the drawing is what it stays")
    box = plot.bounding_box()
    assert box is not None
    way.page.mouse.click(box["x"] + 0.55 * box["width"], box["y"] + 0.5 * box["height"])
    way.wait(lambda: 300.5 < _x(way) < 325.5, "the machine where the plot was clicked")
    way.page.get_by_text("Polynomials for the joints").click()
    way.field("Degree").first.click()
    # The list is placed anew as the panel grows; waiting until it is at rest may take for ever.
    found = way.page.get_by_role("option", name="5", exact=True)
    found.wait_for(state="attached")
    found.dispatch_event("click")
    way.wait_for_text(r"True error of the machine")
    way.shot("trajectory-fit")
    with way.page.expect_download() as saved:
        way.page.get_by_role("button", name="CSV", exact=True).last.click()
    file = tmp_path / "way.csv"
    saved.value.save_as(file)
    lines = file.read_text(encoding="utf-8").splitlines()
    assert len(lines) == 22
    assert lines[0].startswith("t,x,y,z,phi_deg,theta_deg,rho1")
    way.field("It runs").first.click()
    way.page.get_by_role("option", name="Points from a CSV file").click()
    with way.page.expect_file_chooser() as chooser:
        way.page.get_by_role("button", name="Open a CSV file").click()
    chooser.value.set_files(file)
    way.wait_for_text(r"way\.csv: 21 points, 1 s")
    way.wait_for_text(r"mm in 1 s, constant velocity")


def test_a_path_is_drawn_with_the_mouse(way: Tab) -> None:
    way.field("It runs").first.click()
    way.page.get_by_role("option", name="Drawn with the mouse").click()
    plane = way.page.get_by_label("The plane of x and y")
    plane.wait_for()
    plane.scroll_into_view_if_needed()
    box = plane.bounding_box()
    assert box is not None
    x, y = box["x"] + 0.45 * box["width"], box["y"] + 0.5 * box["height"]
    way.page.mouse.move(x, y)
    way.page.mouse.down()
    for n in range(1, 21):
        way.page.mouse.move(x + 2.5 * n, y + 0.15 * n * (20 - n))
    way.page.mouse.up()
    way.wait_for_text(r"[\d.]+ mm in [\d.]+ s, quintic, 21 samples")
    way.wait(lambda: bool(way.props("/trajectory/line").get("visible")), "the way in the scene")
    way.shot("trajectory-drawn")


def test_the_plots_lie_over_the_foot_of_the_scene(way: Tab) -> None:
    way.wait_for_text(r"nearest to a singularity: [\d.]+ mm")
    plot = way.page.get_by_label("The trajectory against time")
    window = way.page.locator("[data-floating-window]:has(.bo-play)")
    way.wait(
        lambda: plot.get_attribute("viewBox") == _size(plot), "the drawing as large as its room"
    )
    frame, drawn = _box(window), _box(plot)
    panel = _box(way.page.locator('[data-dock-region="right"]'))
    assert frame["x"] == 0.0
    assert frame["y"] + frame["height"] == pytest.approx(800.0, abs=1.0)
    assert frame["height"] == pytest.approx(352.0, abs=1.0)
    assert frame["x"] + frame["width"] == pytest.approx(panel["x"], abs=1.0)
    assert drawn["y"] + drawn["height"] <= 800.0  # nothing of it is cut
    # The play bar is one row, from end to end of the window, above the plots.
    row = [
        _box(way.page.get_by_role("button", name=name, exact=True))
        for name in ("Play", "¼×", "½×", "1×", "4×", "Stop here", "Back to where it was")
    ]
    row.append(_box(way.field("Time (s)").last))
    middles = [box["y"] + 0.5 * box["height"] for box in row]
    assert max(middles) - min(middles) < 4.0
    assert all(frame["x"] <= b["x"] <= b["x"] + b["width"] <= frame["width"] for b in row)
    assert all(box["y"] + box["height"] <= drawn["y"] + 1.0 for box in row)
    ends = sorted((box["x"], box["x"] + box["width"]) for box in row)
    assert all(one[1] <= two[0] + 0.5 for one, two in itertools.pairwise(ends))


def test_what_goes_wrong_first_is_gone_to(way: Tab) -> None:
    way.type_line("end", "250, 120, 240, 0, 0")
    told = way.wait_for_text(r"Leaves the workspace at t = [\d.]+ s")
    at = float(told.split()[-2])
    way.page.get_by_role("button", name="Go there").click()
    way.wait(lambda: abs(way.value("Time (s)") - at) < 2e-3, "the time of it")
    way.wait(lambda: abs(_x(way) - 251.76) < 0.05, "the machine there")


def _box(found: Locator) -> Any:
    box = found.locator("visible=true").first.bounding_box()
    assert box is not None
    return box


def _size(plot: Locator) -> str:
    """The view box of a drawing that is shown pixel by pixel."""
    box = _box(plot)
    return f"0 0 {round(box['width'])} {round(box['height'])}"
