"""Wang et al. (2017): the equations at random poses of the preset."""

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
    claimed,
    compared,
    error,
    identity,
)
from app.features.paper.registry import computes
from kinematics.arrays import Array
from kinematics.machine import Machine

W = "sps-spr-2017"
COUNT = 200
WHERE = f"at {COUNT} random poses"
LEGS, SPR = 5, 4
LEVEL = 560.0
"""mm, an altitude within the printed range."""


@dataclass(frozen=True, eq=False)
class Poses:
    """N random poses on the constraint, with random rates, and what the library says of them.

    Attributes:
        turn, p: (N, 3, 3), (N, 3).
        a, b: (5, 3) base points; platform points, platform frame.
        velocity, acceleration: (N, 6) [v, ω] and [a, ε].
        joints, rates, second: (N, 5) of the legs.
    """

    poses: Array
    turn: Array
    p: Array
    a: Array
    b: Array
    axis: Array
    velocity: Array
    acceleration: Array
    joints: Array
    rates: Array
    second: Array

    @property
    def arm(self) -> Array:
        """r_i (N, 5, 3)."""
        return np.asarray(self.b @ self.turn.swapaxes(-1, -2))

    @property
    def n(self) -> Array:
        """n_i (N, 5, 3)."""
        return np.asarray((self.p[:, None] + self.arm - self.a) / self.joints[..., None])

    @property
    def n6(self) -> Array:
        return np.asarray(self.turn @ self.axis)

    @property
    def r6(self) -> Array:
        return np.asarray(self.a[SPR] - self.p)

    @property
    def g(self) -> Array:
        """G of eq. 10, (N, 6, 6)."""
        legs = np.concatenate([self.n, np.cross(self.arm, self.n)], axis=-1)
        sixth = np.concatenate([self.n6, np.cross(self.r6, self.n6)], axis=-1)
        return np.concatenate([legs, sixth[:, None]], axis=1)


@cache
def machine() -> Machine[Any]:
    return kin.open("sps-spr")


@cache
def poses() -> Poses:
    """The same ones each time; x follows from the constraint."""
    made, chance = machine(), np.random.default_rng(2017)
    mode = made.home.mode
    size = np.array([0.0, 80.0, 60.0, 0.3, 0.3, 0.3])
    found: list[Array] = []
    while len(found) < COUNT:
        tried = np.array(made.home.pose) + size * chance.uniform(-1.0, 1.0, 6)
        tried[0] = np.nan
        try:
            found.append(np.array(made.complete_pose(tried.tolist(), mode)))
        except kin.InputError:
            continue
    at = np.array(found)
    rates, second = chance.normal(size=(2, COUNT, 6)) * np.array([30, 30, 30, 0.2, 0.2, 0.2])
    rates[:, 0] = second[:, 0] = np.nan
    moved = made.motion.inverse(at, mode, rates, second)
    swapped = [3, 4, 5, 0, 1, 2]  # [ω, v] → [v, ω]
    placed = made.mechanism.transform(at, mode)
    limbs = made.table["limb"]
    axis = np.array(made.table["revolute_axis"], dtype=float)
    return Poses(
        poses=at,
        turn=placed[:, :3, :3],
        p=placed[:, :3, 3],
        a=np.array([limb["base"] for limb in limbs], dtype=float),
        b=np.array([limb["platform"] for limb in limbs], dtype=float),
        axis=axis / np.linalg.norm(axis),
        velocity=moved.twist[:, swapped],
        acceleration=moved.twist_rate[:, swapped],
        joints=made.mechanism.joints(at, mode),
        rates=moved.joint_rates,
        second=moved.joint_accelerations,
    )


def skew(v: Array) -> Array:
    """Eq. 12: (..., 3) → (..., 3, 3)."""
    x, y, z = (v[..., k] for k in range(3))
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


# --- position ------------------------------------------------------------------------------


@computes(W, "eq. 1")
def eq_1(item: Item) -> Outcome:
    data = item.data
    freedoms = 6 * (data["links"] - data["joints"] - 1) + sum(data["freedoms"]) - data["idle"]
    at = poses()
    rank = int(np.linalg.matrix_rank(at.g[0] / np.repeat([1.0, 100.0], 3)))
    free = 6 - int(np.linalg.matrix_rank(at.g[0, LEGS:]))
    return compared(
        Quantity("M by the formula", float(freedoms), str(data["mobility"])),
        Quantity("freedoms that the library's one constraint leaves", float(free), "5"),
        Quantity("rank of G, legs and constraint", float(rank)),
    )


@computes(W, "eq. 2")
def eq_2(item: Item) -> Outcome:
    at = poses()
    off = error(at.turn @ at.turn.swapaxes(-1, -2), np.broadcast_to(np.eye(3), at.turn.shape))
    return identity(off, where=f"{WHERE}, R orthogonal")


@computes(W, "eq. 3")
def eq_3(item: Item) -> Outcome:
    at = poses()
    points = machine().statics.wrenches(at.poses, machine().home.mode).point[:, :LEGS]
    found = np.einsum("nij,kj->nki", euler(at.poses, third=True), at.b) + at.p[:, None]
    return identity(error(found, points), where=WHERE)


def euler(at: Array, *, third: bool) -> Array:
    """R_z(α) R_y(β) R_x(γ) as printed after eq. 3; with ``third`` entry (1, 3) has cγ."""
    (ca, cb, cg), (sa, sb, sg) = np.cos(at[:, 3:]).T, np.sin(at[:, 3:]).T
    # "λ" of the printed entry is one of the three: the misprint is least as another one than γ.
    lam = cg if third else ca
    rows = [
        [ca * cb, ca * sb * sg - sa * cg, ca * sb * lam + sa * sg],
        [sa * cb, sa * sb * sg + ca * cg, sa * sb * cg - ca * sg],
        [-sb, cb * sg, cb * cg],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


@computes(W, "R after eq. 3")
def rotation(item: Item) -> Outcome:
    at = poses()
    as_printed, right = euler(at.poses, third=False), euler(at.poses, third=True)
    where = f"{WHERE}, λ read as α"
    return identity(error(as_printed, at.turn), error(right, at.turn), where=where)


@computes(W, "eq. 4")
def eq_4(item: Item) -> Outcome:
    at = poses()
    legs = at.p[:, None] + at.arm - at.a
    return identity(error(np.linalg.norm(legs, axis=-1), at.joints), where=WHERE)


@computes(W, "eq. 5")
def eq_5(item: Item) -> Outcome:
    at = poses()
    rows = machine().statics.at(at.poses, machine().home.mode).rows[:, :LEGS, :3]
    return identity(error(at.n, rows), where=WHERE)


# --- velocity, acceleration ----------------------------------------------------------------


@computes(W, "eq. 6")
def eq_6(item: Item) -> Outcome:
    # Beside the difference quotient of the library's own platform points.
    at = poses()
    v, w = at.velocity[:, None, :3], at.velocity[:, None, 3:]
    step = 1e-5
    turned = np.einsum("nij,nkj->nki", _turn(at.velocity[:, 3:] * step), at.arm)
    back = np.einsum("nij,nkj->nki", _turn(-at.velocity[:, 3:] * step), at.arm)
    moved = v + (turned - back) / (2.0 * step)
    return identity(error(v + np.cross(w, at.arm), moved), where=WHERE)


def _turn(vector: Array) -> Array:
    """Rotations by vectors (N, 3), by Rodrigues' formula."""
    angle = np.linalg.norm(vector, axis=-1)[:, None, None]
    k = skew(vector / angle[:, :, 0])
    return np.asarray(np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k)


@computes(W, "eq. 7")
def eq_7(item: Item) -> Outcome:
    at = poses()
    v, w = at.velocity[:, None, :3], at.velocity[:, None, 3:]
    along = (at.n * v).sum(axis=-1) + (np.cross(at.arm, at.n) * w).sum(axis=-1)
    return identity(error(along, at.rates), where=WHERE)


@computes(W, "eq. 8")
def eq_8(item: Item) -> Outcome:
    at = poses()
    found = (at.g[:, :LEGS] @ at.velocity[..., None])[..., 0]
    return identity(error(found, at.rates), where=WHERE)


@computes(W, "eq. 9")
def eq_9(item: Item) -> Outcome:
    at = poses()
    v, w = at.velocity[:, :3], at.velocity[:, 3:]
    force = (at.n6 * v).sum(axis=-1)
    as_printed = (np.cross(at.n6, at.r6) * w).sum(axis=-1)
    return identity(error(-force, as_printed), error(-force, -as_printed), where=WHERE)


@computes(W, "eq. 10")
def eq_10(item: Item) -> Outcome:
    at = poses()
    power = np.concatenate([at.rates, np.zeros((COUNT, 1))], axis=1)
    back = np.linalg.solve(at.g, power[..., None])[..., 0]
    off = max(error((at.g @ at.velocity[..., None])[..., 0], power), error(back, at.velocity))
    return identity(off, where=WHERE)


@computes(W, "eq. 11")
def eq_11(item: Item) -> Outcome:
    # (a, ε) given back by the library's forward acceleration.
    at = poses()
    found = machine().motion.forward(at.poses, machine().home.mode, at.rates, at.second)
    swapped = found.twist_rate[:, [3, 4, 5, 0, 1, 2]]
    return identity(error(swapped, at.acceleration), where=f"{WHERE}, there and back")


@computes(W, "eq. 12")
def eq_12(item: Item) -> Outcome:
    at = poses()
    found = skew(at.arm) @ at.n[..., None]
    off = max(
        error(found[..., 0], np.cross(at.arm, at.n)),
        error(skew(at.arm).swapaxes(-1, -2), -skew(at.arm)),
    )
    return identity(off, where=WHERE)


def _bias(at: Poses, sign: float) -> Array:
    """Vᵀ H_i V of eq. 13 (N, 5), its first matrix with + or − r̂² in the lower right block."""
    r, n = skew(at.arm), skew(at.n)
    v = np.broadcast_to(at.velocity[:, None, :3], at.arm.shape)[..., None]
    w = np.broadcast_to(at.velocity[:, None, 3:], at.arm.shape)[..., None]

    def quadratic(left: Array, matrix: Array, right: Array) -> Array:
        return np.asarray((left.swapaxes(-1, -2) @ matrix @ right)[..., 0, 0])

    first = (v.swapaxes(-1, -2) @ v)[..., 0, 0] - quadratic(v, r, w) + quadratic(w, r, v)
    first = first + quadratic(w, sign * r @ r, w)
    along = (at.g[:, :LEGS] @ at.velocity[..., None])[..., 0]
    return np.asarray((first - along**2) / at.joints + quadratic(w, r @ n, w))


@computes(W, "eq. 13")
def eq_13(item: Item) -> Outcome:
    at = poses()
    rest = at.second - (at.g[:, :LEGS] @ at.acceleration[..., None])[..., 0]
    return identity(error(_bias(at, 1.0), rest), error(_bias(at, -1.0), rest), where=WHERE)


def _sixth(at: Poses) -> Array:
    """Vᵀ H₆ V of eq. 14, (N,)."""
    v, w = at.velocity[:, :3, None], at.velocity[:, 3:, None]
    n, r = skew(at.n6), skew(at.r6)
    vt, wt = v.swapaxes(-1, -2), w.swapaxes(-1, -2)
    return np.asarray((-vt @ n @ w + wt @ n @ v - wt @ n @ r @ w)[:, 0, 0])


@computes(W, "eq. 14")
def eq_14(item: Item) -> Outcome:
    at = poses()
    along = (at.g[:, LEGS] * at.acceleration).sum(axis=-1)
    return identity(error(-along, _sixth(at)), where=WHERE)


@computes(W, "eq. 15")
def eq_15(item: Item) -> Outcome:
    at = poses()
    rest = np.concatenate([_bias(at, -1.0), _sixth(at)[:, None]], axis=1)
    given = np.concatenate([at.second, np.zeros((COUNT, 1))], axis=1)
    back = np.linalg.solve(at.g, (given - rest)[..., None])[..., 0]
    return identity(error(back, at.acceleration), where=f"{WHERE}, with eq. 13 corrected")


# --- statics -------------------------------------------------------------------------------


@computes(W, "eq. 16")
def eq_16(item: Item) -> Outcome:
    at, load = poses(), np.array([0.0, 10.0, -10.0, 10.0, 0.0, 10.0])
    found = -np.linalg.solve(at.g.swapaxes(-1, -2), np.broadcast_to(load, (COUNT, 6))[..., None])
    held = machine().statics.forces(at.poses, machine().home.mode, load)
    return identity(error(found[..., 0], held.forces), where=f"{WHERE} under the load of section 4")


@computes(W, "C1")
def c_1(item: Item) -> Outcome:
    table = machine().table["limb"]
    prismatic, spherical, revolute = len(table), 2 * len(table) - 1, 1
    kinds = item.data["kinds"]
    return compared(
        Quantity("prismatic joints", float(prismatic), str(kinds[0])),
        Quantity("spherical joints", float(spherical), str(kinds[1])),
        Quantity("revolute joints", float(revolute), str(kinds[2])),
        Quantity("joints", float(prismatic + spherical + revolute), str(item.data["joints"])),
        Quantity("links", float(2 * len(table) + 2), str(item.data["links"])),
    )


@computes(W, "C2")
def c_2(item: Item) -> Outcome:
    at = poses()
    base, platform = np.linalg.norm(at.a[1:], axis=1), np.linalg.norm(at.b, axis=1)
    return compared(
        Quantity("r_a of A₂ … A₅ in the preset", float(base.mean()), str(item.data["r_a"]), "mm"),
        Quantity("r_b of B₁ … B₅", float(platform.mean()), str(item.data["r_b"]), "mm"),
        Quantity("W, chosen here", float(at.a[0, 0]), unit="mm"),
    )


@computes(W, "C3")
def c_3(item: Item) -> Outcome:
    load = np.array(item.data["load"], dtype=float)
    held = machine().at().forces(load)
    rows = machine().at().wrenches().rows
    left = float(np.abs(held.forces @ rows + load).max()) / float(np.abs(load).max())
    told = ", ".join(f"{v:.2f}".replace("-", "−") for v in held.forces)
    return claimed(
        left < 1e-9,
        Quantity("F₁ … F₅, F_τ that hold it at the preset's home", told, unit="N"),
        Quantity("what is left of the load", left),
        proof="an input; the library holds it",
    )
