"""A process for one kind of work: the newest jobs win, and what is found comes in order.

It keeps nothing that a job needs of another, so its death costs only the job at work.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from app.jobs.process import GIVES_WAY, Process, give_way
from app.language import tr
from kinematics.errors import BohemiaError


@dataclass(frozen=True, eq=False, slots=True)
class Job:
    """A call to make in the process.

    Attributes:
        key: jobs with equal keys are the same work.
        title: what a person reads while it takes long.
        rest: s for which the job must have been wanted before it is begun.
        slow: it is given up at once when nobody wants it any more; others end quickly anyway.
        tries: how often it is begun if the process dies of it.
    """

    key: Hashable
    title: str
    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    rest: float = 0.0
    slow: bool = False
    tries: int = 1


@dataclass(frozen=True, eq=False, slots=True)
class Done:
    """A job with what it returned."""

    job: Job
    result: Any


@dataclass(frozen=True, eq=False, slots=True)
class Lost:
    """A job that was given up; ``text`` is for the user, "" if they cancelled it."""

    job: Job
    text: str


@dataclass(frozen=True, slots=True)
class Busy:
    """A lane began (a title) or ended (None) its work."""

    lane: str
    title: str | None
    since: float


class Lane:
    """Does the jobs that `want` was last told, in order; reports from its own thread.

    Args:
        prepare: called in the process first; left out, it gives way to those that build solids.
        warm: the process starts with the lane, not with the first job.
    """

    def __init__(
        self,
        name: str,
        on_event: Callable[[Done | Lost | Busy], None],
        *,
        prepare: Callable[[], None] | None = None,
        warm: bool = False,
    ) -> None:
        self.name = name
        self._report = on_event
        self._prepare = prepare or partial(give_way, GIVES_WAY)
        self._warm = warm
        self._changed = threading.Condition()
        self._jobs: tuple[Job, ...] = ()
        self._since: dict[Hashable, float] = {}
        self._answered: set[Hashable] = set()
        self._at_work: Job | None = None
        self._process: Process | None = None
        self._cancelled = False
        self._stopped = False
        self._thread = threading.Thread(target=self._work, name=name, daemon=True)

    def start(self) -> None:
        """Start the thread."""
        if self._warm:
            self._process = Process(self.name, self._prepare)
        self._thread.start()

    def want(self, jobs: Sequence[Job]) -> None:
        """These are the jobs from now on, the first to be done first; all others are void.

        What was answered while it was wanted is not done again.
        """
        now = time.monotonic()
        with self._changed:
            self._jobs = tuple(jobs)
            keys = {job.key for job in jobs}
            self._answered &= keys
            self._since = {key: self._since.get(key, now) for key in keys}
            at_work = self._at_work
            if at_work is not None and at_work.slow and at_work.key not in keys:
                self._give_up()
            self._changed.notify_all()

    def cancel(self) -> None:
        """Give up the job at work."""
        with self._changed:
            if self._at_work is not None:
                self._give_up()

    def _give_up(self) -> None:
        self._cancelled = True
        if self._process is not None:
            self._process.kill()

    def stop(self) -> None:
        """End the thread and the process."""
        with self._changed:
            self._stopped = True
            self._changed.notify_all()
            if self._process is not None:
                self._process.kill()
        self._thread.join(timeout=5.0)

    @property
    def idle(self) -> bool:
        """Nothing is at work, nor wanted and not answered."""
        with self._changed:
            return self._at_work is None and {job.key for job in self._jobs} <= self._answered

    @property
    def pid(self) -> int | None:
        """The process, for tests of its death."""
        return None if self._process is None else self._process.pid

    def _next(self) -> Job | None:
        """The next job, waited for; None when the lane stops."""
        with self._changed:
            while not self._stopped:
                wait: float | None = None
                for job in self._jobs:
                    if job.key in self._answered:
                        continue
                    left = self._since[job.key] + job.rest - time.monotonic()
                    if left <= 0.0:
                        self._at_work, self._cancelled = job, False
                        return job
                    wait = left if wait is None else min(wait, left)
                self._changed.wait(wait)
        return None

    def _work(self) -> None:
        while (job := self._next()) is not None:
            self._report(Busy(self.name, job.title, time.monotonic()))
            event = self._done(job)
            if event is None:
                return
            with self._changed:
                self._at_work = None
                if job.key in self._since:
                    self._answered.add(job.key)
            self._report(event)
            self._report(Busy(self.name, None, time.monotonic()))

    def _done(self, job: Job) -> Done | Lost | None:
        """What becomes of a job; None when the lane stops."""
        for _ in range(job.tries):
            try:
                return Done(job, self._call(job))
            except BohemiaError as error:
                return Lost(job, str(error))
            except (EOFError, OSError):
                if self._stopped:
                    return None
                self._bury()
                if self._cancelled:
                    return Lost(job, "")
        return Lost(
            job,
            tr("work.stopped", what=job.title or tr("work.this")),
        )

    def _bury(self) -> None:
        """A process that no longer answers may still count as alive for a moment."""
        with self._changed:
            process, self._process = self._process, None
        if process is not None:
            process.kill()

    def _call(self, job: Job) -> Any:
        with self._changed:
            if self._stopped or self._cancelled:
                raise EOFError
            if self._process is None or not self._process.alive:
                self._process = Process(self.name, self._prepare)
            process = self._process
        return process.run(None, job.function, *job.arguments)
