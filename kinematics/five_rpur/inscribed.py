"""The usable workspace: the largest ball and box inside it.

Both are grown from the best places of a grid by steps of sequential programming: what lies
nearest in the complement (`clearance.contacts`, exact) bounds the next step, and no step is
taken that does not make the body larger. The best "anywhere" is thus the best found from several
starts, a local optimum that no other start beat, and not proven to be the global one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage, optimize

from kinematics.five_rpur.clearance import Contacts, Ints, Region, contacts
from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.sections import Box, Sphere
from kinematics.spatial import Array, finite

_ROUNDING = 1e-9  # part of the machine's size
_STARTS = 6
_GRID = 40


# --- the ball ----------------------------------------------------------------------------------


def sphere(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: tuple[str, ...] | None = None,
    center: Sequence[float] | None = None,
) -> Sphere | None:
    """The largest ball about ``center`` (3,) mm of the base frame, or anywhere.
    """
    region = Region.at(design, phi, theta, modes)
    if center is not None:
        middle = finite(center, name="the centre", last=3)
        radius, _ = _clearance(region, middle)
        return Sphere(middle, radius, _ROUNDING * region.size)
    best = None
    for start in _starts(region):
        c, r, _ = _grow_ball(region, start)
        if best is None or r > best[1]:
            best = c, r
    if best is None:
        return None
    return Sphere(best[0], best[1], _ROUNDING * region.size)


@dataclass(frozen=True, eq=False)
class _Point:
    """A ball's centre; measured is the distance from it."""

    region: Region
    center: Array

    @property
    def tube(self) -> Ints:
        return np.arange(len(self.region.tubes[0]))

    def foot(self, which: Ints, axis: tuple[Array, Array, Array]) -> Array:
        radius = self.region.tubes[1][which]
        x, y, z = axis
        dx, dz = self.center[0] - x, self.center[2] - z
        apart = np.hypot(dx, dz)
        # On the axis every point of the circle is as near as the others.
        scale = radius / np.maximum(apart, 1e-300)
        points = np.empty((*x.shape, 3))
        points[..., 0] = x + np.where(apart > 0.0, dx * scale, radius)
        points[..., 1] = y
        points[..., 2] = z + dz * scale
        return points

    def measure(self, points: Array) -> Array:
        d = points - self.center
        distance: Array = np.sqrt(np.einsum("...k,...k", d, d))
        return distance


def _clearance(region: Region, center: Array, band: float = 0.0) -> tuple[float, Contacts | None]:
    if region.bounds is None or not region.inside(center):
        return 0.0, None
    near = contacts(region, _Point(region, center), band)
    low, high = region.span
    ends = min(center[1] - low, high - center[1])
    return float(min(near.value.min(initial=np.inf), ends)), near


def _grow_ball(region: Region, center: Array, steps: int = 40) -> tuple[Array, float, float]:
    reach = 15.0
    radius, near = _clearance(region, center, 3.5 * reach)
    for _ in range(steps):
        if near is None: break
        move, hoped = _ball_step(region, center, near, radius, reach)
        if hoped <= radius + 1e-10 * region.size:
            break
        r, n = _clearance(region, center + move, 7.0 * reach)
        gain = (r - radius) / (hoped - radius)
        if r > radius:
            center, radius, near = center + move, r, n
        reach *= 2.0 if gain > 0.75 else 1.0 if gain > 0.25 else 0.25
        if reach < 1e-9 * region.size:
            break
    return center, radius, 0.0


def _ball_step(
    region: Region, center: Array, near: Contacts, radius: float, reach: float
) -> tuple[Array, float]:
    """The best move by the contacts' distances to second order, and the radius it promises."""
    use = near.value <= radius + 2.0 * np.sqrt(3.0) * reach
    value = near.value[use]
    normal = (center - near.point[use]) / value[:, None]
    bend = _bend(region, center, near, np.flatnonzero(use), normal)
    low, high = region.span

    def room(x: Array) -> Array:
        d = x[:3]
        curved = 0.5 * np.einsum("nij,i,j->n", bend, d, d)
        return np.append(
            value + normal @ d + curved - x[3],
            [center[1] + d[1] - low - x[3], high - center[1] - d[1] - x[3]],
        )

    def slope(x: Array) -> Array:
        rows = normal + bend @ x[:3]
        rows = np.vstack([rows, [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
        return np.column_stack([rows, -np.ones(len(rows))])

    answer = optimize.minimize(
        lambda x: -x[3],
        np.append(np.zeros(3), radius),
        jac=lambda x: np.array([0.0, 0.0, 0.0, -1.0]),
        bounds=[(-reach, reach)] * 3 + [(0.0, None)],
        constraints={"type": "ineq", "fun": room, "jac": slope},
        method="SLSQP",
        options={"maxiter": 40, "ftol": 1e-12},
    )
    return answer.x[:3], radius + float(room(np.append(answer.x[:3], radius)).min())


def _bend(region: Region, center: Array, near: Contacts, use: Ints, normal: Array) -> Array:
    """Second derivatives (N, 3, 3) of the contacts' distances by the centre.

    A foot q(u) of p on a surface or curve keeps J^T (p − q) = 0, J = ∂q/∂u, hence moves by
    M^-1 J^T dp with M = J^T J − (p − q)·∂²q.
    """
    sets, radii, _ = region.tubes
    result = np.empty((len(use), 3, 3))
    for row, n in enumerate(use):
        away = center - near.point[n]
        if near.tube[n] >= 0:
            k, at = sets[near.tube[n]], near.at[n]
            x, y, z = region.axis(k, np.asarray(at))
            limb = k // 2
            rise = (1.0 - 2.0 * (k % 2)) * region.link[limb]
            u = (near.point[n] - [x, y, z]) / radii[near.tube[n]]
            lean = region.lean
            first = np.array([rise*np.cos(at)*lean[0], -region.link[limb]*np.sin(at), rise*np.cos(at)*lean[1]])
            second = np.array([-rise*np.sin(at)*lean[0], -region.link[limb]*np.cos(at), -rise*np.sin(at)*lean[1]])
            around = radii[near.tube[n]] * np.array([-u[2], 0.0, u[0]])
            jac = np.column_stack([first, around])
            m = jac.T @ jac
            m[0, 0] -= away @ second
            m[1, 1] += away @ u * radii[near.tube[n]]
        else:
            e = 1e-4
            q = region.curves.at(near.piece[n : n + 1], near.at[n] + np.array([-e, 0.0, e]))
            jac = ((q[2] - q[0]) / (2 * e))[:, None]
            m = jac.T @ jac - away @ (q[2] - 2 * q[1] + q[0]) / e**2
        g = normal[row]
        result[row] = np.eye(3) - np.outer(g, g) - jac @ np.linalg.pinv(m) @ jac.T
        result[row] /= near.value[n]
    return result


def _starts(region: Region) -> list[Array]:
    """Where in a grid the complement is far, best first."""
    if region.bounds is None:
        return []
    low, high = region.bounds
    step = (high - low) / _GRID
    axes = [low[k] + step[k] * (np.arange(_GRID) + 0.5) for k in range(3)]
    full = region.inside(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1))
    far = ndimage.distance_transform_edt(np.pad(full, 1), sampling=step)[1:-1, 1:-1, 1:-1]
    peak = (far == ndimage.maximum_filter(far, size=3)) & full
    where = np.argwhere(peak)
    where = where[np.argsort(-far[tuple(where.T)], kind="stable")]
    starts: list[Array] = []
    for index in where:
        point = low + step * (index + 0.5)
        if all(np.linalg.norm(point - s) > 0.7 * far[tuple(index)] for s in starts):
            starts.append(point)
            if len(starts) == _STARTS:
                break
    return starts


def box(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: tuple[str, ...] | None = None,
    center: Sequence[float] | None = None,
) -> Box | None:
    """The largest box along x, y, z centred at ``center``, or anywhere."""
    raise NotImplementedError
