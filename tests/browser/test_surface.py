"""The Workspace tab: what its solid is made of, and dropdowns that follow undo."""

from __future__ import annotations

import pytest

from tests.browser.conftest import Tab

pytestmark = pytest.mark.browser


def _undo(tab: Tab) -> None:
    tab.page.wait_for_timeout(300)
    tab.page.mouse.click(12, 330)  # a hotkey goes to the page, not to a box
    tab.page.keyboard.press("Control+z")


def test_the_true_surface_is_shown_told_and_taken_back(tab: Tab) -> None:
    tab.open_tab("Workspace")
    tab.wait_for_text("mesh: (normal|fine)")
    tab.wait_for_text("facets, right on the average")
    before = tab.props("/solids/workspace/front0")["vertices"]
    tab.unfold("Look")
    tab.choose("Made of", "The true surface")
    tab.wait_for_text("true: vertices within")
    tab.wait(lambda: tab.props("/solids/workspace/front0")["vertices"] > before, "more vertices")
    _undo(tab)
    tab.wait(lambda: tab.field("Made of").first.input_value() == "Facets", "facets again")
    tab.wait_for_text("facets, right on the average")


def test_the_choice_of_modes_follows_undo(tab: Tab) -> None:
    tab.open_tab("Workspace")
    tab.choose("Of", "A chosen set")
    tab.wait(lambda: tab.page.get_by_text("Modes", exact=True).is_visible(), "the set of modes")
    _undo(tab)
    tab.wait(lambda: tab.field("Of").first.input_value() == "The current working mode", "the mode")
    assert not tab.page.get_by_text("Modes", exact=True).is_visible()
