"""The posture that a review of a five-bar starts from, and the box that P can be in."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.inverse import posture
from kinematics.mechanisms.five_bar.design import FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import MODES, in_range, joints_of
from kinematics.mechanisms.five_bar.statics import condition, sines
from kinematics.screws.spatial import common_box, decimals

GRID = 81
_ORDER = ("+-", "-+", "++", "--")  # elbows outwards first, as in Fig. 1 of the paper


def reach(design: FiveBarDesign) -> tuple[tuple[float, float], tuple[float, float]]:
    """A box that holds P, rounded outwards to 10 mm: lows and highs of x and y."""
    radius = design.proximal + design.distal
    low, high = common_box(design.base, radius)  # limbs apart: what one of them reaches
    return (low[0], low[1]), (high[0], high[1])


@lru_cache(maxsize=64)
def home(design: FiveBarDesign) -> Posture:
    """Elbows outwards, on the side of y > 0, where every singularity and limit is far off.

    The grid's best place: the product of the conditioning, of the sines between links, and of the
    margin of the joints' ranges is largest. Other working modes only where "+-" reaches nothing;
    where nothing is reached at all, the middle of the box.
    """
    for above in (True, False):
        grid = _grid(design, above=above)
        for mode in _ORDER:
            joints = joints_of(design, grid, mode)
            score = _score(design, grid, joints)
            if score.max() > 0.0:
                digits = decimals(float((design.proximal + design.distal).max()))
                place = np.round(grid[int(score.argmax())], digits)
                found = posture(design, (float(place[0]), float(place[1])), mode)
                if found.reachable:
                    return found
                best = grid[int(score.argmax())]
                return posture(design, (float(best[0]), float(best[1])), mode)
    low, high = reach(design)
    middle = (0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]))
    return posture(design, middle, MODES[1])


def _grid(design: FiveBarDesign, *, above: bool) -> Array:
    low, high = reach(design)
    bottom = max(low[1], 0.0) if above else low[1]
    axes = np.linspace(low[0], high[0], GRID), np.linspace(bottom, high[1], GRID)
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)


def _score(design: FiveBarDesign, grid: Array, joints: Array) -> Array:
    """(N,) 0 where a pose cannot be held."""
    limbs, between = sines(design, grid, joints)
    share = np.ones(len(grid))
    for i, limb in enumerate(design.limbs):
        if limb.joint_range_deg is not None:
            low, high = design.joint_range[i]
            margin = np.minimum(joints[:, i] - low, high - joints[:, i])
            share = share * np.minimum(margin / 0.35, 1.0)
    with np.errstate(invalid="ignore"):
        score = np.abs(limbs).prod(axis=-1) * np.abs(between) / condition(design, grid, joints)
    ok = in_range(design, joints).all(axis=-1)
    return np.where(ok & np.isfinite(score), score * np.maximum(share, 0.0), 0.0)
