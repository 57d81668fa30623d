"""Values of a session file, checked as they are read: one sentence for what cannot be used."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Any

from app.language import tr
from kinematics.designs.files import read_design, write_design
from kinematics.errors import InputError
from kinematics.machine import Machine
from kinematics.mechanism import Coordinate, Design


def typed(content: dict[str, Any], key: str, kind: type, origin: str) -> Any:
    """What stands under a key, which must be there.

    Raises:
        InputError: it is not, or is of another kind.
    """
    value = content.get(key)
    if not isinstance(value, kind):
        raise InputError(tr("session.missing", what=f"{origin}: {key!r}"))
    return value


def table(content: dict[str, Any], key: str, origin: str) -> dict[str, Any]:
    """The table under a key; an empty one where an older session has none.

    Raises:
        InputError: it is no table.
    """
    given = content.get(key, {})
    if not isinstance(given, dict):
        raise InputError(tr("session.wrong_kind", what=f"{origin}: {key!r}"))
    return given


def number(value: Any, what: str) -> float:
    """A finite number.

    Raises:
        InputError: it is none.
    """
    if not isinstance(value, bool) and isinstance(value, int | float):
        with suppress(OverflowError):  # an integer that no double comes near
            if math.isfinite(value):
                return float(value)
    raise InputError(tr("typing.one_finite", what=what))


def listed(value: object, known: Iterable[object], what: str) -> None:
    """Raise an InputError that begins with ``what`` unless a value is one of those known."""
    names = tuple(known)
    if value not in names:
        known_as = ", ".join(str(n) for n in names if n)
        raise InputError(f"{what} {tr('session.not', known=known_as, value=value)}")


def design_entry(design: Design) -> dict[str, str]:
    """A further design as a session has it, beside the one that is reviewed."""
    return {"name": design.name, "design": write_design(design)}


def design_of(entry: object, what: str) -> Design:
    """A design from such an entry.

    Raises:
        InputError: it is none; the sentence begins with ``what``.
    """
    given = entry if isinstance(entry, Mapping) else {}
    text, name = given.get("design"), given.get("name")
    if not isinstance(text, str) or not isinstance(name, str):
        raise InputError(tr("design.no_design", what=what))
    return read_design(text, origin=what, name=name)


def key_of(c: Coordinate) -> str:
    """What a coordinate is called in the file."""
    return c.key if c.unit == "mm" else f"{c.key}_deg"


def checked_modes(modes: Sequence[Any], machine: Machine[Any], origin: str) -> None:
    """Raise an InputError unless all these are modes of a machine."""
    if any(mode not in machine.modes for mode in modes):
        noun = tr(f"modes.{(machine.mode_noun or 'mode').replace(' ', '_')}")
        known = ", ".join(map(repr, machine.modes))
        raise InputError(tr("session.one_of", what=f"{origin}: {noun}", known=known))
