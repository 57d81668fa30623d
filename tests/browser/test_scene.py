"""What the scene looks like, by its pixels: colours, how much of it is used, named views."""

from __future__ import annotations

import colorsys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from app.features.section.state import MoveCut, SetCut
from app.review import session
from app.review.changes import Change, SetOption, change
from app.review.state import new_review
from app.review.view import view
from app.scene import palette
from app.scene.camera import toward_of
from kinematics.designs.files import load_design
from tests.browser import conftest
from tests.browser.conftest import Served, Tab

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.browser

PANEL = 422  # px at the right
MACHINES = {
    "rpur-table1": (1280, 800),
    "rpur-table2": (1440, 900),
    "sps-spr": (1280, 800),
    "rps-3": (1440, 900),
    "spr-3": (1280, 800),
    "five-bar": (1440, 900),
}
GROUNDS = {False: (255, 255, 255), True: (20, 20, 20)}  # of the scene, by whether it is dark
Show = Callable[..., Tab]


@pytest.fixture
def show(
    browser: Browser,
    shots: Path,
    tmp_path: Path,
    serve: Callable[..., Served],
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[Show]:
    """Open a design in a window of a size, after some changes."""
    tabs: list[Tab] = []

    def start(design: str, size: tuple[int, int], *changes: Change) -> Tab:
        review = new_review(load_design(design))
        for each in (SetOption("handle", False), SetOption("frames", False), *changes):
            review, _ = change(review, each)
        file = tmp_path / f"{design}{len(tabs)}.json"
        session.save(review, file)
        monkeypatch.setattr(conftest, "SIZE", {"width": size[0], "height": size[1]})
        served = serve("--session", str(file))
        tabs.append(Tab(browser, served.address, shots, "/machine/bars"))
        return tabs[-1]

    yield start
    for tab in tabs:
        tab.close()
        assert tab.faults == []


def _picture(tab: Tab, name: str) -> np.ndarray:
    """The scene once it stands still, without what floats over its left corners: (H, W, 3)."""
    before = np.empty(0)
    for _ in range(40):
        tab.page.wait_for_timeout(700)
        image = np.asarray(Image.open(tab.shot(name)).convert("RGB")).astype(int)
        if np.array_equal(before, image[:, :-PANEL]):
            break
        before = image[:, :-PANEL]
    scene = image[:, :-PANEL].copy()
    scene[:70, :240] = scene[-120:, :320] = _ground(scene)
    return scene


def _ground(scene: np.ndarray) -> tuple[int, ...]:
    """The colour that most of the upper edge has, lines or not."""
    colors, count = np.unique(scene[:6].reshape(-1, 3), axis=0, return_counts=True)
    return tuple(int(v) for v in colors[count.argmax()])


def _of_hue(scene: np.ndarray, code: str) -> np.ndarray:
    """Where (H, W) the picture has a colour, be it in light or in shade."""
    hue = colorsys.rgb_to_hsv(*(c / 255.0 for c in palette.rgb(code)))[0]
    high, low = scene.max(axis=2), scene.min(axis=2)
    spread = np.maximum(high - low, 1)
    r, g, b = np.moveaxis(scene, 2, 0)
    turned = np.select(
        [high == r, high == g],
        [(g - b) / spread % 6.0, (b - r) / spread + 2.0],
        (r - g) / spread + 4.0,
    )
    away = np.abs((turned / 6.0 - hue + 0.5) % 1.0 - 0.5)
    found: np.ndarray = (away < 0.025) & (high - low > 0.3 * high) & (high > 60)
    return found


def _content(scene: np.ndarray, ground: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """The box of what stands out from the ground and from the lines on it, as shares of it."""
    there = np.argwhere(np.abs(scene - np.array(ground)).max(axis=2) > 80)
    size = np.array(scene.shape[:2])
    return there.min(axis=0) / size, there.max(axis=0) / size


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize(
    "design",
    [
        design if design == "rpur-table1" else pytest.param(design, marks=pytest.mark.slow)
        for design in MACHINES
    ],
)
def test_a_machine_is_seen_whole_in_the_colours_of_its_limbs(
    show: Show, design: str, dark: bool
) -> None:
    tab = show(design, MACHINES[design], SetOption("dark", dark))
    scene = _picture(tab, f"scene-{design}-{'dark' if dark else 'light'}")
    assert _ground(scene) == GROUNDS[dark]
    seen = view(new_review(load_design(design)))
    for limb in sorted({row.limb for row in seen.joints}):
        assert _of_hue(scene, palette.limb_color(limb)).sum() > 150, limb
    low, high = _content(scene, GROUNDS[dark])
    assert (low > 0.02).all()
    assert (high < 0.98).all()
    assert (high - low).max() > 0.6


TURNED = """() => {
    const { camera } = window.__viserMutable.scene.__r3f.root.getState();
    const m = camera.matrixWorld.elements;
    const base = (n) => [-m[n + 2], -m[n], m[n + 1]];  // the browser's y is up, and −z is x
    return { fov: camera.fov, right: base(0), toward: base(8) };
}"""


def _camera(tab: Tab) -> tuple[float, np.ndarray, np.ndarray]:
    """The field of view, degrees, from where one looks, and what is to the right."""
    found: dict[str, Any] = tab.page.evaluate(TURNED)
    return float(found["fov"]), np.array(found["toward"]), np.array(found["right"])


def test_keys_turn_to_named_views_and_back(show: Show) -> None:
    tab = show("rpur-table1", (1280, 800))
    tab.page.mouse.click(430, 500)

    def seen(name: str, fov: float) -> bool:
        wide, toward, _ = _camera(tab)
        goal = toward_of(False, name)  # type: ignore[arg-type]
        return abs(wide - fov) < 0.1 and bool(toward @ goal / np.linalg.norm(goal) > 0.9999)

    tab.wait(lambda: seen("isometric", 30.0), "the view at first")
    for key, name, fov in (("2", "plan", 6.0), ("3", "front", 6.0), ("4", "side", 6.0)):
        tab.page.keyboard.press(key)
        tab.wait(lambda name=name, fov=fov: seen(name, fov), name)
        if name in ("plan", "front"):
            assert _camera(tab)[2] == pytest.approx([1.0, 0.0, 0.0], abs=2e-3)
        low, high = _content(_picture(tab, f"view-{name}"), GROUNDS[False])
        assert (low > 0.02).all()
        assert (high < 0.98).all()
        assert (high - low).max() > 0.6
    tab.page.keyboard.press("f")  # stays where one looks from
    tab.page.wait_for_timeout(1000)
    assert seen("side", 6.0)
    tab.page.keyboard.press("1")
    tab.wait(lambda: seen("isometric", 30.0), "the view at first again")


def test_a_section_opens_the_solid(show: Show) -> None:
    tab = show("rpur-table1", (1280, 800), SetCut("on", True), MoveCut(326.0))
    tab.wait(lambda: bool(tab.props("/section/cap").get("visible")), "the cap")
    whole = "() => window.__viserSceneTree.getState()['/solids/workspace/front0'].message.props"
    reach = f"""() => {{
        const v = ({whole})().vertices;
        const a = new Float32Array(v.buffer, v.byteOffset, v.byteLength / 4);
        let most = -1e9;
        for (let i = 0; i < a.length; i += 3) most = Math.max(most, a[i]);
        return most;
    }}"""
    faces = tab.page.evaluate(reach)
    assert faces > 300.0
    assert tab.props("/section/label")["text"] == "x′ = 326.0 mm"
    scene = _picture(tab, "scene-section")
    # The cap is a flat grey that no translucent solid has on white.
    flat = np.abs(scene - np.array(palette.rgb(palette.LIGHT.cut))).max(axis=2) < 48
    darker = scene.max(axis=2) < 200
    assert (flat & darker).sum() > 2500
    for limb in (2, 3, 4):  # their arcs bound it
        assert _of_hue(scene, palette.limb_color(limb)).sum() > 150
