"""Playing a trajectory on the page: where the machine is shown on its way, and who has it.

While it plays, only pictures of the machine change; the review stays where it is until a person
stops the machine on its way.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from app.features.move.state import Place
from app.features.trajectory.compute import Computed
from app.features.trajectory.player import Player
from app.features.trajectory.state import Plan
from app.jobs.parts import Stage
from app.review import view as compute
from app.review.requests import LeaveWay, NextWarning, Play, Scrub, StopHere
from app.review.state import Review
from app.review.units import within
from app.review.view import View

if TYPE_CHECKING:
    import viser

SETTLED = 0.5  # s for which a hand must rest on the scrub bar before the machine is put there
SAME = 1e-6  # mm and rad: poses that are one


@dataclass(frozen=True, slots=True)
class _Rested:
    """A hand has come to rest on the scrub bar."""

    client: viser.ClientHandle | None


class Playing:
    """Plays the trajectory that the review asks for, once it is known.

    Attributes:
        current: that trajectory; None while it is not known.
        player: which time of it is shown.
        away: the machine is shown there, and not where the review has it.
        late: something changed that panels have not been told of.
    """

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self.current: Computed | None = None
        self.player = Player(1.0)
        self.away = False
        self.late = False
        self._stands: tuple[object, ...] = ()
        self._settle_at: float | None = None
        self._settler: viser.ClientHandle | None = None
        self._played_to = 0.0  # s of the trajectory, in the last picture

    @property
    def waits(self) -> bool:
        """Something is to be done soon."""
        return self.late or self.player.playing or self._settle_at is not None

    def forget(self) -> None:
        """Another machine has come."""
        self.current = None
        self.player = Player(1.0)
        self.leave()

    def follow(self, review: Review, current: Computed | None) -> None:
        """The review changed, or what is known of its trajectory."""
        stands = review.design, review.pose, review.mode
        if stands != self._stands:  # whoever moved the machine has it
            self._stands = stands
            self.leave()
        if current is not self.current:
            other = current is None or self.current is None or current.asked != self.current.asked
            self.current = current
            if other:
                duration = 1.0 if current is None else current.law.duration
                self.leave()
                self.player = Player(duration, review[Plan].playback, review[Plan].pace)
        plan = review[Plan]
        self.player = self.player.paced(plan.playback, plan.pace, time.monotonic())

    def leave(self) -> None:
        """The machine is shown where the review has it: at the start, if it is not on its way."""
        self.player = self.player.pause(time.monotonic())
        self.away, self._settle_at = False, None
        if not self.stands_at(self.player.at(time.monotonic())):
            self.player = self.player.to(0.0)

    def stands_at(self, at: float) -> bool:
        """Whether the review has the machine where the trajectory has it at a time."""
        computed = self.current
        if computed is None:
            return False
        review = self._stage.view.review
        there = np.subtract(computed.pose_at(at), review.pose)
        return computed.asked.mode == review.mode and bool(np.abs(there).max() <= SAME)

    # --- the person's hand on it

    def take(self, item: object) -> bool:
        """Something a person asked for; true when the page has to be brought to it."""
        now = time.monotonic()
        match item:
            case Play(on):
                if self.current is None:
                    self._stage.complain("There is no trajectory to play yet.")
                    return False
                on = not self.player.playing if on is None else on
                self.player = self.player.play(now) if on else self.player.pause(now)
                self._played_to = self.player.at(now)
                self.away, self._settle_at, self.late = True, None, True
            case Scrub(at, client):
                self._scrub(at, client)
            case NextWarning(client):
                self._to_warning(now, client)
            case StopHere(client):
                return self._settle(client, asked=True)
            case _Rested(client):
                return self._settle(client, asked=False)
            case LeaveWay():
                self.leave()
                self.late = True
                return True
        return False

    def _scrub(self, at: float, client: viser.ClientHandle | None) -> None:
        if self.current is None or not np.isfinite(at):
            return
        self.player = self.player.to(at)
        self.away, self.late = True, True
        self._settle_at, self._settler = time.monotonic() + SETTLED, client

    def _to_warning(self, now: float, client: viser.ClientHandle | None) -> None:
        computed = self.current
        events = () if computed is None else computed.found.events
        if not events:
            self._stage.complain("Nothing is wrong on the way, as far as it is known.", client)
            return
        at = self.player.at(now)
        later = [e.start for e in events if e.start > at + 1e-9]
        self._scrub(later[0] if later else events[0].start, client)

    def _settle(self, client: viser.ClientHandle | None, *, asked: bool) -> bool:
        """Put the machine where it is shown; one step of undo.

        Not where its sliders do not reach: that is told if it was ``asked`` for.
        """
        self._settle_at = None
        computed, review = self.current, self._stage.view.review
        if computed is None or not self.away:
            return False
        now = time.monotonic()
        self.player = self.player.pause(now)
        pose = computed.pose_at(self.player.at(now))
        axes = review.machine.coordinates
        notes = [within(c, v)[1] for c, v in zip(axes, pose, strict=True)]
        if any(notes):  # elsewhere than on the way it would be of no use
            if asked:
                told = " ".join(note for note in notes if note)
                self._stage.complain(f"The machine cannot be put there: {told}", client)
            self.late = True
            return False
        self.away = False
        return self._stage.apply(Place(pose, gesture=""), client)

    # --- time goes on

    def catch_up(self, now: float) -> None:
        """What has become due."""
        if self._settle_at is not None and now >= self._settle_at:
            self._settle_at = None
            self._stage.put(_Rested(self._settler))
        if self.player.over(now):
            self.player, self.late = self.player.to(self.player.duration), True
        self._halt(now)

    def _halt(self, now: float) -> None:
        """Stop at a singularity that has been passed since the last picture."""
        if not self.player.playing:
            return
        before, at = self._played_to, self.player.at(now)
        self._played_to = at
        computed = self.current
        if computed is None or not self._stage.view.review[Plan].halt:
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
            self.player, self.late = self.player.halted(self._played_to, now), True
            self._stage.complain(
                f"Stopped at {self._played_to:.3f} s: the platform is not held there. Play goes on."
            )

    def shown(self, view: View) -> View:
        """The view with the machine where it is on its trajectory; the same if it is not."""
        computed = self.current
        if not self.away or computed is None:
            return view
        at = self.player.at(time.monotonic())
        return on_the_way(view, computed.pose_at(at), at, computed.law.duration)


def on_the_way(view: View, pose: tuple[float, ...], at: float, duration: float) -> View:
    """The view with the machine at a pose of its trajectory; the review stays."""
    review = view.review
    machine = review.machine
    posture = machine.inverse.posture(pose, review.mode)
    status = compute.status(replace(review, pose=pose), posture)
    return replace(
        view,
        posture=posture,
        drawing=machine.drawing(posture),
        platform=machine.transform(pose, review.mode),
        joints=compute.joint_rows(machine, posture),
        status=replace(status, text=f"At {at:.2f} of {duration:.2f} s · {status.text}"),
    )
