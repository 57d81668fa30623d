"""A lane: the newest jobs win, nothing is done twice, and the death of its process is survived."""

from __future__ import annotations

import operator
import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.jobs.lane import Done, Job, Lost
from app.jobs.process import Process, load_coarse_solids, one_core
from kinematics.solids.csg import first_use
from tests.app import lanes
from tests.app.lanes import Desk


@pytest.fixture(scope="module")
def shared() -> Iterator[Desk]:
    with lanes.desk("sections") as made:
        yield made


@pytest.fixture
def desk(shared: Desk) -> Desk:
    shared.clear()
    return shared


def add(n: int, rest: float = 0.0) -> Job:
    return Job(("add", n), "a sum", operator.add, (n, 1), rest)


def test_jobs_are_done_in_order_and_only_once(desk: Desk) -> None:
    jobs = (add(1), add(2))
    desk.lane.want(jobs)
    assert desk.results(("add", 2)) == [2, 3]
    desk.lane.want((*jobs, add(3)))
    assert desk.results(("add", 3)) == [4]


def test_what_was_wanted_last_is_what_comes(desk: Desk) -> None:
    desk.lane.want((Job("slow", "a rest", time.sleep, (0.3,)),))
    desk.begun("a rest")
    for n in range(50):
        desk.lane.want((add(n),))
    assert desk.results(("add", 49)) == [None, 50]  # the job at work ends, the rest is void


def test_a_job_that_must_rest_gives_way_to_others(desk: Desk) -> None:
    desk.lane.want((add(1, rest=0.4), add(2)))
    assert desk.results(("add", 1)) == [3, 2]


def test_a_job_taken_back_before_its_time_is_not_begun(desk: Desk) -> None:
    desk.lane.want((add(1, rest=0.15),))
    desk.lane.want(())
    time.sleep(0.4)
    assert desk.events.empty()


def test_a_job_given_up_and_wanted_again_is_done_again(desk: Desk) -> None:
    desk.lane.want((add(7),))
    desk.until(Done)
    desk.lane.want(())
    desk.lane.want((add(7),))
    assert desk.until(Done).result == 8


def test_failures_are_told_and_the_next_job_works(desk: Desk) -> None:
    desk.lane.want((Job("bad", "a division", divmod, (1, 0)), add(4)))
    assert "ZeroDivisionError" in desk.until(Lost).text
    assert desk.until(Done).result == 5


def test_a_cancelled_job_says_nothing_and_the_next_one_works(desk: Desk) -> None:
    desk.lane.want((Job("long", "a long rest", time.sleep, (60.0,)),))
    desk.begun("a long rest")
    desk.lane.cancel()
    assert desk.until(Lost).text == ""
    desk.lane.want((add(5),))
    assert desk.until(Done).result == 6


def test_the_death_of_the_process_is_told_and_survived(desk: Desk) -> None:
    desk.lane.want((add(1),))
    desk.until(Done)
    pid = desk.lane.pid
    assert pid is not None
    desk.lane.want((Job("long", "a long rest", time.sleep, (60.0,)),))
    desk.begun("a long rest")
    time.sleep(0.1)
    os.kill(pid, signal.SIGKILL)
    assert "a long rest stopped" in desk.until(Lost).text
    desk.lane.want((add(9),))
    assert desk.until(Done).result == 10
    assert desk.lane.pid != pid


def test_a_process_that_died_at_rest_is_started_again(desk: Desk) -> None:
    desk.lane.want((add(1),))
    desk.until(Done)
    pid = desk.lane.pid
    assert pid is not None
    os.kill(pid, signal.SIGKILL)
    time.sleep(0.2)
    desk.lane.want((add(2),))
    assert desk.until(Done).result == 3
    assert desk.lane.pid != pid


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="the system has no such thing")
def test_one_core_is_given_back() -> None:
    before = os.sched_getaffinity(0)
    with one_core():
        assert len(os.sched_getaffinity(0)) == 1
    assert os.sched_getaffinity(0) == before


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="threads are counted there")
def test_coarse_solids_are_built_by_one_thread() -> None:
    process = Process("test", load_coarse_solids)
    try:
        assert process.run(30.0, _threads) == process.run(30.0, _threads_after_a_boolean)
        assert process.run(30.0, os.sched_getaffinity, 0) == os.sched_getaffinity(0)
    finally:
        process.kill()


def _threads() -> int:
    return len([*Path("/proc/self/task").iterdir()])


def _threads_after_a_boolean() -> int:
    first_use()
    return _threads()
