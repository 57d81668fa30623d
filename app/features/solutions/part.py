"""The solutions on the page: found beside its loop, drawn for a share of its time."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from app.features.move.state import Drive
from app.features.solutions.compute import Wish
from app.features.solutions.explorer import Explorer
from app.features.solutions.scene import Ghosts
from app.features.solutions.state import Atlas
from app.jobs.lane import Done, Job, Lost
from app.jobs.parts import Stage
from app.jobs.worker import LaneName
from app.review.changes import Change
from app.review.requests import ChooseFold, FindAgain, RedrawSolutions, VisitSolution
from app.review.state import Options, Review
from app.widgets.desk import Solutions
from kinematics.errors import BohemiaError

if TYPE_CHECKING:
    import viser

# The solutions pause so many times as long as bringing them up to date takes: seen in the scene, or
# in the list alone.
PAUSE_SEEN, PAUSE_LISTED = 1.0, 4.0


class Solving:
    """Keeps list, ghosts and folds ahead true to the machine."""

    lanes: tuple[LaneName, ...] = ("solutions",)

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._explorer = Explorer(stage.put)
        self._ghosts = Ghosts(stage.scene, lambda identity: stage.put(VisitSolution(identity)))
        self._late = False
        self._drawn: object = None
        self._from = 0.0  # the time from which they may be brought up to date again

    @property
    def late(self) -> bool:
        return self._late

    def start(self) -> None:
        self._explorer.lane.start()

    def stop(self) -> None:
        self._explorer.lane.stop()

    def cancel(self, lane: LaneName) -> None:
        self._explorer.lane.cancel()

    def prepare(self) -> None:
        self._ghosts.prepare()

    def follow(self) -> None:
        self._late = True

    def applied(self, change: Change, before: Review, note: str) -> None:
        if isinstance(change, Drive):
            self._explorer.drove(change.index)

    def take(self, item: object) -> bool:
        match item:
            case Done(Job(Wish())) | Lost(Job(Wish())):
                self._explorer.take(item, self._stage.view)
                self._redraw()
                return self._visit(None)
            case VisitSolution(identity, client):
                self._explorer.await_visit(identity)
                return self._visit(client)
            case FindAgain():
                self._explorer.find_again(self._stage.view)
                self._redraw()
            case ChooseFold(index, longer):
                self._explorer.choose_fold((index, longer))
                self._redraw()
            case RedrawSolutions():
                self._redraw()
        return False

    def _redraw(self) -> None:
        self._late, self._drawn = True, None

    def _visit(self, client: viser.ClientHandle | None) -> bool:
        """Go to the solution that a person chose, if the set is of the present actuators."""
        try:
            due = self._explorer.visit(self._stage.view)
        except BohemiaError as error:
            self._stage.complain(str(error), client)
            return False
        return due is not None and self._stage.apply(due, client)

    def catch_up(self) -> None:
        """Bring the solutions up to date, after everything else and for a share of the time."""
        now = time.monotonic()
        if not self._late:
            return
        view, explorer = self._stage.view, self._explorer
        explorer.look(view)
        if now < self._from:
            return
        self._late = False
        explorer.catch_up(view)
        # Who belongs to other actuators stays as it is while the hand moves: that costs nothing.
        review, current = view.review, explorer.is_current(view)
        drawn = explorer.known, review[Atlas], review[Options].dark, explorer.trouble, current
        if not current and explorer.known is not None and drawn == self._drawn:
            return
        self._drawn = drawn
        ahead, fold = explorer.folds(view)
        solutions = Solutions(
            explorer.atlas(view),
            explorer.known,
            ahead,
            fold,
            explorer.trouble,
            explorer.fold_trouble,
        )
        sheet = self._stage.sheet()
        with self._stage.server.atomic():
            self._ghosts.show(view, solutions.atlas, fold)
            for panel in self._stage.panels:
                panel.draw_solutions(sheet, solutions)
        self._stage.server.flush()
        done = time.monotonic()
        pause = PAUSE_SEEN if review[Atlas].ghosts else PAUSE_LISTED
        self._from = done + pause * (done - now)
