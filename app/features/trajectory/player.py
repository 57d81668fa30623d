"""Playing a trajectory: which time of it is shown when. Pure values; times in s."""

from __future__ import annotations

from dataclasses import dataclass, replace

from kinematics.answers.trajectories import Playback


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
