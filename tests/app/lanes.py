"""A lane at work, as tests look on."""

from __future__ import annotations

import queue
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from app.jobs.lane import Busy, Done, Lane

PATIENCE = 150.0  # s; only a hang is caught by it


class Desk:
    """A lane and what it reported."""

    def __init__(self, name: str) -> None:
        self.events: queue.Queue[Any] = queue.Queue()
        self.lane = Lane(name, self.events.put)

    def until(self, kind: type) -> Any:
        """The next event of a kind; what passes on the way is lost."""
        end = time.monotonic() + PATIENCE
        while True:
            event = self.events.get(timeout=max(0.01, end - time.monotonic()))
            if isinstance(event, kind):
                return event

    def begun(self, title: str) -> None:
        """Wait until the job with this title is at work."""
        while self.until(Busy).title != title:
            pass

    def results(self, last: object) -> list[Any]:
        """What was done until the job with this key was."""
        found = []
        while True:
            done = self.until(Done)
            found.append(done.result)
            if done.job.key == last:
                return found

    def clear(self) -> None:
        """Nothing is wanted and nothing was reported."""
        self.lane.want(())
        while not self.events.empty():
            self.events.get()


@contextmanager
def desk(name: str) -> Iterator[Desk]:
    """A lane that works for as long as this lasts."""
    made = Desk(name)
    made.lane.start()
    yield made
    made.lane.stop()
