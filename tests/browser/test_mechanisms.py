"""The other mechanisms on the page, each used as a person uses it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from app.review import session
from app.review.state import new_review
from kinematics.designs.files import load_design
from tests.browser.conftest import Tab

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from playwright.sync_api import Locator

pytestmark = pytest.mark.browser

WIDE = {"width": 1280, "height": 800}
TABS = ["Move", "Solutions", "Workspace", "Singularities", "Trajectory", "Design", "Review"]


@pytest.fixture
def machine(tab: Tab, tmp_path: Path) -> Iterator[Callable[[str, str], Tab]]:
    """The one page on another design, once this text stands there."""
    before = tab.page.viewport_size
    tab.page.set_viewport_size(WIDE)  # type: ignore[arg-type]

    def start(name: str, pattern: str) -> Tab:
        file = tmp_path / f"{name}.json"
        session.save(new_review(load_design(name)), file)
        tab.upload("Review", "Open a session file", file)
        tab.wait_for_text(pattern)
        tab.wait(lambda: tab.page.get_by_role("tab", name="Map").count() == 0, "other tabs")
        return tab

    yield start
    assert before is not None
    tab.page.set_viewport_size(before)


def _chosen(tab: Tab) -> str:
    """The operation mode whose button is pressed."""
    return tab.page.locator(".bo-modes [aria-pressed=true]").inner_text()


def _tabs(tab: Tab) -> list[str]:
    return [title for title in tab.page.get_by_role("tab").all_inner_texts() if title in TABS]


def _plot(tab: Tab, index: int = 0) -> Locator:
    found = tab.page.locator(".plot svg[data-box]").locator("visible=true").nth(index)
    found.wait_for(timeout=60_000)
    found.scroll_into_view_if_needed()
    return found


def _click(tab: Tab, plot: Locator, x: float, y: float) -> None:
    """Click on a place of a plot, in its units."""
    box: Any = plot.bounding_box()
    numbers = [float(v) for v in str(plot.get_attribute("data-box")).split()]
    left, top, wide, high, x0, x1, y0, y1 = numbers
    scale = box["width"] / float(str(plot.get_attribute("viewBox")).split()[2])
    tab.page.mouse.click(
        box["x"] + scale * (left + wide * (x - x0) / (x1 - x0)),
        box["y"] + scale * (top + high * (y1 - y) / (y1 - y0)),
    )


def _moves(tab: Tab, coordinate: str, value: float, joint: str, step: float) -> None:
    """By a coordinate of the pose, and by an actuator; the one follows the other."""
    tab.open_tab("Move")
    before = tab.value(joint)
    tab.type_into(coordinate, value)
    tab.wait(lambda: tab.value(joint) != before, f"{joint} follows {coordinate}")
    assert tab.value(coordinate) == value
    driven = tab.value(joint) + step
    tab.type_into(joint, driven)
    tab.wait(lambda: tab.value(coordinate) != value, f"{coordinate} follows {joint}")
    assert tab.value(joint) == pytest.approx(driven, abs=0.06)
    tab.wait_for_text("Reachable")


@pytest.mark.parametrize(
    ("name", "other"), [("rps-3", "3-SPR"), pytest.param("spr-3", "3-RPS", marks=pytest.mark.slow)]
)
def test_a_tripod(machine: Callable[[str, str], Tab], name: str, other: str) -> None:
    tab = machine(name, "Reachable · operation mode 2")
    tab.wait(lambda: _tabs(tab) == TABS, "its tabs")
    _moves(tab, "θ (°)", 8.0, "ρ₂ (mm)", -2.0)
    # Another operation mode only where both meet.
    tab.page.get_by_role("button", name="operation mode 1").click()
    tab.wait_for_text(r"Operation mode 1 begins at a tilt of 180°")
    tab.wait_for_text("Reachable · operation mode 2")
    tab.page.get_by_role("button", name="Go where modes meet").click()
    tab.wait(lambda: abs(tab.value("θ (°)") - 180.0) < 0.06, "a tilt of 180°")
    tab.wait(lambda: _chosen(tab) == "operation mode 2", "still mode 2")
    tab.page.get_by_role("button", name="operation mode 1").click()
    tab.wait_for_text("eachable · operation mode 1")
    tab.page.get_by_role("button", name="Home position").click()
    tab.wait_for_text("Reachable · operation mode 2")
    # The polar chart, with the inscribed circle, alone and beside the other machine's.
    tab.open_tab("Singularities")
    tab.choose("Chart", "Singular orientations at this altitude")
    circles = tab.page.locator("circle.micr").locator("visible=true")
    tab.wait(lambda: circles.count() == 1, "the inscribed circle")
    tab.wait_for_text(r"\d curves?, every point exact to")
    _click(tab, _plot(tab), 4.0, 3.0)
    tab.open_tab("Move")
    tab.wait(lambda: abs(tab.value("θ (°)") - 5.0) < 0.6, "the tilt that was pointed at")
    assert tab.value("φ (°)") == pytest.approx(36.9, abs=6.0)
    tab.open_tab("Singularities")
    tab.check(f"Beside the {other}").click()
    tab.wait(lambda: circles.count() == 2, "both circles")
    tab.wait_for_text(rf"{other}\s+Conditioning|Circle to a singularity")
    tab.wait(lambda: bool(tab.props("/machine/other base").get("visible")), "the other machine")
    tab.shot(f"mechanisms-{name}")
    tab.check(f"Beside the {other}").click()
    tab.wait(lambda: not tab.props("/machine/other base").get("visible"), "one machine")


def test_the_4_sps_spr(machine: Callable[[str, str], Tab]) -> None:
    tab = machine("sps-spr", r"Reachable · [\d.]+ mm left of travel")
    tab.wait(lambda: _tabs(tab) == TABS, "its tabs")
    tab.open_tab("Move")
    labels = ["x (mm)", "y (mm)", "z (mm)", "α (°)", "β (°)", "γ (°)"]
    tab.choose("Gives way", "y")
    before = [tab.value(label) for label in labels]
    tab.type_into("β (°)", 10)
    tab.wait(lambda: tab.value("y (mm)") != before[1], "y gives way")
    after = [tab.value(label) for label in labels]
    assert [n for n in range(6) if after[n] != before[n]] == [1, 4]
    tab.wait_for_text(r"loop closure to [\d]e-1\d mm")
    _moves(tab, "z (mm)", 600.0, "l₁ (mm)", 3.0)
    tab.open_tab("Singularities")
    tab.page.get_by_text("Load on the platform", exact=True).click()
    tab.check("Arrow to drag").click()
    tab.check("Forces on the limbs").click()
    tab.wait(lambda: bool(tab.props("/control/tip").get("visible")), "the arrow")
    tab.wait(lambda: bool(tab.props("/control/forces").get("visible")), "the forces")
    tab.wait_for_text(r"F₁\s+−?[\d.]+ N\s")
    tab.wait_for_text(r"Fτ\s+−?[\d.e−]+ N")
    labelled = [n for n in range(8) if tab.props(f"/control/labels/force{n}").get("visible")]
    assert len(labelled) >= 5
    tab.shot("mechanisms-sps-spr")


def test_the_five_bar(machine: Callable[[str, str], Tab]) -> None:
    tab = machine("five-bar", r"Reachable · mode \+−")
    tab.wait(lambda: _tabs(tab) == TABS, "its tabs")
    _moves(tab, "x (mm)", 40.0, "θ₁ (°)", 1.0)
    tab.wait(lambda: bool(tab.props("/regions/fill0").get("visible")), "the workspace")
    tab.open_tab("Workspace")
    tab.wait_for_text(r"19[,. ]?83\d(\.\d)? cm²")
    fills = [f"/regions/fill{n}" for n in range(12)]

    def seen() -> int:
        return sum(bool(tab.props(fill).get("visible")) for fill in fills)

    assert seen() == 1
    tab.choose("Regions", "Aspects")
    tab.wait(lambda: seen() > 2, "the aspects")
    tab.wait(lambda: bool(tab.props("/regions/locus").get("visible")), "where control is lost")
    tab.open_tab("Singularities")
    tab.choose("Chart", "Singularities of the working mode")
    tab.wait_for_text(r"\d curves?, every point exact to")
    _click(tab, _plot(tab), -100.0, 700.0)
    tab.open_tab("Move")
    tab.wait(lambda: abs(tab.value("x (mm)") + 100.0) < 8.0, "the place that was pointed at")
    assert tab.value("y (mm)") == pytest.approx(700.0, abs=8.0)
    tab.shot("mechanisms-five-bar")


def test_the_design_is_changed_on_the_page_and_back(tab: Tab) -> None:
    tab.open_tab("Design")
    tab.choose("Design", "five-bar", -1)  # the first is the tab's own name
    tab.wait_for_text(r"Reachable · mode \+−\s")
    tab.wait(lambda: bool(tab.props("/regions/fill0").get("visible")), "its plane")
    tab.open_tab("Review")
    tab.page.get_by_role("button", name="Undo").click()
    tab.wait_for_text(r"Reachable · mode \+−\+−\+")
    tab.wait(lambda: not tab.props("/regions/fill0"), "no plane any more")
    tab.wait(lambda: bool(tab.props("/solids/workspace").get("visible")), "the workspace again")


def test_another_machine_stands_as_it_should_and_undo_goes_back(tab: Tab) -> None:
    tab.type_into("φ (°)", 25)
    tab.wait(lambda: abs(tab.props("/machine/platform")["wxyz"][0]) < 0.99, "a turned platform")
    tab.open_tab("Design")
    tab.choose("Design", "rps-3", -1)
    tab.wait_for_text("operation mode 2")
    for node in ("/machine/platform", "/handle"):
        tab.wait(
            lambda node=node: tab.props(node)["wxyz"] == pytest.approx([1, 0, 0, 0], abs=1e-6),
            f"{node} level",
        )
    tab.page.mouse.click(12, 330)
    tab.page.keyboard.press("Control+z")
    tab.wait_for_text("mode \\+−\\+−\\+")
    tab.wait(lambda: abs(tab.props("/machine/platform")["wxyz"][0]) < 0.99, "turned again")
    assert "Something went wrong" not in tab.text()
