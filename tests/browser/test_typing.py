"""Boxes that people type into: what is typed counts when Enter or leaving the box ends it."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.browser.conftest import Served, Tab

pytestmark = pytest.mark.browser

Open = Callable[[Served], Tab]

HEARD = """
() => {
    if (window.sent) { window.sent = []; return; }
    window.sent = [];
    const send = window.__viserMutable.sendMessage;
    window.__viserMutable.sendMessage = (message) => {
        if (message.type === 'GuiUpdateMessage') window.sent.push(message.updates.value);
        send(message);
    };
}
"""


@pytest.fixture
def heard(tab: Tab) -> Tab:
    """A page that remembers which values it sends."""
    tab.page.evaluate(HEARD)
    return tab


def _sent(tab: Tab) -> list[object]:
    tab.page.wait_for_timeout(400)
    found: list[object] = tab.page.evaluate("window.sent.splice(0)")
    return found


def _write(tab: Tab, label: str, text: str) -> None:
    box = tab.field(label).last
    box.click(click_count=3)
    tab.page.keyboard.type(text, delay=30)


@pytest.mark.parametrize("ending", ["Enter", "Tab"])
def test_a_number_counts_once_when_it_is_complete(heard: Tab, ending: str) -> None:
    _write(heard, "z (mm)", "195")
    assert _sent(heard) == []
    heard.page.keyboard.press(ending)
    assert _sent(heard) == [195]
    assert heard.value("z (mm)") == 195
    heard.open_tab("Review")
    heard.page.get_by_role("button", name="Take back: z 211 → 195 mm", exact=True).click()
    heard.open_tab("Move")
    heard.wait(lambda: heard.value("z (mm)") == 211, "one step of undo")


def test_escape_and_what_is_no_number_change_nothing(heard: Tab) -> None:
    for text, ending in (("19", "Escape"), ("-", "Tab"), ("", "Enter")):
        box = heard.field("z (mm)").last
        box.click(click_count=3)
        heard.page.keyboard.press("Delete")
        heard.page.keyboard.type(text)
        heard.page.keyboard.press(ending)
        assert _sent(heard) == []
        assert heard.value("z (mm)") == 211


def test_nobody_writes_into_a_box_while_one_types(
    heard: Tab, served: Served, open_page: Open
) -> None:
    other = open_page(served)
    _write(heard, "z (mm)", "19")
    other.type_into("z (mm)", 205)
    other.type_into("y (mm)", 70)
    heard.wait(lambda: heard.value("y (mm)") == 70, "the other's y")
    assert heard.field("z (mm)").last.input_value() == "19"
    heard.field("z (mm)").last.press("Escape")
    assert heard.value("z (mm)") == 205
    _write(heard, "z (mm)", "198")
    other.type_into("z (mm)", 204)
    slider = heard.page.get_by_role("slider").nth(2)
    heard.wait(lambda: slider.get_attribute("aria-valuenow") == "204", "the other's z")
    heard.field("z (mm)").last.press("Enter")
    other.wait(lambda: other.value("z (mm)") == 198, "the last word")
    assert heard.value("z (mm)") == 198


def test_a_place_beyond_the_slider_is_asked_for_and_answered(heard: Tab) -> None:
    heard.type_into("x (mm)", 600)
    heard.wait_for_text("Not reachable")
    heard.open_tab("Solutions")
    heard.open_tab("Move")
    assert heard.value("x (mm)") == 600
    heard.field("y (mm)").last.click()
    heard.page.wait_for_timeout(400)
    assert heard.value("x (mm)") == 600


def test_arrow_keys_step_from_what_was_typed(heard: Tab) -> None:
    _write(heard, "z (mm)", "200")
    heard.page.keyboard.press("ArrowUp")
    assert _sent(heard) == [200, 200.1]


def test_text_counts_when_it_is_left(heard: Tab) -> None:
    heard.open_tab("Move")
    _write(heard, "As text", "300, 73, 211, 0, 0")
    assert _sent(heard) == []
    heard.page.keyboard.press("Enter")
    assert _sent(heard) == ["300, 73, 211, 0, 0"]
