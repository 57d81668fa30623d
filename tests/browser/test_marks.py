"""Marks by a hand: things clicked in the scene, and a presentation by its keys."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from app.review.state import new_review
from app.review.view import view
from kinematics.designs.files import load_design

if TYPE_CHECKING:
    from tests.browser.conftest import Tab

pytestmark = pytest.mark.browser

# From mm to the browser's own axes, whose y is up and whose −z is x; and to the picture, px.
PICTURE = """([x, y, z]) => {
    const { gl, camera } = window.__viserMutable.scene.__r3f.root.getState();
    const seen = camera.position.clone().set(-y, z, -x).project(camera);
    const { clientWidth, clientHeight } = gl.domElement;
    return [(0.5 + 0.5 * seen.x) * clientWidth, (0.5 - 0.5 * seen.y) * clientHeight];
}"""
ABOVE = """() => {
    const { position } = window.__viserMutable.scene.__r3f.root.getState().camera;
    return position.y > position.x;
}"""


def test_a_click_near_joints_measures_between_them(tab: Tab) -> None:
    drawing = view(new_review(load_design("rpur-table1"))).drawing
    places = {mark.name: np.array(mark.position) for mark in drawing.points}
    a, b = places["limb1/A"], places["limb4/A"]
    tab.open_tab("Review")
    tab.open_tab("Marks")
    tab.page.get_by_role("button", name="Measure", exact=True).click()
    tab.wait_for_text("Click thing 1 of 2")
    for place, text in ((a, "A₁"), (b, "A₄")):
        x, y = tab.page.evaluate(PICTURE, place.tolist())
        tab.page.mouse.move(x + 3, y - 3)
        tab.wait(lambda text=text: tab.props("/labels/near")["text"] == text, text)
        tab.page.mouse.down()
        tab.page.mouse.up()
    told = f"{np.linalg.norm(b - a):.2f} mm"
    tab.wait_for_text(told)
    assert tab.props("/labels/dimension0")["text"] == told
    # A drag turns the view, and is no click.
    tab.page.mouse.move(200, 200)
    tab.page.mouse.down()
    tab.page.mouse.move(230, 210, steps=3)
    tab.page.mouse.up()
    assert "So far" not in tab.text()
    tab.page.keyboard.press("Escape")
    tab.wait(lambda: "Click thing" not in tab.text(), "nothing more to choose")
    tab.page.get_by_role("tab", name="Session", exact=True).click()


def test_keys_step_through_a_presentation(tab: Tab) -> None:
    page = tab.page
    tab.open_tab("Review")
    tab.open_tab("Marks")
    for key, name in (("2", "from above"), ("3", "from the front")):
        page.keyboard.press("Escape")
        page.mouse.click(300, 120)
        page.keyboard.press(key)
        page.wait_for_timeout(700)
        tab.type_into("View name", name)
        page.get_by_role("button", name="Keep this view").click()
        page.get_by_role("button", name=f"Show {name}").wait_for()
    text = page.locator(".bo-stage p")
    panel = page.get_by_role("tab", name="Design")
    page.get_by_role("button", name="Present", exact=True).click()
    text.wait_for()
    assert text.inner_text() == "from above"
    assert not panel.is_visible()
    tab.wait(lambda: bool(page.evaluate(ABOVE)), "the camera above")
    page.keyboard.press("ArrowRight")
    tab.wait(lambda: text.inner_text() == "from the front", "the second step")
    page.keyboard.press("ArrowRight")  # it is the last
    tab.wait(lambda: not page.evaluate(ABOVE), "the camera at the front")
    page.keyboard.press("ArrowLeft")
    assert text.inner_text() == "from above"
    tab.wait(lambda: bool(page.evaluate(ABOVE)), "the camera above")
    assert page.evaluate("document.querySelector('canvas').clientWidth") == 900
    page.keyboard.press("Escape")
    panel.wait_for()
    assert not text.count()
    page.get_by_role("tab", name="Session", exact=True).click()
