"""Sosa-López et al. (2017): equations of the five-bar at random poses.

Lengths are mm here and cm where they stand beside printed ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import kinematics as kin
from app.features.paper.items import Item
from app.features.paper.judging import (
    Outcome,
    Quantity,
    compared,
    drawn,
    error,
    identity,
)
from app.features.paper.registry import computes
from kinematics.arrays import Array
from kinematics.machine import Machine

S = "five-bar-2017"
R1, R3 = 480.0, 240.0
COUNT = 200
WHERE = f"at {COUNT} random poses in each of four modes"
START = 738.644
"""mm, where both paths begin."""


@cache
def machine() -> Machine[Any]:
    return kin.open("five-bar")


@dataclass(frozen=True, eq=False)
class Poses:
    """Random poses in all four modes, one mode after another, with random rates.

    Attributes:
        x, y, one, two: (N,) of P and of both driven angles.
        p1, q1, p2, q2: (N, 2) first and second derivatives of P and of the angles.
        a: (N, 2) the diagonal of A; b (N, 2, 2); by the library's wrenches.
        modes: (N,) the signs of each.
    """

    x: Array
    y: Array
    one: Array
    two: Array
    p1: Array
    q1: Array
    p2: Array
    q2: Array
    a: Array
    b: Array
    modes: tuple[str, ...]


@cache
def poses() -> Poses:
    made, chance = machine(), np.random.default_rng(5)
    places = chance.uniform([-500.0, -900.0], [500.0, 900.0], (20 * COUNT, 2))
    held = np.isfinite(made.mechanism.joints(places, "+-")).all(axis=1)
    p = places[held][:COUNT]
    parts = []
    for mode in made.modes:
        p1, p2 = chance.normal(size=(2, COUNT, 2)) * 200.0
        moved = made.motion.inverse(p, mode, p1, p2)
        rows, gain, _ = made.statics.at(p, mode)
        q = made.mechanism.joints(p, mode)
        parts.append(
            (
                p,
                q,
                p1,
                moved.joint_rates,
                p2,
                moved.joint_accelerations,
                gain * 480.0,
                rows[:, :2, :2] * 480.0,
            )
        )
    p, q, p1, q1, p2, q2, a, b = (np.concatenate(each) for each in zip(*parts, strict=True))
    modes = tuple(str(mode) for mode in made.modes for _ in range(COUNT))
    return Poses(p[:, 0], p[:, 1], q[:, 0], q[:, 1], p1, q1, p2, q2, a, b, modes)


def elbows(at: Poses) -> Array:
    """Eq. 2: b_1 and b_2 (N, 2, 2)."""
    one = np.stack([R1 * np.cos(at.one) - R3, R1 * np.sin(at.one)], axis=-1)
    two = np.stack([R1 * np.cos(at.two) + R3, R1 * np.sin(at.two)], axis=-1)
    return np.stack([one, two], axis=1)


# --- position ------------------------------------------------------------------------------


@computes(S, "Table I")
def table_1(item: Item) -> Outcome:
    table = machine().table
    names = ("proximal", "distal", "half_base")
    told = zip(("R_1", "R_2", "R_3"), item.data["lengths"], names, strict=True)
    return compared(
        *(
            Quantity(f"{what}, limb {n}", float(length) / 10.0, str(said), "cm")
            for what, said, key in told
            for n, length in enumerate(np.ravel(table[key]).tolist(), start=1)
        )
    )


@computes(S, "Fig. 1")
def fig_1(item: Item) -> Outcome:
    at = machine().at((0.0, START), "+-")
    theta = [float(np.degrees(v)) for v in at.joints]
    return drawn(
        at.reachable and at.posture.residual < 1e-9,
        Quantity(
            "θ_1, θ_2 at (0, 73.8644) cm, mode +−", f"{theta[0]:.4f}, {theta[1]:.4f}", unit="°"
        ),
        Quantity("closure error", at.posture.residual / 10.0, unit="cm"),
        proof="the posture that is drawn closes",
    )


@computes(S, "eq. 1")
def eq_1(item: Item) -> Outcome:
    at = poses()
    placed = machine().mechanism.transform(np.stack([at.x, at.y], axis=1), "+-")[:, :2, 3]
    return identity(error(placed, np.stack([at.x, at.y], axis=1)), where=WHERE)


@computes(S, "eq. 2")
def eq_2(item: Item) -> Outcome:
    at = poses()
    p = np.stack([at.x, at.y], axis=1)
    return identity(error(elbows(at), p[:, None] - at.b), where=WHERE)


def _links(at: Poses) -> Array:
    p = np.stack([at.x, at.y], axis=-1)
    return np.asarray(np.linalg.norm(p[:, None] - elbows(at), axis=-1))


@computes(S, "eq. 3")
def eq_3(item: Item) -> Outcome:
    return identity(error(_links(poses()), np.full((4 * COUNT, 2), 480.0)), where=WHERE)


@computes(S, "eq. 4")
def eq_4(item: Item) -> Outcome:
    at = poses()
    left = (at.x - R1 * np.cos(at.one) + R3) ** 2 + (at.y - R1 * np.sin(at.one)) ** 2
    return identity(error(left, np.full_like(left, 480.0**2)), where=WHERE)


@computes(S, "eq. 5")
def eq_5(item: Item) -> Outcome:
    at = poses()
    left = (at.x - R1 * np.cos(at.two) - R3) ** 2 + (at.y - R1 * np.sin(at.two)) ** 2
    return identity(error(left, np.full_like(left, 480.0**2)), where=WHERE)


def _z(at: Poses, limb: int, *, as_printed: bool) -> Array:
    """z_i of eq. 7 with the sign of each pose's mode."""
    x = at.x + R3 if limb == 0 or as_printed else at.x - R3
    square = R1**2 + at.y**2 + x**2 - 480.0**2
    a, b, c = square + 2 * x * R1, -4 * at.y * R1, square - 2 * x * R1
    sign = np.array([1.0 if mode[limb] == "+" else -1.0 for mode in at.modes])
    with np.errstate(invalid="ignore"):
        found: Array = (-b + sign * np.sqrt(b * b - 4 * a * c)) / (2 * a)
    return found


def _off(one: Array, other: Array) -> float:
    """The largest |Δ| of angles; π where there is none."""
    return float(np.nan_to_num(np.abs(np.angle(np.exp(1j * (one - other)))), nan=np.pi).max())


@computes(S, "eq. 6")
def eq_6(item: Item) -> Outcome:
    at = poses()
    theta = 2 * np.arctan(_z(at, 0, as_printed=True))
    return identity(_off(theta, at.one), where=f"{WHERE}, for limb 1", of="error in rad")


@computes(S, "eq. 7")
def eq_7(item: Item) -> Outcome:
    at = poses()
    off = [
        max(
            _off(2 * np.arctan(_z(at, limb, as_printed=printed)), (at.one, at.two)[limb])
            for limb in (0, 1)
        )
        for printed in (True, False)
    ]
    found = identity(off[0], off[1], where=WHERE, of="error in rad")
    none, pair = np.zeros(1), np.zeros((1, 2))
    top = np.array([START])
    start = Poses(none, top, none, none, pair, pair, pair, pair, pair, pair[..., None], ("+-",))
    told = [
        Quantity(
            f"θ_2 at (0, 73.8644) cm {how}",
            float(2 * np.arctan(_z(start, 1, as_printed=printed))[0]),
            unit="rad",
        )
        for how, printed in (("as printed", True), ("corrected", False))
    ]
    return Outcome(found.verdict, (*found.quantities, *told), found.proof)


# --- velocity, acceleration ----------------------------------------------------------------


def printed_a(at: Poses) -> Array:
    """The diagonal of eq. 21 (N, 2)."""
    first = at.y * np.cos(at.one) - (at.x + R3) * np.sin(at.one)
    second = at.y * np.cos(at.two) + (R3 - at.x) * np.sin(at.two)
    return R1 * np.stack([first, second], axis=-1)


def printed_b(at: Poses) -> Array:
    """Eq. 22 (N, 2, 2)."""
    rows = [
        [at.x + R3 - R1 * np.cos(at.one), at.y - R1 * np.sin(at.one)],
        [at.x - R3 - R1 * np.cos(at.two), at.y - R1 * np.sin(at.two)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _times(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _relative(left: Array, right: Array) -> float:
    """As `error`, row by row: near singularities rates are large."""
    size = np.maximum(np.abs(left), np.abs(right)).max(axis=-1)
    return float((np.abs(left - right).max(axis=-1) / size).max())


@computes(S, "eq. 20")
def eq_20(item: Item) -> Outcome:
    at = poses()
    off = _relative(printed_a(at) * at.q1, _times(printed_b(at), at.p1))
    return identity(off, where=WHERE)


@computes(S, "eq. 21")
def eq_21(item: Item) -> Outcome:
    return identity(error(printed_a(poses()), poses().a), where=WHERE)


@computes(S, "eq. 22")
def eq_22(item: Item) -> Outcome:
    return identity(error(printed_b(poses()), poses().b), where=WHERE)


@computes(S, "eq. 23")
def eq_23(item: Item) -> Outcome:
    at = poses()
    j = printed_b(at) / printed_a(at)[..., None]
    return identity(_relative(_times(j, at.p1), at.q1), where=f"{WHERE}, J maps ṗ to θ̇")


@computes(S, "eq. 24")
def eq_24(item: Item) -> Outcome:
    at = poses()
    x, y, r = at.x, at.y, R3
    c1, s1, c2, s2 = np.cos(at.one), np.sin(at.one), np.cos(at.two), np.sin(at.two)
    exact = at.a[:, 0] * at.a[:, 1]
    both, last = y * y * c1 * c2, (x * x - r * r) * s1 * s2
    as_printed = x * y * c1 * s2 - x * y * c2 * s1 - y * r * c1 * s2 - y * r * c2 * s1 + both - last
    right = -x * y * (c1 * s2 + s1 * c2) + y * r * (c1 * s2 - s1 * c2) + both + last
    factor = (y * c1 - (x + r) * s1) * (y * c2 - (r - x) * s2)
    found = identity(error(R1**2 * as_printed, exact), error(R1**2 * right, exact), where=WHERE)
    more = Quantity("error of the printed form as that product", error(as_printed, factor))
    return Outcome(found.verdict, (*found.quantities, more), found.proof)


@computes(S, "eq. 25")
def eq_25(item: Item) -> Outcome:
    at = poses()
    x, y, r1, r = at.x, at.y, R1, R3
    c1, s1, c2, s2 = np.cos(at.one), np.sin(at.one), np.cos(at.two), np.sin(at.two)
    left = 2 * y * r - y * r1 * c1 + y * r1 * c2 + x * r1 * s1 - x * r1 * s2
    left += -r1 * r * s1 - r1 * r * s2 - r1 * r1 * np.sin(at.one - at.two)
    return identity(error(left, np.linalg.det(at.b)), where=WHERE)


def _f(at: Poses) -> tuple[Array, Array]:
    """f_2, f_4, f_6 and g_2, g_4, g_6 of eq. 28, (3, N) each."""
    found = []
    for angle, rate, x in ((at.one, at.q1[:, 0], at.x + R3), (at.two, at.q1[:, 1], R3 - at.x)):
        c, s = np.cos(angle), np.sin(angle)
        px, py = at.p1.T
        # As printed, limb 2 has + (r_3 − x) c θ̇ where limb 1 has − (x + r_3) c θ̇.
        last = -x * c * rate if angle is at.one else x * c * rate
        second = R1 * (py * c - at.y * s * rate - px * s + last)
        found.append(np.stack([second, px + R1 * s * rate, py - R1 * c * rate]))
    return found[0], found[1]


def _c(at: Poses, *, as_printed: bool) -> Array:
    """Eq. 27 (N, 2)."""
    f, g = _f(at)
    second = at.q1[:, 0] if as_printed else at.q1[:, 1]
    px, py = at.p1.T
    rows = [px * f[1] + py * f[2] - at.q1[:, 0] * f[0], px * g[1] + py * g[2] - second * g[0]]
    return np.stack(rows, axis=-1)


def _rest(at: Poses) -> Array:
    """A θ̈ − B p̈ (N, 2) by the library."""
    return np.asarray(at.a * at.q2 - _times(at.b, at.p2))


@computes(S, "eq. 26")
def eq_26(item: Item) -> Outcome:
    at = poses()
    off = _relative(at.a * at.q2, _times(at.b, at.p2) + _c(at, as_printed=False))
    return identity(off, where=f"{WHERE}, with eq. 27 corrected")


@computes(S, "eq. 27")
def eq_27(item: Item) -> Outcome:
    at = poses()
    off = [_relative(_c(at, as_printed=printed), _rest(at)) for printed in (True, False)]
    return identity(off[0], off[1], where=WHERE)


@computes(S, "eq. 28")
def eq_28(item: Item) -> Outcome:
    # f_2, g_2 are the rates of A's diagonal, f_4, f_6, g_4, g_6 those of B: difference quotients.
    at, step = poses(), 1e-6
    moved = [
        Poses(
            at.x + h * at.p1[:, 0],
            at.y + h * at.p1[:, 1],
            at.one + h * at.q1[:, 0],
            at.two + h * at.q1[:, 1],
            at.p1,
            at.q1,
            at.p2,
            at.q2,
            at.a,
            at.b,
            at.modes,
        )
        for h in (step, -step)
    ]
    a = (printed_a(moved[0]) - printed_a(moved[1])) / (2 * step)
    b = (printed_b(moved[0]) - printed_b(moved[1])) / (2 * step)
    f, g = _f(at)
    off = max(
        error(f[0], a[:, 0]), error(g[0], a[:, 1]), error(f[1:].T, b[:, 0]), error(g[1:].T, b[:, 1])
    )
    return identity(off, where=f"{WHERE}, beside difference quotients of eqs. 21 and 22")


@computes(S, "eq. 29")
def eq_29(item: Item) -> Outcome:
    at = poses()
    found = (_times(printed_b(at), at.p2) + _c(at, as_printed=False)) / printed_a(at)
    return identity(_relative(found, at.q2), where=f"{WHERE}, with eq. 27 corrected")


@computes(S, "eq. 30")
def eq_30(item: Item) -> Outcome:
    at = poses()
    right = printed_a(at) * at.q2 - _c(at, as_printed=False)
    found = np.linalg.solve(printed_b(at), right[..., None])[..., 0]
    return identity(_relative(np.asarray(found), at.p2), where=f"{WHERE}, with eq. 27 corrected")
