"""The examples in the README and in the documentation, as they stand there.

In the pages of the documentation

- ``console`` shows commands behind ``$`` with what they print, where ``…`` is anything, also lines;
- ``sh`` has commands without what they print, and ``pycon`` a dialogue with Python;
- ``toml`` and ``text`` with a caption are files of that name, for what comes after them;
- a line ``% slow`` before one has it left out of the quick tests.

    python -m tests.examples PAGE…

writes what commands and Python print now into the pages, to be read before it is committed.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import os
import re
import shlex
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.cli import main

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "assets" / "docs"
_BLOCK = re.compile(
    r"^(?P<slow>% slow\n+)?```(?:\{code-block\} )?(?P<kind>[a-z]+)\n(?P<text>.*?)^```$", re.M | re.S
)
_OPTION = re.compile(r"\A:caption: (\S+)\n+")


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, its text, the file that it is, and where the text begins."""

    kind: str
    text: str
    file: str = ""
    slow: bool = False
    start: int = 0


def blocks(text: str, *kinds: str) -> list[Block]:
    """The blocks of a page in their order, of some languages or of all."""
    found = []
    for match in _BLOCK.finditer(text):
        said, file = match["text"], ""
        if option := _OPTION.match(said):
            said, file = said[option.end() :], option[1]
        if not kinds or match["kind"] in kinds:
            start = match.end("text") - len(said)
            found.append(Block(match["kind"], said, file, bool(match["slow"]), start))
    return found


def commands(text: str) -> list[str]:
    """The `bohemia …` lines of a page's ``sh``, without their comments."""
    lines = "".join(block.text for block in blocks(text, "sh")).splitlines()
    return [line.split("#")[0].strip() for line in lines if line.startswith("bohemia ")]


def dialogue(text: str, name: str) -> doctest.DocTest:
    """A page's conversation with Python."""
    said = "".join(block.text for block in blocks(text, "pycon"))
    return doctest.DocTestParser().get_doctest(said, {}, name, None, 0)


@dataclass(frozen=True)
class Said:
    """What a command printed."""

    code: int
    out: str
    err: str


def run(command: str | Sequence[str]) -> Said:
    """A `bohemia …`, or its words after that, in this process and folder."""
    words = shlex.split(command)[1:] if isinstance(command, str) else command
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main(words)
        except SystemExit as done:
            code = int(done.code or 0)
    return Said(code, out.getvalue(), err.getvalue())


def shown(text: str) -> Iterator[tuple[str, str]]:
    """The commands of a ``console`` block and what stands below each."""
    for part in re.split(r"^\$ ", text, flags=re.M)[1:]:
        command, _, below = part.partition("\n")
        while command.endswith("\\"):
            more, _, below = below.partition("\n")
            command = f"{command[:-1]}{more.lstrip('> ')}"
        yield command, below


def same(printed: str, told: str) -> bool:
    """Whether a page tells what is printed; … may be anything."""
    parts = re.split(r"(?:^[ ]*…[ ]*\n|…)", told, flags=re.M)
    return re.fullmatch(r".*?".join(map(re.escape, parts)), printed, re.S) is not None


def play(page: Path, *, slow: bool) -> int:
    """Run all that a page shows, in this folder, and count it.

    Raises:
        AssertionError: something else happens than the page says.
    """
    text = page.read_text(encoding="utf-8")
    known: dict[str, Any] = {}
    count = 0
    for block in blocks(text):
        if block.file:
            Path(block.file).write_text(block.text, encoding="utf-8")
        if block.slow and not slow:
            continue
        if block.kind == "console":
            for command, below in shown(block.text):
                said, count = run(command), count + 1
                printed = said.out if said.code == 0 else said.err
                assert same(printed, below), f"$ {command}\n{printed}\nand not\n{below}"
                assert said.code or not said.err, f"$ {command}\n{said.err}"
        elif block.kind == "sh":
            for command in commands(f"```sh\n{block.text}```\n"):
                said, count = run(command), count + 1
                assert (said.code, said.err) == (0, ""), f"$ {command}\n{said.err}"
                assert said.out, command
        elif block.kind == "pycon":
            test = doctest.DocTestParser().get_doctest(block.text, known, page.name, None, 0)
            test.globs = known  # one conversation a page
            report = io.StringIO()
            runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
            count += len(test.examples)
            failed = runner.run(test, out=report.write, clear_globs=False).failed
            assert not failed, report.getvalue()
    return count


def filled(text: str) -> str:
    """A page with what its commands and its Python print now; longer lines with … are kept."""
    known: dict[str, Any] = {}
    for block in reversed(blocks(text)):  # places in the text stay right from the end on
        if block.file:
            Path(block.file).write_text(block.text, encoding="utf-8")
    changes = []
    for block in blocks(text):
        new = block.text
        if block.kind == "console":
            new = ""
            for command, below in shown(block.text):
                said = run(command)
                printed = said.out if said.code == 0 else said.err
                kept = "…" in below and below.strip() != "…" and same(printed, below)
                printed = re.sub(r"(?<=in )[\d.]+ m?s$", "…", printed, flags=re.M)
                new += f"$ {command}\n{below if kept else printed}"
        elif block.kind == "pycon":
            new = "".join(_talk(block.text, known))
        changes.append((block, new))
    for block, new in reversed(changes):
        text = text[: block.start] + new + text[block.start + len(block.text) :]
    return text


def _talk(text: str, known: dict[str, Any]) -> Iterator[str]:
    for example in doctest.DocTestParser().get_examples(text):
        first, *rest = example.source.splitlines()
        yield "\n".join([f">>> {first}", *(f"... {line}" for line in rest), ""])
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile(example.source, "page", "single"), known)
        printed = out.getvalue()
        told = example.want
        yield told if "..." in told else printed


if __name__ == "__main__":
    for name in sys.argv[1:]:
        path = Path(name).resolve()
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            written = filled(path.read_text(encoding="utf-8"))
        path.write_text(written, encoding="utf-8")
        print(os.path.relpath(path))
