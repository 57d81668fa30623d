"""Control on the page: what holds the platform here, what is near, where control is lost."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from app.features.design.state import EditDesign
from app.features.move.state import GoHome, Move, Place, Visit
from app.features.review.files import ExportedFile, solid_name
from app.features.singularities import compute
from app.features.singularities.files import locus_bytes
from app.features.singularities.html import TOLD, held_fact, limit
from app.features.singularities.scene import Held, Loads
from app.features.singularities.state import Control, SetControl
from app.jobs.answers import Asked, Key
from app.jobs.lane import Done, Job, Lost
from app.jobs.parts import Client, Grip, Part, Stage
from app.language import tr
from app.review.changes import Change
from app.review.state import Review
from app.review.view import Clear, Limits, View
from app.scene.camera import machine_points
from app.widgets.desk import Sheet
from kinematics.answers.loci import LocusCurves
from kinematics.arrays import Array
from kinematics.machine import required

KEPT = 60  # lines of the log
FRAME = 0.03  # s between two pictures of a free motion


class ControlPart(Part):
    """Keeps what is told of control true to the machine."""

    LANES = ("control", "loci")

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._grip = Grip()
        self._free: Asked[Any] | None = None  # a ball that a person asked for
        self._swing: tuple[float, tuple[float, ...]] | None = None
        self._watched: compute.Place | None = None
        self._log: tuple[compute.Logged, ...] = ()

    def prepare(self) -> None:
        self._held = Held(self.stage.scene)
        self._loads = Loads(self.stage.scene, lambda *what: self.stage.ask(self.pull, *what))
        self._swing = None

    # --- what is wanted

    def wished(self, view: View) -> Iterable[Asked[Any]]:
        review, spot = view.review, compute.spot_of(view.review)
        machine, control, other = review.machine, review[Control], compute.counterpart(view.review)
        yield compute.HERE(spot)
        if self._watched is None or not compute.same_branch(self._watched, spot):
            self._watched = spot
        if self._watched.pose != spot.pose:
            way = self._watched, spot.pose
            yield compute.PASSED(way, *way)
        if other is not None:
            yield compute.BESIDE(other)
        if self._free is not None and self._free.request[0] != compute.orientation(review):
            self._free = None
        if self._free is not None:
            yield self._free
        if control.chart:
            key = compute.chart_key(review)
            yield compute.CURVES(key, spot, control.chart)
            if other is not None:
                yield compute.CURVES_BESIDE(key, other, control.chart)
        if machine.circles is not None:
            yield compute.PROFILES((review.design, control.ratios), spot, control.ratios)

    def seen(self, view: View) -> View:
        return replace(view, beside=compute.beside(view.review))

    def applied(self, change: Change, before: Review, note: str, client: Client) -> None:
        if note:
            self._note(note, "stop")
        if isinstance(change, Visit):
            self._note(tr("singularities.jumped"), "jump")
        if not isinstance(change, Move | Place | GoHome):
            # An actuator drives along its own way, and says itself what stopped it.
            self._watched = None

    def _note(self, text: str, kind: str) -> None:
        if self._log and self._log[0].text == text:  # a slider held against its stop
            self._log = (replace(self._log[0], at=time.time()), *self._log[1:])
        else:
            self._log = (compute.Logged(time.time(), text, kind), *self._log)[:KEPT]
        self.late = True

    # --- what comes

    def take(self, event: Done | Lost) -> bool:
        match event:
            case Done(Job(Key(question, (before, pose))), events) if (
                question is compute.PASSED and before == self._watched
            ):
                # The hand may have moved on: then the next way begins where this one ends.
                for each in events:
                    self._note(each.text, each.kind)
                self._watched = replace(before, pose=pose)
        return super().take(event)

    def came(self, asked: Asked[Any], answer: Any) -> bool:
        if asked.question is compute.FREE and not answer:
            self.stage.complain(tr("singularities.no_ball"))
        return False

    def lost(self, asked: Asked[Any]) -> None:
        if asked.question is compute.FREE:
            self._free = None

    # --- what a person asks for

    def pull(self, phase: str, client_id: int | None, tip: tuple[float, ...]) -> bool:
        """A hand holds the tip of the load's arrow (mm, base frame): the force follows it, the
        moment stays.
        """
        moved = self._grip.take(phase, client_id)
        self._loads.pulled = self._grip.held
        if not moved:
            self.late = True
            return False
        force = self._loads.force_of(self.stage.view, tip)
        load = (*force, *self.stage.review[Control].load[3:])
        return self.stage.apply(SetControl("load", load), None)

    def find_free(self, here: bool) -> None:
        """Find the largest ball without a singularity, about the platform or anywhere."""
        review = self.stage.view.review
        spot = compute.spot_of(review)
        request = (compute.orientation(review), spot.pose if here else None)
        self._free = compute.FREE(request, spot, here)
        self.follow()

    def forget_free(self) -> None:
        """Take that ball off display."""
        self._free = None
        self.follow()

    def go_to_free(self, client: Client = None) -> bool:
        """Put the platform into the middle of that ball."""
        balls, review = self.answers[compute.FREE].now, self.stage.review
        if not balls:
            return False
        pose = compute.placed(review.machine, review.pose, balls[0].center[None])[0]
        return self.stage.apply(Place(tuple(float(v) for v in pose), gesture=""), client)

    def escape(self, client: Client = None) -> bool:
        """Go to the nearest posture that can be held."""
        here = self.answers[compute.HERE].now
        if here is None or here.remedy is None or here.remedy.nearest is None:
            self.stage.complain(tr("singularities.no_escape"), client)
            return False
        nearest = here.remedy.nearest
        way: Change = Visit(nearest.pose, nearest.mode)
        if nearest.mode == self.stage.review.mode:
            way = Place(nearest.pose, gesture="")
        return self.stage.apply(way, client)

    def change_design(self, way: int, client: Client = None) -> bool:
        """Change the design so that the pose can be held, in the way of this number."""
        here = self.answers[compute.HERE].now
        ways = () if here is None or here.remedy is None else here.remedy.changes
        if way >= len(ways):
            return False
        edits = tuple((change.path, change.after) for change in ways[way])
        return self.stage.apply(EditDesign(edits), client)

    def swing(self, which: int) -> None:
        """Show the free motion of the singularity of this number."""
        here = self.answers[compute.HERE].now
        if here is not None and which < len(here.singular):
            motion = here.singular[which].motion
            self._swing = None if motion is None else (time.monotonic(), motion)

    def clear_log(self) -> None:
        """Forget what happened on the way."""
        self._log, self.late = (), True

    def save_curves(self, kind: str, client: Client) -> None:
        """Save the chart's curves as a file of this kind."""
        review = self.stage.view.review
        chart, title = review[Control].chart, review.design.title or review.design.name

        def make(curves: LocusCurves) -> ExportedFile:
            spec = next(s for s in review.machine.singularities.loci if s.key == chart)
            name = solid_name(review.design, f"singularities-{spec.key}", (), (review.mode,))
            return ExportedFile(f"{name}.{kind}", locus_bytes(curves, spec, kind, title=title))

        self.save(self.answers[compute.CURVES].now, make, client, tr("singularities.none_to_save"))

    # --- what is shown

    @property
    def due(self) -> float | None:
        return super().due if self._swing is None else FRAME

    @property
    def points(self) -> Array | None:
        other = self.stage.view.beside
        return None if other is None else machine_points(other.drawing)

    def catch_up(self) -> None:
        if self._swing is not None:
            begun, motion = self._swing
            with self.stage.server.atomic():
                if self.answers[compute.HERE].now is None or not self._held.swing(
                    self.stage.view, motion, time.monotonic() - begun
                ):
                    self._swing = None
                    self._held.still()
            self.stage.server.flush()
        super().catch_up()

    def show(self, sheet: Sheet) -> None:
        controlled = self.controlled()
        here = controlled.here
        self._held.show(sheet.view, here, controlled.ball)
        self._loads.show(sheet.view, here)
        self.stage.tell(controlled)
        ways = () if here is None else tuple(map(limit, here.clearances[:TOLD]))
        self.stage.tell(Limits(ways, controlled.stale))
        remedy = None if here is None else here.remedy
        back = self.escape if remedy is not None and remedy.nearest is not None else None
        self.stage.tell(Clear(held_fact(here), controlled.stale, back))

    def _nearly(
        self, question: Any, spot: compute.Place | None
    ) -> tuple[compute.Here | None, bool]:
        """What is known of a place, or was last while the hand moves; whether it is of before."""
        told = self.answers[question]
        if told.stale and (spot is None or not compute.same_branch(told.old_of, spot)):
            return None, True
        return told.shown, told.now is None

    def controlled(self) -> compute.Controlled:
        """What panels draw of it."""
        review = self.stage.view.review
        here, stale = self._nearly(compute.HERE, compute.spot_of(review))
        curves, chart = self.answers[compute.CURVES], review[Control].chart
        of_chart = not curves.stale or curves.old_of[0] == chart
        profiles = self.answers[compute.PROFILES].now or ()
        if profiles:
            circles = required(review.machine.circles, "circles of orientations")
            at = circles.profile_place(review.pose)
            profiles = tuple((each, replace(p, at=at)) for each, p in profiles)
        free = self.answers[compute.FREE]
        return compute.Controlled(
            here,
            stale,
            curves.shown if of_chart else None,
            curves.stale,
            profiles,
            self._nearly(compute.BESIDE, compute.counterpart(review))[0],
            self.answers[compute.CURVES_BESIDE].now,
            next(iter(free.now or ()), None),
            self._free is not None and free.now is None,
            self._log,
            self.answers[compute.HERE].trouble,
        )
