"""The trajectory on the page: computed beside the loop, played by it (`playing`)."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from app.features.review.files import ExportedFile, solid_name
from app.features.trajectory import compute
from app.features.trajectory.compute import Asked, Computed, Reach
from app.features.trajectory.files import trajectory_csv
from app.features.trajectory.playing import Playing
from app.features.trajectory.plot import plots_svg
from app.features.trajectory.scene import Trail
from app.features.trajectory.state import STROKE, Plan, SetPlan, missing
from app.jobs.lane import Done, Job, Lane, Lost
from app.jobs.parts import Stage
from app.jobs.worker import LaneName
from app.review.changes import Change
from app.review.requests import Distances, SaveTrajectory, Shortest
from app.review.state import Review
from app.review.view import View
from app.widgets.desk import Moment, Moved
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.trajectories import Fits, duration_within

if TYPE_CHECKING:
    import viser

REST = 0.2  # s for which a trajectory must stay asked for before it is computed
OPENED = 0.7  # s in which a browser has opened or closed the plots, and says how wide it is
FRAME = 1 / 31  # s between two pictures
MEDIA_TYPES = {"csv": "text/csv", "svg": "image/svg+xml"}
QUIET = ""  # the title of work that has a progress bar of its own


class Moving:
    """Keeps the trajectory true to the review, and plays it."""

    lanes: tuple[LaneName, ...] = ("trajectory",)

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._lane = Lane("trajectory", stage.put)
        self._trail = Trail(stage.scene)
        self._late = False
        self._asked: Asked | None = None
        self._computed: Computed | None = None
        self._trouble = ""
        self._distance = np.empty(0)
        self._parts: list[tuple[int, ...]] = []  # that are still to come
        self._given_up = False
        self._fits: Fits | None = None
        self._fits_of: object = None
        self._fit_trouble = ""
        self._reach: tuple[object, Reach] | None = None
        self.playing = Playing(stage)
        self._framed_at = 0.0
        self._fit_at: float | None = None
        self._told: Moment | None = None

    @property
    def late(self) -> bool:
        return self._late or self.playing.waits or self._fit_at is not None

    @property
    def due(self) -> float | None:
        """s until the next picture; None while nothing plays."""
        if not self.playing.player.playing:
            return None
        return max(self._framed_at + FRAME - time.monotonic(), 0.002)

    @property
    def bounds(self) -> tuple[Array, Array] | None:
        """The box around the way of O′, mm; None while there is none."""
        spots = None if self._computed is None else self._computed.spots
        return None if spots is None else (spots.min(axis=0), spots.max(axis=0))

    def start(self) -> None:
        self._lane.start()

    def stop(self) -> None:
        self._lane.stop()

    def cancel(self, lane: LaneName) -> None:
        self._lane.cancel()

    def prepare(self) -> None:
        self._trail.prepare(self._stage.view.drawing.size)
        self._computed = self._reach = self._told = None
        self.playing.forget()
        if self._stage.view.review[Plan].on:  # its window has been closed and is opened again
            self._fit_at = time.monotonic() + OPENED

    # --- what is wanted

    def follow(self) -> None:
        review = self._stage.view.review
        asked = compute.asked(review)
        if asked != self._asked:
            self._asked, self._trouble, self._given_up = asked, "", False
            if asked is None:
                self._computed = None
        self.playing.follow(review, self._computed if self._current else None)
        self._want()
        self._late = True

    @property
    def _current(self) -> bool:
        """What is known is what is asked for."""
        return self._computed is not None and self._computed.asked == self._asked

    def _want(self) -> None:
        review = self._stage.view.review
        jobs: list[Job] = []
        of = self._asked
        if of is not None and not self._current:
            job = Job(("trajectory", of), "the trajectory", compute.compute, (of,), REST)
            jobs.append(job)
        elif of is not None:
            jobs += self._further(of, review)
        if review[Plan].on and review[Plan].way == STROKE:
            plane = _reach_key(review)
            jobs.append(Job(("reach", plane), "the reach", compute.reach, plane))
        self._lane.want(jobs)

    def _further(self, of: Asked, review: Review) -> list[Job]:
        """What is asked once the trajectory is there."""
        computed = self._computed
        assert computed is not None
        jobs: list[Job] = []
        degree = review[Plan].degree
        if degree and self._fits_of != (of, degree):
            key = ("fit", of, degree)
            jobs.append(Job(key, "the polynomials", compute.fitted, (computed, degree), REST))
        if not self._given_up:
            for part in self._parts:
                poses = computed.found.poses[list(part)]
                arguments = (of, poses)
                jobs.append(Job(("distances", of, part), QUIET, compute.distances, arguments))
            if not self._parts and not np.array_equal(
                self._distance, computed.found.distance, equal_nan=True
            ):
                known = replace(computed, found=replace(computed.found, distance=self._distance))
                jobs.append(Job(("judged", of), QUIET, compute.judged, (known,)))
        return jobs

    def applied(self, change: Change, before: Review, note: str) -> None:
        if isinstance(change, SetPlan) and ("on", not before[Plan].on) in change.values:
            self._fit_at = time.monotonic() + OPENED  # the scene has another width then

    # --- what comes

    def take(self, item: object) -> bool:
        match item:
            case Done(Job(("trajectory", Asked() as of)), Computed() as computed):
                if of == self._asked:
                    self._came(computed)
            case Done(Job(("distances", Asked() as of, tuple(part))), np.ndarray() as values):
                if of == self._asked:
                    self._measured(part, values)
            case Done(Job(("judged", Asked() as of)), Computed() as computed):
                if of == self._asked:
                    self._computed, self._late = computed, True
                    self.playing.follow(self._stage.view.review, computed)
                    self._want()
            case Done(Job(("fit", Asked() as of, degree)), Fits() as fits):
                self._fits, self._fits_of, self._fit_trouble = fits, (of, degree), ""
                self._late = True
            case Done(Job(("reach", key)), Reach() as reach):
                self._reach, self._late = (key, reach), True
            case Lost(job, text):
                self._lost(job, text)
            case Distances(on):
                self._given_up = not on
                if not on:
                    self._lane.cancel()
                self._want()
                self._late = True
            case SaveTrajectory(kind, client):
                self._save(kind, client)
            case Shortest(client):
                return self._shorten(client)
            case _:
                return self.playing.take(item)
        return False

    def _came(self, computed: Computed) -> None:
        self._computed, self._trouble, self._late = computed, "", True
        count = len(computed.found.times)
        self._distance = np.full(count, np.nan)
        self._parts = compute.parts(count)
        self.playing.follow(self._stage.view.review, computed)
        self._want()

    def _measured(self, part: tuple[int, ...], values: Array) -> None:
        self._distance = self._distance.copy()
        self._distance[list(part)] = values
        self._parts = [each for each in self._parts if each != part]
        self._late = True
        if not self._parts:
            self._want()

    def _lost(self, job: Job, text: str) -> None:
        match job.key:
            case ("trajectory", of) if of == self._asked:
                self._computed, self._late = None, True
                self._trouble = text or "It was given up; change something to try again."
            case ("fit", of, degree):
                self._fits, self._fits_of, self._late = None, (of, degree), True
                self._fit_trouble = text or "It was given up."
            case ("distances" | "judged", of, *_) if of == self._asked:
                self._given_up, self._late = True, True
                if text:
                    self._stage.complain(text)
                self._want()

    # --- the person's hand on it

    def _shorten(self, client: viser.ClientHandle | None) -> bool:
        computed, plan = self._computed, self._stage.view.review[Plan]
        if computed is None or not self._current:
            return False
        if not (plan.rates or plan.accelerations):
            self._stage.complain("Give limits of rates or accelerations first.", client)
            return False
        try:
            duration = rounded_up(duration_within(computed.found, plan.limits))
        except InputError as error:
            self._stage.complain(str(error), client)
            return False
        machine = computed.law.kind
        values: tuple[tuple[str, object], ...] = (("duration", duration), ("law", machine))
        if plan.law == "trapezoidal":
            length, old = computed.path.length, computed.law
            top = length / duration / (1.0 - old.ramp)
            values = (("speed", top), ("acceleration", top / (old.ramp * duration)))
        return self._stage.apply(SetPlan(values), client)

    # --- what is shown

    def shown(self, view: View) -> View:
        """The view with the machine where it is on its trajectory; the same if it is not."""
        return self.playing.shown(view)

    def catch_up(self) -> None:
        now = time.monotonic()
        self.playing.catch_up(now)
        if self._fit_at is not None and now >= self._fit_at:
            self._fit_at = None
            self._stage.put("fit")
        playing = self.playing.player.playing and now - self._framed_at >= FRAME
        if self._late or self.playing.late or playing:
            self._show(now)

    def _show(self, now: float) -> None:
        late = self._late or self.playing.late
        self._late = self.playing.late = False
        self._framed_at = now
        computed, away = self._computed, self.playing.away
        view = self.shown(self._stage.view)
        sheet = replace(self._stage.sheet(), view=view)
        at = self.playing.player.at(now)
        there = away or self.playing.stands_at(at)
        playing = self.playing.player.playing
        moment = Moment(at, playing, away, self._nearest(at), there)
        with self._stage.server.atomic():
            self._stage.scene.veil(away)
            if away:
                self._stage.scene.show(view, dragging=False)
            if late:
                self._trail.show(computed)
                for panel in self._stage.panels:
                    panel.draw_trajectory(sheet, self._moved())
            for panel in self._stage.panels:
                panel.draw_moment(sheet, moment)
        self._stage.server.flush()
        if self._told is not None and self._told.away and not away:
            self._stage.put("redraw")  # the machine is where the review has it again
        self._told = moment

    def _nearest(self, at: float) -> float:
        """mm to a singularity at a time, between the samples that are known."""
        computed = self._computed
        if computed is None or not self._current or not len(self._distance):
            return float("nan")
        found = replace(computed.found, distance=self._distance)
        times, distances = compute.known_distances(found)
        return float(np.interp(at, times, distances)) if len(times) else float("nan")

    def _moved(self) -> Moved:
        review, computed = self._stage.view.review, self._computed
        if computed is not None and self._current:
            found = replace(computed.found, distance=self._distance)
            computed = replace(computed, found=found)
        count = max(len(self._distance), 1)
        left = sum(map(len, self._parts))
        wanted = (self._asked, review[Plan].degree)
        reach = None
        if self._reach is not None and self._reach[0] == _reach_key(review):
            reach = self._reach[1]
        return Moved(
            computed,
            not self._current,
            missing(review[Plan]),
            1.0 - left / count,
            not self._given_up and bool(left),
            self._fits if self._fits_of == wanted else None,
            self._fit_trouble if self._fits_of == wanted else "",
            reach,
            self._trouble,
        )

    def _save(self, kind: str, client: viser.ClientHandle | None) -> None:
        computed = self._computed
        if computed is None or not self._current:
            self._stage.complain("There is no trajectory to save yet.", client)
            return
        of, review = computed.asked, self._stage.view.review
        axes = of.machine.coordinates
        joints = of.machine.joints
        found = replace(computed.found, distance=self._distance)
        if kind == "csv":
            data = trajectory_csv(found, axes, joints)
        else:
            title = of.design.title or of.design.name
            data = plots_svg(replace(computed, found=found), review[Plan].plot, title)
        name = solid_name(of.design, "trajectory", (), (of.mode,) if of.mode else None)
        file = ExportedFile(f"{name}.{kind}", data.encode(), MEDIA_TYPES[kind])
        self._stage.apart(client, lambda: self._stage.download(file, client))


def rounded_up(value: float) -> float:
    """A positive number to six digits and never less, so that what is at a limit is not beyond it
    by rounding.
    """
    digit = 10.0 ** (math.floor(math.log10(value)) - 5)
    return float(f"{math.ceil(value * (1.0 + 1e-9) / digit) * digit:.6g}")


def _reach_key(
    review: Review,
) -> tuple[object, tuple[float, ...], str, tuple[int, int], int | None]:
    """All that the reach in the plane of a stroke depends on."""
    plane = compute.drawn_axes(review)
    held = tuple(0.0 if n in plane else v for n, v in enumerate(review.pose))
    return review.design, held, review.mode, plane, review.dependent
