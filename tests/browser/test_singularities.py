"""The Singularities tab, used as a person uses it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from app.scene import palette
from tests.browser.conftest import Tab

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.browser

WIDE = {"width": 1280, "height": 800}


@pytest.fixture
def control(tab: Tab) -> Iterator[Tab]:
    """The Singularities tab, once the present place has been looked at."""
    before = tab.page.viewport_size
    tab.page.set_viewport_size(WIDE)  # type: ignore[arg-type]
    tab.open_tab("Singularities")
    tab.wait_for_text(r"parallel singularity\s+47\.50 mm")
    yield tab
    assert before is not None
    tab.page.set_viewport_size(before)


def _coats(tab: Tab) -> list[tuple[int, ...]]:
    """The colour of each coat of the aspects that is to be seen."""
    found = [tab.props(f"/solids/aspects/front{n}") for n in range(11)]
    return [tuple(props["color"]) for props in found if props.get("visible")]


def test_the_place_is_told_and_drawn(control: Tab) -> None:
    control.wait_for_text(r"67\.7 mm left of travel \(limb 3, ρ min\) · 47\.5 mm to a sing")
    control.wait_for_text(r"The platform is held")
    control.wait_for_text(r"limb 4, end of the workspace \(ρ min\)\s+66\.29 mm")
    control.check("Wrench lines").click()
    control.check("Nearest limits").click()
    control.wait(lambda: bool(control.props("/control/arrows").get("visible")), "the wrenches")
    control.wait(lambda: bool(control.props("/control/ways").get("visible")), "the ways")
    lines = [control.props(f"/control/wrench{n}").get("visible") for n in range(8)]
    assert lines == [True] * 5 + [False] * 3
    assert control.props("/control/arrows")["points"] == 7 * 2 * 3 * 4  # five forces, one couple
    control.shot("singularities-place")


def test_aspects_are_shown_listed_and_coloured(control: Tab) -> None:
    control.check("Show").click()
    control.wait_for_text(r"1\s+det < 0\s+2\.81\d* dm³\s+[\d.]+\s+the machine is here")
    control.wait_for_text(r"together 6\.00\d* ± [\d.]+ dm³")
    lost = palette.rgb(palette.BEYOND)
    control.wait(lambda: lost in _coats(control), "the singular surface")
    control.wait(lambda: len(set(_coats(control))) >= 4, "pieces in their colours")
    control.check("Singular surface").click()
    control.wait(lambda: lost not in _coats(control), "no singular surface")
    assert len(_coats(control)) >= 3
    control.shot("singularities-aspects")


def test_out_of_reach_the_ways_out_are_told_and_taken(control: Tab) -> None:
    control.open_tab("Move")
    control.type_into("z (mm)", 330)
    control.wait_for_text(r"Not reachable")
    control.open_tab("Singularities")
    control.wait_for_text(r"The ways out")
    control.wait_for_text(r"Or change the design[^§]*1\s+(ρ max|link) of limb 2 from")
    control.page.get_by_role("button", name="Go to that pose").click()
    control.wait_for_text(r"Reachable · mode")
    control.wait(lambda: "The ways out" not in control.text(), "nothing to get out of")
    text = control.wait_for_text(r"limb \d, end of a stroke \(ρ m\w+\)\s+0\.0\d mm")
    assert re.search(r"0\.0", text)


def test_a_ball_without_a_singularity_is_found_and_hidden(control: Tab) -> None:
    control.page.get_by_role("button", name="Find the ball").click()
    control.wait_for_text(r"Radius\s+47\.50 mm")
    control.wait(lambda: bool(control.props("/free/ball").get("visible")), "the ball")
    control.page.get_by_role("button", name="Hide it").click()
    control.wait(lambda: not control.props("/free/ball").get("visible"), "no ball")


def test_what_a_move_passes_is_logged(control: Tab) -> None:
    control.page.get_by_text("What happened on the way").click()
    control.page.get_by_role("button", name="Clear", exact=True).click()
    control.wait_for_text(r"Nothing yet\.")
    control.open_tab("Move")
    control.type_into("z (mm)", 120)  # 30 mm beyond it
    control.open_tab("Singularities")
    control.wait_for_text(r"\d\d:\d\d:\d\d .*parallel singularity")
    control.shot("singularities-log")
