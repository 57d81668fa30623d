"""Playing a trajectory: which time of it is shown when, where the machine is shown on its way, and
who has it. Times in s.

While it plays, only pictures of the machine change; the review stays where it is until a person
stops the machine on its way.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.features.move.state import Place
from app.features.trajectory.compute import Computed
from app.features.trajectory.state import Plan
from app.jobs.parts import Client, Stage
from app.language import tr
from app.review import view as compute
from app.review.state import Review
from app.review.units import within
from app.review.view import View
from kinematics.answers.trajectories import Event, Playback

SETTLED = 0.5  # s for which a hand must rest on the scrub bar before the machine is put there
SAME = 1e-6  # mm and rad: poses that are one


@dataclass(frozen=True, slots=True)
class Player:
    """A playback.

    Attributes:
        duration: of the trajectory.
        playback: "once" stays at the end, "loop" begins again, "swing" runs to and fro.
        pace: how much faster than in truth.
        phase: what had been played of it at ``since``; of "swing" up to twice the duration.
        since: when it was set going; None while it stands still.
    """

    duration: float
    playback: Playback = "loop"
    pace: float = 1.0
    phase: float = 0.0
    since: float | None = None

    @property
    def playing(self) -> bool:
        """Whether time goes on."""
        return self.since is not None

    def _played(self, now: float) -> float:
        return self.phase if self.since is None else self.phase + (now - self.since) * self.pace

    def _phase(self, now: float) -> float:
        """What is kept of what has been played: of "swing" also whether it is on its way back."""
        return self._played(now) % (2.0 * self.duration) if self._swings else self.at(now)

    @property
    def _swings(self) -> bool:
        return self.playback == "swing"

    def at(self, now: float) -> float:
        """The time on the trajectory that is to be shown, 0 to its duration."""
        played = self._played(now)
        if self._swings:
            folded = self.duration - abs(self.duration - played % (2.0 * self.duration))
        elif self.playback == "loop" and self.playing:
            folded = played % self.duration
        else:
            folded = played
        return min(max(folded, 0.0), self.duration)

    def over(self, now: float) -> bool:
        """It has run to its end, and stays there."""
        return self.playing and self.playback == "once" and self._played(now) >= self.duration

    def play(self, now: float) -> Player:
        """Set going from where it stands, from the start if that is the end."""
        again = self.at(now) >= self.duration * (1.0 - 1e-9) and not self._swings
        return replace(self, phase=0.0 if again else self._phase(now), since=now)

    def pause(self, now: float) -> Player:
        """Stand still where it is."""
        return replace(self, phase=self._phase(now), since=None)

    def to(self, time: float) -> Player:
        """Stand still at a time."""
        return replace(self, phase=min(max(time, 0.0), self.duration), since=None)

    def halted(self, time: float, now: float) -> Player:
        """Stand still at a time that it has just passed, on its way back if it was."""
        back = self._swings and self._phase(now) > self.duration
        return replace(self, phase=2.0 * self.duration - time if back else time, since=None)

    def paced(self, playback: Playback, pace: float, now: float) -> Player:
        """The same place, played otherwise from now on."""
        if (playback, pace) == (self.playback, self.pace):
            return self
        since = None if self.since is None else now
        phase = self._phase(now) if playback == self.playback else self.at(now)
        return replace(self, playback=playback, pace=pace, phase=phase, since=since)


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
        self._settler: Client = None
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

    # --- the person's hand on it; what returns True has the page brought to the review

    def play(self, on: bool | None = None) -> None:
        """Play, or pause; None for the other of the two."""
        now = time.monotonic()
        if self.current is None:
            self._stage.complain(tr("trajectory.none_to_play"))
            return
        on = not self.player.playing if on is None else on
        self.player = self.player.play(now) if on else self.player.pause(now)
        self._played_to = self.player.at(now)
        self.away, self._settle_at, self.late = True, None, True

    def scrub(self, at: float, client: Client = None) -> None:
        """Show the machine at this time, and put it there when the hand rests."""
        if self.current is None or not np.isfinite(at):
            return
        self.player = self.player.to(at)
        self.away, self.late = True, True
        self._settle_at, self._settler = time.monotonic() + SETTLED, client

    def to_warning(self, client: Client = None, *, first: bool = False) -> None:
        """Show the machine at the next place where something is wrong, or at the ``first`` one."""
        events = () if self.current is None else self.current.found.events
        if not events:
            self._stage.complain(tr("trajectory.nothing_wrong"), client)
            return
        at = self.player.at(time.monotonic())
        later = [e.start for e in events if e.start > at + 1e-9 and not first]
        known = first_wrong(events)
        self.scrub(later[0] if later else known.start, client)

    def stop_here(self, client: Client = None) -> bool:
        """Put the machine where it is shown."""
        return self.settle(client, asked=True)

    def go_back(self) -> bool:
        """Show the machine where the review has it."""
        self.leave()
        self.late = True
        return True

    def settle(self, client: Client, *, asked: bool) -> bool:
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
                self._stage.complain(tr("trajectory.not_there", why=told), client)
            self.late = True
            return False
        self.away = False
        return self._stage.apply(Place(pose, gesture=""), client)

    # --- time goes on

    def catch_up(self, now: float) -> None:
        """What has become due."""
        if self._settle_at is not None and now >= self._settle_at:
            self._settle_at = None
            self._stage.ask(self.settle, self._settler, asked=False)
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
            self._stage.complain(tr("trajectory.stopped", at=self._played_to))

    def shown(self, view: View) -> View:
        """The view with the machine where it is on its trajectory; the same if it is not."""
        computed = self.current
        if not self.away or computed is None:
            return view
        at = self.player.at(time.monotonic())
        return on_the_way(view, computed.pose_at(at), at, computed.law.duration)


def first_wrong(events: Sequence[Event]) -> Event:
    """What goes wrong first; that a singularity is only near comes after all else."""
    return min(events, key=lambda event: (event.kind == "near", event.start))


def on_the_way(view: View, pose: tuple[float, ...], at: float, duration: float) -> View:
    """The view with the machine at a pose of its trajectory; the review stays."""
    review = view.review
    machine = review.machine
    posture = machine.inverse.posture(pose, review.mode)
    status = compute.status(replace(review, pose=pose), posture)
    when = tr("trajectory.at_of", at=at, duration=duration)
    return replace(
        view,
        posture=posture,
        drawing=machine.drawing(posture),
        platform=machine.transform(pose, review.mode),
        joints=compute.joint_rows(machine, posture),
        status=replace(status, mode=when, text=f"{when} · {status.text}"),
    )
