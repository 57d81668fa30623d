"""The machine on the page: dragged by its handle, and gliding to another solution."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from app.features.move.compute import REACH, reach_asked
from app.features.move.state import Place, Visit
from app.jobs.answers import Asked
from app.jobs.parts import Client, Grip, Part
from app.review.changes import Change
from app.review.state import Review
from app.review.view import Reach, View
from app.scene.machine import HANDLE
from app.scene.morph import Morph
from app.scene.nodes import transform
from app.scene.pointer import Pointer
from app.widgets.desk import Sheet
from kinematics.arrays import Array

CLOSE = 1.6  # of the handle's size: a pointer that is nearer may want it
FRAME = 0.02  # s between two pictures on the way to another solution


class MovePart(Part):
    """Takes what a hand does to the platform, and shows the way to another solution."""

    LANES = ("reach",)

    def __init__(self, stage: Any) -> None:
        super().__init__(stage)
        self._grip = Grip()
        self._from: View | None = None  # where a visit was begun
        self._morph: Morph | None = None
        self._near: dict[int, bool] = {}  # in which browsers the handle is wanted

    def prepare(self) -> None:
        self._grip = Grip()
        scene = self.stage.scene
        scene.dragged(
            scene.handle,
            lambda phase, who, handle: self.stage.ask(self.drag, phase, who, transform(handle)),
        )

    def wished(self, view: View) -> Iterable[Asked[Any]]:
        yield reach_asked(view.review)

    def show(self, sheet: Sheet) -> None:
        told = self.answers[REACH]
        self.stage.tell(Reach(told.shown or (), told.stale))

    def pointed(self, pointer: Pointer) -> None:
        """The handle is there while the first tab is open, or somebody's pointer is near it."""
        place = self.stage.shown().platform[:3, 3]
        reach = pointer.length(CLOSE * HANDLE * self.stage.scene.size, place)
        near = pointer.tab <= 0 or float(pointer.distances(place[None])[0]) <= reach
        there = {client.client_id for client in self.stage.server.get_clients().values()}
        self._near = {who: at for who, at in self._near.items() if who in there}
        if pointer.client is not None:
            self._near[pointer.client.client_id] = near
        self.stage.scene.approach(any(self._near.values()))

    def drag(self, phase: str, client_id: int | None, placed: Array) -> bool:
        """A hand holds the platform, (4, 4), or lets it go."""
        moved = self._grip.take(phase, client_id)
        self.stage.scene.held = self._grip.held
        if not moved:
            self.stage.scene.release_handle()
            return True
        if not np.isfinite(placed).all():
            return False
        review = self.stage.review
        pose = review.machine.pose_from_transform(placed, review.mode)
        return self.stage.apply(Place(pose, held=self._grip.number), None)

    # --- the way to another solution

    def applied(self, change: Change, before: Review, note: str, client: Client) -> None:
        self._from = self._morph = None
        if isinstance(change, Visit) and before.design == self.stage.view.review.design:
            self._from = self.stage.shown()

    def follow(self) -> None:
        super().follow()
        view = self.stage.view
        if self._from is not None:
            self._morph = Morph(self._from, view, time.monotonic())
            self._from = None
        elif self._morph is not None and self._morph.after.review.pose != view.review.pose:
            self._morph = None  # somebody moved it on

    def shown(self, view: View) -> View:
        if self._morph is None:
            return view
        return replace(self._morph, after=view).at(time.monotonic())

    @property
    def due(self) -> float | None:
        return super().due if self._morph is None else FRAME

    def catch_up(self) -> None:
        super().catch_up()
        if self._morph is None:
            return
        with self.stage.server.atomic():
            self.stage.show_machine()
        self.stage.server.flush()
        if self._morph.over(time.monotonic()):
            self._morph = None
