"""The map on the page: swept on all cores beside the loop, coarse first, drawn as it comes."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from app.features.map.files import map_bytes
from app.features.map.state import Chart, Span
from app.features.review.files import ExportedFile, solid_name
from app.features.workspace.state import solver_modes
from app.jobs.executors import Workers, local_workers
from app.jobs.parts import Stage
from app.jobs.worker import LaneName
from app.review.changes import Change
from app.review.requests import SaveMap, StartMap, StopMap
from app.review.state import Review
from app.widgets.desk import Charted
from kinematics.answers.sections import MapCells
from kinematics.arrays import Array, Ints
from kinematics.errors import BohemiaError, ComputationError
from kinematics.facets.map_sweeps import Map, MapRequest, OnCells, map_request, sweep

if TYPE_CHECKING:
    import viser

PAUSE = 0.35  # s between two pictures of a map that is being computed
SHARE = 4.0  # and so many times as long as a picture takes
TICK = 0.5  # s between two looks at the clock while nothing comes
MEDIA_TYPES = {
    "csv": "text/csv",
    "npz": "application/octet-stream",
    "png": "image/png",
    "svg": "image/svg+xml",
}


@dataclass(frozen=True, eq=False, slots=True)
class Came:
    """Some points of a map."""

    run: int
    indices: Ints
    cells: MapCells


@dataclass(frozen=True, slots=True)
class Ended:
    """A map is whole, or was given up; ``text`` is for the user."""

    run: int
    text: str


class _Known:
    """What is known of a map of one quantity."""

    def __init__(self, request: MapRequest) -> None:
        self.request = request
        self.values: Array = np.full(request.shape, np.nan)
        self.errors: Array = np.full(request.shape, np.nan)
        self.done: NDArray[np.bool_] = np.zeros(request.shape, dtype=bool)

    def take(self, indices: Ints, cells: MapCells) -> None:
        self.values.flat[indices] = cells.values[:, 0]
        self.errors.flat[indices] = cells.errors[:, 0]
        self.done.flat[indices] = True

    def map(self) -> Map:
        return Map(
            self.request, self.values[None].copy(), self.errors[None].copy(), self.done.copy()
        )


class Mapping:
    """One map at a time is computed; those of the same workspaces are kept, newest last."""

    lanes: tuple[LaneName, ...] = ()

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._pool = _Pool()
        self._run = 0  # the number of the newest map
        self._running: MapRequest | None = None
        self._begun = 0.0
        self._kept: list[_Known] = []
        self._trouble = ""
        self._late = False
        self._from = 0.0

    @property
    def late(self) -> bool:
        return self._late

    def start(self) -> None:
        pass

    def stop(self) -> None:
        self._run += 1
        self._pool.close()

    def cancel(self, lane: LaneName) -> None:
        self._give_up("")

    def prepare(self) -> None:
        pass

    def applied(self, change: Change, before: Review, note: str) -> None:
        pass

    def follow(self) -> None:
        if self._running is not None and not of(self._running, self._stage.view.review):
            self._give_up("")
        self._late, self._from = True, 0.0

    def take(self, item: object) -> bool:
        match item:
            case Came(run, indices, cells) if run == self._run and self._running is not None:
                self._keep(indices, cells)
            case Ended(run, text) if run == self._run and self._running is not None:
                self._running, self._trouble = None, text
                self._late, self._from = True, 0.0
            case StartMap(client):
                self._begin(client)
            case StopMap():
                self._give_up("")
            case SaveMap(kind, client):
                self._save(kind, client)
        return False

    # --- computing

    def _begin(self, client: viser.ClientHandle | None) -> None:
        review = self._stage.view.review
        try:
            request = chart_request(review)
        except BohemiaError as error:
            self._stage.complain(str(error), client)
            return
        self._run += 1
        self._running, self._begun, self._trouble = request, time.monotonic(), ""
        self._late, self._from = True, 0.0
        threading.Thread(
            target=self._sweep, args=(request, self._run), name="map", daemon=True
        ).start()

    def _sweep(self, request: MapRequest, run: int) -> None:
        """Called in a thread of its own."""
        text = ""
        try:
            self._pool.sweep(
                request,
                lambda indices, cells: self._stage.put(Came(run, indices, cells)),
                lambda: run != self._run,
            )
        except BohemiaError as error:
            text = str(error)
        self._stage.put(Ended(run, text))

    def _give_up(self, text: str) -> None:
        if self._running is not None:
            self._run += 1
            self._running, self._trouble = None, text
            self._late, self._from = True, 0.0

    def _keep(self, indices: Ints, cells: MapCells) -> None:
        assert self._running is not None
        if not self._kept or self._kept[-1].request is not self._running:
            self._kept = [known for known in self._kept if beside(known.request, self._running)]
            self._kept.append(_Known(self._running))
        self._kept[-1].take(indices, cells)
        self._late = True

    # --- showing

    def catch_up(self) -> None:
        now = time.monotonic()
        ticking = self._running is not None and now > self._from + TICK
        if not (self._late or ticking) or now < self._from:
            return
        self._late = False
        sheet, charted = self._stage.sheet(), self._charted(now)
        with self._stage.server.atomic():
            for panel in self._stage.panels:
                panel.draw_map(sheet, charted)
        self._stage.server.flush()
        done = time.monotonic()
        self._from = done + max(PAUSE, SHARE * (done - now))

    def _charted(self, now: float) -> Charted:
        known, running = self._known(), self._running
        newest = self._kept[-1] if self._kept else None
        begun = newest is not None and newest.request is running
        return Charted(
            self._blank() if known is None else known.map(),
            None if known is None else known.request,
            known is not None and not of(known.request, self._stage.view.review),
            "" if running is None else running.quantities[0].title,
            float(newest.done.mean()) if begun and newest is not None else 0.0,
            now - self._begun,
            self._trouble,
        )

    def _known(self) -> _Known | None:
        """The map of the chosen quantity; while there is none, the newest one."""
        wanted = self._stage.view.review[Chart].quantity
        chosen = [known for known in self._kept if known.request.quantities[0].key == wanted]
        return next(iter([*chosen, *self._kept[-1:]]), None)

    def _blank(self) -> Map | None:
        """A map to come; None if there can be none."""
        try:
            return _Known(chart_request(self._stage.view.review)).map()
        except BohemiaError:
            return None

    def _save(self, kind: str, client: viser.ClientHandle | None) -> None:
        known = self._known()
        if known is None:
            self._stage.complain("There is no map to save; start one first.", client)
            return
        found = known.map()
        self._stage.apart(client, lambda: self._stage.download(map_file(found, kind), client))


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


def of(request: MapRequest, review: Review) -> bool:
    """Whether a map is of a review's design and working modes."""
    return request.design == review.design and request.modes == solver_modes(review)


def chart_request(review: Review) -> MapRequest:
    """The map that a review asks for.

    Raises:
        InputError: its mechanism has none.
    """
    chart = review[Chart]
    return map_request(
        review.design,
        values(chart.first),
        values(chart.second),
        modes=solver_modes(review),
        quantities=(chart.quantity,),
        pose=review.pose,
    )


def beside(old: MapRequest, new: MapRequest) -> bool:
    """Whether a map is kept beside a new one: another quantity of the same workspaces."""
    return old.quantities != new.quantities and (
        replace(old, quantities=new.quantities, pose=new.pose) == new
    )


def values(span: Span) -> Array:
    """The values of a span (n,)."""
    return np.linspace(span.low, span.high, span.count)


def map_file(found: Map, kind: str) -> ExportedFile:
    """A map as a file."""
    request = found.request
    name = solid_name(request.design, f"map-{request.quantities[0].key}", (), request.modes)
    return ExportedFile(f"{name}.{kind}", map_bytes(found, kind), MEDIA_TYPES[kind])
