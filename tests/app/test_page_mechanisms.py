"""Every mechanism on the page, used as a person uses it, without a browser."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterator
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from app.features.design.state import UseDesign
from app.features.move.state import Flip, GoHome, Place
from app.features.singularities.compute import Here
from app.features.singularities.part import ControlPart
from app.features.singularities.state import Control, SetControl
from app.features.workspace.part import RegionsPart
from app.features.workspace.state import ChooseModes, Flat, SetFlat
from app.review import session
from app.review.changes import Restore
from app.review.state import Review, new_review
from app.review.units import how_far
from app.scene import palette
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from tests.app.seats import Seat, seat

MACHINES = ("rpur-table1", "five-bar", "rps-3", "spr-3", "sps-spr")
TRIPODS = ("rps-3", "spr-3")
COMMON = ["Move", "Solutions", "Workspace", "Singularities", "Trajectory", "Design", "Review"]
LOAD = (-30.0, 20.0, -100.0, 50.0, -2000.0, 700.0)

Open = Callable[[str], Seat]


@pytest.fixture(scope="module")
def shared() -> Iterator[Seat]:
    with seat("five-bar") as made:
        yield made


@pytest.fixture
def opened(shared: Seat) -> Open:
    """The one page, on a fresh review of a preset."""

    def start(name: str) -> Seat:
        shared.do(Restore(new_review(load_design(name))))
        shared.told.clear()
        shared.files.clear()
        return shared

    return start


def _here(seat: Seat) -> Here:
    here = seat.page.part(ControlPart).controlled().here
    assert here is not None
    assert here.place.pose == seat.review.pose
    return here


def _coordinates(review: Review) -> list[str]:
    design = review.design
    axes = [*machine_of(design).coordinates, *machine_of(design).joints]
    return [f"{c.symbol} ({'mm' if c.unit == 'mm' else '°'})" for c in axes]


# --- every machine


@pytest.mark.parametrize("name", MACHINES)
def test_the_tabs_are_those_that_the_machine_has_a_use_for(opened: Open, name: str) -> None:
    page = opened(name)
    design = page.review.design
    more = {"Section": machine_of(design).section_spec, "Map": machine_of(design).map_spec}
    views = [t for t, has in more.items() if has is not None]
    wanted = [
        *COMMON,
        "This design",
        "Compare",
        "Session",
        "Marks",
        *(["Solid", *views] if views else []),
    ]
    assert sorted(page.tabs) == sorted(wanted)
    assert set(_coordinates(page.review)) <= page.labels()
    assert "Reachable" in page.text()
    assert not page.told


@pytest.mark.parametrize("name", MACHINES)
def test_it_moves_by_its_pose_and_by_its_actuators_and_goes_home(opened: Open, name: str) -> None:
    page = opened(name)
    home = page.review
    design = home.design
    for by_pose in (True, False):
        axes = machine_of(design).coordinates if by_pose else machine_of(design).joints
        label = f"{axes[0].symbol} ({'mm' if axes[0].unit == 'mm' else '°'})"
        before = page.review
        step = 3.0 if by_pose else -2.0
        page.put(label, page.widget(label).value + step)
        after = page.review
        assert after.pose != before.pose
        assert after.posture.reachable
        assert after.posture.residual < 1e-7
        joints, were = np.array(after.posture.joints), np.array(before.posture.joints)
        if by_pose:
            assert after.pose[0] - before.pose[0] == pytest.approx(step, abs=1e-9)
        else:
            scale = 1.0 if axes[0].unit == "mm" else math.radians(1.0)
            assert joints[0] == pytest.approx(round(were[0] / scale, 1) * scale + step * scale)
            assert joints[1:] == pytest.approx(were[1:], abs=1e-7)
        shown = page.server.scene._handle_from_node_name["/handle"]
        at = machine_of(design).transform(after.pose, after.mode)
        assert shown.position == pytest.approx(at[:3, 3], abs=1e-9)
        assert page.page.part(ControlPart).controlled().stale is False
    page.press("Home position")
    assert page.review.pose == home.pose
    page.press("Undo")
    assert page.review == after
    assert not page.told


@pytest.mark.parametrize("name", MACHINES)
def test_dragging_the_handle_and_putting_it_back(opened: Open, name: str) -> None:
    page = opened(name)
    home = page.review
    handle = page.node("/handle")
    at = np.add(handle.position, (2.0, 1.0, 3.0))
    for phase in ("start", "update", "end"):
        page.drag("/handle", at.tolist(), phase)
    assert page.review.pose != home.pose
    true = home.machine.transform(page.review.pose, page.review.mode)
    assert page.node("/handle").position == pytest.approx(true[:3, 3], abs=1e-9)
    page.press("Undo")
    assert page.review == home


@pytest.mark.parametrize("name", MACHINES)
def test_the_load_is_dragged_and_the_limbs_hold_it(opened: Open, name: str) -> None:
    page = opened(name)
    page.put("Arrow to drag", True)
    page.put("Forces on the limbs", True)
    page.do(SetControl("load", LOAD))
    here = _here(page)
    assert here.wrenches is not None
    assert here.statics is not None
    # What the arrows show holds what can be held of the load, and begins at the limbs.
    rows = np.asarray(here.wrenches.rows)
    held = here.exerted @ rows
    plane = np.linalg.lstsq(rows.T, np.array(LOAD), rcond=None)[0] @ rows
    assert held == pytest.approx(-plane, abs=1e-6 * np.abs(LOAD).max())
    arrows = np.asarray(page.node("/control/forces").points, dtype=float)
    forces = here.exerted[:, None] * rows[:, :3]
    longest = np.linalg.norm(forces, axis=1).max()
    reach = 0.45 * page.page.view.drawing.size / longest
    for start, tip in arrows:
        n = int(np.linalg.norm(np.asarray(here.wrenches.point) - start, axis=1).argmin())
        near = [
            f for f, p in zip(forces, here.wrenches.point, strict=True) if np.allclose(p, start)
        ]
        assert any(np.allclose(tip - start, reach * f, atol=1e-3) for f in near or [forces[n]])
    # Limbs that are pushed by the load push back.
    joints = here.place.machine.joints
    unit = "N" if joints[0].unit == "mm" else "N·mm"
    texts = [page.node(n).text for n in page.seen("/control/labels/force")]
    assert any(re.fullmatch(rf"[\d.e+]+ {unit}( push| pull)?", text) for text in texts)
    assert any("pu" in text for text in texts) == (unit == "N")
    told = page.text()
    largest = max(map(abs, here.statics.forces))
    for symbol, value in zip(here.statics.names, here.statics.forces, strict=True):
        value = value if abs(value) > 1e-9 * largest else 0.0  # else it is rounding
        assert f"{symbol.symbol} {value:.4g}".replace("-", "−") in told
    # The arrow's tip is the load, to the scale of the scene.
    view = page.page.view
    tip = np.array(page.node("/control/tip").position)
    scale = page.page.part(ControlPart)._loads.scale(view)
    assert (tip - view.platform[:3, 3]) / scale == pytest.approx(LOAD[:3])
    page.drag("/control/tip", view.platform[:3, 3] + scale * np.array([10.0, 0.0, -40.0]))
    page.drag("/control/tip", page.node("/control/tip").position, "end")
    assert page.review[Control].load == (10.0, 0.0, -40.0, *LOAD[3:])
    page.put("Arrow to drag", False)
    page.put("Forces on the limbs", False)
    for name in ("/control/load", "/control/tip", "/control/labels/force"):
        assert not page.seen(name)


@pytest.mark.parametrize("name", MACHINES)
def test_rates_are_typed_and_the_actuators_answer(opened: Open, name: str) -> None:
    page = opened(name)
    design = page.review.design
    axes = machine_of(design).coordinates
    page.put("Rates", ", ".join("10" for _ in axes))
    rates = tuple(10.0 if c.unit == "mm" else math.radians(10.0) for c in axes)
    assert page.review[Control].rates == pytest.approx(rates)
    motion = _here(page).motion
    assert motion is not None
    # Against a difference of the inverse kinematics, along the rates that are true.
    true, step = np.asarray(motion.pose_rates), 1e-5
    ahead, behind = (
        np.array(
            machine_of(design)
            .inverse.posture(tuple(page.review.pose + s * step * true), page.review.mode)
            .joints
        )
        for s in (1, -1)
    )
    assert motion.joint_rates == pytest.approx((ahead - behind) / (2 * step), abs=2e-4)
    assert page.seen("/control/rates")
    assert any("mm/s" in page.node(n).text for n in page.seen("/control/labels/rate"))
    asked = page.text()
    assert ("follows:" in asked) == bool(machine_of(design).dependent)
    page.put("Rates", "1, 2")
    if len(axes) != 2:
        assert "numbers with commas" in page.told[-1]
        assert page.widget("Rates").value.count(",") == len(axes) - 1
    page.put("Rates", "")
    assert page.review[Control].rates == ()
    assert not page.seen("/control/rates")


@pytest.mark.parametrize("name", MACHINES)
def test_every_chart_is_drawn_pointed_at_and_saved(opened: Open, name: str) -> None:
    page = opened(name)
    review = page.review
    design = review.design
    for spec in machine_of(design).singularities.loci:
        if spec.key == "section":
            continue
        page.do(GoHome())
        page.put("Chart", spec.title)
        assert page.review[Control].chart == spec.key
        pictures = [h for h in page.html() if f'aria-label="{spec.title}' in h]
        assert len(pictures) == 1
        picture = re.search(r"<svg.*</svg>", pictures[0], re.DOTALL)
        assert picture is not None
        root = ElementTree.fromstring(picture[0])
        curves = [p for p in root.iter("path") if "locus" in p.get("class", "")]
        known = page.page.part(ControlPart).controlled().curves
        assert known is not None
        assert len(curves) == len(known.kinds)
        assert "exact to" in page.text() or not curves
        symbols = {c.symbol: n for n, c in enumerate(machine_of(design).coordinates)}
        before = page.review.pose
        page.point(spec.title, 12.0, 8.0)
        if set(spec.axes) <= set(symbols):
            at = [page.review.pose[symbols[s]] for s in spec.axes]
            scale = [math.radians(1.0) if u == "rad" else 1.0 for u in spec.units]
            if spec.polar:
                wanted = [math.hypot(12.0, 8.0) * scale[0], math.atan2(8.0, 12.0)]
            else:
                wanted = [12.0 * scale[0], 8.0 * scale[1]]
            assert at == pytest.approx(wanted)
        else:
            assert page.review.pose == before
            assert "to go there" not in pictures[0]
        for file_kind in ("csv", "svg"):
            page.ask(page.page.part(ControlPart).save_curves, file_kind, None)
        csv, svg = page.files[-2:]
        assert csv.data.count(b"\n") > len(known.points)
        ElementTree.fromstring(svg.data.decode())
    page.put("Chart", "Nothing")
    assert page.review[Control].chart == ""
    assert not any('class="locus' in h for h in page.html())
    assert not page.told


@pytest.mark.parametrize("name", MACHINES)
def test_wrenches_and_clearances_are_drawn(opened: Open, name: str) -> None:
    page = opened(name)
    page.put("Wrench lines", True)
    page.put("Nearest limits", True)
    here = _here(page)
    assert here.wrenches is not None
    forces = np.linalg.norm(np.asarray(here.wrenches.rows)[:, :3], axis=1) > 0
    assert len(page.seen("/control/wrench")) == int(forces.sum())
    assert bool(page.seen("/control/ways")) == bool(here.clearances)
    told = page.text()
    for way in here.clearances[:9]:
        assert how_far(way, 2) in told
        assert way.along in told
    turned = [way for way in here.clearances[:9] if way.angle is not None]
    assert len(re.findall(r"by turning \d+\.\d\d°", told)) == len(turned)


@pytest.mark.parametrize("name", MACHINES)
def test_beyond_its_reach_the_way_out_is_offered_and_taken(opened: Open, name: str) -> None:
    page = opened(name)
    axes = page.review.machine.coordinates
    far = next(c for c in reversed(axes) if c.unit == "mm")
    page.put(f"{far.symbol} (mm)", 0.999 * far.upper)
    assert not page.review.posture.reachable
    assert "Not reachable" in page.text()
    remedy = _here(page).remedy
    assert remedy is not None
    if remedy.nearest is not None:
        page.press("Go to that pose")
        assert page.review.posture.reachable
    page.press("Home position")
    assert page.review.posture.reachable


def test_nothing_of_the_last_machine_stays(opened: Open) -> None:
    """From every machine to every other, with everything switched on."""
    page = opened("five-bar")
    page.put("Joint names", True)
    page.put("Axes e₁, e₂", True)
    page.put("Forces on the limbs", True)
    page.put("Arrow to drag", True)
    order = "five-bar rps-3 five-bar spr-3 rps-3 rpur-table1 five-bar sps-spr rpur-table1 spr-3"
    for name in [*order.split(), "sps-spr", "rps-3", "sps-spr", "five-bar"]:
        page.open(name)
        drawing = page.page.view.drawing
        names = {f"/labels/{m.name}" for m in (*drawing.points, *drawing.axes)}
        own = re.compile(r"/labels/(grid|force\d|limb\d)$")
        assert {n for n in page.seen("/labels/") if not own.match(n)} <= names
        axes = {f"/axes/{m.name}" for m in drawing.axes}
        assert set(page.seen("/axes/")) == axes
        bodies = {f"/machine/{body.name}" for body in drawing.bodies}
        rims = {f"{body}/rim" for body in bodies}
        assert set(page.seen("/machine/")) == bodies | rims | {"/machine/bars"}
        flat = page.review.machine.region_specs
        assert bool(page.seen("/regions/")) == bool(flat)
        at = page.page.view.platform
        assert page.node("/handle").position == pytest.approx(at[:3, 3])
        bars = np.asarray(page.node("/machine/bars").batched_scales)
        assert (bars[:, 0] > 0).sum() <= len(drawing.bars)
    assert not page.told


def test_a_handle_that_is_hidden_stays_hidden(opened: Open) -> None:
    page = opened("five-bar")
    page.put("Drag handle", False)
    page.open("rps-3")
    assert not page.seen("/handle")
    page.put("Drag handle", True)
    page.open("five-bar")
    assert page.seen("/handle")


@pytest.mark.parametrize("name", MACHINES)
def test_a_review_is_opened_as_it_was_saved(opened: Open, name: str) -> None:
    page = opened(name)
    page.put("Wrench lines", True)
    page.put("Forces on the limbs", True)
    specs = page.review.machine.singularities.loci
    page.do(SetControl("chart", specs[0].key))
    saved = session.to_text(page.review)
    kept = page.review
    page.open("rps-3" if name != "rps-3" else "five-bar")
    page.do(Restore(session.from_text(saved, origin="x")))
    assert page.review[Control] == kept[Control]
    assert page.review.pose == pytest.approx(kept.pose, abs=1e-12)
    assert json.loads(session.to_text(page.review)) == json.loads(saved)
    assert not page.told


# --- tripods


@pytest.mark.parametrize("name", TRIPODS)
def test_the_chart_has_the_inscribed_circle_and_the_machines_cross(opened: Open, name: str) -> None:
    page = opened(name)
    (spec,) = page.review.machine.singularities.loci
    page.put("Chart", spec.title)
    (picture,) = [h for h in page.html() if 'class="micr"' in h]
    circle = next(c for c in _here(page).circles if c.limit == "parallel")
    # One degree on the page, from the rings: the outermost is the end of the chart.
    (box,) = re.findall(r'data-box="([^"]*)"', picture)
    _, _, wide, _, low, high, *_ = map(float, box.split())
    (drawn,) = re.findall(r'class="micr"[^>]* r="([\d.]+)"', picture)
    assert float(drawn) == pytest.approx(
        math.degrees(circle.radius) * wide / (high - low), abs=0.06
    )
    page.point(spec.title, 5.0, 0.0)
    assert page.review.pose[1:] == pytest.approx((math.radians(5.0), 0.0))
    assert sum('class="over"' in h for h in page.html()) >= 1


@pytest.mark.parametrize("name", TRIPODS)
def test_side_by_side_with_its_counterpart(opened: Open, name: str) -> None:
    page = opened(name)
    other = "3-SPR" if name == "rps-3" else "3-RPS"
    alone = len(page.seen("/machine/"))
    page.put(f"Beside the {other}", True)
    assert len(page.seen("/machine/other ")) == 4  # base and platform, each with its rim
    labels = [page.node(n).text for n in page.seen("/labels/machine")]
    assert labels == ["3-RPS", "3-SPR"] if name == "rps-3" else ["3-SPR", "3-RPS"]
    beside = page.page.view.beside
    assert beside is not None
    assert beside.posture.pose == page.review.pose
    assert {row.limb % len(palette.LIMBS) for row in beside.joints} == {1, 2, 3}
    assert [palette.limb_color(row.limb) for row in beside.joints] == list(palette.LIMBS[:3])
    controlled = page.page.part(ControlPart).controlled()
    assert controlled.beside is not None
    assert controlled.beside.place.design == beside.design
    assert "Circle to a singularity" in page.text()
    (spec,) = page.review.machine.singularities.loci
    page.put("Chart", spec.title)
    assert sum('class="micr"' in h for h in page.html()) == 2
    assert len([h for h in page.html() if f'aria-label="{spec.title}' in h]) == 2
    # The counterpart goes with the machine and never stays behind.
    page.put("θ (°)", 10.0)
    moved = page.page.view.beside
    assert moved is not None
    assert moved.posture.pose == page.review.pose
    page.open("spr-3" if name == "rps-3" else "rps-3")
    controlled = page.page.part(ControlPart).controlled()
    assert page.review[Control].compare
    assert controlled.beside is not None
    assert controlled.beside.place.design.mechanism != page.review.design.mechanism
    page.do(SetControl("compare", False))
    assert len(page.seen("/machine/")) == alone
    assert not page.seen("/labels/machine")


@pytest.mark.parametrize("name", TRIPODS)
def test_the_operation_mode_changes_only_where_modes_meet(opened: Open, name: str) -> None:
    page = opened(name)
    home = page.review
    other = next(m for m in home.machine.modes if m != home.mode)
    page.press(f"operation mode {other}")
    assert "begins at a tilt of 180°" in page.told[-1]
    assert page.review == home
    chosen = [h for h in page.html() if f'data-send="{home.mode}" aria-pressed="true"' in h]
    assert chosen
    page.press("Go where modes meet")
    there = page.review
    assert there.mode == home.mode
    assert there.pose[1] == pytest.approx(math.pi)
    assert not page.widget("Go where modes meet").visible
    page.press(f"operation mode {other}")
    assert page.review.mode == other
    before = machine_of(home.design).transform(there.pose, there.mode)
    after = machine_of(home.design).transform(page.review.pose, page.review.mode)
    assert after == pytest.approx(before, abs=1e-6)
    page.press("Undo")
    assert page.review == there
    page.press("Undo")
    assert page.review == home


@pytest.mark.parametrize("name", TRIPODS)
def test_the_profile_goes_to_an_altitude_and_compares_ratios(opened: Open, name: str) -> None:
    page = opened(name)
    page.put("Further h₂/h₁", "0.5, 1, 2")
    assert page.review[Control].ratios == (0.5, 1.0, 2.0)
    ((_, profile), *_) = page.page.part(ControlPart).controlled().profiles
    more = {c.title for c in profile.curves if not c.own}
    assert more >= {"h₂/h₁ = 1", f"h₂/h₁ = {'2' if name == 'rps-3' else '0.5'}"}
    page.point(profile.title, 1.25, 0.0)
    assert page.page.part(ControlPart).controlled().profiles[0][1].at == pytest.approx(1.25)
    for text in ("a", "0.5, -1", "nan", "1e999"):
        page.put("Further h₂/h₁", text)
        assert "ratio" in page.told[-1]
        assert page.review[Control].ratios == (0.5, 1.0, 2.0)
        assert page.widget("Further h₂/h₁").value == "0.5, 1, 2"


# --- 4-SPS + 1-SPR


@pytest.mark.parametrize("way", ["x", "y", "alpha", "beta", "gamma"])
def test_the_coordinate_that_gives_way_keeps_the_constraint(opened: Open, way: str) -> None:
    page = opened("sps-spr")
    axes = page.review.machine.coordinates
    keys = [c.key for c in axes]
    page.put("γ (°)", 7.0)  # away from home, where nothing follows from some coordinates
    page.put("β (°)", -9.0)
    page.put("Gives way", axes[keys.index(way)].symbol)
    assert page.review.gives_way == way
    for n, c in enumerate(axes):
        if c.key == way:
            continue
        before = page.review.pose
        label = f"{c.symbol} ({'mm' if c.unit == 'mm' else '°'})"
        page.put(label, page.widget(label).value + 1.0)
        after = page.review.pose
        if page.told:  # no value of that coordinate is enough
            assert after == before
            page.told.clear()
            continue
        changed = {keys[i] for i in range(6) if abs(after[i] - before[i]) > 1e-12}
        assert c.key in changed
        assert changed <= {c.key, way}
        assert page.review.posture.residual < 1e-9
        assert page.review.posture.closes
        assert n < 6
    page.put("Gives way", "what suits best")
    assert page.review.gives_way == ""


def test_editing_the_revolute_axis_leaves_the_machine_assembled(opened: Open) -> None:
    page = opened("sps-spr")
    page.put("β (°)", 12.0)
    page.put("n₆ x", 1.2)
    assert page.review.posture.closes
    assert page.review.posture.residual < 1e-9


# --- five-bar


def test_regions_in_the_plane_are_chosen_told_and_saved(opened: Open) -> None:
    page = opened("five-bar")
    page.do(ChooseModes("all"))
    review = page.review
    for spec in review.machine.region_specs:
        page.put("Regions", spec.title)
        found = review.machine.regions.of(spec.key, review.pose, None)
        drawn = [region for region in found if region.mode in ("", review.mode)]
        assert len(page.seen("/regions/fill")) == min(len(drawn), 12)
        text = page.text()
        for region in found:
            assert region.title in text
        for file_kind in ("svg", "dxf", "csv"):
            page.ask(page.page.part(RegionsPart).save_regions, file_kind, None)
        ElementTree.fromstring(page.files[-3].data.decode())
    assert page.seen("/regions/locus")
    page.do(SetFlat("locus", False))
    assert not page.seen("/regions/locus")
    page.do(SetFlat("on", False))
    assert not page.seen("/regions/")
    page.ask(page.page.part(RegionsPart).save_regions, "svg", None)
    assert "no regions to save" in page.told[-1]


def test_another_five_bar_keeps_what_is_shown_of_its_plane(opened: Open) -> None:
    page = opened("five-bar")
    page.do(SetFlat("key", "aspects"))
    page.put("half base r₃ (mm)", 200.0)
    assert page.review[Flat].key == "aspects"
    page.do(UseDesign(page.review.design), UseDesign(load_design("five-bar")))
    assert page.review[Flat].key == "aspects"
    assert page.seen("/regions/fill")
    page.open("sps-spr")
    assert page.review[Flat].key == "workspace"


def test_five_bar_modes_turn_over_limb_by_limb(opened: Open) -> None:
    page = opened("five-bar")
    for mode in page.review.machine.modes:
        before = page.review
        page.do(Flip(mode))
        assert page.review.pose == before.pose or page.told


def test_a_change_that_cannot_be_drawn_is_not_kept(
    opened: Open, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    seated = opened("five-bar")
    page, home = seated.page, seated.review
    draw, said, undoable = page.scene.show, [], page.sheet().can_undo
    monkeypatch.setattr(page, "_notify", lambda text, client: said.append(text))

    def show(view: Any, **options: Any) -> None:
        if view.review.pose != home.pose:
            raise RuntimeError("no such picture")
        draw(view, **options)

    monkeypatch.setattr(page.scene, "show", show)
    page.send(Place((100.0, 700.0), gesture=""))
    page._turn([page._inbox.get_nowait()])
    assert len(said) == 1
    assert "the last change was lost" in said[0]
    assert "no such picture" in caplog.text
    seated.settle()
    assert seated.review == home
    assert page.sheet().can_undo == undoable
    page._turn(["redraw"])
    assert len(said) == 1
