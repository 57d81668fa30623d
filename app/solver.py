"""Solutions in a process of their own: the newest actuators win, and what is found comes in order.

A general design takes from a tenth of a second to more than one, too long for the page's loop. The
process is started when it is first needed and gives way to those that build solids. It keeps
nothing between two jobs, so its death costs only the job at work.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from app.folds import Ahead, look_ahead
from app.worker import Busy, Process, give_way
from kinematics.errors import BohemiaError
from kinematics.mechanism import Design, mechanism
from kinematics.solutions import ForwardSolutions, Posture, Refreshed

REST = 0.15  # s without a new wish before work on it begins
YIELD = 4  # how much the process gives way to others (nice)


@dataclass(frozen=True, eq=False, slots=True)
class Wish:
    """Solutions to find, or folds to look for.

    Attributes:
        before: a set to go on from, None to find all from scratch.
        posture: look for the folds ahead of it; None to find solutions.
    """

    design: Design
    joints: tuple[float, ...]
    mixed: bool = False
    before: ForwardSolutions | None = None
    posture: Posture | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Solved:
    """The solutions of a wish; from scratch all of them count as having been there before."""

    wish: Wish
    refreshed: Refreshed


@dataclass(frozen=True, eq=False, slots=True)
class Foreseen:
    """The folds ahead of a wish's posture."""

    wish: Wish
    ahead: tuple[Ahead, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Unsolved:
    """A wish that was given up; ``text`` is for the user, "" if they cancelled it."""

    wish: Wish
    text: str


class Solver:
    """Works on what `want` was last told, and reports by ``on_event`` from its own thread."""

    def __init__(self, on_event: Callable[[Solved | Foreseen | Unsolved | Busy], None]) -> None:
        self._report = on_event
        self._changed = threading.Condition()
        self._wish: Wish | None = None
        self._wished_at = 0.0
        self._process: Process | None = None
        self._cancelled = False
        self._stopped = False
        self._thread = threading.Thread(target=self._work, name="solutions", daemon=True)

    def start(self) -> None:
        """Start the thread; the process starts with the first wish."""
        self._thread.start()

    def want(self, wish: Wish | None) -> None:
        """This is what to find once the hand rests; an earlier wish that nobody began is void."""
        with self._changed:
            self._wish = wish
            self._wished_at = time.monotonic()
            self._changed.notify_all()

    def cancel(self) -> None:
        """Give up the job at work."""
        with self._changed:
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
    def pid(self) -> int | None:
        """The process, for tests of its death."""
        return None if self._process is None else self._process.pid

    def _next(self) -> Wish | None:
        """Take the wish once the hand rests; None when the solver stops."""
        with self._changed:
            while not self._stopped:
                if self._wish is None:
                    self._changed.wait()
                    continue
                rest = REST - (time.monotonic() - self._wished_at)
                if rest > 0:
                    self._changed.wait(rest)
                    continue
                wish, self._wish = self._wish, None
                return wish
        return None

    def _work(self) -> None:
        while (wish := self._next()) is not None:
            title = "all solutions" if wish.posture is None else "the folds ahead"
            self._report(Busy("solutions", title, time.monotonic()))
            try:
                self._report(self._answer(wish))
            except BohemiaError as error:
                self._report(Unsolved(wish, str(error)))
            except (EOFError, OSError):
                if self._stopped:
                    return
                text = "" if self._cancelled else _DIED
                self._report(Unsolved(wish, text))
            finally:
                self._report(Busy("solutions", None, time.monotonic()))

    def _answer(self, wish: Wish) -> Solved | Foreseen:
        with self._changed:
            if self._stopped:
                raise EOFError
            if self._process is None or not self._process.alive:
                self._process = Process("solutions", partial(give_way, YIELD))
            self._cancelled = False
            process = self._process
        if wish.posture is not None:
            return Foreseen(wish, process.run(None, look_ahead, wish.design, wish.posture))
        return Solved(
            wish, process.run(None, solve, wish.design, wish.joints, wish.mixed, wish.before)
        )


_DIED = "The process that finds the solutions stopped; move an actuator, and it is tried again."


def solve(
    design: Design, joints: tuple[float, ...], mixed: bool, before: ForwardSolutions | None
) -> Refreshed:
    """All solutions at these joints, gone on from ``before`` if there is such a set."""
    kind = mechanism(design.mechanism)
    if before is not None:
        return kind.refresh(design, before, joints)
    (found,) = kind.forward(design, [joints], mixed_modes=mixed)
    return Refreshed(found, (), ())
