"""The posture that a review of a design starts from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.inverse import posture as posture_at
from kinematics.mechanism import mechanism_of
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.arrangements import CLASSES, PairKind, arrangements
from kinematics.mechanisms.five_rpur.design import MODES, FiveRPURDesign
from kinematics.screws.spatial import common_box, decimals

if TYPE_CHECKING:  # loaded only where it follows
    from kinematics.facets.following import ClosureFollowing

GRID = 15  # positions tried along each axis
ROUNDS = 12  # halvings of the step while the best position of a mode is improved
TRAVEL = 0.3  # of the stroke
DRIVES = 48  # of single actuators that are tried; beyond, the best so far has to do
PIECES = 200  # of proven way that a drive may take; one that takes more runs beside a singularity
ORIENTATIONS = ((0.0, 0.0), (0.3, 0.3), (-0.3, 0.3), (0.3, -0.3), (-0.3, -0.3))

_SIGNS = np.array([inverse.signs(mode) for mode in MODES])
_NEIGHBOURS = np.array(list(product((-1.0, 0.0, 1.0), repeat=3)))


@lru_cache(maxsize=64)
def reach(design: FiveRPURDesign) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """A box that holds O' whatever the orientation, rounded outwards to 10 mm: lows and highs."""
    radius = design.stroke[:, 1] + design.link + np.linalg.norm(design.platform, axis=1)
    low, high = common_box(design.base, radius)  # limbs apart: what one of them reaches
    return low, high


@lru_cache(maxsize=64)
def home(design: FiveRPURDesign) -> Posture:
    """A posture to start from: level if possible, roomy, well under control, above the base.

    For every working mode the position with the largest smallest margin is found, on a grid and
    then by halving steps. Of these the one is taken from which every actuator alone can be moved
    furthest, in and out, before a singularity or a limit stops it: a margin in space says nothing
    about how near a parallel singularity is. Where nothing is reachable, the posture that misses
    by least.
    """
    # Of a simplified design rather a posture that its closed forms hold.
    simplified = arrangements(design).name in CLASSES
    tied: tuple[tuple[PairKind, ...], ...] = (("A1",),)
    tied = (("A1", "A2", "A3"), *tied) if simplified else tied
    fallback: tuple[float, Posture] | None = None
    drives = iter(range(DRIVES))
    # Below its base a machine would stand in its own floor: only where there is nothing above.
    for above, (phi, theta) in product((True, False), ORIENTATIONS):
        positions, room = _roomiest(design, phi, theta, above=above)
        room[~np.isin(MODES, design.modes)] = -np.inf
        for kinds in tied:
            margins = np.where(_together(design, kinds), room, -np.inf)
            found = _most_travel(design, positions, margins, phi, theta, drives)
            if found is not None:
                return found
        n = int(margins.argmax())
        if fallback is None or margins[n] > fallback[0]:
            pose = (*(float(v) for v in positions[n]), phi, theta)
            fallback = float(margins[n]), posture_at(design, pose, MODES[n])
    assert fallback is not None
    return fallback[1]


def _most_travel(
    design: FiveRPURDesign,
    positions: Array,
    margins: Array,
    phi: float,
    theta: float,
    drives: Iterator[int],
) -> Posture | None:
    """Of the modes' positions the one from which every actuator can be moved furthest."""
    best, found = 0.0, None
    for n in np.argsort(-margins):
        if margins[n] <= best:
            break  # no actuator can be moved further than the nearest stroke end
        pose = (*(float(v) for v in positions[n]), phi, theta)
        posture = posture_at(design, pose, MODES[n])
        travel = _least_travel(design, posture, best, drives)
        if travel > best:
            best, found = travel, posture
    return found


def _together(design: FiveRPURDesign, kinds: Sequence[PairKind]) -> NDArray[np.bool_]:
    """(32,) which modes hold the limbs of such pairs alike; a merged U joint (A1) has to."""
    like = np.isin(MODES, design.modes)
    for group in arrangements(design).groups:
        for pair in group.pairs:
            if pair.kind in kinds:
                i, j = pair.limbs
                like &= _SIGNS[:, i - 1] == _SIGNS[:, j - 1]
    return like


def _least_travel(
    design: FiveRPURDesign, posture: Posture, enough: float, drives: Iterator[int]
) -> float:
    """How far the least movable actuator can be driven alone, mm; stops looking below ``enough``.

    0 when no more ``drives`` may be tried. Looked at up to `TRAVEL` of the stroke, since more makes
    no better start.
    """
    following: ClosureFollowing[FiveRPURDesign] = mechanism_of(design).facet("following")
    least = np.inf
    for i, (low, high) in enumerate(design.stroke):
        for direction in (-1.0, 1.0):
            if next(drives, None) is None:
                return 0.0
            goal = posture.joints[i] + direction * TRAVEL * (high - low)
            joints = list(posture.joints)
            joints[i] = float(np.clip(goal, low, high))
            reached = following.follow(posture, joints, PIECES).posture.joints[i]
            least = min(least, abs(reached - posture.joints[i]))
            if least <= enough:
                return least
    return least


def _roomiest(
    design: FiveRPURDesign, phi: float, theta: float, *, above: bool
) -> tuple[Array, Array]:
    """For each working mode its roomiest position (32, 3) and the margin there (32,), mm."""
    low, high = (np.array(v) for v in reach(design))
    if above:
        low[2] = np.clip(design.base[:, 2].max(), low[2], 0.5 * (low[2] + high[2]))
    axes = [np.linspace(a, b, GRID) for a, b in zip(low, high, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    margins = _margins(design, grid, phi, theta)  # (N, 32)
    positions = grid[margins.argmax(axis=0)]
    step = (high - low) / (GRID - 1)
    modes = np.arange(len(MODES))
    for _ in range(ROUNDS):
        around = positions[:, None, :] + 0.5 * step * _NEIGHBOURS  # (32, 27, 3)
        tried = _margins(design, around, phi, theta)[modes, :, modes]  # (32, 27)
        positions = np.maximum(around[modes, tried.argmax(axis=1)], low)
        step = 0.7 * step
    positions = np.round(positions, decimals(float(design.stroke.max())))
    return positions, _margins(design, positions, phi, theta)[modes, modes]


def _margins(design: FiveRPURDesign, positions: Array, phi: float, theta: float) -> Array:
    """The smallest margin of all limbs in each of the 32 modes, (..., 32) mm; −inf: no closure."""
    angles = np.broadcast_to((phi, theta), (*positions.shape[:-1], 2))
    poses = np.concatenate([positions, angles], axis=-1)
    lengths = inverse.limb_lengths(design, poses)  # (..., 5, 2)
    stroke = np.minimum(lengths - design.stroke[:, :1], design.stroke[:, 1:] - lengths)
    turned = np.cos(phi) * design.platform[:, 1] - np.sin(phi) * design.platform[:, 2]
    link = design.link - np.abs(positions[..., 1:2] + turned - design.base[:, 1])
    both = np.where(np.isfinite(stroke), np.minimum(stroke, link[..., None]), -np.inf)
    plus, minus = both[..., 0], both[..., 1]
    each = np.where(_SIGNS > 0, plus[..., None, :], minus[..., None, :])  # (..., 32, 5)
    return np.asarray(each.min(axis=-1))
