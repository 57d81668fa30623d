"""What a trajectory asks of a machine: plain results. Arrays are read-only; mm, rad, s, N, N·mm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kinematics.motion import WrenchName
from kinematics.spatial import Array, Frozen

EventKind = Literal["outside", "singularity", "near", "jump", "rate", "acceleration", "force"]
Playback = Literal["once", "loop", "swing"]


@dataclass(frozen=True, slots=True)
class Event:
    """Something a trajectory should not do, or nearly does.

    Attributes:
        kind: the path leaves the workspace; crosses or touches a singularity; comes near one; a
            joint has to leap; or a limit is exceeded.
        start, end: s; equal where it is a moment.
        pose: at the start.
        text: one sentence for the user.
        joint: index of the joint (or force) that is concerned, from 0; -1: none in particular.
        value: what is worst: mm beyond a bound, mm to a singularity, the largest rate, …
    """

    kind: EventKind
    start: float
    end: float
    pose: tuple[float, ...]
    text: str
    joint: int = -1
    value: float = float("nan")


@dataclass(frozen=True, slots=True)
class Limits:
    """What the actuators can do, one number each or None where nothing limits: mm/s or rad/s,
    mm/s² or rad/s², N or N·mm."""

    rates: tuple[float, ...] | None = None
    accelerations: tuple[float, ...] | None = None
    forces: tuple[float, ...] | None = None


@dataclass(frozen=True, eq=False)
class Trajectory(Frozen):
    """A trajectory at N times; NaN where the path is outside or a singularity leaves it open.

    Attributes:
        mode: the working mode it runs in.
        times: (N,) s, evenly from 0 to the law's duration.
        shares: (N,) of the path, 0 to 1.
        poses, pose_rates, pose_accelerations: (N, P).
        joints: (N, J); angles go on beyond a turn rather than leap.
        joint_rates, joint_accelerations: (N, J).
        reachable: (N,) bool, within all strokes.
        names: of the forces; empty without a load.
        forces: (N, R) that hold the load, quasi-statically.
        determinant: (N,) of the wrenches; zero at parallel and constraint singularities.
        conditioning: (N,) 0 to 1, NaN for a mechanism without this measure.
        distance: (N,) mm to the nearest parallel or constraint singularity as `clearances` tells
            it; inf: there is none; NaN where it was not asked for.
        events: by time.
        length: of the path, mm.
    """

    mode: str
    times: Array
    shares: Array
    poses: Array
    pose_rates: Array
    pose_accelerations: Array
    joints: Array
    joint_rates: Array
    joint_accelerations: Array
    reachable: NDArray[np.bool_]
    names: tuple[WrenchName, ...]
    forces: Array
    determinant: Array
    conditioning: Array
    distance: Array
    events: tuple[Event, ...]
    length: float

    @property
    def duration(self) -> float:
        """s."""
        return float(self.times[-1])

    @property
    def sound(self) -> bool:
        """Nothing on the way stops the machine: no event but that a singularity is near."""
        return all(event.kind == "near" for event in self.events)

    def index_at(self, elapsed: float, *, speed: float = 1.0, playback: Playback = "loop") -> int:
        """The sample to be shown ``elapsed`` s after the start of a playback.

        "once" stays at the end, "loop" begins again, "swing" runs to and fro.
        """
        turns = elapsed * speed / self.duration
        if playback == "once":
            share = min(max(turns, 0.0), 1.0)
        elif playback == "loop":
            share = turns % 1.0
        else:
            share = 1.0 - abs(1.0 - turns % 2.0)
        return round(share * (len(self.times) - 1))
