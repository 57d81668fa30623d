"""The frame of the page: what stays in sight, what can be pressed, what can be typed."""

from __future__ import annotations

import re

import pytest

from tests.browser.conftest import Tab

pytestmark = pytest.mark.browser

TABS = ["Move", "Solutions", "Workspace", "Singularities", "Trajectory", "Design", "Review"]
BOX = """e => { const b = e.getBoundingClientRect();
    return [b.left, b.top, b.right, b.bottom].map(Math.round); }"""


def _box(tab: Tab, selector: str) -> list[int]:
    found: list[int] = tab.page.locator(selector).first.evaluate(BOX)
    return found


def test_bar_status_tabs_and_foot_have_their_places(tab: Tab) -> None:
    size = tab.page.viewport_size
    assert size is not None
    wide, high = size["width"], size["height"]
    left = wide - 420
    assert _box(tab, "[data-dock-region=right]") == [left, 0, wide, high]
    assert _box(tab, ".bo-bar")[1::2] == [0, 40]
    assert _box(tab, ".bo-status") == [left, 40, wide, 104]
    assert _box(tab, "[role=tablist]") == [left, 104, wide, 136]
    assert _box(tab, ".bo-foot") == [left, high - 32, wide, high]
    names = [each for each in tab.page.get_by_role("tab").all() if each.inner_text() in TABS]
    assert [each.inner_text() for each in names] == TABS
    tops = {each.evaluate(BOX)[1] for each in names}
    assert len(tops) == 1, "the tabs stand in one row"
    assert all(each.evaluate("e => e.scrollWidth <= e.clientWidth + 1") for each in names)


def test_the_help_of_a_tab_opens_above_the_foot_with_the_keys(tab: Tab) -> None:
    tab.open_tab("Solutions")
    ask = tab.page.get_by_role("button", name="What am I looking at?")
    ask.click()
    help_ = tab.page.locator(".bo-help[data-open]")
    assert "assembly mode" in help_.inner_text()
    assert re.search(r"Ctrl\+Z\s+Undo", help_.inner_text())
    high = (tab.page.viewport_size or {})["height"]
    assert help_.evaluate(BOX)[3] == high - 32
    tab.page.keyboard.press("Escape")
    assert tab.page.locator(".bo-help[data-open]").count() == 0


def test_the_bar_takes_back_goes_home_and_says_what(tab: Tab) -> None:
    x = tab.value("x (mm)")
    undo = tab.page.get_by_role("button", name="Undo", exact=True)
    tab.type_into("x (mm)", x - 7)
    tab.wait(lambda: f"x {x:g} → {x - 7:g} mm" in str(undo.get_attribute("title")), "its name")
    undo.click()
    tab.wait(lambda: tab.value("x (mm)") == x, "x again")
    redo = tab.page.get_by_role("button", name="Redo", exact=True)
    tab.wait(lambda: redo.is_enabled(), "something to do again")
    redo.click()
    tab.wait(lambda: tab.value("x (mm)") == x - 7, "done again")
    tab.page.get_by_role("button", name="Home position").click()
    tab.wait(lambda: tab.value("x (mm)") == x, "home")


@pytest.mark.parametrize(
    ("typed", "value"),
    [("300+25", 325.0), ("12.5 in", 317.5), ("(2 + 1/2)*13 cm", 325.0), ("3,2e2", 320.0)],
)
def test_a_number_box_takes_calculations_and_units(tab: Tab, typed: str, value: float) -> None:
    tab.type_into("x (mm)", typed)
    tab.wait(lambda: tab.value("x (mm)") == pytest.approx(value), f"{typed} as {value}")


def test_an_angle_may_be_in_radians_and_nonsense_is_told(tab: Tab) -> None:
    tab.type_into("φ (°)", "0.1 rad")
    tab.wait(lambda: tab.value("φ (°)") == pytest.approx(5.7296, abs=1e-4), "0.1 rad in degrees")
    tab.type_into("φ (°)", "3 mm")
    note = tab.page.locator(".bo-wrong")
    note.wait_for()
    assert "“3 mm” is no number" in note.inner_text()
    assert tab.value("φ (°)") == pytest.approx(5.7296, abs=1e-4)


def test_a_pose_is_taken_as_one_line(tab: Tab) -> None:
    tab.type_into("As text", "300; 60, 200 3 -2")
    tab.wait(lambda: tab.value("θ (°)") == -2.0, "the pose")
    assert [tab.value(f"{c} (mm)") for c in "xyz"] == [300.0, 60.0, 200.0]
    tab.type_into("As text", "300, 60")
    tab.wait_for_text(r"a pose needs 5 numbers: x, y, z \(mm\), φ, θ \(°\)")


def test_bands_show_where_a_coordinate_can_go(tab: Tab) -> None:
    def spans() -> list[tuple[float, float]]:
        return [
            (float(left), float(wide))
            for left, wide in re.findall(
                r"left:([\d.]+)%;width:([\d.]+)%",
                str(tab.page.locator(".bo-reach").evaluate_all("e => e.map(i => i.innerHTML)")),
            )
        ]

    tab.wait(lambda: len(spans()) == 5, "a band for each coordinate")
    x_left, x_wide = spans()[0]
    assert -360 + 9.10 * x_left == pytest.approx(255.0, abs=0.5)  # the slider is −360 … 550
    assert 9.10 * x_wide == pytest.approx(394.6 - 255.0, abs=0.5)
    band, track = _box(tab, ".bo-reach"), _box(tab, ".mantine-Slider-track")
    assert (band[0], band[2]) == pytest.approx((track[0], track[2]), abs=2)
    assert band[1] <= track[1]
    assert band[3] >= track[3]


def test_a_limb_is_put_over_by_its_picture_and_by_the_keyboard(tab: Tab) -> None:
    second = tab.page.locator(".bo-modes button").nth(1)
    before = second.inner_text()
    assert before.strip() == "2 −"
    second.focus()
    tab.page.keyboard.press("Enter")
    tab.wait(lambda: second.inner_text().strip() == "2 +", "limb 2 on +")
    tab.wait_for_text("mode ++++".replace("++++", r"\+\+\+−\+"))
    second.click()
    tab.wait(lambda: second.inner_text().strip() == "2 −", "and back")


def test_a_number_of_the_design_is_edited_in_its_table(tab: Tab) -> None:
    tab.open_tab("Design")
    link = tab.page.get_by_label("Limb 2: link l (mm)")
    link.fill("15 cm + 3")
    link.press("Tab")
    again = tab.page.get_by_label("Limb 2: link l (mm)")
    tab.wait(lambda: again.input_value() == "153", "the new link")
    focused = "() => document.activeElement.getAttribute('aria-label')"
    tab.wait(lambda: "ρ min" in str(tab.page.evaluate(focused)), "the keys in the next box")
    tab.page.get_by_role("button", name="Undo", exact=True).click()
    tab.wait(lambda: again.input_value() == "150", "the old link")


CONTRAST = """() => {
    const lum = (c) => { const [r, g, b] = c.map((v) => v / 255)
        .map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
        return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
    const parse = (text) => (text.match(/[\\d.]+/g) || []).map(Number);
    const ground = (at) => { for (; at; at = at.parentElement) {
        const c = parse(getComputedStyle(at).backgroundColor);
        if (c.length && (c.length < 4 || c[3] > 0.9)) return c.slice(0, 3); }
        return [255, 255, 255]; };
    const faint = [], root = document.querySelector('[data-dock-region=right]');
    const walk = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
    while (walk.nextNode()) {
        const at = walk.currentNode.parentElement, text = walk.currentNode.textContent.trim();
        if (!text || !at.offsetParent && getComputedStyle(at).position !== 'fixed') continue;
        if (at.closest('script,style,svg,:disabled,[inert],.aged')) continue;
        if (at.closest('[aria-hidden=true]:not(.bo-verdict)')) continue;
        let opacity = 1;
        for (let up = at; up; up = up.parentElement) opacity *= getComputedStyle(up).opacity;
        if (!opacity) continue;
        const under = ground(at), ink = parse(getComputedStyle(at).color).slice(0, 3)
            .map((v, n) => v * opacity + under[n] * (1 - opacity));
        const [a, b] = [lum(ink), lum(under)].sort((x, y) => y - x);
        const ratio = (a + 0.05) / (b + 0.05);
        if (ratio < 4.5) faint.push(`${text.slice(0, 40)}: ${ratio.toFixed(2)}`);
    }
    return [...new Set(faint)];
}"""


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_every_text_of_the_panel_can_be_read(tab: Tab, dark: bool) -> None:
    """WCAG AA: 4.5 to 1 for text."""
    tab.open_tab("Review")
    if dark:
        tab.check("Dark page").click()
        tab.wait(lambda: bool(tab.page.locator("[data-mantine-color-scheme=dark]").count()), "dark")
    for name in TABS:
        tab.open_tab(name)
        tab.page.mouse.move(5, 300)
        tab.page.wait_for_timeout(900)
        assert tab.page.evaluate(CONTRAST) == [], name
    if dark:
        tab.open_tab("Review")
        tab.check("Dark page").click()


def test_the_server_hears_which_tab_is_open_and_where_the_pointer_is(tab: Tab) -> None:
    told = """() => document.querySelector(".bo-pointer").closest(".bo-live").parentElement
        .nextElementSibling.querySelector("input").value.split(" ").slice(0, 3)"""

    def is_told(*words: str) -> None:
        tab.wait(lambda: tab.page.evaluate(told) == list(words), f"{words} told")

    tab.page.mouse.move(300, 200)
    is_told("0", "300", "200")
    tab.open_tab("Design")
    is_told("5", "-", "-")
    tab.page.mouse.move(120, 410)
    is_told("5", "120", "410")
    tab.page.mouse.down()  # somebody turns the view
    tab.page.mouse.move(140, 430)
    tab.page.wait_for_timeout(300)
    is_told("5", "120", "410")
    tab.page.mouse.up()
    tab.open_tab("Move")
    is_told("0", "-", "-")
