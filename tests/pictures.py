"""The README's pictures of the page as it is: `make pictures`; a slow test compares them with it.

python -m tests.pictures assets/readme
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Browser

    from tests.browser.conftest import Tab

SIZE = {"width": 1280, "height": 800}
SETTLED = 3000  # ms in which the picture comes to rest


def _workspace(tab: Tab) -> None:
    tab.open_tab("Workspace")
    tab.wait_for_text(r"mesh: fine, \d+ triangles")


def _section(tab: Tab) -> None:
    tab.open_tab("Section")
    tab.check("Show the section").click()
    tab.wait_for_text("Perimeter")


PICTURES: dict[str, tuple[str, Callable[[Tab], None]]] = {
    "page": ("rpur-table1", _workspace),
    "section": ("rpur-table1", _section),
    "gough": ("gough", _workspace),
}
"""By the file's name: the design, and what is done before the picture is taken."""


def take(browser: Browser, name: str, folder: Path) -> Path:
    """One of the pictures as a PNG in a folder."""
    from tests.browser import conftest

    design, do = PICTURES[name]
    conftest.SIZE = SIZE
    with tempfile.TemporaryDirectory() as scratch:
        served = conftest.Served(design, folder=Path(scratch))
        tab = conftest.Tab(browser, served.address, folder, "/machine/bars")
        try:
            do(tab)
            tab.page.mouse.move(5, 790)
            tab.wait(lambda: "Computing" not in tab.text(), "rest")
            tab.page.wait_for_timeout(SETTLED)
            return tab.shot(name)
        finally:
            tab.close()
            served.stop()


def main(folder: Path) -> None:
    """Take all of them."""
    import shutil

    from playwright.sync_api import sync_playwright

    from tests.browser.conftest import ARGUMENTS
    from tests.conftest import BROWSERS

    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        sys.exit(f"no browser found ({', '.join(BROWSERS)})")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, headless=True, args=ARGUMENTS)
        for name in PICTURES:
            print(take(browser, name, folder))
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
