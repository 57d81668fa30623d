"""What the straight way between two postures of one working mode passes.

Between the places where some limb's |Y| = l all is smooth in t, s = middle − half cos t: there the
zeros of ρ − ρ_min, ρ_max − ρ and of the determinant are sought (`pieces`), crossings by their
change of sign, touches by what the determinant leaves where it is stationary. Poses next to a
singularity that the way passes without meeting it are told up to `NEAR`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.bounds import decimals
from kinematics.answers.singularities import Event
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array, finite
from kinematics.facets.pose_paths import after_part, along
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import LINK_SLACK, STROKE_SLACK
from kinematics.mechanisms.five_rpur.paths.chebyshev import (
    special_points,
    with_middles,
    zero_between,
)
from kinematics.mechanisms.five_rpur.paths.straight import Way

NEAR = 1.0
"""mm, angles times the characteristic length: what is passed so near is told."""
_TOUCH = 1e-6  # mm: what is passed so near is met
_SAME = 1e-9  # of the way: two crossings so close are a touch
_DISTINCT = 1e-6  # of the way: what comes near only so close to an end or a crossing is no more
_STILL = 1e-12  # mm: a shorter way is none


def passed(
    design: FiveRPURDesign, before: Posture, after: Posture, through: ArrayLike = ()
) -> tuple[Event, ...]:
    """What is passed on the way from one posture to another of the same mode.

    The way is straight, or straight from one to the next of the poses ``through`` (N, 5); angles go
    the shorter way round. Of postures in different modes it is only told that no way was driven.

    Returns:
        Events in the order in which they are met; their fractions are of the whole length, angles
        counted by the characteristic length.

    Raises:
        InputError: the poses on the way are not five finite numbers each.
    """
    if before.mode != after.mode:
        return (_other_mode(before, after),)
    corners = [before.pose, *finite(np.reshape(through, (-1, 5)), name="a pose"), after.pose]
    ways = [Way.between(design, a, b, before.mode) for a, b in pairwise(corners)]
    return along(ways, events)


def events(way: Way) -> tuple[Event, ...]:
    """What a way passes, in order."""
    if way.length <= _STILL:
        return ()
    found = list(_reaches(way))
    breaks = sorted({0.0, 1.0, *(s for s, *_ in found)})
    told = [event for *_, event in found]
    for a, b in pairwise(breaks):
        if b - a > _SAME:
            told += _between(way, a, b)
    return tuple(sorted(told, key=lambda event: event.fraction))


# --- the reach of links: serial singularities ----------------------------------------------------


def _reaches(way: Way) -> Iterator[tuple[float, Event]]:
    """Where |Y| = l of a limb, and what happens there."""
    candidates = special_points(way.reach, 0.0, 1.0)
    for column, points in enumerate(candidates):
        i = column // 2
        link = float(way.design.link[i])
        slack = LINK_SLACK * link

        def room(s: float, column: int = column) -> float:
            return float(way.reach(np.array([s]))[0, column])

        x = with_middles(points)
        values = way.reach(x)[:, column]
        values = np.where(np.abs(values) <= slack, 0.0, values)
        for s, leaves in _changes(room, x, values):
            yield s, _serial(way, i, s, leaves)
        # Touched from inside: stationary there, and not beyond.
        for k in range(1, len(x) - 1):
            low = values[k] <= values[k - 1] and values[k] <= values[k + 1]
            if low and 0.0 <= values[k] <= _TOUCH * 1e-3 and values[k - 1] > 0.0 < values[k + 1]:
                yield float(x[k]), _serial(way, i, float(x[k]), None)


def _changes(
    function: Callable[[float], float], x: Array, values: Array
) -> Iterator[tuple[float, bool]]:
    """Where values ≥ 0 become negative or stop to be, and whether they become so."""
    found: list[tuple[float, bool]] = []
    inside = values >= 0.0
    for k in np.flatnonzero(inside[1:] != inside[:-1]).tolist():
        low, high = float(x[k]), float(x[k + 1])
        crosses = function(low) * function(high) <= 0.0
        # Where the way starts on the bound but for rounding, it is passed at once.
        s = zero_between(function, low, high) if crosses else (low if inside[k] else high)
        found.append((s, bool(inside[k])))
    yield from _without_touches(found)


def _without_touches(found: list[tuple[float, bool]]) -> list[tuple[float, bool]]:
    """Crossings without pairs that undo each other at once."""
    kept: list[tuple[float, bool]] = []
    for each in found:
        if kept and each[0] - kept[-1][0] < _SAME and each[1] != kept[-1][1]:
            kept.pop()
        else:
            kept.append(each)
    return kept


# --- strokes and parallel singularities ----------------------------------------------------------


def _between(way: Way, a: float, b: float) -> list[Event]:
    """What is passed where the same limbs close all the way."""
    middle, half = 0.5 * (a + b), 0.5 * (b - a)

    def part(t: Array) -> Array:
        return np.clip(middle - half * np.cos(t), a, b)

    room = way.reach(np.array([middle])).reshape(LIMBS, 2).min(axis=1)
    closing = np.asarray(room >= -LINK_SLACK * way.design.link)
    told = _strokes(way, part, closing)
    if closing.all():
        told += _parallel(way, part)
    return told


def _strokes(way: Way, part: Callable[[Array], Array], closing: NDArray[np.bool_]) -> list[Event]:
    columns = np.flatnonzero(np.repeat(closing, 2))
    # A stroke from zero has no lower end.
    columns = columns[(columns % 2 == 1) | (way.design.stroke[columns // 2, 0] > 0.0)]
    if not len(columns):
        return []

    def rooms(t: Array) -> Array:
        return np.asarray(way.strokes(part(t))[:, columns] / way.size**2)

    told = []
    for n, (column, points) in enumerate(
        zip(columns.tolist(), special_points(rooms, 0.0, np.pi), strict=True)
    ):

        def room(t: float, n: int = n) -> float:
            return float(rooms(np.array([t]))[0, n])

        x = with_middles(points)
        values = rooms(x)[:, n]
        end = float(way.design.stroke[column // 2, column % 2])
        slack = 2.0 * end * STROKE_SLACK / way.size**2
        for k in (0, -1):  # as postures are judged
            if abs(values[k]) <= slack and part(x[k : k + 1 or None])[0] in (0.0, 1.0):
                values[k] = 0.0
        for t, leaves in _changes(room, x, values):
            told.append(_stroke(way, column, float(part(np.array([t]))[0]), leaves))
    return told


def _parallel(way: Way, part: Callable[[Array], Array]) -> list[Event]:
    def values_of(t: Array) -> Array:
        return way.determinant(way.poses(part(t)))[0][:, None]

    def value(t: float) -> float:
        return float(values_of(np.array([t]))[0, 0])

    grid = np.linspace(0.0, np.pi, 49)
    on_grid, noise = way.determinant(way.poses(part(grid)))
    if (np.abs(on_grid) <= noise).all():
        return [_all_along(way, float(part(grid[:1])[0]))]
    (points,) = special_points(values_of, 0.0, np.pi, stationary=True, noise=float(noise.max()))
    x = with_middles(points)
    values, fractions = values_of(x)[:, 0], part(x)
    first, last = float(fractions[0]), float(fractions[-1])
    from_singular = first == 0.0 and way.apart(way.pose(0.0)) <= _TOUCH
    to_singular = last == 1.0 and way.apart(way.pose(1.0)) <= _TOUCH

    def inside(s: float, margin: float) -> bool:
        """Not at an end that is singular itself, or where two links reach their ends at once."""
        after = s > first + margin or (first == 0.0 and not from_singular)
        return after and (s < last - margin or (last == 1.0 and not to_singular))

    crossings = []
    for k in np.flatnonzero((values[1:] >= 0.0) != (values[:-1] >= 0.0)).tolist():
        t = zero_between(value, float(x[k]), float(x[k + 1]))
        crossings.append((float(part(np.array([t]))[0]), bool(values[k] >= 0.0)))
    crossed = [s for s, _ in _without_touches(crossings) if inside(s, _SAME)]
    told = [_crossed(way, s) for s in crossed]
    if from_singular:
        told.append(_ended(way, 0.0))
    if to_singular:
        told.append(_ended(way, 1.0))
    size = np.abs(values)
    for k in range(1, len(x) - 1):
        s = float(fractions[k])
        dips = size[k] < size[k - 1] and size[k] <= size[k + 1]
        apart_from = min(abs(s - c) for c in (first, last, *crossed))
        if dips and apart_from > _DISTINCT:
            apart = way.apart(way.pose(s))
            if apart <= NEAR:
                told.append(_came_near(way, s, apart))
    return told


# --- in words ------------------------------------------------------------------------------------


def _other_mode(before: Posture, after: Posture) -> Event:
    changed = [i for i in range(LIMBS) if before.mode[i] != after.mode[i]]
    which = (
        f"limb {changed[0] + 1}"
        if len(changed) == 1
        else "limbs " + ", ".join(str(i + 1) for i in changed)
    )
    text = (
        f"went to another working mode of {which}; the machine itself comes there only through a "
        "serial singularity"
    )
    limb = changed[0] + 1 if len(changed) == 1 else None
    return Event("serial", 0.0, before.pose, limb, text, True)


def _serial(way: Way, i: int, s: float, leaves: bool | None) -> Event:
    # Two links that are parallel to e₁ at once may be of no more use than one.
    what = "a serial singularity"
    if way.determinant_vanishes(s):
        what = "a serial and a parallel singularity at once"
    if leaves is None:
        text = f"limb {i + 1} touched {what} {after_part(s)}, its link along e₁"
    elif leaves:
        text = (
            f"limb {i + 1} came to the reach of its link {after_part(s)}, {what}, and cannot close "
            "beyond"
        )
    else:
        text = f"limb {i + 1} can close again {after_part(s)}, from {what} on"
    return Event("serial", s, way.pose(s), i + 1, text, leaves is not False)


def _stroke(way: Way, column: int, s: float, leaves: bool) -> Event:
    i, end = divmod(column, 2)
    name = f"ρ {('min', 'max')[end]} = {way.design.stroke[i, end]:g} mm"
    if leaves:
        text = f"limb {i + 1} passed the end of its stroke ({name}) {after_part(s)}"
    else:
        text = f"limb {i + 1} is back within its stroke ({name}) {after_part(s)}"
    return Event("stroke", s, way.pose(s), i + 1, text, leaves)


def _crossed(way: Way, s: float) -> Event:
    text = f"crossed a parallel singularity {after_part(s)}: the machine is now in another aspect"
    return Event("parallel", s, way.pose(s), None, text, True)


def _ended(way: Way, s: float) -> Event:
    text = "started from a parallel singularity" if s == 0.0 else "stands in a parallel singularity"
    return Event("parallel", s, way.pose(s), None, text, s > 0.0)


def _all_along(way: Way, s: float) -> Event:
    text = "all along the way the machine is in a parallel singularity"
    return Event("parallel", s, way.pose(s), None, text, True)


def _came_near(way: Way, s: float, apart: float) -> Event:
    if apart <= _TOUCH:
        text = f"touched a parallel singularity {after_part(s)}, without crossing it"
        return Event("parallel", s, way.pose(s), None, text, True)
    near = f"came as near as {apart:.{decimals(apart)}f} mm to a parallel singularity"
    text = f"{near} {after_part(s)}"
    return Event("parallel", s, way.pose(s), None, text, False)
