"""Where the others point, in the scene of one browser alone."""

from __future__ import annotations

from typing import Any

from app.review.view import Person
from app.scene import palette
from app.scene.nodes import LABEL
from kinematics.arrays import Array

DOT = 0.012  # of the machine's size


class Pointers:
    """A dot and a name for each of the others, by their numbers."""

    def __init__(self, client: Any) -> None:
        self._scene = client.scene
        self._marks: dict[int, tuple[Any, Any]] = {}

    def put(self, person: Person, place: Array | None, size: float) -> None:
        """Show where somebody points, (3,) mm; None: not into the scene."""
        marks = self._marks.get(person.number)
        if place is None:
            for mark in marks or ():
                mark.visible = False
            return
        if marks is None:
            marks = self._marks[person.number] = self._made(person)
        marks[0].scale = DOT * size
        for mark in marks:
            mark.position = tuple(place.tolist())
            mark.visible = True
        if marks[1].text != person.text:
            marks[1].text = person.text

    def drop(self, person: Person) -> None:
        """Somebody has gone."""
        for mark in self._marks.pop(person.number, ()):
            mark.remove()

    def _made(self, person: Person) -> tuple[Any, Any]:
        name, color = f"/people/{person.number}", palette.rgb(person.color)
        dot = self._scene.add_icosphere(f"{name}/dot", radius=1.0, color=color)
        label = self._scene.add_label(
            f"{name}/name", person.text, anchor="bottom-left", font_screen_scale=LABEL
        )
        return dot, label
