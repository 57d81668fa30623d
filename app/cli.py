"""`bohemia`: the page, and the same answers without a browser.

Exit code 0: done, 1: it could not be computed, 2: bad input. Each command stands in the folder of
its feature and is imported when it is called.
"""

from __future__ import annotations

import errno
import os
import signal
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module
from typing import Any

import click
from click.shell_completion import CompletionItem, shell_complete

from kinematics.designs.assets import asset_folder
from kinematics.errors import BohemiaError, InputError

COMMANDS = {
    "serve": "review.command:serve",
    "designs": "review.command:designs",
    "ik": "solutions.command:ik",
    "fk": "solutions.command:fk",
    "workspace": "workspace.command:workspace",
    "vertex-space": "workspace.command:vertex_space",
    "volume": "section.command:volume",
    "section": "section.command:section",
    "map": "map.command:chart",
    "velocity": "move.command:velocity",
    "statics": "move.command:statics",
    "singularity": "singularities.command:singularity",
    "micr": "singularities.micr_command:micr",
    "trajectory": "trajectory.command:trajectory",
    "compare": "compare.command:compare",
    "paper": "paper.command:paper",
    "report": "report.command:report",
    "schema": "review.command:schema",
}
"""Where each command stands in `app.features`; the first is meant where none is named."""
SERVE = next(iter(COMMANDS))
COMPLETE = "_BOHEMIA_COMPLETE"
"""The environment variable by which a shell asks for completions."""
UNWRITABLE = (errno.ENOSPC, errno.EIO, errno.EBADF, errno.EFBIG, errno.EDQUOT)


class Bohemia(click.Group):
    """The commands by name. A design alone is served, and so is the page without any word."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        module, _, name = COMMANDS[cmd_name].partition(":")
        found: click.Command = getattr(import_module(f"app.features.{module}"), name)
        return found

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        first = args[0] if args else ""
        own = {name for param in self.get_params(ctx) for name in param.opts}
        served = first.startswith("-") and first not in own
        if served or _is_design(first) or not (first or ctx.resilient_parsing):
            args = [SERVE, *args]
        return super().parse_args(ctx, args)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args[0] not in COMMANDS and not ctx.resilient_parsing:
            presets = [path.stem for path in asset_folder("designs").glob("*.toml")]
            near = get_close_matches(args[0], [*COMMANDS, *presets], n=1)
            hint = f"did you mean {near[0]!r}" if near else f"there are {', '.join(COMMANDS)}"
            raise InputError(f"there is no command {args[0]!r}; {hint}")
        return super().resolve_command(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Commands, and what is served: designs."""
        serve = self.get_command(ctx, SERVE)
        designs = serve.params[0].shell_complete(ctx, incomplete) if serve else []
        return [*designs, *super().shell_complete(ctx, incomplete)]


def _version(ctx: click.Context, param: click.Parameter, wanted: bool) -> None:
    """Looks the version up only when it is asked for: that takes longer than --help."""
    if not wanted:
        return
    from importlib.metadata import PackageNotFoundError, version

    try:
        found = version("bohemia")
    except PackageNotFoundError:
        found = "(not installed)"
    click.echo(f"bohemia {found}")
    ctx.exit()


bohemia = Bohemia(
    "bohemia",
    help="An instrument for people who design parallel mechanisms. Without a command it serves the "
    "page.",
    epilog="Lengths are mm, angles degrees. DESIGN is a preset (see bohemia designs) or the path "
    "of a design file. Commands, presets, files, modes and names are completed by the shell after "
    f'eval "$({COMPLETE}=bash_source bohemia)"; likewise zsh_source, and in fish '
    f"{COMPLETE}=fish_source bohemia | source.",
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    params=[
        click.Option(
            ["--version"],
            is_flag=True,
            is_eager=True,
            expose_value=False,
            callback=_version,
            help="show the version and exit",
        )
    ],
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    if sys.stderr is None:  # closed: what it would say is lost, but no error
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115, PTH123 (for as long as this process runs)
    if sys.stdout is None:
        return _fail("standard output is closed, so there is no place for an answer", 1)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a terminal without φ shows ? and goes on
            stream.reconfigure(errors="replace")
    try:
        if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:  # see `app.__main__`
            signal.signal(signal.SIGINT, signal.default_int_handler)
        if COMPLETE in os.environ:
            return shell_complete(bohemia, {}, "bohemia", COMPLETE, os.environ[COMPLETE])
        with bohemia.make_context("bohemia", list(sys.argv[1:] if argv is None else argv)) as ctx:
            bohemia.invoke(ctx)
        sys.stdout.flush()
    except click.exceptions.Exit as done:
        raise SystemExit(done.exit_code) from None
    except click.UsageError as error:
        return _fail(_sentence(error), 2)
    except InputError as error:
        return _fail(str(error), 2)
    except BohemiaError as error:
        return _fail(str(error), 1)
    except OSError as error:
        if error.errno not in (errno.EPIPE, *UNWRITABLE) or error.filename is not None:
            raise
        # What is left in the buffer must not be tried again at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if error.errno == errno.EPIPE:  # the reader, as `head`, had enough
            return 1
        return _fail(f"the answer cannot be written: {error.strerror}", 1)
    except KeyboardInterrupt:
        return 130
    return 0


def _fail(text: str, code: int) -> int:
    click.echo(f"bohemia: {' '.join(text.split())}", err=True)
    return code


def _sentence(error: click.UsageError) -> str:
    """What was typed wrong, in one sentence instead of a usage listing."""
    ctx = error.ctx
    said = f"{error.format_message()[:1].lower()}{error.format_message()[1:].rstrip('.')}"
    params: list[Any] = [] if ctx is None else ctx.command.get_params(ctx)
    if isinstance(error, click.MissingParameter) and ctx is not None:
        named = [
            param.make_metavar(ctx) if isinstance(param, click.Argument) else param.opts[0]
            for param in params
            if param.required or getattr(param, "needed", False)
            if param.name not in ctx.params
        ]
        said = f"these arguments are required: {', '.join(named)}"
    elif isinstance(error, click.NoSuchOption):
        own = [param.opts[0] for param in params if isinstance(param, click.Option)]
        bare = {name.strip("-"): name for param in params for name in param.opts}
        near = get_close_matches(error.option_name.strip("-"), bare, n=1)
        hint = f"did you mean {bare[near[0]]}" if near else f"there are {', '.join(own)}"
        said = f"unrecognized arguments: {error.option_name}; {hint}"
    elif isinstance(error, click.BadOptionUsage):
        flag = any(error.option_name in param.opts and param.is_flag for param in params)
        said = f"{error.option_name}: {'no argument is taken' if flag else 'expected one argument'}"
    return f"{said} (see {'bohemia' if ctx is None else ctx.command_path} --help)"


def _is_design(word: str) -> bool:
    """A preset, or what looks like a design file: whoever names one alone wants to see it."""
    if not word or word in COMMANDS or word.startswith("-"):
        return False
    preset = asset_folder("designs") / f"{word}.toml"
    return word.endswith(".toml") or ("/" not in word and "\\" not in word and preset.is_file())
