"""The Map tab, used as a person uses it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from tests.browser.conftest import Tab

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Locator

pytestmark = pytest.mark.browser

TOLD = r"φ (−?[\d.]+)°, θ (−?[\d.]+)°: ([\d.]+) ± ([\d.]+) dm³"

UNFINISHED = r"Computing: |Nothing is computed yet|Press Start|Stopped at"


def _plot(tab: Tab) -> Locator:
    found = tab.page.locator(".plot svg[data-box]").locator("visible=true").first
    found.wait_for(timeout=60_000)
    found.scroll_into_view_if_needed()
    return found


def _place(plot: Locator, phi: float, theta: float) -> tuple[float, float]:
    """Where on the page the map shows an orientation (degrees)."""
    box: Any = plot.bounding_box()
    left, top, wide, high, x0, x1, y0, y1 = map(float, str(plot.get_attribute("data-box")).split())
    scale = box["width"] / float(str(plot.get_attribute("viewBox")).split()[2])
    return (
        box["x"] + scale * (left + wide * (phi - x0) / (x1 - x0)),
        box["y"] + scale * (top + high * (1 - (theta - y0) / (y1 - y0))),
    )


def _set_spans(tab: Tab, low: float, high: float, count: int) -> None:
    for symbol in "φθ":
        for name, value in (("from", low), ("to", high), ("values", count)):
            tab.type_into(f"{symbol} {name}", value)
            # The browser sends what changed every 50 ms, and of two boxes only the last.
            tab.page.wait_for_timeout(250)


def _run(tab: Tab, low: float, high: float, count: int) -> None:
    """Compute a map, of another size than what is shown, and wait for the whole of it."""
    tab.open_tab("Map")
    _set_spans(tab, low, high, count)
    tab.page.get_by_role("button", name="Start", exact=True).click()
    shown = tab.page.locator(f'.plot svg[data-grid="{count} {count}"]').locator("visible=true")

    def whole() -> bool:
        return shown.count() == 1 and not re.search(UNFINISHED, tab.text())

    tab.wait(whole, "the whole map")


def _told(plot: Locator) -> str:
    return str(plot.locator(".tip").text_content())


def test_a_map_is_computed_read_and_steers_the_machine(tab: Tab, tmp_path: Path) -> None:
    _run(tab, -30, 30, 5)
    plot = _plot(tab)
    assert plot.locator("path[shape-rendering]").count() >= 3
    mouse = tab.page.mouse
    mouse.move(*_place(plot, 1.0, -1.0))
    found = re.fullmatch(TOLD, _told(plot))
    assert found is not None, _told(plot)
    assert (found[1], found[2]) == ("0.0", "0.0")
    assert abs(float(found[3]) - 6.001738) <= float(found[4]) + 1e-6
    with tab.page.expect_download(timeout=60_000) as started:
        tab.page.get_by_role("button", name="NPZ", exact=True).locator("visible=true").click()
    path = tmp_path / started.value.suggested_filename
    started.value.save_as(path)
    with np.load(path) as saved:
        assert saved["volume_mm3"].shape == (5, 5)
        assert saved["volume_mm3"][2, 2] == pytest.approx(6_001_738, rel=1e-4)
    # The machine goes where the map is clicked; x, y and z stay, and undo takes it back.
    plot = _plot(tab)
    before = plot.locator("xpath=ancestor::div[2]/following-sibling::div[1]").inner_html()
    mouse.click(*_place(plot, 13.0, -27.0))  # in the cell of 15 and −30
    tab.wait(
        lambda: (
            plot.locator("xpath=ancestor::div[2]/following-sibling::div[1]").inner_html() != before
        ),
        "the cross elsewhere",
    )
    tab.shot("map")
    tab.open_tab("Move")
    x = tab.value("x (mm)")
    tab.wait(lambda: tab.value("φ (°)") == 15.0, "φ of the cell")
    assert tab.value("θ (°)") == -30.0
    tab.open_tab("Review")
    tab.page.get_by_role("button", name="Undo").click()
    tab.open_tab("Move")
    tab.wait(lambda: tab.value("φ (°)") == 0.0, "φ as before")
    assert tab.value("x (mm)") == x


def test_a_map_of_another_design_is_marked_and_kept(tab: Tab) -> None:
    _run(tab, -10, 10, 2)
    tab.open_tab("Design")
    tab.field("Design", 1).first.click()
    tab.page.get_by_role("option", name="rpur-table2", exact=True).click()
    tab.open_tab("Map")
    tab.wait_for_text("Of the design or working modes before")
    assert _plot(tab).locator("g.map").get_attribute("opacity") == ".35"


def test_a_map_is_cancelled_at_once_and_what_came_stays(tab: Tab) -> None:
    tab.open_tab("Map")
    _set_spans(tab, -60, 60, 61)
    tab.page.get_by_role("button", name="Start", exact=True).click()
    tab.wait(lambda: re.search(r"Computing: [\d.]+ %", tab.text()) is not None, "a first part")
    tab.page.get_by_role("button", name="Cancel", exact=True).locator("visible=true").last.click()
    text = tab.wait_for_text(r"Stopped at \d+ % of the map")
    assert int(text.split()[2]) < 100


def test_what_is_typed_after_undo_is_what_is_computed(tab: Tab) -> None:
    """Down to a number that was there before: boxes of numbers once kept it to themselves."""
    tab.open_tab("Map")
    _set_spans(tab, -90, 90, 7)
    tab.page.wait_for_timeout(1200)  # a step of its own in undo
    _set_spans(tab, -90, 90, 41)
    tab.page.wait_for_timeout(1200)
    tab.open_tab("Review")
    tab.page.get_by_role("button", name="Undo").click()
    tab.open_tab("Map")
    tab.wait(lambda: tab.field("θ values").last.input_value() == "7", "undone")
    _run(tab, -60, 60, 4)
    told = _plot(tab).get_attribute("data-grid")
    assert told == "4 4"
    assert tab.field("φ from").last.input_value() == "-60"


def test_maps_of_several_quantities_are_kept_and_told_apart(tab: Tab) -> None:
    _run(tab, -20, 20, 3)
    tab.field("Show").first.click()
    tab.page.get_by_role("option", name="Number of pieces", exact=True).click()
    tab.wait_for_text(r"Shown: volume\. Press Start for number of pieces\.")
    tab.page.get_by_role("button", name="Start", exact=True).click()
    pieces = tab.page.get_by_role("img", name="Map of Number of pieces")
    pieces.wait_for(timeout=60_000)
    tab.wait(lambda: not re.search(UNFINISHED, tab.text()), "the whole map")
    tab.field("Show").first.click()
    tab.page.get_by_role("option", name="Volume", exact=True).click()
    tab.page.get_by_role("img", name="Map of Volume").wait_for(timeout=60_000)
    assert "Shown: " not in tab.text()


def test_ranges_that_cannot_be_used_are_told_and_change_nothing(tab: Tab) -> None:
    tab.open_tab("Map")
    _set_spans(tab, -90, 90, 5)
    tab.type_into("φ to", "-120")
    tab.wait_for_text("φ must end above where it begins")
    tab.type_into("φ to", "nan")
    tab.wait_for_text("An end of φ: finite numbers")
    tab.type_into("φ to", "")
    tab.wait_for_text("An end of φ is one number")
    tab.page.get_by_role("button", name="Start", exact=True).click()
    tab.type_into("φ to", "45")
    tab.wait(lambda: "one number" not in tab.text(), "ranges that can be used")
    assert "Computing: " not in tab.text()


def test_a_map_covers_the_scene_and_gives_way_to_the_machine(tab: Tab) -> None:
    before = tab.page.viewport_size
    tab.page.set_viewport_size({"width": 1280, "height": 800})
    _run(tab, -20, 20, 5)
    window = tab.page.locator("[data-floating-window]:has(.bo-map)")
    panel = tab.page.locator('[data-dock-region="right"]').bounding_box()
    assert panel is not None

    def box() -> tuple[int, ...]:
        found: Any = window.bounding_box()
        return tuple(round(found[name]) for name in ("x", "y", "width", "height"))

    tab.wait(lambda: box() == (0, 0, round(panel["x"]), 800), "the map in the scene's place")
    plot = _plot(tab)
    tab.wait(lambda: float(str(plot.get_attribute("viewBox")).split()[2]) > 800, "as large")
    low, high = (tab.page.locator(f"path.{name}").count() for name in ("min", "max"))
    assert (low, high) == (1, 1)
    tab.shot("map-whole")
    tab.page.get_by_role("button", name="Smallest", exact=True).click()
    tab.wait(lambda: box() == (0, 380, 420, 420), "the map beside the machine")
    tab.wait(lambda: float(str(plot.get_attribute("viewBox")).split()[2]) < 420, "as small")
    tab.shot("map-folded")
    tab.open_tab("Move")
    tab.wait(lambda: not window.is_visible(), "no map where it is not asked for")
    tab.wait(lambda: abs(tab.value("φ (°)")) == 20.0, "the machine at the least value")
    tab.open_tab("Map")
    tab.page.get_by_role("button", name="Over the scene").click()
    tab.wait(lambda: box()[2] > 800, "the map in the scene's place again")
    assert before is not None
    tab.page.set_viewport_size(before)
