"""Actuators of limbs at placements of the platform: joints in every branch, and what they move.

All of it in batches, and analytic in the placement: complex ones give derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.parallel.limbs import Limb

Numbers = NDArray[Any]
"""Real, or complex where derivatives are taken."""


class Push(NamedTuple):
    """What the actuators exert, (..., L, …) each.

    Attributes:
        force: (..., L, 3) of length one, or zero of couples.
        couple: (..., L, 3) mm of the moment about O′; of length one where there is no force.
        gain: (..., L).
        point: (..., L, 3) mm, on the line of the force; O′ of couples.
    """

    force: Numbers
    couple: Numbers
    gain: Numbers
    point: Numbers


def dot(one: Numbers, other: Numbers) -> Numbers:
    """Scalar products along the last axis, without conjugation."""
    return np.asarray((one * other).sum(axis=-1))


def size(vectors: Numbers) -> Numbers:
    """Lengths along the last axis, analytic."""
    return np.asarray(np.sqrt(dot(vectors, vectors)))


@dataclass(frozen=True, eq=False)
class Drives:
    """All limbs' actuators together."""

    limbs: tuple[Limb, ...]

    @cached_property
    def groups(self) -> dict[str, NDArray[np.intp]]:
        """Which limbs are driven how."""
        found: dict[str, list[int]] = {}
        for n, limb in enumerate(self.limbs):
            found.setdefault(limb.drive, []).append(n)
        return {drive: np.array(which) for drive, which in found.items()}

    @cached_property
    def a(self) -> Array:
        return np.array([limb.a for limb in self.limbs])

    @cached_property
    def b(self) -> Array:
        return np.array([limb.b for limb in self.limbs])

    @cached_property
    def w(self) -> Array:
        return np.array([limb.axis for limb in self.limbs])

    @cached_property
    def z(self) -> Array:
        return np.array([limb.zero for limb in self.limbs])

    @cached_property
    def y(self) -> Array:
        return np.cross(self.w, self.z)

    @cached_property
    def r(self) -> Array:
        return np.array([limb.crank for limb in self.limbs])

    @cached_property
    def l(self) -> Array:  # noqa: E743  the field's letter
        return np.array([limb.rod for limb in self.limbs])

    @cached_property
    def n(self) -> Array:
        return np.array([limb.normal for limb in self.limbs])

    @cached_property
    def m(self) -> Array:
        return np.array([limb.mark for limb in self.limbs])

    @cached_property
    def along(self) -> Array:
        return np.array([limb.along for limb in self.limbs])

    @cached_property
    def shift(self) -> Array:
        return np.array([limb.shift for limb in self.limbs])

    @cached_property
    def middle(self) -> Array:
        """(L,) of the ranges; 0 where there are none."""
        ends = np.array([(limb.low, limb.high) for limb in self.limbs])
        return np.where(np.isfinite(ends).all(axis=1), ends.mean(axis=1), 0.0)

    # --- where things are

    def points(self, placement: Numbers) -> Numbers:
        """B in the base frame, (..., L, 3) mm; of directions that of the platform's axis."""
        turned = self.b @ placement[..., :3, :3].swapaxes(-1, -2)
        shift = np.array([limb.drive != "direction" for limb in self.limbs])[:, None]
        return np.asarray(turned + np.where(shift, placement[..., None, :3, 3], 0.0))

    def circle(self, placement: Numbers, g: NDArray[np.intp]) -> tuple[Numbers, ...]:
        """A, B and K of A cos q + B sin q = K of cranks and directions, (..., G) each."""
        at = self.points(placement)[..., g, :]
        turning = np.array([self.limbs[n].drive == "direction" for n in g.tolist()])
        d = at - np.where(turning[:, None], 0.0, self.a[g])
        one, two = dot(d, self.z[g]), dot(d, self.y[g])
        r = np.where(turning, 1.0, self.r[g])
        rod = (dot(d, d) + r * r - self.l[g] ** 2) / (2.0 * r)
        k = np.where(turning, self.l[g] - self.along[g] * dot(d, self.w[g]), rod)
        return one, two, k

    def arms(self, placement: Numbers, signs: Array) -> tuple[Numbers, Numbers]:
        """E (..., L, 3) mm of limbs in branches ``signs`` (..., L), and the branches' roots.

        Of an offset leg it is Q, of a leg or an elbow A; of a direction the middle axis. The roots
        are NaN where a limb cannot close.
        """
        at = self.points(placement)
        shape = np.broadcast_shapes(at.shape[:-1], np.shape(signs))
        kind = np.result_type(placement.dtype, float)
        e = np.broadcast_to(self.a, (*shape, 3)).astype(kind)
        roots = np.ones(shape, dtype=kind)
        signs = np.broadcast_to(signs, shape)
        for drive, g in self.groups.items():
            s = signs[..., g]
            if drive in ("crank", "direction"):
                one, two, k = self.circle(placement, g)
                h = one * one + two * two
                root = self.root(h - k * k)
                cos = (k * one - s * two * root) / h
                sin = (k * two + s * one * root) / h
                arm = cos[..., None] * self.z[g] + sin[..., None] * self.y[g]
                base = self.a[g] if drive == "crank" else self.along[g, None] * self.w[g]
                e[..., g, :] = base + (self.r[g, None] if drive == "crank" else 1.0) * arm
            elif drive == "slider":
                d = at[..., g, :] - self.a[g]
                way = dot(d, self.w[g])
                root = self.root(self.l[g] ** 2 - (dot(d, d) - way * way))
                e[..., g, :] = self.a[g] + (way + s * root)[..., None] * self.w[g]
            elif drive == "offset leg":
                m = self.m[g] @ placement[..., :3, :3].swapaxes(-1, -2)
                flat = self.n[g] - dot(self.n[g], m)[..., None] * m
                away = dot(self.n[g], self.a[g] - at[..., g, :]) / dot(flat, flat)
                foot = at[..., g, :] + away[..., None] * flat
                line = np.cross(self.n[g], m)
                line = line / size(line)[..., None]
                root = self.root(self.l[g] ** 2 - away * away * dot(flat, flat))
                e[..., g, :] = foot + (s * root)[..., None] * line
            elif drive == "elbow":
                d = at[..., g, :] - self.a[g]
                r, rod = self.r[g], self.l[g]
                c = (dot(d, d) - r * r - rod * rod) / (2.0 * r * rod)
                root = self.root(1.0 - c * c)
            else:
                continue
            roots[..., g] = root
            e[..., g, :] = np.where(np.isnan(root)[..., None], np.nan, e[..., g, :])
        return e, roots

    # --- joints

    def joints(self, placement: Array, signs: Array) -> Array:
        """(..., L) of limbs in branches ``signs`` (..., L), mm or rad; NaN where one cannot close.

        Angles are those nearest to the middle of their range.
        """
        at = self.points(placement)
        shape = np.broadcast_shapes(at.shape[:-1], np.shape(signs))
        signs = np.broadcast_to(signs, shape)
        q = np.empty(shape)
        with np.errstate(invalid="ignore", divide="ignore"):
            for drive, g in self.groups.items():
                s, d = signs[..., g], at[..., g, :] - self.a[g]
                if drive == "leg":
                    q[..., g] = size(d)
                elif drive == "slider":
                    way = dot(d, self.w[g])
                    q[..., g] = way + s * self.root(self.l[g] ** 2 - (dot(d, d) - way * way))
                elif drive in ("crank", "direction"):
                    one, two, k = self.circle(placement, g)
                    h = np.hypot(one, two)
                    angle = np.arctan2(self.root(h * h - k * k), k)
                    q[..., g] = self.near(np.arctan2(two, one) + s * angle, g)
                elif drive == "elbow":
                    r, rod = self.r[g], self.l[g]
                    c = (dot(d, d) - r * r - rod * rod) / (2.0 * r * rod)
                    q[..., g] = self.near(s * np.arctan2(self.root(1.0 - c * c), c), g)
                else:
                    e, _ = self.arms(placement, signs)
                    q[..., g] = size(e[..., g, :] - self.a[g])
        return np.asarray(q + self.shift)

    def near(self, angles: Array, g: NDArray[np.intp]) -> Array:
        """Angles by whole turns nearest to the middle of their ranges."""
        middle = self.middle[g] - self.shift[g]
        turns = np.ceil((angles - middle - np.pi) / (2.0 * np.pi))
        return np.where(turns == 0.0, angles, angles - 2.0 * np.pi * turns)

    def branches(self, placement: Array, joints: Array) -> Array:
        """(..., L) ±1: the branches that limbs with these joints (..., L) are in."""
        at = self.points(placement)
        found = np.ones(np.broadcast_shapes(at.shape[:-1], joints.shape))
        q = joints - self.shift
        with np.errstate(invalid="ignore", divide="ignore"):
            for drive, g in self.groups.items():
                if drive in ("crank", "direction"):
                    one, two, _ = self.circle(placement, g)
                    side = np.sin(q[..., g] - np.arctan2(two, one))
                elif drive == "slider":
                    side = q[..., g] - dot(at[..., g, :] - self.a[g], self.w[g])
                elif drive == "elbow":
                    side = np.sin(q[..., g])
                elif drive == "offset leg":
                    both = [
                        self.joints(placement, np.full(len(self.limbs), s)) for s in (1.0, -1.0)
                    ]
                    off = [np.abs(one[..., g] - joints[..., g]) for one in both]
                    side = off[1] - off[0]
                else:
                    continue
                found[..., g] = np.where(side < 0.0, -1.0, 1.0)
        return np.asarray(found)

    def locked(self, joints: Array) -> tuple[Array, Array]:
        """E (..., L, 3) and |EB| (..., L) mm with the actuators at joints (..., L).

        Of directions the middle axis, and cos α. An offset leg has none.
        """
        q = joints - self.shift
        e = np.broadcast_to(self.a, (*q.shape, 3)).copy()
        length = np.broadcast_to(self.l, q.shape).copy()
        for drive, g in self.groups.items():
            c, s = np.cos(q[..., g, None]), np.sin(q[..., g, None])
            if drive == "crank":
                e[..., g, :] += self.r[g, None] * (c * self.z[g] + s * self.y[g])
            elif drive == "direction":
                e[..., g, :] = self.along[g, None] * self.w[g] + c * self.z[g] + s * self.y[g]
            elif drive == "slider":
                e[..., g, :] += q[..., g, None] * self.w[g]
            elif drive == "leg":
                length[..., g] = q[..., g]
            elif drive == "elbow":
                r, rod = self.r[g], self.l[g]
                length[..., g] = np.sqrt(r * r + rod * rod + 2.0 * r * rod * c[..., 0])
            else:
                e[..., g, :], length[..., g] = np.nan, np.nan
        return e, length

    def residual(self, placement: Array, joints: Array, signs: Array) -> Array:
        """(..., L) mm: how far limbs with these joints are from closing."""
        e, length = self.locked(joints)
        at = self.points(placement)
        off = size(at - e) - length
        for drive, g in self.groups.items():
            if drive == "direction":
                off[..., g] = dot(at[..., g, :], e[..., g, :]) - length[..., g]
            elif drive == "offset leg":
                off[..., g] = (self.joints(placement, signs) - joints)[..., g]
        return np.asarray(np.abs(off))

    # --- what bounds them

    def room(self, placement: Array) -> Array:
        """(..., L) how far limbs are from not closing, mm (directions: rad); NaN of legs."""
        at = self.points(placement)
        room = np.full(at.shape[:-1], np.nan)
        for drive, g in self.groups.items():
            d = at[..., g, :] - self.a[g]
            if drive in ("crank", "direction"):
                one, two, k = self.circle(placement, g)
                room[..., g] = np.hypot(one, two) - np.abs(k)
            elif drive == "slider":
                way = dot(d, self.w[g])
                across = np.sqrt(np.maximum(dot(d, d) - way * way, 0.0))
                room[..., g] = self.l[g] - across
            elif drive == "elbow":
                far = size(d)
                most, least = self.r[g] + self.l[g], np.abs(self.r[g] - self.l[g])
                room[..., g] = np.minimum(most - far, np.where(least > 0.0, far - least, np.inf))
            elif drive == "offset leg":
                room[..., g] = self.l[g] - np.abs(dot(d, self.n[g]))
        return room

    # --- what they exert

    def pushes(self, placement: Numbers, signs: Array) -> Push:
        """The unit wrenches of the actuators, moments about O′, and their gains."""
        at = self.points(placement)
        e, roots = self.arms(placement, signs)
        d = at - e
        kind = d.dtype
        gain = np.ones(d.shape[:-1], dtype=kind)
        with np.errstate(invalid="ignore", divide="ignore"):
            force = d / size(d)[..., None]
            point = at + 0.0 * d
            arm = at - placement[..., None, :3, 3]
            for drive, g in self.groups.items():
                f = force[..., g, :]
                if drive == "crank":
                    swing = np.cross(self.w[g], e[..., g, :] - self.a[g])
                    gain[..., g] = dot(f, swing)
                elif drive == "slider":
                    gain[..., g] = dot(f, self.w[g])
                elif drive == "elbow":
                    r, rod = self.r[g], self.l[g]
                    s = np.broadcast_to(signs, d.shape[:-1])[..., g]
                    gain[..., g] = -r * rod * s * roots[..., g] / size(d[..., g, :])
                    force[..., g, :] = np.where(np.isnan(roots[..., g, None]), np.nan, f)
                elif drive == "offset leg":
                    m = self.m[g] @ placement[..., :3, :3].swapaxes(-1, -2)
                    out = e[..., g, :] - self.a[g]
                    u = out / size(out)[..., None]
                    swing = np.cross(m, -d[..., g, :])
                    drive_gain = dot(np.broadcast_to(self.n[g], swing.shape), swing)
                    pull = drive_gain[..., None] * u - dot(u, swing)[..., None] * self.n[g]
                    strength = size(pull)
                    force[..., g, :] = pull / strength[..., None]
                    gain[..., g] = drive_gain / strength
                    point[..., g, :] = e[..., g, :]
                    arm[..., g, :] = e[..., g, :] - placement[..., None, :3, 3]
            couple = np.cross(arm, force)
            for g in (self.groups[drive] for drive in ("direction",) if drive in self.groups):
                turn = np.cross(e[..., g, :], at[..., g, :])
                strength = size(turn)
                couple[..., g, :] = turn / strength[..., None]
                swing = np.cross(np.broadcast_to(self.w[g], turn.shape), e[..., g, :])
                gain[..., g] = dot(swing, at[..., g, :]) / strength
                force[..., g, :] = 0.0 * turn
                point[..., g, :] = placement[..., None, :3, 3] + 0.0 * turn
        return Push(force, couple, gain, point)

    def root(self, square: Numbers) -> Numbers:
        """The root; NaN where the real part is negative."""
        with np.errstate(invalid="ignore"):
            return np.asarray(np.where(square.real < 0.0, np.nan, np.sqrt(square + 0.0)))


class Stretched(Drives):
    """The same with limbs that cannot close as they are at the end of their reach."""

    def root(self, square: Numbers) -> Numbers:
        return np.asarray(np.sqrt(np.maximum(square, 0.0)))
