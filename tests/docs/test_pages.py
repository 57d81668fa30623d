"""What the documentation shows works: every command, every line of Python, every file."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import pytest

from tests.examples import DOCS, blocks, play

PAGES = sorted(path for path in DOCS.rglob("*.md"))
SHOWN = {"console", "sh", "pycon", "toml", "text", "bash"}


def _id(page: Path) -> str:
    return str(page.relative_to(DOCS))


@pytest.mark.parametrize("page", PAGES, ids=_id)
def test_what_a_page_shows_works(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    play(page, slow=False)


SLOW = [page for page in PAGES if any(b.slow for b in blocks(page.read_text(encoding="utf-8")))]


@pytest.mark.slow
@pytest.mark.parametrize("page", SLOW, ids=_id)
def test_what_a_page_shows_slowly_works(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert play(page, slow=True)


@pytest.mark.parametrize("page", PAGES, ids=_id)
def test_no_example_escapes(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    kinds = {block.kind for block in blocks(text)}
    assert kinds <= SHOWN, kinds - SHOWN
    opened = re.findall(r"^```(?:\{code-block\} )?([a-z]+)$", text, re.M)
    assert len(opened) == len(blocks(text)), "a block that is not closed"


def test_links_that_lead_nowhere_are_found(tmp_path: Path) -> None:
    spec = importlib.util.spec_from_file_location("links", DOCS / "extensions" / "links.py")
    assert spec is not None
    assert spec.loader is not None
    links = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(links)
    (tmp_path / "one.html").write_text(
        '<h1 id="top"></h1><a href="two.html#here"></a><a href="#top"></a>'
        '<a href="https://example.org"></a><img src="gone.png"><a href="two.html#there"></a>'
    )
    (tmp_path / "two.html").write_text('<p id="here"></p><a href="three.html"></a>')
    assert links.broken(tmp_path) == [
        "one.html: gone.png is not there",
        "one.html: two.html#there has no such place",
        "two.html: three.html is not there",
    ]
