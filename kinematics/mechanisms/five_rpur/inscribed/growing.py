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

    By SciPy's SLSQP from x = 0, which need not be feasible.

    Args:
        rows: (m, n).
        offset: (m,).
        slope: (n,).
        curvature: (n, n), negative semidefinite.

    Returns:
        x and the multipliers (m,) of the rows.
    """
    from scipy.optimize import minimize

    def lost(x: Array) -> tuple[float, Array]:
        bent = curvature @ x
        return -float((slope + 0.5 * bent) @ x), -(slope + bent)

    n = rows.shape[1]
    above = {"type": "ineq", "fun": lambda x: rows @ x + offset, "jac": lambda _: rows}
    found = minimize(
        lost,
        np.zeros(n),
        method="SLSQP",
        jac=True,
        bounds=[(-1.0, 1.0)] * n,
        constraints=above,
        options={"ftol": 1e-13},
    )
    return found.x, np.asarray(found.multipliers)


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
    _, sizes, across = np.linalg.svd(rows[weight > 1e-6 * weight.max(initial=0.0)])
    free = across[int((sizes > 1e-9 * sizes.max(initial=0.0)).sum()) :]
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
