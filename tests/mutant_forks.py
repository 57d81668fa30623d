"""Tries mutants in forks of one process that has collected the tests; a plugin of pytest.

A fork gets the code of the changed functions and runs tests until one fails, which must not fail in
a fork without the mutant. So nothing is loaded twice. What is changed where a module is loaded, or
compiled, cannot be tried so.
"""

from __future__ import annotations

import functools
import gc
import importlib
import json
import os
import resource
import sys
import time
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

import pytest
from hypothesis import Phase, settings

ROOT = Path.cwd()
MEMORY = 8 << 30
_CASES = 6  # of each test of a file, before those of the next file


class _Seen:
    failed: tuple[str, str] | None = None
    first = 0.0


def pytest_configure() -> None:
    """A failure is enough; the least example of it is not sought."""
    phases = (Phase.explicit, Phase.generate)
    ci = settings.get_profile("ci")
    settings.register_profile("mutants", parent=ci, phases=phases, deadline=None, database=None)
    settings.load_profile("mutants")


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """The first failure ends a fork's work."""
    if report.failed and _Seen.failed is None:
        crash = getattr(report.longrepr, "reprcrash", None)
        _Seen.failed = report.nodeid, str(crash.message if crash else report.longrepr)[:200]


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> bool:
    """All mutants, each on its tests."""
    asked = json.loads(Path(os.environ["MUTANTS_ASKED"]).read_text())
    out = Path(os.environ["MUTANTS_FOUND"])
    sound: dict[str, bool] = {}
    for mutant in asked:
        ranked = [
            (_turn(item) // _CASES, n, _turn(item), k)
            for k, item in enumerate(session.items)
            for n, test in enumerate(mutant["tests"])
            if item.nodeid.startswith(test)
        ]
        items = [session.items[each[-1]] for each in sorted(ranked)]
        began = time.time()
        said = _fork(items, mutant, mutant["seconds"])
        if said["failed"]:
            test = said["failed"][0]
            if test not in sound:
                alone = [i for i in items if i.nodeid == test]
                sound[test] = _fork(alone, None, 60.0)["end"] == "passed"
            if not sound[test]:
                said = {"failed": None, "end": f"{test} fails as it is"}
        with out.open("a") as file:
            told = {"number": mutant.get("number"), "key": mutant["key"], **said}
            file.write(json.dumps(told) + "\n")
        print(f"{mutant['key']} {said} {time.time() - began:.0f} s", file=sys.stderr, flush=True)
    return True


def _turn(item: pytest.Item) -> int:
    """Which case of its test it is, from 0."""
    name = item.nodeid.split("[")[0]
    count: dict[str, int] = item.session.__dict__.setdefault("_mutant_turns", {})
    turns: dict[str, int] = item.session.__dict__.setdefault("_mutant_turn", {})
    if item.nodeid not in turns:
        turns[item.nodeid] = count.get(name, 0)
        count[name] = turns[item.nodeid] + 1
    return turns[item.nodeid]


def _fork(items: list[pytest.Item], mutant: Any, seconds: float) -> dict[str, Any]:
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(read)
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 2))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        try:
            said = _tried(items, mutant)
        except BaseException as error:  # noqa: BLE001
            said = {"failed": None, "end": f"{type(error).__name__}: {error}"}
        os.write(write, json.dumps(said).encode()[:60_000])
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        told = pipe.read()
    _, status = os.waitpid(child, 0)
    if told:
        answer: dict[str, Any] = json.loads(told)
        return answer
    return {"failed": None, "end": f"signal {os.WTERMSIG(status)}"}


def _tried(items: list[pytest.Item], mutant: Any) -> dict[str, Any]:
    if mutant is not None and not _change(mutant):
        return {"failed": None, "end": "not in a function"}
    for each in gc.get_objects():
        if isinstance(each, functools._lru_cache_wrapper):
            each.cache_clear()
    for item, after in pairwise([*items, None]):
        assert item is not None
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=after)
        if _Seen.failed is not None:
            return {"failed": _Seen.failed, "end": "failed"}
    return {"failed": None, "end": "passed"}


def _change(mutant: Any) -> bool:
    """Give every function of the module that is now another one its code."""
    place = ROOT / mutant["file"]
    importlib.import_module(mutant["file"].removesuffix(".py").replace("/", "."))
    text = place.read_bytes()
    new = text[: mutant["start"]] + mutant["text"].encode() + text[mutant["end"] :]
    codes = dict(_codes(compile(new, str(place), "exec")))
    changed = False
    for each in gc.get_objects():
        if isinstance(each, FunctionType) and each.__code__.co_filename == str(place):
            code = codes.get((each.__code__.co_qualname, each.__code__.co_firstlineno))
            if code is not None and code != each.__code__:
                each.__code__ = code
                changed = True
    return changed


def _codes(code: CodeType) -> Iterable[tuple[tuple[str, int], CodeType]]:
    for each in code.co_consts:
        if isinstance(each, CodeType):
            yield (each.co_qualname, each.co_firstlineno), each
            yield from _codes(each)
