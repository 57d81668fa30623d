"""The solutions on the page: found beside its loop, drawn for a share of its time.

Quick designs are solved right there, the others in a process of their own once the hand rests;
until then the last set stays, and its list says so.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from app.features.move.state import Drive, Visit
from app.features.solutions import compute
from app.features.solutions.scene import Ghosts
from app.features.solutions.state import Atlas
from app.jobs.answers import Answers, Asked
from app.jobs.lane import Busy, Done, Lane, Lost
from app.jobs.parts import Client, Part, Stage
from app.language import tr
from app.review.changes import Change
from app.review.history import QUIET_GAP
from app.review.state import Options, Review
from app.review.view import Legend, View
from app.scene import palette
from app.scene.pointer import Pointer
from app.widgets.desk import Sheet
from kinematics.answers.solutions import Refreshed
from kinematics.errors import BohemiaError

# The solutions pause so many times as long as bringing them up to date takes: seen in the scene, or
# in the list alone.
PAUSE_SEEN, PAUSE_LISTED = 1.0, 4.0
UNDER = 14.0  # px: a ghost that is nearer is under the pointer


@dataclass(frozen=True, eq=False, slots=True)
class Solutions:
    """The forward solutions as panels draw them.

    ``ahead`` is empty while the folds are being looked for; ``fold`` is the one that is told of;
    ``trouble`` and ``fold_trouble`` say why there are none of them, if that is so.
    """

    atlas: compute.Listed
    known: compute.Known | None
    ahead: tuple[compute.Ahead, ...]
    fold: compute.Ahead | None
    trouble: str
    fold_trouble: str


class Explorer:
    """Holds the last set of solutions and the folds ahead, and sees that they become true."""

    def __init__(self, on_event: Callable[[Done | Lost | Busy], None]) -> None:
        self.lane = Lane("solutions", on_event)
        self.answers = Answers({self.lane.name: self.lane})
        self.known: compute.Known | None = None
        self.trouble = ""
        self._wish: compute.Wish | None = None
        self._driven: int | None = None
        self._driving = True  # and not placed: who comes and goes then is no news
        self._chosen: tuple[int, bool] | None = None
        self._awaited: int | None = None
        self._joints: tuple[float, ...] = ()
        self._moved_at = 0.0
        self._rested = True

    # --- bringing it up to date

    def look(self, view: View) -> None:
        """The present review: ask for what is missing. Cheap; call it for every change."""
        posture = view.posture
        if posture.joints != self._joints:
            now = time.monotonic()
            self._rested |= now - self._moved_at > QUIET_GAP
            self._joints, self._moved_at = posture.joints, now
        self.answers.want(self._wished(view))

    def _wished(self, view: View) -> Iterable[Asked[Any]]:
        review, posture = view.review, view.posture
        if not posture.closes:
            self._wish = None
        elif self.is_current(view):
            self._wish = None
            yield compute.FOLDS(_of(view), review.design, posture)
        elif not self._quick(view):
            yield compute.SOLUTIONS(self._next(view))

    def _next(self, view: View) -> compute.Wish:
        """What is to be found now; the same wish while it is."""
        review, wish = view.review, self._wish
        before = self.known.solutions if self.known and self.known.is_of(review) else None
        made = compute.Wish(review.design, view.posture.joints, before)
        if wish is None or (wish.design, wish.joints) != (made.design, made.joints):
            self._wish = wish = made
        return wish

    def catch_up(self, view: View) -> None:
        """Solve a quick design for the present actuators, at once."""
        if not view.posture.closes or self.is_current(view) or not self._quick(view):
            return
        wish = self._next(view)
        try:
            self._keep(wish, compute.solve(wish))
        except BohemiaError as error:
            self.trouble = str(error)
        self.look(view)  # the folds ahead can be looked for now

    def take(self, event: Done | Lost, view: View) -> None:
        """A wish was worked on; what is of another design is dropped."""
        asked = self.answers.take(event)
        match event:
            case Done(_, Refreshed() as refreshed):
                wish = event.job.arguments[0]
                if wish.design == view.review.design:
                    self._keep(wish, refreshed)
            case Lost(_, text) if asked is not None:
                self._awaited = None
                if asked.question is compute.SOLUTIONS:
                    self.trouble = text
        self.look(view)

    def find_again(self, view: View) -> None:
        """Forget the set, so that all solutions are found from scratch."""
        self.known = self._wish = None
        self.trouble = ""
        self.look(view)

    def _keep(self, wish: compute.Wish, refreshed: Refreshed) -> None:
        if wish.before is not None and self.known is not None and self._driving:
            self.known = self.known.after(refreshed, rested=self._rested)
        else:
            self.known = compute.Known(wish.design, refreshed.solutions)
        self._rested = False
        self.trouble = ""

    @staticmethod
    def _quick(view: View) -> bool:
        return view.review.machine.forward.is_quick()

    # --- what is shown and asked

    def is_current(self, view: View) -> bool:
        """Whether the last set is of the present actuators and design."""
        return (
            self.known is not None
            and self.known.is_of(view.review)
            and self.known.stands_at(view.posture.joints)
        )

    def atlas(self, view: View) -> compute.Listed:
        """The solutions as they are shown."""
        return compute.atlas(view, self.known)

    def await_visit(self, identity: int | None) -> None:
        """A person wants to go to this solution as soon as the set is of the present actuators."""
        self._awaited = identity

    def visit(self, view: View) -> Visit | None:
        """The visit that is due, once.

        Raises:
            BohemiaError: that solution is not there any more.
        """
        if self._awaited is None or self.known is None:
            return None
        if not self.known.is_of(view.review):  # numbers of another set mean nothing in the next
            self._awaited = None
            raise BohemiaError(tr("solutions.of_before"))
        if not self.is_current(view):
            return None
        identity, self._awaited = self._awaited, None
        index = self.known.index(identity)
        if index is None:
            raise BohemiaError(tr("solutions.gone", identity=identity))
        found = self.known.solutions
        return Visit(tuple(float(v) for v in found.poses[index]), found.modes[index])

    def drove(self, index: int) -> None:
        """A person drives this actuator: its folds are told of before the others'."""
        self._driving = True
        if index != self._driven:
            self._driven, self._chosen = index, None

    def placed(self) -> None:
        """A person puts the platform somewhere, and drives no actuator."""
        self._driving = False

    def choose_fold(self, choice: tuple[int, bool] | None) -> None:
        """Which fold to tell of and to mark: the actuator, and whether it grows."""
        self._chosen = choice

    def folds(self, view: View) -> tuple[tuple[compute.Ahead, ...], compute.Ahead | None]:
        """Both directions of every actuator from here, and the fold that is told of.

        Nothing while they are being looked for.
        """
        ahead = self.answers.of(compute.FOLDS, _of(view)).now
        if ahead is None:
            return (), None
        folds = compute.nearest_first(ahead, self._driven)
        chosen = next((a for a in folds if (a.index, a.longer) == self._chosen), None)
        return ahead, chosen or (folds[0] if folds else None)

    def shown(self, view: View) -> Solutions:
        """All of it as panels draw it."""
        folds = self.answers[compute.FOLDS].trouble
        return Solutions(self.atlas(view), self.known, *self.folds(view), self.trouble, folds)


def _of(view: View) -> tuple[object, ...]:
    return view.review.design, view.posture.pose, view.posture.mode


class SolutionsPart(Part):
    """Keeps list, ghosts and folds ahead true to the machine."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._explorer = Explorer(stage.put)
        self.answers = self._explorer.answers
        self.lanes = {self._explorer.lane.name: self._explorer.lane}
        self._drawn: object = None
        self._pointed: int | None = None
        self._from = 0.0  # the time from which they may be brought up to date again

    def prepare(self) -> None:
        stage = self.stage
        self._ghosts = Ghosts(stage.scene, self._clicked)
        self._drawn = None

    def ask(self) -> None:
        self._explorer.look(self.stage.view)

    def applied(self, change: Change, before: Review, note: str, client: Client) -> None:
        if isinstance(change, Drive):
            self._explorer.drove(change.index)
        elif before.pose != self.stage.review.pose:
            self._explorer.placed()

    def take(self, event: Done | Lost) -> bool:
        if getattr(event.job.key, "question", None) not in (compute.SOLUTIONS, compute.FOLDS):
            return False
        self._explorer.take(event, self.stage.view)
        self.redraw()
        return self._visit(None)

    # --- what a person asks for

    def visit(self, identity: int, client: Client = None) -> bool:
        """Go to a solution of the list, by its number."""
        self._explorer.await_visit(identity)
        return self._visit(client)

    def _clicked(self, identity: int) -> None:
        if not self.stage.scene.aside:  # a click means something else
            self.stage.ask(self.visit, identity)

    def find_again(self) -> None:
        """Forget the solutions and find them all from scratch."""
        self._explorer.find_again(self.stage.view)
        self.redraw()

    def choose_fold(self, index: int, longer: bool) -> None:
        """Tell of the fold of this actuator, as it grows or shrinks."""
        self._explorer.choose_fold((index, longer))
        self.redraw()

    def redraw(self) -> None:
        """The list is to be drawn again, as when it shows more of itself."""
        self.late, self._drawn = True, None

    def _visit(self, client: Client) -> bool:
        """Go to the solution that a person chose, if the set is of the present actuators."""
        try:
            due = self._explorer.visit(self.stage.view)
        except BohemiaError as error:
            self.stage.complain(str(error), client)
            return False
        return due is not None and self.stage.apply(due, client)

    # --- drawing

    def pointed(self, pointer: Pointer) -> None:
        """The ghost under somebody's pointer is filled and named instead of the nearest one."""
        if not self.stage.view.review[Atlas].ghosts:
            return
        owners, places = self._ghosts.spots
        away = pointer.distances(places)
        at = owners[int(away.argmin())] if len(away) and away.min() <= UNDER else None
        if at != self._pointed:
            self._pointed = at
            self.redraw()

    @property
    def due(self) -> float | None:
        return max(self._from - time.monotonic(), 0.0) if self.late else None

    def catch_up(self) -> None:
        """Bring the solutions up to date, after everything else and for a share of the time."""
        now = time.monotonic()
        if not self.late or now < self._from:
            return
        self._explorer.catch_up(self.stage.view)
        super().catch_up()
        done = time.monotonic()
        ghosts = self.stage.view.review[Atlas].ghosts
        self._from = done + (PAUSE_SEEN if ghosts else PAUSE_LISTED) * (done - now)

    def show(self, sheet: Sheet) -> None:
        view, explorer = sheet.view, self._explorer
        # Who belongs to other actuators stays as it is while the hand moves: that costs nothing.
        options, current = view.review[Options], explorer.is_current(view)
        wanted = view.review[Atlas]
        drawn = explorer.known, wanted, options.dark, explorer.trouble, current, self._pointed
        if not current and explorer.known is not None and drawn == self._drawn:
            return
        self._drawn = drawn
        solutions = explorer.shown(view)
        self._ghosts.show(view, solutions.atlas, solutions.fold, self._pointed)
        self.stage.tell(solutions)
        of = palette.scheme(options.dark)
        entries = (of.ghost, tr("solutions.nearest_ones")), (of.dot, tr("solutions.further"))
        self.stage.tell(Legend("ghosts", entries if wanted.ghosts else ()))
