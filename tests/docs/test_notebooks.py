"""The notebooks run from top to bottom, and stand in the repository as nobody has run them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.conftest import command_environment
from tests.examples import DOCS

NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))


def test_there_are_eight_and_each_is_described() -> None:
    assert len(NOTEBOOKS) == 8
    page = (DOCS / "notebooks.md").read_text(encoding="utf-8")
    assert all(f"<notebooks/{path.name}>" in page for path in NOTEBOOKS)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_nothing_that_was_printed_is_kept(path: Path) -> None:
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    assert not [cell for cell in cells if cell.get("outputs") or cell.get("execution_count")]


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.filterwarnings("default")  # of the programs that run notebooks
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import nbformat
    from nbclient import NotebookClient

    monkeypatch.setenv("PYTHONPATH", command_environment()["PYTHONPATH"])
    book = nbformat.read(path, 4)
    place = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(book, timeout=500, kernel_name="python3", resources=place).execute()
    printed = [o for cell in book.cells for o in cell.get("outputs", ())]
    assert printed
    assert not [o for o in printed if o.output_type == "error"]
    if path.stem.startswith("1-"):
        assert any("<iframe" in o.get("data", {}).get("text/html", "") for o in printed)
