"""What a trajectory demands of single actuators and they may not do: leaps, corners, limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil, degrees, isfinite
from typing import NamedTuple

import numpy as np

from kinematics.answers.trajectories import Event, Limits, Quantity, Trajectory
from kinematics.arrays import runs
from kinematics.mechanism import Coordinate
from kinematics.trajectories.along import Along
from kinematics.trajectories.between import crossings

LEAP = 0.5  # rad that a joint may turn more than its rates say
MOMENT = 1.0 / 4096  # of the duration: what happens within it happens at once
SINGLY = 12  # corners that are told one by one; more are told together
_OVER = 1e-9  # relative: what is beyond a limit by less is at it
_QUANTITIES: tuple[Quantity, ...] = ("rate", "acceleration", "force")


def leaps(along: Along, found: Trajectory) -> Iterator[Event]:
    """Joints that turn far at once, which their rates do not tell."""
    times = found.times
    for n in np.flatnonzero(_leap(times, found.joints, found.joint_rates).any(axis=1)):
        # So coarse are the samples, perhaps: closer by, what its rates tell is none.
        count = max(1, ceil((times[n + 1] - times[n]) / (MOMENT * found.duration)))
        fine = np.linspace(times[n], times[n + 1], count + 1)
        joints, _ = along.joints(fine)
        over = _leap(fine, joints, along.asked(fine, None)[0])
        for k, c in enumerate(along.machine.joints):
            if c.unit != "rad":
                continue
            for first, last in runs(over[:, k]):
                start, end = float(fine[first]), float(fine[last + 1])
                turn = abs(float(joints[last + 1, k] - joints[first, k]))
                text = (
                    f"{c.symbol} has to turn by {degrees(turn):.0f}° between t = {start:.4f} s and "
                    f"t = {end:.4f} s: the path passes a serial singularity, or nearly"
                )
                yield Event("jump", start, end, along.pose(start), text, k, turn, start)


def _leap(times: np.ndarray, joints: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """(N − 1, J): where joints turn by more than `LEAP` beyond what their rates say."""
    before, after = rates[:-1], rates[1:]
    before = np.where(np.isnan(before), after, before)  # there are none at a singularity
    after = np.where(np.isnan(after), before, after)
    expected = np.nan_to_num(0.5 * np.diff(times)[:, None] * (before + after))
    with np.errstate(invalid="ignore"):
        found: np.ndarray = np.abs(np.diff(joints, axis=0) - expected) > LEAP
    return found


def corners(along: Along, found: Trajectory) -> Iterator[Event]:
    """Corners of the path that are passed at speed: rates leap there."""
    close = found.close
    if not len(close.corners):
        return
    sizes = np.abs(close.leaps)
    if len(close.corners) <= SINGLY:
        for at, row in zip(close.corners.tolist(), sizes, strict=True):
            k = int(row.argmax())
            pose = along.pose(at)
            text = (
                f"the path has a sharp corner at t = {at:.4f} s, {place(along, pose)}, and passes "
                f"it at speed: the rate of {_leaping(along, k, float(row[k]))}, which no finite "
                "acceleration does"
            )
            yield Event("corner", at, at, pose, text, k, float(row[k]), at)
        return
    n, k = (int(i) for i in np.unravel_index(sizes.argmax(), sizes.shape))
    start, end = float(close.corners[0]), float(close.corners[-1])
    text = (
        f"the path has {len(sizes)} sharp corners between t = {start:.4f} s and t = {end:.4f} s, "
        f"and passes them at speed: at t = {close.corners[n]:.4f} s the rate of "
        f"{_leaping(along, k, float(sizes[n, k]))}, which no finite acceleration does"
    )
    at = float(close.corners[n])
    yield Event("corner", start, end, along.pose(start), text, k, float(sizes[n, k]), at)


def _leaping(along: Along, k: int, size: float) -> str:
    c = along.machine.joints[k]
    return f"{c.symbol} leaps by {shown(size, c, 'rate'):.4g} {unit(c, 'rate')}"


def beyond(along: Along, found: Trajectory, limits: Limits) -> Iterator[Event]:
    """Limits of the actuators that are exceeded, from when to when and by how much."""
    close, spans = found.close, _spans(found, limits)
    if not spans:
        return
    last = len(close.times) - 1
    edges = [(s.first, max(s.first - 1, 0)) for s in spans]
    edges += [(s.last, min(s.last + 1, last)) for s in spans]
    inside, outside = (close.times[list(each)] for each in zip(*edges, strict=True))
    column = np.array([s.column for s in spans] * 2)
    limit = np.array([s.limit for s in spans] * 2)
    passed = crossings(along, found.load, column, limit, inside, outside).reshape(2, -1)
    coordinates = along.machine.joints
    for span, start, end in zip(spans, *passed.tolist(), strict=True):
        c, what = coordinates[span.joint], span.what
        mark = unit(c, what)
        reached = (
            f"reaches {shown(span.worst, c, what):.4g} {mark} at t = {span.at:.3f} s"
            if isfinite(span.worst)
            else f"grows without end towards t = {span.at:.3f} s"
        )
        text = (
            f"{what} of {c.symbol} {reached}; from t = {start:.3f} s to {end:.3f} s it is beyond "
            f"its limit, {shown(span.limit, c, what):.4g} {mark}"
        )
        yield Event(what, start, end, along.pose(start), text, span.joint, span.worst, span.at)


class _Span(NamedTuple):
    """A run of closer times, from ``first`` to ``last``, at which a quantity is too large."""

    what: Quantity
    joint: int
    column: int  # of rates, accelerations and forces side by side
    limit: float
    first: int
    last: int
    worst: float
    at: float


def _spans(found: Trajectory, limits: Limits) -> list[_Span]:
    close, spans, before = found.close, [], 0
    values = (close.joint_rates, close.joint_accelerations, close.forces)
    allowed = (limits.rates, limits.accelerations, limits.forces)
    for what, array, bounds in zip(_QUANTITIES, values, allowed, strict=True):
        for k, (column, limit) in enumerate(zip(array.T, bounds or (), strict=False)):
            sizes = np.abs(column)
            with np.errstate(invalid="ignore"):
                over = sizes > limit * (1.0 + _OVER)
            for first, last in runs(over):
                n = first + int(np.argmax(sizes[first : last + 1]))
                worst, at = float(sizes[n]), float(close.times[n])
                spans.append(_Span(what, k, before + k, limit, first, last, worst, at))
        before += array.shape[1]
    return spans


def unit(c: Coordinate, what: Quantity) -> str:
    """The unit in which people read a quantity of a joint."""
    if what == "force":
        return "N·mm" if c.unit == "rad" else "N"
    return ("°/s" if c.unit == "rad" else "mm/s") + ("²" if what == "acceleration" else "")


def shown(value: float, c: Coordinate, what: Quantity) -> float:
    """A quantity of a joint in that unit."""
    return degrees(value) if c.unit == "rad" and what != "force" else value


def place(along: Along, pose: Sequence[float]) -> str:
    """ "x = −69.65 mm, y = 804.00 mm"."""
    parts = []
    for c, value in zip(along.machine.coordinates, pose, strict=True):
        number = f"{degrees(value):.2f}°" if c.unit == "rad" else f"{value:.2f} mm"
        parts.append(f"{c.symbol} = {number.replace('-', '−')}")
    return ", ".join(parts)
