"""A review as a file: round trips, and one sentence for everything that is wrong."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.features.map.state import Chart, Colours, Span
from app.features.section.state import Cut
from app.features.solutions.state import Atlas
from app.features.workspace.state import Shown, Workspace
from app.review import session
from app.review.state import Options, Review, new_review
from kinematics.designs.files import load_design, presets
from kinematics.errors import InputError


@pytest.fixture(scope="module")
def review() -> Review:
    fresh = new_review(load_design("rpur-table2"))
    moved = replace(fresh, pose=(12.25, -7.5, 301.0, 0.2, -0.4), mode="+-+-+")
    solids = (Shown("workspace", 0.5), Shown("limb3/H2", 0.25))
    shown = Workspace(("+-+-+", "-----"), solids)
    return moved.having(shown, Options(labels=True, grid=False))


def test_what_is_written_reads_back(review: Review) -> None:
    again = session.from_text(session.to_text(review), origin="x")
    assert again.pose == pytest.approx(review.pose, abs=1e-12)
    assert replace(again, pose=review.pose) == review


@pytest.mark.parametrize("name", [p.name for p in presets()])
def test_every_preset_survives(name: str) -> None:
    fresh = new_review(load_design(name))
    again = session.from_text(session.to_text(fresh), origin="x")
    assert again.design == fresh.design
    assert again.posture.mode == fresh.posture.mode


def test_files_are_replaced_whole(review: Review, tmp_path: Path) -> None:
    path = tmp_path / "review.json"
    session.save(review, path)
    session.save(replace(review, mode="-----"), path)
    assert session.load(path).mode == "-----"
    assert [p.name for p in tmp_path.iterdir()] == ["review.json"]


def test_a_folder_that_is_not_there(review: Review, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot write"):
        session.save(review, tmp_path / "none" / "x.json")
    with pytest.raises(InputError, match="cannot be read"):
        session.load(tmp_path / "none.json")


def test_not_text(tmp_path: Path) -> None:
    path = tmp_path / "x.json"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not text"):
        session.load(path)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        ({"bohemia_session": 99}, "version"),
        ({"design": 3}, "design"),
        ({"design": "mechanism = 'none'"}, "mechanism"),
        ({"pose": {"x": 1.0}}, "pose has no y"),
        ({"pose": {"x": "a", "y": 0, "z": 0, "phi_deg": 0, "theta_deg": 0}}, "finite number"),
        ({"working_mode": "++"}, "working mode"),
        ({"workspace_modes": ["+-"]}, "working mode"),
        ({"workspace_modes": "some"}, "workspace_modes"),
        ({"workspace_modes": [["+"]]}, "working mode"),
        ({"solids": {"workspace": "much"}}, "finite number"),
        ({"options": []}, "options"),
    ],
)
def test_each_fault_is_named(review: Review, edit: dict, message: str) -> None:
    content = json.loads(session.to_text(review)) | edit
    with pytest.raises(InputError, match=message) as caught:
        session.from_text(json.dumps(content), origin="a.json")
    assert str(caught.value).startswith(("a.json: ", "a.json, design, line 1: "))


def test_nan_in_a_pose_is_refused(review: Review) -> None:
    content = json.loads(session.to_text(review))
    content["pose"]["x"] = float("nan")
    with pytest.raises(InputError, match="finite"):
        session.from_text(json.dumps(content), origin="x")


@given(st.text(max_size=200))
def test_any_text_is_answered(text: str) -> None:
    with pytest.raises(InputError):
        session.from_text(text, origin="x")


def test_what_is_too_large_is_refused() -> None:
    with pytest.raises(InputError, match="smaller"):
        session.from_text(" " * (session.MAX_BYTES + 1), origin="x")


def test_how_solutions_are_shown_is_kept(review: Review) -> None:
    wanted = Atlas(ghosts=True, sort="condition", modes="+?+?+, -----")
    shown = review.having(wanted)
    assert session.from_text(session.to_text(shown), origin="x")[Atlas] == shown[Atlas]


def test_sessions_from_before_there_were_solutions_still_open(review: Review) -> None:
    content = json.loads(session.to_text(review))
    del content["solutions"]
    again = session.from_text(json.dumps(content), origin="x")
    assert again[Atlas] == Atlas()
    assert again.mode == review.mode


def test_the_present_mode_alone_is_one_thing_now(review: Review) -> None:
    content = json.loads(session.to_text(review)) | {"solutions": {"modes": "same"}}
    again = session.from_text(json.dumps(content), origin="x")
    assert again[Atlas] == Atlas(only="mode")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([], "'solutions' is not of the right kind"),
        ({"ghosts": "yes"}, "solutions: ghosts"),
        ({"sort": 3}, "solutions: sort"),
        ({"sort": "colour"}, "sorted by"),
        ({"modes": "+"}, "not a working mode"),
    ],
)
def test_broken_ways_of_showing_solutions(review: Review, given: object, message: str) -> None:
    content = json.loads(session.to_text(review)) | {"solutions": given}
    with pytest.raises(InputError, match=message):
        session.from_text(json.dumps(content), origin="a.json")


def test_section_and_map_are_kept(review: Review) -> None:
    colours = Colours(low=0.5, high=None, contours=False, step=2.0)
    chart = Chart("pieces", Span(-0.5, 0.25, 7), Span(0.0, 1.0, 11), colours)
    shown = review.having(Cut(on=True, at=-12.5), chart)
    again = session.from_text(session.to_text(shown), origin="x")
    assert again[Cut] == shown[Cut]
    assert again[Chart].quantity == "pieces"
    assert again[Chart].colours == colours
    for span, expected in ((again[Chart].first, chart.first), (again[Chart].second, chart.second)):
        assert (span.low, span.high) == pytest.approx((expected.low, expected.high), abs=1e-12)
        assert span.count == expected.count


def test_sessions_from_before_there_were_sections_and_maps_still_open(review: Review) -> None:
    content = json.loads(session.to_text(review))
    del content["section"], content["map"]
    again = session.from_text(json.dumps(content), origin="x")
    fresh = new_review(review.design)
    assert (again[Cut], again[Chart]) == (fresh[Cut], fresh[Chart])


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        ({"section": []}, "'section' is not of the right kind"),
        ({"section": {"on": 1}}, "'section' is not of the right kind"),
        ({"section": {"at": "far"}}, "section: at must be a finite number"),
        ({"map": 7}, "'map' is not of the right kind"),
        ({"map": {"quantity": "mass"}}, "not 'mass'"),
        ({"map": {"quantity": []}}, "a map shows"),
        ({"map": {"phi_deg": [0, 10]}}, "from, to, how many"),
        ({"map": {"phi_deg": [0, 10, 2.5]}}, "from, to, how many"),
        ({"map": {"phi_deg": [0, "10", 3]}}, "finite number"),
        ({"map": {"theta_deg": [10, 0, 3]}}, "θ must end above"),
        ({"map": {"theta_deg": [0, 999, 3]}}, "must stay within"),
        ({"map": {"colours": 3}}, "'colours' is not of the right kind"),
        ({"map": {"colours": {"low": "a"}}}, "finite number"),
        ({"map": {"colours": {"low": 2, "high": 1}}}, "must end above"),
        ({"map": {"colours": {"step": -1}}}, "the step of the contours"),
        ({"map": {"colours": {"contours": 1}}}, "are drawn or not"),
    ],
)
def test_broken_sections_and_maps(review: Review, edit: dict, message: str) -> None:
    content = json.loads(session.to_text(review)) | edit
    with pytest.raises(InputError, match=message) as caught:
        session.from_text(json.dumps(content), origin="a.json")
    assert str(caught.value).startswith("a.json: ")
