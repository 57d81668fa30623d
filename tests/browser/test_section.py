"""The Section tab and the measures of the workspace, used as a person uses them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import pytest

from tests.browser.conftest import Tab

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from playwright.sync_api import Locator

pytestmark = pytest.mark.browser

AT = "x′ (mm)"
WIDE = {"width": 1280, "height": 800}  # the plot's window beside the machine


@pytest.fixture
def section(tab: Tab) -> Iterator[Tab]:
    """The Section tab with the section of every mode together on display."""
    before = tab.page.viewport_size
    tab.page.set_viewport_size(WIDE)  # type: ignore[arg-type]
    tab.open_tab("Workspace")
    tab.field("Of").first.click()
    tab.page.get_by_role("option", name="All working modes together", exact=True).click()
    tab.open_tab("Section")
    tab.check("Show the section").click()
    tab.wait_for_text(r"Perimeter\s+[\d.]+ mm")
    yield tab
    assert before is not None
    tab.page.set_viewport_size(before)


def _plot(tab: Tab) -> Locator:
    """The profile of areas, once it is there."""
    found = tab.page.get_by_role("img", name="Area of the section").locator("visible=true")
    found.first.wait_for(timeout=60_000)
    found.first.scroll_into_view_if_needed()
    return found.first


def _place(plot: Locator, x: float) -> tuple[float, float]:
    """Where on the page the profile shows an x′."""
    box: Any = plot.bounding_box()
    left, top, wide, high, low, end, *_ = map(float, str(plot.get_attribute("data-box")).split())
    scale = box["width"] / float(str(plot.get_attribute("viewBox")).split()[2])
    return (
        box["x"] + scale * (left + wide * (x - low) / (end - low)),
        box["y"] + scale * (top + 0.5 * high),
    )


def _edges(tab: Tab) -> dict[int, int]:
    """How many bytes of edges of each limb the scene shows."""
    found = {n: tab.props(f"/section/edges{n}") for n in range(1, 6)}
    return {n: props["points"] for n, props in found.items() if props.get("visible")}


def _arrow(tab: Tab) -> float:
    """The x′ at which the plane's arrow stands in the scene."""
    return float(tab.props("/section/handle")["position"][0])


def test_the_section_is_drawn_in_the_scene_as_a_plot_and_in_numbers(section: Tab) -> None:
    section.type_into(AT, 50)
    section.wait_for_text(r"Area\s+463\.2 cm²")
    section.wait_for_text(r"4 pieces, 4 loops")
    section.wait(lambda: bool(_edges(section)), "edges in the scene")
    assert section.props("/section/cap")["vertices"] > 1000
    assert section.props("/section/cap")["visible"]
    assert section.props("/section")["visible"]
    drawn = section.page.locator("svg[role=img] path.edge").locator("visible=true")
    classes = {str(edge.get_attribute("class")) for edge in drawn.all()}
    assert {f"limb{n}" for n in _edges(section)} == {name.split()[1] for name in classes}
    assert section.page.locator("path.made").locator("visible=true").count() > 10
    section.shot("section-plot")


def test_the_plane_goes_where_the_slider_the_arrow_and_typing_put_it(section: Tab) -> None:
    section.type_into(AT, 50)
    section.wait_for_text(r"Area\s+463\.2 cm²")
    slider = section.page.get_by_role("slider").locator("visible=true").first
    slider.focus()
    for _ in range(5):
        slider.press("ArrowRight")
        section.page.wait_for_timeout(60)
    section.wait(lambda: abs(section.value(AT) - 50.5) < 0.01, "x′ = 50.5")
    section.wait(
        lambda: abs(section.props("/section/handle")["position"][0] - 50.5) < 0.01, "arrow"
    )
    section.wait(lambda: "463.2 cm²" not in section.text(), "another area")
    section.type_into(AT, 50.1234)
    section.wait_for_text(r"Cut at\s+x′ = 50\.1234 mm")
    section.type_into(AT, "abc")
    section.wait(lambda: section.field(AT).last.input_value() == "50.1234", "the number again")
    section.type_into(AT, 1200)
    section.wait_for_text(
        r"The section is empty here; the workspace lies within x′ = −200 … 395 mm"
    )
    section.page.get_by_role("button", name="Through O′", exact=True).click()
    section.wait_for_text(r"Perimeter\s+[\d.]+ mm")
    section.wait(lambda: section.page.locator("path.mark").count() == 1, "the platform's cross")


def test_dragging_in_the_profile_moves_the_plane(section: Tab) -> None:
    plot = _plot(section)
    mouse = section.page.mouse
    mouse.move(*_place(plot, -100.0))
    told = str(plot.locator(".tip").text_content())
    found = re.fullmatch(r"x′ = (−[\d.]+) mm: ([\d.]+) cm²", told)
    assert found is not None, told
    assert float(found[1].replace("−", "-")) == pytest.approx(-100.0, abs=3.0)
    mouse.down()
    told_at = float(found[1].replace("−", "-"))
    section.wait(lambda: section.value(AT) == told_at, "the plane where the tip tells")
    wanted = pytest.approx(float(found[2]), rel=2e-3)
    section.wait(
        lambda: float(section.wait_for_text(r"Area\s+[\d.]+ cm²").split()[1]) == wanted, "its area"
    )
    for x in range(-50, 201, 25):
        mouse.move(*_place(plot, float(x)))
        section.page.wait_for_timeout(70)
    mouse.up()
    section.wait(lambda: abs(section.value(AT) - 200.0) < 2.0, "the plane where the hand let go")
    section.wait_for_text(r"Perimeter\s+[\d.]+ mm")


def test_the_section_is_saved_as_it_is_shown(section: Tab, tmp_path: Path) -> None:
    section.type_into(AT, 50)
    section.wait_for_text(r"Area\s+463\.2 cm²")
    with section.page.expect_download(timeout=60_000) as started:
        section.page.get_by_role("button", name="SVG", exact=True).locator("visible=true").click()
    path = tmp_path / started.value.suggested_filename
    started.value.save_as(path)
    assert path.name == "rpur-table1_section_phi0_theta0_at50.svg"
    root = ElementTree.parse(path).getroot()
    assert root.tag.endswith("svg")
    with section.page.expect_download(timeout=60_000) as started:
        section.page.get_by_role("button", name="CSV", exact=True).locator("visible=true").click()
    started.value.save_as(tmp_path / "section.csv")
    rows = (tmp_path / "section.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) > 12


def test_the_exact_volume_stands_beside_that_of_the_solid(tab: Tab) -> None:
    tab.open_tab("Workspace")
    tab.wait_for_text(r"6\.001738 ± 0\.00000\d dm³, exact")  # of its mode
    exact = tab.page.locator("[title*='6 001 738 ± ']").first
    assert "mm³" in str(exact.get_attribute("title"))
    tab.wait_for_text(r"mesh: fine, .*, [+−][\d.e−]+ % beside the exact volume")
    tab.field("Of").first.click()
    tab.page.get_by_role("option", name="All working modes together", exact=True).click()
    tab.wait_for_text(r"24\.50\d+ ± 0\.0000\d+ dm³, exact")


def test_the_largest_ball_is_found_shown_and_gone_to(tab: Tab) -> None:
    tab.open_tab("Workspace")
    tab.wait_for_text("dm³, exact")
    tab.page.get_by_role("button", name="Largest ball").click()
    text = tab.wait_for_text(r"Ball: radius [\d.]+ mm about [\d., −-]+ mm")
    numbers = [float(v) for v in re.findall(r"-?\d+\.?\d*", text.replace("−", "-"))]
    tab.wait(lambda: bool(tab.props("/inside/ball").get("visible")), "the ball in the scene")
    assert tab.props("/inside/ball")["position"] == pytest.approx(numbers[1:4], abs=0.06)
    tab.page.get_by_role("button", name="Platform to the ball's centre").click()
    tab.open_tab("Move")
    labels = ("x (mm)", "y (mm)", "z (mm)")
    tab.wait(
        lambda: [tab.value(label) for label in labels] == pytest.approx(numbers[1:4], abs=0.11),
        "the platform in the ball's centre",
    )
    tab.wait_for_text("Reachable · mode")
    tab.type_into("φ (°)", 20)  # another workspace: the ball is not of it
    tab.wait(lambda: not tab.props("/inside/ball").get("visible"), "no ball")


def test_an_empty_state_has_one_sentence_and_one_button(tab: Tab) -> None:
    before = tab.page.viewport_size
    tab.page.set_viewport_size(WIDE)  # type: ignore[arg-type]
    tab.open_tab("Section")
    tab.wait_for_text("No section yet")
    window = tab.page.locator("[data-floating-window]:has(.bo-cut)")
    assert window.count() == 0
    tab.page.get_by_role("button", name="Cut through O′").click()
    tab.wait_for_text(r"Perimeter\s+[\d.]+ mm")
    tab.wait(lambda: tab.page.locator("path.mark").count() == 1, "the platform's cross")
    box: Any = window.bounding_box()
    assert (box["x"], round(box["y"] + box["height"])) == (0.0, 800)
    assert (round(box["width"]), round(box["height"])) == (384, 505)
    assert not tab.page.get_by_role("button", name="Cut through O′").is_visible()
    tab.page.get_by_role("button", name="At the largest area").click()
    told = tab.wait_for_text(r"max [\d.]+ at −?\d[\d.]* mm")
    wanted = float(told.split()[-2].replace("−", "-"))
    tab.wait(lambda: tab.value(AT) == pytest.approx(wanted, abs=0.06), "the plane there")
    assert before is not None
    tab.page.set_viewport_size(before)


@pytest.mark.parametrize("share", [0.3, 0.7])
def test_a_drawing_is_true_to_scale_at_every_zoom(section: Tab, share: float) -> None:
    plot = section.page.get_by_role("img", name="Section at").locator("visible=true")
    plot.wait_for()
    section.wait(lambda: float(str(plot.get_attribute("viewBox")).split()[2]) < 384, "its room")

    def scales() -> tuple[float, float]:
        _, _, wide, high, *ends = map(float, str(plot.get_attribute("data-box")).split())
        return wide / (ends[1] - ends[0]), high / (ends[3] - ends[2])

    across, up = scales()
    assert across == pytest.approx(up)
    box: Any = plot.bounding_box()
    section.page.mouse.move(box["x"] + share * box["width"], box["y"] + share * box["height"])
    section.page.mouse.wheel(0, -300)  # in a window over the scene nothing scrolls
    section.wait(lambda: scales()[0] > 1.3 * across, "a part of it")
    across, up = scales()
    assert across == pytest.approx(up)
    bar = section.page.locator("path.bar").get_attribute("d")
    length = float(str(bar).split("h")[1])
    said = str(section.page.locator("text.bar").text_content())
    assert length == pytest.approx(across * float(said.removesuffix(" mm")), rel=1e-3)
    section.page.mouse.dblclick(box["x"] + 100, box["y"] + 60)
    section.wait(lambda: scales()[0] < across / 1.3, "the whole")
