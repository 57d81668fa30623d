"""A spawned process that calls functions, one at a time.

manifold3d holds the GIL for as long as a boolean takes, and much else takes longer than a frame, so
none of it runs in the server's process.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import TypeVar

from app.language import tr
from kinematics.errors import BohemiaError

T = TypeVar("T")

GIVES_WAY = 15
"""Steps of niceness of all that is not the coarse solid, which a hand waits for."""


class _Quiet(SpawnProcess):
    def start(self) -> None:
        """A signal that is blocked here is blocked there as well: a process that is still starting
        would answer Ctrl-C with a traceback."""
        if not hasattr(signal, "pthread_sigmask"):  # Windows
            super().start()
            return
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            super().start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Spawning(SpawnContext):
    """As `multiprocessing.get_context("spawn")`."""

    Process = _Quiet


class Process:
    """A spawned process; ``prepare`` is called in it first."""

    def __init__(self, name: str, prepare: Callable[[], None]) -> None:
        context = Spawning()
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(
            target=_serve, args=(theirs, prepare), daemon=True, name=f"bohemia-{name}"
        )
        self._process.start()
        theirs.close()

    @property
    def alive(self) -> bool:
        return self._process.is_alive()

    @property
    def pid(self) -> int:
        return self._process.pid or 0

    def run(self, timeout: float | None, function: Callable[..., T], *arguments: object) -> T:
        """What ``function`` returns there.

        Raises:
            BohemiaError: its own failure, or it took too long.
            EOFError, OSError: the process died.
        """
        self._pipe.send((function, arguments))
        if not self._pipe.poll(timeout):
            raise BohemiaError(tr("work.too_slow", seconds=timeout))
        failure, answer = self._pipe.recv()
        if failure:
            raise BohemiaError(failure)
        result: T = answer
        return result

    def kill(self) -> None:
        self._process.kill()
        self._process.join(timeout=5.0)


def apart(function: Callable[..., T], *arguments: object, timeout: float = 120.0) -> T:
    """Call a function in a process made for it alone: for files, which nobody drags.

    Raises:
        BohemiaError: its own failure, its death, or it took longer than ``timeout`` seconds.
    """
    process = Process("apart", load_solids)
    try:
        return process.run(timeout, function, *arguments)
    except EOFError:
        raise BohemiaError(tr("work.ended")) from None
    finally:
        process.kill()


def give_way(steps: int) -> None:
    """Let other processes go first, by so many steps of niceness where the system has it."""
    if hasattr(os, "nice"):
        os.nice(steps)


def load_solids() -> None:
    """Load manifold3d while nobody waits yet."""
    import kinematics.solids.csg  # noqa: F401


def load_coarse_solids() -> None:
    """The same where they are small: one thread, as several would wait for each other longer than
    they gain, and take the page's core away."""
    from kinematics.solids.csg import first_use

    with one_core():
        first_use()


@contextmanager
def one_core() -> Iterator[None]:
    """This process on one core, where the system has it: how many threads a library starts is
    often settled by the cores that it finds at its first use.
    """
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def load_finer_solids() -> None:
    """The same where coarser ones go first."""
    give_way(GIVES_WAY // 2)
    load_solids()


def _serve(pipe: Connection, prepare: Callable[[], None]) -> None:
    """What a spawned process does until its parent goes away."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server; it ends us
    prepare()
    while True:
        try:
            function, arguments = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            answer = ("", function(*arguments))
        except BohemiaError as error:
            answer = (str(error), None)
        except Exception as error:  # noqa: BLE001 (the server must hear of it, whatever it was)
            answer = (tr("work.failed", what=type(error).__name__, why=error), None)
        try:
            pipe.send(answer)
        except OSError:
            return
