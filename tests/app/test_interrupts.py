"""Ctrl-C at any moment of a command: quiet, and nobody is left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.conftest import ROOT, command_environment

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals to a group of processes")

# Says when the interpreter itself has started, which nothing of ours can make quiet.
BEGIN = "import os, runpy; os.write(1, b'!'); runpy.run_module('app', run_name='__main__')"
MAP = ("map", "rpur-table1", "--phi", "-40:40:40", "--theta", "-40:40:40", "--jobs", "2")


def _interrupted(
    after: float, *words: str, how: signal.Signals = signal.SIGINT
) -> tuple[int, str, int]:
    process = subprocess.Popen(
        [sys.executable, "-c", BEGIN, *words],
        cwd=ROOT,
        env=command_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    assert process.stdout is not None
    assert process.stdout.read(1) == b"!"
    time.sleep(after)
    if process.poll() is None:
        os.killpg(process.pid, how)
    try:
        _, said = process.communicate(timeout=60)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        raise
    return process.returncode, said.decode(), process.pid


def _group_is_gone(group: int) -> bool:
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        try:
            os.killpg(group, 0)
        except (ProcessLookupError, PermissionError):
            return True
        time.sleep(0.1)
    return False


@pytest.mark.parametrize(
    "after",
    [0.1, 0.8, *(pytest.param(t, marks=pytest.mark.slow) for t in (0.05, 0.2, 0.4, 1.2, 1.6, 2.4))],
)
def test_a_map_whose_workers_start_is_stopped_in_silence(after: float) -> None:
    code, said, group = _interrupted(after, *MAP)
    assert code in (130, -signal.SIGINT)
    assert "Traceback" not in said
    assert said.count("\n") <= 1  # how far it came
    assert _group_is_gone(group)


@pytest.mark.parametrize("after", [0.05, 0.15, 0.3])
@pytest.mark.parametrize(
    "words", ["designs", "ik rpur-table1 --pose 0,100,450,0,0", "volume rps-3"]
)
def test_a_short_command_is_stopped_in_silence_or_done(after: float, words: str) -> None:
    code, said, _ = _interrupted(after, *words.split())
    assert code in (0, 2, 130, -signal.SIGINT)
    assert "Traceback" not in said


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("after", [0.05, 0.3, 1.0, 2.0])
def test_a_server_that_starts_is_stopped_in_silence(
    after: float, how: signal.Signals, tmp_path: Path
) -> None:
    words = ("serve", "--no-browser", "--port", "0", "--session", str(tmp_path / "r.json"))
    code, said, group = _interrupted(after, *words, how=how)
    assert code in (0, 130, -how)
    assert said == ""
    assert _group_is_gone(group)
    assert not [p for p in tmp_path.iterdir() if p.name != "r.json"]
