"""Where a trajectory leaves the workspace, meets or nears a singularity, leaps or exceeds a limit.

Samples show it roughly; between them the moment is found by halving, and dips that lie between two
samples by a search for the least value, so that a short excursion is not passed over.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import degrees, inf, isfinite, nan

import numpy as np
from numpy.typing import NDArray

from kinematics.mechanism import Coordinate, Design, Mechanism
from kinematics.solutions import Posture
from kinematics.spatial import Array
from kinematics.trajectories.laws import Law
from kinematics.trajectories.paths import Path
from kinematics.trajectories.results import Event, EventKind, Limits, Trajectory

LEAP = 0.5  # rad that a joint may turn more than its rates say, from one sample to the next
_TOUCH = 1e-7  # a determinant, relative to its largest on the way, that is none
_HALVINGS = 50


@dataclass(frozen=True, eq=False)
class Along:
    """A machine on its path: what it is at any time."""

    mechanism: Mechanism
    design: Design
    path: Path
    law: Law
    mode: str

    def pose(self, time: float) -> tuple[float, ...]:
        """At a time, s."""
        s, _, _ = self.law.at([time])
        return tuple(float(v) for v in self.path.at(s)[0][0])

    def posture(self, time: float) -> Posture:
        """At a time, s."""
        return self.mechanism.posture(self.design, self.pose(time), self.mode)

    def room(self, time: float) -> float:
        """How far from its nearest limit, relative to a characteristic length or rad; negative
        beyond it.
        """
        posture = self.posture(time)
        length = self.mechanism.characteristic_length(self.design)
        least = min(
            (m.amount / (length if m.unit == "mm" else 1.0) for m in posture.margins), default=inf
        )
        return least if posture.reachable else min(least, -1e-15)

    def determinant(self, time: float) -> float:
        """Of the wrenches, at a time, s."""
        system = self.mechanism.wrench_system(self.design, [self.pose(time)], self.mode)
        return float(system.determinant[0])

    def distance(self, pose: Sequence[float]) -> float:
        """mm to the nearest parallel or constraint singularity; inf: none; NaN: not known."""
        posture = self.mechanism.posture(self.design, tuple(map(float, pose)), self.mode)
        if not posture.reachable:
            return nan
        found = self.mechanism.clearances(self.design, posture)
        return min((c.distance for c in found if c.kind in ("parallel", "constraint")), default=inf)


def events_of(along: Along, found: Trajectory, limits: Limits, near: float) -> tuple[Event, ...]:
    """All events by time."""
    events = [
        *_outside(along, found),
        *_singular(along, found, near),
        *_leaps(along, found),
        *_beyond(along, found, "rate", found.joint_rates, limits.rates),
        *_beyond(along, found, "acceleration", found.joint_accelerations, limits.accelerations),
        *_beyond(along, found, "force", found.forces, limits.forces),
    ]
    return tuple(sorted(events, key=lambda event: (event.start, event.end)))


# --- the workspace -------------------------------------------------------------------------


def _outside(along: Along, found: Trajectory) -> Iterator[Event]:
    times = found.times
    ok = found.reachable
    for first, last in _runs(~ok):
        start = times[first]
        if first > 0:
            start = _edge(lambda t: along.room(t) >= 0.0, times[first - 1], times[first])
        end = times[last]
        if last + 1 < len(times):
            end = _edge(lambda t: along.room(t) < 0.0, times[last], times[last + 1])
        yield _left(along, float(start), float(end), float(times[first]))
    # Dips between samples that are all inside.
    room = np.array([along.room(t) if o else -1.0 for t, o in zip(times, ok, strict=True)])
    for n in _dips(room):
        low, high = float(times[max(n - 1, 0)]), float(times[min(n + 1, len(times) - 1)])
        if room[max(n - 1, 0)] < 0.0 or room[min(n + 1, len(times) - 1)] < 0.0 or room[n] < 0.0:
            continue
        at = _least(along.room, low, high)
        if along.room(at) < -1e-12:
            start = _edge(lambda t: along.room(t) >= 0.0, low, at)
            end = _edge(lambda t: along.room(t) < 0.0, at, high)
            yield _left(along, start, end, at)


def _left(along: Along, start: float, end: float, within: float) -> Event:
    worst = along.posture(within)
    reasons = worst.reasons
    why = f": {reasons[0].text}" if reasons else ""
    amount = max((r.amount for r in reasons), default=nan)
    where = _place(along, along.pose(start))
    what = "is outside of the workspace" if start <= 0.0 else "leaves the workspace"
    text = f"the path {what} at t = {start:.4f} s, {where}{why}"
    return Event("outside", start, end, along.pose(start), text, -1, amount)


# --- singularities -------------------------------------------------------------------------


def _singular(along: Along, found: Trajectory, near: float) -> Iterator[Event]:
    times, values = found.times, found.determinant
    finite = np.isfinite(values)
    if not finite.any():
        return
    scale = float(np.abs(values[finite]).max())
    told: list[float] = []
    for n in range(len(times) - 1):
        if finite[n] and finite[n + 1] and (values[n] < 0.0) != (values[n + 1] < 0.0):
            same = partial(_same_side, along, bool(values[n] < 0.0))
            at = _edge(same, float(times[n]), float(times[n + 1]))
            told.append(at)
            yield _crossed(along, at, "crosses")
    size = np.where(finite, np.abs(values), np.inf)
    for n in _dips(size):
        low, high = float(times[max(n - 1, 0)]), float(times[min(n + 1, len(times) - 1)])
        if not (finite[max(n - 1, 0)] and finite[min(n + 1, len(times) - 1)]):
            continue
        if any(low <= at <= high for at in told):
            continue
        at = _least(lambda t: abs(along.determinant(t)), low, high)
        value = along.determinant(at)
        if (value < 0.0) != (values[n] < 0.0) or abs(value) <= _TOUCH * scale:
            told.append(at)
            yield _crossed(along, at, "touches")
    known = np.isfinite(found.distance) & (found.distance < near)
    for first, last in _runs(known):
        n = first + int(np.argmin(found.distance[first : last + 1]))
        at = _least(
            lambda t: _or_infinite(along.distance(along.pose(t))),
            float(times[max(n - 1, 0)]),
            float(times[min(n + 1, len(times) - 1)]),
            rounds=20,
        )
        least = min(_or_infinite(along.distance(along.pose(at))), float(found.distance[n]))
        if any(times[first] <= each <= times[last] for each in told):
            continue
        pose = along.pose(at)
        text = (
            f"the path comes within {least:.2g} mm of a singularity at t = {at:.4f} s, "
            f"{_place(along, pose)}"
        )
        yield Event("near", float(times[first]), float(times[last]), pose, text, -1, least)


def _same_side(along: Along, negative: bool, time: float) -> bool:
    return (along.determinant(time) < 0.0) == negative


def _crossed(along: Along, at: float, verb: str) -> Event:
    pose = along.pose(at)
    posture = along.posture(at)
    lost = along.mechanism.singularities(along.design, posture)
    cause = f": {lost[0].cause}" if lost else ""
    text = f"the path {verb} a singularity at t = {at:.4f} s, {_place(along, pose)}{cause}"
    return Event("singularity", at, at, pose, text, -1, 0.0)


def _or_infinite(value: float) -> float:
    return value if isfinite(value) else inf


# --- joints --------------------------------------------------------------------------------


def _leaps(along: Along, found: Trajectory) -> Iterator[Event]:
    step = np.diff(found.times)[:, None]
    expected = 0.5 * step * (found.joint_rates[:-1] + found.joint_rates[1:])
    with np.errstate(invalid="ignore"):
        leap = np.abs(np.diff(found.joints, axis=0) - expected)
    for k, c in enumerate(along.mechanism.joint_coordinates(along.design)):
        if c.unit != "rad":
            continue
        for n in np.flatnonzero(leap[:, k] > LEAP):
            start, end = float(found.times[n]), float(found.times[n + 1])
            turn = abs(float(found.joints[n + 1, k] - found.joints[n, k]))
            text = (
                f"{c.symbol} has to turn by {degrees(turn):.0f}° between t = {start:.4f} s and "
                f"t = {end:.4f} s: the path passes a serial singularity, or nearly"
            )
            yield Event("jump", start, end, along.pose(start), text, k, turn)


def _beyond(
    along: Along,
    found: Trajectory,
    kind: EventKind,
    values: Array,
    allowed: tuple[float, ...] | None,
) -> Iterator[Event]:
    if allowed is None or not values.shape[1]:
        return
    coordinates = along.mechanism.joint_coordinates(along.design)
    for k, c in enumerate(coordinates):
        over = np.abs(values[:, k]) > allowed[k]
        for first, last in _runs(over):
            worst = float(np.abs(values[first : last + 1, k]).max())
            start = _interpolated(found.times, np.abs(values[:, k]), allowed[k], first, -1)
            end = _interpolated(found.times, np.abs(values[:, k]), allowed[k], last, 1)
            unit = _unit(c, kind)
            text = (
                f"{kind} of {c.symbol} reaches {_shown(worst, c, kind):.4g} {unit} from "
                f"t = {start:.3f} s to {end:.3f} s; its limit is "
                f"{_shown(allowed[k], c, kind):.4g} {unit}"
            )
            yield Event(kind, start, end, along.pose(start), text, k, worst)


def _unit(c: Coordinate, kind: EventKind) -> str:
    if kind == "force":
        return "N·mm" if c.unit == "rad" else "N"
    return ("°/s" if c.unit == "rad" else "mm/s") + ("²" if kind == "acceleration" else "")


def _shown(value: float, c: Coordinate, kind: EventKind) -> float:
    return degrees(value) if c.unit == "rad" and kind != "force" else value


# --- between samples -----------------------------------------------------------------------


def _runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last index of every run of true values."""
    padded = np.concatenate([[False], flags, [False]])
    change = np.flatnonzero(padded[1:] != padded[:-1])
    return [(int(a), int(b) - 1) for a, b in zip(change[::2], change[1::2], strict=True)]


def _dips(values: Array) -> list[int]:
    """Where a sampled function is not larger than at both neighbours."""
    left = np.concatenate([[np.inf], values[:-1]])
    right = np.concatenate([values[1:], [np.inf]])
    return [int(n) for n in np.flatnonzero((values <= left) & (values <= right))]


def _edge(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Where something that holds at ``low`` and not at ``high`` ends, by halving."""
    low, high = float(low), float(high)
    for _ in range(_HALVINGS):
        half = 0.5 * (low + high)
        if half in (low, high):
            break
        low, high = (half, high) if holds(half) else (low, half)
    return 0.5 * (low + high)


def _least(function: Callable[[float], float], low: float, high: float, rounds: int = 60) -> float:
    """Where a function is least between two times, by golden sections."""
    ratio = 0.5 * (5.0**0.5 - 1.0)
    a, b = high - ratio * (high - low), low + ratio * (high - low)
    fa, fb = function(a), function(b)
    for _ in range(rounds):
        if fa <= fb:
            high, b, fb = b, a, fa
            a = high - ratio * (high - low)
            fa = function(a)
        else:
            low, a, fa = a, b, fb
            b = low + ratio * (high - low)
            fb = function(b)
    return 0.5 * (low + high)


def _interpolated(times: Array, values: Array, limit: float, n: int, step: int) -> float:
    """The time at which a sampled value passes a limit beside sample n."""
    m = n + step
    if not (0 <= m < len(times)) or not isfinite(values[m]) or values[m] == values[n]:
        return float(times[n])
    share = float((limit - values[n]) / (values[m] - values[n]))
    return float(times[n] + share * (times[m] - times[n]))


def _place(along: Along, pose: Sequence[float]) -> str:
    parts = []
    for c, value in zip(along.mechanism.pose_coordinates(along.design), pose, strict=True):
        shown = f"{degrees(value):.2f}°" if c.unit == "rad" else f"{value:.2f} mm"
        parts.append(f"{c.symbol} = {shown}")
    return ", ".join(parts)
