"""What is drawn of a section: its fill, edges, the extent; and which workspaces are the same."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from app.features.move.state import Flip, Move
from app.features.section import compute
from app.features.section.plot import section_figure
from app.features.section.state import MoveCut
from app.features.singularities.state import SetControl
from app.features.workspace.state import ChooseModes, Show
from app.review.changes import change
from app.review.state import Options, Review, new_review
from app.scene.palette import limb_color
from kinematics.answers.sections import Section
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from tests.app.made_sections import LENS, RING, TWO


@pytest.fixture(scope="module")
def review() -> Review:
    return new_review(load_design("rpur-table1"))


@pytest.mark.parametrize("section", [RING, LENS, TWO])
def test_edges_are_as_long_as_the_outline_and_each_is_of_its_limb(section: Section) -> None:
    lines, limbs = compute.edges(section)
    lengths = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(section.perimeter, rel=3e-3)
    assert lengths.max() <= max(compute.STEP, 20.0 + 1e-9)  # but for straight edges
    assert set(limbs.tolist()) == set(section.limb.tolist())


@pytest.mark.parametrize("at", [-120.0, 50.0, 326.0])
def test_the_fill_covers_the_region_and_nothing_else(review: Review, at: float) -> None:
    drawn = compute.draw(compute.wish(change(review, MoveCut(at))[0]))
    a, b, c = np.moveaxis(drawn.fill, 1, 0)
    turned = np.cross(b - a, c - a)
    assert (turned[:, 0] > -1e-6).all()  # all of one side
    assert not turned[:, 1:].any()
    assert (drawn.fill[..., 0] == at).all()
    assert 0.5 * turned[:, 0].sum() == pytest.approx(drawn.section.area, rel=5e-3)


def test_equal_workspaces_are_one_region(review: Review) -> None:
    own, _ = change(review, ChooseModes("current"))
    review, _ = change(review, ChooseModes("all"))
    here = compute.region(review)
    assert compute.region(own) == compute.region(review, "present") != here
    assert compute.region(own, "all") == here
    for what in (Move(0, 3.0), Move(2, 400.0), MoveCut(20.0), Flip("-----")):
        assert compute.region(change(review, what)[0]) == here
    for what in (Move(3, 0.1), Move(4, -0.2), ChooseModes("current")):
        assert compute.region(change(review, what)[0]) != here
    flipped = change(change(review, ChooseModes("current"))[0], Flip("-----"))[0]
    assert compute.region(flipped) != compute.region(change(review, ChooseModes("current"))[0])
    assert hash(compute.region(change(review, Move(0, 3.0))[0])) == hash(here)


def test_the_platform_is_marked_only_where_it_stands_in_the_plane(review: Review) -> None:
    turned, _ = change(review, Move(4, 0.4))
    x, y, z = turned.pose[:3]
    cos, sin = math.cos(0.4), math.sin(0.4)
    at = cos * x - sin * z  # x′ of R_y(−θ) p
    through, _ = change(turned, MoveCut(at))
    mark = compute.wish(through).mark
    assert mark == pytest.approx((y, sin * x + cos * z))
    assert compute.wish(change(turned, MoveCut(at + 1.0))[0]).mark is None


def test_a_dark_page_shows_the_same_drawing_whose_colours_the_style_sheet_sets(
    review: Review,
) -> None:
    dark = review.having(replace(review[Options], dark=True))
    assert compute.wish(dark) == compute.wish(review)
    content = section_figure(compute.draw(compute.wish(review)).picture).content
    # Only what means a limb has the same colour on both pages.
    fixed = set(re.findall(r'(?:fill|stroke)="(#\w+)"', content))
    assert fixed <= {limb_color(limb) for limb in range(1, 6)}


def test_lost_control_is_drawn_where_the_present_mode_comes(review: Review) -> None:
    review = change(review, Show("aspects", True))[0]
    review = change(review, SetControl("shade", "conditioning"))[0]
    drawn = compute.draw(compute.wish(review))
    design = review.design
    assert len(drawn.locus) > 20
    frame = machine_of(design).sections.frame(review.pose)
    middles = drawn.locus.mean(axis=1) @ frame[:3, :3].T + frame[:3, 3]
    poses = compute.placed(machine_of(design), review.pose, middles)
    held = [machine_of(design).inverse.posture(pose, review.mode).reachable for pose in poses]
    assert np.mean(held) > 0.95  # all but where the curve leaves
    content = section_figure(drawn.picture).content
    assert 'class="lost"' in content
    assert 'class="lost-beyond"' in content
    assert 'class="shade"' in content
    # Another mode than those that are cut has nothing to tell here.
    other = change(review, ChooseModes(("-----",)))[0]
    drawn = compute.draw(compute.wish(other))
    assert len(drawn.locus) == 0
    assert 'class="shade"' not in section_figure(drawn.picture).content
