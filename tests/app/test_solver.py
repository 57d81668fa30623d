"""The solutions' lane: what is found is right, newest wins, nothing old after something new."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import pytest

from app.features.solutions.compute import SOLUTIONS, Wish, look_ahead
from app.jobs.lane import Done, Job, Lost
from app.review.state import new_review
from kinematics.answers.solutions import Posture
from kinematics.designs.files import load_design
from tests.app import lanes
from tests.app.lanes import Desk

DESIGN = load_design("rpur-a3a3")  # quick, so that the tests are


@pytest.fixture(scope="module")
def home() -> Posture:
    return new_review(DESIGN).posture


@pytest.fixture(scope="module")
def shared() -> Iterator[Desk]:
    with lanes.desk("solutions") as made:
        yield made


@pytest.fixture
def desk(shared: Desk) -> Desk:
    shared.clear()
    return shared


def _longer(home: Posture, by: float) -> tuple[float, ...]:
    return (home.joints[0] + by, *home.joints[1:])


def job(wish: Wish) -> Job:
    """What the lane has to do for a wish."""
    return Job(wish, SOLUTIONS.title, SOLUTIONS.answer, (wish,), SOLUTIONS.rest)


def _found(desk: Desk, wish: Wish) -> Any:
    """What comes of a wish."""
    desk.lane.want((job(wish),))
    done = desk.until(Done)
    assert done.job.key is wish
    return done.result


@pytest.mark.slow
def test_what_is_wished_is_found(desk: Desk, home: Posture) -> None:
    refreshed = _found(desk, Wish(DESIGN, home.joints))
    assert refreshed.solutions.complete
    assert refreshed.solutions.joints == home.joints
    assert refreshed.appeared == ()


def test_it_goes_on_from_a_set_and_keeps_its_identities(desk: Desk, home: Posture) -> None:
    first = _found(desk, Wish(DESIGN, home.joints)).solutions
    refreshed = _found(desk, Wish(DESIGN, _longer(home, 0.01), before=first))
    second = refreshed.solutions
    assert second.joints == _longer(home, 0.01)
    gone = {m.identity for m in refreshed.merged}
    assert set(second.identities) == set(first.identities) - gone | set(refreshed.appeared)
    assert set(second.identities) & set(first.identities)


@pytest.mark.slow
def test_an_equal_wish_is_worked_on_again(desk: Desk, home: Posture) -> None:
    first = _found(desk, Wish(DESIGN, home.joints))
    assert _found(desk, Wish(DESIGN, home.joints)) is not first


def test_the_newest_wish_wins_and_nothing_old_follows(desk: Desk, home: Posture) -> None:
    wishes = [Wish(DESIGN, _longer(home, 0.1 * n)) for n in range(25)]
    for wish in wishes:
        desk.lane.want((job(wish),))
        time.sleep(0.004)
    seen = [desk.until(Done).job.key]
    while seen[-1] is not wishes[-1]:
        seen.append(desk.until(Done).job.key)
    assert len(seen) < 25
    assert [wishes.index(wish) for wish in seen] == sorted(wishes.index(wish) for wish in seen)
    time.sleep(0.3)
    assert not [e for e in desk.events.queue if isinstance(e, Done)]


def test_the_folds_ahead_are_looked_for(desk: Desk, home: Posture) -> None:
    desk.lane.want((Job("folds", "", look_ahead, (DESIGN, home)),))
    ahead = desk.until(Done).result
    assert {(a.index, a.longer) for a in ahead} == {
        (n, longer) for n in range(5) for longer in (False, True)
    }
    for way in ahead:
        assert (way.goal > way.start) == way.longer
        if way.fold is not None:
            assert min(way.start, way.end) < way.goal < max(way.start, way.end)


def test_what_cannot_be_computed_is_told(desk: Desk, home: Posture) -> None:
    desk.lane.want((job(Wish(DESIGN, (-1.0, *home.joints[1:]))),))
    assert "positive" in desk.until(Lost).text
    assert _found(desk, Wish(DESIGN, home.joints)).solutions.complete
