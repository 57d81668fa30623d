"""Where the scene is seen from, what the ground is divided into, and where names stand."""

from __future__ import annotations

import contextlib
import itertools
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.review.changes import SetOption, change
from app.review.state import is_planar, new_review
from app.review.view import View, view
from app.scene import labels as naming
from app.scene.camera import (
    FIELD_OF_VIEW,
    FILLED,
    ISOMETRIC,
    NARROW,
    Aim,
    Aims,
    axes_of,
    frame,
    look,
    toward_of,
)
from app.scene.ground import footprint, scale_of
from app.scene.machine import HANDLE
from app.scene.shapes import base_floor, ground_cell
from kinematics.designs.files import load_design
from tests.app.seats import seat

MACHINES = ("rpur-table1", "rpur-table2", "sps-spr", "rps-3", "spr-3", "five-bar")


def _view(name: str) -> View:
    return view(new_review(load_design(name)))


def _seen(
    points: np.ndarray, position: np.ndarray, toward: np.ndarray, *, flat: bool
) -> np.ndarray:
    """Points (N, 3) in a picture: to the right and up by the distance, (N, 2)."""
    right, up, back = axes_of(toward, flat=flat)
    away = points - position
    return np.stack([away @ right, away @ up], axis=1) / (-away @ back)[:, None]


@pytest.mark.parametrize("flat", [False, True])
@pytest.mark.parametrize("name", ["isometric", "plan", "front", "side"])
def test_a_view_fills_its_share_of_the_picture(name: str, flat: bool) -> None:
    points = np.random.default_rng(4).uniform(-1.0, 1.0, (60, 3)) * [300.0, 150.0, 200.0] + 40.0
    toward = toward_of(flat, name)  # type: ignore[arg-type]
    for fov, aspect in itertools.product((FIELD_OF_VIEW, NARROW), (0.6, 1.0, 1.8)):
        position, target = frame(points, toward, fov, aspect, flat=flat)
        away = position - target
        assert away / np.linalg.norm(away) == pytest.approx(toward / np.linalg.norm(toward))
        seen = _seen(points, position, toward, flat=flat) / (math.tan(0.5 * fov) * FILLED)
        share = np.abs(seen / [aspect, 1.0]).max(axis=0)
        assert share.max() == pytest.approx(1.0, abs=1e-6)
        assert (share <= 1.0 + 1e-6).all()


def test_what_lies_over_the_foot_of_the_picture_hides_nothing() -> None:
    points = np.random.default_rng(4).uniform(-1.0, 1.0, (60, 3)) * [300.0, 150.0, 200.0] + 40.0
    toward = toward_of(False, "isometric")
    for aspect, foot in itertools.product((0.6, 1.0, 1.8), (0.2, 0.44)):
        position, target = frame(points, toward, FIELD_OF_VIEW, aspect, foot=foot)
        away = position - target
        assert away / np.linalg.norm(away) == pytest.approx(toward / np.linalg.norm(toward))
        x, y = (_seen(points, position, toward, flat=False) / math.tan(0.5 * FIELD_OF_VIEW)).T
        assert np.abs(x).max() < aspect
        assert y.min() > 2.0 * foot - 1.0  # from −1 at the foot to 1 at the top
        assert y.max() < 1.0


def test_what_lies_over_the_left_of_the_picture_hides_nothing() -> None:
    points = np.random.default_rng(4).uniform(-1.0, 1.0, (60, 3)) * [300.0, 150.0, 200.0] + 40.0
    toward = toward_of(False, "isometric")
    for aspect, left, foot in itertools.product((0.6, 1.0, 1.8), (0.2, 0.45), (0.0, 0.3)):
        position, target = frame(points, toward, FIELD_OF_VIEW, aspect, foot=foot, left=left)
        away = position - target
        assert away / np.linalg.norm(away) == pytest.approx(toward / np.linalg.norm(toward))
        x, y = (_seen(points, position, toward, flat=False) / math.tan(0.5 * FIELD_OF_VIEW)).T
        assert aspect * (2.0 * left - 1.0) < x.min()
        assert x.max() < aspect
        assert 2.0 * foot - 1.0 < y.min()
        assert y.max() < 1.0


def test_in_plan_x_is_to_the_right_and_y_up() -> None:
    for flat in (False, True):
        right, up, _ = axes_of(toward_of(flat, "plan"), flat=flat)
        assert right == pytest.approx([1.0, 0.0, 0.0], abs=2e-3)
        assert up == pytest.approx([0.0, 1.0, 0.0], abs=2e-3)


def test_a_planar_machine_opens_in_plan_and_others_from_the_front_right_above() -> None:
    assert toward_of(True) == pytest.approx([0.0, 0.0, 1.0])
    assert toward_of(False) == pytest.approx([0.55, -0.83, 0.36])
    for name in ("five-bar", "rpur-table1"):
        with seat(name) as page:
            camera = page.server.initial_camera
            away = camera.position - camera.look_at
            toward = toward_of(is_planar(page.review.machine))
            assert away / np.linalg.norm(away) == pytest.approx(toward / np.linalg.norm(toward))
            assert camera.fov == pytest.approx(FIELD_OF_VIEW)
            page.do(SetOption("parallel", True))
            page.page.fit_view()
            page.settle()
            assert camera.fov == pytest.approx(NARROW)


def test_a_fit_right_after_a_browser_has_come_keeps_the_view_that_it_was_given() -> None:
    aims: Aims = {}
    seen = _view("rpur-table1")
    camera = SimpleNamespace(
        position=np.array([3.0, 3.0, 3.0]),
        look_at=np.zeros(3),
        fov=1.3,
        aspect=1.4,
        image_height=5,
        image_width=7,
    )
    client = SimpleNamespace(client_id=5, camera=camera, atomic=contextlib.nullcontext)
    server: Any = SimpleNamespace(get_clients=lambda: {5: client}, initial_camera=camera)

    def toward() -> np.ndarray:
        away = camera.position - camera.look_at
        return np.asarray(away / np.linalg.norm(away))

    look(server, seen, (), None, client, aims=aims)
    first = toward()
    # viser's own view, reported late by the browser
    camera.position, camera.look_at = np.array([3.0, 3.0, 3.0]), np.zeros(3)
    look(server, seen, (), "fit", client, aims=aims)
    assert toward() == pytest.approx(first)
    # A person who has turned it since keeps what they see.
    aims[5] = replace(aims[5], reported=True)
    camera.position = camera.look_at + np.array([-100.0, 50.0, 70.0])
    turned = toward()
    look(server, seen, (), "fit", client, aims=aims)
    assert toward() == pytest.approx(turned)


def test_a_picture_of_another_shape_is_outgrown_until_somebody_turns_it() -> None:
    aim = Aim(0.0, ISOMETRIC, np.array([900.0, -1300.0, 800.0]), 1.4)
    for position, aspect, outgrown in (
        (aim.position, 1.41, False),
        (aim.position, 0.75, True),
        (aim.position + 0.5, 0.75, True),
        (1.02 * aim.position, 0.75, False),
    ):
        camera = SimpleNamespace(position=position, aspect=aspect)
        assert aim.outgrown(camera) == outgrown


@pytest.mark.parametrize("name", MACHINES)
def test_five_to_fifteen_cells_span_the_base(name: str) -> None:
    drawing = _view(name).drawing
    base = next(b for b in drawing.bodies if b.name == "base")
    span = np.ptp(np.array(base.points)[:, :2], axis=0).max() + 2.0 * base.radius
    cell = ground_cell(drawing)
    assert 5.0 <= span / cell <= 15.0
    assert f"{cell:e}"[0] in "125"
    assert f"{cell:e}"[1:9] == ".000000e"


def test_the_ground_is_below_everything_that_is_shown() -> None:
    with seat("rpur-table1") as page:
        drawing = page.page.view.drawing
        cell = ground_cell(drawing)
        floor = page.node("/grid").position[2]
        assert floor < base_floor(drawing)
        assert floor > base_floor(drawing) - 1.2 * cell
        page.page.scene.ground("something", np.array([[0.0, 0.0, -234.0], [0.0, 0.0, 9.0]]))
        assert -234.0 - 1.2 * cell < page.node("/grid").position[2] < -234.0
        page.page.scene.ground("something", None)
        assert page.node("/grid").position[2] == floor
        assert page.node("/footprint").position[2] > page.node("/grid").position[2]


def test_a_footprint_covers_the_base_from_above() -> None:
    points = np.array([[0.0, 0.0, 5.0], [40.0, 0.0, 9.0], [40.0, 30.0, 5.0], [0.0, 30.0, 5.0]])
    vertices, faces = footprint(points, 2.0)
    a, b, c = (vertices[faces[:, n], :2] for n in range(3))
    area = 0.5 * float(np.sum((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]))
    assert area == pytest.approx(40 * 30 + 2 * 2 * 70 + math.pi * 4, rel=2e-3)
    assert not vertices[:, 2].any()


@pytest.mark.parametrize("name", MACHINES)
def test_a_scale_has_round_numbers_where_they_belong(name: str) -> None:
    seen = _view(name)
    cell = ground_cell(seen.drawing)
    lines, numbers = scale_of(seen, cell, -500.0)
    assert [bool(axis) for axis in numbers] == [True, True, not is_planar(seen.review.machine)]
    assert np.isfinite(lines).all()
    for k, axis in enumerate(numbers):
        for n, (text, at) in enumerate(axis):
            assert at is not None
            bare = text.strip("xyz m").replace("−", "-")
            assert float(bare) == pytest.approx(at[k])
            assert (text.startswith("xyz"[k]) and text.endswith(" mm")) == (n == len(axis) - 1)


@pytest.mark.parametrize("name", MACHINES)
def test_names_are_apart_in_the_picture_at_rest(name: str) -> None:
    seen = _view(name)
    drawing, origin = seen.drawing, seen.platform[:3, 3]
    flat = is_planar(seen.review.machine)
    placed = naming.labels(drawing, origin, HANDLE * drawing.size, flat=flat)
    texts = " ".join(named.text for named in placed.values()).split()
    assert sorted(texts) == sorted(word for mark in drawing.points for word in mark.text.split())
    at = np.array([named.at for named in placed.values()])
    screen, _, _ = naming.on_screen(drawing, at, origin, 0.0, flat=flat)
    rects = [
        naming.rect_of(point, named.text, named.anchor)
        for point, named in zip(screen, placed.values(), strict=True)
    ]
    for one, two in itertools.combinations(rects, 2):
        apart = (one[:2] >= two[2:] - 1e-9) | (two[:2] >= one[2:] - 1e-9)
        assert apart.any()
    assert len(placed) >= len(drawing.points) // 2


def test_close_points_share_a_name_and_others_stand_outwards() -> None:
    seen = _view("rpur-table1")
    drawing, origin = seen.drawing, seen.platform[:3, 3]
    placed = naming.labels(drawing, origin, HANDLE * drawing.size, flat=False)
    assert placed["limb1/A"].anchor == "top-right"  # at the left of the machine, below its middle
    near = tuple(
        type(mark)(mark.name, mark.text, drawing.points[0].position) for mark in drawing.points[:2]
    )
    both = type(drawing)(drawing.bars, drawing.bodies, near, (), drawing.size)
    (only,) = naming.labels(both, origin, 0.0, flat=False).values()
    assert only.text == "A₁ B₁"


def test_the_scale_is_shown_on_demand() -> None:
    with seat("rps-3") as page:
        assert not page.seen("/scale")
        page.do(SetOption("scale", True))
        assert page.seen("/scale") == ["/scale"]
        texts = [getattr(page.node(n), "text", "") for n in page.seen("/labels/")]
        assert any(text.startswith("x ") and text.endswith(" mm") for text in texts)


def test_options_of_looking_are_no_changes_of_the_review() -> None:
    review = new_review(load_design("five-bar"))
    for name in ("scale", "parallel"):
        after, _ = change(review, SetOption(name, True))
        assert after.shown_as(review) == review
