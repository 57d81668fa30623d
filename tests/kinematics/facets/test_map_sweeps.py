"""Maps over a grid: every point once, coarse first, whatever the executor does."""

from __future__ import annotations

import pickle
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from kinematics.answers.sections import MapCells
from kinematics.designs.files import load_design
from kinematics.errors import BohemiaError, ComputationError, InputError
from kinematics.facets.map_sweeps import ATTEMPTS, MapRequest, coarse_first, map_request, sweep
from kinematics.mechanisms.five_rpur.maps import Maps

DESIGN = load_design("rpur-table1")
FIRST = np.linspace(-1.0, 1.0, 7)
SECOND = np.linspace(-0.5, 0.5, 5)


def formula(poses: Any, quantities: int) -> Any:
    """Stands for a mechanism's quantities: known at every pose."""
    phi, theta = np.asarray(poses)[:, 3], np.asarray(poses)[:, 4]
    return np.stack([(k + 1) * np.sin(phi) + theta**2 for k in range(quantities)], axis=1)


@pytest.fixture
def known(monkeypatch: pytest.MonkeyPatch) -> None:
    """The mechanism answers by the formula; its errors are the tolerance."""

    def cells(self: Any, poses: Any, modes: Any, quantities: Any, *, relative: float) -> MapCells:
        values = formula(poses, len(quantities))
        return MapCells(values, np.full_like(values, relative))

    monkeypatch.setattr(Maps, "cells", cells)


@pytest.fixture
def threads() -> Iterator[Executor]:
    with ThreadPoolExecutor(3) as pool:
        yield pool


def asked(**options: Any) -> MapRequest:
    return map_request(DESIGN, FIRST, SECOND, quantities=("volume", "pieces"), **options)


class Direct(Executor):
    """Runs every task at once, and counts; ``break_at`` breaks it as a dead worker would."""

    def __init__(self, break_at: Callable[[int], BaseException | None] = lambda n: None) -> None:
        self.tasks = 0
        self._break_at = break_at

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.tasks += 1
        future: Future[Any] = Future()
        error = self._break_at(self.tasks)
        if error is not None:
            future.set_exception(error)
        else:
            try:
                future.set_result(fn(*args, **kwargs))
            except Exception as failure:  # noqa: BLE001 (an executor's duty)
                future.set_exception(failure)
        return future


# --- the order -----------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (2, 2), (37, 37), (5, 64), (33, 17)])
def test_every_point_comes_once_and_coarse_ones_first(shape: tuple[int, int]) -> None:
    levels = coarse_first(shape)
    order = np.concatenate(levels)
    assert sorted(order.tolist()) == list(range(shape[0] * shape[1]))
    assert order[0] == 0
    done = np.zeros(shape, dtype=bool)
    for left, level in zip(range(len(levels) - 1, -1, -1), levels, strict=True):
        done.ravel()[level] = True
        rows, columns = (np.flatnonzero(done.any(axis=1 - axis)) for axis in (0, 1))
        step = max(np.diff(rows).max(initial=0), np.diff(columns).max(initial=0))
        assert step <= 2**left  # a regular grid, twice as fine with every level
        assert done[np.ix_(rows, columns)].all()


def test_a_big_map_is_first_a_small_one() -> None:
    levels = coarse_first((361, 361))
    assert sum(map(len, levels[:-3])) < 361 * 361 / 50


# --- the values ----------------------------------------------------------------------------


@pytest.mark.usefixtures("known")
@pytest.mark.parametrize(("chunk", "in_flight"), [(1, 1), (8, 16), (3, 2), (1000, 1)])
def test_values_are_the_mechanisms_own(threads: Executor, chunk: int, in_flight: int) -> None:
    request = asked(relative=1e-3)
    seen: list[int] = []

    def on_cells(indices: Any, cells: MapCells) -> None:
        assert threading.current_thread() is threading.main_thread()
        assert len(indices) <= chunk
        np.testing.assert_array_equal(cells.values, formula(request.poses(indices), 2))
        seen.extend(indices.tolist())

    found = sweep(request, threads, chunk=chunk, in_flight=in_flight, on_cells=on_cells)
    assert found.complete
    assert sorted(seen) == list(range(35))
    phi, theta = np.meshgrid(FIRST, SECOND, indexing="ij")
    np.testing.assert_array_equal(found.values[0], np.sin(phi) + theta**2)
    np.testing.assert_array_equal(found.values[1], 2 * np.sin(phi) + theta**2)
    assert (found.errors == 1e-3).all()
    for array in (found.values, found.errors, found.done):
        assert not array.flags.writeable


@pytest.mark.usefixtures("known")
def test_no_more_is_in_flight_than_is_asked_for() -> None:
    class Held(Direct):
        """Finishes a task only when the sweep waits."""

        most = 0
        open = 0

        def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
            self.open += 1
            self.most = max(self.most, self.open)
            future: Future[Any] = Future()

            def finish() -> None:
                self.open -= 1
                future.set_result(fn(*args, **kwargs))

            threading.Timer(0.002, finish).start()
            return future

    executor = Held()
    assert sweep(asked(), executor, chunk=2, in_flight=3).complete
    assert executor.most == 3


@pytest.mark.usefixtures("known")
def test_a_cancelled_map_keeps_what_is_done() -> None:
    done: list[int] = []
    found = sweep(
        asked(),
        Direct(),
        chunk=4,
        in_flight=1,
        on_cells=lambda indices, _: done.extend(indices.tolist()),
        cancelled=lambda: len(done) >= 8,
    )
    assert not found.complete
    assert np.flatnonzero(found.done).tolist() == sorted(done)
    assert 8 <= len(done) < 35
    assert np.isnan(found.values[:, ~found.done]).all()
    assert np.isfinite(found.values[:, found.done]).all()


def test_a_request_travels() -> None:
    request = asked(modes=["+++++", "-----"])
    again = pickle.loads(pickle.dumps(request))
    assert again == request
    assert hash(again) == hash(request)
    assert [axis.key for axis in request.coordinates] == ["phi", "theta"]
    np.testing.assert_array_equal(
        request.poses(np.array([0, 6, 34])),
        [[0, 0, 0, FIRST[0], SECOND[0]], [0, 0, 0, FIRST[1], SECOND[1]], [0, 0, 0, 1.0, 0.5]],
    )


# --- what goes wrong -----------------------------------------------------------------------


class KilledWorker(Exception):
    """As Dask's, which need not be installed."""


KilledWorker.__module__ = "distributed.scheduler"


@pytest.mark.usefixtures("known")
@pytest.mark.parametrize("error", [BrokenExecutor("gone"), KilledWorker("gone"), EOFError()])
def test_a_lost_worker_costs_only_its_task(error: Exception) -> None:
    executor = Direct(lambda n: error if n in {1, 4, 5} else None)
    found = sweep(asked(), executor, chunk=5)
    assert found.complete
    assert executor.tasks == 3 + sum(-(-len(level) // 5) for level in coarse_first((7, 5)))
    assert (found.values[0] == np.sin(FIRST)[:, None] + SECOND**2).all()


@pytest.mark.usefixtures("known")
def test_workers_that_are_lost_again_and_again_end_the_map() -> None:
    executor = Direct(lambda n: KilledWorker("twice"))
    with pytest.raises(ComputationError, match=f"lost {ATTEMPTS} times .KilledWorker: twice"):
        sweep(asked(), executor, in_flight=1)
    assert executor.tasks == ATTEMPTS


@pytest.mark.usefixtures("known")
def test_an_executor_that_takes_no_more_ends_the_map() -> None:
    pool = ThreadPoolExecutor(1)
    pool.shutdown()
    with pytest.raises(ComputationError, match="cannot go on"):
        sweep(asked(), pool)


@pytest.mark.parametrize(
    ("error", "kind", "said"),
    [
        (InputError("limb 3 is odd"), BohemiaError, "^limb 3 is odd$"),
        (ZeroDivisionError("by 0"), ComputationError, "ZeroDivisionError: by 0"),
    ],
)
def test_a_points_own_failure_is_not_tried_again(
    monkeypatch: pytest.MonkeyPatch, error: Exception, kind: type[Exception], said: str
) -> None:
    def cells(*_: Any, **__: Any) -> MapCells:
        raise error

    monkeypatch.setattr(Maps, "cells", cells)
    executor = Direct()
    with pytest.raises(kind, match=said):
        sweep(asked(), executor, in_flight=1)
    assert executor.tasks == 1


def test_what_is_asked_is_checked() -> None:
    def refused(said: str, *arguments: Any, **options: Any) -> None:
        with pytest.raises(InputError, match=said):
            map_request(DESIGN, *(arguments or (FIRST, SECOND)), **options)

    refused("values of φ must be a list", [], SECOND)
    refused("values of θ must be a list", FIRST, 0.5)
    refused("values of θ must be finite", FIRST, [np.nan])
    refused("is too large", np.zeros(10_000), np.zeros(10_000))
    refused("no quantity 'mass'; it is one of volume, pieces", quantities=["mass"])
    refused("each wanted quantity once", quantities=["volume", "volume"])
    refused("each wanted quantity once", quantities=[])
    refused("working modes", modes=["+++"])
    refused("working modes", modes=[])
    refused("between 0 and 1", relative=0.0)
    refused("between 0 and 1", relative=float("nan"))
    refused("pose must be 5 finite numbers", pose=[1.0, 2.0])
    for bad in ({"chunk": 0}, {"in_flight": 0}):
        with pytest.raises(InputError, match="at least one"):
            sweep(asked(), Direct(), **bad)
