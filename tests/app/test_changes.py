"""The state of a review: every change, what it refuses, undo and redo."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from app.features.design.state import EditDesign, UseDesign
from app.features.map.state import Chart, Colours, SetChart, Span
from app.features.move.state import Drive, Flip, GoHome, Move, Place, Visit
from app.features.review.files import design_file
from app.features.section.state import Cut, MoveCut, SetCut, point_in_section
from app.features.solutions.state import Atlas, SetAtlas
from app.features.workspace.state import ChooseModes, Fade, Show, Workspace, solver_modes
from app.review import session
from app.review.changes import SetOption, change
from app.review.history import History
from app.review.state import Review, new_review
from kinematics.designs.files import load_design
from kinematics.errors import InputError


@pytest.fixture(scope="module")
def review() -> Review:
    return new_review(load_design("rpur-table1"))


def test_a_new_review_stands_at_a_reachable_home(review: Review) -> None:
    assert review.posture.reachable
    assert review.posture.nearest.amount > 5.0
    assert review[Workspace].shown("workspace") is not None


def test_moving_a_coordinate_changes_only_that_one(review: Review) -> None:
    moved, note = change(review, Move(0, review.pose[0] + 12.5))
    assert note == ""
    assert moved.pose[0] == review.pose[0] + 12.5
    assert moved.pose[1:] == review.pose[1:]
    assert moved.mode == review.mode


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_none_are_refused(review: Review, bad: float) -> None:
    for what in (
        Move(2, bad),
        Drive(1, bad),
        Place((0.0, bad, 300.0, 0.0, 0.0)),
        EditDesign(((("limb", 0, "link"), bad),)),
    ):
        with pytest.raises(InputError):
            change(review, what)


def test_numbers_out_of_range_stop_at_the_range_and_say_so(review: Review) -> None:
    coordinate = review.machine.coordinates[0]
    moved, note = change(review, Move(0, 1e12))
    assert moved.pose[0] == coordinate.upper
    assert f"{coordinate.upper:g} mm" in note
    turned, note = change(review, Move(3, 40.0))
    assert turned.pose[3] == pytest.approx(math.pi)
    assert "180 °" in note


def test_half_a_turn_in_degrees_is_not_worth_a_note(review: Review) -> None:
    _, note = change(review, Move(3, math.radians(180.0) * (1 + 1e-15)))
    assert note == ""


def test_driving_an_actuator_moves_the_platform_and_keeps_the_others(review: Review) -> None:
    before = review.posture.joints
    moved, note = change(review, Drive(0, before[0] + 3.0))
    assert note == ""
    after = moved.posture.joints
    assert after[0] == pytest.approx(before[0] + 3.0, abs=1e-9)
    assert after[1:] == pytest.approx(before[1:], abs=1e-9)
    assert moved.pose != review.pose
    back, _ = change(moved, Drive(0, before[0]))
    assert back.pose == pytest.approx(review.pose, abs=1e-8)


def test_a_machine_that_is_not_assembled_cannot_be_driven(review: Review) -> None:
    y = review.machine.coordinates[1].upper
    away, _ = change(review, Move(1, y))
    assert not away.posture.closes
    first = next(r.limb for r in away.posture.reasons if r.bound == "link")
    with pytest.raises(InputError, match=f"limb {first} cannot close"):
        change(away, Drive(0, 300.0))


def test_a_drive_that_cannot_be_finished_says_why_and_stays_on_its_branch(review: Review) -> None:
    low, high = review.design.limbs[0].stroke  # type: ignore[attr-defined]
    stops = []
    for goal in (low, high):
        reached, note = change(review, Drive(0, goal))
        joints = reached.posture.joints
        short = abs(joints[0] - goal)
        others = np.abs(np.subtract(joints[1:], review.posture.joints[1:])).max()
        if short > 1e-6:
            assert note
        assert others < 1e-6 or note
        stops.append(short)
    assert min(stops) >= 0.0


def test_flip_takes_only_working_modes(review: Review) -> None:
    flipped, _ = change(review, Flip("-----"))
    assert flipped.mode == "-----"
    assert flipped.pose == review.pose
    with pytest.raises(InputError, match="working mode"):
        change(review, Flip("++++"))


def test_another_design_keeps_what_is_shown(review: Review) -> None:
    shown, _ = change(review, Show("limb2/H1", True))
    other, _ = change(shown, UseDesign(load_design("rpur-table2")))
    assert [s.key for s in other[Workspace].solids] == ["workspace", "limb2/H1"]
    assert other.posture.reachable
    assert other.design.name == "rpur-table2"


def test_an_edit_is_checked_as_a_file_would_be(review: Review) -> None:
    edited, _ = change(review, EditDesign(((("limb", 0, "link"), 175.0),)))
    assert edited.design.limbs[0].link == 175.0  # type: ignore[attr-defined]
    assert edited.pose == review.pose
    with pytest.raises(InputError, match="link"):
        change(review, EditDesign(((("limb", 0, "link"), -1.0),)))


def test_show_keeps_the_order_and_refuses_the_unknown(review: Review) -> None:
    some, _ = change(review, Show("limb3/whole", True))
    some, _ = change(some, Show("limb1/H2", True))
    assert [s.key for s in some[Workspace].solids] == ["workspace", "limb1/H2", "limb3/whole"]
    none, _ = change(some, Show("limb1/H2", False))
    assert none[Workspace].shown("limb1/H2") is None
    with pytest.raises(InputError):
        change(review, Show("limb9/whole", True))


def test_fading_changes_only_the_named(review: Review) -> None:
    some, _ = change(review, Show("limb1/whole", True))
    faded, _ = change(some, Fade(("limb1/whole",), 0.6))
    assert faded[Workspace].shown("limb1/whole").opacity == 0.6  # type: ignore[union-attr]
    assert faded[Workspace].shown("workspace") == review[Workspace].shown("workspace")
    with pytest.raises(InputError):
        change(review, Fade(("workspace",), 2.0))


def test_modes_of_the_workspace(review: Review) -> None:
    assert solver_modes(review) == (review.mode,)
    every, _ = change(review, ChooseModes("all"))
    assert solver_modes(every) is None
    current, _ = change(review, ChooseModes("current"))
    assert solver_modes(current) == (review.mode,)
    chosen, _ = change(review, ChooseModes(("+-+-+", "-----")))
    assert solver_modes(chosen) == ("+-+-+", "-----")


# --- history ------------------------------------------------------------------------------


def test_undo_and_redo_walk_the_same_way(review: Review) -> None:
    history = History(review)
    steps: tuple = (
        Move(0, 5.0),
        Flip("-----"),
        SetOption("labels", True),
        Show("limb1/H1", True),
        EditDesign(((("limb", 1, "link"), 160.0),)),
        GoHome(),
    )
    seen = [history.present]
    for n, step in enumerate(steps):
        history, _ = history.apply(step, 10.0 * n)
        seen.append(history.present)
    for expected in reversed(seen[:-1]):
        history = history.undo()
        assert history.present == expected
    assert history.undo() is history
    for expected in seen[1:]:
        history = history.redo()
        assert history.present == expected
    assert history.redo() is history


def test_a_drag_is_one_step(review: Review) -> None:
    history = History(review)
    for n in range(20):
        history, _ = history.apply(Move(0, float(n)), 0.05 * n)
    assert history.undo().present == review
    assert len(history.past) == 1


def test_a_pause_or_another_slider_begins_a_new_step(review: Review) -> None:
    history = History(review)
    history, _ = history.apply(Move(0, 1.0), 0.0)
    history, _ = history.apply(Move(1, 1.0), 0.1)
    history, _ = history.apply(Move(1, 2.0), 5.0)
    assert len(history.past) == 3


def test_a_change_after_undo_forgets_the_undone(review: Review) -> None:
    history = History(review)
    history, _ = history.apply(Move(0, 1.0), 0.0)
    history = history.undo()
    history, _ = history.apply(Move(0, 2.0), 0.1)
    assert history.future == ()
    assert history.undo().present == review


def test_what_changes_nothing_is_no_step(review: Review) -> None:
    history, _ = History(review).apply(Move(0, review.pose[0]), 0.0)
    assert history.past == ()


def test_reviews_are_values(review: Review) -> None:
    assert hash(review) == hash(replace(review))
    assert replace(review, mode="-----") != review


# --- solutions ----------------------------------------------------------------------------


def test_a_visit_is_one_step_that_can_be_taken_back(review: Review) -> None:
    (found,) = review.machine.forward([review.posture.joints])
    n = int(np.abs(found.poses - review.pose).max(axis=1).argmax())
    visit = Visit(tuple(found.poses[n].tolist()), found.modes[n])
    history, note = History(review).apply(visit, 1.0)
    assert note == ""
    assert history.present.pose == visit.pose
    assert history.present.mode == visit.mode
    assert history.present.posture.joints == pytest.approx(review.posture.joints, abs=1e-7)
    again, _ = history.apply(Visit(review.pose, review.mode), 1.1)
    assert len(again.past) == 2  # two quick visits are two steps
    assert again.undo().present == history.present
    assert again.undo().undo().present == review


def test_a_visit_is_taken_as_it_is_or_not_at_all(review: Review) -> None:
    far = review.machine.coordinates[0].upper + 50.0
    there, note = change(review, Visit((far, *review.pose[1:]), review.mode))
    assert there.pose[0] == far
    assert note == ""
    for pose, mode in (((math.nan, *review.pose[1:]), review.mode), (review.pose, "++")):
        with pytest.raises(InputError, match="not a solution"):
            change(review, Visit(pose, mode))


def test_how_solutions_are_shown_is_checked(review: Review) -> None:
    shown, _ = change(review, SetAtlas("ghosts", True))
    shown, _ = change(shown, SetAtlas("sort", "height"))
    shown, _ = change(shown, SetAtlas("modes", "?+?++, −−+++"))
    assert shown[Atlas] == Atlas(ghosts=True, sort="height", modes="?+?++, −−+++")
    with pytest.raises(InputError, match="sorted by"):
        change(review, SetAtlas("sort", "colour"))
    with pytest.raises(InputError, match="not a working mode"):
        change(review, SetAtlas("modes", "+?"))
    other, _ = change(shown, UseDesign(load_design("rpur-table2")))
    assert other[Atlas] == shown[Atlas]


# --- section and map ----------------------------------------------------------------------


def test_the_section_of_a_new_review_goes_through_the_platform(review: Review) -> None:
    assert not review[Cut].on
    assert review[Cut].at == pytest.approx(review.pose[0])  # at home φ = θ = 0, so x′ = x
    turned, _ = change(review, Move(4, 0.3))
    x, _, z = review.pose[:3]
    assert point_in_section(turned)[0] == pytest.approx(math.cos(0.3) * x - math.sin(0.3) * z)
    assert turned[Cut] == review[Cut]  # the plane stays where a person put it


def test_a_drag_of_the_plane_is_one_step(review: Review) -> None:
    history, _ = History(review).apply(SetCut("on", True), 0.0)
    for n in range(30):
        history, note = history.apply(MoveCut(float(n)), 0.1 + 0.05 * n)
        assert note == ""
    assert history.present[Cut].at == 29.0
    assert history.undo().present[Cut].at == review[Cut].at
    assert history.undo().present[Cut].on
    assert history.undo().undo().present == review


def test_one_grip_of_the_plane_is_one_step_however_long_it_pauses(review: Review) -> None:
    history = History(review)
    for n, at in enumerate((10.0, 20.0, 30.0)):
        history, _ = history.apply(MoveCut(at, held=1), 5.0 * n)
    history, _ = history.apply(MoveCut(40.0, held=2), 20.0)
    assert history.undo().present[Cut].at == 30.0
    assert history.undo().undo().present == review


def test_a_plane_beyond_everything_is_kept_within_reach(review: Review) -> None:
    there, note = change(review, MoveCut(1e9))
    assert "x′ is kept within" in note
    assert there[Cut].at == 1e4
    assert change(review, MoveCut(1200.0))[1] == ""
    with pytest.raises(InputError, match="x′ must be a finite number"):
        change(review, MoveCut(math.nan))


def test_the_settings_of_a_map_are_checked(review: Review) -> None:
    good = Chart("pieces", Span(-0.1, 0.2, 5), Span(0.0, 1.0, 2))
    assert change(review, SetChart(good))[0][Chart] == good
    for bad, message in (
        (replace(good, quantity="mass"), "not 'mass'"),
        (replace(good, first=Span(0.2, 0.2, 5)), "φ must end above"),
        (replace(good, second=Span(0.0, 1.0, 1)), "values of θ"),
        (replace(good, second=Span(0.0, 1.0, 10_000)), "values of θ"),
        (replace(good, first=Span(-4.0, 0.2, 5)), "φ must stay within −180 … 180 °"),
        (replace(good, first=Span(math.nan, 0.2, 5)), "finite"),
        (replace(good, colours=Colours(low=math.nan)), "are finite numbers"),
        (replace(good, colours=Colours(high=math.inf)), "are finite numbers"),
        (replace(good, colours=Colours(low=2.0, high=2.0)), "must end above"),
        (replace(good, colours=Colours(step=-1.0)), "is positive"),
    ):
        with pytest.raises(InputError, match=message):
            change(review, SetChart(bad))


def test_another_design_keeps_section_and_map(review: Review) -> None:
    shown, _ = change(review, SetCut("on", True))
    shown, _ = change(shown, SetChart(Chart("pieces", Span(-0.1, 0.2, 5), Span(0.0, 1.0, 2))))
    other, _ = change(shown, UseDesign(load_design("rpur-table2")))
    assert other[Cut].on
    assert other[Cut].at == pytest.approx(point_in_section(other)[0])
    assert other[Chart] == shown[Chart]


def test_what_is_saved_of_an_edited_preset_says_that_it_was_edited(review: Review) -> None:
    name, link = review.design.name, review.design.limbs[0].link  # type: ignore[attr-defined]
    edited, _ = change(review, EditDesign(((("limb", 0, "link"), 175.0),)))
    file = design_file(edited.design)
    assert file.name == f"{name}-edited.toml"
    text = file.data.decode()
    assert "(edited)" in text
    assert f'source = "edited from {name};' in text
    assert session.from_text(session.to_text(edited), origin="x").design == edited.design
    back, _ = change(edited, EditDesign(((("limb", 0, "link"), link),)))
    assert back.design == review.design
    assert design_file(back.design).name == f"{name}.toml"
