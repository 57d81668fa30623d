"""The largest ball without singularities: the usable workspace of a mode at one orientation.

A ball in the workspace grows (`inscribed.balls`) until contacts with the workspace's boundary and
with the parallel singularities hold it from all sides. Nearest zeros of the determinant are first
looked for among points on its zero surface, sampled once; the ball that is returned is then
checked, and grown again if need be, with the thorough search of `nearest`. As of every ball
"anywhere", it is the best found from several starts. Lengths mm.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.answers.sections import Sphere
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inscribed.balls import Obstacles, clearance, grow_ball
from kinematics.mechanisms.five_rpur.inscribed.growing import ERROR
from kinematics.mechanisms.five_rpur.inscribed.largest import Grid, grid_of, point_of, starts_in
from kinematics.mechanisms.five_rpur.inscribed.region import Mask, Region, formula
from kinematics.mechanisms.five_rpur.offsets import SAME_SOLIDS, aligned_offsets
from kinematics.mechanisms.five_rpur.singularities.cells import CELLS, Cells
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from kinematics.mechanisms.five_rpur.singularities.nearest import Chart, spread, zeros_near

_STARTS = 4  # from which the best anywhere is sought, of each sign
_FINALISTS = 2  # of these, when they have grown a little
_NODES = 40  # along each axis of a grid, were it a cube
_CHECKS = 4  # of a ball that has grown; each may find a zero that the samples missed
_LOOKS = 8  # sampled points from which zeros are sought


def singularity_free_ball(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    mode: str,
    center: Sequence[float] | None = None,
    *,
    piece: Sequence[float] | None = None,
) -> Sphere | None:
    """The largest ball about a centre, or the largest found anywhere, without singularities.

    Args:
        center: (3,) mm in the base frame; None for the best anywhere.
        piece: (3,) likewise: only in the singularity-free piece that holds this point.

    Returns:
        The ball, of radius 0 about a centre that is outside or singular; None where no centre is
        given and nothing is found.

    Raises:
        InputError: angles, mode, centre or point that are not what they should be.
    """
    if center is not None and piece is not None:
        raise InputError("a ball has a given centre or is sought in a piece, not both")
    determinant = Determinant.at(design, phi, theta, mode)
    lean = np.array([0.0, 1.0])  # in x'y'z'
    offset = aligned_offsets(design, phi, theta, SAME_SOLIDS)
    region = Region(offset, design.link, design.stroke, lean, formula((mode,)))
    error = 2.0 * ERROR * region.size
    if center is not None:
        middle = point_of(center)
        inner = middle @ determinant.turn
        radius, _ = clearance(region, inner, 0.0)
        return Sphere(middle, _free(determinant, inner, radius), error)
    held = None if piece is None else point_of(piece) @ determinant.turn
    if held is not None and not _free(determinant, held, clearance(region, held, 0.0)[0]) > 0.0:
        return None
    if region.bounds is None:
        return None
    cells = Cells.about(determinant, design.stroke, np.array(region.bounds), CELLS["normal"], 0.0)
    if not np.isfinite(cells.values).any() or cells.vanish():
        return None
    seen = _Seen(determinant, cells.zeros())
    starts = _starts(region, determinant, held)
    young = [grow_ball(region, start, 3, seen) for start in starts]
    young.sort(key=lambda ball: -ball[1])
    balls = [_grown(region, seen, place) for place, _ in young[:_FINALISTS]]
    best = max(balls, key=lambda ball: ball[1], default=None)
    if best is None or not best[1] > 0.0:
        return None
    return Sphere(determinant.turn @ best[0], best[1], error)


def _free(determinant: Determinant, center: Array, radius: float) -> float:
    """A radius, as far as there are no zeros in the ball."""
    if not radius > 0.0:
        return 0.0
    found = zeros_near(determinant, center, radius)
    return radius if found is None else min(radius, float(found[1][0]))


def _grown(region: Region, seen: _Seen, start: Array) -> tuple[Array, float]:
    """A ball that has grown as far as it can, checked."""
    center = start
    for _ in range(_CHECKS):
        center, radius = grow_ball(region, center, seeing=seen)
        found = zeros_near(seen.determinant, center, radius)
        if found is None or found[1][0] >= radius - ERROR * region.size:
            return center, radius
        seen.add(found[0])
    return center, _free(seen.determinant, center, radius)


class _Seen:
    """Sampled points on the zero surface, and the zeros nearest to a centre found from them."""

    def __init__(self, determinant: Determinant, points: Array) -> None:
        self.determinant = determinant
        self._set(points)

    def add(self, points: Array) -> None:
        """More points on the surface."""
        self._set(np.concatenate([self._points, points]))

    def _set(self, points: Array) -> None:
        from scipy.spatial import cKDTree

        self._points = points
        self._tree = cKDTree(points) if len(points) else None

    def __call__(self, center: Array, band: float) -> Obstacles:
        """See `growing.Seeing`."""
        nothing = Obstacles(np.empty(0), np.empty((0, 3)), np.empty((0, 3, 3)))
        if self._tree is None:
            return nothing
        nearest, _ = self._tree.query(center)
        near = self._points[self._tree.query_ball_point(center, float(nearest) + band)]
        apart = np.linalg.norm(near - center, axis=1)
        starts = near[spread(near, apart, 0.4 * float(nearest) + 0.1 * band)[:_LOOKS]]
        chart = Chart.about(self.determinant, center)
        found = chart.polished(chart.lift(starts), 0.5 * float(nearest) + 1e-3)
        if found is None:
            return nothing
        points, value, _ = found
        keep = [0]
        for k in range(1, len(points)):
            apart = np.linalg.norm(points[keep] - points[k], axis=1)
            if apart.min() > 1e-6 * self.determinant.size and value[k] <= value[0] + band:
                keep.append(k)
        points, value = points[keep], value[keep]
        if not value[0] > 0.0:
            return Obstacles(np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3, 3)))
        normal = (center - points) / value[:, None]
        return Obstacles(value, normal, self._bend(points, normal, value))

    def _bend(self, points: Array, normal: Array, value: Array) -> Array:
        """The Hessians (N, 3, 3) of the distances of a centre from the surface.

        The surface rises t·K·t / 2 above its tangent plane, towards the centre: the Hessian is
        −K (1 − d K)^-1 in that plane, d the distance.
        """
        tiny = 1e-5 * self.determinant.size
        shifts = tiny * np.concatenate([np.eye(3), -np.eye(3)])
        _, slope = self.determinant.value_and_gradient(points + shifts[:, None])
        _, own = self.determinant.value_and_gradient(points)
        hessian = (slope[:3] - slope[3:]).transpose(1, 0, 2) / (2.0 * tiny)
        steep = np.einsum("ni,ni->n", own, normal)  # ±|∇F|
        flat = np.eye(3) - normal[:, :, None] * normal[:, None, :]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            rise = -(flat @ hessian @ flat) / steep[:, None, None]
            rise = 0.5 * (rise + rise.transpose(0, 2, 1))
        usual = np.isfinite(rise).all(axis=(1, 2))
        sizes, axes = np.linalg.eigh(np.where(usual[:, None, None], rise, 0.0))
        # At a nearest point 1 − d K is positive; at an end of the span the foot is taken to stay.
        left = 1.0 - value[:, None] * sizes
        curved = np.where(left > 1e-3, -sizes / np.where(left > 1e-3, left, 1.0), 0.0)
        return np.asarray(np.einsum("nia,na,nja->nij", axes, curved, axes))


def _starts(region: Region, determinant: Determinant, held: Array | None) -> list[Array]:
    """Places with much room: of both signs, or in the piece that holds a point."""
    grid = grid_of(region, _NODES)
    if grid is None:
        return []
    first, step, inside = grid
    axes = [f + s * np.arange(n) for f, s, n in zip(first, step, inside.shape, strict=True)]
    positive = determinant.on_grid(axes[0], axes[1], axes[2]) > 0.0
    if held is not None:
        own = inside & (positive == bool(determinant.value(held) > 0.0))
        own = _connected(own, (held - first) / step)
        return [held, *_placed(region, (first, step, own))]
    found = [
        place
        for side in (positive, ~positive)
        for place in _placed(region, (first, step, inside & side))
    ]
    return found or starts_in(region, grid, _STARTS)


def _placed(region: Region, grid: Grid) -> list[Array]:
    return starts_in(region, grid, _STARTS) if grid[2].any() else []


def _connected(nodes: Mask, at: Array) -> Mask:
    """Those nodes that hang together with the one nearest to a place (in steps)."""
    from scipy import ndimage

    labels, count = ndimage.label(nodes)
    if not count:
        return nodes
    index = np.argwhere(nodes)
    nearest = index[((index - at) ** 2).sum(axis=1).argmin()]
    return np.asarray(labels == labels[tuple(nearest)])
