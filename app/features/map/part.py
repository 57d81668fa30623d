"""The map on the page: swept on all cores beside the loop, coarse first, drawn as it comes."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from typing import Any

from app.features.map.compute import MAP, Charted, Known, chart_request, key_of, of, same_places
from app.features.map.files import map_bytes
from app.features.review.files import ExportedFile, solid_name
from app.jobs.answers import Asked
from app.jobs.executors import Workers, local_workers
from app.jobs.parts import Client, Part, Stage
from app.language import tr
from app.review.view import View
from app.widgets.desk import Sheet
from kinematics.answers.sections import MapCells
from kinematics.arrays import Ints
from kinematics.errors import BohemiaError, ComputationError
from kinematics.facets.map_sweeps import Map, MapRequest, OnCells, sweep

PAUSE = 0.35  # s between two pictures of a map that is being computed
SHARE = 4.0  # and so many times as long as a picture takes
TICK = 0.5  # s between two looks at the clock while nothing comes


class MapPart(Part):
    """One map at a time is computed; those of the same workspaces are kept."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._pool = _Pool()
        self._run = 0  # the number of the newest map
        self._running: Known | None = None
        self._key: tuple[object, ...] = ()  # what it will answer
        self._last: MapRequest | None = None  # of which something is known
        self._begun = 0.0
        self._trouble = ""
        self._from = 0.0

    def stop(self) -> None:
        self._run += 1
        self._pool.close()

    def wished(self, view: View) -> Iterable[Asked[Any]]:
        if view.review.machine.map_spec is not None:
            yield MAP(key_of(view.review), idle=True)

    def follow(self) -> None:
        super().follow()
        review = self.stage.view.review
        if self._running is not None and not of(self._running.request, review):
            self.give_up()
        self._from = 0.0

    # --- computing

    def begin(self, client: Client = None) -> None:
        """Compute the map that is chosen."""
        review = self.stage.view.review
        try:
            request = chart_request(review)
        except BohemiaError as error:
            self.stage.complain(str(error), client)
            return
        self._run += 1
        self._running, self._key = Known(request), key_of(review)
        self._begun, self._trouble = time.monotonic(), ""
        self.late, self._from = True, 0.0
        threading.Thread(
            target=self._sweep, args=(request, self._run), name="map", daemon=True
        ).start()

    def _sweep(self, request: MapRequest, run: int) -> None:
        """Called in a thread of its own."""
        text = ""
        try:
            self._pool.sweep(
                request,
                lambda indices, cells: self.stage.ask(self._came, run, indices, cells),
                lambda: run != self._run,
            )
        except BohemiaError as error:
            text = str(error)
        self.stage.ask(self._ended, run, text)

    def _came(self, run: int, indices: Ints, cells: MapCells) -> None:
        """Some points of the map are there."""
        known = self._running
        if run != self._run or known is None:
            return
        if self._last is not known.request:
            if self._last is not None and not same_places(self._last, known.request):
                self.answers.forget(MAP)
            self._last = known.request
        known.take(indices, cells)
        self.answers.put(MAP, self._key, known)
        self.late = True

    def _ended(self, run: int, text: str) -> None:
        """The map is whole, or was given up; ``text`` is for the user."""
        if run == self._run and self._running is not None:
            self._running, self._trouble = None, text
            self.late, self._from = True, 0.0

    def give_up(self) -> None:
        """Give up the map that is being computed."""
        self._ended(self._run, "")
        self._run += 1

    # --- showing

    @property
    def due(self) -> float | None:
        if self._running is None and not self.late:
            return None
        at = self._from if self.late else self._from + TICK
        return max(at - time.monotonic(), 0.0)

    def catch_up(self) -> None:
        now = time.monotonic()
        self.late |= self._running is not None and now > self._from + TICK
        if not self.late or now < self._from:
            return
        super().catch_up()
        done = time.monotonic()
        self._from = done + max(PAUSE, SHARE * (done - now))

    def show(self, sheet: Sheet) -> None:
        if sheet.view.review.machine.map_spec is None:
            return
        review, running = sheet.view.review, self._running
        known = self.answers[MAP].shown
        stale = known is not None and not of(known.request, review)
        self.stage.tell(
            Charted(
                Known(chart_request(review)).map() if known is None else known.map(),
                None if known is None else known.request,
                stale,
                "" if running is None else running.request.quantities[0].title,
                0.0 if running is None else float(running.done.mean()),
                time.monotonic() - self._begun,
                self._trouble,
            )
        )

    def save_map(self, kind: str, client: Client = None) -> None:
        """Save the map that is shown as a file of this kind."""
        known = self.answers[MAP].shown
        found = None if known is None else known.map()
        missing = tr("map.none_to_save")
        self.save(found, lambda found: map_file(found, kind), client, missing)


class _Pool:
    """Processes for maps, started for the first one and kept warm for the next."""

    def __init__(self) -> None:
        self._one = threading.Lock()
        self._stack = ExitStack()
        self._workers: Workers | None = None

    def sweep(self, request: MapRequest, on_cells: OnCells, cancelled: Callable[[], bool]) -> None:
        """One map at a time; one that was cancelled meanwhile is not begun."""
        with self._one:
            if cancelled():
                return
            if self._workers is None:
                self._workers = self._stack.enter_context(local_workers())
            try:
                sweep(
                    request,
                    self._workers.executor,
                    in_flight=self._workers.count + 1,
                    on_cells=on_cells,
                    cancelled=cancelled,
                )
            except ComputationError:
                self._workers = None  # they may be dead; the next map gets new ones
                self._stack.close()
                raise

    def close(self) -> None:
        self._stack.close()


def map_file(found: Map, kind: str) -> ExportedFile:
    """A map as a file."""
    request = found.request
    name = solid_name(request.design, f"map-{request.quantities[0].key}", (), request.modes)
    return ExportedFile(f"{name}.{kind}", map_bytes(found, kind))
