"""What people type, read: by the option's name, the text and, where it matters, the machine.

Angles are degrees here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import isfinite, nan
from typing import TYPE_CHECKING, Any

from kinematics.answers.modes import matching
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.machine import Machine
    from kinematics.mechanism import Coordinate

LARGEST = 1e9
"""Beyond this a typed number is a slip, and squares of it no longer hold a mm."""
MOST = 1_000_000
"""Values in a range."""
DASHES = frozenset("-−–")
"""A coordinate that is left to the mechanism."""


def number(option: str, text: str, machine: Any = None, *, dash: bool = False) -> float:
    """A finite number of a size that means something; with ``dash`` NaN for "-"."""
    if dash and text.strip() in DASHES:
        return nan
    try:
        value = float(text)
    except ValueError:
        raise InputError(f"{option} must be a number, got {text.strip()!r}") from None
    if not isfinite(value):
        raise InputError(f"{option} must be a finite number, got {text.strip()}")
    if abs(value) > LARGEST:
        raise InputError(f"{option} must lie within ±{LARGEST:.0e}, got {text.strip()}")
    return value


def numbers(
    option: str, text: str, names: Sequence[str], units: str = "", *, dash: bool = False
) -> list[float]:
    """One number for each name; with ``dash`` one of them may be NaN.

    Args:
        units: said behind the names where their count is wrong.
    """
    words = text.split(",")
    if len(words) != len(names):
        raise InputError(
            f"{option} needs {len(names)} numbers with commas between them, "
            f"{', '.join(names)}{units}; got {len(words)}"
        )
    if dash and (count := sum(word.strip() in DASHES for word in words)) > 1:
        raise InputError(f"{option}: only one coordinate may be -, got {count}")
    plain = (name.partition(" ")[0] for name in names)
    return [
        number(f"{option}: {name}", word, dash=dash)
        for name, word in zip(plain, words, strict=True)
    ]


def of_axes(
    option: str,
    text: str,
    axes: Sequence[Coordinate],
    units: tuple[str, str] = ("mm", "degrees"),
    *,
    dash: bool = False,
) -> list[float]:
    """One number for each coordinate, as typed; ``units`` of lengths and of angles."""
    names = [f"{axis.symbol} ({units[axis.unit == 'rad']})" for axis in axes]
    return numbers(option, text, names, dash=dash)


def of_joints(option: str, text: str, machine: Machine[Any]) -> list[float]:
    """One number for each actuated joint, as typed."""
    return of_axes(option, text, machine.joints)


def of_pose(option: str, text: str, machine: Machine[Any]) -> list[float]:
    """One number for each coordinate of the pose, as typed; NaN for one that is open."""
    return of_axes(option, text, machine.coordinates, dash=True)


def load(option: str, text: str, machine: Any) -> list[float]:
    """A force (N) and a moment (N·mm)."""
    return numbers(option, text, ("Fx", "Fy", "Fz", "Tx", "Ty", "Tz"), " (N and N·mm)")


def point(option: str, text: str, machine: Any) -> list[float]:
    """A place, mm."""
    return numbers(option, text, "xyz", " (mm)")


def whole(option: str, text: str, machine: Any = None) -> int:
    try:
        return int(text[:20])
    except ValueError:
        raise InputError(f"{option} must be a whole number, got {text.strip()!r}") from None


def without(why: str, **given: Any) -> None:
    """Raise an InputError that says ``why`` of the first of these options that is given."""
    for name, value in given.items():
        if value is not None:
            raise InputError(f"{'-o' if name == 'o' else f'--{name}'} {why}")


def counted(what: str, low: int, high: int) -> Callable[[str, str, Any], int]:
    """Reads a whole number between two others, which is ``what``."""

    def read(option: str, text: str, machine: Any) -> int:
        if not text.isdecimal() or not low <= int(text[:20]) <= high:
            raise InputError(f"{option}: {text!r} is not {what} from {low} to {high}")
        return int(text)

    return read


def span(option: str, text: str, example: str) -> list[float]:
    """The values of "from:to:count", or one alone."""
    words = text.split(":")
    if len(words) == 1:
        return [number(option, text)]
    if len(words) != 3:
        raise InputError(
            f"{option} must be from:to:count, as {example}, or one number; got {text!r}"
        )
    first, last = (number(option, word) for word in words[:2])
    count = int(words[2][:20]) if words[2].strip().isdecimal() else 0
    if not 1 <= count <= MOST:
        most = f"at most {MOST}" if count else "from 1 on"
        raise InputError(f"{option}: the count must be a whole number {most}, got {words[2]!r}")
    if first == last:
        raise InputError(f"{option} runs from {first:g} to the same; write {option} {first:g}")
    step = (last - first) / max(1, count - 1)
    return [first, *(first + n * step for n in range(1, count - 1)), last][: max(count, 1)]


def one_of(option: str, text: str, known: Iterable[str]) -> str:
    """What was typed, in small letters or capital ones, as it is known."""
    named = {each.lower(): each for each in known}
    found = named.get(text.strip().lower())
    if found is None:
        raise InputError(f"{option} must be one of {', '.join(named.values())}, got {text!r}")
    return found


def modes(option: str, text: str, machine: Machine[Any]) -> tuple[str, ...] | None:
    """The modes asked for, in the mechanism's order; None for all of them."""
    word = text.strip().lower()
    if word in ("all", "home"):
        home = machine.home.mode if word == "home" else ""  # "" where there are none
        return (home,) if home else None
    if not machine.mode_noun:
        raise InputError(f"{option}: a {machine.title} has only one mode; leave {option} out")
    try:
        chosen = matching(text, machine.modes, machine.mode_noun)
    except InputError as error:
        raise InputError(f"{option}: {error}, or 'home' or 'all'") from None
    return None if len(chosen) == len(machine.modes) else chosen


def mode(option: str, text: str, machine: Machine[Any]) -> str:
    """The one mode asked for."""
    chosen = modes(option, text, machine) or machine.modes
    if len(chosen) > 1:
        raise InputError(f"{option}: {text.strip()!r} are {len(chosen)} modes; name one of them")
    return chosen[0]
