"""The solids' lanes: newest wish wins, coarse before fine, the death of a process is survived."""

from __future__ import annotations

import os
import queue
import signal
import time
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from app.features.move.state import Move
from app.features.workspace import compute
from app.features.workspace.compute import Built
from app.features.workspace.part import SolidsPart
from app.features.workspace.state import Show
from app.jobs.lane import Busy, Done, Lost
from app.jobs.process import apart
from app.review.changes import change
from app.review.state import Review, new_review
from kinematics.designs.files import load_design
from kinematics.errors import BohemiaError

PATIENCE = 60.0  # s; only a hang is caught by it


@pytest.fixture(scope="module")
def review() -> Review:
    return new_review(load_design("rpur-table1"))


class Failed(Exception):
    """A solid was given up; ``text`` is for the user."""

    def __init__(self, text: str) -> None:
        self.text = text


class Desk:
    """The part that keeps solids, and what came of its work."""

    def __init__(self) -> None:
        self.inbox: queue.Queue[Any] = queue.Queue()
        self.stage: Any = SimpleNamespace(
            put=self.inbox.put, scene=None, complain=lambda text: None, note=lambda text: None
        )
        self.part = SolidsPart(self.stage)
        self.events: list[Any] = []
        self._seen: dict[str, Built] = {}
        self.part.start()

    def want(self, review: Review) -> None:
        self.stage.view = SimpleNamespace(review=review)
        self.part.ask()
        self._look()

    def _look(self) -> None:
        """Note which solids are there that were not."""
        built = self.part._built()
        for key, each in built.items():
            known = self._seen.get(key)
            if known is None or known.solid is not each.solid:
                self.events.append(each)
        self._seen = built

    def until(self, kind: type, **wanted: object) -> Any:
        """The next event of a kind with these attributes."""
        end = time.monotonic() + PATIENCE
        while True:
            while self.events:
                event = self.events.pop(0)
                if isinstance(event, kind) and all(
                    getattr(event, name) == value for name, value in wanted.items()
                ):
                    return event
            event = self.inbox.get(timeout=max(0.01, end - time.monotonic()))
            if isinstance(event, Busy):
                self.events.append(event)
            elif isinstance(event, Done | Lost):
                self.part.take(event)
                if isinstance(event, Lost):
                    self.events.append(Failed(event.text))
                self._look()

    @property
    def pids(self) -> list[int]:
        return [lane.pid for lane in self.part.lanes.values() if lane.pid is not None]


@pytest.fixture
def desk() -> Iterator[Desk]:
    made = Desk()
    yield made
    made.part.stop()


def test_coarse_comes_first_and_finer_when_the_hand_rests(desk: Desk, review: Review) -> None:
    desk.want(review)
    order = []
    while len(order) < 3:
        built = desk.until(Built)
        order.append(built.resolution)
        assert built.solid.watertight
    assert order == ["preview", "normal", "fine"]


def test_what_was_wished_last_is_what_comes(desk: Desk, review: Review) -> None:
    for n in range(40):
        review, _ = change(review, Move(3, 0.01 * n))
        desk.want(review)
        time.sleep(0.005)
    last = compute.wishes(review)[0].what
    seen = []
    while True:
        built = desk.until(Built)
        seen.append(built.wish.what)
        if built.wish.what == last:
            break
    assert len(seen) < 40  # most wishes were void before their turn came
    # After the newest nothing older may follow.
    desk.until(Built, resolution="fine")
    assert not any(isinstance(e, Built) and e.wish.what != last for e in desk.events)


def test_a_wish_seen_before_comes_from_the_cache_at_once(desk: Desk, review: Review) -> None:
    desk.want(review)
    desk.until(Built, resolution="fine")
    other, _ = change(review, Move(3, 0.3))
    desk.want(other)
    desk.until(Built, resolution="preview")
    desk.events.clear()
    desk.want(review)
    first = desk.events[0]
    assert isinstance(first, Built)
    assert first.resolution == "fine"


def test_equal_limbs_are_built_once(desk: Desk, review: Review) -> None:
    for limb in range(1, 6):
        review, _ = change(review, Show(f"limb{limb}/whole", True))
    review, _ = change(review, Show("workspace", False))
    wishes = compute.wishes(review)
    assert len({wish.what for wish in wishes}) == 1
    desk.want(review)
    keys = set()
    while len(keys) < 5:
        built = desk.until(Built, resolution="preview")
        keys.add(built.wish.spec.key)
    placements = {wish.placement.tobytes() for wish in wishes}
    assert len(placements) == 5


def test_the_death_of_the_processes_is_survived(desk: Desk, review: Review) -> None:
    desk.want(review)
    desk.until(Built, resolution="preview")
    for pid in desk.pids:
        os.kill(pid, signal.SIGKILL)
    moved, _ = change(review, Move(4, 0.2))
    desk.want(moved)
    built = desk.until(Built, resolution="preview")
    assert built.wish.what == compute.wishes(moved)[0].what
    desk.until(Built, resolution="fine")


def test_what_cannot_be_computed_is_told_and_the_next_works(
    desk: Desk, review: Review, monkeypatch: pytest.MonkeyPatch
) -> None:
    wish = compute.wishes(review)[0]
    broken = {
        name: replace(request, arguments=("nonsense", name))
        for name, request in wish.requests.items()
    }
    with monkeypatch.context() as patch:
        patch.setattr(
            "app.features.workspace.compute.wishes",
            lambda review: (replace(wish, requests=broken),),
        )
        desk.want(review)
        failed = desk.until(Failed)
    assert "could not be computed" in failed.text
    desk.want(review)
    desk.until(Built, resolution="preview")


def test_cancelling_keeps_the_coarse_solid_and_gives_up_the_fine(
    desk: Desk, review: Review
) -> None:
    desk.want(review)
    desk.until(Built, resolution="preview")
    desk.until(Busy, lane="fine")
    desk.part.cancel("fine")
    moved, _ = change(review, Move(3, 0.15))
    desk.want(moved)
    built = desk.until(Built, resolution="normal")
    assert built.wish.what == compute.wishes(moved)[0].what


def test_work_apart_reports_its_failure() -> None:
    assert apart(pow, 2, 10) == 1024
    with pytest.raises(BohemiaError, match="ZeroDivisionError"):
        apart(divmod, 1, 0)
    with pytest.raises(BohemiaError, match="stopped"):
        apart(os._exit, 3)
    with pytest.raises(BohemiaError, match="given up"):
        apart(time.sleep, 30, timeout=0.5)
