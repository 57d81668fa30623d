"""What limbs take from the platform whatever their actuators do: equations and wrenches.

Each bond is some equations in the placement, zero where the limb can be assembled, and as many
wrenches, whose work on a motion of the platform is the equations' rate. In batches, and analytic.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.parallel.drives import Numbers, dot, size
from kinematics.mechanisms.parallel.limbs import Limb, unit

COUNTS = {
    "free": 0,
    "base plane": 1,
    "platform plane": 1,
    "normal axes": 1,
    "universal": 1,
    "parallelogram": 2,
    "planar": 3,
    "point": 3,
}
_ALIKE = 1e-9  # of bonds that are the same


class Bound(NamedTuple):
    """One bond of some limbs that share it.

    Attributes:
        limbs: counted from 0.
        limb: one of them.
    """

    limbs: tuple[int, ...]
    limb: Limb


class Held(NamedTuple):
    """Equations and wrenches of all bonds at placements.

    Attributes:
        values: (..., C) mm or without unit.
        force: (..., C, 3).
        couple: (..., C, 3) mm, about O′.
        point: (..., C, 3) mm.
    """

    values: Numbers
    force: Numbers
    couple: Numbers
    point: Numbers


@dataclass(frozen=True, eq=False)
class Bonds:
    """All limbs' bonds; those that say the same are there once.

    Attributes:
        start: (4, 4) the placement at which planar limbs and points were described.
    """

    limbs: tuple[Limb, ...]
    start: Array

    @cached_property
    def each(self) -> tuple[Bound, ...]:
        """The different ones, in the order of the limbs."""
        found: list[Bound] = []
        for n, limb in enumerate(self.limbs):
            if limb.bond == "free":
                continue
            for k, other in enumerate(found):
                if _alike(limb, other.limb):
                    found[k] = other._replace(limbs=(*other.limbs, n))
                    break
            else:
                found.append(Bound((n,), limb))
        return tuple(found)

    @property
    def count(self) -> int:
        """C, equations of all of them."""
        return sum(COUNTS[one.limb.bond] for one in self.each)

    def at(self, placement: Numbers) -> Held:
        """Values and wrenches at placements (..., 4, 4)."""
        shape = placement.shape[:-2]
        kind = np.result_type(placement.dtype, float)
        values = np.zeros((*shape, self.count), dtype=kind)
        force, couple = (np.zeros((*shape, self.count, 3), dtype=kind) for _ in range(2))
        origin = placement[..., :3, 3]
        point = np.broadcast_to(origin[..., None, :], force.shape).copy()
        k = 0
        for one in self.each:
            made = _made(one.limb, placement, self.start)
            for value, f, t, p in made:
                values[..., k] = value
                force[..., k, :], couple[..., k, :] = f, t
                if p is not None:
                    point[..., k, :] = p
                k += 1
        return Held(values, force, couple, point)

    def rows(self, placement: Numbers) -> Numbers:
        """(..., C, 6) [F, T about O′], whose work is the equations' rate."""
        held = self.at(placement)
        return np.concatenate([held.force, held.couple], axis=-1)

    def closed(self, placement: Array, length: float, rounds: int = 40) -> Array:
        """Placements (..., 4, 4) near those given where all bonds hold; NaN where none is found.

        By Gauss-Newton steps of least length, angles counted by ``length``.
        """
        if not self.count:
            return placement
        scale = np.array([1.0, 1.0, 1.0, length, length, length])
        t = placement.copy()
        for _ in range(rounds):
            held = self.at(t)
            rows = np.concatenate([held.force, held.couple], axis=-1) / scale
            good = np.isfinite(rows).all(axis=(-1, -2))[..., None, None]
            back = np.linalg.pinv(np.where(good, rows, 0.0), rcond=1e-8)
            step = (back @ -held.values[..., None])[..., 0] / scale
            t = moved(t, np.where(good[..., 0], step, np.nan))
            if not np.abs(step * scale).max(initial=0.0) > 1e-14 * length:
                break
        off = np.abs(self.at(t).values).max(axis=-1, initial=0.0)
        return np.where((off < 1e-9 * max(length, 1.0))[..., None, None], t, np.nan)


def moved(placement: Array, velocity: Array) -> Array:
    """Placements (..., 4, 4) after a motion [v, ω] (..., 6) for a unit of time, O′ straight on."""
    omega = velocity[..., 3:]
    angle = np.sqrt((omega * omega).sum(axis=-1))[..., None, None]
    x, y, z = np.moveaxis(omega, -1, 0)
    cross = np.zeros((*angle.shape[:-2], 3, 3))
    cross[..., 0, 1], cross[..., 0, 2], cross[..., 1, 2] = -z, y, -x
    cross = cross - cross.swapaxes(-1, -2)
    turn = np.eye(3) + np.sinc(angle / np.pi) * cross
    turn = turn + 0.5 * np.sinc(0.5 * angle / np.pi) ** 2 * (cross @ cross)
    answer = placement.copy()
    answer[..., :3, :3] = turn @ placement[..., :3, :3]
    answer[..., :3, 3] += velocity[..., :3]
    return answer


_Made = tuple[Numbers, Numbers, Numbers, "Numbers | None"]


def _made(limb: Limb, placement: Numbers, start: Array) -> list[_Made]:
    """Value, force, couple and point of each equation of one bond."""
    r, p = placement[..., :3, :3], placement[..., :3, 3]
    n, m = limb.normal, limb.mark
    b = r @ limb.b
    none = np.zeros(p.shape)
    if limb.bond == "base plane":
        f = np.broadcast_to(n, p.shape)
        return [((p + b - limb.a) @ n, f, np.cross(b, f), p + b)]
    if limb.bond == "platform plane":
        f, arm = r @ m, limb.a - p
        return [(limb.b @ m - dot(f, arm), f, np.cross(arm, f), np.broadcast_to(limb.a, p.shape))]
    if limb.bond == "normal axes":
        f = r @ m
        return [(f @ n, none, np.cross(f, n), None)]
    if limb.bond == "universal":
        return [_universal(limb, p, b, r @ m)]
    if limb.bond == "point":
        arm = r @ m
        return [
            ((p + arm - limb.a) @ e, np.broadcast_to(e, p.shape), np.cross(arm, e), p + arm)
            for e in np.eye(3)
        ]
    axis = r @ m
    across = np.linalg.svd(n[None])[2][1:]
    turns: list[_Made] = [(axis @ e, none, np.cross(axis, e), None) for e in across]
    if limb.bond == "parallelogram":
        return turns
    return [((p - start[:3, 3]) @ n, np.broadcast_to(n, p.shape), none, None), *turns]


def _universal(limb: Limb, p: Numbers, b: Numbers, u: Numbers) -> _Made:
    """w·(leg × u) = 0, of unit force, or a unit couple where the outer axes are parallel."""
    w = limb.normal
    leg = p + b - limb.a
    f = np.cross(u, w)
    value = dot(np.broadcast_to(w, u.shape), np.cross(leg, u))
    couple = np.cross(u, np.cross(np.broadcast_to(w, leg.shape), leg))
    strength = size(f)
    free = np.abs(strength) < _ALIKE
    with np.errstate(invalid="ignore", divide="ignore"):
        by = np.where(free, size(couple), strength)
        f = np.where(free[..., None], 0.0, f / by[..., None])
        couple = couple / by[..., None]
        value = value / by
    return value, f, np.cross(b, f) + couple, p + b


def _alike(one: Limb, other: Limb) -> bool:
    """Whether two limbs take the same."""
    if one.bond != other.bond:
        return False
    axes = _parallel(one.normal, other.normal)
    if one.bond == "normal axes":
        return axes and _parallel(one.mark, other.mark)
    if one.bond in ("planar", "parallelogram"):
        return axes
    if one.bond == "point":
        return bool(np.abs(one.a - other.a).max() <= _ALIKE * max(np.abs(one.a).max(), 1.0))
    return False


def _parallel(one: Array, other: Array) -> bool:
    return bool(np.linalg.norm(np.cross(unit(one), unit(other))) < _ALIKE)
