"""Assembly modes while the actuators move: who stayed, who merged, who appeared."""

from __future__ import annotations

from dataclasses import replace
from itertools import count

import numpy as np

from kinematics.answers.solutions import ForwardSolutions, Merged, Refreshed
from kinematics.arrays import Array
from kinematics.homotopy.tracking import Index


def told_apart(
    before: ForwardSolutions,
    now: ForwardSolutions,
    became: Index,
    last: Array,
    side: Array,
    apart: Array,
    together: float,
) -> Refreshed:
    """The solutions with their identities.

    Args:
        became: (N,) which solution of ``now`` each of ``before`` is, −1 of those that ended.
        last: (N, P) the poses where their paths ended.
        side: (N,) the sign of the determinant.
        apart: (N, N) distances of these poses; infinite between those that never meet.
        together: up to which distance two that ended have met.
    """
    stayed = became >= 0
    names = dict(zip(became[stayed].tolist(), np.flatnonzero(stayed), strict=True))
    fresh = (number for number in count(1) if number not in before.identities)
    identities = tuple(
        before.identities[names[n]] if n in names else next(fresh) for n in range(len(now))
    )
    appeared = tuple(name for n, name in enumerate(identities) if n not in names)
    gone = np.flatnonzero(~stayed)
    met = _meetings(apart[np.ix_(gone, gone)], side[gone], together)
    merged = tuple(
        Merged(
            before.identities[n],
            before.identities[gone[met[k]]] if k in met else None,
            tuple(last[n].tolist()),
            before.modes[n],
        )
        for k, n in enumerate(gone)
    )
    return Refreshed(replace(now, identities=identities), appeared, merged)


def _meetings(apart: Array, side: Array, near: float) -> dict[int, int]:
    """Who met whom at a fold, nearest first: only solutions from different sides do."""
    met: dict[int, int] = {}
    for n in np.argsort(apart, axis=None):
        i, j = divmod(int(n), len(apart))
        if apart[i, j] > near:
            break
        if i != j and i not in met and j not in met and side[i] != side[j]:
            met[i], met[j] = j, i
    return met
