"""What is served into the browser beside viser's own page: its look, and what viser cannot do."""

from __future__ import annotations

from html import escape
from importlib.resources import files

_HERE = files(__name__)
_NOTHING = "data:image/gif;base64,R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7"


def run(script: str) -> str:
    """HTML that runs a script once it is in the page.

    Scripts in HTML that a page adds later are not run; the handlers of its elements are.
    """
    return f'<img alt="" style="display:none" src="{_NOTHING}" onload="{escape(script)}">'


def _read(ending: str) -> str:
    found = sorted((f for f in _HERE.iterdir() if f.name.endswith(ending)), key=lambda f: f.name)
    return "\n".join(file.read_text(encoding="utf-8") for file in found)


FRONT = f"<style>{_read('.css')}</style>{run(_read('.js'))}"
"""HTML that a page has once."""
