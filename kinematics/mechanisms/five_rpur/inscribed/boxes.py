"""Boxes that grow inside a region, their edges along x, y, z."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

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
_AROUND = np.concatenate([-(0.25 ** np.arange(8)), [0.0], 0.25 ** np.arange(8)])
_THIN = 8.0  # samples' distances: a tube of less radius is thin
_BESIDE = np.linspace(-1.5, 1.5, 25)  # radii that the axis passes beside a corner
_GAIN = 1e-7  # the part by which a box must still be hoped to grow


@dataclass(frozen=True, eq=False)
class _Faces:
    """A box (2, 3), and distances from it in the maximum norm.

    In a plane y = const a growing rectangle meets a circle about it with a corner, and a circle
    outside of it with a corner or a side.
    """

    region: Region
    corners: Array

    @cached_property
    def _kinds(self) -> Ints:
        """(K, 3): a tube, and the way in x and z in which a corner or side looks for it."""
        rows = [
            (n, sx, sz)
            for n, outer in enumerate(self.region.tubes[2])
            for sx, sz in product((-1, 0, 1), repeat=2)
            if (sx and sz) or ((sx or sz) and not outer)
        ]
        return np.array(rows, dtype=np.intp).reshape(-1, 3)

    @property
    def tube(self) -> Ints:
        return self._kinds[:, 0]

    def foot(self, which: Ints, axis: tuple[Array, Array, Array]) -> Array:
        tube, sx, sz = np.moveaxis(self._kinds[which], -1, 0)
        radius, outer = self.region.tubes[1][tube], self.region.tubes[2][tube]
        x, y, z = axis
        # The corner, from the circle's centre; it moves along (sx, sz) as the box grows.
        cx = self.corners[(sx > 0).astype(np.intp), 0] - x
        cz = self.corners[(sz > 0).astype(np.intp), 2] - z
        ahead = 0.5 * (sx * cx + sz * cz)
        square = ahead**2 - 0.5 * (cx**2 + cz**2 - radius**2)
        root = np.sqrt(np.where(square >= 0.0, square, np.nan))
        grow = np.where(outer, root, -root) - ahead
        qx, qz = cx + sx * grow, cz + sz * grow
        # There the circle must lie about the corner, or face it.
        way = np.where(outer, 1, -1)
        corner, meets = sx * sz != 0, (qx * sx * way >= 0.0) & (qz * sz * way >= 0.0)
        points = np.empty((*x.shape, 3))
        points[..., 0] = x + np.where(corner, np.where(meets, qx, np.nan), -radius * sx)
        points[..., 1] = y
        points[..., 2] = z + np.where(corner, np.where(meets, qz, np.nan), -radius * sz)
        return points

    def samples(self, beta: Array) -> Array:
        region, tube, sx, sz = self.region, *self._kinds.T
        sets, radius = region.tubes[0][tube], region.tubes[1][tube]
        limb, step = sets // 2, beta[:, 1] - beta[:, 0]
        link = region.link[limb]
        # Distances have their kinks, and so their least, next to the faces across y.
        y = (self.corners[:, 1] - region.offset[limb, 1:2]) / link[:, None]
        closer = step[:, None, None] * _AROUND
        faces = (np.arccos(np.clip(y, -1.0, 1.0))[..., None] + closer).reshape(len(limb), -1)
        more = [faces]
        # A corner meets a circle only in planes where the axis passes close to it: where the tube
        # is thin, there may be no sample among these.
        if (radius < _THIN * link * step).any():
            dx = self.corners[(sx > 0).astype(np.intp), 0] - region.offset[limb, 0]
            dz = self.corners[(sz > 0).astype(np.intp), 2] - region.offset[limb, 2]
            along = SIGN[sets] * (dx * region.lean[0] + dz * region.lean[1])
            shares = (along[:, None] + radius[:, None] * _BESIDE) / link[:, None]
            passing = np.arcsin(np.clip(shares, 0.0, 1.0))
            more += [passing, np.pi - passing]
        return with_more(beta, *more)

    def measure(self, points: Array) -> Array:
        half, middle = 0.5 * (self.corners[1] - self.corners[0]), self.corners.mean(axis=0)
        x, y, z = (np.abs(points[..., k] - middle[k]) - half[k] for k in range(3))
        beyond = np.maximum(np.maximum(x, z), y)
        return np.where(np.isnan(beyond), np.inf, beyond)


def fitted(region: Region, corners: Array, band: float) -> tuple[Array, Contacts]:
    """A box (2, 3) with all faces moved by as much as they may (or must), and its contacts.

    Where it would be turned inside out it has no size.
    """
    near = contacts(region, _Faces(region, corners), band)
    low, high = region.span
    ends = min(corners[0, 1] - low, high - corners[1, 1])
    gap = min(float(near.value.min(initial=np.inf)), ends)
    moved = np.stack([corners[0] - gap, corners[1] + gap])
    if not (moved[0] < moved[1]).all():
        moved = np.tile(corners.mean(axis=0), (2, 1))
    # Faces that all move out by as much come so much nearer to every point.
    return moved, replace(near, value=near.value - gap)


def grow_box(region: Region, corners: Array, centred: bool, steps: int = STEPS) -> Array:
    """The corners (2, 3) of the largest box uphill of one, with the same centre if ``centred``."""
    reach = REACH * region.size
    best, near = fitted(region, corners, 4.0 * reach)
    reach = min(reach, float((best[1] - best[0]).max()))
    volume = volume_of(best)
    for _ in range(steps):
        if volume <= 0.0 or reach < ERROR * region.size:
            break
        trial = best + _box_step(region, best, near, reach, centred)
        hoped = volume_of(trial) / volume - 1.0
        if hoped <= _GAIN:
            break
        trial, beyond = fitted(region, trial, 8.0 * reach)
        gain = volume_of(trial) / volume - 1.0
        if gain > 0.0:
            best, volume, near = trial, volume_of(trial), beyond
        reach = next_reach(reach, gain / hoped, region)
    return best


def volume_of(corners: Array) -> float:
    """mm³ of a box (2, 3)."""
    return float(np.prod(corners[1] - corners[0]))


def _box_step(region: Region, corners: Array, near: Contacts, reach: float, centred: bool) -> Array:
    """How the faces (2, 3) should move by the contacts' distances to second order."""
    use = np.flatnonzero(near.value <= 4.0 * reach)
    size = corners[1] - corners[0]
    low, high = region.span
    pushes, bend = _pushes(region, corners, near, use)
    rows = np.concatenate([pushes, np.zeros((2, 6))])
    rows[-2, 1], rows[-1, 4] = 1.0, -1.0
    gap = np.concatenate([near.value[use], [corners[0, 1] - low, high - corners[1, 1]]])
    # In units that leave a box of some size: opposite faces come no more than halfway closer.
    unit = np.diag(np.tile(np.minimum(reach, 0.24 * size), 2))
    if centred:
        unit = unit[:, 3:] - unit[:, :3]
    sides = unit[3:] - unit[:3]
    rows, gap = rows @ unit / reach, gap / reach
    share = sides / size[:, None]
    curvature = -share.T @ share
    for _ in range(2):
        x, weight = concave_program(rows, gap, share.sum(axis=0), curvature)
        curved = np.einsum("n,nij->ij", weight[:-2] / reach, bend)
        curvature = held(rows, weight, unit.T @ curved @ unit - share.T @ share)
    return np.asarray((unit @ x).reshape(2, 3))


def _pushes(region: Region, corners: Array, near: Contacts, use: Ints) -> tuple[Array, Array]:
    """First (N, 6) and second (N, 6, 6) derivatives of the contacts' distances by the faces.

    Faces are in the order low x, y, z and high x, y, z. A distance is the greatest of those from
    the faces, least on a surface or curve q(u): weights of the greatest ones, on a surface the
    parts of its normal, leave nothing along the tangents. How u and the weights change with the
    faces follows by differentiating these conditions.
    """
    first, second = tangents(region, near, use)
    point, count = near.point[use], len(use)
    outward = np.repeat([-1.0, 1.0], 3)
    beyond = np.concatenate([corners[0] - point, point - corners[1]], axis=1)
    active = beyond >= near.value[use, None] - 1e-7 * region.size
    normal = np.abs(np.cross(first[:, :, 0], first[:, :, 1]))
    weight = np.where(active, np.tile(normal, 2), 0.0)
    for n in np.flatnonzero(near.tube[use] < 0):
        along = np.where(active[n], outward * np.tile(first[n, :, 0], 2), 0.0)
        down, up = along.argmin(), along.argmax()
        if along[down] < 0.0 < along[up]:
            weight[n, [down, up]] = along[up], -along[down]
    lost = weight.sum(axis=1) <= 0.0
    weight[lost, beyond[lost].argmax(axis=1)] = 1.0
    weight /= weight.sum(axis=1, keepdims=True)
    # Unknown: two parameters u, six weights, the distance. Faces not in touch keep weight 0.
    touched = weight > 1e-9
    slopes = np.tile(first, (1, 2, 1)) * outward[:, None] * touched[:, :, None]
    bends = np.einsum("nk,nkj->nj", weight * outward, np.tile(second, (1, 2, 1)))
    system = np.zeros((count, 9, 9))
    system[:, [0, 1], [0, 1]] = bends
    system[near.tube[use] < 0, 1, 1] = 1.0
    system[:, :2, 2:8] = slopes.swapaxes(1, 2)
    system[:, 2:8, :2] = slopes
    system[:, 2:8, 8] = system[:, 8, 2:8] = -1.0 * touched
    system[:, range(2, 8), range(2, 8)] = ~touched
    moved = np.linalg.pinv(system, rcond=1e-10)[:, :2, 2:8] * (outward * touched)[:, None, :]
    bend = np.einsum("nai,na,naj->nij", moved, bends, moved)
    return weight * -outward, bend
