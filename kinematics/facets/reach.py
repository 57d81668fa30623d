"""Where each coordinate of a pose can go while the others are held."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.inverse import InverseFacet
from kinematics.mechanism import D

_PLACES = 128  # over the range of a coordinate; what is narrower than a step may be passed over
_FEWER = 24  # the same where each place takes a solution of its own
_ROUNDS = 7  # of halving between a place inside and one that is not


def reach(
    inverse: InverseFacet[D], pose: Sequence[float], mode: str, dependent: int | None = None
) -> tuple[Array, ...]:
    """The intervals (K, 2) of each coordinate in which the pose can be held in a mode, mm and rad.

    Their ends are right to 1/16000 of a coordinate's range; an interval narrower than 1/128 of it
    is found only where the pose itself stands in it. Where coordinates follow from each other both
    are five times that.

    Args:
        pose: (P,) the others are held at its values, as far as they do not depend on each other.
        dependent: the coordinate that gives way, see `Mechanism.complete_pose`.
    """
    mechanism = inverse.mechanism
    at = np.array(pose, dtype=float)
    axes = mechanism.coordinates
    tied = bool(mechanism.dependent_coordinates())
    rows = []
    for c, value in zip(axes, at, strict=True):
        places = np.linspace(c.lower, c.upper, (_FEWER if tied else _PLACES) + 1)
        rows.append(np.sort(np.append(places, min(max(value, c.lower), c.upper))))
    index = np.repeat(np.arange(len(axes)), [len(row) for row in rows])

    def inside(which: NDArray[np.intp], values: Array) -> NDArray[np.bool_]:
        poses = np.tile(at, (len(values), 1))
        poses[np.arange(len(values)), which] = values
        if tied:
            for n, one in enumerate(poses):
                with suppress(InputError):
                    poses[n] = mechanism.complete_pose(one, mode, int(which[n]), dependent)
                    continue
                poses[n] = np.inf
        there = np.isfinite(poses).all(axis=-1)
        held = np.zeros(len(poses), dtype=bool)
        held[there] = inverse.inside(poses[there], (mode,))
        return held

    held = inside(index, np.concatenate(rows))
    found, start = [], 0
    for row in rows:
        found.append(held[start : start + len(row)])
        start += len(row)
    # Every change between neighbours is halved, all of them at once.
    edges = [np.flatnonzero(one[1:] != one[:-1]) for one in found]
    which = np.repeat(np.arange(len(axes)), [len(edge) for edge in edges])
    low = np.concatenate([row[edge] for row, edge in zip(rows, edges, strict=True)])
    high = np.concatenate([row[edge + 1] for row, edge in zip(rows, edges, strict=True)])
    first = np.concatenate([one[edge] for one, edge in zip(found, edges, strict=True)])
    for _ in range(_ROUNDS if len(which) else 0):
        middle = 0.5 * (low + high)
        same = inside(which, middle) == first
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    ends = np.where(first, low, high)
    spans = []
    for n, (row, one) in enumerate(zip(rows, found, strict=True)):
        own = [*([row[0]] if one[0] else []), *ends[which == n], *([row[-1]] if one[-1] else [])]
        spans.append(np.array(own).reshape(-1, 2))
    return tuple(spans)
