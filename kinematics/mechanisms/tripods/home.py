"""The posture that a review of a 3-RPS or 3-SPR starts from, and what its radii mean."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from kinematics.answers.solutions import Finding, Posture, Severity
from kinematics.arrays import Array
from kinematics.facets.inverse import posture
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import MODES, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.limbs import limb_lengths
from kinematics.mechanisms.tripods.micr import micr
from kinematics.screws.spatial import decimals

_LEVELS, _TILTS, _AZIMUTHS = 41, 19, 24  # of the grid that is searched where level is out of reach


def reach(design: TripodDesign) -> float:
    """No altitude beyond ± this is within the strokes, mm, rounded outwards to 10 mm.

    The limbs' mean upward part is the altitude in the frame of the revolute joints; in that of
    the spherical ones O′ is up to their circumradius further away.
    """
    longest = design.stroke[1]
    if not design.revolute_on_base:
        longest = float(np.hypot(longest, design.base_radius))
    step = 10.0 ** (1 - decimals(longest))
    return float(np.ceil(longest / step) * step)


def level_span(design: TripodDesign, mode: str) -> tuple[float, float] | None:
    """The altitudes Z ≥ 0 that the level platform can have, mm; None if it can have none."""
    aside = abs(mode_sign(mode) * design.platform_radius - design.base_radius)
    low, high = design.stroke
    if high <= aside:
        return None
    up = float(np.sqrt(high**2 - aside**2))
    return float(np.sqrt(max(low**2 - aside**2, 0.0))), up


@lru_cache(maxsize=64)
def home(design: TripodDesign) -> Posture:
    """Level, in operation mode 2 if possible, the limbs in the middle of their strokes.

    Where the level platform is out of reach, the posture with most margin above the base; where
    nothing is reachable, the one that misses by least.
    """
    for mode in reversed(MODES):
        span = level_span(design, mode)
        if span is None:
            continue
        aside = mode_sign(mode) * design.platform_radius - design.base_radius
        middle = 0.5 * sum(design.stroke)
        z = float(np.sqrt(max(middle**2 - aside**2, 0.0)))
        z = z if span[0] < z < span[1] else 0.5 * (span[0] + span[1])
        whole = float(np.round(z, decimals(z)))
        found = posture(design, (whole if span[0] < whole < span[1] else z, 0.0, 0.0), mode)
        if found.reachable:
            return found
    return _widest(design)


def _widest(design: TripodDesign) -> Posture:
    top = reach(design)
    axes = (
        np.linspace(0.02 * top, top, _LEVELS),
        np.linspace(0.0, np.pi, _TILTS),
        np.linspace(-np.pi, np.pi, _AZIMUTHS, endpoint=False),
    )
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, posing.POSE)
    best: tuple[float, Array, str] | None = None
    low, high = design.stroke
    for mode in reversed(MODES):
        lengths = limb_lengths(design, grid, mode)
        margin = np.minimum(lengths - low, high - lengths).min(axis=-1)
        margin = np.where(np.isfinite(margin), margin, -np.inf)
        n = int(margin.argmax())
        if best is None or margin[n] > best[0]:
            best = float(margin[n]), grid[n], mode
    assert best is not None
    return posture(design, best[1], best[2])


def findings(design: TripodDesign) -> tuple[Finding, ...]:
    """What the radii mean for the machine."""
    found: list[Finding] = []

    def tell(severity: Severity, title: str, text: str, limbs: tuple[int, ...] = ()) -> None:
        found.append(Finding(severity, title, text, limbs))

    start = home(design)
    if not start.reachable:
        tell(
            "warning",
            "Empty workspace",
            "No pose was found within the strokes: "
            f"{start.reasons[0].text}. Lengthen the stroke or bring the radii closer together.",
        )
    elif start.pose[1] == 0.0:
        circles = []
        for mode in MODES:
            one = micr(
                design.mechanism, design.base_radius, design.platform_radius, start.pose[0], mode
            )
            text = f"{np.degrees(float(one.radius)):.2f}°" if np.isfinite(one.radius) else "none"
            circles.append(f"{text} in operation mode {mode}")
        tell(
            "info",
            "Singularity-free circle",
            f"From the level platform at Z = {start.pose[0]:g} mm the nearest actuation "
            f"singularity is at a tilt of {' and '.join(circles)}.",
        )
    if design.spherical_radius == 2.0 * design.revolute_radius:
        tell(
            "warning",
            "Self-motion with equal limbs",
            "The triangle of the spherical joints is exactly twice as large as that of the "
            "revolute ones: with three equal limbs there are poses in operation mode 2 where "
            "the platform moves although all actuators are locked.",
        )
    return tuple(found)
