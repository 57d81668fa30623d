"""What the tests of commands share: a command in this process."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from app import cli
from tests.conftest import Finished


@pytest.fixture
def here(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Callable[..., Finished]:
    """As `bohemia`, but in this process: for long tables, each kind of which is a process once."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> Finished:
        code = cli.main(arguments)
        return Finished(code, *capsys.readouterr())

    return run
