"""Equations of the model of both 5-RPUR papers, tried at random postures."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from app.features.paper.items import Item
from app.features.paper.judging import Outcome, Quantity, claimed, compared, error, identity
from app.features.paper.recomputed.postures import WHERE, Postures, postures
from app.features.paper.registry import computes
from kinematics.arrays import Array

J, K = "meccanica-2011", "icee-2010"
_GENERAL = {J: "rpur-table1", K: "rpur-table1-icee"}


def general(item: Item) -> Postures:
    """Postures of the paper's general design."""
    return postures(_GENERAL[item.paper])


def printed_q(phi: Array, theta: Array) -> Array:
    """Eq. 1 as printed, (N, 3, 3)."""
    cf, sf, ct, st = np.cos(phi), np.sin(phi), np.cos(theta), np.sin(theta)
    zero = np.zeros_like(cf)
    rows = [[ct, sf * st, cf * st], [zero, cf, -sf], [-st, sf * ct, cf * ct]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def about_x(angle: Array) -> Array:
    """(N, 3, 3) rotations about x."""
    return printed_q(angle, np.zeros_like(angle))


def about_y(angle: Array) -> Array:
    """(N, 3, 3) rotations about y."""
    return printed_q(np.zeros_like(angle), angle)


# --- orientation, limbs --------------------------------------------------------------------


@computes(J, "eq. 1")
@computes(K, "eq. 1")
def eq_1(item: Item) -> Outcome:
    at = general(item)
    return identity(error(printed_q(at.phi, at.theta), at.turn), where=WHERE)


@computes(J, "eq. 2")
def eq_2(item: Item) -> Outcome:
    at = general(item)
    e2 = np.stack([at.cos, np.zeros_like(at.cos), -at.sin], axis=-1)
    arms = np.einsum("nij,kj->nki", printed_q(at.phi, at.theta), at.s)
    off = max(error(e2, at.turn[:, :, 0]), error(arms, at.c - at.p[:, None]))
    return identity(off, where=WHERE)


@computes(J, "eq. 3")
@computes(K, "eq. 2")
def eq_3(item: Item) -> Outcome:
    at = general(item)
    u = at.b - at.a
    return identity(error(u[..., 0] ** 2 + u[..., 2] ** 2, at.rho**2), where=WHERE)


@computes(J, "eq. 4")
@computes(K, "eq. 3")
def eq_4(item: Item) -> Outcome:
    at = general(item)
    return identity(error(((at.c - at.b) ** 2).sum(axis=-1), at.link**2), where=WHERE)


@computes(J, "eq. 5")
@computes(K, "eq. 4")
def eq_5(item: Item) -> Outcome:
    at = general(item)
    v = at.c - at.b
    left = v[..., 0] * at.cos[:, None], v[..., 2] * at.sin[:, None]
    return identity(error(*left), where=WHERE)


@computes(J, "eq. 6")
@computes(K, "eq. 5")
def eq_6(item: Item) -> Outcome:
    at = general(item)
    found = at.p[:, None] + np.einsum("nij,kj->nki", printed_q(at.phi, at.theta), at.s)
    return identity(error(found, at.c), where=WHERE)


# --- pairs ---------------------------------------------------------------------------------

# Of each kind a sample with its pair, from 1, and postures with both limbs in one mode.
PAIRS = {"A1": ("rpur-a1a1", 1, 2), "A2": ("rpur-a2a2", 1, 2), "A3": ("rpur-a3a3", 1, 2)}


def _along(x: bool) -> float:
    """The largest error of eq. 7 (x) or 8 (z) over the three arrangements."""
    worst = 0.0
    for name, i, j in PAIRS.values():
        at = postures(name)
        apart = at.s[j - 1, 0] - at.s[i - 1, 0]
        if x:
            left, right = at.x("B", j) - at.x("B", i), apart * at.cos
        else:
            left, right = at.z("B", j) - at.z("B", i), -apart * at.sin
        size = float(np.abs(at.b).max())
        worst = max(worst, float(np.abs(left - right).max()) / size)
    return worst


@computes(J, "eq. 7")
def eq_7(item: Item) -> Outcome:
    return identity(_along(x=True), where=f"{WHERE} of A1, A2 and A3 pairs")


@computes(J, "eq. 8")
def eq_8(item: Item) -> Outcome:
    return identity(_along(x=False), where=f"{WHERE} of A1, A2 and A3 pairs")


# --- workspace offsets ---------------------------------------------------------------------


def offsets(at: Postures) -> Array:
    """w′ (N, 5, 3): where C = A in x′y′z′, from the library's own points."""
    base = at.p[:, None] - (at.c - at.a)  # p − (C − A)
    return np.asarray(np.einsum("nij,nkj->nki", about_y(-at.theta), base))


@computes(J, "eq. 26")
@computes(K, "eq. 13")
def eq_26(item: Item) -> Outcome:
    at = general(item)
    arms = np.einsum("nij,kj->nki", printed_q(at.phi, at.theta), at.s)
    return identity(error(at.a - arms, at.p[:, None] - (at.c - at.a)), where=WHERE)


@computes(J, "eq. 27")
def eq_27(item: Item) -> Outcome:
    at = general(item)
    return identity(error(turned_offsets(at, at.phi), offsets(at)), where=WHERE)


@computes(K, "eq. 14")
def eq_14_conference(item: Item) -> Outcome:
    at = general(item)
    as_printed, right = turned_offsets(at, -at.phi), turned_offsets(at, at.phi)
    return identity(error(as_printed, offsets(at)), error(right, offsets(at)), where=WHERE)


@computes(K, "eq. 16")
def eq_16_conference(item: Item) -> Outcome:
    at = general(item)
    return identity(error(turned_offsets(at, at.phi), offsets(at)), where=WHERE)


def turned_offsets(at: Postures, phi: Array) -> Array:
    """Q_y⁻¹ r_i − Q_x s′_i (N, 5, 3)."""
    base = np.einsum("nij,kj->nki", about_y(-at.theta), at.a)
    return np.asarray(base - np.einsum("nij,kj->nki", about_x(phi), at.s))


# --- the limb's equation -------------------------------------------------------------------


@computes(K, "C1")
def c_1_conference(item: Item) -> Outcome:
    off, found, _ = _degrees()
    printed = item.data["degrees"]
    told = zip("xyzut", printed, found, strict=True)
    return compared(
        *(Quantity(f"degree in {key}", float(own), str(said)) for key, said, own in told),
        Quantity("error of the equation at 200 random postures, both modes of each limb", off),
    )


@computes(K, "C2")
def c_2_conference(item: Item) -> Outcome:
    off, found, total = _degrees()
    most = max(found)
    return claimed(
        most == item.data["counts"][0],
        Quantity("total degree in all five unknowns", float(total), str(item.data["counts"][0])),
        Quantity("largest degree in one unknown", float(most)),
        Quantity("error of the equation at 200 random postures", off),
        proof=f"in one unknown the equation has degree {most} at most; {total} is that of a random "
        "line through all five",
    )


@cache
def _degrees() -> tuple[float, list[int], int]:
    """Of the limb's equation in x, y, z, u = tan φ/2, t = tan θ/2 with B eliminated: how well the
    library satisfies it, its degree in each unknown, and along a line through all of them.

    Degrees are exact: differences of values at whole numbers, in whole numbers.
    """
    at = postures("rpur-table1-icee")
    other = at.mode.translate(str.maketrans("+-", "-+"))
    off = 0.0
    for rho in (at.rho, at.machine.mechanism.joints(at.poses, other)):
        values = []
        for n, pose in enumerate(at.poses):
            u, t = np.tan(0.5 * pose[3:])
            scale = 400.0**4 * (1 + u * u) ** 4 * (1 + t * t) ** 4
            for limb in range(5):
                numbers = (*at.a[limb], *at.s[limb], at.link[limb], rho[n, limb])
                values.append(_limb_equation((*pose[:3], u, t), numbers) / scale)
        off = max(off, float(np.abs(values).max()))
    numbers = (20, 205, 10, 30, 50, -40, 150, 300)
    start = (3, 1, 2, 4, 5)
    degrees = []
    for way in (*np.eye(5, dtype=int).tolist(), [1, 2, -1, 1, 2]):
        line = [
            _limb_equation([a + k * b for a, b in zip(start, way, strict=True)], numbers)
            for k in range(26)
        ]
        degree = -1
        while any(line):
            line = [b - a for a, b in pairwise(line)]
            degree += 1
        degrees.append(degree)
    return off, degrees[:5], degrees[5]


def _limb_equation(unknowns: Sequence[Any], numbers: Sequence[Any]) -> Any:
    """(ρ² − X² − Z² − h²)² − 4 Z² h², h² = l² − Y², times (1 + u²)⁴ (1 + t²)⁴."""
    x, y, z, u, t = unknowns
    rx, ry, rz, sx, sy, sz, link, rho = numbers
    cu, su, du = 1 - u * u, 2 * u, 1 + u * u
    ct, st, dt = 1 - t * t, 2 * t, 1 + t * t
    # X, Y, Z of C − A in x′y′z′, times (1 + u²)(1 + t²)
    along = ((x - rx) * ct - (z - rz) * st + sx * dt) * du
    across = ((y - ry) * du + cu * sy - su * sz) * dt
    up = ((x - rx) * st + (z - rz) * ct) * du + (su * sy + cu * sz) * dt
    both = du * du * dt * dt
    square = link * link * both - across * across
    return (rho * rho * both - along * along - up * up - square) ** 2 - 4 * up * up * square
