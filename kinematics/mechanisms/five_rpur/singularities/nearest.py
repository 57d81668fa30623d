"""The parallel singularity that is nearest to a pose, at the pose's orientation and mode.

Boxes about the pose, each twice as large as the one before, are cut into cells by the nodes of a
grid; in the first in which the determinant (`determinant`) vanishes its nearest zeros are sought
from all cells that may hold one, by Newton's method on Lagrange's equations. A last, finer grid
over the box that is left looks for what is nearer still. Lengths mm.

Along y' the variable is the angle β of y' = middle − half cos β: where a limb's link lies along e1
the determinant runs as the square root of the way that is left, but smoothly in β.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array, Frozen, finite
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant

ERROR = 1e-9
"""Part of the machine's size by which a distance may be wrong."""

_FIRST = 1.0 / 64.0  # half the side of the first box, part of the machine's size
_LAST = 4.0  # and of the last
_NODES = 25  # along each axis of a box; of the last, finer one:
_FINE = 57
_STARTS = 48  # cells from which zeros are sought, and how often again
_ROUNDS = 4
_PATIENCE = 4  # steps after which starts are given up that lead far away
_STEPS = 40  # along the zeros
_CORRECTIONS = 7  # back onto them
_EDGE = 1e-7  # rad from the ends of β, where slopes by y' are infinite


@dataclass(frozen=True, eq=False)
class Nearest(Frozen):
    """The nearest parallel singularity.

    Attributes:
        distance: mm from the pose, at the same orientation.
        point: (3,) O' there, mm, base frame.
        error: mm, an estimate of the error of ``distance``.
    """

    distance: float
    point: Array
    error: float


def nearest_singularity(design: FiveRPURDesign, pose: Sequence[float], mode: str) -> Nearest | None:
    """The nearest pose of the same orientation and mode in which the wrenches are dependent.

    Limbs close there; the ends of their strokes are not regarded. What is smaller than a cell of
    the last grid (a 28th of the distance) and does not change the determinant's sign at its nodes,
    nor bring it near to zero, may be missed.

    Args:
        pose: (x, y, z, φ, θ), mm and rad.

    Returns:
        None where a limb cannot close at the pose, or there is no singularity within four times
        the machine's size. Distance 0 where the pose itself is singular.

    Raises:
        InputError: the pose is not five finite numbers, or the mode not five signs.
    """
    values = finite(pose, name="a pose", last=5)
    if values.shape != (5,):
        raise InputError("a pose must be one row of 5 numbers (x, y, z, φ, θ)")
    determinant = Determinant.at(design, float(values[3]), float(values[4]), mode)
    center = values[:3] @ determinant.turn
    low, high = determinant.span
    if not low <= center[1] <= high:
        return None
    found = zeros_near(determinant, center)
    if found is None:
        return None
    points, distances, residuals = found
    return Nearest(
        float(distances[0]),
        determinant.turn @ points[0],
        float(residuals[0]) + ERROR * determinant.size,
    )


def zeros_near(
    determinant: Determinant, center: Array, most: float | None = None
) -> tuple[Array, Array, Array] | None:
    """Zeros of the determinant, the nearest to a centre first.

    Args:
        center: (3,) in x'y'z', where every limb closes.
        most: how far to look, mm; None: `_LAST` of the machine's size.

    Returns:
        Points (N, 3) in x'y'z', their distances (N,) and residuals (N,) |F| / |∇F|, mm: the
        nearest zero, and others at which the distance is least among neighbours. None where
        there is none.
    """
    if not determinant.closes:
        return None
    if abs(float(determinant.value(center))) <= float(determinant.roundoff(center)):
        return center[None], np.zeros(1), np.zeros(1)
    chart = Chart.about(determinant, center)
    limit = _LAST * determinant.size if most is None else most
    reach = min(_FIRST * determinant.size, limit)
    while True:
        found = chart.search(reach, _NODES)
        if found is not None and found[1][0] <= limit:
            break
        if reach >= limit:
            return None
        reach = min(2.0 * reach, limit)
    nearest = float(found[1][0])
    return _merged(found, chart.search(nearest, _FINE, nearest))


@dataclass(frozen=True, eq=False)
class Chart:
    """Positions about a centre as (x', half β, z'), mm."""

    determinant: Determinant
    center: Array
    middle: float
    half: float

    @classmethod
    def about(cls, determinant: Determinant, center: Array) -> Chart:
        low, high = determinant.span
        return cls(determinant, center, 0.5 * (low + high), 0.5 * (high - low))

    def place(self, u: Array) -> Array:
        """Points (..., 3) in x'y'z'."""
        points = u.copy()
        points[..., 1] = self.middle - self.half * np.cos(u[..., 1] / self.half)
        return points

    def lift(self, points: Array) -> Array:
        """The other way round: (..., 3) of points in x'y'z' within the span."""
        u = points.copy()
        u[..., 1] = self.half * self._beta(points[..., 1])
        return u

    def _beta(self, y: Array) -> Array:
        return np.asarray(np.arccos(np.clip((self.middle - y) / self.half, -1.0, 1.0)))

    def value_and_gradient(self, u: Array) -> tuple[Array, Array]:
        value, gradient = self.determinant.value_and_gradient(self.place(u))
        gradient[..., 1] *= np.sin(u[..., 1] / self.half)
        return value, gradient

    # --- cells that may hold zeros

    def search(
        self, reach: float, nodes: int, within: float = np.inf
    ) -> tuple[Array, Array, Array] | None:
        """Zeros in the box of half side ``reach`` about the centre, see `zeros_near`.

        Only cells that hold points at less than ``within`` count.
        """
        cx, cy, cz = self.center
        low, high = self._beta(np.array([cy - reach, cy + reach]))
        low, high = max(low, _EDGE), min(high, np.pi - _EDGE)
        x, z = (np.linspace(c - reach, c + reach, nodes) for c in (cx, cz))
        v = self.half * np.linspace(low, high, nodes)
        y = self.middle - self.half * np.cos(v / self.half)
        values = self.determinant.on_grid(x, y, z)
        least, most = _extremes(values)
        changes = (least <= 0.0) & (most >= 0.0)
        near = np.minimum(np.abs(least), np.abs(most)) <= 0.5 * (most - least)
        cells = np.argwhere(changes | near)
        if not len(cells):
            return None
        starts = np.stack(
            [0.5 * (a[cells[:, k]] + a[cells[:, k] + 1]) for k, a in enumerate((x, v, z))], axis=-1
        )
        apart = np.linalg.norm(self.place(starts) - self.center, axis=1)
        sides = np.stack([a[cells[:, k] + 1] - a[cells[:, k]] for k, a in enumerate((x, y, z))])
        half = 0.5 * np.linalg.norm(sides, axis=0)
        inside = apart - half < within
        if not inside.any():
            return None
        starts, apart, farthest = starts[inside], apart[inside], (apart + half)[inside]
        changed = changes[tuple(cells[inside].T)]
        found = self.polished(starts[spread(starts, apart, 0.3 * reach)], 0.5 * reach)
        # A cell in which the sign changes is proof of a zero: if it is nearer, look again there.
        for _ in range(_ROUNDS):
            best = within if found is None else min(within, float(found[1][0]))
            nearer = np.flatnonzero(changed & (farthest < best))
            if not len(nearer):
                break
            chosen = nearer[spread(starts[nearer], apart[nearer], 0.1 * reach)]
            changed[nearer[apart[nearer] <= apart[chosen].min()]] = False
            changed[chosen] = False
            more = self.polished(starts[chosen], 2.0 * reach / nodes)
            found = more if found is None else _merged(found, more)
        return found

    # --- along F = 0 towards the centre

    def polished(self, u: Array, longest: float) -> tuple[Array, Array, Array] | None:
        """Zeros nearest to the centre, each from a start (N, 3); no step is longer than so much.

        Newton's steps on Lagrange's equations, each followed by the way back onto F = 0, and
        shortened until the centre is nearer: what is found is never farther than where it began.
        """
        size = self.determinant.size
        u, there = self._onto(u, longest)
        u = u[there]
        distance = self._apart(u)
        scale = np.ones(len(u))
        active = np.arange(len(u))
        for count in range(_STEPS):
            if not len(active):
                break
            step = self._step(u[active])
            length = np.linalg.norm(step, axis=1)
            step *= np.minimum(scale[active], longest / np.maximum(length, 1e-300))[:, None]
            tried, there = self._onto(self._held(u[active] + step), longest)
            apart = self._apart(tried)
            nearer = there & (apart < distance[active])
            way = np.linalg.norm(tried - u[active], axis=1)
            moving = (way > 1e-9 * size) & ~(nearer & (apart > distance[active] - 1e-14 * size))
            u[active[nearer]], distance[active[nearer]] = tried[nearer], apart[nearer]
            scale[active] = np.where(nearer, np.minimum(1.0, 4.0 * scale[active]), 0.0)
            scale[active[~nearer]] = (
                0.2 * np.linalg.norm(step[~nearer], axis=1) / np.maximum(length[~nearer], 1e-300)
            )
            if count >= _PATIENCE:  # the others' turn comes, if there, from another start
                moving &= distance[active] < 1.3 * distance.min()
            active = active[moving]
        if not len(u):
            return None
        value, g = self.value_and_gradient(u)
        residual = np.abs(value) / np.maximum(np.linalg.norm(g, axis=1), 1e-300)
        order = np.argsort(distance, kind="stable")
        return self.place(u[order]), distance[order], residual[order]

    @property
    def _ends(self) -> tuple[float, float]:
        return self.half * _EDGE, self.half * (np.pi - _EDGE)

    def _held(self, u: Array) -> Array:
        """Points with β within its ends."""
        held = u.copy()
        held[:, 1] = np.clip(u[:, 1], *self._ends)
        return held

    def _apart(self, u: Array) -> Array:
        return np.asarray(np.linalg.norm(self.place(u) - self.center, axis=1))

    def _onto(self, u: Array, longest: float) -> tuple[Array, NDArray[np.bool_]]:
        """Points (N, 3) moved onto F = 0 along its gradient, and which of them got there."""
        u, start = u.copy(), u
        there = np.zeros(len(u), dtype=bool)
        active = np.arange(len(u))
        for _ in range(_CORRECTIONS):
            if not len(active):
                break
            value, g = self.value_and_gradient(u[active])
            self._keep_off_ends(u[active], -value[:, None] * g, g)
            steep = np.maximum((g * g).sum(axis=1), 1e-300)
            u[active] = self._held(u[active] - (value / steep)[:, None] * g)
            residual = np.abs(value) / np.sqrt(steep)
            done = residual <= 1e-12 * self.determinant.size
            there[active[done]] = True
            near = np.linalg.norm(u[active] - start[active], axis=1) <= 2.0 * longest
            active = active[~done & near]
        if len(active):  # as near as rounding lets them
            value, g = self.value_and_gradient(u[active])
            noise = self.determinant.roundoff(self.place(u[active]))
            steep = np.linalg.norm(g, axis=1)
            there[active] = np.abs(value) <= 4.0 * noise + 1e-11 * self.determinant.size * steep
        return u, there

    def _keep_off_ends(self, u: Array, way: Array, *vectors: Array) -> NDArray[np.bool_]:
        """Where a way would lead beyond an end of β: there β stays, in ``vectors`` as well."""
        low, high = self._ends
        out = (u[:, 1] <= low) & (way[:, 1] < 0.0) | (u[:, 1] >= high) & (way[:, 1] > 0.0)
        for vector in vectors:
            vector[out, 1] = 0.0
        return out

    def _step(self, u: Array) -> Array:
        """Newton's step from points (N, 3) on F = 0, in its tangent plane, towards the centre."""
        _, g, hessian = self._second(u)
        angle = u[:, 1] / self.half
        away = self.place(u) - self.center
        # The gradient and the Hessian of half the squared distance.
        slope = away.copy()
        slope[:, 1] *= np.sin(angle)
        bend = np.tile(np.eye(3), (len(u), 1, 1))
        bend[:, 1, 1] = np.sin(angle) ** 2 + away[:, 1] * np.cos(angle) / self.half
        square = np.maximum((g * g).sum(axis=1), 1e-300)
        weight = -(slope * g).sum(axis=1) / square
        whole = bend + weight[:, None, None] * hessian
        out = self._keep_off_ends(u, -(slope + weight[:, None] * g), g, slope)
        whole[out, 1, :] = whole[out, :, 1] = 0.0
        whole[out, 1, 1] = 1.0
        return _along(g, slope, whole)

    def _second(self, u: Array) -> tuple[Array, Array, Array]:
        """F, its gradient and (by central differences of that) its Hessian."""
        tiny = 1e-5 * self.determinant.size
        shifts = tiny * np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3)])
        value, gradient = self.value_and_gradient(u + shifts[:, None])
        hessian = (gradient[1:4] - gradient[4:7]) / (2.0 * tiny)
        hessian = hessian.transpose(1, 0, 2)
        return value[0], gradient[0], 0.5 * (hessian + hessian.transpose(0, 2, 1))


def _along(normal: Array, slope: Array, whole: Array) -> Array:
    """Newton's step (N, 3) in the planes across ``normal``; downhill where it is not convex."""
    axis = np.eye(3)[np.abs(normal).argmin(axis=1)]
    first = np.cross(normal, axis)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    second = np.cross(normal, first)
    second /= np.maximum(np.linalg.norm(second, axis=1, keepdims=True), 1e-300)
    basis = np.stack([first, second], axis=-1)  # (N, 3, 2)
    reduced = np.einsum("nia,nij,njb->nab", basis, whole, basis)
    right = np.einsum("nia,ni->na", basis, slope)
    size, turn = np.linalg.eigh(reduced)
    size = np.maximum(np.abs(size), 1e-5)
    move = np.einsum("nab,nb->na", turn, np.einsum("nab,na->nb", turn, right) / size)
    return -np.asarray(np.einsum("nia,na->ni", basis, move))


def spread(points: Array, apart: Array, gap: float) -> NDArray[np.intp]:
    """Up to `_STARTS` of some points, the least ``apart`` first, none within a gap of another."""
    left = np.argsort(apart, kind="stable")
    chosen: list[int] = []
    while len(left) and len(chosen) < _STARTS:
        first = left[0]
        chosen.append(int(first))
        left = left[((points[left] - points[first]) ** 2).sum(axis=1) > gap * gap]
    return np.array(chosen, dtype=np.intp)


def _merged(
    first: tuple[Array, Array, Array], second: tuple[Array, Array, Array] | None
) -> tuple[Array, Array, Array]:
    """Both lists of zeros, nearest first."""
    if second is None:
        return first
    points, distance, residual = (
        np.concatenate([a, b]) for a, b in zip(first, second, strict=True)
    )
    order = np.argsort(distance, kind="stable")
    return points[order], distance[order], residual[order]


def _extremes(values: Array) -> tuple[Array, Array]:
    """The least and the greatest of the eight corners of every cell."""
    least = most = values
    for axis in range(3):
        near = (slice(None),) * axis + (slice(None, -1),)
        far = (slice(None),) * axis + (slice(1, None),)
        least = np.minimum(least[near], least[far])
        most = np.maximum(most[near], most[far])
    return least, most
