"""What is drawn can be read: few platforms of many solutions, a machine among vertex spaces."""

from __future__ import annotations

import numpy as np
import pytest

from app.features.solutions import scene
from app.features.solutions.part import SolutionsPart
from app.features.solutions.state import SetAtlas
from app.features.workspace.state import Show
from tests.app import seats


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


def test_several_vertex_spaces_leave_the_machine_to_be_seen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(seats, "INLINE", (*seats.INLINE, "coarse"))
    with seats.seat() as page:
        page.do(Show("limb1/whole", True))
        alone = page.node("/solids/limb1/whole/front0").opacity
        page.do(Show("limb2/whole", True))
        both = [page.node(f"/solids/limb{n}/whole/front0") for n in (1, 2)]
        assert all(node.visible and node.opacity < 0.2 * alone for node in both)
        page.do(Show("limb2/whole", False))
        assert page.node("/solids/limb1/whole/front0").opacity == alone
