"""The Solutions tab, used as a person uses it, in a headless Chromium."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from tests.browser.conftest import Tab

if TYPE_CHECKING:
    from playwright.sync_api import Locator

pytestmark = pytest.mark.browser

COUNT = r"(\d+) real (?:\(\d+ distinct\) )?of (\d+) complex solutions"


def _rows(tab: Tab) -> Locator:
    return tab.page.locator("tr.sol").locator("visible=true")


def _said(tab: Tab) -> list[str]:
    """What the rows say, from the first one on."""
    found = _rows(tab).evaluate_all("rows => rows.map((row) => row.getAttribute('aria-label'))")
    return [str(text) for text in found]


def _count(tab: Tab) -> tuple[int, int]:
    """The real and the complex solutions, once they are those of the present lengths."""
    tab.open_tab("Solutions")
    tab.wait(
        lambda: (
            re.search(COUNT, tab.text()) is not None
            and "for the lengths before" not in tab.text()
            and _rows(tab).first.is_visible()
        ),
        "the solutions of the present lengths",
    )
    found = re.search(COUNT, tab.text())
    assert found is not None
    return int(found[1]), int(found[2])


def _numbers(row: str) -> list[float]:
    """x, y, z, φ and θ of a row."""
    found = re.search(r"x (\S+) y (\S+) z (\S+) mm φ (\S+)° θ (\S+)°", row)
    assert found is not None, row
    return [float(v.replace("−", "-")) for v in found.groups()]


def _pose(tab: Tab) -> list[float]:
    return [tab.value(label) for label in ("x (mm)", "y (mm)", "z (mm)", "φ (°)", "θ (°)")]


def _places(tab: Tab, node: str) -> list[float]:
    """Where the copies of a batched mesh stand."""
    places: list[float] = tab.page.evaluate(
        "node => Array.from(window.__viserSceneTree.getState()[node]"
        ".message.props.batched_positions)",
        node,
    )
    return places


def test_all_solutions_are_counted_listed_filtered_and_sorted(tab: Tab) -> None:
    _count(tab)
    tab.wait_for_text(r"complete ✓[\s\S]*count and conjugation closure hold")
    more = tab.page.get_by_role("button", name=re.compile(r"Show \d+ of \d+ more"))
    shown = 0

    def listed() -> bool:
        """As many as are counted, doubles in one row; a list may still be that of before."""
        nonlocal shown
        shown = _rows(tab).count()
        left = int(more.inner_text().split()[-2])
        return abs(shown + left - _count(tab)[0]) <= 2

    tab.wait(listed, "a list of all that are counted")
    _, complex_count = _count(tab)
    assert complex_count == 1560
    more.click()
    tab.wait(lambda: _rows(tab).count() > shown, "more rows")
    assert "The present solution" in _said(tab)[0]
    heights = [_numbers(text)[2] for text in _said(tab)]
    assert heights != sorted(heights, reverse=True)
    tab.page.locator('[data-send="sort height"]').click()

    def sorted_now() -> bool:
        now = [_numbers(text)[2] for text in _said(tab)]
        return now == sorted(now, reverse=True)

    tab.wait(sorted_now, "the list by height")
    tab.unfold("Which are listed")
    tab.choose("Of", "A pattern")
    tab.type_into("Pattern", "+????")

    def modes() -> set[str]:
        return {re.findall(r"mode ([+−]+)", t)[0] for t in _said(tab)}

    tab.wait(
        lambda: len(found := modes()) > 1 and all(mode[0] == "+" for mode in found),
        "several modes, limb 1 on + in all of them",
    )
    tab.page.locator('[data-send="only mode"]').click()
    tab.wait(lambda: len(modes()) == 1, "only the present mode")


def test_a_click_puts_the_machine_there_and_undo_brings_it_back(tab: Tab) -> None:
    tab.open_tab("Move")
    before, machine = _pose(tab), _places(tab, "/machine/bars")
    lengths = [tab.value(f"ρ{s} (mm)") for s in "₁₂₃₄₅"]
    _count(tab)
    goal = _numbers(_said(tab)[2])
    _rows(tab).nth(2).focus()
    tab.page.keyboard.press("Enter")  # as a button, it needs no mouse
    tab.wait(
        lambda: "The present solution" in (text := _said(tab)[0]) and _numbers(text) == goal,
        "the present solution is the chosen one",
    )
    tab.open_tab("Move")
    tab.wait(lambda: _pose(tab) == pytest.approx(goal, abs=0.051), "the pose of the solution")
    assert [tab.value(f"ρ{s} (mm)") for s in "₁₂₃₄₅"] == pytest.approx(lengths, abs=0.051)
    tab.wait_for_text("Reachable")
    tab.wait(lambda: _places(tab, "/machine/bars") != machine, "the machine there")
    tab.open_tab("Review")
    tab.page.get_by_role("button", name="Undo").click()
    tab.open_tab("Move")
    tab.wait(lambda: _pose(tab) == pytest.approx(before, abs=0.051), "the pose before")
    tab.wait(lambda: _places(tab, "/machine/bars") == machine, "the machine before")


def test_ghosts_are_shown_and_follow_the_actuators(tab: Tab) -> None:
    _count(tab)
    tab.check("Ghosts").click()
    tab.wait(lambda: "other solutions" in tab.text(), "the ghosts' colour in the legend")
    tab.wait(lambda: any(_places(tab, "/ghosts/edges")), "ghosts in the scene")
    before = _places(tab, "/ghosts/edges")
    tab.open_tab("Move")
    rho = tab.value("ρ₁ (mm)")
    tab.type_into("ρ₁ (mm)", rho + 15)
    tab.wait(lambda: tab.value("ρ₁ (mm)") == pytest.approx(rho + 15, abs=0.06), "a longer ρ₁")
    _count(tab)
    tab.wait(lambda: _places(tab, "/ghosts/edges") != before, "other ghosts")
    tab.wait_for_text(r"(?:appeared|merged) on the way: #\d+")


def test_the_fold_ahead_is_told_and_can_be_driven_to(tab: Tab) -> None:
    _count(tab)
    tab.unfold("Fold ahead")
    text = tab.wait_for_text(r"(?:Raising|Lowering) ρ[₁-₅] by [\d.]+ mm, to [\d.]+ mm")
    found = re.search(r"(ρ[₁-₅]) by [\d.]+ mm, to ([\d.]+)", text)
    assert found is not None
    tab.page.get_by_role("button", name="Drive to the fold").click()
    tab.open_tab("Move")
    label, goal = f"{found[1]} (mm)", float(found[2])
    tab.wait(lambda: abs(tab.value(label) - goal) < 0.3, "the actuator at the fold")
