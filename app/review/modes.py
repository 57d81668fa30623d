"""Working modes as people write them, on the command line and on the page."""

from __future__ import annotations

import re

from kinematics.errors import InputError


def page_mode(mode: str) -> str:
    """A working mode with a minus sign as long as the plus."""
    return mode.replace("-", "−")


def signed(known: tuple[str, ...]) -> bool:
    """Whether a mechanism's modes are signs, one a limb."""
    return any(known) and set("".join(known)) <= {"+", "-"}


def matching(text: str, known: tuple[str, ...], noun: str = "working mode") -> tuple[str, ...]:
    """The modes of a mechanism that fit what was typed, in the mechanism's order.

    Args:
        text: modes or patterns with commas or blanks between them, "+-?++, −−+++"; ? stands for
            either sign, and a minus may be typed as any of - − –.
        known: all modes of the mechanism.
        noun: what the mechanism calls them.

    Raises:
        InputError: a word fits no mode; the message says what is wanted.
    """
    chosen: set[str] = set()
    for word in re.split(r"[,;\s]+", text.strip()):
        pattern = word.replace("−", "-").replace("–", "-")
        fitting = {mode for mode in known if _fits(mode, pattern)}
        if not fitting:
            article = "an" if noun[:1] in "aeiou" else "a"
            raise InputError(f"{word!r} is not {article} {noun}; {_wanted(known)}")
        chosen |= fitting
    return tuple(mode for mode in known if mode in chosen)


def _fits(mode: str, pattern: str) -> bool:
    return len(mode) == len(pattern) and all(
        p in {"?", sign} for sign, p in zip(mode, pattern, strict=True)
    )


def _wanted(known: tuple[str, ...]) -> str:
    if not signed(known):
        return f"it is one of {', '.join(known)}"
    return (
        f"write one sign (+, - or ? for either) for each of the {len(known[0])} limbs, "
        f"as {known[len(known) // 2 - 1]}"
    )
