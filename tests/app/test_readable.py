"""What is drawn can be read: few platforms of many solutions, a machine among vertex spaces."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from app.features.solutions import scene
from app.features.solutions.part import SolutionsPart
from app.features.solutions.state import SetAtlas
from app.features.workspace.state import Show
from app.review.state import new_review
from app.review.view import view
from app.scene import palette
from app.scene.camera import UP, frame
from app.scene.machine import labels, machine_bounds
from kinematics.designs.files import load_design
from tests.app import seats

PRESETS = ("rpur-table1", "rpur-table2", "sps-spr", "spr-3", "rps-3", "five-bar")


def test_of_many_solutions_the_nearest_are_platforms_and_all_are_dots(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(scene, "NEAREST", 3)
    with seats.seat("rpur-a1a1") as page:
        page.do(SetAtlas("ghosts", True))
        part = page.page.part(SolutionsPart)
        part._from = 0.0  # no pause for the eye
        page.ask(part.redraw)
        rows = part._explorer.atlas(page.page.view).rows
        others = sorted((row for row in rows if not row.here), key=lambda row: row.distance)
        assert len(others) > 3
        dots, edges = page.node("/ghosts/dots"), page.node("/ghosts/edges")
        places = dots.batched_positions[dots.batched_scales[:, 0] > 0]
        assert places == pytest.approx(np.array([row.pose[:3] for row in others]), abs=1e-2)
        drawn = edges.batched_scales[:, 0] > 0
        sides = len(scene.outline([b for b in page.page.view.drawing.bodies if b.frame != "base"]))
        assert drawn.sum() == 3 * sides
        ends = edges.batched_positions[drawn].reshape(3, sides, 3)
        size = page.page.view.drawing.size
        for row, corners in zip(others, ends, strict=False):
            assert np.linalg.norm(corners - row.pose[:3], axis=1).max() < size


def _lab(code: str) -> np.ndarray:
    """CIE L*a*b* of a colour."""
    c = np.array(palette.rgb(code)) / 255
    c = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    x, y, z = np.cbrt(xyz @ c / [0.9505, 1.0, 1.089])
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def test_ghosts_and_workspace_have_colours_that_differ() -> None:
    for ghost in (palette.GHOST, palette.GHOST_DARK):
        assert np.linalg.norm(_lab(ghost) - _lab(palette.WORKSPACE)) > 15


@pytest.mark.parametrize("name", PRESETS)
def test_labels_of_points_do_not_lie_over_one_another(name: str) -> None:
    shown = view(new_review(load_design(name)))
    planar = name == "five-bar"
    bounds = machine_bounds(shown.drawing)
    eye, middle = frame(bounds, from_above=planar, aspect=870 / 760)
    ahead = (middle - eye) / np.linalg.norm(middle - eye)
    right = np.cross(ahead, UP[planar])
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    boxes = []
    for text, place in labels(shown.drawing).values():
        away = place - eye
        scale = 380 / np.tan(np.radians(19.0)) / (away @ ahead)  # px for a mm, 760 px high
        x, y, wide = away @ right * scale, away @ up * scale, 7 * len(text) + 6
        boxes.append((x - wide / 2, x + wide / 2, y, y + 15, text))
    for one, two in itertools.combinations(boxes, 2):
        apart = one[0] >= two[1] or two[0] >= one[1] or one[2] >= two[3] or two[2] >= one[3]
        assert apart, (one[4], two[4])


def test_several_vertex_spaces_leave_the_machine_to_be_seen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(seats, "INLINE", (*seats.INLINE, "coarse"))
    with seats.seat() as page:
        page.do(Show("limb1/whole", True))
        alone = page.node("/solids/limb1/whole").opacity
        page.do(Show("limb2/whole", True))
        both = [page.node(f"/solids/limb{n}/whole") for n in (1, 2)]
        assert all(node.visible and node.opacity < 0.2 * alone for node in both)
        page.do(Show("limb2/whole", False))
        assert page.node("/solids/limb1/whole").opacity == alone
