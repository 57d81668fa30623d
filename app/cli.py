"""`bohemia`: the page, and the same answers without a browser.

Exit code 0: done, 1: it could not be computed, 2: bad input. Each family of commands is a module
of `app.commands`.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any, NoReturn

from app.features.map import command as mapping
from app.features.move import command as controlling
from app.features.review import command as serving
from app.features.section import command as measuring
from app.features.singularities import command as losing
from app.features.singularities import micr_command
from app.features.solutions import command as solving
from app.features.trajectory import command as moving
from app.features.workspace import command as solids
from kinematics.designs.assets import asset_folder
from kinematics.errors import BohemiaError, InputError

# Their values may begin with a minus sign, which argparse takes for an option.
SIGNED_OPTIONS = frozenset(
    {
        *(
            "--pose",
            "--joints",
            "--phi",
            "--theta",
            "--alpha",
            "--beta",
            "--gamma",
            "--modes",
            "--mode",
            "--x",
            "--around",
            "--at",
        ),
        *("--rates", "--accelerations", "--joint-rates", "--joint-accelerations", "--load"),
        *("--base", "--platform", "--altitude", "--ratios", "--heights"),
    }
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a terminal without φ shows ? and goes on
            stream.reconfigure(errors="replace")
    try:
        arguments = _parse(list(sys.argv[1:] if argv is None else argv))
        arguments.command(arguments)
        sys.stdout.flush()
    except InputError as error:
        return _fail(error, 2)
    except BohemiaError as error:
        return _fail(error, 1)
    except BrokenPipeError:  # the reader, as `head`, had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


def _fail(error: BohemiaError, code: int) -> int:
    print(f"bohemia: {' '.join(str(error).split())}", file=sys.stderr)
    return code


# --- arguments -----------------------------------------------------------------------------


class _Parser(argparse.ArgumentParser):
    """Mistakes become one sentence instead of a usage listing."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message} (see {self.prog} --help)")


class _Version(argparse.Action):
    """Looks the version up only when it is asked for: that takes longer than --help."""

    def __init__(self, **options: Any) -> None:
        super().__init__(nargs=0, **options)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            found = version("bohemia")
        except PackageNotFoundError:
            found = "(not installed)"
        print(f"bohemia {found}")
        parser.exit()


def _parser() -> tuple[argparse.ArgumentParser, tuple[str, ...]]:
    """The parser, and the names of its commands."""
    parser = _Parser(
        prog="bohemia",
        description="An instrument for people who design parallel mechanisms. "
        "Without a command it serves the page.",
        epilog="Lengths are mm, angles degrees. DESIGN is a preset (see bohemia designs) or the "
        "path of a design file.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, help="show the version and exit")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, title="commands")

    def command(name: str, run: Any, summary: str) -> argparse.ArgumentParser:
        added = commands.add_parser(name, help=summary, description=summary, allow_abbrev=False)
        added.set_defaults(command=run)
        return added

    families = (
        serving,
        solving,
        solids,
        measuring,
        mapping,
        controlling,
        losing,
        micr_command,
        moving,
    )
    for family in families:
        family.register(command)
    return parser, tuple(commands.choices)


def _parse(argv: list[str]) -> argparse.Namespace:
    parser, commands = _parser()
    first = argv[0] if argv else ""
    is_option = first.startswith("-") and first not in {"-h", "--help", "--version"}
    if not first or is_option or (first not in commands and _is_design(first)):
        argv = ["serve", *argv]
    elif not first.startswith("-") and first not in commands:
        near = get_close_matches(first, commands, n=1)
        hint = f"did you mean {near[0]!r}" if near else f"there are {', '.join(commands)}"
        raise InputError(f"there is no command {first!r}; {hint}")
    return parser.parse_args(_joined(argv))


def _is_design(word: str) -> bool:
    """A preset, or what looks like a design file: whoever names one alone wants to see it."""
    if word.startswith("-"):
        return False
    preset = asset_folder("designs") / f"{word}.toml"
    return word.endswith(".toml") or ("/" not in word and "\\" not in word and preset.is_file())


def _joined(argv: list[str]) -> list[str]:
    """`--pose -10,…` as `--pose=-10,…`, the form in which argparse accepts it.

    A value of two minus signs, which is a mode, argparse would take for its own end of options: it
    gets the longer signs, which mean the same.
    """
    joined: list[str] = []
    words = iter(argv)
    for word in words:
        value = next(words, None) if word in SIGNED_OPTIONS else None
        option, given, own = word.partition("=")
        if value is None and given and option in SIGNED_OPTIONS:
            word, value = option, own
        if value is not None:
            value = "−−" if value.strip() == "--" else value
        joined.append(word if value is None else f"{word}={value}")
    return joined
