"""Several people at one review: each sees where the others point, and who changes what."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from app.features.together.scene import Pointers
from app.incoming import looks_on
from app.jobs.parts import Client, Part
from app.language import tr
from app.review.changes import Change
from app.review.state import Review
from app.review.view import People, Person
from app.scene import palette
from app.scene.pointer import Pointer
from app.widgets.desk import Sheet
from kinematics.arrays import Array

SAID = 6.0  # s for which it stands what somebody has changed


class TogetherPart(Part):
    """Knows who is here, and shows each the others."""

    def __init__(self, stage: Any) -> None:
        super().__init__(stage)
        self._people: dict[int, Person] = {}  # by their browsers
        self._places: dict[int, Array | None] = {}  # where each points
        self._said: dict[int, float] = {}  # until when it stands what each did
        self._pointers: dict[int, Pointers] = {}
        self._came = 0

    def prepare(self) -> None:
        self._pointers = {}  # the scene has been cleared

    def joined(self, client: Client) -> None:
        who = client.client_id
        self._came += 1
        aside = looks_on(self.stage.server, who)
        name, color = tr("together.person", n=self._came), palette.limb_color(self._came)
        self._people[who] = Person(self._came, name, color, aside)
        if aside:
            told = tr("together.looks_on")
            self.stage.run_script(f"document.body.dataset.boAside = {told!r};", client)
        self.late = True

    def left(self) -> None:
        here = self.stage.server.get_clients()
        for who in [who for who in self._people if who not in here]:
            person = self._people.pop(who)
            for known in (self._places, self._said, self._pointers):
                known.pop(who, None)
            for pointers in self._pointers.values():
                pointers.drop(person)
        self.late = True

    def pointed(self, pointer: Pointer) -> None:
        who = None if pointer.client is None else pointer.client.client_id
        if who not in self._people or len(self._people) < 2:
            return
        bars = self.stage.shown().drawing.bars
        self._places[who] = pointer.place(np.array([end for b in bars for end in (b.start, b.end)]))
        self._mark(who)

    def applied(self, change: Change, before: Review, note: str, client: Client) -> None:
        who = None if client is None else client.client_id
        if who not in self._people or len(self._people) < 2:
            return
        self._say(who, change.title(before, self.stage.review))
        self._said[who] = time.monotonic() + SAID

    @property
    def due(self) -> float | None:
        times = [super().due, *(end - time.monotonic() for end in self._said.values())]
        return min((s for s in times if s is not None), default=None)

    def catch_up(self) -> None:
        for who in [who for who, end in self._said.items() if time.monotonic() >= end]:
            del self._said[who]
            self._say(who, "")
        super().catch_up()

    def show(self, sheet: Sheet) -> None:
        self.stage.tell(People(tuple(self._people.values())))

    def _say(self, who: int, did: str) -> None:
        self._people[who] = replace(self._people[who], did=did)
        self._mark(who)
        self.late = True

    def _mark(self, who: int) -> None:
        """Show the others where somebody points, and what they did."""
        for other in self._others(who):
            other.put(self._people[who], self._places.get(who), self.stage.scene.size)

    def _others(self, who: int) -> Iterator[Pointers]:
        for other, client in self.stage.server.get_clients().items():
            if other != who and other in self._people:
                if other not in self._pointers:
                    self._pointers[other] = Pointers(client)
                yield self._pointers[other]
