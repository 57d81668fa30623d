"""Following a polyline of poses in one working mode, up to what would stop the machine."""

from __future__ import annotations

from itertools import pairwise

from numpy.typing import ArrayLike

from kinematics.answers.singularities import Event
from kinematics.answers.solutions import Followed, Posture
from kinematics.facets.inverse import posture
from kinematics.facets.pose_paths import after_part, corners_of, follow_ways
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.paths.events import events
from kinematics.mechanisms.five_rpur.paths.nearness import warning
from kinematics.mechanisms.five_rpur.paths.straight import Way

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
    corners = [start.pose, *corners_of(poses, ("x", "y", "z", "φ", "θ"))]
    return follow_ways(
        start,
        [Way.between(design, a, b, start.mode) for a, b in pairwise(corners)],
        events=events,
        posture=lambda pose: posture(design, pose, start.mode),
        back=lambda way: GAP / way.length,
        why=lambda event, here, covered: _why(design, event, here, covered),
        warning=lambda here, stopped: warning(design, here, stopped=stopped),
    )


def _why(design: FiveRPURDesign, event: Event, here: Posture, covered: float) -> str:
    if event.kind == "stroke":
        limb = event.limb or 1
        rho = here.joints[limb - 1]
        low, high = design.limbs[limb - 1].stroke
        name, end = ("min", low) if abs(rho - low) < abs(rho - high) else ("max", high)
        at_end = f"limb {limb} is at the end of its stroke (ρ {name} = {end:g} mm)"
        return f"{at_end} {after_part(covered)}"
    if event.kind == "serial":
        return f"stopped at a serial singularity of limb {event.limb} {after_part(covered)}"
    return f"stopped at a parallel singularity {after_part(covered)}"
