"""What is known of the solutions while a review changes: found anew, gone on from, looked ahead of.

Called from the page's loop alone. Quick designs are solved right there, the others in a process of
their own once the hand rests; until then the last set stays, and its view says so.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from app.features.move.state import Visit
from app.features.solutions.atlas import Known, Listed, atlas, mixes
from app.features.solutions.compute import Wish, job, solve
from app.features.solutions.folds import Ahead, nearest_first
from app.jobs.lane import Done, Job, Lane, Lost
from app.jobs.worker import Busy
from app.review.history import QUIET_GAP
from app.review.view import View
from kinematics.answers.solutions import Posture, Refreshed
from kinematics.errors import BohemiaError


class Explorer:
    """Holds the last set of solutions and the folds ahead, and sees that they become true."""

    def __init__(self, on_event: Callable[[Done | Lost | Busy], None]) -> None:
        self.lane = Lane("solutions", on_event)
        self.known: Known | None = None
        self.trouble = ""
        self.fold_trouble = ""
        self._driven: int | None = None
        self._ahead: tuple[Ahead, ...] = ()
        self._ahead_of: object = None
        self._chosen: tuple[int, bool] | None = None
        self._asked: object = None
        self._awaited: int | None = None
        self._joints: tuple[float, ...] = ()
        self._moved_at = 0.0
        self._rested = True

    # --- bringing it up to date

    def look(self, view: View) -> None:
        """The present review: ask for what is missing. Cheap; call it for every change."""
        review, posture = view.review, view.posture
        if posture.joints != self._joints:
            now = time.monotonic()
            self._rested |= now - self._moved_at > QUIET_GAP
            self._joints, self._moved_at = posture.joints, now
        key = (review.design, mixes(review), posture.pose, posture.mode)
        if key == self._asked:
            return
        wish: Wish | None = None
        if posture.closes:
            if not self.is_current(view):
                if not self._quick(view):
                    before = self.known.solutions if self._goes_on(view) and self.known else None
                    wish = Wish(review.design, posture.joints, mixes(review), before)
            elif self._ahead_of != _of(view):
                wish = Wish(review.design, posture.joints, mixes(review), posture=posture)
        self._asked = key
        self.lane.want(() if wish is None else (job(wish),))

    def catch_up(self, view: View) -> None:
        """Solve a quick design for the present actuators, at once."""
        if not view.posture.closes or self.is_current(view) or not self._quick(view):
            return
        review = view.review
        before = self.known.solutions if self._goes_on(view) and self.known else None
        wish = Wish(review.design, view.posture.joints, mixes(review), before)
        try:
            found = solve(wish.design, wish.joints, wish.mixed, wish.before)
        except BohemiaError as error:
            self.trouble = str(error)
        else:
            self._keep(wish, found)
        self._asked = None  # the folds ahead can be looked for now
        self.look(view)

    def take(self, event: Done | Lost, view: View) -> None:
        """A wish was worked on; what is of another design or other modes is dropped."""
        match event:
            case Done(Job(Wish() as wish), Refreshed() as refreshed):
                if wish.design == view.review.design and wish.mixed == mixes(view.review):
                    self._keep(wish, refreshed)
                    self._asked = None
            case Done(Job(Wish(design, posture=Posture() as posture)), ahead):
                self._ahead, self.fold_trouble = ahead, ""
                self._ahead_of = (design, posture.pose, posture.mode)
            case Lost(Job(Wish(posture=None)), text):
                self._awaited, self.trouble = None, text
            case Lost(_, text):
                self._awaited, self.fold_trouble = None, text
        self.look(view)

    def find_again(self, view: View) -> None:
        """Forget the set, so that all solutions are found from scratch."""
        self.known = self._asked = None
        self.trouble = ""
        self.look(view)

    def _keep(self, wish: Wish, refreshed: Refreshed) -> None:
        if wish.before is not None and self.known is not None:
            self.known = self.known.after(refreshed, rested=self._rested)
        else:
            self.known = Known(wish.design, wish.mixed, refreshed.solutions)
        self._rested = False
        self.trouble = ""

    @staticmethod
    def _quick(view: View) -> bool:
        review = view.review
        return review.machine.forward.is_quick(mixed_modes=mixes(review))

    def _goes_on(self, view: View) -> bool:
        return self.known is not None and self.known.is_of(view.review)

    # --- what is shown and asked

    def is_current(self, view: View) -> bool:
        """Whether the last set is of the present actuators, design and working modes."""
        return (
            self.known is not None
            and self.known.is_of(view.review)
            and self.known.stands_at(view.posture.joints)
        )

    def atlas(self, view: View) -> Listed:
        """The solutions as they are shown."""
        return atlas(view, self.known)

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
            raise BohemiaError(
                "this list was of the machine before; choose again once the new one is there"
            )
        if not self.is_current(view):
            return None
        identity, self._awaited = self._awaited, None
        index = self.known.index(identity)
        if index is None:
            raise BohemiaError(f"solution #{identity} is not there any more: it merged on the way")
        found = self.known.solutions
        return Visit(tuple(float(v) for v in found.poses[index]), found.modes[index])

    def drove(self, index: int) -> None:
        """A person drives this actuator: its folds are told of before the others'."""
        if index != self._driven:
            self._driven, self._chosen = index, None

    def choose_fold(self, choice: tuple[int, bool] | None) -> None:
        """Which fold to tell of and to mark: the actuator, and whether it grows."""
        self._chosen = choice

    def folds(self, view: View) -> tuple[tuple[Ahead, ...], Ahead | None]:
        """Both directions of every actuator from here, and the fold that is told of.

        Nothing while they are being looked for.
        """
        if self._ahead_of != _of(view):
            return (), None
        folds = nearest_first(self._ahead, self._driven)
        chosen = next((a for a in folds if (a.index, a.longer) == self._chosen), None)
        return self._ahead, chosen or (folds[0] if folds else None)


def _of(view: View) -> tuple[object, ...]:
    return view.review.design, view.posture.pose, view.posture.mode
