"""Who computes a map: all cores of this machine, or a Dask cluster."""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

from app.jobs.process import Process, Spawning, give_way
from kinematics.errors import ComputationError, InputError

YIELD = 19  # how much the processes give way to whatever a person is waiting for (nice)
REPLY = 5.0  # s for a scheduler to answer, and as much again for a worker
LOOK = 2.0  # s between two looks at a cluster
PATIENCE = 30.0  # s to wait for the workers of a cluster that has lost them all
LOST_WORKERS = 3  # so often Dask begins a task anew whose worker is lost


@dataclass(frozen=True, eq=False, slots=True)
class Workers:
    """An executor, and what it does not tell itself.

    Attributes:
        count: how many tasks it runs at a time.
        title: what a person calls it.
        check: raises a ComputationError if nothing will come any more. Call it while waiting.
    """

    executor: Executor
    count: int
    title: str
    check: Callable[[], None]


def cores() -> int:
    """The cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def local_workers(
    jobs: int | None = None, *, meanwhile: Callable[[], None] | None = None
) -> Iterator[Workers]:
    """Processes on this machine, one for each core unless ``jobs`` says how many.

    They are started as they are needed and end with the block, or with this process; so does one
    more that calls ``meanwhile``, what makes the work of the others faster.
    """
    count = cores() if jobs is None else jobs
    pool = ProcessPoolExecutor(count, mp_context=Spawning(), initializer=_prepare)
    other = Process("prepare", partial(_first, meanwhile)) if meanwhile is not None else None
    try:
        title = f"{count} process{'' if count == 1 else 'es'}"
        yield Workers(pool, count, title, lambda: None)  # a pool says by itself that it is broken
    finally:
        pool.shutdown(cancel_futures=True)
        if other is not None:
            other.kill()


def _first(function: Callable[[], None]) -> None:
    _prepare()
    function()


def _prepare() -> None:
    """What a process does first: give way, leave Ctrl-C to its parent, and end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    give_way(YIELD)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def dask_workers(address: str) -> Iterator[Workers]:
    """The workers of the Dask cluster whose scheduler is at ``address``, "tcp://host:8786".

    Raises:
        InputError: Dask is not installed here, or this is not an address.
        ComputationError: nobody answers there, it has no workers, or they lack Bohemia.
    """
    if not address.startswith(("tcp://", "tls://")):
        raise InputError(f"{address!r} is not a scheduler's address, as tcp://192.168.1.7:8786")
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            "a scheduler needs Dask, which is not installed; pip install 'bohemia[cluster]'"
        ) from None
    _quiet()
    try:
        asyncio.run(_knock(address))
    except TimeoutError:
        raise ComputationError(
            f"no Dask scheduler answered at {address} within {REPLY:.0f} s"
        ) from None
    except (OSError, ValueError) as error:
        why = " ".join(str(error).split())
        raise ComputationError(f"no Dask scheduler answered at {address}: {why}") from None
    except Exception:  # noqa: BLE001 (whatever the handshake makes of another kind of server)
        raise ComputationError(f"what answers at {address} is no Dask scheduler") from None
    client = Client(address, timeout=REPLY, set_as_default=False)
    with client:
        try:
            client.wait_for_workers(1, timeout=REPLY)
        except TimeoutError:
            raise ComputationError(f"the Dask scheduler at {address} has no workers") from None
        try:
            client.submit(_has_bohemia, pure=False).result()
        except ImportError as error:
            raise ComputationError(
                f"the Dask workers at {address} cannot run Bohemia; install the same version "
                f"there ({error})"
            ) from None
        count = sum(client.nthreads().values())
        with client.get_executor(pure=False, retries=LOST_WORKERS) as executor:
            check = _Watch(client, address).check
            yield Workers(executor, count, f"{count} threads of the cluster at {address}", check)


class _Watch:
    """Sees what Dask's futures never tell: that the scheduler, or every worker, is gone."""

    def __init__(self, client: Any, address: str) -> None:
        self._client = client
        self._address = address
        self._looked = self._seen = time.monotonic()

    def check(self) -> None:
        """Raise a ComputationError if nothing will come any more."""
        now = time.monotonic()
        if self._client.status in ("closed", "closing"):
            raise ComputationError(f"the Dask scheduler at {self._address} is gone")
        if now - self._looked < LOOK:
            return
        self._looked = now
        try:
            workers = self._client.nthreads()
        except (OSError, RuntimeError):  # cut off; the client tries for some seconds to return
            return
        if workers:
            self._seen = now
        elif now - self._seen > PATIENCE:
            raise ComputationError(
                f"the Dask scheduler at {self._address} has had no workers for {PATIENCE:.0f} s"
            )


def _quiet() -> None:
    """What fails is said once, by us, instead of logged by each part of Dask with a traceback."""
    for name in [*logging.root.manager.loggerDict, "concurrent.futures"]:
        if name.partition(".")[0] in ("distributed", "concurrent"):
            logging.getLogger(name).setLevel(logging.CRITICAL)


async def _knock(address: str) -> None:
    """Shake hands and leave; a client that fails to would linger for ten seconds."""
    from distributed.comm import connect
    from distributed.security import Security

    options = Security().get_connection_args("client")
    comm = await connect(address, timeout=REPLY, **options)
    await comm.close()


def _has_bohemia() -> bool:
    """Called on a worker, which must find this module for it."""
    import kinematics.facets.map_sweeps

    return bool(kinematics.facets.map_sweeps)
