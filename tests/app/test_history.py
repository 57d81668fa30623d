"""What is reviewed and how it is shown are taken back apart, and each step has a name."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.features.design.state import EditDesign, UseDesign
from app.features.move.state import Drive, Flip, GoHome, Move
from app.features.solutions.state import SetAtlas
from app.features.workspace.state import ChooseModes, Fade, Show
from app.review.changes import Change, SetOption
from app.review.history import History
from app.review.state import Options, Review, new_review
from kinematics.designs.files import load_design
from tests.app.seats import Seat, seat

HOME = new_review(load_design("rpur-table1"))
DONE: tuple[Change, ...] = (
    Move(0, 300.0),
    Move(3, 0.2),
    Flip("-----"),
    EditDesign(((("limb", 1, "link"), 160.0),)),
    ChooseModes("all"),
    GoHome(),
)
SHOWN: tuple[Change, ...] = (
    SetOption("labels", True),
    SetOption("dark", True),
    SetOption("labels", False),
    Show("limb1/H1", True),
    Fade(("workspace",), 0.7),
    SetAtlas("ghosts", True),
)


def _history(steps: list[Change]) -> History:
    history = History(HOME)
    for n, step in enumerate(steps):
        history, _ = history.apply(step, 10.0 * n)
    return history


def _look(review: Review) -> Review:
    """The home review, shown as this one."""
    return HOME.shown_as(review)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.sampled_from(DONE + SHOWN), max_size=10), st.booleans())
def test_one_kind_is_taken_back_and_the_other_stays(steps: list[Change], looks: bool) -> None:
    history = there = _history(steps)
    while (before := history.undo(looks)) is not history:
        history = before
    kept, gone = (_look, lambda r: r.shown_as(HOME))[:: -1 if looks else 1]
    assert kept(history.present) == kept(there.present)
    assert gone(history.present) == HOME
    assert all(step.looks != looks for step in history.past)
    while (after := history.redo(looks)) is not history:
        history = after
    assert history.present == there.present


def test_a_step_of_the_other_kind_keeps_what_was_undone() -> None:
    history = _history([Move(0, 300.0), SetOption("labels", True)]).undo(looks=False)
    history, _ = history.apply(SetOption("dark", True), 99.0)
    again = history.redo(looks=False)
    assert again.present.pose[0] == 300.0
    assert again.present[Options].labels
    assert again.present[Options].dark
    history, _ = history.apply(Move(0, 200.0), 100.0)
    assert history.redo(looks=False) is history


def test_steps_are_named() -> None:
    steps = [*DONE[:5], Drive(0, 320.0), UseDesign(load_design("rpur-table2")), *SHOWN[:1]]
    assert _history(steps).titles(looks=False, most=20) == [
        "design rpur-table1-edited → rpur-table2",
        "ρ₁ driven to 320.0 mm",
        "workspace modes current → all",
        "Limb 2: link l 150 → 160 mm",
        "mode +−+−+ → −−−−−",
        "φ 0 → 11.5 °",
        "x 326 → 300 mm",
    ]
    assert _history(list(SHOWN)).titles(looks=True, most=3) == [
        "solutions ghosts on",
        "opacity 0.7",
        "Limb 1: hole H₁ shown",
    ]


@pytest.fixture(scope="module")
def page():
    with seat() as opened:
        yield opened


def test_the_list_takes_back_what_is_pressed_and_says_so(page: Seat) -> None:
    page.do(Move(0, 300.0), SetOption("labels", True), Move(1, 60.0), Move(2, 200.0))
    page.press("Take back: y 73 → 60 mm")
    assert page.review.pose[:3] == (300.0, 73.0, 211.0)
    assert page.review[Options].labels
    assert "Taken back: z 211 → 200 mm; y 73 → 60 mm" in page.text()
    page.press("Display as before")
    assert not page.review[Options].labels
    assert page.review.pose[0] == 300.0
    page.press("Redo")
    assert "Done again: y 73 → 60 mm" in page.text()
    assert page.review.pose[:3] == (300.0, 60.0, 211.0)
