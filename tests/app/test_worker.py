"""The lanes: newest wish wins, coarse before fine, and the death of a process is survived."""

from __future__ import annotations

import os
import queue
import signal
import time
from collections.abc import Iterator
from dataclasses import replace

import pytest

from app.features.move.state import Move
from app.features.workspace import compute as view
from app.features.workspace.state import Show
from app.jobs.worker import Built, Busy, Event, Failed, Worker
from app.review.changes import change
from app.review.state import Review, new_review
from kinematics.designs.files import load_design
from kinematics.errors import BohemiaError

PATIENCE = 60.0  # s; only a hang is caught by it


@pytest.fixture(scope="module")
def review() -> Review:
    return new_review(load_design("rpur-table1"))


class Desk:
    """A worker and what it reported."""

    def __init__(self) -> None:
        self.events: queue.Queue[Event] = queue.Queue()
        self.worker = Worker(self.events.put)
        self.worker.start()

    def until(self, kind: type, **wanted: object) -> Event:
        """The next event of a kind with these attributes."""
        end = time.monotonic() + PATIENCE
        while True:
            event = self.events.get(timeout=max(0.01, end - time.monotonic()))
            if isinstance(event, kind) and all(
                getattr(event, name) == value for name, value in wanted.items()
            ):
                return event


@pytest.fixture
def desk() -> Iterator[Desk]:
    made = Desk()
    yield made
    made.worker.stop()


def test_coarse_comes_first_and_finer_when_the_hand_rests(desk: Desk, review: Review) -> None:
    wishes = view.wishes(review)
    desk.worker.want(wishes)
    order = []
    while len(order) < 3:
        built = desk.until(Built)
        assert isinstance(built, Built)
        order.append(built.resolution)
        assert built.solid.watertight
    assert order == ["preview", "normal", "fine"]


def test_what_was_wished_last_is_what_comes(desk: Desk, review: Review) -> None:
    for n in range(40):
        review, _ = change(review, Move(3, 0.01 * n))
        desk.worker.want(view.wishes(review))
        time.sleep(0.005)
    last = view.wishes(review)[0].what
    seen = []
    while True:
        built = desk.until(Built)
        assert isinstance(built, Built)
        seen.append(built.wish.what)
        if built.wish.what == last:
            break
    assert len(seen) < 40  # most wishes were void before their turn came
    # After the newest nothing older may follow.
    desk.until(Built, resolution="fine")
    while not desk.events.empty():
        event = desk.events.get()
        assert not isinstance(event, Built) or event.wish.what == last


def test_a_wish_seen_before_comes_from_the_cache_at_once(desk: Desk, review: Review) -> None:
    desk.worker.want(view.wishes(review))
    desk.until(Built, resolution="fine")
    other, _ = change(review, Move(3, 0.3))
    desk.worker.want(view.wishes(other))
    desk.until(Built, resolution="preview")
    while not desk.events.empty():
        desk.events.get()
    desk.worker.want(view.wishes(review))
    first = desk.events.get_nowait()
    assert isinstance(first, Built)
    assert first.resolution == "fine"


def test_equal_limbs_are_built_once(desk: Desk, review: Review) -> None:
    for limb in range(1, 6):
        review, _ = change(review, Show(f"limb{limb}/whole", True))
    review, _ = change(review, Show("workspace", False))
    wishes = view.wishes(review)
    assert len({wish.what for wish in wishes}) == 1
    desk.worker.want(wishes)
    keys = set()
    while len(keys) < 5:
        built = desk.until(Built, resolution="preview")
        assert isinstance(built, Built)
        keys.add(built.wish.spec.key)
    placements = {wish.placement.tobytes() for wish in wishes}
    assert len(placements) == 5


def test_the_death_of_the_processes_is_survived(desk: Desk, review: Review) -> None:
    desk.worker.want(view.wishes(review))
    desk.until(Built, resolution="preview")
    for pid in desk.worker.pids:
        os.kill(pid, signal.SIGKILL)
    moved, _ = change(review, Move(4, 0.2))
    desk.worker.want(view.wishes(moved))
    built = desk.until(Built, resolution="preview")
    assert isinstance(built, Built)
    assert built.wish.what == view.wishes(moved)[0].what
    desk.until(Built, resolution="fine")


def test_what_cannot_be_computed_is_told_and_the_next_works(desk: Desk, review: Review) -> None:
    wish = view.wishes(review)[0]
    broken = {
        name: replace(request, arguments=("nonsense", name))
        for name, request in wish.requests.items()
    }
    desk.worker.want((replace(wish, requests=broken),))
    failed = desk.until(Failed)
    assert isinstance(failed, Failed)
    assert "could not be computed" in failed.text
    desk.worker.want((wish,))
    desk.until(Built, resolution="preview")


def test_cancelling_keeps_the_coarse_solid_and_gives_up_the_fine(
    desk: Desk, review: Review
) -> None:
    desk.worker.want(view.wishes(review))
    desk.until(Built, resolution="preview")
    desk.until(Busy, lane="fine")
    desk.worker.cancel()
    moved, _ = change(review, Move(3, 0.15))
    desk.worker.want(view.wishes(moved))
    built = desk.until(Built, resolution="normal")
    assert isinstance(built, Built)
    assert built.wish.what == view.wishes(moved)[0].what


def test_work_apart_reports_its_failure() -> None:
    assert Worker.apart(pow, 2, 10) == 1024
    with pytest.raises(BohemiaError, match="ZeroDivisionError"):
        Worker.apart(divmod, 1, 0)
    with pytest.raises(BohemiaError, match="stopped"):
        Worker.apart(os._exit, 3)
    with pytest.raises(BohemiaError, match="given up"):
        Worker.apart(time.sleep, 30, timeout=0.5)
