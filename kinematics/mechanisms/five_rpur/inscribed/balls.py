"""Balls that grow inside a region: the largest about a centre, and uphill of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.inscribed.contacts import Contacts, contacts
from kinematics.mechanisms.five_rpur.inscribed.growing import (
    ERROR,
    REACH,
    STEPS,
    concave_program,
    held,
    next_reach,
    tangents,
    with_more,
)
from kinematics.mechanisms.five_rpur.inscribed.region import SIGN, Ints, Region

_CLOSER = 0.5 ** np.arange(24)


@dataclass(frozen=True, eq=False)
class _Centre:
    """A point, and distances from it."""

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

    def samples(self, beta: Array) -> Array:
        region, sets = self.region, self.region.tubes[0]
        limb, step = sets // 2, beta[:, 1] - beta[:, 0]
        link = region.link[limb]
        dx, dz = (self.center[k] - region.offset[limb, k] for k in (0, 2))
        along = SIGN[sets] * (dx * region.lean[0] + dz * region.lean[1])
        across = dx * region.lean[1] - dz * region.lean[0]
        # Where the tube's axis passes close to the centre the foot runs around the tube.
        share = np.clip(along / link, 0.0, 1.0)
        if not (np.hypot(across, along - link * share) < 8.0 * link * step).any():
            return beta
        passing = np.arcsin(share)[:, None]
        closer = step[:, None] * np.concatenate([-_CLOSER, [0.0], _CLOSER])
        more = np.concatenate([passing + closer, np.pi - passing + closer], axis=1)
        return with_more(beta, more)

    def measure(self, points: Array) -> Array:
        x, y, z = (points[..., k] - self.center[k] for k in range(3))
        return np.asarray(np.sqrt(x * x + y * y + z * z))


def clearance(region: Region, center: Array, band: float) -> tuple[float, Contacts | None]:
    """The largest radius about a centre, and the contacts up to ``band`` farther."""
    if not region.inside(center):
        return 0.0, None
    near = contacts(region, _Centre(region, center), band)
    low, high = region.span
    ends = min(center[1] - low, high - center[1])
    return float(min(near.value.min(initial=np.inf), ends)), near


@dataclass(frozen=True, eq=False)
class Obstacles:
    """What else a ball must not hold: its nearest points, with first and second derivatives.

    Attributes:
        value: (N,) distances from the centre, mm, nearest first.
        normal: (N, 3) their gradients, and
        bend: (N, 3, 3) their Hessians by the centre.
    """

    value: Array
    normal: Array
    bend: Array


Seeing = Callable[[Array, float], Obstacles]
"""The obstacles about a centre (3,): the nearest, and others up to so many mm farther."""

_NONE = Obstacles(np.empty(0), np.empty((0, 3)), np.empty((0, 3, 3)))


def grow_ball(
    region: Region, center: Array, steps: int = STEPS, seeing: Seeing | None = None
) -> tuple[Array, float]:
    """The centre and radius of the largest ball uphill of a centre.

    Args:
        region: holds the ball.
        center: (3,) where it begins.
        steps: at most.
        seeing: finds obstacles that it must not hold either. No step then leaves the ball, so that
            none leads across them.
    """

    def look(at: Array, band: float) -> tuple[float, Contacts | None, Obstacles]:
        radius, near = clearance(region, at, band)
        if seeing is None or near is None:
            return radius, near, _NONE
        others = seeing(at, band)
        return min(radius, float(others.value.min(initial=np.inf))), near, others

    within = np.inf if seeing is None else 0.5
    reach = REACH * region.size
    radius, near, others = look(center, 4.0 * reach)
    reach = min(reach, 4.0 * radius, within * radius)
    for _ in range(steps):
        if near is None or radius <= 0.0 or reach < ERROR * region.size:
            break
        move, hoped, linear = _ball_step(region, center, near, others, radius, reach)
        if linear <= 0.1 * ERROR * region.size:
            break
        if hoped <= radius:
            reach *= 0.25
            continue
        there, beyond, obstacles = look(center + move, 8.0 * reach)
        share = (there - radius) / (hoped - radius)
        if there > radius:
            center, radius, near, others = center + move, there, beyond, obstacles
        reach = min(next_reach(reach, share, region), within * radius)
    return center, radius


_LAST = np.array([0.0, 0.0, 0.0, 1.0])


def _ball_step(
    region: Region,
    center: Array,
    near: Contacts,
    others: Obstacles,
    radius: float,
    reach: float,
) -> tuple[Array, float, float]:
    """The best move by the contacts' distances to second order, the radius that it promises, and
    what it would gain to first order.
    """
    use = np.flatnonzero((near.value <= radius + 4.0 * reach) & (near.value > 0.0))
    value, away = near.value[use], center - near.point[use]
    low, high = region.span
    ends = np.array([center[1] - low, high - center[1]])
    gap = np.concatenate([value, others.value, ends]) - radius
    facing = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    normal = np.concatenate([away / value[:, None], others.normal, facing])
    flat = np.zeros((2, 3, 3))
    bend = np.concatenate([_bend(region, near, use, away), others.bend, flat])
    # In units of the reach: the move, and what the radius gains.
    rows = np.column_stack([normal, np.full(len(gap), -1.0)])
    curvature = np.zeros((4, 4))
    for _ in range(2):
        x, weight = concave_program(rows, gap / reach, _LAST, curvature)
        curvature[:3, :3] = reach * np.einsum("n,nij->ij", weight, bend)
        curvature = held(rows, weight, curvature)
    move = reach * x[:3]
    linear = gap + normal @ move
    hoped = linear + 0.5 * np.einsum("nij,i,j->n", bend, move, move)
    return move, radius + float(hoped.min()), float(linear.min())


def _bend(region: Region, near: Contacts, use: Ints, away: Array) -> Array:
    """Second derivatives (N, 3, 3) of the contacts' distances by the centre p.

    A foot q(u) on a surface or curve keeps J^T (p − q) = 0, J = ∂q/∂u, and so moves by
    J M^-1 J^T dp with M = J^T J − (p − q)·∂²q, which is positive at a nearest point.
    """
    first, second = tangents(region, near, use)
    m = np.einsum("nki,nkj->nij", first, first)
    m[:, [0, 1], [0, 1]] -= np.einsum("nk,nki->ni", away, second)
    m[near.tube[use] < 0, 1, 1] = 1.0
    det = m[:, 0, 0] * m[:, 1, 1] - m[:, 0, 1] ** 2
    least = (m[:, 0, 0] > 0.0) & (det > 1e-9 * np.abs(m[:, 0, 0] * m[:, 1, 1]))
    inverse = np.stack(
        [np.stack([m[:, 1, 1], -m[:, 0, 1]], -1), np.stack([-m[:, 0, 1], m[:, 0, 0]], -1)], -1
    )
    # Elsewhere, as at an end of a tube, the foot is taken to stay.
    inverse *= (least / np.where(least, det, 1.0))[:, None, None]
    slid = first @ inverse @ first.swapaxes(1, 2)
    square = np.einsum("nk,nk->n", away, away)[:, None, None]
    along = away[:, :, None] * away[:, None, :] / square
    return np.asarray((np.eye(3) - along - slid) / np.sqrt(square))
