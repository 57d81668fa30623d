"""What is known of the solutions while a review changes, as the page's loop goes through it."""

from __future__ import annotations

import os
import queue
import signal
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from app.features.design.state import EditDesign, UseDesign
from app.features.move.state import Drive, Move
from app.features.solutions.part import Explorer
from app.jobs.lane import Busy, Done, Lost
from app.review import view as compute
from app.review.changes import change
from app.review.state import Review, new_review
from kinematics.designs.files import load_design
from kinematics.errors import BohemiaError

PATIENCE = 60.0  # s; only a hang is caught by it


class Loop:
    """As much of the page's loop as the explorer needs."""

    def __init__(self) -> None:
        self.events: queue.Queue[Any] = queue.Queue()
        self.explorer = Explorer(self.events.put)
        self.explorer.lane.start()

    def show(self, review: Review) -> compute.View:
        view = compute.view(review)
        self.explorer.look(view)
        self.explorer.catch_up(view)
        return view

    def until(self, view: compute.View, holds: Callable[[], bool]) -> None:
        end = time.monotonic() + PATIENCE
        while not holds():
            event = self.events.get(timeout=max(0.01, end - time.monotonic()))
            if isinstance(event, Done | Lost):
                self.explorer.take(event, view)

    def settle(self, view: compute.View) -> None:
        """Wait until the solutions and the folds ahead are of this view."""
        self.until(view, lambda: self.explorer.is_current(view))
        self.until(view, lambda: bool(self.explorer.folds(view)[0]))


@pytest.fixture
def loop() -> Iterator[Loop]:
    made = Loop()
    yield made
    made.explorer.lane.stop()


def test_a_quick_design_is_solved_in_the_same_turn(loop: Loop) -> None:
    review = new_review(load_design("rpur-a1a1"))
    view = loop.show(review)
    assert loop.explorer.is_current(view)
    assert any(row.here for row in loop.explorer.atlas(view).rows)
    first = loop.explorer.known
    moved, _ = change(review, Move(2, review.pose[2] + 0.5))
    view = loop.show(moved)
    assert loop.explorer.is_current(view)
    assert loop.explorer.known is not first
    (here,) = [row for row in loop.explorer.atlas(view).rows if row.here]
    assert here.pose == pytest.approx(moved.pose, abs=1e-6)


def test_a_general_design_is_solved_apart_and_gone_on_from(loop: Loop) -> None:
    review = new_review(load_design("rpur-table1"))
    view = loop.show(review)
    assert loop.explorer.known is None
    loop.settle(view)
    first = loop.explorer.known
    assert first is not None
    driven, _ = change(review, Drive(0, review.posture.joints[0] + 2.0))
    view = loop.show(driven)
    assert loop.explorer.atlas(view).stale
    assert loop.explorer.atlas(view).count  # the last ones stay
    loop.settle(view)
    second = loop.explorer.known
    assert second is not None
    kept = set(first.solutions.identities) & set(second.solutions.identities)
    assert len(kept) > len(first.solutions) / 2
    assert kept | second.appeared == set(second.solutions.identities)


def test_the_folds_ahead_begin_with_the_actuator_that_was_driven(loop: Loop) -> None:
    review = new_review(load_design("rpur-table1"))
    view = loop.show(review)
    loop.settle(view)
    ahead, nearest = loop.explorer.folds(view)
    assert nearest is not None
    assert nearest.fold is not None
    distances = {a.index: a.fold.distance for a in ahead if a.fold is not None}
    assert nearest.fold.distance == min(a.fold.distance for a in ahead if a.fold is not None)
    other = next(index for index in distances if index != nearest.index)
    loop.explorer.drove(other)
    told = loop.explorer.folds(view)[1]
    assert told is not None
    assert told.index == other
    loop.explorer.choose_fold((nearest.index, nearest.longer))
    assert loop.explorer.folds(view)[1] is nearest


def test_a_visit_waits_for_the_present_lengths(loop: Loop) -> None:
    review = new_review(load_design("rpur-a1a1"))
    view = loop.show(review)
    rows = loop.explorer.atlas(view).rows
    target = rows[1]
    moved, _ = change(review, Move(2, review.pose[2] + 0.05))
    later = compute.view(moved)
    loop.explorer.await_visit(target.identity)
    assert loop.explorer.visit(later) is None  # the set is of the lengths before
    loop.show(moved)
    due = loop.explorer.visit(later)
    assert due is not None
    assert due.mode == target.mode
    assert due.pose == pytest.approx(target.pose, abs=5.0)
    assert due.pose != target.pose
    assert loop.explorer.visit(later) is None  # once
    there, _ = change(moved, due)
    assert there.posture.joints == pytest.approx(moved.posture.joints, abs=1e-7)


def test_a_solution_that_is_gone_is_told(loop: Loop) -> None:
    view = loop.show(new_review(load_design("rpur-a1a1")))
    loop.explorer.await_visit(10_000)
    with pytest.raises(BohemiaError, match="#10000 is not there any more"):
        loop.explorer.visit(view)
    assert loop.explorer.visit(view) is None


def test_a_number_of_another_machine_is_not_looked_up_in_this_one(loop: Loop) -> None:
    review = new_review(load_design("rpur-a1a1"))
    view = loop.show(review)
    target = loop.explorer.atlas(view).rows[1]
    edited, _ = change(review, EditDesign(((("limb", 0, "platform", 0), -57.0),)))
    later = compute.view(edited)
    loop.explorer.await_visit(target.identity)
    with pytest.raises(BohemiaError, match="choose again"):
        loop.explorer.visit(later)
    loop.show(edited)
    assert loop.explorer.visit(compute.view(edited)) is None


def test_another_design_starts_afresh_and_what_comes_late_is_dropped(loop: Loop) -> None:
    general = new_review(load_design("rpur-table1"))
    late = loop.show(general)
    quick, _ = change(general, UseDesign(load_design("rpur-a1a1")))
    view = loop.show(quick)
    assert loop.explorer.is_current(view)
    known = loop.explorer.known
    loop.settle(view)
    assert loop.explorer.known is known
    assert not loop.explorer.is_current(late)


@pytest.mark.parametrize("how", ["cancelled", "killed"])
def test_a_search_that_was_given_up_says_why_and_the_next_one_works(loop: Loop, how: str) -> None:
    view, lane = loop.show(new_review(load_design("rpur-a3a3"))), loop.explorer.lane
    while not isinstance(event := loop.events.get(timeout=PATIENCE), Busy) or event.title is None:
        pass
    time.sleep(0.05)
    if how == "cancelled":
        lane.cancel()
    else:
        assert lane.pid is not None
        os.kill(lane.pid, signal.SIGKILL)
    while not isinstance(event := loop.events.get(timeout=PATIENCE), Lost):
        pass
    loop.explorer.take(event, view)
    assert loop.explorer.known is None
    assert ("all solutions stopped" in loop.explorer.trouble) == (how == "killed")
    assert (loop.explorer.trouble == "") == (how == "cancelled")
    loop.explorer.find_again(view)
    loop.until(view, lambda: loop.explorer.is_current(view))
    assert loop.explorer.trouble == ""


@pytest.mark.slow
def test_all_can_be_found_from_scratch(loop: Loop) -> None:
    review = new_review(load_design("rpur-a1a1"))
    view = loop.show(review)
    driven, _ = change(review, Drive(0, review.posture.joints[0] + 30.0))
    view = loop.show(driven)
    loop.explorer.find_again(view)
    assert loop.explorer.known is None
    loop.explorer.catch_up(view)
    known = loop.explorer.known
    assert known is not None
    assert (known.appeared, known.merged) == (frozenset(), ())


def test_a_machine_that_does_not_close_asks_for_nothing(loop: Loop) -> None:
    review = new_review(load_design("rpur-table1"))
    top = review.machine.coordinates[1].upper
    away, _ = change(review, Move(1, top))
    view = loop.show(away)
    time.sleep(0.3)
    assert loop.events.empty()
    assert "do not close" in loop.explorer.atlas(view).remarks[0][0]


def test_who_comes_and_goes_is_news_only_of_a_drive_and_numbers_stay_small(loop: Loop) -> None:
    review = new_review(load_design("rpur-a1a1"))
    loop.show(review)
    numbers: list[int] = []
    news = 0
    for n in range(40):
        if n < 20:
            loop.explorer.placed()
        else:
            loop.explorer.drove(0)
        moved = Move(0, review.pose[0] + 6.0 * (-1) ** n) if n < 20 else Drive(0, 260.0 + 5.0 * n)
        loop.show(change(review, moved)[0])
        known = loop.explorer.known
        assert known is not None
        numbers += known.solutions.identities
        news += bool(known.appeared or known.merged)
        assert n >= 20 or not news
    assert news
    assert max(numbers) <= 2 * known.solutions.complex_count
