"""A posture at another orientation, where none at the wanted one can be held: by search.

Poses are compared by hypot(distance of O', characteristic length times the change of angles). A
lattice of poses is tried, orientations near the wanted one first, then clouds about the best of it
that become ever smaller. What is found can be held; that nothing is nearer is not proven.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.five_rpur.home import reach
from kinematics.five_rpur.inverse import MODES, inside, limb_lengths, wrap_angle
from kinematics.five_rpur.remedies.projection import Found, nearest
from kinematics.five_rpur.velocity import characteristic_length
from kinematics.solutions import Posture
from kinematics.spatial import Array

_STEPS = 12  # from an angle to half a turn away
_PLACES = 11  # along each axis
_STARTS = 6
_CLOUD = 300
_ROUNDS = 50
_SHRINK = 0.75
_BATCH = 40  # orientations at a time
_SHORT = 1e9  # mm; what cannot be held is worse than anything that can, the less the nearer it is


def turned(design: FiveRPURDesign, wanted: Posture) -> Found | None:
    """The nearest posture found in the wanted mode, else in any; None where none is found."""
    return _searched(design, wanted, wanted.mode) or _searched(design, wanted, None)


def _searched(design: FiveRPURDesign, wanted: Posture, mode: str | None) -> Found | None:
    target = np.array(wanted.pose)
    unit = characteristic_length(design)
    metric = np.array([1.0, 1.0, 1.0, unit, unit])

    def score(poses: Array) -> Array:
        away = np.linalg.norm((poses - target) * metric, axis=-1)
        short = _shortfall(design, poses, mode)
        return np.where(short > 0.0, _SHORT + short, away)

    starts = _lattice(design, target, metric, score)
    rng = np.random.default_rng(0)
    low, high = (np.array(v) for v in reach(design))
    spread = np.array([*((high - low) / _PLACES), np.pi / _STEPS, np.pi / _STEPS])
    steps = rng.normal(size=(_CLOUD, 5))
    part = np.linspace(0.0, 1.0, 16)[1:, None]
    values = score(starts)
    for _ in range(_ROUNDS):
        for n, here in enumerate(starts):
            tried = np.concatenate([here + steps * spread, here + part * (target - here)])
            scores = score(tried)
            k = int(scores.argmin())
            if scores[k] < values[n]:
                starts[n], values[n] = tried[k], scores[k]
        spread = _SHRINK * spread
        steps = steps[:, [1, 2, 3, 4, 0]]  # other directions
    found = None
    for n in np.argsort(values, kind="stable"):
        if values[n] >= _SHORT:
            break
        phi, theta = wrap_angle(starts[n, 3:]).tolist()
        pose = (*wanted.pose[:3], phi, theta)
        held = [m for m in MODES if mode in (None, m) and inside(design, starts[n], [m])]
        for each in held:
            closer = nearest(design, pose, each, np.inf if found is None else found.distance)
            found = closer or found
        if found is not None:
            return Found(found.posture, found.distance, float("inf"))
    return found


def _lattice(
    design: FiveRPURDesign, target: Array, metric: Array, score: Callable[[Array], Array]
) -> Array:
    """The best poses of a lattice, (n, 5)."""
    steps = np.pi / _STEPS * np.arange(-_STEPS, _STEPS)
    turns = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    turns = turns[np.argsort(np.linalg.norm(turns, axis=1), kind="stable")]
    low, high = (np.array(v) for v in reach(design))
    axes = [np.linspace(a, b, _PLACES) for a, b in zip(low, high, strict=True)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    places = np.concatenate([target[None, :3], places])
    best, values = np.empty((0, 5)), np.empty(0)
    for k in range(0, len(turns), _BATCH):
        batch = turns[k : k + _BATCH]
        if len(values) == _STARTS and np.linalg.norm(batch[0]) * metric[3] > values.max():
            break  # all that follow are farther
        poses = np.empty((len(batch), len(places), 5))
        poses[..., :3] = places
        poses[..., 3:] = target[3:] + batch[:, None]
        scores = score(poses)
        # One an orientation, so that the starts are not all at one.
        at = scores.argmin(axis=1)
        rows = np.arange(len(batch))
        best = np.concatenate([best, poses[rows, at]])
        values = np.concatenate([values, scores[rows, at]])
        order = np.argsort(values, kind="stable")[:_STARTS]
        best, values = best[order], values[order]
    return best


def _shortfall(design: FiveRPURDesign, poses: Array, mode: str | None) -> Array:
    """How far the worst limb is beyond its bounds, mm; ≤ 0 where the pose can be held."""
    lengths = limb_lengths(design, poses)
    c, s = np.cos(poses[..., 3:4]), np.sin(poses[..., 3:4])
    turned = c * design.platform[:, 1] - s * design.platform[:, 2]
    across = np.abs(poses[..., 1:2] + turned - design.base[:, 1]) - design.link
    stroke = np.maximum(design.stroke[:, :1] - lengths, lengths - design.stroke[:, 1:])
    # A limb that cannot close is worse than one that is only beyond its stroke.
    far = design.link[:, None] + design.stroke[:, 1:] + across[..., None]
    short = np.where(np.isfinite(stroke), stroke, far)
    if mode is None:
        return np.asarray(short.min(axis=-1).max(axis=-1))
    column = [0 if sign == "+" else 1 for sign in mode]
    return np.asarray(short[..., range(len(column)), column].max(axis=-1))
