"""What the whole suite shares: the checkout, the command as a process, the browser."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from tests import schemas

ROOT = Path(__file__).resolve().parent.parent

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
APPLE_BROWSERS = (
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
)

# No deadline: a busy machine is not a failure. In CI the same examples every time.
settings.register_profile("local", deadline=None)
settings.register_profile(
    "ci", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("ci" if os.environ.get("CI") else "local")


# --- tests on several cores: pytest -n auto --dist loadfile, which is what make test does ------


def pytest_sessionstart(session: pytest.Session) -> None:
    """What is compiled once on a machine is compiled before the workers begin, not in each."""
    if getattr(session.config.option, "numprocesses", None):
        subprocess.run([sys.executable, "-c", PREPARE], cwd=ROOT, check=True)


PREPARE = """
from kinematics.mechanism import mechanism_class, mechanism_kinds
for kind in mechanism_kinds():
    mechanism_class(kind).prepare()
"""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """A file is the work of one worker, for what its tests share; so are all of the browser's."""
    from xdist.scheduler import LoadFileScheduling

    class Rooms(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return BROWSER if nodeid.startswith(BROWSER) else super()._split_scope(nodeid)

    return Rooms(config, log) if config.getoption("dist") == "loadfile" else None


BROWSER = "tests/browser/"
# Arrangements between the first and the last; in the app a 3-SPR is what a 3-RPS is.
ALIKE = {
    f"{prefix}{name}"
    for prefix in ("", "rpur-")
    for name in ("a1a2", "a1a3", "a2a2", "a2a3", "mpa2")
}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The browser's tests first: they are the longest piece of work.

    A test over many designs is left to `make check-all` for those that are like others.
    """
    for item in items:
        named = set(map(str, getattr(getattr(item, "callspec", None), "params", {}).values()))
        if named & ALIKE or (item.nodeid.startswith("tests/app/") and "spr-3" in named):
            item.add_marker(pytest.mark.slow)
    items.sort(key=lambda item: not item.nodeid.startswith(BROWSER))


def rarely(*values: Any) -> Any:
    """Values of parameters that are left to `make check-all`."""
    return pytest.param(*values, marks=pytest.mark.slow)


@pytest.fixture(scope="session")
def root() -> Path:
    """The checkout."""
    return ROOT


@dataclass(frozen=True)
class Finished:
    """How a command ended."""

    code: int
    stdout: str
    stderr: str

    @property
    def json(self) -> dict[str, Any]:
        """The one JSON object on stdout; strict, so NaN and Infinity are refused, and of the form
        that its schema says.
        """
        answer = json.loads(self.stdout, parse_constant=_refuse_constant)
        assert isinstance(answer, dict)
        schemas.check(answer)
        return answer


def _refuse_constant(name: str) -> None:
    raise AssertionError(f"{name} is not JSON")


def command_environment() -> dict[str, str]:
    """The environment in which this checkout's `bohemia` runs, whatever is installed."""
    paths = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "PYTHONWARNINGS": "error"}


@pytest.fixture
def bohemia(tmp_path: Path) -> Callable[..., Finished]:
    """Run `bohemia` with these arguments as a process in an empty folder."""

    def run(*arguments: str | os.PathLike[str]) -> Finished:
        done = subprocess.run(
            [sys.executable, "-m", "app", *map(os.fspath, arguments)],
            cwd=tmp_path,
            env=command_environment(),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            timeout=120,
            check=False,
        )
        return Finished(done.returncode, done.stdout, done.stderr)

    return run


@pytest.fixture(scope="session")
def chromium() -> str:
    """The browser for the page's tests; skipped without one unless BOHEMIA_REQUIRE_BROWSER=1."""
    named = os.environ.get("BOHEMIA_CHROMIUM")
    for candidate in [named] if named else [*BROWSERS, *APPLE_BROWSERS]:
        if found := shutil.which(candidate):
            return found
    reason = (
        f"BOHEMIA_CHROMIUM={named} cannot be run"
        if named
        else f"no browser found ({', '.join(BROWSERS)}); name one with BOHEMIA_CHROMIUM"
    )
    if os.environ.get("BOHEMIA_REQUIRE_BROWSER") == "1":
        pytest.fail(f"BOHEMIA_REQUIRE_BROWSER=1, and {reason}")
    pytest.skip(reason)


def refused(done: Finished, code: int = 2) -> str:
    """The one sentence of a refusal, and nothing else anywhere."""
    assert done.code == code, (done.stdout, done.stderr)
    assert done.stdout == ""
    assert done.stderr.startswith("bohemia: ")
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr
    return done.stderr.removeprefix("bohemia: ").strip()


def answered(done: Finished) -> dict[str, Any]:
    """The JSON of a command that went well and had nothing to add."""
    assert done.code == 0, done.stderr
    assert done.stderr == ""
    return done.json
