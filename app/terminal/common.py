"""What the commands share: arguments, design files in, numbers and files out.

Angles are degrees here and nowhere below. Numbers go to stdout (with --json one object and nothing
else), progress and warnings to stderr. Whatever is slow to import is imported by the command that
needs it.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import isfinite, isnan, nan, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from app.review.modes import matching
from app.terminal import tables
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.machine import Machine
    from kinematics.mechanism import Coordinate, Design

# Beyond this a typed number is a slip, and squares of it no longer hold a mm.
LARGEST = 1e9

# No double holds a volume more exactly, however many sections are taken.
FINEST = 1e-12


class AddCommand(Protocol):
    """Adds a command's parser: its name, what runs it, and one line of help."""

    def __call__(self, name: str, run: Any, summary: str, /) -> argparse.ArgumentParser: ...


# --- arguments -----------------------------------------------------------------------------


def add_design(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("design", metavar="DESIGN", help="a preset or a design file")


def add_json(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print one JSON object")


# Of all mechanisms' orientations: whoever parses does not know the design yet.
ANGLES = ("phi", "theta", "alpha", "beta", "gamma")


def add_orientation(parser: argparse.ArgumentParser, *, follows: bool = False) -> None:
    """``follows``: one angle may be "-", which then follows from the mechanism's constraint."""
    hint = ", or - for the one that follows from the constraint" if follows else ""
    for name in ANGLES:
        parser.add_argument(
            f"--{name}",
            type=_angle_or_dash if follows else angle,
            metavar="DEG",
            help=f"degrees, of a mechanism that has it (default 0{hint})",
        )


def _angle_or_dash(text: str) -> float:
    return nan if text.strip() in _DASHES else angle(text)


class Orientation(NamedTuple):
    """A pose of which only the angles matter, mm and rad; NaN for one that is left to the
    mechanism."""

    pose: list[float]
    angles: list[tuple[Coordinate, float]]  # with what was typed, degrees

    @property
    def open(self) -> int | None:
        """Which coordinate is left to the mechanism."""
        return next((n for n, value in enumerate(self.pose) if isnan(value)), None)

    def text(self) -> str:
        """ "φ = 10°, θ = -5°"."""
        return ", ".join(
            f"{axis.symbol} follows" if isnan(value) else f"{axis.symbol} = {value:g}°"
            for axis, value in self.angles
        )

    def entries(self) -> dict[str, float | None]:
        """For JSON; null for what is left to the mechanism."""
        return {tables.key(axis): finite(value) for axis, value in self.angles}


def orientation(arguments: argparse.Namespace, machine: Machine[Any]) -> Orientation:
    """The orientation asked for.

    Raises:
        InputError: an angle that the mechanism does not have, or too many left open.
    """
    axes = machine.coordinates
    own = {axis.key for axis in axes if axis.unit == "rad"}
    for name in ANGLES:
        if getattr(arguments, name) is not None and name not in own:
            has = ", ".join(f"--{axis.key}" for axis in axes if axis.key in own) or "none"
            raise InputError(f"--{name}: a {machine.title} has no such angle; it has {has}")
    typed = [getattr(arguments, axis.key, None) if axis.key in own else None for axis in axes]
    given = [0.0 if value is None else float(value) for value in typed]
    angles = [(axis, v) for axis, v in zip(axes, given, strict=True) if axis.key in own]
    found = Orientation([radians(value) for value in given], angles)
    free = [n for n, value in enumerate(found.pose) if isnan(value)]
    allowed = machine.dependent
    if len(free) > 1 or any(n not in allowed for n in free):
        name = axes[free[-1]].key
        why = (
            "only one angle may be -"
            if len(free) > 1
            else f"no angle of a {machine.title} follows from the others"
        )
        raise InputError(f"--{name}: {why}")
    return found


def add_modes(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--modes",
        default="all",
        metavar="MODES",
        help="working modes, one sign a limb, as +-+++; several with commas, ? for either sign "
        "(default all)",
    )


def add_tolerance(parser: argparse.ArgumentParser, default: float) -> None:
    parser.add_argument(
        "--tolerance",
        type=_tolerance,
        default=default,
        metavar="REL",
        help="how exact, as a part of the volume (default %(default)g)",
    )


def _tolerance(text: str) -> float:
    try:
        value = number(text, "the tolerance")
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    if not FINEST <= value < 1.0:
        raise argparse.ArgumentTypeError(f"{text!r} does not lie between {FINEST:g} and 1")
    return value


def angle(text: str) -> float:
    try:
        return number(text, "the angle in degrees")
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def number(text: str, name: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise InputError(f"{name} must be a number, got {text.strip()!r}") from None
    if not isfinite(value):
        raise InputError(f"{name} must be a finite number, got {text.strip()}")
    if abs(value) > LARGEST:
        raise InputError(f"{name} must lie within ±{LARGEST:.0e}, got {text.strip()}")
    return value


def numbers(
    option: str, text: str, axes: Sequence[Coordinate], units: tuple[str, str] = ("mm", "degrees")
) -> list[float]:
    """The numbers as typed, one for each coordinate; ``units`` of lengths and of angles."""
    words = text.split(",")
    wanted = ", ".join(f"{axis.symbol} ({units[axis.unit == 'rad']})" for axis in axes)
    if len(words) != len(axes):
        raise InputError(
            f"{option} needs {len(axes)} numbers with commas between them, {wanted}; "
            f"got {len(words)}"
        )
    return [
        number(word, f"{option}: {axis.symbol}") for word, axis in zip(words, axes, strict=True)
    ]


def open_numbers(option: str, text: str, axes: Sequence[Coordinate]) -> list[float]:
    """As `numbers`, but NaN for one coordinate that is left to the mechanism, "-"."""
    words = text.split(",")
    free = [n for n, word in enumerate(words) if word.strip() in _DASHES]
    if len(free) > 1:
        raise InputError(f"{option}: only one coordinate may be -, got {len(free)}")
    rest = ",".join("0" if n in free else word for n, word in enumerate(words))
    return [nan if n in free else value for n, value in enumerate(numbers(option, rest, axes))]


_DASHES = frozenset("-−–")


def add_pose(parser: argparse.ArgumentParser, *, required: bool = True) -> None:
    parser.add_argument(
        "--pose",
        required=required,
        metavar="x,y,...",
        help="mm and degrees, in the mechanism's own coordinates (5-RPUR: x,y,z,phi,theta); - for "
        "one that the mechanism's constraint gives",
    )


def add_mode(parser: argparse.ArgumentParser, otherwise: str) -> None:
    parser.add_argument(
        "--mode",
        metavar="MODE",
        help=f"the working or operation mode, as +-+++ or 1 (default: {otherwise})",
    )


def chosen_mode(text: str | None, machine: Machine[Any]) -> str:
    """The one mode asked for; the home posture's if none was."""
    if text is None:
        return machine.home.mode
    if not machine.mode_noun:
        raise InputError(f"--mode: a {machine.title} has only one mode; leave --mode out")
    try:
        chosen = matching(text, machine.modes, machine.mode_noun)
    except InputError as error:
        raise InputError(f"--mode: {error}") from None
    if len(chosen) > 1:
        raise InputError(f"--mode: {text.strip()!r} are {len(chosen)} modes; name one of them")
    return chosen[0]


def mode_entry(machine: Machine[Any], mode: str) -> dict[str, str]:
    """The mode under the mechanism's own key; nothing where there is only one."""
    noun = machine.mode_noun
    return {noun.replace(" ", "_"): mode} if noun else {}


def mode_text(machine: Machine[Any], mode: str) -> str:
    """ ", working mode +-+++", to be put behind a pose; "" where there is only one."""
    return f", {machine.mode_noun} {mode}" if machine.mode_noun else ""


def chosen_modes(text: str, known: tuple[str, ...]) -> tuple[str, ...] | None:
    """The working modes asked for, in the mechanism's order; None for all of them."""
    if text.strip().lower() == "all":
        return None
    try:
        chosen = matching(text, known)
    except InputError as error:
        raise InputError(f"--modes: {error}, or 'all'") from None
    return None if len(chosen) == len(known) else chosen


# --- in and out ----------------------------------------------------------------------------


def load(name: str) -> Machine[Any]:
    from kinematics.designs.files import load_design
    from kinematics.machine import machine_of

    return machine_of(load_design(name))


def warn(machine: Machine[Any]) -> None:
    """Say on stderr what is wrong with a design that is valid all the same."""
    for finding in machine.findings:
        if finding.severity == "warning":
            print(f"bohemia: warning: {finding.title}: {finding.text}", file=sys.stderr)


@contextmanager
def progress(what: str) -> Iterator[None]:
    """Name the work on stderr while it lasts, if a person is looking."""
    shown = sys.stderr.isatty()
    if shown:
        print(f"{what} …", end="", file=sys.stderr, flush=True)
    try:
        yield
    finally:
        if shown:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def ending(path: Path, known: tuple[str, ...], what: str) -> str:
    """The format that an ending asks for; refused, before any work, if it cannot be written."""
    kind = path.suffix.removeprefix(".").lower()
    if kind not in known:
        got = f"has the ending .{kind}" if kind else "has no ending"
        endings = ", ".join(f".{each}" for each in known)
        raise InputError(f"{str(path)!r} {got}; {what} is written as one of {endings}")
    return checked(path, kind)


def checked(path: Path, kind: str) -> str:
    """Refuse, before any work, a file that cannot be written."""
    if path.is_dir():
        raise InputError(f"cannot write {str(path)!r}: it is a folder")
    if not path.parent.is_dir():
        raise InputError(f"cannot write {str(path)!r}: there is no folder {str(path.parent)!r}")
    return kind


def write(path: Path, data: bytes) -> None:
    try:
        path.write_bytes(data)
    except OSError as error:
        why = error.strerror or str(error)
        raise InputError(f"cannot write {str(path)!r}: {why}") from None


def finite(value: float) -> float | None:
    """JSON has no infinity."""
    return float(value) if isfinite(value) else None


def print_head(design: Design, *lines: str) -> None:
    print(f"{design.name}: {design.title}", *lines, sep="\n")


def print_json(answer: dict[str, Any]) -> None:
    print(json.dumps(answer, allow_nan=False))
