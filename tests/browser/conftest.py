"""The page as a person meets it: `bohemia serve` as a process, a headless Chromium before it."""

from __future__ import annotations

import json
import os
import queue
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from app.review import session
from app.review.state import new_review
from kinematics.designs.files import load_design
from tests.conftest import command_environment

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Locator

PATIENCE = 60.0  # s; only a hang is caught by it

# Small, because software draws every pixel here.
SIZE = {"width": 900, "height": 640}
SCALE = 1.0  # of a px on the screen

ARGUMENTS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--disable-dev-shm-usage",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
]

# Few and plain pictures: drawn in software, they would take the cores from all that is tested.
CALM = """
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 400);
window.cancelAnimationFrame = clearTimeout;
const context = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, options) {
    return context.call(this, kind, {...options, antialias: false});
};
"""


class Served:
    """A running `bohemia serve`."""

    def __init__(self, *arguments: str, folder: Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "app", "serve", "--no-browser", "--port", "0", *arguments],
            cwd=folder,
            env=command_environment() | {"PYTHONUNBUFFERED": "1"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding="utf-8",
        )
        self.lines: queue.Queue[str] = queue.Queue()
        self.log: list[str] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self.address = self._wait_for_address()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.log.append(line)
            self.lines.put(line)

    def _wait_for_address(self) -> str:
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            try:
                line = self.lines.get(timeout=0.2)
            except queue.Empty:
                assert self.process.poll() is None, "".join(self.log)
                continue
            if found := re.search(r"http://[\w.:\[\]]+", line):
                return found[0]
        raise AssertionError("no address was printed: " + "".join(self.log))

    def check(self) -> None:
        """Nothing that a person should have been told went to the log instead."""
        bad = ("Traceback", "dropped what", "refused a request")
        assert not [line for line in self.log if any(b in line for b in bad)], "".join(self.log)

    def stop(self) -> int:
        if self.process.poll() is None:
            self.process.terminate()
        code = self.process.wait(timeout=20)
        self._reader.join(timeout=10)
        assert self.process.stdout is not None
        self.process.stdout.close()
        return code


@pytest.fixture(scope="package")
def browser(chromium: str) -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium, headless=True, args=ARGUMENTS)
        yield opened
        opened.close()


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[..., Served]]:
    """Start servers of one's own."""
    running: list[Served] = []

    def start(*arguments: str) -> Served:
        running.append(Served(*arguments, folder=tmp_path))
        return running[-1]

    yield start
    for served in running:
        served.stop()
        served.check()


@pytest.fixture(scope="package")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """One server for all tests that leave it as they found it, and not for longer."""
    running = Served(folder=tmp_path_factory.mktemp("served"))
    yield running
    running.stop()
    running.check()


class Tab:
    """A browser tab on the page, with what a person can do and see."""

    def __init__(
        self, browser: Browser, address: str, shots: Path, node: str = "/solids/workspace"
    ) -> None:
        self.context = browser.new_context(
            viewport=SIZE, device_scale_factor=SCALE, accept_downloads=True
        )
        self.context.add_init_script(CALM)
        self.page = self.context.new_page()
        self.shots = shots
        self.faults: list[str] = []
        self.page.on("pageerror", lambda error: self.faults.append(f"page error: {error}"))
        self.page.on("console", self._console)
        self.page.on("request", self._request)
        self.page.goto(address)
        self.page.wait_for_function(
            "(node) => window.__viserSceneTree && node in window.__viserSceneTree.getState()",
            arg=node,
            timeout=PATIENCE * 1000,
        )
        toast = self.page.locator("#webgl-software-rendering button")
        if toast.count():
            toast.first.click()
        status = self.page.get_by_text("eachable · ").locator("visible=true")
        status.first.wait_for(timeout=PATIENCE * 1000)

    def _console(self, message: Any) -> None:
        if message.type == "error":
            self.faults.append(f"console: {message.text}")

    def _request(self, request: Any) -> None:
        if not re.match(r"(https?|wss?)://127\.0\.0\.1[:/]|data:|blob:", request.url):
            self.faults.append(f"request to {request.url}")

    # --- seeing

    def props(self, node: str) -> dict[str, Any]:
        """What a scene node was last told, without its large arrays."""
        return self.page.evaluate(
            """(node) => {
                const found = window.__viserSceneTree.getState()[node];
                if (!found) return {};
                const props = found.message.props, out = {};
                for (const key of Object.keys(props)) {
                    const value = props[key];
                    out[key] = ArrayBuffer.isView(value) ? value.byteLength : value;
                }
                const pose = window.__viserMutable.nodePoseData[node] ?? {};
                return {...out, position: pose.position, wxyz: pose.wxyz,
                        visible: found.visibility ?? found.visible};
            }""",
            node,
        )

    def text(self) -> str:
        """All the text on the page."""
        return self.page.locator("body").inner_text()

    def wait(self, condition: Callable[[], bool], what: str) -> None:
        """Poll until something holds."""
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                self.shot("timeout")
                raise AssertionError(f"waited in vain: {what}\n{self.text()[:3000]}")
            self.page.wait_for_timeout(150)

    def wait_for_text(self, pattern: str) -> str:
        """Poll until the page's text matches; the match."""
        found: list[str] = []

        def there() -> bool:
            match = re.search(pattern, self.text())
            if match is not None:
                found.append(match[0])
            return bool(found)

        self.wait(there, pattern)
        return found[0]

    def shot(self, name: str) -> Path:
        path = self.shots / f"{name}.png"
        self.page.screenshot(path=path)
        return path

    # --- doing

    def open_tab(self, name: str) -> None:
        """A tab, or a view of the workspace: its solid, its section, its map."""
        tabs = self.page.get_by_role("tab")
        views = {"Workspace": "Solid", "Section": "Section", "Map": "Map"}
        if name in views:
            self.page.get_by_role("tab", name="Workspace", exact=True).click()
        view = self.page.get_by_role("tab", name=views.get(name, name), exact=True)
        # A workspace alone has no views; another view comes a moment after its tab.
        if name != "Workspace" or tabs.filter(has_text="Solid").count():
            view.click()

    def unfold(self, title: str) -> None:
        """Open a group, if it is closed."""
        heading = self.page.get_by_text(title, exact=True).locator("visible=true").first
        inside = heading.locator("xpath=following-sibling::div[1]")
        if inside.get_attribute("aria-hidden") != "false":
            heading.click()

    def field(self, label: str, index: int = 0) -> Locator:
        """The number or text box that belongs to a label."""
        row = self.page.get_by_text(label, exact=True).locator("visible=true").nth(index)
        return row.locator("xpath=ancestor::div[contains(@class,'mantine-Flex-root')][1]").locator(
            "input"
        )

    def choose(self, label: str, option: str, index: int = 0) -> None:
        """Pick from a drop-down list; ``index`` tells labels apart that stand there more than once.

        A panel that grows at the same moment closes the list again or places it anew.
        """
        found = self.page.get_by_role("option", name=option, exact=True).locator("visible=true")

        def chosen() -> bool:
            box = self.field(label, index).first
            if box.input_value() == option:
                return True
            if not found.count():
                box.scroll_into_view_if_needed()
                box.click()
                self.page.wait_for_timeout(150)
            if found.count():
                found.first.dispatch_event("click")
            return False

        self.wait(chosen, f"{option} of {label}")

    def type_into(self, label: str, value: float | str, index: int = 0) -> None:
        box = self.field(label, index).last
        box.fill(str(value))
        box.press("Enter")

    def type_line(self, line: str, text: str) -> None:
        """Type all numbers of a row into its first box."""
        box = self.page.locator(f'[data-line="{line}.line"]').first
        box.fill(text)
        box.press("Enter")

    def value(self, label: str) -> float:
        return float(self.field(label).last.input_value())

    def check(self, label: str) -> Locator:
        """The checkbox that belongs to a label."""
        row = self.page.get_by_text(label, exact=True).locator("visible=true").first
        return row.locator(
            "xpath=ancestor::div[contains(@class,'mantine-Flex-root')][1]"
        ).get_by_role("checkbox")

    def upload(self, tab: str, button: str, file: Path) -> None:
        """Choose a file for the upload button of a tab."""
        self.open_tab(tab)
        with self.page.expect_file_chooser() as chooser:
            self.page.get_by_role("button", name=button).click()
        chooser.value.set_files(file)

    def open_review(self, file: Path) -> None:
        """Open a session file and wait until the page shows it."""
        self.upload("Review", "Open a session file", file)
        pose = json.loads(file.read_text(encoding="utf-8"))["pose"]
        self.open_tab("Move")
        self.wait(lambda: abs(self.value("x (mm)") - pose["x"]) < 0.06, "the session's x")
        self.wait(lambda: abs(self.value("φ (°)") - pose["phi_deg"]) < 0.06, "the session's φ")

    def close(self) -> None:
        self.context.close()


FAILED = pytest.StashKey[bool]()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, Any]:
    report = yield
    item.stash[FAILED] = item.stash.get(FAILED, False) or report.failed
    return report


@pytest.fixture
def shots(tmp_path: Path) -> Path:
    """Where screenshots go; BOHEMIA_SHOTS keeps them."""
    return _shots(tmp_path)


def _shots(folder: Path) -> Path:
    kept = os.environ.get("BOHEMIA_SHOTS")
    folder = Path(kept) if kept else folder
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _end(tab: Tab, request: pytest.FixtureRequest, name: str) -> None:
    """How the page looked in the end, where somebody will look: a picture takes seconds."""
    if request.node.stash.get(FAILED, False) or os.environ.get("BOHEMIA_SHOTS"):
        tab.shot(name)


@pytest.fixture
def open_page(
    browser: Browser, shots: Path, request: pytest.FixtureRequest
) -> Iterator[Callable[[Served], Tab]]:
    """Open further tabs."""
    tabs: list[Tab] = []

    def start(served: Served) -> Tab:
        tabs.append(Tab(browser, served.address, shots))
        return tabs[-1]

    yield start
    for n, tab in enumerate(tabs):
        _end(tab, request, f"{request.node.name}-{n}")
        tab.close()
        assert tab.faults == []


@pytest.fixture(scope="package")
def shared_tab(
    browser: Browser, served: Served, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Tab]:
    opened = Tab(browser, served.address, _shots(tmp_path_factory.mktemp("shots")))
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def fresh_session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A session file of Table 1 at home."""
    file = tmp_path_factory.mktemp("session") / "fresh.json"
    session.save(new_review(load_design("rpur-table1")), file)
    return file


@pytest.fixture
def tab(shared_tab: Tab, fresh_session: Path, request: pytest.FixtureRequest) -> Iterator[Tab]:
    """The one tab that most tests use, on a fresh review: loading a page takes long without GPU."""
    shared_tab.faults.clear()
    shared_tab.open_review(fresh_session)
    yield shared_tab
    _end(shared_tab, request, request.node.name)
    assert shared_tab.faults == []
