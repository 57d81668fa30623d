"""How the page looks: nothing is cut, nothing lies over anything else, nothing jumps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from tests.browser import conftest
from tests.browser.conftest import Served, Tab

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.browser

FAULTS = (Path(__file__).parent / "layout.js").read_text(encoding="utf-8")
LAPTOP, ZOOMED = (1280, 800, 1.0), (1024, 640, 1.25)  # the same screen at 125 %
DESK = (1440, 900, 1.0)


@pytest.fixture
def at_size(
    browser: Browser, shots: Path, serve: Callable[..., Served], monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[..., Tab]]:
    """Open a design in a window of a size."""
    tabs: list[Tab] = []

    def start(design: str, size: tuple[int, int, float]) -> Tab:
        monkeypatch.setattr(conftest, "SIZE", {"width": size[0], "height": size[1]})
        monkeypatch.setattr(conftest, "SCALE", size[2])
        tabs.append(Tab(browser, serve(design).address, shots, "/machine/bars"))
        return tabs[-1]

    yield start
    for tab in tabs:
        tab.close()
        assert tab.faults == []


def _scroll(tab: Tab, by: int) -> int:
    """Scroll the panel; where it stands then."""
    # All at once: the status is drawn anew at any time.
    script = """(by) => { const status = document.querySelector('.bo-status');
        const panel = status.closest('.mantine-ScrollArea-viewport');
        panel.scrollBy({top: by, behavior: 'instant'}); return panel.scrollTop; }"""
    return int(tab.page.evaluate(script, by))


def _faults(tab: Tab) -> list[str]:
    """What is wrong in the open tab, as it is scrolled from top to bottom."""
    found: list[str] = []
    at = _scroll(tab, -9999)
    for _ in range(8):
        tab.page.mouse.move(5, 5)  # no tooltips
        tab.page.wait_for_timeout(350)
        found += tab.page.evaluate(FAULTS)
        before, at = at, _scroll(tab, 300)
        if at == before:
            break
    _scroll(tab, -9999)
    return list(dict.fromkeys(found))


@pytest.mark.parametrize(
    ("design", "size", "dark"),
    [
        ("rpur-table1", ZOOMED, False),
        ("sps-spr", LAPTOP, True),
        *(
            pytest.param(*rest, marks=pytest.mark.slow)
            for rest in (
                *((name, ZOOMED, False) for name in ("five-bar", "sps-spr", "spr-3", "rps-3")),
                ("rpur-table1", LAPTOP, True),
                ("five-bar", LAPTOP, False),
                ("rpur-table1", DESK, False),
                ("rps-3", DESK, True),
            )
        ),
    ],
    ids=str,
)
def test_no_text_is_cut_or_lies_over_another(
    at_size: Callable[..., Tab], design: str, size: tuple[int, int, float], dark: bool
) -> None:
    tab = at_size(design, size)
    if dark:
        tab.open_tab("Review")
        tab.check("Dark page").click()
        tab.wait(lambda: bool(tab.page.locator("[data-mantine-color-scheme=dark]").count()), "dark")
    names = [each.inner_text() for each in tab.page.get_by_role("tab").all()]
    for name in names:
        tab.open_tab(name)
        assert not _faults(tab), name


@pytest.mark.slow
def test_the_panels_beside_the_scene_leave_it_room(at_size: Callable[..., Tab]) -> None:
    tab = at_size("rpur-table1", LAPTOP)
    tab.open_tab("Section")
    tab.check("Show the section").click()
    tab.wait_for_text("Perimeter")
    assert not _faults(tab)
    tab.check("Show the section").click()
    tab.open_tab("Trajectory")
    tab.type_line("end", "300, 60, 200, 0, 0")
    tab.check("Show the trajectory").click()
    tab.wait_for_text(r"O′ travels [\d.]+ mm in 1 s")
    tab.wait(lambda: tab.value("Duration (s)") == 1.0, "the duration that runs")
    assert not _faults(tab)
    beside = tab.page.evaluate(
        """() => [...document.querySelectorAll('.mantine-Paper-root')]
            .map((e) => e.getBoundingClientRect()).filter((r) => r.height > 700)
            .reduce((wide, r) => Math.max(wide, r.left < 10 ? r.right : innerWidth - r.left), 0)"""
    )
    assert beside < 420


def test_the_status_has_one_height_and_stays_in_sight(tab: Tab) -> None:
    def place() -> tuple[float, ...]:
        # All at once: the status is drawn anew at any time.
        found: list[float] = tab.page.evaluate(
            """() => { const at = (what) => document.querySelector(what).getBoundingClientRect();
                const status = at(".bo-status");
                return [status.top, status.height, at("[role=tablist]").top]; }"""
        )
        return tuple(found)

    tab.wait_for_text("Reachable")
    tab.wait(lambda: place()[1] > 0, "the status")
    home = place()
    tab.type_into("y (mm)", 600)
    tab.wait_for_text("Not reachable")
    assert place() == home
    tab.type_into("y (mm)", 73)
    tab.wait_for_text("Reachable · mode")
    tab.type_into("ρ₁ (mm)", 9999)
    tab.wait_for_text("(?i)kept within|stopped")
    assert place() == home
    tab.open_tab("Solutions")
    tab.check("Ghosts").click()
    tab.wait(lambda: "other solutions" in tab.text(), "the ghosts' colour in the legend")
    assert place() == home
    legend = tab.page.locator(".bo-legend")
    assert legend.evaluate("e => e.scrollHeight - e.clientHeight") <= 1
    tab.wait(lambda: tab.page.locator("tr.sol").count() > 30, "a list longer than the panel")
    assert _scroll(tab, 400) > 100
    tab.page.wait_for_timeout(300)
    top, height, _ = place()
    assert top >= 0
    middle = tab.page.locator(".bo-status").evaluate(
        """e => { const r = e.getBoundingClientRect();
            return e.contains(document.elementFromPoint(r.left + 60, r.top + 10)); }"""
    )
    assert middle, "something lies over the status"
    assert top + height < 200
    tab.check("Ghosts").click()


def test_a_machine_in_a_plane_opens_in_plan(at_size: Callable[..., Tab]) -> None:
    tab = at_size("five-bar", LAPTOP)
    tab.wait(lambda: bool(tab.props("/regions/fill0").get("visible")), "the region")
    tab.page.wait_for_timeout(1500)
    picture = np.asarray(Image.open(tab.shot("plan")).convert("RGB")).astype(int)[:, :860]
    r, g, b = np.moveaxis(picture, -1, 0)
    across = np.argwhere((r > 225) & (g < 90) & (b > 60) & (b < 160))  # the handle's x
    upwards = np.argwhere((g > 180) & (r < 160) & (b < 180) & (g - r > 60))  # and its y
    assert len(across) > 20
    assert len(upwards) > 20
    (high, wide), (tall, thin) = (np.ptp(each, axis=0) for each in (across, upwards))
    assert wide > 3 * high
    assert tall > 3 * thin
    assert across[:, 1].mean() > upwards[:, 1].mean()  # x to the right
