"""Assembly modes while the actuators move: who stayed, who merged, who appeared.

Every real solution is followed from the joints before to those now. Where it arrives it is the same
assembly mode, and keeps its identity; where it ends at a fold, it has merged with another. Arriving
is not taken on trust: the end has to be one of the full set, two may not arrive together, and the
determinant may not have changed its sign. Distances are a mechanism's own, mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import count

import numpy as np

from kinematics.answers.solutions import ForwardSolutions, Merged, Refreshed
from kinematics.arrays import Array
from kinematics.homotopy.tracking import Complex, Control, Ending, Index, Tracked

AT_ONCE = Control(first=0.5, error=2e-2, shortest=1e-5, most=400)
CAREFULLY = Control(first=0.02, error=1e-3, contraction=0.02, shortest=1e-6, most=2000)
"""For paths that arrived, but not beyond doubt."""

Sides = tuple[Array, Array]
"""The sign of a determinant that no regular path changes, of the solutions before and now."""


def tracked_apart(
    before: ForwardSolutions,
    now: ForwardSolutions,
    tracked: Callable[[Index | None], Tracked],
    poses: Callable[[Complex], Array],
    distances: Callable[[Array, Array], Array],
    *,
    sides: Sides,
    there: float,
    together: float,
) -> Refreshed:
    """The solutions ``now`` with their identities, by tracking all of those ``before``.

    Args:
        tracked: tracks all paths (None), or some of them again with care.
        poses: (N, P) of the ends (K, N) of paths.
        distances: between poses (n, P) and (m, P), (n, m).
        there: up to which distance an end is a solution.
        together: up to which distance two that ended have met.
    """

    def at_ends() -> Index:
        arrived = ends.ended(Ending.REGULAR)
        apart = distances(poses(ends.values[:, arrived]), now.poses)
        return _arrivals(apart, arrived, sides, there)

    ends = tracked(None)
    which = at_ends()
    doubtful = np.flatnonzero((which < 0) & (ends.endings == Ending.REGULAR))
    if doubtful.size:
        again = tracked(doubtful)
        ends.endings[doubtful], ends.reached[doubtful] = again.endings, again.reached
        ends.values[:, doubtful] = again.values
        which = at_ends()
    last = poses(ends.values)
    return told_apart(before, now, which, last, sides[0], distances(last, last), together)


def _arrivals(apart: Array, arrived: Index, sides: Sides, there: float) -> Index:
    """Which of M solutions each of N paths has become; −1 for none, or for doubt.

    Args:
        apart: (K, M) distances from the ends of the paths ``arrived`` (K,) to the solutions.
        there: up to which distance an end is a solution.
    """
    answer = np.full(len(sides[0]), -1, dtype=np.intp)
    if not apart.size:
        return answer
    nearest = apart.argmin(axis=1)
    good = apart[np.arange(len(arrived)), nearest] <= there
    good &= sides[0][arrived] == sides[1][nearest]
    good &= np.bincount(nearest[good], minlength=apart.shape[1])[nearest] <= 1
    answer[arrived[good]] = nearest[good]
    return answer


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
    fresh = count(max(before.identities, default=0) + 1)
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
