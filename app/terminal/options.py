"""What stands as the default of a command's parameter and makes its option or argument.

A value is read by a function of the option's name, the text and the machine of the design. What
may be typed the shell completes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

from app.terminal import values
from app.terminal.command import Output, said
from app.terminal.poses import Given
from kinematics.designs.assets import asset_folder
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.machine import Machine

Reader = Callable[[str, str, Any], Any]
Known = Callable[[Any], Iterable[str]]
Modes = tuple[str, ...] | None
"""None for all of them."""

FINEST = 1e-12
"""No double holds a volume more exactly, however many sections are taken."""


class Read(click.ParamType[Any]):
    """A value read by a function; the shell offers what is ``known``, and files if wanted."""

    name = "text"

    def __init__(self, read: Reader | None, known: Known | None, files: bool) -> None:
        self.read, self.known, self.files = read, known, files

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if param is None or ctx is None or self.read is None or not isinstance(value, str):
            return value
        if ctx.obj is None:  # what options mean is the design's to say
            for other in ctx.command.params:
                if other.name == "machine" and other.required:
                    raise click.MissingParameter(ctx=ctx, param=other)
        return self.read(param.opts[0], value, ctx.obj)

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """What begins so; behind a comma what may come next."""
        before, comma, last = incomplete.rpartition(",")
        files = [CompletionItem(incomplete, type="file")] if self.files else []
        try:
            known = [] if self.known is None else [*self.known(ctx.obj)]
        except (InputError, AttributeError):  # no design, or one that has nothing of the kind
            known = []
        fitting = (before + comma + word for word in known if word.startswith(last))
        return [*files, *map(CompletionItem, fitting)]


def option(
    metavar: str,
    help: str,
    read: Reader | None = None,
    *names: str,
    known: Known | None = None,
    files: bool = False,
    default: str | None = None,
    kind: type[click.Option] = click.Option,
    **more: Any,
) -> Any:
    """An option with a value, named as the parameter unless by ``names``."""
    if default is not None:
        help, more = f"{help} (default {default})", {"default": default, **more}
    value = Read(read, known, files)

    def made(name: str) -> click.Option:
        shown = names or (f"--{name.replace('_', '-')}",)
        return kind([*shown, name], type=value, metavar=metavar, help=help, **more)

    return made


def flag(help: str) -> Any:
    return lambda name: click.Option([f"--{name.replace('_', '-')}", name], is_flag=True, help=help)


def argument(metavar: str, known: Known, *, files: bool = False, **more: Any) -> Any:
    kind = Read(None, known, files)
    return lambda name: click.Argument([name], metavar=metavar, type=kind, **more)


def choice(help: str, *known: str, default: str | None = None) -> Any:
    """One of some words."""

    def read(option: str, text: str, machine: Any) -> str:
        if text not in known:
            raise InputError(f"{option}: invalid choice {text!r}; it is one of {', '.join(known)}")
        return text

    return option("|".join(known), help, read, known=lambda machine: known, default=default)


def preset_names(machine: Any = None) -> list[str]:
    return sorted(path.stem for path in asset_folder("designs").glob("*.toml"))


def design(*, required: bool = True) -> Any:
    """The machine of the design that is named, which the command has loaded."""
    return lambda name: click.Argument(
        [name],
        metavar="DESIGN",
        required=required,
        type=Read(lambda option, text, machine: machine, preset_names, files=True),
    )


DESIGN = design()


def designs(metavar: str, most: int) -> Any:
    """Names of designs, or of files with them, one or up to so many."""

    def few(ctx: click.Context, param: click.Parameter, names: tuple[str, ...]) -> tuple[str, ...]:
        if len(names) > most:
            raise InputError(f"at most {most} designs, got {len(names)}")
        return names

    return lambda name: click.Argument(
        [name],
        metavar=metavar,
        required=True,
        nargs=-1,
        callback=few,
        type=Read(None, preset_names, files=True),
    )


# --- poses and modes -----------------------------------------------------------------------


class _Needed(click.Option):
    """A pose that is needed where none of its coordinates is given, which click cannot know."""

    needed = True


def pose(otherwise: str = "those of the home posture", *, needed: bool = False) -> Any:
    """--pose, beside an option for each coordinate of the machine."""

    def given(ctx: click.Context, param: click.Parameter, text: str | None) -> Given | None:
        if needed and text is None and not said():
            raise click.MissingParameter(ctx=ctx, param=param)
        return None if ctx.obj is None else Given.read(ctx.obj, text, said())

    help = (
        "mm and degrees, in the mechanism's own coordinates (5-RPUR: x,y,z,phi,theta); - for one "
        "that the constraint gives. Or each coordinate alone, as --phi 10 --theta -5; the others "
        f"are {otherwise}"
    )
    return option("x,y,...", help, callback=given, kind=_Needed if needed else click.Option)


POSE = pose(needed=True)
ORIENTATION = pose("0. Only the angles matter here")

_MODES = "several with commas, ? for either sign, home or all"


def mode(default: str | None = "home") -> Any:
    """One mode."""
    help = "the working or operation mode, as +-+++ or 1, or home, that of the home posture"
    return option("MODE", help, values.mode, "--mode", "--modes", known=_modes, default=default)


def modes(*names: str) -> Any:
    """Any modes; None for all of them."""
    help = f"working modes, one sign a limb, as +-+++, or operation modes, as 1; {_MODES}"
    names = names or ("--modes", "--mode")
    return option("MODES", help, values.modes, *names, known=_modes, default="all")


def _modes(machine: Machine[Any]) -> list[str]:
    return [*machine.modes, "home", "all"]


MODE, MODES = mode(), modes()


# --- the rest ------------------------------------------------------------------------------


def resolution(what: str = "", default: str | None = "normal") -> Any:
    help = f"{what}how fine the mesh is; the volume's error is printed"
    return choice(help, "preview", "normal", "fine", default=default)


RESOLUTION = resolution()


def tolerance(told: str, default: str | None = "") -> Any:
    """How exact; ``told`` stands in the help, and is the default unless there is another."""

    def read(option: str, text: str, machine: Any) -> float:
        value = values.number(f"{option}: the tolerance", text)
        if not FINEST <= value < 1.0:
            raise InputError(f"{option}: {text!r} does not lie between {FINEST:g} and 1")
        return value

    what = "how exact, as a part of the volume"
    if default is None:
        return option("REL", f"{what}  [default: {told}]", read, default=None)
    return option("REL", what, read, default=told)


def output(what: str) -> Any:
    """-o, an `Output` whether or not it is given."""

    def given(ctx: click.Context, param: click.Parameter, text: str | None) -> Output:
        return Output(Path(text) if text else None)

    help = f"write {what}"
    return option("FILE", help, None, "-o", "--output", files=True, callback=given)
