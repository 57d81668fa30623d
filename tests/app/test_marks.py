"""Saved views, notes and dimensions: kept in a session, undone, carried, and what is refused."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from app.features.design.state import UseDesign
from app.features.marks.model import Anchor, Dimension, Note, SavedView, looks_of, measure_of
from app.features.marks.state import AddMark, DropMark, Marks, NameMark, Recall
from app.features.section.state import SetCut
from app.features.solutions.state import SetAtlas
from app.features.workspace.state import Fade, Show
from app.review import session
from app.review.changes import Change, SetOption, change
from app.review.history import History
from app.review.state import Options, Review, new_review
from app.scene.camera import Camera
from kinematics.designs.files import load_design
from kinematics.errors import InputError

CAMERA = Camera((900.0, -800.0, 700.0), (10.0, 20.0, 200.0), (0.0, 0.0, 1.0), math.radians(30.0))
JOINT, OTHER = Anchor("point", "limb1/A"), Anchor("point", "limb2/C")
PLACE, BASE = Anchor("point", at=(1.0, 2.0, 3.5)), Anchor("plane", "base")


def _after(review: Review, *changes: Change) -> Review:
    for each in changes:
        review, _ = change(review, each)
    return review


@pytest.fixture(scope="module")
def review() -> Review:
    """Of Table 1, with marks of every kind."""
    fresh = new_review(load_design("rpur-table1"))
    fresh = _after(fresh, SetOption("labels", True), SetAtlas("ghosts", True), SetCut("on", True))
    view = SavedView("from above", CAMERA, looks_of(fresh))
    there = replace(view, text="there", pose=fresh.pose, mode=fresh.mode)
    return _after(
        fresh,
        AddMark("views", view),
        AddMark("views", there),
        AddMark("notes", Note("look <here>", fresh.pose, fresh.mode, JOINT, CAMERA)),
        AddMark("notes", Note("and there", fresh.pose, fresh.mode)),
        AddMark("dimensions", Dimension("", (JOINT, OTHER))),
        AddMark("dimensions", Dimension("height", (PLACE, BASE))),
    )


@pytest.mark.parametrize("name", ["rpur-table1", "five-bar", "gough", "rps-3"])
def test_marks_are_kept_in_a_session(name: str, review: Review) -> None:
    if name != "rpur-table1":
        fresh = new_review(load_design(name))
        view = SavedView("v", CAMERA, looks_of(fresh), fresh.pose, fresh.mode)
        note = Note("n", fresh.pose, fresh.mode)
        review = _after(fresh, AddMark("views", view), AddMark("notes", note))
    text = session.to_text(review)
    again = session.from_text(text, origin="x")
    assert session.to_text(again) == text
    assert again[Marks].dimensions == review[Marks].dimensions
    for one, other in zip(again[Marks].views, review[Marks].views, strict=True):
        assert one.looks == other.looks
        assert one.camera.position == other.camera.position
        assert one.pose == pytest.approx(other.pose, abs=1e-12)


def test_sessions_from_before_there_were_marks_still_open(review: Review) -> None:
    content = json.loads(session.to_text(review))
    del content["marks"]
    assert session.from_text(json.dumps(content), origin="x")[Marks] == Marks()


def test_each_is_a_step_that_can_be_taken_back(review: Review) -> None:
    history = History(review)
    done = (
        DropMark("views", 0),
        NameMark("notes", 1, "  and   here "),
        NameMark("dimensions", 0, ""),
        AddMark("views", replace(review[Marks].views[1], camera=replace(CAMERA, fov=0.2))),
    )
    for n, each in enumerate(done):
        history, _ = history.apply(each, 10.0 * n)
    assert [v.camera.fov for v in history.present[Marks].views] == [0.2]  # of the same name: again
    assert history.present[Marks].notes[1].text == "and here"
    assert history.present[Marks].dimensions[0].anchors[1].short == "C₂"
    titles = ["view there kept", "renamed: and here", "view from above removed"]
    assert history.titles(False, 9) == titles  # a dimension had no name before
    for _ in titles:
        history = history.undo()
    assert history.present == review


def test_a_view_brings_back_what_was_shown_and_if_wished_the_pose(review: Review) -> None:
    shown, there = review[Marks].views
    moved = replace(review, pose=tuple(0.9 * v for v in review.pose))
    changes = (SetOption("labels", False), SetOption("dark", True), SetCut("on", False))
    other = _after(moved, *changes, Show("limb1/H2", True), Fade(("workspace",), 0.8))
    back = _after(other, Recall(shown))
    assert back[Options].dark  # is of the page
    assert looks_of(back) == looks_of(review)
    assert back.pose == other.pose
    assert _after(other, Recall(there)).pose == review.pose
    # Nothing but how it is shown: a step of its own kind.
    history, _ = History(other).apply(Recall(shown), 0.0)
    assert history.titles(True, 1) == ["view from above"]


def test_what_was_measured_is_told_in_the_list_of_changes(review: Review) -> None:
    between = (Anchor("line", "limb2/rail"), PLACE)
    history, _ = History(review).apply(AddMark("dimensions", Dimension("", between)), 0.0)
    assert history.titles(False, 1) == ["dimension rail 2 – (1, 2, 3.5)"]


def test_another_machine_keeps_where_people_looked_from(review: Review) -> None:
    same = _after(review, UseDesign(load_design("rpur-table2")))
    assert same[Marks] == review[Marks]
    other = _after(review, UseDesign(load_design("five-bar")))[Marks]
    assert [(v.text, v.camera, v.looks, v.pose) for v in other.views] == [
        ("from above", CAMERA, (), ()),
        ("there", CAMERA, (), ()),
    ]
    assert not other.notes
    assert not other.dimensions


@pytest.mark.parametrize(
    ("anchors", "measure"),
    [
        ((JOINT, OTHER), "distance"),
        ((BASE, PLACE), "distance"),
        ((Anchor("line", "limb1/rail"), JOINT), "distance"),
        ((Anchor("line", "limb1/rail"), BASE), "angle"),
        ((JOINT, OTHER, PLACE), "angle"),
        ((JOINT, JOINT), ""),
        ((JOINT,), ""),
        ((JOINT, OTHER, BASE), ""),
        ((JOINT, Anchor("point", at=(math.nan, 0.0, 0.0))), ""),
        ((JOINT, Anchor("point")), ""),
    ],
)
def test_what_can_be_measured(anchors: tuple[Anchor, ...], measure: str) -> None:
    if measure:
        assert measure_of(anchors) == measure
        return
    with pytest.raises(InputError):
        measure_of(anchors)


@pytest.mark.parametrize(
    ("what", "message"),
    [
        (AddMark("views", SavedView(" ", CAMERA)), "a view needs a name"),
        (AddMark("notes", Note("", (), "")), "a note needs a text"),
        (AddMark("notes", Note("x" * 501, (), "")), "500 letters are the most"),
        (AddMark("notes", Note("x", (1.0,), "+++++")), "none of this machine"),
        (NameMark("views", 0, "there"), "another view is called there"),
        (Recall(SavedView("elsewhere", CAMERA)), "not there any more"),
        (DropMark("notes", 7), "not there any more"),
        (NameMark("dimensions", -1, "x"), "not there any more"),
        (AddMark("dimensions", Dimension("", (JOINT,))), "between two different things"),
    ],
)
def test_what_cannot_be_marked_is_said(review: Review, what: Change, message: str) -> None:
    with pytest.raises(InputError, match=message):
        change(review, what)


def test_no_more_than_fit(review: Review) -> None:
    one = AddMark("dimensions", Dimension("x", (JOINT, OTHER)))
    full = _after(review, *[one] * (50 - len(review[Marks].dimensions)))
    with pytest.raises(InputError, match="at most 50 dimensions"):
        change(full, one)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        ({"views": 3}, "marks: views is not of the right kind"),
        ({"views": [{"name": "x"}]}, "views 1: camera: position is not"),
        ({"notes": [{"text": "x"}]}, "notes 1: 'pose' is missing"),
        ({"notes": [{"text": 3, "pose": {}}]}, "notes 1"),
        ({"dimensions": [{"between": [{"point": "limb1/A"}]}]}, "between two different things"),
        ({"dimensions": [{"between": [{"point": [1, 2]}]}]}, "between is not of the right kind"),
        ({"dimensions": [{"between": [{"edge": "x"}]}]}, "between is not of the right kind"),
        ({"dimensions": [{"name": "x"}]}, "'between' is missing"),
        ({"shown": 1}, "shown is not of the right kind"),
    ],
)
def test_each_fault_of_a_file_is_named(review: Review, edit: dict, message: str) -> None:
    content = json.loads(session.to_text(review))
    content["marks"] |= edit
    with pytest.raises(InputError, match=message):
        session.from_text(json.dumps(content), origin="x")


def test_a_camera_that_sees_nothing_is_refused(review: Review) -> None:
    content = json.loads(session.to_text(review))
    seen = content["marks"]["views"][0]["camera"]
    for wrong in ({"position": seen["look_at"]}, {"fov_deg": 0.0}, {"up": [0, 0, 0]}):
        content["marks"]["views"][0]["camera"] = seen | wrong
        with pytest.raises(InputError, match="views 1: camera: there is no picture from there"):
            session.from_text(json.dumps(content), origin="x")
