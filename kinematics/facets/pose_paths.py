"""Ways through several poses: what they pass, and paths that stop where they have to.

A mechanism knows what one straight way passes (its events, in order); here such ways are strung
together. Lengths mm, angles weighed by a length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.singularities import Event
from kinematics.answers.solutions import Followed, Posture
from kinematics.arrays import Array, finite
from kinematics.errors import InputError

_ROUNDINGS = (0.0, 1e-15, 1e-13, 1e-11, 1e-9)  # of a way, by which a posture may be held again


class Way(Protocol):
    """A way from one pose (at s = 0) to another (s = 1)."""

    @property
    def length(self) -> float:
        """mm, angles weighed by a length."""
        ...

    def pose(self, s: float) -> tuple[float, ...]:
        """The pose at s."""
        ...


W = TypeVar("W", bound=Way)


def after_part(s: float) -> str:
    """Where on a way, in words."""
    return f"after {100.0 * s:.3g} % of the way"


def corners_of(poses: ArrayLike, symbols: Sequence[str]) -> Array:
    """The poses (N, P) of a path.

    Raises:
        InputError: no poses, or not as many finite numbers each as there are symbols.
    """
    targets = finite(poses, name="a pose", last=len(symbols))
    if targets.ndim != 2 or not len(targets):
        names = ", ".join(symbols)
        raise InputError(f"a path must be a list of poses of {len(symbols)} numbers ({names})")
    return targets


def along(ways: Sequence[W], events: Callable[[W], Sequence[Event]]) -> tuple[Event, ...]:
    """What ways one after another pass; fractions are of the whole length."""
    if len(ways) == 1:
        return tuple(events(ways[0]))
    lengths = np.array([way.length for way in ways])
    whole, done = float(lengths.sum()), 0.0
    told: list[Event] = []
    for way, length in zip(ways, lengths.tolist(), strict=True):
        for event in events(way):
            fraction = (done + event.fraction * length) / whole
            text = event.text.replace(after_part(event.fraction), after_part(fraction))
            told.append(replace(event, fraction=fraction, text=text))
        done += length
    return tuple(told)


def follow_ways(
    start: Posture,
    ways: Sequence[W],
    *,
    events: Callable[[W], Sequence[Event]],
    posture: Callable[[tuple[float, ...]], Posture],
    back: Callable[[W], float],
    why: Callable[[Event, Posture, float], str],
    warning: Callable[[Posture, bool], str] = lambda _, __: "",
) -> Followed:
    """Follow ways one after another, up to what would stop the machine.

    A path stops at the end of a stroke itself, but before a singularity.

    Args:
        start: the posture in which the first way begins.
        back: by which part of a way it stops before a singularity.
        why: what is said of the event that stops it, from the posture reached and the part of the
            whole length that is covered.
        warning: a word next to a singularity, and whether one has just stopped the path.

    Returns:
        The posture reached, what stopped it, and what else was passed; ``fraction`` of the whole
        length.
    """
    if not start.reachable:
        return Followed(start, "stalled", f"cannot start: {start.reasons[0].text}", 0.0)
    lengths = np.array([way.length for way in ways])
    whole, done = float(lengths.sum()), 0.0
    notes: list[str] = []
    here = start
    for way, length in zip(ways, lengths.tolist(), strict=True):
        for event in events(way):
            if not event.stops:
                notes.append(event.text)
                continue
            at_end = event.kind == "stroke"
            s = event.fraction if at_end else max(event.fraction - back(way), 0.0)
            here = _reached(way, s, posture, here)
            covered = (done + s * length) / whole
            return Followed(
                here,
                "stroke" if at_end else "singularity",
                "; ".join([*notes, why(event, here, covered)]),
                covered,
                event.limb,
                warning(here, not at_end),
            )
        here = posture(way.pose(1.0))
        done += length
    return Followed(here, "target", "; ".join(notes), 1.0, warning=warning(here, False))


def _reached(
    way: Way, s: float, posture: Callable[[tuple[float, ...]], Posture], here: Posture
) -> Posture:
    """The posture at s, or a rounding before it; where even that cannot be held, the one before."""
    for back in _ROUNDINGS:
        there = posture(way.pose(max(s - back, 0.0)))
        if there.reachable:
            return there
    return here
