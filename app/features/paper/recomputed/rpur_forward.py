"""Equations of the forward kinematics of {A1A1} and {A1A2}, tried at random postures.

Limbs are numbered as in the papers: 1, 2 and 3, 4 are the arrangements. The samples are presets
whose numbers are general, so that nothing that is taken for zero happens to be zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from app.features.paper.items import Item
from app.features.paper.judging import Outcome, error, identity
from app.features.paper.recomputed.postures import WHERE, Postures, of_machine, postures
from app.features.paper.recomputed.rpur_model import J, K
from app.features.paper.registry import computes
from kinematics.arrays import Array
from kinematics.machine import Machine


def _a1a1() -> Postures:
    """{A1A1} with z_A5 ≠ 0."""
    return of_machine(postures("rpur-a1a1").machine.edited("limb.4.base.2", 35.0))


def _a1a2() -> Postures:
    """{A1A2}: limbs 3 and 4 of the preset are the A2 pair, 1 and 2 the A1 pair."""
    return postures("rpur-a1a2")


def angle_error(one: Array, other: Array) -> Array:
    """|Δ| of angles, without whole turns."""
    return np.asarray(np.abs(np.angle(np.exp(1j * (one - other)))))


# --- {A1A1} --------------------------------------------------------------------------------


def _differences(at: Postures) -> tuple[Array, Array, float]:
    """Δx, Δz and Δs of B_34 and B_12."""
    return (
        at.x("B", 3) - at.x("B", 1),
        at.z("B", 3) - at.z("B", 1),
        float(at.s[2, 0] - at.s[0, 0]),
    )


@computes(J, "eq. 11")
@computes(K, "eq. 7")
def eq_11(item: Item) -> Outcome:
    at = _a1a1()
    dx, dz, ds = _differences(at)
    return identity(error(dx * at.cos - dz * at.sin, ds + 0.0 * dx), where=WHERE)


@computes(J, "eq. 12")
def eq_12(item: Item) -> Outcome:
    at = _a1a1()
    dx, dz, ds = _differences(at)
    length = np.hypot(dx, dz)
    middle = np.arctan2(-dz, dx)
    as_printed = angle_error(np.arccos(-ds / length) + middle, at.theta)
    half = np.arccos(np.clip(ds / length, -1.0, 1.0))
    right = np.minimum(angle_error(middle + half, at.theta), angle_error(middle - half, at.theta))
    worst = float(as_printed.max()), float(right.max())
    return identity(*worst, where=WHERE, of="error in rad")


@computes(J, "eq. 13")
@computes(K, "eq. 10")
def eq_13(item: Item) -> Outcome:
    at = _a1a1()
    x, z, rho = at.x("A", 5), at.z("A", 5), at.rho[:, 4]
    ell = _ell(at)

    def off(z_a: Array) -> float:
        root = np.sqrt(np.maximum(rho**2 - (x * at.cos - z_a * at.sin - ell) ** 2, 0.0))
        middle = x * at.sin**2 + z_a * at.sin * at.cos + ell * at.cos
        both = np.stack([middle + at.sin * root, middle - at.sin * root])
        near = np.abs(both - at.x("B", 5)).min(axis=0)
        return float(near.max()) / float(np.abs(at.x("B", 5)).max())

    return identity(off(0.0 * z), off(z), where=f"{WHERE} of a design with z_A5 = 35 mm")


def _ell(at: Postures) -> Array:
    turned = at.x("B", 1) * at.cos - at.z("B", 1) * at.sin
    return np.asarray(turned + at.s[4, 0] - at.s[0, 0])


@computes(J, "eq. 14")
@computes(K, "eq. 11")
def eq_14(item: Item) -> Outcome:
    at = _a1a1()
    turned = at.x("B", 5) * at.cos - at.z("B", 5) * at.sin
    return identity(error(_ell(at), turned), where=WHERE)


@computes(K, "eq. 8")
def eq_8_conference(item: Item) -> Outcome:
    at = _a1a1()
    dx, dz, ds = _differences(at)
    t = _both(dx, dz, ds, dz**2 + dx**2 - ds**2)
    as_printed = np.abs(t - np.tan(0.5 * at.phi)).min(axis=0)
    right = np.abs(t - np.tan(0.5 * at.theta)).min(axis=0)
    return identity(float(as_printed.max()), float(right.max()), where=WHERE)


@computes(K, "eq. 9")
def eq_9_conference(item: Item) -> Outcome:
    at = _a1a1()
    dx, dz, ds = _differences(at)
    theta = np.tan(0.5 * at.theta)
    with np.errstate(invalid="ignore"):
        wrong = np.abs(_both(dx, dz, ds, dz**2 - dx**2 + ds**2) - theta).min(axis=0)
    right = np.abs(_both(dx, dz, ds, dz**2 + dx**2 - ds**2) - theta).min(axis=0)
    # Where H as printed is negative there is no t at all.
    return identity(float(np.nan_to_num(wrong, nan=1.0).max()), float(right.max()), where=WHERE)


def _both(dx: Array, dz: Array, ds: float, h: Array) -> Array:
    """(2, N) t of eq. 8 by both signs."""
    root = np.sqrt(np.where(h >= 0.0, h, np.nan))
    return np.stack([(-dz + root) / (dx + ds), (-dz - root) / (dx + ds)])


@computes(K, "eq. 12")
def eq_12_conference(item: Item) -> Outcome:
    at = _a1a1()
    v = at.c - at.b
    cos2, square = at.cos[:, None] ** 2, v[..., 2] ** 2
    # κ has no meaning in print; without the −l² that makes it one the equations fail.
    return identity(
        error(-(v[..., 1] ** 2) * cos2, square),
        error((at.link**2 - v[..., 1] ** 2) * cos2, square),
        where=WHERE,
    )


# --- {A1A2} --------------------------------------------------------------------------------

ONE, TWO, KNOWN = 3, 4, 1  # limbs of the preset that are called 1, 2 and 34 in the paper


def _first(at: Postures) -> tuple[Array, float, float]:
    """O′₁ (N, 3), on the line C_1C_2 beside O′, and s_1, s_2 from there along e₂."""
    s1, s2 = float(at.s[ONE - 1, 0]), float(at.s[TWO - 1, 0])
    return at.c[:, ONE - 1] - s1 * at.turn[:, :, 0], s1, s2


@computes(J, "eq. 15")
def eq_15(item: Item) -> Outcome:
    at = _a1a2()
    first, _, _ = _first(at)
    off = (at.p[:, 0] - first[:, 0]) * at.cos - (at.p[:, 2] - first[:, 2]) * at.sin
    return identity(float(np.abs(off).max()) / 100.0, where=WHERE)


def _sphere(limb: int, which: int) -> Outcome:
    at = _a1a2()
    first, *s = _first(at)
    square = ((first - at.b[:, limb - 1]) ** 2).sum(axis=-1)
    return identity(error(square, s[which] ** 2 + at.link[ONE - 1] ** 2), where=WHERE)


@computes(J, "eq. 16")
def eq_16(item: Item) -> Outcome:
    return _sphere(ONE, 0)


@computes(J, "eq. 17")
def eq_17(item: Item) -> Outcome:
    return _sphere(TWO, 1)


def _squares(at: Postures, x_a: Array | float, z_a: Array | float) -> Array:
    """x_B2² + z_B2² − (x_B1² + z_B1²), from a point on."""
    one = (at.x("B", ONE) - x_a) ** 2 + (at.z("B", ONE) - z_a) ** 2
    two = (at.x("B", TWO) - x_a) ** 2 + (at.z("B", TWO) - z_a) ** 2
    return np.asarray(two - one)


@computes(J, "eq. 18")
def eq_18(item: Item) -> Outcome:
    at = _a1a2()
    first, s1, s2 = _first(at)
    left = 2 * first[:, 0] * (at.x("B", TWO) - at.x("B", ONE))
    left += 2 * first[:, 2] * (at.z("B", TWO) - at.z("B", ONE))
    return identity(error(left, s1**2 - s2**2 + _squares(at, 0.0, 0.0)), where=WHERE)


@computes(J, "eq. 19")
def eq_19(item: Item) -> Outcome:
    at = _a1a2()
    right = at.rho[:, TWO - 1] ** 2 - at.rho[:, ONE - 1] ** 2
    about = _squares(at, at.x("A", ONE), at.z("A", ONE))
    return identity(error(_squares(at, 0.0, 0.0), right), error(about, right), where=WHERE)


@computes(J, "eq. 20")
def eq_20(item: Item) -> Outcome:
    at = _a1a2()
    _, s1, s2 = _first(at)
    return identity(error(at.x("B", TWO) - at.x("B", ONE), (s2 - s1) * at.cos), where=WHERE)


@computes(J, "eq. 21")
def eq_21(item: Item) -> Outcome:
    at = _a1a2()
    _, s1, s2 = _first(at)
    return identity(error(at.z("B", TWO) - at.z("B", ONE), -(s2 - s1) * at.sin), where=WHERE)


def _right(at: Postures) -> Array:
    """The right side of eqs. 22 and 24."""
    _, s1, s2 = _first(at)
    square = at.rho[:, TWO - 1] ** 2 - at.rho[:, ONE - 1] ** 2 + s1**2 - s2**2
    return np.asarray(square / (2 * (s2 - s1)))


@computes(J, "eq. 22")
def eq_22(item: Item) -> Outcome:
    at = _a1a2()
    first, _, _ = _first(at)
    x_a, z_a = at.x("A", ONE), at.z("A", ONE)
    as_printed = first[:, 0] * at.cos - first[:, 2] * at.sin
    right = (first[:, 0] - x_a) * at.cos - (first[:, 2] - z_a) * at.sin
    return identity(error(as_printed, _right(at)), error(right, _right(at)), where=WHERE)


@computes(J, "eq. 23")
def eq_23(item: Item) -> Outcome:
    at = _a1a2()
    left = at.p[:, 0] * at.cos - at.p[:, 2] * at.sin
    right = at.x("B", KNOWN) * at.cos - at.z("B", KNOWN) * at.sin
    return identity(error(left, right), error(left, right - at.s[KNOWN - 1, 0]), where=WHERE)


@computes(J, "eq. 24")
def eq_24(item: Item) -> Outcome:
    at = _a1a2()
    x, z = at.x("B", KNOWN), at.z("B", KNOWN)
    x_a, z_a = at.x("A", ONE), at.z("A", ONE)
    as_printed = x * at.cos - z * at.sin
    right = (x - x_a) * at.cos - (z - z_a) * at.sin - at.s[KNOWN - 1, 0]
    return identity(error(as_printed, _right(at)), error(right, _right(at)), where=WHERE)


@computes(J, "eq. 25")
def eq_25(item: Item) -> Outcome:
    # Only the missing ± is asked: with A2 at the origin and s_34 = 0 the rest is right.
    as_printed, right = [], []
    made = _at_origin()
    for mode in ("+++++", "++--+"):
        at = of_machine(made, mode)
        x, z = at.x("B", KNOWN), at.z("B", KNOWN)
        half = np.arccos(np.clip(_right(at) / np.hypot(x, z), -1.0, 1.0))
        middle = -np.arctan2(z, x)
        plus, minus = angle_error(middle + half, at.theta), angle_error(middle - half, at.theta)
        as_printed.append(plus)
        right.append(np.minimum(plus, minus))
    where = f"{WHERE} in each of two modes, with A₁ = A₂ at the origin and s_34 = 0"
    worst = float(np.max(as_printed)), float(np.max(right))
    return identity(*worst, where=where, of="error in rad")


def _at_origin() -> Machine[Any]:
    made = _a1a2().machine
    for path, value in (
        *((f"limb.{limb - 1}.base.{axis}", 0.0) for limb in (ONE, TWO) for axis in (0, 2)),
        *((f"limb.{limb}.platform.0", 0.0) for limb in (0, 1)),
    ):
        made = made.edited(path, value)
    return made
