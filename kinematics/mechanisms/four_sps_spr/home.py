"""The posture that a review of a design starts from, and the box that the platform can reach."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.inverse import posture
from kinematics.mechanisms.four_sps_spr import inverse
from kinematics.mechanisms.four_sps_spr.constraint import complete_pose
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import rotation, violation
from kinematics.screws.spatial import common_box, decimals

GRID = 25  # positions tried along each axis of the plane
_EXACT = 1e-12  # of the size
ROUNDS = 14  # halvings of the step while the best position is improved
TILTS = ((0.0, 0.0, 0.0), *((0.0, b, c) for b in (0.2, -0.2) for c in (0.2, -0.2)))
"""Orientations tried in turn, (α, β, γ): level first."""


@lru_cache(maxsize=64)
def reach(design: FourSPSSPRDesign) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """A box that holds p whatever the orientation, rounded outwards to 10 mm: lows and highs."""
    radius = design.stroke[:, 1] + np.linalg.norm(design.platform, axis=1)
    low, high = common_box(design.base, radius)  # limbs apart: what one of them reaches
    return low, high


@lru_cache(maxsize=64)
def home(design: FourSPSSPRDesign) -> Posture:
    """Level if the machine can be, above its base, with the largest smallest margin.

    On the z axis if the constraint allows it, as in Wang et al. (2017) at the initial time. Where
    nothing is reachable at any of `TILTS`, the posture that misses by least. Whether the posture is
    singular does not matter: a design that is, at home, says so (`findings`).
    """
    fallback: tuple[float, Posture] | None = None
    upright = _on_axis(design)
    if upright is not None:
        return upright
    for above in (True, False):
        for angles in TILTS:
            position, margin = _widest(design, angles, above=above)
            pose = _made_exact(design, (*position.tolist(), *angles))
            found = posture(design, pose)
            if found.reachable:
                return found
            if fallback is None or margin > fallback[0]:
                fallback = margin, found
    assert fallback is not None
    return fallback[1]


def _on_axis(design: FourSPSSPRDesign) -> Posture | None:
    """Level on the z axis above the base where the margin is largest; None if none is reachable."""
    digits = decimals(float(design.stroke.max()))
    bottom, top = (
        max(design.base[:, 2].max(), 0.0) * 10.0**digits,
        reach(design)[1][2] * 10.0**digits,
    )
    heights = np.round(np.arange(np.ceil(bottom), top + 1.0)[:4000] / 10.0**digits, digits)
    poses = np.zeros((len(heights), 6))
    poses[:, 2] = heights
    held = np.abs(violation(design, poses)) <= _EXACT * design.size
    if not held.any():
        return None
    margin = np.where(held, _margins(design, poses[:, :3], (0.0, 0.0, 0.0)), -np.inf)
    found = posture(design, poses[int(margin.argmax())])
    return found if found.reachable else None


def _made_exact(design: FourSPSSPRDesign, pose: tuple[float, ...]) -> tuple[float, ...]:
    """In whole millimetres, which are easier to talk about, where the constraint lets it be so."""
    digits = decimals(float(design.stroke.max()))
    rounded = (*(float(np.round(v, digits)) + 0.0 for v in pose[:3]), *pose[3:])
    exact = complete_pose(design, rounded)
    tidy = tuple(float(np.round(v, digits + 9)) + 0.0 for v in exact)
    return tidy if abs(float(violation(design, tidy))) <= _EXACT * design.size else exact


def _widest(
    design: FourSPSSPRDesign, angles: tuple[float, ...], *, above: bool
) -> tuple[Array, float]:
    """The position with the largest smallest margin at an orientation, and that margin, mm.

    The constraint leaves a plane; it is searched on a grid, and then by shrinking steps.
    """
    low, high = (np.array(v) for v in reach(design))
    if above:
        low[2] = np.clip(design.base[:, 2].max(), low[2], 0.5 * (low[2] + high[2]))
    centre = 0.5 * (low + high)
    normal = rotation((0.0, 0.0, 0.0, *angles)) @ design.axis
    centre = centre + normal * float(violation(design, (*centre, *angles)))
    first = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    axes = np.stack([first / np.linalg.norm(first), np.zeros(3)])
    axes[1] = np.cross(normal, axes[0])
    span = 0.5 * float(np.linalg.norm(high - low))
    steps = np.linspace(-1.0, 1.0, GRID)
    grid = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    best = centre
    for _ in range(ROUNDS):
        tried = best + span * (grid @ axes)
        margin = _margins(design, tried, angles)
        margin = np.where(tried[:, 2] >= low[2] - 1e-12 * span, margin, margin - 1e3 * design.size)
        best = tried[int(margin.argmax())]
        span *= 0.4
    return best, float(margin.max())


def _margins(design: FourSPSSPRDesign, positions: Array, angles: tuple[float, ...]) -> Array:
    """The smallest margin of all legs at positions (n, 3), mm."""
    poses = np.hstack([positions, np.broadcast_to(angles, (len(positions), 3))])
    lengths = inverse.leg_lengths(design, poses)
    margin: Array = np.minimum(lengths - design.stroke[:, 0], design.stroke[:, 1] - lengths).min(
        axis=1
    )
    return margin
