"""The assembly modes of a 4-SPS + 1-SPR while its legs move: who stayed, who merged, who appeared.

Every real solution is followed along the straight line in joint space from the lengths before to
those now. Where it arrives it is the same assembly mode, and keeps its identity; where it ends at
a fold, it has merged with another. Arriving is not taken on trust: the end has to be one of the
full set, two may not arrive together, and the determinant may not have changed its sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import count

import numpy as np
from numpy.typing import NDArray

from kinematics.four_sps_spr import moving
from kinematics.four_sps_spr.design import FourSPSSPRDesign
from kinematics.four_sps_spr.forward.assembly import forward, pose_distances
from kinematics.four_sps_spr.forward.equations import (
    Deformation,
    Frame,
    from_transforms,
    parameters,
    to_transforms,
)
from kinematics.four_sps_spr.inverse import rotation
from kinematics.solutions import ForwardSolutions, Merged, Refreshed
from kinematics.spatial import Array
from kinematics.tracking import Control, Ending, Tracked, track

_AT_ONCE = Control(first=0.5, error=2e-2, shortest=1e-5, most=400)
_CAREFULLY = Control(first=0.02, error=1e-3, contraction=0.02, shortest=1e-6, most=2000)
_THERE = 1e-5  # of the characteristic length: an end and the solution that it is
_TOGETHER = 0.5  # of the characteristic length: solutions left at the same fold


def refresh(
    design: FourSPSSPRDesign, before: ForwardSolutions, joints: Sequence[float]
) -> Refreshed:
    """All assembly modes at other lengths, with the identities they had ``before``.

    Raises:
        InputError: not five finite positive lengths.
    """
    (now,) = forward(design, [joints])
    frame = Frame.of(design)
    g0, g1 = (parameters(design, s.joints, frame) for s in (before, now))
    way = Deformation(g0, g1)
    starts = from_transforms(frame, rotation(before.poses), before.poses[:, :3])
    ends = track(way, starts, _AT_ONCE)
    became = _arrivals(design, frame, before, now, ends)
    doubtful = np.flatnonzero((became < 0) & (ends.endings == Ending.REGULAR))
    if doubtful.size:
        again = track(way.take(doubtful), starts[:, doubtful], _CAREFULLY)
        ends.endings[doubtful], ends.reached[doubtful] = again.endings, again.reached
        ends.values[:, doubtful] = again.values
        became = _arrivals(design, frame, before, now, ends)
    return _told_apart(design, before, now, _poses(frame, ends), became)


def _poses(frame: Frame, ends: Tracked) -> Array:
    r, p = to_transforms(frame, ends.values)
    states = (moving.State(*one) for one in zip(r, p, strict=True))
    return np.array([moving.pose_of(state) for state in states]).reshape(-1, 6)


def _arrivals(
    design: FourSPSSPRDesign,
    frame: Frame,
    before: ForwardSolutions,
    now: ForwardSolutions,
    ends: Tracked,
) -> NDArray[np.intp]:
    """Which solution of ``now`` each of ``before`` has become; −1 for none, or for doubt."""
    answer = np.full(len(before), -1, dtype=np.intp)
    arrived = np.flatnonzero(ends.endings == Ending.REGULAR)
    if not arrived.size or not len(now):
        return answer
    apart = pose_distances(design, _poses(frame, ends)[arrived], now.poses)
    nearest = apart.argmin(axis=1)
    good = apart[np.arange(len(arrived)), nearest] <= _THERE * design.length
    good &= np.sign(before.determinant)[arrived] == np.sign(now.determinant)[nearest]
    good &= np.bincount(nearest[good], minlength=len(now))[nearest] <= 1
    answer[arrived[good]] = nearest[good]
    return answer


def _told_apart(
    design: FourSPSSPRDesign,
    before: ForwardSolutions,
    now: ForwardSolutions,
    last: Array,
    became: NDArray[np.intp],
) -> Refreshed:
    stayed = became >= 0
    names = dict(zip(became[stayed].tolist(), np.flatnonzero(stayed), strict=True))
    fresh = count(max(before.identities, default=0) + 1)
    identities = tuple(
        before.identities[names[n]] if n in names else next(fresh) for n in range(len(now))
    )
    appeared = tuple(name for n, name in enumerate(identities) if n not in names)
    gone = np.flatnonzero(~stayed)
    met = _meetings(design, last[gone], np.sign(before.determinant)[gone])
    merged = tuple(
        Merged(
            before.identities[n],
            before.identities[gone[met[k]]] if k in met else None,
            tuple(last[n].tolist()),
            "",
        )
        for k, n in enumerate(gone)
    )
    return Refreshed(replace(now, identities=identities), appeared, merged)


def _meetings(design: FourSPSSPRDesign, poses: Array, side: Array) -> dict[int, int]:
    """Who met whom at a fold, nearest first: only solutions from different sides do."""
    apart = pose_distances(design, poses, poses)
    met: dict[int, int] = {}
    for n in np.argsort(apart, axis=None):
        i, j = divmod(int(n), len(poses))
        if apart[i, j] > _TOGETHER * design.length:
            break
        if i != j and i not in met and j not in met and side[i] != side[j]:
            met[i], met[j] = j, i
    return met
