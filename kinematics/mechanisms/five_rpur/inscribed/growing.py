"""Balls and boxes that grow inside a region until contacts hold them from all sides.

Each step solves a small concave program over the contacts (`clearance.contacts`) within reach, a
trust region; it is taken only where the body really becomes larger. Lengths mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.inscribed.contacts import (
    SIGN,
    Contacts,
    Ints,
    Region,
    contacts,
)

ERROR = 1e-9
"""Part of the machine's size by which a distance may be wrong."""
_REACH = 0.03  # of the machine's size, the first and the longest step
STEPS = 40
"""More than a body ever took to grow."""
_CLOSER = 0.5 ** np.arange(24)
_AROUND = np.concatenate([-(0.25 ** np.arange(8)), [0.0], 0.25 ** np.arange(8)])
_THIN = 8.0  # samples' distances: a tube of less radius is thin
_BESIDE = np.linspace(-1.5, 1.5, 25)  # radii that the axis passes beside a corner
_GAIN = 1e-7  # the part by which a box must still be hoped to grow


def concave_program(
    rows: Array, room: Array, slope: Array, curvature: Array
) -> tuple[Array, Array]:
    """Maximise slope·x + x·curvature·x / 2 where ``rows @ x + room`` >= 0 and all |x| <= 1.

    Primal-dual interior point method from x = 0, which need not be feasible.

    Args:
        rows: (m, n).
        room: (m,).
        slope: (n,).
        curvature: (n, n), negative semidefinite.

    Returns:
        x and the multipliers (m,) of the rows.
    """
    n = rows.shape[1]
    unit = np.eye(n)
    rows = np.concatenate([rows, unit, -unit])
    room = np.concatenate([room, np.ones(2 * n)])
    x = np.zeros(n)
    slack = np.maximum(room, 0.1)
    weight = 0.1 / slack
    for _ in range(40):
        dual = -slope - curvature @ x - weight @ rows
        primal = rows @ x + room - slack
        mean = float(slack @ weight) / len(room)
        if mean < 1e-12 or (mean < 1e-10 and np.abs(dual).max() < 1e-9 > np.abs(primal).max()):
            break
        ratio = weight / slack
        matrix = (rows.T * ratio) @ rows - curvature
        matrix[np.diag_indices(n)] += 1e-14 * matrix.trace()

        # First towards the bounds, to see how far they let go; then to a share of the mean.
        target = 0.0
        for last in (False, True):
            wanted = target / slack - weight - ratio * primal
            dx = np.linalg.solve(matrix, wanted @ rows - dual)
            ds = rows @ dx + primal
            dw = (target - weight * ds) / slack - weight
            short = float(np.concatenate([ds / slack, dw / weight]).min())
            length = min(1.0, 0.995 / max(-short, 1e-300))
            if not last:
                ahead = float((slack + length * ds) @ (weight + length * dw)) / len(room)
                target = (ahead / mean) ** 3 * mean
        x, slack, weight = x + length * dx, slack + length * ds, weight + length * dw
    return x, weight[: len(room) - 2 * n]


def _with(beta: Array, *more: Array) -> Array:
    """Samples (K, N) and more of them, in order, none beyond their ends."""
    added = np.clip(np.concatenate(more, axis=1), beta[:, :1], beta[:, -1:])
    return np.sort(np.concatenate([beta, added], axis=1), axis=1)


# --- the ball ------------------------------------------------------------------------------------


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
        return _with(beta, more)

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
    reach = _REACH * region.size
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
        reach = min(_next(reach, share, region), within * radius)
    return center, radius


def _held(rows: Array, weight: Array, curvature: Array) -> Array:
    """A curvature as it counts where active rows hold: its concave part along them."""
    _, sizes, across = np.linalg.svd(rows[weight > 1e-6 * weight.max()])
    free = across[int((sizes > 1e-9 * sizes[0]).sum()) :]
    turn, along = np.linalg.eigh(free @ curvature @ free.T)
    basis = along.T @ free
    return np.asarray((basis.T * np.minimum(turn, 0.0)) @ basis)


_LAST = np.array([0.0, 0.0, 0.0, 1.0])


def _next(reach: float, share: float, region: Region) -> float:
    """The next step's reach, by the share of the hoped gain that came true."""
    factor = 2.0 if share > 0.75 else 1.0 if share > 0.25 else 0.25
    return min(factor * reach, _REACH * region.size)


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
    room = np.concatenate([value, others.value, ends]) - radius
    facing = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    normal = np.concatenate([away / value[:, None], others.normal, facing])
    flat = np.zeros((2, 3, 3))
    bend = np.concatenate([_bend(region, near, use, away), others.bend, flat])
    # In units of the reach: the move, and what the radius gains.
    rows = np.column_stack([normal, np.full(len(room), -1.0)])
    curvature = np.zeros((4, 4))
    for _ in range(2):
        x, weight = concave_program(rows, room / reach, _LAST, curvature)
        curvature[:3, :3] = reach * np.einsum("n,nij->ij", weight, bend)
        curvature = _held(rows, weight, curvature)
    move = reach * x[:3]
    linear = room + normal @ move
    hoped = linear + 0.5 * np.einsum("nij,i,j->n", bend, move, move)
    return move, radius + float(hoped.min()), float(linear.min())


def _tangents(region: Region, near: Contacts, use: Ints) -> tuple[Array, Array]:
    """First (N, 3, 2) and unmixed second (N, 3, 2) derivatives of the surfaces at contacts.

    Along the axis of a tube and around it; along a curve, and nothing.
    """
    first, second = np.zeros((2, len(use), 3, 2))
    tube = np.flatnonzero(near.tube[use] >= 0)
    contact = use[tube]
    sets = region.tubes[0][near.tube[contact]]
    at, link = near.at[contact], region.link[sets // 2]
    out = SIGN[sets] * link
    for axis, lean in zip((0, 2), region.lean, strict=True):
        first[tube, axis, 0] = out * np.cos(at) * lean
        second[tube, axis, 0] = -out * np.sin(at) * lean
    first[tube, 1, 0], second[tube, 1, 0] = -link * np.sin(at), -link * np.cos(at)
    x, _, z = region.axis(sets, at)
    dx, dz = near.point[contact, 0] - x, near.point[contact, 2] - z
    first[tube, 0, 1], first[tube, 2, 1] = -dz, dx
    second[tube, 0, 1], second[tube, 2, 1] = -dx, -dz
    curve = np.flatnonzero(near.tube[use] < 0)
    if curve.size:
        contact, tiny = use[curve], 1e-4
        s = near.at[contact, None] + np.array([-tiny, 0.0, tiny])
        before, here, after = np.moveaxis(region.curves.at(near.piece[contact, None], s), 1, 0)
        first[curve, :, 0] = (after - before) / (2.0 * tiny)
        second[curve, :, 0] = (after - 2.0 * here + before) / tiny**2
    return first, second


def _bend(region: Region, near: Contacts, use: Ints, away: Array) -> Array:
    """Second derivatives (N, 3, 3) of the contacts' distances by the centre p.

    A foot q(u) on a surface or curve keeps J^T (p − q) = 0, J = ∂q/∂u, and so moves by
    J M^-1 J^T dp with M = J^T J − (p − q)·∂²q, which is positive at a nearest point.
    """
    first, second = _tangents(region, near, use)
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


# --- the box -------------------------------------------------------------------------------------


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
        return _with(beta, *more)

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
    room = min(float(near.value.min(initial=np.inf)), ends)
    moved = np.stack([corners[0] - room, corners[1] + room])
    if not (moved[0] < moved[1]).all():
        moved = np.tile(corners.mean(axis=0), (2, 1))
    # Faces that all move out by as much come so much nearer to every point.
    return moved, replace(near, value=near.value - room)


def grow_box(region: Region, corners: Array, centred: bool, steps: int = STEPS) -> Array:
    """The corners (2, 3) of the largest box uphill of one, with the same centre if ``centred``."""
    reach = _REACH * region.size
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
        reach = _next(reach, gain / hoped, region)
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
    room = np.concatenate([near.value[use], [corners[0, 1] - low, high - corners[1, 1]]])
    # In units that leave a box of some size: opposite faces come no more than halfway closer.
    unit = np.diag(np.tile(np.minimum(reach, 0.24 * size), 2))
    if centred:
        unit = unit[:, 3:] - unit[:, :3]
    sides = unit[3:] - unit[:3]
    rows, room = rows @ unit / reach, room / reach
    share = sides / size[:, None]
    curvature = -share.T @ share
    for _ in range(2):
        x, weight = concave_program(rows, room, share.sum(axis=0), curvature)
        curved = np.einsum("n,nij->ij", weight[:-2] / reach, bend)
        curvature = _held(rows, weight, unit.T @ curved @ unit - share.T @ share)
    return np.asarray((unit @ x).reshape(2, 3))


def _pushes(region: Region, corners: Array, near: Contacts, use: Ints) -> tuple[Array, Array]:
    """First (N, 6) and second (N, 6, 6) derivatives of the contacts' distances by the faces.

    Faces are in the order low x, y, z and high x, y, z. A distance is the greatest of those from
    the faces, least on a surface or curve q(u): weights of the greatest ones, on a surface the
    parts of its normal, leave nothing along the tangents. How u and the weights change with the
    faces follows by differentiating these conditions.
    """
    first, second = _tangents(region, near, use)
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
