"""The trajectory on the page: computed beside the loop, played by it.

While it plays, only pictures of the machine change; the review stays where it is until a person
stops the machine on its way.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from app import compute, trajectory
from app.changes import Change, Place, SetPlan
from app.compute import View
from app.exporting import ExportedFile, solid_name
from app.lane import Done, Job, Lane, Lost
from app.panels.desk import Moment, Moved
from app.panels.trajectory_plot import plots_svg
from app.parts import Stage
from app.plan import STROKE, missing
from app.player import Player
from app.requests import (
    Distances,
    LeaveWay,
    NextWarning,
    Play,
    SaveTrajectory,
    Scrub,
    Shortest,
    StopHere,
)
from app.state import Review, within
from app.trail import Trail
from app.trajectory import Asked, Computed, Reach
from app.trajectory_files import trajectory_csv
from app.worker import LaneName
from kinematics.errors import InputError
from kinematics.spatial import Array
from kinematics.trajectories import Fits, duration_within

if TYPE_CHECKING:
    import viser

REST = 0.2  # s for which a trajectory must stay asked for before it is computed
SETTLED = 0.5  # s for which a hand must rest on the scrub bar before the machine is put there
OPENED = 0.7  # s in which a browser has opened or closed the plots, and says how wide it is
FRAME = 1 / 31  # s between two pictures
SAME = 1e-6  # mm and rad: poses that are one
MEDIA_TYPES = {"csv": "text/csv", "svg": "image/svg+xml"}
QUIET = ""  # the title of work that has a progress bar of its own


@dataclass(frozen=True, slots=True)
class _Rested:
    """A hand has come to rest on the scrub bar."""

    client: viser.ClientHandle | None


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
        self._player = Player(1.0)
        self._away = False
        self._stands: tuple[object, ...] = ()
        self._settle_at: float | None = None
        self._settler: viser.ClientHandle | None = None
        self._framed_at = 0.0
        self._fit_at: float | None = None
        self._told: Moment | None = None
        self._played_to = 0.0  # s of the trajectory, in the last picture

    @property
    def late(self) -> bool:
        waits = self._settle_at is not None or self._fit_at is not None
        return self._late or self._player.playing or waits

    @property
    def due(self) -> float | None:
        """s until the next picture; None while nothing plays."""
        if not self._player.playing:
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
        self._player = Player(1.0)
        self._leave()
        if self._stage.view.review.plan.on:  # its window has been closed and is opened again
            self._fit_at = time.monotonic() + OPENED

    # --- what is wanted

    def follow(self) -> None:
        review = self._stage.view.review
        stands = review.design, review.pose, review.mode
        if stands != self._stands:  # whoever moved the machine has it
            self._stands = stands
            self._leave()
        asked = trajectory.asked(review)
        if asked != self._asked:
            self._asked, self._trouble, self._given_up = asked, "", False
            self._leave()
            self._player = self._player.to(0.0)
            if asked is None:
                self._computed = None
        now = time.monotonic()
        self._player = self._player.paced(review.plan.playback, review.plan.pace, now)
        self._want()
        self._late = True

    def _leave(self) -> None:
        """The machine is shown where the review has it: at the start, if it is not on its way."""
        self._player = self._player.pause(time.monotonic())
        self._away, self._settle_at = False, None
        if not self._stands_at(self._player.at(time.monotonic())):
            self._player = self._player.to(0.0)

    def _stands_at(self, at: float) -> bool:
        """Whether the review has the machine where the trajectory has it at a time."""
        computed = self._computed
        if computed is None or not self._current:
            return False
        review = self._stage.view.review
        there = np.subtract(computed.pose_at(at), review.pose)
        return computed.asked.mode == review.mode and bool(np.abs(there).max() <= SAME)

    @property
    def _current(self) -> bool:
        """What is known is what is asked for."""
        return self._computed is not None and self._computed.asked == self._asked

    def _want(self) -> None:
        review = self._stage.view.review
        jobs: list[Job] = []
        of = self._asked
        if of is not None and not self._current:
            job = Job(("trajectory", of), "the trajectory", trajectory.compute, (of,), REST)
            jobs.append(job)
        elif of is not None:
            jobs += self._further(of, review)
        if review.plan.on and review.plan.way == STROKE:
            plane = _reach_key(review)
            jobs.append(Job(("reach", plane), "the reach", trajectory.reach, plane))
        self._lane.want(jobs)

    def _further(self, of: Asked, review: Review) -> list[Job]:
        """What is asked once the trajectory is there."""
        computed = self._computed
        assert computed is not None
        jobs: list[Job] = []
        degree = review.plan.degree
        if degree and self._fits_of != (of, degree):
            key = ("fit", of, degree)
            jobs.append(Job(key, "the polynomials", trajectory.fitted, (computed, degree), REST))
        if not self._given_up:
            for part in self._parts:
                poses = computed.found.poses[list(part)]
                arguments = (of, poses)
                jobs.append(Job(("distances", of, part), QUIET, trajectory.distances, arguments))
            if not self._parts and not np.array_equal(
                self._distance, computed.found.distance, equal_nan=True
            ):
                known = replace(computed, found=replace(computed.found, distance=self._distance))
                jobs.append(Job(("judged", of), QUIET, trajectory.judged, (known,)))
        return jobs

    def applied(self, change: Change, before: Review, note: str) -> None:
        if isinstance(change, SetPlan) and ("on", not before.plan.on) in change.values:
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
                return self._played(item)
        return False

    def _played(self, item: object) -> bool:
        now = time.monotonic()
        match item:
            case Play(on):
                if self._computed is None or not self._current:
                    self._stage.complain("There is no trajectory to play yet.")
                    return False
                on = not self._player.playing if on is None else on
                self._player = self._player.play(now) if on else self._player.pause(now)
                self._played_to = self._player.at(now)
                self._away, self._settle_at, self._late = True, None, True
            case Scrub(at, client):
                self._scrub(at, client)
            case NextWarning(client):
                self._to_warning(now, client)
            case StopHere(client):
                return self._settle(client, asked=True)
            case _Rested(client):
                return self._settle(client, asked=False)
            case LeaveWay():
                self._leave()
                self._late = True
                return True
        return False

    def _came(self, computed: Computed) -> None:
        self._computed, self._trouble, self._late = computed, "", True
        count = len(computed.found.times)
        self._distance = np.full(count, np.nan)
        self._parts = trajectory.parts(count)
        plan = self._stage.view.review.plan
        self._player = Player(computed.law.duration, plan.playback, plan.pace)
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

    def _scrub(self, at: float, client: viser.ClientHandle | None) -> None:
        if self._computed is None or not self._current or not np.isfinite(at):
            return
        self._player = self._player.to(at)
        self._away, self._late = True, True
        self._settle_at, self._settler = time.monotonic() + SETTLED, client

    def _to_warning(self, now: float, client: viser.ClientHandle | None) -> None:
        computed = self._computed
        events = () if computed is None or not self._current else computed.found.events
        if not events:
            self._stage.complain("Nothing is wrong on the way, as far as it is known.", client)
            return
        at = self._player.at(now)
        later = [e.start for e in events if e.start > at + 1e-9]
        self._scrub(later[0] if later else events[0].start, client)

    def _settle(self, client: viser.ClientHandle | None, *, asked: bool) -> bool:
        """Put the machine where it is shown; one step of undo.

        Not where its sliders do not reach: that is told if it was ``asked`` for.
        """
        self._settle_at = None
        computed, review = self._computed, self._stage.view.review
        if computed is None or not self._away:
            return False
        now = time.monotonic()
        self._player = self._player.pause(now)
        pose = computed.pose_at(self._player.at(now))
        axes = review.mechanism.pose_coordinates(review.design)
        notes = [within(c, v)[1] for c, v in zip(axes, pose, strict=True)]
        if any(notes):  # elsewhere than on the way it would be of no use
            if asked:
                told = " ".join(note for note in notes if note)
                self._stage.complain(f"The machine cannot be put there: {told}", client)
            self._late = True
            return False
        self._away = False
        return self._stage.apply(Place(pose, gesture=""), client)

    def _shorten(self, client: viser.ClientHandle | None) -> bool:
        computed, plan = self._computed, self._stage.view.review.plan
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
        kind = computed.law.kind
        values: tuple[tuple[str, object], ...] = (("duration", duration), ("law", kind))
        if plan.law == "trapezoidal":
            length, old = computed.path.length, computed.law
            top = length / duration / (1.0 - old.ramp)
            values = (("speed", top), ("acceleration", top / (old.ramp * duration)))
        return self._stage.apply(SetPlan(values), client)

    # --- what is shown

    def shown(self, view: View) -> View:
        """The view with the machine where it is on its trajectory; the same if it is not."""
        computed = self._computed
        if not self._away or computed is None:
            return view
        at = self._player.at(time.monotonic())
        return on_the_way(view, computed.pose_at(at), at, computed.law.duration)

    def catch_up(self) -> None:
        now = time.monotonic()
        if self._settle_at is not None and now >= self._settle_at:
            self._settle_at = None
            self._stage.put(_Rested(self._settler))
        if self._fit_at is not None and now >= self._fit_at:
            self._fit_at = None
            self._stage.put("fit")
        if self._player.over(now):
            self._player, self._late = self._player.to(self._player.duration), True
        self._halt(now)
        if self._late or (self._player.playing and now - self._framed_at >= FRAME):
            self._show(now)

    def _halt(self, now: float) -> None:
        """Stop at a singularity that has been passed since the last picture."""
        if not self._player.playing:
            return
        before, at = self._played_to, self._player.at(now)
        self._played_to = at
        computed = self._computed
        if computed is None or not self._current or not self._stage.view.review.plan.halt:
            return
        low, high = min(before, at), max(before, at)
        if high - low > 0.5 * computed.law.duration:
            return  # it has begun again
        met = [
            time
            for event in computed.found.events
            for time in {event.start, event.end}
            if event.kind == "singularity" and low < time <= high
        ]
        if met:
            self._played_to = min(met) if at > before else max(met)
            self._player, self._late = self._player.halted(self._played_to, now), True
            self._stage.complain(
                f"Stopped at {self._played_to:.3f} s: the platform is not held there. Play goes on."
            )

    def _show(self, now: float) -> None:
        late, self._late = self._late, False
        self._framed_at = now
        computed = self._computed
        view = self.shown(self._stage.view)
        sheet = replace(self._stage.sheet(), view=view)
        at = self._player.at(now)
        there = self._away or self._stands_at(at)
        moment = Moment(at, self._player.playing, self._away, self._nearest(now), there)
        with self._stage.server.atomic():
            self._stage.scene.veil(self._away)
            if self._away:
                self._stage.scene.show(view, dragging=False)
            if late:
                self._trail.show(computed)
                for panel in self._stage.panels:
                    panel.draw_trajectory(sheet, self._moved())
            for panel in self._stage.panels:
                panel.draw_moment(sheet, moment)
        self._stage.server.flush()
        if self._told is not None and self._told.away and not self._away:
            self._stage.put("redraw")  # the machine is where the review has it again
        self._told = moment

    def _nearest(self, now: float) -> float:
        """mm to a singularity at the present moment, between the samples that are known."""
        computed = self._computed
        if computed is None or not self._current or not len(self._distance):
            return float("nan")
        known = np.isfinite(self._distance)
        if not known.any():
            return float("nan")
        times = computed.found.times
        at = self._player.at(now)
        return float(np.interp(at, times[known], self._distance[known]))

    def _moved(self) -> Moved:
        review, computed = self._stage.view.review, self._computed
        if computed is not None and self._current:
            found = replace(computed.found, distance=self._distance)
            computed = replace(computed, found=found)
        count = max(len(self._distance), 1)
        left = sum(map(len, self._parts))
        wanted = (self._asked, review.plan.degree)
        reach = None
        if self._reach is not None and self._reach[0] == _reach_key(review):
            reach = self._reach[1]
        return Moved(
            computed,
            not self._current,
            missing(review.plan),
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
        axes = of.kind.pose_coordinates(of.design)
        joints = of.kind.joint_coordinates(of.design)
        found = replace(computed.found, distance=self._distance)
        if kind == "csv":
            data = trajectory_csv(found, axes, joints)
        else:
            title = of.design.title or of.design.name
            data = plots_svg(replace(computed, found=found), review.plan.plot, title)
        name = solid_name(of.design, "trajectory", (), (of.mode,) if of.mode else None)
        file = ExportedFile(f"{name}.{kind}", data.encode(), MEDIA_TYPES[kind])
        self._stage.apart(client, lambda: self._stage.download(file, client))


def rounded_up(value: float) -> float:
    """A positive number to six digits and never less, so that what is at a limit is not beyond it
    by rounding.
    """
    digit = 10.0 ** (math.floor(math.log10(value)) - 5)
    return float(f"{math.ceil(value * (1.0 + 1e-9) / digit) * digit:.6g}")


def on_the_way(view: View, pose: tuple[float, ...], at: float, duration: float) -> View:
    """The view with the machine at a pose of its trajectory; the review stays."""
    review = view.review
    kind, design = review.mechanism, review.design
    posture = kind.posture(design, pose, review.mode)
    status = compute.status(replace(review, pose=pose), posture)
    return replace(
        view,
        posture=posture,
        drawing=kind.drawing(design, posture),
        platform=kind.transform(design, pose, review.mode),
        joints=compute.joint_rows(kind, design, posture),
        status=replace(status, text=f"At {at:.2f} of {duration:.2f} s · {status.text}"),
    )


def _reach_key(
    review: Review,
) -> tuple[object, tuple[float, ...], str, tuple[int, int], int | None]:
    """All that the reach in the plane of a stroke depends on."""
    plane = trajectory.drawn_axes(review)
    held = tuple(0.0 if n in plane else v for n, v in enumerate(review.pose))
    return review.design, held, review.mode, plane, review.dependent
