"""The command palette, and the keys that do the same."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from app.features.move.state import GoHome
from app.features.section.state import Cut, ShowCut
from app.features.solutions.state import Atlas, SetAtlas
from app.features.trajectory.state import Plan, SetPlan
from app.features.workspace.state import Show, Workspace
from app.review.changes import SetOption
from app.review.requests import Play
from app.review.state import Options, Review
from app.widgets.desk import Desk, safely


def add_hotkeys(desk: Desk, present: Callable[[], Review]) -> None:
    """Add every command; ``present`` gives the review at the time at which one is used."""

    def toggled(name: str) -> Callable[[], None]:
        return lambda: desk.send(SetOption(name, not getattr(present()[Options], name)))

    commands: tuple[tuple[str, str, str, Callable[[], None]], ...] = (
        ("Undo", "Take back the last change", "ctrl+Z", desk.undo),
        ("Redo", "Do it again", "ctrl+Y", desk.redo),
        ("Fit the view", "Show the machine and its solids whole", "F", desk.fit_view),
        ("Home position", "The design's home pose", "H", lambda: desk.send(GoHome())),
        ("Labels", "Show or hide the joints' names", "L", toggled("labels")),
        ("Axes e₁ and e₂", "Show or hide them", "E", toggled("axes")),
        ("Machine", "Show or hide it", "M", toggled("machine")),
        (
            "Workspace",
            "Show or hide the workspace solid",
            "W",
            lambda: desk.send(Show("workspace", present()[Workspace].shown("workspace") is None)),
        ),
        (
            "Aspects",
            "Show or hide the aspects of the present mode",
            "A",
            lambda: desk.send(Show("aspects", present()[Workspace].shown("aspects") is None)),
        ),
        (
            "Section",
            "Show or hide the section of the workspace",
            "X",
            lambda: desk.send(ShowCut(not present()[Cut].on)),
        ),
        (
            "Trajectory",
            "Show or hide the trajectory and its plots",
            "T",
            lambda: desk.send(SetPlan((("on", not present()[Plan].on),))),
        ),
        ("Play", "Play the trajectory, or pause", "P", lambda: desk.ask(Play())),
        (
            "Ghosts",
            "Show or hide the platform in all other solutions",
            "G",
            lambda: desk.send(SetAtlas("ghosts", not present()[Atlas].ghosts)),
        ),
    )
    for label, description, hotkey, act in commands:
        *control, key = hotkey.split("+")
        command = desk.gui.add_command(
            label,
            description=description,
            hotkey=cast(Any, key),
            modifier="cmd/ctrl" if control else None,
        )

        def triggered(_: object, act: Callable[[], None] = act) -> None:
            safely(desk, None, act)

        command.on_trigger(triggered)
