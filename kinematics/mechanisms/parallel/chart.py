"""The coordinates of a pose: some of x, y, z, φ, θ, ψ with R = Rz(ψ) Ry(θ) Rx(φ).

As many as the platform has freedoms; of the others some never change, and some are parasitic: they
follow from the limbs' bonds. Where these are planes and ψ follows, they are linear in x, y and
cos ψ, sin ψ, which leaves two operation modes; otherwise Newton's method leads there from the
reference. Everything takes batches; complex poses give derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.parallel.bonds import Bonds
from kinematics.mechanisms.parallel.drives import Numbers
from kinematics.mechanisms.parallel.mobility import angles_of, angular_axes

PSI = 5
_ROUNDS = 25
_CLOSES = 1e-9  # of the size, what Newton's method may leave
_TRIES, _MOST = 80, 6  # random places, and modes that are told apart, where nothing is closed
_SAME = 1e-6
_SEVERAL = ("base plane", "platform plane", "normal axes", "universal")
_LINEAR = ("base plane", "platform plane", "normal axes")


@dataclass(frozen=True, eq=False)
class Chart:
    """Poses as placements.

    Attributes:
        free: the coordinates that tell a pose, of x, y, z, φ, θ, ψ.
        fixed: those that never change.
        reference: (6,) all six at the reference.
        length: mm, the characteristic length.
    """

    bonds: Bonds
    free: tuple[int, ...]
    fixed: tuple[int, ...]
    reference: Array
    length: float

    @cached_property
    def following(self) -> tuple[int, ...]:
        """The parasitic ones."""
        return tuple(n for n in range(6) if n not in (*self.free, *self.fixed))

    @cached_property
    def closed_form(self) -> bool:
        """Whether they follow in closed form."""
        return bool(self.following) and linear(self.bonds, self.following)

    @property
    def operations(self) -> int:
        """How many operation modes are told apart."""
        if self.closed_form or not self.following:
            return 2 if PSI in self.following else 1
        return len(self._seeds)

    @cached_property
    def _seeds(self) -> Array:
        """(K, F) what follows at the reference, the reference's own first.

        As far as Newton's method finds them from random places.
        """
        own = self.reference[list(self.following)]
        if any(one.limb.bond not in _SEVERAL for one in self.bonds.each):
            return own[None]
        rng = np.random.default_rng(8)
        full = np.tile(self.reference, (_TRIES, 1))
        for n in self.following:
            spread = self.length * rng.normal(size=_TRIES)
            turned = rng.uniform(-np.pi, np.pi, size=_TRIES)
            full[:, n] = self.reference[n] + spread if n < 3 else turned
        there, room = self._searched(full)
        six = self.six(np.asarray(placed(there[room > 0.0])))
        away = np.abs(six - self.reference)[:, self.free]
        away = np.where(np.array(self.free) < 3, away / self.length, np.abs(np.sin(0.5 * away)))
        found = [own]
        for one in six[away.max(axis=1, initial=0.0) < _SAME][:, self.following]:
            apart = np.where(np.array(self.following) < 3, 1.0 / self.length, 1.0)
            if all(np.abs((one - other) * apart).max() > _SAME for other in found):
                found.append(one)
        return np.array(found[:_MOST])

    # --- from poses to placements

    def full(self, poses: Numbers, operation: NDArray[Any] | int = 1) -> tuple[Numbers, Array]:
        """All six coordinates of poses (..., P), and how far (...) these are from not existing.

        Of poses that have none the nearest that there are; their room is negative. Rooms are
        infinite where nothing follows.
        """
        given = np.broadcast_to(self.reference, (*poses.shape[:-1], 6)).astype(
            np.result_type(poses.dtype, float)
        )
        given[..., self.free] = poses
        if not self.following:
            return given, np.full(poses.shape[:-1], np.inf)
        real = np.ascontiguousarray(given.real)
        if self.closed_form:
            sign = np.where(np.asarray(operation) == 1, self._first, -self._first)
            real, room = self._closed(real, sign)
        else:
            which = np.clip(np.asarray(operation), 1, len(self._seeds)) - 1
            real[..., self.following] = self._seeds[which]
            real, room = self._searched(real)
        if not np.iscomplexobj(given):
            return real, room
        # First order in the imaginary part, which is tiny.
        given[..., self.following] = real[..., self.following]
        values = self.bonds.at(placed(given)).values.imag
        back = np.linalg.pinv(self._slopes(real)[..., self.following])
        given[..., self.following] -= 1j * (back @ values[..., None])[..., 0]
        return given, room

    def transform(self, poses: Array, operation: NDArray[Any] | int = 1) -> Array:
        """(..., 4, 4), also of poses that there are not."""
        return np.asarray(placed(self.full(poses, operation)[0]))

    def placement(self, poses: Array, operation: NDArray[Any] | int = 1) -> Array:
        """(..., 4, 4); NaN of poses that there are not."""
        full, room = self.full(poses, operation)
        return np.where((room >= 0.0)[..., None, None], placed(full), np.nan)

    def pose(self, placement: Array) -> Array:
        """(..., P) of placements (..., 4, 4), θ in [−π/2, π/2]."""
        return self.six(placement)[..., self.free]

    def six(self, placement: Array) -> Array:
        """All six coordinates (..., 6)."""
        angles = angles_of(placement[..., :3, :3])
        return np.concatenate([placement[..., :3, 3], angles], axis=-1)

    def velocity_axes(self, poses: Numbers, operation: NDArray[Any] | int = 1) -> Numbers:
        """(..., 6, P) [v, ω] for unit rates of the coordinates."""
        full, _ = self.full(poses, operation)
        axes = _axes(full)
        mine = axes[..., self.free]
        if not self.following:
            return np.asarray(mine)
        rows = self.bonds.rows(placed(full))
        along = rows @ axes[..., self.following]
        square = along.swapaxes(-1, -2) @ along
        good = np.isfinite(square).all(axis=(-1, -2)) & (np.abs(np.linalg.det(square)) > 0.0)
        square = np.where(good[..., None, None], square, np.eye(len(self.following)))
        right = along.swapaxes(-1, -2) @ (rows @ mine)
        back = np.where(good[..., None, None], -np.linalg.solve(square, right), np.nan)
        return np.asarray(mine + axes[..., self.following] @ back)

    # --- what follows

    def _slopes(self, full: Array) -> Array:
        """(..., C, 6) of the bonds by all six coordinates."""
        return np.asarray(self.bonds.rows(placed(full)) @ _axes(full))

    def _searched(self, full: Array) -> tuple[Array, Array]:
        scale = np.array([1.0 if n < 3 else 1.0 / self.length for n in self.following])
        for _ in range(_ROUNDS):
            values = np.asarray(self.bonds.at(placed(full)).values)
            slopes = self._slopes(full)[..., self.following] * scale
            good = np.isfinite(slopes).all(axis=(-1, -2))[..., None, None]
            back = np.linalg.pinv(np.where(good, slopes, 0.0), rcond=1e-9)
            step = -(back @ np.nan_to_num(values)[..., None])[..., 0]
            most = np.abs(step).max(axis=-1, keepdims=True)
            step *= np.minimum(1.0, 0.3 * self.length / np.maximum(most, 1e-300))
            full = full.copy()
            full[..., self.following] += step * scale
            if not most.max(initial=0.0) > 1e-14 * self.length:
                break
        off = np.abs(np.asarray(self.bonds.at(placed(full)).values)).max(axis=-1)
        slack = _CLOSES * max(self.length, 1.0)
        return full, np.where(off <= slack, np.inf, -off)

    def _closed(self, full: Array, sign: Array) -> tuple[Array, Array]:
        """By elimination: linear in the positions, and in cos ψ, sin ψ where ψ follows."""
        turns = PSI in self.following
        angles = full[..., 3:].copy()
        if turns:
            angles[..., 2] = 0.0
        r = rotation(angles)
        places = [n for n in self.following if n < 3]
        p = full[..., :3].copy()
        p[..., places] = 0.0
        count = len(self.following)
        shape = full.shape[:-1]
        by_place = np.zeros((*shape, count, len(places)))
        cos, sin, right = (np.zeros((*shape, count)) for _ in range(3))
        for k, one in enumerate(self.bonds.each):
            limb, n = one.limb, one.limb.normal
            if limb.bond == "platform plane":
                v, a = r @ limb.mark, limb.a - p
                by_place[..., k, :] = -v[..., places]
                const = limb.b @ limb.mark - 0.0 * v[..., 0]
                cos[..., k] = v[..., 0] * a[..., 0] + v[..., 1] * a[..., 1]
                sin[..., k] = v[..., 0] * a[..., 1] - v[..., 1] * a[..., 0]
                right[..., k] = const - v[..., 2] * a[..., 2]
                continue
            plane = limb.bond == "base plane"
            u = r @ (limb.b if plane else limb.mark)
            cos[..., k] = n[0] * u[..., 0] + n[1] * u[..., 1]
            sin[..., k] = n[1] * u[..., 0] - n[0] * u[..., 1]
            right[..., k] = -n[2] * u[..., 2]
            if plane:
                by_place[..., k, :] = n[places]
                right[..., k] += (limb.a - p) @ n
        room = np.full(shape, np.inf)
        full = full.copy()
        c, s = np.ones(shape), np.zeros(shape)
        if turns:
            left = _left(by_place)
            alpha, beta, gamma = ((left * v).sum(axis=-1) for v in (cos, sin, right))
            square = alpha**2 + beta**2
            h = np.sqrt(square)
            with np.errstate(invalid="ignore", divide="ignore"):
                size = np.linalg.norm(left, axis=-1)
                room = (h - np.abs(gamma)) / size
                half = np.arccos(np.clip(gamma / h, -1.0, 1.0))
                room = np.where(h > 1e-12 * size, room, -1.0)
            psi = np.arctan2(beta, alpha) + sign * np.nan_to_num(half)
            psi = np.mod(psi + np.pi, 2.0 * np.pi) - np.pi
            full[..., PSI] = psi
            c, s = np.cos(psi), np.sin(psi)
        if places:
            rest = right - c[..., None] * cos - s[..., None] * sin
            found = (np.linalg.pinv(by_place) @ rest[..., None])[..., 0]
            full[..., places] = found
            if turns and self.bonds.each[0].limb.bond == "platform plane" and 0 in places:
                x, y = full[..., 0].copy(), full[..., 1].copy()
                full[..., 0], full[..., 1] = c * x - s * y, s * x + c * y
        return full, room

    @cached_property
    def _first(self) -> float:
        """The sign of operation mode 1, in which the reference is."""
        psi = [float(self._closed(self.reference, np.array(s))[0][PSI]) for s in (1.0, -1.0)]
        plus, minus = (abs(np.sin(0.5 * (one - self.reference[PSI]))) for one in psi)
        return 1.0 if plus <= minus else -1.0


def linear(bonds: Bonds, following: tuple[int, ...]) -> bool:
    """Whether coordinates follow from bonds that are linear in places and in cos ψ, sin ψ."""
    kinds = [one.limb.bond for one in bonds.each]
    if len(kinds) != len(following) or any(kind not in _LINEAR for kind in kinds):
        return not following
    if {3, 4} & set(following):
        return False
    if PSI in following and "platform plane" in kinds:
        return "base plane" not in kinds and (0 in following) == (1 in following)
    return True


def _left(matrix: Array) -> Array:
    """(..., C) normal to the C − 1 columns of (..., C, C − 1)."""
    count = matrix.shape[-2]
    if count == 1:
        return np.ones((*matrix.shape[:-2], 1))
    if count == 2:
        return np.stack([-matrix[..., 1, 0], matrix[..., 0, 0]], axis=-1)
    return np.cross(matrix[..., 0], matrix[..., 1])


def rotation(angles: Numbers) -> Numbers:
    """R = Rz(ψ) Ry(θ) Rx(φ) (..., 3, 3) of (φ, θ, ψ) (..., 3), analytic."""
    (cf, ct, cp), (sf, st, sp) = (
        np.moveaxis(np.cos(angles), -1, 0),
        np.moveaxis(np.sin(angles), -1, 0),
    )
    r = np.empty((*cf.shape, 3, 3), dtype=cf.dtype)
    r[..., 0, 0], r[..., 1, 0], r[..., 2, 0] = cp * ct, sp * ct, -st
    r[..., 0, 1], r[..., 1, 1] = cp * st * sf - sp * cf, sp * st * sf + cp * cf
    r[..., 0, 2], r[..., 1, 2] = cp * st * cf + sp * sf, sp * st * cf - cp * sf
    r[..., 2, 1], r[..., 2, 2] = ct * sf, ct * cf
    return r


def placed(full: Numbers) -> Numbers:
    """(..., 4, 4) of all six coordinates."""
    t = np.zeros((*full.shape[:-1], 4, 4), dtype=full.dtype)
    t[..., :3, :3] = rotation(full[..., 3:])
    t[..., :3, 3] = full[..., :3]
    t[..., 3, 3] = 1.0
    return t


def _axes(full: Numbers) -> Numbers:
    """(..., 6, 6) [v, ω] for unit rates of all six coordinates."""
    axes = np.zeros((*full.shape, 6), dtype=full.dtype)
    axes[..., :3, :3] = np.eye(3)
    axes[..., 3:, 3:] = angular_axes(full[..., 3:])
    return axes
