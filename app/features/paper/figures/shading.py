"""Closed surfaces as shaded pictures: parallel projection with a depth for every pixel.

Whatever lies before a cutting plane is left out, and where one then sees a surface from within it
is filled flat: so the picture of a cut solid looks solid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.scene.palette import LIGHT, rgb
from kinematics.arrays import Array
from kinematics.solids.meshes import SolidMesh

_LIGHT = np.array([-0.35, -0.55, 0.76])
_SOFT = 0.42  # of the light from everywhere


@dataclass(frozen=True, slots=True)
class View:
    """From where to look: azimuth and height, degrees; ``cut``: points with normal · p > offset are
    left out."""

    azimuth: float = -58.0
    height: float = 24.0
    cut: tuple[tuple[float, float, float], float] | None = None

    @property
    def frame(self) -> Array:
        """(3, 3) rows: to the right, upwards, towards the eye."""
        a, h = np.radians([self.azimuth, self.height])
        eye = np.array([np.cos(h) * np.cos(a), np.cos(h) * np.sin(a), np.sin(h)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        return np.stack([right, np.cross(eye, right), eye])


def shaded(
    mesh: SolidMesh, view: View, pixels: int = 1100, color: str = LIGHT.workspace
) -> tuple[Array, tuple[float, float, float, float]]:
    """The picture (rows, columns, 4), 0 to 1, and what it spans (left, right, low, high), mm."""
    seen = mesh.vertices @ view.frame.T
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
    margin = 0.03 * float((high - low).max())
    low, high = low - margin, high + margin
    scale = pixels / float((high - low).max())
    columns, rows = (int(n) + 1 for n in np.ceil((high - low) * scale))
    depth = np.full((rows, columns), -np.inf)
    shade = np.zeros((rows, columns))  # of the light; negative: seen from within
    corners = seen[mesh.faces]
    places = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normals, axis=1)
    light = view.frame @ (_LIGHT / np.linalg.norm(_LIGHT))
    for face in np.flatnonzero(size > 0.0):
        _fill(depth, shade, corners[face], places[face], normals[face], light, low, scale, view.cut)
    return _painted(depth, shade, color, scale), (low[0], high[0], low[1], high[1])


def _fill(
    depth: Array,
    shade: Array,
    corners: Array,
    places: Array,
    normal: Array,
    light: Array,
    low: Array,
    scale: float,
    cut: tuple[tuple[float, float, float], float] | None,
) -> None:
    """Put one triangle into the picture where it is nearer than what is there."""
    flat = (corners[:, :2] - low) * scale
    (c0, r0), (c1, r1) = (
        np.floor(flat.min(axis=0)).astype(int),
        np.ceil(flat.max(axis=0)).astype(int),
    )
    c1, r1 = min(int(c1) + 1, depth.shape[1]), min(int(r1) + 1, depth.shape[0])
    x, y = np.arange(c0, c1) + 0.5, np.arange(r0, r1)[:, None] + 0.5
    (ax, ay), (bx, by), (cx, cy) = flat
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if abs(area) < 1e-12:
        return
    u = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area
    v = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area
    w = 1.0 - u - v
    z = u * corners[0, 2] + v * corners[1, 2] + w * corners[2, 2]
    old = depth[r0:r1, c0:c1]
    inside = (u >= -1e-9) & (v >= -1e-9) & (w >= -1e-9) & (z > old)
    if cut is not None:
        side = places @ np.asarray(cut[0]) - cut[1]
        inside &= u * side[0] + v * side[1] + w * side[2] <= 0.0
    if inside.any():
        unit = normal / np.linalg.norm(normal)
        seen = _SOFT + (1.0 - _SOFT) * max(float(unit @ light), 0.0)
        old[inside] = z[inside]
        shade[r0:r1, c0:c1][inside] = seen if unit[2] > 0.0 else -1.0


def _painted(depth: Array, shade: Array, color: str, scale: float) -> Array:
    """Colours, with lines where the depth leaps or a cut begins."""
    tone, cap, line = (np.array(rgb(c)) / 255.0 for c in (color, LIGHT.cut, LIGHT.silhouette))
    there = np.isfinite(depth)
    known = np.where(there, depth, depth[there].min(initial=0.0) - 1e3)
    within = shade < 0.0
    light = np.where(within, 1.0, np.abs(shade))[..., None]
    paint = np.where(within[..., None], cap, np.clip(tone * 1.25 * light + 0.12 * light, 0.0, 1.0))
    edge = np.zeros(depth.shape, dtype=bool)
    for axis in (0, 1):
        leap = np.abs(np.diff(known, axis=axis)) > 14.0 / scale
        bend = np.diff(within.astype(int), axis=axis) != 0
        some = leap | bend
        before = (slice(None, -1), slice(None)) if axis == 0 else (slice(None), slice(None, -1))
        edge[before] |= some
    paint = np.where((edge & there)[..., None], 0.35 * paint + 0.65 * line, paint)
    return np.concatenate([paint, there[..., None].astype(float)], axis=-1)
