"""Where a trajectory leaves the workspace or meets or nears a singularity; all events by time.

Samples show it roughly; between them the moment is found by halving, and dips that lie between two
samples by a search for the least value, so that a short excursion is not passed over.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import pairwise
from math import inf, isfinite, nan

import numpy as np

from kinematics.answers.trajectories import Event, Limits, Trajectory
from kinematics.arrays import Array, runs
from kinematics.trajectories.along import Along
from kinematics.trajectories.demands import beyond, corners, leaps, place
from kinematics.trajectories.searches import edge, least

_SAME = 1e-7  # of the duration: what is nearer is one event
_TOUCH = 1e-7  # a determinant, relative to its largest on the way, that is none


def events_of(along: Along, found: Trajectory, limits: Limits, near: float) -> tuple[Event, ...]:
    """All events by time."""
    events = [
        *_outside(along, found),
        *_singular(along, found, near),
        *leaps(along, found),
        *corners(along, found),
        *beyond(along, found, limits),
    ]
    return tuple(sorted(events, key=lambda event: (event.start, event.end)))


# --- the workspace -------------------------------------------------------------------------


def _outside(along: Along, found: Trajectory) -> Iterator[Event]:
    times = found.times
    ok = found.reachable
    room = np.array([along.room_of(pose) for pose in found.poses.tolist()])
    for first, last in runs(~ok):
        start, end = float(times[first]), float(times[last])
        if first > 0:
            start = edge(lambda t: along.room(t) >= 0.0, times[first - 1], times[first])
        if last + 1 < len(times):
            end = edge(lambda t: along.room(t) < 0.0, times[last], times[last + 1])
        n = first + int(np.argmin(room[first : last + 1]))
        low, high = max(start, times[max(n - 1, 0)]), min(end, times[min(n + 1, len(times) - 1)])
        lowest = partial(_known_room, along)
        at = least(lowest, float(low), float(high))
        worst = min((float(times[n]), at, start, end), key=lowest)
        yield _left(along, found, start, end, worst)
    # Dips between samples that are all inside.
    for n in _dips(np.where(ok, room, -1.0)):
        low, high = float(times[max(n - 1, 0)]), float(times[min(n + 1, len(times) - 1)])
        if not ok[max(n - 1, 0) : n + 2].all():
            continue
        at = least(along.room, low, high)
        if along.room(at) < -1e-12:
            start = edge(lambda t: along.room(t) >= 0.0, low, at)
            end = edge(lambda t: along.room(t) < 0.0, at, high)
            yield _left(along, found, start, end, at)


def _known_room(along: Along, time: float) -> float:
    return _or_infinite(along.room(time))


def _left(along: Along, found: Trajectory, start: float, end: float, at: float) -> Event:
    reasons = sorted(along.posture(at).reasons, key=lambda r: -r.amount)
    amount = max((r.amount for r in reasons), default=nan)
    begun = start <= 0.0
    what = "is outside of the workspace" if begun else "leaves the workspace"
    text = f"the path {what} at t = {start:.4f} s, {place(along, along.pose(start))}"
    back = "and does not come back" if not begun else "and never gets into it"
    if end < found.duration:
        back = f"and comes {'in' if begun else 'back'} at t = {end:.4f} s"
    text += f", {back}"
    if reasons:
        where = place(along, along.pose(at))
        text += f"; farthest beyond at t = {at:.4f} s, {where}: {reasons[0].text}"
    return Event("outside", start, end, along.pose(start), text, -1, amount, at)


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
            told.append(edge(same, float(times[n]), float(times[n + 1])))
    slack = _SAME * found.duration
    touched = [b for a, b in pairwise(told) if b - a <= slack]  # to the other side and back
    for at in told:
        if not any(abs(at - each) <= slack for each in touched):
            yield _crossed(along, at, "crosses")
    for at in touched:
        yield _crossed(along, at, "touches")
    size = np.where(finite, np.abs(values), np.inf)
    for n in _dips(size):
        low, high = float(times[max(n - 1, 0)]), float(times[min(n + 1, len(times) - 1)])
        if not (finite[max(n - 1, 0)] and finite[min(n + 1, len(times) - 1)]):
            continue
        if any(low - slack <= at <= high + slack for at in told):
            continue
        at = least(lambda t: abs(along.determinant(t)), low, high)
        value = along.determinant(at)
        if (value < 0.0) != (values[n] < 0.0) or abs(value) <= _TOUCH * scale:
            told.append(at)
            yield _crossed(along, at, "touches")
    known = np.isfinite(found.distance) & (found.distance < near)
    for first, last in runs(known):
        n = first + int(np.argmin(found.distance[first : last + 1]))
        low, high = float(times[max(first - 1, 0)]), float(times[min(last + 1, len(times) - 1)])
        if any(low - slack <= each <= high + slack for each in told):
            continue  # it is this one that is near
        at = least(
            lambda t: _or_infinite(along.distance(along.pose(t))),
            float(times[max(n - 1, 0)]),
            float(times[min(n + 1, len(times) - 1)]),
            rounds=20,
        )
        distance = _or_infinite(along.distance(along.pose(at)))
        if distance > found.distance[n]:
            at, distance = float(times[n]), float(found.distance[n])
        pose = along.pose(at)
        text = (
            f"the path comes within {distance:.2g} mm of a singularity at t = {at:.4f} s, "
            f"{place(along, pose)}"
        )
        yield Event("near", float(times[first]), float(times[last]), pose, text, -1, distance, at)


def _same_side(along: Along, negative: bool, time: float) -> bool:
    return (along.determinant(time) < 0.0) == negative


def _crossed(along: Along, at: float, verb: str) -> Event:
    pose = along.pose(at)
    posture = along.posture(at)
    lost = along.machine.singularities.at(posture)
    cause = f": {lost[0].cause}" if lost else ""
    text = f"the path {verb} a singularity at t = {at:.4f} s, {place(along, pose)}{cause}"
    return Event("singularity", at, at, pose, text, -1, 0.0, at)


def _or_infinite(value: float) -> float:
    return value if isfinite(value) else inf


def _dips(values: Array) -> list[int]:
    """Where a sampled function is not larger than at both neighbours."""
    left = np.concatenate([[np.inf], values[:-1]])
    right = np.concatenate([values[1:], [np.inf]])
    return [int(n) for n in np.flatnonzero((values <= left) & (values <= right))]
