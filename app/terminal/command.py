"""What every command does alike: its options are its function's, and it answers as JSON or as text.

Angles are degrees here and nowhere below. Numbers go to stdout (with --json one object and nothing
else), progress and warnings to stderr. Whatever is slow to import is imported by the command that
needs it.
"""

from __future__ import annotations

import inspect
import json
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

from app.terminal import tables
from app.terminal.files import format_of
from app.terminal.lengths import csv_in, line_in
from kinematics.errors import BohemiaError, InputError
from kinematics.lengths import UNITS, unit_of
from kinematics.storage import write_file

if TYPE_CHECKING:
    from kinematics.machine import Machine

WORDS, COORDINATES = "bohemia.words", "bohemia.coordinates"


@dataclass(frozen=True, slots=True)
class Answer:
    """What a command found out.

    Attributes:
        data: what --json prints, below the schema and the design's name. Its ``warnings`` are told
            on stderr as well.
        lines: what is printed without --json, below the design's title.
        stopped: why this is not all that was asked for, "" where it is.
    """

    data: Mapping[str, Any]
    lines: Iterable[str]
    stopped: str = ""


@dataclass(slots=True)
class Output:
    """The file that -o names, if it does, and the ``unit`` of its lengths where its kind leaves
    that open; what was ``written`` and what is to be known of it.
    """

    path: Path | None = None
    unit: str = "mm"
    written: str | None = None
    note: str = ""

    def kind(self, known: tuple[str, ...], what: str) -> str:
        """The format that its ending asks for, "" without a file.

        Raises:
            InputError: before any work, an ending of no format or a file that cannot be written.
        """
        if self.path is None:
            return ""
        path, kind = self.path, format_of(self.path, known, f"{what} is")
        if path.is_dir():
            raise InputError(f"cannot write {str(path)!r}: it is a folder")
        if not path.parent.is_dir():
            raise InputError(f"cannot write {str(path)!r}: there is no folder {str(path.parent)!r}")
        return kind

    def unit_of(self, kind: str) -> str:
        """Which unit a file of a kind is in, some of which leave no choice."""
        return {"glb": "m", "svg": "mm"}.get(kind, self.unit)

    def write(self, data: bytes, note: str = "", lengths: Collection[str] = ()) -> None:
        """Write the content; of a CSV with all columns that are mm in the unit, see `csv_in`."""
        if self.path is not None:
            if self.path.suffix.lower() == ".csv" and self.unit != "mm":
                data = csv_in(data.decode(), self.unit, lengths).encode()
            write_file(self.path, data)
            self.written, self.note = str(self.path), note and f" ({note})"


class Command(click.Command):
    """A command; one that takes a design has its machine as the context's object.

    Attributes:
        schema: the form of its JSON, by name.
        coordinates: whether the coordinates of the machine's pose are options too.
    """

    schema = ""
    coordinates = False

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.meta.update({WORDS: [word for word in args if word != "="], COORDINATES: []})
        design = self._design(ctx, args)
        if design is not None:
            with suppress(*((BohemiaError,) if ctx.resilient_parsing else ())):
                ctx.obj = load(design)
        if ctx.obj is not None and self.coordinates:
            own = {name for param in self.params for name in param.opts}
            ctx.meta[COORDINATES] = [
                click.Option(
                    [f"--{axis.key}"],
                    metavar="DEG" if axis.unit == "rad" else "MM",
                    help=f"{axis.symbol} of the pose alone",
                    is_eager=True,  # before --pose, which is not to be given beside them
                    expose_value=False,
                    callback=_keep,
                )
                for axis in ctx.obj.coordinates
                if f"--{axis.key}" not in own
            ]
        try:
            return super().parse_args(ctx, args)
        except click.UsageError as error:
            error.ctx = error.ctx or ctx
            raise

    def _design(self, ctx: click.Context, args: list[str]) -> str | None:
        """The word that names the design: neither an option nor the value of one."""
        if not any(param.name == "machine" for param in self.params):
            return None
        flags = {n for p in self.get_params(ctx) if getattr(p, "is_flag", 0) for n in p.opts}
        words = iter(args)
        for word in words:
            if not word.startswith("-"):
                return word
            if word not in flags and "=" not in word and (word.startswith("--") or len(word) < 3):
                next(words, None)
        return None

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        return [*super().get_params(ctx), *ctx.meta.get(COORDINATES, ())]

    def invoke(self, ctx: click.Context) -> None:
        as_json, output = ctx.params.pop("as_json", False), ctx.params.get("output") or Output()
        output.unit = ctx.params.pop("units", "mm")
        answer: Answer | None = super().invoke(ctx)
        if answer is None:
            return
        found = [] if ctx.obj is None else tables.warnings(ctx.obj)
        for text in (*found, *answer.data.get("warnings", ())):
            warn(text)
        data: dict[str, Any] = {"schema": self.schema}
        lines = [line_in(line, output.unit) for line in answer.lines]
        if ctx.obj is not None:
            design = ctx.obj.design
            data |= {"design": design.name, "mechanism": design.mechanism}
            lines.insert(0, f"{design.name}: {design.title or ctx.obj.title}")
        data |= answer.data
        if "output" in ctx.params:
            data["file"] = output.written
            if output.unit != "mm":
                data["file_units"] = output.unit
        if output.written:
            lines.append(f"file       {output.written}{output.note}")
        click.echo(json.dumps(data, allow_nan=False) if as_json else "\n".join(lines))
        if answer.stopped:
            click.echo(f"bohemia: {answer.stopped}", err=True)
            raise KeyboardInterrupt

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Options; or the values of the last one, which may begin with a minus sign too."""
        last = [*ctx.meta.get(WORDS, ()), ""][-1 - bool(ctx.meta.get(WORDS))]
        for param in self.get_params(ctx):
            if isinstance(param, click.Option) and not param.is_flag and last in param.opts:
                return param.shell_complete(ctx, incomplete)
        return super().shell_complete(ctx, incomplete)


class _Unit(click.ParamType[Any]):
    name = "unit"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        unit = unit_of(value)
        if not unit:
            raise InputError(f"--units: {value!r} is none of {', '.join(UNITS)}")
        return unit

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        return [CompletionItem(unit) for unit in UNITS if unit.startswith(incomplete)]


_UNITS = click.Option(
    ["--units"],
    type=_Unit(),
    metavar="|".join(UNITS),
    default="mm",
    help="of lengths, areas and volumes that are printed, and in files whose kind leaves it open: "
    "STL, PLY, OBJ, 3MF, DXF, CSV (default mm). JSON is mm, as its keys say; SVG is of true size, "
    "GLB in metres. What is typed is mm",
)


def _keep(ctx: click.Context, param: click.Parameter, text: str | None) -> None:
    if text is not None:
        said()[param.opts[0].removeprefix("--")] = text


def said() -> dict[str, str]:
    """What was typed of coordinates by options of their own: text by key."""
    found: dict[str, str] = click.get_current_context().meta.setdefault("bohemia.said", {})
    return found


def command(
    name: str, *, version: int = 1, coordinates: bool = False
) -> Callable[[Callable[..., Any]], Command]:
    """Makes a command of a function; its docstring is the help, and the default of each parameter
    makes an option or argument of the parameter's name (see `app.terminal.options`).

    Args:
        version: of its JSON; a key that is taken away or changes its meaning raises it.
        coordinates: whether those of the pose are options too, as where there is a ``pose``.
    """

    def made(function: Callable[..., Any]) -> Command:
        signature = inspect.signature(function)
        params = [each.default(each.name) for each in signature.parameters.values()]
        if signature.return_annotation == Answer.__name__:
            if "machine" in signature.parameters:
                params.append(_UNITS)
            params.append(
                click.Option(["--json", "as_json"], is_flag=True, help="print one JSON object")
            )
        help = inspect.cleandoc(function.__doc__ or "")
        done = Command(name, callback=function, params=params, help=help)
        done.schema = f"bohemia/{name}/{version}"
        done.coordinates = coordinates or any(param.name == "pose" for param in params)
        return done

    return made


def load(name: str) -> Machine[Any]:
    """The machine of a preset or of a design file."""
    from kinematics.designs.files import load_design
    from kinematics.machine import machine_of

    return machine_of(load_design(name))


def warn(text: str) -> None:
    click.echo(f"bohemia: warning: {text}", err=True)


@contextmanager
def progress(what: str) -> Iterator[Callable[[str], None]]:
    """Name the work on stderr while it lasts, if a person is looking; or rename it."""

    def show(text: str) -> None:
        if sys.stderr.isatty():
            click.echo(f"\r{text}\x1b[K", nl=False, err=True)

    show(f"{what} …")
    try:
        yield show
    finally:
        show("")
