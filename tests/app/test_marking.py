"""Marks on the page: views kept and pressed, notes pinned, things clicked and measured."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.features.marks.compute import measured, things
from app.features.marks.model import Anchor, Dimension
from app.features.marks.part import MarksPart
from app.features.marks.snapping import snapped
from app.features.marks.state import Marks
from app.features.move.state import Move
from app.features.workspace.part import corners_of
from app.review.changes import SetOption
from app.review.state import Options, new_review
from app.review.view import View, view
from app.scene.camera import machine_points
from app.scene.pointer import Pointer, on_screen
from kinematics.arrays import Array
from kinematics.designs.files import load_design
from tests.app.seats import Browser, Seat, seat


@pytest.fixture
def page() -> Iterator[Seat]:
    """A 5-RPUR before somebody who looks at it."""
    with seat("rpur-table1") as made:
        made.browser = Browser(machine_points(made.page.view.drawing))
        yield made


def _at(page: Seat, name: str) -> Array:
    return np.array(next(m.position for m in page.page.view.drawing.points if m.name == name))


def _label(page: Seat, name: str) -> str:
    node = page.node(f"/labels/{name}")
    return str(node.text) if node.visible else ""


def test_a_distance_is_clicked_drawn_listed_and_follows_the_machine(page: Seat) -> None:
    page.press("Measure")
    a, b = _at(page, "limb1/A"), _at(page, "limb3/C")
    assert "Click thing 1 of 2" in page.text()
    assert not page.node("/handle").visible  # it would be in the way
    page.click(page.browser, a + np.array([1.0, 0.0, 0.0]))
    assert _label(page, "near") == "A₁"
    assert "Click thing 2 of 2" in page.text()
    assert "So far: A₁" in page.text()
    page.click(page.browser, b)
    between = (Anchor("point", "limb1/A"), Anchor("point", "limb3/C"))
    assert page.review[Marks].dimensions == (Dimension("", between),)
    told = f"{np.linalg.norm(b - a):.2f} mm"
    assert _label(page, "dimension0") == told
    assert f"A₁ – C₃ Δx {b[0] - a[0]:.1f}".replace("-", "−") in page.text()
    page.do(Move(0, page.review.pose[0] + 40.0))
    moved = f"{np.linalg.norm(_at(page, 'limb3/C') - a):.2f} mm"
    assert moved != told
    assert _label(page, "dimension0") == moved
    assert moved in page.text()
    other = view(replace(page.review, pose=tuple(0.97 * v for v in page.review.pose)))
    page.page.scene.show(other, dragging=False)  # as while a trajectory is played
    there = np.array(next(m.position for m in other.drawing.points if m.name == "limb3/C"))
    assert _label(page, "dimension0") == f"{np.linalg.norm(there - a):.2f} mm"
    page.write("Name of dimension 1", "arm: 1 – 3")
    assert _label(page, "dimension0") == f"arm: 1 – 3: {moved}"
    page.press("Stop (Esc)")
    page.page.point(Pointer(page.browser, 0, None))
    page.settle()
    assert page.node("/handle").visible
    page.put("Show marks", False)
    assert not page.seen("/marks/dimensions")
    assert _label(page, "dimension0") == ""
    page.put("Show marks", True)
    page.press("Remove A₁ – C₃")
    assert not page.review[Marks].dimensions
    page.page.undo()
    page.settle()
    assert _label(page, "dimension0") == f"arm: 1 – 3: {moved}"


def test_things_can_be_chosen_from_a_list_and_typed(page: Seat) -> None:
    page.press("Measure")
    page.put("Or from a list", "base plane")
    page.put("Or a place", "10, 20")
    assert page.told[-1] == "a place is three numbers: x, y, z in mm"
    page.put("Or a place", "10 20 -30.5")
    assert "(10.0, 20.0, −30.5) – base plane" in page.text() or "base plane – (10.0" in page.text()
    assert _label(page, "dimension0") == "30.50 mm"
    page.put("Or from a list", "base plane")
    page.put("Or from a list", "base plane")
    assert "between two different things" in page.told[-1]
    assert len(page.review[Marks].dimensions) == 1
    page.press("Angle at a point")
    for name in ("A₁", "A₂", "A₃"):
        page.put("Or from a list", name)
    a, b, c = (_at(page, f"limb{n}/A") for n in (1, 2, 3))
    cos = (a - b) @ (c - b) / np.linalg.norm(a - b) / np.linalg.norm(c - b)
    assert _label(page, "dimension1") == f"{math.degrees(math.acos(cos)):.2f}°"


def test_a_view_is_kept_pressed_renamed_and_removed(page: Seat) -> None:
    camera = page.browser.camera
    before = np.array(camera.position)
    page.put("View name", "whole")
    page.put("With the pose", True)
    page.press("Keep this view")
    page.do(Move(0, 60.0), SetOption("frames", False))
    camera.position, camera.fov = before + 100.0, 0.1
    page.press("Show whole")
    assert camera.position == pytest.approx(before)
    assert camera.fov == pytest.approx(math.radians(30.0))
    assert page.review[Options].frames
    assert page.review.pose == page.review.machine.home.pose
    camera.aspect /= 2.0  # a narrower window shows as much, from farther off
    page.press("Show whole")
    away = np.linalg.norm(camera.position - camera.look_at)
    assert away == pytest.approx(2.0 * np.linalg.norm(before - camera.look_at))
    page.write("Name of view 1", "")
    assert page.told[-1] == "a view needs a name"
    page.write("Name of view 1", "all of it")
    page.press("Remove all of it")
    assert not page.review[Marks].views
    page.browser = type(page.browser).__new__(Browser)  # one that has told nothing yet
    page.put("View name", "x")
    page.press("Keep this view")
    assert "of one browser's picture" in page.told[-1]


def test_a_note_is_pinned_goes_back_and_follows_its_joint(page: Seat) -> None:
    page.press("Pin to a point")
    assert page.told[-1] == "a note needs a text"
    page.put("Note", "too <b>long</b>")
    page.press("Pin to a point")
    assert "Click a joint, a corner or a line" in page.text()
    page.click(page.browser, _at(page, "limb2/C"))
    note = page.review[Marks].notes[0]
    assert note.anchor == Anchor("point", "limb2/C")
    assert note.pose == page.review.pose
    assert "Choose in the scene" not in page.text()
    assert page.widget("Note").value == ""
    assert not page.page.scene.aside
    page.put("Note", "here")
    page.press("Pin to this pose")
    home = page.review.pose
    page.do(Move(0, home[0] + 40.0))
    feet = np.array(page.node("/marks/stems").points)[:, 0]
    assert feet[0] == pytest.approx(_at(page, "limb2/C"), abs=1e-3)
    assert feet[1] == pytest.approx(page.page.view.platform[:3, 3] - [40.0, 0.0, 0.0], abs=1e-3)
    assert [_label(page, f"note{n}") for n in (0, 1)] == ["1", "2"]
    page.write("Text of note 2", "here, too")
    assert page.review[Marks].notes[1].text == "here, too"
    page.browser.camera.fov = 0.1
    page.press("Go where note 1 was written")
    assert page.review.pose == home
    assert page.browser.camera.fov == pytest.approx(math.radians(30.0))


def test_a_presentation_steps_through_views_and_notes(page: Seat) -> None:
    page.press("Present")
    assert "neither a saved view nor a note" in page.told[-1]
    page.put("View name", 'a "view"')
    page.press("Keep this view")
    page.put("Note", "look")
    page.press("Pin to this pose")
    page.press("Present")
    assert page.browser.scripts == ["window.bohemiaPresent();"]
    steps = next(
        piece
        for piece in page.html()
        if piece.startswith('<div class="bo-live"><div class="bo-steps')
    )
    assert "Note 1" in steps
    home = page.review.pose
    page.do(Move(0, home[0] + 40.0))
    part = page.page.part(MarksPart)
    page.ask(part.step, 0, page.browser)
    assert page.review.pose != home
    page.ask(part.step, 1, page.browser)
    assert page.review.pose == home
    page.ask(part.step, 2, page.browser)
    assert "not there any more" in page.told[-1]


# --- what is measured, and what a pointer is on


def _view(name: str) -> View:
    return view(new_review(load_design(name)))


@pytest.mark.parametrize(
    ("anchors", "text", "note"),
    [
        (("point", (3.0, 4.0, 12.0)), ("point", "base"), "13.00 mm"),
        (("point", (30.0, 4.0, 3.0)), ("line", "base/x"), "5.00 mm"),
        (("point", (3.0, 4.0, -12.0)), ("plane", "xz"), "4.00 mm"),
        (("line", "base/x"), ("line", "base/y"), "90.00°"),
        (("line", "base/x"), ("plane", "base"), "0.00°"),
        (("line", "base/z"), ("plane", "base"), "90.00°"),
        (("plane", "xz"), ("plane", "yz"), "90.00°"),
    ],
)
def test_measures_are_right(anchors: Any, text: Any, note: str) -> None:
    seen = _view("gough")
    made = [
        Anchor(kind, at=of) if isinstance(of, tuple) else Anchor(kind, of)
        for kind, of in (anchors, text)
    ]
    found = measured(things(seen), Dimension("", tuple(made)), seen.drawing.size)
    assert found is not None
    assert found.text == note
    assert np.isfinite(found.lines).all()


def test_lines_and_planes_are_told_how_far_they_are_apart() -> None:
    seen = _view("gough")
    known, size = things(seen), seen.drawing.size
    rails = [Anchor("line", f"limb{n}/rail") for n in (1, 3)]
    found = measured(known, Dimension("", (rails[0], rails[1])), size)
    u, v = (known[rail].along for rail in rails)
    across = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
    gap = abs(float((known[rails[1]].at - known[rails[0]].at) @ across))
    assert found is not None
    assert found.value == pytest.approx(math.acos(abs(float(u @ v))))
    assert found.note == f"{gap:.1f} mm apart"
    planes = Anchor("plane", "base"), Anchor("plane", "platform")
    level = measured(known, Dimension("", planes), size)
    assert level is not None
    assert level.text == "0.00°"
    assert level.note == f"{seen.platform[2, 3]:.1f} mm apart"


@pytest.mark.parametrize("name", ["rpur-table1", "five-bar", "sps-spr", "delta", "rps-3"])
def test_a_click_on_a_thing_chooses_it(name: str) -> None:
    """Each point that no other hides on the screen, lines in their middles, planes by bodies."""
    seen = _view(name)
    known = things(seen)
    client = Browser(machine_points(seen.drawing))
    points = [t for a, t in known.items() if a.kind == "point"]
    spots, _ = on_screen(client.camera, np.array([t.at for t in points]))
    apart = np.linalg.norm(spots[:, None] - spots, axis=-1) + 1e9 * np.eye(len(points))
    clear = [n for n in range(len(points)) if apart[n].min() > 20.0]
    assert len(clear) >= 4
    for n in clear:
        at = (float(spots[n, 0]) + 4.0, float(spots[n, 1]) - 4.0)
        found = snapped(Pointer(client, 0, at), seen, known, np.empty((0, 3)))
        assert found is points[n]
    rail = next(t for a, t in known.items() if a.kind == "line" and a.name.startswith("limb1/"))
    middle, _ = on_screen(client.camera, rail.ends.mean(axis=0)[None])
    if np.linalg.norm(spots - middle, axis=1).min() > 20.0:
        spot = (float(middle[0, 0]), float(middle[0, 1]))
        on = snapped(Pointer(client, 0, spot), seen, known, np.empty((0, 3)))
        assert on is not None
        assert on.anchor.kind == "line"
    planes = _planes_of(client, seen)
    assert "base" in planes
    assert "platform" in planes or name in ("five-bar", "delta")  # a point, and all joints
    assert snapped(Pointer(client, 0, (2.0, 2.0)), seen, known, np.empty((0, 3))) is None
    assert snapped(Pointer(client, 0, None), seen, known, np.empty((0, 3))) is None


def _planes_of(client: Any, seen: View) -> set[str]:
    """On whose planes a pointer is somewhere over the bodies."""
    known, found = things(seen), set()
    for body in seen.drawing.bodies:
        place = seen.platform if body.frame == "platform" else np.eye(4)
        corners = np.array(body.points) @ place[:3, :3].T + place[:3, 3]
        shares = np.random.default_rng(3).dirichlet(np.ones(len(corners)), 60)
        for x, y in on_screen(client.camera, shares @ corners)[0].tolist():
            on = snapped(Pointer(client, 0, (x, y)), seen, known, np.empty((0, 3)))
            found |= {on.anchor.name} if on is not None and on.anchor.kind == "plane" else set()
    return found


def test_a_corner_of_the_workspace_is_a_place() -> None:
    seen = _view("rpur-table1")
    client = Browser(machine_points(seen.drawing))
    corner = np.array([[10.0, 60.0, 500.0]])
    spot, _ = on_screen(client.camera, corner)
    at = (float(spot[0, 0]) + 2.0, float(spot[0, 1]))
    found = snapped(Pointer(client, 0, at), seen, things(seen), corner)
    assert found is not None
    assert found.anchor == Anchor("point", at=(10.0, 60.0, 500.0))


def test_corners_are_where_edges_meet() -> None:
    """Of a cube with an edge in two pieces."""
    corners = [np.array(c, float) for c in itertools.product((0, 1), repeat=3)]
    pairs = [(a, b) for a, b in itertools.combinations(corners, 2) if abs(a - b).sum() == 1.0]
    first, last = pairs.pop()
    edges = np.array([*pairs, (first, 0.5 * (first + last)), (0.5 * (first + last), last)])
    assert len(edges) == 13
    made: Any = SimpleNamespace(edges=edges)
    found = corners_of.__wrapped__(made)
    assert sorted(found.tolist()) == [c.tolist() for c in corners]
