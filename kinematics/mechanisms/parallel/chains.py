"""Limbs given as chains of joints: which known limb it is, and its numbers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from typing import cast

import numpy as np

from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.mechanisms.parallel.design import Entries, LimbTable
from kinematics.mechanisms.parallel.limb_types import SPHERICAL, TYPES
from kinematics.mechanisms.parallel.limbs import Bond, Drive, Limb, copies, unit

_ALIGNED = 1e-6
"""Sine of the angle below which axes are parallel; part of a rod below which points meet."""
KNOWN = (
    "UPS, SPS, RUS, RSS, PUS, PSS, PRS, RRS, RPS, SPR, UPU, RPUR, planar RPR, RRR and PRR, "
    "and RRR with three axes through one point"
)


@dataclass(frozen=True, eq=False)
class Joint:
    """One joint at the reference, base frame."""

    letter: str
    at: Array
    axes: tuple[Array, ...]
    actuated: bool
    low: float
    high: float
    value: float

    @property
    def axis(self) -> Array:
        return self.axes[0]


def _joint(entries: Entries, turn: Array) -> Joint:
    table = dict(entries)
    letter = str(table["joint"])
    at = turn @ np.array(table.get("at", (0.0, 0.0, 0.0)), dtype=float)
    given = (
        [table["axis"]]
        if "axis" in table
        else list(cast(tuple[object, ...], table.get("axes", ())))
    )
    axes = tuple(unit(turn @ np.array(axis, dtype=float)) for axis in given)
    low, high = cast(tuple[float, float], table.get("range", (-inf, inf)))
    value = float(cast(float, table.get("value", 0.0)))
    if letter == "R":
        low, high, value = np.radians(low), np.radians(high), np.radians(value)
    return Joint(
        letter, at, axes, bool(table.get("actuated")), float(low), float(high), float(value)
    )


def chain(table: LimbTable, copy: int, start: Array) -> Limb:
    """The limb of a chain.

    Args:
        start: (4, 4) the reference pose.

    Raises:
        InputError: it is no known limb; the message says what is the matter.
    """
    joints = [_joint(entries, copies(table, copy)) for entries in table.joints]
    word = "".join(joint.letter for joint in joints)
    driven = [n for n, joint in enumerate(joints) if joint.actuated]
    if len(driven) != 1:
        raise InputError(
            f"{len(driven)} of its joints are actuated; mark one, with actuated = true"
        )
    (k,) = driven
    made = _Chain(joints, word, k, start)
    found = made.limb()
    if found is None:
        raise InputError(
            f"the chain {' '.join(word)} with its joint {k + 1} actuated has no closed-form "
            f"inverse kinematics here; known are {KNOWN}"
        )
    return found


@dataclass(frozen=True, eq=False)
class _Chain:
    joints: list[Joint]
    word: str
    driven: int
    start: Array

    def limb(self) -> Limb | None:
        """The limb; None where it is no known one."""
        word, k = self.word, self.driven
        first, last = self.joints[0], self.joints[-1]
        middle = self.joints[1] if len(self.joints) == 3 else None
        if word == "RPUR" and k == 1:
            return self._offset_leg()
        if middle is None:
            return None
        if middle.letter == "P" and k == 1:
            return self._leg(first, middle, last)
        if word in ("RUS", "RSS", "RSU") and k == 0:
            return self._crank("RUS", "free", first, first.at, middle.at, last.at)
        if word in ("PUS", "PSS", "PSU") and k == 0:
            return self._slider("PUS", "free", first, middle.at, last.at)
        flat = [joint.axis for joint in self.joints if joint.letter == "R"]
        parallel = all(_parallel(axis, flat[0]) for axis in flat[1:]) if flat else False
        if word in ("PRS", "PRR") and k == 0 and abs(first.axis @ middle.axis) < _ALIGNED:
            if word == "PRR" and not parallel:
                return None
            e = _level(middle.at, last.at, middle.axis)
            bond: Bond = "base plane" if word == "PRS" else "planar"
            return self._slider(word, bond, first, e, last.at, middle.axis)
        if word in ("RRS", "RRR") and parallel and k <= (1 if word == "RRR" else 0):
            a, e = (_level(joint.at, last.at, first.axis) for joint in (first, middle))
            if k == 1:
                return self._elbow(first, middle, a, e, last.at)
            bond = "base plane" if word == "RRS" else "planar"
            return self._crank(word, bond, first, a, e, last.at)
        if word == "RRR" and k == 0:
            return self._spherical(first, middle, last)
        return None

    # --- what limbs have in common

    def _made(self, name: str, drive: Drive, bond: Bond, a: Array, b: Array) -> Limb:
        r, p = self.start[:3, :3], self.start[:3, 3]
        act = self.joints[self.driven]
        kind = SPHERICAL if name == SPHERICAL.name else TYPES[name]
        z = np.zeros(3)
        return Limb(
            kind, drive, bond, a, r.T @ (b - p), np.array([0.0, 0.0, 1.0]), z, 0.0, 0.0, 0.0,
            np.array([0.0, 0.0, 1.0]), z, act.low, act.high, 1,
        )  # fmt: skip

    def _bonded(self, limb: Limb, axis: Array | None) -> Limb:
        """With the axis of a plane of its bond."""
        if axis is None:
            return limb
        return replace(limb, normal=axis, mark=self.start[:3, :3].T @ axis)

    def _leg(self, first: Joint, slide: Joint, last: Joint) -> Limb | None:
        word, a, b = self.word, first.at, last.at
        axis: Array | None = None
        bond: Bond = "free"
        if word == "RPS":
            bond, axis, a = "base plane", first.axis, _level(first.at, b, first.axis)
        elif word == "SPR":
            bond, axis, b = "platform plane", last.axis, _level(last.at, a, last.axis)
        elif word == "RPR":
            if not _parallel(first.axis, last.axis):
                return None
            bond, axis, a = "planar", first.axis, _level(first.at, b, first.axis)
        elif word == "UPU":
            if not _parallel(first.axes[1], last.axes[0]):
                return None
            bond = "universal"
        elif word not in ("UPS", "SPS", "SPU"):
            return None
        if not _parallel(slide.axis, b - a):
            raise InputError(
                "its P joint must slide along the line between the joints at its ends, "
                f"along {_told(unit(b - a))}"
            )
        name = "UPS" if bond == "free" else word
        limb = self._made(name, "leg", bond, a, b)
        shift = slide.value - float(np.linalg.norm(b - a))
        limb = replace(self._bonded(limb, axis), shift=shift)
        if bond == "universal":
            if max(abs(slide.axis @ inner) for inner in (first.axes[1], last.axes[0])) > _ALIGNED:
                raise InputError("the inner axes of its U joints must be normal to its leg")
            turn = self.start[:3, :3].T
            limb = replace(limb, normal=first.axes[0], mark=turn @ last.axes[1])
        return limb

    def _crank(self, name: str, bond: Bond, act: Joint, a: Array, e: Array, b: Array) -> Limb:
        w = act.axis
        a = _level(a, e, w)
        arm = e - a
        if np.linalg.norm(arm) < _ALIGNED * max(float(np.linalg.norm(b - e)), 1e-9):
            raise InputError("its second joint lies on the axis of the first, which moves nothing")
        limb = self._made(name, "crank", bond, a, b)
        zero = _rotated(w, unit(arm), -act.value)
        limb = replace(
            limb,
            axis=w,
            zero=zero,
            crank=float(np.linalg.norm(arm)),
            rod=float(np.linalg.norm(b - e)),
        )
        return self._bonded(limb, w if bond != "free" else None)

    def _elbow(self, first: Joint, act: Joint, a: Array, e: Array, b: Array) -> Limb:
        limb = self._made("RRR", "elbow", "planar", a, b)
        one, two = e - a, b - e
        bent = float(np.arctan2(np.cross(one, two) @ first.axis, one @ two))
        r, rod = (float(np.linalg.norm(v)) for v in (one, two))
        limb = replace(limb, axis=first.axis, crank=r, rod=rod, shift=act.value - bent)
        return self._bonded(limb, first.axis)

    def _slider(
        self, name: str, bond: Bond, act: Joint, e: Array, b: Array, axis: Array | None = None
    ) -> Limb:
        limb = self._made(name, "slider", bond, e - act.value * act.axis, b)
        limb = replace(limb, axis=act.axis, rod=float(np.linalg.norm(b - e)))
        return self._bonded(limb, axis)

    def _offset_leg(self) -> Limb | None:
        first, slide, universal, last = self.joints
        aligned = _parallel(first.axis, universal.axes[0]) and _parallel(
            universal.axes[1], last.axis
        )
        if not aligned or abs(slide.axis @ first.axis) > _ALIGNED:
            return None
        q = universal.at
        a, b = _level(first.at, q, first.axis), _level(last.at, q, last.axis)
        limb = self._made("RPUR", "offset leg", "normal axes", a, b)
        return replace(
            limb,
            normal=first.axis,
            mark=self.start[:3, :3].T @ last.axis,
            rod=float(np.linalg.norm(b - q)),
            shift=slide.value - float(np.linalg.norm(q - a)),
        )

    def _spherical(self, first: Joint, middle: Joint, last: Joint) -> Limb | None:
        centre = _meeting(self.joints)
        if centre is None:
            return None
        r, p = self.start[:3, :3], self.start[:3, 3]
        u, v, w = first.axis, middle.axis, last.axis
        across = v - (u @ v) * u
        limb = self._made(SPHERICAL.name, "direction", "point", centre, centre)
        return replace(
            limb,
            b=r.T @ w,
            axis=u,
            zero=np.asarray(_rotated(u, across, -first.value)),
            along=float(u @ v),
            rod=float(v @ w),
            mark=r.T @ (centre - p),
        )


def _parallel(one: Array, other: Array) -> bool:
    size = float(np.linalg.norm(one) * np.linalg.norm(other))
    return bool(np.linalg.norm(np.cross(one, other)) < _ALIGNED * size)


def _level(point: Array, like: Array, axis: Array) -> Array:
    """A point moved along an axis to the plane normal to it through another."""
    return np.asarray(point + axis * (axis @ (like - point)))


def _rotated(axis: Array, vector: Array, angle: float) -> Array:
    return np.asarray(np.cos(angle) * vector + np.sin(angle) * np.cross(axis, vector))


def _meeting(joints: list[Joint]) -> Array | None:
    """Where all axes meet; None if they do not."""
    blocks = [np.eye(3) - np.outer(joint.axis, joint.axis) for joint in joints]
    sides = [block @ joint.at for block, joint in zip(blocks, joints, strict=True)]
    matrix, right = np.concatenate(blocks), np.concatenate(sides)
    point, _, rank, _ = np.linalg.lstsq(matrix, right)
    scale = max(1.0, *(float(np.abs(joint.at).max()) for joint in joints))
    meet = rank == 3 and np.abs(matrix @ point - right).max() < 1e-7 * scale
    return np.asarray(point, dtype=float) if meet else None


def _told(direction: Array) -> str:
    return "[" + ", ".join(f"{v + 0.0:.4g}" for v in np.round(direction, 6)) + "]"
