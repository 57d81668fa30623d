"""The place of a working mode's workspace, at one orientation, that is nearest to a given one.

In the plane y = const of the base frame turned by R_y(−θ) each limb's solid is an annulus, so the
nearest point of their intersection is known: the place itself, its foot on a circle or a point
where two circles meet. Over a slab y₀ … y₁ the annuli move; widened by as much as that, they bound
the distance from below. Slabs that cannot hold anything nearer than what is found are dropped, the
others halved (branch and bound), and what is left is refined.
Lengths mm, angles rad.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from kinematics.arrays import Array
from kinematics.facets.clearances import Nearest
from kinematics.facets.inverse import posture
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import signs
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.screws.spatial import rotation_y

PROVEN = 0.01
"""mm: no place is nearer than the one found by more than this, and rounding."""
_SLACK = 2e-10  # mm within which a point is on its circle: less than inverse.STROKE_SLACK
_LOOSE = 1e-9  # the same, as part of the machine's size, where nothing may be dropped by rounding
_SLABS = 64
_MOST_SLABS = 30_000
_CHUNK = 256  # planes at a time, so that the temporaries stay in the cache
_THINNEST = 1e-9  # part of the machine's size: slabs are not halved further
_MINIMA = 12  # that are refined
_CLOSER = np.linspace(-1.0, 1.0, 9)
_NUDGES = (0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5)  # mm that all bounds are drawn in

_PAIRS = [
    (2 * i + m, 2 * j + n)
    for i, j in combinations(range(LIMBS), 2)
    for m, n in product((0, 1), repeat=2)
]
_FIRST, _SECOND = np.array(_PAIRS).T
_OWNER = np.repeat(np.arange(LIMBS), 2)


@dataclass(frozen=True, eq=False)
class Annuli:
    """A mode's workspace at one orientation as annuli in planes y = const of the turned frame.

    Attributes:
        offset: (5, 3) w'_i.
        link: (5,).
        stroke: (5, 2).
        sign: (5,) ±1.
    """

    offset: Array
    link: Array
    stroke: Array
    sign: Array

    @property
    def span(self) -> tuple[float, float]:
        """Where every limb can close."""
        y = self.offset[:, 1]
        return float((y - self.link).max()), float((y + self.link).min())

    @property
    def size(self) -> float:
        return float(np.abs(self.offset).max() + (self.link + self.stroke[:, 1]).max())

    def heights(self, y: Array) -> Array:
        """h_i (N, 5) at y (N,)."""
        dy = y[:, None] - self.offset[:, 1]
        return np.asarray(np.sqrt(np.maximum((self.link - dy) * (self.link + dy), 0.0)))

    def drawn_in(self, amount: float) -> Annuli:
        """The same with all bounds met by ``amount`` sooner."""
        if not amount:
            return self
        inwards = np.where(self.stroke > 0.0, [amount, -amount], 0.0)
        return Annuli(self.offset, self.link - amount, self.stroke + inwards, self.sign)

    def nearest(self, place: Array, y: Array, slack: float = _SLACK) -> tuple[Array, Array]:
        """Distance (N,) and nearest point (N, 3) in each plane; infinite where it is empty."""
        apart, point = self._in_planes(place, self.heights(y), np.zeros(LIMBS), slack)
        points = np.stack([point[:, 0], y, point[:, 1]], axis=1)
        return np.hypot(apart, y - place[1]), points

    def nearer_bound(self, place: Array, low: Array, high: Array) -> Array:
        """A distance (N,) below which slabs low … high hold nothing; infinite where empty."""
        ends = self.heights(low), self.heights(high)
        bottom, top = np.minimum(*ends), np.maximum(*ends)
        middle = self.offset[:, 1]
        top = np.where((low[:, None] <= middle) & (middle <= high[:, None]), self.link, top)
        spread = 0.5 * (top - bottom) + _LOOSE * self.size
        apart, _ = self._in_planes(place, 0.5 * (top + bottom), spread, _LOOSE * self.size)
        beside = np.maximum(np.maximum(low - place[1], place[1] - high), 0.0)
        return np.asarray(np.hypot(apart, beside))

    def _in_planes(
        self, place: Array, height: Array, spread: Array, slack: float
    ) -> tuple[Array, Array]:
        """Distance (N,) and point (N, 2), x' and z', of the intersection of widened annuli."""
        count = len(height)
        spread = np.broadcast_to(spread, height.shape)
        if count > _CHUNK:
            parts = [
                self._in_planes(place, height[k : k + _CHUNK], spread[k : k + _CHUNK], slack)
                for k in range(0, count, _CHUNK)
            ]
            return np.concatenate([d for d, _ in parts]), np.concatenate([p for _, p in parts])
        cx = np.broadcast_to(self.offset[:, 0], height.shape)
        cz = self.offset[:, 2] + self.sign * height
        near = np.broadcast_to(np.maximum(self.stroke[:, 0] - spread, 0.0), height.shape)
        far = np.broadcast_to(self.stroke[:, 1] + spread, height.shape)
        radius = np.stack([near, far], axis=2).reshape(count, 2 * LIMBS)
        dx, dz = place[0] - cx, place[2] - cz
        apart = np.hypot(dx, dz)
        safe = np.where(apart > 0.0, apart, 1.0)
        ux, uz = np.where(apart > 0.0, dx / safe, 1.0)[:, _OWNER], (dz / safe)[:, _OWNER]
        foot_x, foot_z = cx[:, _OWNER] + radius * ux, cz[:, _OWNER] + radius * uz
        px, pz = _meetings(cx, cz, radius)
        here = np.ones((count, 1))
        x = np.concatenate([place[0] * here, foot_x, px], axis=1)
        z = np.concatenate([place[2] * here, foot_z, pz], axis=1)
        distance = np.hypot(x - place[0], z - place[2])
        # The nearest first, most of which are not in all annuli.
        for i in range(LIMBS):
            rho = np.hypot(x - cx[:, i, None], z - cz[:, i, None])
            outside = (rho < near[:, i, None] - slack) | (rho > far[:, i, None] + slack)
            distance[outside] = np.inf
        best = distance.argmin(axis=1)
        rows = np.arange(count)
        return distance[rows, best], np.stack([x[rows, best], z[rows, best]], axis=1)


def _meetings(cx: Array, cz: Array, radius: Array) -> tuple[Array, Array]:
    """x' and z' (N, 80) of the points where circles of two limbs meet; far away where none do."""
    a, b = _FIRST, _SECOND
    ox, oz = cx[:, _OWNER[a]], cz[:, _OWNER[a]]
    dx, dz = cx[:, _OWNER[b]] - ox, cz[:, _OWNER[b]] - oz
    ra, rb = radius[:, a], radius[:, b]
    apart = np.hypot(dx, dz)
    exists = apart > 0.0
    safe = np.where(exists, apart, 1.0)
    along = 0.5 * (apart + (ra - rb) * (ra + rb) / safe)
    square = (ra - along) * (ra + along)
    # Circles that touch may be a rounding short of it.
    exists &= square >= -1e-12 * (ra * ra + rb * rb)
    across = np.sqrt(np.maximum(square, 0.0))
    ux, uz = dx / safe, dz / safe
    lost = np.where(exists, 0.0, 1e150)
    mx, mz = ox + along * ux + lost, oz + along * uz
    return (
        np.concatenate([mx - across * uz, mx + across * uz], axis=1),
        np.concatenate([mz + across * ux, mz - across * ux], axis=1),
    )


def annuli(design: FiveRPURDesign, phi: float, theta: float, mode: str) -> Annuli:
    """The workspace of one mode at one orientation."""
    offset = offset_points(design, phi, theta)
    return Annuli(offset, design.link, design.stroke, signs(mode, design))


def nearest(
    design: FiveRPURDesign, pose: tuple[float, ...], mode: str, within: float = np.inf
) -> Nearest | None:
    """The posture of one mode at the pose's orientation with O' nearest to the pose's.

    Args:
        within: mm; only what is nearer than this counts.

    Returns:
        None where the mode's workspace at this orientation is empty (proven, but for what is
        thinner than 1e-9 of the machine), or holds nothing as near as ``within``.
    """
    phi, theta = pose[3], pose[4]
    turn = rotation_y(theta)
    place = np.array(pose[:3]) @ turn
    region = annuli(design, phi, theta, mode)
    for nudge in _NUDGES:
        found = _search(region.drawn_in(nudge), place, within)
        if found is None:
            return None
        point, gap = found
        x, y, z = (turn @ point).tolist()
        there = posture(design, (x, y, z, phi, theta), mode)
        if there.reachable:
            return Nearest(there, float(np.linalg.norm(point - place)), gap + 2.0 * nudge)
    return None


def _search(region: Annuli, place: Array, within: float) -> tuple[Array, float] | None:
    low, high = region.span
    if not low <= high:
        return None
    edges = np.linspace(low, high, _SLABS + 1)
    left, right = edges[:-1], edges[1:]
    best, at = within, np.nan
    # Ends of the span are looked at too: where they touch, there is nothing between.
    tried = np.append(edges, np.clip(place[1], low, high))
    while True:
        apart, _ = region.nearest(place, tried)
        n = int(apart.argmin())
        if apart[n] < best:
            best, at = float(apart[n]), float(tried[n])
        bound = region.nearer_bound(place, left, right)
        kept = bound < best
        left, right, bound = left[kept], right[kept], bound[kept]
        if not len(left) or best - bound.min() < PROVEN:
            break
        width = float((right - left).max())
        if width < _THINNEST * region.size or len(left) > _MOST_SLABS:
            break
        middle = 0.5 * (left + right)
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
        tried = 0.5 * (left + right)
    if np.isnan(at):
        return None
    gap = max(best - float(bound.min(initial=np.inf)), 0.0)
    return _refined(region, place, np.concatenate([left, right, [at]])), gap


def _refined(region: Annuli, place: Array, tried: Array) -> Array:
    """The nearest point next to planes already tried: ever closer about each local minimum."""
    low, high = region.span
    y = np.unique(tried)
    if len(y) == 1:
        y = np.clip(y + (high - low) / _SLABS * np.array([-1.0, 0.0, 1.0]), low, high)
    apart, _ = region.nearest(place, y)
    padded = np.concatenate([[np.inf], apart, [np.inf]])
    # Where planes next to each other are empty or far apart, a minimum may be on either side.
    lowest = np.isfinite(apart) & (apart <= padded[:-2]) & (apart <= padded[2:])
    lowest |= np.isfinite(apart) & ~(np.isfinite(padded[:-2]) & np.isfinite(padded[2:]))
    chosen = np.flatnonzero(lowest)
    chosen = chosen[np.argsort(apart[chosen], kind="stable")][:_MINIMA]
    middle = y[chosen]
    reach = np.maximum(y[np.minimum(chosen + 1, len(y) - 1)] - middle, middle - y[chosen - 1])
    rows = np.arange(len(chosen))
    while True:
        planes = np.clip(middle[:, None] + reach[:, None] * _CLOSER, low, high)
        apart, points = region.nearest(place, planes.ravel())
        apart = apart.reshape(planes.shape)
        best = apart.argmin(axis=1)
        middle = planes[rows, best]
        if reach.max() < 1e-13 * region.size:
            n = int(apart[rows, best].argmin())
            return np.asarray(points.reshape(*planes.shape, 3)[n, best[n]])
        reach = 0.25 * reach
