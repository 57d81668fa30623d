"""What an instrumented copy of the program runs with, see `mutant_reach.py`; a plugin of pytest."""

from __future__ import annotations

import builtins
import functools
import json
import os
import resource
from collections.abc import Iterator
from typing import Any

import pytest

HITS, TESTS = os.environ["MUTANT_HITS"], os.environ["MUTANT_TESTS"]

_seen: set[int] = set()
_caches: list[Any] = []
_write, _open, _close, _get = os.write, os.open, os.close, os.environ.get
_lru_cache = functools.lru_cache


def _hit(site: int) -> None:
    """A place runs; nothing that a test replaces is used to tell it."""
    if site not in _seen:
        _seen.add(site)
        out = _open(HITS, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
        _write(out, f"{site}\t{_get('PYTEST_CURRENT_TEST', '')}\n".encode())
        _close(out)


def _cached(*arguments: Any, **options: Any) -> Any:
    made = _lru_cache(*arguments, **options)
    if not isinstance(made, functools._lru_cache_wrapper):
        return lambda function: _noted(made(function))
    return _noted(made)


def _noted(made: Any) -> Any:
    if made.__module__.split(".")[0] in ("kinematics", "app", "tests"):
        _caches.append(made)
    return made


builtins.__hit__ = _hit  # type: ignore[attr-defined]
functools.lru_cache = _cached
functools.cache = lambda function: _cached(maxsize=None)(function)


# --- pytest --------------------------------------------------------------------------------

_before = [""]


def _say(test: str, seconds: float | None) -> None:
    with open(TESTS, "a") as out:  # noqa: PTH123 (tests may replace what Path does)
        out.write(json.dumps([test, seconds]) + "\n")


def _spent() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[Any]:
    """How long a test takes, of processors."""
    before = _spent()
    try:
        return (yield)
    finally:
        _say(item.nodeid, _spent() - before)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """A test that fails as it is cannot tell anything."""
    if report.failed:
        _say(report.nodeid, None)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """What other tests left in caches would hide what this one runs through."""
    _seen.clear()
    test = item.nodeid.split("[")[0]
    if test != _before[0]:
        _before[0] = test
        for each in _caches:
            each.cache_clear()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_call() -> None:
    """What the test itself runs through is told apart from what its fixtures do."""
    _seen.clear()
