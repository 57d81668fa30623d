"""The assembly modes while the actuators move: who stayed, who merged, who appeared.

All real solutions are known in closed form everywhere on the straight line between the old and the
new lengths. The line is halved until the sets at the ends of a piece correspond beyond doubt: each
solution has moved by much less than it is away from any other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import count

import numpy as np

from kinematics.answers.solutions import ForwardSolutions, Merged, Refreshed
from kinematics.arrays import Array
from kinematics.mechanisms.tripods.design import TripodDesign
from kinematics.mechanisms.tripods.forward import distances, forward

_CLEAR = 0.35  # of the distance to the next solution: what one may move in a piece
_FINEST = 12  # halvings
_TOGETHER = 0.5  # of h2: how near solutions are that left together


def refresh(design: TripodDesign, before: ForwardSolutions, joints: Sequence[float]) -> Refreshed:
    """All assembly modes at other lengths, with the identities they had ``before``.

    Raises:
        InputError: not three finite positive lengths.
    """
    (now,) = forward(design, joints)
    start, end = np.array(before.joints), np.array(now.joints)
    names = np.array(before.identities, dtype=int)
    lost: list[tuple[int, ForwardSolutions, int]] = []
    pending = [(0.0, 1.0, before, now, 0)]
    while pending:
        low, high, a, b, depth = pending.pop()
        became = _became(design, a, b)
        whole = (became >= 0).all() and len(b) == len(a)
        if not whole and depth < _FINEST:
            middle = 0.5 * (low + high)
            (between,) = forward(design, start + middle * (end - start))
            pending += [(middle, high, between, b, depth + 1), (low, middle, a, between, depth + 1)]
            continue
        # Pieces are worked off in their order, so ``names`` are those of ``a``.
        lost += [(int(names[n]), a, n) for n in np.flatnonzero(became < 0).tolist()]
        kept = became >= 0
        renamed = np.full(len(b), -1)
        renamed[became[kept]] = names[kept]
        names = renamed
    fresh = count(max((*before.identities, -1)) + 1)
    identities = tuple(int(name) if name >= 0 else next(fresh) for name in names)
    appeared = tuple(i for i, name in zip(identities, names, strict=True) if name < 0)
    gone = [entry for entry in lost if entry[0] >= 0]
    return Refreshed(
        solutions=replace(now, identities=identities),
        appeared=appeared,
        merged=tuple(_merged(design, entry, lost) for entry in gone),
    )


def _became(design: TripodDesign, a: ForwardSolutions, b: ForwardSolutions) -> Array:
    """(len(a),) which solution of ``b`` each of ``a`` is; −1 where that is not beyond doubt."""
    answer = np.full(len(a), -1)
    if not len(a) or not len(b):
        return answer
    apart = distances(design, a.poses, a.modes, b.poses, b.modes)
    same = np.array(a.modes)[:, None] == np.array(b.modes)[None, :]
    same &= np.sign(a.determinant)[:, None] == np.sign(b.determinant)[None, :]
    apart = np.where(same, apart, np.inf)
    nearest = apart.argmin(axis=1)
    rows = np.arange(len(a))
    room_a, room_b = _room(design, a), _room(design, b)
    good = apart[rows, nearest] < _CLEAR * np.minimum(room_a, room_b[nearest])
    good &= apart[:, nearest].argmin(axis=0) == rows
    answer[good] = nearest[good]
    return answer


def _room(design: TripodDesign, found: ForwardSolutions) -> Array:
    """Distance of each solution to the next one it could be taken for, mm: of its own operation
    mode, and from the same side of P = 0, so that it cannot meet it."""
    apart = distances(design, found.poses, found.modes, found.poses, found.modes)
    side = np.sign(found.determinant)
    apart[np.array(found.modes)[:, None] != np.array(found.modes)[None, :]] = np.inf
    apart[side[:, None] != side[None, :]] = np.inf
    np.fill_diagonal(apart, np.inf)
    return np.asarray(apart.min(axis=1))


def _merged(
    design: TripodDesign,
    entry: tuple[int, ForwardSolutions, int],
    lost: Sequence[tuple[int, ForwardSolutions, int]],
) -> Merged:
    """Whom it met: the nearest of those that left in the same piece from the other side."""
    identity, found, n = entry
    partner, best = None, _TOGETHER * design.platform_radius
    for other, where, m in lost:
        if where is not found or m == n or found.modes[m] != found.modes[n]:
            continue
        if np.sign(found.determinant[m]) == np.sign(found.determinant[n]):
            continue
        apart = float(
            distances(
                design,
                found.poses[n : n + 1],
                (found.modes[n],),
                found.poses[m : m + 1],
                (found.modes[m],),
            )[0, 0]
        )
        if apart < best and other >= 0:
            partner, best = other, apart
    return Merged(identity, partner, tuple(found.poses[n].tolist()), found.modes[n])
