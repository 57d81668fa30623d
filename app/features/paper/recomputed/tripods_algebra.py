"""Nayak et al. (2017): the equations of the 3-SPR at random poses, its modes and its Jacobian."""

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
    drawn,
    error,
    identity,
)
from app.features.paper.registry import computes
from kinematics.arrays import Array
from kinematics.machine import Machine

N = "rps-spr-2017"
COUNT = 100
WHERE = f"at {COUNT} random poses in each mode"
ROOT = np.sqrt(3.0)
STEP = 1e-20  # imaginary, of derivatives to rounding


@cache
def machine(name: str) -> Machine[Any]:
    return kin.open(name)


@dataclass(frozen=True, eq=False)
class Poses:
    """Random poses of a machine in one mode, as Study parameters too.

    Attributes:
        poses: (N, 3) z, tilt, azimuth; turn (N, 3, 3); p (N, 3) mm.
        x, y: (N, 4) Study parameters, Σ x² = 1.
        joints: (N, 3) mm; h1, h2 mm.
    """

    machine: Machine[Any]
    mode: str
    poses: Array
    turn: Array
    p: Array
    x: Array
    y: Array
    joints: Array
    h1: float
    h2: float


@cache
def poses(name: str, mode: str) -> Poses:
    """The same ones each time; tilts keep away from 90°, where the 3-SPR has no position."""
    made, chance = machine(name), np.random.default_rng(2016)
    at = np.stack(
        [
            chance.uniform(60.0, 250.0, COUNT),
            chance.uniform(0.1, 1.2, COUNT),
            chance.uniform(-np.pi, np.pi, COUNT),
        ],
        axis=1,
    )
    placed = made.mechanism.transform(at, mode)
    table = made.table
    turn, p = placed[:, :3, :3], placed[:, :3, 3]
    x = quaternion(turn)
    return Poses(
        machine=made,
        mode=mode,
        poses=at,
        turn=turn,
        p=p,
        x=x,
        y=dual(x, p),
        joints=made.mechanism.joints(at, mode),
        h1=float(table["base_radius"]),
        h2=float(table["platform_radius"]),
    )


def both(name: str) -> tuple[Poses, Poses]:
    """In mode 1 and in mode 2."""
    return poses(name, "1"), poses(name, "2")


def quaternion(turn: Array) -> Array:
    """x (N, 4) of rotations, of length one."""
    from scipy.spatial.transform import Rotation  # slow to import

    return np.asarray(np.roll(Rotation.from_matrix(turn).as_quat(), 1, axis=-1))


def dual(x: Array, p: Array) -> Array:
    """y (N, 4) such that eq. 2 gives p and eq. 3 holds."""
    rows = _translation_rows(x)
    return np.asarray(0.5 * (p[:, None, :] @ rows)[:, 0])


def _translation_rows(x: Array) -> Array:
    """(N, 3, 4): M_T of eq. 2 is 2 · rows · y."""
    x0, x1, x2, x3 = x.T
    rows = [[x1, -x0, x3, -x2], [x2, -x3, -x0, x1], [x3, x2, -x1, -x0]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=1)


def printed_m(x: Any, y: Any) -> tuple[Any, Any]:
    """M_T and M_R of eq. 2 as printed."""
    x0, x1, x2, x3 = (x[..., n] for n in range(4))
    y0, y1, y2, y3 = (y[..., n] for n in range(4))
    shift = [
        -2 * x0 * y1 + 2 * x1 * y0 - 2 * x2 * y3 + 2 * x3 * y2,
        -2 * x0 * y2 + 2 * x1 * y3 + 2 * x2 * y0 - 2 * x3 * y1,
        -2 * x0 * y3 - 2 * x1 * y2 + 2 * x2 * y1 + 2 * x3 * y0,
    ]
    a, b, c, d = x0**2, x1**2, x2**2, x3**2
    turn = [
        [a + b - c - d, -2 * x0 * x3 + 2 * x1 * x2, 2 * x0 * x2 + 2 * x1 * x3],
        [2 * x0 * x3 + 2 * x1 * x2, a - b + c - d, -2 * x0 * x1 + 2 * x3 * x2],
        [-2 * x0 * x2 + 2 * x1 * x3, 2 * x0 * x1 + 2 * x3 * x2, a - b - c + d],
    ]
    rows = [np.stack(row, axis=-1) for row in turn]
    return np.stack(shift, axis=-1), np.stack(rows, axis=-2)


def triangle(h: float, *, as_printed: bool = False) -> Array:
    """A_i or B_i (3, 3): eq. 1 as printed or with the right y."""
    y = h / (2.0 * ROOT) if as_printed else 0.5 * ROOT * h
    return np.array([[h, 0.0, 0.0], [-0.5 * h, -y, 0.0], [-0.5 * h, y, 0.0]])


def axes(*, as_printed: bool = False) -> Array:
    """s_i (3, 3): eq. 5 as printed or right."""
    x = 1.0 / (2.0 * ROOT) if as_printed else 0.5 * ROOT
    return np.array([[0.0, -1.0, 0.0], [-x, 0.5, 0.0], [x, 0.5, 0.0]])


# --- the machines --------------------------------------------------------------------------


@computes(N, "Fig. 1", "Fig. 2")
def machines(item: Item) -> Outcome:
    name = item.data["design"]
    at = poses(name, "2")
    legs = at.p[:, None] + triangle(at.h2) @ at.turn.swapaxes(-1, -2) - triangle(at.h1)
    off = error(np.linalg.norm(legs, axis=-1), at.joints)
    # The revolute axis stands on the base (3-RPS) or turns with the platform (3-SPR).
    across = axes() @ at.turn.swapaxes(-1, -2) if name == "spr-3" else axes()
    off = max(off, float(np.abs((legs * across).sum(axis=-1)).max()) / at.h1)
    return drawn(
        off < 1e-9,
        Quantity("error of limb lengths and of limb ⟂ axis at 100 random poses", off),
        Quantity("h₁", at.h1, unit="mm"),
        Quantity("h₂", at.h2, unit="mm"),
        proof="drawn to the paper's example, times 100 mm",
    )


@computes(N, "eq. 1")
def eq_1(item: Item) -> Outcome:
    off = [0.0, 0.0]
    for at in both("spr-3"):
        for n, as_printed in enumerate((True, False)):
            a, b = (triangle(h, as_printed=as_printed) for h in (at.h1, at.h2))
            legs = at.p[:, None] + b @ at.turn.swapaxes(-1, -2) - a
            off[n] = max(off[n], error(np.linalg.norm(legs, axis=-1), at.joints))
    return identity(off[0], off[1], where=f"{WHERE}, put into the limb lengths")


@computes(N, "eq. 2")
def eq_2(item: Item) -> Outcome:
    off = 0.0
    for at in both("spr-3"):
        shift, turn = printed_m(at.x, at.y)
        off = max(off, error(shift, at.p), error(turn, at.turn))
    return identity(off, where=WHERE)


@computes(N, "eq. 3")
def eq_3(item: Item) -> Outcome:
    off = max(
        float(np.abs((at.x * at.y).sum(axis=1)).max()) / float(np.abs(at.y).max())
        for at in both("spr-3")
    )
    return identity(off, where=WHERE)


@computes(N, "eq. 4")
def eq_4(item: Item) -> Outcome:
    # With all x zero the printed M_R is no rotation.
    _, turn = printed_m(np.zeros((1, 4)), np.ones((1, 4)))
    least = min(float((at.x**2).sum(axis=1).min()) for at in both("spr-3"))
    return claimed(
        least > 0.0 and float(np.abs(np.linalg.det(turn)).max()) == 0.0,
        Quantity("least Σ x² at random poses", least),
        Quantity("determinant of M_R where all x are zero", float(np.linalg.det(turn)[0])),
        proof="no displacement of the library violates it, and what does is no displacement",
    )


@computes(N, "eq. 5")
def eq_5(item: Item) -> Outcome:
    off = [0.0, 0.0]
    for at in both("spr-3"):
        legs = at.p[:, None] + triangle(at.h2) @ at.turn.swapaxes(-1, -2) - triangle(at.h1)
        for n, as_printed in enumerate((True, False)):
            turned = axes(as_printed=as_printed) @ at.turn.swapaxes(-1, -2)
            along = np.abs((legs * turned).sum(axis=-1)).max() / at.joints.max()
            off[n] = max(off[n], float(along))
    return identity(off[0], off[1], where=f"{WHERE}, limb ⟂ axis")


@computes(N, "eq. 6")
def eq_6(item: Item) -> Outcome:
    off = 0.0
    for at in both("spr-3"):
        shift, turn = printed_m(at.x, at.y)
        points = shift[:, None] + triangle(at.h2) @ turn.swapaxes(-1, -2)
        wrenches = at.machine.statics.wrenches(at.poses, at.mode)
        # Each limb's force passes through A_i and B_i.
        force, moment = wrenches.rows[:, :3, :3], wrenches.rows[:, :3, 3:]
        off = max(off, error(np.cross(points - shift[:, None], force), moment))
    return identity(off, where=f"{WHERE}, B_i on the lines of the library's forces")


def constraints(x: Any, y: Any, h1: float, *, as_printed: bool = False) -> Any:
    """g_1, g_2, g_3 of eq. 7 (..., 3)."""
    x0, x1, x2, x3 = (x[..., n] for n in range(4))
    y0, y1, y2, y3 = (y[..., n] for n in range(4))
    lost = 2 * x2 if as_printed else 2 * x2 * y3
    first = 2 * h1 * x0 * x3 if as_printed else -h1 * x0 * x3
    return np.stack(
        [
            x0 * x3,
            h1 * x1**2 - h1 * x2**2 - 2 * x0 * y1 + 2 * x1 * y0 + lost - 2 * x3 * y2,
            first + h1 * x1 * x2 + x0 * y2 + x1 * y3 - x2 * y0 - x3 * y1,
        ],
        axis=-1,
    )


@computes(N, "eq. 7")
def eq_7(item: Item) -> Outcome:
    off = [0.0, 0.0]
    for at in both("spr-3"):
        for n, as_printed in enumerate((True, False)):
            g = constraints(at.x, at.y, at.h1, as_printed=as_printed)
            off[n] = max(off[n], float(np.abs(g).max()) / at.h1)
    return identity(off[0], off[1], where=WHERE)


@computes(N, "eq. 8")
def eq_8(item: Item) -> Outcome:
    off = 0.0
    for at in both("spr-3"):
        seven = np.abs((at.x * at.y).sum(axis=1)).max() / np.abs(at.y).max()
        off = max(off, float(seven), float(np.abs((at.x**2).sum(axis=1) - 1.0).max()))
    return identity(off, where=WHERE)
