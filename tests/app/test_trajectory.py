"""What is computed and drawn of a trajectory: against the library, and as text."""

from __future__ import annotations

import itertools
import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.features.trajectory import compute
from app.features.trajectory.compute import Asked, Computed
from app.features.trajectory.files import polynomial
from app.features.trajectory.html import bar_html, fits_html, most_html, summary_html
from app.features.trajectory.playing import Player, on_the_way
from app.features.trajectory.plot import (
    ORDER,
    axes_for,
    figure,
    mark,
    plots_svg,
    strip_axes,
    strips,
)
from app.features.trajectory.scene import along, wrong
from app.features.trajectory.sketch import read_stroke, sketch_axes, sketch_figure, sketch_mark
from app.features.trajectory.state import SetPlan
from app.review.changes import change
from app.review.state import Review, new_review
from app.widgets.axes import Look
from app.widgets.boxes import shown_pose, typed_numbers, typed_pose, units
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from tests.conftest import Finished

Run = Callable[..., Finished]

MACHINES = {
    "rpur-table1": (250.0, 110.0, 280.0, 0.2, -0.17),
    "five-bar": (240.0, 450.0),
    "sps-spr": (80.0, 30.0, 640.0, 0.17, 0.14, 0.0),
    "rps-3": (330.0, 0.4, 1.0),
    "spr-3": (115.0, 0.25, 1.0),
}


def _review(name: str, **values: Any) -> Review:
    fresh = new_review(load_design(name))
    values = {"on": True, "way": "straight", "end": MACHINES[name], "samples": 21} | values
    return change(fresh, SetPlan(tuple(values.items())))[0]


def _asked(review: Review) -> Asked:
    found = compute.asked(review)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def bar() -> Computed:
    return compute.compute(_asked(_review("five-bar", way="rest-to-rest", rates=(0.3, 0.4))))


@pytest.mark.parametrize("name", MACHINES)
def test_every_mechanism_runs_straight_from_home(name: str) -> None:
    review = _review(name)
    computed = compute.compute(_asked(review))
    found = computed.found
    assert found.reachable.all()
    assert np.isfinite(found.joint_accelerations).all()
    assert np.isnan(found.distance).all()
    # Rates are those of the joints, also where a coordinate follows.
    fine = compute.compute(_asked(_review(name, samples=801))).found
    slope = np.gradient(fine.joints, fine.times, axis=0, edge_order=2)
    size = np.abs(fine.joint_rates).max()
    np.testing.assert_allclose(slope, fine.joint_rates, atol=1e-3 * size)
    # What is played is what was sampled, and O′ is where it was drawn.
    at = float(found.times[7])
    np.testing.assert_allclose(computed.pose_at(at), found.poses[7], atol=1e-9)
    spot = review.machine.transform(found.poses[7], review.mode)[:3, 3]
    np.testing.assert_allclose(computed.spots[7], spot, atol=1e-9)
    distance = compute.distances(computed.asked, found.poses[7:8])
    posture = review.machine.inverse.posture(computed.pose_at(at), review.mode)
    known = review.machine.clearances.of(posture)
    kinds = ("parallel", "constraint")
    least = min((c.distance for c in known if c.kind in kinds), default=math.inf)
    assert distance[0] == pytest.approx(least, abs=1e-6)


def test_the_drawn_coordinates_are_kept_where_others_can_give_way() -> None:
    fresh = new_review(load_design("sps-spr"))
    home = np.array(fresh.pose)
    turn = np.linspace(0.0, 2.0 * np.pi, 40)
    ring = np.tile(home, (len(turn), 1))
    ring[:, 0] += 20.0 * np.cos(turn) - 20.0
    ring[:, 1] += 20.0 * np.sin(turn)
    stroke = tuple(map(tuple, ring.tolist()))
    review = _review("sps-spr", way="stroke", stroke=stroke, smooth=0.0)
    found = compute.compute(_asked(review)).found
    assert found.reachable.all()
    assert np.hypot(found.poses[:, 0] + 20.0, found.poses[:, 1]) == pytest.approx(20.0, abs=0.05)


def test_how_it_is_shown_makes_no_other_trajectory() -> None:
    one = _review("five-bar")
    values = {
        "plot": "rates",
        "pace": 4.0,
        "playback": "once",
        "degree": 3,
        "points": ((1.0, 2.0),),
    }
    other = _review("five-bar", **values)
    assert compute.asked(one) == compute.asked(other)
    assert compute.asked(_review("five-bar", duration=3.0)) != compute.asked(one)
    assert compute.asked(_review("five-bar", on=False)) is None
    assert compute.asked(_review("five-bar", end=())) is None


@pytest.mark.parametrize("samples", [2, 3, 17, 64, 101, 2001])
def test_distances_come_coarse_first_and_each_once(samples: int) -> None:
    found = [n for part in compute.parts(samples) for n in part]
    assert sorted(found) == list(range(samples))
    if samples > 20:
        first = next(k for k in range(1, samples) if found[k] < found[k - 1])
        assert 8 < first <= 16
        early = np.sort(found[: samples // 4])
        assert np.diff(early).max() <= 8 * samples / 101 + 8


def test_near_singularities_are_told_once_distances_are_known(bar: Computed) -> None:
    review = _review("five-bar", end=(290.0, 280.0), start=(240.0, 450.0))
    computed = compute.compute(_asked(review))
    distance = compute.distances(computed.asked, computed.found.poses)
    judged = compute.judged(replace(computed, found=replace(computed.found, distance=distance)))
    assert [e.kind for e in judged.found.events] == ["near"]
    assert judged.marks.shape == (1, 3)
    assert not wrong(judged.found).any()
    assert wrong(bar.found).any()
    assert {e.kind for e in bar.found.events} == {"rate"}


def test_the_reach_in_a_plane_is_where_the_machine_can_be() -> None:
    review = _review("rpur-table1")
    plane = (0, 2)
    reach = compute.reach(review.design, review.pose, review.mode, plane, None)
    n = len(reach.inside)
    (x0, x1), (z0, z1) = reach.bounds
    assert x1 - x0 == pytest.approx(z1 - z0)
    for i, j in ((5, 5), (n // 2, n // 2), (n // 3, 2 * n // 3)):
        pose = list(review.pose)
        pose[0], pose[2] = x0 + (i + 0.5) / n * (x1 - x0), z0 + (j + 0.5) / n * (z1 - z0)
        posture = review.machine.inverse.posture(pose, review.mode)
        assert posture.reachable == reach.inside[i, j]
    assert reach.inside.any()
    assert not reach.inside[0].any()


# --- playing -------------------------------------------------------------------------------


def test_a_playback_ends_begins_again_or_turns() -> None:
    once = Player(2.0, "once").play(10.0)
    assert (once.at(11.0), once.at(13.0), once.over(11.9), once.over(12.0)) == (
        1.0,
        2.0,
        False,
        True,
    )
    assert Player(2.0, "loop", 2.0).play(0.0).at(1.25) == pytest.approx(0.5)
    assert Player(2.0, "swing").play(0.0).at(2.5) == pytest.approx(1.5)
    assert once.to(2.0).play(20.0).at(20.5) == pytest.approx(0.5)


@given(
    st.sampled_from(("once", "loop", "swing")),
    st.floats(0.25, 4.0),
    st.floats(0.0, 50.0),
    st.floats(0.25, 4.0),
)
def test_nothing_jumps_when_it_pauses_or_changes_its_pace(
    playback: Any, pace: float, elapsed: float, other: float
) -> None:
    player = Player(3.0, playback, pace).play(5.0)
    now = 5.0 + elapsed
    at = player.at(now)
    assert 0.0 <= at <= 3.0
    assert player.pause(now).at(now + 9.0) == pytest.approx(at)
    assert player.paced(playback, other, now).at(now) == pytest.approx(at, abs=1e-9)


def test_the_view_on_the_way_leaves_the_review_where_it_is() -> None:
    from app.review.view import view

    before = view(_review("five-bar"))
    after = on_the_way(before, MACHINES["five-bar"], 1.0, 2.0)
    assert after.review is before.review
    assert after.posture.pose == MACHINES["five-bar"]
    assert after.status.text.startswith("At 1.00 of 2.00 s · Reachable")
    away = on_the_way(before, (5000.0, 0.0), 1.0, 2.0)
    assert away.status.level == "bad"


# --- plots ---------------------------------------------------------------------------------


def test_strips_are_in_page_units_and_show_limits(bar: Computed) -> None:
    shown = strips(bar, "all")
    assert len(shown) == len(ORDER)
    np.testing.assert_allclose(shown[0].curves[1].values, np.degrees(bar.found.joints[:, 1]))
    limits = [curve.limit for curve in shown[1].curves]
    assert limits == pytest.approx([math.degrees(0.3), math.degrees(0.4)])
    drawn = figure(bar, "all")
    boxes = strip_axes(shown, drawn.axes)
    assert boxes[1].y[1] > math.degrees(0.4)
    assert drawn.content.count('class="limit"') == 4
    assert drawn.content.count('class="event"') == len(bar.found.events) * len(ORDER)
    assert any("too fast" in column for column in drawn.columns)
    cursor = mark(bar, "all", drawn.axes, 1.0)
    middle = np.degrees(bar.found.joints[10, 0])
    told = [t.text for t in ElementTree.fromstring(f"<g>{cursor}</g>").iter("text")]
    assert told[:2] == ["θ₁", f"{middle:.1f}"]  # the larger of the two, beside its chip
    assert figure(bar, "rates").axes.height < drawn.axes.height


def test_plots_fill_the_room_that_a_browser_tells(bar: Computed) -> None:
    for plot, size in itertools.product(("main", "all", "rates"), ((860.0, 300.0), (640.0, 250.0))):
        drawn = figure(bar, plot, Look(size=size))
        assert (drawn.axes.width, drawn.axes.height) == size
        shown = strips(bar, plot)
        boxes = strip_axes(shown, drawn.axes)
        assert boxes[-1].bottom == pytest.approx(drawn.axes.bottom)
        for one, two in itertools.pairwise(boxes):
            assert one.top + one.inner[1] + 15 < two.top  # a title stands between
        cursor = ElementTree.fromstring(f"<g>{mark(bar, plot, drawn.axes, 1.0)}</g>")
        values = [g for g in cursor.iter("g") if g.get("class") == "values"]
        for group, box in zip(values, boxes, strict=True):
            for text in group.iter("text"):
                x, y = float(text.get("x", "")), float(text.get("y", ""))
                assert box.left + box.inner[0] < x <= box.width
                assert box.top <= y <= box.top + max(box.inner[1], 13.0) + 1.0


def test_values_stand_in_the_order_of_the_curves(bar: Computed) -> None:
    (strip,) = strips(bar, "joints")
    box = axes_for((strip,), bar.found.duration)
    for at in (0.3, 1.0, 1.7):
        cursor = ElementTree.fromstring(f"<g>{mark(bar, 'joints', box, at)}</g>")
        told = [t.text or "" for t in cursor.iter("text")]
        values = [float(text.replace("−", "-")) for text in told[1::2]]
        assert values == sorted(values, reverse=True)
        known = {c.symbol: float(np.interp(at, c.times, c.values)) for c in strip.curves}
        assert dict(zip(told[::2], values, strict=True)) == pytest.approx(known, abs=0.06)


def test_ends_of_strokes_are_named_where_the_joints_come_near() -> None:
    review = _review("rpur-table1", start=_review("rpur-table1").pose, end=(250, 120, 240, 0, 0))
    computed = compute.compute(_asked(review))
    drawn = figure(computed, "joints")
    texts = [t.text for t in ElementTree.fromstring(f"<g>{drawn.content}</g>").iter("text")]
    assert "ρ min 250" in texts  # limb 3 goes beyond it
    assert not any("ρ max" in (text or "") for text in texts)  # 400 mm is far
    assert drawn.table()[0][:3] == ["t (s)", "ρ₁ (mm)", "ρ₂ (mm)"]
    assert len(drawn.table()[1]) == 25


def test_what_is_beyond_is_marked_on_the_time_line_and_told_first(bar: Computed) -> None:
    from app.features.trajectory.compute import Moved

    review = _review("rpur-table1", start=_review("rpur-table1").pose, end=(250, 120, 240, 0, 0))
    computed = compute.compute(_asked(review))
    (event,) = computed.found.events
    share = 100.0 * event.start / computed.found.duration
    assert f"transparent {share:.2f}%" in bar_html(computed, 1.0)
    assert "gradient" not in bar_html(None, 1.0)
    moved = Moved(computed, False, "", 1.0, False, None, "", None, "")
    told = re.sub(r"<[^>]*>", "|", summary_html(moved))
    first = next(part for part in told.split("|") if part.strip())
    assert first == f"Leaves the workspace at t = {event.start:.3f} s"
    rows = re.findall(r"<tr>.*?</tr>", most_html(computed))
    heads, *limbs = [
        [re.sub(r"<[^>]*>", "", c) for c in re.findall("<t[hd].*?</t[hd]>", r)] for r in rows
    ]
    assert heads == ["", "mm/s", "mm/s²", "N"]
    assert [row[0] for row in limbs] == ["ρ₁", "ρ₂", "ρ₃", "ρ₄", "ρ₅"]
    most = computed.found.largest("rate")[0]
    assert [float(row[1]) for row in limbs] == pytest.approx(most, abs=0.06)


def test_the_saved_plot_is_a_picture_of_its_own(bar: Computed) -> None:
    text = plots_svg(bar, "all", 'A <"machine">')
    root = ElementTree.fromstring(text)
    assert root.get("width") == "860"
    assert "θ₂" in text
    assert "<machine" not in text


def test_a_curve_has_a_gap_where_the_path_is_outside() -> None:
    review = _review("five-bar", way="straight", start=(0.0, 804.0), end=(1200.0, 804.0))
    computed = compute.compute(_asked(review))
    assert [e.kind for e in computed.found.events][-1] == "outside"
    drawn = figure(computed, "joints")
    assert "nan" not in drawn.content
    assert "outside of the workspace" in drawn.columns[-1]
    with pytest.raises(InputError, match="leaves the workspace"):
        compute.fitted(computed, 3)


def test_what_is_told_in_words(bar: Computed) -> None:
    from app.features.trajectory.compute import Moved

    moved = Moved(bar, False, "", 1.0, False, None, "", None, "")
    text = summary_html(moved)
    assert "375.4 mm in 2 s, quintic" in text
    assert "Rate of θ₂ reaches" in text
    assert "<b>" not in summary_html(replace(moved, missing="<b>"))
    fits = compute.fitted(bar, 5)
    joints = bar.asked.machine.joints
    axes = bar.asked.machine.coordinates
    told = fits_html(fits, "", axes, joints)
    assert f"{abs(fits.coefficients[0, 5]):.{fits.digits}g}".replace("-", "−") in told
    assert "t<sup>5</sup>" in told
    assert f"{fits.deviation[0][1]:.3g}".replace("-", "−") in told


def test_polynomials_read_from_the_highest_power() -> None:
    assert polynomial([3.0, -1.25, 0.5]) == "0.5t^2 - 1.25t + 3"
    assert polynomial([-3.0, 1e-7]) == "1e-07t - 3"


# --- what is typed and drawn ----------------------------------------------------------------


def test_poses_are_typed_in_page_units() -> None:
    review = _review("rpur-table1")
    axes = review.machine.coordinates
    pose = typed_pose("−10; 100 450,5 -3", axes, "To")
    assert pose == pytest.approx((-10, 100, 450, math.radians(5), math.radians(-3)))
    assert shown_pose(pose, axes) == "−10, 100, 450, 5, −3"
    assert typed_pose(shown_pose(pose, axes), axes, "To") == pytest.approx(pose)
    assert typed_pose("  ", axes, "To") == ()
    with pytest.raises(InputError, match=r"To needs 5 numbers: x, y, z \(mm\), φ, θ \(°\)"):
        typed_pose("1, 2", axes, "To")
    with pytest.raises(InputError, match="commas"):
        typed_numbers("1, b", "Rates")
    with pytest.raises(InputError, match="finite"):
        typed_numbers("1, inf", "Rates")
    assert units(axes[3:]) == "φ, θ (°)"


def test_a_stroke_is_read_and_everything_else_is_nothing() -> None:
    stroke = read_stroke("1 2 3.5 -4 5 6 12345.6")
    assert stroke is not None
    assert stroke.tolist() == [[1.0, 2.0], [3.5, -4.0], [5.0, 6.0]]
    for text in ("", "1 2 3", "1 2 3 4", "a b c d e", "1 2 nan 4 5", "1 2 3 inf 5"):
        assert read_stroke(text) is None


def test_the_plane_of_a_stroke_is_drawn_where_things_are() -> None:
    review = _review("five-bar")
    reach = compute.reach(review.design, review.pose, review.mode, (0, 1), None)
    axes = review.machine.coordinates
    box = sketch_axes(axes, reach)
    assert sketch_figure(axes, reach).content.count('class="trace"') == 1
    path = np.array([[0.0, 700.0], [100.0, 500.0]])
    marked = sketch_mark(axes, box, path, review.pose)
    x, y = box.px(100.0, 500.0)
    assert f"L{x:.1f} {y:.1f}" in marked
    assert 'class="stroke"' not in sketch_mark(axes, box, path[:0], review.pose)


def test_arrows_point_along_the_way_and_way_points_are_marked() -> None:
    turn = np.linspace(0.0, np.pi, 200)
    spots = 100.0 * np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn])
    arrows = along(spots, 10.0)
    assert len(arrows) == 4
    way = arrows[:, 1] - arrows[:, 0]
    np.testing.assert_allclose(np.linalg.norm(way, axis=1), 10.0, rtol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(arrows[:, 1], axis=1), 100.0, rtol=1e-3)
    assert (np.cross(arrows[:, 1], way)[:, 2] > 0.0).all()  # counter-clockwise, as it runs
    assert not len(along(spots[:2], 10.0))
    assert not len(along(np.zeros((5, 3)), 10.0))
    review = new_review(load_design("five-bar"))
    points = ((0.0, 804.0), (100.0, 700.0), (-50.0, 650.0))
    review = change(review, SetPlan((("on", True), ("way", "points"), ("points", points))))[0]
    of = compute.asked(review)
    assert of is not None
    computed = compute.compute(of)
    np.testing.assert_allclose(computed.knots[:, :2], points, atol=1e-9)
    away = np.linalg.norm(computed.spots[:, None] - computed.knots, axis=2).min(axis=0)
    assert away.max() < 5.0  # between samples


@pytest.mark.parametrize(
    ("name", "plane"),
    [("five-bar", (0, 1)), ("five-bar", (1, 0)), ("rpur-table1", (3, 4)), ("rps-3", (1, 2))],
)
def test_where_a_stroke_loses_control_is_shown(name: str, plane: tuple[int, int]) -> None:
    review = new_review(load_design(name))
    design = review.design
    reach = compute.reach(design, review.pose, review.mode, plane, None)
    points = np.concatenate([curve[1:-1] for curve in reach.lost])  # some end on A₁ and A₂
    points = points[np.isfinite(points).all(axis=1)][::7]
    assert len(points) > 10
    poses = np.tile(review.pose, (len(points), 1))
    poses[:, plane[0]], poses[:, plane[1]] = points.T
    held = machine_of(design).statics.wrenches(poses, review.mode).determinant
    usual = abs(float(machine_of(design).statics.wrenches(review.pose, review.mode).determinant))
    assert np.nanmax(np.abs(held)) < 1e-3 * usual
    axes = machine_of(design).coordinates
    drawn = sketch_figure([axes[n] for n in plane], reach).content
    assert 'class="lost"' in drawn


def test_the_distance_to_a_singularity_is_nothing_where_one_is_crossed() -> None:
    review = new_review(load_design("five-bar"))
    plan = (("on", True), ("way", "straight"), ("start", (0.0, 804.0)), ("end", (0.0, 300.0)))
    review = change(review, SetPlan((*plan, ("samples", 12))))[0]
    of = compute.asked(review)
    assert of is not None
    computed = compute.compute(of)
    distance = compute.distances(of, computed.found.poses)
    computed = compute.judged(replace(computed, found=replace(computed.found, distance=distance)))
    (met,) = (e.start for e in computed.found.events if e.kind == "singularity")
    times, known = compute.known_distances(computed.found)
    assert np.interp(met, times, known) == 0.0
    assert (np.diff(times) >= 0.0).all()
    box = axes_for(strips(computed, "forces"), computed.found.duration)
    assert mark(computed, "forces", box, met).count("–") == 2  # no force holds a load there
    assert "–" not in mark(computed, "forces", box, met - 0.1)
    (strip,) = strips(computed, "distance")
    assert np.interp(met, strip.curves[0].times, strip.curves[0].values) == 0.0
    np.testing.assert_allclose(
        np.interp(computed.found.times, strip.curves[0].times, strip.curves[0].values), distance
    )


@pytest.mark.parametrize("name", ["rps-3", "spr-3", "rpur-table1", "sps-spr"])
def test_the_length_is_what_the_platforms_origin_travels(name: str) -> None:
    machine = machine_of(load_design(name))
    home = np.array(machine.home.pose)
    end = home + [3.0 if c.unit == "mm" else math.radians(5.0) for c in machine.coordinates]
    poses = [machine.complete_pose(tuple(pose), machine.home.mode) for pose in (home, end)]
    found = machine.trajectory(poses, duration=1.0, samples=4001, distances=False)
    places = machine.transform(found.poses, machine.home.mode)[:, :3, 3]
    assert found.travel == pytest.approx(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())


@pytest.mark.slow
def test_a_circle_of_the_tilts_azimuth_is_no_way_of_half_a_metre(here: Run, tmp_path: Path) -> None:
    z = machine_of(load_design("rps-3")).home.pose[0]
    turned = "\n".join(f"{z},5,{azimuth}" for azimuth in np.linspace(-180, 180, 73))
    (tmp_path / "circle.csv").write_text(f"z,tilt,azimuth\n{turned}\n")
    done = here("trajectory", "rps-3", "circle.csv", "--json")
    assert json.loads(done.stdout)["length_mm"] < 20.0
