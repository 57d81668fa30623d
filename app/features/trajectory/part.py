"""The trajectory on the page: computed beside the loop, played by it (`playing`)."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from app.features.review.files import ExportedFile, solid_name
from app.features.trajectory import compute
from app.features.trajectory.files import trajectory_csv
from app.features.trajectory.playing import Playing
from app.features.trajectory.plot import plots_svg
from app.features.trajectory.scene import Trail
from app.features.trajectory.state import STROKE, Plan, SetPlan, missing, set_plan
from app.jobs import answers
from app.jobs.parts import Client, Part, Stage
from app.language import tr
from app.review.changes import Change
from app.review.state import Review
from app.review.view import Moment, View
from app.widgets.desk import Sheet
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.trajectories import duration_within

OPENED = 0.7  # s in which a browser has opened or closed the plots, and says how wide it is
FOOT = 352.0  # px of the scene over which the plots lie
FRAME = 1 / 31  # s between two pictures


class TrajectoryPart(Part):
    """Keeps the trajectory true to the review, and plays it."""

    LANES = ("trajectory",)

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._asked: compute.Asked | None = None
        self._given_up = False  # its distances to singularities
        self.playing = Playing(stage)
        self._framed_at = 0.0
        self._fit_at: float | None = None
        self._told: Moment | None = None
        self._known: tuple[object, compute.Computed | None] = (None, None)
        self._shown: compute.Moved | None = None
        self._before: compute.Computed | None = None

    def prepare(self) -> None:
        self._trail = Trail(self.stage.scene)
        self._told = self._before = None
        self.playing.forget()
        if self.stage.view.review[Plan].on:  # its window has been closed and is opened again
            self._fit_at = time.monotonic() + OPENED

    # --- what is wanted

    def wished(self, view: View) -> Iterable[answers.Asked[Any]]:
        review = view.review
        of = compute.asked(review)
        if of != self._asked:
            self._asked, self._given_up = of, False
        if of is not None:
            yield compute.TRAJECTORY(of)
            computed = self.answers.kept(compute.TRAJECTORY(of))
            if computed is not None:
                yield from self._further(of, computed, review[Plan].degree)
        if review[Plan].on and review[Plan].way == STROKE:
            key = compute.reach_key(review)
            yield compute.REACH(key, *key)

    def _further(
        self, of: compute.Asked, computed: compute.Computed, degree: int
    ) -> Iterable[answers.Asked[Any]]:
        """What is asked once the trajectory is there."""
        if degree:
            yield compute.FITS((computed, degree), computed, degree)
        whole = True
        for part in compute.parts(len(computed.found.times)):
            each = compute.DISTANCES((computed, part), of, computed.found.poses[list(part)])
            known = self.answers.kept(each) is not None
            whole &= known
            if known or not self._given_up:
                yield each
        if whole:
            yield compute.JUDGED(computed, self._measured(computed)[0])

    def _measured(self, computed: compute.Computed) -> tuple[compute.Computed, float]:
        """A trajectory with the distances that are known, and the share of these."""
        distance = np.full(len(computed.found.times), np.nan)
        left = 0
        for part in compute.parts(len(distance)):
            values = self.answers.kept(compute.DISTANCES((computed, part)))
            if values is None:
                left += len(part)
            else:
                distance[list(part)] = values
        found = replace(computed.found, distance=distance)
        return replace(computed, found=found), 1.0 - left / max(len(distance), 1)

    def applied(self, change: Change, before: Review, note: str, client: Client) -> None:
        if _covered(self.stage.review) != _covered(before):
            self._fit_at = time.monotonic() + OPENED  # another part of the scene is free then

    def follow(self) -> None:
        super().follow()
        self.playing.follow(self.stage.view.review, self.current)

    # --- what comes

    @property
    def current(self) -> compute.Computed | None:
        """The trajectory that is asked for, once it is known."""
        return self.answers[compute.JUDGED].now or self.answers[compute.TRAJECTORY].now

    def came(self, asked: answers.Asked[Any], answer: Any) -> bool:
        self.playing.follow(self.stage.view.review, self.current)
        return False

    def lost(self, asked: answers.Asked[Any]) -> None:
        self._given_up |= asked.question in (compute.DISTANCES, compute.JUDGED)

    # --- what a person asks for

    def measure(self, on: bool) -> None:
        """Find the distances to singularities, or give that up."""
        self._given_up = not on
        if not on:
            self.cancel("trajectory")
        self.follow()

    def shorten(self, client: Client = None) -> bool:
        """Choose the shortest duration that keeps the limits of rates and accelerations."""
        computed, plan = self.current, self.stage.view.review[Plan]
        if computed is None:
            return False
        if not (plan.rates or plan.accelerations):
            self.stage.complain(tr("trajectory.limits_first"), client)
            return False
        try:
            duration = rounded_up(duration_within(computed.found, plan.limits))
        except InputError as error:
            self.stage.complain(str(error), client)
            return False
        values: dict[str, object] = {"duration": duration, "law": computed.law.kind}
        if plan.law == "trapezoidal":
            ramp = computed.law.ramp
            top = computed.path.length / duration / (1.0 - ramp)
            values = {"speed": top, "acceleration": top / (ramp * duration)}
        return self.stage.apply(SetPlan(tuple(values.items())), client)

    def cut(self, client: Client = None) -> bool:
        """End the straight way where it leaves the workspace."""
        computed = self.current
        leaves = None if computed is None else compute.leaves_at(computed)
        if computed is None or leaves is None:
            return False
        end = compute.last_inside(computed, leaves)
        return end is not None and self.stage.apply(set_plan("end", end), client)

    def save_trajectory(self, kind: str, client: Client = None) -> None:
        """Save the trajectory as CSV, or its plots as SVG."""
        plot = self.stage.view.review[Plan].plot

        def make(computed: compute.Computed) -> ExportedFile:
            of = computed.asked
            name = solid_name(of.design, "trajectory", (), (of.mode,) if of.mode else None)
            if kind == "csv":
                data = trajectory_csv(computed.found, of.machine.coordinates, of.machine.joints)
            else:
                data = plots_svg(computed, plot, of.design.title or of.design.name)
            return ExportedFile(f"{name}.{kind}", data.encode())

        computed = None if self.current is None else self._moved().computed
        self.save(computed, make, client, tr("trajectory.none_to_save"))

    # --- what is shown

    @property
    def due(self) -> float | None:
        playing = self.playing
        if self.late or playing.late:
            return 0.0
        if playing.player.playing:
            return max(self._framed_at + FRAME - time.monotonic(), 0.0)
        return FRAME if playing.waits or self._fit_at is not None else super().due

    @property
    def points(self) -> Array | None:
        """The way of O′, mm; None while there is none."""
        computed = self.answers[compute.TRAJECTORY].shown
        return None if computed is None else computed.spots

    @property
    def covered(self) -> float:
        return _covered(self.stage.view.review)

    def shown(self, view: View) -> View:
        """The view with the machine where it is on its trajectory; the same if it is not."""
        return self.playing.shown(view)

    def catch_up(self) -> None:
        now = time.monotonic()
        self.playing.catch_up(now)
        if self._fit_at is not None and now >= self._fit_at:
            self._fit_at = None
            self.stage.fit_view()
        if self.late or self.playing.late:
            self.playing.late = False
            self.late = True
            self._framed_at = now
            super().catch_up()
        elif self.playing.player.playing and now - self._framed_at >= FRAME:
            self._framed_at = now
            with self.stage.server.atomic():
                self._show_moment()
            self.stage.server.flush()

    def show(self, sheet: Sheet) -> None:
        moved = self._shown = self._moved()
        told = self.answers[compute.TRAJECTORY]
        self._trail.show(None if self.aged(told) else moved.computed)
        self.stage.tell(moved)
        self._show_moment()

    def _show_moment(self) -> None:
        away, player = self.playing.away, self.playing.player
        at = player.at(time.monotonic())
        self.stage.scene.veil(away)
        if away:
            self.stage.show_machine()
        there = away or self.playing.stands_at(at)
        moment = Moment(at, player.playing, away, self._nearest(at), there)
        self.stage.tell(moment, self.stage.shown())
        if self._told is not None and self._told.away and not away:
            self.stage.put("redraw")  # the machine is where the review has it again
        self._told = moment

    def _nearest(self, at: float) -> float:
        """mm to a singularity at a time, between the samples that are known."""
        computed = None if self._shown is None else self._shown.computed
        if computed is None or self.current is None:
            return float("nan")
        times, distances = compute.known_distances(computed.found)
        return float(np.interp(at, times, distances)) if len(times) else float("nan")

    def _moved(self) -> compute.Moved:
        review, told = self.stage.view.review, self.answers[compute.TRAJECTORY]
        # While another one is wanted, the one that was there last stays.
        computed, share = (self._before if told.stale else None), 0.0
        if told.now is not None:
            self._before = told.now
            computed, share = self._measured(told.now)
            judged = self.answers[compute.JUDGED].now
            computed = self._same(judged or computed, told.now, share)
        fits, reach = self.answers[compute.FITS], self.answers[compute.REACH]
        trouble = told.trouble
        if told.given_up and not trouble:
            trouble = tr("trajectory.given_up_change")
        fit_trouble = fits.trouble
        if fits.given_up and not fit_trouble:
            fit_trouble = tr("trajectory.given_up")
        return compute.Moved(
            computed,
            told.now is None,
            missing(review[Plan]),
            share,
            not self._given_up and share < 1.0,
            fits.now,
            fit_trouble,
            reach.now,
            trouble,
        )

    def _same(
        self, measured: compute.Computed, of: compute.Computed, share: float
    ) -> compute.Computed:
        """The same object for the same trajectory and distances, so that nothing is drawn twice."""
        key = of, share, self.answers[compute.JUDGED].now
        if self._known[0] != key:
            self._known = key, measured
        return self._known[1] or measured


def _covered(review: Review) -> float:
    plan = review[Plan]
    return FOOT if plan.on and not missing(plan) else 0.0


def rounded_up(value: float) -> float:
    """A positive number to six digits and never less, so that what is at a limit is not beyond it
    by rounding.
    """
    digit = 10.0 ** (math.floor(math.log10(value)) - 5)
    return float(f"{math.ceil(value * (1.0 + 1e-9) / digit) * digit:.6g}")
