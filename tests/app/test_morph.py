"""The way between two postures: exact at both ends, rigid where the platform is, joined between."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.features.move.state import Place, Visit
from app.review import view
from app.review.changes import change
from app.review.state import Review, new_review
from app.scene.morph import DURATION, Morph, between
from kinematics.designs.files import load_design


@pytest.fixture(scope="module")
def views() -> tuple[view.View, view.View]:
    review: Review = new_review(load_design("rpur-table1"))
    x, y, z, _, _ = review.pose
    other, _ = change(review, Place((x - 40.0, y + 15.0, z + 30.0, 1.1, -0.6)))
    return view.view(review), view.view(change(other, Visit(other.pose, "-+-+-"))[0])


@pytest.mark.parametrize("end", [0, 1])
def test_the_ends_are_the_postures(views: tuple[view.View, view.View], end: int) -> None:
    drawing, platform = between(*views, float(end))
    assert platform == pytest.approx(views[end].platform, abs=1e-12)
    expected = {bar.name: bar for bar in views[end].drawing.bars}
    for bar in drawing.bars:
        assert bar.start == pytest.approx(expected[bar.name].start, abs=1e-9)
        assert bar.end == pytest.approx(expected[bar.name].end, abs=1e-9)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_links_stay_on_the_platform_and_limbs_in_one_piece(
    views: tuple[view.View, view.View], share: float
) -> None:
    drawing, platform = between(*views, share)
    assert platform[:3, :3] @ platform[:3, :3].T == pytest.approx(np.eye(3), abs=1e-12)
    bars = {bar.name: bar for bar in drawing.bars}
    design = views[0].review.design
    for n, limb in enumerate(design.limbs, 1):  # type: ignore[attr-defined]
        tip = (platform @ [*limb.platform, 1.0])[:3]
        assert bars[f"limb{n}/link"].end == pytest.approx(tuple(tip), abs=1e-9)
        assert bars[f"limb{n}/cylinder"].start == pytest.approx(limb.base, abs=1e-9)
        assert bars[f"limb{n}/rod"].end == pytest.approx(bars[f"limb{n}/link"].start, abs=1e-9)


def test_it_takes_its_time_and_then_is_over(views: tuple[view.View, view.View]) -> None:
    morph = Morph(*views, begun=10.0)
    assert not morph.over(10.0 + 0.9 * DURATION)
    assert morph.over(10.0 + DURATION)
    assert morph.at(9.0).platform == pytest.approx(views[0].platform, abs=1e-12)
    assert morph.at(99.0).platform == pytest.approx(views[1].platform, abs=1e-12)
    ways = [
        math.dist(morph.at(10.0 + s * DURATION).platform[:3, 3], views[0].platform[:3, 3])
        for s in (0.1, 0.3, 0.5, 0.7, 0.9)
    ]
    assert ways == sorted(ways)
    assert morph.at(10.1).posture == views[1].posture  # all that is said is true already
