"""A report in a browser without a network: the scene turns, both themes, paper, and accessibility
as axe-core judges it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from app.features.marks.model import Anchor, Dimension, Note, SavedView, looks_of
from app.features.marks.state import Marks
from app.features.report.compute import Depth, gather
from app.features.report.make import report_of, written
from app.features.trajectory.state import Plan
from app.review.state import new_review
from app.scene.camera import Camera
from kinematics.designs.files import load_design
from tests.browser.conftest import CALM

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser
RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"]}
# How many colours the scene has, drawn now: a picture that is not kept can only be read at once.
COLOURS = """() => {
  const canvas = document.querySelector("canvas"), copy = document.createElement("canvas");
  copy.width = canvas.width; copy.height = canvas.height;
  return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
    const to = copy.getContext("2d");
    to.drawImage(canvas, 0, 0);
    const all = to.getImageData(0, 0, copy.width, copy.height).data, seen = new Set();
    for (let n = 0; n < all.length; n += 4 * 7) seen.add(all.slice(n, n + 3).join());
    done(seen.size);
  })));
}"""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of the five-bar with its trajectory, and of a tripod: two designs in one file."""
    first = new_review(load_design("five-bar"))
    camera = Camera((0.0, 0.0, 3000.0), (0.0, 400.0, 0.0), (0.0, 1.0, 0.0), 0.5)
    elbow = Anchor("point", "limb1/B")
    marks = Marks(
        (SavedView("From afar", camera, looks_of(first)),),
        (Note("close to the rail", first.pose, first.mode, elbow),),
        (Dimension("", (elbow, Anchor("point", "P"))),),
    )
    first = first.having(replace(first[Plan], on=True, samples=21), marks)
    found = [gather(r, Depth("preview", 0)) for r in (first, new_review(load_design("spr-3")))]
    place = tmp_path_factory.mktemp("report") / "review.html"
    place.write_bytes(written(report_of(found, datetime(2026, 12, 1, tzinfo=UTC)), "html").data)
    return place


@pytest.fixture
def opened(browser: Browser, file: Path) -> Iterator[Callable[..., Page]]:
    """Opens the report; at the end nothing was asked for but the file, and nothing went wrong."""
    asked: list[str] = []
    wrong: list[str] = []
    contexts = []

    def open_(scheme: str = "light") -> Page:
        context = browser.new_context(
            offline=True,
            color_scheme=scheme,  # type: ignore[arg-type]
            viewport={"width": 640, "height": 480},
        )
        contexts.append(context)
        context.add_init_script(CALM)
        page = context.new_page()
        page.on("request", lambda request: asked.append(request.url))
        page.on("console", lambda message: wrong.append(message.text))
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.goto(file.as_uri())
        return page

    yield open_
    for context in contexts:
        context.close()
    assert set(asked) == {file.as_uri()}
    assert wrong == []


@pytest.mark.parametrize("scheme", ["light", pytest.param("dark", marks=pytest.mark.slow)])
def test_a_report_is_accessible(opened: Callable[..., Page], scheme: str) -> None:
    from axe_playwright_python.sync_playwright import Axe

    page = opened(scheme)
    found = Axe().run(page, options={**RULES, "resultTypes": ["violations"]})
    assert found.violations_count == 0, found.generate_report()


@pytest.mark.slow
def test_the_scene_is_drawn_turned_and_played(opened: Callable[..., Page]) -> None:
    page = opened()
    scene = page.locator(".scene").first
    assert scene.get_attribute("class") == "scene live"
    page.wait_for_function(f"() => ({COLOURS})().then((n) => n > 60)")
    canvas = scene.locator("canvas")
    before = canvas.screenshot()
    canvas.focus()
    canvas.press("ArrowLeft")
    page.wait_for_timeout(600)
    turned = canvas.screenshot()
    assert turned != before
    scene.get_by_role("button", name="Isometric").click()
    scene.get_by_role("checkbox", name="Machine").uncheck()
    scene.get_by_role("button", name="From afar").click()
    assert scene.get_by_role("checkbox", name="Machine").is_checked()  # as it was kept
    scene.get_by_role("checkbox", name="Machine").uncheck()
    page.wait_for_timeout(600)
    assert canvas.screenshot() not in (before, turned)
    scene.get_by_role("button", name="Play").click()
    page.wait_for_function("() => document.querySelector('[data-told]').textContent > '0.1'")
    scene.get_by_role("button", name="Pause").click()


@pytest.mark.slow
def test_on_paper_pictures_stand_instead_of_the_scene(opened: Callable[..., Page]) -> None:
    page = opened("dark")
    page.emulate_media(media="print")
    for scene in page.locator(".scene").all():
        assert not scene.locator("canvas").is_visible()
        assert scene.locator("figure.still > svg").is_visible()
    assert page.evaluate("getComputedStyle(document.body.parentElement).backgroundColor") == (
        "rgb(255, 255, 255)"
    )
    assert page.evaluate("getComputedStyle(document.querySelector('h1')).color") == (
        "rgb(31, 41, 51)"
    )
    assert not page.locator("nav").is_visible()


@pytest.mark.slow
def test_nothing_is_wider_than_a_small_screen(opened: Callable[..., Page]) -> None:
    page = opened()
    page.set_viewport_size({"width": 400, "height": 700})
    assert page.evaluate("document.documentElement.scrollWidth") <= 400
