"""Ghosts: outlines and faces that a browser draws from copies of one small shape."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from app.features.solutions.compute import NONE_YET, Listed, Row
from app.features.solutions.part import SolutionsPart
from app.features.solutions.scene import (
    NEAREST,
    _faces,
    _sticks,
    name_of,
    outline,
    right_triangles,
)
from app.features.solutions.state import SetAtlas
from app.review.changes import SetOption
from app.scene import palette
from kinematics.answers.drawings import Body
from tests.app.seats import Seat, seat

SQUARE = ((0.0, 0.0, 0.0), (30.0, 0.0, 0.0), (30.0, 20.0, 0.0), (0.0, 20.0, 0.0))


def _area(triangles: np.ndarray) -> float:
    legs = triangles[:, 1:] - triangles[:, :1]
    return float(0.5 * np.linalg.norm(np.cross(legs[:, 0], legs[:, 1]), axis=1).sum())


def test_an_outline_is_closed_and_leaves_inner_points_out() -> None:
    points = (*SQUARE, (14.0, 9.0, 0.5))
    lines = outline([Body("platform", points, 3.0, "platform", "platform")])
    assert len(lines) == 4
    assert {tuple(p) for p in lines[:, 0]} == set(SQUARE)
    assert np.array_equal(lines[:, 1], np.roll(lines[:, 0], -1, axis=0))


def test_points_on_a_line_give_one_line_and_no_face() -> None:
    points = ((0.0, 0.0, 0.0), (5.0, 5.0, 0.0), (-3.0, -3.0, 0.0))
    lines = outline([Body("platform", points, 3.0, "platform", "platform")])
    assert lines.shape == (1, 2, 3)
    assert {tuple(p) for p in lines[0]} == {points[1], points[2]}
    turns, places, scales = _faces(lines, np.eye(4)[None])
    assert len(turns) == len(places) == len(scales) == 0


def test_right_triangles_fill_a_polygon() -> None:
    rng = np.random.default_rng(5)
    for corners in (3, 4, 5, 6):
        angles = np.sort(rng.uniform(0, 2 * np.pi, corners))
        flat = np.column_stack([50 * np.cos(angles), 30 * np.sin(angles), np.zeros(corners)])
        polygon = flat @ Rotation.random(random_state=corners).as_matrix().T + [5, 6, 7]
        filled = right_triangles(polygon)
        legs = filled[:, 1:] - filled[:, :1]
        assert np.einsum("ni,ni->n", legs[:, 0], legs[:, 1]) == pytest.approx(0.0, abs=1e-9)
        x, y = flat[:, 0], flat[:, 1]
        shoelace = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
        assert _area(filled) == pytest.approx(shoelace)


def test_copies_are_the_shape_at_every_placement() -> None:
    lines = outline([Body("platform", SQUARE, 3.0, "platform", "platform")])
    placements = np.tile(np.eye(4), (3, 1, 1))
    placements[:, :3, :3] = Rotation.random(3, random_state=1).as_matrix()
    placements[:, :3, 3] = np.random.default_rng(2).uniform(-100, 100, (3, 3))

    turns, places, scales = _sticks(lines, placements, np.full(3, 1.5))
    axis = Rotation.from_quat(np.roll(turns, -1, axis=1)).apply([0.0, 0.0, 1.0])
    ends = places + axis * scales[:, 2:]
    expected = np.einsum("nij,kej->nkei", placements[:, :3, :3], lines)
    expected = (expected + placements[:, None, None, :3, 3]).reshape(-1, 2, 3)
    assert places == pytest.approx(expected[:, 0], abs=1e-4)
    assert ends == pytest.approx(expected[:, 1], abs=1e-4)

    turns, places, scales = _faces(lines, placements)
    rotation = Rotation.from_quat(np.roll(turns, -1, axis=1))
    corners = [
        places + rotation.apply(np.array(unit) * scales)
        for unit in ([0.0, 0, 0], [1.0, 0, 0], [0.0, 1, 0])
    ]
    assert _area(np.stack(corners, axis=1)) == pytest.approx(3 * 600.0, rel=1e-6)
    local = np.stack(corners, axis=1).reshape(3, -1, 3) - placements[:, None, :3, 3]
    local = np.einsum("nij,nki->nkj", placements[:, :3, :3], local)
    assert local[..., 2] == pytest.approx(0.0, abs=1e-6)
    assert local.min() > -1e-6
    assert local[..., 0].max() == pytest.approx(30.0)
    assert local[..., 1].max() == pytest.approx(20.0)


COUNT = 20


def _listed() -> Listed:
    """Solutions each farther away than the one before; the first is the present one."""
    rows = tuple(
        Row(n, n, (float(n),) * 5, "-+--+", 25.0 * n, 0.0, 1.0, "", True, n == 0, False)
        for n in range(COUNT)
    )
    places = np.tile(np.eye(4), (COUNT, 1, 1))
    places[:, 0, 3] = 25.0 * np.arange(COUNT)
    return replace(NONE_YET, rows=rows, placements=places, stale=False)


def _many(page: Seat, node: str) -> int:
    """How many copies have a size."""
    mesh = page.node(node)
    return int((mesh.batched_scales > 0).any(axis=1).sum()) if mesh.visible else 0


def test_all_are_dots_six_are_outlines_and_the_nearest_is_filled_and_named() -> None:
    with seat("rpur-table1") as page:
        page.do(SetAtlas("ghosts", True))
        part, view = page.page.part(SolutionsPart), page.page.view
        edges = outline([b for b in view.drawing.bodies if b.frame == "platform"])
        for dark in (False, True):
            page.do(SetOption("dark", dark))
            part._ghosts.show(page.page.view, _listed(), None)
            of = palette.scheme(dark)
            assert _many(page, "/ghosts/dots") == COUNT - 1
            assert _many(page, "/ghosts/edges") == NEAREST * len(edges)
            assert _many(page, "/ghosts/faces") == len(right_triangles(edges[:, 0]))
            assert page.node("/ghosts/faces").opacity == 0.35
            colors = [tuple(c) for c in page.node("/ghosts/dots").batched_colors[: COUNT - 1]]
            assert set(colors[:NEAREST]) == {palette.linear(of.ghost)}
            assert set(colors[NEAREST:]) == {palette.linear(of.dot)}
        label = page.node("/labels/nearest")
        assert (label.visible, label.text) == (True, "#1 · 25.0 mm · −+−−+")
        assert label.position == pytest.approx([25.0, 0.0, 0.0])
        # A distance is told of the present actuators or not at all.
        part._ghosts.show(page.page.view, replace(_listed(), stale=True), None)
        assert not label.visible
        page.do(SetAtlas("ghosts", False))
        part._ghosts.show(page.page.view, _listed(), None)
        assert _many(page, "/ghosts/dots") == _many(page, "/ghosts/faces") == 0


def test_a_solution_without_a_mode_is_named_without() -> None:
    row = replace(_listed().rows[3], mode="")
    assert name_of(row) == "#3 · 75.0 mm"
