"""Solids in processes of their own: newest wish wins, coarse first, finer when the hand rests.

manifold3d holds the GIL for as long as a boolean takes, so it never runs in the server's process.
There are two lanes, each one spawned process with a thread that waits for it: the coarse lane is
always free for the next preview, whatever the fine lane is busy with. A process that dies is
started again; a request that kills it twice is given up with a message.
"""

from __future__ import annotations

import os
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Literal, TypeVar

from app.features.workspace.compute import SolidWish
from app.jobs.spawning import Spawning
from kinematics.errors import BohemiaError
from kinematics.facets.solids import Resolution, SolidRequest

if TYPE_CHECKING:
    from multiprocessing.context import SpawnProcess

    from kinematics.solids.csg import BuiltSolid

REST_NORMAL = 0.15  # s without a new wish before the normal solid is begun
REST_FINE = 0.7  # s before the fine one
CACHE = 48  # solids kept, over all resolutions

T = TypeVar("T")

LaneName = Literal[
    "coarse",
    "fine",
    "solutions",
    "sections",
    "measures",
    "control",
    "loci",
    "regions",
    "trajectory",
]


@dataclass(frozen=True, eq=False, slots=True)
class Built:
    """A solid that was wished for, ready to be shown."""

    wish: SolidWish
    resolution: Resolution
    solid: BuiltSolid


@dataclass(frozen=True, slots=True)
class Failed:
    """A solid could not be computed; ``text`` is for the user."""

    what: tuple[object, ...]
    resolution: Resolution
    text: str


@dataclass(frozen=True, slots=True)
class Busy:
    """A lane began (a title) or ended (None) its work."""

    lane: LaneName
    title: str | None
    since: float


Event = Built | Failed | Busy


class Worker:
    """Computes what `want` was last told, and reports by ``on_event`` from its own threads."""

    def __init__(self, on_event: Callable[[Event], None]) -> None:
        self.report = on_event
        self._changed = threading.Condition()
        self._wishes: tuple[SolidWish, ...] = ()
        self._wished_at = 0.0
        self._given_up: set[SolidRequest] = set()
        self._cache: OrderedDict[SolidRequest, BuiltSolid] = OrderedDict()
        self.stopped = False
        self._lanes = [
            _Lane("coarse", self, ("preview",)),
            _Lane("fine", self, ("normal", "fine")),
        ]

    def start(self) -> None:
        """Start both processes; the first wish finds them warm."""
        for lane in self._lanes:
            lane.start()

    def want(self, wishes: Sequence[SolidWish]) -> None:
        """These are the solids to show from now on; earlier wishes are void.

        What is in the cache comes back by `on_event` before this returns.
        """
        ready: list[Built] = []
        with self._changed:
            before = {wish.spec.key: wish.what for wish in self._wishes}
            if any(before.get(wish.spec.key) != wish.what for wish in wishes):
                self._wished_at = time.monotonic()
            self._wishes = tuple(wishes)
            for wish in wishes:
                if before.get(wish.spec.key) == wish.what:
                    continue
                best = self._best(wish)
                if best is not None:
                    ready.append(Built(wish, best, self._cache[wish.requests[best]]))
            self._changed.notify_all()
        for built in ready:
            self.report(built)

    def cancel(self) -> None:
        """Give up what the fine lane is busy with; the coarser solid stays."""
        self._lanes[1].interrupt()

    @staticmethod
    def apart(function: Callable[..., T], *arguments: object, timeout: float = 120.0) -> T:
        """Call a function in a process made for it alone: for exports, which nobody drags.

        Raises:
            BohemiaError: its own failure, its death, or it took longer than ``timeout`` seconds.
        """
        process = Process("solids", _load_solids)
        try:
            return process.run(timeout, function, *arguments)
        except EOFError:
            raise BohemiaError("the process at work on it stopped; try again") from None
        finally:
            process.kill()

    def stop(self) -> None:
        """End threads and processes."""
        with self._changed:
            self.stopped = True
            self._changed.notify_all()
        for lane in self._lanes:
            lane.interrupt()
        for lane in self._lanes:
            lane.thread.join(timeout=5.0)

    @property
    def pids(self) -> tuple[int, ...]:
        """The processes at work, for tests of their death."""
        return tuple(lane.process.pid for lane in self._lanes if lane.process is not None)

    # --- called by the lanes

    def _best(self, wish: SolidWish) -> Resolution | None:
        found: Resolution | None = None
        for resolution, request in wish.requests.items():
            if request in self._cache:
                found = resolution
        return found

    def _begun(self, wish: SolidWish) -> bool:
        """Something of it is there already, or its preview cannot be had."""
        return self._best(wish) is not None or wish.requests["preview"] in self._given_up

    def _keep(self, request: SolidRequest, solid: BuiltSolid) -> None:
        with self._changed:
            self._cache[request] = solid
            self._cache.move_to_end(request)
            while len(self._cache) > CACHE:
                self._cache.popitem(last=False)
            self._changed.notify_all()  # the finer lane waits for the coarser solid

    def next_job(self, lane: _Lane) -> tuple[SolidWish, Resolution] | None:
        """The next job of a lane; waits for one. None when the worker stops."""
        with self._changed:
            while not self.stopped:
                job, wait = self._pick(lane.resolutions)
                if job is not None:
                    return job
                self._changed.wait(wait)
        return None

    def _pick(
        self, resolutions: tuple[Resolution, ...]
    ) -> tuple[tuple[SolidWish, Resolution] | None, float | None]:
        rested = time.monotonic() - self._wished_at
        wait: float | None = None
        for resolution in resolutions:
            rest = {"preview": 0.0, "normal": REST_NORMAL, "fine": REST_FINE}[resolution]
            for wish in self._wishes:
                request = wish.requests[resolution]
                if request in self._cache or request in self._given_up:
                    continue
                if resolution == "preview":
                    if self._best(wish) is not None:
                        continue  # something better is on display already
                elif not self._begun(wish):
                    continue  # the preview first: two cores are not many
                if rested >= rest:
                    return (wish, resolution), None
                wait = min(rest - rested, wait if wait is not None else rest)
        return None, wait

    def done(self, wish: SolidWish, resolution: Resolution, solid: BuiltSolid) -> None:
        self._keep(wish.requests[resolution], solid)
        with self._changed:
            wanted = [w for w in self._wishes if w.what == wish.what]
        for each in wanted:
            self.report(Built(each, resolution, solid))

    def failed(self, wish: SolidWish, resolution: Resolution, text: str) -> None:
        with self._changed:
            self._given_up.add(wish.requests[resolution])
            self._changed.notify_all()
        self.report(Failed(wish.what, resolution, text))


@dataclass(eq=False)
class _Lane:
    """One process and the thread that feeds it."""

    name: LaneName
    worker: Worker
    resolutions: tuple[Resolution, ...]
    process: Process | None = None
    thread: threading.Thread = field(init=False)
    _interrupted: bool = False

    def start(self) -> None:
        self.process = Process("solids", _load_solids)
        self.thread = threading.Thread(target=self._work, name=f"solids-{self.name}", daemon=True)
        self.thread.start()

    def interrupt(self) -> None:
        """Kill the process at work; its job counts as given up."""
        self._interrupted = True
        if self.process is not None:
            self.process.kill()

    def _work(self) -> None:
        worker = self.worker
        deaths: dict[SolidRequest, int] = {}
        while (job := worker.next_job(self)) is not None:
            wish, resolution = job
            request = wish.requests[resolution]
            if self.process is None or not self.process.alive:
                self.process = Process("solids", _load_solids)
            self._interrupted = False
            title = f"{wish.spec.title}, {resolution}"
            worker.report(Busy(self.name, title, time.monotonic()))
            try:
                solid = self.process.run(None, build, request)
            except BohemiaError as error:
                worker.failed(wish, resolution, str(error))
            except (EOFError, OSError):
                self.process.kill()
                if worker.stopped:
                    return
                deaths[request] = deaths.get(request, 0) + 1
                if self._interrupted:
                    worker.failed(wish, resolution, "")
                elif deaths[request] > 1:
                    worker.failed(
                        wish,
                        resolution,
                        f"The process that computes solids stopped twice on {title}; "
                        f"the last good solid stays.",
                    )
            else:
                worker.done(wish, resolution, solid)
            finally:
                worker.report(Busy(self.name, None, time.monotonic()))


class Process:
    """A spawned process that calls functions, one at a time; ``prepare`` is called first."""

    def __init__(self, name: str, prepare: Callable[[], None]) -> None:
        context = Spawning()
        self._pipe, theirs = context.Pipe()
        self._process: SpawnProcess = context.Process(
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
            raise BohemiaError(f"it was not ready after {timeout:.0f} s and was given up")
        failure, answer = self._pipe.recv()
        if failure:
            raise BohemiaError(failure)
        result: T = answer
        return result

    def kill(self) -> None:
        self._process.kill()
        self._process.join(timeout=5.0)


def build(request: SolidRequest) -> BuiltSolid:
    """Build a solid, in whatever process this is called."""
    from kinematics.facets.solids import build_solid

    return build_solid(request)


def give_way(steps: int) -> None:
    """Let other processes go first, by so many steps of niceness where the system has it."""
    if hasattr(os, "nice"):
        os.nice(steps)


def _load_solids() -> None:
    import kinematics.solids.csg  # noqa: F401  # manifold3d is loaded while nobody waits yet


def _serve(pipe: Connection, prepare: Callable[[], None]) -> None:
    """What a spawned process does until its parent goes away."""
    import signal

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
            answer = (f"it could not be computed ({type(error).__name__}: {error})", None)
        try:
            pipe.send(answer)
        except OSError:
            return
