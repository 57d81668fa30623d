"""The true surfaces behind a faceted solid, and points moved onto several of them at once.

About w'_i in x'y'z' (Tale Masouleh et al. 2011, section 4) they are {ρ u(α) + l v(β)}:
x² + (z − σ h(y))² = ρ² with h = sqrt(l² − y²) or, where h is steep, y² + (z ∓ S(x))² = l² with
S = sqrt(ρ² − x²); and the planes |y| = l in which they end. Lengths mm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.workspace.vertex_space import Surface
from kinematics.solids.csg import TracedMesh

Masks = NDArray[np.int64]

_ITERATIONS = 24
_STEP, _REACH = 2.0, 8.0  # how far one step and all steps may lead, in deviations of the mesh
_DAMPING = 1e-10  # of normalised equations: equal surfaces share a step, others feel nothing
_ARC, _PLANE, _SIDE = range(3)


@dataclass(frozen=True, eq=False)
class Sheets:
    """The distinct true surfaces of a mesh, one row each.

    Attributes:
        kind: (S,) arc, plane or side.
        center: (S, 3) mm about which an arc or a side is; of a plane only y counts.
        radius, link, sign: (S,) as of `vertex_space.Surface`.
        of_face: (F,) which of them each face stands for.
        rims: (S,) bits: the planes in which an arc ends; there h is 0.
    """

    kind: NDArray[np.int64]
    center: Array
    radius: Array
    link: Array
    sign: Array
    of_face: NDArray[np.int64]
    rims: Masks

    def __len__(self) -> int:
        return len(self.kind)

    @property
    def curved(self) -> np.int64:
        """The arcs, as bits."""
        return np.int64((np.int64(1) << np.flatnonzero(self.kind == _ARC)).sum())


def sheets_of(traced: TracedMesh) -> Sheets:
    """The distinct true surfaces behind a mesh made of `vertex_space` solids."""
    mesh = traced.mesh
    size = float(np.abs(mesh.vertices).max(initial=1.0))
    rows = np.zeros((2 * len(traced.patches), 7))
    for n, patch in enumerate(traced.patches):
        surface = patch.tag
        if not isinstance(surface, Surface):
            raise TypeError(f"a face without a surface: {surface!r}")
        center = patch.transform[:, 3]
        for at, side in ((2 * n, 1.0), (2 * n + 1, -1.0)):
            if surface.kind == "end":
                rows[at] = _PLANE, 0.0, center[1] + side * surface.link, 0.0, 0.0, 0.0, 0.0
            else:
                curved = _ARC if surface.kind == "arc" else _SIDE
                rows[at] = curved, *center, surface.radius, surface.link, surface.sign
    # Both rows of an arc are one; so are planes of several limbs, and limbs that coincide.
    _, first, same = np.unique(
        np.round(rows / (1e-9 * size)), axis=0, return_index=True, return_inverse=True
    )
    table = rows[first]
    ends = rows[::2, 0] == _PLANE
    middle = np.array([patch.transform[1, 3] for patch in traced.patches])
    y = mesh.vertices[mesh.faces[:, 0], 1]
    low = ends[traced.patch_of] & (y < middle[traced.patch_of])
    kind: NDArray[np.int64] = table[:, 0].astype(np.int64)
    bit = np.int64(1) << np.arange(len(table), dtype=np.int64)
    apart = np.abs(np.abs(table[:, None, 2] - table[None, :, 2]) - table[:, None, 5])
    own = (kind[:, None] == _ARC) & (kind[None, :] == _PLANE) & (apart <= 1e-8 * size)
    return Sheets(
        kind=kind,
        center=table[:, 1:4],
        radius=table[:, 4],
        link=table[:, 5],
        sign=table[:, 6],
        of_face=np.asarray(same, np.int64).reshape(-1)[2 * traced.patch_of + low],
        rims=np.where(own, bit, 0).sum(axis=1),
    )


def masks_of(sheets: Sheets, faces: NDArray[np.int32], vertices: int) -> Masks:
    """(V,) the sheets that meet in each vertex, as bits."""
    mask = np.zeros(vertices, np.int64)
    np.bitwise_or.at(mask, faces.ravel(), np.repeat(np.int64(1) << sheets.of_face, 3))
    return mask


def count_of(masks: Masks) -> NDArray[np.int64]:
    """How many bits are set."""
    bits = np.unpackbits(masks[:, None].view(np.uint8), axis=1)
    return np.asarray(bits.sum(axis=1), dtype=np.int64)


# --- one surface -------------------------------------------------------------------------------


def distances(
    sheets: Sheets, which: NDArray[np.int64], rim: NDArray[np.bool_], points: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """How far points are from surfaces, to first order, and the surfaces' unit normals there.

    Args:
        which: (N,) the surface of each point.
        rim: (N,) the point is kept in the plane |y| = l of its arc.
        points: (N, 3) mm.

    Returns:
        (N,) mm with sign, positive outside an arc's circle, beyond a plane or a side; (N, 3);
        and (N,) where a point is on the arc of the other sign, or beyond both.
    """
    kind, r, l_ = sheets.kind[which], sheets.radius[which], sheets.link[which]
    sign = sheets.sign[which]
    x, y, z = (points - sheets.center[which]).T
    tiny = np.where(kind == _ARC, 1e-12 * (r + l_), 1.0)
    h = np.where(rim, 0.0, np.sqrt(np.maximum((l_ - y) * (l_ + y), 0.0)))
    s = np.sqrt(np.maximum((r - x) * (r + x), 0.0))
    d = z - sign * h
    upright = rim | (h * r >= s * l_)
    # As a circle of radius ρ in the plane y …
    around = np.maximum(np.hypot(x, d), tiny)
    slope = np.where(rim, 0.0, sign * y / np.maximum(h, tiny))
    # … or as one of radius l in the plane x.
    half = np.where(d < 0.0, -1.0, 1.0)
    e = z - half * s
    along = np.maximum(np.hypot(y, e), tiny)
    out = half * sign / along  # also positive away from the arc's axis
    f = np.where(upright, around - r, half * sign * (along - l_))
    gx = np.where(upright, x / around, half * x / np.maximum(s, tiny) * e * out)
    gy = np.where(upright, slope * d / around, y * out)
    gz = np.where(upright, d / around, e * out)
    crossed = np.where(upright, np.abs(y) > (1 + 1e-9) * l_, sign * e < -1e-9 * l_)
    crossed &= (kind == _ARC) & ~rim
    flat = kind != _ARC
    if flat.any():
        plane, side = kind == _PLANE, kind == _SIDE
        f = np.where(plane, y, np.where(side, np.abs(x) - r, f))
        gx = np.where(plane, 0.0, np.where(side, np.sign(x), gx))
        gy = np.where(plane, 1.0, np.where(side, 0.0, gy))
        gz = np.where(flat, 0.0, gz)
    length = np.maximum(np.sqrt(gx * gx + gy * gy + gz * gz), 1e-300)
    return f / length, np.stack([gx, gy, gz], axis=1) / length[:, None], crossed


# --- many vertices, each on all of its surfaces ------------------------------------------------


def _pairs(
    sheets: Sheets, masks: Masks
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
    """(point, sheet, rim) of every bit, ordered by point."""
    bits = (masks[:, None] >> np.arange(len(sheets), dtype=np.int64)) & 1
    point, sheet = np.nonzero(bits)
    return point, sheet, (masks[point] & sheets.rims[sheet]) != 0


def residuals(sheets: Sheets, masks: Masks, points: Array) -> Array:
    """(N,) how far each point is from the farthest of its surfaces, mm."""
    point, sheet, rim = _pairs(sheets, masks)
    f, _, crossed = distances(sheets, sheet, rim, points[point])
    result = np.zeros(len(points))
    np.maximum.at(result, point, np.where(crossed, np.inf, np.abs(f)))
    return result


def onto(
    sheets: Sheets, masks: Masks, points: Array, deviation: Array | float, on: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Points moved onto all of their surfaces by Gauss-Newton steps of least norm.

    Args:
        masks: (N,) which of them each point belongs to, at least one.
        points: (N, 3) mm.
        deviation: a number or (N,), mm: what the steps are measured by.
        on: mm, near enough.

    Returns:
        (N, 3), and (N,) where that succeeded.
    """
    result = points.copy()
    scale = np.broadcast_to(np.asarray(deviation, dtype=float), len(points))
    done = np.zeros(len(points), bool)
    active = np.arange(len(points))
    for _ in range(_ITERATIONS):
        here = result[active]
        point, sheet, rim = _pairs(sheets, masks[active])
        f, g, crossed = distances(sheets, sheet, rim, here[point])
        start = np.flatnonzero(np.diff(point, prepend=-1))
        far = np.maximum.reduceat(np.abs(f), start)
        met = far <= on
        settled = np.flatnonzero(met)
        if len(settled):
            astray = np.bitwise_or.reduceat(crossed, start)
            done[active[settled]] = ~astray[settled]
            if len(settled) == len(active):
                break
        step = _steps(f, g, start)
        length = np.maximum(np.linalg.norm(step, axis=1), 1e-300)
        step *= np.minimum(1.0, _STEP * scale[active] / length)[:, None]
        moving = ~met & (np.linalg.norm(here - points[active], axis=1) <= _REACH * scale[active])
        active, here, step = active[moving], here[moving], step[moving]
        if not len(active):
            break
        result[active] = here + step
    done &= np.linalg.norm(result - points, axis=1) <= _REACH * scale
    return result, done


def _steps(f: Array, g: Array, start: NDArray[np.int64]) -> Array:
    """The least step of each point that meets the linear equations f + g·step = 0."""
    step = -f[start, None] * g[start]
    count = np.diff(start, append=len(f))
    several = np.flatnonzero(count > 1)
    if len(several):
        rows = np.repeat(count > 1, count)
        begin = np.concatenate([[0], np.cumsum(count[several])[:-1]])
        g, f = g[rows], f[rows]
        normal = np.add.reduceat(g[:, :, None] * g[:, None, :], begin) + _DAMPING * np.eye(3)
        right = np.add.reduceat(-f[:, None] * g, begin)
        step[several] = np.linalg.solve(normal, right[:, :, None])[:, :, 0]
    return step


def onto_fewer(
    sheets: Sheets, masks: Masks, points: Array, deviation: float, on: float
) -> tuple[Array, Masks]:
    """Points that cannot be on all their surfaces, on all but one: the nearest such place.

    Returns (N, 3) and the surfaces (N,) on which they now are; none where they stay.
    """
    best, taken = points.copy(), np.zeros(len(points), np.int64)
    least = np.full(len(points), np.inf)
    for sheet in range(len(sheets)):
        bit = np.int64(1) << np.int64(sheet)
        able = np.flatnonzero((masks & bit != 0) & (masks != bit))
        if not len(able):
            continue
        tried, done = onto(sheets, masks[able] & ~bit, points[able], deviation, on)
        way = np.linalg.norm(tried - points[able], axis=1)
        better = done & (way < least[able])
        chosen = able[better]
        best[chosen], taken[chosen] = tried[better], masks[chosen] & ~bit
        least[chosen] = way[better]
    return best, taken
