"""Modes as people write them, on the command line and on the page."""

from __future__ import annotations

from collections.abc import Sequence

from kinematics.answers import modes
from kinematics.answers.modes import Mode


def page_mode(mode: str) -> str:
    """A mode with minus signs as long as plus signs."""
    return mode.replace("-", "−")


def signed(known: Sequence[str]) -> bool:
    """Whether a mechanism's modes are signs, one a limb, and nothing else."""
    return modes.noun(known) == "working mode"


def matching(text: str, known: Sequence[str], noun: str = "") -> tuple[Mode, ...]:
    """The modes of a mechanism that fit what was typed, see `kinematics.answers.modes.matching`.

    Raises:
        InputError: a word fits no mode; the message says what is wanted.
    """
    return modes.matching(text, known, noun)
