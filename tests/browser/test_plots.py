"""Plots of every kind: looked at closely, copied, and read as tables; with mouse and keyboard."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import pytest

from tests.browser.conftest import Tab

if TYPE_CHECKING:
    from playwright.sync_api import Locator

pytestmark = pytest.mark.browser

NAME = "Area of the section"


def _area(tab: Tab) -> Locator:
    tab.open_tab("Section")
    found = tab.page.get_by_role("img", name=NAME).locator("visible=true")
    found.wait_for(timeout=60_000)
    found.scroll_into_view_if_needed()
    return found


def _span(plot: Locator) -> tuple[float, float]:
    """From and to of the first axis."""
    low, high = str(plot.get_attribute("data-box")).split()[4:6]
    return float(low), float(high)


def _place(plot: Locator, u: float) -> tuple[float, float]:
    """A place on the page at a share of the plot's width."""
    box: Any = plot.bounding_box()
    left, top, wide, high = map(float, str(plot.get_attribute("data-box")).split()[:4])
    scale = box["width"] / float(str(plot.get_attribute("viewBox")).split()[2])
    return box["x"] + scale * (left + u * wide), box["y"] + scale * (top + 0.5 * high)


def test_a_plot_is_zoomed_and_shown_whole_again(tab: Tab) -> None:
    plot, mouse = _area(tab), tab.page.mouse
    whole = _span(plot)
    at = tab.value("x′ (mm)")
    tab.page.keyboard.down("Shift")
    mouse.move(*_place(plot, 0.25))
    mouse.down()
    mouse.move(*_place(plot, 0.5), steps=4)
    mouse.move(*_place(plot, 0.75))
    mouse.up()
    wide = whole[1] - whole[0]
    expected = whole[0] + 0.25 * wide, whole[0] + 0.75 * wide
    tab.wait(lambda: _span(plot) == pytest.approx(expected, abs=0.01 * wide), "the chosen part")
    before = _span(plot)
    mouse.move(*_place(plot, 0.5))
    mouse.wheel(0, -300)
    tab.page.keyboard.up("Shift")
    size = before[1] - before[0]
    tab.wait(lambda: _span(plot)[1] - _span(plot)[0] < 0.8 * size, "a smaller part")
    middle = 0.5 * sum(before)
    assert 0.5 * sum(_span(plot)) == pytest.approx(middle, abs=0.01 * size)
    assert tab.value("x′ (mm)") == at  # looking moves nothing
    tab.page.get_by_role("button", name="Whole").locator("visible=true").click()
    tab.wait(lambda: _span(plot) == whole, "the whole")


def test_the_wheel_alone_scrolls_the_panel(tab: Tab) -> None:
    plot = _area(tab)
    whole = _span(plot)
    tab.page.mouse.move(*_place(plot, 0.5))
    tab.page.mouse.wheel(0, -120)
    tab.page.wait_for_timeout(400)
    assert _span(plot) == whole


def test_a_plot_is_copied_as_a_picture_of_its_own(tab: Tab) -> None:
    tab.context.grant_permissions(["clipboard-read", "clipboard-write"])
    plot = _area(tab)
    frame = plot.locator("xpath=..")
    frame.get_by_role("button", name="Copy").click()
    frame.get_by_role("button", name="Copied").wait_for(timeout=10_000)
    text = str(tab.page.evaluate("navigator.clipboard.readText()"))
    root = ElementTree.fromstring(text)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert float(root.get("width", "")) > 300
    assert "var(" not in text  # no style sheet goes with it
    assert "data-" not in text
    told = [each.text for each in root.iter("{http://www.w3.org/2000/svg}text")]
    assert "Area along x′" in told
    assert root.findall(".//*[@class='cursor']")  # and what lies over the drawing


def test_the_numbers_are_reached_with_the_keyboard(tab: Tab) -> None:
    plot = _area(tab)
    high: Any = plot.bounding_box()
    button = plot.locator("xpath=..").get_by_role("button", name="Table")
    button.focus()
    tab.page.keyboard.press("Enter")
    table = tab.page.get_by_role("region", name=f"{NAME}, table")
    table.wait_for(timeout=10_000)
    heads = table.get_by_role("columnheader").all_inner_texts()
    assert heads == ["x′ (mm)", "area (cm²)"]
    assert table.get_by_role("row").count() == 26
    box: Any = table.bounding_box()
    assert box["height"] == pytest.approx(high["height"], abs=1.0)  # nothing moves
    tab.page.get_by_role("button", name="Plot", exact=True).locator("visible=true").click()
    plot.wait_for(timeout=10_000)
