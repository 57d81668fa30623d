"""The usable workspace: the largest ball and box inside it.

Both grow from the best places of a grid by sequential programming: what lies nearest in the
complement (`contacts`, exact) bounds the next step, and no step is taken that does not
make the body larger. The best "anywhere" is thus the best found from several starts, a local
optimum that no other start beat; it is not proven to be the global one.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from kinematics.answers.sections import Box, Sphere
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inscribed.balls import clearance, grow_ball
from kinematics.mechanisms.five_rpur.inscribed.boxes import grow_box, volume_of
from kinematics.mechanisms.five_rpur.inscribed.growing import ERROR
from kinematics.mechanisms.five_rpur.inscribed.region import Mask, Region

_STARTS = 8  # from which the best anywhere is sought
_APART = 0.6  # of its distance from the boundary, from one place to the next
_PLACES = 3 * _STARTS  # of which those farthest from the boundary are the starts
_FINALISTS = 3  # of these, when they have grown a little
_NODES = 40  # along each axis of a grid, were it a cube
_ENOUGH = 0.03  # of its nodes inside, and the grid is fine enough
_CELLS = 16_000  # that are halved again
_SMALLEST = 1e-8  # part of the machine's size: cells are not halved further
_EIGHTHS = np.array(list(product((-1.0, 1.0), repeat=3)))


def sphere(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: tuple[str, ...] | None = None,
    center: Sequence[float] | None = None,
) -> Sphere | None:
    """The largest ball about a centre, or the largest found anywhere, inside the workspace.

    Args:
        modes: working modes of which any will do; None for all 32.
        center: (3,) mm in the base frame; None for the best anywhere.

    Returns:
        The ball, of radius 0 about a centre outside; None where no centre is given and nothing
        of the workspace is found: it is empty, or thinner than `_SMALLEST` of the machine.

    Raises:
        InputError: angles, modes or centre that are not what they should be.
    """
    region = Region.at(design, phi, theta, modes)
    error = 2.0 * ERROR * region.size
    if center is not None:
        middle = point_of(center)
        return Sphere(middle, clearance(region, middle, 0.0)[0], error)
    balls = [grow_ball(region, c) for c, _ in _young(region)[:_FINALISTS]]
    return max((Sphere(c, r, error) for c, r in balls), key=lambda ball: ball.radius, default=None)


def box(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: tuple[str, ...] | None = None,
    center: Sequence[float] | None = None,
) -> Box | None:
    """The largest box found along x, y, z of the base frame, about a centre or anywhere.

    As `sphere`; a box about a centre is centred there, and of no size about one outside.
    """
    region = Region.at(design, phi, theta, modes)
    error = 2.0 * ERROR * region.size
    found = []
    if center is None:
        balls = _young(region)[:_FINALISTS]
        starts = [_cube(c, r) for c, r in balls]
        found = starts.copy()
        if starts:
            starts += _cuboids(region)
    else:
        middle = point_of(center)
        radius, _ = clearance(region, middle, 0.0)
        found = [_cube(middle, radius)]
        starts = _centred_starts(region, middle, radius) if radius > error else []
    centred = center is not None
    young = sorted((grow_box(region, start, centred, 5) for start in starts), key=volume_of)
    found += [grow_box(region, start, centred) for start in young[-_FINALISTS:]]
    boxes = (Box(low, high, error) for low, high in found)
    return max(boxes, key=lambda b: b.volume, default=None)


def _young(region: Region) -> list[tuple[Array, float]]:
    """Balls that have begun to grow, largest first."""
    places = starts_in(region, grid_of(region, _NODES), _PLACES)
    places.sort(key=lambda place: -clearance(region, place, 0.0)[0])
    young = [grow_ball(region, start, 3) for start in places[:_STARTS]]
    return sorted(young, key=lambda ball: -ball[1])


def _cube(center: Array, radius: float) -> Array:
    """The cube in a ball, (2, 3)."""
    half = radius / np.sqrt(3.0)
    return np.stack([center - half, center + half])


def point_of(center: Sequence[float]) -> Array:
    middle = finite(center, name="the centre", last=3)
    if middle.shape != (3,):
        raise InputError("the centre must be one point of 3 numbers (x, y, z)")
    return middle.copy()


# --- starts --------------------------------------------------------------------------------------


Grid = tuple[Array, Array, Mask]
"""The first node (3,), the step (3,) and which nodes are inside."""


def grid_of(region: Region, count: int) -> Grid | None:
    """A grid of about count³ nodes about all that may be inside.

    None where the region is proven to be empty.
    """
    if region.bounds is None:
        return None
    low, high = region.bounds
    while True:
        # Cells as much like cubes as can be.
        even = float(np.prod(high - low)) ** (1.0 / 3.0) / count
        counts = np.clip(np.ceil((high - low) / even), 4, 4 * count).astype(int)
        step = (high - low) / counts
        axes = [
            a + s * (np.arange(n) + 0.5) for a, s, n in zip(low, step, counts.tolist(), strict=True)
        ]
        inside = region.nodes(axes)
        if inside.mean() > _ENOUGH:
            break
        may_be = region.nodes(axes, 0.5 * step)
        where = [np.flatnonzero(may_be.any(axis=other)) for other in ((1, 2), (0, 2), (0, 1))]
        if not where[0].size:
            return None
        first = np.array([w[0] for w in where])
        last = np.array([w[-1] + 1 for w in where])
        low, high = low + step * first, low + step * last
        if np.prod((last - first) / counts) > 0.3 or step.max() < _SMALLEST * region.size:
            break
    return np.array([a[0] for a in axes]), step, inside


def starts_in(region: Region, grid: Grid | None, wanted: int) -> list[Array]:
    """Places inside, far from the complement and from each other, best first."""
    from scipy import ndimage

    if grid is None:
        return []
    first, step, inside = grid
    if not inside.any():
        return _sought(region, first, step, inside.shape, wanted)
    far = ndimage.distance_transform_edt(np.pad(inside, 1), sampling=step)[1:-1, 1:-1, 1:-1]
    points, far = first + step * np.argwhere(inside), far[inside]
    starts: list[Array] = []
    while len(points) and len(starts) < wanted:
        best = int(far.argmax())
        starts.append(points[best])
        apart = np.linalg.norm(points - points[best], axis=1) > _APART * far[best]
        points, far = points[apart], far[apart]
    return starts


def _sought(
    region: Region, first: Array, step: Array, shape: tuple[int, ...], wanted: int
) -> list[Array]:
    """Places inside a region too thin for a grid: cells that may hold some are halved."""
    cells = first + step * np.indices(shape).reshape(3, -1).T
    half = 0.5 * step
    while half.max() > _SMALLEST * region.size:
        cells = cells[region.inside(cells, half)]
        found = cells[region.inside(cells)]
        if len(found):
            return _spread(found, wanted)
        if len(cells) > _CELLS:
            cells = cells[:: len(cells) // _CELLS + 1]
        half = 0.5 * half
        cells = (cells[:, None] + half * _EIGHTHS).reshape(-1, 3)
    return []


def _spread(points: Array, wanted: int) -> list[Array]:
    """Some points, each as far as can be from those before it."""
    chosen = [points[len(points) // 2]]
    far = np.full(len(points), np.inf)
    while len(chosen) < min(wanted, len(points)):
        far = np.minimum(far, np.linalg.norm(points - chosen[-1], axis=1))
        chosen.append(points[int(far.argmax())])
    return chosen


def _cuboids(region: Region) -> list[Array]:
    """The largest cuboids (2, 3) of grid nodes, all of which are inside."""
    grid = grid_of(region, 28)
    if grid is None:
        return []
    first, step, inside = grid
    nx, ny, _ = inside.shape
    # How many nodes in a row end at a node, along z; then the least over windows of x and y.
    run = np.zeros(inside.shape, dtype=np.int16)
    for k in range(inside.shape[2]):
        run[:, :, k] = (run[:, :, k - 1] + 1) * inside[:, :, k] if k else inside[:, :, 0]
    found = []
    over_x = run
    for i in range(nx):
        if i:
            over_x = np.minimum(over_x[:-1], run[i:])
        over_xy = over_x
        for j in range(ny):
            if j:
                over_xy = np.minimum(over_xy[:, :-1], over_x[:, j:])
            at = np.unravel_index(int(over_xy.argmax()), over_xy.shape)
            deep = int(over_xy[at])
            if not deep:
                break
            size = step * (i + 1, j + 1, deep)
            low = first + step * (at[0], at[1], at[2] - deep + 1)
            found.append((float(np.prod(size)), low, low + size - step))
    found.sort(key=lambda f: -f[0])
    chosen: list[Array] = []
    for _, low, high in found:
        corners = np.stack([low - 0.05 * step, high + 0.05 * step])
        if all(_overlap(corners, other) < 0.5 for other in chosen):
            chosen.append(corners)
            if len(chosen) == _STARTS:
                break
    return chosen


def _overlap(a: Array, b: Array) -> float:
    """The volume that two boxes share, as part of the smaller one's."""
    shared = np.maximum(np.minimum(a[1], b[1]) - np.maximum(a[0], b[0]), 0.0)
    return float(np.prod(shared) / min(np.prod(a[1] - a[0]), np.prod(b[1] - b[0])))


def _centred_starts(region: Region, center: Array, radius: float) -> list[Array]:
    """Boxes about a centre: in its ball, and the largest that the nodes of a grid allow."""
    halves = [np.full(3, radius / np.sqrt(3.0))]
    if region.bounds is not None:
        low, high = region.bounds
        count = 24
        step = np.maximum(high - center, center - low) / count
        axes = [c + s * np.arange(-count, count + 1) for c, s in zip(center, step, strict=True)]
        inside = region.nodes(axes)
        eighth = np.ones((count + 1,) * 3, dtype=bool)
        for flips in product((slice(count, None), slice(count, None, -1)), repeat=3):
            eighth &= inside[flips]
        # Out to each node in x and y, how many nodes in a row are inside along z.
        deep = np.minimum.accumulate(np.cumprod(eighth, axis=2).sum(axis=2), axis=0)
        deep = np.minimum.accumulate(deep, axis=1) - 1
        i, j = np.nonzero(deep > 0)
        sizes = np.stack([i, j, deep[i, j]], axis=-1) * step
        for size in sizes[np.argsort(-np.prod(sizes, axis=1), kind="stable")]:
            if len(halves) == 3:
                break
            if size.all() and all(np.abs(np.log(size / h)).max() > 0.5 for h in halves[1:]):
                halves.append(0.98 * size)
    return [np.stack([center - half, center + half]) for half in halves]
