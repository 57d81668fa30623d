"""How bodies grow inside a region until contacts hold them from all sides.

Each step solves a small concave program over the contacts within reach, a trust region; it is taken
only where the body really becomes larger. Lengths mm.
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.inscribed.contacts import Contacts
from kinematics.mechanisms.five_rpur.inscribed.region import SIGN, Ints, Region

ERROR = 1e-9
"""Part of the machine's size by which a distance may be wrong."""
REACH = 0.03
"""Part of the machine's size: the first and the longest step."""
STEPS = 40
"""More than a body ever took to grow."""


def concave_program(
    rows: Array, offset: Array, slope: Array, curvature: Array
) -> tuple[Array, Array]:
    """Maximise slope·x + x·curvature·x / 2 where ``rows @ x + offset`` >= 0 and all |x| <= 1.

    Primal-dual interior point method from x = 0, which need not be feasible.

    Args:
        rows: (m, n).
        offset: (m,).
        slope: (n,).
        curvature: (n, n), negative semidefinite.

    Returns:
        x and the multipliers (m,) of the rows.
    """
    n = rows.shape[1]
    unit = np.eye(n)
    rows = np.concatenate([rows, unit, -unit])
    offset = np.concatenate([offset, np.ones(2 * n)])
    x = np.zeros(n)
    slack = np.maximum(offset, 0.1)
    weight = 0.1 / slack
    for _ in range(40):
        dual = -slope - curvature @ x - weight @ rows
        primal = rows @ x + offset - slack
        mean = float(slack @ weight) / len(offset)
        if mean < 1e-12 or (mean < 1e-10 and np.abs(dual).max() < 1e-9 > np.abs(primal).max()):
            break
        ratio = weight / slack
        matrix = (rows.T * ratio) @ rows - curvature
        matrix[np.diag_indices(n)] += 1e-14 * matrix.trace()

        # First towards the bounds, to see how far they let go; then to a share of the mean.
        target = 0.0
        for last in (False, True):
            wanted = target / slack - weight - ratio * primal
            dx = np.linalg.solve(matrix, wanted @ rows - dual)
            ds = rows @ dx + primal
            dw = (target - weight * ds) / slack - weight
            short = float(np.concatenate([ds / slack, dw / weight]).min())
            length = min(1.0, 0.995 / max(-short, 1e-300))
            if not last:
                ahead = float((slack + length * ds) @ (weight + length * dw)) / len(offset)
                target = (ahead / mean) ** 3 * mean
        x, slack, weight = x + length * dx, slack + length * ds, weight + length * dw
    return x, weight[: len(offset) - 2 * n]


def with_more(beta: Array, *more: Array) -> Array:
    """Samples (K, N) and more of them, in order, none beyond their ends."""
    added = np.clip(np.concatenate(more, axis=1), beta[:, :1], beta[:, -1:])
    return np.sort(np.concatenate([beta, added], axis=1), axis=1)


def next_reach(reach: float, share: float, region: Region) -> float:
    """The next step's reach, by the share of the hoped gain that came true."""
    factor = 2.0 if share > 0.75 else 1.0 if share > 0.25 else 0.25
    return min(factor * reach, REACH * region.size)


def held(rows: Array, weight: Array, curvature: Array) -> Array:
    """A curvature as it counts where active rows hold: its concave part along them."""
    _, sizes, across = np.linalg.svd(rows[weight > 1e-6 * weight.max()])
    free = across[int((sizes > 1e-9 * sizes[0]).sum()) :]
    turn, along = np.linalg.eigh(free @ curvature @ free.T)
    basis = along.T @ free
    return np.asarray((basis.T * np.minimum(turn, 0.0)) @ basis)


def tangents(region: Region, near: Contacts, use: Ints) -> tuple[Array, Array]:
    """First (N, 3, 2) and unmixed second (N, 3, 2) derivatives of the surfaces at contacts.

    Along the axis of a tube and around it; along a curve, and nothing.
    """
    first, second = np.zeros((2, len(use), 3, 2))
    tube = np.flatnonzero(near.tube[use] >= 0)
    contact = use[tube]
    sets = region.tubes[0][near.tube[contact]]
    at, link = near.at[contact], region.link[sets // 2]
    out = SIGN[sets] * link
    for axis, lean in zip((0, 2), region.lean, strict=True):
        first[tube, axis, 0] = out * np.cos(at) * lean
        second[tube, axis, 0] = -out * np.sin(at) * lean
    first[tube, 1, 0], second[tube, 1, 0] = -link * np.sin(at), -link * np.cos(at)
    x, _, z = region.axis(sets, at)
    dx, dz = near.point[contact, 0] - x, near.point[contact, 2] - z
    first[tube, 0, 1], first[tube, 2, 1] = -dz, dx
    second[tube, 0, 1], second[tube, 2, 1] = -dx, -dz
    curve = np.flatnonzero(near.tube[use] < 0)
    if curve.size:
        contact, tiny = use[curve], 1e-4
        s = near.at[contact, None] + np.array([-tiny, 0.0, tiny])
        before, here, after = np.moveaxis(region.curves.at(near.piece[contact, None], s), 1, 0)
        first[curve, :, 0] = (after - before) / (2.0 * tiny)
        second[curve, :, 0] = (after - 2.0 * here + before) / tiny**2
    return first, second
