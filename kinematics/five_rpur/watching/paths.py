"""Following a polyline of poses in one working mode, up to what would stop the machine."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from kinematics.errors import InputError
from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.five_rpur.inverse import posture
from kinematics.five_rpur.watching.nearness import warning
from kinematics.five_rpur.watching.passing import events
from kinematics.five_rpur.watching.way import Way
from kinematics.singularities import Event
from kinematics.solutions import Followed, Posture
from kinematics.spatial import finite

GAP = 0.01
"""mm, angles times the characteristic length, by which a path stops before a singularity."""


def path(design: FiveRPURDesign, start: Posture, poses: ArrayLike) -> Followed:
    """Follow straight lines through poses (N, 5), in the start's mode, angles the shorter way.

    The path stops `GAP` before a parallel or serial singularity that it would cross or touch, and
    at a stroke end that it would pass. From a parallel singularity it may lead away.

    Returns:
        The posture reached, what stopped it, and what else was passed; ``fraction`` of the whole
        length, angles counted by the characteristic length.

    Raises:
        InputError: no poses, or not five finite numbers each.
    """
    targets = finite(poses, name="a pose", last=5)
    if targets.ndim != 2 or not len(targets):
        raise InputError("a path must be a list of poses of 5 numbers (x, y, z, φ, θ)")
    if not start.reachable:
        return Followed(start, "stalled", f"cannot start: {start.reasons[0].text}", 0.0)
    corners = np.concatenate([[start.pose], targets])
    ways = [Way.between(design, a, b, start.mode) for a, b in pairwise(corners)]
    lengths = np.array([way.length for way in ways])
    whole, done = float(lengths.sum()), 0.0
    notes: list[str] = []
    here = start
    for way, length in zip(ways, lengths.tolist(), strict=True):
        for event in events(way):
            if event.stops:
                s = _before(event, length)
                here = _reached(design, way, s, start.mode, here)
                return _stopped(design, event, here, (done + s * length) / whole, notes)
            notes.append(event.text)
        here = posture(design, way.pose(1.0), start.mode)
        done += length
    text = "; ".join(notes)
    return Followed(here, "target", text, 1.0, warning=warning(design, here))


def _before(event: Event, length: float) -> float:
    """Where to stop: at a stroke end itself, before a singularity."""
    if event.kind == "stroke":
        return event.fraction
    return max(event.fraction - GAP / length, 0.0)


def _reached(design: FiveRPURDesign, way: Way, s: float, mode: str, here: Posture) -> Posture:
    """The posture at s, or a rounding before it; where even that cannot be held, the one before."""
    for back in (0.0, 1e-15, 1e-13, 1e-11, 1e-9):
        there = posture(design, way.pose(max(s - back, 0.0)), mode)
        if there.reachable:
            return there
    return here


def _stopped(
    design: FiveRPURDesign, event: Event, here: Posture, fraction: float, notes: list[str]
) -> Followed:
    covered = f"after {100.0 * fraction:.3g} % of the way"
    if event.kind == "stroke":
        limb = event.limb or 1
        rho = here.joints[limb - 1]
        low, high = design.limbs[limb - 1].stroke
        name, end = ("min", low) if abs(rho - low) < abs(rho - high) else ("max", high)
        text = f"limb {limb} is at the end of its stroke (ρ {name} = {end:g} mm) {covered}"
    elif event.kind == "serial":
        text = f"stopped at a serial singularity of limb {event.limb} {covered}"
    else:
        text = f"stopped at a parallel singularity {covered}"
    return Followed(
        here,
        "stroke" if event.kind == "stroke" else "singularity",
        "; ".join([*notes, text]),
        fraction,
        event.limb,
        warning(design, here, stopped=event.kind != "stroke"),
    )
