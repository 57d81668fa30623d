"""Modes of a mechanism as values: working modes, operation modes, or both.

A working mode is one sign a limb: on which of its two branches the limb stands. An operation mode
is a family of motions of the platform; they are told apart by numbers. A mechanism may have one of
these, both (a 3-PRS), or neither.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import product

from kinematics.errors import InputError

_NAMED = 16  # modes that a message names
_MINUS = str.maketrans("−–", "--")


def plain(text: str) -> str:
    """With a minus for each of − and –, and without blanks around."""
    return text.strip().translate(_MINUS)


class Mode(str):
    """A mode; as text it is its written form: "+-+++", "1", or "1+-+" of both kinds at once.

    Attributes:
        operation: the number of the operation mode, as "1"; "" where there is but one.
        signs: one sign a limb, as "+-+++"; "" where the limbs have but one branch.
    """

    __slots__ = ("operation", "signs")
    operation: str
    signs: str

    def __new__(cls, operation: int | str = "", signs: str = "") -> Mode:
        made = super().__new__(cls, f"{operation}{signs}")
        made.operation, made.signs = str(operation), signs
        return made

    def __getnewargs__(self) -> tuple[str, str]:  # type: ignore[override]
        return self.operation, self.signs

    @classmethod
    def read(cls, text: str) -> Mode:
        """The mode that is written so; a minus may be any of - − –.

        Raises:
            InputError: it is no number followed by signs.
        """
        found = re.fullmatch(r"(\d*)([+-]*)", plain(text))
        if found is None:
            raise InputError(
                "a mode is one sign for each limb, as +-+++, or the number of an operation mode; "
                f"got {text[:20]!r}"
            )
        return cls(*found.groups())

    @property
    def page(self) -> str:
        """With a minus sign as long as the plus."""
        return self.replace("-", "−")

    @property
    def named(self) -> str:
        """ "mode ++−+−", "operation mode 1", "operation mode 1, mode ++−"; "" of the only mode."""
        parts = (
            f"operation mode {self.operation}" if self.operation else "",
            f"mode {self.signs.replace('-', '−')}" if self.signs else "",
        )
        return ", ".join(filter(None, parts))

    @property
    def entry(self) -> dict[str, str]:
        """As JSON has it: under "operation_mode", under "working_mode", or both."""
        parts = {"operation_mode": self.operation, "working_mode": self.signs}
        return {key: part for key, part in parts.items() if part}

    @property
    def sigma(self) -> tuple[float, ...]:
        """The signs as numbers ±1."""
        return tuple(1.0 if sign == "+" else -1.0 for sign in self.signs)

    def flips(self, other: str) -> int:
        """How many limbs change their sign from here to there; another operation counts most."""
        there = Mode.read(other)
        turned = sum(a != b for a, b in zip(self.signs, there.signs, strict=True))
        return turned + (len(self.signs) + 1) * (self.operation != there.operation)

    def with_sign(self, limb: int, sign: str, known: Sequence[Mode] = ()) -> Mode:
        """With the sign of a limb (from 1) replaced; of modes that are known, the nearest such."""
        turned = Mode(self.operation, self.signs[: limb - 1] + sign + self.signs[limb:])
        able = [mode for mode in known if mode.signs[limb - 1 : limb] == sign]
        return min(able, key=turned.flips, default=turned)


def working_modes(limbs: int) -> tuple[Mode, ...]:
    """All modes of so many limbs with two branches each, the last limb changing fastest."""
    return tuple(Mode(signs="".join(signs)) for signs in product("+-", repeat=limbs))


def noun(modes: Sequence[str]) -> str:
    """What a mechanism's modes are: "working mode", "operation mode", "mode" of both kinds; ""."""
    read = [Mode.read(mode) for mode in modes]
    signs, numbers = any(mode.signs for mode in read), any(mode.operation for mode in read)
    if signs and numbers:
        return "mode"
    return "working mode" if signs else "operation mode" if numbers else ""


def one_of(text: str, modes: Sequence[Mode]) -> Mode:
    """The one of a mechanism's modes that is written so.

    Raises:
        InputError: there is no such mode; the message says how one is written.
    """
    written = plain(text)
    for mode in modes:
        if mode == written:
            return mode
    example, called = modes[len(modes) // 2 - 1], noun(modes)
    if example.signs and not example.operation:
        limbs = len(example.signs)
        said = (
            f"has one sign, + or -, for each of the {limbs} limbs: {limbs} signs, "
            f"as {str(example)!r};"
        )
    else:
        said = f"is {' or '.join(modes[:40])}," if called else "need not be named;"
    article = "an" if called.startswith("o") else "a"
    raise InputError(f"{article} {called or 'mode'} {said} got {text[:20]!r}")


def matching(text: str, known: Sequence[str], called: str = "") -> tuple[Mode, ...]:
    """The modes of a mechanism that fit what was typed, in the mechanism's order.

    Args:
        text: modes or patterns with commas or blanks between them, "+-?++, −−+++"; ? stands for
            either sign, and a minus may be typed as any of - − –. Of modes of both kinds a number
            or signs alone fit all that have them.
        known: all modes of the mechanism.
        called: what messages call them; by default what they are.

    Raises:
        InputError: a word fits no mode; the message says what is wanted.
    """
    modes = [Mode.read(mode) for mode in known]
    called = called or noun(known) or "mode"
    chosen: set[str] = set()
    for word in re.split(r"[,;\s]+", text.strip()):
        found = re.fullmatch(r"(\d*)([+?-]*)", plain(word))
        fitting = {m for m in modes if found and word and _fits(m, *found.groups())}
        if not fitting:
            pattern = found[2] if found and not found[1] else ""
            if pattern and any(len(mode.signs) == len(pattern) for mode in modes):
                raise InputError(
                    f"this machine has no {called} {word!r}; it has {', '.join(modes[:_NAMED])}"
                    f"{' …' if len(modes) > _NAMED else ''}"
                )
            article = "an" if called[:1] in "aeiou" else "a"
            raise InputError(f"{word!r} is not {article} {called}; {_wanted(modes)}")
        chosen |= fitting
    return tuple(mode for mode in modes if mode in chosen)


def _fits(mode: Mode, operation: str, pattern: str) -> bool:
    both = bool(mode.operation and mode.signs)
    right = operation == mode.operation or (both and not operation)
    if both and not pattern:
        return right
    return (
        right
        and len(pattern) == len(mode.signs)
        and all(p in {"?", sign} for sign, p in zip(mode.signs, pattern, strict=True))
    )


def _wanted(modes: Sequence[Mode]) -> str:
    example = modes[len(modes) // 2 - 1]
    if not example.signs or example.operation:
        return f"it is one of {', '.join(modes[:40])}"
    return (
        f"write one sign (+, - or ? for either) for each of the {len(example.signs)} limbs, "
        f"as {example}"
    )
