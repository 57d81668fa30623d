"""The command palette, and the keys that do the same."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, cast

from app.widgets.desk import Command, Desk, safely


def add_hotkeys(desk: Desk, commands: Iterable[Command]) -> None:
    """Add every command."""
    for each in commands:
        *control, key = each.key.split("+")
        command = desk.gui.add_command(
            each.label,
            description=each.description,
            hotkey=cast(Any, key),
            modifier="cmd/ctrl" if control else None,
        )

        def triggered(_: object, act: Callable[[], None] = each.act) -> None:
            safely(desk, None, act)

        command.on_trigger(triggered)
