"""State → view: what the page says must be true of the machine."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.features.move.state import Flip, Move
from app.features.workspace.compute import inside, wishes
from app.features.workspace.state import ChooseModes, Show
from app.review import view as compute
from app.review.changes import change
from app.review.state import Review, new_review
from app.review.units import page_unit
from kinematics.designs.files import load_design, presets


@pytest.fixture(scope="module")
def review() -> Review:
    return new_review(load_design("rpur-table1"))


@pytest.mark.parametrize("name", [p.name for p in presets()])
def test_every_preset_has_a_view_with_a_reachable_home(name: str) -> None:
    review = new_review(load_design(name))
    view = compute.view(review)
    assert view.posture.reachable
    assert inside(view.review)
    mode = compute.mode_text(review.machine, review.mode)
    assert view.status.text.startswith(f"Reachable · {mode}")
    assert len(view.joints) == len(review.machine.joints)


def test_the_status_names_the_nearest_limit(review: Review) -> None:
    view = compute.view(review)
    nearest = view.posture.nearest
    assert f"{nearest.amount:.1f} mm left of travel (limb {nearest.limb}," in view.status.text


def test_an_unreachable_pose_says_which_limb_and_by_how_much(review: Review) -> None:
    high = review.machine.coordinates[2].upper
    view = compute.view(change(review, Move(2, high))[0])
    assert view.status.level == "bad"
    assert view.status.text.startswith("Not reachable · mode ")
    assert not inside(view.review)
    worst = max(view.posture.reasons, key=lambda r: r.amount)
    assert worst.text in view.status.text
    bad = [row for row in view.joints if row.level == "bad"]
    assert {row.limb for row in bad} == {r.limb for r in view.posture.reasons}


def test_the_way_out_is_the_nearest_mode_that_reaches(review: Review) -> None:
    answered = review.machine.inverse(review.pose)
    unable = [m for m, ok in zip(answered.modes, answered.within_stroke, strict=True) if not ok]
    assert unable
    view = compute.view(change(review, Flip(unable[-1]))[0])
    assert view.status.remedy.startswith("Within reach in mode ")
    named = view.status.remedy.removeprefix("Within reach in mode ").rstrip(".").replace("−", "-")
    assert answered.within_stroke[answered.modes.index(named)]


def test_the_platform_and_the_drawing_agree(review: Review) -> None:
    view = compute.view(review)
    tips = {m.name: m.position for m in view.drawing.points if m.name.endswith("/C")}
    for n, limb in enumerate(review.design.limbs):  # type: ignore[attr-defined]
        expected = view.platform @ [*limb.platform, 1.0]
        assert tips[f"limb{n + 1}/C"] == pytest.approx(tuple(expected[:3]), abs=1e-9)
    bars = {bar.name: bar for bar in view.drawing.bars}
    for n, rho in enumerate(view.posture.joints):
        barrel, rod = bars[f"limb{n + 1}/cylinder"], bars[f"limb{n + 1}/rod"]
        assert barrel.end == rod.start
        assert math.dist(barrel.start, rod.end) == pytest.approx(rho, rel=1e-12)
        link = bars[f"limb{n + 1}/link"]
        length = review.design.limbs[n].link  # type: ignore[attr-defined]
        assert math.dist(link.start, link.end) == pytest.approx(length, rel=1e-12)


def test_a_limb_that_cannot_close_shows_by_how_much(review: Review) -> None:
    y = review.machine.coordinates[1].upper
    view = compute.view(change(review, Move(1, y))[0])
    gaps = {bar.limb: bar for bar in view.drawing.bars if bar.role == "gap"}
    short = {r.limb: r.amount for r in view.posture.reasons if r.bound == "link"}
    assert gaps.keys() == short.keys() != set()
    for limb, bar in gaps.items():
        assert math.dist(bar.start, bar.end) == pytest.approx(short[limb], rel=1e-9)
    assert all(np.isfinite([*bar.start, *bar.end]).all() for bar in view.drawing.bars)


def test_wishes_depend_on_the_orientation_but_not_on_the_position(review: Review) -> None:
    here = wishes(review)[0]
    there = wishes(change(review, Move(0, 55.0))[0])[0]
    turned = wishes(change(review, Move(3, 0.1))[0])[0]
    assert here.what == there.what
    assert here.what != turned.what


def test_a_limbs_solid_is_only_moved(review: Review) -> None:
    shown, _ = change(review, Show("limb4/whole", True))
    turned, _ = change(shown, Move(4, 0.3))
    before, after = wishes(shown)[1], wishes(turned)[1]
    assert before.what == after.what
    assert not np.allclose(before.placement, after.placement)


def test_the_modes_of_the_workspace_reach_the_request(review: Review) -> None:
    current = wishes(review)[0].what  # of its own mode, as nobody has chosen yet
    assert current == wishes(change(review, ChooseModes("current"))[0])[0].what
    every = wishes(change(review, ChooseModes("all"))[0])[0].what
    assert every != current


def test_page_units() -> None:
    review = new_review(load_design("rpur-table1"))
    coordinates = review.machine.coordinates
    assert [page_unit(c) for c in coordinates] == ["mm", "mm", "mm", "°", "°"]
    for c in coordinates:
        assert c.inner(c.outer(0.75)) == pytest.approx(0.75)


def test_the_mode_that_reaches_a_pose_flips_the_fewest_limbs(review: Review) -> None:
    assert compute.reaching_mode(review, review.pose) == review.mode
    kind, answer = review.machine, review.machine.inverse(review.pose)
    able = [m for m, ok in zip(answer.modes, answer.within_stroke, strict=True) if ok]
    assert 0 < len(able) < len(kind.modes)
    for mode in kind.modes:
        found = compute.reaching_mode(change(review, Flip(mode))[0], review.pose)
        assert found in able
        flips = [sum(a != b for a, b in zip(mode, other, strict=True)) for other in able]
        assert sum(a != b for a, b in zip(mode, found, strict=True)) == min(flips)
    far = (review.pose[0], 9999.0, *review.pose[2:])
    assert compute.reaching_mode(review, far) is None
