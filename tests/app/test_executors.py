"""Maps on processes of this machine and on a Dask cluster, one of whose workers is killed."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.jobs import executors
from app.jobs.executors import dask_workers, local_workers
from kinematics.designs.files import load_design
from kinematics.errors import ComputationError, InputError
from kinematics.facets.map_sweeps import Map, MapRequest, map_request, sweep
from kinematics.mechanism import mechanism_class
from tests.conftest import command_environment


@pytest.fixture(scope="module")
def request_() -> MapRequest:
    """Enough points that every worker has several tasks."""
    first, second = np.radians(np.linspace(-40, 40, 6)), np.radians(np.linspace(-30, 60, 5))
    design = load_design("rpur-table1")
    return map_request(design, first, second, quantities=("volume", "pieces"), relative=1e-3)


@pytest.fixture(scope="module")
def alone(request_: MapRequest) -> Map:
    """The map as one thread computes it, when sections have been compiled."""
    mechanism_class(request_.design.mechanism).prepare()
    with ThreadPoolExecutor(1) as pool:
        return sweep(request_, pool)


def same(found: Map, alone: Map) -> None:
    assert found.complete
    np.testing.assert_array_equal(found.values, alone.values)
    np.testing.assert_array_equal(found.errors, alone.errors)


def wait_until(what: Callable[[], Any], seconds: float = 60.0) -> Any:
    """What ``what`` says as soon as it says something."""
    end = time.monotonic() + seconds
    while not (said := what()):
        assert time.monotonic() < end, "it never happened"
        time.sleep(0.02)
    return said


def runs(pid: int) -> bool:
    """A process is there and is no zombie."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    status = Path(f"/proc/{pid}/status")
    return "State:\tZ" not in status.read_text() if status.exists() else True


# --- this machine --------------------------------------------------------------------------


@pytest.mark.slow
def test_processes_give_the_same_map(request_: MapRequest, alone: Map) -> None:
    with local_workers(2) as workers:
        assert workers.count == 2
        same(sweep(request_, workers.executor, chunk=5, in_flight=4), alone)
        workers.check()


def test_there_is_a_process_for_each_core() -> None:
    with local_workers() as workers:
        assert workers.count == executors.cores() >= 1


def test_a_process_that_dies_ends_the_map_with_a_sentence(request_: MapRequest) -> None:
    def kill_one(*_: object) -> None:
        os.kill(workers.executor.submit(os.getpid).result(), signal.SIGKILL)

    with (
        local_workers(1) as workers,
        pytest.raises(ComputationError, match=r"cannot go on.*terminated abruptly"),
    ):
        sweep(request_, workers.executor, on_cells=kill_one, in_flight=1)


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_processes_end_with_the_one_that_started_them() -> None:
    code = (
        "import os, time\n"
        "from app.jobs.executors import local_workers\n"
        "if __name__ == '__main__':\n"
        "    with local_workers(1) as workers:\n"
        "        print(workers.executor.submit(os.getpid).result(), flush=True)\n"
        "        time.sleep(600)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], env=command_environment(), stdout=subprocess.PIPE, text=True
    ) as parent:
        assert parent.stdout is not None
        child = int(parent.stdout.readline())
        assert runs(child)
        parent.kill()
    wait_until(lambda: not runs(child))


# --- a cluster -----------------------------------------------------------------------------


@contextmanager
def dask(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """A part of a cluster as a process of its own."""
    with subprocess.Popen(
        [sys.executable, "-m", "dask", *arguments, "--no-dashboard"],
        env=command_environment(),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as process:
        try:
            yield process
        finally:
            process.kill()


@pytest.mark.slow
def test_a_cluster_gives_the_same_map_though_a_worker_is_killed(
    request_: MapRequest, alone: Map, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    killed: list[int] = []
    seen = 0
    monkeypatch.setattr(executors, "REPLY", 60.0)  # a busy machine is not a failure
    with dask(
        *("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file))
    ) as scheduler:
        address = wait_until(lambda: _address(file))
        with monkeypatch.context() as patch:
            patch.setattr(executors, "REPLY", 1.0)
            with pytest.raises(ComputationError, match="has no workers"):
                dask_workers(address).__enter__()
        options = ("worker", address, "--no-nanny", "--nthreads", "1", "--host", "127.0.0.1")
        with dask(*options) as one, dask(*options) as other, dask_workers(address) as workers:
            wait_until(lambda: len(_nthreads(workers)) == 2)

            def kill_one(indices: Any, cells: Any) -> None:
                nonlocal seen
                seen += len(indices)
                if not killed:
                    one.kill()
                    killed.append(one.wait())
                    assert other.poll() is None

            found = sweep(
                request_,
                workers.executor,
                chunk=4,
                in_flight=6,
                on_cells=kill_one,
                cancelled=lambda: bool(workers.check()),
            )
            same(found, alone)
            assert killed == [-signal.SIGKILL]
            assert seen == found.done.size
            assert len(_nthreads(workers)) == 1

            def lose_all(*_: object) -> None:
                scheduler.kill()
                scheduler.wait()

            with pytest.raises(ComputationError, match=f"scheduler at {address} is gone"):
                sweep(
                    request_,
                    workers.executor,
                    chunk=4,
                    on_cells=lose_all,
                    cancelled=lambda: bool(workers.check()),
                )


def _address(file: Path) -> str:
    """The scheduler's, once the file is there and whole."""
    try:
        return str(json.loads(file.read_text())["address"])
    except (OSError, ValueError, KeyError):
        return ""


def _nthreads(workers: executors.Workers) -> dict[str, int]:
    client: Any = workers.executor._client  # type: ignore[attr-defined]
    return dict(client.nthreads())


def test_without_dask_it_is_said_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"pip install 'bohemia\[cluster\]'"):
        dask_workers("tcp://127.0.0.1:8786").__enter__()


def test_nobody_there_is_said_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(executors, "REPLY", 0.3)
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))  # taken, but nobody listens
        address = f"tcp://127.0.0.1:{bound.getsockname()[1]}"
        with pytest.raises(ComputationError, match=f"no Dask scheduler answered at {address}"):
            dask_workers(address).__enter__()


def test_another_kind_of_server_is_told_from_a_scheduler(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(executors, "REPLY", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer() -> None:
            there, _ = server.accept()
            with there:
                there.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n" * 4)

        threading.Thread(target=answer, daemon=True).start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(ComputationError, match=f"{address} is no Dask scheduler|answered at"):
            dask_workers(address).__enter__()


@pytest.mark.parametrize("address", ["", "127.0.0.1:8786", "http://127.0.0.1:8786"])
def test_what_is_no_address_is_refused(address: str) -> None:
    with pytest.raises(InputError, match="not a scheduler's address"):
        dask_workers(address).__enter__()


def test_an_address_without_a_port_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(executors, "REPLY", 0.3)
    with pytest.raises(ComputationError, match="no Dask scheduler answered at tcp://:"):
        dask_workers("tcp://").__enter__()
