"""The solutions' process: newest wins, nothing old after something new, its death is survived."""

from __future__ import annotations

import os
import queue
import signal
import time
from collections.abc import Iterator
from typing import Any

import pytest

from app.solver import Foreseen, Solved, Solver, Unsolved, Wish
from app.state import new_review
from app.worker import Busy
from kinematics.designs import load_design
from kinematics.solutions import Posture

PATIENCE = 60.0  # s; only a hang is caught by it

DESIGN = load_design("rpur-a3a3")  # quick, so that the tests are


@pytest.fixture(scope="module")
def home() -> Posture:
    return new_review(DESIGN).posture


class Desk:
    """A solver and what it reported."""

    def __init__(self) -> None:
        self.events: queue.Queue[Any] = queue.Queue()
        self.solver = Solver(self.events.put)
        self.solver.start()

    def until(self, kind: type) -> Any:
        """The next event of a kind; what passes on the way is lost."""
        end = time.monotonic() + PATIENCE
        while True:
            event = self.events.get(timeout=max(0.01, end - time.monotonic()))
            if isinstance(event, kind):
                return event


@pytest.fixture(scope="module")
def shared() -> Iterator[Desk]:
    made = Desk()
    yield made
    made.solver.stop()


@pytest.fixture
def desk(shared: Desk) -> Desk:
    while not shared.events.empty():
        shared.events.get()
    return shared


def _longer(home: Posture, by: float) -> tuple[float, ...]:
    return (home.joints[0] + by, *home.joints[1:])


def test_what_is_wished_is_found(desk: Desk, home: Posture) -> None:
    wish = Wish(DESIGN, home.joints)
    desk.solver.want(wish)
    solved = desk.until(Solved)
    assert solved.wish is wish
    assert solved.refreshed.solutions.complete
    assert solved.refreshed.solutions.joints == home.joints
    assert solved.refreshed.appeared == ()


def test_it_goes_on_from_a_set_and_keeps_its_identities(desk: Desk, home: Posture) -> None:
    desk.solver.want(Wish(DESIGN, home.joints))
    first = desk.until(Solved).refreshed.solutions
    desk.solver.want(Wish(DESIGN, _longer(home, 0.01), before=first))
    refreshed = desk.until(Solved).refreshed
    second = refreshed.solutions
    assert second.joints == _longer(home, 0.01)
    gone = {m.identity for m in refreshed.merged}
    assert set(second.identities) == set(first.identities) - gone | set(refreshed.appeared)
    assert set(second.identities) & set(first.identities)


def test_the_newest_wish_wins_and_nothing_old_follows(desk: Desk, home: Posture) -> None:
    wishes = [Wish(DESIGN, _longer(home, 0.1 * n)) for n in range(25)]
    for wish in wishes:
        desk.solver.want(wish)
        time.sleep(0.004)
    seen = [desk.until(Solved).wish]
    while seen[-1] is not wishes[-1]:
        seen.append(desk.until(Solved).wish)
    assert len(seen) < 25
    assert [wishes.index(wish) for wish in seen] == sorted(wishes.index(wish) for wish in seen)
    time.sleep(0.3)
    assert not [e for e in desk.events.queue if isinstance(e, Solved)]


def test_a_wish_taken_back_is_not_worked_on(desk: Desk, home: Posture) -> None:
    desk.solver.want(Wish(DESIGN, home.joints))
    desk.solver.want(None)
    time.sleep(0.4)
    assert desk.events.empty()


def test_the_folds_ahead_are_looked_for(desk: Desk, home: Posture) -> None:
    desk.solver.want(Wish(DESIGN, home.joints, posture=home))
    foreseen = desk.until(Foreseen)
    assert {(a.index, a.longer) for a in foreseen.ahead} == {
        (n, longer) for n in range(5) for longer in (False, True)
    }
    for ahead in foreseen.ahead:
        assert (ahead.goal > ahead.start) == ahead.longer
        if ahead.fold is not None:
            assert min(ahead.start, ahead.end) < ahead.goal < max(ahead.start, ahead.end)


def test_the_death_of_the_process_is_told_and_survived(desk: Desk, home: Posture) -> None:
    desk.solver.want(Wish(DESIGN, home.joints))
    desk.until(Solved)
    assert desk.solver.pid is not None
    os.kill(desk.solver.pid, signal.SIGKILL)
    time.sleep(0.2)
    desk.solver.want(Wish(DESIGN, _longer(home, 2.0)))
    assert desk.until(Solved).refreshed.solutions.complete


def test_a_death_at_work_costs_that_job_alone(desk: Desk, home: Posture) -> None:
    slow = Wish(DESIGN, home.joints, mixed=True)
    desk.solver.want(slow)
    while desk.until(Busy).title is None:
        pass
    time.sleep(0.05)
    assert desk.solver.pid is not None
    os.kill(desk.solver.pid, signal.SIGKILL)
    told = desk.until(Unsolved)
    assert told.wish is slow
    assert "stopped" in told.text
    desk.solver.want(Wish(DESIGN, home.joints))
    assert desk.until(Solved).wish.design == DESIGN


def test_cancelling_gives_up_the_job_without_a_word(desk: Desk, home: Posture) -> None:
    slow = Wish(DESIGN, home.joints, mixed=True)
    desk.solver.want(slow)
    while desk.until(Busy).title is None:
        pass
    time.sleep(0.05)
    desk.solver.cancel()
    told = desk.until(Unsolved)
    assert (told.wish, told.text) == (slow, "")
    desk.solver.want(Wish(DESIGN, home.joints))
    assert desk.until(Solved).wish.design == DESIGN


def test_what_cannot_be_computed_is_told(desk: Desk, home: Posture) -> None:
    desk.solver.want(Wish(DESIGN, (-1.0, *home.joints[1:])))
    told = desk.until(Unsolved)
    assert "positive" in told.text
    desk.solver.want(Wish(DESIGN, home.joints))
    desk.until(Solved)
