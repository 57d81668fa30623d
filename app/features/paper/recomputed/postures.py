"""Random postures of a 5-RPUR with everything that the papers' equations are written in.

A is on the base, B the U joint, C on the platform; s′ are the platform points in its own frame.
Poses and lengths come from the library: C from the placement, B from where the actuation wrenches
act, ρ from the inverse kinematics. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import kinematics as kin
from kinematics.arrays import Array
from kinematics.machine import Machine

COUNT = 200
"""Postures at which a formula is tried."""
WHERE = f"at {COUNT} random postures"


@dataclass(frozen=True, eq=False)
class Postures:
    """N postures of one machine in one working mode.

    Attributes:
        a: (5, 3) base points; s (5, 3) platform points, platform frame; link (5,) mm.
        p, b, c: (N, 3), (N, 5, 3), (N, 5, 3) mm, base frame.
        rho: (N, 5) mm.
        phi, theta: (N,) rad; cos, sin: of θ.
        turn: (N, 3, 3) from the platform to the base frame.
    """

    machine: Machine[Any]
    mode: str
    poses: Array
    a: Array
    s: Array
    link: Array
    p: Array
    b: Array
    c: Array
    rho: Array
    turn: Array

    @property
    def phi(self) -> Array:
        return self.poses[:, 3]

    @property
    def theta(self) -> Array:
        return self.poses[:, 4]

    @property
    def cos(self) -> Array:
        return np.cos(self.theta)

    @property
    def sin(self) -> Array:
        return np.sin(self.theta)

    def x(self, points: str, limb: int) -> Array:
        """(N,) the x coordinates of a limb's A, B or C; limbs count from 1."""
        return self._at(points, limb, 0)

    def y(self, points: str, limb: int) -> Array:
        return self._at(points, limb, 1)

    def z(self, points: str, limb: int) -> Array:
        return self._at(points, limb, 2)

    def _at(self, points: str, limb: int, axis: int) -> Array:
        found: Array = {"A": self.a[None], "B": self.b, "C": self.c}[points]
        return np.asarray(np.broadcast_to(found, self.b.shape)[:, limb - 1, axis])


@cache
def machine(name: str) -> Machine[Any]:
    """The machine of a preset."""
    return kin.open(name)


def with_limbs(limbs: Iterable[Mapping[str, Any]], head: str = "") -> Machine[Any]:
    """A 5-RPUR of given limbs, as design files have them; ``head``: what else its file says."""
    lines = ['mechanism = "five_rpur"', head]
    for limb in limbs:
        lines += ["[[limb]]", *(f"{key} = {value}" for key, value in limb.items())]
    return kin.read("\n".join(lines))


@cache
def postures(name: str, mode: str = "", spread: float = 0.9) -> Postures:
    """The same random postures of a preset each time; every limb closes, strokes left aside.

    Args:
        mode: "" for the home posture's.
        spread: rad, of φ and θ to either side.
    """
    return of_machine(machine(name), mode, spread)


def of_machine(made: Machine[Any], mode: str = "", spread: float = 0.9) -> Postures:
    """Likewise of any machine."""
    home, chance = made.home, np.random.default_rng(20110101)
    mode = mode or home.mode
    size = np.array([80.0, 60.0, 80.0, spread, spread])
    middle = np.array([*home.pose[:3], 0.0, 0.0])
    tried = middle + size * chance.uniform(-1.0, 1.0, (60 * COUNT, 5))
    rho = made.mechanism.joints(tried, mode)
    closing = np.flatnonzero(np.isfinite(rho).all(axis=1))[:COUNT]
    poses, rho = tried[closing], rho[closing]
    limbs = made.table["limb"]
    s = np.array([limb["platform"] for limb in limbs], dtype=float)
    placed = made.mechanism.transform(poses, mode)
    turn, p = placed[:, :3, :3], placed[:, :3, 3]
    return Postures(
        machine=made,
        mode=mode,
        poses=poses,
        a=np.array([limb["base"] for limb in limbs], dtype=float),
        s=s,
        link=np.array([limb["link"] for limb in limbs], dtype=float),
        p=p,
        b=made.statics.wrenches(poses, mode).point[:, : len(limbs)],
        c=p[:, None] + s @ turn.swapaxes(-1, -2),
        rho=rho,
        turn=turn,
    )
