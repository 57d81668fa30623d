"""Trajectories and what they ask of a machine: plain results.

Arrays are read-only; mm, rad, s, N, N·mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.motion import WrenchName
from kinematics.arrays import Array, Frozen

EventKind = Literal[
    "outside", "singularity", "near", "jump", "corner", "rate", "acceleration", "force"
]
Quantity = Literal["rate", "acceleration", "force"]
Playback = Literal["once", "loop", "swing"]
JUMP = 1e-6  # of the largest rate: a rate that leaps by less is continuous

Derivatives = tuple[Array, Array, Array]
"""Points, first and second derivatives by s, each (N, P)."""


class Path(Protocol):
    """A way through pose space."""

    @property
    def length(self) -> float:
        """mm, with angles as the path's scale counts them."""
        ...

    @property
    def knots(self) -> Array:
        """Shares (K,) between 0 and 1 at which derivatives may leap: corners, ends of pieces."""
        ...

    def at(self, share: ArrayLike) -> Derivatives:
        """Points and derivatives at shares (N,) of the way."""
        ...


class TimeLaw(Protocol):
    """How the share of a way grows with time, see `kinematics.trajectories.laws.Law`."""

    @property
    def kind(self) -> str:
        """Which of `kinematics.trajectories.LAWS`."""
        ...

    @property
    def duration(self) -> float:
        """s."""
        ...

    @property
    def ramp(self) -> float:
        """Of a trapezoid: the part of the duration in which it speeds up."""
        ...

    @property
    def breaks(self) -> tuple[float, ...]:
        """Times at which the acceleration leaps, s."""
        ...

    def at(self, times: ArrayLike) -> Derivatives:
        """s, ds/dt and d²s/dt² at times (...), s."""
        ...

    def times_of(self, shares: ArrayLike) -> Array:
        """When given shares (...) of the way are passed, s."""
        ...


@dataclass(frozen=True)
class NamedTrajectory:
    """A path with its time law, its working mode and its name."""

    name: str
    title: str
    path: Path
    law: TimeLaw
    mode: str
    source: str = ""


@dataclass(frozen=True, slots=True)
class Event:
    """Something a trajectory should not do, or nearly does.

    Attributes:
        kind: the path leaves the workspace; crosses or touches a singularity; comes near one; a
            joint has to leap; the path has a corner that is passed at speed; or a limit is
            exceeded.
        start, end: s; equal where it is a moment.
        pose: at the start.
        text: one sentence for the user.
        joint: index of the joint (or force) that is concerned, from 0; -1: none in particular.
        value: what is worst: mm beyond a bound, mm to a singularity, the largest rate, by how much
            rates leap, …
        at: when it is worst, s; NaN where that is not asked.
    """

    kind: EventKind
    start: float
    end: float
    pose: tuple[float, ...]
    text: str
    joint: int = -1
    value: float = float("nan")
    at: float = float("nan")


@dataclass(frozen=True, slots=True)
class Limits:
    """What the actuators can do, one number each or None where nothing limits: mm/s or rad/s,
    mm/s² or rad/s², N or N·mm."""

    rates: tuple[float, ...] | None = None
    accelerations: tuple[float, ...] | None = None
    forces: tuple[float, ...] | None = None


@dataclass(frozen=True, eq=False)
class Close(Frozen):
    """What a trajectory asks of the actuators, so close that no largest value is passed over.

    Attributes:
        times: (M,) s, uneven, samples and what lies between them; some stand on both sides of a
            moment at which something leaps.
        joint_rates, joint_accelerations: (M, J), NaN where there are none; inf at a moment towards
            which a quantity grows without end.
        forces: (M, R) likewise.
        corners: (C,) s, when rates leap, as no finite acceleration makes them.
        leaps: (C, J) by how much.
    """

    times: Array
    joint_rates: Array
    joint_accelerations: Array
    forces: Array
    corners: Array
    leaps: Array


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
        length: of the path, mm, with angles as its scale counts them.
        travel: mm that the platform's origin O′ travels; NaN where the path leaves that open.
        close: rates, accelerations and forces between the samples, too.
        load: that the forces hold, [F, T], N and N·mm; None for none.
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
    travel: float
    close: Close
    load: tuple[float, ...] | None

    @property
    def duration(self) -> float:
        """s."""
        return float(self.times[-1])

    @property
    def sound(self) -> bool:
        """Nothing on the way stops the machine: no event but that a singularity is near."""
        return all(event.kind == "near" for event in self.events)

    def largest(self, what: Quantity) -> tuple[Array, Array]:
        """The largest sizes of a quantity between samples, too, and when (s), (J,) or (R,) each.

        Accelerations are infinite where the path has a corner that is passed at speed; anything may
        be towards a singularity. NaN where there are no values at all.
        """
        close = self.close
        values = np.abs(
            {
                "rate": close.joint_rates,
                "acceleration": close.joint_accelerations,
                "force": close.forces,
            }[what]
        )
        times = close.times
        if what == "acceleration" and len(close.corners):
            sharp = np.abs(close.leaps) > JUMP * self.largest("rate")[0]
            values = np.concatenate([values, np.where(sharp, np.inf, np.nan)])
            times = np.concatenate([times, close.corners])
        known = np.where(np.isnan(values), -1.0, values)
        n = known.argmax(axis=0)
        most = known.max(axis=0)
        return np.where(most < 0.0, np.nan, most), np.where(most < 0.0, np.nan, times[n])

    @property
    def moving_ends(self) -> tuple[bool, bool]:
        """Whether the machine moves already when the trajectory starts, and still at its end."""
        most = np.nan_to_num(self.largest("rate")[0], posinf=0.0).max(initial=0.0)
        rates = np.nan_to_num(self.close.joint_rates[[0, -1]], posinf=0.0)
        moving = np.abs(rates) > JUMP * max(float(most), 1e-12)
        return bool(moving[0].any()), bool(moving[1].any())

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
