"""Docstrings are written for people: bars mean absolute values there, and no substitutions."""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

_CODE = re.compile(r"(``.*?``|`.*?`)")


def escaped(line: str) -> str:
    """The line with its bars as they are; what is code or dialogue is not touched."""
    if line.lstrip().startswith((">>>", "...")):
        return line
    parts = _CODE.split(line)
    parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
    return "".join(parts)


def _lines(app: Sphinx, what: str, name: str, item: Any, options: Any, lines: list[str]) -> None:
    lines[:] = [escaped(line) for line in lines]


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("autodoc-process-docstring", _lines, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
