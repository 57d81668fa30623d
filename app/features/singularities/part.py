"""Control on the page: what holds the platform here, what is near, where control is lost."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from app.features.design.state import EditDesign
from app.features.move.state import GoHome, Move, Place, Visit
from app.features.review.files import ExportedFile, solid_name
from app.features.singularities import compute
from app.features.singularities.compute import Here
from app.features.singularities.compute import Place as Spot
from app.features.singularities.files import locus_bytes
from app.features.singularities.loads_scene import Loads
from app.features.singularities.painter import Painter
from app.features.singularities.scene import Held
from app.features.singularities.state import Control, SetControl
from app.features.workspace.compute import SolidWish
from app.jobs.lane import Done, Job, Lane, Lost
from app.jobs.parts import Stage
from app.jobs.worker import Built, LaneName
from app.review.changes import Change
from app.review.requests import ChangeDesign, ClearLog, Escape, FindFree, GoToFree, SaveLoci, Swing
from app.review.state import Review
from app.review.view import View
from app.scene.painting import Coat
from app.widgets.desk import Controlled, Logged
from kinematics.answers.circles import Profile
from kinematics.answers.loci import LocusCurves
from kinematics.answers.sections import Sphere
from kinematics.machine import required
from kinematics.mechanism import Design

if TYPE_CHECKING:
    import viser

REST = 0.2  # s for which a place must stay before curves are traced about it
KEPT = 60  # lines of the log
MEDIA_TYPES = {"svg": "image/svg+xml", "csv": "text/csv"}


@dataclass(frozen=True, slots=True)
class Pulled:
    """A hand holds the tip of the load's arrow (mm, base frame), or lets it go."""

    phase: str
    client_id: int | None
    tip: tuple[float, ...]


class Controlling:
    """Keeps what is told of control true to the machine."""

    lanes: tuple[LaneName, ...] = ("control", "loci")

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._quick = Lane("control", stage.put)
        self._slow = Lane("loci", stage.put)
        self._held = Held(stage.scene)
        self._loads = Loads(stage.scene, self._pulled)
        self._pulling: set[int] = set()
        self._late = False
        self._here: Here | None = None
        self._curves: tuple[object, LocusCurves] | None = None
        self._profiles: tuple[object, tuple[tuple[Design, Profile], ...]] | None = None
        self._beside: tuple[Here | None, LocusCurves | None] = (None, None)
        self._beside_of: tuple[object, ...] = ()
        self._asked: Job | None = None  # for a ball
        self._ball: Sphere | None = None
        self._ball_of: object = None
        self._painter = Painter()
        self._swing: tuple[float, tuple[float, ...]] | None = None
        self._watched: Spot | None = None
        self._log: tuple[Logged, ...] = ()
        self._trouble = ""

    @property
    def late(self) -> bool:
        return self._late or self._swing is not None

    def start(self) -> None:
        self._quick.start()
        self._slow.start()

    def stop(self) -> None:
        self._quick.stop()
        self._slow.stop()

    def cancel(self, lane: LaneName) -> None:
        (self._quick if lane == "control" else self._slow).cancel()

    def prepare(self) -> None:
        self._painter = Painter()  # the last machine's solids are none of this one's
        self._held.prepare(self._stage.view.drawing.size)
        self._loads.prepare(self._stage.view.drawing.size)

    # --- what is wanted

    def follow(self) -> None:
        view = self._stage.view
        review, spot = view.review, spot_of(view.review)
        if self._watched is None or not _same_branch(self._watched, spot):
            self._watched = spot
        quick = [Job(("here", spot), "what holds the platform", compute.look, (spot,))]
        if self._watched.pose != spot.pose:
            way = self._watched, spot.pose
            quick.append(Job(("passed", *way), "the way here", compute.passed, way))
        other = counterpart(review)
        if other is not None:
            quick.append(Job(("beside", other), "the counterpart", compute.look, (other,)))
        self._quick.want(quick)
        if self._ball_of is not None and self._ball_of != _orientation(review):
            self._ball = self._ball_of = self._asked = None
        self._ask_slowly()
        self._late = True

    def _ask_slowly(self) -> None:
        review, spot = self._stage.view.review, spot_of(self._stage.view.review)
        jobs = [] if self._asked is None else [self._asked]
        if review[Control].chart:
            key = ("curves", *_chart_key(review))
            arguments = spot, review[Control].chart
            jobs.append(Job(key, "the singular curves", compute.curves, arguments, REST))
            other = counterpart(review)
            if other is not None:
                key = ("curves beside", *_chart_key(review))
                arguments = other, review[Control].chart
                jobs.append(Job(key, "the counterpart's curves", compute.curves, arguments, REST))
        if review.machine.circles is not None:
            jobs.append(
                Job(
                    ("profiles", *_profile_key(review)),
                    "the profile",
                    compute.profiles,
                    (spot, review[Control].ratios),
                    REST,
                )
            )
        if review[Control].shade:
            jobs += self._painter.jobs(review, spot)
        self._slow.want(jobs)

    def applied(self, change: Change, before: Review, note: str) -> None:
        if note:
            self._note(note, "stop")
        if isinstance(change, Visit):
            self._note("Went to another solution; the way between was not driven.", "jump")
        if not isinstance(change, Move | Place | GoHome):
            # An actuator drives along its own way, and says itself what stopped it.
            self._watched = None

    def _note(self, text: str, kind: str) -> None:
        if self._log and self._log[0].text == text:  # a slider held against its stop
            self._log = (replace(self._log[0], at=time.time()), *self._log[1:])
        else:
            self._log = (Logged(time.time(), text, kind), *self._log)[:KEPT]
        self._late = True

    # --- what comes

    def take(self, item: object) -> bool:
        match item:
            case Done(Job(("here", _)), Here() as here):
                self._here, self._trouble, self._late = here, "", True
            case Done(Job(("passed", Spot() as before, tuple(pose))), events):
                for event in events:
                    self._note(event.text, event.kind)
                self._watched = replace(before, pose=pose)
            case Done(Job(("curves", *_) as key), LocusCurves() as curves):
                self._curves, self._late = (key, curves), True
            case Done(Job(("beside", _)), Here() as here):
                self._beside, self._late = (here, self._beside[1]), True
            case Done(Job(("curves beside", *key)), LocusCurves() as curves):
                self._beside, self._late = (self._beside[0], curves), True
                self._beside_of = tuple(key)
            case Done(Job(("profiles", *_) as key), tuple(profiles)):
                self._profiles, self._late = (key, profiles), True
            case Done(Job(("field", *_) as key), np.ndarray() as values):
                self._painter.take(key, values)
                return True
            case Done(job, result) if job is self._asked:
                return self._ball_came(result)
            case Lost(job, text):
                self._lost(job, text)
            case Pulled(phase, client_id, tip):
                return self._pull(phase, client_id, tip)
            case FindFree(here, client):
                self._find(here, client)
            case GoToFree(client):
                return self._go_to_ball(client)
            case Escape(client):
                return self._escape(client)
            case ChangeDesign(way, client):
                return self._change_design(way, client)
            case Swing(which):
                self._begin_swing(which)
            case SaveLoci(kind, client):
                self._save(kind, client)
            case ClearLog():
                self._log, self._late = (), True
        return False

    def _lost(self, job: Job, text: str) -> None:
        match job.key:
            case ("here", _):
                self._trouble, self._late = text, True
            case ("curves" | "field", *_):
                if text:
                    self._stage.complain(text)
            case _ if job is self._asked:
                self._asked, self._late = None, True
                if text:
                    self._stage.complain(text)

    # --- the load's arrow

    def _pulled(self, phase: str, client_id: int | None, tip: tuple[float, ...]) -> None:
        """Called on the event loop."""
        self._stage.put(Pulled(phase, client_id, tip))

    def _pull(self, phase: str, client_id: int | None, tip: tuple[float, ...]) -> bool:
        """The arrow's tip is dragged: the force follows it, the moment stays."""
        who = -1 if client_id is None else client_id
        if phase == "end":
            self._pulling.discard(who)
            self._loads.pulled = False
            self._late = True
            return False
        self._pulling.add(who)
        self._loads.pulled = True
        view = self._stage.view
        force = self._loads.force_of(view, tip)
        load = (*force, *view.review[Control].load[3:])
        return self._stage.apply(SetControl("load", load), None)

    # --- the ball

    def _find(self, here: bool | None, client: viser.ClientHandle | None) -> None:
        review = self._stage.view.review
        self._ball, self._asked = None, None
        self._ball_of = _orientation(review)
        if here is not None:
            spot = spot_of(review)
            title = "the largest ball without a singularity"
            self._asked = Job(("free", spot, here), title, compute.ball, (spot, here), slow=True)
        self._ask_slowly()
        self._late = True

    def _ball_came(self, result: Sphere | None) -> bool:
        self._asked, self._ball, self._late = None, result, True
        if result is None:
            self._stage.complain("There is no such ball: nothing of the workspace is there.")
        return False

    def _go_to_ball(self, client: viser.ClientHandle | None) -> bool:
        if self._ball is None:
            return False
        review = self._stage.view.review
        pose = compute.placed(review.machine, review.pose, self._ball.center[None])[0]
        return self._stage.apply(Place(tuple(float(v) for v in pose), gesture=""), client)

    # --- ways out

    def _escape(self, client: viser.ClientHandle | None) -> bool:
        here = self._current()
        if here is None or here.remedy is None or here.remedy.nearest is None:
            self._stage.complain("No reachable pose is known from here.", client)
            return False
        nearest = here.remedy.nearest
        way: Change = Visit(nearest.pose, nearest.mode)
        if nearest.mode == self._stage.view.review.mode:
            way = Place(nearest.pose, gesture="")
        return self._stage.apply(way, client)

    def _change_design(self, way: int, client: viser.ClientHandle | None) -> bool:
        here = self._current()
        ways = () if here is None or here.remedy is None else here.remedy.changes
        if way >= len(ways):
            return False
        edits = tuple((change.path, change.after) for change in ways[way])
        return self._stage.apply(EditDesign(edits), client)

    def _current(self) -> Here | None:
        """What is known of the present place; None while that is of another."""
        spot = spot_of(self._stage.view.review)
        return self._here if self._here is not None and self._here.place == spot else None

    # --- free motion

    def _begin_swing(self, which: int) -> None:
        here = self._current()
        if here is not None and which < len(here.singular):
            motion = here.singular[which].motion
            self._swing = None if motion is None else (time.monotonic(), motion)

    # --- what is shown

    def catch_up(self) -> None:
        if self._swing is not None:
            self._show_swing()
        if not self._late:
            return
        self._late = False
        sheet, controlled = self._stage.sheet(), self.controlled()
        current = self._current()
        with self._stage.server.atomic():
            self._held.show(sheet.view, current or self._nearly(), self._ball)
            self._loads.show(sheet.view, current or self._nearly())
            for panel in self._stage.panels:
                panel.draw_control(sheet, controlled)
        self._stage.server.flush()

    def _show_swing(self) -> None:
        assert self._swing is not None
        begun, motion = self._swing
        with self._stage.server.atomic():
            if self._current() is None or not self._held.swing(
                self._stage.view, motion, time.monotonic() - begun
            ):
                self._swing = None
                self._held.still()
        self._stage.server.flush()

    def _nearly(self) -> Here | None:
        """What was known last, while the hand moves and the newest is on its way."""
        here, spot = self._here, spot_of(self._stage.view.review)
        return here if here is not None and _same_branch(here.place, spot) else None

    def controlled(self) -> Controlled:
        """What panels draw of it."""
        review = self._stage.view.review
        curves = None
        if self._curves is not None and review[Control].chart:
            key = ("curves", *_chart_key(review))
            curves = self._curves[1] if self._curves[0] == key else None
        profiles: tuple[tuple[Design, Profile], ...] = ()
        if self._profiles is not None and self._profiles[0] == ("profiles", *_profile_key(review)):
            at = required(review.machine.circles, "circles of orientations").profile_place(
                review.pose
            )
            profiles = tuple((each, replace(p, at=at)) for each, p in self._profiles[1])
        return Controlled(
            self._nearly(),
            self._current() is None,
            curves,
            profiles,
            *self._known_beside(review),
            self._ball,
            self._asked is not None,
            self._log,
            self._painter.scale(review),
            self._trouble,
        )

    def _known_beside(self, review: Review) -> tuple[Here | None, LocusCurves | None]:
        """What is known of the counterpart, and its curves; nothing of another one's."""
        other, (here, curves) = counterpart(review), self._beside
        if other is None:
            return None, None
        if here is not None and not _same_branch(here.place, other):
            here = None
        if not review[Control].chart or self._beside_of != _chart_key(review):
            curves = None
        return here, curves

    def coats(self, view: View, wish: SolidWish, built: Built) -> tuple[Coat, ...]:
        """How a solid is painted."""
        coats = self._painter.coats(view.review, wish, built)
        if self._painter.wants:
            self._ask_slowly()
        return coats

    def _save(self, kind: str, client: viser.ClientHandle | None) -> None:
        review = self._stage.view.review
        curves = self.controlled().curves
        if curves is None:
            self._stage.complain("There are no curves to save yet.", client)
            return
        spec = next(s for s in review.machine.singularities.loci if s.key == review[Control].chart)
        name = solid_name(review.design, f"singularities-{spec.key}", (), (review.mode,))
        data = locus_bytes(curves, spec, kind, title=review.design.title or review.design.name)
        file = ExportedFile(f"{name}.{kind}", data, MEDIA_TYPES[kind])
        self._stage.apart(client, lambda: self._stage.download(file, client))


def spot_of(review: Review) -> Spot:
    """Where the machine stands, with its load."""
    control = review[Control]
    return Spot(
        review.design,
        review.pose,
        review.mode,
        control.load,
        control.rates,
        control.accelerations,
    )


def counterpart(review: Review) -> Spot | None:
    """The counterpart at the same coordinates, where it is to be compared with."""
    others = review.machine.counterparts if review[Control].compare else ()
    return next((replace(spot_of(review), design=other) for other in others), None)


def _profile_key(review: Review) -> tuple[object, ...]:
    return review.design, review[Control].ratios


def _same_branch(one: Spot, other: Spot) -> bool:
    return one.design == other.design and one.mode == other.mode


def _orientation(review: Review) -> tuple[object, ...]:
    """All of a review on which balls depend, but for the position."""
    return review.design, review.mode, *_held(review, ("x", "y", "z"))


def _held(review: Review, free: tuple[str, ...]) -> tuple[float, ...]:
    axes = review.machine.coordinates
    return tuple(
        v
        for c, v in zip(axes, review.pose, strict=True)
        if c.key not in free and c.symbol not in free
    )


def _chart_key(review: Review) -> tuple[object, ...]:
    """All that the curves of the chosen chart depend on: its own two coordinates are free."""
    chart = review[Control].chart
    spec = next(s for s in review.machine.singularities.loci if s.key == chart)
    return chart, review.design, review.mode, *_held(review, spec.axes)
