"""Every link and picture of the pages that were built leads to something that is there.

Those that leave the site are only read: building needs no network.
"""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

if TYPE_CHECKING:
    from sphinx.application import Sphinx

MADE_BY_SPHINX = {"genindex.html", "search.html", "py-modindex.html"}


class _Page(HTMLParser):
    """The links of a page and the places in it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.places: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for key, value in attrs:
            if key == "id" and value:
                self.places.add(value)
            if key in ("href", "src") and value and tag != "use":
                self.links.append(value)


def broken(folder: Path) -> list[str]:
    """What is wrong with the links of all pages in a folder, one sentence each."""
    pages = {
        path.resolve(): _Page(path.read_text("utf-8"))
        for path in sorted(folder.rglob("*.html"))
        if path.name not in MADE_BY_SPHINX
    }
    wrong = []
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            name = f"{path.relative_to(folder.resolve())}: {link}"
            if parts.scheme or parts.netloc:
                if parts.scheme not in ("https", "http", "data", "mailto") or link[:2] == "//":
                    wrong.append(f"{name} is no address")
                continue
            to = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not to.is_file():
                wrong.append(f"{name} is not there")
            elif parts.fragment and to in pages and parts.fragment not in pages[to].places:
                wrong.append(f"{name} has no such place")
            elif not parts.path and not parts.fragment and link not in ("#", ""):
                wrong.append(f"{name} leads nowhere")
    return wrong


def _check(app: Sphinx, exception: Exception | None) -> None:
    if exception is None and app.builder.format == "html":
        wrong = broken(Path(app.outdir))
        if wrong:
            from sphinx.errors import ExtensionError

            raise ExtensionError("links that lead nowhere:\n  " + "\n  ".join(wrong))


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("build-finished", _check)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
