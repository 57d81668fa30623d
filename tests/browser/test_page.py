"""The page, used as a person uses it, in a headless Chromium."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from tests.browser.conftest import SIZE, Served, Tab

pytestmark = pytest.mark.browser

Serve = Callable[..., Served]
Open = Callable[[Served], Tab]

VOLUME = r"[\d.,]+ ± [\d.,]+ (?:dm³|cm³)"


def _wait_for_solid(tab: Tab, resolution: str = "fine") -> str:
    """The volume that the page states once the solid has this resolution."""
    tab.open_tab("Workspace")
    told = tab.wait_for_text(rf"mesh: {resolution}, \d+ triangles, {VOLUME}")
    return told.partition("triangles, ")[2]


def _pose_text(tab: Tab) -> list[float]:
    """The five coordinates of the pose, as the Move tab shows them."""
    return [tab.value(label) for label in ("x (mm)", "y (mm)", "z (mm)", "φ (°)", "θ (°)")]


def test_load_turn_and_watch_the_solid_change(tab: Tab) -> None:
    before = _wait_for_solid(tab)
    shape = tab.props("/solids/workspace/front0")
    assert shape["visible"]
    tab.open_tab("Move")
    tab.type_into("φ (°)", 25)
    after = ""

    def changed() -> bool:
        nonlocal after
        after = _wait_for_solid(tab)
        return after != before

    tab.wait(changed, "another volume")
    turned = tab.props("/solids/workspace/front0")
    assert turned["vertices"] != shape["vertices"]
    assert float(after.split()[0]) < float(before.split()[0])


def test_an_actuator_moves_the_platform(tab: Tab) -> None:
    tab.wait_for_text("Reachable")
    before = _pose_text(tab)
    rho = tab.value("ρ₁ (mm)")
    others = [tab.value(f"ρ{s} (mm)") for s in "₂₃₄₅"]
    slider = tab.page.get_by_role("slider").nth(5)
    slider.focus()
    for _ in range(20):
        slider.press("ArrowRight")
        tab.page.wait_for_timeout(20)
    tab.wait(lambda: tab.value("ρ₁ (mm)") > rho + 0.5, "a longer ρ₁")
    tab.wait(lambda: _pose_text(tab) != before, "another pose")
    assert [tab.value(f"ρ{s} (mm)") for s in "₂₃₄₅"] == pytest.approx(others, abs=1e-9)
    assert "Reachable" in tab.text()


def test_a_drive_to_the_very_end_stops_and_says_why(tab: Tab) -> None:
    tab.type_into("ρ₁ (mm)", 400)
    tab.wait_for_text(r"(?i)stopped at a parallel singularity|ρ₁ near its end")
    tab.type_into("ρ₁ (mm)", 9999)
    # The box gives back what was driven; the text may still be of the drive before.
    tab.wait(lambda: tab.value("ρ₁ (mm)") <= 400.0, "ρ₁ within its stroke")
    tab.wait_for_text("(?i)kept within|stopped")


def _red(tab: Tab) -> tuple[np.ndarray, np.ndarray]:
    """Where the handle's first axis is: nothing else on the canvas is of this red."""
    picture = np.asarray(Image.open(tab.shot("handle")).convert("RGB")).astype(int)
    picture = picture[:, : SIZE["width"] - 410]
    ys, xs = np.nonzero((picture[..., 0] > 235) & (picture[..., 1] < 80) & (picture[..., 2] > 60))
    return ys, xs


def test_dragging_the_handle_moves_the_machine(tab: Tab) -> None:
    _wait_for_solid(tab)
    tab.open_tab("Move")
    before = _pose_text(tab)
    tab.wait(lambda: len(_red(tab)[0]) > 50, "the handle")
    ys, xs = _red(tab)
    x, y = int(xs[len(xs) // 2]), int(ys[len(xs) // 2])
    mouse = tab.page.mouse
    mouse.move(x, y)
    mouse.down()
    for step in range(1, 16):
        mouse.move(x + 3 * step, y + 2 * step)
        tab.page.wait_for_timeout(30)

    tab.wait(lambda: _pose_text(tab) != before, "the platform follows the hand")
    mouse.up()
    tab.wait_for_text("eachable · mode")


def test_an_export_reloads_watertight_with_the_stated_volume(tab: Tab, tmp_path: Path) -> None:
    _wait_for_solid(tab)
    text = tab.wait_for_text(r"mesh: fine, \d+ triangles, [\d.]+ ± [\d.]+ dm³")
    stated = 1e6 * float(text.split()[4])
    tab.unfold("Save a solid")
    with tab.page.expect_download(timeout=60_000) as started:
        tab.page.get_by_role("button", name="Save", exact=True).click()
    name = started.value.suggested_filename
    path = tmp_path / name
    started.value.save_as(path)
    assert name == "rpur-table1_workspace_phi0_theta0_+-+-+_mm.stl"
    solid = trimesh.load(path)
    assert solid.is_watertight
    assert solid.volume == pytest.approx(stated, rel=1e-4)
    assert solid.volume == pytest.approx(6_001_738, rel=1e-4)  # of its mode


def test_a_picture_of_the_view_shows_the_machine(tab: Tab, tmp_path: Path) -> None:
    _wait_for_solid(tab)
    tab.open_tab("Review")
    with tab.page.expect_download(timeout=60_000) as started:
        tab.page.get_by_role("button", name="Picture of the view (PNG)").click()
    assert started.value.suggested_filename == "rpur-table1_view.png"
    started.value.save_as(tmp_path / "view.png")
    picture = np.asarray(Image.open(tmp_path / "view.png").convert("RGBA")).astype(int)
    assert picture.shape[1] >= 1600 - 2
    assert (picture[..., 3] == 255).all()
    drawn = (picture[..., :3].min(axis=2) < 250).mean()
    assert drawn > 0.1, "nothing but its ground"
    orange = (picture[..., 0] > 190) & (picture[..., 1] > 100) & (picture[..., 2] < 60)
    assert orange.sum() > 200, "limb 2"
    seen = np.asarray(Image.open(tab.shot("seen")).convert("RGB")).astype(int)
    seen = seen[:, : SIZE["width"] - 410]
    ratio = (seen.min(axis=2) < 250).mean() / drawn
    assert 0.3 < ratio < 3.0


def test_a_broken_design_file_is_told_and_nothing_is_lost(tab: Tab, tmp_path: Path) -> None:
    volume = _wait_for_solid(tab)
    broken = tmp_path / "mine.toml"
    broken.write_text('mechanism = "five_rpur"\n[[limb]]\nbase = [0, 0]\n')
    tab.upload("Design", "Open a design file", broken)
    shown = tab.wait_for_text(r"mine\.toml[,:] [^\n]*")
    assert "Traceback" not in tab.text()
    assert "limb" in shown
    assert _wait_for_solid(tab) == volume


def test_a_design_file_is_opened_edited_and_taken_back(
    tab: Tab, tmp_path: Path, root: Path
) -> None:
    volume = _wait_for_solid(tab)
    own = tmp_path / "own.toml"
    text = (root / "assets/designs/rpur-table1.toml").read_text(encoding="utf-8")
    own.write_text(text.replace("link = 150.0", "link = 170.0", 1), encoding="utf-8")
    tab.upload("Design", "Open a design file", own)
    tab.wait(lambda: _wait_for_solid(tab) != volume, "the volume of the uploaded design")
    tab.page.keyboard.press("Escape")
    tab.open_tab("Review")
    tab.page.get_by_role("button", name="Undo").click()
    tab.wait(lambda: _wait_for_solid(tab) == volume, "the volume of Table 1 again")


def test_two_tabs_agree_and_a_reload_loses_nothing(
    tab: Tab, served: Served, open_page: Open
) -> None:
    one, two = tab, open_page(served)
    one.type_into("x (mm)", 300.5)
    two.wait(lambda: two.value("x (mm)") == 300.5, "the other tab's x")
    two.type_into("φ (°)", 12)
    one.wait(lambda: one.value("φ (°)") == 12, "the other tab's φ")
    one.wait(lambda: _pose_text(one) == _pose_text(two), "the same pose in both tabs")
    one.page.reload()
    one.wait(lambda: "φ (°)" in one.text() and one.value("φ (°)") == 12, "the same φ after reload")
    assert one.value("x (mm)") == 300.5


def test_an_unreachable_pose_is_told_with_limb_and_amount(tab: Tab) -> None:
    tab.type_into("y (mm)", 600)
    tab.wait_for_text(r"Not reachable · mode [+−]+ · limb \d")
    tab.wait_for_text("cannot close")
    tab.wait_for_text("No working mode reaches this pose|Within reach in mode")
    tab.page.get_by_role("button", name="Home position").click()
    tab.wait_for_text("Reachable · mode")


@pytest.mark.parametrize("typed", ["1e999", "99999999", "-5000"])
def test_numbers_out_of_range_never_reach_the_machine(tab: Tab, typed: str) -> None:
    tab.wait_for_text("Reachable")
    tab.type_into("z (mm)", typed)
    tab.page.wait_for_timeout(600)
    assert abs(tab.value("z (mm)")) < 2000
    tab.type_into("z (mm)", 200)
    tab.wait(lambda: tab.value("z (mm)") == 200, "the next number works")


def test_vertex_spaces_and_holes_have_switches(tab: Tab) -> None:
    tab.open_tab("Workspace")
    tab.unfold("Vertex spaces")
    tab.check("All limbs").click()
    for n in range(1, 6):
        tab.wait(lambda n=n: bool(tab.props(f"/solids/limb{n}/whole").get("visible")), f"limb {n}")
    tab.wait_for_text("Limb 5: vertex space: ")
    tab.page.get_by_role("checkbox", name="Limb 2: hole H₂ (Fig. 10)").click()
    tab.wait(lambda: bool(tab.props("/solids/limb2/H2").get("visible")), "hole H2 of limb 2")


def test_undo_and_redo_by_hotkey(tab: Tab) -> None:
    x = tab.value("x (mm)")
    tab.type_into("x (mm)", x + 10)
    tab.wait(lambda: tab.value("x (mm)") == x + 10, "x + 10")
    tab.page.wait_for_timeout(300)
    tab.page.mouse.click(12, 330)  # a hotkey goes to the page, not to the number box
    tab.page.keyboard.press("Control+z")
    tab.wait(lambda: tab.value("x (mm)") == x, "x again")
    tab.page.keyboard.press("Control+y")
    tab.wait(lambda: tab.value("x (mm)") == x + 10, "x + 10 again")


def test_the_death_of_the_solids_process_is_survived(tab: Tab, served: Served) -> None:
    before = _wait_for_solid(tab)
    children = subprocess.run(
        ["ps", "-ww", "--ppid", str(served.process.pid), "-o", "pid=,args="],
        capture_output=True,
        encoding="utf-8",
        check=True,
    ).stdout
    solids = [int(line.split()[0]) for line in children.splitlines() if "spawn_main" in line]
    assert solids
    for pid in solids:
        os.kill(pid, signal.SIGKILL)
    tab.open_tab("Move")
    tab.type_into("θ (°)", 20)
    tab.wait(lambda: _wait_for_solid(tab) != before, "a solid from a new process")


def test_a_session_file_opens_as_it_was_left(serve: Serve, open_page: Open, tmp_path: Path) -> None:
    file = tmp_path / "review.json"
    served = serve("rpur-table2", "--session", str(file))
    tab = open_page(served)
    tab.type_into("φ (°)", 7)
    tab.wait(lambda: file.exists() and '"phi_deg": 7' in file.read_text(), "the saved session")
    served.stop()
    again = open_page(serve("--session", str(file)))
    assert again.value("φ (°)") == 7
    again.open_tab("Design")
    assert "Table 2" in again.text()
