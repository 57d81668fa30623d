"""The events of a straight move of the pose: reaches, ends of ranges, parallel singularities.

Between the places where some limb stops to close all is smooth in t, s = middle − half cos t: there
the zeros of the ends of ranges and of the determinant are sought, crossings by their change of
sign, touches by what the determinant leaves where it is stationary. Poses next to a singularity
that a move passes without meeting it are told up to `NEAR`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from kinematics.answers.bounds import Bound, decimals
from kinematics.answers.singularities import Event
from kinematics.arrays import Array, runs
from kinematics.facets.inverse import SLACK
from kinematics.facets.segments import Part, Segment
from kinematics.zeros import with_middles, zero_between

if TYPE_CHECKING:
    from kinematics.facets.paths import PathsFacet

NEAR = 1.0
"""mm, angles times the characteristic length: what is passed so near is told."""
_TOUCH = 1e-6  # mm: what is passed so near is met
_AT_REACH = 1e-13  # part of a limb's size by which rounding may carry it over its reach
_TOUCHED = 1e-11  # part of a limb's size: so near to its reach it is met
_CLOSES = 1e-9  # part of a limb's size by which a rounding of s may carry it over its reach
_VANISHES = 1e4  # times the rounding of a determinant that counts as zero where limbs are at reach
_SAME = 1e-9  # of the way: two crossings so close are a touch
_DISTINCT = 1e-6  # of the way: what comes near only so close to an end or a crossing is no more
_STILL = 1e-12  # mm: a shorter way is none


class MoveEvents:
    """What one move passes, as a facet of paths tells it."""

    def __init__(self, paths: PathsFacet[Any], move: Segment) -> None:
        self.paths, self.move = paths, move

    def all(self) -> tuple[Event, ...]:
        """The events in order."""
        if self.move.length <= _STILL:
            return ()
        found = list(self._reaches())
        told = [event for *_, event in found]
        breaks = sorted({0.0, 1.0, *(s for s, *_ in found), *self.paths.breaks(self.move)})
        for a, b in pairwise(breaks):
            if b - a > _SAME:
                told += self._between(Part(a, b))
        return tuple(sorted(told, key=lambda event: event.fraction))

    def _reaches(self) -> Iterator[tuple[float, Event]]:
        """Where limbs come to their reach, and what happens there."""
        if not self.paths.reach_limbs:
            return
        paths, move, part = self.paths, self.move, Part(0.0, 1.0)

        def reach(t: Array) -> Array:
            return paths.reach(move.poses(part.s(t)), move.mode)

        for column, points in enumerate(self.paths.places(self.move, part, reach)):
            limb = self.paths.reach_limbs[column]

            def margin(t: float, column: int = column) -> float:
                return float(reach(np.array([t]))[0, column])

            x = with_middles(points)
            exact = reach(x)[:, column]
            values = np.where(np.abs(exact) <= _AT_REACH, 0.0, exact)
            fractions = part.s(x)
            for t, leaves in _changes(margin, x, values):
                s = float(part.s(np.array([t]))[0])
                yield s, self._serial(limb, s, leaves)
            # Touched from inside: nothing is left there, and it is not passed.
            met = (values >= 0.0) & (values <= _TOUCHED)
            for k, last in runs(met):
                if k > 0 and last < len(x) - 1 and values[k - 1] > 0.0 < values[last + 1]:
                    s = float(fractions[k + int(np.abs(exact[k : last + 1]).argmin())])
                    yield s, self._serial(limb, s, None)

    def _serial(self, limb: int, s: float, leaves: bool | None) -> Event:
        # Two limbs that are at their reach at once may be of no more use than one.
        what, where = "a serial singularity", after_part(s)
        pose = self.move.poses(np.array([s]))
        closes = bool((self.paths.reach(pose, self.move.mode) >= -_CLOSES).all())
        value, noise = self.move.determinant(pose)
        if closes and abs(float(value[0])) <= _VANISHES * float(noise[0]):
            what = "a serial and a parallel singularity at once"
        if leaves is None:
            text = self.paths.touched(limb, what, where)
        elif leaves:
            text = f"limb {limb} came to the end of its reach {where}, {what}, and cannot close "
            text += "beyond"
        else:
            text = f"limb {limb} can close again {where}, from {what} on"
        return Event("serial", s, self.move.pose(s), limb, text, leaves is not False)

    # --- inside: ends of ranges and parallel singularities

    def _between(self, part: Part) -> list[Event]:
        """What is passed where the same limbs close all the way."""
        open_limbs: set[int] = set()
        if self.paths.reach_limbs:
            reach = self.paths.reach(self.move.poses(np.array([part.middle])), self.move.mode)[0]
            limbs = zip(self.paths.reach_limbs, reach, strict=True)
            open_limbs = {limb for limb, value in limbs if value < -_AT_REACH}
        told = self._ranges(part, open_limbs)
        if not open_limbs:
            told += self._parallel(part)
        return told

    def _ranges(self, part: Part, open_limbs: set[int]) -> list[Event]:
        paths, move = self.paths, self.move
        middle = paths.ranges(move.poses(np.array([part.middle])), move.mode)[0]
        columns = [
            n
            for n, (bound, end) in enumerate(self.paths.ends)
            if bound.limb not in open_limbs
            and np.isfinite(middle[n])  # else there is no such end
            and not (bound.end == "min" and bound.unit == "mm" and end == 0.0)
        ]
        if not columns:
            return []

        def margins(t: Array) -> Array:
            return paths.ranges(move.poses(part.s(t)), move.mode)[:, columns]

        whole = {0: part.a == 0.0, -1: part.b == 1.0}  # ends of the move itself
        on_end = {k: np.abs(self._margins(float(k != 0))) <= SLACK for k in whole if whole[k]}
        told = []
        for n, points in enumerate(self.paths.places(self.move, part, margins)):

            def margin(t: float, n: int = n) -> float:
                return float(margins(np.array([t]))[0, n])

            x = with_middles(points)
            values = margins(x)[:, n]
            column = columns[n]
            for k in whole:
                if k not in on_end:  # there another limb is at its reach: as next to it
                    values[k] = values[1 if k == 0 else -2]
                elif on_end[k][column]:  # as postures are judged
                    values[k] = 0.0
            bound, end = self.paths.ends[column]
            for t, leaves in _changes(margin, x, values):
                s = float(part.s(np.array([t]))[0])
                if bound.unit == "mm" or self._is_met(column, s):
                    told.append(_range_event(self.move, bound, end, s, leaves))
        return told

    def _is_met(self, column: int, s: float) -> bool:
        """Whether it is this end of a joint's range that is met at s, and not the other one."""
        margins, limb = np.abs(self._margins(s)), self.paths.ends[column][0].limb
        own = [n for n, (bound, _) in enumerate(self.paths.ends) if bound.limb == limb]
        return bool(margins[column] <= margins[own].min())

    def _margins(self, s: float) -> Array:
        """(B,) of the ends of ranges, mm or rad."""
        mechanism, mode = self.paths.mechanism, self.move.mode
        poses = self.move.poses(np.array([s]))
        margins = mechanism.margins(poses, mode, mechanism.joints(poses, mode))[0]
        return np.asarray(margins[[b.end in ("min", "max") for b in mechanism.bounds]])

    def _parallel(self, part: Part) -> list[Event]:
        def values_of(t: Array) -> Array:
            return self.move.determinant(self.move.poses(part.s(t)))[0][:, None]

        def value(t: float) -> float:
            return float(values_of(np.array([t]))[0, 0])

        on_grid, noises = self.move.determinant(
            self.move.poses(part.s(np.linspace(0.0, np.pi, 49)))
        )
        if (np.abs(on_grid) <= noises).all():
            text = "all along the way the machine is in a parallel singularity"
            return [_parallel_event(self.move, part.a, text)]
        noise = float(noises.max())
        (points,) = self.paths.places(self.move, part, values_of, stationary=True, noise=noise)
        x = with_middles(points)
        values, fractions = values_of(x)[:, 0], part.s(x)
        first, last = float(fractions[0]), float(fractions[-1])
        starts = first == 0.0 and self.move.to_singularity(self.move.pose(0.0)) <= _TOUCH
        stands = last == 1.0 and self.move.to_singularity(self.move.pose(1.0)) <= _TOUCH

        def inside(s: float) -> bool:
            """Not at an end that is singular itself, or where two limbs are at their reach."""
            after = s > first + _SAME or (first == 0.0 and not starts)
            return after and (s < last - _SAME or (last == 1.0 and not stands))

        crossings = []
        for k in np.flatnonzero((values[1:] >= 0.0) != (values[:-1] >= 0.0)).tolist():
            t = zero_between(value, float(x[k]), float(x[k + 1]))
            crossings.append((float(part.s(np.array([t]))[0]), bool(values[k] >= 0.0)))
        crossed = [s for s, _ in _without_touches(crossings) if inside(s)]
        told = [
            _parallel_event(
                self.move,
                s,
                f"crossed a parallel singularity {after_part(s)}: the machine is now in another "
                "aspect",
            )
            for s in crossed
        ]
        if starts:
            text = "started from a parallel singularity"
            told.append(_parallel_event(self.move, 0.0, text, stops=False))
        if stands:
            told.append(_parallel_event(self.move, 1.0, "stands in a parallel singularity"))
        size = np.abs(values)
        for k in range(1, len(x) - 1):
            s = float(fractions[k])
            dips = size[k] < size[k - 1] and size[k] <= size[k + 1]
            if dips and min(abs(s - c) for c in (first, last, *crossed)) > _DISTINCT:
                away = self.move.to_singularity(self.move.pose(s))
                if away <= _TOUCH:
                    text = f"touched a parallel singularity {after_part(s)}, without crossing it"
                    told.append(_parallel_event(self.move, s, text))
                elif away <= NEAR:
                    near = f"came as near as {away:.{decimals(away)}f} mm to a parallel singularity"
                    told.append(
                        _parallel_event(self.move, s, f"{near} {after_part(s)}", stops=False)
                    )
        return told


def after_part(s: float) -> str:
    """Where on a way, in words."""
    return f"after {100.0 * s:.3g} % of the way"


def shown_end(bound: Bound, end: float) -> str:
    """An end of a range with its number, as \"ρ max = 400 mm\"."""
    number = f"{np.degrees(end):g}°" if bound.unit == "rad" else f"{end:g} mm"
    return f"{bound.name} = {number}"


def _range_event(move: Segment, bound: Bound, end: float, s: float, leaves: bool) -> Event:
    who, what = (f"limb {bound.limb}", "stroke") if bound.unit == "mm" else (bound.joint, "range")
    did = f"passed the end of its {what}" if leaves else f"is back within its {what}"
    text = f"{who} {did} ({shown_end(bound, end)}) {after_part(s)}"
    return Event("stroke", s, move.pose(s), bound.limb, text, leaves)


def _parallel_event(move: Segment, s: float, text: str, *, stops: bool = True) -> Event:
    return Event("parallel", s, move.pose(s), None, text, stops)


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
        t = zero_between(function, low, high) if crosses else (low if inside[k] else high)
        found.append((t, bool(inside[k])))
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
